//! The program tests itself on the machine that it runs on: closed solutions, and a case of a half-space program.
//!
//! What a study is made of is computed where somebody else has the value: bricks, beam, contact on half-spaces, fit of a law. A check fails where this build computes
//! otherwise than those that were tested.

use std::f64::consts::PI;
use std::sync::OnceLock;

use nalgebra::{Point2, Vector2};
use railspring_calibrate::analytic::beam::Bending;
use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::beam::{BeamSection, End, RailBeam, Torsion};
use railspring_calibrate::calibration::{
    Bodies, ContactField, DOWNWARDS, Enforcement, Reference, WheelOnRail, load_points, press_loads,
};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::law::{StiffnessLaw, fit_law};
use railspring_calibrate::mesh::{BlockOptions, MeshOptions, SurfaceGrid, mesh_block};
use railspring_calibrate::pair::Pair;
use railspring_calibrate::section_analysis::rail_properties;
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::Superelement;
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::{rail_section, wheel_section};
use serde::{Deserialize, Serialize};

/// A value that this program computes and somebody else has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// What is computed, with its unit.
    pub name: String,
    /// Whose value it is compared with.
    pub source: String,
    /// This program's value.
    pub found: f64,
    /// The other one.
    pub expected: f64,
    /// Largest difference, over the expected value.
    pub tolerance: f64,
}

impl Check {
    fn new(name: &str, source: &str, [found, expected]: [f64; 2], tolerance: f64) -> Self {
        Self { name: name.into(), source: source.into(), found, expected, tolerance }
    }

    /// Difference over the expected value.
    pub fn relative_error(&self) -> f64 {
        self.found / self.expected - 1.0
    }

    /// Whether it is within the tolerance; what is no number is not.
    pub fn holds(&self) -> bool {
        self.relative_error().abs() <= self.tolerance
    }
}

/// What rounding leaves of a value that is exact otherwise: 1e-16 times a condition number of 1e6.
const ROUNDOFF: f64 = 1e-10;

/// Computes all checks; some seconds.
///
/// # Errors
/// An interruption, and numerics that do not converge.
pub fn checks(monitor: &dyn Monitor) -> Result<Vec<Check>> {
    let parts: [fn() -> Result<Vec<Check>>; 6] =
        [bricks, order_of_bricks, beam, law, hertz, half_space_program];
    let mut all = Vec::new();
    for (n, part) in parts.iter().enumerate() {
        monitor.progress("self-test", n, parts.len())?;
        all.extend(part()?);
    }
    monitor.progress("self-test", parts.len(), parts.len())?;
    Ok(all)
}

/// A column of bricks without Poisson's effect under an equal pressure.
fn bricks() -> Result<Vec<Check>> {
    const LENGTHS: [f64; 3] = [0.05, 0.04, 0.1];
    const FORCE: f64 = 1e5;
    let mesh = mesh_block(&BlockOptions::uniform(LENGTHS, [6, 5, 8]))?;
    let supports = Supports { held: mesh.foot.clone(), ..Supports::default() };
    let material = Material { poisson: 0.0, ..Material::STEEL };
    let column = Superelement::new(System::new(&mesh, material, Formulation::IncompatibleModes, &supports)?)?;
    // nodes at an edge carry half of what those inside do, at a corner a quarter
    let share = |node: usize| {
        let at = mesh.nodes[node];
        let half = |place: f64, length: f64| if place.abs() > 0.499 * length { 0.5 } else { 1.0 };
        half(at.x, LENGTHS[0]) * half(at.y, LENGTHS[1])
    };
    let top = &mesh.contact.nodes;
    let all: f64 = top.iter().map(|&node| share(node)).sum();
    let mut forces = vec![0.0; 3 * mesh.nodes.len()];
    top.iter().for_each(|&node| forces[3 * node + 2] = FORCE * share(node) / all);
    let moved = column.solve(&forces);
    let expected = FORCE * LENGTHS[2] / (material.young * LENGTHS[0] * LENGTHS[1]);
    let both = [moved[3 * top[0] + 2], expected];
    Ok(vec![Check::new("shortening of a column of bricks, m", "F L / (E A)", both, ROUNDOFF)])
}

/// The order at which displacements of bricks come to those of a manufactured solution (P.J. Roache, J. Fluids Eng. 124 (2002)): a block without Poisson's effect, held at sides
/// and foot, whose vertical displacement is `sin πx/L · sin πy/L · z²(L-z)/L³` from its free face down; edges of a sixth and a twelfth of the block.
fn order_of_bricks() -> Result<Vec<Check>> {
    const LENGTH: f64 = 0.1;
    // edges of a third of the block are too long for the order, and those of a sixth and a twelfth leave this much of it
    const TOLERANCE: f64 = 0.05;
    let material = Material { poisson: 0.0, ..Material::STEEL };
    let shear = 0.5 * material.young;
    let error = |divisions: usize| -> Result<f64> {
        let mesh = mesh_block(&BlockOptions::uniform([LENGTH; 3], [divisions; 3]))?;
        let held = mesh.foot.iter().chain(&mesh.ends).copied().collect();
        let supports = Supports { held, ..Supports::default() };
        let block =
            Superelement::new(System::new(&mesh, material, Formulation::IncompatibleModes, &supports)?)?;
        let edge = LENGTH / divisions as f64;
        let wave = PI / LENGTH;
        let mut forces = vec![0.0; 3 * mesh.nodes.len()];
        let mut exact = Vec::new();
        for (node, at) in mesh.nodes.iter().enumerate() {
            let [(sx, cx), (sy, cy)] = [at.x, at.y].map(|at| (wave * (at + 0.5 * LENGTH)).sin_cos());
            let z = at.z / LENGTH;
            // the shape over the depth, and its derivatives
            let shape = [z * z * (1.0 - z), (2.0 - 3.0 * z) * z / LENGTH, (2.0 - 6.0 * z) / LENGTH.powi(2)];
            let body = [
                -shear * wave * cx * sy * shape[1],
                -shear * wave * sx * cy * shape[1],
                shear * sx * sy * (2.0 * wave * wave * shape[0] - 2.0 * shape[2]),
            ];
            // at the free face a node has half an element
            let volume = edge.powi(3) * if at.z == 0.0 { 0.5 } else { 1.0 };
            for (direction, force) in body.iter().enumerate() {
                forces[3 * node + direction] = force * volume;
            }
            exact.push(sx * sy * shape[0]);
        }
        let moved = block.solve(&forces);
        let off: f64 =
            exact.iter().enumerate().map(|(node, exact)| (moved[3 * node + 2] - exact).powi(2)).sum();
        Ok((off / exact.len() as f64).sqrt())
    };
    let order = (error(6)? / error(12)?).log2();
    Ok(vec![Check::new("observed order of bricks' displacement", "manufactured", [order, 2.0], TOLERANCE)])
}

/// The rail as a beam with fixed ends.
fn beam() -> Result<Vec<Check>> {
    const LENGTH: f64 = 0.555;
    let rail = rail_section("60E1")?;
    let section =
        BeamSection::rail(&rail_properties(&rail)?, &Material::STEEL, LENGTH, Torsion::SaintVenant)?;
    let found = RailBeam::new(section, LENGTH, 20, 0.0, [End::Fixed; 2])?.section_flexibility(0.5 * LENGTH);
    let planes = [(section.bending_y, section.shear_y), (section.bending_z, section.shear_z)];
    let names =
        ["lateral flexibility of a rail of beams, m/N", "vertical flexibility of a rail of beams, m/N"];
    let check = |((name, (bending_stiffness, shear_stiffness)), found): ((&str, (f64, f64)), f64)| {
        let expected =
            Bending { length: LENGTH, bending_stiffness, shear_stiffness }.fixed_midspan_deflection();
        Check::new(name, "Timoshenko beam", [found, expected], ROUNDOFF)
    };
    Ok(names.into_iter().zip(planes).zip([found[(0, 0)], found[(1, 1)]]).map(check).collect())
}

/// Points of a law give its constants.
fn law() -> Result<Vec<Check>> {
    // where the search for the exponent ends
    const SEARCH: f64 = 1e-5;
    let exact = StiffnessLaw::new(2e8, 4e8, 0.3)?;
    let forces: Vec<f64> = (0..24).map(|i| 1e3 * 1.24_f64.powi(i)).collect();
    let tangents: Vec<f64> = forces.iter().map(|&force| exact.tangent(force)).collect();
    let found = fit_law(&forces, &tangents)?.law;
    let check = |name, found, expected| Check::new(name, "the law itself", [found, expected], SEARCH);
    Ok(vec![
        check("a of a fitted law, N/m", found.a, exact.a),
        check("b of a fitted law, N/m", found.b, exact.b),
        check("c of a fitted law", found.c, exact.c),
    ])
}

/// A wheel with a flat tread on a crown, both half-spaces. K.L. Johnson, Contact Mechanics (1985), section 4.2.
fn hertz() -> Result<Vec<Check>> {
    const WHEEL: f64 = 0.46;
    const CROWN: f64 = 0.3;
    let curve = |height: &dyn Fn(f64) -> f64| {
        let points: Vec<_> =
            (-80..=80).map(|i| f64::from(i) * 2.5e-4).map(|y| Point2::new(y, height(y))).collect();
        ProfileCurve::from_points(&points, &[])
    };
    let (rail, wheel) = (curve(&|y| y * y / (2.0 * CROWN))?, curve(&|_| 0.0)?);
    let lines =
        |n: i32, step: f64, middle: f64| (-n..=n).map(|i| middle + f64::from(i) * step).collect::<Vec<_>>();
    let grid = |middle: f64, radius: f64| {
        let (s, x) = (lines(9, 2e-3, middle), lines(16, 1.5e-3 / radius, 0.0));
        SurfaceGrid { nodes: (0..s.len() * x.len()).collect(), along_profile: s, along_track: x }
    };
    let grids = [grid(0.5 * rail.length(), 1.0), grid(0.5 * wheel.length(), WHEEL)];
    let placed = WheelOnRail {
        bodies: Bodies::HalfSpaces,
        rail_surface: Surface::extruded(&rail, &grids[0]),
        wheel_surface: Surface::revolved(&wheel, &grids[1], WHEEL, Vector2::zeros()),
        friction: 0.0,
        enforcement: Enforcement::Exact,
        field: ContactField::Hybrid,
        materials: [Material::STEEL; 2],
        along: DOWNWARDS,
        beyond: OnceLock::new(),
    };
    let found = last(&placed, 80e3)?;
    let modulus = Material::STEEL.contact_modulus(&Material::STEEL);
    let exact = point_contact(80e3, WHEEL, CROWN, modulus)?;
    let check = |name, found, expected, tolerance| Check::new(name, "Hertz", [found, expected], tolerance);
    // ten cells and more across the patch
    Ok(vec![
        check("approach of an ellipse at 80 kN, m", found.0, exact.approach, 0.001),
        check("tangent of an ellipse at 80 kN, N/m", found.1, exact.tangent_stiffness, 0.003),
    ])
}

/// S1002 on the UIC60 head, 3 mm towards the flange, as CONTACT 25.2 (Vollebregt and Kalker) has it with G 82 GPa, Poisson 0.28 and a grid of 0.1 mm, which knows the approach to 0.22 %.
fn half_space_program() -> Result<Vec<Check>> {
    const FORCE: f64 = 94_574.16;
    // m, N/m, m², Pa
    const EXPECTED: [f64; 4] = [1.107_627_5e-4, 1.322_618_76e9, 103.78e-6, 1_509.248_65e6];
    let steel = Material { young: 209.92e9, poisson: 0.28, ..Material::STEEL };
    let track = TrackGeometry { lateral_shift: 3e-3, ..TrackGeometry::standard() };
    let pair = Pair::new(rail_section("UIC60")?, wheel_section("S1002", 0.92)?, &track)?;
    let meshes = pair.mesh(0.555, &MeshOptions { contact_half_length: 24e-3, ..MeshOptions::default() })?;
    let grids = [&meshes.rail.contact, &meshes.wheel.contact];
    let placed = pair.half_spaces_on_rail(grids, [steel; 2], ContactField::Hybrid);
    let (approach, tangent, [area, pressure]) = last(&placed, FORCE)?;
    let check =
        |name, found, expected, tolerance| Check::new(name, "CONTACT 25.2", [found, expected], tolerance);
    Ok(vec![
        check("approach of S1002 on UIC60, 3 mm, 94.6 kN, m", approach, EXPECTED[0], 0.01),
        check("tangent of it, N/m", tangent, EXPECTED[1], 0.01),
        check("contact area of it, m\u{b2}", area, EXPECTED[2], 0.01),
        check("largest pressure of it, Pa", pressure, EXPECTED[3], 0.02),
    ])
}

/// Approach (m), tangent (N/m), area (m²) and largest pressure (Pa) under a force, which grows to it.
fn last(placed: &WheelOnRail, force: f64) -> Result<(f64, f64, [f64; 2])> {
    const LOADS: i32 = 20;
    let loads: Vec<f64> = (0..LOADS).map(|i| force * 1.3_f64.powi(i + 1 - LOADS)).collect();
    let states = press_loads(placed, &loads, "self-test", &railspring_profiles::monitor::Silent)?;
    let points = load_points(placed, &states, Reference::HalfSpaces)?;
    let (state, point) = (&states[states.len() - 1], &points[points.len() - 1]);
    let patch = placed.patch_without_stresses(state)?.values;
    Ok((point.displacement, point.solid_tangent, [patch.area, patch.max_pressure]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use railspring_profiles::monitor::Silent;

    /// Source: closed solutions and CONTACT. Goal: every check holds, each by its own tolerance; one whose value is another, or none, does not.
    #[test]
    fn the_program_passes_its_own_test() {
        let all = checks(&Silent).unwrap();
        assert!(all.len() > 8);
        for check in &all {
            println!(
                "{}: {:e}, {:e}: {:.2e}",
                check.name,
                check.found,
                check.expected,
                check.relative_error()
            );
            assert!(check.holds(), "{check:?}");
            let other = 1.0 + 1.5 * check.tolerance;
            for wrong in [check.expected * other, f64::NAN] {
                assert!(!Check { found: wrong, ..check.clone() }.holds(), "{check:?}");
            }
        }
    }
}
