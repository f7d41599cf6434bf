//! The Python packages that the program brings along.

use std::io::Write;
use std::path::Path;

use railspring_profiles::error::InputError;

/// Exact versions and hashes of all packages of the reference.
pub(super) const LOCK: &str = include_str!("../../reference/requirements.lock");
/// The same with what elements of second order need besides.
pub(super) const SECOND_ORDER_LOCK: &str = include_str!("../../reference/requirements-second-order.lock");
/// Exact versions and hashes of all packages of the client of a Dask cluster.
pub(super) const CLUSTER_LOCK: &str = include_str!("../../cluster/requirements.lock");

/// A package with its modules, so that the installed program needs no source tree.
#[derive(Debug)]
pub(super) struct Package {
    /// Its name.
    pub name: &'static str,
    /// What its folder is called.
    pub short: &'static str,
    /// Modules that all of its commands share: file and text.
    files: &'static [(&'static str, &'static str)],
    /// Modules beside them that answer the static questions of a cross-check.
    statics: &'static [(&'static str, &'static str)],
    /// Modules beside them that run load cases in time.
    in_time: &'static [(&'static str, &'static str)],
    /// Modules beside them that answer no question of a cross-check.
    readers: &'static [(&'static str, &'static str)],
    /// Packages that it imports, with spaces between them.
    pub imports: &'static str,
    /// What messages expect of an interpreter.
    expected: &'static str,
    /// What to do where there is none.
    remedy: &'static str,
}

/// The reference, and the reader of mesh files.
pub(super) static REFERENCE: Package = Package {
    name: "railspring_reference",
    short: "reference",
    files: &[
        ("__init__.py", include_str!("../../reference/src/railspring_reference/__init__.py")),
        ("__main__.py", include_str!("../../reference/src/railspring_reference/__main__.py")),
        ("inner_modes.py", include_str!("../../reference/src/railspring_reference/inner_modes.py")),
        ("iteration.py", include_str!("../../reference/src/railspring_reference/iteration.py")),
        ("ordering.py", include_str!("../../reference/src/railspring_reference/ordering.py")),
        ("factor.py", include_str!("../../reference/src/railspring_reference/factor.py")),
        ("body.py", include_str!("../../reference/src/railspring_reference/body.py")),
        ("exchange.py", include_str!("../../reference/src/railspring_reference/exchange.py")),
        ("surface.py", include_str!("../../reference/src/railspring_reference/surface.py")),
        ("command.py", include_str!("../../reference/src/railspring_reference/command.py")),
    ],
    statics: &[
        ("contact.py", include_str!("../../reference/src/railspring_reference/contact.py")),
        ("run.py", include_str!("../../reference/src/railspring_reference/run.py")),
    ],
    in_time: &[
        ("curve.py", include_str!("../../reference/src/railspring_reference/curve.py")),
        ("moving_surfaces.py", include_str!("../../reference/src/railspring_reference/moving_surfaces.py")),
        ("coulomb.py", include_str!("../../reference/src/railspring_reference/coulomb.py")),
        ("dynamics.py", include_str!("../../reference/src/railspring_reference/dynamics.py")),
        ("in_time.py", include_str!("../../reference/src/railspring_reference/in_time.py")),
        ("load_case.py", include_str!("../../reference/src/railspring_reference/load_case.py")),
    ],
    readers: &[
        ("refusal.py", include_str!("../../reference/src/railspring_reference/refusal.py")),
        ("abaqus_cards.py", include_str!("../../reference/src/railspring_reference/abaqus_cards.py")),
        ("abaqus.py", include_str!("../../reference/src/railspring_reference/abaqus.py")),
        ("gmsh.py", include_str!("../../reference/src/railspring_reference/gmsh.py")),
        ("nastran.py", include_str!("../../reference/src/railspring_reference/nastran.py")),
        ("mesh_in.py", include_str!("../../reference/src/railspring_reference/mesh_in.py")),
    ],
    imports: "skfem meshio scipy numpy",
    expected: "a Python that runs the reference (scikit-fem, meshio, numpy, scipy)",
    remedy: "install Python 3.11 or newer with the module venv (Debian: apt install python3-venv), or name an \
             interpreter that has scikit-fem, meshio and scipy with --python PATH; only `crosscheck` and studies \
             with a mesh_file need it",
};

/// The client of a Dask cluster.
pub(super) static CLUSTER: Package = Package {
    name: "railspring_cluster",
    short: "cluster",
    files: &[
        ("__init__.py", include_str!("../../cluster/src/railspring_cluster/__init__.py")),
        ("__main__.py", include_str!("../../cluster/src/railspring_cluster/__main__.py")),
        ("worker.py", include_str!("../../cluster/src/railspring_cluster/worker.py")),
        ("client.py", include_str!("../../cluster/src/railspring_cluster/client.py")),
    ],
    statics: &[],
    in_time: &[],
    readers: &[],
    imports: "distributed",
    expected: "a Python that has Dask's package distributed",
    remedy: "install Python 3.11 or newer with the module venv (Debian: apt install python3-venv), or name the \
             interpreter of the cluster's environment with --python PATH",
};

fn hash_of<'a>(files: impl Iterator<Item = &'a (&'static str, &'static str)>) -> String {
    let bytes: Vec<u8> = files.flat_map(|(name, text)| [name.as_bytes(), text.as_bytes()].concat()).collect();
    blake3::hash(&bytes).to_hex().to_string()
}

impl Package {
    fn all(&self) -> impl Iterator<Item = &'static (&'static str, &'static str)> {
        self.files.iter().chain(self.statics).chain(self.in_time).chain(self.readers)
    }

    /// BLAKE3 of all its source files.
    pub fn hash(&self) -> String {
        hash_of(self.all())
    }

    /// The same of those that answer the static questions of a cross-check.
    pub fn hash_of_answers(&self) -> String {
        hash_of(self.files.iter().chain(self.statics))
    }

    /// The same of those that run load cases in time.
    pub fn hash_in_time(&self) -> String {
        hash_of(self.files.iter().chain(self.in_time))
    }

    /// Writes its modules into a folder.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        for (name, text) in self.all() {
            let file = folder.join(name);
            if std::fs::read(&file).ok().as_deref() != Some(text.as_bytes()) {
                // commands that run at the same time must not see half a file
                let mut whole = tempfile::NamedTempFile::new_in(folder)?;
                whole.write_all(text.as_bytes())?;
                whole.persist(file)?;
            }
        }
        Ok(())
    }

    /// The error of an interpreter that does not run it.
    pub fn missing(&self, interpreter: &Path, cause: &str) -> InputError {
        InputError::new(
            "--python",
            format!("{} ({cause})", interpreter.display()),
            self.expected,
            self.remedy,
        )
    }
}
