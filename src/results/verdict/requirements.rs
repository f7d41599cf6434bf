//! Lines of the verdict on what the intended use of the springs asks for.

use crate::results::springs::record::StiffnessRecord;
use crate::results::springs::uncertainty_record::{UncertainPointRecord, UncertainRecord};
use crate::results::verdict::validation::ValidationRecord;
use crate::rounding::significant;
use crate::study::IntendedUseKeys;
use crate::verify::{Criterion, Kind, Line};

/// A line for each requirement of the study. One whose value is not known fails.
pub(crate) fn requirements(
    of: &IntendedUseKeys,
    stiffness: Option<&StiffnessRecord>,
    validation: Option<&ValidationRecord>,
) -> Vec<Line> {
    let criterion = |quantity, meaning, percent: f64| Criterion {
        quantity,
        meaning,
        kind: Kind::Acceptance,
        unit: "1",
        limit: 1e-2 * percent,
    };
    let at_loads = |of: Criterion, take: fn(&UncertainPointRecord) -> &UncertainRecord| {
        let points = stiffness.and_then(|found| found.input_uncertainty.as_ref()).map(|of| &of.points);
        let values = points.map(|points| {
            points
                .iter()
                .map(|point| Some((take(point).combined?, point.force_kn)))
                .collect::<Option<Vec<_>>>()
        });
        let largest = values.flatten().and_then(|all| all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)));
        match largest {
            Some((value, force_kn)) => {
                of.line(Some(value)).noted(format!("at {} kN", significant(force_kn, 3)))
            }
            None => of.line(None).noted(unknown(stiffness)),
        }
    };
    let mut lines = Vec::new();
    lines.extend(of.displacement_percent.map(|percent| {
        let meaning = "Uncertainty of the displacement (95 %), inputs and numerics, largest over the loads";
        at_loads(criterion("displacement_percent", meaning, percent), |point| &point.displacement)
    }));
    lines.extend(of.tangent_percent.map(|percent| {
        let meaning =
            "Uncertainty of the tangent stiffness (95 %), inputs and numerics, largest over the loads";
        at_loads(criterion("tangent_percent", meaning, percent), |point| &point.tangent)
    }));
    lines.extend(of.horizontal_percent.map(|percent| {
        let meaning = "Uncertainty of the horizontal stiffness (95 %), inputs and numerics";
        let of = criterion("horizontal_percent", meaning, percent);
        let uncertain = stiffness.and_then(|found| found.input_uncertainty.as_ref()?.horizontal.as_ref());
        match uncertain.and_then(|uncertain| uncertain.combined) {
            Some(value) => of.line(Some(value)),
            None => of.line(None).noted(unknown(stiffness)),
        }
    }));
    lines.extend(of.displacement_percent.zip(validation).map(|(percent, validation)| {
        let meaning = "Error of the displacement against the measured curve with its uncertainty (95 %), largest over the measured displacement";
        let line = criterion("measured_displacement", meaning, percent).line(validation.at_most());
        line.noted(validation.sentence())
    }));
    lines
}

/// Why the uncertainty of springs is not known.
fn unknown(stiffness: Option<&StiffnessRecord>) -> String {
    let Some(stiffness) = stiffness else {
        return "the load cases ran with springs that are not the study's own".into();
    };
    let reason = stiffness.input_uncertainty.as_ref().and_then(|of| of.missing.clone());
    reason.unwrap_or_else(|| match &stiffness.error_band {
        None => "without error bands (calibration.error_band = false) it is not known".into(),
        Some(_) => "a part of the error band is missing".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// Goal: each requirement is a line with the largest uncertainty of the sample over its loads, which holds from that on and fails below it; without a
    /// band it fails; none is asked for by default.
    #[test]
    fn requirements_are_lines() {
        let stiffness = samples::stiffness();
        assert_eq!(requirements(&IntendedUseKeys::default(), Some(&stiffness), None), []);
        let uncertain = stiffness.input_uncertainty.as_ref().unwrap();
        let largest = uncertain.points.iter().map(|p| p.tangent.combined.unwrap()).fold(0.0, f64::max);
        let with = |percent: f64, stiffness: &StiffnessRecord| {
            let of = IntendedUseKeys {
                displacement_percent: Some(1e3),
                tangent_percent: Some(percent),
                horizontal_percent: Some(1e3),
                ..IntendedUseKeys::default()
            };
            requirements(&of, Some(stiffness), None)
        };
        let kept = with(101.0 * largest, &stiffness);
        assert!(kept.len() == 3 && kept.iter().all(|line| line.holds), "{kept:?}");
        let missed = with(99.0 * largest, &stiffness);
        assert!(!missed[1].holds && missed[1].value.is_some(), "{missed:?}");
        let mut without = stiffness.clone();
        (without.error_band, without.input_uncertainty) = (None, None);
        let unknown = with(101.0 * largest, &without);
        assert!(unknown.iter().all(|line| !line.holds && line.value.is_none()), "{unknown:?}");
    }
}
