//! Tables that are killed, find their disk full, or share a store with others: `railspring table`.
//!
//! Goal: nothing is lost and nothing is wrong. The next table takes whatever is in the store after a kill,
//! and comes to the bytes of one that was left alone. Every file in the output folder is a whole one, of this
//! table or of the one before. A full disk loses only what does not fit there. Tables that run at the same
//! time on one store come to their bytes each. Source: the same tables, left alone, equal to the byte; one of them has a folder
//! of measured wheels, and a page of the fleet. Half
//! of the kills come at a random time, half right after a random change in the output folder or in the store.
//! The full disk is a file system of a given size (tmpfs in a mount namespace).
//! `cargo long interrupted_tables` does more of each.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant, SystemTime};

use crate::tables::{Place, hollow_wheels};
use railspring_testing::{Need, Random, await_changes, needs};

/// Two wheels on a rail at two shifts.
const TABLE: &str = "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0, 2]\nstiffness_at_kn = [20, 60]\n\
    [[wheel]]\nprofile = \"S1002\"\n[[wheel]]\nname = \"worn\"\nprofile_file = \"worn.whl\"\nstandard = \"S1002\"\n\
    [[rail]]\nprofile = \"60E1\"\n";
const PLACES: usize = 4;
/// As many measured wheels as make a page of a fleet, on a rail.
const FLEET: &str = "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0]\nstiffness_at_kn = [20, 60]\n\
    [[wheel]]\nfolder = \"measured\"\nstandard = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n";
const WHEELS: usize = 21;

type Files = BTreeMap<&'static str, Vec<u8>>;

/// A table and another one with the same bodies, both left alone.
struct Clean {
    place: Place,
    places: usize,
    files: [Files; 2],
    /// How long the first one took.
    duration: Duration,
    /// Size of its store, bytes.
    stored: u64,
}

fn clean() -> &'static Clean {
    static MADE: OnceLock<Clean> = OnceLock::new();
    MADE.get_or_init(|| {
        let made = left_alone(
            Place::new(TABLE),
            PLACES,
            &TABLE.replace("shifts_mm = [0, 2]", "shifts_mm = [-1, 1]"),
        );
        assert!(made.files[0].iter().all(|(name, content)| *content != made.files[1][name]));
        made
    })
}

fn fleet() -> &'static Clean {
    static MADE: OnceLock<Clean> = OnceLock::new();
    MADE.get_or_init(|| {
        let place = Place::new(FLEET);
        hollow_wheels(&place.path("measured"), WHEELS);
        let made = left_alone(place, WHEELS, &FLEET.replace("shifts_mm = [0]", "shifts_mm = [1]"));
        assert!(
            ["table.csv", "table_fleet.html"].iter().all(|name| made.files[0][name] != made.files[1][name])
        );
        made
    })
}

fn left_alone(place: Place, places: usize, other: &str) -> Clean {
    place.write("other.toml", other);
    let begun = Instant::now();
    let mut duration = None;
    let files = [("table.toml", "clean"), ("other.toml", "other")].map(|(table, out)| {
        whole(&run(&place, table, &place.path(out), &place.path("clean-store"), &[]).output().unwrap());
        duration.get_or_insert(begun.elapsed());
        files(&place.path(out))
    });
    let stored = entries(&place.path("clean-store")).values().map(|(bytes, _)| bytes).sum();
    Clean { place, places, files, duration: duration.unwrap(), stored }
}

fn run(place: &Place, table: &str, out: &Path, store: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
    command
        .current_dir(place.0.path())
        .args(["table", table, "-o"])
        .arg(out)
        .arg("--cache")
        .arg(store)
        .args(more);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// What a table says that ended well.
fn whole(output: &Output) -> String {
    let said =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat();
    assert!(output.status.success() && !said.contains("damaged"), "{said}");
    said
}

/// Files of a folder, with their sizes (bytes) and times of change.
fn entries(folder: &Path) -> BTreeMap<String, (u64, Option<SystemTime>)> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let entry = |file: std::fs::DirEntry| {
        let about = file.metadata().ok()?;
        Some((file.file_name().to_string_lossy().into_owned(), (about.len(), about.modified().ok())))
    };
    files.filter_map(entry).collect()
}

fn count(folder: &Path, beginning: &str) -> usize {
    entries(folder).keys().filter(|name| name.starts_with(beginning)).count()
}

fn copy(from: &Path, to: &Path) {
    let _ = std::fs::remove_dir_all(to);
    std::fs::create_dir_all(to).unwrap();
    for name in entries(from).keys() {
        std::fs::copy(from.join(name), to.join(name)).unwrap();
    }
}

fn files(out: &Path) -> Files {
    let read = |name| Some((name, std::fs::read(out.join(name)).ok()?));
    let names =
        ["table.csv", "table.json", "table.html", "table.parquet", "table_fleet.html", "table_typical.toml"];
    names.into_iter().filter_map(read).collect()
}

fn killed(Clean { place, places, files: [wanted, earlier], duration, .. }: &Clean, kills: usize) {
    let root = tempfile::tempdir().unwrap();
    let [store, copied] = ["store", "copied"].map(|name| root.path().join(name));
    // beside the folders of those that were left alone: paths in the files are relative to theirs
    let [out, after] = ["out", "after"].map(|name| place.path(&format!("{name}-{kills}")));
    let mut random = Random::new(kills as u64);
    let (mut in_time, mut mixed, mut found) = (0, 0, BTreeMap::<usize, usize>::new());
    for kill in 0..kills {
        copy(&place.path("other"), &out);
        // a store lives through four kills
        if kill % 4 == 0 {
            let _ = std::fs::remove_dir_all(&store);
        }
        let fresh: &[&str] = if kill % 8 == 7 { &["--fresh"] } else { &[] };
        let mut child = run(place, "table.toml", &out, &store, fresh).stderr(Stdio::null()).spawn().unwrap();
        if kill % 2 == 0 {
            std::thread::sleep(*duration * random.below(1000) as u32 / 1000);
        } else {
            // an entry for each place, some for the bodies, and the files, each under a temporary name and renamed
            let changes = 1 + random.below(2 * (places + 6) as u64);
            await_changes(&mut child, changes, || [&out, &store].map(|folder| entries(folder)));
        }
        in_time += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        let there = files(&out);
        assert!(there.iter().all(|(name, content)| [wanted, earlier].iter().any(|of| of[name] == *content)));
        assert_eq!(there.len(), wanted.len(), "kill {kill}");
        let new = there.iter().filter(|(name, content)| wanted[*name] == **content).count();
        mixed += usize::from((1..wanted.len()).contains(&new));
        // the next table, on a copy, so that the store goes on as it was left
        copy(&store, &copied);
        let kept = count(&copied, "place-");
        let said = whole(&run(place, "table.toml", &out, &copied, &[]).output().unwrap());
        assert!(said.contains(&format!("{kept} of them in the store")), "kill {kill}, {kept}: {said}");
        assert!(files(&out) == *wanted, "kill {kill}: another table than one that was left alone");
        assert_eq!((count(&out, ".railspring-"), count(&copied, "place-")), (0, *places), "kill {kill}");
        whole(&run(place, "table.toml", &after, &copied, &[]).output().unwrap());
        assert!(files(&after) == *wanted, "kill {kill}");
        *found.entry(kept).or_insert(0) += 1;
    }
    assert!(in_time > 0);
    println!(
        "{kills} kills, {in_time} before the end, {mixed} of them between the files of the output folder; places that the next table found, and how \
         often: {found:?}"
    );
}

/// On file systems of `sizes` bytes: the store alone, and the output folder alone.
fn on_full_disks(sizes: &[u64]) {
    let Clean { place, files: [wanted, earlier], stored, .. } = clean();
    let namespace = |script: &str| {
        let mut command = Command::new("unshare");
        command.args(["--user", "--map-root-user", "--mount", "sh", "-c", script, "sh"]);
        command.current_dir(place.0.path()).stdin(Stdio::null());
        command
    };
    let root = tempfile::tempdir().unwrap();
    let [disk, after, out, store] = ["disk", "after", "out", "store"].map(|name| root.path().join(name));
    std::fs::create_dir(&disk).unwrap();
    let can = namespace("mount -t tmpfs -o size=64k tmpfs \"$1\"").arg(&disk).output();
    if !needs(Need::SmallDisk, "unshare and tmpfs", can.is_ok_and(|output| output.status.success())) {
        return;
    }
    // the disk is gone with its namespace: what is on it is copied
    let script = "mount -t tmpfs -o size=\"$1\" tmpfs \"$2\" && { [ ! -d \"$3\" ] || cp \"$3\"/* \"$2\"; } && shift 2 && from=$1 && to=$2 && shift 2 && \
                  \"$@\"; code=$?; cp \"$DISK\"/* \"$to\"; exit $code";
    let on_disk = |size: u64, from: &Path, table: &mut Command| -> Output {
        let _ = std::fs::remove_dir_all(&after);
        std::fs::create_dir(&after).unwrap();
        let mut command = namespace(script);
        command.env("DISK", &disk).arg(size.to_string()).args([&disk, from, &after]);
        command.arg(table.get_program()).args(table.get_args()).output().unwrap()
    };
    let (mut kept_in_part, mut refused) = (0, 0);
    for &size in sizes {
        let output = on_disk(size, Path::new("none"), &mut run(place, "table.toml", &out, &disk, &[]));
        let said = whole(&output);
        assert!(files(&out) == *wanted, "{size} bytes: another table than with room");
        let kept = count(&after, "place-") + count(&after, "body-");
        assert_eq!(
            said.contains("not kept in the store"),
            size < *stored,
            "{size} of {stored} bytes: {said}"
        );
        assert_eq!(count(&after, ".railspring-"), 0, "{size} bytes");
        kept_in_part += usize::from(kept > 0 && size < *stored);
        // what fitted is taken
        let places = count(&after, "place-");
        let said = whole(&run(place, "table.toml", &out, &after, &[]).output().unwrap());
        assert!(said.contains(&format!("{places} of them in the store")) && files(&out) == *wanted, "{said}");
    }
    whole(&run(place, "table.toml", &out, &store, &[]).output().unwrap());
    let needed: u64 = wanted.values().chain(earlier.values()).map(|content| content.len() as u64).sum();
    for &size in sizes {
        // from what the earlier table takes to what both take
        let before: u64 = earlier.values().map(|content| content.len().next_multiple_of(4096) as u64).sum();
        let size = before + size * needed / stored;
        let output = on_disk(size, &place.path("other"), &mut run(place, "table.toml", &disk, &store, &[]));
        let (said, there) = (String::from_utf8_lossy(&output.stderr).into_owned(), files(&after));
        assert!(there.iter().all(|(name, content)| [wanted, earlier].iter().any(|of| of[name] == *content)));
        assert_eq!((there.len(), count(&after, ".railspring-")), (wanted.len(), 0));
        match output.status.code() {
            Some(0) => assert!(there == *wanted),
            code => {
                assert!(
                    code == Some(2) && said.contains("make room") && there == *earlier,
                    "{code:?}: {said}"
                );
                refused += 1;
            }
        }
    }
    assert!(kept_in_part > 0 && refused > 0, "{kept_in_part} {refused}");
    println!(
        "{0} stores on full disks, {kept_in_part} of them with a part of the entries; {0} output folders on full disks, {refused} of them as before",
        sizes.len()
    );
}

/// Two tables and the first one once more at the same time on one store, which is pruned meanwhile every other time.
fn at_once(rounds: usize) {
    let Clean { place, files: wanted, .. } = clean();
    let root = tempfile::tempdir().unwrap();
    let mut random = Random::new(7);
    for round in 0..rounds {
        let store = root.path().join(format!("store-{round}"));
        let begin = |(number, table): (usize, &str)| {
            let out = root.path().join(format!("{round}-{number}"));
            std::thread::sleep(Duration::from_millis(random.below(200)));
            (run(place, table, &out, &store, &["--threads", "1"]).spawn().unwrap(), out)
        };
        let tables = ["table.toml", "other.toml", "table.toml"];
        let begun: Vec<_> = tables.into_iter().enumerate().map(begin).collect();
        let pruned = round % 2 == 1;
        if pruned {
            std::thread::sleep(clean().duration / 2);
            let mut prune = Command::new(env!("CARGO_BIN_EXE_railspring"));
            prune.args(["cache", "prune", "--all", "--cache"]).arg(&store).stdout(Stdio::null());
            assert!(prune.status().unwrap().success());
        }
        for ((child, out), which) in begun.into_iter().zip([0, 1, 0]) {
            whole(&child.wait_with_output().unwrap());
            assert!(files(&out) == wanted[which], "round {round}: another table than one that was alone");
        }
        for (table, which) in [("table.toml", 0), ("other.toml", 1)] {
            let out = root.path().join("again");
            let said = whole(&run(place, table, &out, &store, &[]).output().unwrap());
            let all = said.contains(&format!("at {PLACES} places, {PLACES} of them in the store"));
            assert!((all || pruned) && files(&out) == wanted[which], "round {round}: {said}");
        }
        assert_eq!(count(&store, ".railspring-"), 0, "round {round}");
        std::fs::remove_dir_all(&store).unwrap();
    }
    println!("{rounds} times three tables at once on one store, every other time pruned meanwhile");
}

#[test]
#[ignore = "a quarter of a minute: cargo long interrupted_tables"]
fn a_killed_table_loses_nothing() {
    killed(clean(), 2);
}

/// Goal: the same of a table with a folder of measured wheels, whose page and typical wheels are those of one that was left alone.
#[test]
#[ignore = "a minute: cargo long interrupted_tables"]
fn a_killed_fleet_loses_nothing() {
    killed(fleet(), 2);
}

#[test]
#[ignore = "a quarter of a minute: cargo long interrupted_tables"]
fn a_full_disk_costs_what_does_not_fit() {
    // room for eight tenths of a table of the same size beside the earlier one
    on_full_disks(&[clean().stored * 2 / 5]);
}

#[test]
fn tables_share_a_store() {
    at_once(1);
}

/// Goal: after each of a hundred kills, twenty of a fleet, on full disks, and with several tables at once on one store, a table has the bytes of one that nothing disturbed.
#[test]
#[ignore = "ten minutes: cargo long interrupted_tables"]
fn a_hundred_kills_full_disks_and_tables_at_once() {
    killed(clean(), 100);
    killed(fleet(), 20);
    let stored = clean().stored;
    on_full_disks(&(0..20).map(|part| stored * (2 * part + 1) / 36).collect::<Vec<u64>>());
    at_once(20);
}
