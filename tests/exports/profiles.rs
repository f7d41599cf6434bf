//! Formats with the profiles of the pair beside the springs.

use nalgebra::{Point2, Vector2};
use railspring::results::bodies::geometry;
use railspring::study::Study;
use railspring_profiles::profile::ProfileKind;
use railspring_profiles::profile_file::{ReadOptions, read};
use serde_json::Value;

use super::{export, interpolated, number_after, rows, springs, text};

/// Goal: the profiles for CONTACT, read back by our reader, are the placed rail and the wheel. Every point of
/// the rail lies on the placed surface once it is moved to the gauge, every point of the wheel on its
/// profile. The case has track, wheelset, shear modulus, and as KZRAIL the law's stiffness besides the
/// contact. CONTACT itself is not at hand. Units mm, N, N/mm, MPa. Accuracy: DIGITS of a millimetre for
/// points, and six digits of the case.
#[test]
fn contact_gets_the_pair_in_place() {
    const SIX_DIGITS: f64 = 1e-6;
    let (place, record) = springs(None);
    let folder = export(&place, "contact", &[]);
    let study = Study::read(&place.path().join("study.toml")).unwrap_or_else(|e| panic!("{e:?}"));
    let geometry = geometry::geometry(study.statics()).unwrap();
    let points = |name: &str, kind: ProfileKind| -> Vec<Point2<f64>> {
        let profile = read(&folder.join(name), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(profile.kind, kind);
        profile.points.iter().map(|p| p.point).collect()
    };
    let (rail, wheel) = (points("rail.prr", ProfileKind::Rail), points("wheel.prw", ProfileKind::Wheel));
    let placed = &geometry.pair.placed.curve;
    let shift = Vector2::new(placed.point(0.0).x - rail[0].x, 0.0);
    let top = rail.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    assert!(rail.len() > 200 && (0.0..1e-7).contains(&top), "{top}");
    for (curve, points, shift) in
        [(placed, &rail, shift), (&geometry.pair.wheel.running, &wheel, Vector2::zeros())]
    {
        let length: f64 = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        assert!((length / curve.length() - 1.0).abs() < 1e-4, "the whole surface");
        for point in points {
            assert!(curve.closest(&(point + shift)).1.abs() < 1e-12, "{point}");
        }
    }
    let case = text(&folder, "contact.inp");
    let line = |name: &str| -> Vec<f64> {
        let line = case.lines().find(|line| line.contains(name) && !line.starts_with('%')).unwrap();
        line.split_whitespace().map_while(|word| word.parse().ok()).collect()
    };
    assert_eq!(line("GAUGHT"), [14.0, 0.0, 1435.0, 0.0]);
    assert_eq!(line("FBDIST"), [1360.0, -70.0, 429.0]);
    let shear = 210e3 / 2.6;
    assert!(
        line("POISS").iter().zip([0.3, 0.3, shear, shear]).all(|(a, b)| (a / b - 1.0).abs() < SIX_DIGITS)
    );
    let tangent = |reference: &str, force: f64| {
        let all = record["references"].as_array().unwrap();
        let points = all.iter().find(|r| r["reference"] == reference).unwrap()["points"].as_array().unwrap();
        let is_it = |p: &&Value| (p["force_kn"].as_f64().unwrap() * 1e3 / force - 1.0).abs() < SIX_DIGITS;
        points.iter().find(is_it).unwrap()["tangent_kn_per_m"].as_f64().unwrap()
    };
    let horizontal = record["horizontal_kn_per_m"].as_f64().unwrap();
    let of_cases: Vec<Vec<f64>> = case
        .split("1 MODULE")
        .skip(1)
        .map(|case| {
            let numbers = |name: &str| -> Vec<f64> {
                let line = case.lines().find(|line| line.contains(name)).unwrap();
                line.split_whitespace().map_while(|word| word.parse().ok()).collect()
            };
            [numbers("KYRAIL"), numbers("S, Y, FZ")].concat()
        })
        .collect();
    assert!(of_cases.len() >= 3, "{of_cases:?}");
    assert_eq!(case.matches("C-P-B-T-N-F-S").count(), of_cases.len());
    for digits in case.lines().filter(|line| line.contains("C-P-B-T-N-F-S")) {
        // CONTACT 25, `wr_contact_fy_brent`: "Brent method for Fy needs T>=1, F=3"; N = 1 gives the vertical force
        let digits: Vec<u32> = digits.trim().chars().map_while(|digit| digit.to_digit(10)).collect();
        assert!(digits[3] >= 1 && digits[4] == 1 && digits[5] == 3, "{digits:?}");
    }
    assert_eq!(line("FSTAT"), [0.5, 0.5], "the study's, and FKIN is 1e-4 at least");
    for case in of_cases {
        let [k_y, _, k_z, _, _, _, force, ..] = case[..] else { panic!("{case:?}") };
        // contact and massless rail in series are the law's tangent
        let both = 1.0 / (1.0 / k_z + 1.0 / tangent("local", force));
        assert!((both / tangent("beam", force) - 1.0).abs() < SIX_DIGITS, "{both}");
        assert!((k_y / horizontal - 1.0).abs() < SIX_DIGITS);
    }
}

/// Source: the first rows of the wheel's profile in the manual of KPF, which is an S1002: (-60.0, -2.63568) and a slope of 1:15; the manual's distance of 32.5 mm
/// from the gauge face to the rail's origin at 1435 mm. Goal: the profiles are in KPF's axes and agree with the study's, y ascends; the field
/// ascends in the angle and has the solid's tangents. Units mm, rad, N/m. Accuracy: the manual's five digits, DIGITS.
#[test]
fn gensys_gets_profiles_and_fields() {
    const FIVE_DIGITS: f64 = 6e-6;
    let (place, _) = springs(None);
    let folder = export(&place, "gensys", &[]);
    let study = Study::read(&place.path().join("study.toml")).unwrap_or_else(|e| panic!("{e:?}"));
    let pair = geometry::geometry(study.statics()).unwrap().pair;
    let profile = |body: &str| rows(&text(&folder, &format!("profile.{body}")));
    let (wheel, rail) = (profile("wheel"), profile("rail"));
    assert!((wheel[0][0] + 60.0).abs() < 0.5 && wheel.last().unwrap()[0] > 68.5);
    for y in [-60.0_f64, -59.9, -59.0, -58.6] {
        let expected = -2.63568 + (y + 60.0) / 15.0;
        assert!((interpolated(&wheel, y.max(wheel[0][0])) - expected).abs() < FIVE_DIGITS, "{y}");
    }
    for (rows, curve, origin) in [(&wheel, &pair.wheel.running, 0.0), (&rail, &pair.placed.curve, 0.75)] {
        assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        for [y, z] in rows {
            let distance = curve.closest(&Point2::new(origin - 1e-3 * y, 1e-3 * z)).1;
            assert!(distance.abs() < 1e-9, "{y} {z}: {distance}");
        }
    }
    // the gauge face lies 14 mm below the top, 32.5 mm from the origin
    let face = rail.iter().rev().find(|row| row[1] < 14.0).unwrap();
    assert!((face[0] - 32.5).abs() < 0.1, "{face:?}");
    let laws: Value = serde_json::from_str(&text(place.path(), "stiffness_by_angle.json")).unwrap();
    let shifts = laws["shifts"].as_array().unwrap();
    let mut fields = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|end| end != "dat") {
            continue;
        }
        fields += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let load = number_after(&text, "angle under ");
        let field = rows(&text);
        assert!(field.len() >= 2 && field.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        for [angle, stiffness] in field {
            let is_it = |s: &&Value| {
                s["touch"]["contact_angle_deg"]
                    .as_f64()
                    .is_some_and(|a| (a.to_radians() - angle).abs() < 1e-8)
            };
            let shift = shifts.iter().find(is_it).unwrap();
            let at = shift["loads"].as_array().unwrap().iter().find(|l| l["force_kn"] == load).unwrap();
            let beam =
                at["references"].as_array().unwrap().iter().find(|r| r["reference"] == "beam").unwrap();
            let expected = 1e3 * beam["tangent_kn_per_m"].as_f64().unwrap();
            assert!((stiffness / expected - 1.0).abs() < 1e-6, "{stiffness} {expected}");
        }
    }
    assert!(fields >= 3, "{fields}");
}
