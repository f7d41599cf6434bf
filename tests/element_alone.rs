//! The contact element in foreign programs: the commands and files of `railspring element`, a host in C, user routines with mock drivers, FMPy, Exudyn.
//!
//! Source: hosts with an integration of their own (`element/c/examples`, `examples/element`), and the project's own run of the same load case, kN. A C compiler, a Fortran compiler, FMPy and Exudyn
//! are not needed to build or use the tool; without them their tests are counted as skipped.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use railspring_element::element::Element;
use railspring_testing::{Need, needs};
use tempfile::TempDir;

/// Rows of the load case: through the first impacts on the flange.
const ROWS: usize = 120;

/// Largest RMS of a difference over the largest force, with a host's own scheme and 16 steps a row. Over all
/// of load case 4.1 the scheme leaves 0.12 % of P and Q, and half of that with half of the steps. Through the
/// impacts on a coarse mesh four times as much is allowed.
const STEPS: f64 = 0.005;

/// Load case 4.1 of the publication to 60 ms, without the solid.
const CASE: &str = r#"
[scenario.pushed]
description = "Constant lateral force, vertical force with a sine on the suspended mass."
steps = 120
time_step_s = 0.0005
gravity_m_per_s2 = 0
suspended_mass_t = 6.25
vertical_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
lateral_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
vertical_force = { mean_kn = 10, amplitude_kn = 61.25, frequency_hz = 10, phase_deg = 0 }
lateral_force = { mean_kn = 20 }
rotations_held = true
solid = false
"#;

fn railspring(root: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_railspring");
    Command::new(program).current_dir(root).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat()
}

/// A wheel that rolls over three metres of rail. The rail's beams are short: they lack the deflection between their nodes.
const ROLLING: &str = r#"
[simulation]
rail_elements = 240

[scenario.rolling]
description = "Vertical force with a sine on the suspended mass, along a rail between held ends."
steps = 120
time_step_s = 0.0005
gravity_m_per_s2 = 0
suspended_mass_t = 0.775
vertical_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
lateral_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
vertical_force = { mean_kn = 60, amplitude_kn = 60, frequency_hz = 60, phase_deg = 0 }
lateral_force = { mean_kn = 0 }
rotations_held = true
speed_m_per_s = 30
start_x_m = 0.3
solid = false
"#;

/// A coarse pair with its element, the unit and the library, and the load case run on it.
fn study(length_m: &str, case: &str) -> TempDir {
    let root = tempfile::tempdir().unwrap();
    // full integration locks the disc of this mesh, whose modes then couple with the hub as no wheel's do
    let coarse = include_str!("studies/coarse.toml")
        .replace("shifts_mm = []", "shifts_mm = [0, 4, 6.5, 7]")
        .replace("full-integration", "incompatible-modes")
        .replace("length_m = 0.555", &format!("length_m = {length_m}"));
    std::fs::write(root.path().join("study.toml"), format!("{coarse}{case}")).unwrap();
    let element = "element study.toml -o pair.rse --fmu pair.fmu --c c --results out --cache store -q";
    for command in [element, "simulate study.toml -o out --cache store -q"] {
        let output = railspring(root.path(), &command.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(0), "{command}: {}", said(&output));
    }
    root
}

/// The study that most tests share, made once.
fn made() -> &'static Path {
    static MADE: OnceLock<TempDir> = OnceLock::new();
    MADE.get_or_init(|| study("0.555", CASE)).path()
}

fn sources(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// Columns with these names of the first rows of a table.
fn columns(text: &str, names: [&str; 2], factor: f64) -> [Vec<f64>; 2] {
    let mut lines = text.lines();
    let heading: Vec<&str> = lines.next().unwrap().split(',').collect();
    let places = names.map(|name| heading.iter().position(|found| *found == name).unwrap());
    let rows: Vec<Vec<f64>> = lines
        .take(ROWS + 1)
        .map(|line| line.split(',').map(|value| value.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    assert_eq!(rows.len(), ROWS + 1);
    places.map(|place| rows.iter().map(|row| factor * row[place]).collect())
}

/// P and Q of a host against the project's own run: RMS of the differences, and the largest values (N).
fn against_own_run(forces: &str, study: &Path) -> [[f64; 2]; 2] {
    let history = std::fs::read_to_string(study.join("out/history.csv")).unwrap();
    let own = columns(&history, ["p_kn", "q_kn"], 1e3);
    let found = columns(forces, ["p_n", "q_n"], 1.0);
    [0, 1].map(|i| {
        let square: f64 = found[i].iter().zip(&own[i]).map(|(a, b)| (a - b).powi(2)).sum();
        let largest = own[i].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        [(square / found[i].len() as f64).sqrt(), largest]
    })
}

/// The same, each over its largest value.
fn differences(forces: &str) -> [f64; 2] {
    against_own_run(forces, made()).map(|[difference, largest]| difference / largest)
}

/// Whether a program of the system is there; counted as skipped without it.
fn compiler(name: &str, need: Need) -> bool {
    let there = Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    needs(need, name, there)
}

/// Compiles C sources, relative to the folder of the examples, with the library into a program.
fn compiled(folder: &TempDir, name: &str, sources_of: &[&str], objects: &[&str]) -> PathBuf {
    let (library, program) = (made().join("c"), folder.path().join(name));
    let mut command = Command::new("cc");
    command.current_dir(sources("element/c/examples")).args(["-std=c99", "-O2", "-Wall", "-Werror", "-I"]);
    command.arg(&library).args(sources_of).args(objects.iter().map(|object| folder.path().join(object)));
    command.arg("-L").arg(&library).arg(format!("-Wl,-rpath,{}", library.display()));
    command.args(["-lrailspring_c", "-lm", "-lpthread"]);
    if !objects.is_empty() {
        command.arg("-lgfortran");
    }
    let output = command.arg("-o").arg(&program).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    program
}

/// A program that takes the library which was handed out: cargo's variable would lead it to one in the target folder.
fn host(program: &Path) -> Command {
    let mut command = Command::new(program);
    command.env_remove("LD_LIBRARY_PATH");
    command
}

/// Runs a program on the element file; its standard output.
fn run(program: &Path, arguments: &[&str]) -> String {
    let element = made().join("pair.rse");
    let output = host(program).args(arguments).env("RAILSPRING_ELEMENT", element).output().unwrap();
    assert!(output.status.success(), "{} {arguments:?}: {}", program.display(), said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Goal: the host in C with Newmark's scheme of its own has the forces of the project's own run (kN). Accuracy: STEPS.
#[test]
fn a_host_in_c_runs_the_load_case() {
    if !compiler("cc", Need::Compiler) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let program = compiled(&folder, "newmark", &["newmark.c"], &[]);
    let [p, q] = differences(&run(&program, &[made().join("pair.rse").to_str().unwrap(), "16"]));
    println!("P {p:.5}, Q {q:.5}");
    assert!(p < STEPS && q < STEPS, "{p} {q}");
}

/// Goal: the conformance program writes 200 states with forces and tangents and finds them again; wrong input returns codes, clones, restored states and two threads have the same bytes. Exact, but for the vectors, which it
/// compares to nine digits.
#[test]
fn the_c_interface_conforms() {
    if !compiler("cc", Need::Compiler) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let sources = ["", "_vectors", "_errors", "_motions", "_checks", "_threads"];
    let sources = sources.map(|part| format!("conformance{part}.c"));
    let program = compiled(&folder, "conformance", &sources.each_ref().map(String::as_str), &[]);
    let element = made().join("pair.rse");
    let element = element.to_str().unwrap();
    let vectors = run(&program, &["--write", element]);
    let file = folder.path().join("vectors.json");
    std::fs::write(&file, &vectors).unwrap();
    println!("{}", run(&program, &[element, file.to_str().unwrap()]));
    let all: Vec<Vec<serde_json::Value>> = serde_json::from_str(&vectors).unwrap();
    let states = all.iter().filter(|vector| [50, 24].contains(&vector.len())).count();
    assert_eq!(states, 200);
    // a vector that is not the element's is found
    let end = vectors.rfind("],\n[\"end\"]").unwrap();
    let last = vectors[..end].rfind(',').unwrap();
    std::fs::write(&file, format!("{},1e3{}", &vectors[..last], &vectors[end..])).unwrap();
    let output = host(&program).args([element, file.to_str().unwrap()]).output().unwrap();
    assert!(!output.status.success(), "{}", said(&output));
}

/// Goal: the samples for Simpack, GENSYS and Abaqus give under their mock drivers, whose steps are given up and repeated, the forces of direct calls: what each driver checks itself.
#[test]
fn user_routines_run_under_mock_drivers() {
    if !compiler("cc", Need::Compiler) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for name in ["simpack_user_force", "gensys_user"] {
        let files = [format!("user_routines/{name}_driver.c"), format!("user_routines/{name}.c")];
        let program = compiled(&folder, name, &files.each_ref().map(String::as_str), &[]);
        println!("{}", run(&program, &[]));
    }
    if !compiler("gfortran", Need::Fortran) {
        return;
    }
    let object = folder.path().join("abaqus_uel.o");
    let routine = sources("element/c/examples/user_routines/abaqus_uel.f");
    let mut fortran = Command::new("gfortran");
    // it leaves its modules where it runs
    fortran.current_dir(folder.path());
    let output = fortran.arg("-O2").arg("-c").arg(routine).arg("-o").arg(object).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let driver = ["user_routines/abaqus_uel_driver.c"];
    println!("{}", run(&compiled(&folder, "uel", &driver, &["abaqus_uel.o"]), &[]));
}

/// Runs an example in Python on element file and unit in an empty folder; the forces that it leaves.
fn example(interpreter: &Path, name: &str, arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    run_example(interpreter, name, arguments, made(), folder.path());
    std::fs::read_to_string(folder.path().join("forces.csv")).unwrap()
}

/// The same with the element of a study in a folder.
fn run_example(interpreter: &Path, name: &str, arguments: &[&str], study: &Path, folder: &Path) {
    let script = sources("examples/element").join(name);
    let library = std::fs::read_dir(study.join("c"))
        .unwrap()
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|end| end != "h"))
        .unwrap();
    let mut command = Command::new(interpreter);
    command.current_dir(folder).arg("-B").arg(script).arg(study.join("pair.rse")).args(arguments);
    let output = command.env("RAILSPRING_LIBRARY", library).output().unwrap();
    assert!(output.status.success(), "{name}: {}", said(&output));
    println!("{}", said(&output));
}

/// Source: FMPy's validation against the standard, and FMPy as master. Goal: it finds no fault. It simulates
/// the unit for co-simulation and for model exchange. Hub and rail of a master in Python have the forces of
/// the project's own run (kN). A state that is set back repeats its step. Directional derivatives agree with
/// differences; `fmpy_check.py` has the limit. Accuracy: STEPS.
#[test]
fn fmpy_runs_the_unit() {
    let Some(interpreter) = railspring_testing::fmpy(Path::new(env!("CARGO_TARGET_TMPDIR"))) else {
        return;
    };
    let unit = made().join("pair.fmu");
    let check = "import sys\nfrom fmpy import simulate_fmu\nfrom fmpy.validation import validate_fmu\n\
                 problems = validate_fmu(sys.argv[1])\nassert not problems, problems\n\
                 for kind in ('CoSimulation', 'ModelExchange'):\n    \
                 rows = simulate_fmu(sys.argv[1], fmi_type=kind, stop_time=0.001, start_values={'hub.z': 5e-5})\n    \
                 assert len(rows) > 2 and rows['rim.fz'][-1] < -1e3, (kind, rows)\n";
    let output = Command::new(&interpreter).args(["-c", check]).arg(&unit).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let [p, q] = differences(&example(&interpreter, "fmpy_master.py", &[unit.to_str().unwrap(), "16"]));
    println!("P {p:.5}, Q {q:.5}");
    assert!(p < STEPS && q < STEPS, "{p} {q}");
    // a state that is set back, and directional derivatives: it fails by itself
    run_example(&interpreter, "fmpy_check.py", &[unit.to_str().unwrap()], made(), made());
}

/// Source: Exudyn's implicit integration with the contact called live. Goal: the forces of the project's own run (kN). Accuracy: STEPS.
#[test]
fn exudyn_calls_the_contact() {
    let Some(interpreter) = railspring_testing::exudyn(Path::new(env!("CARGO_TARGET_TMPDIR"))) else {
        return;
    };
    let [p, q] = differences(&example(&interpreter, "exudyn_live.py", &["contact", "16"]));
    println!("P {p:.5}, Q {q:.5}");
    assert!(p < STEPS && q < STEPS, "{p} {q}");
}

/// Source: equilibrium and symmetry. Goal: in the example of a wheelset on two rails, which a force pushes across the track, left and right are mirror images before the push; the contacts carry the push while it grows, and
/// the weight at the end (N). Accuracy: SYMMETRY, between an element and its mirror image, whose strips are looked up on the other side; MASS, what the accelerations of the bodies take of the forces.
#[test]
fn a_wheelset_stands_in_exudyn() {
    const SYMMETRY: f64 = 1e-3;
    const MASS: f64 = 0.02;
    let Some(interpreter) = railspring_testing::exudyn(Path::new(env!("CARGO_TARGET_TMPDIR"))) else {
        return;
    };
    let forces = example(&interpreter, "exudyn_wheelset.py", &[]);
    let rows: Vec<Vec<f64>> = forces
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|value| value.parse().unwrap()).collect())
        .collect();
    // time_s,p_n,q_n,contacts,left_p_n,left_q_n,left_contacts,push_n,y_m,turn_rad
    let at = |time: f64| rows.iter().find(|row| row[0] >= time - 1e-9).unwrap();
    let before = at(0.49);
    assert!((before[1] - before[4]).abs() < SYMMETRY * before[1], "{before:?}");
    assert!((before[2] - before[5]).abs() < SYMMETRY * before[1], "{before:?}");
    let element = Element::open(&made().join("pair.rse")).unwrap();
    // axle, suspended mass and two wheels, as the example has them
    let weight = 9.81 * (500.0 + 12_500.0 + 2.0 * element.wheel.mass[(1, 1)]);
    let last = rows.last().unwrap();
    assert!((last[1] + last[4] - weight).abs() < MASS * weight, "{last:?}, {weight}");
    for time in [0.6, 0.7] {
        let row = at(time);
        assert!((row[2] - row[5] - row[7]).abs() < MASS * weight && row[7] > 1e4, "{row:?}");
    }
}

/// Source: the beams of STEM and their integration by Kratos. Goal: a wheel whose contact STEM calls live has the forces of the project's own run (kN). Accuracy: STEPS, as that of the other hosts.
#[test]
#[ignore = "two minutes, and packages of 750 MB: cargo long stem_calls"]
fn stem_calls_the_contact() {
    let Some(interpreter) = railspring_testing::stem_with_kratos(Path::new(env!("CARGO_TARGET_TMPDIR")))
    else {
        return;
    };
    let rows = ROWS.to_string();
    let [p, q] = differences(&example(&interpreter, "stem_wheel.py", &["16", &rows]));
    println!("P {p:.5}, Q {q:.5}");
    assert!(p < STEPS && q < STEPS, "{p} {q}");
}

/// Source: the same. Goal: a wheel that rolls over STEM's beams has the forces of the project's own run, N. Accuracy: STEPS of the largest P, for Q as well: STEM's vehicles put no moment on a rail, and Q is a fiftieth of P.
#[test]
#[ignore = "three minutes, and packages of 750 MB: cargo long stem_rolls"]
fn stem_rolls_a_wheel() {
    let Some(interpreter) = railspring_testing::stem_with_kratos(Path::new(env!("CARGO_TARGET_TMPDIR")))
    else {
        return;
    };
    let study = study("3", ROLLING);
    let rows = ROWS.to_string();
    run_example(&interpreter, "stem_track.py", &["held", "16", &rows], study.path(), study.path());
    let forces = std::fs::read_to_string(study.path().join("forces.csv")).unwrap();
    let [[p, largest], [q, _]] = against_own_run(&forces, study.path());
    println!("P {p:.0} N, Q {q:.0} N of {largest:.0} N");
    assert!(largest > 60e3 && p < STEPS * largest && q < STEPS * largest, "{p} {q} {largest}");
}

/// Goal: the same element gives the same bytes; what the file says of itself is of this study; without a load case and with the lumped element there is a file as well.
#[test]
fn the_same_study_gives_the_same_file() {
    let root = made();
    let command = "element study.toml -o again.rse --fmu again.fmu --results out --cache store -q";
    let output = railspring(root, &command.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    for (one, other) in [("pair.rse", "again.rse"), ("pair.fmu", "again.fmu")] {
        assert!(std::fs::read(root.join(one)).unwrap() == std::fs::read(root.join(other)).unwrap(), "{one}");
    }
    let element = Element::open(&root.join("pair.rse")).unwrap();
    assert_eq!((element.about.study.as_str(), element.about.element.as_str()), ("coarse", "condensed"));
    assert!(element.about.largest_force_n > 50e3 && element.rail_at_wheel.is_some());
    let command = "element study.toml -o lumped.rse --element lumped --results out --cache store -q";
    let output = railspring(root, &command.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert_eq!(Element::open(&root.join("lumped.rse")).unwrap().about.element, "lumped");
}

/// Goal: what cannot be written is refused with the option or key, the value and a remedy, and what was there stays.
#[test]
fn impossible_elements_are_refused() {
    let root = made();
    let before = std::fs::read(root.join("pair.rse")).unwrap();
    let refused = |arguments: &str| {
        let all = format!("element study.toml --results out --cache store -q {arguments}");
        let output = railspring(root, &all.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", said(&output));
        said(&output)
    };
    let message = refused("-o pair.rse --set calibration.elements=false");
    assert!(message.contains("calibration.elements") && message.contains("leave it out"), "{message}");
    let message = refused("-o pair.rse --set calibration.shifts_mm=[]");
    assert!(message.contains("calibration.shifts_mm"), "{message}");
    let message = refused("-o out");
    assert!(message.contains("-o") && message.contains("not a folder"), "{message}");
    assert!(std::fs::read(root.join("pair.rse")).unwrap() == before);
}

/// Goal: `railspring.h` declares what the library has: every function with its number of arguments, as cbindgen finds them.
#[test]
fn the_header_is_that_of_the_library() {
    let text = |name: &str| std::fs::read_to_string(sources("element/c").join(name)).unwrap();
    let header = text("include/railspring.h");
    let sources =
        ["guard", "element", "contact", "unit"].map(|name| text(&format!("src/{name}.rs"))).concat();
    let mut count = 0;
    for function in sources.split("extern \"C\" fn ").skip(1) {
        let (name, rest) = function.split_once('(').unwrap();
        let arguments = rest.split_once(") ").unwrap().0.matches(": ").count();
        let declared = header.split(&format!("{name}(")).nth(1).unwrap_or_else(|| panic!("no {name}"));
        let declared = declared.split_once(')').unwrap().0;
        let there = if declared.trim() == "void" { 0 } else { declared.matches(',').count() + 1 };
        assert_eq!(there, arguments, "{name}");
        count += 1;
    }
    assert!(count > 20, "{count}");
}
