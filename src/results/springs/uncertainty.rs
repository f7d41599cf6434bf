//! Uncertainty of springs by their inputs: those of a study through its pair, on the bodies that it has.

use nalgebra::Matrix3;
use railspring_calibrate::calibration::{ContactField, NormalCalibration, Reference};
use railspring_calibrate::law::fit_law;
use railspring_calibrate::pair::{CondensedPair, Pair, spread};
use railspring_calibrate::uncertainty::{
    Asked, Band, Distribution, Effect, Propagated, UncertainPair, propagate,
};
use railspring_profiles::error::{Result, or_reason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::KILONEWTON;

use crate::results::bodies::geometry::{Geometry, track};
use crate::results::springs::law::LawConstants;
use crate::results::springs::make::{FittedSprings, contact_conditions};
use crate::results::springs::record::StiffnessRecord;
use crate::results::springs::uncertain_inputs::UncertainInputs;
use crate::results::springs::uncertainty_record::{
    InputUncertaintyRecord, UncertainInputRecord, UncertainLawRecord, UncertainPointRecord, UncertainRecord,
    between_loads,
};
use crate::study::Statics;

/// Loads at which the springs are made with other inputs, from the smallest to the largest of the law.
const LOADS: usize = 4;
/// Half width of the band of 95 % by scatter, in standard uncertainties.
const TWICE: f64 = 2.0;

/// Why a contact between the elements of the meshes has no uncertainty by its inputs.
const BETWEEN_ELEMENTS: &str = "a contact between elements goes from node to node";

/// The uncertainty by the inputs of a study of its springs, as they are in its record; none where it asks for no bands. Inputs that the model cannot
/// go along with leave a reason.
///
/// # Errors
/// An interruption.
pub fn uncertainty(
    statics: Statics<'_>,
    geometry: &Geometry,
    bodies: &CondensedPair,
    found: &FittedSprings,
    springs: &StiffnessRecord,
    monitor: &dyn Monitor,
) -> Result<Option<InputUncertaintyRecord>> {
    if !statics.wants_error_band() {
        return Ok(None);
    }
    let reference = Reference::from(statics.calibration.reference);
    let law = found.laws.get(reference).expect("the law in use is made");
    let numbers = spread(law.points.len(), LOADS);
    let loads: Vec<f64> = numbers.iter().map(|&number| law.points[number].force).collect();
    let asked = asked(statics, &geometry.pair, &loads);
    let uncertain = UncertainInputs::of(statics);
    let without = |reason: String| InputUncertaintyRecord {
        inputs: uncertain.records(),
        samples: 0,
        failed: 0,
        points: Vec::new(),
        horizontal: None,
        law: None,
        missing: Some(reason),
    };
    if asked.contact.field == ContactField::Elements {
        return Ok(Some(without(BETWEEN_ELEMENTS.into())));
    }
    let pair = match or_reason(UncertainPair::new(&geometry.pair, bodies, asked))? {
        Ok(pair) => pair,
        Err(reason) => return Ok(Some(without(reason))),
    };
    let evaluate = |departures: &[f64], alone: bool| {
        let answers = pair.answers(&uncertain.departure(departures), alone && found.horizontal.is_some())?;
        let parts = [answers.displacement, answers.tangent, answers.area, answers.pressure];
        Ok(parts.into_iter().flatten().chain(answers.horizontal).collect())
    };
    let inputs = uncertain.inputs();
    let stage = ("uncertainty of the inputs", monitor);
    let propagated = match or_reason(propagate(&inputs, statics.uncertainty.samples, evaluate, stage))? {
        Ok(propagated) => propagated,
        Err(reason) => return Ok(Some(without(reason))),
    };
    Ok(Some(record(uncertain.records(), &propagated, law, &numbers, springs)))
}

/// Half widths of the bands of 95 % by the inputs of a study, relative, of displacement and tangent stiffness of a `pair` pressed vertically under `loads` (N, ascending) on `bodies` of its
/// study; or why there are none.
///
/// # Errors
/// An interruption.
pub fn at_loads(
    statics: Statics<'_>,
    pair: &Pair,
    bodies: &CondensedPair,
    loads: &[f64],
    monitor: &dyn Monitor,
) -> Result<std::result::Result<Vec<[f64; 2]>, String>> {
    let asked = asked(statics, pair, loads);
    if asked.contact.field == ContactField::Elements {
        return Ok(Err(BETWEEN_ELEMENTS.into()));
    }
    let uncertain = UncertainInputs::of(statics);
    let inputs = uncertain.inputs();
    let propagated = || {
        let pair = UncertainPair::new(pair, bodies, asked)?;
        let evaluate = |departures: &[f64], _: bool| {
            let answers = pair.answers(&uncertain.departure(departures), false)?;
            Ok([answers.displacement, answers.tangent].concat())
        };
        propagate(&inputs, statics.uncertainty.samples, evaluate, ("uncertainty of the inputs", monitor))
    };
    let half = |propagated: &Propagated, answer: usize| propagated.band(answer, &[]).half_width;
    Ok(or_reason(propagated())?
        .map(|found| (0..loads.len()).map(|at| [half(&found, at), half(&found, loads.len() + at)]).collect()))
}

/// How a pair of a study is asked under some loads.
fn asked<'a>(statics: Statics<'_>, pair: &Pair, loads: &'a [f64]) -> Asked<'a> {
    let preloads = &statics.calibration.horizontal_preloads;
    Asked {
        track: track(statics, (-pair.placed.angle).tan()),
        contact: contact_conditions(statics),
        reference: Reference::from(statics.calibration.reference),
        loads,
        preload: preloads[preloads.len() / 2],
    }
}

/// The record of what was propagated of some `inputs`, at the loads of the `law` with some `numbers`.
fn record(
    mut inputs: Vec<UncertainInputRecord>,
    propagated: &Propagated,
    law: &NormalCalibration,
    numbers: &[usize],
    springs: &StiffnessRecord,
) -> InputUncertaintyRecord {
    let reference = springs.reference.as_str();
    let bands = springs.error_band.as_ref().and_then(|band| band.of(reference));
    let assumed = springs.assumed.as_ref().and_then(|assumed| assumed.of(reference));
    let scatters = bands.is_some_and(|band| band.points.iter().any(|p| p.scatter_displacement.is_some()));
    let by_effect = |name: &str, distribution: &str| UncertainInputRecord {
        name: name.into(),
        key: None,
        standard: None,
        unit: String::new(),
        distribution: distribution.into(),
    };
    if scatters {
        inputs.push(by_effect("scatter of the measured points", "normal"));
    }
    if assumed.is_some() {
        inputs.push(by_effect("assumed bodies and places", "rectangular"));
    }
    // relative changes at the ends of the range
    let extra = |scatter: Option<f64>, of_assumed: Option<[f64; 2]>| -> Vec<Effect> {
        let one = scatter.unwrap_or(0.0) / TWICE;
        let scatter = scatters.then_some(Effect { distribution: Distribution::Normal, changes: [-one, one] });
        let ends = of_assumed.unwrap_or_default();
        let of_assumed = assumed.map(|_| Effect {
            distribution: Distribution::Rectangular,
            changes: ends.map(|end| end.ln_1p() / 3.0_f64.sqrt()),
        });
        scatter.into_iter().chain(of_assumed).collect()
    };
    let count = numbers.len();
    let points = numbers.iter().enumerate().map(|(at, &number)| {
        let band = bands.filter(|band| band.largest().is_some()).map(|band| band.points[number]);
        let numerical = |part: usize| band.map(|band| band.numerical()[part]);
        let value = |part: usize, numerical: Option<f64>, extra: Vec<Effect>| {
            value_record(propagated, part * count + at, &extra, numerical)
        };
        let none = || extra(None, None);
        UncertainPointRecord {
            force_kn: law.points[number].force / KILONEWTON,
            displacement: value(
                0,
                numerical(0),
                extra(band.and_then(|b| b.scatter_displacement), assumed.map(|a| a.displacement)),
            ),
            tangent: value(
                1,
                numerical(1),
                extra(band.and_then(|b| b.scatter_tangent), assumed.map(|a| a.tangent)),
            ),
            area: value(2, None, none()),
            pressure: value(3, None, none()),
        }
    });
    let points: Vec<UncertainPointRecord> = points.collect();
    let horizontal = springs.horizontal.as_ref().zip(springs.horizontal_kn_per_m).map(|(of, stiffness)| {
        let numerical = of.error_band.as_ref().and_then(|band| band.band);
        let assumed = springs.assumed.as_ref().and_then(|assumed| assumed.horizontal_kn_per_m);
        let extra = extra(None, assumed.map(|range| range.map(|end| end / stiffness - 1.0)));
        value_record(propagated, 4 * count, &extra, numerical)
    });
    InputUncertaintyRecord {
        inputs,
        samples: propagated.changes.len(),
        failed: propagated.failed,
        points,
        horizontal,
        law: propagated.is_enough().then(|| law_record(propagated, law, numbers)).flatten(),
        missing: None,
    }
}

/// The uncertainty of an answer; `beside` are inputs that are known by their effect.
fn value_record(
    propagated: &Propagated,
    answer: usize,
    beside: &[Effect],
    numerical: Option<f64>,
) -> UncertainRecord {
    let Band { linear, sampled, percentiles, half_width, shares } = propagated.band(answer, beside);
    UncertainRecord {
        changes: propagated
            .linear
            .iter()
            .map(|of| of[answer])
            .chain(beside.iter().map(Effect::linear))
            .collect(),
        shares,
        linear,
        sampled,
        percentiles,
        input: half_width,
        numerical,
        combined: numerical.map(|numerical| numerical.hypot(half_width)),
    }
}

/// The law fitted to the tangents of each sample: those of the law, changed as at the loads of the samples, straight over the logarithm of the load between.
fn law_record(
    propagated: &Propagated,
    law: &NormalCalibration,
    numbers: &[usize],
) -> Option<UncertainLawRecord> {
    let forces: Vec<f64> = law.points.iter().map(|point| point.force).collect();
    let at: Vec<f64> = numbers.iter().map(|&number| forces[number]).collect();
    let constants: Vec<[f64; 3]> = propagated
        .changes
        .iter()
        .filter_map(|changes| {
            let of_tangents = &changes[numbers.len()..2 * numbers.len()];
            let change = |force: f64| {
                let (below, part) = between_loads(&at, force);
                of_tangents[below] + part * (of_tangents[below + 1] - of_tangents[below])
            };
            let tangents: Vec<f64> =
                law.points.iter().map(|point| point.solid_tangent * change(point.force).exp()).collect();
            let law = fit_law(&forces, &tangents).ok()?.law;
            let constants = LawConstants::from(law);
            Some([constants.a_kn_per_m, constants.b_kn_per_m, constants.c])
        })
        .collect();
    let count = constants.len() as f64;
    let mean = |i: usize| constants.iter().map(|of| of[i]).sum::<f64>() / count;
    let means = [mean(0), mean(1), mean(2)];
    let covariance = Matrix3::from_fn(|i, j| {
        constants.iter().map(|of| (of[i] - means[i]) * (of[j] - means[j])).sum::<f64>() / (count - 1.0)
    });
    let deviation = |i: usize| covariance[(i, i)].sqrt();
    (count > 1.0).then(|| UncertainLawRecord {
        a_kn_per_m: deviation(0),
        b_kn_per_m: deviation(1),
        c: deviation(2),
        covariance: std::array::from_fn(|i| std::array::from_fn(|j| covariance[(i, j)])),
    })
}
