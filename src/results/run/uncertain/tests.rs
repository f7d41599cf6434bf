//! Samples of uncertain inputs through a load case, beside runs of studies that have these inputs.

use std::path::Path;

use railspring_profiles::monitor::Silent;
use railspring_simulate::time::scenario::Scenario;

use super::*;
use crate::results::bodies::geometry::{self, track};
use crate::results::run::input::{SimpleRunInput, SpringsInput};
use crate::results::run::make::{SimpleModel, Springs};
use crate::results::run::springs;
use crate::results::run::uncertain_record::write;
use crate::study::Study;

/// A load case of 15 ms on the published springs, which need no calibration: the wheel is pressed sideways and slides.
const STUDY: &str = r#"
name = "x"
[rail]
profile = "60E1"
[wheel]
profile = "S1002"
[contact]
friction = 0.2
[simulation]
law = "published"
horizontal_kn_per_m = 65000
rail_elements = 8
inner_steps = 4
[scenario.push]
steps = 30
time_step_s = 5e-4
vertical_force = { mean_kn = 60 }
lateral_force = { mean_kn = 20 }
[uncertainty]
gauge_mm = 0
flange_back_mm = 0
inclination_deg = 0
tape_diameter_mm = 0
friction = 0
young_percent = 0
poisson = 0
"#;

/// The line that says that friction is known exactly, and what follows it.
const EXACT_FRICTION: &str = "friction = 0\nyoung";

/// The study with other lines, each in the place of the one that gives the same key, or in its section.
fn study(more: &[(&str, &str)]) -> Study {
    let text = more.iter().fold(STUDY.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    Study::parse(Path::new("x.toml"), &text).unwrap_or_else(|mistakes| panic!("{mistakes}"))
}

/// The springs of a study.
fn springs_of(study: &Study) -> Springs {
    let geometry = geometry::geometry(study.statics()).unwrap();
    let record = springs::without_calibration(&SpringsInput::of(study), &geometry).unwrap();
    springs::springs(&record).unwrap()
}

/// The run of a study as it is.
fn run(study: &Study) -> History {
    let geometry = geometry::geometry(study.statics()).unwrap();
    let input = SimpleRunInput::of(study, &study.scenarios["push"]);
    let model = SimpleModel::new(&input, &geometry.pair, &geometry.beam, &springs_of(study)).unwrap();
    // those of the samples
    let inner_steps = input.simulation.steps(model.element()).doubled();
    let scenario = Scenario { inner_steps, ..input.case.clone() };
    model.run(&scenario, &Silent).unwrap()
}

/// The samples of a study beside its own run.
fn samples(study: &Study, samples: usize) -> std::result::Result<UncertainRun, String> {
    let geometry = geometry::geometry(study.statics()).unwrap();
    let springs = springs_of(study);
    let departing = Departing {
        input: SimpleRunInput::of(study, &study.scenarios["push"]),
        geometry: &geometry,
        track: track(study.statics(), (-geometry.pair.placed.angle).tan()),
        springs: &springs,
        changes: None,
    };
    let evaluated = Evaluated { window: 0.004, carrying: Carrying::EXACT, shortest: 2e-3 };
    let inputs = UncertainInputs::of(study.statics());
    let asked = (samples, "published", Vec::new());
    uncertain(&departing, &inputs, (&run(study), evaluated), asked, ("", &Silent)).unwrap()
}

/// Source: runs of studies that have the input itself as two samples have it: place of the wheel (mm), gauge (mm), friction. Goal: the band of P and of Q (kN) of these two
/// samples of the one input lies between the two runs at each time step, so that its width is their difference. Unit: kN. Accuracy: ITERATIONS, of forces of some 10 kN.
#[test]
fn the_band_of_one_input_is_the_difference_of_two_runs() {
    const ITERATIONS: f64 = 1e-5;
    let shifted = |by: f64| ("[simulation]", format!("[track]\nlateral_shift_mm = {by}\n[simulation]"));
    // the line that gives the uncertainty, and what says the input itself with a departure
    type Case<'a> = (&'a str, &'a str, f64, Distribution, &'a dyn Fn(f64) -> (&'static str, String));
    let cases: [Case<'_>; 3] = [
        ("gauge_mm = 0", "lateral_mm = 0.01\ngauge_mm = 0", 0.01, Distribution::Normal, &shifted),
        ("gauge_mm = 0", "gauge_mm = 0.02", 0.02, Distribution::Normal, &|by| shifted(-0.5 * by)),
        (EXACT_FRICTION, "friction = 0.004\nyoung", 0.004, Distribution::Rectangular, &|by| {
            ("friction = 0.2", format!("friction = {}", 0.2 + by))
        }),
    ];
    for (key, uncertain, standard, distribution, with) in cases {
        let found = samples(&study(&[(key, uncertain)]), 2).unwrap();
        let runs: Vec<History> = departures(&[distribution], 2)
            .iter()
            .map(|by| {
                let (from, to) = with(standard * by[0]);
                run(&study(&[(from, &to)]))
            })
            .collect();
        assert_eq!(found.rows.len(), runs[0].rows.len());
        type Of = (&'static str, fn(&HistoryRow) -> f64, fn(&UncertainRow) -> Quantiles);
        let forces: [Of; 2] =
            [("P", |row| row.vertical_force, |row| row.p), ("Q", |row| row.lateral_force, |row| row.q)];
        for (name, expected, of) in forces {
            let mut most: f64 = 0.0;
            for (n, row) in found.rows.iter().enumerate() {
                let [one, other] = [0, 1].map(|run| expected(&runs[run].rows[n]) / KILONEWTON);
                let [low, high] = band(of(row).unwrap());
                most = most.max(high - low);
                let off = (low - one.min(other)).abs().max((high - one.max(other)).abs());
                assert!(off < ITERATIONS, "{uncertain} {name} {n}: {low} {high}, {one} {other}");
            }
            assert!(most > 100.0 * ITERATIONS, "{uncertain} moves {name} by {most} kN");
        }
        assert_eq!((found.record.failed, found.record.ended_early), (0, 0));
    }
}

/// Goal: the same bytes and the same record on one thread and on three; fewer samples are the first of more, so that the band of all has those of the first ones
/// within its range.
#[test]
fn samples_do_not_depend_on_the_threads() {
    let study = study(&[("gauge_mm = 0", "gauge_mm = 0.5"), (EXACT_FRICTION, "friction = 0.05\nyoung")]);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| samples(&study, 12)).unwrap()
    };
    let (one, three) = (on(1), on(3));
    assert!(write(&one.rows) == write(&three.rows) && one.record == three.record);
    let first = samples(&study, 6).unwrap();
    let ([low, high], [few_low, few_high]) = (one.record.largest_p_kn.range, first.record.largest_p_kn.range);
    assert!(low <= few_low && few_high <= high);
}

/// Goal: where more than a twentieth of the samples has no run there is no band, with the reason of the first; an interruption ends all.
#[test]
fn samples_that_fail_leave_no_band() {
    let tilted = study(&[("inclination_deg = 0", "inclination_deg = 0.5")]);
    let reason = samples(&tilted, 8).unwrap_err();
    assert!(
        reason.contains("of 8 samples of the inputs have no run") && reason.contains("off their bodies"),
        "{reason}"
    );
}
