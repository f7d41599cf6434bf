//! Whether a compliance is its own mirror image along the track.

use crate::mesh::SurfaceGrid;
use faer::Mat;

/// Part of its largest value by which it may differ from its mirror image: the last digits of what is condensed.
const ALIKE: f64 = 1e-9;
/// The same of the places of nodes along the track.
const SAME_PLACE: f64 = 1e-9;

/// The mirror image along the track of a coordinate (`3·node + axis`) of a grid with so many `columns` of nodes along it.
pub fn image_along(coordinate: usize, columns: usize) -> usize {
    let node = coordinate / 3;
    3 * (node - node % columns + columns - 1 - node % columns) + coordinate % 3
}

/// What a force or a displacement in a coordinate is multiplied with in its mirror image along the track.
pub fn sign_along(coordinate: usize) -> f64 {
    if coordinate.is_multiple_of(3) { -1.0 } else { 1.0 }
}

/// Whether the `compliance` of the nodes of a `grid` (`3·node + axis`, m/N) is its own mirror image along the track, and the grid is, to a billionth of the largest values.
///
/// A force on the mirror image of a node then moves the mirror images of all nodes, with the opposite sign along the track.
pub fn is_mirrored(compliance: &Mat<f64>, grid: &SurfaceGrid) -> bool {
    let x = &grid.along_track;
    let columns = x.len();
    let last = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let grid_is = x.iter().zip(x.iter().rev()).all(|(a, b)| (a + b).abs() <= SAME_PLACE * last);
    let rows = 3 * grid.along_profile.len() * columns;
    if !grid_is || columns == 0 || compliance.nrows() < rows {
        return false;
    }
    let image = |row: usize| image_along(row, columns);
    let largest = (0..rows).fold(0.0_f64, |m, row| m.max(compliance[(row, row)].abs()));
    (0..rows).filter(|column| *column <= image(*column)).all(|column| {
        let (here, there) = (compliance.col_as_slice(column), compliance.col_as_slice(image(column)));
        let odd = |row: usize| here[row] - sign_along(row) * sign_along(column) * there[image(row)];
        (0..rows).all(|row| odd(row).abs() <= ALIKE * largest)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a compliance (m/N) that is made of its mirror image is one, whatever it has beside the contact nodes; one of which a single value differs by a millionth is none, and none
    /// is one on a grid that is not.
    #[test]
    fn a_value_that_differs_is_seen() {
        let (lines, columns) = (3, 5);
        let rows = 3 * lines * columns;
        let place = |k: usize| k as f64 - 2.0;
        let grid = |along_track: Vec<f64>| SurfaceGrid {
            along_profile: vec![0.0, 1.0, 2.5],
            along_track,
            nodes: (0..lines * columns).collect(),
        };
        let even = grid((0..columns).map(place).collect());
        let any = |r: usize, c: usize| (1.3 * (r + c) as f64).sin() + (0.7 * (r * c) as f64).cos();
        let image = |row: usize| {
            let node = row / 3;
            3 * (node / columns * columns + columns - 1 - node % columns) + row % 3
        };
        let value = |r: usize, c: usize| {
            let sign = if r.is_multiple_of(3) == c.is_multiple_of(3) { 1.0 } else { -1.0 };
            any(r, c) + sign * any(image(r), image(c))
        };
        let beside = |r: usize, c: usize| if r.max(c) < rows { value(r, c) } else { 7.0 };
        let matrix = Mat::from_fn(rows + 1, rows + 1, beside);
        assert!(is_mirrored(&matrix, &even));
        assert!(!is_mirrored(&matrix, &grid(vec![-2.0, -1.0, 0.0, 1.0, 2.1])));
        for (r, c) in [(0, 0), (7, 31), (rows - 1, 4)] {
            let mut other = matrix.clone();
            other[(r, c)] += 1e-6;
            assert!(!is_mirrored(&other, &even), "{r} {c}");
        }
    }
}
