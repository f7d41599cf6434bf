//! Mutated histories. What is accepted is written again as it stands in the file, with times that go on, and the
//! comparison with the history as it was has only lines that have a finite value.

use std::path::Path;

use nalgebra::Point2;
use railspring::results::run::history_csv;
use railspring::verify::{Limits, ModelRun, Spread, compare};
use railspring_simulate::time::history::{ContactMode, ContactState, Ending, History, HistoryRow};

use super::mutate::{Dice, mistakes};
use super::{Fate, tried};

/// A wheel that rolls from tread to flange and lifts off for three steps.
fn history() -> History {
    let contact = |i: usize, share: f64| ContactState {
        mode: if i == 0 { ContactMode::Slip } else { ContactMode::Stick },
        rail: Point2::new(-0.0123456 * (i + 1) as f64, 1e-3),
        wheel: Point2::new(-0.02, 2e-7 * share),
        normal_force: 12_345.678 * share,
        tangential_force: -1e3 * share,
    };
    let row = |n: usize| {
        let touches = !(20..23).contains(&n) && n > 0;
        let force = if touches { 5e4 + 100.0 * n as f64 } else { 0.0 };
        HistoryRow {
            time: n as f64 * 0.0005,
            vertical_force: force,
            lateral_force: 0.3 * force,
            wheel_y: -1e-4 * n as f64,
            wheel_z: 2e-4,
            load_y: 1e-3 - 1e-4 * n as f64,
            energy: None,
            contacts: (0..if touches { 1 + n % 2 } else { 0 }).map(|i| contact(i, n as f64)).collect(),
        }
    };
    History { rows: (0..40).map(row).collect(), degrees_of_freedom: 116, ending: Ending::Completed }
}

pub fn try_mutations(count: u64) {
    let original = history();
    let text = String::from_utf8(history_csv::write(&original)).unwrap();
    tried("histories", count, |dice: &mut Dice| {
        let (mutated, changes) = mistakes(&text, dice);
        let fate = match history_csv::read(Path::new("mutated.csv"), &mutated, 116, Ending::Completed) {
            Err(error) => Fate::Refused(error.to_string()),
            Ok(history) => match misread(&history, &mutated).or_else(|| miscompared(&history, &original)) {
                Some(what) => Fate::Silent(what),
                None => Fate::Read,
            },
        };
        (changes, fate)
    });
}

fn cells(text: &str) -> Option<Vec<Vec<String>>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    reader.records().map(|record| Some(record.ok()?.iter().map(Into::into).collect())).collect()
}

/// The first cell that is not in the history as it stands in the file.
fn misread(history: &History, text: &str) -> Option<String> {
    // ROUNDOFF: twelve digits are written, and a quotient has them of two numbers.
    const ROUNDOFF: f64 = 2e-11;
    if let Some(pair) = history.rows.windows(2).find(|pair| !(pair[1].time > pair[0].time)) {
        return Some(format!("{} s after {} s", pair[1].time, pair[0].time));
    }
    let written = cells(&String::from_utf8_lossy(&history_csv::write(history)))?;
    let Some(file) = cells(text) else { return Some("no CSV".into()) };
    if file.len() != written.len() {
        return Some(format!("{} lines were read as {}", file.len(), written.len()));
    }
    let same = |a: &str, b: &str| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= ROUNDOFF * a.abs().max(b.abs()) + f64::MIN_POSITIVE,
        _ => a == b,
    };
    for (line, (file, written)) in file.iter().zip(&written).enumerate() {
        if file.len() != written.len() {
            return Some(format!("line {}: {} cells were read as {}", line + 1, file.len(), written.len()));
        }
        if let Some((a, b)) = file.iter().zip(written).find(|(a, b)| !same(a, b)) {
            return Some(format!("line {}: {a:?} was read as {b:?}", line + 1));
        }
    }
    None
}

/// A line of the verdict that holds without a finite value.
fn miscompared(history: &History, original: &History) -> Option<String> {
    [(history, original), (original, history)].into_iter().find_map(|(simple, solid)| {
        // beside itself, and as what an input that is 0.1 % larger makes of the other one
        let spread = Spread::between(solid, simple, "lateral force").ok();
        let disturbed = spread.as_ref().map(|spread| (simple, spread));
        let solid = ModelRun { disturbed, ..ModelRun::alone(solid) };
        let comparison = compare(&ModelRun::alone(simple), &solid, &Limits::default()).ok()?;
        let unearned = comparison.lines.iter().find(|l| l.holds && !l.value.is_some_and(f64::is_finite));
        unearned.map(|line| format!("{} holds with {:?}", line.quantity, line.value))
    })
}
