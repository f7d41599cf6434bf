//! Solids against closed solutions: rigid-body modes, Timoshenko beams.

use nalgebra::{Point3, Vector3};
use railspring_calibrate::analytic::beam::Bending;
use railspring_calibrate::mesh::{BlockOptions, MeshOptions, mesh_block, mesh_rail};
use railspring_calibrate::section_analysis::rail_properties;
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::Superelement;
use railspring_profiles::placement::{TrackGeometry, place_rail};
use railspring_profiles::section::rail_section;

/// Rounding of sums of element forces relative to the largest of them.
const ROUNDOFF: f64 = 1e-11;

/// Source: elasticity. Goal: a body that follows its master node stores no energy in the six rigid-body motions, so that
/// stiffness times motion vanishes on every equation. Accuracy: ROUNDOFF of the largest element force.
#[test]
fn rigid_body_motions_of_the_master_node_need_no_force() {
    let mesh = mesh_block(&BlockOptions::uniform([0.05, 0.04, 0.03], [3, 3, 3])).unwrap();
    let master = Point3::new(0.01, -0.02, 0.2);
    let supports =
        Supports { followers: mesh.foot.clone(), master, master_free: [true; 6], ..Default::default() };
    let system = System::new(&mesh, Material::STEEL, Formulation::IncompatibleModes, &supports).unwrap();
    let stiffness = system.matrix(1.0, 0.0, &[]).unwrap();
    let numbering = &system.numbering;
    for motion in 0..6 {
        let mut axis = Vector3::zeros();
        axis[motion % 3] = 1.0;
        let mut x = vec![0.0; numbering.equations];
        for (n, p) in mesh.nodes.iter().enumerate() {
            let u = if motion < 3 { axis } else { axis.cross(&(p - master)) };
            for d in 0..3 {
                let (terms, count) = numbering.terms(n, p, d);
                if count == 1 && terms[0].0 < numbering.interior + numbering.contact {
                    x[terms[0].0] = u[d];
                }
            }
        }
        x[numbering.master_equation(motion).unwrap()] = 1.0;
        let mut force = vec![0.0; x.len()];
        let mut largest = 0.0_f64;
        for column in 0..x.len() {
            let range = stiffness.col_ptr()[column]..stiffness.col_ptr()[column + 1];
            for (row, value) in stiffness.row_idx()[range.clone()].iter().zip(&stiffness.val()[range]) {
                force[*row] += value * x[column];
                if *row != column {
                    force[column] += value * x[*row];
                }
                largest = largest.max((value * x[column]).abs());
            }
        }
        let worst = force.iter().map(|f| f.abs()).fold(0.0, f64::max);
        assert!(worst < ROUNDOFF * largest, "motion {motion}: {worst} of {largest}");
    }
}

fn tip_deflection(formulation: Formulation) -> (f64, f64) {
    // a bar along x, 1 m long, 0.1 m high, two elements over its height
    let mesh = mesh_block(&BlockOptions::uniform([1.0, 0.05, 0.1], [20, 1, 2])).unwrap();
    let at = |x: f64| -> Vec<usize> {
        (0..mesh.nodes.len()).filter(|&n| (mesh.nodes[n].x - x).abs() < 1e-9).collect()
    };
    let held = at(-0.5);
    // the contact grid of a block covers its whole top; held nodes cannot be retained as well
    let mut free = mesh.clone();
    let columns = free.contact.along_track.len();
    let last = columns - 1;
    free.contact.nodes =
        free.contact.nodes.iter().enumerate().filter(|(i, _)| i % columns == last).map(|(_, n)| *n).collect();
    free.contact.along_track = vec![0.5];
    let material = Material { poisson: 0.0, ..Material::STEEL };
    let supports = Supports { held, ..Default::default() };
    let element = Superelement::new(System::new(&free, material, formulation, &supports).unwrap()).unwrap();
    let tip = at(0.5);
    let force = 1e3;
    let mut nodal = vec![0.0; 3 * free.nodes.len()];
    // over the height 1:2:1, over the width 1:1
    for &n in &tip {
        let middle = (free.nodes[n].z - 0.05).abs() < 1e-9;
        nodal[3 * n + 2] = force * if middle { 0.25 } else { 0.125 };
    }
    let u = element.solve(&nodal);
    let mean = tip.iter().map(|&n| u[3 * n + 2]).sum::<f64>() / tip.len() as f64;
    let exact = Bending {
        length: 1.0,
        bending_stiffness: material.young * 0.05 * 0.1_f64.powi(3) / 12.0,
        shear_stiffness: 5.0 / 6.0 * material.shear_modulus() * 0.05 * 0.1,
    };
    (mean, force * exact.cantilever_deflection())
}

/// Source: Timoshenko's cantilever. Goal: incompatible modes within 0.5 % with two elements over the height, without
/// lateral contraction, which the clamped end would hinder. Full integration is far too stiff, so the test can
/// fail. Units SI.
#[test]
fn a_cantilever_bends_as_timoshenko_says() {
    const DISCRETISATION: f64 = 0.005;
    let (measured, exact) = tip_deflection(Formulation::IncompatibleModes);
    assert!((measured / exact - 1.0).abs() < DISCRETISATION, "{measured} {exact}");
    let (locked, _) = tip_deflection(Formulation::FullIntegration);
    assert!(locked / exact < 0.95, "{locked} {exact}");
}

/// Sag of the meshed rail under its own weight, both ends held, over that of the beam.
fn sag_over_timoshenko(length: f64) -> f64 {
    let material = Material::STEEL;
    let section = rail_section("60E1").unwrap();
    let placed =
        place_rail(&section, &TrackGeometry { inclination: 0.0, ..TrackGeometry::standard() }).unwrap();
    let mesh = mesh_rail(&section, &placed, length, &MeshOptions::default()).unwrap();
    let supports = Supports { held: mesh.ends.clone(), ..Default::default() };
    let system = System::new(&mesh, material, Formulation::IncompatibleModes, &supports).unwrap();
    let mut unit = vec![0.0; 3 * mesh.nodes.len()];
    unit.iter_mut().skip(2).step_by(3).for_each(|u| *u = 9.81);
    let forces = system.nodal_mass().times(&unit);
    let u = Superelement::new(system).unwrap().solve(&forces);
    let centroid = section.height - section.area.centroid_height;
    let near: Vec<usize> = (0..mesh.nodes.len())
        .filter(|&n| mesh.nodes[n].x.abs() < 1e-9 && (mesh.nodes[n].z - centroid).abs() < 8e-3)
        .collect();
    let measured = near.iter().map(|&n| u[3 * n + 2]).sum::<f64>() / near.len() as f64;
    let p = rail_properties(&section).unwrap();
    let q = material.density * p.area * 9.81;
    let shear = p.shear_coefficient_vertical * material.shear_modulus() * p.area;
    let exact = q * length.powi(4) / (384.0 * material.young * p.ixx) + q * length.powi(2) / (8.0 * shear);
    measured / exact
}

/// Source: Timoshenko's beam fixed at both ends under its own weight, q·L⁴/(384·E·I) + q·L²/(8·κ·G·A), with κ = 0.393 of
/// 60E1. Goal: the meshed rail of 2.4 m sags by the same within 3 %. The stub of 0.555 m is stiffer than the beam, never
/// softer: its held ends hinder the warping which κ takes as free (MODEL, 11 % measured). Units SI.
#[test]
fn the_rail_fixed_at_both_ends_bends_as_timoshenko_says() {
    const MODEL: f64 = 0.03;
    const HINDERED_WARPING: f64 = 0.13;
    let long = sag_over_timoshenko(2.4);
    assert!((long - 1.0).abs() < MODEL, "{long}");
    let stub = sag_over_timoshenko(0.555);
    assert!(stub < 1.0 && stub > 1.0 - HINDERED_WARPING, "{stub}");
}
