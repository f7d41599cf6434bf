//! The law beside a measured curve (ASME V&V 20): error of the model, and the uncertainty with which it is known.

use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::springs::record::{ReferenceRecord, StiffnessRecord, TangentRecord};
use crate::results::springs::uncertainty_record::between_loads;
use crate::rounding::significant;
use crate::study::{ForceCurve, MeasuredForce, ZeroKey};

/// Half widths of bands of 95 % over standard uncertainties.
pub(crate) const TWICE: f64 = 2.0;

/// The law in use beside a measured curve. With the error `E = model - measured` and its standard uncertainty `u_val = √(u_num² + u_input² + u_D²)`
/// the model's own error lies within `E ± 2·u_val` in 95 of 100 cases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValidationRecord {
    /// File of the curve, as the study names it.
    pub file: String,
    /// BLAKE3 hash of its content.
    pub blake3: String,
    /// What the displacement of both is measured against.
    pub reference: String,
    /// Where it is counted from: `touching` or `first-line`.
    pub zero: String,
    /// The points of the curve that the law has.
    pub points: Vec<ValidationPointRecord>,
    /// Points beyond the loads at which the law ends.
    pub beyond: usize,
    /// What `u_val` does not have, so that it is too small.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lacking: Vec<String>,
}

/// A point of the curve; uncertainties are standard ones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValidationPointRecord {
    /// Line of the file.
    pub line: u64,
    /// Force, kN.
    pub force_kn: f64,
    /// Measured displacement, mm.
    pub measured_mm: f64,
    /// Displacement of the solid, mm, between its loads with its tangents.
    pub model_mm: f64,
    /// Model less measurement, mm.
    pub error_mm: f64,
    /// Numerical uncertainty of the model, mm: half of its band.
    pub numerical_mm: f64,
    /// Uncertainty of the model by its inputs, mm.
    pub input_mm: f64,
    /// Uncertainty of the measurement, mm.
    pub measurement_mm: f64,
    /// All together, `u_val`, mm.
    pub validation_mm: f64,
}

impl ValidationPointRecord {
    /// Whether the error is within its own uncertainty, so that the error of the model cannot be distinguished from zero.
    pub fn within(&self) -> bool {
        self.error_mm.abs() <= TWICE * self.validation_mm
    }

    /// Largest size of the model's error in 95 of 100 cases, over the measured displacement; none where that is zero.
    pub fn at_most(&self) -> Option<f64> {
        (self.measured_mm > 0.0)
            .then(|| (self.error_mm.abs() + TWICE * self.validation_mm) / self.measured_mm)
    }
}

impl ValidationRecord {
    /// The point with the largest error over the measured displacement.
    pub fn largest(&self) -> Option<&ValidationPointRecord> {
        let relative = |point: &ValidationPointRecord| (point.error_mm / point.measured_mm).abs();
        let known = self.points.iter().filter(|point| point.measured_mm > 0.0);
        known.max_by(|a, b| relative(a).total_cmp(&relative(b)))
    }

    /// Largest size of the model's error in 95 of 100 cases, over the measured displacement.
    pub fn at_most(&self) -> Option<f64> {
        self.points.iter().filter_map(ValidationPointRecord::at_most).reduce(f64::max)
    }

    /// What it comes to, a sentence or two.
    pub fn sentence(&self) -> String {
        let Some(worst) = self.largest() else {
            return format!("{}: no point of the curve lies within the loads of the law", self.file);
        };
        let within = self.points.iter().filter(|point| point.within()).count();
        let percent = |part: f64| significant(1e2 * part / worst.measured_mm, 2);
        let mut said = format!(
            "{}: displacement against {} at {} forces from {} to {} kN; largest error {} % at {} kN, known to ±{} % (95 %); at {within} of {} forces the error is within 2 u_val",
            self.file,
            self.reference,
            self.points.len(),
            significant(self.points[0].force_kn, 3),
            significant(self.points[self.points.len() - 1].force_kn, 3),
            percent(worst.error_mm),
            significant(worst.force_kn, 3),
            percent(TWICE * worst.validation_mm),
            self.points.len(),
        );
        if self.beyond > 0 {
            said += &format!("; {} points lie beyond the loads of the law", self.beyond);
        }
        for part in &self.lacking {
            said += &format!("; {part}");
        }
        said
    }
}

/// The law of `stiffness` beside a measured `curve`.
pub(crate) fn validation(curve: &ForceCurve, stiffness: &StiffnessRecord) -> Option<ValidationRecord> {
    let name = stiffness.reference.as_str();
    let law = stiffness.references.iter().find(|found| found.reference == name)?;
    let ends = law.points.first().zip(law.points.last())?;
    let range = ends.0.force_kn..=ends.1.force_kn;
    let force_kn = |point: &MeasuredForce| point.force / KILONEWTON;
    let (inside, outside): (Vec<&MeasuredForce>, Vec<&MeasuredForce>) =
        curve.points.iter().partition(|point| range.contains(&force_kn(point)));
    let parts = relative_uncertainties(stiffness);
    let mut lacking = Vec::new();
    if parts.numerical.is_none() {
        lacking.push("the numerical uncertainty is not known and not in it".to_owned());
    }
    if parts.input.is_none() {
        lacking.push("the uncertainty of the inputs is not known and not in it".to_owned());
    }
    if inside.iter().any(|point| point.standard_uncertainty.is_none()) {
        lacking.push("the uncertainty of the measurement is not given and not in it".to_owned());
    }
    let (measured_zero, model_zero) = match (curve.zero, inside.first()) {
        (ZeroKey::FirstLine, Some(first)) => {
            (first.displacement / MILLIMETRE, displacement(law, force_kn(first)))
        }
        _ => (0.0, 0.0),
    };
    let points = inside.iter().map(|point| {
        let force_kn = force_kn(point);
        let model_mm = displacement(law, force_kn) - model_zero;
        let measured_mm = point.displacement / MILLIMETRE - measured_zero;
        let part =
            |of: &Option<Vec<(f64, f64)>>| of.as_ref().map_or(0.0, |of| at(of, force_kn) * model_mm / TWICE);
        let (numerical_mm, input_mm) = (part(&parts.numerical), part(&parts.input));
        let measurement_mm = point.standard_uncertainty.unwrap_or(0.0) / MILLIMETRE;
        ValidationPointRecord {
            line: point.line,
            force_kn,
            measured_mm,
            model_mm,
            error_mm: model_mm - measured_mm,
            numerical_mm,
            input_mm,
            measurement_mm,
            validation_mm: numerical_mm.hypot(input_mm).hypot(measurement_mm),
        }
    });
    // the first line of a curve that is counted from it says nothing
    let skipped = usize::from(curve.zero == ZeroKey::FirstLine);
    Some(ValidationRecord {
        file: curve.file.clone(),
        blake3: curve.blake3.clone(),
        reference: name.into(),
        zero: match curve.zero {
            ZeroKey::Touching => "touching",
            ZeroKey::FirstLine => "first-line",
        }
        .into(),
        points: points.skip(skipped).collect(),
        beyond: outside.len(),
        lacking,
    })
}

/// Half widths of the bands of 95 % of the displacement, relative, over the load (kN).
struct Relative {
    numerical: Option<Vec<(f64, f64)>>,
    input: Option<Vec<(f64, f64)>>,
}

fn relative_uncertainties(stiffness: &StiffnessRecord) -> Relative {
    let bands = stiffness.error_band.as_ref().and_then(|band| band.of(&stiffness.reference));
    let numerical = bands
        .filter(|band| band.largest().is_some())
        .map(|band| band.points.iter().map(|point| (point.force_kn, point.numerical()[0])).collect());
    let input = stiffness.input_uncertainty.as_ref().filter(|of| !of.points.is_empty());
    let input = input.map(|of| of.points.iter().map(|p| (p.force_kn, p.displacement.input)).collect());
    Relative { numerical, input }
}

/// A value between those at some loads, over the logarithm of the load.
fn at(values: &[(f64, f64)], force_kn: f64) -> f64 {
    let loads: Vec<f64> = values.iter().map(|(load, _)| *load).collect();
    if loads.len() < 2 {
        return values.first().map_or(0.0, |(_, value)| *value);
    }
    let (below, part) = between_loads(&loads, force_kn);
    values[below].1 + part * (values[below + 1].1 - values[below].1)
}

/// Displacement of the solid, mm, at a force between its loads: the cubic with its displacements and tangents at these.
fn displacement(law: &ReferenceRecord, force_kn: f64) -> f64 {
    let points = &law.points;
    let after = points.partition_point(|point| point.force_kn < force_kn).clamp(1, points.len() - 1);
    let (a, b) = (&points[after - 1], &points[after]);
    let length = b.force_kn - a.force_kn;
    let t = ((force_kn - a.force_kn) / length).clamp(0.0, 1.0);
    let slope =
        |point: &TangentRecord| length * KILONEWTON / (point.tangent_kn_per_m * KILONEWTON) / MILLIMETRE;
    let (start, end) = ((1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t), t * t * (3.0 - 2.0 * t));
    start * a.displacement_mm
        + end * b.displacement_mm
        + t * (1.0 - t) * ((1.0 - t) * slope(a) - t * slope(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// A curve of the law of the sample, whose displacements are `off` times its own.
    fn curve(stiffness: &StiffnessRecord, off: impl Fn(f64) -> f64, zero: ZeroKey) -> ForceCurve {
        let law = stiffness.references.iter().find(|found| found.reference == stiffness.reference).unwrap();
        let points = law.points.iter().enumerate().step_by(2).map(|(line, p)| MeasuredForce {
            line: line as u64 + 2,
            force: p.force_kn * 1e3,
            displacement: off(p.force_kn) * p.displacement_mm * 1e-3,
            standard_uncertainty: Some(1e-6),
        });
        ForceCurve { file: "c.csv".into(), blake3: String::new(), zero, points: points.collect() }
    }

    /// Source: the sample's own displacements, and ASME V&V 20 in its numbers. Goal: a curve that is the law has no error; one that is 3 % short has 3/97 of it
    /// at each point; u_val is the root of the squares; from the first line on, an offset of all displacements does not matter. Accuracy: rounding.
    #[test]
    fn errors_have_their_uncertainty() {
        const ROUNDOFF: f64 = 1e-12;
        let stiffness = samples::stiffness();
        let same = validation(&curve(&stiffness, |_| 1.0, ZeroKey::Touching), &stiffness).unwrap();
        assert!(same.points.len() > 5 && same.beyond == 0 && same.lacking.is_empty(), "{same:?}");
        assert!(same.points.iter().all(|p| p.error_mm.abs() < ROUNDOFF && p.within()));
        let short = validation(&curve(&stiffness, |_| 0.97, ZeroKey::Touching), &stiffness).unwrap();
        for point in &short.points {
            assert!((point.error_mm / point.measured_mm - 3.0 / 97.0).abs() < ROUNDOFF, "{point:?}");
            let parts = [point.numerical_mm, point.input_mm, point.measurement_mm];
            let u: f64 = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
            assert!((point.validation_mm / u - 1.0).abs() < ROUNDOFF && parts.iter().all(|part| *part > 0.0));
            assert!((point.measurement_mm - 1e-3).abs() < ROUNDOFF);
        }
        let shifted = |off_mm: f64| {
            let mut curve = curve(&stiffness, |_| 0.97, ZeroKey::FirstLine);
            curve.points.iter_mut().for_each(|point| point.displacement += off_mm * 1e-3);
            validation(&curve, &stiffness).unwrap()
        };
        let (one, other) = (shifted(0.0), shifted(0.4));
        assert_eq!(one.points.len(), short.points.len() - 1);
        for (a, b) in one.points.iter().zip(&other.points) {
            assert!((a.error_mm - b.error_mm).abs() < ROUNDOFF, "{a:?} {b:?}");
        }
    }

    /// Source: the law `k = a + b·f^c` of the sample, whose points lie on its integral to 1 %. Goal: between loads the displacement is that of the cubic: with the middle
    /// of an interval of the loads it differs from the next points' mean by less than the curve bends. Accuracy: the eighth part of the change of the tangent.
    #[test]
    fn displacements_between_loads_follow_the_tangents() {
        let stiffness = samples::stiffness();
        let law = stiffness.references.iter().find(|found| found.reference == stiffness.reference).unwrap();
        for pair in law.points.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let middle = displacement(law, 0.5 * (a.force_kn + b.force_kn));
            let compliance = |p: &TangentRecord| 1e3 / p.tangent_kn_per_m;
            let bend = (b.force_kn - a.force_kn) * (compliance(a) - compliance(b)) / 8.0;
            let expected = 0.5 * (a.displacement_mm + b.displacement_mm) + bend;
            assert!((middle - expected).abs() < 1e-12, "{middle} {expected}");
            for end in [a, b] {
                assert!((displacement(law, end.force_kn) - end.displacement_mm).abs() < 1e-12);
            }
        }
    }

    /// Goal: without bands, or an uncertainty of the measurement, the record says what it lacks; points beyond the law are counted.
    #[test]
    fn what_is_not_known_is_said() {
        let mut stiffness = samples::stiffness();
        let mut measured = curve(&stiffness, |_| 1.0, ZeroKey::Touching);
        (stiffness.error_band, stiffness.input_uncertainty) = (None, None);
        measured.points[1].standard_uncertainty = None;
        let last = measured.points.len() - 1;
        measured.points[last].force = 200e3;
        let found = validation(&measured, &stiffness).unwrap();
        assert_eq!((found.lacking.len(), found.beyond), (3, 1), "{found:?}");
        assert!(found.sentence().contains("1 points lie beyond"), "{}", found.sentence());
    }
}
