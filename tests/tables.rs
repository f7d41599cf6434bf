//! A folder with the table file of a test, its study and worn wheels.

use crate::coarser::coarser;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use railspring_profiles::profile_file::{
    MeasuredPoint, ProfileFormat, ProfileKind, ReadOptions, read, write,
};
use serde_json::Value;

pub struct Place(pub tempfile::TempDir);

impl Place {
    /// With `table` as `table.toml`, over the coarse study with loads of the tables' columns.
    pub fn new(table: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        let loads = "loads_kn = [5, 20, 40, 60, 85]";
        let base = coarser().replace("load_min_kn = 5\nload_max_kn = 85\nload_count = 5", loads);
        assert!(base.contains(loads));
        place.write("base.toml", &base);
        place.write("worn.whl", include_str!("../data/profiles/worn-s1002.whl"));
        place.write("table.toml", table);
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// The files of the table in a folder.
    pub fn files(&self, out: &str) -> BTreeMap<&'static str, Vec<u8>> {
        let read = |name| (name, std::fs::read(self.path(out).join(name)).unwrap());
        ["table.csv", "table.json", "table.html", "table.parquet"].map(read).into()
    }

    /// The program here, with a store of its own.
    pub fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
        command.current_dir(self.0.path()).args(arguments).env("RAILSPRING_CACHE", "cache");
        let Output { status, stdout, stderr } = command.stdin(Stdio::null()).output().unwrap();
        let said = [stdout, stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
        (status.code(), said)
    }

    pub fn json(&self, file: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.path(file)).unwrap()).unwrap()
    }
}

/// Makes a folder with so many wheels, `00.whl` and so on: the worn wheel of `data/profiles` with hollows of up to 3 mm.
pub fn hollow_wheels(folder: &Path, count: usize) {
    std::fs::create_dir(folder).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles/worn-s1002.whl");
    let worn = read(&file, &ReadOptions::default()).unwrap();
    for n in 0..count {
        let depth = 3e-3 * n as f64 / count as f64;
        let mut points = worn.points.clone();
        for MeasuredPoint { point, .. } in &mut points {
            point.y -= depth * (-((point.x - 5e-3) / 18e-3).powi(2)).exp();
        }
        let text = write(ProfileFormat::MiniProf, ProfileKind::Wheel, &points, "hollow");
        std::fs::write(folder.join(format!("{n:02}.whl")), text).unwrap();
    }
}
