//! What springs of measured profiles hang on that nobody has said: the pair is pressed with other bodies, and in other places, in the place of the assumed
//! ones.
//!
//! A wheel of which only the profile is known may have any web, rim and hub. A rail of which only the head is
//! known may have any web and foot. A head whose sides do not show it may be inclined in its file. The
//! alternatives are the ends of what is in use. Wheels have a thin straight web under a thin rim, a thick one
//! under a thick rim with a large hub, or an S web. Rails are the standard ones next lighter and next heavier
//! than the assumed one. Roll and lateral place change to either side by their uncertainty.

use railspring_calibrate::calibration::{LoadPoint, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{CondensedPair, Laws};
use railspring_profiles::error::{Result, or_reason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::KILONEWTON_PER_METRE;

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::others::{Other, Part, assumptions, others};
use crate::results::bodies::zones::mesh_options;
use crate::results::springs::assumed_record::{AssumedRecord, AssumedReference, OtherRecord};
use crate::results::springs::make::{FittedSprings, contact_conditions};
use crate::study::Statics;

/// Loads under which others are compared, at most.
const LOADS: usize = 6;

/// The springs of `bodies` with others in the place of what was assumed, if anything was. `condense` has the bodies of a pair on its meshes. All are pressed
/// with the same few loads, since the approach is integrated over the loads.
///
/// # Errors
/// An interruption.
pub fn assumed(
    statics: Statics<'_>,
    geometry: &Geometry,
    (meshes, bodies): (&Meshes, &CondensedPair),
    found: &FittedSprings,
    condense: impl Fn(&Geometry, &Meshes) -> Result<CondensedPair>,
    monitor: &dyn Monitor,
) -> Result<Option<AssumedRecord>> {
    let (assumed, keys, open) = assumptions(statics, geometry);
    if assumed.is_empty() || !statics.wants_error_band() {
        return Ok(None);
    }
    let others = others(statics, geometry, open);
    let reference = Reference::from(statics.calibration.reference);
    let own: &Vec<LoadPoint> = &found.laws.beam.points;
    let step = own.len().div_ceil(LOADS).max(1);
    let loads: Vec<f64> = own.iter().map(|p| p.force).rev().step_by(step).collect();
    let loads: Vec<f64> = loads.into_iter().rev().collect();
    let preloads = &statics.calibration.horizontal_preloads;
    let preload = &preloads[preloads.len() / 2..preloads.len() / 2 + 1];
    let contact = contact_conditions(statics);
    let own_laws = bodies.press(&geometry.pair, contact, &loads, monitor).and_then(|pressed| pressed.laws());
    let own_laws = match or_reason(own_laws)? {
        Ok(laws) => laws,
        Err(reason) => {
            let missing = vec![format!("the pair itself under fewer loads: {reason}")];
            let (others, references) = (Vec::new(), Vec::new());
            let horizontal_kn_per_m = None;
            return Ok(Some(AssumedRecord {
                assumed,
                keys,
                others,
                references,
                horizontal_kn_per_m,
                missing,
            }));
        }
    };
    let (mut records, mut missing) = (Vec::new(), Vec::new());
    let count = others.len();
    for (done, Other { part, name, geometry: other }) in others.into_iter().enumerate() {
        monitor.progress("other bodies", done, count)?;
        let pressed = other.and_then(|other| {
            let options = MeshOptions {
                window_half_length: meshes.options().window_half_length,
                contact_half_length: meshes.options().contact_half_length,
                ..mesh_options(statics, &other)
            };
            // a wheel in another place has the same body, unless it touches where that has no fine elements
            let own = (part == Part::Shift && options == *meshes.options()).then_some(bodies);
            let condensed;
            let bodies = match own {
                Some(bodies) => bodies,
                None => {
                    condensed = condense(&other, &Meshes::with_own(statics, &other, None, None, options)?)?;
                    &condensed
                }
            };
            let pressed = bodies.press(&other.pair, contact, &loads, monitor)?;
            let horizontal = pressed.horizontal(reference, preload, monitor).map(|h| h.stiffness);
            Ok((pressed.laws()?, horizontal))
        });
        match or_reason(pressed)? {
            Ok((laws, horizontal)) => {
                let horizontal = or_reason(horizontal)?.ok();
                records.push(record(
                    part,
                    name,
                    &own_laws,
                    &laws,
                    own_horizontal(found, preload[0]).zip(horizontal),
                ));
            }
            Err(reason) => missing.push(format!("{name}: {reason}")),
        }
    }
    monitor.progress("other bodies", count, count)?;
    let references = found.laws.iter().map(|(reference, _)| range(reference.name(), &records)).collect();
    let horizontal = found.horizontal.as_ref().map(|horizontal| {
        let changes = |part: Part| {
            let of = records.iter().filter(move |other| other.part == part.name());
            of.filter_map(|other| other.horizontal)
        };
        let [least, greatest] = summed(&changes);
        let stiffness = horizontal.stiffness / KILONEWTON_PER_METRE;
        [stiffness * (1.0 + least).max(0.0), stiffness * (1.0 + greatest)]
    });
    Ok(Some(AssumedRecord {
        assumed,
        keys,
        others: records,
        references,
        horizontal_kn_per_m: horizontal,
        missing,
    }))
}

/// The horizontal stiffness of the springs at a preload, N/m.
fn own_horizontal(found: &FittedSprings, preload: f64) -> Option<f64> {
    let points = &found.horizontal.as_ref()?.points;
    points.iter().find(|point| (point.preload / preload - 1.0).abs() < 1e-9).map(|point| point.stiffness)
}

/// The largest change of a value over the loads that both laws have.
fn largest(own: &[LoadPoint], other: &[LoadPoint], of: fn(&LoadPoint) -> f64) -> f64 {
    let at = |p: &LoadPoint| own.iter().find(|own| (own.force / p.force - 1.0).abs() < 1e-9).map(of);
    let changes = other.iter().filter_map(|p| Some(of(p) / at(p)? - 1.0));
    changes.fold(0.0, |largest: f64, change| if change.abs() > largest.abs() { change } else { largest })
}

fn record(part: Part, name: String, own: &Laws, other: &Laws, horizontal: Option<(f64, f64)>) -> OtherRecord {
    let changes = |of: fn(&LoadPoint) -> f64| {
        let both = own.iter().filter_map(|(reference, law)| Some((reference, law, other.get(reference)?)));
        both.map(|(reference, law, other)| {
            (reference.name().to_owned(), largest(&law.points, &other.points, of))
        })
        .collect()
    };
    OtherRecord {
        part: part.name().into(),
        name,
        displacement: changes(|p| p.displacement),
        tangent: changes(|p| p.solid_tangent),
        horizontal: horizontal.map(|(own, other)| other / own - 1.0),
    }
}

/// The least and the greatest change: those of each part, and none, added up over the parts.
fn summed<I: Iterator<Item = f64>>(changes: &dyn Fn(Part) -> I) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for part in Part::ALL {
        let [least, greatest] =
            changes(part).fold([0.0_f64; 2], |[low, high], change| [low.min(change), high.max(change)]);
        sum[0] += least;
        sum[1] += greatest;
    }
    sum
}

fn range(reference: &str, others: &[OtherRecord]) -> AssumedReference {
    let of = |get: fn(&OtherRecord) -> &Vec<(String, f64)>| {
        summed(&|part: Part| {
            let all = others.iter().filter(move |other| other.part == part.name());
            all.flat_map(get).filter(|(name, _)| name == reference).map(|(_, change)| *change)
        })
    };
    AssumedReference {
        reference: reference.into(),
        displacement: of(|other| &other.displacement),
        tangent: of(|other| &other.tangent),
    }
}
