//! A folder with the table file of a test, its study and a worn wheel.

use std::collections::BTreeMap;
use std::path::PathBuf;

/// Bodies with as few degrees of freedom as hold the loads: what is compared are bytes.
const COARSER: &str = "[mesh]\nwheel_section_element_mm = 40\nwheel_arc_element_mm = 300\nrail_length_element_mm = 60\ngrowth = 2.5\n";

pub struct Place(pub tempfile::TempDir);

impl Place {
    /// With `table` as `table.toml`, over the coarse study with loads of the tables' columns.
    pub fn new(table: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        let base = include_str!("studies/coarse.toml").replace("[mesh]\n", COARSER);
        let loads = "loads_kn = [5, 20, 40, 60, 85]";
        let base = base.replace("load_min_kn = 5\nload_max_kn = 85\nload_count = 5", loads);
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
        ["table.csv", "table.json", "table.html"].map(read).into()
    }
}
