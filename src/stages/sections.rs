//! The two sections of a study: standard ones, those of files, or measured surfaces on these.

use railspring_calibrate::error::Result;
use railspring_calibrate::profile::wheels::wheel_profile_with_flange;
use railspring_calibrate::profile_file::{Action, ClosedSection, Finding, ProfileKind, sketch_section};
use railspring_calibrate::profile_placement::{Reference, say_nearest, with_nearest_to};
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
    let keys = &study.rail;
    let mut records = Vec::new();
    let nominal = match own_section(keys.section.as_ref(), ProfileKind::Rail, None, &mut records)? {
        Some((file, read)) => rail_section_on(file, read.running, read.rest),
        None => rail_section(&keys.profile)?,
    };
    let Some(measured) = &keys.measured else {
        return Ok(Sectioned { section: nominal, records, surface: None });
    };
    let reference = Reference::rail(&nominal);
    let mut found = surface(measured, &reference, None)?;
    let section = rail_section_with_head(nominal, &found.prepared.curve, &mut found.prepared.findings)?;
    let seams = Seams::of_rail(&section);
    let surface = found.on(measured, &reference, seams, &keys.profile, &mut records);
    Ok(Sectioned { section, records, surface: Some(surface) })
}

/// Section of the wheel.
pub(super) fn wheel(study: &Study) -> Result<Sectioned<WheelSection>> {
    let keys = &study.wheel;
    let mut records = Vec::new();
    let own = own_section(keys.section.as_ref(), ProfileKind::Wheel, keys.tape_circle, &mut records)?;
    let nominal = match own {
        Some((file, read)) => wheel_section_of(file, read.running, read.rest, keys.tape_diameter)?,
        None => {
            let running = wheel_profile_with_flange(&keys.profile, &keys.flange)?;
            wheel_section_on(running, &keys.profile, keys.tape_diameter, &keys.body)?
        }
    };
    let Some(measured) = &keys.measured else {
        return Ok(Sectioned { section: nominal, records, surface: None });
    };
    let reference = Reference::wheel(&nominal);
    let tape_circle = keys.tape_circle.unwrap_or_else(|| from_flange_back(&nominal));
    let mut found = surface(measured, &reference, Some(tape_circle))?;
    let section = wheel_section_with_profile(nominal, &found.prepared.curve, &mut found.prepared.findings)?;
    let seams = Seams::of_wheel(&section);
    let surface = found.on(measured, &reference, seams, &keys.profile, &mut records);
    Ok(Sectioned { section, records, surface: Some(surface) })
}

/// The section of a study's own file, with its record, if the study has one; the standards that are nearest to it are said.
fn own_section<'a>(
    own: Option<&'a SectionFile>,
    kind: ProfileKind,
    tape_circle: Option<f64>,
    records: &mut Vec<ProfileRecord>,
) -> Result<Option<(&'a str, ClosedSection)>> {
    let Some(own) = own else { return Ok(None) };
    let name = own.path.display().to_string();
    let (sketch, section) = sketch_section(&name, &own.content, kind, tape_circle);
    let mut section = section.map_err(|error| with_nearest_to(&sketch, kind, error))?;
    say_nearest(&mut section);
    records.push(ProfileRecord {
        body: format!("{} section", kind.name()),
        file: own.file.clone(),
        content_hash: Some(content_hash(&own.content)),
        format: section.format.to_string(),
        standard: own.file.clone(),
        points: section.count,
        findings: section.findings.iter().map(finding_record).collect(),
    });
    Ok(Some((&own.file, section)))
}

impl Surface {
    /// The surface on its section, for the picture; its record is added.
    fn on(
        &self,
        measured: &MeasuredSurface,
        reference: &Reference,
        seams: Option<Seams<'_>>,
        standard: &str,
        records: &mut Vec<ProfileRecord>,
    ) -> OnStandard {
        records.push(ProfileRecord {
            body: reference.kind.name().into(),
            file: measured.file.clone(),
            content_hash: Some(content_hash(&measured.content)),
            format: self.in_place.format.to_string(),
            standard: standard.into(),
            points: self.in_place.points.len(),
            findings: self.prepared.findings.iter().map(finding_record).collect(),
        });
        let both = (&self.in_place, &self.prepared);
        on_standard(&measured.file, reference, both, seams, self.placed.as_ref())
    }
}

/// Distance of a wheel's tape circle from its flange back, where its running surface begins, m, to the nanometre of definitions.
fn from_flange_back(wheel: &WheelSection) -> f64 {
    const NANOMETRES: f64 = 1e9;
    (-wheel.running.point(0.0).x * NANOMETRES).round() / NANOMETRES
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
