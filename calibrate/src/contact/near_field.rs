//! Half-spaces on a uniform grid: the matrix by look-ups in a table, products by a convolution.

use super::convolution::{Convolution, Spectrum};
use super::half_space::{Factors, HalfSpace, HatTable, sum_of_factors};
use super::operator::ComplianceOperator;
use super::point::{ALONG, ContactPoint};
use super::strips::Strips;
use faer::Mat;
use nalgebra::Vector2;
use std::sync::Arc;

/// Number of a point, and its place in a strip.
type Member = (usize, (usize, usize));

/// Half-spaces between points of a uniform grid.
pub struct NearField {
    factors: Factors,
    directions: usize,
    /// Corner of the grid's rectangle that holds all points.
    corner: (usize, usize),
    /// Place of every point from that corner; of half of a mirror image, from its middle line.
    places: Vec<(usize, usize)>,
    /// Lines of the rectangle along the profile and the track, with the mirror image.
    extent: (usize, usize),
    /// Means between the hats of the grid over the rectangle.
    table: HatTable,
    /// The strips of the rectangle's lines in which there are points.
    strips: Strips,
    /// By strip, the numbers of its points and their places in it.
    members: Arc<Vec<Vec<Member>>>,
    /// That of a strip.
    convolution: Arc<Convolution>,
    /// Whether each point stands for its mirror image along the track, too: a force is then what both carry together.
    is_half: bool,
}

impl NearField {
    /// The half-spaces `bodies` between `points` of a uniform grid with `directions` (1 or 3) unknowns a point.
    pub fn new(bodies: &[HalfSpace], points: &[ContactPoint], directions: usize) -> Self {
        let cell = points.first().map_or_else(Default::default, |point| point.widths);
        Self::on_grid(cell, bodies, points, directions)
    }

    /// As [`Self::new`] on a grid with spacings `cell`, m.
    pub fn on_grid(
        cell: Vector2<f64>,
        bodies: &[HalfSpace],
        points: &[ContactPoint],
        directions: usize,
    ) -> Self {
        let places = points.iter().map(|point| point.index).collect();
        Self::at(cell, sum_of_factors(bodies), places, directions, false)
    }

    /// That of points at `places` of the grid; of half of a mirror image, from its middle line.
    fn at(
        cell: Vector2<f64>,
        factors: Factors,
        mut places: Vec<(usize, usize)>,
        directions: usize,
        is_half: bool,
    ) -> Self {
        let low = |pick: fn(&(usize, usize)) -> usize| places.iter().map(pick).min().unwrap_or(0);
        let corner = (low(|place| place.0), if is_half { 0 } else { low(|place| place.1) });
        places.iter_mut().for_each(|place| *place = (place.0 - corner.0, place.1 - corner.1));
        let lines =
            |pick: fn(&(usize, usize)) -> usize| places.iter().map(pick).max().map_or(0, |last| last + 1);
        let columns = lines(|place| place.1);
        let extent =
            (lines(|place| place.0), if is_half { (2 * columns).saturating_sub(1) } else { columns });
        let strips = Strips::of(places.iter().map(|place| place.0), corner.0);
        let convolution = Convolution::shared(cell, (strips.lines(), extent.1));
        let table = match strips.count() {
            1 => convolution.table.clone(),
            _ => HatTable::shared(cell, (strips.reach() + convolution.lines(), convolution.columns())),
        };
        let mut members = vec![Vec::new(); strips.count()];
        for (j, &(line, column)) in places.iter().enumerate() {
            let (strip, within) = strips.place(line);
            members[strip].push((j, (within, column)));
        }
        let members = Arc::new(members);
        Self { factors, directions, corner, places, extent, table, strips, members, convolution, is_half }
    }

    /// The half-spaces between the `points` on the middle line and ahead of it, each for its mirror image as well; a point in the middle does not move
    /// along the track. None where there is no middle line.
    pub(super) fn half(&self, points: &[usize]) -> Option<Self> {
        let middle = (self.extent.1 % 2 == 1).then_some(self.extent.1 / 2)?;
        let place = |j: &usize| Some((self.places[*j].0, self.places[*j].1.checked_sub(middle)?));
        let places = points.iter().map(place).collect::<Option<_>>()?;
        Some(Self::at(self.cell(), self.factors, places, self.directions, true))
    }

    /// Whether a row is that of a point in the middle of a mirror image along the track.
    pub(super) fn rests(&self, row: usize) -> bool {
        self.is_half && row / self.places.len() == ALONG && self.places[row % self.places.len()].1 == 0
    }

    /// Transform of the values of a strip's points in a direction.
    fn transform(&self, direction: usize, strip: usize, value: impl Fn(usize) -> f64) -> Spectrum {
        let values = self.members[strip].iter().map(|(j, place)| (*place, value(*j)));
        if self.is_half {
            self.convolution.mirrored().transform(direction, values)
        } else {
            self.convolution.transform(values)
        }
    }

    /// The values in a direction at the points of a strip whose `spectrum` it is, by their number.
    fn back(&self, direction: usize, strip: usize, spectrum: Spectrum, each: impl FnMut(usize, f64)) {
        let places = self.members[strip].iter().copied();
        if self.is_half {
            self.convolution.mirrored().back(direction, spectrum, self.strips.lines(), places, each);
        } else {
            self.convolution.back(spectrum, self.strips.lines(), places, each);
        }
    }

    /// Adds to the spectrum `sum` of a strip and direction what the forces of another strip and direction move there, whose `spectrum` is given.
    fn add(
        &self,
        (to, to_strip): (usize, usize),
        (from, from_strip): (usize, usize),
        spectrum: &Spectrum,
        sum: &mut Spectrum,
    ) {
        let Self { convolution, factors, .. } = self;
        let directions = (to, from);
        let apart = (self.strips.apart(to_strip, from_strip), &self.table);
        match (to_strip == from_strip, self.is_half) {
            (true, false) => convolution.add(factors, directions, spectrum, sum),
            (true, true) => convolution.add_mirrored(factors, directions, spectrum, sum),
            (false, false) => convolution.add_apart(apart, factors, directions, spectrum, sum),
            (false, true) => convolution.add_apart_mirrored(apart, factors, directions, spectrum, sum),
        }
    }

    fn cell(&self) -> Vector2<f64> {
        self.table.cell
    }

    /// The half-spaces between some of the points, by their places in the list.
    pub fn between(&self, points: &[usize]) -> Self {
        let places = points.iter().map(|&j| self.places[j]).collect();
        let mut between = Self::at(self.cell(), self.factors, places, self.directions, self.is_half);
        between.corner = (between.corner.0 + self.corner.0, between.corner.1 + self.corner.1);
        between
    }

    /// Displacements at the nodes `wanted` of the grid, by direction and node, m, under forces on the points `carrying`, by direction and
    /// place in that list, N.
    pub fn seen_from(
        &self,
        carrying: &[usize],
        wanted: &[(usize, usize)],
        force: impl Fn(usize) -> f64,
    ) -> Vec<f64> {
        let (n, m) = (carrying.len(), wanted.len());
        if n == 0 || m == 0 {
            return vec![0.0; self.directions * m];
        }
        let corner = self.corner;
        let grid = |place: (usize, usize)| (place.0 + corner.0, place.1 + corner.1);
        let places = carrying.iter().map(|&j| grid(self.places[j])).chain(wanted.iter().copied()).collect();
        let both = Self::at(self.cell(), self.factors, places, self.directions, false);
        let all = n + m;
        let mut forces = vec![0.0; self.directions * all];
        for row in 0..self.directions * n {
            forces[row / n * all + row % n] = force(row);
        }
        let mut motion = vec![0.0; forces.len()];
        both.add_product(&forces, &mut motion);
        (0..self.directions).flat_map(|d| motion[d * all + n..(d + 1) * all].iter().copied()).collect()
    }

    /// The half-spaces in the normal direction alone.
    pub fn in_normal_direction(&self) -> Self {
        let Self { places, table, strips, members, convolution, .. } = self;
        Self {
            directions: 1,
            places: places.clone(),
            table: table.clone(),
            strips: strips.clone(),
            members: members.clone(),
            convolution: convolution.clone(),
            ..*self
        }
    }

    /// Compliance of `bodies` under `forces` on the points: fᵀ·N·f, m·N.
    pub fn quadratic(&self, bodies: &[HalfSpace], forces: &[f64]) -> f64 {
        let n = self.places.len();
        let loaded: Vec<usize> =
            (0..n).filter(|&j| (0..self.directions).any(|d| forces[d * n + j] != 0.0)).collect();
        let places = loaded.iter().map(|&j| self.places[j]).collect();
        let near = Self::at(self.cell(), sum_of_factors(bodies), places, self.directions, false);
        let forces: Vec<f64> =
            (0..self.directions).flat_map(|d| loaded.iter().map(move |&j| forces[d * n + j])).collect();
        let mut motion = vec![0.0; forces.len()];
        near.add_product(&forces, &mut motion);
        motion.iter().zip(&forces).map(|(u, f)| u * f).sum()
    }

    /// Whether the directions see each other: without `coupling` the normal and the tangential ones do not.
    fn couples(factors: &Factors, to: usize, from: usize) -> bool {
        (to == 0) == (from == 0) || factors.coupling != 0.0
    }

    /// One value of the matrix.
    pub fn value(&self, row: usize, column: usize) -> f64 {
        let n = self.places.len();
        let (to, from) = (row / n, column / n);
        if !Self::couples(&self.factors, to, from) {
            return 0.0;
        }
        let (a, b) = (self.places[row % n], self.places[column % n]);
        let at =
            |along: isize| self.factors.entry(&self.table.at((a.0 as isize - b.0 as isize, along)), to, from);
        let (ahead, beside) = (a.1 as isize, b.1 as isize);
        let value = at(ahead - beside);
        if !self.is_half || beside == 0 {
            return if (self.rests(row) || self.rests(column)) && row != column { 0.0 } else { value };
        }
        let twin = at(ahead + beside);
        0.5 * if from == ALONG { value - twin } else { value + twin }
    }

    /// The values between `rows`, for many of them.
    pub fn values(&self, rows: &[usize]) -> Values {
        let (n, d) = (self.places.len(), self.directions);
        let (lines, columns) = self.extent;
        let width = (2 * columns).saturating_sub(1);
        let placed = |&row: &usize| Placed {
            direction: row / n,
            line: self.places[row % n].0 * width,
            column: self.places[row % n].1,
            rests: self.rests(row),
        };
        let rows: Vec<Placed> = rows.iter().map(placed).collect();
        let mut there = vec![false; d];
        rows.iter().for_each(|row| there[row.direction] = true);
        let offset = |t: usize| {
            let (i, k) = (t / width, t % width);
            (i as isize - (lines as isize - 1), k as isize - (columns as isize - 1))
        };
        let table = |to: usize, from: usize| {
            (there[to] && there[from] && Self::couples(&self.factors, to, from)).then(|| {
                let at = |t| self.factors.entry(&self.table.at(offset(t)), to, from);
                (0..(2 * lines).saturating_sub(1) * width).map(at).collect()
            })
        };
        let tables = (0..d * d).map(|t| table(t / d, t % d)).collect();
        Values {
            rows,
            directions: d,
            middle: lines.saturating_sub(1) * width + columns.saturating_sub(1),
            tables,
            is_half: self.is_half,
        }
    }
}

/// Values of the matrix between some of its rows: a table over the signed offsets for each pair of directions.
pub struct Values {
    rows: Vec<Placed>,
    directions: usize,
    /// Place of the offset zero.
    middle: usize,
    tables: Vec<Option<Vec<f64>>>,
    /// Whether the points stand for their mirror images, too.
    is_half: bool,
}

/// Place of a row in the tables.
#[derive(Clone, Copy)]
struct Placed {
    direction: usize,
    /// Of the first column of the line along the profile.
    line: usize,
    column: usize,
    rests: bool,
}

impl Values {
    /// The value between two rows, by their places in the list.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        let (to, from) = (self.rows[row], self.rows[column]);
        let Some(table) = &self.tables[to.direction * self.directions + from.direction] else { return 0.0 };
        let line = self.middle + to.line - from.line + to.column;
        if !self.is_half || from.column == 0 {
            return if (to.rests || from.rests) && row != column { 0.0 } else { table[line - from.column] };
        }
        let (value, twin) = (table[line - from.column], table[line + from.column]);
        0.5 * if from.direction == ALONG { value - twin } else { value + twin }
    }
}

impl ComplianceOperator for NearField {
    fn rows(&self) -> usize {
        self.directions * self.places.len()
    }

    fn among(&self, points: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        Some(Box::new(self.between(points)))
    }

    fn normal(&self) -> Option<Box<dyn ComplianceOperator + '_>> {
        Some(Box::new(self.in_normal_direction()))
    }

    fn nearly_inverse(&self, direction: usize, motion: &[f64]) -> Option<Vec<f64>> {
        // just these if the grid were endless, and the points beyond moved by nothing
        let weight = |place: &(usize, usize)| if self.is_half && place.1 > 0 { 2.0 } else { 1.0 };
        let mut forces = vec![0.0; motion.len()];
        // strips that are apart see little of each other
        for strip in 0..self.strips.count() {
            let mut spectrum = self.transform(direction, strip, |j| weight(&self.places[j]) * motion[j]);
            if self.is_half {
                self.convolution.divide_mirrored(&self.factors, direction, &mut spectrum);
            } else {
                self.convolution.divide(&self.factors, direction, &mut spectrum);
            }
            self.back(direction, strip, spectrum, |j, force| forces[j] = weight(&self.places[j]) * force);
        }
        Some(forces)
    }

    fn diagonal(&self, row: usize) -> f64 {
        self.value(row, row)
    }

    fn add_column(&self, row: usize, force: f64, motion: &mut [f64]) {
        motion.iter_mut().enumerate().for_each(|(other, m)| *m += self.value(other, row) * force);
    }

    fn block(&self, rows: &[usize]) -> Mat<f64> {
        let values = self.values(rows);
        Mat::from_fn(rows.len(), rows.len(), |r, c| values.at(r, c))
    }

    fn add_product(&self, forces: &[f64], motion: &mut [f64]) {
        let n = self.places.len();
        let d = self.directions;
        let acting: Vec<((usize, usize), Spectrum)> = (0..d)
            .flat_map(|from| (0..self.strips.count()).map(move |strip| (from, strip)))
            .filter_map(|(from, strip)| {
                let part = &forces[from * n..(from + 1) * n];
                let acts = self.members[strip].iter().any(|(j, _)| part[*j] != 0.0);
                acts.then(|| ((from, strip), self.transform(from, strip, |j| part[j])))
            })
            .collect();
        for to in 0..d {
            let seen = |from: usize| Self::couples(&self.factors, to, from);
            if !acting.iter().any(|((from, _), _)| seen(*from)) {
                continue;
            }
            let rows = &mut motion[to * n..(to + 1) * n];
            for strip in 0..self.strips.count() {
                let mut sum =
                    if self.is_half { self.convolution.mirrored().zero() } else { self.convolution.zero() };
                for (from, spectrum) in acting.iter().filter(|((from, _), _)| seen(*from)) {
                    self.add((to, strip), *from, spectrum, &mut sum);
                }
                self.back(to, strip, sum, |j, value| rows[j] += value);
            }
        }
        for row in (ALONG * n..motion.len()).filter(|row| self.rests(*row)) {
            motion[row] += self.value(row, row) * forces[row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::point::{Side, flat_grid};
    use super::super::{Compliance, total};
    use super::*;

    /// Source: the half-spaces as a dense matrix. Goal: products and look-ups of points in strips far apart are those of the matrix; those of
    /// half of a mirror image are those of the whole. The approximate inverse of a strip moves no other. Accuracy over the largest: ROUNDOFF, and BEYOND for the inverse.
    #[test]
    fn products_pass_over_empty_lines() {
        const ROUNDOFF: f64 = 1e-11;
        const BEYOND: f64 = 0.25;
        let mut points = flat_grid((90, 9), 0.4e-3, |_, _| 0.0);
        points.retain(|point| {
            let (line, column) = point.index;
            let wide = usize::abs_diff(column, 4) <= 2;
            (3..9).contains(&line) && wide || (40..46).contains(&line) || (84..89).contains(&line) && wide
        });
        let n = points.len();
        let soft = HalfSpace { shear_modulus: 30e9, poisson: 0.2, side: Side::Base };
        let stiff = HalfSpace { shear_modulus: 80e9, poisson: 0.3, side: Side::Opposing };
        let near = NearField::new(&[soft, stiff], &points, 3);
        assert_eq!(near.strips.count(), 3);
        let matrix = total(&[&soft as &dyn Compliance, &stiff], &points, 3);
        // those along the track are the opposite of themselves in the mirror
        let force = |row: usize| {
            let (line, column) = points[row % n].index;
            let away = column as f64 - 4.0;
            let even = 1.0 + ((3 * line + row / n) % 7) as f64 + away.abs();
            if row / n == ALONG { even * away } else { even }
        };
        let forces: Vec<f64> = (0..3 * n).map(force).collect();
        let mut product = vec![0.0; 3 * n];
        near.add_product(&forces, &mut product);
        let largest = product.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for row in 0..3 * n {
            let exact: f64 = (0..3 * n).map(|column| matrix[(row, column)] * forces[column]).sum();
            assert!((product[row] - exact).abs() < ROUNDOFF * largest, "{row}: {} {exact}", product[row]);
            let across = (row * 7 + 5) % (3 * n);
            assert!((near.value(row, across) - matrix[(row, across)]).abs() < ROUNDOFF * matrix[(0, 0)]);
        }
        let ahead: Vec<usize> = (0..n).filter(|&j| points[j].index.1 >= 4).collect();
        let half = near.half(&ahead).unwrap();
        let h = ahead.len();
        let carried: Vec<f64> = (0..3 * h)
            .map(|row| {
                let j = ahead[row % h];
                let both = if points[j].index.1 == 4 { 1.0 } else { 2.0 };
                both * forces[row / h * n + j]
            })
            .collect();
        let mut of_half = vec![0.0; 3 * h];
        half.add_product(&carried, &mut of_half);
        for row in 0..3 * h {
            let whole = product[row / h * n + ahead[row % h]];
            assert!((of_half[row] - whole).abs() < ROUNDOFF * largest, "{row}: {} {whole}", of_half[row]);
        }
        // a strip that is moved alone is carried alone; other grids than endless ones differ by what lies beyond them
        let moved: Vec<f64> = points.iter().map(|point| f64::from(point.index.0 < 9)).collect();
        let alone: Vec<usize> = (0..n).filter(|&j| points[j].index.0 < 9).collect();
        let found = near.nearly_inverse(0, &moved).unwrap();
        let of_these = near.between(&alone).nearly_inverse(0, &vec![1.0; alone.len()]).unwrap();
        let largest = of_these.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (&j, force) in alone.iter().zip(of_these) {
            assert!((found[j] - force).abs() < BEYOND * largest, "{j}: {} {force}", found[j]);
        }
        assert!((0..n).all(|j| points[j].index.0 < 9 || found[j] == 0.0));
    }

    /// Source: the half-spaces as a dense matrix. Goal: look-ups and products on a ragged set of points of a grid are those of
    /// the matrix, with and without coupling of normal and tangential directions. Accuracy over the largest: ROUNDOFF
    /// of the means' Gauss sums, from either side, and of a transform of some thousand values.
    #[test]
    fn look_ups_and_products_are_those_of_the_matrix() {
        const ROUNDOFF: f64 = 1e-11;
        let h = 0.5e-3;
        let mut points = flat_grid((13, 9), h, |_, _| 0.0);
        points.retain(|point| (point.index.0 + 2 * point.index.1) % 5 != 0 && point.index.0 > 1);
        let n = points.len();
        let soft = HalfSpace { shear_modulus: 30e9, poisson: 0.2, side: Side::Base };
        let stiff = HalfSpace { shear_modulus: 80e9, poisson: 0.3, side: Side::Opposing };
        let same = HalfSpace { side: Side::Opposing, ..soft };
        for (directions, other) in [(1, stiff), (3, stiff), (3, same)] {
            let near = NearField::new(&[soft, other], &points, directions);
            let parts: [&dyn Compliance; 2] = [&soft, &other];
            let matrix = total(&parts, &points, directions);
            assert_eq!(near.rows(), matrix.nrows());
            let forces: Vec<f64> = (0..directions * n).map(|j| ((7 * j + 3) % 11) as f64 - 4.0).collect();
            let mut product = vec![0.0; forces.len()];
            near.add_product(&forces, &mut product);
            let largest = product.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let every_third: Vec<usize> = (0..forces.len()).step_by(3).collect();
            let block = near.block(&every_third);
            for (r, &row) in every_third.iter().enumerate() {
                for (c, &column) in every_third.iter().enumerate() {
                    assert!((block[(r, c)] - matrix[(row, column)]).abs() < ROUNDOFF * matrix[(0, 0)]);
                }
            }
            for row in 0..forces.len() {
                let mut exact = 0.0;
                for column in 0..forces.len() {
                    let value = matrix[(row, column)];
                    assert!(
                        (near.value(row, column) - value).abs() < ROUNDOFF * matrix[(0, 0)],
                        "{row} {column}"
                    );
                    exact += value * forces[column];
                }
                assert!((product[row] - exact).abs() < ROUNDOFF * largest, "{row}: {} {exact}", product[row]);
            }
        }
    }
}
