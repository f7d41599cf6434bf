//! Worn profiles of a study as surfaces on their standards.

use std::path::Path;

use crate::results::bodies::geometry::geometry;
use crate::results::bodies::surface_figure::{Origin, Part};
use crate::study::Study;

/// Goal: of a worn head that is cut off 20 mm to the field side of its top, with one spike, the picture says what was measured, changed
/// and joined. The parts meet, bit for bit; the spike of 1 mm is the largest change. DISCRETISATION: the crown is inclined by less than
/// 0.07 there, and the spike stands upright, so that its distance is less by 0.3 % at most, and by the scatter of 2 micrometres.
#[test]
fn a_short_head_with_a_spike() {
    const DISCRETISATION: f64 = 0.01e-3;
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut study = Study::read(&root.join("data/studies/worn.toml")).unwrap();
    let measured = study.rail.measured.as_mut().unwrap();
    let text = String::from_utf8(measured.content.bytes(&measured.path).unwrap().to_vec()).unwrap();
    let row = |line: &str| -> Option<(f64, f64)> {
        let (y, z) = line.trim().split_once(char::is_whitespace)?;
        Some((y.parse().ok()?, z.trim().parse().ok()?))
    };
    let at = text.lines().position(|line| row(line).is_some_and(|(y, _)| y >= 5.0)).unwrap();
    let lines = text.lines().enumerate().filter_map(|(n, line)| match row(line) {
        Some((y, _)) if y > 20.0 => None,
        Some((y, z)) if n == at => Some(format!("{y} {}", z - 1.0)),
        _ => Some(line.to_owned()),
    });
    measured.content = lines.collect::<Vec<_>>().join("\n").into_bytes().into();
    let geometry = geometry(study.statics()).unwrap();
    let head = &geometry.surfaces[0];
    assert_eq!((head.body.as_str(), head.standard.as_str(), geometry.surfaces.len()), ("rail", "60E1", 2));
    let largest = head.changed.iter().max_by(|a, b| a.change.total_cmp(&b.change)).unwrap();
    assert_eq!(largest.line, at + 1);
    assert!((largest.change - 1e-3).abs() < DISCRETISATION, "{largest:?}");
    assert!((largest.read.point.x - 5e-3).abs() < 0.5e-3);
    let surface: Vec<&Part> = head
        .parts
        .iter()
        .filter(|part| part.running)
        .take_while(|part| part.origin != Origin::MeasuredUnused && part.origin != Origin::StandardUnused)
        .collect();
    for pair in surface.windows(2) {
        assert_eq!(pair[0].points.last(), pair[1].points.first());
    }
    let origins: Vec<Origin> = surface.iter().map(|part| part.origin).collect();
    let ends = [Origin::Measured, Origin::Transition, Origin::Standard];
    assert_eq!(origins[origins.len() - 3..], ends, "{origins:?}");
    let end = surface[surface.len() - 3].points.last().unwrap();
    assert!((end.x - 20e-3).abs() < 0.5e-3, "{end}");
    let whole: f64 = surface.iter().map(|part| part.length).sum();
    assert!((whole - geometry.pair.rail.running.length()).abs() < 1e-12);
    // The transition ends on the standard.
    let last = head.transitions.last().unwrap().last().unwrap();
    assert!(last.missing.abs() < 1e-9, "{last:?}");
}

/// Goal: a worn head whose gauge side was measured down to 9 mm says that its body places the rail, one that was measured
/// down to below the gauge does not. Unit mm, of the file. Accuracy: its points are 0.5 mm apart.
#[test]
fn a_side_that_ends_above_the_gauge_is_said() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let said = |deepest: f64| -> Option<String> {
        let mut study = Study::read(&root.join("data/studies/worn.toml")).unwrap();
        let measured = study.rail.measured.as_mut().unwrap();
        let text = String::from_utf8(measured.content.bytes(&measured.path).unwrap().to_vec()).unwrap();
        let too_deep = |line: &&str| {
            let row = line.trim().split_once(char::is_whitespace);
            let row = row.and_then(|(y, z)| Some((y.parse::<f64>().ok()?, z.trim().parse::<f64>().ok()?)));
            row.is_some_and(|(y, z)| y < 0.0 && z > deepest)
        };
        let kept: Vec<&str> = text.lines().filter(|line| !too_deep(line)).collect();
        measured.content = kept.join("\n").into_bytes().into();
        let geometry = geometry(study.statics()).unwrap();
        let findings = &geometry.profiles[0].findings;
        findings
            .iter()
            .map(|finding| &finding.text)
            .find(|text| text.contains("track.gauge_height_mm"))
            .cloned()
    };
    assert_eq!(said(100.0), None);
    let text = said(9.0).unwrap();
    let depth = text.strip_prefix("measured down to ").and_then(|rest| rest.split(' ').next()).unwrap();
    assert!((depth.parse::<f64>().unwrap() - 9.0).abs() < 1.5, "{text}");
}

#[test]
fn the_worn_study_reads_its_profiles() {
    let study = Study::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies/worn.toml")).unwrap();
    assert!(study.rail.measured.is_some() && study.wheel.measured.is_some());
    let geometry = geometry(study.statics()).unwrap();
    assert_eq!(geometry.profiles.len(), 2);
    assert!(geometry.profiles.iter().flat_map(|p| &p.findings).all(|f| f.action != "left"));
    // Worn off: the crown's 1.5 mm, of which 8/15 over 68 mm, and a little of the gauge corner.
    let area = geometry.pair.rail.area.area;
    assert!((76.70e-4 - 0.65e-4..76.70e-4 - 0.54e-4).contains(&area), "{area}");
}
