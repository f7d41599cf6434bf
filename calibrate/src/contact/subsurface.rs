//! Stresses in a half-space below a contact patch.
//!
//! Every contact point carries the bilinear hat of a uniform grid. Near to it the hat is 4 by 4 or 8 by 8 concentrated forces, farther
//! away one (J. Boussinesq 1885, V. Cerruti 1882; formulas in K.L. Johnson, Contact Mechanics, 1985, (3.20) and (3.76)).

use super::point::ContactPoint;
use crate::solid::{largest_shear, von_mises};
use nalgebra::{Point2, Vector2};
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::PI;

/// Stress (Pa) in the axes of the patch: 1 along the profile, 2 along the track, 3 into the body; 11, 22, 33, 12, 23, 31.
pub type PatchStress = [f64; 6];

/// Where below the patch a stress is largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Its value, Pa.
    pub stress: f64,
    /// Its depth, m.
    pub depth: f64,
    /// The place above it: arc length along the profile and x, m.
    pub place: Point2<f64>,
}

/// The largest stresses below a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subsurface {
    /// Largest shear stress.
    pub shear: Peak,
    /// Von Mises stress.
    pub mises: Peak,
}

/// Hats nearer than so many of their widths are taken apart.
const NEAR: f64 = 4.0;
/// Hats nearer than so many of their widths are taken apart into more parts.
const NEXT: f64 = 1.5;
/// Parts of a hat in each direction, and of one that is next to the place.
const PARTS: usize = 4;
const MORE_PARTS: usize = 8;
/// Ratio of the depths that are looked at.
const DEEPER: f64 = 1.25;
/// Parts of the way between depths that are looked at in the end, and of such a part again.
const BETWEEN: usize = 6;
/// Depth, in widths, from which on hats may be concentrated forces while a place is sought.
const CONCENTRATED: f64 = 1.5;

/// Stress of the body below at a `place` (arc length, x; m) and `depth` (m, above 0) under the contact `forces` on the body
/// above, by direction and point as everywhere; one direction or three.
pub fn stress_below(
    points: &[ContactPoint],
    forces: &[f64],
    poisson: f64,
    place: &Point2<f64>,
    depth: f64,
) -> PatchStress {
    let mut sum = [0.0; 6];
    for Loaded { point, load } in &loaded(points, forces) {
        let of_hat = hat(point.widths, place - point.position, depth, poisson, *load);
        sum.iter_mut().zip(of_hat).for_each(|(s, v)| *s += v);
    }
    sum
}

/// A point that carries load.
struct Loaded<'a> {
    point: &'a ContactPoint,
    /// What the body below feels: pressed inwards, and drawn along 1 and 2, N.
    load: [f64; 3],
}

fn loaded<'a>(points: &'a [ContactPoint], forces: &[f64]) -> Vec<Loaded<'a>> {
    let n = points.len();
    let force = |direction: usize, j: usize| forces.get(direction * n + j).copied().unwrap_or(0.0);
    let carries = points.iter().enumerate().filter(|(j, _)| forces[*j] > 0.0);
    // the body below feels the opposite along the surface
    carries.map(|(j, point)| Loaded { point, load: [force(0, j), -force(1, j), -force(2, j)] }).collect()
}

/// Stress at an `offset` and `depth` from a hat of these widths.
fn hat(widths: Vector2<f64>, offset: Vector2<f64>, depth: f64, poisson: f64, load: [f64; 3]) -> PatchStress {
    let distance = offset.norm().hypot(depth) / widths.max();
    if distance > NEAR {
        return concentrated(offset, depth, poisson, load);
    }
    let parts = if distance > NEXT { PARTS } else { MORE_PARTS };
    // midpoints of equal parts of -1..1, with the share that the hat has there
    let part = |i: usize| (2.0 * i as f64 + 1.0) / parts as f64 - 1.0;
    let share = |i: usize| 2.0 / parts as f64 * (1.0 - part(i).abs());
    let mut sum = [0.0; 6];
    for i in 0..parts {
        for k in 0..parts {
            let shift = Vector2::new(part(i) * widths.x, part(k) * widths.y);
            let of_part = load.map(|l| share(i) * share(k) * l);
            let stress = concentrated(offset - shift, depth, poisson, of_part);
            sum.iter_mut().zip(stress).for_each(|(s, v)| *s += v);
        }
    }
    sum
}

/// The largest shear and von Mises stresses below the points that carry load, at depths from a quarter of the width of a point
/// on; `None` if none does. The points are those of a uniform grid.
///
/// At the surface, where friction may have the largest, all points are looked at; below, where the field is smooth, of every line along the
/// track the place of the largest pressure, and then what is beside and between.
pub fn subsurface(points: &[ContactPoint], forces: &[f64], poisson: f64) -> Option<Subsurface> {
    let loaded = loaded(points, forces);
    let first = loaded.first()?.point;
    let over = |axis: usize| {
        let ends = loaded.iter().map(|l| l.point.position[axis]);
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        high - low + first.widths[axis]
    };
    let (least, deep) = (0.25 * first.widths.min(), CONCENTRATED * first.widths.max());
    let deepest = over(0).min(over(1)).max(deep);
    let count = ((deepest / deep).ln() / DEEPER.ln()).ceil() as usize + 1;
    let depths: Vec<f64> = (0..count).map(|i| deep * DEEPER.powi(i as i32)).collect();

    let mut found = Subsurface::none(first.position);
    for place in ridge(&loaded) {
        for &depth in &depths {
            let mut sum = [0.0; 6];
            for Loaded { point, load } in &loaded {
                let stress = concentrated(place - point.position, depth, poisson, *load);
                sum.iter_mut().zip(stress).for_each(|(s, v)| *s += v);
            }
            found.look(sum, place, depth);
        }
    }
    let mut exact = at_surface(&loaded, least, poisson);
    for start in [found.shear, found.mises] {
        let stress = |place: &Point2<f64>, depth: f64| stress_below(points, forces, poisson, place, depth);
        // beside the place, then above and below
        let mut beside = Subsurface::none(start.place);
        for (i, k) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let place = start.place + Vector2::new(i * first.widths.x, k * first.widths.y);
            beside.look(stress(&place, start.depth), place, start.depth);
        }
        let above = if start.depth <= deep { least } else { start.depth / DEEPER };
        for peak in [beside.shear, beside.mises] {
            let mut below = Subsurface::none(peak.place);
            let mut look = |(low, high): (f64, f64)| {
                for i in 0..=BETWEEN {
                    let depth = low + (high - low) * i as f64 / BETWEEN as f64;
                    below.look(stress(&peak.place, depth), peak.place, depth);
                }
                below
            };
            let (low, high) = (above, start.depth * DEEPER);
            let step = (high - low) / BETWEEN as f64;
            let coarse = look((low, high));
            for centre in [coarse.shear.depth, coarse.mises.depth] {
                look(((centre - step).max(least), centre + step));
            }
            exact.keep(&below);
            if beside.shear.place == beside.mises.place {
                break;
            }
        }
        if found.shear.place == found.mises.place && found.shear.depth == found.mises.depth {
            break;
        }
    }
    Some(exact)
}

impl Subsurface {
    fn none(place: Point2<f64>) -> Self {
        let nothing = Peak { stress: 0.0, depth: 0.0, place };
        Self { shear: nothing, mises: nothing }
    }

    /// Keeps what is larger.
    fn keep(&mut self, other: &Self) {
        for (peak, other) in [(&mut self.shear, other.shear), (&mut self.mises, other.mises)] {
            if other.stress > peak.stress {
                *peak = other;
            }
        }
    }

    /// Keeps the stress at a place where it is larger.
    fn look(&mut self, stress: PatchStress, place: Point2<f64>, depth: f64) {
        for (peak, value) in [(&mut self.shear, largest_shear(stress)), (&mut self.mises, von_mises(stress))]
        {
            if value > peak.stress {
                *peak = Peak { stress: value, depth, place };
            }
        }
    }
}

/// Of every line along the track the place of the largest pressure.
fn ridge(loaded: &[Loaded]) -> Vec<Point2<f64>> {
    let mut highest: BTreeMap<usize, &Loaded> = BTreeMap::new();
    for l in loaded {
        let known = highest.entry(l.point.index.0).or_insert(l);
        if l.load[0] > known.load[0] {
            *known = l;
        }
    }
    highest.values().map(|l| l.point.position).collect()
}

/// The largest stresses below the loaded points themselves at one depth: between points of a uniform grid the stress of a hat depends on the
/// lines between them alone.
fn at_surface(loaded: &[Loaded], depth: f64, poisson: f64) -> Subsurface {
    const UNIT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let first = loaded[0].point;
    let mut table: HashMap<(isize, isize), [PatchStress; 3]> = HashMap::new();
    let mut found = Subsurface::none(first.position);
    for at in loaded {
        let mut sum = [0.0; 6];
        for Loaded { point, load } in loaded {
            let lines = (
                at.point.index.0 as isize - point.index.0 as isize,
                at.point.index.1 as isize - point.index.1 as isize,
            );
            let of_unit = table.entry(lines).or_insert_with(|| {
                let offset = Vector2::new(lines.0 as f64 * point.widths.x, lines.1 as f64 * point.widths.y);
                UNIT.map(|load| hat(point.widths, offset, depth, poisson, load))
            });
            for (stress, force) in of_unit.iter().zip(load).filter(|(_, force)| **force != 0.0) {
                sum.iter_mut().zip(stress).for_each(|(s, v)| *s += force * v);
            }
        }
        found.look(sum, at.point.position, depth);
    }
    found
}

/// Stress at an `offset` and `depth` from a concentrated force: into the body, along 1 and along 2, N.
fn concentrated(offset: Vector2<f64>, depth: f64, poisson: f64, [p, q1, q2]: [f64; 3]) -> PatchStress {
    let powers = Powers::new(offset, depth);
    let mut stress = boussinesq(offset, depth, &powers, poisson).map(|s| p * s);
    if q1 != 0.0 {
        let unit = cerruti(offset, depth, &powers, poisson);
        stress.iter_mut().zip(unit).for_each(|(s, v)| *s += q1 * v);
    }
    if q2 != 0.0 {
        let [aa, bb, cc, ab, bc, ca] = cerruti(offset.yx(), depth, &powers, poisson);
        stress.iter_mut().zip([bb, aa, cc, ab, ca, bc]).for_each(|(s, v)| *s += q2 * v);
    }
    stress
}

/// Powers of the distance ρ from a force and of its sum with the depth z, which the forces in all directions share: they are asked for
/// millions of times, and a division takes as long as ten products.
struct Powers {
    /// ρ, m.
    distance: f64,
    /// 1/ρ, 1/ρ³, 1/ρ⁵.
    inverse: [f64; 3],
    /// 1/(ρ + z) and its square.
    with_depth: [f64; 2],
}

impl Powers {
    fn new(offset: Vector2<f64>, z: f64) -> Self {
        let distance = (offset.norm_squared() + z * z).sqrt();
        let (first, sum) = (1.0 / distance, 1.0 / (distance + z));
        let third = first * first * first;
        Self { distance, inverse: [first, third, third * first * first], with_depth: [sum, sum * sum] }
    }
}

/// Johnson (3.20), for a unit force.
fn boussinesq(offset: Vector2<f64>, z: f64, powers: &Powers, poisson: f64) -> PatchStress {
    let (x, y) = (offset.x, offset.y);
    let Powers { distance: rho, inverse: [first, third, fifth], with_depth: [sum, square] } = *powers;
    let compressible = 1.0 - 2.0 * poisson;
    // (1 - z/ρ)/r² = 1/(ρ·(ρ + z)), which has its value below the force, too
    let g = first * sum;
    // {(1 - z/ρ)(x² - y²)/r² + z·y²/ρ³}/r², where 1/r² goes out: y²·(z/ρ³ - 2g)/r² + g, and z/ρ³ - 2g = -r²·h
    let h = (2.0 * rho + z) * third * square;
    let normal =
        |along: f64, across: f64| compressible * (g - across * across * h) - 3.0 * z * along * along * fifth;
    let shear = 3.0 * z * z * fifth;
    [
        normal(x, y),
        normal(y, x),
        -shear * z,
        compressible * x * y * h - 3.0 * x * y * z * fifth,
        -shear * y,
        -shear * x,
    ]
    .map(|s| s * (0.5 / PI))
}

/// Johnson (3.76), for a unit force along the first axis.
fn cerruti(offset: Vector2<f64>, z: f64, powers: &Powers, poisson: f64) -> PatchStress {
    let (x, y) = (offset.x, offset.y);
    let Powers { inverse: [first, third, fifth], with_depth: [sum, square], .. } = *powers;
    let compressible = 1.0 - 2.0 * poisson;
    let common = square * (third + 2.0 * first * first * sum);
    let straight = first * square;
    let far = 3.0 * fifth;
    [
        -far * x * x * x + compressible * (x * third - 3.0 * x * straight + x * x * x * common),
        -far * x * y * y + compressible * (x * third - x * straight + x * y * y * common),
        -far * x * z * z,
        -far * x * x * y + compressible * (x * x * y * common - y * straight),
        -far * x * y * z,
        -far * x * x * z,
    ]
    .map(|s| s * (0.5 / PI))
}

#[cfg(test)]
mod tests {
    use super::super::point::flat_grid;
    use super::*;

    const POISSON: f64 = 0.3;

    /// Source: the equations of equilibrium, and a surface without stress around the force (Johnson, 3.2 and 3.6). Goal: the
    /// stresses of concentrated forces in all three directions satisfy both, Pa/m. Accuracy: DISCRETISATION of central
    /// differences over 1e-4 of the distance.
    #[test]
    fn concentrated_forces_are_in_equilibrium() {
        const DISCRETISATION: f64 = 1e-6;
        for load in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, -0.5, 0.7]] {
            for (x, y, z) in [(0.7, -0.4, 0.5), (0.2, 0.3, 1.0), (-1.0, 0.1, 0.2)] {
                let at = |x: f64, y: f64, z: f64| concentrated(Vector2::new(x, y), z, POISSON, load);
                let e = 1e-4;
                let [dx, dy, dz] = [
                    (at(x + e, y, z), at(x - e, y, z)),
                    (at(x, y + e, z), at(x, y - e, z)),
                    (at(x, y, z + e), at(x, y, z - e)),
                ]
                .map(|(a, b)| -> [f64; 6] { std::array::from_fn(|i| (a[i] - b[i]) / (2.0 * e)) });
                // 11 12 13, 12 22 23, 13 23 33
                for (i, k, l) in [(0, 3, 5), (3, 1, 4), (5, 4, 2)] {
                    let rest = dx[i] + dy[k] + dz[l];
                    let size = dx[i].abs() + dy[k].abs() + dz[l].abs();
                    assert!(rest.abs() < DISCRETISATION * (1.0 + size), "{load:?} {x} {y} {z}: {rest}");
                }
                let surface = at(x, y, 1e-9);
                assert!([2, 4, 5].iter().all(|&i| surface[i].abs() < 1e-6), "{load:?}: {surface:?}");
            }
        }
    }

    /// Source: the resultant over a plane. Goal: the stresses on a plane 1 m below concentrated forces carry them, N. Accuracy:
    /// DISCRETISATION, the plane ends at 60 m, where 1/60 of a tangential force's share, (1/60)³ of a normal one's is missing.
    #[test]
    fn a_plane_below_carries_the_forces() {
        let (half, count) = (60.0, 1200);
        let h = 2.0 * half / f64::from(count);
        let load = [2.0, -1.0, 0.5];
        let mut carried = [0.0; 3];
        for i in 0..count {
            for k in 0..count {
                let centre = |n: i32| (f64::from(n) + 0.5) * h - half;
                let s = concentrated(Vector2::new(centre(i), centre(k)), 1.0, POISSON, load);
                for (c, value) in carried.iter_mut().zip([-s[2], -s[5], -s[4]]) {
                    *c += value * h * h;
                }
            }
        }
        for (found, force) in carried.iter().zip(load) {
            assert!((found / force - 1.0).abs() < 0.03, "{carried:?}");
        }
        assert!((carried[0] / load[0] - 1.0).abs() < 1e-4, "{carried:?}");
    }

    /// Source: Hertz' circular contact (Johnson, 3.4): below the middle the largest shear stress is 0.310·p0 at a depth of
    /// 0.48·a, and the von Mises stress, which is twice the shear on the axis, 0.620·p0 there, for ν = 0.3. Goal: both on a grid
    /// of 16 points across. Accuracy: DISCRETISATION of a sphere's pressure by hats and of the tabled digits; the depth, where the
    /// stress changes by 0.5 % over a tenth of it, half a spacing of the grid.
    #[test]
    fn the_largest_shear_lies_below_a_hertz_contact() {
        const DISCRETISATION: f64 = 0.01;
        let (radius, peak) = (4e-3, 1e9);
        let h = radius / 8.0;
        let points = flat_grid((17, 17), h, |_, _| 0.0);
        let pressure = |p: &ContactPoint| (1.0 - p.position.coords.norm_squared() / radius.powi(2)).max(0.0);
        let forces: Vec<f64> = points.iter().map(|p| peak * pressure(p).sqrt() * p.area).collect();
        let Subsurface { shear, mises } = subsurface(&points, &forces, POISSON).unwrap();
        assert!((shear.stress / (0.310 * peak) - 1.0).abs() < DISCRETISATION, "{shear:?}");
        assert!((shear.depth - 0.48 * radius).abs() < 0.5 * h, "{shear:?}");
        assert!((mises.stress / (0.620 * peak) - 1.0).abs() < DISCRETISATION, "{mises:?}");
        assert!(shear.place.coords.norm() < 0.1 * h);
        assert_eq!(subsurface(&points, &vec![0.0; points.len()], POISSON), None);
    }

    /// Source: every place and depth looked at. Goal: on two patches side by side with friction along and across, the search finds the largest
    /// shear and von Mises stress of all points and of depths a tenth of a width apart, Pa; once where friction has them at the surface, once
    /// below. Accuracy: DISCRETISATION, a place half a width off and a depth a twentieth off, where the field is level.
    #[test]
    fn the_search_finds_what_is_largest() {
        const DISCRETISATION: f64 = 0.01;
        let h = 0.5e-3;
        let points = flat_grid((30, 14), h, |_, _| 0.0);
        for friction in [0.1, 0.5] {
            let pressure = |p: &ContactPoint| {
                let ellipse = |centre: f64, a: f64, b: f64| {
                    let (s, x) = ((p.position.x - centre) / a, p.position.y / b);
                    (1.0 - s * s - x * x).max(0.0).sqrt()
                };
                900e6 * ellipse(-5e-3, 1.6e-3, 3.2e-3) + 700e6 * ellipse(2.5e-3, 4e-3, 2.5e-3)
            };
            let normal: Vec<f64> = points.iter().map(|p| pressure(p) * p.area).collect();
            let along = |share: f64| normal.iter().map(move |f| share * friction * f);
            let forces: Vec<f64> = normal.iter().copied().chain(along(0.6)).chain(along(-0.8)).collect();
            let clock = std::time::Instant::now();
            let found = subsurface(&points, &forces, POISSON).unwrap();
            println!("{friction}: {:.1} ms, {found:?}", 1e3 * clock.elapsed().as_secs_f64());
            let mut all = Subsurface::none(points[0].position);
            for (point, _) in points.iter().zip(&normal).filter(|(_, force)| **force > 0.0) {
                for i in 0..60 {
                    let depth = h * (0.25 + 0.1 * f64::from(i));
                    let stress = stress_below(&points, &forces, POISSON, &point.position, depth);
                    all.look(stress, point.position, depth);
                }
            }
            let surface = friction > 0.3;
            assert_eq!(all.shear.depth < 0.5 * h, surface, "{all:?}");
            for (found, all) in [(found.shear, all.shear), (found.mises, all.mises)] {
                assert!((found.stress / all.stress - 1.0).abs() < DISCRETISATION, "{found:?} {all:?}");
                assert!((found.depth - all.depth).abs() < 0.3 * all.depth, "{found:?} {all:?}");
            }
        }
    }
}
