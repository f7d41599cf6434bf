//! The Python package of `python/`: built, checked and tried as a user has it.
//!
//! Goal: the module builds for the Python at hand, its types hold (mypy, strict), its tests pass with this program, and the notebook with the figures of the README
//! runs to its end and leaves them. Source: `python/tests`, `python/notebooks`. Needs Python 3.11 or newer, the package index, and crates.io on the first
//! run; it compiles the library once more for Python, so that it is no part of the usual tests: `cargo long python_package`, five minutes.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs a program in `python/`, which succeeds.
fn done(program: &Path, arguments: &[&str], variables: &[(&str, &Path)]) -> String {
    let mut command = Command::new(program);
    command.current_dir(folder()).args(arguments).envs(variables.iter().copied());
    let output = command.output().unwrap_or_else(|cause| panic!("{}: {cause}", program.display()));
    let said =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert!(output.status.success(), "{} {arguments:?}: {said}", program.display());
    said
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("python")
}

/// Goal: the versions and the stubs of the package are those of the program and of the module.
#[test]
fn the_package_goes_with_the_program() {
    let text =
        |name: &str| std::fs::read_to_string(folder().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let manifest = text("Cargo.toml");
    let version = format!("\nversion = \"{}\"\n", env!("CARGO_PKG_VERSION"));
    assert!(manifest.contains(&version), "{manifest}");
    let stubs = text("src/railspring/_native.pyi");
    let module = [text("src/lib.rs"), text("src/element.rs")].concat();
    let lists =
        module.split("use super::").skip(1).filter_map(|rest| rest.split_once('{')?.1.split_once('}'));
    let exported: Vec<&str> = lists.flat_map(|(names, _)| names.split(',')).map(str::trim).collect();
    assert!(exported.len() > 6, "{exported:?}");
    for name in exported {
        let stub = [format!("class {name}:"), format!("def {name}(")];
        assert!(stub.iter().any(|stub| stubs.contains(stub)), "{name} has no stub");
        assert!(
            text("src/railspring/__init__.py").contains(&format!("\"{name}\"")),
            "{name} is not exported"
        );
    }
    // every method of the module
    let methods = module.lines().filter_map(|line| line.strip_prefix("    fn ")?.split(['(', '<']).next());
    for method in methods.filter(|name| !name.starts_with("__") && *name != "new") {
        assert!(stubs.contains(&format!("    def {method}(")), "{method} has no stub");
    }
}

#[test]
#[ignore = "five minutes and the package index: cargo long python_package"]
fn the_package_works() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let lock = include_str!("../python/requirements.lock");
    let Some(python) = railspring_testing::locked(target, "python-package", lock) else { return };
    let wheels = tempfile::tempdir().unwrap();
    let [maturin, mypy] = ["maturin", "mypy"].map(|name| python.with_file_name(name));
    // beside the target folder of the program, whose lock is held while its tests are compiled
    let target_dir = target.join("python");
    let out = wheels.path().to_str().unwrap();
    let interpreter = python.to_str().unwrap();
    done(
        &maturin,
        &["build", "--release", "--locked", "--interpreter", interpreter, "-o", out],
        &[("CARGO_TARGET_DIR", &target_dir)],
    );
    let wheel = std::fs::read_dir(wheels.path()).unwrap().flatten().next().unwrap().path();
    let install = [
        "-I",
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--no-deps",
        "--force-reinstall",
    ];
    done(&python, &[&install[..], &[wheel.to_str().unwrap()]].concat(), &[]);
    done(&mypy, &["--cache-dir", "/dev/null", "src", "tests"], &[]);
    let program = Path::new(env!("CARGO_BIN_EXE_railspring"));
    println!("{}", done(&python, &["-B", "-m", "pytest"], &[("RAILSPRING", program)]));
    let figures = tempfile::tempdir().unwrap();
    let run = "import nbformat, nbclient\nnotebook = nbformat.read('notebooks/readme_figures.ipynb', as_version=4)\n\
               nbclient.NotebookClient(notebook, timeout=600, kernel_name='python3').execute()";
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let variables = [("RAILSPRING", program), ("RAILSPRING_ROOT", root), ("RAILSPRING_OUT", figures.path())];
    done(&python, &["-c", run], &variables);
    for figure in ["law.png", "derailment-coefficient.png"] {
        let size = std::fs::metadata(figures.path().join(figure)).unwrap().len();
        assert!(size > 10_000, "{figure}: {size} bytes");
    }
}
