//! The two sections of a study: standard ones, those of files, or measured surfaces on these.

use railspring_calibrate::error::Result;
use railspring_calibrate::profile::wheels::wheel_profile_with_flange;
use railspring_calibrate::profile_file::{
    Action, ClosedSection, Finding, parse_rail_section, parse_wheel_section,
};
use railspring_calibrate::profile_placement::Reference;
use railspring_calibrate::section::{
    RailSection, WheelSection, rail_section, rail_section_on, rail_section_with_head, wheel_section_of,
    wheel_section_on, wheel_section_with_profile,
};

use super::measured::{Surface, surface};
use super::on_standard::{Seams, on_standard};
use crate::records::{FindingRecord, ProfileRecord};
use crate::report::measured::OnStandard;
use crate::study::{MeasuredSurface, SectionFile, Study};

/// The section of a body.
pub(super) struct Sectioned<S> {
    pub section: S,
    /// The records of the section that the study brings, and of the measured surface.
    pub records: Vec<ProfileRecord>,
    /// The measured surface on its standard.
    pub surface: Option<OnStandard>,
}

/// Section of the rail.
pub(super) fn rail(study: &Study) -> Result<Sectioned<RailSection>> {
    let standard = &study.rail.profile;
    let (standard_section, mut records) = match &study.rail.section {
        Some(own) => own_rail(own).map(|(section, record)| (section, vec![record]))?,
        None => (rail_section(standard)?, Vec::new()),
    };
    let Some(measured) = &study.rail.measured else {
        return Ok(Sectioned { section: standard_section, records, surface: None });
    };
    let reference = Reference::rail(&standard_section);
    let mut found = surface(measured, &reference)?;
    let prepared = &mut found.prepared;
    let section = rail_section_with_head(standard_section, &prepared.curve, &mut prepared.findings)?;
    let seams = Seams::of_rail(&section);
    let both = (&found.in_place, &found.prepared);
    let surface = on_standard(&measured.file, &reference, both, seams, found.placed.as_ref());
    records.push(record("rail", measured, standard, &found));
    Ok(Sectioned { section, records, surface: Some(surface) })
}

/// The section of a study's own file.
fn own_rail(own: &SectionFile) -> Result<(RailSection, ProfileRecord)> {
    let read = parse_rail_section(&own.path.display().to_string(), &own.content)?;
    let record = section_record("rail section", own, &read);
    Ok((rail_section_on(&own.file, read.running, read.rest), record))
}

/// The section of a study's own file on a wheel of its diameter.
fn own_wheel(own: &SectionFile, tape_diameter: f64) -> Result<(WheelSection, ProfileRecord)> {
    let read = parse_wheel_section(&own.path.display().to_string(), &own.content)?;
    let record = section_record("wheel section", own, &read);
    Ok((wheel_section_of(&own.file, read.running, read.rest, tape_diameter)?, record))
}

fn section_record(body: &str, own: &SectionFile, read: &ClosedSection) -> ProfileRecord {
    ProfileRecord {
        body: body.into(),
        file: own.file.clone(),
        format: read.format.to_string(),
        standard: own.file.clone(),
        points: read.count,
        findings: read.findings.iter().map(finding_record).collect(),
    }
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

/// Section of the wheel.
pub(super) fn wheel(study: &Study) -> Result<Sectioned<WheelSection>> {
    let keys = &study.wheel;
    let standard = &keys.profile;
    let (nominal, mut records) = match &keys.section {
        Some(own) => own_wheel(own, keys.tape_diameter).map(|(section, record)| (section, vec![record]))?,
        None => {
            let running = wheel_profile_with_flange(standard, &keys.flange)?;
            (wheel_section_on(running, standard, keys.tape_diameter, &keys.body)?, Vec::new())
        }
    };
    let Some(measured) = &keys.measured else {
        return Ok(Sectioned { section: nominal, records, surface: None });
    };
    let reference = Reference::wheel(&nominal);
    let mut found = surface(measured, &reference)?;
    let prepared = &mut found.prepared;
    let section = wheel_section_with_profile(nominal, &prepared.curve, &mut prepared.findings)?;
    let seams = Seams::of_wheel(&section);
    let both = (&found.in_place, &found.prepared);
    let surface = on_standard(&measured.file, &reference, both, seams, found.placed.as_ref());
    records.push(record("wheel", measured, standard, &found));
    Ok(Sectioned { section, records, surface: Some(surface) })
}

fn record(body: &str, measured: &MeasuredSurface, standard: &str, found: &Surface) -> ProfileRecord {
    ProfileRecord {
        body: body.into(),
        file: measured.file.clone(),
        format: found.in_place.format.to_string(),
        standard: standard.into(),
        points: found.in_place.points.len(),
        findings: found.prepared.findings.iter().map(finding_record).collect(),
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
