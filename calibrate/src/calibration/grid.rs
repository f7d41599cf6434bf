//! The grid that a patch asks for, and what is measured of a patch on its grid.

use crate::contact::{ContactPoint, HalfSpace, Lattice};
use nalgebra::Vector2;
use railspring_profiles::quadrature::GAUSS_5_UNIT;
use std::f64::consts::PI;

/// Largest spacing of the grid along the profile, where the curvature of worn and standard profiles changes within millimetres, and along
/// the track, m.
const LARGEST_CELL: [f64; 2] = [0.65e-3, 1.0e-3];
/// Cells across a patch that are wanted at least. With sixteen the approach of Hertz' ellipses is right to 0.1 %, the largest
/// pressure to 0.3 % and the area to 0.5 %.
const CELLS_ACROSS: f64 = 16.0;
/// Fewer cells than these do not remain.
const LEAST_ACROSS: f64 = 11.0;
/// Halvings of the spacing at most, by direction: half of these times.
const FINEST: [i32; 2] = [10, 12];
/// The spacing for a patch of the widths `across` (along the profile, along the track; m): the largest one, divided by √2 as
/// often as it takes, all times `spacing`.
pub fn cell_for(across: [f64; 2], spacing: f64) -> Vector2<f64> {
    let cell = |axis: usize| {
        // a conversion of what is beyond all numbers ends at their ends
        let steps = (2.0 * (LARGEST_CELL[axis] * CELLS_ACROSS / across[axis]).log2()).ceil() as i32;
        spacing * LARGEST_CELL[axis] * 0.5_f64.powf(0.5 * f64::from(steps.clamp(0, FINEST[axis])))
    };
    Vector2::new(cell(0), cell(1))
}

/// Whether a patch of the widths `across` (m) has too few cells, though there are smaller ones; `spacing` as in [`cell_for`].
pub fn too_coarse(lattice: &Lattice, across: [f64; 2], spacing: f64) -> bool {
    let least = cell_for([0.0; 2], spacing);
    (0..2).any(|axis| {
        spacing * across[axis] < LEAST_ACROSS * lattice.cell[axis]
            && lattice.cell[axis] > least[axis] * (1.0 + 1e-9)
    })
}

/// Lines of a fine grid from one that carries load to the next one of the same region, at most.
pub(super) const FINE_APART: usize = 2;

/// How many regions there are on a fine grid with some `forces` on its points.
pub(super) fn regions_on_grid(points: &[ContactPoint], forces: &[f64]) -> usize {
    parted(points, forces, FINE_APART).len()
}

/// Numbers of the points that carry load, parted where more lines than `apart` lie between them.
pub(super) fn parted(points: &[ContactPoint], forces: &[f64], apart: usize) -> Vec<Vec<usize>> {
    let mut regions: Vec<Vec<usize>> = Vec::new();
    for j in (0..points.len()).filter(|&j| forces[j] > 0.0) {
        let line = points[j].index.0;
        match regions.last_mut() {
            Some(region) if line <= points[region[region.len() - 1]].index.0 + apart => region.push(j),
            _ => regions.push(vec![j]),
        }
    }
    regions
}

/// Widths (along the profile, along the track; m) of the patch that carries most of the `forces`: those of the ellipse of
/// Hertz with the same second moments. Patches are parted by at least two lines along the track without load.
pub fn widths(lattice: &Lattice, points: &[ContactPoint], forces: &[f64]) -> [f64; 2] {
    let patches = parted(points, forces, FINE_APART);
    let carried = |patch: &[usize]| patch.iter().map(|&j| forces[j]).sum::<f64>();
    let Some(patch) = patches.iter().max_by(|a, b| carried(a).total_cmp(&carried(b))) else {
        return [0.0; 2];
    };
    [0, 1].map(|axis| 2.0 * (5.0 * variance(patch, points, forces, axis, lattice)).sqrt())
}

/// Area of the patches, m². Along the track, where the wheel is round, the pressure of a line is a semi-ellipse (Hertz; J.J.
/// Kalker's line contact), whose width follows from its second moment. The square of the width is smooth: it is linear between
/// lines. At either end of a patch two lines have too few points for a moment; there it goes along with the force of the
/// line, as in an ellipse, and the force as a parabola whose integral is what the last lines carry.
pub(super) fn area(lattice: &Lattice, points: &[ContactPoint], forces: &[f64]) -> f64 {
    let carrying: Vec<usize> = (0..points.len()).filter(|&j| forces[j] > 0.0).collect();
    let follows = |a: &usize, b: &usize| {
        let (a, b) = (points[*a].index, points[*b].index);
        a.0 == b.0 && a.1 + 1 == b.1
    };
    let mut lines: Vec<Line> = Vec::new();
    for run in carrying.chunk_by(follows) {
        let number = points[run[0]].index.0;
        let width = 4.0 * variance(run, points, forces, 1, lattice).sqrt();
        let force = run.iter().map(|&j| forces[j]).sum();
        match lines.last_mut() {
            Some(last) if last.number == number => {
                last.width += width;
                last.force += force;
            }
            _ => lines.push(Line { number, width, force }),
        }
    }
    let cells: f64 = lines
        .chunk_by(|a, b| a.number + 1 == b.number)
        .map(|patch| {
            let backwards: Vec<Line> = patch.iter().rev().copied().collect();
            let ((first, before), (last, after)) = (end(patch), end(&backwards));
            between(&patch[first..patch.len() - last]) + before + after
        })
        .sum();
    cells * lattice.cell.x
}

/// A line of points along the track with load.
#[derive(Clone, Copy)]
struct Line {
    number: usize,
    /// m.
    width: f64,
    /// N.
    force: f64,
}

/// Lines at either end of a patch with too few points for the width of the line.
const ENDS: usize = 2;

/// Integral of the width over lines whose square is linear between them.
fn between(lines: &[Line]) -> f64 {
    let piece = |pair: &[Line]| {
        let [a, b] = [pair[0].width, pair[1].width];
        if (a - b).abs() > 1e-6 * a { 2.0 / 3.0 * (a.powi(3) - b.powi(3)) / (a * a - b * b) } else { a }
    };
    lines.windows(2).map(piece).sum()
}

/// Lines at the end of a patch for which something else stands in, and the integral of the width from the next line outwards.
fn end(lines: &[Line]) -> (usize, f64) {
    let rises = |lines: &[Line]| lines.windows(2).all(|pair| pair[1].force > pair[0].force);
    if lines.len() >= 2 * ENDS + 4 && rises(&lines[..ENDS + 3]) {
        return (ENDS, loaded_end(lines));
    }
    // The square goes on linearly to zero, by one and a half lines at most, as a point nearer than half a cell to the rim
    // carries nothing.
    let first = lines[0].width;
    let beyond = match lines.get(1) {
        Some(Line { width: second, .. }) if *second > first => {
            (first * first / (second * second - first * first)).min(1.5)
        }
        _ => 0.5,
    };
    (0, 2.0 / 3.0 * first * beyond)
}

/// Integral of the width from the line after [`ENDS`] outwards. A line at the distance t has the force q =
/// q₀ + s·t + c·t². The slope s comes from the lines inside, c from q = 0 at the rim, and the place of the rim
/// from the force of the lines beyond.
fn loaded_end(lines: &[Line]) -> f64 {
    let [q0, q1, q2] = [0, 1, 2].map(|line| lines[ENDS + line].force);
    let slope = (0.5 * (3.0 * q0 - 4.0 * q1 + q2)).min(0.0);
    let beyond = 0.5 * q0 + lines[..ENDS].iter().map(|line| line.force).sum::<f64>();
    // 2/3·q₀·rim + s·rim²/6 = beyond
    let discriminant = (4.0 / 9.0 * q0 * q0 + 2.0 / 3.0 * slope * beyond).max(0.0);
    let rim = 2.0 * beyond / (2.0 / 3.0 * q0 + discriminant.sqrt());
    // the outermost line with load is at the distance ENDS; a point nearer than half a cell to the rim carries nothing
    let rim = rim.clamp(ENDS as f64 - 0.5, ENDS as f64 + 1.5);
    let curvature = -(q0 + slope * rim) / (rim * rim);
    // with t = rim·(1 - u²) the integrand is smooth at the rim
    let at = |(u, weight): (f64, f64)| {
        let t = rim * (1.0 - u * u);
        weight * 2.0 * rim * u * ((q0 + t * (slope + t * curvature)) / q0).max(0.0).sqrt()
    };
    lines[ENDS].width * GAUSS_5_UNIT.map(at).iter().sum::<f64>()
}

/// Variance of the places along an `axis` of the pressure of `some` points, m²: that of the points and that of a hat.
fn variance(some: &[usize], points: &[ContactPoint], forces: &[f64], axis: usize, lattice: &Lattice) -> f64 {
    let sum: f64 = some.iter().map(|&j| forces[j]).sum();
    let mean = |value: &dyn Fn(f64) -> f64| {
        some.iter().map(|&j| forces[j] * value(points[j].position[axis])).sum::<f64>() / sum
    };
    let centre = mean(&|at| at);
    mean(&|at| (at - centre).powi(2)) + lattice.cell[axis].powi(2) / 6.0
}

/// Whether a point that carries load has no neighbour on the grid, though the meshes go on there.
pub fn touches_border(points: &[ContactPoint], forces: &[f64]) -> bool {
    let there = |index: (usize, usize)| points.binary_search_by_key(&index, |point| point.index).is_ok();
    points.iter().zip(forces).filter(|(point, force)| !point.at_edge && **force > 0.0).any(|(point, _)| {
        let (i, k) = point.index;
        let (below, before) = (i.wrapping_sub(1), k.wrapping_sub(1));
        ![(i + 1, k), (below, k), (i, k + 1), (i, before)].into_iter().all(there)
    })
}

/// Gap at the rim of the patch under a normal force (N) that would press a round contact into an area (m²), m: half of
/// the approach, `F = 8/3·E*·a·g` (Hertz).
pub(super) fn rim_gap(half_spaces: &[HalfSpace], force: f64, area: f64) -> f64 {
    let contact_modulus =
        1.0 / half_spaces.iter().map(|b| 0.5 * (1.0 - b.poisson) / b.shear_modulus).sum::<f64>();
    0.375 * force / (contact_modulus * (area / PI).sqrt())
}

/// Normal forces (N) to start from where nothing is known but the gaps of the points at first touch: `√(1 - gap/rim)` as in
/// Hertz' contact, where the area with a smaller gap than that of the rim belongs to the `force`.
pub(super) fn first_forces(half_spaces: &[HalfSpace], points: &[ContactPoint], force: f64) -> Vec<f64> {
    let mut gaps: Vec<f64> = points.iter().map(|point| point.gap).collect();
    gaps.sort_by(f64::total_cmp);
    let cell = points.first().map_or(0.0, |point| point.area);
    let enough = |n: &usize| gaps[*n] >= rim_gap(half_spaces, force, (*n as f64 + 1.0) * cell);
    let rim = (0..gaps.len()).find(enough).map_or(f64::INFINITY, |n| gaps[n]);
    let share = |gap: f64| if gap <= gaps[0] { 1.0 } else { (1.0 - gap / rim).max(0.0).sqrt() };
    let sum: f64 = points.iter().map(|point| share(point.gap)).sum();
    points.iter().map(|point| force * share(point.gap) / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::hertz::point_contact;
    use crate::contact::{FreeDirection, NearField, Problem, flat_grid, gaps, solve};
    use crate::solid::Material;
    use nalgebra::Vector3;

    /// Points and normal forces of a load (N) on two half-spaces of steel with relative radii along the profile and the track (m), on a
    /// grid of `cells` to each semi-axis whose middle is off the patch's by the parts `off` of a cell.
    fn pressed(
        load: f64,
        radii: [f64; 2],
        cells: f64,
        off: [f64; 2],
    ) -> (Lattice, Vec<ContactPoint>, Vec<f64>) {
        let exact =
            point_contact(load, radii[0], radii[1], Material::STEEL.contact_modulus(&Material::STEEL))
                .unwrap();
        let cell = Vector2::new(exact.semi_axis_x, exact.semi_axis_y) / cells;
        let count = 2 * (1.4 * cells) as usize + 1;
        let mut points = flat_grid((count, count), 1.0, |_, _| 0.0);
        for point in &mut points {
            point.widths = cell;
            point.area = cell.x * cell.y;
            for axis in 0..2 {
                point.position[axis] = (point.position[axis] + off[axis]) * cell[axis];
                point.gap += (point.position[axis].powi(2) + cell[axis].powi(2) / 6.0) / (2.0 * radii[axis]);
            }
        }
        let compliance = NearField::new(&HalfSpace::both(&Material::STEEL), &points, 1);
        let free = gaps(&points);
        let hub = [FreeDirection { along: Vector3::z_axis(), force: -load }];
        let problem =
            Problem { points: &points, compliance: &compliance, free: &free, friction: 0.0, hub: &hub };
        let forces =
            solve(&problem, &first_forces(&HalfSpace::both(&Material::STEEL), &points, load)).unwrap().forces;
        (Lattice { cell, middle: count / 2 }, points, forces)
    }

    /// Source: Hertz (K.L. Johnson, Contact Mechanics, 1985, chapter 4). Goal: widths and area of a patch, m and m², of a round
    /// and of a long contact anywhere on the grid. Accuracy: DISCRETISATION, widths half a cell, the area 0.5 % with eight cells to a
    /// semi-axis, 0.3 % with twelve and 2 % with five, as the force of the last lines places the rim.
    #[test]
    fn a_patch_is_measured_between_the_points() {
        for (cells, discretisation) in [(5.0, 0.02), (8.0, 0.005), (12.0, 0.003)] {
            for radii in [[0.3, 0.3], [0.1, 0.46]] {
                for off in [[0.0, 0.0], [0.5, 0.5], [0.3, 0.1], [0.2, 0.45]] {
                    let (lattice, points, forces) = pressed(50e3, radii, cells, off);
                    let exact = PI * cells * cells * lattice.cell.x * lattice.cell.y;
                    let ratio = area(&lattice, &points, &forces) / exact;
                    assert!((ratio - 1.0).abs() < discretisation, "{cells} {radii:?} {off:?}: {ratio}");
                    for (width, cell) in widths(&lattice, &points, &forces).iter().zip(lattice.cell.iter()) {
                        assert!(
                            (width / cell - 2.0 * cells).abs() < 0.5,
                            "{cells} {radii:?} {off:?}: {width}"
                        );
                    }
                }
            }
        }
    }

    /// Source: Hertz. Goal: the gap at the rim of a round contact, m, and the forces to start from, which are those of the
    /// contact. Accuracy: ROUNDOFF; DISCRETISATION, a fifth of a cell at the rim of eight, √(2·0.2/8) of the largest force.
    #[test]
    fn the_first_forces_are_those_of_hertz() {
        const ROUNDOFF: f64 = 1e-12;
        const DISCRETISATION: f64 = 0.2;
        let (load, radius) = (50e3, 0.3);
        let both = HalfSpace::both(&Material::STEEL);
        let exact =
            point_contact(load, radius, radius, Material::STEEL.contact_modulus(&Material::STEEL)).unwrap();
        let rim = rim_gap(&both, load, PI * exact.semi_axis_x.powi(2));
        assert!((rim / (0.5 * exact.approach) - 1.0).abs() < ROUNDOFF, "{rim}");
        let (_, points, forces) = pressed(load, [radius; 2], 8.0, [0.3, 0.1]);
        let first = first_forces(&both, &points, load);
        let largest = forces.iter().copied().fold(0.0, f64::max);
        assert!((first.iter().sum::<f64>() / load - 1.0).abs() < ROUNDOFF);
        for (a, b) in first.iter().zip(&forces) {
            assert!((a - b).abs() < DISCRETISATION * largest, "{a} {b} of {largest}");
        }
    }

    /// Goal: the spacing follows the patch in steps of √2 between its ends, whatever the width; a patch that reaches points
    /// without neighbours touches the border of its grid.
    #[test]
    fn the_grid_follows_the_patch() {
        for width in [0.0, f64::MIN_POSITIVE, 1e-5, 0.7e-3, 3e-3, 9e-3, 1.0, f64::INFINITY] {
            let cell = cell_for([width; 2], 1.0);
            for axis in 0..2 {
                let steps = 2.0 * (LARGEST_CELL[axis] / cell[axis]).log2();
                assert!(
                    (steps - steps.round()).abs() < 1e-9
                        && (-0.1..f64::from(FINEST[axis]) + 0.1).contains(&steps),
                    "{width}: {steps}"
                );
                let (coarsest, finest) = (steps < 0.5, steps > f64::from(FINEST[axis]) - 0.5);
                assert!(coarsest || width >= CELLS_ACROSS * cell[axis] * (1.0 - 1e-9) || finest, "{width}");
                assert!(coarsest || width < CELLS_ACROSS * cell[axis] * 1.5, "{width}: {cell}");
            }
            // half the spacing is half of every cell, and changes where the other does
            let half = cell_for([width; 2], 0.5);
            assert_eq!(half, 0.5 * cell);
            for wider in [0.5, 0.68, 0.7, 1.0, 1.5] {
                let coarse =
                    |cell, spacing| too_coarse(&Lattice { cell, middle: 0 }, [wider * width; 2], spacing);
                assert_eq!(coarse(cell, 1.0), coarse(half, 0.5), "{width}");
                assert!(wider < 1.0 || !coarse(cell, 1.0), "{width}: {cell}");
            }
        }
        let (_, mut points, mut forces) = pressed(50e3, [0.3; 2], 6.0, [0.0; 2]);
        points[0].at_edge = false;
        assert!(!touches_border(&points, &forces));
        forces[0] = 1.0;
        assert!(touches_border(&points, &forces));
    }
}
