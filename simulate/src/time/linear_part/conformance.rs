//! The rules of [`LinearPart`], measured on an implementation. Tests of every implementation use this.

use super::part::{LinearPart, LinearStep};
use faer::{Mat, MatRef, Side};

/// Steps of a trial; the first starts from rest, so that the later ones have something carried over.
const STEPS: usize = 4;

/// A part and what a trial has to know of it.
pub struct Trial<'a, P: LinearPart> {
    /// The part.
    pub part: &'a P,
    /// The state in which all numbers are zero.
    pub rest: P::State,
    /// Two loads and their sum, with the interface at the same place.
    pub loads: [P::Load; 3],
    /// Largest force at the interface, N or N·m.
    pub force: f64,
    /// Displacement of the interface in a state.
    pub displacement: &'a dyn Fn(&P::State) -> Vec<f64>,
    /// All numbers of a state, those of a unit together.
    pub numbers: &'a dyn Fn(&P::State) -> Vec<Vec<f64>>,
}

/// How far a part is from the rules, relative; rounding apart all are zero.
#[derive(Debug, Clone, Copy, Default)]
pub struct Deviations {
    /// Of the displacement at the interface after a step from `free + flexibility·forces`, against the sum of its terms.
    pub reached: f64,
    /// Of the flexibility from its transpose, and of the rows of held coordinates from zero.
    pub asymmetry: f64,
    /// Negative eigenvalues of the flexibility, its diagonal scaled to 1, against the largest.
    pub indefinite: f64,
    /// Of the state under two loads, and forces, together from the sum of the states under each.
    pub superposition: f64,
    /// Of a step, and of the state from which it starts, after another was tried from there and dropped.
    pub repetition: f64,
}

impl Deviations {
    /// The largest; not a number if one is not.
    pub fn largest(&self) -> f64 {
        [self.reached, self.asymmetry, self.indefinite, self.superposition, self.repetition]
            .into_iter()
            .fold(0.0, larger)
    }
}

/// The larger value, unlike `f64::max` not a number if either is not.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Forces of both signs that repeat in no simple way.
fn forces(count: usize, step: usize, largest: f64) -> Vec<f64> {
    (0..count).map(|i| largest * (1.3 * i as f64 + 2.1 * step as f64 + 0.5).sin()).collect()
}

impl<P: LinearPart> Trial<'_, P> {
    /// Takes a few steps under each load.
    pub fn deviations(&self) -> Deviations {
        let mut worst = Deviations::default();
        let size = self.size(&self.loads[0]);
        // the first forces turn around from step to step, the second do not
        let alone = |load: usize, step: usize| match load {
            0 => forces(size, step, self.force),
            _ => forces(size, 17, 0.7 * self.force),
        };
        let mut ends = Vec::new();
        for load in 0..3 {
            let mut state = None;
            for step in 0..STEPS {
                let applied: Vec<f64> = match load {
                    2 => alone(0, step).iter().zip(alone(1, step)).map(|(a, b)| a + b).collect(),
                    _ => alone(load, step),
                };
                state = Some(self.step(state.as_ref().unwrap_or(&self.rest), load, &applied, &mut worst));
            }
            ends.extend(state.map(|state| (self.numbers)(&state)));
        }
        for ((a, b), both) in ends[0].iter().zip(&ends[1]).zip(&ends[2]) {
            let scale = both.iter().fold(0.0, |m: f64, v| larger(m, v.abs()));
            for ((a, b), both) in a.iter().zip(b).zip(both) {
                worst.superposition = larger(worst.superposition, relative(both - (a + b), scale));
            }
        }
        worst
    }

    /// Number of coordinates of the interface.
    fn size(&self, load: &P::Load) -> usize {
        self.part.predict(&self.rest, load, &mut P::State::default()).free().len()
    }

    /// A step with all that can be seen of it.
    fn step(&self, state: &P::State, load: usize, applied: &[f64], worst: &mut Deviations) -> P::State {
        let (part, load) = (self.part, &self.loads[load]);
        let before = (self.numbers)(state);
        // the second step takes the memory of the first, and must not see what that left there
        let mut next = P::State::default();
        let tried = part.predict(state, load, &mut next);
        let free = tried.free().to_vec();
        tried.finish(&forces(free.len(), 5, 3.0 * self.force));
        let step = part.predict(state, load, &mut next);
        let same = before == (self.numbers)(state) && free == step.free();
        worst.repetition = larger(worst.repetition, if same { 0.0 } else { f64::INFINITY });
        let flexibility = step.flexibility();
        worst.asymmetry = larger(worst.asymmetry, asymmetry(flexibility));
        worst.indefinite = larger(worst.indefinite, indefinite(flexibility));
        let expected: Vec<(f64, f64)> = (0..free.len())
            .map(|i| {
                let terms = (0..free.len()).map(|j| flexibility[(i, j)] * applied[j]);
                terms.fold((free[i], free[i].abs()), |(sum, size), term| (sum + term, size + term.abs()))
            })
            .collect();
        step.finish(applied);
        let reached = (self.displacement)(&next);
        assert_eq!(reached.len(), expected.len(), "coordinates of the interface");
        for (reached, (expected, scale)) in reached.iter().zip(expected) {
            worst.reached = larger(worst.reached, relative(reached - expected, scale));
        }
        next
    }

    /// Largest deviation of the `energy` (J) of a state from the work of the forces at the interface over some steps from rest
    /// under `no_load`, relative to the largest energy. With average acceleration and without damping the
    /// trapezoidal rule makes it rounding.
    pub fn energy_defect(&self, no_load: &P::Load, energy: &dyn Fn(&P::State) -> f64) -> f64 {
        let size = self.size(no_load);
        let (mut state, mut work, mut defect, mut most) = (None, 0.0, 0.0, 0.0);
        let (mut force, mut place) = (vec![0.0; size], (self.displacement)(&self.rest));
        for step in 0..10 * STEPS {
            let now = forces(size, step, self.force);
            let next = self.part.advance(state.as_ref().unwrap_or(&self.rest), no_load, &now);
            let reached = (self.displacement)(&next);
            for i in 0..size {
                work += 0.5 * (force[i] + now[i]) * (reached[i] - place[i]);
            }
            defect = larger(defect, (energy(&next) - work).abs());
            most = larger(most, energy(&next));
            (state, force, place) = (Some(next), now, reached);
        }
        relative(defect, most)
    }
}

/// A deviation over its scale; one from a scale of zero is not small.
fn relative(deviation: f64, scale: f64) -> f64 {
    if deviation == 0.0 { 0.0 } else { deviation.abs() / scale }
}

fn asymmetry(matrix: MatRef<'_, f64>) -> f64 {
    let mut worst = 0.0;
    for i in 0..matrix.nrows() {
        for j in 0..matrix.ncols() {
            let scale = (matrix[(i, i)] * matrix[(j, j)]).sqrt();
            // a held coordinate has no scale, and nothing may stand in its row
            worst = larger(worst, relative(matrix[(i, j)] - matrix[(j, i)], scale));
            if scale == 0.0 {
                worst = larger(worst, relative(matrix[(i, j)], 0.0));
            }
        }
    }
    worst
}

fn indefinite(matrix: MatRef<'_, f64>) -> f64 {
    let free: Vec<usize> = (0..matrix.nrows()).filter(|&i| matrix[(i, i)] != 0.0).collect();
    let scaled = Mat::from_fn(free.len(), free.len(), |i, j| {
        let (i, j) = (free[i], free[j]);
        matrix[(i, j)] / (matrix[(i, i)].abs() * matrix[(j, j)].abs()).sqrt()
    });
    match scaled.self_adjoint_eigenvalues(Side::Lower) {
        Ok(values) => match (values.first(), values.last()) {
            (Some(least), Some(largest)) if *least < 0.0 => -least / largest.abs(),
            _ => 0.0,
        },
        Err(_) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::newmark::{Motion, Newmark};

    /// ROUNDOFF of a step with two numbers, relative.
    const ROUNDOFF: f64 = 1e-13;
    const MASS: f64 = 3.0;
    const STIFFNESS: f64 = 2e4;

    /// Which rule the oscillator breaks.
    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Fault {
        None,
        Flexibility,
        Asymmetry,
        Held,
        Negative,
        Quadratic,
        Memory,
        Damped,
    }

    /// A mass on a spring whose interface is its displacement, twice, and a held coordinate.
    struct Oscillator {
        scheme: Newmark,
        flexibility: Mat<f64>,
        fault: Fault,
        calls: std::cell::Cell<f64>,
    }

    struct OscillatorStep<'s> {
        part: &'s Oscillator,
        state: &'s Motion,
        next: &'s mut Motion,
        free: [f64; 3],
    }

    impl Oscillator {
        fn new(fault: Fault) -> Self {
            let scheme = Newmark::new(1e-3, if fault == Fault::Damped { 0.05 } else { 0.0 });
            let f = 1.0 / (STIFFNESS + MASS * scheme.acceleration);
            let mut flexibility = Mat::from_fn(3, 3, |i, j| if i < 2 && j < 2 { f } else { 0.0 });
            match fault {
                Fault::Flexibility => flexibility[(0, 0)] *= 1.001,
                Fault::Asymmetry => flexibility[(0, 1)] *= 1.001,
                Fault::Held => (flexibility[(2, 0)], flexibility[(0, 2)]) = (f, f),
                Fault::Negative => (flexibility[(1, 0)], flexibility[(0, 1)]) = (1.01 * f, 1.01 * f),
                _ => {}
            }
            Self { scheme, flexibility, fault, calls: std::cell::Cell::new(0.0) }
        }

        fn effective(&self) -> f64 {
            STIFFNESS + MASS * self.scheme.acceleration
        }
    }

    impl LinearPart for Oscillator {
        type State = Motion;
        type Load = f64;
        type Step<'s> = OscillatorStep<'s>;

        fn predict<'s>(&'s self, state: &'s Motion, load: &f64, next: &'s mut Motion) -> OscillatorStep<'s> {
            let mut right = load + MASS * self.scheme.inertia(state);
            match self.fault {
                Fault::Quadratic => right += 1e-3 * load * load,
                Fault::Memory => {
                    self.calls.set(self.calls.get() + 1.0);
                    right += self.calls.get();
                }
                _ => {}
            }
            let free = right / self.effective();
            OscillatorStep { part: self, state, next, free: [free, free, 0.0] }
        }
    }

    impl LinearStep for OscillatorStep<'_> {
        fn free(&self) -> &[f64] {
            &self.free
        }

        fn flexibility(&self) -> MatRef<'_, f64> {
            self.part.flexibility.as_ref()
        }

        fn finish(self, forces: &[f64]) {
            let u = self.free[0] + (forces[0] + forces[1]) / self.part.effective();
            *self.next = self.part.scheme.advance(self.state, u);
        }
    }

    fn trial(part: &Oscillator) -> Trial<'_, Oscillator> {
        Trial {
            part,
            rest: Motion::default(),
            loads: [100.0, -30.0, 70.0],
            force: 50.0,
            displacement: &|m| vec![m.u, m.u, 0.0],
            numbers: &|m| vec![vec![m.u], vec![m.v], vec![m.a]],
        }
    }

    fn energy(m: &Motion) -> f64 {
        0.5 * (MASS * m.v * m.v + STIFFNESS * m.u * m.u)
    }

    /// Goal: a mass on a spring obeys every rule, and keeps its energy.
    #[test]
    fn an_oscillator_obeys_the_rules() {
        let part = Oscillator::new(Fault::None);
        let found = trial(&part).deviations();
        assert!(found.largest() < ROUNDOFF, "{found:?}");
        let defect = trial(&part).energy_defect(&0.0, &energy);
        assert!(defect < ROUNDOFF, "{defect:e}");
    }

    /// Goal: each rule is seen to be broken, by its own deviation.
    #[test]
    fn a_part_that_breaks_a_rule_is_found() {
        let found = |fault| trial(&Oscillator::new(fault)).deviations();
        assert!(found(Fault::Flexibility).reached > 1e-5);
        assert!(found(Fault::Asymmetry).asymmetry > 1e-4);
        assert!(found(Fault::Held).asymmetry > 1e-4);
        assert!(found(Fault::Negative).indefinite > 1e-3);
        assert!(found(Fault::Quadratic).superposition > 1e-3);
        assert!(found(Fault::Memory).repetition > 1.0);
        let part = Oscillator::new(Fault::Damped);
        assert!(trial(&part).energy_defect(&0.0, &energy) > 1e-3);
    }
}
