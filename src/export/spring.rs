//! The law that is exported, and what has to be said about it in every file.

use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::law::{REFERENCE_FORCE, StiffnessLaw};
use railspring_calibrate::units::KILONEWTON;

use crate::records::{ReferenceRecord, StiffnessRecord};

/// A file to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportFile {
    /// Its name, without a folder.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// The law with one reference.
pub(super) struct Spring<'a> {
    pub record: &'a StiffnessRecord,
    pub found: &'a ReferenceRecord,
    pub law: StiffnessLaw,
    /// Smallest and largest load of the fit, N.
    pub range: [f64; 2],
}

impl<'a> Spring<'a> {
    /// The law against `reference`, the study's own unless one is named; `file` is where it comes from.
    ///
    /// # Errors
    /// [`InputError`] for a reference that the file does not have, and for constants or a range that are none.
    pub fn of(file: &str, record: &'a StiffnessRecord, reference: Option<&str>) -> Result<Self> {
        let wanted = reference.unwrap_or(&record.reference);
        let found = record.references.iter().find(|found| found.reference == wanted).ok_or_else(|| {
            let there: Vec<String> = record.references.iter().map(|r| format!("{:?}", r.reference)).collect();
            InputError::new(
                "--reference",
                format!("{wanted:?}"),
                format!("one that {file} has: {}", there.join(", ")),
                "name one of them; calibrate with calibration.foot_held = true for \"foot\"",
            )
        })?;
        let law = StiffnessLaw::try_from(found.law.constants)?;
        let [low, high] = found.law.range_kn;
        if !(low > 0.0 && high > low && high.is_finite()) {
            return Err(InputError::new(
                format!("{file}: range_kn"),
                format!("[{low}, {high}]"),
                "two ascending loads above 0",
                "calibrate again",
            )
            .into());
        }
        Ok(Self { record, found, law, range: [low * KILONEWTON, high * KILONEWTON] })
    }

    /// Loads (N) at which a file shows what it does: common wheel loads, as far as the law has them.
    pub fn shown_loads(&self) -> Vec<f64> {
        let within = |load: &f64| (self.range[0]..=self.range[1]).contains(load);
        let common: Vec<f64> = [10e3, 50e3, 85e3, 120e3].into_iter().filter(within).collect();
        if common.is_empty() { self.range.to_vec() } else { common }
    }

    /// What every file says first: where it is from, the law and its worth; then what is the file's own.
    pub fn heading(&self, what: &str, own: &[String]) -> Vec<String> {
        let StiffnessRecord { study, pair, input_hash, version, .. } = self.record;
        let [low, high] = self.found.law.range_kn;
        let StiffnessLaw { a, b, c } = self.law;
        let against = match self.found.reference.as_str() {
            "beam" => {
                "the hub against the rail's section at the contact: one spring in series with a beam for the rail"
            }
            "local" => {
                "the approach of the two surfaces alone, without what wheel and rail deflect as bodies"
            }
            _ => "the hub against the held foot of the rail: the bending of the rail's head and web is in it",
        };
        let mut lines = vec![
            format!("{what}, by railspring {}", env!("CARGO_PKG_VERSION")),
            format!(
                "study {study}, {}; calibration {} by railspring {version}",
                pair.name,
                input_hash.get(..12).unwrap_or(input_hash)
            ),
            format!("reference {}: {against}", self.found.reference),
            format!(
                "law: k(F) = dF/dx = a + b (F/f0)^c, a = {a:e} N/m, b = {b:e} N/m, c = {c}, f0 = {REFERENCE_FORCE} N"
            ),
            format!(
                "range: fitted from {low} to {high} kN; below, the law goes on to no load; above {high} kN there is none"
            ),
            format!(
                "the law against the solid model: tangent within {:.2} %, displacement within {:.2} % of the largest",
                1e2 * self.found.law.max_rel_error,
                1e2 * self.found.displacement.max_rel_error
            ),
        ];
        let band = self.record.error_band.as_ref().and_then(|band| band.of(&self.found.reference));
        if let Some((displacement, tangent)) = band.and_then(|band| Some((band.displacement?, band.tangent?)))
        {
            lines.push(format!(
                "error band of the solid model: displacement {:.2} %, tangent {:.2} %",
                1e2 * displacement,
                1e2 * tangent
            ));
        }
        lines.extend(self.record.shortened());
        lines.extend_from_slice(own);
        lines.push("left out: tension (a wheel lifts off), friction, damping and mass".into());
        lines.iter().map(|line| plain(line)).collect()
    }
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
