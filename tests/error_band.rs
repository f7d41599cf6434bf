//! The calibration states the error band of its law, and refines its meshes until the band is as narrow as the study wants.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use railspring::results::bodies::estimate::{Resources, Work, dry_run};
use railspring::results::bodies::input::SolidsInput;
use railspring::results::springs::band_record::ErrorBandRecord;
use railspring::results::springs::record::StiffnessRecord;
use railspring::study::Study;
use railspring_profiles::monitor::Silent;

/// The coarse study with its contact on a fine grid and with error bands; `more` goes into its section `[mesh]`.
fn study(more: &str) -> String {
    include_str!("studies/coarse.toml")
        .replace("error_band = false", "error_band = true")
        .replace("[contact]\n", "[contact]\nfield = \"hybrid\"\n")
        .replace("[mesh]\n", &format!("[mesh]\n{more}"))
}

fn calibrate(folder: &Path, name: &str, study: &str, more: &[&str]) -> (Output, PathBuf) {
    let (file, out) = (format!("{name}.toml"), folder.join(name));
    std::fs::write(folder.join(&file), study).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_railspring"))
        .current_dir(folder)
        .env("RAILSPRING_CACHE", "cache")
        .args(["calibrate", &file, "-o", name, "--cache", "store"])
        .args(more)
        .output()
        .unwrap();
    (output, out)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn band(out: &Path) -> (StiffnessRecord, ErrorBandRecord) {
    let text = std::fs::read_to_string(out.join("stiffness.json")).unwrap();
    let record: StiffnessRecord = serde_json::from_str(&text).unwrap();
    let band = record.error_band.clone().unwrap();
    (record, band)
}

/// Goal: `stiffness.json` has a band for every load and reference, which is the sum of the sizes of its
/// parts, and the largest of all loads. The terminal prints it. The second run takes everything from the
/// store and prints the same. A cross-check does not depend on it.
#[test]
fn the_calibration_states_the_error_band_of_its_law() {
    let folder = tempfile::tempdir().unwrap();
    let (output, out) = calibrate(folder.path(), "first", &study(""), &[]);
    let first = said(&output);
    assert!(output.status.success(), "{first}");
    let (record, band) = band(&out);
    assert!(band.missing.is_empty() && band.target.is_none(), "{band:?}");
    assert!(band.coarser_element_mm.unwrap() > 1.9 * band.contact_element_mm, "{band:?}");
    // against the section, of the surfaces, and of the profiles on half-spaces, which have no meshes
    assert_eq!(band.references.len(), 3);
    for (of, law) in band.references.iter().zip(&record.references) {
        assert_eq!((&of.reference, of.points.len()), (&law.reference, law.points.len()));
        for point in &of.points {
            let meshed = law.reference != "half-spaces";
            assert_eq!([point.mesh_displacement, point.mesh_tangent].map(|of| of.is_some()), [meshed; 2]);
            let sum = |grid: Option<f64>, mesh: Option<f64>| grid.unwrap().abs() + mesh.map_or(0.0, f64::abs);
            assert_eq!(point.displacement.unwrap(), sum(point.grid_displacement, point.mesh_displacement));
            assert_eq!(point.tangent.unwrap(), sum(point.grid_tangent, point.mesh_tangent));
        }
        let largest = of.points.iter().map(|p| p.tangent.unwrap()).fold(0.0, f64::max);
        assert_eq!(of.tangent.unwrap(), largest);
        // elements of 6 and 12 mm differ, but not by more than the law is good for
        assert!((1e-4..0.3).contains(&of.displacement.unwrap()) && largest < 0.3, "{of:?}");
    }
    let horizontal = record.horizontal.as_ref().unwrap();
    let of = horizontal.error_band.as_ref().unwrap();
    assert!(of.missing.is_none() && of.meshes.len() == horizontal.points.len(), "{of:?}");
    let largest = of.meshes.iter().fold(0.0, |largest: f64, change| largest.max(change.abs()));
    assert_eq!(of.band.unwrap(), largest);
    assert!((1e-4..0.3).contains(&of.band.unwrap()), "{of:?}");
    assert!(first.contains(&of.sentence()), "{first}");
    let line = record.law_errors().remove(0);
    assert!(line.starts_with("error band of the law (beam): displacement \u{b1}"), "{line}");
    assert!(first.contains(&line), "{first}");
    assert!(first.contains("wheel of coarser elements: made"), "{first}");
    let (output, _) = calibrate(folder.path(), "second", &study(""), &[]);
    let second = said(&output);
    assert!(second.contains("calibration: taken from the store") && second.contains(&line), "{second}");
}

/// Goal: a wanted band between that of the study's meshes and that of the next finer ones refines them once.
/// The laws, the bands and the laws by contact angle are then made on these meshes, also from the store. A
/// band that no grid reaches ends with the smallest one.
#[test]
#[ignore = "a minute: cargo long error_band"]
fn a_wanted_band_refines_the_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let (output, out) = calibrate(folder.path(), "as_is", &study(""), &[]);
    assert!(output.status.success(), "{}", said(&output));
    let (_, as_is) = band(&out);
    let found = as_is.of("beam").unwrap().largest().unwrap();

    let wanted = format!("target_error = {:.4}\n", 0.9 * found);
    let (output, out) = calibrate(folder.path(), "finer", &study(&wanted), &[]);
    let text = said(&output);
    assert!(output.status.success() && text.contains("meshed again with 4.24 mm"), "{text}");
    let (record, finer) = band(&out);
    let target = finer.target.clone().unwrap();
    assert_eq!((target.refinements, &target.not_reached), (1, &None), "{finer:?}");
    assert!(finer.of("beam").unwrap().largest().unwrap() <= 0.9 * found, "{finer:?}");
    assert!((record.mesh[0].contact_element_mm - 6.0 / 2.0_f64.sqrt()).abs() < 1e-9, "{:?}", record.mesh);

    let (output, out) = calibrate(folder.path(), "beyond", &study("target_error = 0.0001\n"), &[]);
    let text = said(&output);
    assert!(output.status.success() && text.contains("wanted error band of 0.01 %: not reached"), "{text}");
    let (_, beyond) = band(&out);
    let reason = beyond.target.unwrap().not_reached.unwrap();
    assert!(reason.contains("of which the grid of the contact and the scatter"), "{reason}");
}

/// Source: the estimate of the study's meshes, GiB. Goal: a wanted band ends where the next finer meshes have no room in a memory that those of
/// the study just fit; the laws of those are written with their band, and the reason says which meshes, and what is allowed.
#[test]
#[ignore = "a minute: cargo long error_band"]
fn a_wanted_band_ends_where_the_memory_does() {
    const GIB: f64 = 1024.0 * 1024.0 * 1024.0;
    let wanted = study("target_error = 0.03\n");
    let parsed = Study::parse(Path::new("study.toml"), &wanted).map_err(|e| e.to_string()).unwrap();
    let input = SolidsInput::of(&parsed);
    let work = Work::of(&input, true, false);
    let estimate = dry_run(&input, &work, &Resources::of_the_machine(&Silent)).unwrap();
    let limit = format!("{:.4}", 1.02 * estimate.memory() / GIB);
    let folder = tempfile::tempdir().unwrap();
    let (output, out) = calibrate(folder.path(), "small", &wanted, &["--memory-limit", &limit]);
    let text = said(&output);
    assert!(output.status.success() && !text.contains("meshed again"), "{text}");
    let (record, band) = band(&out);
    assert!((record.mesh[0].contact_element_mm - 6.0).abs() < 1e-9, "{:?}", record.mesh);
    let target = band.target.clone().unwrap();
    let reason = target.not_reached.clone().unwrap();
    assert_eq!(target.refinements, 0);
    assert!(reason.contains("the next finer meshes: ") && reason.contains("--memory-limit"), "{reason}");
    assert!(band.of("beam").unwrap().largest().unwrap() > 0.03, "{band:?}");
    assert!(text.contains("wanted error band of 3.00 %: not reached"), "{text}");
}
