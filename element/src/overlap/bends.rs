//! How a profile bends: its sharpest curvature, its waves, and where its curvature jumps.

use railspring_profiles::profile::ProfileCurve;

/// The least distance of stations, m, where a measured profile that is not smoothed has short waves.
pub(super) const LEAST_STATION: f64 = 0.1e-3;

/// Curvatures that differ by more than this make a wave, 1/m: within a millimetre they move a penetration by 25 µm. Standards have none.
const WAVE: f64 = 200.0;

/// The largest jump of a curvature within a smooth part, 1/m; the parts of S1002's throat have jumps of a twentieth of that.
const LARGEST_JUMP: f64 = 1.0;

/// Beside a joint the curvature is looked at so far from it, m.
const BESIDE: f64 = 1e-6;

/// How a profile bends.
pub(super) struct Bends {
    /// Its sharpest curvature either way, 1/m.
    pub sharpest: f64,
    /// Its shortest wave, m: twice the way from a curvature to one that differs from it by a wave's, the other way round from before; infinite without waves.
    pub shortest_wave: f64,
}

impl Bends {
    pub fn of(curve: &ProfileCurve) -> Self {
        let mut bends = Self { sharpest: 0.0, shortest_wave: f64::INFINITY };
        // the last crest or trough, and what may become the next one
        let mut turned: Option<f64> = None;
        let [mut low, mut high] = [(f64::INFINITY, 0.0), (f64::NEG_INFINITY, 0.0)];
        let mut rises: Option<bool> = None;
        for s in curve.sample_parameters(0.5 * LEAST_STATION) {
            let here = (curve.curvature(s), s);
            bends.sharpest = bends.sharpest.max(here.0.abs());
            (low, high) =
                (if here.0 < low.0 { here } else { low }, if here.0 > high.0 { here } else { high });
            let [falls, climbs] = [high.0 - here.0 > WAVE, here.0 - low.0 > WAVE];
            let turn = match rises {
                Some(true) | None if falls => Some((high.1, false)),
                Some(false) | None if climbs => Some((low.1, true)),
                _ => None,
            };
            let Some((at, up)) = turn else { continue };
            // the end of a profile is no crest
            if let Some(last) = turned.filter(|last| *last > 0.0) {
                bends.shortest_wave = bends.shortest_wave.min(2.0 * (at - last));
            }
            (turned, rises) = (Some(at), Some(up));
            (low, high) = (here, here);
        }
        bends
    }
}

/// Arc lengths at which the curvature of a profile jumps by so much that the rule is divided there, m.
pub(super) fn joints(curve: &ProfileCurve) -> Vec<f64> {
    let jumps = |s: &f64| {
        let [before, behind] = [-BESIDE, BESIDE].map(|by| curve.curvature(s + by));
        (behind - before).abs() > LARGEST_JUMP
    };
    curve.breakpoints().into_iter().filter(jumps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;
    use railspring_profiles::section::{rail_section, wheel_section};

    /// Goal: the length of a profile's waves (m), and none of standards, of waves so flat that stations a millimetre apart see them, or of a single bend. Accuracy: the places at which the curvature is looked at,
    /// half of [`LEAST_STATION`] apart, at both ends of half a wave.
    #[test]
    fn waves_have_their_length() {
        for (length, height, waves) in [(0.9e-3, 8e-6, true), (2.5e-3, 40e-6, true), (2.5e-3, 8e-6, false)] {
            let wave = |y: f64| height * (std::f64::consts::TAU * y / length).cos();
            let points: Vec<Point2<f64>> =
                (-200..=200).map(|i| 0.1e-3 * f64::from(i)).map(|y| Point2::new(y, wave(y))).collect();
            let found = Bends::of(&ProfileCurve::from_points(&points, &[]).unwrap()).shortest_wave;
            assert_eq!(found.is_finite(), waves, "{length} {height}: {found}");
            assert!(!waves || (found - length).abs() < 2.0 * LEAST_STATION, "{length}: {found}");
        }
        let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.92).unwrap());
        for standard in [&rail.running, &wheel.running] {
            assert!(Bends::of(standard).shortest_wave.is_infinite());
        }
    }
}
