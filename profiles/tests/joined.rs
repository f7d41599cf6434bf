//! Short measurements joined to the standard where they end: a rail that ends 2 mm to the field side of its top, a head that ends
//! 13 mm below it, a wheel that begins on the top of its flange.

use nalgebra::{Point2, Vector2};
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile_file::{
    Finding, FindingKind, MeasuredPoint, MeasuredProfile, PrepareOptions, ProfileFormat, ProfileKind,
    Smoothing, prepare,
};
use railspring_profiles::section::{
    rail_section, rail_section_with_head, wheel_section, wheel_section_with_profile,
};

/// One millimetre in metres.
const MM: f64 = 1e-3;
/// Distance of the points, m.
const STEP: f64 = 0.2 * MM;

/// A short measurement of a standard.
struct Short {
    name: &'static str,
    kind: ProfileKind,
    standard: ProfileCurve,
    /// Arc lengths of the standard that are measured.
    measured: [f64; 2],
}

fn shorts() -> Vec<Short> {
    let mut shorts = Vec::new();
    for name in ["60E1", "54E1", "49E1"] {
        let standard = rail_section(name).unwrap().running;
        let at_depth = |depth: f64| {
            let places = standard.sample_parameters(0.01 * MM);
            places.into_iter().find(|&s| standard.point(s).y < depth).unwrap()
        };
        let (whole, deep) = (standard.length(), at_depth(13.0 * MM));
        let top = standard.s_at_y(2.0 * MM).unwrap();
        for measured in [[0.0, top], [deep, whole - deep]] {
            shorts.push(Short { name, kind: ProfileKind::Rail, standard: standard.clone(), measured });
        }
    }
    for name in ["S1002", "EN13715-1in40"] {
        let standard = wheel_section(name, 0.92).unwrap().running;
        let places = standard.sample_parameters(0.01 * MM);
        let tip =
            places.into_iter().max_by(|a, b| standard.point(*a).y.total_cmp(&standard.point(*b).y)).unwrap();
        let measured = [tip, standard.length()];
        shorts.push(Short { name, kind: ProfileKind::Wheel, standard, measured });
    }
    shorts
}

impl Short {
    /// The running surface of the section, measured with `depth` (m) of wear and a scatter of `scatter` (m).
    fn joined(&self, depth: f64, scatter: f64, smoothing: Smoothing) -> (ProfileCurve, Vec<Finding>) {
        let [from, to] = self.measured;
        let count = ((to - from) / STEP) as usize;
        let mut state = 7u64;
        let mut even = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let inwards = if self.kind == ProfileKind::Rail { -1.0 } else { 1.0 };
        let points = (0..=count).map(|i| {
            let s = from + (to - from) * i as f64 / count as f64;
            let noise = Vector2::new(even(), even()) * (12.0f64.sqrt() * scatter);
            let normal = self.standard.upward_normal(s);
            let point = self.standard.point(s) + inwards * depth * normal + noise;
            MeasuredPoint { point, line: i + 1, weight: 1.0 }
        });
        let profile = MeasuredProfile {
            name: "made".into(),
            format: ProfileFormat::Text,
            kind: self.kind,
            points: points.collect(),
            findings: Vec::new(),
            drawn: None,
            side_by_groove: false,
        };
        let curve = prepare(&profile, &PrepareOptions { smoothing }).unwrap().curve;
        let mut findings = Vec::new();
        let running = match self.kind {
            ProfileKind::Rail => {
                rail_section_with_head(rail_section(self.name).unwrap(), &curve, &mut findings)
                    .unwrap()
                    .running
            }
            ProfileKind::Wheel => {
                let wheel = wheel_section(self.name, 0.92).unwrap();
                wheel_section_with_profile(wheel, &curve, &mut findings).unwrap().running
            }
        };
        (running, findings)
    }
}

/// Distance from a joint at which both sides are taken, m: small against the radius that a spline through scattered points may have there.
const BESIDE: f64 = 1e-12;

/// Largest jump of the position (m) and of the slope (rad) of a curve, its real corners left out.
fn jumps(curve: &ProfileCurve) -> [f64; 2] {
    let corner = |s: f64| curve.kinks().iter().any(|kink| (kink - s).abs() < 0.01 * MM);
    let mut most = [0.0_f64; 2];
    for s in curve.breakpoints().into_iter().filter(|s| !corner(*s)) {
        let (before, after) = (s - BESIDE, s + BESIDE);
        most[0] = most[0].max((curve.point(after) - curve.point(before)).norm());
        most[1] = most[1].max(curve.tangent(before).angle(&curve.tangent(after)));
    }
    most
}

fn farthest(curve: &ProfileCurve, from: &ProfileCurve) -> f64 {
    curve.sample(0.05 * MM).iter().map(|p: &Point2<f64>| from.closest(p).1).fold(0.0, f64::max)
}

/// Source: the standards themselves, measured with points 0.2 mm apart, unworn and worn evenly by 1 mm. Goal: no jump of position or
/// slope where measured and standard surface meet, and between them no farther from the standard than the wear, or the scatter of
/// 10 µm, explains. Accuracy: ROUNDOFF of arc lengths and tangents. DISCRETISATION, a cubic of 3 mm for arcs and lines, of
/// which one may bend where the other does not. SCATTER, the direction of an end from its last 2 mm, uncertain by 0.02 rad, over such a cubic, with
/// the scatter of the points themselves.
#[test]
fn short_measurements_are_joined_without_a_jump() {
    const ROUNDOFF: f64 = 1e-6;
    const DISCRETISATION: f64 = 0.012 * MM;
    const SCATTER: f64 = 0.06 * MM;
    let (off, smooth) = (Smoothing::Off, Smoothing::ByScatter);
    for short in shorts() {
        for (depth, scatter, smoothing) in [
            (0.0, 0.0, smooth),
            (MM, 0.0, smooth),
            (0.0, 10e-6, off),
            (0.0, 10e-6, smooth),
            (MM, 10e-6, smooth),
        ] {
            let (curve, findings) = short.joined(depth, scatter, smoothing);
            let [position, slope] = jumps(&curve);
            let off = farthest(&curve, &short.standard) - depth;
            let what = format!("{} {:?} {depth} {scatter} {smoothing:?}", short.name, short.measured);
            println!(
                "{what}: position {position:.1e} m, slope {slope:.1e} rad, {:.4} mm beyond the wear",
                off / MM
            );
            assert!(position < 3.0 * BESIDE && slope < ROUNDOFF, "{what}: {position} {slope}");
            let allowed = if scatter > 0.0 { SCATTER } else { DISCRETISATION };
            assert!(off < allowed, "{what}: {off}");
            assert_eq!(findings.iter().filter(|f| f.kind == FindingKind::Joined).count(), 2);
        }
    }
}
