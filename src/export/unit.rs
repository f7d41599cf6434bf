//! The contact element for programs that load it: the shared library with its header, and the functional mock-up unit.

use std::io::{Cursor, Write};

use railspring_element::element::Element;
use railspring_element::variables::{MODEL, RESOURCE, model_description};
use railspring_profiles::error::{InputError, Result};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The library of this platform.
struct Library {
    content: &'static [u8],
    /// How its name ends.
    suffix: &'static str,
    header: &'static [u8],
}

#[cfg(c_library)]
const LIBRARY: Option<Library> = Some(Library {
    content: include_bytes!(env!("RAILSPRING_C_LIBRARY")),
    suffix: env!("RAILSPRING_C_SUFFIX"),
    header: include_bytes!(env!("RAILSPRING_C_HEADER")),
});
#[cfg(not(c_library))]
const LIBRARY: Option<Library> = None;

fn library(option: &str) -> Result<Library> {
    LIBRARY.ok_or_else(|| {
        let expected = "a program that was built with the sources of the library";
        InputError::new(option, "given", expected, "install railspring from its repository").into()
    })
}

/// Header and shared library of the C interface, by name.
///
/// # Errors
/// [`InputError`] for a program that was built without the library.
pub fn c_files() -> Result<[(String, &'static [u8]); 2]> {
    let Library { content, suffix, header } = library("--c")?;
    let start = if suffix == ".dll" { "" } else { "lib" };
    Ok([("railspring.h".into(), header), (format!("{start}{MODEL}{suffix}"), content)])
}

/// An element as a functional mock-up unit of FMI 3.0 for this platform. The same element gives the same bytes.
///
/// # Errors
/// [`InputError`] for a program that was built without the library.
///
/// # Panics
/// Never: a file in memory takes what is written.
pub fn functional_mock_up_unit(element: &Element) -> Result<Vec<u8>> {
    let Library { content: library, suffix, .. } = library("--fmu")?;
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    let description = model_description(element, env!("CARGO_PKG_VERSION"));
    let files: [(String, &[u8]); 3] = [
        ("modelDescription.xml".into(), description.as_bytes()),
        (format!("binaries/{}-{system}/{MODEL}{suffix}", std::env::consts::ARCH), library),
        (format!("resources/{RESOURCE}"), &element.write()),
    ];
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default());
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        archive.start_file(name, options).expect("a new name");
        archive.write_all(content).expect("room in memory");
    }
    Ok(archive.finish().expect("room in memory").into_inner())
}
