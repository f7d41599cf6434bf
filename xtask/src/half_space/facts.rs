//! The tables of the half-space program.

use std::collections::BTreeMap;
use std::path::Path;

use railspring_profiles::error::{InputError, Result};

/// Loads on vertical approaches, file of any pairs.
const ANY: &str = "contact/new-half-space-tables.csv";
/// The same of S1002 on UIC60, on both sides.
const ONE: &str = "contact/normal_contact_S1002_UIC60_R460.csv";

/// What is compared, in this order: approach, tangent, area, largest pressure.
pub type Values = [f64; 4];

/// A place of a wheel on a rail, with the loads of its tables.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Standard rail.
    pub rail: String,
    /// Standard wheel.
    pub wheel: String,
    /// Shift towards the flange of the wheel, mm.
    pub shift_mm: f64,
    /// Vertical loads, kN, ascending, with the program's values (mm, kN/mm, mm², MPa).
    pub loads: Vec<(f64, Values)>,
}

impl Case {
    /// Whether it is of a pair.
    pub fn is_of(&self, rail: &str, wheel: &str) -> bool {
        self.rail == rail && self.wheel == wheel
    }
}

/// The pairs of rail and wheel, each once.
pub fn pairs(cases: &[Case]) -> Vec<(String, String)> {
    let mut pairs: Vec<_> = cases.iter().map(|case| (case.rail.clone(), case.wheel.clone())).collect();
    pairs.dedup();
    pairs
}

/// All cases, of each pair by its shifts. Tables of one place are put together.
///
/// # Errors
/// [`InputError`] for a file that cannot be read, a column that is missing, a number that is none, and tangents that are not the slopes
/// of the approaches.
pub fn read(folder: &Path) -> Result<Vec<Case>> {
    // shifts in micrometres, so that they are keys
    let mut found: BTreeMap<(String, String, i64), Vec<(f64, Values)>> = BTreeMap::new();
    let mut add = |rail: &str, wheel: &str, shift: f64, load: f64, values: Values| {
        let key = (rail.to_owned(), wheel.to_owned(), (shift * 1e3).round() as i64);
        found.entry(key).or_default().push((load, values));
    };
    let table = Table::read(&folder.join(ANY))?;
    for row in &table.rows {
        let of = |name| table.number(row, name);
        let values = [of("approach_mm")?, of("tangent_kn_per_mm")?, of("area_mm2")?, of("max_pressure_mpa")?];
        add(
            table.text(row, "rail")?,
            table.text(row, "wheel")?,
            of("lateral_shift_mm")?,
            of("load_kn")?,
            values,
        );
    }
    let table = Table::read(&folder.join(ONE))?;
    for row in &table.rows {
        let of = |name| table.number(row, name);
        let values = [of("approach_z_mm")?, of("kt_N_per_mm")? * 1e-3, of("area_mm2")?, of("pmax_MPa")?];
        // towards the right, the right wheel goes to its flange, the left one away from it
        let sign = if table.text(row, "side")? == "LEFT" { -1.0 } else { 1.0 };
        add("UIC60", "S1002", sign * of("y_ws_mm")?, of("fz_N")? * 1e-3, values);
    }
    let case = |((rail, wheel, shift), mut loads): (_, Vec<(f64, Values)>)| {
        loads.sort_by(|a, b| a.0.total_cmp(&b.0));
        loads.dedup_by(|a, b| a.0 == b.0);
        Case { rail, wheel, shift_mm: shift as f64 * 1e-3, loads }
    };
    let cases: Vec<Case> = found.into_iter().map(case).collect();
    cases.iter().try_for_each(|case| check(folder, case))?;
    Ok(cases)
}

/// Tangents are the slopes of the approaches: tables in other units do not pass.
fn check(folder: &Path, case: &Case) -> Result<()> {
    /// Largest ratio of a chord to the mean of the tangents at its ends.
    const NEAR: f64 = 1.3;
    for pair in case.loads.windows(2) {
        let [(from, a), (to, b)] = [pair[0], pair[1]];
        let (way, by_tangents) = (b[0] - a[0], 0.5 * (to - from) * (1.0 / a[1] + 1.0 / b[1]));
        // digits of the tables over short steps
        if way > 2e-3 && !(1.0 / NEAR..NEAR).contains(&(way / by_tangents)) {
            return Err(InputError::new(
                "tangent",
                format!("{} and {} in {} on {} at {from} and {to} kN", a[1], b[1], case.wheel, case.rail),
                format!("the slope of the approaches there, {:.1} kN/mm", (to - from) / way),
                format!("correct the tables in {}", folder.display()),
            )
            .into());
        }
    }
    Ok(())
}

/// A table of comma-separated values with a heading.
struct Table {
    file: String,
    heading: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(file: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(file).map_err(|cause| {
            InputError::new(
                "--facts",
                file.display(),
                "a table of the half-space program",
                format!("{cause}: name its folder with --facts, or in RAILSPRING_FACTS"),
            )
        })?;
        Ok(Self::parse(&file.display().to_string(), &text))
    }

    fn parse(file: &str, text: &str) -> Self {
        let cells = |line: &str| line.split(',').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
        let mut lines = text.lines().filter(|line| !line.trim().is_empty()).map(cells);
        Self { file: file.to_owned(), heading: lines.next().unwrap_or_default(), rows: lines.collect() }
    }

    fn text<'a>(&self, row: &'a [String], column: &str) -> Result<&'a str> {
        let cell = self.heading.iter().position(|name| name == column).and_then(|n| row.get(n));
        cell.map(String::as_str).ok_or_else(|| {
            let expected = format!("a value in the column {column:?}");
            InputError::new(&self.file, row.join(","), expected, "complete the table").into()
        })
    }

    fn number(&self, row: &[String], column: &str) -> Result<f64> {
        let text = self.text(row, column)?;
        text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            let expected = format!("a number in the column {column:?}");
            InputError::new(&self.file, format!("{text:?}"), expected, "correct the table").into()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADING: &str =
        "rail,wheel,lateral_shift_mm,load_kn,approach_mm,tangent_kn_per_mm,area_mm2,max_pressure_mpa\n";
    const OTHER: &str = "set,side,y_ws_mm,fz_N,approach_z_mm,kt_N_per_mm,area_mm2,pmax_MPa\n";

    fn folder(any: &str, one: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("contact")).unwrap();
        std::fs::write(folder.path().join(ANY), format!("{HEADING}{any}")).unwrap();
        std::fs::write(folder.path().join(ONE), format!("{OTHER}{one}")).unwrap();
        folder
    }

    /// Goal: rows of one place in both tables make one case with ascending loads, each once, in kN/mm; the left wheel is on the other side.
    #[test]
    fn tables_of_one_place_are_one_case() {
        let folder = folder(
            "UIC60,S1002,-3,20,0.0336,897,49.1,623\nUIC60,S1002,-3,20,0.0336,897,49.1,623\nA,B,0,5,0.01,600,1,2\n",
            "x,LEFT,3,10000,0.02114,710705,30.8,494\nx,RIGHT,3,10000,0.025,600000,21,723\n",
        );
        let cases = read(folder.path()).unwrap();
        let names: Vec<_> = cases.iter().map(|c| (c.rail.as_str(), c.shift_mm, c.loads.len())).collect();
        assert_eq!(names, [("A", 0.0, 1), ("UIC60", -3.0, 2), ("UIC60", 3.0, 1)]);
        assert_eq!(cases[1].loads[0], (10.0, [0.02114, 710.705, 30.8, 494.0]));
        assert_eq!(pairs(&cases), [("A".to_owned(), "B".to_owned()), ("UIC60".into(), "S1002".into())]);
    }

    /// Goal: a missing folder, a missing column, a word for a number and tangents in kN/m are refused with what is wrong.
    #[test]
    fn wrong_tables_are_refused() {
        let missing = read(Path::new("/nowhere")).unwrap_err().to_string();
        assert!(missing.contains("RAILSPRING_FACTS") && missing.contains(ANY), "{missing}");
        let word = read(folder("A,B,0,many,0.01,600,1,2\n", "").path()).unwrap_err().to_string();
        assert!(word.contains("many") && word.contains("load_kn"), "{word}");
        let short = read(folder("A,B,0,5,0.01,600,1\n", "").path()).unwrap_err().to_string();
        assert!(short.contains("max_pressure_mpa"), "{short}");
        let unit = "A,B,0,5,0.01,583000,1,2\nA,B,0,20,0.03,930000,1,2\n";
        let unit = read(folder(unit, "").path()).unwrap_err().to_string();
        assert!(unit.contains("tangent") && unit.contains("slope"), "{unit}");
    }
}
