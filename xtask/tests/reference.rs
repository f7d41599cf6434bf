//! `cargo xtask reference`: the pages of the documents that are made from the program.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Pages that are made.
const REFERENCE: [&str; 3] = ["reference-commands.md", "reference-files.md", "reference-keys.md"];

/// Goal: the reference pages are those that the program writes. To renew them: `cargo xtask reference -o docs`.
#[test]
fn the_reference_is_that_of_the_program() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let place = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_xtask"))
        .args(["reference", "-o"])
        .arg(place.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written = std::fs::read_dir(place.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(written.collect::<BTreeSet<_>>(), REFERENCE.map(String::from).into());
    for name in REFERENCE {
        let [made, kept] =
            [place.path(), &docs].map(|folder| std::fs::read_to_string(folder.join(name)).unwrap());
        let different = made.lines().zip(kept.lines()).find(|(made, kept)| made != kept);
        assert!(
            made == kept,
            "docs/{name} is out of date, do `cargo xtask reference -o docs`: {different:?}"
        );
    }
    let keys = std::fs::read_to_string(docs.join("reference-keys.md")).unwrap();
    for part in ["| `contact.friction` | Coulomb friction", "a number from 0 to 2", "`[scenario.NAME]`"] {
        assert!(keys.contains(part), "{part}");
    }
}
