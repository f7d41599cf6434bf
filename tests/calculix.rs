//! The deck for other programs, CalculiX on it, and studies that cannot be cross-validated.
//!
//! CalculiX (`ccx` on the path; Debian: `calculix-ccx`) is not needed to build or use the tool; without it the second
//! test is counted as skipped. The long comparison is `cargo validate-calculix`.

use std::path::Path;
use std::sync::OnceLock;

use railspring::results::bodies::estimate::Resources;
use railspring::results::crosscheck::answers::AnsweredCurve;
use railspring::results::crosscheck::deck::{Deck, Format};
use railspring::results::crosscheck::input::CrosscheckInput;
use railspring::results::crosscheck::{Prepared, calculix, prepare};
use railspring::results::springs::make::check_friction;
use railspring::study::Study;
use railspring_profiles::monitor::Silent;
use railspring_testing::{Need, needs};

fn study() -> &'static Study {
    static STUDY: OnceLock<Study> = OnceLock::new();
    STUDY.get_or_init(|| {
        Study::parse(Path::new("coarse.toml"), include_str!("studies/coarse.toml"))
            .unwrap_or_else(|e| panic!("{e}"))
    })
}

fn input() -> &'static CrosscheckInput<'static> {
    static INPUT: OnceLock<CrosscheckInput<'static>> = OnceLock::new();
    INPUT.get_or_init(|| CrosscheckInput::of(study()))
}

fn prepared() -> &'static Prepared {
    static PREPARED: OnceLock<Prepared> = OnceLock::new();
    PREPARED.get_or_init(|| {
        prepare(input(), &[], &Resources::of_the_machine(&Silent)).unwrap_or_else(|e| panic!("{e}"))
    })
}

fn deck(friction: f64, lowerings: &[f64]) -> Deck<'_> {
    let Prepared { geometry, meshes, .. } = prepared();
    Deck { input: input(), geometry, meshes, friction, lowerings }
}

/// Lines that follow the first line beginning with `keyword`, up to the next keyword.
fn block<'a>(text: &'a str, keyword: &str) -> Vec<&'a str> {
    let lines = text.lines().skip_while(|line| !line.starts_with(keyword)).skip(1);
    lines.take_while(|line| !line.starts_with('*')).collect()
}

/// Source: the keyword manuals of CalculiX and Abaqus. Goal: both decks hold all nodes (and the hub's), all bricks,
/// the facets of both contact grids, hard contact, friction if there is any, and a step for every displacement (mm).
#[test]
fn decks_are_complete() {
    let Prepared { meshes, .. } = prepared();
    for format in [Format::Calculix, Format::Abaqus] {
        let text = deck(0.5, &[1e-5, 2e-5]).text(format).unwrap_or_else(|e| panic!("{e}"));
        let nodes = block(&text, "*NODE, NSET=NALL").len();
        assert_eq!(nodes, meshes.rail.nodes.len() + meshes.wheel.nodes.len() + 2);
        for (name, mesh) in [("RAIL", &meshes.rail), ("WHEEL", &meshes.wheel)] {
            let bricks = block(&text, &format!("*ELEMENT, TYPE=C3D8, ELSET={name}"));
            assert_eq!(bricks.len(), mesh.hexes.len());
            let facets = (mesh.contact.along_profile.len() - 1) * (mesh.contact.along_track.len() - 1);
            assert_eq!(block(&text, &format!("*SURFACE, NAME=S{name}")).len(), facets);
        }
        assert!(text.contains("PRESSURE-OVERCLOSURE=HARD") && text.contains("*FRICTION\n0.5,"));
        assert_eq!(text.matches("*STEP").count(), 2);
        assert!(text.contains(", 3, 3, 1.000000000000e-2\n") && text.contains(", 3, 3, 2.000000000000e-2\n"));
        let smooth = deck(0.0, &[1e-5]).text(format).unwrap_or_else(|e| panic!("{e}"));
        assert!(!smooth.contains("*FRICTION"));
    }
}

/// Source: CalculiX with its own mortar contact on the same facets. Goal: the reaction (N) at the hub displacement that
/// the tool has under 60 kN without friction. Accuracy: on 6 mm elements five nodes carry that load; their pressures are
/// weighted by other functions.
#[test]
fn calculix_finds_the_load() {
    /// Half of one node's share of the area, times the half of the compliance that is local, of five nodes.
    const DISCRETISATION: f64 = 0.05;
    const LOAD: f64 = 60e3;
    let version = calculix::version();
    if !needs(Need::Calculix, "CalculiX (ccx)", version.is_ok()) {
        return;
    }
    let (program, _) = version.unwrap();
    let AnsweredCurve { points, .. } = &prepared().answers.faceted;
    let point = points.iter().find(|p| p.force == LOAD).unwrap();
    let root = tempfile::tempdir().unwrap();
    let text = deck(0.0, &[point.displacement]).text(Format::Calculix).unwrap_or_else(|e| panic!("{e}"));
    std::fs::write(root.path().join("deck.inp"), text).unwrap();
    let steps = calculix::run(program, root.path(), "deck", 1, &Silent).unwrap_or_else(|e| panic!("{e}"));
    let [(displacement, reaction)] = steps[..] else { panic!("{steps:?}") };
    assert!((displacement / point.displacement - 1.0).abs() < 1e-6, "{displacement}");
    assert!((reaction / LOAD - 1.0).abs() < DISCRETISATION, "{reaction}");
}

/// Source: CalculiX's brick with full integration on the same meshes. Goal: mean lateral displacement of each body's contact under lateral
/// forces of one in all, m/N. Accuracy: the seven digits that it prints, of some forty nodes.
#[test]
fn calculix_finds_the_lateral_flexibility() {
    /// ROUNDOFF of the printed digits.
    const PRINTED: f64 = 1e-6;
    let version = calculix::version();
    if !needs(Need::Calculix, "CalculiX (ccx)", version.is_ok()) {
        return;
    }
    let (program, _) = version.unwrap();
    let answers = &prepared().answers;
    let root = tempfile::tempdir().unwrap();
    let bodies = [&answers.rail, &answers.wheel];
    let text = deck(0.0, &[]).lateral_text(bodies.map(|body| body.lateral.as_slice()));
    std::fs::write(root.path().join("deck.inp"), text).unwrap();
    let moved =
        calculix::displacements(program, root.path(), "deck", &Silent).unwrap_or_else(|e| panic!("{e}"));
    for (body, offset) in bodies.into_iter().zip([0, prepared().meshes.rail.nodes.len()]) {
        assert!((body.lateral.iter().map(|(_, force)| force).sum::<f64>() - 1.0).abs() < 1e-12);
        let mean: f64 = body.lateral.iter().map(|(node, force)| force * moved[&(node + offset + 1)].y).sum();
        assert!(
            (mean / body.lateral_flexibility - 1.0).abs() < PRINTED,
            "{mean} {}",
            body.lateral_flexibility
        );
    }
}

/// Goal: a study whose loads are all below the smallest one of the cross-validation is refused by key, and so is a frictionless
/// calibration.
#[test]
fn studies_that_cannot_be_cross_validated_are_refused() {
    let mut light = study().clone();
    light.calibration.loads = vec![1e3, 2e3, 3e3];
    let said = prepare(&CrosscheckInput::of(&light), &[], &Resources::of_the_machine(&Silent))
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(said.contains("calibration.load_max_kn = 3: expected a load of at least 5 kN"), "{said}");
    let mut smooth = study().clone();
    smooth.contact.friction = 0.0;
    let said = check_friction(smooth.statics()).unwrap_err().to_string();
    assert!(said.contains("contact.friction = 0: expected a positive coefficient"), "{said}");
}
