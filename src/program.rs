//! Where the program is on this machine: its own file, whose hash says which build it is, and the command that starts it.
//!
//! They are the same for the program `railspring`. Inside of Python the file is the package's module, and the command a script.

use std::path::PathBuf;
use std::sync::OnceLock;

/// File and command of a program that is a part of another one.
#[derive(Debug)]
struct Place {
    file: PathBuf,
    command: Option<PathBuf>,
}

static PLACE: OnceLock<Place> = OnceLock::new();

/// Says where the program is if it is a part of another one: the file that it is in, and what starts it, if there is such a file. What was said first
/// counts.
pub fn is_part_of(file: PathBuf, command: Option<PathBuf>) {
    let _ = PLACE.set(Place { file, command });
}

/// The program's own file; none where the system does not say.
pub fn file() -> Option<PathBuf> {
    PLACE.get().map_or_else(|| std::env::current_exe().ok(), |place| Some(place.file.clone()))
}

/// The file that starts the program; none where there is no such file.
pub fn command() -> Option<PathBuf> {
    PLACE.get().map_or_else(|| std::env::current_exe().ok(), |place| place.command.clone())
}
