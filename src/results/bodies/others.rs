//! Other bodies and places of a measured pair, in the place of those that were assumed.

use railspring_profiles::error::Result;
use railspring_profiles::profile::rails::RAIL_NAMES;
use railspring_profiles::profile::wheels::wheel_profile_with_flange;
use railspring_profiles::section::{
    RailSection, WebShape, WheelBody, WheelSection, rail_section, rail_section_for_head,
    wheel_section_for_profile, wheel_section_on,
};
use railspring_profiles::units::MILLIMETRE;

use super::geometry::Geometry;
use super::sections::Assumed;
use crate::study::Statics;

/// Keys that tell the body of a wheel.
const WHEEL_KEYS: [&str; 4] =
    ["wheel.body", "wheel.web_thickness_mm", "wheel.rim_depth_mm", "wheel.hub_diameter_mm"];

/// Which part of a pair another one takes the place of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Rail,
    Wheel,
    Roll,
    Shift,
}

impl Part {
    pub(crate) const ALL: [Self; 4] = [Self::Rail, Self::Wheel, Self::Roll, Self::Shift];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Rail => "rail",
            Self::Wheel => "wheel",
            Self::Roll => "roll",
            Self::Shift => "shift",
        }
    }
}

/// A pair with another body, or in another place.
pub(crate) struct Other {
    pub(crate) part: Part,
    pub(crate) name: String,
    pub(crate) geometry: Result<Geometry>,
}

/// What was assumed, and the keys that say it otherwise; none where all of the pair is known, or the study wants no bands.
pub(crate) fn assumptions(statics: Statics<'_>, geometry: &Geometry) -> (Vec<String>, Vec<String>, Open) {
    let (mut said, mut keys) = (Vec::new(), Vec::new());
    let [rail, wheel] = &geometry.assumed;
    let own_wheel = statics.wheel.mesh.is_none() && statics.wheel.section.is_none();
    let wheel_open = wheel.is_some() && !statics.wheel.body_given && own_wheel;
    if wheel_open {
        let body = &statics.wheel.body;
        said.push(format!(
            "the wheel has a straight web of {:.0} mm, a rim {:.0} mm deep and a hub of {:.0} mm, which were not given",
            body.web.least_thickness() / MILLIMETRE,
            body.rim_depth / MILLIMETRE,
            body.hub_diameter / MILLIMETRE
        ));
        keys.extend(WHEEL_KEYS.map(String::from));
    }
    let like = rail.as_ref().and_then(|rail| rail.like.as_ref()).filter(|_| statics.rail.mesh.is_none());
    if let Some(like) = like {
        said.push(format!("the rail has web and foot like those of {like}, which were not given"));
        keys.push("rail.body".into());
    }
    let unsure = rail.as_ref().map_or(0.0, |rail| rail.unsure.roll);
    let roll_open = unsure > LEAST_ROLL && statics.rail.mesh.is_none();
    if roll_open {
        said.push(format!(
            "the head's roll is known to \u{b1}{:.1} degrees; it is laid at 1:{:.0}",
            unsure.to_degrees(),
            1.0 / geometry.pair.placed.angle.tan().abs()
        ));
        keys.extend(["rail.inclination".into(), "rail.standard".into()]);
    }
    let unsure = wheel.as_ref().map_or(0.0, |wheel| wheel.unsure.shift);
    let shift_open = unsure > LEAST_SHIFT && statics.wheel.mesh.is_none();
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
pub(crate) struct Open {
    /// The body of the rail.
    pub(crate) rail: bool,
    /// The body of the wheel.
    pub(crate) wheel: bool,
    /// The roll of the head.
    pub(crate) roll: bool,
    /// The lateral place of the wheel.
    pub(crate) shift: bool,
}

/// Roll that is as good as known, rad, and lateral place, m.
const LEAST_ROLL: f64 = 0.002;

const LEAST_SHIFT: f64 = 0.2 * MILLIMETRE;

/// How many others there are whose rail, and whose wheel, is condensed for them.
pub fn others_by_body(statics: Statics<'_>, geometry: &Geometry) -> [usize; 2] {
    let (_, _, open) = assumptions(statics, geometry);
    if !statics.wants_error_band() {
        return [0; 2];
    }
    let rails =
        geometry.assumed[0].as_ref().filter(|_| open.rail).map_or(0, |known| other_rails(&known.base).len());
    let rolls = geometry.assumed[0].as_ref().filter(|_| open.roll).map_or(0, |known| rolls(known).len());
    let wheels =
        if open.wheel { other_wheels(&statics.wheel.body, statics.wheel.tape_diameter).len() } else { 0 };
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

/// The pairs with others in the place of the `open` parts of rail, wheel and place.
pub(crate) fn others(statics: Statics<'_>, geometry: &Geometry, open: Open) -> Vec<Other> {
    let mut others = Vec::new();
    let with = |rail: Option<RailSection>, wheel: Option<WheelSection>, slope: f64| {
        let (rail, wheel) = (
            rail.unwrap_or_else(|| geometry.pair.rail.clone()),
            wheel.unwrap_or_else(|| geometry.pair.wheel.clone()),
        );
        Geometry::in_track(statics, rail, wheel, slope)
    };
    let slope = -geometry.pair.placed.angle.tan();
    if let (true, Some(known)) = (open.wheel, &geometry.assumed[1]) {
        for (name, body) in other_wheels(&statics.wheel.body, statics.wheel.tape_diameter) {
            let section = wheel_profile_with_flange(&known.base, &statics.wheel.flange)
                .and_then(|running| {
                    wheel_section_on(running, &known.base, statics.wheel.tape_diameter, &body)
                })
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
