//! The verdict against closed examples: signals whose differences are known
//! by construction.

use nalgebra::Point2;
use railspring_simulate::time::history::{ContactMode, ContactState, Ending};

use super::series::rms;
use super::*;

/// ROUNDOFF: sums of a few hundred terms of order one; values are rounded to six digits.
const ROUNDOFF: f64 = 1e-5;
const STEP: f64 = 0.0005;

fn history(
    rows: usize,
    force: impl Fn(f64) -> (f64, f64),
    mode: impl Fn(f64) -> Option<ContactMode>,
) -> History {
    let rows = (0..rows)
        .map(|n| {
            let time = n as f64 * STEP;
            let (vertical_force, lateral_force) = force(time);
            let contact = |mode| ContactState {
                mode,
                rail: Point2::origin(),
                wheel: Point2::origin(),
                normal_force: vertical_force,
                tangential_force: lateral_force,
            };
            let contacts = mode(time).map(contact).into_iter().collect();
            HistoryRow { contacts, ..forces_alone(time, vertical_force, lateral_force) }
        })
        .collect();
    History { rows, degrees_of_freedom: 1, ending: Ending::Completed }
}

/// A row with forces (N) at a time (s), without a contact or a motion of the wheel.
pub fn forces_alone(time: f64, vertical_force: f64, lateral_force: f64) -> HistoryRow {
    HistoryRow {
        time,
        vertical_force,
        lateral_force,
        wheel_y: 0.0,
        wheel_z: 0.0,
        load_y: 0.0,
        energy: None,
        contacts: Vec::new(),
    }
}

/// Compares two runs of which nothing else is known.
fn compare(simple: &History, solid: &History, limits: &Limits) -> Result<Comparison> {
    super::compare(&ModelRun::alone(simple), &ModelRun::alone(solid), limits)
}

fn line<'a>(comparison: &'a Comparison, meaning: &str) -> &'a Line {
    comparison.lines.iter().find(|line| line.meaning.starts_with(meaning)).unwrap()
}

fn value(comparison: &Comparison, meaning: &str) -> Option<f64> {
    line(comparison, meaning).value
}

/// Reasons why a comparison was not made.
fn reason<'a>(comparison: &'a Comparison, quantity: &str) -> Option<&'a str> {
    let found = comparison.not_applicable.iter().find(|item| item.quantity == quantity);
    assert!(found.is_none() || comparison.lines.iter().all(|line| line.quantity != quantity));
    found.map(|item| item.reason.as_str())
}

const SLIP: fn(f64) -> Option<ContactMode> = |_| Some(ContactMode::Slip);

#[test]
fn a_run_agrees_with_itself() {
    let run = history(551, |t| (1e5 * (1.0 + t), 2e4 * (30.0 * t).sin()), SLIP);
    let comparison = compare(&run, &run, &Limits::default()).unwrap();
    assert!(comparison.lines.iter().all(|line| line.holds && line.value == Some(0.0)));
    for quantity in ["separation_begin_s", "separation_end_s"] {
        assert_eq!(reason(&comparison, quantity), Some("neither model separates"));
    }
    assert_eq!(reason(&comparison, "departure_s"), Some("neither model leaves the profile"));
}

#[test]
fn force_differences_are_over_the_peak_of_the_solid() {
    // The solid has P = 200 kN at its peak; the simple model differs by 10 kN in one of two rows.
    let solid = history(400, |t| (if t == 0.0 { 200e3 } else { 100e3 }, -50e3), SLIP);
    let odd = |t: f64| (t / STEP).round() as usize % 2 == 1;
    let simple = history(400, |t| (solid_p(t) + if odd(t) { 10e3 } else { 0.0 }, -49e3), SLIP);
    fn solid_p(t: f64) -> f64 {
        if t == 0.0 { 200e3 } else { 100e3 }
    }
    let comparison = compare(&simple, &solid, &Limits::default()).unwrap();
    let expected =
        [("P, RMS", 0.05 / 2f64.sqrt()), ("P, largest", 0.05), ("Q, RMS", 0.02), ("Q, largest", 0.02)];
    for (meaning, expected) in expected {
        let found = value(&comparison, meaning).unwrap();
        assert!((found - expected).abs() < ROUNDOFF, "{meaning}: {found}, expected {expected}");
    }
}

#[test]
fn the_averaged_ratio_is_the_mean_over_the_window() {
    // Q = q·t over P = p: the mean of Q over the last w seconds is q·(t − w/2), and q·t/2 before w.
    let (p, q, window) = (80e3, 4e5, 0.024);
    let run = history(200, |t| (p, q * t), SLIP);
    for (row, ratio) in run.rows.iter().zip(averaged_ratio(&run, window, &Carrying::EXACT)) {
        let t = row.time;
        let expected = if t < window { q * t / 2.0 } else { q * (t - window / 2.0) } / p;
        assert!((ratio.unwrap() - expected).abs() < 1e-12, "{t}: {ratio:?} {expected}");
    }
}

#[test]
fn a_window_that_is_no_multiple_of_the_step_is_interpolated() {
    let (p, q, window) = (80e3, 4e5, 0.0213);
    let run = history(200, |t| (p, q * t), SLIP);
    let ratio = averaged_ratio(&run, window, &Carrying::EXACT)[150].unwrap();
    let expected = q * (150.0 * STEP - window / 2.0) / p;
    assert!((ratio - expected).abs() < 1e-12);
}

#[test]
fn without_contact_the_ratio_is_undefined_and_not_compared() {
    let apart = |t: f64| (0.05..0.10).contains(&t);
    let run = history(
        400,
        |t| if apart(t) { (0.0, 0.0) } else { (1e5, 3e4) },
        |t| (!apart(t)).then_some(ContactMode::Stick),
    );
    let ratios = averaged_ratio(&run, 0.024, &Carrying { errors: [1.0, 0.0], limit: 1.0 });
    // The window lies wholly in the separation from 0.05 + 0.024 s to its end.
    let undefined = ratios.iter().filter(|r| r.is_none()).count();
    assert_eq!(undefined, ((0.0995 - 0.0740) / STEP).round() as usize + 1);
    let comparison = compare(&run, &run, &Limits::default()).unwrap();
    assert_eq!(value(&comparison, "Averaged Q/P, largest"), Some(0.0));
}

#[test]
fn separations_are_paired_and_their_times_compared() {
    let with_gap = |a: f64, b: f64| {
        history(
            551,
            move |t| if t >= a - 1e-9 && t < b - 1e-9 { (0.0, 0.0) } else { (1e5, 0.0) },
            move |t| (!(t >= a - 1e-9 && t < b - 1e-9)).then_some(ContactMode::Stick),
        )
    };
    let solid = with_gap(0.100, 0.150);
    let comparison = compare(&with_gap(0.103, 0.149), &solid, &Limits::default()).unwrap();
    assert!((value(&comparison, "Separation begins").unwrap() - 0.003).abs() < ROUNDOFF);
    assert!((value(&comparison, "Separation ends").unwrap() - 0.001).abs() < ROUNDOFF);
    assert_eq!(value(&comparison, "Separations that only"), Some(0.0));
    assert_eq!(comparison.compared.separations.solid, [Separation { begin_s: 0.1, end_s: 0.15 }]);

    let far = compare(&with_gap(0.200, 0.220), &solid, &Limits::default()).unwrap();
    assert!(reason(&far, "separation_begin_s").unwrap().starts_with("no separation of one model"));
    assert_eq!(value(&far, "Separations that only"), Some(2.0));
    assert!(!far.lines.iter().find(|line| line.quantity == "separations_unmatched").unwrap().holds);

    let brief = compare(&with_gap(0.200, 0.201), &with_gap(9.0, 9.0), &Limits::default()).unwrap();
    assert_eq!(value(&brief, "Separations that only"), Some(0.0), "shorter than the limit");

    // one that is just long enough is not alone where the other model separates for a shorter time
    for (a, b) in
        [(with_gap(0.200, 0.202), with_gap(0.2, 0.2015)), (with_gap(0.2, 0.2015), with_gap(0.200, 0.202))]
    {
        let found = compare(&a, &b, &Limits::default()).unwrap();
        assert_eq!(value(&found, "Separations that only"), Some(0.0));
        assert!((value(&found, "Separation ends").unwrap() - 0.0005).abs() < ROUNDOFF);
    }
}

/// Goal: a contact under less than a thousandth of the solid's largest P (100 kN here) is none in either model, one under more is.
#[test]
fn a_contact_that_hardly_carries_is_a_separation() {
    let pressed = |least: f64| {
        let flies = |t: f64| (0.1 - 1e-9..0.15 - 1e-9).contains(&t);
        history(551, move |t| if flies(t) { (least, 0.0) } else { (1e5, 0.0) }, SLIP)
    };
    for (force, separated) in [(0.0, 1), (99.0, 1), (101.0, 0)] {
        let comparison = compare(&pressed(force), &pressed(0.0), &Limits::default()).unwrap();
        assert_eq!(comparison.compared.separations.simple.len(), separated, "{force} N");
        assert_eq!(comparison.compared.separations.solid.len(), 1);
        assert_eq!(value(&comparison, "Separations that only"), Some(1.0 - separated as f64));
        let fraction = comparison.compared.mode_fractions.simple.separated;
        assert!((fraction - separated as f64 * 100.0 / 550.0).abs() < ROUNDOFF, "{fraction}");
    }
}

#[test]
fn mode_fractions_add_up_to_one() {
    let mode = |t: f64| match (t / STEP).round() as usize {
        0..=100 => Some(ContactMode::Stick),
        101..=150 => Some(ContactMode::Slip),
        _ => None,
    };
    let fractions = mode_fractions(&history(201, |_| (1.0, 1.0), mode), 0.0);
    assert_eq!((fractions.stick, fractions.slip, fractions.separated), (0.5, 0.25, 0.25));
}

#[test]
fn values_that_are_no_numbers_fail() {
    let solid = history(10, |_| (1e5, 1e3), SLIP);
    let broken = history(10, |t| (if t > 0.0 { f64::NAN } else { 1e5 }, 1e3), SLIP);
    let comparison = compare(&broken, &solid, &Limits::default()).unwrap();
    let rms = line(&comparison, "P, RMS");
    assert!(!rms.holds && rms.value.is_none(), "{rms:?}");
    let nothing = history(10, |_| (0.0, 0.0), |_| None);
    let comparison = compare(&solid, &nothing, &Limits::default()).unwrap();
    assert!(!line(&comparison, "P, RMS").holds, "force without any in the solid");
}

/// Goal: a line holds with a finite value within its limit, and in no other case; lines without a value are the worst.
#[test]
fn a_line_without_a_value_does_not_hold() {
    let criterion =
        Criterion { quantity: "q", meaning: "m", kind: Kind::Verification, unit: "1", limit: 0.5 };
    let check = |value| criterion.line(value);
    for (value, holds, excess) in [
        (Some(0.5), true, 1.0),
        (Some(0.75), false, 1.5),
        (None, false, f64::INFINITY),
        (Some(f64::NAN), false, f64::INFINITY),
        (Some(f64::NEG_INFINITY), false, f64::INFINITY),
    ] {
        let line = check(value);
        assert_eq!((line.holds, line.excess()), (holds, excess), "{value:?}");
    }
    let exact = |value| Criterion { limit: 0.0, ..criterion }.line(Some(value)).excess();
    assert_eq!((exact(0.0), exact(1.0)), (0.0, f64::INFINITY));
}

/// Goal: a load case in which nothing touches fails, although both models agree that there is no force.
#[test]
fn a_load_case_without_contact_fails() {
    let apart = history(100, |_| (0.0, 0.0), |_| None);
    let comparison = compare(&apart, &apart, &Limits::default()).unwrap();
    let touches = line(&comparison, "Models in which the wheel never touches");
    assert_eq!((touches.value, touches.holds), (Some(2.0), false));
    assert!(touches.note.as_ref().unwrap().contains("solid model: no contact at any step"));
    assert!(!line(&comparison, "Averaged Q/P, RMS").holds, "no step at which Q/P is defined");
    assert!(run_lines(&apart, None).iter().any(|line| !line.holds), "nor does one model alone pass");
    let first_only = history(100, |_| (0.0, 0.0), |t| (t == 0.0).then_some(ContactMode::Stick));
    assert!(!run_lines(&first_only, None)[1].holds, "the initial state does not count");
}

/// Goal: a run whose contact reached the end of the surfaces counts among those that end before the last step, with the reason, time (s) and
/// place (mm); the steps before that are compared, and no time of a departure is.
#[test]
fn a_run_at_the_end_of_its_surfaces_fails() {
    use nalgebra::Point2;
    use railspring_profiles::placement::Departure;
    use railspring_simulate::time::history::SurfaceEnd;
    let whole = history(551, |t| (1e5 * (1.0 + t), 2e4), SLIP);
    let mut cut = history(100, |t| (1e5 * (1.0 + t), 2e4), SLIP);
    let (time, rail) = (100.0 * STEP, Point2::new(-0.0358, 0.0142));
    cut.ending = Ending::EndOfSurface { time, end: SurfaceEnd::ContactZone, rail };
    let mut left = whole.clone();
    left.ending = Ending::Departed { time: 0.3, departure: Departure::FieldSide };
    for other in [&whole, &left] {
        let found = compare(other, &cut, &Limits::default()).unwrap();
        let ends = line(&found, "Models whose run ends before");
        let ended = 1.0 + f64::from(u8::from(other.ending != Ending::Completed));
        assert_eq!((ends.value, ends.holds), (Some(ended), false));
        let note = ends.note.as_ref().unwrap();
        assert!(note.contains("solid model: the contact reached the end of the contact zone"), "{note}");
        assert!(note.contains("at 0.05 s (y = -35.8 mm, z = 14.2 mm"), "{note}");
        assert_eq!(reason(&found, "departure_s"), Some("a run ended at the end of its model's surfaces"));
        assert_eq!(value(&found, "P, largest"), Some(0.0), "equal until then");
    }
}

/// Goal: a run that left the profile fails, with its time said; the steps before that are compared, and the times where
/// both leave to the same side, s.
#[test]
fn a_run_that_leaves_the_profile_fails() {
    use railspring_profiles::placement::Departure;
    let left = |rows: usize, departure| {
        let mut run = history(rows, |t| (1e5 * (1.0 + t), 2e4), SLIP);
        run.ending = Ending::Departed { time: rows as f64 * STEP, departure };
        run
    };
    let whole = history(551, |t| (1e5 * (1.0 + t), 2e4), SLIP);
    let one = compare(&left(100, Departure::FieldSide), &whole, &Limits::default()).unwrap();
    let ends = line(&one, "Models whose run ends before");
    assert_eq!((ends.value, ends.holds), (Some(1.0), false));
    assert!(ends.note.as_ref().unwrap().starts_with("simple model: left the profile at 0.05 s"));
    assert_eq!(reason(&one, "departure_s"), Some("only one model leaves the profile"));
    assert_eq!(value(&one, "P, largest"), Some(0.0), "equal until then");
    assert_eq!(one.lines.iter().filter(|line| !line.holds).count(), 1);

    let (a, b) = (left(100, Departure::FieldSide), left(101, Departure::FieldSide));
    let both = compare(&a, &b, &Limits::default()).unwrap();
    assert!((value(&both, "Wheel leaves").unwrap() - 0.0005).abs() < ROUNDOFF);
    assert!(
        line(&both, "Wheel leaves").holds && !line(&both, "Models whose run").holds,
        "alike, but no pass"
    );
    let other = compare(&a, &left(104, Departure::GaugeSide), &Limits::default()).unwrap();
    assert!(!line(&other, "Wheel leaves").holds, "to the other side");

    let at_once = compare(&left(1, Departure::FieldSide), &whole, &Limits::default()).unwrap();
    assert!(line(&at_once, "P, RMS").value.is_none() && !line(&at_once, "P, RMS").holds);
}

/// Goal: one row, equal times and values that are no numbers give no panic.
#[test]
fn odd_histories_do_not_panic() {
    let single = history(1, |_| (1e5, 0.0), SLIP);
    assert_eq!(averaged_ratio(&single, 0.024, &Carrying::EXACT), [Some(0.0)]);
    let mut same = history(5, |_| (1e5, 2e4), SLIP);
    same.rows.iter_mut().for_each(|row| row.time = 0.5);
    assert_eq!(averaged_ratio(&same, 0.024, &Carrying::EXACT), [Some(0.2); 5]);
    let broken = history(5, |_| (f64::NAN, f64::INFINITY), SLIP);
    assert_eq!(averaged_ratio(&broken, 0.024, &Carrying::EXACT), [None; 5]);
    for run in [single, same, broken] {
        let comparison = compare(&run, &run, &Limits::default()).unwrap();
        mode_fractions(&run, 0.0);
        assert!(comparison.lines.iter().any(|line| !line.holds) || run.rows.len() == 5);
    }
}

#[test]
fn runs_over_other_times_are_refused() {
    let long = history(11, |_| (1.0, 1.0), SLIP);
    let short = history(10, |_| (1.0, 1.0), SLIP);
    assert!(compare(&long, &short, &Limits::default()).is_err());
    let mut later = long.clone();
    later.rows[5].time += 1e-4;
    assert!(compare(&long, &later, &Limits::default()).is_err());
}

mod uncertainty;

mod properties {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Scaling both models' forces changes no relative difference, and no ratio.
        #[test]
        fn relative_differences_do_not_depend_on_the_unit(scale in 0.01f64..100.0, shift in 0.0f64..0.3) {
            let solid = |s: f64| history(80, move |t| (s * (1e5 + 2e4 * (90.0 * t).sin()), s * 3e4 * (50.0 * t).cos()), SLIP);
            let simple = |s: f64| history(80, move |t| (s * (1e5 + 2e4 * (90.0 * t + shift).sin()), s * 3e4 * (50.0 * t + shift).cos()), SLIP);
            let one = compare(&simple(1.0), &solid(1.0), &Limits::default()).unwrap();
            let scaled = compare(&simple(scale), &solid(scale), &Limits::default()).unwrap();
            for (a, b) in one.lines.iter().zip(&scaled.lines) {
                let (a, b) = (a.value.unwrap_or(0.0), b.value.unwrap_or(0.0));
                prop_assert!((a - b).abs() <= ROUNDOFF * a.abs().max(1e-9), "{a} {b}");
            }
        }

        /// The RMS is never above the largest difference.
        #[test]
        fn rms_is_at_most_the_largest(values in proptest::collection::vec(-1e6f64..1e6, 1..50)) {
            prop_assert!(rms(&values) <= peak(&values) * (1.0 + 1e-12));
        }
    }
}

/// Goal: the drift of the balance (J) over the largest energy that is stored, of the model where it is larger; only of those that have a balance, with both
/// in the note. Accuracy: ROUNDOFF.
#[test]
fn the_drift_is_over_the_largest_energy() {
    let run = |drift: Option<f64>| {
        let mut run = history(11, |_| (1e5, 0.0), SLIP);
        for (n, row) in run.rows.iter_mut().enumerate() {
            // 50 J are stored at the fifth row alone, and the drift is largest there
            let (kinetic, elastic) = if n == 4 { (30.0, 20.0) } else { (10.0, 5.0) };
            let of_row = |drift: f64| if n == 4 { drift } else { 0.5 * drift };
            row.energy = drift.map(|drift| EnergyBalance {
                kinetic,
                elastic,
                drift: of_row(drift),
                ..EnergyBalance::default()
            });
        }
        run
    };
    let with = |simple, solid| compare(&run(simple), &run(solid), &Limits::default()).unwrap();
    let both = with(Some(-2.0), Some(4.0));
    let line = both.lines.iter().find(|line| line.quantity == "energy_drift").unwrap();
    assert!((line.value.unwrap() - 0.08).abs() < ROUNDOFF && !line.holds, "{line:?}");
    assert_eq!(line.note.as_deref(), Some("simple model 4.00 %, solid model 8.00 %"));
    let one = with(Some(-0.2), None);
    let line = one.lines.iter().find(|line| line.quantity == "energy_drift").unwrap();
    assert!((line.value.unwrap() - 0.004).abs() < ROUNDOFF && line.holds, "{line:?}");
    assert_eq!(reason(&with(None, None), "energy_drift"), Some("neither run has energies"));
}

/// Goal: limits that are not the default ones are listed with these, and which of them let more pass.
#[test]
fn changed_limits_are_listed() {
    assert!(Limits::default().changed().is_empty());
    let limits = Limits { law_max: 9.0, vertical_rms: 0.01, ratio_window_s: 0.05, ..Limits::default() };
    let changed = limits.changed();
    let texts: Vec<(String, bool)> = changed.iter().map(|of| (of.to_string(), of.is_looser())).collect();
    let expected = [
        ("verification.law_max = 9 (default 0.15)", true),
        ("verification.ratio_window_s = 0.05 (default 0.024)", true),
        ("verification.vertical_rms = 0.01 (default 0.03)", false),
    ];
    assert_eq!(texts, expected.map(|(text, looser)| (text.to_string(), looser)));
}
