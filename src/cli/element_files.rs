//! The files of a contact element.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use railspring_element::element::Element;
use railspring_profiles::error::Error;
use serde_json::Value;

use crate::engine::inputs::Inputs;
use crate::engine::output::OutputFolder;
use crate::export::{c_files, element, functional_mock_up_unit};
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::commands::Found;
use crate::study::{ContactElementKey, Study};

/// What is written of an element.
#[derive(Debug, Args)]
pub(super) struct ElementFiles {
    /// The element file
    #[arg(short = 'o', long = "output", value_name = "FILE", default_value = "pair.rse")]
    pub file: PathBuf,
    /// Write a functional mock-up unit of FMI 3.0 as well, for co-simulation and model exchange on this platform
    #[arg(long, value_name = "FILE")]
    fmu: Option<PathBuf>,
    /// Write the shared library with its header for C as well, into a folder
    #[arg(long = "c", value_name = "DIR")]
    c: Option<PathBuf>,
    /// Which element
    #[arg(long = "element", value_enum, value_name = "ELEMENT", default_value_t = Kind::Condensed)]
    kind: Kind,
}

/// An element of the solids.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    /// The condensed solids: as near to them as they know themselves
    Condensed,
    /// Oscillators, a bushing and strips that do not see each other
    Lumped,
}

impl ElementFiles {
    /// Refuses files that are inputs, before anything is made.
    ///
    /// # Errors
    /// Those of [`Inputs::check`], and of a program without the library for C.
    pub fn check(&self, inputs: &Inputs) -> Result<(), Error> {
        [&self.file].into_iter().chain(&self.fmu).try_for_each(|file| inputs.check(file))?;
        match &self.c {
            Some(folder) => c_files()?.iter().try_for_each(|(name, _)| inputs.check(&folder.join(name))),
            None => Ok(()),
        }
    }

    /// Writes the files; what is said of them.
    ///
    /// # Errors
    /// Those of the element, a folder that cannot be written, and a file that is one of the `inputs`.
    pub fn write(
        &self,
        study: &Study,
        found: &Found,
        laws: &StiffnessByAngleRecord,
        inputs: &Inputs,
    ) -> Result<(Vec<String>, Value), Error> {
        let kind = match self.kind {
            Kind::Condensed => ContactElementKey::Condensed,
            Kind::Lumped => ContactElementKey::Lumped,
        };
        let Some(stiffness) = &found.stiffness else { return Ok((Vec::new(), Value::Null)) };
        let element = element(study, stiffness, laws, kind)?;
        let mut said = vec![summary(&element)];
        let write = |option: &str, path: &Path, bytes: &[u8]| {
            let (folder, name) = OutputFolder::of_file(option, path, inputs)?;
            folder.write(&name, bytes)
        };
        write("-o", &self.file, &element.write())?;
        if let Some(file) = &self.fmu {
            write("--fmu", file, &functional_mock_up_unit(&element)?)?;
            said.push(format!("functional mock-up unit: {}", file.display()));
        }
        if let Some(folder) = &self.c {
            for (name, content) in c_files()? {
                let file = folder.join(name);
                write("--c", &file, content)?;
                said.push(format!("C interface: {}", file.display()));
            }
        }
        let about = serde_json::to_value(&element.about).expect("strings and numbers are plain JSON");
        Ok((said, about))
    }
}

/// The element in a line.
fn summary(element: &Element) -> String {
    let about = &element.about;
    let hub = about
        .hub_max_rel_error
        .map_or_else(String::new, |hub| format!(", the hub's displacement by {:.1} %", 100.0 * hub));
    format!(
        "{} element: {} modes of the wheel, {} places of strips, for normal forces up to {:.0} kN; contact forces differ from the solids' by {:.1} % at most{hub}",
        about.element,
        element.wheel.modes.len(),
        element.strips.places().len(),
        1e-3 * about.largest_force_n,
        100.0 * about.strips_max_rel_error
    )
}
