//! An earlier table, as it was written.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use railspring_profiles::error::{InputError, Result};
use serde::Deserialize;

use super::record::TableRecord;
use crate::engine::list::not_a_users;
use crate::engine::output::{parse_json, read_text};
use crate::engine::seal::Sealed;
use crate::hash::hash;

/// The record that lists the files of a table.
pub const RECORD: &str = "table.json";

/// The rows of an earlier table.
#[derive(Debug, Clone)]
pub struct Earlier {
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Earlier {
    /// Reads a `table.csv`, which the `table.json` beside it has to list with the hash of its content.
    ///
    /// # Errors
    /// [`InputError`] for a file that is no table, and for one that is not as it was written.
    pub fn read(path: &Path) -> Result<Self> {
        let refused = |value: String, expected: &str| {
            let remedy =
                "name a table.csv that `railspring table` has written, with its table.json beside it";
            InputError::new(path.display().to_string(), value, expected, remedy)
        };
        let text = read_text(path, "table")?;
        let header: Vec<String> = match csv::Reader::from_reader(text.as_bytes()).headers() {
            Ok(header) => header.iter().map(str::to_owned).collect(),
            Err(cause) => return Err(refused(cause.to_string(), "a table in CSV").into()),
        };
        if let Some(missing) =
            ["wheel", "rail", "shift_mm", "status"].iter().find(|name| !header.iter().any(|h| h == *name))
        {
            let expected = "a table with the columns wheel, rail, shift_mm, status";
            return Err(refused(format!("no column {missing:?}"), expected).into());
        }
        let record_at = path.with_file_name(RECORD);
        if !record_at.is_file() {
            let expected = format!("a table whose {RECORD} lies beside it, with the hash of its rows");
            return Err(refused(format!("no {} beside it", record_at.display()), &expected).into());
        }
        let record: TableRecord<'_> = parse_json(&record_at, &read_text(&record_at, "table")?, "table")?;
        record.check_as_written(&record_at, "table")?;
        let content = hash(text.as_bytes());
        if !record.written.values().any(|listed| *listed == content) {
            let expected =
                format!("a file as it was written, which {} lists with its hash", record_at.display());
            return Err(refused("another content".into(), &expected).into());
        }
        Ok(Self { path: path.to_path_buf(), text })
    }
}

/// The files that an earlier table has written in its folder.
#[derive(Debug, Clone)]
pub struct EarlierFiles {
    folder: PathBuf,
    /// With the hashes of their contents; none where no table was written.
    written: BTreeMap<String, String>,
}

impl EarlierFiles {
    /// Those that the record in a folder lists.
    ///
    /// # Errors
    /// [`InputError`] for a file under the name of the record that is a user's.
    pub fn of(folder: &Path) -> Result<Self> {
        /// What is taken of a record that may be large.
        #[derive(Deserialize)]
        struct Written {
            written: BTreeMap<String, String>,
        }
        let path = folder.join(RECORD);
        let record = read_text(&path, "table").ok().and_then(|text| serde_json::from_str(&text).ok());
        let written = match record {
            Some(Written { written }) => written,
            None => not_a_users(&path).map(|()| BTreeMap::new())?,
        };
        Ok(Self { folder: folder.to_path_buf(), written })
    }

    /// Refuses to write files of these names where there is one that the table has not written.
    ///
    /// # Errors
    /// [`InputError`] whose key is the path of that file.
    pub fn check<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Result<()> {
        let others = names.into_iter().filter(|name| *name != RECORD && !self.written.contains_key(*name));
        others.map(|name| self.folder.join(name)).try_for_each(|path| not_a_users(&path))
    }

    /// Whether a file is one of these, and as it was written.
    pub fn is_as_written(&self, name: &str) -> bool {
        let bytes = railspring_profiles::input::read(&self.folder.join(name), u64::MAX - 1).ok();
        bytes.is_some_and(|bytes| self.written.get(name).is_some_and(|listed| *listed == hash(&bytes)))
    }
}
