//! The two sections of a study: standard ones, those of files, or measured surfaces on these.

use railspring_profiles::error::{Error, Result};
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile::rail_catalogue::rail_of_dimensions;
use railspring_profiles::profile::wheels::wheel_profile_with_flange;
use railspring_profiles::profile_file::{
    Action, ClosedSection, Finding, FindingKind, MeasuredProfile, Prepared, ProfileKind, sketch_section,
};
use railspring_profiles::profile_placement::{
    OwnFrame, Reference, TURNED, Unsure, rail_in_own_frame, say_nearest, wheel_in_own_frame, with_nearest_to,
};
use railspring_profiles::section::{
    RailSection, WheelSection, rail_section, rail_section_for_head, rail_section_of, rail_section_on,
    rail_section_with_head, wheel_section_for_profile, wheel_section_of, wheel_section_on,
    wheel_section_with_profile,
};

use crate::results::bodies::measured::{self, Nominal, Surface};
use crate::results::bodies::on_standard::{Seams, on_standard};
use crate::results::bodies::record::{FindingRecord, ProfileRecord};
use crate::results::bodies::surface_figure::OnStandard;
use crate::study::{MeasuredSurface, RailBody, SectionFile, Statics};

/// The section of a body.
#[derive(Clone)]
pub(crate) struct Sectioned<S> {
    pub section: S,
    /// The records of the section that the study brings, and of the measured surface.
    pub records: Vec<ProfileRecord>,
    /// The measured surface on its standard.
    pub surface: Option<OnStandard>,
    /// The section that a measured surface was laid on.
    pub base: Option<S>,
    /// What is assumed of a measured body.
    pub assumed: Option<Assumed>,
    /// The section without a quarter of the measured points each; none where nothing scatters.
    pub replicates: Vec<S>,
}

impl<S> Sectioned<S> {
    /// A section of which nothing was measured.
    fn known(section: S, records: Vec<ProfileRecord>) -> Self {
        Self { section, records, surface: None, base: None, assumed: None, replicates: Vec::new() }
    }
}

/// What is assumed of the body of a measured profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Assumed {
    /// The standard whose body is taken, because the profile belongs to none; `None` where its own is known.
    pub like: Option<String>,
    /// The section that it was laid on.
    pub base: String,
    /// The profile in its place, prepared.
    pub curve: ProfileCurve,
    /// How the profile was turned from its file, rad, if it was.
    pub turned: Option<f64>,
    /// By how much its place is unsure.
    pub unsure: Unsure,
}

/// Section of the rail.
pub(crate) fn rail(statics: Statics<'_>) -> Result<Sectioned<RailSection>> {
    let keys = &statics.rail;
    let mut records = Vec::new();
    let own = own_section(keys.section.as_ref(), ProfileKind::Rail, None, &mut records)?;
    let own = own.map(|(file, read)| (file, rail_section_on(file, read.running, read.rest)));
    let Some(file) = &keys.measured else {
        let section = match own {
            Some((_, section)) => section,
            None => rail_section(keys.profile.as_deref().unwrap_or_default())?,
        };
        return Ok(Sectioned::known(section, records));
    };
    let mut profile = measured::read(file, ProfileKind::Rail, None)?;
    let (base, known, given) = match (own, &keys.profile, &keys.body) {
        (Some((_, section)), ..) => (section, true, true),
        (None, Some(standard), _) => (rail_section(standard)?, true, true),
        (None, None, Some(RailBody::Standard(name))) => (rail_section(name)?, false, true),
        (None, None, Some(RailBody::Drawn(name, dimensions))) => {
            (rail_section_of(name, rail_of_dimensions(dimensions)?), false, true)
        }
        (None, None, None) => {
            let Nominal { name, fits, sure, said } = measured::nominal(file, &profile)?;
            profile.findings.push(said);
            (rail_section(&name)?, fits, sure)
        }
    };
    let reference = Reference::rail(&base);
    let frame = |profile: &MeasuredProfile| rail_in_own_frame(profile, measured::head_width(&base));
    let (mut found, joins) = laid(file, profile, &reference, known, frame)?;
    let (section, replicates) = found.sections(
        joins,
        |curve, findings| rail_section_with_head(base.clone(), curve, findings),
        |curve, findings| rail_section_for_head(base.clone(), curve, findings),
    )?;
    let surface = found.on(file, &reference, Seams::of_rail(&section), &mut records);
    let assumed = Some(found.assumed(given, reference.name));
    Ok(Sectioned { section, records, surface: Some(surface), base: Some(base), assumed, replicates })
}

/// Section of the wheel.
pub(crate) fn wheel(statics: Statics<'_>) -> Result<Sectioned<WheelSection>> {
    let keys = &statics.wheel;
    let mut records = Vec::new();
    let own = own_section(keys.section.as_ref(), ProfileKind::Wheel, keys.tape_circle, &mut records)?;
    let generic = |standard: &str| {
        let running = wheel_profile_with_flange(standard, &keys.flange)?;
        wheel_section_on(running, standard, keys.tape_diameter, &keys.body)
    };
    let own = match own {
        Some((file, read)) => Some(wheel_section_of(file, read.running, read.rest, keys.tape_diameter)?),
        None => keys.profile.as_deref().map(generic).transpose()?,
    };
    let Some(file) = &keys.measured else {
        let section = own.map_or_else(|| generic(""), Ok)?;
        return Ok(Sectioned::known(section, records));
    };
    let tape_circle = keys.tape_circle.or_else(|| own.as_ref().map(from_flange_back));
    let mut profile = measured::read(file, ProfileKind::Wheel, tape_circle)?;
    let (base, known) = match own {
        Some(section) => (section, true),
        None => {
            let Nominal { name, fits, said, .. } = measured::nominal(file, &profile)?;
            let base = generic(&name)?;
            // a standard may have its tape circle elsewhere
            if fits && keys.tape_circle.is_none() {
                profile = measured::read(file, ProfileKind::Wheel, Some(from_flange_back(&base)))?;
            }
            profile.findings.push(said);
            (base, fits)
        }
    };
    let reference = Reference::wheel(&base);
    let frame = |profile: &MeasuredProfile| {
        wheel_in_own_frame(profile, keys.tape_circle.unwrap_or_else(|| from_flange_back(&base)))
    };
    let (mut found, joins) = laid(file, profile, &reference, known, frame)?;
    let (section, replicates) = found.sections(
        joins,
        |curve, findings| wheel_section_with_profile(base.clone(), curve, findings),
        |curve, findings| wheel_section_for_profile(&base, curve, &keys.body, findings),
    )?;
    let surface = found.on(file, &reference, Seams::of_wheel(&section), &mut records);
    let assumed = Some(found.assumed(known, reference.name));
    Ok(Sectioned { section, records, surface: Some(surface), base: Some(base), assumed, replicates })
}

/// The profile in its place, and whether that is on a section which is `known` to be its own: on the `reference`, or by its own shape in the `frame` of a body
/// like its own.
fn laid(
    file: &MeasuredSurface,
    mut profile: MeasuredProfile,
    reference: &Reference,
    known: bool,
    frame: impl Fn(&MeasuredProfile) -> Result<OwnFrame>,
) -> Result<(Surface, bool)> {
    if known {
        if let Some(found) = measured::on_reference(file, &profile, reference)? {
            return Ok((found, true));
        }
        profile.findings.push(measured::unlike(&reference.name));
    }
    Ok((measured::by_itself(file, &profile, frame)?, false))
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
    let mut section = match &own.read {
        Some(read) if tape_circle.is_none() => ClosedSection::clone(read),
        _ => {
            let (sketch, section) = sketch_section(&name, &own.content, kind, tape_circle);
            section.map_err(|error| with_nearest_to(&sketch, kind, error))?
        }
    };
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
    /// Its section: joined to the section of its own where it `joins` that, or else, as where an end of it is too far from that, on a body moved to its ends. The
    /// same of its replicates.
    fn sections<S>(
        &mut self,
        joins: bool,
        join: impl Fn(&ProfileCurve, &mut Vec<Finding>) -> Result<S>,
        moved: impl Fn(&ProfileCurve, &mut Vec<Finding>) -> Result<S>,
    ) -> Result<(S, Vec<S>)> {
        let Prepared { curve, replicates, findings, .. } = &mut self.prepared;
        let mut joined = None;
        if joins {
            let before = findings.len();
            match join(curve, findings) {
                Err(Error::Input(error)) => {
                    findings.truncate(before);
                    let text = format!("{}: the body is moved to the measured ends", error.value);
                    findings.push(Finding::new(FindingKind::Joined, Action::Noted, text));
                }
                section => joined = Some(section?),
            }
        }
        let again = |curve: &ProfileCurve| match joined {
            Some(_) => join(curve, &mut Vec::new()),
            None => moved(curve, &mut Vec::new()),
        };
        let replicates = replicates.iter().map(again).collect::<Result<_>>()?;
        let section = joined.map_or_else(|| moved(curve, findings), Ok)?;
        Ok((section, replicates))
    }

    /// What is assumed of its body on the section `base`, whether that is `given` or only like it.
    fn assumed(&self, given: bool, base: String) -> Assumed {
        let like = (!given).then(|| base.clone());
        let turned = self.motion.map(|motion| motion.angle).filter(|angle| angle.abs() > TURNED);
        Assumed { like, base, curve: self.prepared.curve.clone(), turned, unsure: self.unsure }
    }

    /// The surface on its section, for the picture; its record is added.
    fn on(
        &self,
        measured: &MeasuredSurface,
        reference: &Reference,
        seams: Option<Seams<'_>>,
        records: &mut Vec<ProfileRecord>,
    ) -> OnStandard {
        records.push(ProfileRecord {
            body: reference.kind.name().into(),
            file: measured.file.clone(),
            content_hash: Some(measured.content.hash().to_owned()),
            format: self.in_place.format.to_string(),
            standard: reference.name.clone(),
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

/// What was done to measured profiles, what is left to be looked at, and what is assumed of their bodies and places, one line each.
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
    let assumes = [FindingKind::Shape, FindingKind::Aligned].map(FindingKind::name);
    let said = |profile: &ProfileRecord, finding: &FindingRecord| {
        let surface = [ProfileKind::Rail, ProfileKind::Wheel].iter().any(|kind| profile.body == kind.name());
        finding.action != Action::Noted.name() || (surface && assumes.contains(&finding.kind.as_str()))
    };
    let of = |profile: &ProfileRecord| -> Vec<String> {
        profile.findings.iter().filter(|f| said(profile, f)).map(|f| line(profile, f)).collect()
    };
    profiles.iter().flat_map(of).collect()
}

fn content_hash(content: &[u8]) -> String {
    blake3::hash(content).to_hex().to_string()
}

pub(super) fn finding_record(finding: &Finding) -> FindingRecord {
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

    use super::*;

    /// Source: the definition of APTA120, whose tape circle is 72.231 mm from its flange back. Goal: a file whose y (mm) counts from the flange back comes to
    /// the tape circle of its standard, by the standard's distance or the key's. Accuracy: a micrometre, the digits of the file's points.
    #[test]
    fn a_file_from_the_flange_back_has_the_tape_circle_of_its_standard() {
        const DIGITS: f64 = 1e-6;
        let folder = tempfile::tempdir().unwrap();
        let standard = railspring_profiles::profile::wheels::wheel_profile("APTA120").unwrap();
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
            wheel(crate::study::Study::parse(&folder.path().join("a.toml"), &text).unwrap().statics())
        };
        for more in ["", "tape_circle_mm = 72.231"] {
            let running = read(more).unwrap().section.running;
            let off = |s: f64| standard.closest(&running.point(s)).1;
            let largest = running.sample_parameters(1e-3).into_iter().map(off).fold(0.0, f64::max);
            assert!(largest < DIGITS, "{more:?}: {largest} m");
        }
        // taken for 70 mm it lies 2.231 mm aside, and is placed
        let aside = read("tape_circle_mm = 70").unwrap();
        let said = repairs(&aside.records).join("\n");
        assert!(said.contains("which lies off APTA120") && said.contains("2.23"), "{said}");
    }
}
