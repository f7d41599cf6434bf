//! The factor of a chain of elements, from both of its ends.
//!
//! The matrix of such a chain is block-tridiagonal: a node meets its two neighbours only. Elimination from either end towards a node
//! leaves that node's own equations. With both stored, a right-hand side is eliminated towards the node where
//! forces are still to come, and substituted back from there: one pass each way, and the flexibility at that place needs no solution.
//! Which node that is may change with every right-hand side.

use nalgebra::SMatrix;

/// Degrees of freedom of a node that take part in bending and torsion.
pub const NODE: usize = 5;
/// Displacements of a node along the section's y and z, and its rotations about x, y and z.
pub type Node = [f64; NODE];
pub(super) type Block = SMatrix<f64, NODE, NODE>;

/// An element's matrix by its nodes, each with `N` degrees of freedom: first with first, first with second, second with second.
pub type ElementBlocks<const N: usize = NODE> = [SMatrix<f64, N, N>; 3];

/// What stands at a degree of freedom: a number, or those of two chains alike that are solved side by side.
pub trait Entry: Copy {
    /// Nothing.
    const ZERO: Self;

    /// Adds `factor` times a value.
    fn add(&mut self, factor: f64, value: &Self);

    /// Takes a value away.
    fn subtract(&mut self, value: &Self);

    /// Makes zero of what is too small to count.
    fn flush(&mut self);
}

impl Entry for f64 {
    const ZERO: Self = 0.0;

    #[inline]
    fn add(&mut self, factor: f64, value: &Self) {
        *self += value * factor;
    }

    #[inline]
    fn subtract(&mut self, value: &Self) {
        *self -= value;
    }

    #[inline]
    fn flush(&mut self) {
        *self = if self.abs() < NOTHING { 0.0 } else { *self };
    }
}

impl Entry for [f64; 2] {
    const ZERO: Self = [0.0; 2];

    #[inline]
    fn add(&mut self, factor: f64, value: &Self) {
        (0..2).for_each(|side| self[side].add(factor, &value[side]));
    }

    #[inline]
    fn subtract(&mut self, value: &Self) {
        (0..2).for_each(|side| self[side].subtract(&value[side]));
    }

    #[inline]
    fn flush(&mut self) {
        self.iter_mut().for_each(Entry::flush);
    }
}

/// A factored chain.
#[derive(Debug, Clone)]
pub struct ChainFactor<const N: usize = NODE> {
    elements: Elements<N>,
    held: [[bool; N]; 2],
    /// Elimination from the first node on, and from the last.
    sweeps: [Sweep<N>; 2],
}

/// The matrices of all elements.
#[derive(Debug, Clone)]
enum Elements<const N: usize> {
    /// All have this one, and there are so many.
    Equal(ElementBlocks<N>, usize),
    /// One after the other.
    Each(Vec<ElementBlocks<N>>),
}

impl<const N: usize> Elements<N> {
    fn count(&self) -> usize {
        match self {
            Self::Equal(_, count) => *count,
            Self::Each(all) => all.len(),
        }
    }

    fn at(&self, element: usize) -> &ElementBlocks<N> {
        match self {
            Self::Equal(one, _) => one,
            Self::Each(all) => &all[element],
        }
    }
}

/// Elimination from one end, a link for each node in turn. With inertia the end is forgotten after some elements: the links repeat to
/// the last bit, one or a few in turn, and those that follow are not stored. Where elements differ, links of equal supports at equal distances repeat: each is stored once.
#[derive(Debug, Clone)]
struct Sweep<const N: usize> {
    links: Vec<Link<N>>,
    /// How many of the last links repeat.
    period: usize,
    /// Where elements differ, the number of each node's link.
    numbers: Vec<u32>,
}

/// Longest period that is looked for: rounding makes few links go round.
const MOST_IN_TURN: usize = 16;

/// Elements differ that many nodes back at most where links are looked for that repeat: more than lie between two sleepers.
const MOST_BETWEEN: usize = 32;

/// The elimination of a node into the next.
#[derive(Debug, Clone, PartialEq)]
struct Link<const N: usize> {
    /// Inverse of the node's equations; zero where it is held.
    inverse: SMatrix<f64, N, N>,
    /// What the node takes of its predecessor's right-hand side, and the transpose.
    carried: SMatrix<f64, N, N>,
    carried_back: SMatrix<f64, N, N>,
}

/// The place towards which a right-hand side is eliminated: an element, by its first node, and two rows of numbers for its nodes.
#[derive(Debug, Clone, Copy)]
pub struct Meeting<const N: usize = NODE> {
    element: usize,
    /// Inverse of the equations of the first node, when all others are eliminated, and of those of the second before
    /// it is eliminated into the first.
    inverses: [SMatrix<f64, N, N>; 2],
    carried: SMatrix<f64, N, N>,
    carried_back: SMatrix<f64, N, N>,
}

impl<const N: usize> ChainFactor<N> {
    /// Factors `elements` elements with the matrix `element`, the ends held as `held`; none if the matrix is not positive definite.
    pub fn new(element: ElementBlocks<N>, elements: usize, held: [[bool; N]; 2]) -> Option<Self> {
        Self::of(Elements::Equal(element, elements), held)
    }

    /// Factors elements with a matrix each, the ends held as `held`; none if the matrix is not positive definite or there is no element.
    pub fn of_elements(elements: Vec<ElementBlocks<N>>, held: [[bool; N]; 2]) -> Option<Self> {
        if elements.is_empty() { None } else { Self::of(Elements::Each(elements), held) }
    }

    fn of(elements: Elements<N>, held: [[bool; N]; 2]) -> Option<Self> {
        let from_first = Sweep::new(&elements, &held[0], false)?;
        let from_last = Sweep::new(&elements, &held[1], true)?;
        Some(Self { elements, held, sweeps: [from_first, from_last] })
    }

    /// The equations of the nodes of an element, all others eliminated.
    pub fn meeting(&self, element: usize) -> Meeting<N> {
        let count = self.elements.count();
        let [first, across, _] = self.elements.at(element);
        let [left, right] = [self.sweeps[0].link(element), self.sweeps[1].link(count - element)];
        let mut own = *first;
        if element > 0 {
            let [_, before, second] = self.elements.at(element - 1);
            own += second - left.carried * before;
        }
        own -= right.carried * across.transpose();
        let held = if element == 0 { self.held[0] } else { [false; N] };
        let beyond = self.sweeps[1].link(count - element - 1);
        Meeting {
            element,
            // the matrix is positive definite, and so is what elimination leaves of it
            inverses: [inverse(own, &held).unwrap_or_else(SMatrix::zeros), beyond.inverse],
            carried: right.carried,
            carried_back: right.carried_back,
        }
    }

    /// Eliminates a right-hand side, one entry a node, towards the first node of the element.
    pub fn forward<V: Entry>(&self, meeting: &Meeting<N>, nodes: &mut [[V; N]]) {
        let (left, right) = nodes.split_at_mut(meeting.element + 1);
        self.sweeps[0].forward(left.iter_mut());
        self.sweeps[1].forward(right.iter_mut().rev());
        let taken = product(&meeting.carried, &right[0]);
        subtract(&mut left[meeting.element], &taken);
    }

    /// Substitutes back what [`Self::forward`] has eliminated.
    pub fn backward<V: Entry>(&self, meeting: &Meeting<N>, nodes: &mut [[V; N]]) {
        let first = meeting.element;
        let (left, right) = nodes.split_at_mut(first + 1);
        [left[first], right[0]] = meeting.solution(&left[first], &right[0]);
        self.sweeps[0].backward(first, left.iter_mut().rev());
        self.sweeps[1].backward(self.elements.count() - first - 1, right.iter_mut());
    }
}

impl<const N: usize> Sweep<N> {
    /// From the first node on, or from the last (`backwards`), whose node is held as `held`.
    fn new(elements: &Elements<N>, held: &[bool; N], backwards: bool) -> Option<Self> {
        let count = elements.count();
        // the elements in the order of the sweep, with their nodes in that order, too
        let element = |number: usize| {
            let [first, across, second] = elements.at(if backwards { count - 1 - number } else { number });
            if backwards { (second, *across, first) } else { (first, across.transpose(), second) }
        };
        let end = inverse(*element(0).0, held)?;
        let at_end = Link { inverse: end, carried: SMatrix::zeros(), carried_back: SMatrix::zeros() };
        let mut links = vec![at_end];
        let mut numbers: Vec<u32> = match elements {
            Elements::Equal(..) => Vec::new(),
            Elements::Each(_) => vec![0],
        };
        for node in 1..=count {
            let before = numbers.last().map_or(node - 1, |number| *number as usize);
            // what belongs of a node's equations to its predecessor
            let (_, towards, own) = element(node - 1);
            let carried = towards * links[before].inverse;
            // nothing follows the last node: its link is only carried to, and any positive equations do
            let following = element(node.min(count - 1)).0;
            let left = own + following - carried * towards.transpose();
            let inverse = inverse(left, &[false; N])?;
            let link = Link { inverse, carried, carried_back: carried.transpose() };
            if let Elements::Equal(..) = elements
                && let Some(back) = links.iter().rev().take(MOST_IN_TURN).position(|known| *known == link)
            {
                return Some(Self { links, period: back + 1, numbers });
            }
            if let Elements::Each(_) = elements {
                let known =
                    numbers.iter().rev().take(MOST_BETWEEN).find(|known| links[**known as usize] == link);
                if let Some(&known) = known {
                    numbers.push(known);
                    continue;
                }
                numbers.push(links.len() as u32);
            }
            links.push(link);
        }
        Some(Self { links, period: 1, numbers })
    }

    fn link(&self, node: usize) -> &Link<N> {
        &self.links[self.stored(node)]
    }

    /// Where the link of a node is stored.
    fn stored(&self, node: usize) -> usize {
        if let Some(number) = self.numbers.get(node) {
            return *number as usize;
        }
        let stored = self.links.len();
        if node < stored { node } else { stored - self.period + (node - stored) % self.period }
    }

    fn forward<'a, V: Entry + 'a>(&self, nodes: impl Iterator<Item = &'a mut [V; N]>) {
        let mut before = [V::ZERO; N];
        if !self.numbers.is_empty() {
            for (node, number) in nodes.zip(&self.numbers) {
                subtract(node, &product(&self.links[*number as usize].carried, &before));
                flush(node);
                before = *node;
            }
            return;
        }
        let mut at = 0;
        for node in nodes {
            subtract(node, &product(&self.links[at].carried, &before));
            flush(node);
            before = *node;
            at += 1;
            if at == self.links.len() {
                at -= self.period;
            }
        }
    }

    /// From the node `start`, which has its value, back to the end.
    fn backward<'a, V: Entry + 'a>(&self, start: usize, mut nodes: impl Iterator<Item = &'a mut [V; N]>) {
        let Some(mut after) = nodes.next().copied() else { return };
        let mut substitute = |own: &Link<N>, next: &Link<N>, node: &mut [V; N]| {
            let mut value = product(&own.inverse, node);
            subtract(&mut value, &product(&next.carried_back, &after));
            flush(&mut value);
            *node = value;
            after = value;
        };
        if let Some(numbers) = self.numbers.get(..=start) {
            let mut next = &self.links[numbers[start] as usize];
            for (number, node) in numbers[..start].iter().rev().zip(nodes) {
                let own = &self.links[*number as usize];
                substitute(own, next, node);
                next = own;
            }
            return;
        }
        let (stored, first_of_turn) = (self.links.len(), self.links.len() - self.period);
        let mut at = self.stored(start);
        for (from_end, node) in (0..start).rev().zip(nodes) {
            let next = &self.links[at];
            at = if from_end + 1 >= stored && at == first_of_turn { stored - 1 } else { at - 1 };
            substitute(&self.links[at], next, node);
        }
    }
}

impl<const N: usize> Meeting<N> {
    /// The element.
    pub fn element(&self) -> usize {
        self.element
    }

    /// What a right-hand side at both nodes is when the second is eliminated into the first.
    pub fn eliminated<V: Entry>(&self, [first, second]: &[[V; N]; 2]) -> [[V; N]; 2] {
        let mut first = *first;
        subtract(&mut first, &product(&self.carried, second));
        [first, *second]
    }

    /// Forces at the nodes, as [`Self::eliminated`], over the matrix: times the rows of a displacement, eliminated as well, it is that under the forces.
    pub fn over<V: Entry>(&self, forces: &[[V; N]; 2]) -> [[V; N]; 2] {
        [0, 1].map(|node| product(&self.inverses[node], &forces[node]))
    }

    /// The values of both nodes, from right-hand sides as [`Self::eliminated`].
    fn solution<V: Entry>(&self, first: &[V; N], second: &[V; N]) -> [[V; N]; 2] {
        let first = product(&self.inverses[0], first);
        let mut second = product(&self.inverses[1], second);
        subtract(&mut second, &product(&self.carried_back, &first));
        [first, second]
    }
}

/// A matrix times the entries of a node.
#[inline]
pub fn product<V: Entry, const N: usize>(matrix: &SMatrix<f64, N, N>, vector: &[V; N]) -> [V; N] {
    let mut sum = [V::ZERO; N];
    for (column, value) in matrix.data.0.iter().zip(vector) {
        for (sum, factor) in sum.iter_mut().zip(column) {
            sum.add(*factor, value);
        }
    }
    sum
}

#[inline]
fn subtract<V: Entry, const N: usize>(from: &mut [V; N], value: &[V; N]) {
    from.iter_mut().zip(value).for_each(|(from, value)| from.subtract(value));
}

/// What is smaller is zero: motion fades along the beam, and numbers of less than the usual number of digits take a hundred times as long.
const NOTHING: f64 = 1e-200;

#[inline]
fn flush<V: Entry, const N: usize>(node: &mut [V; N]) {
    node.iter_mut().for_each(Entry::flush);
}

/// Inverse of a symmetric matrix in the coordinates that are not held, zero in the others, by Gauss-Jordan elimination; none if the matrix is
/// not positive definite.
pub(super) fn inverse<const N: usize>(
    mut matrix: SMatrix<f64, N, N>,
    held: &[bool; N],
) -> Option<SMatrix<f64, N, N>> {
    let free = || (0..N).filter(|&i| !held[i]);
    for k in free() {
        let pivot = matrix[(k, k)];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        for j in free().filter(|&j| j != k) {
            matrix[(k, j)] /= pivot;
        }
        for i in free().filter(|&i| i != k) {
            let factor = matrix[(i, k)];
            for j in free().filter(|&j| j != k) {
                matrix[(i, j)] -= factor * matrix[(k, j)];
            }
            matrix[(i, k)] = -factor / pivot;
        }
        matrix[(k, k)] = 1.0 / pivot;
    }
    let kept =
        |i: usize, j: usize| if held[i] || held[j] { 0.0 } else { 0.5 * (matrix[(i, j)] + matrix[(j, i)]) };
    Some(SMatrix::from_fn(kept))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector, SVector};

    /// Condition of the matrices below, up to 1e4, times 1e-16, a factor of a hundred spare.
    const ROUNDOFF: f64 = 1e-10;

    /// An element with `inertia` whose stiffness is that of unequal springs between all of its degrees of freedom.
    fn element(inertia: f64) -> ElementBlocks {
        let spring = Block::from_fn(|i, j| {
            if i == j { 3.0 + i as f64 } else { 0.2 * ((i * j) as f64).sin() + 0.1 * (i + j) as f64 }
        });
        let mass = Block::identity() * inertia;
        [spring + mass, -spring, spring + mass]
    }

    fn dense(element: &ElementBlocks, elements: usize, held: [[bool; NODE]; 2]) -> DMatrix<f64> {
        let size = NODE * (elements + 1);
        let mut sum = DMatrix::zeros(size, size);
        for first in (0..NODE * elements).step_by(NODE) {
            let [own, across, next] = element;
            for (i, j, block) in [(0, 0, *own), (0, 5, *across), (5, 0, across.transpose()), (5, 5, *next)] {
                let mut part = sum.fixed_view_mut::<NODE, NODE>(first + i, first + j);
                part += block;
            }
        }
        for (end, from) in [(0, 0), (1, size - NODE)] {
            for i in (0..NODE).filter(|&i| held[end][i]) {
                sum.row_mut(from + i).fill(0.0);
                sum.column_mut(from + i).fill(0.0);
                sum[(from + i, from + i)] = f64::INFINITY;
            }
        }
        sum
    }

    /// Source: the dense inverse, in which held unknowns have none. Goal: solutions and the displacement of rows under forces, whichever element a right-hand side is
    /// eliminated towards, for one element and for forty, with inertia such that most links repeat and without any, with free ends and
    /// partly held ones. Accuracy: ROUNDOFF.
    #[test]
    fn solutions_are_those_of_the_dense_matrix() {
        let all = [true; NODE];
        let some = [true, false, true, false, false];
        for (elements, inertia, held) in [
            (1, 0.0, [all, [false; NODE]]),
            (1, 0.5, [some, some]),
            (40, 0.0, [all, some]),
            (40, 3.0, [[false; NODE], some]),
            (40, 30.0, [some, all]),
        ] {
            let element = element(inertia);
            let factor = ChainFactor::new(element, elements, held).unwrap();
            let stored = factor.sweeps.iter().map(|sweep| sweep.links.len()).sum::<usize>() / 2;
            assert_eq!(stored <= elements, inertia > 0.0 && elements > 1, "{stored} links");
            let matrix = dense(&element, elements, held);
            let free: Vec<usize> = (0..matrix.nrows()).filter(|&i| matrix[(i, i)].is_finite()).collect();
            let reduced = DMatrix::from_fn(free.len(), free.len(), |i, j| matrix[(free[i], free[j])]);
            let inverse = reduced.try_inverse().unwrap();
            let dense_solution = |right: &[Node]| {
                let right = DVector::from_fn(free.len(), |i, _| right.as_flattened()[free[i]]);
                let mut solution = DVector::zeros(matrix.nrows());
                (&inverse * right).iter().zip(&free).for_each(|(value, &i)| solution[i] = *value);
                solution
            };
            let right: Vec<Node> =
                (0..=elements).map(|n| std::array::from_fn(|i| ((7 * n + 3 * i) as f64).sin())).collect();
            let expected = dense_solution(&right);
            for towards in [0, 1, elements / 2, elements - 1].into_iter().filter(|&e| e < elements) {
                let meeting = factor.meeting(towards);
                assert_eq!(meeting.element(), towards);
                let mut nodes = right.clone();
                factor.forward(&meeting, &mut nodes);
                factor.backward(&meeting, &mut nodes);
                let off = nodes.as_flattened().iter().zip(&expected).map(|(a, b)| (a - b).abs());
                let off = off.fold(0.0, f64::max);
                assert!(off < ROUNDOFF * expected.amax(), "{elements} {inertia} {towards}: {off:e}");
                // rows and forces at the nodes of the element alone
                let [rows, forces] = [0.3, 1.7]
                    .map(|phase| [0, 1].map(|n| std::array::from_fn(|i| (phase + (5 * n + i) as f64).cos())));
                let mut loaded = vec![[0.0; NODE]; elements + 1];
                loaded[towards..towards + 2].copy_from_slice(&forces);
                let solution = dense_solution(&loaded);
                let moved: f64 = (0..2)
                    .map(|n| SVector::from(rows[n]).dot(&solution.fixed_rows::<NODE>(NODE * (towards + n))))
                    .sum();
                let over = meeting.over(&meeting.eliminated(&forces));
                let rows = meeting.eliminated(&rows);
                let found: f64 =
                    rows.as_flattened().iter().zip(over.as_flattened()).map(|(a, b)| a * b).sum();
                assert!((found - moved).abs() < ROUNDOFF * solution.amax(), "{found} {moved}");
            }
        }
    }

    /// Goal: a matrix that is not positive definite has no factor: free ends without inertia in the limit of an element that is negative, and numbers that are none.
    #[test]
    fn a_matrix_without_a_factor_is_none() {
        let negative = element(-20.0);
        assert!(ChainFactor::new(negative, 5, [[false; NODE]; 2]).is_none());
        let mut unknown = element(1.0);
        unknown[1][(2, 2)] = f64::NAN;
        assert!(ChainFactor::new(unknown, 5, [[true; NODE]; 2]).is_none());
    }

    /// Goal: motion that fades along a chain ends in zeros, not in numbers of less than the usual number of digits.
    #[test]
    fn what_fades_ends_in_zeros() {
        let factor = ChainFactor::new(element(30.0), 4000, [[false; NODE]; 2]).unwrap();
        let meeting = factor.meeting(10);
        let mut nodes = vec![[0.0; NODE]; 4001];
        nodes[10] = [1.0; NODE];
        factor.forward(&meeting, &mut nodes);
        factor.backward(&meeting, &mut nodes);
        assert!(nodes[9].iter().all(|value| value.abs() > 1e-4));
        assert_eq!(nodes[4000], [0.0; NODE]);
        assert!(nodes.as_flattened().iter().all(|value| *value == 0.0 || value.abs() >= NOTHING));
    }
}
