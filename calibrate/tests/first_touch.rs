//! First touch of the S1002 wheel on the inclined UIC60 rail.

use std::path::PathBuf;

use railspring_calibrate::placement::{TrackGeometry, place_rail, touch};
use railspring_calibrate::profile::wheels::wheel_profile;
use railspring_calibrate::section::rail_section;

fn facts() -> PathBuf {
    std::env::var_os("RAILSPRING_FACTS").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/facts"),
        PathBuf::from,
    )
}

#[test]
fn contact_program_finds_the_same_touch() {
    let path = facts().join("contact/touch_point_right_wheel_no_yaw.csv");
    let Ok(table) = std::fs::read_to_string(&path) else {
        println!("skipped: {} is not there", path.display());
        return;
    };
    let track = TrackGeometry::standard();
    let rail = place_rail(&rail_section("UIC60").unwrap(), &track).unwrap();
    let wheel = wheel_profile("S1002").unwrap();
    for row in table.lines().skip(1) {
        let column: Vec<f64> = row.split(',').map(|v| v.parse().unwrap()).collect();
        let shift = column[0];
        let found = touch(&rail, &wheel, track.tape_y() + 1e-3 * shift).unwrap();
        println!("{shift:6.2} dy {:9.4} dz {:9.5} dtape {:10.6} dangle {:9.5}", found.point.x*1e3-column[4], found.point.y*1e3-column[5], found.tape_z*1e3-column[3], found.contact_angle+column[11]);
    }
}
