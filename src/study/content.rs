//! What a file that is given as a study is, if it is none.

use std::path::Path;

use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::profile_file::format_of;

/// Largest study that is read, bytes.
const LARGEST: u64 = 64 << 20;

/// The text of a TOML file, a study or what `whole` says.
pub(super) fn read(path: &Path, whole: &str) -> Result<String, InputError> {
    let refused = |value: String, expected: &str, remedy: &str| {
        InputError::new(
            format!("{whole} file"),
            value,
            expected,
            remedy.replace("the study", &format!("the {whole}")),
        )
    };
    let bytes = input::read(path, LARGEST)
        .map_err(|cause| refused(cause.to_string(), "a readable TOML file", "check the path of the study"))?;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").map(<[u8]>::to_vec).unwrap_or(bytes);
    if let [0xff, 0xfe, ..] | [0xfe, 0xff, ..] = bytes[..] {
        let value = "text in UTF-16".into();
        return Err(refused(value, "a TOML file, which is text in UTF-8", "save the study in UTF-8"));
    }
    if let Some(at) = bytes.iter().position(|byte| *byte == 0) {
        if let Some(mesh) = mesh(path) {
            return Err(mesh);
        }
        let value = format!("a binary file: a zero byte at position {at}");
        return Err(refused(value, "a TOML file, which is text in UTF-8", "check the path of the study"));
    }
    String::from_utf8(bytes).map_err(|cause| {
        let at = cause.utf8_error().valid_up_to();
        let line = cause.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count() + 1;
        refused(
            format!("a byte on line {line} that is not UTF-8"),
            "a TOML file, which is text in UTF-8",
            "save the study in UTF-8; if this is no text, check the path of the study",
        )
    })
}

/// Endings of the mesh formats that people have most.
const MESH_ENDINGS: [&str; 9] = ["vtu", "vtk", "msh", "inp", "bdf", "nas", "unv", "med", "xdmf"];

/// A file that is no TOML and has the ending of a mesh.
fn mesh(path: &Path) -> Option<InputError> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    MESH_ENDINGS.contains(&ending.as_str()).then(|| {
        InputError::new(
            "study file",
            format!("a mesh file (.{ending})"),
            "a study, which is a TOML file",
            "name the mesh in a study: `rail.mesh_file` or `wheel.mesh_file`",
        )
    })
}

/// What a text that is not TOML is, if that can be said.
pub(super) fn foreign(path: &Path, text: &str) -> Option<InputError> {
    if let Some(mesh) = mesh(path) {
        return Some(mesh);
    }
    let format = format_of(&path.display().to_string(), text.as_bytes())?;
    Some(InputError::new(
        "study file",
        format!("a profile file ({format})"),
        "a study, which is a TOML file",
        "name the profile in a study: `rail.profile_file` (or `wheel.profile_file`) with `rail.standard`",
    ))
}
