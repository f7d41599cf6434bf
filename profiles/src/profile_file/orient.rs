//! From the rows of a file to the profile frame: unit, wheel or rail, direction of the axes, order, origin.

use super::blocks::extent;
use super::check::{median, remove_duplicates, remove_spikes};
use super::finding::{Action, Finding, FindingKind, Findings};
use super::format::ProfileFormat;
use super::heads::{Groove, groove, open_groove};
use super::measured::{MeasuredPoint, MeasuredProfile};
use super::options::ReadOptions;
use super::raw::{Convention, Raw};
use super::sentinels::drop_sentinels;
use super::shape::Shape;
use super::text::error_on;
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::ProfileKind;
use crate::units::{MILLIMETRE, in_millimetres};

/// Extent of a profile, m: from part of a head to a whole wheel.
const EXTENT: std::ops::RangeInclusive<f64> = 0.02..=0.4;
/// A scan is not recognised as one that is too short below this, m.
const SHORTEST: f64 = 0.003;
/// One inch, m.
const INCH: f64 = 25.4 * MILLIMETRE;
/// Extent below which numbers without a unit may be inches, m: a head in centimetres would be larger.
const LARGEST_IN_INCHES: f64 = 0.162;
/// A point further than this from the middle of the profile is none of it, m.
const FAR_OFF: f64 = 0.25;
/// Largest share of such points that are dropped.
const MOST_FAR_OFF: f64 = 0.05;
/// Greatest coordinate of a point, m: profiles may be given in the frame of the track, but no further off.
const FARTHEST: f64 = 10.0;
/// Where the tip of a flange is expected, m from the tape circle.
const TIP: std::ops::RangeInclusive<f64> = -0.070..=-0.040;
/// A tread further than this from the origin at the tape circle is moved there, m.
const ORIGIN: f64 = 5.0 * MILLIMETRE;
/// Distance from the tape circle over which the height of the tread there is compared with that of its middle point, m, ...
const ABOUT_TAPE: f64 = 12.0 * MILLIMETRE;
/// ... from which it is no further on any tread, m: 1.5 mm in one that is hollow by 3 mm.
const OFF_TREAD: f64 = 2.0 * MILLIMETRE;
/// A tread nearer than this to the origin needs no remark, m.
const AT_ORIGIN: f64 = 0.5 * MILLIMETRE;

/// Turns raw rows into a profile.
pub(super) fn orient(name: &str, mut raw: Raw, options: &ReadOptions) -> Result<MeasuredProfile> {
    if raw.points.len() < 4 {
        let line = raw.points.last().map_or(1, |p| p.line);
        let count = format!("{} points", raw.points.len());
        return Err(error_on(name, line, &count, "at least 4 points", "give the whole profile"));
    }
    drop_sentinels(&mut raw.points, &mut raw.findings);
    scale(name, &mut raw, options)?;
    drop_far_off(name, &mut raw)?;
    if let Some(p) =
        raw.points.iter().find(|p| p.point.coords.amax().is_nan() || p.point.coords.amax() > FARTHEST)
    {
        let value = format!("({:e}, {:e}) m", p.point.x, p.point.y);
        let expected = format!("a point within {FARTHEST} m of the origin");
        return Err(error_on(name, p.line, &value, expected, "check the shifts and the unit of the file"));
    }
    let groove_at_large_y = leave_running_head(name, &mut raw, options)?;
    let kind = recognise(name, &mut raw, options, groove_at_large_y.is_some())?;
    turn_over(kind, &mut raw, options, groove_at_large_y);
    put_in_order(kind, &mut raw);
    if kind == ProfileKind::Wheel {
        place_wheel(&mut raw, options.tape_circle_distance());
    }
    let Raw { format, points, findings, .. } = raw;
    let side_by_groove = groove_at_large_y.is_some();
    Ok(MeasuredProfile { name: name.to_owned(), format, kind, points, findings, drawn: None, side_by_groove })
}

fn scale(name: &str, raw: &mut Raw, options: &ReadOptions) -> Result<()> {
    let unit_field = match options.kind {
        Some(ProfileKind::Rail) => format!("`{}`", InputField::RailProfileUnit),
        Some(ProfileKind::Wheel) => format!("`{}`", InputField::WheelProfileUnit),
        None => format!("`{}`", InputField::ProfileUnit),
    };
    let extent = extent(raw.points.iter());
    let lines = (raw.points[0].line, raw.points[raw.points.len() - 1].line);
    let wrong = |line: usize, remedy: &str| {
        error_on(name, line, &format!("{extent:.4} units across"), "a profile 20 to 400 mm across", remedy)
    };
    let sizes = |unit: f64, least: f64| (least..*EXTENT.start()).contains(&(unit * extent));
    // A scan that is too short in a unit that fits it as such.
    let short = |unit: f64, line: usize| {
        let value = format!("the profile is {:.1} mm wide", unit * extent / MILLIMETRE);
        let remedy = "at least 20 mm are needed: give a scan of the whole head or wheel";
        error_on(name, line, &value, "a scan 20 to 400 mm wide", remedy)
    };
    let unit = match (options.unit, raw.unit) {
        (None, Some((unit, line))) if raw.format != ProfileFormat::Dxf && sizes(unit, SHORTEST) => {
            return Err(short(unit, if line == 0 { lines.0 } else { line }));
        }
        (Some(unit), _) if sizes(unit, SHORTEST) => return Err(short(unit, lines.0)),
        // A drawing has the unit of the program's template, whatever it was drawn in.
        (None, Some((unit, line)))
            if raw.format == ProfileFormat::Dxf && !EXTENT.contains(&(unit * extent)) =>
        {
            let said = unit_name(unit);
            let Some((other, fitting)) = only_fitting(extent) else {
                let expected = "a profile 20 to 400 mm across";
                let remedy = format!(
                    "$INSUNITS of the drawing says {said}, which does not fit its numbers: give {unit_field}"
                );
                return Err(error_on(name, line, &format!("{extent:.4} units across"), expected, remedy));
            };
            let text = format!(
                "$INSUNITS of the drawing says {said}, in which it is {:.3} m across: taken as {fitting}, the only unit that fits",
                unit * extent
            );
            raw.findings.push(
                Finding::new(FindingKind::Unit, Action::Repaired, text)
                    .on_lines(line, line)
                    .with_value(extent, fitting),
            );
            other
        }
        (Some(unit), _) => {
            if !EXTENT.contains(&(unit * extent)) {
                return Err(wrong(
                    lines.0,
                    &format!("{unit_field} is given: it is not the unit in which the file is written"),
                ));
            }
            unit
        }
        (None, Some((unit, line))) => {
            if !EXTENT.contains(&(unit * extent)) {
                let stated = if line == 0 { lines.0 } else { line };
                return Err(wrong(
                    stated,
                    &format!("the unit of the file does not fit its numbers: give {unit_field}"),
                ));
            }
            unit
        }
        (None, None) => {
            let Some((unit, unit_name)) = only_fitting(extent) else {
                return Err(wrong(lines.0, &format!("the unit is none of mm, m and in: give {unit_field}")));
            };
            let text = format!("the profile is {extent:.3} {unit_name} across, so the unit is {unit_name}");
            raw.findings.push(
                Finding::new(FindingKind::Unit, Action::Noted, text)
                    .on_lines(lines.0, lines.1)
                    .with_value(extent, unit_name),
            );
            unit
        }
    };
    // Dividing by the units a metre rounds once only: 14.3 mm becomes the number nearest to 0.0143 m.
    let per_metre = (1.0 / unit).round();
    let exact = unit < 1.0 && (per_metre * unit - 1.0).abs() < 1e-12;
    raw.points.iter_mut().for_each(|p| if exact { p.point /= per_metre } else { p.point *= unit });
    Ok(())
}

/// The unit among mm, m and in of which no two fit the same extent, m, and its name.
fn only_fitting(extent: f64) -> Option<(f64, &'static str)> {
    [(MILLIMETRE, "mm"), (1.0, "m"), (INCH, "in")]
        .into_iter()
        .filter(|(unit, _)| EXTENT.contains(&(unit * extent)))
        .find(|(unit, _)| *unit != INCH || unit * extent < LARGEST_IN_INCHES)
}

/// What the unit of a drawing is called.
fn unit_name(unit: f64) -> String {
    let names = [(INCH, "inches"), (MILLIMETRE, "mm"), (1.0, "m"), (0.01, "cm"), (0.3048, "feet")];
    let known = names.into_iter().find(|(length, _)| *length == unit);
    known.map_or_else(|| format!("{unit} m"), |(_, name)| name.to_owned())
}

fn drop_far_off(name: &str, raw: &mut Raw) -> Result<()> {
    let y = median(raw.points.iter().map(|p| p.point.x).collect());
    let z = median(raw.points.iter().map(|p| p.point.y).collect());
    let distance = |p: &MeasuredPoint| (p.point.x - y).hypot(p.point.y - z);
    let far = raw.points.iter().filter(|p| distance(p) > FAR_OFF).count();
    if far == 0 {
        return Ok(());
    }
    if far as f64 > MOST_FAR_OFF * raw.points.len() as f64 {
        let first = raw.points.iter().find(|p| distance(p) > FAR_OFF).map_or(1, |p| p.line);
        let value = format!("{far} points");
        return Err(error_on(
            name,
            first,
            &value,
            "points within 250 mm of the profile's middle",
            "give a single profile",
        ));
    }
    let mut spikes = Findings::new(&mut raw.findings, FindingKind::Spike);
    for p in raw.points.iter().filter(|p| distance(p) > FAR_OFF) {
        spikes.add(
            (p.line, p.line),
            (distance(p) / MILLIMETRE, "mm"),
            Action::Repaired,
            "far off the profile: dropped",
        );
    }
    drop(spikes);
    raw.points.retain(|p| distance(p) <= FAR_OFF);
    if raw.points.len() < 4 {
        return Err(error_on(name, 1, "", "at least 4 points", "give the whole profile"));
    }
    Ok(())
}

/// Sets a groove beside the running head of a rail aside, and what is beyond it; whether it lay at the end of large y.
///
/// # Errors
/// Two heads of which neither is evidently the running head.
fn leave_running_head(name: &str, raw: &mut Raw, options: &ReadOptions) -> Result<Option<bool>> {
    let said = options.kind.or(raw.kind);
    if said == Some(ProfileKind::Wheel) {
        return Ok(None);
    }
    let found = groove(&raw.points).or_else(|| {
        let shape = Shape::of(&raw.points)?;
        said.or(shape.kind()).filter(|kind| *kind == ProfileKind::Rail)?;
        let upwards = match (raw.convention, options.mirror_z) {
            (Convention::Stated, _) => false,
            (_, Some(upwards)) => upwards,
            _ => shape.upside_down(ProfileKind::Rail)?,
        };
        open_groove(&raw.points, if upwards { 1.0 } else { -1.0 })
    });
    let Some(found) = found else { return Ok(None) };
    let Groove { width, depth, .. } = found;
    let depth = format!("{:.0} mm deep", depth / MILLIMETRE);
    let size = match width {
        Some(width) => format!("{:.0} mm wide at half its depth and {depth}", width / MILLIMETRE),
        None => depth,
    };
    let Some(aside) = found.set_aside(&mut raw.points) else {
        let value = format!("two heads with a groove {size} between them");
        let remedy = "give the heads of a crossing one by one; of a grooved rail, or of a rail with a check rail, the running head alone";
        return InputError::refuse(name, value, "the profile of one head", remedy);
    };
    let what = if width.is_some() { "and the keeper or check rail beyond it" } else { "beside the head" };
    let text = format!("a groove {size} {what}: set aside, the running head is taken");
    let finding = Finding::new(FindingKind::PassedOver, Action::Repaired, text);
    raw.findings
        .push(finding.on_lines(aside.lines.0, aside.lines.1).with_value(aside.count as f64, "points"));
    Ok(Some(aside.at_large_y))
}

fn recognise(name: &str, raw: &mut Raw, options: &ReadOptions, grooved: bool) -> Result<ProfileKind> {
    let seen = Shape::of(&raw.points).and_then(|shape| shape.kind());
    let seen = if grooved { Some(ProfileKind::Rail) } else { seen };
    let said = options.kind.or(raw.kind);
    if let (Some(said), Some(seen)) = (said, seen)
        && said != seen
    {
        let text = format!("given as a {}, but it has the shape of a {}", said.name(), seen.name());
        raw.findings.push(Finding::new(FindingKind::Shape, Action::Left, text));
    }
    said.or(seen).ok_or_else(|| {
        InputError::new(
            name,
            "a profile that may be a wheel or a rail",
            "a file that says which, or the shape of a whole wheel or rail head",
            format!("say whether it is a wheel or a rail: give `{}`", InputField::ProfileKind),
        )
        .into()
    })
}

fn turn_over(kind: ProfileKind, raw: &mut Raw, options: &ReadOptions, groove_at_large_y: Option<bool>) {
    let shape = Shape::of(&raw.points);
    let upside_down = shape.and_then(|shape| shape.upside_down(kind));
    let flange_wrong = match kind {
        ProfileKind::Rail => None,
        ProfileKind::Wheel => shape.and_then(|shape| shape.flange_at_large_y()),
    };
    let stated = raw.convention == Convention::Stated;
    let miniprof = raw.convention == Convention::MiniProf;
    let mirror_y = match (stated, options.mirror_y, kind) {
        (true, mirror, _) => mirror.unwrap_or(false),
        (_, Some(mirror), _) => mirror,
        (_, _, ProfileKind::Rail) => groove_at_large_y.unwrap_or(miniprof),
        (_, _, ProfileKind::Wheel) => flange_wrong.unwrap_or(false),
    };
    let mirror_z = match (stated, options.mirror_z) {
        (true, _) => false,
        (_, Some(mirror)) => mirror,
        _ => upside_down.unwrap_or(miniprof && kind == ProfileKind::Rail),
    };
    let mut note = |kind, action, text: &str| raw.findings.push(Finding::new(kind, action, text));
    // A right wheel has its flange at small y, whatever the options say.
    let flange_out = flange_wrong.is_some_and(|wrong| wrong != mirror_y);
    if mirror_y {
        let why = match kind {
            ProfileKind::Rail if groove_at_large_y == Some(true) && !stated && options.mirror_y.is_none() => {
                "the groove is at the end of large y, and belongs to the gauge side: turned over"
            }
            ProfileKind::Rail if options.mirror_y.is_none() => {
                "y of a MiniProf rail counts towards the track centre: turned over"
            }
            _ if options.mirror_y.is_some() => "y turned over as requested",
            _ => "the flange is at the end of large y: turned over",
        };
        note(FindingKind::Mirrored, Action::Repaired, why);
    }
    // Of kind header: no place on a standard answers it.
    if groove_at_large_y.is_some_and(|large| large != mirror_y) {
        let text = if stated && options.mirror_y.is_none() {
            "the groove is at the field side, as the header has it, and belongs to the gauge side: the rail of the other side, or check mirror.y"
        } else {
            "the groove is at the field side, as requested, and belongs to the gauge side: the rail of the other side"
        };
        note(FindingKind::Header, Action::Left, text);
    } else if groove_at_large_y == Some(false) && miniprof && options.mirror_y.is_none() {
        let text = "the groove is at the end of small y, and belongs to the gauge side: not turned over as MiniProf rails are";
        note(FindingKind::Mirrored, Action::Noted, text);
    }
    if flange_out {
        note(
            FindingKind::Mirrored,
            Action::Left,
            if stated && !mirror_y {
                "the flange is at the field side, as the header has it: the profile of a left wheel, or check mirror.y"
            } else {
                "the flange is at the field side, as requested"
            },
        );
    }
    if mirror_z {
        let why = if options.mirror_z.is_some() {
            "z turned over as requested"
        } else {
            "z counts upwards: turned over"
        };
        note(FindingKind::UpsideDown, Action::Repaired, why);
    } else if upside_down == Some(true) {
        note(
            FindingKind::UpsideDown,
            Action::Left,
            if stated {
                "upside down, as the header has it: check mirror.z"
            } else {
                "upside down, as requested"
            },
        );
    } else if upside_down.is_none() {
        note(
            FindingKind::UpsideDown,
            Action::Left,
            "the shape does not show which side is up: z is taken as it is",
        );
    }
    for p in &mut raw.points {
        if mirror_y {
            p.point.x = -p.point.x;
        }
        if mirror_z {
            p.point.y = -p.point.y;
        }
    }
}

/// Lets the points run from small to large y.
fn put_in_order(kind: ProfileKind, raw: &mut Raw) {
    let tenth = raw.points.len().div_ceil(10);
    let mean = |part: &[MeasuredPoint]| part.iter().map(|p| p.point.x).sum::<f64>() / part.len() as f64;
    let (start, end) = (mean(&raw.points[..tenth]), mean(&raw.points[raw.points.len() - tenth..]));
    if end < start {
        raw.points.reverse();
        // The wheels of Simpack files run from the field side by convention.
        if raw.convention != Convention::Stated || kind == ProfileKind::Rail {
            let text = "the points run towards the track centre: order reversed";
            raw.findings.push(Finding::new(FindingKind::Reversed, Action::Repaired, text));
        }
    }
}

/// Puts the origin of a wheel at the tape circle, `tape_circle` (m) from the flange back.
fn place_wheel(raw: &mut Raw, tape_circle: f64) {
    // A point that is off must not move the origin.
    let mut sound = raw.points.clone();
    remove_duplicates(&mut sound, &mut Vec::new());
    remove_spikes(&mut sound, &mut Vec::new());
    let tip = |points: &[MeasuredPoint]| {
        points.iter().max_by(|a, b| a.point.y.total_cmp(&b.point.y)).map_or(0.0, |p| p.point.x)
    };
    let least_y = sound.iter().map(|p| p.point.x).fold(f64::INFINITY, f64::min);
    let from_back = raw.convention == Convention::MiniProf || raw.convention == Convention::Free;
    if from_back && !TIP.contains(&tip(&sound)) && (-0.02..0.02).contains(&least_y) {
        raw.points.iter_mut().chain(&mut sound).for_each(|p| p.point.x -= tape_circle);
        let distance = in_millimetres(tape_circle);
        let text = format!("y counts from the flange back: {distance} mm subtracted");
        raw.findings
            .push(Finding::new(FindingKind::Origin, Action::Repaired, text).with_value(-distance, "mm"));
    }
    let at = tip(&sound);
    if !TIP.contains(&at) {
        let text = "the flange tip is expected 40 to 70 mm from the tape circle: check the origin of y";
        raw.findings
            .push(Finding::new(FindingKind::Origin, Action::Left, text).with_value(at / MILLIMETRE, "mm"));
    }
    let crossing = sound.windows(2).find(|pair| pair[0].point.x <= 0.0 && pair[1].point.x > 0.0);
    let Some([a, b]) = crossing.map(|pair| [pair[0].point, pair[1].point]) else {
        return;
    };
    let crossing = a.y + (b.y - a.y) * (0.0 - a.x) / (b.x - a.x);
    let beside = sound.iter().filter(|p| p.point.x.abs() <= ABOUT_TAPE).map(|p| p.point.y);
    let level = median(beside.chain([crossing]).collect());
    let astray = (crossing - level).abs() > OFF_TREAD;
    // Several points that are off look like a line to their neighbours; the tread about them does not follow it.
    let height = if astray { level } else { crossing };
    if astray {
        let text =
            "the points at the tape circle are off the tread about them, whose height is taken: check them";
        let off = (crossing - level) / MILLIMETRE;
        raw.findings.push(Finding::new(FindingKind::Spike, Action::Left, text).with_value(off, "mm"));
    }
    let finding =
        |action, text| Finding::new(FindingKind::Origin, action, text).with_value(height / MILLIMETRE, "mm");
    if height.abs() > ORIGIN && from_back {
        raw.points.iter_mut().for_each(|p| p.point.y -= height);
        raw.findings.push(finding(Action::Repaired, "height of the tread at the tape circle: moved to 0"));
    } else if height.abs() > ORIGIN {
        raw.findings
            .push(finding(Action::Left, "height of the tread at the tape circle: check the origin of z"));
    } else if height.abs() > AT_ORIGIN {
        let text =
            "height of the tread at the tape circle: kept, the rolling radius there differs from the nominal";
        raw.findings.push(finding(Action::Noted, text));
    }
}
