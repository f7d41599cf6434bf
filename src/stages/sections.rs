//! The two sections of a study: standard ones, a rail's from a file, or measured surfaces on these.

use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::field::InputField;
use railspring_calibrate::profile::ProfileCurve;
use railspring_calibrate::profile::wheels::wheel_profile_with_flange;
use railspring_calibrate::profile_file::{
    Action, Finding, FindingKind, MeasuredProfile, PrepareOptions, ProfileKind, ReadOptions, parse,
    parse_rail_section, prepare,
};
use railspring_calibrate::section::{
    RailSection, WheelSection, align_rail, rail_section, rail_section_on, rail_section_with_head,
    wheel_section_on, wheel_section_with_profile,
};
use railspring_calibrate::units::MILLIMETRE;

use crate::records::{FindingRecord, ProfileRecord};
use crate::study::{MeasuredSurface, SectionFile, Study};

/// Share of the points that has to lie on the standard for an alignment to be sure of.
const ENOUGH_UNWORN: f64 = 0.4;

/// Section of the rail, and the records of its own section and of its measured head.
pub(super) fn rail(study: &Study) -> Result<(RailSection, Vec<ProfileRecord>)> {
    let standard = &study.rail.profile;
    let (standard_section, mut records) = match &study.rail.section {
        Some(own) => own_rail(own).map(|(section, record)| (section, vec![record]))?,
        None => (rail_section(standard)?, Vec::new()),
    };
    let Some(measured) = &study.rail.measured else {
        return Ok((standard_section, records));
    };
    let (profile, mut curve, mut findings) = curve_of(measured, ProfileKind::Rail)?;
    if measured.aligned {
        let motion = align_rail(&curve, &standard_section.running)?;
        let text = format!(
            "turned by {:.6} rad and moved by ({:.4}, {:.4}) mm onto {standard}; RMS distance of the {:.0} % of the \
             head that count as unworn",
            motion.angle,
            motion.translation.x / MILLIMETRE,
            motion.translation.y / MILLIMETRE,
            100.0 * motion.share,
        );
        let action = if motion.share < ENOUGH_UNWORN { Action::Left } else { Action::Repaired };
        findings.push(Finding {
            kind: FindingKind::Aligned,
            lines: None,
            value: Some((motion.rms / (1e-3 * MILLIMETRE), "\u{b5}m")),
            action,
            text,
        });
        curve = curve.transformed(motion.angle, motion.translation);
    } else if !study.source.gives("rail.profile_aligned") {
        refuse_canted(measured, &curve, &standard_section)?;
    }
    findings.extend(worn_outside(&curve));
    let section = rail_section_with_head(standard_section, &curve, &mut findings)?;
    records.push(record("rail", measured, standard, &profile, &findings));
    Ok((section, records))
}

/// The section of a study's own file.
fn own_rail(own: &SectionFile) -> Result<(RailSection, ProfileRecord)> {
    let read = parse_rail_section(&own.path.display().to_string(), &own.content)?;
    let record = ProfileRecord {
        body: "rail section".into(),
        file: own.file.clone(),
        format: read.format.to_string(),
        standard: own.file.clone(),
        points: read.count,
        findings: read.findings.iter().map(finding_record).collect(),
    };
    Ok((rail_section_on(&own.file, read.running, read.rest), record))
}

/// Refuses a head that was measured as it lies in the track: joined to a section that is not inclined, it would be
/// inclined twice.
fn refuse_canted(measured: &MeasuredSurface, curve: &ProfileCurve, standard: &RailSection) -> Result<()> {
    /// Half of the least inclination in use, 1:40, rad: wear turns the unworn part of a head by less.
    const CANTED: f64 = 0.0125;
    // A head that cannot be aligned gives no answer here; whether it fits is found when it is joined.
    let Ok(motion) = align_rail(curve, &standard.running) else { return Ok(()) };
    if motion.angle.abs() < CANTED || motion.share < ENOUGH_UNWORN {
        return Ok(());
    }
    Err(InputError::new(
        InputField::RailHead,
        format!("{:?}, canted by 1:{:.0} against its section", measured.file, 1.0 / motion.angle.abs()),
        "a head in the frame of its section: origin at the unworn top, on the axis, not inclined",
        "a head that is measured as it lies in the track, canted, needs `rail_aligned` = true; if it is worn like \
         that, say so with `rail_aligned` = false",
    )
    .into())
}

/// A head that is worn at its field side rather than at its gauge side is most likely a left rail's.
fn worn_outside(curve: &ProfileCurve) -> Option<Finding> {
    /// Distances from the axis at which the two sides are compared, m: the gauge corner.
    const AT: std::ops::RangeInclusive<u32> = 20..=32;
    /// Mean difference of height from which the sides count as different, m: far above noise and tilt of a survey.
    const DIFFERENT: f64 = 0.3 * MILLIMETRE;
    let depth = |y: f64| curve.s_at_y(y).map(|s| curve.point(s).y);
    let deeper: Vec<f64> =
        AT.map(|mm| f64::from(mm) * MILLIMETRE).filter_map(|y| Some(depth(y)? - depth(-y)?)).collect();
    let mean = deeper.iter().sum::<f64>() / deeper.len() as f64;
    (mean > DIFFERENT).then(|| Finding {
        kind: FindingKind::Mirrored,
        lines: None,
        value: Some((mean / MILLIMETRE, "mm")),
        action: Action::Left,
        text: "the head is worn deeper at the field side than at the gauge: if it is a left rail's, set \
               rail.profile_mirrored = true"
            .into(),
    })
}

/// What was done to measured profiles, and what is left to be looked at, one line each.
pub fn repairs(profiles: &[ProfileRecord]) -> Vec<String> {
    let line = |profile: &ProfileRecord, finding: &FindingRecord| {
        let lines = match (finding.first_line, finding.last_line) {
            (Some(first), Some(last)) if first != last => format!(":{first} to {last}"),
            (Some(first), _) => format!(":{first}"),
            _ => String::new(),
        };
        let value = match (finding.value, &finding.unit) {
            (Some(value), Some(unit)) => format!(" {value:.3} {unit}"),
            _ => String::new(),
        };
        format!("{}{lines}: {}{value} ({}): {}", profile.file, finding.kind, finding.action, finding.text)
    };
    let changed = |finding: &&FindingRecord| finding.action != Action::Noted.name();
    profiles
        .iter()
        .flat_map(|profile| profile.findings.iter().filter(changed).map(move |f| line(profile, f)))
        .collect()
}

/// Section of the wheel, and the record of its measured profile.
pub(super) fn wheel(study: &Study) -> Result<(WheelSection, Option<ProfileRecord>)> {
    let keys = &study.wheel;
    let standard = &keys.profile;
    let nominal = wheel_profile_with_flange(standard, &keys.flange)
        .and_then(|running| wheel_section_on(running, standard, keys.tape_diameter, &keys.body));
    let Some(measured) = &keys.measured else {
        return Ok((nominal?, None));
    };
    let nominal = nominal?;
    let (profile, curve, mut findings) = curve_of(measured, ProfileKind::Wheel)?;
    if findings.iter().any(|f| f.kind == FindingKind::Mirrored && f.action == Action::Left) {
        let (expected, remedy) = match measured.mirrored {
            Some(true) => {
                ("a file in which y counts towards the track centre", "remove `wheel.profile_mirrored`")
            }
            _ => ("the profile of a right wheel, y to the field side", "set `wheel.profile_mirrored` = true"),
        };
        let value = format!("{:?}, a wheel with its flange at the field side", measured.file);
        return Err(InputError::new(InputField::WheelProfile, value, expected, remedy).into());
    }
    let section = wheel_section_with_profile(nominal, &curve, &mut findings)?;
    Ok((section, Some(record("wheel", measured, standard, &profile, &findings))))
}

fn curve_of(
    measured: &MeasuredSurface,
    kind: ProfileKind,
) -> Result<(MeasuredProfile, ProfileCurve, Vec<Finding>)> {
    let name = measured.path.display().to_string();
    let options = ReadOptions {
        kind: Some(kind),
        unit: measured.unit,
        mirror_y: measured.mirrored,
        part: measured.part.clone(),
        ..ReadOptions::default()
    };
    let mut profile = parse(&name, &measured.content, &options)?;
    profile.findings.splice(0..0, measured.findings.iter().cloned());
    let prepared = prepare(&profile, &PrepareOptions { smoothing: measured.smoothing })?;
    Ok((profile, prepared.curve, prepared.findings))
}

fn record(
    body: &str,
    measured: &MeasuredSurface,
    standard: &str,
    profile: &MeasuredProfile,
    findings: &[Finding],
) -> ProfileRecord {
    ProfileRecord {
        body: body.into(),
        file: measured.file.clone(),
        format: profile.format.to_string(),
        standard: standard.into(),
        points: profile.points.len(),
        findings: findings.iter().map(finding_record).collect(),
    }
}

fn finding_record(finding: &Finding) -> FindingRecord {
    FindingRecord {
        kind: finding.kind.name().into(),
        first_line: finding.lines.map(|lines| lines.0),
        last_line: finding.lines.map(|lines| lines.1),
        value: finding.value.map(|value| value.0),
        unit: finding.value.map(|value| value.1.into()),
        action: finding.action.name().into(),
        text: finding.text.clone(),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn the_worn_study_reads_its_profiles() {
        let study =
            Study::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies/worn.toml")).unwrap();
        assert!(study.rail.measured.is_some() && study.wheel.measured.is_some());
        let geometry = super::super::geometry(&study).unwrap();
        assert_eq!(geometry.profiles.len(), 2);
        assert!(geometry.profiles.iter().flat_map(|p| &p.findings).all(|f| f.action != "left"));
        // Worn off: the crown's 1.5 mm, of which 8/15 over 68 mm, and a little of the gauge corner.
        let area = geometry.pair.rail.area.area;
        assert!((76.70e-4 - 0.65e-4..76.70e-4 - 0.54e-4).contains(&area), "{area}");
    }
}
