//! What is compared: numbers in groups, lines of the verdicts, inputs.

use std::collections::BTreeMap;

use serde::Serialize;

use super::side::Side;
use super::solid::{Solid, loads};
use super::values::{Compared, Value};
use crate::report::number::number;
use crate::results::by_angle::record::ShiftRecord;
use crate::results::springs::record::LawRecord;
use crate::rounding::with_unit;
use crate::verify::Line;

/// Names of the groups that the summary speaks of.
const TANGENT: &str = "Tangent stiffness of the solid";
const DISPLACEMENT: &str = "Displacement of the solid";
const HORIZONTAL: &str = "Horizontal stiffness";
const BY_ANGLE: &str = "Tangent stiffness along the contact normal";
/// Shifts that differ by less are the same, mm.
const SAME_SHIFT: f64 = 1e-9;
/// Changes below this are none: the digits of a file.
const UNCHANGED: f64 = 1e-9;
/// Most inputs that the summary names.
const NAMED: usize = 6;

/// Numbers of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// What they are.
    pub name: String,
    /// What has to be known about them.
    pub caption: String,
    /// The numbers.
    pub rows: Vec<Compared>,
}

impl Group {
    /// The unit of all its rows, if they have the same.
    pub fn unit(&self) -> Option<&str> {
        let unit = self.rows.first()?.unit.as_str();
        self.rows.iter().all(|row| row.unit == unit).then_some(unit)
    }
}

/// A line of one verdict or of both.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LineChange {
    /// `springs`, or the load case.
    pub subject: String,
    /// What is compared, in words.
    pub meaning: String,
    /// The line of A.
    pub a: Option<Line>,
    /// The line of B.
    pub b: Option<Line>,
}

impl LineChange {
    /// Value and limit in A and in B, then what became of it, for a reader.
    pub fn texts(&self) -> [String; 3] {
        let text = |line: &Option<Line>| match line {
            None => "no such line".to_string(),
            Some(line) => {
                let state = if line.holds { "holds" } else { "fails" };
                format!(
                    "{} (limit {}), {state}",
                    with_unit(line.value, &line.unit),
                    with_unit(Some(line.limit), &line.unit)
                )
            }
        };
        let change = match (&self.a, &self.b) {
            (Some(a), Some(b)) if a.holds && !b.holds => "fails now",
            (Some(a), Some(b)) if !a.holds && b.holds => "holds now",
            (Some(_), Some(_)) => "",
            (Some(_), None) => "in A only",
            _ => "in B only",
        };
        [text(&self.a), text(&self.b), change.into()]
    }
}

/// An input that is not the same.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputChange {
    /// Key with its section, or what else it is.
    pub key: String,
    /// What A has.
    pub a: String,
    /// What B has.
    pub b: String,
}

/// The numbers of both.
pub(super) fn groups(a: &Side, b: &Side, reference: &str) -> Vec<Group> {
    let mut all = vec![constants(a, b, reference)];
    all.extend(over_load(a, b, reference));
    all.extend(horizontal(a, b));
    all.extend(by_angle(a, b, reference));
    all
}

fn constants(a: &Side, b: &Side, reference: &str) -> Group {
    let of = |side: &Side| {
        let found = side.stiffness.references.iter().find(|found| found.reference == reference);
        found.map(|found| found.law)
    };
    let (first, second) = (of(a), of(b));
    let row = |name: &str, unit: &str, value: &dyn Fn(&LawRecord) -> Value| {
        let [a, b] = [&first, &second].map(|law| law.as_ref().map(value));
        Compared::new(name, unit, a, b).without_answer()
    };
    let plain = |value: f64| Value { value, error: None };
    Group {
        name: "Normal law".into(),
        caption: format!(
            "k(f) = a + b\u{b7}(f/f0)^c against {reference}, with standard errors of the fit. Two sets of constants may be nearly the same law: whether laws differ is to be seen at the loads below."
        ),
        rows: vec![
            row("a", "kN/m", &|law| {
                Value::with_error(law.constants.a_kn_per_m, law.a_standard_error_kn_per_m)
            }),
            row("b", "kN/m", &|law| {
                Value::with_error(law.constants.b_kn_per_m, law.b_standard_error_kn_per_m)
            }),
            row("c", "1", &|law| Value::with_error(law.constants.c, law.c_standard_error)),
            row("f0", "kN", &|law| plain(law.constants.f0_kn)),
            row("error of the law against the solid's tangents, RMS", "%", &|law| {
                plain(1e2 * law.rms_rel_error)
            }),
            row("error of the law against the solid's tangents, largest", "%", &|law| {
                plain(1e2 * law.max_rel_error)
            }),
        ],
    }
}

/// Displacement and tangent of the solids over the load.
fn over_load(a: &Side, b: &Side, reference: &str) -> Vec<Group> {
    let (Some(first), Some(second)) = (Solid::of(a, reference), Solid::of(b, reference)) else {
        return Vec::new();
    };
    let loads = loads(&first, &second);
    if loads.is_empty() {
        return Vec::new();
    }
    let group = |name: &str, unit: &str, which: usize| Group {
        name: name.into(),
        caption: format!("Against {reference}, with error bands; at loads of A, B between its loads."),
        rows: loads
            .iter()
            .map(|load| {
                let [a, b] = [&first, &second].map(|solid| solid.at(*load).map(|values| values[which]));
                Compared::new(format!("at {} kN", number(*load)), unit, a, b)
            })
            .collect(),
    };
    vec![group(TANGENT, "kN/m", 1), group(DISPLACEMENT, "mm", 0)]
}

fn horizontal(a: &Side, b: &Side) -> Option<Group> {
    let of = |side: &Side| {
        let band = side.stiffness.horizontal.as_ref().and_then(|all| all.error_band.as_ref()?.band);
        side.stiffness.horizontal_kn_per_m.map(|value| Value::with_band(value, band))
    };
    let (first, second) = (of(a), of(b));
    (first.is_some() || second.is_some()).then(|| Group {
        name: HORIZONTAL.into(),
        caption: "Mean under sticking over the preloads, with its error band.".into(),
        rows: vec![Compared::new("k_h", "kN/m", first, second)],
    })
}

/// A shift that both have.
pub(super) fn common_shifts<'s>(a: &'s Side, b: &'s Side) -> Vec<[&'s ShiftRecord; 2]> {
    let (Some(first), Some(second)) = (&a.by_angle, &b.by_angle) else { return Vec::new() };
    let partner = |shift: &'s ShiftRecord| {
        let same = |other: &&ShiftRecord| (other.shift_mm - shift.shift_mm).abs() < SAME_SHIFT;
        Some([shift, second.shifts.iter().find(same)?])
    };
    first.shifts.iter().filter_map(partner).collect()
}

/// The tangent of a shift at a fixed load.
pub(super) fn tangent_at(shift: &ShiftRecord, force_kn: f64, reference: &str) -> Option<Value> {
    let load = shift.loads.iter().find(|load| load.force_kn == force_kn)?;
    let point = load.reference(reference)?;
    let band = shift.band(reference, force_kn).and_then(|band| band.tangent);
    Some(Value::with_band(point.tangent_kn_per_m, band))
}

fn by_angle(a: &Side, b: &Side, reference: &str) -> Option<Group> {
    let mut rows = Vec::new();
    for [first, second] in common_shifts(a, b) {
        let angle = |shift: &ShiftRecord| {
            shift.angle().map_or_else(|| "no touch".into(), |angle| format!("{angle:.1}\u{b0}"))
        };
        let mut loads: Vec<f64> =
            [first, second].iter().flat_map(|shift| &shift.loads).map(|load| load.force_kn).collect();
        loads.sort_by(f64::total_cmp);
        loads.dedup();
        rows.extend(loads.into_iter().map(|load| {
            let [at_a, at_b] = [first, second].map(|shift| tangent_at(shift, load, reference));
            let place =
                format!("shift {} mm ({} and {})", number(first.shift_mm), angle(first), angle(second));
            Compared::new(format!("{place} at {} kN", number(load)), "kN/m", at_a, at_b)
        }));
    }
    (!rows.is_empty()).then(|| Group {
        name: BY_ANGLE.into(),
        caption: format!(
            "Against {reference}, with the wheel at several lateral shifts; in brackets the contact angles of A and of B."
        ),
        rows,
    })
}

/// The lines of both verdicts, in the order of A.
pub(super) fn lines(a: &Side, b: &Side) -> Vec<LineChange> {
    let of = |side: &Side| -> Vec<(String, Line)> {
        let verdict = side.verdict.iter().flat_map(|verdict| verdict.lines());
        verdict.map(|(subject, line)| (subject.to_string(), line.clone())).collect()
    };
    let (first, mut second) = (of(a), of(b));
    let mut all: Vec<LineChange> = Vec::new();
    for (subject, line) in first {
        let same =
            second.iter().position(|(other, found)| *other == subject && found.quantity == line.quantity);
        let partner = same.map(|at| second.remove(at).1);
        all.push(LineChange { subject, meaning: line.meaning.clone(), a: Some(line), b: partner });
    }
    all.extend(second.into_iter().map(|(subject, line)| LineChange {
        subject,
        meaning: line.meaning.clone(),
        a: None,
        b: Some(line),
    }));
    all
}

/// The inputs that differ: program, profile files by their content, keys.
pub(super) fn inputs(a: &Side, b: &Side) -> Vec<InputChange> {
    let mut all = Vec::new();
    let mut add = |key: String, a: String, b: String| {
        if a != b {
            all.push(InputChange { key, a, b });
        }
    };
    let program = |side: &Side, commits: bool| match commits {
        true => side.about().program,
        false => format!("railspring {}", side.stiffness.version),
    };
    // of a program whose commit is not known on one side the version is all that can differ
    let commits = a.inputs.is_some() && b.inputs.is_some();
    add("program".into(), program(a, commits), program(b, commits));
    let files = |side: &Side| -> BTreeMap<String, String> {
        let profiles = side.stiffness.profiles.iter();
        let content = |hash: &Option<String>| {
            hash.as_deref().map_or_else(|| "not known".into(), |hash| hash[..hash.len().min(12)].to_string())
        };
        profiles
            .map(|p| {
                (
                    format!("content of the {} file", p.body),
                    format!("{}, BLAKE3 {}", p.file, content(&p.content_hash)),
                )
            })
            .collect()
    };
    let keys = |side: &Side| -> BTreeMap<String, String> {
        let name = |key: &crate::study::ResolvedKey| match key.section.is_empty() {
            true => key.key.clone(),
            false => format!("{}.{}", key.section, key.key),
        };
        let value = |key: &crate::study::ResolvedKey| match key.given {
            true => key.value.clone(),
            false => format!("{} (default)", key.value),
        };
        side.keys().into_iter().flatten().map(|key| (name(key), value(key))).collect()
    };
    let both_known = a.keys().is_some() && b.keys().is_some();
    let mut tables = vec![(files(a), files(b))];
    if both_known {
        tables.push((keys(a), keys(b)));
    }
    for (first, second) in tables {
        let names: std::collections::BTreeSet<&String> = first.keys().chain(second.keys()).collect();
        for name in names {
            let text =
                |of: &BTreeMap<String, String>| of.get(name).cloned().unwrap_or_else(|| "\u{2013}".into());
            let plain = |text: &str| text.trim_end_matches(" (default)").to_string();
            let (first, second) = (text(&first), text(&second));
            // a default that is given is the same value
            if plain(&first) != plain(&second) {
                add(name.clone(), first, second);
            }
        }
    }
    all
}

/// What is missing on either side, a sentence each.
pub(super) fn not_compared(a: &Side, b: &Side, reference: &str) -> Vec<String> {
    let mut all = Vec::new();
    let sides = [("A", a), ("B", b)];
    for (name, side) in sides {
        if side.stiffness.reference != reference {
            all.push(format!(
                "{name} uses its law against {}; what both have is the law against {reference}.",
                side.stiffness.reference
            ));
        }
        let band = side.stiffness.error_band.as_ref().and_then(|band| band.of(reference)?.largest());
        let missing = [
            (
                band.is_none(),
                "error band (calibration.error_band), without which nobody knows whether a difference means anything",
            ),
            (side.stiffness.horizontal_kn_per_m.is_none(), "horizontal stiffness"),
            (side.by_angle.is_none(), "laws by contact angle"),
            (side.verdict.is_none(), "verdict"),
            (side.keys().is_none(), "list of its inputs (inputs.json) that is of these springs"),
        ];
        let missing = missing.into_iter().filter(|(missing, _)| *missing);
        all.extend(missing.map(|(_, what)| format!("{name} has no {what}.")));
    }
    let ranges = sides.map(|(_, side)| Solid::of(side, reference).map(|solid| solid.range()));
    if let [Some([low_a, high_a]), Some([low_b, high_b])] = ranges
        && (high_a < low_b || high_b < low_a)
    {
        all.push(format!(
            "No load is in both ranges: A has {} to {} kN, B {} to {} kN.",
            number(low_a),
            number(high_a),
            number(low_b),
            number(high_b)
        ));
    }
    all
}

/// The most important, a sentence each.
pub(super) fn summary(groups: &[Group], lines: &[LineChange], inputs: &[InputChange]) -> Vec<String> {
    let named = [TANGENT, DISPLACEMENT, HORIZONTAL, BY_ANGLE];
    let found = named.iter().filter_map(|name| groups.iter().find(|group| group.name == *name));
    let mut all: Vec<String> = found.filter_map(in_words).collect();
    let [worse, better] = ["fails now", "holds now"].map(|state| {
        let changed = lines.iter().filter(|line| line.texts()[2] == state);
        changed.map(|line| format!("{}: {}", line.subject, line.meaning)).collect::<Vec<_>>()
    });
    let sentence =
        |what: &str, of: &[String]| (!of.is_empty()).then(|| format!("{what}: {}.", of.join("; ")));
    all.extend(sentence("Limits that hold in A and fail in B", &worse));
    all.extend(sentence("Limits that fail in A and hold in B", &better));
    if worse.is_empty() && better.is_empty() && lines.iter().any(|line| line.a.is_some() && line.b.is_some())
    {
        all.push("No limit of both verdicts changes its state.".into());
    }
    let mut names: Vec<&str> = inputs.iter().map(|input| input.key.as_str()).collect();
    let more = match names.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    names.truncate(NAMED);
    all.push(match names.is_empty() {
        true => "No input that is known differs.".into(),
        false => format!("Inputs that differ: {}{more}.", names.join(", ")),
    });
    all
}

/// Whether the numbers of a group differ, and which one most.
fn in_words(group: &Group) -> Option<String> {
    let changes = group.rows.iter().filter_map(|row| Some((row, row.change?)));
    let (most, _) = changes.max_by(|x, y| x.1.abs().total_cmp(&y.1.abs()))?;
    let [a, b, change, _] = most.texts();
    let known = group.rows.iter().filter(|row| row.beyond.is_some()).count();
    let beyond = group.rows.iter().filter(|row| row.beyond == Some(true)).count();
    let answer = match (known, beyond) {
        (0, _) => "without error bands on both sides".to_string(),
        (1, 0) => "within the error bands".into(),
        (1, _) => "beyond the error bands".into(),
        (_, 0) => format!("within the error bands at all {known}"),
        _ => format!("beyond the error bands at {beyond} of {known}"),
    };
    if most.change.is_some_and(|change| change.abs() < UNCHANGED) {
        return Some(format!("{}: the same.", group.name));
    }
    let largest = if group.rows.len() > 1 { "largest change " } else { "" };
    let unit = if most.unit == "1" { String::new() } else { format!(" {}", most.unit) };
    Some(format!("{}: {answer}; {largest}{change} ({}: {a} to {b}{unit}).", group.name, most.quantity))
}
