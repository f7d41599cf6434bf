//! The error of the condensed element's own steps in the load cases of the default studies: `cargo long own_steps`.

use std::path::Path;
use std::time::Instant;

use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring::results::bodies::estimate::Resources;
use railspring::results::bodies::geometry;
use railspring::results::run::input::{SimpleRunInput, SpringsInput};
use railspring::results::run::make::{self, Springs};
use railspring::results::run::springs;
use railspring::results::study_run::StudyRun;
use railspring::study::Study;
use railspring_profiles::monitor::Silent;
use railspring_simulate::element::condensed::CondensedModel;
use railspring_simulate::time::history::{History, HistoryRow};
use railspring_simulate::time::scenario::Scenario;
use railspring_simulate::time::steps::InnerSteps;

/// The studies with their load cases, and the times up to which the solid's motion is determined there, s, where it has the load case; the study of the published size has the cases of the first two.
type Cases = &'static [(&'static str, f64)];
const STUDIES: [(&str, &str, Cases); 3] = [
    ("uic60-s1002.toml", include_str!("../data/studies/uic60-s1002.toml"), &[("constant", 0.275)]),
    (
        "uic60-s1002-sine.toml",
        include_str!("../data/studies/uic60-s1002-sine.toml"),
        &[("sine", 0.065), ("torsion", f64::INFINITY)],
    ),
    (
        "uic60-s1002-torsion.toml",
        include_str!("../data/studies/uic60-s1002-torsion.toml"),
        &[("torsion", 0.072), ("fast", 0.083)],
    ),
];

/// Runs of which the fastest is stated.
const TIMED: usize = 5;

fn parsed((name, text): (&str, &str)) -> Study {
    Study::parse(Path::new(name), text).unwrap()
}

/// RMS and largest difference of a force over its peak, up to a time (s).
fn off([run, exact]: [&History; 2], force: fn(&HistoryRow) -> f64, until: f64) -> [f64; 2] {
    let peak = exact.rows.iter().map(|row| force(row).abs()).fold(0.0, f64::max);
    let rows = run.rows.iter().zip(&exact.rows).take_while(|(_, row)| row.time < until);
    let shares: Vec<f64> = rows.map(|(a, b)| ((force(a) - force(b)) / peak).abs()).collect();
    let squares: f64 = shares.iter().map(|share| share * share).sum();
    [(squares / shares.len() as f64).sqrt(), shares.iter().fold(0.0, |most, share| most.max(*share))]
}

/// Source: the same run with 256 equal steps in each of the history. Goal: P and Q of the condensed element
/// with the steps of a study, in every load case of the default studies, and the error of its steps that the
/// verdict states. P and Q are RMS over their peaks, as long as the motion is determined, of element and
/// solid; the stated error counts as long as the element's own motion is. Accuracy: DISCRETISATION, 0.5 %:
/// half of the solid's step error, so that the root of the squares of both is the solid's but for an eighth.
#[test]
#[ignore = "half a minute: cargo long own_steps"]
fn steps_of_a_study_have_half_the_error_of_the_solids() {
    const DISCRETISATION: f64 = 0.005;
    let place = tempfile::tempdir().unwrap();
    let folder = OutputFolder::create(place.path(), &Inputs::none()).unwrap();
    let first = parsed((STUDIES[0].0, STUDIES[0].1));
    StudyRun::new(&first, &folder, Resources::of_the_machine(&Silent)).calibrate().unwrap();
    let record = springs::from_file(
        &SpringsInput::of(&first),
        &geometry::geometry(first.statics()).unwrap(),
        &place.path().join("stiffness.json"),
    );
    let springs: Springs = springs::springs(&record.unwrap()).unwrap();
    let (_, element) = springs.element.clone().expect("the default study has an element");
    println!(
        "| | until | P: RMS, largest | Q: RMS, largest | P, Q by steps half as long | twice as long | steps | time |\n|---|---|---|---|---|---|---|---|"
    );
    let mut worst = 0.0_f64;
    for (name, text, cases) in STUDIES {
        let study = parsed((name, text));
        let geometry = geometry::geometry(study.statics()).unwrap();
        let beam = geometry.beam.corrected(&springs.beam).unwrap();
        let damped = study.statics().materials().map(|own| own.damped(study.damping));
        let model = CondensedModel::of_pair(&geometry.pair, beam, damped.each_ref(), element.clone());
        for &(key, of_solid) in cases {
            let case = &study.scenarios[key];
            let (history, tried) =
                make::simulate(&SimpleRunInput::of(&study, case), &geometry, &springs, &Silent).unwrap();
            let spread = tried.uncertainty.spread.unwrap();
            let own = spread.determined_until_s.unwrap_or(f64::INFINITY);
            let until = own.min(of_solid);
            let uncertainty = tried.uncertainty.steps.unwrap().of.change;
            let run = |inner_steps| {
                let scenario = Scenario { inner_steps, ..case.scenario.clone() };
                let begun = Instant::now();
                (model.run(&scenario, &Silent).unwrap(), 1e3 * begun.elapsed().as_secs_f64())
            };
            let timed: Vec<_> = (0..TIMED).map(|_| run(CondensedModel::STEPS)).collect();
            assert_eq!(timed[0].0.history.rows, history.rows);
            let [exact, longer] = [InnerSteps::Equal(256), CondensedModel::STEPS.doubled()]
                .map(|inner_steps| run(inner_steps).0.history);
            let forces: [fn(&HistoryRow) -> f64; 2] = [|row| row.vertical_force, |row| row.lateral_force];
            let [p, q] = forces.map(|force| off([&history, &exact], force, until));
            let doubled = forces.map(|force| off([&longer, &history], force, until)[0]);
            let end = history.rows[history.rows.len() - 1].time;
            println!(
                "| {name} {key} | {:.1} ms | {:.2}, {:.1} % | {:.2}, {:.1} % | {:.2}, {:.2} % to {:.1} ms | {:.2}, {:.2} % | {:.2} | {:.0} ms |",
                1e3 * until.min(end),
                1e2 * p[0],
                1e2 * p[1],
                1e2 * q[0],
                1e2 * q[1],
                1e2 * uncertainty.p_rms,
                1e2 * uncertainty.q_rms,
                1e3 * own.min(end),
                1e2 * doubled[0],
                1e2 * doubled[1],
                timed[0].0.statistics.steps as f64 / case.scenario.steps as f64,
                timed.iter().map(|(_, time)| *time).fold(f64::INFINITY, f64::min)
            );
            worst = [p[0], q[0], uncertainty.p_rms, uncertainty.q_rms].into_iter().fold(worst, f64::max);
        }
    }
    assert!(worst < DISCRETISATION, "{worst}");
}
