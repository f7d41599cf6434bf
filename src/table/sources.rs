//! Where what is known of the measurements of a folder comes from: a list, the names of the files, and their headers.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::profile_file::{LARGEST_FILE, header_entries};

use super::files::{List, beside};
use super::folder::FolderFile;
use super::metadata::{Metadata, of_header, of_source};
use super::pattern::Pattern;

/// What says more of the files of a folder than their headers do.
#[derive(Debug, Default)]
pub(super) struct Sources {
    list: Option<Listed>,
    pattern: Option<Pattern>,
}

/// The rows of a list by the files that they name.
#[derive(Debug, Default)]
struct Listed {
    /// What the list is called.
    file: String,
    rows: BTreeMap<String, Metadata>,
}

/// What is known of files.
pub(super) struct Known {
    /// Of each file.
    pub metadata: Vec<Metadata>,
    /// What the sources leave open.
    pub notices: Vec<String>,
}

impl Sources {
    /// Those that an entry gives, each with its key: a list in CSV, and a pattern of names.
    ///
    /// # Errors
    /// [`InputError`] for a list that cannot be read, has no column with the files, or names one twice, and for a pattern that is none.
    pub fn read(
        table: &Path,
        list: Option<(&str, String)>,
        pattern: Option<(&str, String)>,
    ) -> Result<Self, InputError> {
        let list =
            list.map(|(file, key)| Listed::of(file, &List::read(table, file, &key)?, &key)).transpose()?;
        let pattern = pattern.map(|(pattern, key)| Pattern::parse(pattern, &key)).transpose()?;
        Ok(Self { list, pattern })
    }

    /// What is known of each file: the list comes before the name, and the name before the header.
    pub fn of_files(&self, table: &Path, files: &[FolderFile]) -> Known {
        let (mut found, mut without_row, mut of_no_pattern) = (BTreeSet::new(), 0, 0);
        let mut of = |file: &FolderFile| {
            // a file that cannot be read has a row that says so
            let content = input::read(&beside(table, &file.path), LARGEST_FILE).unwrap_or_default();
            let mut metadata = of_header(header_entries(&file.relative, &content));
            metadata.extend(file.slice_position.map(|(column, position)| (column.into(), position.into())));
            if let Some(pattern) = &self.pattern {
                let values = pattern.values(&file.stem);
                of_no_pattern += usize::from(values.is_none());
                metadata.extend(of_source(values.unwrap_or_default()));
            }
            if let Some(list) = &self.list {
                let row =
                    [&file.relative, &file.stem].into_iter().find_map(|name| list.rows.get_key_value(name));
                without_row += usize::from(row.is_none());
                if let Some((name, row)) = row {
                    found.insert(name.as_str());
                    metadata.extend(row.clone());
                }
            }
            metadata
        };
        let metadata = files.iter().map(&mut of).collect();
        let mut notices = Vec::new();
        if of_no_pattern > 0 {
            notices.push(format!("{of_no_pattern} of {} files have names of another pattern", files.len()));
        }
        if let Some(Listed { file, rows }) = &self.list {
            let without_file = rows.len() - found.len();
            if without_row > 0 {
                notices.push(format!("{without_row} of {} files have no row in {file}", files.len()));
            }
            if without_file > 0 {
                notices.push(format!("{without_file} of {} rows of {file} have no file", rows.len()));
            }
        }
        Known { metadata, notices }
    }
}

impl Listed {
    /// The rows of a list; `key` is the key that names its file.
    fn of(file: &str, list: &List, key: &str) -> Result<Self, InputError> {
        let refused =
            |expected: String, remedy: &str| InputError::new(key, format!("{file:?}"), expected, remedy);
        let Some(at) = list.column("file").or(list.column("name")) else {
            let expected = format!("a column `file` or `name`; it has {}", list.header.join(", "));
            return Err(refused(expected, "call the column with the files `file`"));
        };
        let mut rows = BTreeMap::new();
        for (line, fields) in &list.rows {
            let name = fields[at].replace('\\', "/").trim_start_matches("./").to_owned();
            if name.is_empty() {
                return Err(refused(
                    format!("a file in each row; line {line} has none"),
                    "name it, or remove the row",
                ));
            }
            let entries = list.header.iter().zip(fields).enumerate().filter(|(column, _)| *column != at);
            let entries = entries.map(|(_, (key, value))| (key.clone(), value.clone())).collect();
            if rows.insert(name.clone(), of_source(entries)).is_some() {
                let expected = format!("each file once; line {line} has {name:?} again");
                return Err(refused(expected, "remove one of the rows"));
            }
        }
        Ok(Self { file: file.to_owned(), rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(relative: &str) -> FolderFile {
        let stem = relative.rsplit_once('.').map_or(relative, |(stem, _)| stem).to_owned();
        FolderFile {
            name: stem.clone(),
            stem,
            relative: relative.into(),
            path: format!("measured/{relative}"),
            slice_position: None,
        }
    }

    fn text(metadata: &Metadata) -> String {
        let entries = metadata.iter().map(|(key, value)| format!("{key}={value}"));
        entries.collect::<Vec<_>>().join(" ").replace('"', "")
    }

    /// Goal: of three sources the list comes first, then the name, then the header; a row names its file with or without its ending; what has no file
    /// or no row is counted.
    #[test]
    fn a_list_comes_before_a_name_and_a_name_before_a_header() {
        let place = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(place.path().join("measured/a")).unwrap();
        let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
        write("measured/a/7_2.whl", "CarNo=1\nAxleNo=1\nUserName=A. B.\nColumnDef=X,Y\n\n0 0\n");
        write("fleet.csv", "File;Axle;Depot;Mileage [km]\na\\7_2;;North;1,5\nb/8_1.whl;3;South;\ngone;1;;\n");
        let table = place.path().join("table.toml");
        let read =
            |pattern| Sources::read(&table, Some(("fleet.csv", "l".into())), Some((pattern, "p".into())));
        let files = [file("a/7_2.whl"), file("b/8_1.whl"), file("c.whl")];
        let known = read("{folder}/{vehicle}_{axle}").unwrap().of_files(&table, &files);
        let found: Vec<String> = known.metadata.iter().map(text).collect();
        assert_eq!(found[0], "axle=2 depot=North folder=a mileage_km=1.5 user_name=A. B. vehicle=7");
        assert_eq!(found[1..], ["axle=3 depot=South folder=b vehicle=8", ""]);
        let said = ["1 of 3 files have names of another pattern", "1 of 3 files have no row", "1 of 3 rows"];
        assert!(
            known.notices.iter().zip(said).all(|(notice, said)| notice.starts_with(said)),
            "{:?}",
            known.notices
        );
        assert_eq!((known.notices.len(), read("x").unwrap_err().key.as_str()), (3, "p"));
    }

    /// Goal: a list without a column of files, with an empty one, or with a file twice is refused with its key.
    #[test]
    fn lists_that_say_nothing_are_refused() {
        let place = tempfile::tempdir().unwrap();
        for (list, said) in
            [("a,b\n1,2\n", "it has a, b"), ("file,b\n,2\n", "line 2"), ("name,b\nx,1\nx,2\n", "\"x\" again")]
        {
            std::fs::write(place.path().join("l.csv"), list).unwrap();
            let table = place.path().join("table.toml");
            let refused =
                Sources::read(&table, Some(("l.csv", "wheel[0].metadata_file".into())), None).unwrap_err();
            assert_eq!(refused.key, "wheel[0].metadata_file");
            assert!(refused.expected.contains(said), "{refused}");
        }
    }
}
