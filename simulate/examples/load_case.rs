//! Runs a wheel on a rail of beams with the published law under a vertical and a lateral force:
//! `cargo run --release -p railspring-simulate --example load_case`.

use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::Material;
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_simulate::element::published::{MovingModel, WheelSprings};
use railspring_simulate::time::scenario::{HarmonicForce, Scenario};

fn main() -> Result<()> {
    let pair = Pair::new(rail_section("60E1")?, wheel_section("S1002", 0.858)?, &TrackGeometry::standard())?;
    let steel = Material { damping: 2.0 * 0.02 / (std::f64::consts::TAU * 1000.0), ..Material::STEEL };
    let beam = pair.beam(&steel, 0.555, 20)?; // 0.555 m of rail in 20 elements
    let springs =
        WheelSprings { horizontal: 80e6, normal: StiffnessLaw::published().into(), longitudinal: 80e6 };
    let model = MovingModel::of_pair(&pair, beam, [&steel; 2], springs, 283.0); // mass of the wheel, kg
    let scenario = Scenario {
        vertical_force: HarmonicForce { amplitude: 30e3, frequency: 10.0, ..HarmonicForce::constant(60e3) },
        lateral_force: HarmonicForce::constant(20e3),
        ..Scenario::new(200, 5e-4, 0.5)
    };
    let history = model.run(&scenario, &Silent)?.history;
    println!("{} unknowns, {}", history.degrees_of_freedom, history.ending);
    println!("time, s   P, kN   Q, kN   y, mm");
    for row in history.rows.iter().step_by(20) {
        let (p, q) = (row.vertical_force * 1e-3, row.lateral_force * 1e-3);
        println!("{:.3}   {p:7.2} {q:7.2} {:7.3}", row.time, row.wheel_y * 1e3);
    }
    Ok(())
}
