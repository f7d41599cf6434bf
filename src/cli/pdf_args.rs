//! The option for a page as PDF.

use clap::Args;
use railspring_profiles::error::Result;

use crate::pdf::Printer;

/// Whether a page is printed to a PDF as well.
#[derive(Debug, Clone, Copy, Args)]
pub(super) struct PdfArgs {
    /// Write the page as a PDF as well, A4, beside it: needs Chromium or Chrome on this machine
    #[arg(long)]
    pdf: bool,
}

impl PdfArgs {
    /// What prints, if it is asked for: found before anything else is done.
    ///
    /// # Errors
    /// [`railspring_profiles::error::InputError`] with key `--pdf` without a browser.
    pub fn printer(self) -> Result<Option<Printer>> {
        self.pdf.then(Printer::find).transpose()
    }
}
