//! Where the findings of a profile file lie on its curve, for the figure.

use railspring_profiles::profile_file::{Action, Finding, MeasuredProfile, Prepared};
use railspring_profiles::units::MILLIMETRE;

/// Findings nearer to each other than this share a mark, m along the profile.
const SHARED: f64 = 3.0 * MILLIMETRE;
/// A finding over more than this part of the profile concerns the whole of it and gets no mark.
const WHOLE: f64 = 0.8;

/// The findings of all files of a figure, numbered in the order in which they are listed.
#[derive(Debug, Default)]
pub(super) struct Listed {
    /// Lines of the list.
    pub notes: Vec<String>,
    count: usize,
}

/// A mark on the curve.
#[derive(Debug, PartialEq)]
pub(super) struct Mark {
    /// Arc length, m.
    pub s: f64,
    /// Numbers of the findings here.
    pub numbers: String,
    /// The gravest action among them.
    pub action: Action,
}

/// Lists the findings of a file and tells where they lie on its curve.
pub(super) fn marked(profile: &MeasuredProfile, prepared: &Prepared, listed: &mut Listed) -> Vec<Mark> {
    let found = if prepared.findings.is_empty() { "no findings" } else { "findings" };
    listed.notes.push(format!(
        "{} ({}, {}, {} points): {found}",
        profile.name,
        profile.format,
        profile.kind.name(),
        profile.points.len()
    ));
    let mut placed: Vec<(f64, usize, Action)> = Vec::new();
    for finding in &prepared.findings {
        listed.count += 1;
        listed.notes.push(format!("[{}] {finding}", listed.count));
        if let Some(s) = place(finding, profile, prepared) {
            placed.push((s, listed.count, finding.action));
        }
    }
    placed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut groups: Vec<Vec<(f64, usize, Action)>> = Vec::new();
    for item in placed {
        match groups.last_mut() {
            Some(group) if item.0 - group[0].0 < SHARED => group.push(item),
            _ => groups.push(vec![item]),
        }
    }
    groups
        .iter()
        .map(|group| Mark {
            s: group[0].0,
            numbers: numbers(group.iter().map(|item| item.1).collect()),
            action: group
                .iter()
                .map(|item| item.2)
                .max_by_key(|action| gravity(*action))
                .unwrap_or(group[0].2),
        })
        .collect()
}

fn gravity(action: Action) -> u8 {
    match action {
        Action::Noted => 0,
        Action::Repaired => 1,
        Action::Left => 2,
    }
}

/// Arc length in the middle of a finding's lines; `None` if it has no place of its own.
fn place(finding: &Finding, profile: &MeasuredProfile, prepared: &Prepared) -> Option<f64> {
    let (first, last) = finding.lines?;
    // A line of the header has no place.
    profile.points.iter().any(|p| (first..=last).contains(&p.line)).then_some(())?;
    let curve = &prepared.curve;
    // The points as read: what was repaired is often no longer among the prepared ones.
    let on_curve = |line: usize| {
        let nearest = profile.points.iter().min_by_key(|p| p.line.abs_diff(line))?;
        Some(curve.closest(&nearest.point).0)
    };
    let (a, b) = (on_curve(first)?, on_curve(last)?);
    ((b - a).abs() < WHOLE * curve.length()).then_some(0.5 * (a + b))
}

/// Numbers in order, runs of them shortened: "1, 4–6".
fn numbers(mut all: Vec<usize>) -> String {
    all.sort_unstable();
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for n in all {
        match runs.last_mut() {
            Some(run) if run.1 + 1 == n => run.1 = n,
            _ => runs.push((n, n)),
        }
    }
    let text = |(a, b): &(usize, usize)| match b - a {
        0 => a.to_string(),
        1 => format!("{a}, {b}"),
        _ => format!("{a}\u{2013}{b}"),
    };
    runs.iter().map(text).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_numbers_are_shortened() {
        assert_eq!(numbers(vec![6, 1, 5, 4]), "1, 4\u{2013}6");
        assert_eq!(numbers(vec![2, 3]), "2, 3");
        assert_eq!(numbers(vec![7]), "7");
    }
}
