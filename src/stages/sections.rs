//! The two sections of a study: standard ones, or measured surfaces on standard bodies.

use railspring_calibrate::error::Result;
use railspring_calibrate::profile::ProfileCurve;
use railspring_calibrate::profile::wheels::wheel_profile_with_flange;
use railspring_calibrate::profile_file::{
    Action, Finding, FindingKind, MeasuredProfile, PrepareOptions, ProfileKind, ReadOptions, parse, prepare,
};
use railspring_calibrate::section::{
    RailSection, WheelSection, align_rail, rail_section, rail_section_with_head, wheel_section_on,
    wheel_section_with_profile,
};
use railspring_calibrate::units::MILLIMETRE;

use crate::records::{FindingRecord, ProfileRecord};
use crate::study::{MeasuredSurface, Study};

/// Share of the points that has to lie on the standard for an alignment to be sure of.
const ENOUGH_UNWORN: f64 = 0.4;

/// Section of the rail, and the record of its measured head.
pub(super) fn rail(study: &Study) -> Result<(RailSection, Option<ProfileRecord>)> {
    let standard = &study.rail.profile;
    let Some(measured) = &study.rail.measured else {
        return Ok((rail_section(standard)?, None));
    };
    let standard_section = rail_section(standard)?;
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
        let action = if motion.share < ENOUGH_UNWORN { Action::Left } else { Action::Mended };
        findings.push(Finding {
            kind: FindingKind::Aligned,
            lines: None,
            value: Some((motion.rms / (1e-3 * MILLIMETRE), "\u{b5}m")),
            action,
            text,
        });
        curve = curve.transformed(motion.angle, motion.translation);
    }
    let section = rail_section_with_head(standard, &curve, &mut findings)?;
    Ok((section, Some(record("rail", measured, standard, &profile, &findings))))
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
    let section = wheel_section_with_profile(nominal, &curve, &mut findings)?;
    Ok((section, Some(record("wheel", measured, standard, &profile, &findings))))
}

fn curve_of(
    measured: &MeasuredSurface,
    kind: ProfileKind,
) -> Result<(MeasuredProfile, ProfileCurve, Vec<Finding>)> {
    let name = measured.path.display().to_string();
    let options = ReadOptions { kind: Some(kind), ..ReadOptions::default() };
    let profile = parse(&name, &measured.content, &options)?;
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
        let area = geometry.rail.area.area;
        assert!((76.70e-4 - 0.65e-4..76.70e-4 - 0.54e-4).contains(&area), "{area}");
    }
}
