//! What was compared: a row for every load of the tables, and one for every normal force on the flange.

use railspring::engine::output::to_csv;
use serde::Serialize;

use super::bodies::PressedOn;
use super::facts::Values;

/// The compared quantities with their units and the limits of their differences.
pub const QUANTITIES: [(&str, &str, f64); 4] = [
    ("approach", "mm", 0.01),
    ("tangent", "kN/mm", 0.01),
    ("area", "mm\u{b2}", 0.01),
    ("largest pressure", "MPa", 0.02),
];

/// A load of the tables.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Standard rail.
    pub rail: String,
    /// Standard wheel.
    pub wheel: String,
    /// Shift towards the flange, mm.
    pub shift_mm: f64,
    /// Vertical load, kN.
    pub load_kn: f64,
    /// The program's values.
    pub tables: Values,
    /// Those found on each of [`PressedOn::ALL`].
    pub found: [Values; 4],
}

/// Parts of a difference, relative to the value of the tables. They add up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// Rim and head that roll: flexible against stiff bodies.
    pub roll: f64,
    /// Bodies that end and turn with the profile: stiff ones against half-spaces.
    pub bodies: f64,
    /// The spacing of the contact's grid: half-spaces against those on half the grid.
    pub grid: f64,
    /// What is left between two half-space programs.
    pub rest: f64,
}

impl Compared {
    /// The place in words.
    pub fn place(&self) -> String {
        format!("{}/{} {:+}", self.rail, self.wheel, self.shift_mm)
    }

    /// Relative difference of a quantity.
    pub fn difference(&self, on: PressedOn, quantity: usize) -> f64 {
        self.found[on.index()][quantity] / self.tables[quantity] - 1.0
    }

    /// What the difference of a quantity is made of; what the bodies do not have is zero.
    pub fn parts(&self, on: PressedOn, quantity: usize) -> Parts {
        let of = |on: PressedOn| self.found[on.index()][quantity];
        let table = self.tables[quantity];
        let step = |from: PressedOn, to: PressedOn| (of(to) - of(from)) / table;
        let is = |kinds: &[PressedOn], part: f64| if kinds.contains(&on) { part } else { 0.0 };
        use PressedOn::{Flexible, HalfSpaces, HalfSpacesHalved, Stiff};
        Parts {
            roll: is(&[Flexible], step(Stiff, Flexible)),
            bodies: is(&[Flexible, Stiff], step(HalfSpaces, Stiff)),
            grid: is(&[Flexible, Stiff, HalfSpaces], step(HalfSpacesHalved, HalfSpaces)),
            rest: of(HalfSpacesHalved) / table - 1.0,
        }
    }
}

/// A normal force on the flange. Values of a wheel that is pressed downwards are turned to the normal.
#[derive(Debug, Clone, PartialEq)]
pub struct OnFlange {
    /// Standard rail.
    pub rail: String,
    /// Standard wheel.
    pub wheel: String,
    /// Shift towards the flange, mm.
    pub shift_mm: f64,
    /// Contact angle at the first touch, degrees.
    pub angle_deg: f64,
    /// Normal force, kN.
    pub normal_kn: f64,
    /// Half-spaces, pressed along the normal.
    pub half_spaces: Values,
    /// Half-spaces, pressed downwards.
    pub downwards: Values,
    /// Stiff bodies, pressed along the normal.
    pub stiff: Values,
    /// Flexible bodies, pressed along the normal.
    pub flexible: Values,
}

impl OnFlange {
    /// Relative steps of a quantity: from the normal to the vertical path, from half-spaces to stiff bodies, and on to flexible ones.
    pub fn steps(&self, quantity: usize) -> [f64; 3] {
        let step = |from: &Values, to: &Values| to[quantity] / from[quantity] - 1.0;
        [
            step(&self.half_spaces, &self.downwards),
            step(&self.half_spaces, &self.stiff),
            step(&self.stiff, &self.flexible),
        ]
    }
}

/// All that was compared.
pub struct Comparison {
    /// Least load that is judged, kN.
    pub from_kn: f64,
    /// The loads of the tables.
    pub rows: Vec<Compared>,
    /// The flange.
    pub flange: Vec<OnFlange>,
}

/// Those that have to hold: a half-space program knows nothing of rim and head.
pub const JUDGED: [PressedOn; 2] = [PressedOn::HalfSpaces, PressedOn::Stiff];

impl Comparison {
    /// Nothing yet.
    pub fn new(from_kn: f64) -> Self {
        Self { from_kn, rows: Vec::new(), flange: Vec::new() }
    }

    /// The rows that are judged.
    pub fn judged(&self) -> impl Iterator<Item = &Compared> {
        self.rows.iter().filter(|row| row.load_kn >= self.from_kn)
    }

    /// The judged places, in the order of the rows.
    pub fn places(&self) -> Vec<String> {
        let mut places: Vec<String> = self.judged().map(Compared::place).collect();
        places.dedup();
        places
    }

    /// The judged row of a place with the largest difference.
    pub fn worst(&self, place: &str, on: PressedOn, quantity: usize) -> Option<&Compared> {
        let off = |row: &&Compared| row.difference(on, quantity).abs();
        self.judged().filter(|row| row.place() == place).max_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// How many quantities of all places hold at every judged load, and how many there are.
    pub fn count(&self, on: PressedOn) -> [usize; 2] {
        let places = self.places();
        let all =
            places.iter().flat_map(|place| (0..QUANTITIES.len()).map(move |quantity| (place, quantity)));
        let holds = |(place, quantity): &(&String, usize)| {
            let worst = self.worst(place, on, *quantity);
            worst.is_some_and(|row| row.difference(on, *quantity).abs() <= QUANTITIES[*quantity].2)
        };
        [all.filter(holds).count(), places.len() * QUANTITIES.len()]
    }

    /// Whether everything that is judged holds, and there is something.
    pub fn holds(&self) -> bool {
        JUDGED.into_iter().all(|on| {
            let [hold, all] = self.count(on);
            all > 0 && hold == all
        })
    }

    /// Every load, quantity and body as a row.
    pub fn csv(&self) -> Vec<u8> {
        #[derive(Serialize)]
        struct Row<'a> {
            rail: &'a str,
            wheel: &'a str,
            lateral_shift_mm: f64,
            load_kn: f64,
            pressed_on: &'static str,
            quantity: &'static str,
            unit: &'static str,
            table: f64,
            found: f64,
            difference: f64,
            limit: f64,
            of_roll: f64,
            of_bodies: f64,
            of_grid: f64,
            rest: f64,
        }
        let mut rows = Vec::new();
        for row in &self.rows {
            for on in PressedOn::ALL {
                for (n, (quantity, unit, limit)) in QUANTITIES.into_iter().enumerate() {
                    let Parts { roll, bodies, grid, rest } = row.parts(on, n);
                    rows.push(Row {
                        rail: &row.rail,
                        wheel: &row.wheel,
                        lateral_shift_mm: row.shift_mm,
                        load_kn: row.load_kn,
                        pressed_on: on.name(),
                        quantity,
                        unit,
                        table: row.tables[n],
                        found: row.found[on.index()][n],
                        difference: row.difference(on, n),
                        limit,
                        of_roll: roll,
                        of_bodies: bodies,
                        of_grid: grid,
                        rest,
                    });
                }
            }
        }
        to_csv(&rows)
    }

    /// Every normal force and quantity on the flange as a row.
    pub fn flange_csv(&self) -> Vec<u8> {
        #[derive(Serialize)]
        struct Row<'a> {
            rail: &'a str,
            wheel: &'a str,
            lateral_shift_mm: f64,
            contact_angle_deg: f64,
            normal_force_kn: f64,
            quantity: &'static str,
            unit: &'static str,
            half_spaces: f64,
            half_spaces_downwards: f64,
            stiff_bodies: f64,
            flexible_bodies: f64,
        }
        let mut rows = Vec::new();
        for row in &self.flange {
            rows.extend(QUANTITIES.iter().enumerate().map(|(n, (quantity, unit, _))| Row {
                rail: &row.rail,
                wheel: &row.wheel,
                lateral_shift_mm: row.shift_mm,
                contact_angle_deg: row.angle_deg,
                normal_force_kn: row.normal_kn,
                quantity,
                unit,
                half_spaces: row.half_spaces[n],
                half_spaces_downwards: row.downwards[n],
                stiff_bodies: row.stiff[n],
                flexible_bodies: row.flexible[n],
            }));
        }
        to_csv(&rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(load_kn: f64, found: [f64; 4]) -> Compared {
        Compared {
            rail: "A".into(),
            wheel: "B".into(),
            shift_mm: 5.0,
            load_kn,
            tables: [1.0; 4],
            found: found.map(|value| [value; 4]),
        }
    }

    /// Goal: the parts add up to the difference of each of the bodies, and a half-space has no roll. Accuracy: ROUNDOFF.
    #[test]
    fn parts_add_up() {
        const ROUNDOFF: f64 = 1e-15;
        let row = row(20.0, [1.02, 1.01, 1.05, 1.2]);
        for on in PressedOn::ALL {
            let Parts { roll, bodies, grid, rest } = row.parts(on, 0);
            assert!((roll + bodies + grid + rest - row.difference(on, 0)).abs() < ROUNDOFF, "{on:?}");
        }
        assert_eq!(row.parts(PressedOn::HalfSpaces, 0).roll, 0.0);
        assert!((row.parts(PressedOn::Flexible, 0).roll - 0.15).abs() < ROUNDOFF);
    }

    /// Goal: the largest difference of the judged loads decides, smaller loads do not, flexible bodies are counted alone, and nothing at
    /// all does not hold.
    #[test]
    fn the_worst_judged_load_decides() {
        let mut comparison = Comparison::new(20.0);
        assert!(!comparison.holds());
        comparison.rows.push(row(5.0, [2.0; 4]));
        assert!(!comparison.holds());
        comparison.rows.push(row(20.0, [1.005, 1.005, 1.005, 1.2]));
        assert!(comparison.holds());
        assert_eq!(comparison.count(PressedOn::Flexible), [0, 4]);
        // above 1, below 2 %: the pressure holds
        comparison.rows.push(row(40.0, [1.0, 1.0, 0.985, 1.0]));
        assert_eq!(comparison.count(PressedOn::Stiff), [1, 4]);
        assert!(!comparison.holds());
    }
}
