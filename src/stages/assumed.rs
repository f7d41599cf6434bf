//! What springs of measured profiles hang on that nobody has said: the pair is pressed with other bodies, and in other places, in the place of the assumed
//! ones.
//!
//! A wheel of which only the profile is known may have any web, rim and hub; a rail of which only the head is known any web and foot; a head whose
//! sides do not show it may be inclined in its file. The others are the ends of what is in use: a thin straight web under a thin rim, a thick one
//! under a thick rim with a large hub, and an S web; the standard rails next lighter and next heavier than what was assumed; roll and lateral place to either side by as much as
//! they are unsure, and in between.

use railspring_calibrate::calibration::{LoadPoint, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{CondensedPair, Laws};
use railspring_profiles::error::{Result, or_reason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::profile::rails::RAIL_NAMES;
use railspring_profiles::profile::wheels::wheel_profile_with_flange;
use railspring_profiles::section::{
    RailSection, WebShape, WheelBody, WheelSection, rail_section, rail_section_for_head,
    wheel_section_for_profile, wheel_section_on,
};
use railspring_profiles::units::{KILONEWTON_PER_METRE, MILLIMETRE};

use super::calibrate::{FoundSprings, contact_conditions};
use super::sections::Assumed;
use super::zones::mesh_options;
use super::{Geometry, Meshes};
use crate::records::{AssumedRecord, AssumedReference, OtherRecord};
use crate::study::Study;

/// Loads under which others are compared, at most.
const LOADS: usize = 6;
/// Keys that tell the body of a wheel.
const WHEEL_KEYS: [&str; 4] =
    ["wheel.body", "wheel.web_thickness_mm", "wheel.rim_depth_mm", "wheel.hub_diameter_mm"];

/// Which part of a pair another one takes the place of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Rail,
    Wheel,
    Roll,
    Shift,
}

impl Part {
    const ALL: [Self; 4] = [Self::Rail, Self::Wheel, Self::Roll, Self::Shift];

    fn name(self) -> &'static str {
        match self {
            Self::Rail => "rail",
            Self::Wheel => "wheel",
            Self::Roll => "roll",
            Self::Shift => "shift",
        }
    }
}

/// A pair with another body, or in another place.
struct Other {
    part: Part,
    name: String,
    geometry: Result<Geometry>,
}

/// What was assumed, and the keys that say it otherwise; none where all of the pair is known, or the study wants no bands.
fn assumptions(study: &Study, geometry: &Geometry) -> (Vec<String>, Vec<String>, Open) {
    let (mut said, mut keys) = (Vec::new(), Vec::new());
    let [rail, wheel] = &geometry.assumed;
    let own_wheel = study.wheel.mesh.is_none() && study.wheel.section.is_none();
    let wheel_open = wheel.is_some() && !study.wheel.body_given && own_wheel;
    if wheel_open {
        let body = &study.wheel.body;
        said.push(format!(
            "the wheel has a straight web of {:.0} mm, a rim {:.0} mm deep and a hub of {:.0} mm, which were not given",
            body.web.least_thickness() / MILLIMETRE,
            body.rim_depth / MILLIMETRE,
            body.hub_diameter / MILLIMETRE
        ));
        keys.extend(WHEEL_KEYS.map(String::from));
    }
    let like = rail.as_ref().and_then(|rail| rail.like.as_ref()).filter(|_| study.rail.mesh.is_none());
    if let Some(like) = like {
        said.push(format!("the rail has web and foot like those of {like}, which were not given"));
        keys.push("rail.body".into());
    }
    let unsure = rail.as_ref().map_or(0.0, |rail| rail.unsure.roll);
    let roll_open = unsure > LEAST_ROLL && study.rail.mesh.is_none();
    if roll_open {
        said.push(format!(
            "the head's roll is known to \u{b1}{:.1} degrees; it is laid at 1:{:.0}",
            unsure.to_degrees(),
            1.0 / geometry.pair.placed.angle.tan().abs()
        ));
        keys.extend(["rail.inclination".into(), "rail.standard".into()]);
    }
    let unsure = wheel.as_ref().map_or(0.0, |wheel| wheel.unsure.shift);
    let shift_open = unsure > LEAST_SHIFT && study.wheel.mesh.is_none();
    if shift_open {
        said.push(format!(
            "the wheel's distance from the flange back is known to \u{b1}{:.1} mm",
            unsure / MILLIMETRE
        ));
        keys.push("track.lateral_shift_mm".into());
    }
    (said, keys, Open { rail: like.is_some(), wheel: wheel_open, roll: roll_open, shift: shift_open })
}

/// What is open of a pair.
#[derive(Debug, Clone, Copy)]
struct Open {
    /// The body of the rail.
    rail: bool,
    /// The body of the wheel.
    wheel: bool,
    /// The roll of the head.
    roll: bool,
    /// The lateral place of the wheel.
    shift: bool,
}

/// Roll that is as good as known, rad, and lateral place, m.
const LEAST_ROLL: f64 = 0.002;
const LEAST_SHIFT: f64 = 0.2 * MILLIMETRE;

/// The springs of `bodies` with others in the place of what was assumed, if anything was. `condense` has the bodies of a pair on its meshes. All are pressed
/// with the same few loads, since the approach is integrated over the loads.
///
/// # Errors
/// An interruption.
pub fn assumed(
    study: &Study,
    geometry: &Geometry,
    (meshes, bodies): (&Meshes, &CondensedPair),
    found: &FoundSprings,
    condense: impl Fn(&Geometry, &Meshes) -> Result<CondensedPair>,
    monitor: &dyn Monitor,
) -> Result<Option<AssumedRecord>> {
    let (assumed, keys, open) = assumptions(study, geometry);
    if assumed.is_empty() || !study.wants_error_band() {
        return Ok(None);
    }
    let others = others(study, geometry, open);
    let reference = Reference::from(study.calibration.reference);
    let own: &Vec<LoadPoint> = &found.laws.beam.points;
    let step = own.len().div_ceil(LOADS).max(1);
    let loads: Vec<f64> = own.iter().map(|p| p.force).rev().step_by(step).collect();
    let loads: Vec<f64> = loads.into_iter().rev().collect();
    let preloads = &study.calibration.horizontal_preloads;
    let preload = &preloads[preloads.len() / 2..preloads.len() / 2 + 1];
    let contact = contact_conditions(study);
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
                ..mesh_options(study, &other)
            };
            // a wheel in another place has the same body, unless it touches where that has no fine elements
            let own = (part == Part::Shift && options == *meshes.options()).then_some(bodies);
            let condensed;
            let bodies = match own {
                Some(bodies) => bodies,
                None => {
                    condensed = condense(&other, &Meshes::with_own(study, &other, None, None, options)?)?;
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

/// How many others there are whose rail, and whose wheel, is condensed for them.
pub fn others_by_body(study: &Study, geometry: &Geometry) -> [usize; 2] {
    let (_, _, open) = assumptions(study, geometry);
    if !study.wants_error_band() {
        return [0; 2];
    }
    let rails =
        geometry.assumed[0].as_ref().filter(|_| open.rail).map_or(0, |known| other_rails(&known.base).len());
    let rolls = geometry.assumed[0].as_ref().filter(|_| open.roll).map_or(0, |known| rolls(known).len());
    let wheels =
        if open.wheel { other_wheels(&study.wheel.body, study.wheel.tape_diameter).len() } else { 0 };
    [rails + rolls, wheels]
}

/// Other rolls of a head, rad, both ways up to that by which it is unsure.
fn rolls(known: &Assumed) -> Vec<f64> {
    const STEP: f64 = 0.0125;
    both_ways(known.unsure.roll, STEP)
}

/// Other places of a wheel, m, both ways up to that by which it is unsure. On worn surfaces, where the contact goes from one place to another, the law is no
/// monotonic function of the lateral place.
fn shifts(known: &Assumed) -> Vec<f64> {
    const STEP: f64 = 0.75 * MILLIMETRE;
    both_ways(known.unsure.shift, STEP)
}

/// Values both ways up to the `most`, `step` apart at most.
fn both_ways(most: f64, step: f64) -> Vec<f64> {
    let count = (most / step - 1e-9).ceil() as i32;
    let values = (-count..=count).filter(|&i| i != 0).map(|i| most * f64::from(i) / f64::from(count));
    values.collect()
}

/// The horizontal stiffness of the springs at a preload, N/m.
fn own_horizontal(found: &FoundSprings, preload: f64) -> Option<f64> {
    let points = &found.horizontal.as_ref()?.points;
    points.iter().find(|point| (point.preload / preload - 1.0).abs() < 1e-9).map(|point| point.stiffness)
}

/// The pairs with others in the place of the `open` parts of rail, wheel and place.
fn others(study: &Study, geometry: &Geometry, open: Open) -> Vec<Other> {
    let mut others = Vec::new();
    let with = |rail: Option<RailSection>, wheel: Option<WheelSection>, slope: f64| {
        let (rail, wheel) = (
            rail.unwrap_or_else(|| geometry.pair.rail.clone()),
            wheel.unwrap_or_else(|| geometry.pair.wheel.clone()),
        );
        Geometry::in_track(study, rail, wheel, slope)
    };
    let slope = -geometry.pair.placed.angle.tan();
    if let (true, Some(known)) = (open.wheel, &geometry.assumed[1]) {
        for (name, body) in other_wheels(&study.wheel.body, study.wheel.tape_diameter) {
            let section = wheel_profile_with_flange(&known.base, &study.wheel.flange)
                .and_then(|running| wheel_section_on(running, &known.base, study.wheel.tape_diameter, &body))
                .and_then(|base| wheel_section_for_profile(&base, &known.curve, &body, &mut Vec::new()));
            let geometry = section.and_then(|section| with(None, Some(section), slope));
            others.push(Other { part: Part::Wheel, name: format!("wheel with {name}"), geometry });
        }
    }
    if let (true, Some(known)) = (open.rail, &geometry.assumed[0]) {
        for name in other_rails(&known.base) {
            let section = rail_section(name)
                .and_then(|base| rail_section_for_head(base, &known.curve, &mut Vec::new()));
            let geometry = section.and_then(|section| with(Some(section), None, slope));
            others.push(Other { part: Part::Rail, name: format!("rail with a body like {name}"), geometry });
        }
    }
    if let (true, Some(known)) = (open.roll, &geometry.assumed[0]) {
        for roll in rolls(known) {
            let name = format!("head rolled by {:+.1} degrees", roll.to_degrees());
            others.push(Other { part: Part::Roll, name, geometry: with(None, None, slope + roll) });
        }
    }
    if let (true, Some(known)) = (open.shift, &geometry.assumed[1]) {
        for shift in shifts(known) {
            let name = format!("wheel {:+.2} mm to the field side", shift / MILLIMETRE);
            let geometry = with(None, None, slope).and_then(|own| {
                let pair = own.pair.with_wheel_at(own.pair.tape_y + shift)?;
                Ok(Geometry { pair, ..own })
            });
            others.push(Other { part: Part::Shift, name, geometry });
        }
    }
    others
}

/// The ends of what wheels have under their rim: webs of 16 to 32 mm, rims 35 to 80 mm deep, hubs up to 340 mm as far as the wheel has room for them.
fn other_wheels(body: &WheelBody, tape_diameter: f64) -> [(&'static str, WheelBody); 3] {
    /// Radial length that web and fillets need, and the least wall of a hub, m.
    const WEB: f64 = 85.0 * MILLIMETRE;
    const WALL: f64 = 11.0 * MILLIMETRE;
    let mm = |mm: f64| mm * MILLIMETRE;
    let (rim, least) = (mm(80.0), body.bore_diameter + 2.0 * WALL);
    let thin = WheelBody {
        web_thickness: Some(mm(16.0)),
        rim_depth: mm(35.0),
        hub_diameter: least.min(body.hub_diameter),
        ..*body
    };
    let room = (tape_diameter - 2.0 * (rim + WEB)).max(least);
    let hub = body.hub_diameter.max(mm(340.0)).min(room);
    let thick = WheelBody { web_thickness: Some(mm(32.0)), rim_depth: rim, hub_diameter: hub, ..*body };
    let curved = WheelBody { web: WebShape::S, web_thickness: Some(mm(16.0)), rim_depth: mm(38.0), ..*body };
    [
        ("a thin straight web and rim", thin),
        ("a thick straight web, rim and hub", thick),
        ("a thin S web", curved),
    ]
}

/// The standard rails next lighter and next heavier than one by a tenth of its mass and more.
fn other_rails(base: &str) -> Vec<&'static str> {
    const APART: f64 = 0.1;
    let area = |name: &str| rail_section(name).map_or(0.0, |rail| rail.area.area);
    let own = area(base);
    let lighter = |a: &&str, b: &&str| area(a).total_cmp(&area(b));
    let below = RAIL_NAMES.iter().copied().filter(|name| area(name) < (1.0 - APART) * own).max_by(lighter);
    let above = RAIL_NAMES.iter().copied().filter(|name| area(name) > (1.0 + APART) * own).min_by(lighter);
    below.into_iter().chain(above).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: values both ways, the ends among them and no two farther apart than the step. Accuracy: ROUNDOFF.
    #[test]
    fn values_both_ways_have_their_ends() {
        for (most, count) in [(3.0, 4), (0.75, 1), (0.5, 1), (0.76, 2)] {
            let values = both_ways(most, 0.75);
            assert_eq!((values.len(), values[0], values[2 * count - 1]), (2 * count, -most, most));
            assert!(
                values
                    .windows(2)
                    .all(|w| w[1] - w[0] <= if w[0] < 0.0 && w[1] > 0.0 { 1.5 } else { 0.75 } + 1e-12)
            );
        }
    }
}
