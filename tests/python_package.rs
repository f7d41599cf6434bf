//! The Python package of `python/`: built, checked and tried as a user has it.
//!
//! Goal: the source distribution builds for the Python at hand, its types hold (mypy, strict), its tests pass with the program that it brings along, and the notebook with the figures of the README
//! runs to its end and leaves them. Source: `python/tests`, `python/notebooks`. Needs Python 3.11 or newer, the package index, and crates.io on the first
//! run; it compiles the library once more for Python, so that it is no part of the usual tests: `cargo long python_package`, a quarter of an hour.

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
        // the program is started by `__main__`
        let offered =
            name == "run_program" || text("src/railspring/__init__.py").contains(&format!("\"{name}\""));
        assert!(offered, "{name} is not exported");
    }
    // every method of the module
    let methods = module.lines().filter_map(|line| line.strip_prefix("    fn ")?.split(['(', '<']).next());
    for method in methods.filter(|name| !name.starts_with("__") && *name != "new") {
        assert!(stubs.contains(&format!("    def {method}(")), "{method} has no stub");
    }
}

#[test]
#[ignore = "a quarter of an hour and the package index: cargo long python_package"]
fn the_package_works() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let lock = include_str!("../python/requirements.lock");
    let Some(python) = railspring_testing::locked(target, "python-package", lock) else { return };
    let wheels = tempfile::tempdir().unwrap();
    let [maturin, mypy] = ["maturin", "mypy"].map(|name| python.with_file_name(name));
    // beside the target folder of the program, whose lock is held while its tests are compiled
    let target_dir = target.join("python");
    done(&maturin, &["sdist", "-o", wheels.path().to_str().unwrap()], &[]);
    let sources = std::fs::read_dir(wheels.path()).unwrap().flatten().next().unwrap().path();
    // with the build tools of the lock
    let install = "-I -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --force-reinstall";
    let install: Vec<&str> = install.split(' ').chain([sources.to_str().unwrap()]).collect();
    let search = [python.parent().unwrap().as_os_str(), &std::env::var_os("PATH").unwrap_or_default()];
    let search = search.map(|part| part.to_string_lossy().into_owned()).join(":");
    done(&python, &install, &[("CARGO_TARGET_DIR", &target_dir), ("PATH", Path::new(&search))]);
    done(&mypy, &["--cache-dir", "/dev/null", "src", "tests"], &[]);
    let program = python.with_file_name("railspring");
    let version = done(&program, &["--version"], &[]);
    assert!(version.contains(env!("CARGO_PKG_VERSION")), "{version}");
    println!("{}", done(&python, &["-B", "-m", "pytest"], &[]));
    let figures = tempfile::tempdir().unwrap();
    let run = "import nbformat, nbclient\nnotebook = nbformat.read('notebooks/readme_figures.ipynb', as_version=4)\n\
               nbclient.NotebookClient(notebook, timeout=600, kernel_name='python3').execute()";
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let variables =
        [("RAILSPRING", program.as_path()), ("RAILSPRING_ROOT", root), ("RAILSPRING_OUT", figures.path())];
    done(&python, &["-c", run], &variables);
    for figure in ["law.png", "derailment-coefficient.png"] {
        let size = std::fs::metadata(figures.path().join(figure)).unwrap().len();
        assert!(size > 10_000, "{figure}: {size} bytes");
    }
}
