//! What is compared of measured bodies: columns with their names and units on the page.

use super::kind::{Kind, number};
use crate::engine::columns::Cell;
use crate::table::rows::Rows;

/// Of what a quantity is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The profile alone: the same in every row of it.
    Body,
    /// The pair, whatever the shift.
    Pair,
    /// The place.
    Place,
}

/// A column that is compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its number in the rows.
    pub column: usize,
    /// What it is in words: `k at 50 kN`.
    pub name: String,
    /// Its unit on the page.
    pub unit: &'static str,
    /// That unit over the unit of the column.
    scale: f64,
    /// Of what it is.
    pub source: Source,
    /// Which of those that are compared side by side it is, if any.
    pub role: Option<Role>,
}

/// Quantities that have figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Stiffness at the load in the middle.
    Stiffness,
    /// Lateral stiffness at that load.
    Horizontal,
    /// Conicity at the largest amplitude.
    Conicity,
    /// Wear of the profile.
    Wear,
}

/// Measures of wear: column, name.
const WEAR: [(&str, &str); 7] = [
    ("wheel_flange_height_mm", "flange height"),
    ("wheel_flange_thickness_mm", "flange thickness"),
    ("wheel_flange_slope_mm", "flange slope qR"),
    ("wheel_tread_wear_mm", "tread wear"),
    ("wheel_hollow_mm", "hollow"),
    ("rail_vertical_wear_mm", "vertical wear"),
    ("rail_lateral_wear_mm", "lateral wear"),
];

impl Quantity {
    /// Those of a kind of bodies that have a column.
    pub fn all(kind: Kind, rows: &Rows) -> Vec<Self> {
        let beginning = |prefix: &str| -> Vec<(usize, String)> {
            let columns = rows.columns.iter().enumerate();
            columns.filter_map(|(at, name)| Some((at, name.strip_prefix(prefix)?.to_string()))).collect()
        };
        let mut all = Vec::new();
        let series = [
            ("stiffness_kn_per_m_at_", "k at ", "10\u{2076} kN/m", 1e-6, Source::Place, Role::Stiffness),
            ("horizontal_kn_per_m_at_", "k_h at ", "10\u{2076} kN/m", 1e-6, Source::Place, Role::Horizontal),
            ("conicity_at_", "conicity at ", "1", 1.0, Source::Pair, Role::Conicity),
        ];
        for (prefix, name, unit, scale, source, role) in series {
            let columns = beginning(prefix);
            // the load in the middle, the largest amplitude
            let main =
                if role == Role::Conicity { columns.len().saturating_sub(1) } else { columns.len() / 2 };
            for (index, (column, at)) in columns.iter().enumerate() {
                let at = at.replace("kn", " kN").replace("mm", " mm");
                let role = (index == main).then_some(role);
                all.push(Self { column: *column, name: format!("{name}{at}"), unit, scale, source, role });
            }
        }
        let wear = WEAR.iter().filter(|(column, _)| column.starts_with(kind.name()));
        all.extend(wear.filter_map(|(column, name)| {
            Some(Self {
                column: rows.column(column)?,
                name: (*name).into(),
                unit: "mm",
                scale: 1.0,
                source: Source::Body,
                role: Some(Role::Wear),
            })
        }));
        all
    }

    /// Its value in a row, in the unit of the page.
    pub fn of_row(&self, row: &[Cell]) -> Option<f64> {
        number(&row[self.column]).map(|value| self.scale * value)
    }

    /// Its name with its unit: `k at 50 kN, 10⁶ kN/m`.
    pub fn with_unit(&self) -> String {
        match self.unit {
            "1" => self.name.clone(),
            unit => format!("{}, {unit}", self.name),
        }
    }
}

/// The first with a role.
pub fn with_role(quantities: &[Quantity], role: Role) -> Option<&Quantity> {
    quantities.iter().find(|quantity| quantity.role == Some(role))
}
