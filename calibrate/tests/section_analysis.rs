//! Section properties of the standard rails against published and independently computed ones.

use std::time::Instant;

use railspring_calibrate::section_analysis::rail_properties;
use railspring_profiles::section::rail_section;

/// MODEL: the published values are rounded to four or five digits.
const ROUNDED: f64 = 1e-3;
/// DISCRETISATION: of the independent finite-element solution and of ours together.
const DISCRETISATION: f64 = 3e-3;

/// Source: `geometry/rail_section_properties.csv` of the shared facts: EN 13674-1 and data sheets for area, centroid
/// and second moments (cm², mm, cm⁴), an independent finite-element solution for J (cm⁴), shear centre (mm), warping
/// constant (cm⁶) and shear coefficients. Goal: 60E1, 60E2, 54E1. Accuracy: 0.1 %, and 0.3 %.
#[test]
fn rails_have_the_published_properties() {
    let Some(table) = railspring_testing::facts_text("geometry/rail_section_properties.csv") else { return };
    let mut compared = 0;
    for name in ["60E1", "60E2", "54E1"] {
        let start = Instant::now();
        let p = rail_properties(&rail_section(name).unwrap()).unwrap();
        println!("{name}: {p:?}, {:?}", start.elapsed());
        for row in table.lines().filter(|l| l.starts_with(name)) {
            let column: Vec<&str> = row.split(',').collect();
            let (value, accuracy) = match column[1] {
                "A" => (p.area * 1e4, ROUNDED),
                "zc" => (p.centroid_height * 1e3, ROUNDED),
                "Ixx" => (p.ixx * 1e8, ROUNDED),
                "Iyy" => (p.iyy * 1e8, ROUNDED),
                "J_torsion" => (p.torsion_constant * 1e8, DISCRETISATION),
                "shear_centre_above_foot" => (p.shear_centre_height * 1e3, DISCRETISATION),
                "warping_const_about_shear_centre" => (p.warping_constant * 1e12, DISCRETISATION),
                "shear_area_ratio_lateral" => (p.shear_coefficient_lateral, DISCRETISATION),
                "shear_area_ratio_vertical" => (p.shear_coefficient_vertical, DISCRETISATION),
                _ => continue,
            };
            // The published number where it is one, else the computed one.
            let expected: f64 = column[3].parse().or_else(|_| column[4].parse()).unwrap();
            let off = value / expected - 1.0;
            assert!(
                off.abs() < accuracy,
                "{name} {}: {value} against {expected}, {:.3} %",
                column[1],
                100.0 * off
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 3 * 7 + 2);
}
