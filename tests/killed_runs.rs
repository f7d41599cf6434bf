//! Runs that are killed over an older result of another study in the same folder, and while they write to the store.
//!
//! Goal: whenever a run is killed, no later command uses a mixture. `verify` and `report` of either study
//! refuse, or come to the very bytes of a clean run of that study. So does a run after it with the store that
//! the killed one has left. No entry of that store is damaged. The store is empty, has the results of the
//! other study, or is replaced with `--fresh`. Half of the kills come at a random time. Half come right after
//! a random change in the folder or in the store, where a result stands between two files.
//! Cross-checks are killed in the same way over the cross-check of the other study. Three of each are killed by
//! default, and a hundred runs and twenty cross-checks with `cargo long killed_runs`.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

use railspring_testing::{Random, await_changes, copy};
use serde_json::Value;

use crate::environment;

/// Two studies that share the load case's name and differ in springs, histories and verdict.
fn study(which: usize) -> String {
    let (largest, force) = [(85, 50), (80, 60)][which];
    format!(
        "{}[scenario.one]\nsteps = 4\nvertical_force = {{ mean_kn = {force} }}\nlateral_force = {{ mean_kn = 5 }}\n",
        include_str!("studies/coarse.toml").replace("load_max_kn = 85", &format!("load_max_kn = {largest}"))
    )
}

fn command(root: &Path, name: &str, which: usize, out: &Path, store: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
    command.arg(name).arg(root.join(format!("{which}.toml"))).arg("-o").arg(out);
    command.arg("--cache").arg(store).env("RAILSPRING_CACHE", environment::cache());
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn done(output: &Output) -> bool {
    let code = output.status.code();
    assert!(matches!(code, Some(0..=2)), "{code:?}: {}", String::from_utf8_lossy(&output.stderr));
    code != Some(2)
}

/// The results that follow from the study alone.
fn results(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut names: Vec<String> =
        ["stiffness.json", "load_curve.csv", "history.csv", "solid_history.csv", "verification.json"]
            .map(String::from)
            .into();
    for entry in std::fs::read_dir(out.join("figures")).into_iter().flatten().flatten() {
        names.push(format!("figures/{}", entry.file_name().to_string_lossy()));
    }
    for name in names {
        found.insert(name.clone(), std::fs::read(out.join(&name)).unwrap_or_else(|e| panic!("{name}: {e}")));
    }
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    let part = page.split("<section id=\"measured\">").next().unwrap();
    found.insert("report.html".into(), part.into());
    found
}

/// Names and times of change of the files of an output folder and of a store.
fn state(out: &Path, store: &Path) -> Vec<(String, Option<SystemTime>)> {
    let mut files: Vec<_> =
        [out.to_path_buf(), out.join("figures"), out.join("crosscheck"), store.to_path_buf()]
            .iter()
            .flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten().flatten())
            .map(|entry| {
                let changed = entry.metadata().and_then(|m| m.modified()).ok();
                (entry.file_name().to_string_lossy().into_owned(), changed)
            })
            .collect();
    files.sort();
    files
}

#[test]
#[ignore = "a quarter of a minute: cargo long killed_runs"]
fn a_killed_run_leaves_no_mixture() {
    killed(3);
}

/// Goal: no command after any of a hundred kills uses a mixture of two studies' results.
#[test]
#[ignore = "half an hour: cargo long killed_runs"]
fn a_hundred_killed_runs_leave_no_mixture() {
    killed(100);
}

fn killed(kills: usize) {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let mut clean = Vec::new();
    let mut duration = Duration::ZERO;
    for which in 0..2 {
        std::fs::write(root.join(format!("{which}.toml")), study(which)).unwrap();
        let out = root.join(format!("clean-{which}"));
        let begun = Instant::now();
        let store = root.join(format!("store-{which}"));
        assert!(done(&command(root, "run", which, &out, &store).output().unwrap()));
        duration = begun.elapsed();
        clean.push(results(&out));
    }
    assert!(clean[0].iter().all(|(name, content)| name.contains("figures") || *content != clean[1][name]));

    let mut random = Random::new(kills as u64);
    let (mut used, mut found) = (BTreeMap::new(), BTreeMap::new());
    for kill in 0..kills {
        let out = root.join("out");
        let _ = std::fs::remove_dir_all(&out);
        copy(&root.join("clean-0"), &out);
        let store = root.join("store");
        let _ = std::fs::remove_dir_all(&store);
        let mut run = command(root, "run", 1, &out, &store);
        match kill % 3 {
            0 => {}
            1 => copy(&root.join("store-0"), &store),
            _ => {
                copy(&root.join("store-1"), &store);
                run.arg("--fresh");
            }
        }
        let mut child = run.stderr(Stdio::null()).spawn().unwrap();
        if kill % 2 == 0 {
            std::thread::sleep(duration * random.below(1000) as u32 / 1000);
        } else {
            // Every file is written under a temporary name and renamed: two changes per file, some forty-five files.
            await_changes(&mut child, 1 + random.below(90), || state(&out, &store));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        for which in 0..2 {
            for name in ["report", "verify"] {
                let later = root.join("copy");
                let _ = std::fs::remove_dir_all(&later);
                copy(&out, &later);
                let stored = root.join("stored");
                let _ = std::fs::remove_dir_all(&stored);
                if store.exists() {
                    copy(&store, &stored);
                }
                let took = done(&command(root, name, which, &later, &stored).output().unwrap());
                *used.entry((name, which, took)).or_insert(0) += 1;
                if took {
                    if name == "verify" {
                        assert!(done(&command(root, "report", which, &later, &stored).output().unwrap()));
                    }
                    for (file, content) in results(&later) {
                        assert!(
                            content == clean[which][&file],
                            "kill {kill}: {name} of study {which} uses another {file}"
                        );
                    }
                }
            }
        }
        let after = command(root, "run", 1, &out, &store).output().unwrap();
        let said = String::from_utf8_lossy(&after.stderr);
        assert!(done(&after) && !said.contains("damaged"), "kill {kill}: a run after it: {said}");
        *found.entry(said.matches("taken from the store").count()).or_insert(0) += 1;
        assert!(results(&out) == clean[1], "kill {kill}: a run after it differs from a clean one");
        let left: Vec<_> =
            state(&out, &out).into_iter().filter(|(name, _)| name.starts_with(".railspring-")).collect();
        assert!(left.is_empty(), "kill {kill}: {left:?}");
    }
    println!("{kills} kills; (command, study, took results): {used:?}");
    println!("stages that the run after a kill took from the store, and how often: {found:?}");
}

/// The record of a cross-check and where the bodies differ, without what differs from run to run.
fn answers(out: &Path) -> [Value; 2] {
    fn plain(value: &mut Value) {
        match value {
            Value::Object(fields) => {
                fields.retain(|name, _| {
                    !name.ends_with("seconds")
                        && !["host", "begun_utc", "date_utc", "content_blake3"].contains(&name.as_str())
                });
                fields.values_mut().for_each(plain);
            }
            Value::Array(values) => values.iter_mut().for_each(plain),
            _ => {}
        }
    }
    ["crosscheck.json", "crosscheck/differences.json"].map(|name| {
        let text = std::fs::read(out.join(name)).unwrap_or_else(|cause| panic!("{name}: {cause}"));
        let mut value = serde_json::from_slice(&text).unwrap_or_else(|cause| panic!("{name}: {cause}"));
        plain(&mut value);
        value
    })
}

/// Source: cross-checks and reports of both studies that were left alone. Goal: whenever a cross-check is killed over that of the other study, the results of the folder are as
/// they were. Its cross-check is one of the two and whole, and the report says of which study. The next cross-check has the answers of one that was left alone, with nothing left over.
#[test]
#[ignore = "a minute: cargo long killed_runs"]
fn a_killed_cross_check_leaves_no_mixture() {
    killed_cross_checks(3);
}

/// Goal: the same after each of twenty kills.
#[test]
#[ignore = "ten minutes: cargo long killed_runs"]
fn twenty_killed_cross_checks_leave_no_mixture() {
    killed_cross_checks(20);
}

fn killed_cross_checks(kills: usize) {
    if !railspring_testing::python() {
        return;
    }
    environment::python();
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let (mut duration, mut clean) = (Duration::ZERO, Vec::new());
    let ended = |name: &str, which: usize, out: &Path| {
        assert!(done(
            &command(root, name, which, out, &root.join(format!("store-{which}"))).output().unwrap()
        ));
    };
    for which in 0..2 {
        std::fs::write(root.join(format!("{which}.toml")), study(which)).unwrap();
        let out = root.join(format!("clean-{which}"));
        ended("run", which, &out);
        let begun = Instant::now();
        ended("crosscheck", which, &out);
        duration = begun.elapsed();
        clean.push(answers(&out));
    }
    assert!(clean[0] != clean[1]);
    // the report of the first study with its own cross-check, and with that of the other one
    let report = |out: &Path| {
        ended("report", 0, out);
        results(out).remove("report.html").unwrap()
    };
    let with = |which: usize| {
        let out = root.join("with");
        let _ = std::fs::remove_dir_all(&out);
        copy(&root.join("clean-0"), &out);
        copy(&root.join(format!("clean-{which}/crosscheck")), &out.join("crosscheck"));
        let name = "crosscheck.json";
        std::fs::copy(root.join(format!("clean-{which}")).join(name), out.join(name)).unwrap();
        report(&out)
    };
    let reports = [with(0), with(1)];
    assert!(reports[0] != reports[1]);
    let own = std::fs::read(root.join("clean-0/crosscheck.json")).unwrap();
    let before = results(&root.join("clean-0"));
    let mut random = Random::new(kills as u64);
    let (mut in_time, mut changed) = (0, 0);
    for kill in 0..kills {
        let (out, store, later) = (root.join("out"), root.join("store"), root.join("later"));
        [&out, &store, &later].iter().for_each(|folder| drop(std::fs::remove_dir_all(folder)));
        copy(&root.join("clean-0"), &out);
        let mut run = command(root, "crosscheck", 1, &out, &store);
        if kill % 3 > 0 {
            copy(&root.join(format!("store-{}", kill % 3 - 1)), &store);
        }
        if kill % 3 == 2 {
            run.arg("--fresh");
        }
        let mut child = run.stderr(Stdio::null()).spawn().unwrap();
        if kill % 2 == 0 {
            std::thread::sleep(duration * random.below(1000) as u32 / 1000);
        } else {
            await_changes(&mut child, 1 + random.below(60), || state(&out, &store));
        }
        in_time += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(results(&out) == before, "kill {kill}: the results of the folder are others");
        let is_own = std::fs::read(out.join("crosscheck.json")).unwrap() == own;
        assert!(is_own || answers(&out)[0] == clean[1][0], "kill {kill}: a cross-check of no study");
        copy(&out, &later);
        assert!(report(&later) == reports[usize::from(!is_own)], "kill {kill}: another report");
        changed += usize::from(!is_own);
        let after = command(root, "crosscheck", 1, &out, &store).output().unwrap();
        let said = String::from_utf8_lossy(&after.stderr);
        assert!(done(&after) && !said.contains("damaged"), "kill {kill}: one after it: {said}");
        assert!(answers(&out) == clean[1], "kill {kill}: one after it has other answers");
        for folder in [&out, &out.join("crosscheck")] {
            let left = state(folder, folder).into_iter().filter(|(name, _)| name.starts_with(".railspring-"));
            assert_eq!(left.count(), 0, "kill {kill}");
        }
    }
    println!(
        "{kills} killed cross-checks, {in_time} before the end, {changed} of them after they had replaced the other one"
    );
}
