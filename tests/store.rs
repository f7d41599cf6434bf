//! The store: what was made is taken again, by what it was made from and by nothing else.
//!
//! Goal: a run that takes from the store comes to the very bytes of one that makes everything, says of every stage
//! whether it was taken or made, and makes again exactly what a change has an influence on. Source: runs of the same
//! study with a store that is empty, equal to the byte; times and host aside.

use crate::coarser::coarser;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, SystemTime};

/// The coarse study with still coarser bodies and two load cases; the second has no solid run.
fn study() -> String {
    let load_case = |name: &str, more: &str, force: u32| {
        format!(
            "[scenario.{name}]\nsteps = 3\n{more}vertical_force = {{ mean_kn = {force} }}\nlateral_force = {{ mean_kn = 5 }}\n"
        )
    };
    let coarse = coarser();
    format!("{coarse}\n{}{}", load_case("one", "", 50), load_case("two", "solid = false\n", 40))
}

/// All stages of the study.
const STAGES: [&str; 4] = ["calibration", "simple model, one", "simple model, two", "solid model, one"];

/// The condensed bodies that the calibration is made from.
const BODIES: [&str; 2] = ["wheel", "rail between its ends"];

/// That of laws against the foot.
const ON_FOOT: &str = "rail on its foot";

struct Place {
    root: tempfile::TempDir,
}

/// What a command has left and said.
struct Done {
    output: Output,
    out: PathBuf,
}

impl Place {
    fn new() -> Self {
        Self { root: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
        command.current_dir(self.root.path()).args(arguments).env("RAILSPRING_CACHE", "cache");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// `run` on a study with the store and the output folder of these names.
    fn start(&self, study: &str, store: &str, out: &str, more: &[&str]) -> Command {
        // the report has the name of the file, without its folders
        let file = format!("study of {out}/study.toml");
        std::fs::create_dir_all(self.path(&file).parent().unwrap()).unwrap();
        std::fs::write(self.path(&file), study).unwrap();
        let mut command = self.command(&["run", &file, "-o", out, "--cache", store]);
        command.args(more);
        command
    }

    fn run(&self, study: &str, store: &str, out: &str, more: &[&str]) -> Done {
        let output = self.start(study, store, out, more).output().unwrap();
        Done::new(output, self.path(out))
    }

    /// Files of a store but for the program's own test, which is no result of a study.
    fn entries(&self, store: &str) -> Vec<PathBuf> {
        let files = std::fs::read_dir(self.path(store)).into_iter().flatten().flatten();
        let own_test =
            |entry: &std::fs::DirEntry| entry.file_name().to_string_lossy().starts_with("self-test-");
        let mut files: Vec<PathBuf> =
            files.filter(|entry| !own_test(entry)).map(|entry| entry.path()).collect();
        files.sort();
        files
    }
}

impl Done {
    fn new(output: Output, out: PathBuf) -> Self {
        let done = Self { output, out };
        // 1: the coarse study does not keep all limits.
        assert!(matches!(done.output.status.code(), Some(0 | 1)), "{}", done.said());
        done
    }

    fn said(&self) -> String {
        String::from_utf8_lossy(&self.output.stderr).into_owned()
    }

    /// What says `whence`: the condensed bodies, and the stages.
    fn from(&self, whence: &str) -> [Vec<String>; 2] {
        let said = self.said();
        let names = said.lines().filter_map(|line| line.strip_suffix(&format!(": {whence}")));
        let (bodies, stages) =
            names.map(String::from).partition(|name| BODIES.contains(&name.as_str()) || name == ON_FOOT);
        [bodies, stages]
    }

    fn made(&self) -> Vec<String> {
        self.from("made")[1].clone()
    }

    fn taken(&self) -> Vec<String> {
        self.from("taken from the store")[1].clone()
    }

    /// The condensed bodies that were made and those that were taken.
    fn bodies(&self) -> [Vec<String>; 2] {
        ["made", "taken from the store"].map(|whence| self.from(whence)[0].clone())
    }

    /// Every result; of the report, which measures, the part that does not.
    fn results(&self) -> BTreeMap<String, Vec<u8>> {
        let mut found = BTreeMap::new();
        let mut folders = vec![self.out.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let name = path.strip_prefix(&self.out).unwrap().to_string_lossy().into_owned();
                if path.is_dir() {
                    folders.push(path);
                } else if name == "report.html" {
                    let page = std::fs::read_to_string(path).unwrap();
                    found.insert(name, page.split("<section id=\"measured\">").next().unwrap().into());
                } else if name != "measured.json" {
                    found.insert(name, std::fs::read(path).unwrap());
                }
            }
        }
        found
    }
}

fn same(a: &Done, b: &Done, what: &str) {
    let (a, b) = (a.results(), b.results());
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{what}");
    for (name, content) in &a {
        assert!(*content == b[name], "{what}: {name} differs");
    }
}

/// Goal: the second run, in another folder, takes every stage and leaves the same bytes, `results.json` included;
/// `--fresh` makes every stage and replaces the entries; both say so, on the terminal and in the measures.
#[test]
fn a_second_run_takes_everything() {
    let place = Place::new();
    let first = place.run(&study(), "store", "first", &[]);
    assert_eq!(first.made(), STAGES);
    assert_eq!(first.bodies()[0], BODIES);
    assert_eq!(place.entries("store").len(), BODIES.len() + STAGES.len());
    let second = place.run(&study(), "store", "second", &[]);
    assert_eq!((second.made(), second.taken()), (vec![], STAGES.map(String::from).to_vec()));
    same(&second, &first, "the second run");
    let measured = std::fs::read_to_string(second.out.join("measured.json")).unwrap();
    assert_eq!(measured.matches("\"taken\": true").count(), STAGES.len(), "{measured}");
    let page = std::fs::read_to_string(second.out.join("report.html")).unwrap();
    assert!(page.contains("calibration, taken from the store"));

    let age = SystemTime::now() - Duration::from_secs(3600);
    for entry in place.entries("store") {
        std::fs::File::options().write(true).open(entry).unwrap().set_modified(age).unwrap();
    }
    let fresh = place.run(&study(), "store", "fresh", &["--fresh"]);
    assert_eq!((fresh.made(), fresh.taken()), (STAGES.map(String::from).to_vec(), vec![]));
    assert_eq!(fresh.bodies()[0], BODIES);
    same(&fresh, &first, "the fresh run");
    let replaced = |entry: &PathBuf| entry.metadata().unwrap().modified().unwrap() > age;
    let entries = place.entries("store");
    assert!(entries.iter().all(replaced) && entries.len() == BODIES.len() + STAGES.len());
    let refused =
        place.command(&["report", "study of first/study.toml", "-o", "first", "--fresh"]).output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("--fresh = given"), "{said}");

    // Single commands share the store: calibrate takes, and so do simulate and verify in its folder.
    let alone = |command: &str| {
        let output = place
            .command(&[command, "study of first/study.toml", "-o", "alone", "--cache", "store"])
            .output();
        Done::new(output.unwrap(), place.path("alone"))
    };
    assert_eq!(alone("calibrate").taken(), ["calibration"]);
    assert_eq!(alone("simulate").taken(), ["simple model, one", "simple model, two"]);
    assert_eq!(alone("verify").taken(), ["solid model, one"]);
    alone("report");
    same(&alone("report"), &first, "single commands");
}

/// Goal: each change makes again what depends on it, condensed bodies included, takes the rest, and comes to the bytes of a run without the store.
#[test]
fn a_change_remakes_what_depends_on_it() {
    let place = Place::new();
    let base = study();
    assert_eq!(place.run(&base, "store", "base", &[]).made(), STAGES);
    let change = |from: &str, to: &str| {
        assert!(base.contains(from), "{from}");
        base.replacen(from, to, 1)
    };
    let add = |text: &str| format!("{base}\n{text}");
    let [calibration, simple_one, simple_two, solid_one] = STAGES;
    let springs = [calibration, simple_one, simple_two];
    // what was changed, stages that are made again, and bodies that are; the calibration asks for all of them, a run on the solids
    // for the two that move, unless the calibration has just had them
    let table: [(&str, String, &[&str], &[&str]); 22] = [
        ("name", change("\"coarse\"", "\"renamed\""), &[], &[]),
        ("description", format!("description = \"words\"\n{base}"), &[], &[]),
        ("limit", add("[verification]\nlaw_max = 0.5\n"), &[], &[]),
        ("snapshots", change("steps = 3\n", "steps = 3\nsnapshots_s = [0.0005]\n"), &[], &[]),
        ("load case", change("mean_kn = 50", "mean_kn = 51"), &[simple_one, solid_one], &[]),
        (
            "horizontal stiffness",
            add("[simulation]\nhorizontal_kn_per_m = 50000\n"),
            &[simple_one, simple_two],
            &[],
        ),
        ("loads", change("load_max_kn = 85", "load_max_kn = 80"), &springs, &[]),
        // the law in use stays the same
        ("foot", change("[calibration]\n", "[calibration]\nfoot_held = true\n"), &[calibration], &[ON_FOOT]),
        ("fields", add("[output]\nvertical = \"up\"\n"), &[calibration], &[]),
        ("beam elements", add("[simulation]\nrail_elements = 24\n"), &springs, &[]),
        ("damping", add("[material]\ndamping_ratio = 0.03\n"), &[simple_one, simple_two, solid_one], &[]),
        ("material of the wheel", add("[wheel.material]\nyoung_gpa = 110\n"), &STAGES, &BODIES[..1]),
        ("the same material", add("[rail.material]\nyoung_gpa = 210\n"), &[], &[]),
        ("modes", add("[solid]\nmodes = 20\n"), &[solid_one], &BODIES),
        ("full order", add("[solid]\ntransient = \"full\"\n"), &[solid_one], &[]),
        ("friction", change("friction = 0.5", "friction = 0.4"), &STAGES, &[]),
        ("shift", add("[track]\nlateral_shift_mm = 1\n"), &STAGES, &[]),
        ("mesh", change("contact_element_mm = 6", "contact_element_mm = 9"), &STAGES, &BODIES),
        ("window", change("[mesh]\n", "[mesh]\nwindow_half_length_mm = 16\n"), &STAGES, &BODIES),
        // as long as the usual one, but the contact cannot go on beyond it
        ("given window", change("[mesh]\n", "[mesh]\nwindow_half_length_mm = 12\n"), &STAGES, &BODIES),
        ("rail", change("length_m = 0.555", "length_m = 0.6"), &STAGES, &BODIES[1..]),
        ("wheel", change("tape_diameter_m = 0.858", "tape_diameter_m = 0.9"), &STAGES, &BODIES[..1]),
    ];
    for (n, (what, changed, remade, condensed)) in table.iter().enumerate() {
        // at the same time without the store, where that is not nearly the same
        let store = format!("store-{n}");
        let clean = (condensed.len() < BODIES.len())
            .then(|| place.start(changed, &store, &format!("clean-{n}"), &[]).spawn().unwrap());
        let done = place.run(changed, "store", &format!("changed-{n}"), &[]);
        let clean = clean
            .map(|child| Done::new(child.wait_with_output().unwrap(), place.path(&format!("clean-{n}"))));
        assert_eq!(done.made(), *remade, "{what}: {}", done.said());
        assert_eq!(done.made().len() + done.taken().len(), STAGES.len(), "{what}");
        let [made, taken] = done.bodies();
        let sorted = |names: &[&str]| -> Vec<String> {
            let all = BODIES.iter().chain([&ON_FOOT]);
            all.filter(|body| names.contains(body)).map(ToString::to_string).collect()
        };
        assert_eq!(made, sorted(condensed), "{what}: {}", done.said());
        let wanted = match () {
            () if condensed.contains(&ON_FOOT) => BODIES.len() + 1,
            () if remade.contains(&calibration) => BODIES.len(),
            () if remade.contains(&solid_one) && *what != "full order" => 2,
            () => 0,
        };
        assert_eq!(made.len() + taken.len(), wanted, "{what}");
        if let Some(clean) = clean {
            same(&done, &clean, what);
        }
    }
    // A load case of another name is the same load case.
    let renamed = place.run(&base.replace("scenario.two", "scenario.three"), "store", "case", &[]);
    assert_eq!(renamed.made(), Vec::<String>::new());
    assert!(renamed.out.join("history-three.csv").exists());
}

/// Goal: a calibration that has made the contact window longer hands that on when it is taken: the solid run comes to
/// the bytes of a run that makes both. Preload of 600 kN, whose contact leaves the window of 85 kN; between elements, where it cannot go
/// on beyond the window.
#[test]
fn a_longer_window_is_taken_along() {
    let longer = study()
        .replace("[calibration]\n", "[calibration]\nhorizontal_preloads_kn = [20, 600]\n")
        .replace("[contact]\n", "[contact]\nfield = \"elements\"\n");
    let place = Place::new();
    let first = place.run(&longer, "store", "first", &[]);
    assert!(first.said().contains("meshed again"), "the window was made longer: {}", first.said());
    let other = longer.replacen("mean_kn = 50", "mean_kn = 51", 1);
    let taken = place.run(&other, "store", "taken", &[]);
    assert_eq!(taken.taken(), ["calibration", "simple model, two"]);
    // nor are the longer meshes taken for a study that gives the window and ends where they would begin
    let given = longer.replace("[mesh]\n", "[mesh]\nwindow_half_length_mm = 12\n");
    let refused = place.start(&given, "store", "given", &[]).output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    let ended = said.contains("the contact reached the end of the contact window");
    assert!(refused.status.code() == Some(1) && ended && !said.contains("meshed again"), "{said}");
    same(&taken, &place.run(&other, "other-store", "made", &[]), "a solid run on longer meshes");
}

/// Goal: an entry that is cut, changed, empty or of another stage is said, removed and made again, and the run comes to
/// the same bytes; what a killed process has left beside it changes nothing.
#[test]
fn a_damaged_entry_is_made_again() {
    let place = Place::new();
    let clean = place.run(&study(), "store", "clean", &[]);
    let of_stage = |path: &PathBuf| !path.file_name().unwrap().to_string_lossy().starts_with("body-");
    let (stages, bodies): (Vec<_>, Vec<_>) = place.entries("store").into_iter().partition(of_stage);
    let read = |path: PathBuf| (path.clone(), std::fs::read(path).unwrap());
    let whole: Vec<(PathBuf, Vec<u8>)> = stages.into_iter().map(read).collect();
    type Damage = fn(&[u8]) -> Vec<u8>;
    let damage: [(&str, Damage); 4] = [
        ("cut", |bytes| bytes[..bytes.len() - 1].to_vec()),
        ("changed", |bytes| {
            let mut bytes = bytes.to_vec();
            *bytes.last_mut().unwrap() ^= 1;
            bytes
        }),
        ("empty", |_| Vec::new()),
        ("half", |bytes| bytes[..bytes.len() / 2].to_vec()),
    ];
    std::fs::write(place.path("store/.railspring-left"), "half").unwrap();
    for (n, (what, damaged)) in damage.into_iter().enumerate() {
        let (path, bytes) = &whole[n % whole.len()];
        std::fs::write(path, damaged(bytes)).unwrap();
        let again = place.run(&study(), "store", &format!("again-{n}"), &[]);
        let said = again.said();
        assert_eq!(said.matches("the entry of the store is damaged").count(), 1, "{what}: {said}");
        assert_eq!((again.made().len(), again.taken().len()), (1, STAGES.len() - 1), "{what}: {said}");
        same(&again, &clean, what);
        assert!(std::fs::read(path).unwrap() == *bytes, "{what}: the entry is as it was");
    }
    for (path, bytes) in bodies.into_iter().map(read) {
        // bodies are asked for when the calibration is made
        std::fs::remove_file(&whole[0].0).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let again = place.run(&study(), "store", "body", &[]);
        let said = again.said();
        assert_eq!(said.matches("the entry of the store is damaged").count(), 1, "{said}");
        assert_eq!(
            (again.made(), again.bodies().map(|b| b.len())),
            (vec!["calibration".into()], [1, 1]),
            "{said}"
        );
        same(&again, &clean, "a body");
        assert!(std::fs::read(path).unwrap() == bytes, "the body is as it was");
    }
    std::fs::copy(&whole[0].0, &whole[1].0).unwrap();
    let again = place.run(&study(), "store", "exchanged", &[]);
    assert!(again.said().contains("damaged (it is another artefact)"), "{}", again.said());
    same(&again, &clean, "another stage's entry");
}

/// Goal: two processes that fill one store at the same time both come to the bytes of one alone, and leave a store of
/// which everything can be taken.
#[test]
fn two_processes_share_a_store() {
    let place = Place::new();
    let clean = place.run(&study(), "alone", "clean", &[]);
    for round in 0..2 {
        let more: &[&str] = if round == 0 { &[] } else { &["--fresh"] };
        let names = ["a", "b"].map(|name| format!("{name}-{round}"));
        let running = names.clone().map(|out| place.start(&study(), "store", &out, more).spawn().unwrap());
        for (child, out) in running.into_iter().zip(&names) {
            let done = Done::new(child.wait_with_output().unwrap(), place.path(out));
            assert!(!done.said().contains("damaged"), "{}", done.said());
            same(&done, &clean, out);
        }
    }
    let later = place.run(&study(), "store", "later", &[]);
    assert_eq!(later.taken(), STAGES);
    same(&later, &clean, "after both");
}

/// Goal: `cache list` names every entry with its study and size; `cache prune` removes what it says and no other file;
/// a store that cannot be made is refused where it was asked for, and is done without where it was not.
#[test]
fn the_store_is_listed_and_pruned() {
    let place = Place::new();
    let cache = |arguments: &[&str]| {
        let output = place.command(&[&["cache"], arguments].concat()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, said) = cache(&["list"]);
    assert!(code == Some(0) && said.contains("does not exist") && !place.path("cache").exists(), "{said}");
    let file = "study.toml";
    std::fs::write(place.path(file), study()).unwrap();
    let output = place.command(&["calibrate", file, "-o", "out"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(place.entries("cache/store").len(), 3, "below RAILSPRING_CACHE");
    std::fs::write(place.path("cache/store/notes.txt"), "mine").unwrap();
    let (_, said) = cache(&["list"]);
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines[0].starts_with("calibration ") && lines[0].ends_with("coarse: calibration"), "{said}");
    assert!(lines[1..3].iter().all(|line| line.starts_with("body ")), "{said}");
    assert!(lines[3].starts_with("3 entries, ") && lines[3].ends_with("cache/store"), "{said}");
    for (arguments, left) in
        [(&["prune"][..], 3), (&["prune", "--larger-than", "100"], 3), (&["prune", "--all"], 0)]
    {
        let (code, said) = cache(arguments);
        assert!(code == Some(0) && said.contains(&format!("left {left} ")), "{arguments:?}: {said}");
    }
    assert!(place.path("cache/store/notes.txt").exists());
    for wrong in [&["prune", "--older-than", "-1"][..], &["prune", "--all", "--larger-than", "1"]] {
        assert_eq!(cache(wrong).0, Some(2), "{wrong:?}");
    }

    std::fs::write(place.path("file"), "").unwrap();
    let named = place.command(&["calibrate", file, "-o", "new", "--cache", "file/store"]).output().unwrap();
    let said = String::from_utf8_lossy(&named.stderr).into_owned();
    assert!(named.status.code() == Some(2) && said.contains("--cache = file/store"), "{said}");
    assert!(!place.path("new").exists());
    let mut unnamed = place.command(&["calibrate", file, "-o", "new"]);
    let unnamed = unnamed.env("RAILSPRING_CACHE", Path::new("file")).output().unwrap();
    let said = String::from_utf8_lossy(&unnamed.stderr).into_owned();
    assert!(unnamed.status.code() == Some(0) && said.contains("nothing is taken from the store"), "{said}");
}
