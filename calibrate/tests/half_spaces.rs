//! Profiles pressed on half-spaces, without bodies: closed solutions, and a tangent that is the slope of the displacement.

use nalgebra::{Point2, Unit, Vector2};
use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::calibration::{
    Bodies, ContactField, DOWNWARDS, Enforcement, LoadPoint, Reference, WheelOnRail, load_points,
    press_carried, press_loads,
};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::mesh::{MeshOptions, SurfaceGrid};
use railspring_calibrate::pair::{Pair, PressDirection};
use railspring_calibrate::solid::Material;
use railspring_profiles::error::{Error, StopReason};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::{rail_section, wheel_section};
use std::sync::OnceLock;

/// A parabola of a radius in the middle, 40 mm wide, its material on the other side of the `sign` of z.
fn crown(radius: f64, sign: f64) -> ProfileCurve {
    let point = |y: f64| Point2::new(y, sign * y * y / (2.0 * radius));
    let points: Vec<_> = (-80..=80).map(|i| point(f64::from(i) * 2.5e-4)).collect();
    ProfileCurve::from_points(&points, &[]).unwrap()
}

/// Source: Hertz (K.L. Johnson, Contact Mechanics, 1985, section 4.2). Goal: a wheel of 460 mm with a flat tread on a crown of 300 mm, of two
/// materials: approach, m, and tangent, N/m, from 5 to 100 kN, of which the bodies have no part. Accuracy: DISCRETISATION of ten cells and more across:
/// 0.1 % of the approach, and 0.3 % of the tangent: three times the scatter that is left where some cells of the rim join over the way of a tangent. The tangent of
/// just the points that carry load is up to 1.5 % off.
#[test]
fn half_spaces_are_hertz() {
    const DISCRETISATION: [f64; 2] = [0.001, 0.003];
    let rail = crown(0.3, 1.0);
    let flat: Vec<_> = (-80..=80).map(|i| Point2::new(f64::from(i) * 2.5e-4, 0.0)).collect();
    let wheel = ProfileCurve::from_points(&flat, &[]).unwrap();
    let lines =
        |n: i32, step: f64, middle: f64| (-n..=n).map(|i| middle + f64::from(i) * step).collect::<Vec<_>>();
    let grid = |middle: f64, along: f64| {
        let (s, x) = (lines(9, 2e-3, middle), lines(16, 1.5e-3 / along, 0.0));
        let nodes = (0..s.len() * x.len()).collect();
        SurfaceGrid { along_profile: s, along_track: x, nodes }
    };
    let grids = [grid(0.5 * rail.length(), 1.0), grid(0.5 * wheel.length(), 0.46)];
    let soft = Material { young: 170e9, poisson: 0.26, ..Material::STEEL };
    let placed = WheelOnRail {
        bodies: Bodies::HalfSpaces,
        rail_surface: Surface::extruded(&rail, &grids[0]),
        wheel_surface: Surface::revolved(&wheel, &grids[1], 0.46, Vector2::zeros()),
        friction: 0.0,
        enforcement: Enforcement::Exact,
        field: ContactField::Hybrid,
        materials: [soft, Material::STEEL],
        along: DOWNWARDS,
        beyond: OnceLock::new(),
    };
    let loads: Vec<f64> = (0..12).map(|i| 5e3 * 1.313_f64.powi(i)).collect();
    let states = press_loads(&placed, &loads, "press", &Silent).unwrap();
    for p in load_points(&placed, &states, Reference::HalfSpaces).unwrap() {
        let exact = point_contact(p.force, 0.46, 0.3, soft.contact_modulus(&Material::STEEL)).unwrap();
        let off =
            [p.displacement / exact.approach, p.solid_tangent / exact.tangent_stiffness].map(|r| r - 1.0);
        println!("{:.1} kN: approach, tangent {off:.5?}", p.force * 1e-3);
        assert!(off[0].abs() < DISCRETISATION[0] && off[1].abs() < DISCRETISATION[1], "{off:?}");
        assert!(
            [p.wheel_compliance, p.rail_compliance].iter().all(|part| part.abs() < 1e-9 * p.local_compliance)
        );
    }
}

/// S1002 on 60E1 at a shift (m) on half-spaces, pressed along a direction.
fn on_flange(pair: &Pair, along: Unit<Vector2<f64>>, loads: &[f64]) -> (Vec<LoadPoint>, Option<Error>) {
    let options = MeshOptions { contact_half_length: 24e-3, ..MeshOptions::default() };
    let meshes = pair.mesh(0.2, &options).unwrap();
    let grids = [&meshes.rail.contact, &meshes.wheel.contact];
    let placed = pair.half_spaces_on_rail(grids, [Material::STEEL; 2], ContactField::Hybrid);
    let placed = WheelOnRail { along, ..placed };
    let (states, ended) = press_carried(&placed, loads, "press", &Silent).unwrap();
    (load_points(&placed, &states, Reference::HalfSpaces).unwrap(), ended)
}

fn flange() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.92).unwrap());
    let track = TrackGeometry { lateral_shift: 7e-3, ..TrackGeometry::standard() };
    Pair::new(rail, wheel, &track).unwrap()
}

/// Goal: on the flange at 70 degrees the tangent, N/m, is the slope of the displacement, m, along the normal and downwards, where the wheel slides along the
/// flange and faces the rail elsewhere. Source: the displacement itself, the tangents integrated by trapezia over loads 1.14 apart. Accuracy: TRAPEZIA,
/// 0.02 %, and GRID: 0.1 % of each displacement at either end, over 41 % of it. With gaps that follow the rail's normals it is 4 % off downwards.
#[test]
fn a_tangent_on_the_flange_is_the_slope_of_the_displacement() {
    const GRID: f64 = 0.005;
    let pair = flange();
    for direction in [PressDirection::Normal, PressDirection::Vertical] {
        let along = direction.at(&pair);
        let share = PressDirection::Normal.at(&pair).dot(&along);
        let mut loads: Vec<f64> = (0..25).map(|i| 5e3 * share * 1.142_f64.powi(i)).collect();
        // so that no load is too steep
        loads.push(loads[24] / share * 1.01);
        let (points, _) = on_flange(&pair, along, &loads);
        assert!(points.len() >= 25, "{}", points.len());
        for part in points[..25].windows(5).step_by(4) {
            let way: f64 = part
                .windows(2)
                .map(|w| {
                    0.5 * (w[1].force - w[0].force) * (1.0 / w[0].solid_tangent + 1.0 / w[1].solid_tangent)
                })
                .sum();
            let off = way / (part[4].displacement - part[0].displacement) - 1.0;
            println!("{direction:?}, {:.1} kN: {off:.4}", part[0].force * 1e-3);
            assert!(off.abs() < GRID, "{direction:?} at {} N: {off}", part[0].force);
        }
    }
}

/// Goal: downwards on the flange the loads end where the normal force is a quarter more than the largest of them, with the reason; along
/// the normal they go on. Unit N. Accuracy: exact, by the angle of 70 degrees: 150 kN / cos 70 = 438 kN, and 64 kN are 187.5 kN.
#[test]
fn loads_end_where_the_normal_force_is_too_large() {
    let pair = flange();
    let loads: Vec<f64> = (1..=15).map(|i| f64::from(i) * 10e3).collect();
    let (points, ended) = on_flange(&pair, DOWNWARDS, &loads);
    assert_eq!(points.len(), 6, "{}", points.len());
    let Some(Error::Numerics(ended)) = ended else { panic!("{ended:?}") };
    assert_eq!((ended.reason, ended.step), (StopReason::SteepContact, Some(7)));
    assert!(ended.stage.contains("70.000 kN") && ended.stage.contains("normal force 204"), "{ended}");
    let (points, ended) = on_flange(&pair, PressDirection::Normal.at(&pair), &loads);
    assert!(points.len() == 15 && ended.is_none(), "{ended:?}");
}
