//! A wheel pressed along any direction of the section, on bodies whose compliance is known.

use faer::Mat;
use nalgebra::{Point2, Unit, Vector2};
use railspring_calibrate::calibration::{
    ContactField, DOWNWARDS, Enforcement, LoadPoint, PatchValues, Pressed, Reference, WheelOnRail,
    load_points, press_loads,
};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::mesh::SurfaceGrid;
use railspring_calibrate::solid::Material;
use railspring_profiles::monitor::Silent;
use railspring_profiles::profile::ProfileCurve;
use std::sync::OnceLock;

/// A symmetric crown of a rail and a symmetric wheel, m, with contact nodes that a smooth and isotropic compliance connects.
struct Bodies {
    rail: ProfileCurve,
    wheel: ProfileCurve,
    grids: [SurfaceGrid; 2],
    compliances: [Mat<f64>; 2],
}

const ROLLING_RADIUS: f64 = 0.46;
/// Radius of the rail's crown and of the wheel's hollow, m: a shift of the wheel moves the contact around the crown.
const RAIL_RADIUS: f64 = 0.08;
const WHEEL_RADIUS: f64 = 0.3;

impl Bodies {
    fn new() -> Self {
        // arcs of a circle, as far as 28° to both sides
        let arc = |radius: f64| {
            let point = |i: i32| {
                let angle = f64::from(i) * 0.005;
                Point2::new(radius * angle.sin(), radius * (1.0 - angle.cos()))
            };
            ProfileCurve::from_points(&(-98..=98).map(point).collect::<Vec<_>>(), &[]).unwrap()
        };
        let rail = arc(RAIL_RADIUS);
        let wheel = arc(WHEEL_RADIUS);
        // along the track by x on the rail, by the angle on the wheel
        let grid = |curve: &ProfileCurve, spacing: f64, radius: f64| {
            let half = (0.5 * curve.length() / spacing).floor() as i32 - 1;
            let s = |i: i32| 0.5 * curve.length() + f64::from(i) * spacing;
            let along_profile: Vec<f64> = (-half..=half).map(s).collect();
            let along_track: Vec<f64> = (-7..=7).map(|k| f64::from(k) * 1.5e-3 / radius).collect();
            let nodes = (0..along_profile.len() * along_track.len()).collect();
            SurfaceGrid { along_profile, along_track, nodes }
        };
        let grids = [grid(&rail, 2e-3, 1.0), grid(&wheel, 2e-3, ROLLING_RADIUS)];
        let compliances =
            [(&rail, &grids[0], 1.0), (&wheel, &grids[1], ROLLING_RADIUS)].map(|(curve, grid, radius)| {
                let places: Vec<[f64; 3]> = grid
                    .along_profile
                    .iter()
                    .flat_map(|&s| {
                        let p = curve.point(s);
                        grid.along_track.iter().map(move |&x| [p.x, p.y, x * radius])
                    })
                    .collect();
                // exponential of the distance: positive definite, and the same for every turn and reflection
                Mat::from_fn(3 * places.len(), 3 * places.len(), |r, c| {
                    let (a, b) = (places[r / 3], places[c / 3]);
                    let distance = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
                    if r % 3 == c % 3 { 1e-9 * (-distance / 2e-3).exp() } else { 0.0 }
                })
            });
        Self { rail, wheel, grids, compliances }
    }

    /// The wheel shifted by `shift`, lowered until it touches, pressed with the loads along `along`, and the angle of the contact.
    fn press(
        &self,
        shift: f64,
        along: impl Fn(f64) -> Unit<Vector2<f64>>,
        friction: f64,
        loads: &[f64],
    ) -> (f64, Vec<Pressed>, Vec<(LoadPoint, PatchValues)>) {
        // circles touch on the line through their centres
        let apart = WHEEL_RADIUS - RAIL_RADIUS;
        let angle = (shift / apart).asin();
        let height = apart * (angle.cos() - 1.0);
        let pair = WheelOnRail {
            bodies: railspring_calibrate::calibration::Bodies::Condensed {
                rail: &self.compliances[0],
                wheel: &self.compliances[1],
                mirrored: false,
            },
            rail_surface: Surface::extruded(&self.rail, &self.grids[0]),
            wheel_surface: Surface::revolved(
                &self.wheel,
                &self.grids[1],
                ROLLING_RADIUS,
                Vector2::new(shift, height),
            ),
            friction,
            enforcement: Enforcement::Exact,
            field: ContactField::Elements,
            materials: [Material::STEEL; 2],
            along: along(angle),
            beyond: OnceLock::new(),
        };
        let states = press_loads(&pair, loads, "press", &Silent).unwrap();
        let points = load_points(&pair, &states, Reference::Foot).unwrap();
        let patches = states.iter().map(|state| pair.patch(state).unwrap().values);
        let points = points.into_iter().zip(patches).collect();
        (angle, states, points)
    }
}

/// Along the normal of the contact.
fn normal(angle: f64) -> Unit<Vector2<f64>> {
    Unit::new_normalize(Vector2::new(angle.sin(), angle.cos()))
}

const LOADS: [f64; 5] = [5e3, 10e3, 20e3, 40e3, 80e3];

/// Source: equilibrium without friction. A wheel is pressed with its hub held across the direction of
/// pressing. Its normal force is that force over the cosine of the angle between both. Pressed down by P on a
/// slope of the angle α, it is as stiff as cos²α times its stiffness along the normal under P/cos α. It moves
/// by δ/cos α. Goal: both, at 10 and 18 degrees; the resultant of the contact is normal. Units N, m.
/// Accuracy: SOLVER. DISCRETISATION: the contact slides by some hundredths of a millimetre through elements
/// of 2 mm. That is 0.7 % of the tangent at 5 kN, where few nodes carry, and 0.25 % of the displacement.
#[test]
fn a_slope_is_as_stiff_as_the_square_of_its_cosine() {
    const DISCRETISATION: [f64; 2] = [0.004, 0.01];
    const SOLVER: f64 = 1e-8;
    let bodies = Bodies::new();
    for shift in [0.0382, 0.068] {
        let (angle, states, normal) = bodies.press(shift, normal, 0.0, &LOADS);
        let cosine = angle.cos();
        let (_, held, vertical) = bodies.press(shift, |_| DOWNWARDS, 0.0, &LOADS.map(|load| load * cosine));
        for (i, ((v, _), (n, _))) in vertical.iter().zip(&normal).enumerate() {
            let moved = v.displacement * cosine / n.displacement - 1.0;
            let stiff = v.solid_tangent / (cosine * cosine * n.solid_tangent) - 1.0;
            assert!(moved.abs() < DISCRETISATION[0], "{shift} {i}: {moved}");
            assert!(stiff.abs() < DISCRETISATION[1], "{shift} {i}: {stiff}");
            // the hub stays where it is held
            assert!(held[i].hub.x == 0.0);
            let along = Vector2::new(angle.sin(), angle.cos());
            assert!(states[i].hub.perp(&along).abs() < SOLVER * n.displacement);
            let force = -states[i].force_on_wheel().yz().dot(&along);
            assert!((force / n.force - 1.0).abs() < SOLVER, "{force}");
        }
    }
}

/// Goal: a wheel on the other side of a symmetric crown, pressed along the normal there, has the same displacements, tangents and
/// patches with friction, and its hub moves to the other side. Units N, m. Accuracy: SOLVER, 1e-8 of the forces.
#[test]
fn the_other_side_of_a_crown_is_the_mirror_image() {
    const SOLVER: f64 = 1e-7;
    let bodies = Bodies::new();
    let (angle, states, one) = bodies.press(0.05, normal, 0.3, &LOADS);
    let (mirrored, others, other) = bodies.press(-0.05, normal, 0.3, &LOADS);
    assert_eq!(angle, -mirrored);
    for ((a, patch), (b, mirrored)) in one.iter().zip(&other) {
        let pairs = [
            (a.displacement, b.displacement),
            (a.solid_tangent, b.solid_tangent),
            (patch.area, mirrored.area),
            (patch.max_pressure, mirrored.max_pressure),
            (patch.semi_axis_across, mirrored.semi_axis_across),
        ];
        for (a, b) in pairs {
            assert!((a / b - 1.0).abs() < SOLVER, "{a} {b}");
        }
    }
    for (a, b) in states.iter().zip(&others) {
        assert!((a.hub.x + b.hub.x).abs() < SOLVER * a.hub.norm() && a.hub.x > 0.0);
    }
}
