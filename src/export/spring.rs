//! The law that is exported, and what has to be said about it in every file.

use railspring_calibrate::calibration::Reference;
use railspring_calibrate::law::{Form, NormalLaw, REFERENCE_FORCE, StepConstants, StiffnessLaw};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::KILONEWTON;

use crate::results::springs::form::FormRecord;
use crate::results::springs::record::{LawRecord, StiffnessRecord, TangentRecord};
use crate::rounding::significant;
use crate::table::document::DirectionKey;

/// A file to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportFile {
    /// Its name, without a folder.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// The law with one reference, and what is known besides.
pub(super) struct Spring {
    /// What it is from, `study` or `table`, and the name of that.
    pub source: [String; 2],
    /// The pair in words.
    pub pair: String,
    /// What made it: the second line of every file.
    pub made: String,
    /// Along what the wheel is pressed.
    pub direction: DirectionKey,
    /// What the displacement is measured against.
    pub reference: String,
    pub law: NormalLaw,
    /// Smallest and largest load of the fit, N.
    pub range: [f64; 2],
    /// Largest relative deviations of the law from the solid model at a load, tangent and displacement, in words; and from which load on both are small.
    pub fit_errors: [String; 2],
    /// Error bands of the solid model, relative: of the displacement and of the tangent.
    pub band: Option<[f64; 2]>,
    /// What else a heading says, a line each.
    pub remarks: Vec<String>,
    /// The solid model with the reference of the law.
    pub points: Vec<TangentRecord>,
    /// The solid model against `local`.
    pub local: Vec<TangentRecord>,
    /// Horizontal stiffness of the sticking wheel, kN/m.
    pub horizontal_kn_per_m: Option<f64>,
    /// Young's modulus (GPa) and Poisson's ratio at the running surface of a wheel whose groups have their own materials, if they are said.
    pub wheel_surface: Option<[f64; 2]>,
}

impl Spring {
    /// The law of a calibration against `reference`, the study's own unless one is named; `file` is where it comes from.
    ///
    /// # Errors
    /// [`InputError`] for a reference that the file does not have, and for constants or a range that are none.
    pub fn of_calibration(
        file: &str,
        record: &StiffnessRecord,
        reference: Option<&str>,
        form: Form,
    ) -> Result<Self> {
        let StiffnessRecord { study, pair, input_hash, version, references, .. } = record;
        let wanted = reference.unwrap_or(&record.reference);
        let of = |wanted: &str| references.iter().find(|found| found.reference == wanted);
        let found = of(wanted).ok_or_else(|| {
            let there = references.iter().map(|found| found.reference.as_str());
            no_reference(file, wanted, there, "calibrate with calibration.foot_held = true for \"foot\"")
        })?;
        let of_form = found.form(form).ok_or_else(|| no_form(file, form))?;
        let band = record.error_band.as_ref().and_then(|band| band.of(wanted));
        Ok(Self {
            source: ["study".into(), study.clone()],
            pair: pair.name.clone(),
            made: format!(
                "study {study}, {}; calibration {} by railspring {version}",
                pair.name,
                input_hash.get(..12).unwrap_or(input_hash)
            ),
            direction: DirectionKey::Vertical,
            reference: wanted.into(),
            law: NormalLaw::try_from(&of_form.law)?,
            range: range(file, &found.law, "calibrate")?,
            fit_errors: fit_errors(of_form),
            band: band.and_then(|band| Some([band.displacement?, band.tangent?])),
            remarks: record.shortened(),
            points: found.points.clone(),
            local: of(Reference::Local.name()).map(|local| local.points.clone()).unwrap_or_default(),
            horizontal_kn_per_m: record.horizontal_kn_per_m,
            wheel_surface: record
                .mesh
                .iter()
                .find(|mesh| mesh.body == "wheel")
                .and_then(|mesh| Some([mesh.surface_young_gpa?, mesh.surface_poisson?])),
        })
    }

    /// Loads (N) at which a file shows what it does: common wheel loads, as far as the law has them.
    pub fn shown_loads(&self) -> Vec<f64> {
        let within = |load: &f64| (self.range[0]..=self.range[1]).contains(load);
        let common: Vec<f64> = [10e3, 50e3, 85e3, 120e3].into_iter().filter(within).collect();
        if common.is_empty() { self.range.to_vec() } else { common }
    }

    /// What every file says first: where it is from, the law and its errors; then what is the file's own.
    pub fn heading(&self, what: &str, own: &[String]) -> Vec<String> {
        // as the file has them, without what the way through newtons adds in the last digit
        let [low, high] = self.range.map(|load| (load / KILONEWTON * 1e9).round() / 1e9);
        let against = match self.reference.as_str() {
            "beam" => {
                "the hub against the rail's section at the contact: one spring in series with a beam for the rail"
            }
            "local" => {
                "the approach of the two surfaces alone, without what wheel and rail deflect as bodies; the roll of rim and head is in it"
            }
            "half-spaces" => {
                "the approach of the two profiles on half-spaces, without bodies and without their roll, as half-space programs tabulate it"
            }
            _ => "the hub against the held foot of the rail: the bending of the rail's head and web is in it",
        };
        let along = match self.direction {
            DirectionKey::Vertical => "",
            DirectionKey::Normal => {
                "; force and displacement along the contact normal, the hub held across it"
            }
        };
        let [largest, from] = &self.fit_errors;
        let mut lines = vec![
            format!("{what}, by railspring {}", env!("CARGO_PKG_VERSION")),
            self.made.clone(),
            format!("reference {}: {against}{along}", self.reference),
            format!("law ({}): {}", self.law.form().name(), formula(&self.law)),
            format!(
                "range: fitted from {low} to {high} kN; below, the law goes on to no load; above {high} kN there is none"
            ),
            format!(
                "the law against the solid model, each over its value at the load: largest off {largest}"
            ),
            from.clone(),
        ];
        if let Some([displacement, tangent]) = self.band {
            lines.push(format!(
                "error band of the solid model: displacement {:.2} %, tangent {:.2} %",
                1e2 * displacement,
                1e2 * tangent
            ));
        }
        lines.extend_from_slice(&self.remarks);
        lines.extend_from_slice(own);
        lines.push("left out: tension (a wheel lifts off), friction, damping and mass".into());
        lines.iter().map(|line| plain(line)).collect()
    }
}

/// A law in N and m, F the force and x the displacement.
fn formula(law: &NormalLaw) -> String {
    let f0 = format!("f0 = {REFERENCE_FORCE} N");
    match law {
        NormalLaw::Power(StiffnessLaw { a, b, c }) => {
            format!("k(F) = dF/dx = a + b (F/f0)^c, a = {a:e} N/m, b = {b:e} N/m, c = {c}, {f0}")
        }
        NormalLaw::Series(law) => {
            let power = format!("b = {:e} N/m, c = {}, {f0}", law.b(), law.c());
            match law.s() {
                Some(s) => format!("dx/dF = 1/(b (F/f0)^c) + 1/s, {power}, s = {s:e} N/m"),
                None => format!("k(F) = dF/dx = b (F/f0)^c, {power}"),
            }
        }
        NormalLaw::Steps(law) => {
            let StepConstants { b, c, step_force, sharpness, rise, exponent_above } = law.constants();
            format!(
                "k(F) = dF/dx = b (F/f0)^c (1 + t)^((e - c)/p) (1 + d t/(1 + t)) with t = (F/f1)^p, b = {b:e} N/m, c = {c}, {f0}, \
                 f1 = {step_force} N, p = {sharpness}, d = {rise}, e = {exponent_above}"
            )
        }
        NormalLaw::Table(law) => format!(
            "{} tangents of the solid model, ln k over ln F a monotone cubic between them, a power {} below the first",
            law.knots().count(),
            significant(law.exponent_below(), 4)
        ),
    }
}

/// The errors of a law: the largest, and from which load on they are small.
pub(super) fn fit_errors(of: &FormRecord) -> [String; 2] {
    /// What is small: the smallest limits that a law keeps somewhere are named.
    const NAMED: usize = 2;
    let kept = of.within.iter().filter_map(|within| {
        let percent = significant(1e2 * within.limit, 1);
        Some(format!("{percent} % from {} kN on", significant(of.holds_from(within.limit)?, 3)))
    });
    let kept: Vec<String> = kept.take(NAMED).collect();
    let from = match kept.is_empty() {
        true => {
            "tangent and displacement are within none of the limits that are looked for at the largest load"
                .into()
        }
        false => format!("tangent and displacement both within {}", kept.join(", ")),
    };
    [of.largest_errors(), from]
}

/// The error for a form that a law of `file` does not have.
pub(super) fn no_form(file: &str, form: Form) -> InputError {
    let expected = format!("a form that {file} has; \"steps\" needs eight loads");
    InputError::new(
        "--law",
        format!("{:?}", form.name()),
        expected,
        "take \"table\", or calibrate at more loads",
    )
}

/// The error for a `wanted` reference that `file` does not have.
pub(super) fn no_reference<'r>(
    file: &str,
    wanted: &str,
    there: impl Iterator<Item = &'r str>,
    remedy: &str,
) -> InputError {
    let there: Vec<String> = there.map(|reference| format!("{reference:?}")).collect();
    let expected = format!("one that {file} has: {}", there.join(", "));
    InputError::new("--reference", format!("{wanted:?}"), expected, format!("name one of them; {remedy}"))
}

/// The range of a law of a file, N.
///
/// # Errors
/// [`InputError`] for one that is none.
pub(super) fn range(file: &str, law: &LawRecord, made_by: &str) -> Result<[f64; 2]> {
    let [low, high] = law.range_kn;
    if low > 0.0 && high > low && high.is_finite() {
        return Ok([low * KILONEWTON, high * KILONEWTON]);
    }
    let key = format!("{file}: range_kn");
    let remedy = format!("write the file again with `railspring {made_by}`");
    Err(InputError::new(key, format!("[{low}, {high}]"), "two ascending loads above 0", remedy).into())
}

/// One line of characters that every program reads.
pub(super) fn plain(line: &str) -> String {
    let replaced = |c: char| match c {
        ' '..='~' => c,
        _ if c.is_whitespace() || c.is_control() => ' ',
        _ => '?',
    };
    line.chars().map(replaced).collect()
}

/// Lines as comments, each behind `sign`.
pub(super) fn commented(sign: &str, lines: &[String]) -> String {
    lines.iter().map(|line| format!("{sign} {line}\n")).collect()
}
