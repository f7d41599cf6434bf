//! The solid of a result at any load of its range.

use super::side::Side;
use super::values::Value;
use crate::results::springs::band_record::BandPointRecord;
use crate::results::springs::record::{ReferenceRecord, TangentRecord};

/// Most loads at which two results are compared.
const LOADS: usize = 8;
/// Loads that differ by less, relative, are the same.
const SAME: f64 = 1e-9;

/// Displacement and tangent of the solid over the load, with their error bands.
pub(super) struct Solid<'a> {
    points: &'a [TangentRecord],
    band: &'a [BandPointRecord],
}

impl<'a> Solid<'a> {
    /// That of a result with a reference; none where it has no point.
    pub fn of(side: &'a Side, reference: &str) -> Option<Self> {
        let found: &ReferenceRecord =
            side.stiffness.references.iter().find(|found| found.reference == reference)?;
        let band = side.stiffness.error_band.as_ref().and_then(|band| band.of(reference));
        let points = &found.points[..];
        (!points.is_empty()).then_some(Self { points, band: band.map_or(&[], |band| &band.points[..]) })
    }

    /// Smallest and largest load, kN.
    pub fn range(&self) -> [f64; 2] {
        [self.points[0].force_kn, self.points[self.points.len() - 1].force_kn]
    }

    /// Displacement, mm, and tangent, kN/m, at a load within the range: between two loads the displacement is the cubic with the slopes of their
    /// tangents, and the compliance runs straight.
    pub fn at(&self, force_kn: f64) -> Option<[Value; 2]> {
        let [first, last] = self.range();
        if !(force_kn >= first * (1.0 - SAME) && force_kn <= last * (1.0 + SAME)) {
            return None;
        }
        let bands = [|p: &BandPointRecord| p.displacement, |p: &BandPointRecord| p.tangent];
        let bands = bands.map(|of| self.band_at(force_kn, of));
        let next = self.points.iter().position(|p| p.force_kn >= force_kn * (1.0 - SAME))?;
        let right = &self.points[next];
        if next == 0 || (right.force_kn - force_kn).abs() <= SAME * force_kn {
            return Some([
                Value::with_band(right.displacement_mm, bands[0]),
                Value::with_band(right.tangent_kn_per_m, bands[1]),
            ]);
        }
        let left = &self.points[next - 1];
        let width = right.force_kn - left.force_kn;
        let t = (force_kn - left.force_kn) / width;
        // mm/kN
        let [slope_left, slope_right] = [left, right].map(|p| 1e3 / p.tangent_kn_per_m);
        let displacement = (1.0 + 2.0 * t) * (1.0 - t).powi(2) * left.displacement_mm
            + t * (1.0 - t).powi(2) * width * slope_left
            + t * t * (3.0 - 2.0 * t) * right.displacement_mm
            + t * t * (t - 1.0) * width * slope_right;
        let compliance = slope_left + t * (slope_right - slope_left);
        Some([Value::with_band(displacement, bands[0]), Value::with_band(1e3 / compliance, bands[1])])
    }

    /// A relative band, straight between the loads that have one.
    fn band_at(&self, force_kn: f64, of: fn(&BandPointRecord) -> Option<f64>) -> Option<f64> {
        let next = self.band.iter().position(|p| p.force_kn >= force_kn * (1.0 - SAME))?;
        let right = &self.band[next];
        if next == 0 || (right.force_kn - force_kn).abs() <= SAME * force_kn {
            return of(right);
        }
        let left = &self.band[next - 1];
        let t = (force_kn - left.force_kn) / (right.force_kn - left.force_kn);
        Some((1.0 - t) * of(left)? + t * of(right)?)
    }
}

/// Loads of A that lie in the range of B, some of them from the smallest to the largest, kN.
pub(super) fn loads(a: &Solid<'_>, b: &Solid<'_>) -> Vec<f64> {
    let common: Vec<f64> =
        a.points.iter().map(|p| p.force_kn).filter(|force| b.at(*force).is_some()).collect();
    let chosen = LOADS.min(common.len());
    (0..chosen).map(|n| common[n * (common.len() - 1) / (chosen - 1).max(1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points at loads with a tangent of 100 kN/m at each, and bands that are 0.01, 0.02, … of them.
    fn points(loads: &[f64]) -> (Vec<TangentRecord>, Vec<BandPointRecord>) {
        let point = |&force_kn: &f64| TangentRecord {
            force_kn,
            displacement_mm: 10.0 * force_kn,
            tangent_kn_per_m: 100.0,
        };
        let band = |(n, &force_kn): (usize, &f64)| BandPointRecord {
            force_kn,
            grid_displacement: None,
            grid_tangent: None,
            mesh_displacement: None,
            mesh_tangent: None,
            scatter_displacement: None,
            scatter_tangent: None,
            displacement: Some(0.01 * (n + 1) as f64),
            tangent: (n != 2).then_some(0.1 * (n + 1) as f64),
        };
        (loads.iter().map(point).collect(), loads.iter().enumerate().map(band).collect())
    }

    /// Goal: a band runs straight between the loads that have one, and is none beside one that has none; at a load it is that load's. Beyond
    /// the loads there is no value. Accuracy: ROUNDOFF.
    #[test]
    fn bands_are_straight_between_loads() {
        const ROUNDOFF: f64 = 1e-12;
        let (points, band) = points(&[10.0, 20.0, 40.0]);
        let solid = Solid { points: &points, band: &band };
        let shares = |force: f64| solid.at(force).unwrap().map(|value| value.error.map(|e| e / value.value));
        let near = |found: Option<f64>, expected: f64| (found.unwrap() - expected).abs() < ROUNDOFF;
        let [displacement, tangent] = shares(12.5);
        assert!(near(displacement, 0.0125) && near(tangent, 0.125), "{displacement:?} {tangent:?}");
        let [displacement, tangent] = shares(20.0);
        assert!(near(displacement, 0.02) && near(tangent, 0.2), "{displacement:?} {tangent:?}");
        let [displacement, tangent] = shares(30.0);
        assert!(near(displacement, 0.025) && tangent.is_none(), "{displacement:?} {tangent:?}");
        for force in [9.999, 40.001, f64::NAN] {
            assert!(solid.at(force).is_none(), "{force}");
        }
    }

    /// Goal: at most eight loads, from the smallest to the largest that lie in both ranges, spread over those between.
    #[test]
    fn loads_are_spread_over_what_both_have() {
        let all: Vec<f64> = (1..=30).map(|n| 5.0 * f64::from(n)).collect();
        let ((first, _), (second, _)) = (points(&all), points(&[20.0, 130.0]));
        let [a, b] = [&first, &second].map(|points| Solid { points, band: &[] });
        let chosen = loads(&a, &b);
        assert_eq!((chosen.len(), chosen[0], chosen[7]), (8, 20.0, 130.0), "{chosen:?}");
        assert!(chosen.windows(2).all(|pair| (10.0..=20.0).contains(&(pair[1] - pair[0]))), "{chosen:?}");
        assert_eq!(loads(&b, &a), [20.0, 130.0]);
    }
}
