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
use crate::study::{MeasuredSurface, SectionFile, Study, Wheel};

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
    let mut found = surface(measured, &reference, None)?;
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
fn own_wheel(own: &SectionFile, wheel: &Wheel) -> Result<(WheelSection, ProfileRecord)> {
    let read = parse_wheel_section(&own.path.display().to_string(), &own.content, wheel.tape_circle)?;
    let record = section_record("wheel section", own, &read);
    Ok((wheel_section_of(&own.file, read.running, read.rest, wheel.tape_diameter)?, record))
}

/// Distance of a wheel's tape circle from its flange back, where its running surface begins, m, to the nanometre of definitions.
fn from_flange_back(wheel: &WheelSection) -> f64 {
    const NANOMETRES: f64 = 1e9;
    (-wheel.running.point(0.0).x * NANOMETRES).round() / NANOMETRES
}

fn section_record(body: &str, own: &SectionFile, read: &ClosedSection) -> ProfileRecord {
    ProfileRecord {
        body: body.into(),
        file: own.file.clone(),
        content_hash: Some(content_hash(&own.content)),
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
        Some(own) => own_wheel(own, keys).map(|(section, record)| (section, vec![record]))?,
        None => {
            let running = wheel_profile_with_flange(standard, &keys.flange)?;
            (wheel_section_on(running, standard, keys.tape_diameter, &keys.body)?, Vec::new())
        }
    };
    let Some(measured) = &keys.measured else {
        return Ok(Sectioned { section: nominal, records, surface: None });
    };
    let reference = Reference::wheel(&nominal);
    let tape_circle = keys.tape_circle.unwrap_or_else(|| from_flange_back(&nominal));
    let mut found = surface(measured, &reference, Some(tape_circle))?;
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
        content_hash: Some(content_hash(&measured.content)),
        format: found.in_place.format.to_string(),
        standard: standard.into(),
        points: found.in_place.points.len(),
        findings: found.prepared.findings.iter().map(finding_record).collect(),
    }
}

fn content_hash(content: &[u8]) -> String {
    blake3::hash(content).to_hex().to_string()
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

    /// Source: the definition of APTA120, whose tape circle is 72.231 mm from its flange back. Goal: a file whose y (mm) counts from the flange back comes to
    /// the tape circle of its standard, by the standard's distance or the key's. Accuracy: a micrometre, the digits of the file's points.
    #[test]
    fn a_file_from_the_flange_back_has_the_tape_circle_of_its_standard() {
        const DIGITS: f64 = 1e-6;
        let folder = tempfile::tempdir().unwrap();
        let standard = railspring_calibrate::profile::wheels::wheel_profile("APTA120").unwrap();
        let rows: String = standard
            .sample_parameters(0.25e-3)
            .into_iter()
            .map(|s| standard.point(s))
            .map(|p| format!("{:.4}\t{:.4}\n", 1e3 * p.x + 72.231, 1e3 * p.y))
            .collect();
        std::fs::write(folder.path().join("apta.whl"), format!("ColumnDef=X,Y\n\n{rows}")).unwrap();
        let read = |more: &str| {
            let keys = "profile_file = \"apta.whl\"\nstandard = \"APTA120\"";
            let text = format!("name = \"a\"\n[rail]\nprofile = \"60E1\"\n[wheel]\n{keys}\n{more}\n");
            wheel(&Study::parse(&folder.path().join("a.toml"), &text).unwrap())
        };
        for more in ["", "tape_circle_mm = 72.231"] {
            let running = read(more).unwrap().section.running;
            let off = |s: f64| standard.closest(&running.point(s)).1;
            let largest = running.sample_parameters(1e-3).into_iter().map(off).fold(0.0, f64::max);
            assert!(largest < DIGITS, "{more:?}: {largest} m");
        }
        let aside = read("tape_circle_mm = 70").err().map(|error| error.to_string()).unwrap_or_default();
        assert!(aside.contains("2.23"), "refused as 2.231 mm aside: {aside:?}");
    }

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
