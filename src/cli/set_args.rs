//! The option that gives keys of a study on the command line.

use clap::Args;

use crate::study::Setting;

/// Keys of the study.
#[derive(Debug, Args)]
pub struct SetArgs {
    /// A key of the study and its value, in the place of that of the file; may be given several times. Files are relative to the study; an empty value
    /// takes the key out. `railspring explain` describes the keys
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    settings: Vec<Setting>,
}

impl SetArgs {
    /// The settings in their order; of one key the last one counts.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }
}

pub(super) fn setting(text: &str) -> Result<Setting, String> {
    Setting::parse(text).map_err(|error| format!("expected {}; {}", error.expected, error.remedy))
}
