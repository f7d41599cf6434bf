//! What goes to the terminal. Either stream may close at any time or be full.

use std::io::{ErrorKind, Write};

use railspring_calibrate::error::{Error, InputError, printable};

/// Prints a line to standard output; a reader that has gone away, as in `railspring schema | head`, is no error.
///
/// # Errors
/// [`InputError`] with key `standard output` if it cannot be written for another reason, as on a full device.
pub(super) fn say(line: &str) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    written(writeln!(out, "{}", harmless(line)).and_then(|()| out.flush()))
}

/// The error of a write to standard output, if it is one.
pub(super) fn written(result: std::io::Result<()>) -> Result<(), Error> {
    match result {
        Err(cause) if cause.kind() != ErrorKind::BrokenPipe => Err(InputError::new(
            "standard output",
            cause,
            "a terminal, a pipe or a file that can be written",
            "make room, or send the output elsewhere",
        )
        .into()),
        _ => Ok(()),
    }
}

/// Writes a line to standard error if anybody can hear it.
pub(super) fn remark(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", harmless(line));
}

/// The lines of a text without what does a terminal harm.
fn harmless(text: &str) -> String {
    text.split('\n').map(|line| printable(line.into(), usize::MAX)).collect::<Vec<_>>().join("\n")
}
