//! The loads of all contacts, and the relief that they and it settle to.

use super::places::{Bells, Relief, ReliefPlaces, WIDTH, root, root_from};
use nalgebra::{Matrix3, Vector3};

/// Newton steps in which loads and relief settle, and what the last one may correct, relative: its square is left.
const STEPS: usize = 30;
const LAST: f64 = 1e-3;

/// A step that corrects less, relative, is taken with the factors of the one before.
const NEAR: f64 = 0.03;

/// Share of a load that a step leaves at least.
const LEFT: f64 = 0.2;

/// Those of a normal force and of friction with their moments.
const COMPONENTS: usize = 6;

/// What a contact's forces change by with the relief at one place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gradient {
    /// The number of the place.
    place: usize,
    /// Normal forces and their moment, N/m.
    pub normal: Vector3<f64>,
    /// Friction, the same.
    pub friction: Vector3<f64>,
}

/// A strip as it loads a surface.
pub(crate) struct StripLoad {
    /// Force by its weight, N.
    pub load: f64,
    /// Change of that with the relief, N/m.
    pub stiffness: f64,
    /// What its forces and their moment on the wheel change by with the relief.
    pub normal: Vector3<f64>,
    /// See `normal`.
    pub friction: Vector3<f64>,
}

/// The loads of all contacts under a relief.
#[derive(Debug, Clone, Default)]
pub(crate) struct Loading {
    /// By place, N.
    load: Vec<f64>,
    /// What they lose with the relief at the same place and the next ones, N/m.
    stiffness: Vec<[f64; WIDTH]>,
    /// Contact after contact, each from its first place to its last.
    gradients: Vec<Gradient>,
    /// The first of those of the contact that is summed.
    contact: usize,
    // what follows is made of these: the places that have loads
    active: Vec<usize>,
    /// Their loads that settle, N, and the third roots of them.
    now: Vec<f64>,
    roots: Vec<f64>,
    /// `S`, what the loads lose with the relief, N/m, and `M`, the relief beside them, m/N; by rows, as all matrices here.
    lost: Vec<f64>,
    beside: Vec<f64>,
    softening: Softening,
    /// What the loads are off, N, and a change of the relief at their places, m.
    off: Vec<f64>,
    step: Vec<f64>,
    /// The gradients of all contacts together, component after component, and [`Softening`]'s X times that.
    all: Vec<f64>,
    halves: Vec<f64>,
    /// By place: what the relief changes by with the motion of the wheel, what it has changed by since the strips were found, m, where it was last, and what it changed by there.
    response: Vec<Vector3<f64>>,
    shift: Vec<f64>,
    before: Vec<f64>,
    change: Vec<f64>,
    /// What the stiffness of all contacts loses by the relief: that of the normal forces and that of friction.
    softness: [Matrix3<f64>; 2],
}

/// Factors of the change of the relief with the loads that there would be without it, m/N: `H = D·(I + S·D)⁻¹`, with `D` the derivative of the relief by the loads.
/// From `D = UᵀU` and `I + U·S·Uᵀ = GᵀG` it is `XᵀX` with `X = G⁻ᵀU`.
#[derive(Debug, Clone, Default)]
struct Softening {
    /// `U`, and its transpose.
    derivative: Vec<f64>,
    transposed: Vec<f64>,
    product: Vec<f64>,
    /// `G` with the reciprocals of its diagonal, and its transpose.
    system: Vec<f64>,
    system_transposed: Vec<f64>,
}

impl Softening {
    /// Takes over another, in the memory that there is.
    fn copy_from(&mut self, other: &Self) {
        let Self { derivative, transposed, product, system, system_transposed } = other;
        self.derivative.clone_from(derivative);
        self.transposed.clone_from(transposed);
        self.product.clone_from(product);
        self.system.clone_from(system);
        self.system_transposed.clone_from(system_transposed);
    }
}

impl Loading {
    /// Takes over another, in the memory that there is.
    pub fn copy_from(&mut self, other: &Self) {
        let Self { load, stiffness, gradients, contact, active, now, roots, lost, beside, .. } = other;
        let Self { softening, off, step, all, halves, response, shift, before, change, softness, .. } = other;
        (self.contact, self.softness) = (*contact, *softness);
        self.stiffness.clone_from(stiffness);
        self.gradients.clone_from(gradients);
        self.active.clone_from(active);
        self.response.clone_from(response);
        self.softening.copy_from(softening);
        for (own, other) in [
            (&mut self.load, load),
            (&mut self.now, now),
            (&mut self.roots, roots),
            (&mut self.lost, lost),
            (&mut self.beside, beside),
            (&mut self.off, off),
            (&mut self.step, step),
            (&mut self.all, all),
            (&mut self.halves, halves),
            (&mut self.shift, shift),
            (&mut self.before, before),
            (&mut self.change, change),
        ] {
            own.clone_from(other);
        }
    }

    /// None, on the places of a surface.
    pub fn clear(&mut self, places: Option<&ReliefPlaces>) {
        let count = places.map_or(0, |places| places.count);
        self.load.clear();
        self.load.resize(count, 0.0);
        self.stiffness.clear();
        self.stiffness.resize(count, [0.0; WIDTH]);
        self.shift.clear();
        self.shift.resize(count, 0.0);
        self.gradients.clear();
        self.contact = 0;
    }

    /// From here on the strips of another contact follow.
    pub fn next_contact(&mut self) {
        self.contact = self.gradients.len();
    }

    /// The gradients of a contact whose strips have been summed.
    pub fn of_contact(&self) -> [usize; 2] {
        [self.contact, self.gradients.len()]
    }

    /// Adds a strip of a contact.
    pub fn add(&mut self, bells: &Bells, strip: &StripLoad) {
        if self.load.is_empty() {
            return;
        }
        let Bells { first, value } = *bells;
        let none = |place| Gradient { place, normal: Vector3::zeros(), friction: Vector3::zeros() };
        let mut start = self.gradients.get(self.contact).map_or(first, |gradient| gradient.place);
        // a contact that is integrated as two and as one begins twice
        while first < start {
            start -= 1;
            self.gradients.insert(self.contact, none(start));
        }
        while self.gradients.len() - self.contact < first - start + WIDTH {
            self.gradients.push(none(start + self.gradients.len() - self.contact));
        }
        let offset = self.contact + first - start;
        for (k, b) in value.iter().enumerate() {
            self.load[first + k] += b * strip.load;
            let gradient = &mut self.gradients[offset + k];
            gradient.normal += strip.normal * *b;
            gradient.friction += strip.friction * *b;
            let row = &mut self.stiffness[first + k];
            let part = b * strip.stiffness;
            value[k..].iter().zip(row.iter_mut()).for_each(|(other, sum)| *sum += part * other);
        }
    }

    /// Adds a strip that has been added before, with another load, N.
    pub fn add_load(&mut self, bells: &Bells, load: f64) {
        if let Some(loads) = self.load.get_mut(bells.first..bells.first + WIDTH) {
            add(loads, load, &bells.value);
        }
    }

    /// Prepares the sum of other loads after a motion of the wheel, from the relief that was `made` before it; the strips were found `under` another one.
    pub fn guess(&mut self, made: &Relief, under: &Relief, motion: &Vector3<f64>) {
        let Self { load, response, before, shift, .. } = self;
        load.fill(0.0);
        before.clear();
        before.extend(response.iter().enumerate().map(|(i, response)| made.of(i) + response.dot(motion)));
        shift.clear();
        shift.extend(before.iter().enumerate().map(|(i, at)| at - under.of(i)));
    }

    /// What the relief has changed by since the strips were found, m.
    pub fn shift(&self, bells: &Bells) -> f64 {
        self.shift.get(bells.first..bells.first + WIDTH).map_or(0.0, |shift| dot(shift, &bells.value))
    }

    /// The relief that the loads make, from the guess on by one step with the derivatives of where the strips were found, and its energy, J.
    pub fn again(&mut self, places: &ReliefPlaces, made: &mut Relief) -> f64 {
        let Self { load, active, now, roots, lost, beside, softening, off, step, before, .. } = self;
        let n = active.len();
        for (a, &i) in active.iter().enumerate() {
            (now[a], roots[a]) = (load[i], root_from(roots[a], load[i]));
        }
        // (I + D·S)⁻¹ = I - H·S
        for (a, &i) in active.iter().enumerate() {
            step[a] = places.own(roots[a]).0 - before[i];
        }
        for a in 0..n {
            add(step, now[a], row(beside, n, a));
        }
        off.fill(0.0);
        for a in 0..n {
            add(off, step[a], row(lost, n, a));
        }
        softening.apply(off, &mut self.halves[..n], n);
        for a in 0..n {
            step[a] -= self.halves[a];
        }
        for a in 0..n {
            add(now, -step[a], row(lost, n, a));
        }
        for a in 0..n {
            roots[a] = root_from(roots[a], now[a]);
        }
        self.settle(places, made)
    }

    /// The relief that the loads make if they go down in proportion to it, and its energy, J: `g = g' - S·(r(g) - r')` by Newton's method.
    pub fn relieve(&mut self, places: &ReliefPlaces, relief: &Relief, made: &mut Relief) -> f64 {
        let before = |i: usize| relief.of(i);
        self.gather(places);
        let Self { load, active, now, roots, lost, beside, softening, off, step, .. } = self;
        let n = active.len();
        let mut factored = false;
        for _ in 0..STEPS {
            for (a, &i) in active.iter().enumerate() {
                step[a] = places.own(roots[a]).0 - before(i);
                off[a] = load[i] - now[a];
            }
            for a in 0..n {
                add(step, now[a], row(beside, n, a));
            }
            for a in 0..n {
                add(off, -step[a], row(lost, n, a));
            }
            let size = |loads: &[f64]| loads.iter().map(|load| load.abs()).fold(0.0, f64::max);
            let [wrong, whole] = [size(off), size(now)];
            if !factored || wrong > NEAR * whole {
                softening.factor(beside, lost, |a| places.own(roots[a]).1, n);
                factored = true;
            }
            // (I + S·D)⁻¹ = I - S·H
            softening.apply(off, step, n);
            for a in 0..n {
                add(off, -step[a], row(lost, n, a));
            }
            for a in 0..n {
                now[a] = (now[a] + off[a]).max(LEFT * now[a]);
                roots[a] = root_from(roots[a], now[a]);
            }
            if wrong <= LAST * whole {
                break;
            }
        }
        self.before.clear();
        self.before.extend((0..places.count).map(before));
        self.settle(places, made)
    }

    /// The relief of loads that have settled, and its energy, J.
    fn settle(&mut self, places: &ReliefPlaces, made: &mut Relief) -> f64 {
        let Self { load, active, now, roots, before, change, .. } = self;
        made.at.clear();
        made.at.resize(places.count, 0.0);
        for (&i, load) in active.iter().zip(&*now) {
            add(&mut made.at, *load, places.beside(i));
        }
        let mut energy = 0.0;
        for (a, &i) in active.iter().enumerate() {
            let beside = made.at[i];
            made.at[i] += places.own(roots[a]).0;
            // what the strips have changes by their loads times that of the relief
            energy +=
                places.energy(now[a], roots[a]) + 0.5 * now[a] * beside - load[i] * (made.at[i] - before[i]);
        }
        change.clear();
        change.extend(made.at.iter().zip(before).map(|(at, before)| at - *before));
        energy
    }

    /// Loads and matrices at the places that have loads.
    fn gather(&mut self, places: &ReliefPlaces) {
        let loaded = self.stiffness.iter().enumerate().filter(|(_, stiffness)| stiffness[0] > 0.0);
        self.active.clear();
        self.active.extend(loaded.map(|(i, _)| i));
        let (active, n) = (&self.active, self.active.len());
        self.now.clear();
        self.now.extend(active.iter().map(|i| self.load[*i]));
        self.roots.clear();
        self.roots.extend(self.now.iter().map(|load| root(*load)));
        for list in [&mut self.off, &mut self.step] {
            list.clear();
            list.resize(n, 0.0);
        }
        self.beside.clear();
        for &i in active {
            let row = places.beside(i);
            self.beside.extend(active.iter().map(|j| row[*j]));
        }
        self.lost.clear();
        self.lost.resize(n * n, 0.0);
        for (a, &i) in active.iter().enumerate() {
            for (b, &j) in active.iter().enumerate().skip(a).take_while(|(_, j)| **j < i + WIDTH) {
                let lost = self.stiffness[i][j - i];
                self.lost[a * n + b] = lost;
                self.lost[b * n + a] = lost;
            }
        }
    }

    /// The gradients of a contact by their numbers, with what the relief has changed by at their places, m.
    pub fn changes(&self, [from, to]: [usize; 2]) -> impl Iterator<Item = (&Gradient, f64)> {
        self.gradients[from..to].iter().map(|gradient| (gradient, self.change[gradient.place]))
    }

    /// The largest change, m.
    pub fn largest_change(&self) -> f64 {
        self.change.iter().map(|change| change.abs()).fold(0.0, f64::max)
    }

    /// What the stiffness of all contacts loses by the relief: that of the normal forces and that of friction.
    pub fn softness(&self) -> &[Matrix3<f64>; 2] {
        &self.softness
    }

    /// Finds what the stiffness of all contacts loses by the relief, and what that changes by with the motion of the wheel.
    pub fn soften(&mut self) {
        let Self { gradients, active, softening, all, halves, response, load, .. } = self;
        let n = active.len();
        for list in [&mut *all, &mut *halves] {
            list.clear();
            list.resize(COMPONENTS * n, 0.0);
        }
        for Gradient { place, normal, friction } in gradients {
            let Ok(a) = active.binary_search(place) else { continue };
            for (c, value) in normal.iter().chain(friction.iter()).enumerate() {
                all[c * n + a] += value;
            }
        }
        for c in 0..COMPONENTS {
            softening.half(row(all, n, c), &mut halves[c * n..(c + 1) * n], n);
        }
        let product = |i: usize, j: usize| dot(row(halves, n, i), row(halves, n, j));
        self.softness = [Matrix3::from_fn(product), Matrix3::from_fn(|i, j| product(3 + i, j))];
        response.clear();
        response.resize(load.len(), Vector3::zeros());
        for c in 0..3 {
            let whole = &mut halves[c * n..(c + 1) * n];
            softening.other_half(whole, n);
            for (&i, value) in active.iter().zip(&*whole) {
                response[i][c] = *value;
            }
        }
        if halves.len() < n {
            halves.resize(n, 0.0);
        }
    }
}

impl Softening {
    /// From `M`, `S` and the derivative of the relief that each load makes at its place.
    fn factor(&mut self, beside: &[f64], lost: &[f64], near: impl Fn(usize) -> f64, n: usize) {
        let Self { derivative, transposed, product, system, system_transposed } = self;
        derivative.clear();
        derivative.extend_from_slice(beside);
        for matrix in [&mut *transposed, &mut *product, &mut *system, &mut *system_transposed] {
            matrix.clear();
            matrix.resize(n * n, 0.0);
        }
        for a in 0..n {
            derivative[a * n + a] += near(a);
        }
        cholesky(derivative, n);
        for a in 0..n {
            for k in a..n {
                let u = derivative[a * n + k];
                transposed[k * n + a] = u;
                // U·S, whose band is that of S
                let band = (k + 1).saturating_sub(WIDTH)..(k + WIDTH).min(n);
                add(&mut product[a * n..][band.clone()], u, &row(lost, n, k)[band]);
            }
        }
        for a in 0..n {
            system[a * n + a] = 1.0;
            for k in a..n {
                let factor = product[a * n + k];
                add(&mut system[a * n + a..=a * n + k], factor, &transposed[k * n + a..=k * n + k]);
            }
        }
        cholesky(system, n);
        for a in 0..n {
            system[a * n + a] = 1.0 / system[a * n + a];
            for k in a..n {
                system_transposed[k * n + a] = system[a * n + k];
            }
        }
    }

    /// `H` times `loads`.
    fn apply(&self, loads: &[f64], relief: &mut [f64], n: usize) {
        self.half(loads, relief, n);
        self.other_half(relief, n);
    }

    /// `Xᵀ` times what [`Softening::half`] has made.
    fn other_half(&self, relief: &mut [f64], n: usize) {
        for a in (0..n).rev() {
            let (rest, known) = relief.split_at_mut(a);
            known[0] *= self.system[a * n + a];
            add(rest, -known[0], row(&self.system_transposed, n, a));
        }
        for k in (0..n).rev() {
            let [own, others @ ..] = &mut relief[k..] else { return };
            add(others, *own, &self.derivative[k * n + k + 1..]);
            *own *= self.derivative[k * n + k];
        }
    }

    /// `X` times `loads`.
    fn half(&self, loads: &[f64], result: &mut [f64], n: usize) {
        result.fill(0.0);
        for (k, load) in loads.iter().enumerate() {
            add(&mut result[..=k], *load, &self.transposed[k * n..=k * n + k]);
        }
        for a in 0..n {
            result[a] *= self.system[a * n + a];
            let (known, rest) = result.split_at_mut(a + 1);
            add(rest, -known[a], &self.system[a * n + a + 1..(a + 1) * n]);
        }
    }
}

/// A row of a matrix of `n` columns.
fn row(matrix: &[f64], n: usize, row: usize) -> &[f64] {
    &matrix[row * n..(row + 1) * n]
}

/// Adds a multiple of a list to the first numbers of another.
fn add(sums: &mut [f64], factor: f64, list: &[f64]) {
    sums.iter_mut().zip(list).for_each(|(sum, value)| *sum += factor * value);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Cholesky's factor in the upper triangle of a matrix; without any room but its own, for it is done in every iteration of a step.
fn cholesky(matrix: &mut [f64], n: usize) {
    for k in 0..n {
        let (above, below) = matrix.split_at_mut((k + 1) * n);
        let pivot = &mut above[k * n + k..];
        let over = 1.0 / pivot[0].sqrt();
        pivot.iter_mut().for_each(|value| *value *= over);
        for i in 1..n - k {
            add(&mut below[(i - 1) * n + k + i..i * n], -pivot[i], &pivot[i..]);
        }
    }
}
