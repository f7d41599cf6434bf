//! `table.csv`: one row for each place, with its inputs, what it has come to, and why, where that is less than it should be.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::iter::once;
use std::ops::Range;

use railspring_profiles::error::Result;
use railspring_profiles::units::MILLIMETRE;
use serde::Serialize;
use serde_json::Value;

use super::axle::{self, AxleConicity};
use super::carried::{CarriedRecord, near};
use super::cases::{Case, Table};
use super::made::{Made, MadePlace, Place, Status};
use super::making::{PlaceRecord, is_uncertain};
use super::surfaces::AMPLITUDES_MM;
use crate::engine::columns::{Cell, csv_of_texts};
use crate::results::by_angle::record::{AngleLawRecord, FixedLoadRecord};
use crate::study::Study;
use railspring_calibrate::law::Form;

/// Columns that say which place a row is of; the varied keys come after them.
pub const IDENTITY: [&str; 9] = [
    "wheel",
    "rail",
    "tape_diameter_m",
    "rail_inclination",
    "gauge_mm",
    "friction",
    "direction",
    "side",
    "shift_mm",
];
/// Keys of a study that have a column among these, in their order, behind wheel and rail.
pub const WITH_A_COLUMN: [&str; 4] =
    ["wheel.tape_diameter_m", "rail.inclination", "track.gauge_mm", "contact.friction"];
/// Columns with hashes of inputs, and what each is of.
pub const INPUTS: [(&str, &str); 4] = [
    ("wheel_hash", "the wheel"),
    ("rail_hash", "the rail"),
    ("settings_hash", "the settings"),
    ("version", "the program"),
];

impl From<&Value> for Cell {
    fn from(value: &Value) -> Self {
        match value {
            Value::Number(number) => number.as_f64().into(),
            Value::String(text) => text.as_str().into(),
            other => Self::Text(other.to_string()),
        }
    }
}

/// The rows of a table under their columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rows {
    /// Names of the columns, with units.
    pub columns: Vec<String>,
    /// The rows, in the order of the places.
    pub rows: Vec<Vec<Cell>>,
    /// The columns of what is known of the measurements.
    #[serde(skip)]
    pub metadata: Range<usize>,
}

impl Rows {
    /// The rows of the places of a table.
    ///
    /// # Errors
    /// A place that the store has no more.
    pub fn of(table: &Table, made: &Made<'_>) -> Result<Self> {
        let varied: BTreeSet<&str> =
            table.cases.iter().flat_map(|case| case.varied.keys().map(String::as_str)).collect();
        let varied: Vec<&str> = varied.into_iter().filter(|key| !WITH_A_COLUMN.contains(key)).collect();
        let known = known(table);
        let uncertain = table.cases.iter().any(|case| is_uncertain(&case.study));
        let measured = [true, false].map(|wheel| {
            table.cases.iter().any(|case| match wheel {
                true => case.study.wheel.measured.is_some(),
                false => case.study.rail.measured.is_some(),
            })
        });
        let from_files = table.cases.iter().any(|case| is_from_files(&case.study));
        let axles = axle::conicities(table, made);
        let row = |at: MadePlace<'_>, named: bool| -> Result<Row> {
            let (place, record) = (at.place, &*at.record()?);
            let mut row = Row { named, ..Row::default() };
            row.place(table, place, &known, &varied);
            row.touch(record);
            row.measured(record, measured);
            if !axles.is_empty() {
                row.axle(axles.get(&place.case));
            }
            row.law(law_in_use(&table.cases[place.case], record));
            for load in &table.document.stiffness_at_kn {
                row.load(&table.cases[place.case], record, &table.document.stiffness_at_kn, *load);
                if uncertain {
                    row.uncertainty(record, *load);
                }
            }
            if from_files {
                row.put("findings_left", record.findings_left.join("; ").as_str());
            }
            row.status(&table.cases[place.case], record);
            Ok(row)
        };
        // all rows have the columns of the first
        let first = made.places().next().map(|place| row(place, true)).transpose()?;
        let mut columns = first.map(|row| row.names).unwrap_or_default();
        let metadata = IDENTITY.len()..(IDENTITY.len() + known.len()).min(columns.len());
        for at in metadata.clone() {
            // a word of a file is no result
            if columns.iter().enumerate().any(|(other, name)| other != at && *name == columns[at]) {
                columns[at] += "_of_file";
            }
        }
        let rows = made.places().map(|place| Ok(row(place, false)?.cells)).collect::<Result<_>>()?;
        Ok(Self { columns, rows, metadata })
    }

    /// The number of a column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// The rows as CSV.
    pub fn csv(&self) -> Vec<u8> {
        let rows = self.rows.iter().map(|row| row.iter().map(Cell::text).collect());
        csv_of_texts(once(self.columns.clone()).chain(rows))
    }
}

/// Whether a profile or a section of a study is from a file, in which something may be found.
fn is_from_files(study: &Study) -> bool {
    let Study { wheel, rail, .. } = study;
    wheel.measured.is_some() || rail.measured.is_some() || wheel.section.is_some() || rail.section.is_some()
}

/// What is known of the wheel (0) or the rail (1) of some case, by its names.
fn known(table: &Table) -> Vec<(usize, &str)> {
    let names = |body: usize| -> BTreeSet<&str> {
        table.cases.iter().flat_map(|case| case.metadata[body].keys().map(String::as_str)).collect()
    };
    (0..2).flat_map(|body| names(body).into_iter().map(move |name| (body, name))).collect()
}

/// The law with the reference that the study has in use.
fn law_in_use<'a>(case: &Case, record: &'a PlaceRecord) -> Option<&'a AngleLawRecord> {
    let reference = reference(case);
    record.at.laws.iter().find(|law| law.reference == reference)
}

fn reference(case: &Case) -> &'static str {
    railspring_calibrate::calibration::Reference::from(case.study.calibration.reference).name()
}

/// A row as it grows.
#[derive(Default)]
struct Row {
    /// Whether the names of the columns are wanted.
    named: bool,
    names: Vec<String>,
    cells: Vec<Cell>,
}

impl Row {
    fn put(&mut self, name: impl Display, cell: impl Into<Cell>) {
        if self.named {
            self.names.push(name.to_string());
        }
        self.cells.push(cell.into());
    }

    fn place(&mut self, table: &Table, place: &Place, known: &[(usize, &str)], varied: &[&str]) {
        let case = &table.cases[place.case];
        let study = &case.study;
        let values: [Cell; 9] = [
            case.wheel.as_str().into(),
            case.rail.as_str().into(),
            study.wheel.tape_diameter.into(),
            study.rail.inclination.into(),
            (study.track.gauge / MILLIMETRE).into(),
            study.contact.friction.into(),
            table.document.direction.name().into(),
            place.side.name().into(),
            place.shift_mm.into(),
        ];
        IDENTITY.into_iter().zip(values).for_each(|(name, value)| self.put(name, value));
        for (body, name) in known {
            let cell = case.metadata[*body].get(*name).map_or(Cell::Number(None), Cell::from);
            self.put(format_args!("{}_{name}", ["wheel", "rail"][*body]), cell);
        }
        for key in varied {
            self.put(key.replace('.', "_"), case.varied.get(*key).map_or(Cell::Number(None), Cell::from));
        }
    }

    fn touch(&mut self, record: &PlaceRecord) {
        let touch = record.at.touch;
        self.put("contact_angle_deg", touch.map(|touch| touch.contact_angle_deg));
        self.put("rail_y_mm", touch.map(|touch| touch.rail_y_mm));
        self.put("rail_z_mm", touch.map(|touch| touch.rail_z_mm));
        self.put("wheel_y_mm", touch.map(|touch| touch.wheel_y_mm));
        self.put("wheel_z_mm", touch.map(|touch| touch.wheel_z_mm));
        self.put("rolling_radius_mm", record.rolling_radius_mm);
    }

    /// Of a table with measured wheels, and with measured rails.
    fn measured(&mut self, record: &PlaceRecord, [wheels, rails]: [bool; 2]) {
        let of = record.measured.as_ref();
        if wheels {
            let wheel = of.and_then(|of| of.wheel.as_ref());
            self.put("wheel_standard", wheel.map_or("", |wheel| &wheel.standard));
            self.put("wheel_lateral_uncertainty_mm", wheel.map(|wheel| wheel.lateral_uncertainty_mm));
            self.put("wheel_flange_height_mm", wheel.and_then(|wheel| wheel.flange_height_mm));
            self.put("wheel_flange_thickness_mm", wheel.and_then(|wheel| wheel.flange_thickness_mm));
            self.put("wheel_flange_slope_mm", wheel.and_then(|wheel| wheel.flange_slope_mm));
            self.put("wheel_tread_wear_mm", wheel.and_then(|wheel| wheel.tread_wear_mm));
            self.put("wheel_hollow_mm", wheel.and_then(|wheel| wheel.hollow_mm));
        }
        if rails {
            let rail = of.and_then(|of| of.rail.as_ref());
            self.put("rail_standard", rail.map_or("", |rail| &rail.standard));
            self.put("rail_roll_uncertainty_deg", rail.map(|rail| rail.roll_uncertainty_deg));
            self.put("rail_vertical_wear_mm", rail.and_then(|rail| rail.vertical_wear_mm));
            self.put("rail_lateral_wear_mm", rail.and_then(|rail| rail.lateral_wear_mm));
        }
        if wheels || rails {
            for (at, amplitude) in AMPLITUDES_MM.iter().enumerate() {
                let conicity = of.and_then(|of| *of.conicity.get(at)?);
                self.put(format_args!("conicity_at_{amplitude}mm"), conicity);
            }
            let bodies = record.bodies.as_ref();
            self.put("bodies", bodies.map_or("", |bodies| bodies.of.name()));
            let carried = bodies.and_then(|bodies| bodies.carried.as_ref());
            self.put("off_bodies_mm", carried.map(|carried| carried.off_mm));
            self.put("displacement_rel_bodies_band", carried.map(|carried| carried.displacement_rel_band));
            self.put("stiffness_rel_bodies_band", carried.map(CarriedRecord::largest_tangent_band));
            self.put("horizontal_rel_bodies_band", carried.map(|carried| carried.horizontal_rel_band));
            let own = carried.and_then(|carried| carried.own);
            self.put("displacement_rel_own_bodies", own.map(|own| own.displacement));
            self.put("stiffness_rel_own_bodies", own.map(|own| own.tangent));
            self.put("horizontal_rel_own_bodies", own.map(|own| own.horizontal));
        }
    }

    /// Of a table with axles of which both wheels were measured.
    fn axle(&mut self, conicity: Option<&AxleConicity>) {
        for (at, amplitude) in AMPLITUDES_MM.iter().enumerate() {
            self.put(format_args!("axle_conicity_at_{amplitude}mm"), conicity.and_then(|of| of[at]));
        }
    }

    fn law(&mut self, in_use: Option<&AngleLawRecord>) {
        let law = in_use.map(|entry| entry.law);
        self.put("reference", in_use.map_or(Cell::Number(None), |entry| entry.reference.as_str().into()));
        self.put("a_kn_per_m", law.map(|law| law.constants.a_kn_per_m));
        self.put("b_kn_per_m", law.map(|law| law.constants.b_kn_per_m));
        self.put("c", law.map(|law| law.constants.c));
        self.put("f0_kn", law.map(|law| law.constants.f0_kn));
        self.put("from_kn", law.map(|law| law.range_kn[0]));
        self.put("to_kn", law.map(|law| law.range_kn[1]));
        self.put("law_rms_rel_error", law.map(|law| law.rms_rel_error));
        self.put("law_max_rel_error", law.map(|law| law.max_rel_error));
        self.put(
            "displacement_max_rel_error",
            in_use.and_then(|entry| entry.form(Form::Power)).map(|of| of.displacement.max_rel_error),
        );
    }

    fn load(&mut self, case: &Case, record: &PlaceRecord, loads: &[f64], load_kn: f64) {
        let at = record.at.loads.iter().find(|at| near(at.force_kn, load_kn));
        let with = |reference: &str| at.and_then(|at| at.reference(reference));
        let in_use = with(reference(case));
        let local = with(railspring_calibrate::calibration::Reference::Local.name());
        let band = at.and_then(|at| record.at.band(reference(case), at.force_kn));
        let carried = record.bodies.as_ref().and_then(|bodies| bodies.carried.as_ref());
        let of_bodies = carried.map_or(0.0, |carried| carried.tangent_band(load_kn));
        let number = loads.iter().position(|load| *load == load_kn);
        let hertz = number.and_then(|number| record.hertz_kn_per_m.get(number).copied());
        let mut put = |name: &str, value: Option<f64>| self.put(format_args!("{name}_at_{load_kn}kn"), value);
        put("displacement_mm", in_use.map(|at| at.displacement_mm));
        put("stiffness_kn_per_m", in_use.map(|at| at.tangent_kn_per_m));
        // a hole may hide anything
        let band = band.filter(|_| record.findings_left.is_empty());
        put("stiffness_rel_error_band", band.and_then(|band| Some(band.tangent?.hypot(of_bodies))));
        put("local_stiffness_kn_per_m", local.map(|at| at.tangent_kn_per_m));
        put("hertz_normal_stiffness_kn_per_m", hertz);
        put("horizontal_kn_per_m", at.map(|at| at.horizontal_kn_per_m));
        put("horizontal_contact_share", at.and_then(FixedLoadRecord::horizontal_contact_share));
        put("contact_area_mm2", at.map(|at| at.contact_area_mm2));
        put("semi_axis_along_mm", at.map(|at| at.semi_axis_along_mm));
        put("semi_axis_across_mm", at.map(|at| at.semi_axis_across_mm));
        put("max_pressure_mpa", at.map(|at| at.max_pressure_mpa));
    }

    fn uncertainty(&mut self, record: &PlaceRecord, load_kn: f64) {
        let mut at = record.uncertainty.iter().flat_map(|of| &of.loads);
        let bands = at.find(|(force_kn, _)| near(*force_kn, load_kn)).map(|(_, bands)| *bands);
        let names = ["displacement", "stiffness"];
        for (part, name) in names.into_iter().enumerate() {
            let column = format!("{name}_rel_input_uncertainty_at_{load_kn}kn");
            self.put(column, bands.map(|bands| bands[part]));
        }
    }

    fn status(&mut self, case: &Case, record: &PlaceRecord) {
        self.put("status", Status::of(record).name());
        self.put("reason", record.at.reason.as_deref().unwrap_or_default());
        /// Digits of a hash that are enough to tell inputs from each other.
        const DIGITS: usize = 12;
        let [wheel, rail, settings] = case.parts.each_ref().map(|hash| &hash[..DIGITS]);
        let values = [wheel, rail, settings, env!("CARGO_PKG_VERSION")];
        INPUTS.into_iter().zip(values).for_each(|((name, _), value)| self.put(name, value));
    }
}
