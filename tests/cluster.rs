//! Tables made by a Dask cluster: `railspring table --executor dask`.
//!
//! Goal: whatever workers do, a table comes to the bytes of one that was made on one machine; what a cluster cannot do is an error with its
//! reason. Source: the same table without a cluster, equal to the byte. The cluster is a real one: scheduler and workers as processes of this
//! machine, over TCP. Needs Python 3.11 or newer, and the package index on the first run: the environment is made under `target/` from the
//! lock file of `cluster/`.
#![cfg(unix)]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use crate::tables::{Place, hollow_wheels};
use railspring::python::Python;
use railspring_profiles::monitor::Silent;
use serde_json::{Value, json};

/// A measured wheel and a file that is no profile on two rails at two shifts.
const TABLE: &str = "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0, 2]\nstiffness_at_kn = [20, 60]\n\
    [[wheel]]\nname = \"worn\"\nprofile_file = \"worn.whl\"\nstandard = \"S1002\"\n\
    [[rail]]\nprofile = \"60E1\"\n[[rail]]\nprofile = \"54E1\"\ninclination = \"1:20\"\n";

/// Where the environment is made.
fn cache() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
}

/// One environment for all tests of this file.
fn python() -> Option<&'static Path> {
    static PYTHON: OnceLock<Python> = OnceLock::new();
    static MAKING: Mutex<()> = Mutex::new(());
    if !railspring_testing::python() {
        return None;
    }
    let _one = MAKING.lock().unwrap();
    let made = || Python::for_cluster(None, &cache(), &Silent).unwrap_or_else(|error| panic!("{error}"));
    Some(PYTHON.get_or_init(made).interpreter())
}

/// Ends with its value.
struct Process(Child);

impl Process {
    /// Stops it at once, as a lost machine does.
    fn kill(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// A scheduler and its workers.
struct DaskCluster {
    folder: tempfile::TempDir,
    python: &'static Path,
    scheduler: Process,
    address: String,
    workers: Vec<Worker>,
    /// Workers that were begun.
    begun: usize,
}

/// A worker and the folder that it has to itself.
struct Worker {
    process: Process,
    folder: PathBuf,
}

impl DaskCluster {
    fn new(python: &'static Path, workers: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scheduler.json");
        let arguments =
            ["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file"];
        let scheduler = dask(python, folder.path(), &arguments, &file);
        let deadline = Instant::now() + Duration::from_secs(60);
        let address = loop {
            assert!(Instant::now() < deadline, "no scheduler");
            let said = std::fs::read(&file).ok().and_then(|text| serde_json::from_slice::<Value>(&text).ok());
            match said {
                Some(said) => break said["address"].as_str().unwrap().to_owned(),
                None => std::thread::sleep(Duration::from_millis(50)),
            }
        };
        let mut cluster = Self { folder, python, scheduler, address, workers: Vec::new(), begun: 0 };
        (0..workers).for_each(|_| cluster.begin_worker());
        cluster
    }

    fn begin_worker(&mut self) {
        let Self { folder, python, address, workers, begun, .. } = self;
        let arguments =
            ["worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory"];
        let own = folder.path().join("workers").join(begun.to_string());
        workers.push(Worker { process: dask(python, folder.path(), &arguments, &own), folder: own });
        *begun += 1;
    }

    /// Entries of a kind in the stores of the workers.
    fn entries(&self, kind: &str) -> usize {
        entries(&self.folder.path().join("workers"), kind)
    }
}

/// Entries of a kind in a folder and those below.
fn entries(folder: &Path, kind: &str) -> usize {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    files
        .map(|file| match file.path() {
            path if path.is_dir() => entries(&path, kind),
            path => usize::from(path.file_name().unwrap().to_string_lossy().starts_with(kind)),
        })
        .sum()
}

fn dask(python: &Path, folder: &Path, arguments: &[&str], last: &Path) -> Process {
    let said = std::fs::File::options().create(true).append(true).open(folder.join("said.log")).unwrap();
    let mut command = Command::new(python.with_file_name("dask"));
    command.args(arguments).arg(last).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null());
    Process(command.stderr(said).spawn().unwrap())
}

impl Place {
    /// The table into a folder, with a store of the folder's name.
    fn table_command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
        command.current_dir(self.0.path()).args(["table", "table.toml", "-o", out, "--cache"]);
        command.arg(format!("store-{out}")).args(more).env("RAILSPRING_CACHE", cache());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn on(&self, cluster: &DaskCluster, out: &str, more: &[&str]) -> Command {
        self.table_command(out, &[&["--executor", "dask", "--scheduler", &cluster.address], more].concat())
    }
}

fn done(command: Child, code: i32) -> String {
    let output = command.wait_with_output().unwrap();
    let said =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert_eq!(output.status.code(), Some(code), "{said}");
    said
}

/// Goal: with artefacts through the scheduler, a worker killed as soon as a body is condensed, and a file that is no profile, the table has
/// the bytes of one without a cluster; with the store shared nothing that is there is made again.
#[test]
#[ignore = "a minute: cargo long cluster"]
fn a_cluster_that_loses_a_worker_comes_to_the_same_bytes() {
    let Some(python) = python() else { return };
    let place = Place::new(&TABLE.replace(
        "[[rail]]\nprofile = \"60E1\"",
        "[[wheel]]\nname = \"notes\"\nprofile_file = \"notes.whl\"\nstandard = \"S1002\"\n[[rail]]\nprofile = \"60E1\"",
    ));
    place.write("notes.whl", "the wheels of the third of May\n");
    let mut cluster = DaskCluster::new(python, 3);
    let alone = place.table_command("alone", &[]).spawn().unwrap();
    let mut running = place.on(&cluster, "sent", &["--worker-cache", "stored"]).spawn().unwrap();
    while cluster.entries("body-") == 0 {
        assert!(running.try_wait().unwrap().is_none(), "{}", done(running, 1));
        std::thread::sleep(Duration::from_millis(20));
    }
    cluster.workers[0].process.kill();
    assert!(running.try_wait().unwrap().is_none(), "the worker was lost too late");
    let said = done(running, 1);
    assert!(said.contains("4 places by the cluster in "), "{said}");
    assert!(
        said.contains("notes on 60E1: no worker makes it: ")
            && said.contains("4 places are made on this machine"),
        "{said}"
    );
    done(alone, 1);
    assert!(place.files("sent") == place.files("alone"));
    let bodies = |store: &str| {
        let files = std::fs::read_dir(place.path(store)).unwrap().flatten();
        files.filter(|file| file.file_name().to_string_lossy().starts_with("body-")).count()
    };
    // a wheel and two rails stay with the workers
    assert_eq!((bodies("store-sent"), bodies("store-alone")), (0, 3));

    place.write(
        "table.toml",
        &std::fs::read_to_string(place.path("table.toml")).unwrap().replace("[0, 2]", "[0, 1]"),
    );
    let shared = place.on(&cluster, "alone", &[]).spawn().unwrap();
    let said = done(shared, 1);
    assert!(
        said.contains("2 of them in the store") && said.contains("2 places by the cluster in "),
        "{said}"
    );
    let seen = cluster.entries("place-");
    let local = place.table_command("sent", &[]).spawn().unwrap();
    done(local, 1);
    assert!(place.files("sent") == place.files("alone"));
    assert_eq!(cluster.entries("place-"), seen, "workers that share the store have none themselves");
}

/// Goal: the wheels of a folder go to the workers in packages, on bodies that are condensed once. A worker is
/// killed, and one file is no profile. The table has the bytes of one without a cluster, and the file is a
/// row with its reason. Source: the worn wheel with hollows, to 3 mm.
#[test]
#[ignore = "two minutes: cargo long cluster"]
fn a_folder_goes_to_a_cluster_in_packages() {
    const WHEELS: usize = 70;
    let Some(python) = python() else { return };
    let place = Place::new(
        "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0]\nstiffness_at_kn = [20]\n\
         [study.calibration]\nerror_band = false\n[[wheel]]\nfolder = \"measured\"\nstandard = \"S1002\"\n\
         [[rail]]\nprofile = \"60E1\"\n",
    );
    hollow_wheels(&place.path("measured"), WHEELS);
    place.write("measured/03.whl", "the wheels of the third of May\n");
    let mut cluster = DaskCluster::new(python, 2);
    let mut running = place.on(&cluster, "sent", &["--worker-cache", "stored"]).spawn().unwrap();
    while cluster.entries("place-") < 8 {
        assert!(running.try_wait().unwrap().is_none(), "{}", done(running, 1));
        std::thread::sleep(Duration::from_millis(20));
    }
    cluster.workers[0].process.kill();
    assert!(running.try_wait().unwrap().is_none(), "the worker was lost too late");
    let said = done(running, 1);
    assert!(said.contains("69 places by the cluster in ") && said.contains(" 1 workers lost"), "{said}");
    assert!(said.contains("03 on 60E1: no worker makes it: "), "{said}");
    done(place.table_command("alone", &[]).spawn().unwrap(), 1);
    assert!(place.files("sent") == place.files("alone"));
    // the worker that is left has those of one wheel and one rail
    assert!(cluster.entries("body-") <= 4, "{} bodies", cluster.entries("body-"));
}

/// Goal: a worker that is stopped while it has a body, whose connections stay, is lost after the given time.
/// Others make what it had and what it did, the table has the bytes of one without a cluster, and the loss is
/// reported. Accuracy: the time is 2 s. Heartbeats come every half second, of which ten are waited for: 5 s,
/// and a look every 5 s. Without that the scheduler waits for 300 s.
#[test]
#[ignore = "a minute: cargo long cluster"]
fn a_worker_that_hangs_is_lost() {
    let Some(python) = python() else { return };
    let place = Place::new(TABLE);
    let cluster = DaskCluster::new(python, 2);
    let alone = place.table_command("alone", &[]).spawn().unwrap();
    let more = ["--worker-cache", "stored", "--worker-silence", "2"];
    let mut running = place.on(&cluster, "sent", &more).spawn().unwrap();
    let stopped = Stopped::first(&mut running, &cluster);
    let begun = Instant::now();
    let said = done(running, 0);
    assert!(begun.elapsed() < Duration::from_secs(60), "{said}");
    assert!(said.contains(": nothing heard for 2 s or more: its steps go to other workers"), "{said}");
    assert!(said.contains("4 places by the cluster in ") && said.contains(" 1 workers lost"), "{said}");
    done(alone, 0);
    assert!(place.files("sent") == place.files("alone"));
    drop(stopped);
}

/// A process that is stopped, and goes on with the value's end.
struct Stopped(u32);

impl Stopped {
    /// The worker that has condensed a body first.
    fn first(running: &mut Child, cluster: &DaskCluster) -> Self {
        let worker = loop {
            assert!(running.try_wait().unwrap().is_none(), "the table has ended");
            let has_body = |worker: &&Worker| entries(&worker.folder, "body-") > 0;
            if let Some(worker) = cluster.workers.iter().find(has_body) {
                break worker;
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        let id = worker.process.0.id();
        signal("STOP", id);
        Self(id)
    }
}

impl Drop for Stopped {
    fn drop(&mut self) {
        signal("CONT", self.0);
    }
}

fn signal(name: &str, process: u32) {
    let done = Command::new("kill").args(["-s", name, &process.to_string()]).status();
    assert!(done.is_ok_and(|status| status.success()), "{name}");
}

/// Goal: a cluster without a scheduler, and one whose workers have another program, are errors that say so, and nothing is written.
#[test]
#[ignore = "a minute: cargo long cluster"]
fn a_cluster_that_cannot_is_an_error() {
    let Some(python) = python() else { return };
    let place = Place::new(TABLE);
    let cluster = DaskCluster::new(python, 1);
    let script = "#!/bin/sh\necho '{\"program\": \"0123456789abcdef\", \"version\": \"0.0.1\"}'\n";
    place.write("other", script);
    let other = place.path("other");
    std::fs::set_permissions(&other, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let said =
        done(place.on(&cluster, "out", &["--worker-program", other.to_str().unwrap()]).spawn().unwrap(), 2);
    let expected = "none of 1 workers has this program: ";
    assert!(
        said.contains(expected) && said.contains("is another build (version 0.0.1, 0123456789ab; wanted "),
        "{said}"
    );
    let more = ["--executor", "dask", "--scheduler", "tcp://127.0.0.1:9"];
    let said = done(place.table_command("out", &more).spawn().unwrap(), 2);
    assert!(said.contains("--scheduler = tcp://127.0.0.1:9 ("), "{said}");
    let said = done(place.table_command("out", &["--scheduler", "tcp://127.0.0.1:9"]).spawn().unwrap(), 2);
    assert!(said.contains("no scheduler for --executor local"), "{said}");
    assert!(!place.path("out").exists());
}

/// Runs a module of the package from its source on standard input.
fn module(python: &Path, name: &str, input: &str) -> Child {
    let mut command = Command::new(python);
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("cluster/src");
    command.args(["-B", "-m", name]).env("PYTHONPATH", source).stdin(Stdio::piped());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_owned();
    std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    child
}

/// What the model says of each run.
fn modelled(python: &Path, costs: &Value) -> Vec<Value> {
    let said = done(module(python, "railspring_cluster.model", &costs.to_string()), 0);
    said.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("{said}"))).collect()
}

/// Goal: the simulated cluster has the limits that follow from its costs: few workers are the limit themselves, and with many the client, the
/// scheduler or the store is, whichever takes longest for a case. Source: W / (prepare + read + places·place) and 1 / (seconds of the
/// slowest server for a package). Accuracy: the last steps of a table, when workers run out of work: 5 % of 400 cases.
#[test]
fn the_model_has_its_limits() {
    const ENDS: f64 = 0.05;
    let Some(python) = python() else { return };
    let costs = |client: f64, scheduler: f64, store: f64, workers: usize| {
        json!({ "prepare": 1.0, "place": 1.0, "read": 1.0, "client": client, "scheduler": scheduler, "store": store, "places": 8,
                "runs": [[workers, 400]] })
    };
    // a prepare and a press step for a case of eight places
    for (costs, expected) in [
        (costs(0.001, 0.001, 0.001, 1), 8.0 / 10.0),
        (costs(0.001, 0.001, 0.001, 4), 4.0 * 8.0 / 10.0),
        (costs(0.5, 0.1, 0.01, 200), 8.0 / (2.0 * 0.5)),
        (costs(0.1, 0.5, 0.01, 200), 8.0 / (2.0 * 0.5)),
        (costs(0.01, 0.01, 0.5, 200), 8.0 / (8.0 * 0.5)),
    ] {
        let found = modelled(python, &costs)[0]["places_per_second"].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < ENDS, "{costs}: {found}, expected {expected}");
    }
}

/// Processor time of a process, s.
fn processor_seconds(process: u32) -> f64 {
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    let fields: Vec<&str> = text.rsplit(')').next().unwrap().split_whitespace().collect();
    // user and system time in ticks of 10 ms
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}

/// Goal: a table on a cluster that loses workers is the same. A worker is killed every 20 s and another one
/// begun, and the table has the bytes of one without a cluster. Measured are places a second with one to
/// three workers, and what a step costs client and scheduler. With that, simulated are clusters of up to
/// 1,000 workers and 1,000,000 cases. The numbers are printed, and stand in docs/dask.md.
#[test]
#[ignore = "ten minutes: cargo long cluster"]
fn trial() {
    let Some(python) = python() else { return };
    let table = TABLE.replace("[0, 2]", "[-3, -2, -1, 0, 1, 2, 3, 4, 5]").replace(
        "[[rail]]\nprofile = \"60E1\"",
        "tape_diameter_m = [0.8, 0.81, 0.82, 0.83, 0.84, 0.85, 0.86, 0.87, 0.88, 0.89, 0.9, 0.91]\n[[rail]]\nprofile = \"60E1\"",
    );
    let place = Place::new(&table);
    let begun = Instant::now();
    done(place.table_command("alone", &["--threads", "1"]).spawn().unwrap(), 0);
    println!("one thread without a cluster: {:.1} s", begun.elapsed().as_secs_f64());
    for workers in 1..=3 {
        let cluster = DaskCluster::new(python, workers);
        let out = format!("with-{workers}");
        let said = done(place.on(&cluster, &out, &["--worker-cache", "stored"]).spawn().unwrap(), 0);
        println!("{workers} workers: {}", said.lines().find(|line| line.contains("by the cluster")).unwrap());
        assert!(place.files(&out) == place.files("alone"));
    }
    // all workers share two cores with scheduler and client: three take longer for each step
    let mut cluster = DaskCluster::new(python, 3);
    let mut running = place.on(&cluster, "killed", &["--worker-cache", "stored"]).spawn().unwrap();
    let (mut kills, mut last) = (0, Instant::now());
    while running.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(200));
        if last.elapsed() > Duration::from_secs(20) {
            let mut lost = cluster.workers.remove(0);
            lost.process.kill();
            cluster.begin_worker();
            (kills, last) = (kills + 1, Instant::now());
        }
    }
    let said = done(running, 0);
    println!(
        "{kills} workers killed: {}",
        said.lines().find(|line| line.contains("by the cluster")).unwrap()
    );
    assert!(said.contains("216 places by the cluster"), "{said}");
    assert!(kills >= 2 && place.files("killed") == place.files("alone"));
    drop(cluster);
    simulated(python, &place);
}

/// Measures what a step costs client and scheduler with a program that does nothing, and simulates large clusters with that.
fn simulated(python: &'static Path, place: &Place) {
    const CASES: usize = 1500;
    const PLACES: usize = 9;
    let cluster = DaskCluster::new(python, 2);
    let names: Vec<String> = (0..PLACES).map(|n| format!("place-{n:064x}.artefact")).collect();
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    // one place takes 6 kB
    place.write("nothing", &format!(
        "#!/bin/sh\n[ \"$2\" = --check ] && {{ echo '{{\"program\": \"none\", \"version\": \"0\"}}'; exit; }}\n\
         task=$(cat)\nmkdir -p \"$3\"\ncase \"$task\" in *'\"prepare\"'*) touch \"$3/{prepared}\"; echo '{{\"refused\": [], \"bodies\": [], \"entries\": [\"{prepared}\"]}}';;\n\
         *) [ -f \"$3/{last}\" ] || for name in {all}; do head -c 6000 /dev/zero > \"$3/$name\"; done\n\
         echo '{{\"refused\": [], \"bodies\": [], \"entries\": [{quoted}]}}';; esac\n",
        prepared = format!("prepared-{:064x}.artefact", 0), last = names[PLACES - 1], all = names.join(" "), quoted = quoted.join(", "),
    ));
    std::fs::set_permissions(place.path("nothing"), std::os::unix::fs::PermissionsExt::from_mode(0o755))
        .unwrap();
    let store = place.path("store-nothing");
    std::fs::create_dir(&store).unwrap();
    let settings = json!({
        "scheduler": cluster.address, "places": CASES * PLACES, "table": "nothing", "program": "none", "version": "0",
        "programs": [place.path("nothing")], "store": store, "token": "x", "cache": "stored", "threads": 1, "memory_limit_gib": 1.0,
        "fresh": false, "silence": 30.0,
    });
    let case = |n: usize| json!({ "cases": [n], "name": "wheel on rail", "shifts_mm": [vec![0.0; PLACES]], "package": { "keys": "k".repeat(8000) } });
    let lines: Vec<String> =
        std::iter::once(settings).chain((0..CASES).map(case)).map(|line| line.to_string()).collect();
    let before = processor_seconds(cluster.scheduler.0.id());
    let client = module(python, "railspring_cluster", &(lines.join("\n") + "\n"));
    let id = client.id();
    let client_seconds = std::thread::spawn(move || {
        let mut last = 0.0;
        while Path::new(&format!("/proc/{id}/stat")).exists() {
            let found = std::panic::catch_unwind(|| processor_seconds(id)).unwrap_or(last);
            last = found.max(last);
            std::thread::sleep(Duration::from_millis(100));
            if std::fs::read_to_string(format!("/proc/{id}/stat")).is_ok_and(|text| text.contains(") Z ")) {
                break;
            }
        }
        last
    });
    let said = done(client, 0);
    let client_seconds = client_seconds.join().unwrap();
    let scheduler_seconds = processor_seconds(cluster.scheduler.0.id()) - before;
    let ended: Value =
        serde_json::from_str(said.lines().find(|line| line.contains("\"ended\"")).unwrap()).unwrap();
    assert_eq!(ended["places"], CASES * PLACES, "{ended}");
    let steps = 2.0 * CASES as f64;
    // all cases have the same entries, which the client has written once: the store by itself
    let begun = Instant::now();
    for n in 0..2000 {
        let file = store.join(format!(".railspring-{n}"));
        std::fs::write(&file, vec![0; 6000]).unwrap();
        std::fs::rename(&file, store.join(format!("{n}"))).unwrap();
    }
    let entry = begun.elapsed().as_secs_f64() / 2000.0;
    let costs = json!({
        "prepare": 1.4, "place": 1.0, "read": 0.7, "client": client_seconds / steps, "scheduler": scheduler_seconds / steps,
        "store": entry, "places": PLACES,
        "runs": [[1, 20], [10, 500], [100, 10_000], [300, 30_000], [1000, 100_000], [1000, 1_000_000], [3000, 100_000], [10_000, 200_000]],
    });
    println!(
        "a step: client {:.2} ms, scheduler {:.2} ms; an entry {:.3} ms",
        1e3 * client_seconds / steps,
        1e3 * scheduler_seconds / steps,
        1e3 * entry
    );
    for run in modelled(python, &costs) {
        println!("{run}");
    }
}
