//! What the documentation has for clusters with a queue and for Kubernetes, in the packages that it names.
//!
//! Source: dask-jobqueue and the definitions of dask-kubernetes, from the package index (`testing/requirements-queues.lock`). Goal: the examples are taken as they stand
//! in `docs/dask.md`. The queue of the test starts its jobs at once on this machine.
#![cfg(unix)]

use std::collections::BTreeSet;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::tables::Place;
use railspring::python::Python;
use railspring_profiles::monitor::Silent;

const TABLE: &str = "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0, 2]\nstiffness_at_kn = [20, 60]\n\
    [[wheel]]\nname = \"worn\"\nprofile_file = \"worn.whl\"\nstandard = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n";

/// Starts a job, and says its number as Slurm does. Like Slurm it keeps its own copy of the script: the one that it is given is removed as soon as it has answered.
const SBATCH: &str = "#!/bin/sh\ncp \"$1\" \"$0.$$.sh\"\nsh \"$0.$$.sh\" > \"$0.$$.log\" 2>&1 &\n\
    echo $! >> \"$0.jobs\"\necho \"Submitted batch job $!\"\n";
/// Ends a job.
const SCANCEL: &str = "#!/bin/sh\necho \"$1\" >> \"$0.jobs\"\nkill \"$1\"\n";

/// Checks a manifest against the definition of its kind, keys that it does not know included.
const MANIFEST: &str = r#"
import importlib.util, pathlib, sys
import jsonschema, yaml
package = pathlib.Path(importlib.util.find_spec("dask_kubernetes").origin).parent
definition = package / "operator/deployment/helm/dask-kubernetes-operator/crds/daskcluster.yaml"
version, = yaml.safe_load(definition.read_text())["spec"]["versions"]
schema = version["schema"]["openAPIV3Schema"]
def close(schema):
    if isinstance(schema, dict):
        if "properties" in schema and not schema.get("x-kubernetes-preserve-unknown-fields"):
            schema.setdefault("additionalProperties", False)
        for part in schema.values():
            close(part)
    elif isinstance(schema, list):
        for part in schema:
            close(part)
close(schema["properties"]["spec"])
manifest = yaml.safe_load(sys.stdin)
assert manifest["apiVersion"] == "kubernetes.dask.org/" + version["name"] and manifest["kind"] == "DaskCluster"
jsonschema.validate(manifest, schema)
name, service = manifest["metadata"]["name"], manifest["spec"]["scheduler"]["service"]
assert service["selector"]["dask.org/cluster-name"] == name
print(f"tcp://{name}-scheduler:{service['ports'][0]['port']}")
"#;

/// Job scripts of the three queues; the arguments are the names of the classes.
const JOB_SCRIPTS: &str = r#"
import sys, dask_jobqueue
for name in sys.argv[1:]:
    # LSF counts minutes
    walltime = "04:00" if name == "LSFCluster" else "04:00:00"
    with getattr(dask_jobqueue, name)(cores=16, processes=1, memory="60GB", walltime=walltime) as cluster:
        print(name, cluster.scheduler_address)
        print(cluster.job_script())
"#;

/// A block of the documentation in a language.
fn block(language: &str) -> &'static str {
    let text = include_str!("../docs/dask.md");
    let (_, rest) = text.split_once(&format!("```{language}\n")).unwrap();
    rest.split_once("```").unwrap().0
}

/// One environment for all tests of this file, made by the first of them.
fn queues() -> Option<PathBuf> {
    static MAKING: Mutex<()> = Mutex::new(());
    let _one = MAKING.lock().unwrap_or_else(PoisonError::into_inner);
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
    railspring_testing::locked(cache, "queues", include_str!("../testing/requirements-queues.lock"))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn succeeded(output: Output) -> String {
    let said = text(&output.stdout);
    assert!(output.status.success(), "{said}{}", text(&output.stderr));
    said
}

/// Goal: dask-jobqueue takes the keys of the example for each of the queues, and its job script has them, in the words of the queue.
#[test]
fn the_queues_get_job_scripts() {
    let Some(python) = queues() else { return };
    let classes = ["SLURMCluster", "PBSCluster", "LSFCluster"];
    assert!(classes.iter().all(|class| include_str!("../docs/dask.md").contains(class)));
    let output = Command::new(python).args(["-I", "-c", JOB_SCRIPTS]).args(classes).output().unwrap();
    let said = succeeded(output);
    let wanted = [
        "#SBATCH --cpus-per-task=16\n",
        "#SBATCH -t 04:00:00\n",
        "#PBS -l select=1:ncpus=16:mem=56GB\n",
        "#PBS -l walltime=04:00:00\n",
        "#BSUB -n 16\n",
        "#BSUB -W 04:00\n",
    ];
    for line in wanted {
        assert!(said.contains(line), "{line}{said}");
    }
    assert_eq!(said.matches("--nthreads 16 ").count(), classes.len(), "{said}");
}

/// Goal: the Python example of the documentation, word for word but for the number of jobs and their size, makes a table with the bytes of one without a cluster, by
/// workers that a queue has started, and gives them back.
#[test]
fn a_queue_starts_the_workers_of_a_table() {
    let Some(python) = queues() else { return };
    let place = Place::new(TABLE);
    let commands = place.path("commands");
    std::fs::create_dir(&commands).unwrap();
    for (name, script) in [("sbatch", SBATCH), ("scancel", SCANCEL)] {
        place.write(&format!("commands/{name}"), script);
        let mode = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(commands.join(name), mode).unwrap();
    }
    let program = env!("CARGO_BIN_EXE_railspring");
    std::os::unix::fs::symlink(program, commands.join("railspring")).unwrap();
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
    // the environment of the client, which the example has made on its first run
    Python::for_cluster(None, cache, &Silent).unwrap_or_else(|error| panic!("{error}"));
    let example = block("python")
        .replace("jobs=8", "jobs=2")
        .replace("cores=16, processes=1, memory=\"60GB\"", "cores=1, processes=1, memory=\"4GB\"");
    assert!(example.contains("jobs=2") && example.contains("cores=1,"), "{example}");
    place.write("fleet.toml", TABLE);
    place.write("cluster.py", &example);
    let search = std::env::var("PATH").unwrap_or_default();
    // a queue that starts no job is waited for without end; here that is a failure
    let run = |command: Command| {
        let mut command = assert_cmd::Command::from_std(command);
        command.current_dir(place.0.path()).env("RAILSPRING_CACHE", cache).timeout(Duration::from_secs(300));
        succeeded(command.output().unwrap())
    };
    let mut example = Command::new(&python);
    example.args(["-I", "cluster.py"]).env("PATH", format!("{}:{search}", commands.display()));
    run(example);
    let mut alone = Command::new(program);
    alone.args(["table", "fleet.toml", "-o", "alone", "--cache", "store-alone", "-q"]);
    run(alone);
    assert!(place.files("out/fleet") == place.files("alone"));
    let jobs = |name: &str| -> BTreeSet<String> {
        let text = std::fs::read_to_string(commands.join(format!("{name}.jobs"))).unwrap();
        text.lines().map(str::to_owned).collect()
    };
    let (begun, ended) = (jobs("sbatch"), jobs("scancel"));
    assert_eq!(begun.len(), 2, "{begun:?}");
    assert_eq!(begun, ended);
}

/// Goal: the manifest of the documentation is one that the operator takes, and its scheduler has the address that the text names; a key that the operator does not
/// know is found.
#[test]
fn the_manifest_is_one_of_the_operator() {
    let Some(python) = queues() else { return };
    let checked = |manifest: &str| {
        let mut child = Command::new(&python)
            .args(["-I", "-c", MANIFEST])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), manifest.as_bytes()).unwrap();
        child.wait_with_output().unwrap()
    };
    let manifest = block("yaml");
    let address = succeeded(checked(manifest));
    assert!(
        include_str!("../docs/dask.md").contains(&format!("--scheduler {}`", address.trim())),
        "{address}"
    );
    let wrong = manifest.replace("replicas: 8", "replica: 8");
    assert!(wrong != manifest && !checked(&wrong).status.success());
}
