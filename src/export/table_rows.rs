//! Rows of a `table.json`: which of them are exported, and the spring of each.

use std::collections::BTreeSet;
use std::iter::once;

use railspring_calibrate::calibration::Reference;
use railspring_calibrate::law::{Form, NormalLaw};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::MILLIMETRE;

use super::format::{Format, LawForm, files};
use super::spring::{ExportFile, Spring, fit_errors, no_form, no_reference, range};
use crate::engine::columns::{Cell, csv_of_texts};
use crate::results::by_angle::record::FixedLoadRecord;
use crate::results::by_angle::record::ShiftRecord;
use crate::results::springs::record::TangentRecord;
use crate::study::Study;
use crate::table::document::DirectionKey;
use crate::table::rows::{IDENTITY, WITH_A_COLUMN};
use crate::table::{CaseRecord, PlaceEntry, Table, TableRecord};

/// What a row must have to be exported: a value in a column that says which place it is of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Condition {
    column: String,
    value: String,
}

impl Condition {
    /// A condition as it is written, `COLUMN=VALUE`.
    ///
    /// # Errors
    /// [`InputError`] for a text without `=`.
    pub fn parse(text: &str) -> std::result::Result<Self, InputError> {
        let (column, value) = text.split_once('=').ok_or_else(|| {
            let remedy = "write column and value with = between them, such as wheel=S1002";
            InputError::new("--where", text, "COLUMN=VALUE", remedy)
        })?;
        Ok(Self { column: column.trim().into(), value: value.trim().into() })
    }

    fn holds(&self, row: &ExportRow<'_>) -> bool {
        row.value(&self.column).is_some_and(|value| same(&value, &self.value))
    }
}

/// Whether two texts are the same, or the same number; `1:40` is a number, too.
fn same(a: &str, b: &str) -> bool {
    let number = |text: &str| -> Option<f64> {
        match text.split_once(':') {
            Some((of, to)) => Some(of.parse::<f64>().ok()? / to.parse::<f64>().ok()?),
            None => text.parse().ok(),
        }
    };
    // as far as a number in a table.csv was given with fewer digits
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    a == b || number(a).zip(number(b)).is_some_and(|(a, b)| near(a, b))
}

/// A row of a table.
#[derive(Debug, Clone, Copy)]
pub struct ExportRow<'a> {
    file: &'a str,
    table: &'a TableRecord<'static>,
    case: &'a CaseRecord<'static>,
    place: &'a PlaceEntry,
    /// Its number in `table.csv`, from 1 on.
    number: usize,
    /// How many rows the table has.
    of: usize,
}

/// The rows of a table that fulfil all conditions; `file` is where the table comes from.
///
/// # Errors
/// [`InputError`] for a column that says nothing about a place, a value that no row has, and conditions that no row fulfils together.
pub fn rows<'a>(
    file: &'a str,
    table: &'a TableRecord<'static>,
    conditions: &[Condition],
) -> Result<Vec<ExportRow<'a>>> {
    let of = table.cases.iter().map(|case| case.places.len()).sum();
    let places = table.cases.iter().flat_map(|case| case.places.iter().map(move |place| (case, place)));
    let row = |(index, (case, place))| ExportRow { file, table, case, place, number: index + 1, of };
    let mut rows: Vec<ExportRow<'a>> = places.enumerate().map(row).collect();
    for condition in conditions {
        let Condition { column, value } = condition;
        let values: BTreeSet<String> = rows.iter().filter_map(|row| row.value(column)).collect();
        if values.is_empty() {
            let columns = rows.first().map(ExportRow::columns).unwrap_or_default().join(", ");
            let expected = format!("a column that says which place a row is of: {columns}");
            return Err(InputError::new("--where", column, expected, "name one of them").into());
        }
        if !rows.iter().any(|row| condition.holds(row)) {
            let values = values.into_iter().collect::<Vec<_>>().join(", ");
            let expected = format!("a value that a row of {file} has: {values}");
            return Err(
                InputError::new(format!("--where {column}"), value, expected, "name one of them").into()
            );
        }
    }
    rows.retain(|row| conditions.iter().all(|condition| condition.holds(row)));
    if rows.is_empty() {
        let given: Vec<String> = conditions.iter().map(|c| format!("{}={}", c.column, c.value)).collect();
        let expected = format!("conditions that a row of {file} fulfils together");
        return Err(InputError::new("--where", given.join(", "), expected, "leave one of them out").into());
    }
    Ok(rows)
}

impl ExportRow<'_> {
    /// The columns that say which place it is of.
    fn columns(&self) -> Vec<String> {
        let varied = self.case.varied.keys().filter(|key| !WITH_A_COLUMN.contains(&key.as_str()));
        IDENTITY
            .iter()
            .map(|name| (*name).to_string())
            .chain(self.known().map(|(column, _)| column))
            .chain(varied.map(|key| key.replace('.', "_")))
            .collect()
    }

    /// What is known of its measurements, by columns.
    fn known(&self) -> impl Iterator<Item = (String, String)> {
        let CaseRecord { wheel_metadata, rail_metadata, .. } = self.case;
        [("wheel", wheel_metadata), ("rail", rail_metadata)].into_iter().flat_map(|(body, metadata)| {
            metadata.iter().map(move |(name, value)| (format!("{body}_{name}"), Cell::from(value).text()))
        })
    }

    /// Its value in such a column, or for any key of a study.
    fn value(&self, column: &str) -> Option<String> {
        let Self { table, case, place, .. } = self;
        let known = match column {
            "wheel" => case.wheel.to_string(),
            "rail" => case.rail.to_string(),
            "direction" => table.table.direction.name().into(),
            "side" => place.side.name().into(),
            "shift_mm" => place.shift_mm.to_string(),
            _ => {
                if let Some((_, value)) = self.known().find(|(name, _)| name == column) {
                    return Some(value);
                }
                let with_a_column =
                    IDENTITY[2..].iter().zip(WITH_A_COLUMN).find(|(name, _)| **name == column);
                let wanted = with_a_column.map_or(column, |(_, key)| key);
                let is_it = |key: &str| key == wanted || key.replace('.', "_") == wanted;
                let mut keys = case.keys.iter().chain(&table.keys);
                return keys
                    .find(|key| is_it(&format!("{}.{}", key.section, key.key)))
                    .map(|key| key.value.clone());
            }
        };
        Some(known)
    }

    /// Name of its folder among those of other rows: its number, and what it is of.
    pub fn folder(&self) -> String {
        let Self { case, place, number, of, .. } = self;
        let digits = of.to_string().len();
        let name = format!(
            "{number:0digits$}-{}-{}-{}-{}mm",
            case.wheel,
            case.rail,
            place.side.name(),
            place.shift_mm
        );
        let plain = |c: char| if c.is_ascii_alphanumeric() || "-.+_".contains(c) { c } else { '_' };
        name.chars().map(plain).collect()
    }

    /// The files of a format: the law against `reference`, that of the table unless one is named; `source` is the table of these rows, which
    /// [`Format::Gensys`] and [`Format::Contact`] take their profiles from.
    ///
    /// # Errors
    /// [`InputError`] for a place without a law or without that reference, a table that is missing or of other pairs, and laws along
    /// another direction than the format wants.
    pub fn files(
        &self,
        format: Format,
        reference: Option<&str>,
        law: Option<LawForm>,
        source: Option<&Table>,
    ) -> Result<Vec<ExportFile>> {
        let study = source.map(|table| self.study(table)).transpose()?;
        let form = law.map_or(format.usual_form(), Form::from);
        files(&self.spring(reference, form)?, format, study.as_ref(), || self.by_angle())
    }

    fn spring(&self, reference: Option<&str>, form: Form) -> Result<Spring> {
        let Self { file, table, case, place, number, .. } = self;
        let place_of = format!("{file}: row {number}");
        let at = &place.record.at;
        let in_use = || self.value("calibration.reference").unwrap_or_default();
        let wanted = reference.map_or_else(in_use, str::to_owned);
        let Some(found) = at.laws.iter().find(|law| law.reference == wanted) else {
            if at.laws.is_empty() {
                let reason = at.reason.as_deref().unwrap_or("the table does not say why");
                let remedy = "choose another place with --where";
                return Err(InputError::new(
                    place_of,
                    format!("no law: {reason}"),
                    "a place with a law",
                    remedy,
                )
                .into());
            }
            let there = at.laws.iter().map(|law| law.reference.as_str());
            let remedy = "make the table with calibration.foot_held = true for \"foot\"";
            return Err(no_reference(&place_of, &wanted, there, remedy).into());
        };
        let of_form = found.form(form).ok_or_else(|| no_form(&place_of, form))?;
        let band = at.error_band.as_ref().and_then(|band| band.of(&wanted));
        let short = |hash: &String| hash.get(..12).unwrap_or(hash).to_owned();
        let [wheel, rail, settings] = case.inputs.each_ref().map(short);
        let pair = self.pair();
        Ok(Spring {
            source: ["table".into(), table.table.name.clone()],
            made: format!(
                "table {}, {pair}; wheel {wheel}, rail {rail}, settings {settings} by railspring {}",
                table.table.name, table.version
            ),
            pair,
            direction: table.table.direction,
            law: NormalLaw::try_from(&of_form.law)?,
            range: range(&place_of, &found.law, "table")?,
            fit_errors: fit_errors(of_form),
            band: band.and_then(|band| Some([band.displacement?, band.tangent?])),
            remarks: self.remarks(),
            points: points(at, &wanted),
            local: points(at, Reference::Local.name()),
            horizontal_kn_per_m: self.horizontal().map(|[mean, ..]| mean),
            wheel_surface: None,
            reference: wanted,
        })
    }

    /// The place in words.
    fn pair(&self) -> String {
        let Self { case, place, .. } = self;
        let value =
            |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let varied: String = case.varied.iter().map(|(key, of)| format!(" {key} = {},", value(of))).collect();
        let side = place.side.name();
        format!("wheel {}, rail {},{varied} {side} side, shift {} mm", case.wheel, case.rail, place.shift_mm)
    }

    fn remarks(&self) -> Vec<String> {
        let record = &self.place.record;
        let touch = record.at.touch.zip(record.rolling_radius_mm).map(|(touch, radius)| {
            format!(
                "first touch: contact angle {:.3} degrees, rolling radius {radius:.3} mm",
                touch.contact_angle_deg
            )
        });
        let horizontal = self.horizontal().map(|[_, least, largest]| {
            let loads: Vec<String> = record.at.loads.iter().map(|load| load.force_kn.to_string()).collect();
            format!(
                "horizontal stiffness of the sticking wheel: {least:.0} to {largest:.0} kN/m under {} kN; their mean is taken",
                loads.join(", ")
            )
        });
        let shared = record.at.shared_from_kn.map(|load| {
            format!("from {load} kN on two contacts share the load: the law is that of the pair, along the direction above")
        });
        let end =
            record.at.reason.as_ref().map(|reason| format!("the law ends before the largest load: {reason}"));
        [touch, horizontal, shared, end].into_iter().flatten().collect()
    }

    /// Mean, smallest and largest horizontal stiffness over the loads of the columns, kN/m; as the springs of a study have the mean over
    /// its preloads.
    fn horizontal(&self) -> Option<[f64; 3]> {
        let all: Vec<f64> = self.place.record.at.loads.iter().map(|load| load.horizontal_kn_per_m).collect();
        let [least, largest] = [all.iter().copied().reduce(f64::min)?, all.iter().copied().reduce(f64::max)?];
        Some([all.iter().sum::<f64>() / all.len() as f64, least, largest])
    }

    /// The study of its pair at its shift.
    fn study(&self, source: &Table) -> Result<Study> {
        let Self { file, case, place, .. } = self;
        let found = source
            .cases
            .iter()
            .find(|of| of.parts == *case.inputs && of.wheel == case.wheel && of.rail == case.rail);
        let found = found.ok_or_else(|| {
            let expected = format!("the table that {file} was made from, with {}", self.pair());
            let remedy = "name that table, or make it again with `railspring table`";
            InputError::new("--study", format!("table {}", source.document.name), expected, remedy)
        })?;
        let mut study = found.study.clone();
        study.track.lateral_shift = place.record.at.shift_mm * MILLIMETRE;
        Ok(study)
    }

    /// The laws of all places of its pair, each once: a left wheel stands as a right one under the opposite shift.
    fn by_angle(&self) -> Result<Vec<ShiftRecord>> {
        if self.table.table.direction != DirectionKey::Normal {
            let expected = "\"normal\": GENSYS takes the stiffness along the contact normal";
            let remedy = "make the table with direction = \"normal\"";
            return Err(InputError::new("direction", "\"vertical\"", expected, remedy).into());
        }
        let mut shifts: Vec<ShiftRecord> =
            self.case.places.iter().map(|place| place.record.at.clone()).collect();
        shifts.sort_by(|a, b| a.shift_mm.total_cmp(&b.shift_mm));
        shifts.dedup_by(|a, b| a.shift_mm == b.shift_mm);
        Ok(shifts)
    }
}

fn points(at: &ShiftRecord, reference: &str) -> Vec<TangentRecord> {
    let loads = at.loads.iter();
    let point = |load: &FixedLoadRecord| {
        let of = load.reference(reference)?;
        Some(TangentRecord {
            force_kn: load.force_kn,
            displacement_mm: of.displacement_mm,
            tangent_kn_per_m: of.tangent_kn_per_m,
        })
    };
    loads.filter_map(point).collect()
}

/// What every list of [`index`] begins with.
pub const INDEX_BEGIN: &str = "row,folder,";

/// What has become of the rows, as CSV: one line for each, with its folder and its files, or why it has none.
pub fn index(entries: &[(ExportRow<'_>, std::result::Result<Vec<String>, String>)]) -> Vec<u8> {
    let columns = entries.first().map(|(row, _)| row.columns()).unwrap_or_default();
    let names =
        ["row", "folder"].into_iter().chain(columns.iter().map(String::as_str)).chain(["files", "reason"]);
    let cells = |(row, made): &(ExportRow<'_>, std::result::Result<Vec<String>, String>)| -> Vec<String> {
        let values = columns.iter().map(|column| row.value(column).unwrap_or_default());
        let (folder, files, reason) = match made {
            Ok(files) => (row.folder(), files.join(" "), String::new()),
            Err(reason) => (String::new(), String::new(), reason.clone()),
        };
        [row.number.to_string(), folder].into_iter().chain(values).chain([files, reason]).collect()
    };
    csv_of_texts(once(names.map(str::to_owned).collect()).chain(entries.iter().map(cells)))
}
