//! A rail along the path of a wheel against solids whose contact zone is at the place, and the energy of a load that moves along it.

use super::super::body::{BodyLoad, ElasticBody};
use super::super::load_case::HubSprings;
use super::super::reduced::ReducedBody;
use super::*;
use crate::time::energy::PartEnergy;
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::Newmark;
use nalgebra::Vector2;
use railspring_calibrate::mesh::mesh_rail_between;
use railspring_calibrate::superelement::times;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

const STEEL: Material = Material::STEEL;
const ELEMENT: Formulation = Formulation::IncompatibleModes;

fn pair() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap()
}

fn options() -> MeshOptions {
    MeshOptions { contact_element: 4e-3, contact_element_along: 4e-3, ..MeshOptions::default() }
}

/// The rail with its contact zone at a distance (m) from its first end.
fn condensed(pair: &Pair, length: f64, x: f64) -> CondensedBody {
    let mesh = mesh_rail_between(&pair.rail, &pair.placed, [x, length - x], &options()).unwrap();
    let supports = Supports { held: mesh.ends.clone(), ..Supports::default() };
    let element = Superelement::new(System::new(&mesh, STEEL, ELEMENT, &supports).unwrap()).unwrap();
    let loads = pair.section_loads(&mesh, 0.0).unwrap();
    let section = Some(SectionMotion::new(&mesh, &loads, |forces| element.solve(forces)));
    CondensedBody { section, ..element.condensed("rail".into()) }
}

fn path(pair: &Pair, window: &CondensedBody, length: f64, modes: usize) -> RailPath {
    RailPath::new(pair, window, &options(), &STEEL, ELEMENT, (length, modes)).unwrap()
}

/// Forces (N) on the nodes of the window around the arc length `at` of its lines, of a resultant 1 along y or z.
fn patch(window: &CondensedBody, at: f64, axis: usize) -> Vec<f64> {
    let grid = &window.grid;
    let columns = grid.along_track.len();
    let mut forces = vec![0.0; 3 * window.nodes.len()];
    for (line, s) in grid.along_profile.iter().enumerate() {
        for (column, x) in grid.along_track.iter().enumerate() {
            let weight = (1.0 - ((s - at) / 12e-3).powi(2) - (x / 12e-3).powi(2)).max(0.0);
            forces[3 * (line * columns + column) + axis] = weight;
        }
    }
    let sum: f64 = forces.iter().sum();
    forces.iter().map(|force| force / sum).collect()
}

/// Source: solids whose contact zone is at the place. Goal: displacements (m/N) of a patch under unit forces
/// across the track and down on it, over the root of the product of both solids' own flexibilities. Patches
/// are at the gauge corner and on the crown, 60, 100 and 200 mm from an end of a rail of 0.5 m. Displacements
/// in the middle are up to four times as large. Accuracy: DISCRETISATION of bending and torsion across the
/// track, 3 %, and down 1 %. The solids have elements up to 40 mm long, the path 10 mm.
#[test]
fn the_rail_at_a_place_is_the_solid_there() {
    const DISCRETISATION: f64 = 0.03;
    const DOWN: f64 = 0.01;
    const LENGTH: f64 = 0.5;
    let pair = pair();
    let middle = condensed(&pair, LENGTH, 0.5 * LENGTH);
    let path = path(&pair, &middle, LENGTH, 24);
    println!("{} motions, reach {}", path.window.ncols(), path.reach);
    let s = &middle.grid.along_profile;
    let places = [0.25, 0.6].map(|share| s[0] + share * (s[s.len() - 1] - s[0]));
    let loads: Vec<Vec<f64>> =
        places.iter().flat_map(|at| [1, 2].map(|axis| patch(&middle, *at, axis))).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut worst = 0.0_f64;
    for x in [0.06, 0.1, 0.2] {
        let solid = condensed(&pair, LENGTH, x);
        let at = path.at(x - 0.5 * LENGTH, 24);
        for (n, load) in loads.iter().enumerate() {
            for other in &loads[..=n] {
                let exact = dot(other, &times(&solid.compliance, load));
                let scale = (dot(load, &times(&solid.compliance, load))
                    * dot(other, &times(&solid.compliance, other)))
                .sqrt();
                let in_middle = dot(other, &times(&middle.compliance, load));
                let on = |forces: &[f64]| {
                    DVector::from_fn(path.window.ncols(), |k, _| dot(path.window.col_as_slice(k), forces))
                };
                let found = in_middle + on(other).dot(&(&at.difference * on(load)));
                let off = (found - exact) / scale;
                println!("{x} {n}: solid {exact:.4e} path {found:.4e} middle {in_middle:.4e} off {off:.5}");
                // the second of each two loads is the one down
                if n % 2 == 1 {
                    assert!(off.abs() < DOWN, "{x} {n}: {off}");
                }
                worst = worst.max(off.abs());
            }
        }
    }
    assert!(worst < DISCRETISATION, "{worst}");
}

/// Goal: forces that move along a rail with the speed of a train, and a torsion of it, do the work (J) that the rail has more in each step, with the work of what moves them; without damping. The modes are the rail's, whose lowest
/// natural frequencies (Hz) those of the rail condensed in the middle are. Accuracy: ROUNDOFF of sums of a thousand terms over the largest energy.
#[test]
fn a_load_that_moves_keeps_the_balance_of_energy() {
    const ROUNDOFF: f64 = 1e-10;
    const LENGTH: f64 = 0.3;
    let pair = pair();
    let middle = condensed(&pair, LENGTH, 0.5 * LENGTH);
    let path = path(&pair, &middle, LENGTH, 24);
    let scheme = Newmark::new(1e-4, 0.0);
    let body =
        ReducedBody::new(&middle, 24, STEEL.damping, &scheme, HubSprings::default(), Some(&path)).unwrap();
    let rest = Vector2::zeros();
    let mut state = body.in_motion(&rest, &rest);
    let nodes = 3 * middle.nodes.len();
    let (mut stored, mut worst, mut most, mut driven) = (0.0, 0.0_f64, 0.0_f64, 0.0);
    let mut forces = vec![0.0; nodes];
    for step in 1..=40 {
        let t = 1e-4 * f64::from(step);
        let load =
            BodyLoad { place: -0.05 + 30.0 * t, torsion: 3e4 * (900.0 * t).sin(), ..BodyLoad::default() };
        let now: Vec<f64> = (0..nodes)
            .map(|row| match row % 7 {
                0 => 1e3 * (0.3 * row as f64 + 2000.0 * t).sin() + if row % 3 == 2 { 500.0 } else { 0.0 },
                _ => 0.0,
            })
            .collect();
        let mut next = Default::default();
        body.predict(&state, &load, &mut next).finish(&now);
        let PartEnergy { kinetic, elastic, work, damped, .. } = body.energy(&state, &next, 0.0).unwrap();
        let ways = body.contact_displacement(&next).iter().zip(body.contact_displacement(&state));
        let done: f64 =
            forces.iter().zip(&now).zip(ways).map(|((f, g), (b, a))| 0.5 * (f + g) * (b - a)).sum();
        worst = worst.max((kinetic + elastic - stored - done - work + damped).abs());
        stored = kinetic + elastic;
        most = most.max(stored);
        driven += work;
        (state, forces) = (next, now);
    }
    println!("{worst:e} of {most} J, work {driven} J");
    assert!(most > 1.0 && driven.abs() > 0.1 && worst < ROUNDOFF * most, "{worst:e} of {most} J, {driven} J");
}
