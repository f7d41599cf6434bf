//! The transient solid model with contact on a fine grid, S1002 on 60E1: against contact between elements, from one mesh to
//! another, and from one number of threads to another.

use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::error::Error;
use railspring_calibrate::history::History;
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::monitor::Silent;
use railspring_calibrate::pair::{Pair, PairMeshes};
use railspring_calibrate::placement::TrackGeometry;
use railspring_calibrate::scenario::{HarmonicForce, Scenario};
use railspring_calibrate::section::{rail_section, wheel_section};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_calibrate::transient::TransientModel;

fn pair() -> Pair {
    let (rail, wheel) = (rail_section("60E1"), wheel_section("S1002", 0.858));
    Pair::new(rail.unwrap(), wheel.unwrap(), &TrackGeometry::standard()).unwrap()
}

fn meshes(pair: &Pair, element: f64) -> PairMeshes {
    let options =
        MeshOptions { contact_element: element, contact_element_along: element, ..MeshOptions::default() };
    pair.mesh(0.555, &options).unwrap()
}

/// A wheel at rest, just touching, that is pressed down by 60 kN and to the field side by 10 kN: it bounces, and slides
/// while it carries little.
fn pressed(steps: usize) -> Scenario {
    Scenario {
        vertical_force: HarmonicForce::constant(60e3),
        lateral_force: HarmonicForce::constant(10e3),
        ..Scenario::new(steps, 5e-4, 0.5)
    }
}

fn run(
    pair: &Pair,
    meshes: &PairMeshes,
    contact: (Enforcement, ContactField),
    steps: usize,
) -> Result<History, Error> {
    // the damping of the published studies: 2 % at 1000 Hz
    let material = Material { damping: 0.02 / (1000.0 * std::f64::consts::PI), ..Material::STEEL };
    let element = Formulation::FullIntegration;
    let model = TransientModel::of_pair(pair, [&meshes.rail, &meshes.wheel], material, element, contact);
    Ok(model.run(&pressed(steps), &Silent)?.history)
}

/// Largest difference of P and of Q over the largest value of the second history.
fn difference(a: &History, b: &History) -> [f64; 2] {
    let over = |force: fn(&railspring_calibrate::history::HistoryRow) -> f64| {
        let size = b.rows.iter().map(|row| force(row).abs()).fold(0.0, f64::max);
        a.rows.iter().zip(&b.rows).map(|(a, b)| (force(a) - force(b)).abs() / size).fold(0.0, f64::max)
    };
    [over(|row| row.vertical_force), over(|row| row.lateral_force)]
}

/// Goal: P and Q (N) of a bouncing wheel over ten steps with the mesh refined from 6 to 3 mm: on the fine grid they stay what
/// they are, between elements, of which one to three nodes carry the load at first, they approach those of the fine grid. So
/// the difference of both is the staircase of the nodes. Accuracy: DISCRETISATION of the bodies, 1 % of the
/// largest P and 2 % of the largest Q; the staircase falls to less than half of it, as the nodes under a patch are four times as many.
#[test]
fn elements_approach_the_fine_grid() {
    const DISCRETISATION: [f64; 2] = [0.01, 0.02];
    let pair = pair();
    let histories = [6e-3, 3e-3].map(|element| {
        let meshes = meshes(&pair, element);
        [ContactField::Elements, ContactField::Hybrid]
            .map(|field| run(&pair, &meshes, (Enforcement::Exact, field), 10).unwrap())
    });
    let [[coarse_elements, coarse], [fine_elements, fine]] = &histories;
    let of_bodies = difference(coarse, fine);
    let staircase = difference(coarse_elements, coarse);
    let left = difference(fine_elements, fine);
    println!("bodies {of_bodies:?} staircase {staircase:?} to {left:?}");
    for force in 0..2 {
        assert!(of_bodies[force] < DISCRETISATION[force], "{of_bodies:?}");
        assert!(staircase[force] > 2.0 * DISCRETISATION[force], "{staircase:?}");
        assert!(left[force] < 0.5 * staircase[force], "{staircase:?} {left:?}");
    }
}

/// Goal: the same bytes of P, Q (N) and places (m) with one thread and with three.
#[test]
fn threads_do_not_change_a_history() {
    let pair = pair();
    let meshes = meshes(&pair, 6e-3);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let history = pool.install(|| run(&pair, &meshes, (Enforcement::Exact, ContactField::Hybrid), 4));
        let numbers = |history: History| -> Vec<u64> {
            let rows = history.rows.iter();
            rows.flat_map(|r| [r.vertical_force, r.lateral_force, r.wheel_y, r.wheel_z].map(f64::to_bits))
                .collect()
        };
        numbers(history.unwrap())
    };
    let one = with(1);
    assert!(f64::from_bits(one[one.len() - 4]) > 1e4, "the wheel is pressed on the rail");
    assert_eq!(one, with(3));
}

/// Goal: penalty springs, which stand at the nodes of a mesh, are refused on a fine grid.
#[test]
fn penalty_springs_are_refused_on_a_fine_grid() {
    let pair = pair();
    let refused = run(&pair, &meshes(&pair, 6e-3), (Enforcement::Penalty(1e9), ContactField::Hybrid), 1);
    assert!(matches!(refused, Err(Error::Input(_))), "{:?}", refused.err());
}
