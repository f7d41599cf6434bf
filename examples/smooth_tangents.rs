//! Draws the tangents of a pair over 60 loads, with the contact on the fine grid and between elements:
//! `cargo run --release --example smooth_tangents docs/smooth-tangents.svg`. It takes a minute and prints the measures.

use std::path::PathBuf;

use railspring::report::panel::{Panel, stacked_over_names};
use railspring::report::plot::{DARK, Dash, Marker, RED, Series};
use railspring_calibrate::calibration::{ContactField, Enforcement, LoadPoint, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{ContactConditions, Pair, PairBody};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

/// Loads from 1 to 150 kN, each 9 % above the one before.
const LOADS: u32 = 60;
/// Loads with a number below the figure, kN.
const NAMED: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 150.0];

/// Second differences of the logarithm of the tangents, which a staircase has and a smooth curve has not.
fn second_differences(points: &[LoadPoint]) -> Vec<f64> {
    let tangents: Vec<f64> = points.iter().map(|p| p.solid_tangent.ln()).collect();
    tangents.windows(3).map(|t| t[0] - 2.0 * t[1] + t[2]).collect()
}

fn main() -> Result<()> {
    let file = std::env::args().nth(1).map_or_else(|| "smooth-tangents.svg".into(), PathBuf::from);
    let loads: Vec<f64> =
        (0..LOADS).map(|n| 1e3 * 150.0_f64.powf(f64::from(n) / f64::from(LOADS - 1))).collect();
    let centred =
        Pair::new(rail_section("UIC60")?, wheel_section("S1002", 0.92)?, &TrackGeometry::standard())?;
    let meshes = centred.mesh(0.555, &MeshOptions::default())?;
    let bodies = meshes.condense(
        &centred,
        &PairBody::ALL,
        Material::STEEL,
        Formulation::IncompatibleModes,
        &Silent,
    )?;
    let mut panels = Vec::new();
    for (shift, place) in [(-3e-3, "away by 3 mm"), (0.0, "centred")] {
        let pair = centred.with_wheel_at(centred.tape_y + shift)?;
        let mut panel = |y_label: String, from_zero, series| {
            let x_label = "load P, kN".into();
            panels.push(Panel { x_label, y_label, from_zero, series });
        };
        let (mut tangents, mut differences) = (Vec::new(), Vec::new());
        for (field, name, color, dash, marker) in [
            (ContactField::Elements, "contact between elements of 2 mm", RED, Dash::Dashed, Marker::Square),
            (ContactField::Hybrid, "contact on the fine grid", DARK, Dash::Solid, Marker::Disc),
        ] {
            let contact = ContactConditions { friction: 0.0, enforcement: Enforcement::Exact, field };
            let pressed = bodies.press(&pair, contact, &loads, &Silent)?;
            let points = pressed.fit(Reference::Foot)?.points;
            let rough = second_differences(&points);
            let largest = |from: f64| {
                let from = loads.partition_point(|load| *load < from);
                rough.iter().skip(from).fold(0.0_f64, |m, d| m.max(d.abs()))
            };
            println!("{place}, {name}: {:.3}, from 20 kN {:.3}", largest(0.0), largest(20e3));
            let over = |first: usize, values: Vec<f64>| -> Vec<(f64, f64)> {
                values.into_iter().enumerate().map(|(n, value)| ((n + first) as f64, value)).collect()
            };
            let stiffness = points.iter().map(|p| p.solid_tangent * 1e-9).collect();
            tangents.push(Series::joined(name, over(0, stiffness), color, dash, marker));
            differences.push(Series::joined(name, over(1, rough), color, dash, marker));
        }
        panel(format!("{place}: dP/d\u{3b4}, 10\u{2076} kN/m"), true, tangents);
        panel("second difference of ln dP/d\u{3b4}".into(), true, differences);
    }
    let nearest = |kilonewton: f64| {
        let far = |n: &u32| (loads[*n as usize] * 1e-3 / kilonewton).ln().abs();
        (0..LOADS).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or_default() as usize
    };
    let mut names = vec![[String::new(), String::new()]; loads.len()];
    for kilonewton in NAMED {
        let load = loads[nearest(kilonewton)] * 1e-3;
        names[nearest(kilonewton)][0] = if load < 10.0 { format!("{load:.1}") } else { format!("{load:.0}") };
    }
    std::fs::write(&file, stacked_over_names(860, 215, &panels, &[], &names)).map_err(|cause| {
        railspring_profiles::error::InputError::new(
            file.display().to_string(),
            cause,
            "a file that can be written",
            "name another file",
        )
    })?;
    Ok(())
}
