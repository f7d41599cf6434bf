//! What goes to the terminal. Either stream may close at any time or be full; colours are there where a terminal shows them
//! and `NO_COLOR` is not set.

use std::io::{ErrorKind, Write};

use anstream::AutoStream;
use anstyle::{AnsiColor, Style};
use railspring_profiles::error::{Error, InputError, printable};

/// How a piece of a line is set off; without colours all look the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tone {
    /// As the rest.
    Plain,
    /// The beginning of a group of lines.
    Heading,
    /// Something that holds.
    Good,
    /// Something that does not hold, or an error.
    Bad,
}

impl Tone {
    fn style(self) -> Style {
        let colour = |colour: AnsiColor| colour.on_default().bold();
        match self {
            Self::Plain => Style::new(),
            Self::Heading => Style::new().bold(),
            Self::Good => colour(AnsiColor::Green),
            Self::Bad => colour(AnsiColor::Red),
        }
    }
}

/// A line in pieces.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Line(Vec<(Tone, String)>);

impl Line {
    /// A line that begins with a piece.
    pub fn of(tone: Tone, text: impl Into<String>) -> Self {
        Self::default().then(tone, text)
    }

    /// A line without colours.
    pub fn plain(text: impl Into<String>) -> Self {
        Self::of(Tone::Plain, text)
    }

    /// The same line with another piece.
    pub fn then(mut self, tone: Tone, text: impl Into<String>) -> Self {
        self.0.push((tone, text.into()));
        self
    }

    /// The line with what a terminal makes colours of.
    fn coloured(&self) -> String {
        let piece = |(tone, text): &(Tone, String)| {
            let style = tone.style();
            format!("{style}{}{style:#}", harmless(text))
        };
        self.0.iter().map(piece).collect()
    }
}

/// Prints a line to standard output; a reader that has gone away, as in `railspring schema | head`, is no error.
///
/// # Errors
/// [`InputError`] with key `standard output` if it cannot be written for another reason, as on a full device.
pub fn say(line: &str) -> Result<(), Error> {
    say_line(&Line::plain(line))
}

/// Prints a line in pieces to standard output.
///
/// # Errors
/// As [`say`].
pub(super) fn say_line(line: &Line) -> Result<(), Error> {
    let mut out = AutoStream::auto(std::io::stdout().lock());
    written(writeln!(out, "{}", line.coloured()).and_then(|()| out.flush()))
}

/// Writes bytes to standard output as they are.
///
/// # Errors
/// As [`say`].
pub(super) fn print(bytes: &[u8]) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    written(out.write_all(bytes).and_then(|()| out.flush()))
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
    remark_line(&Line::plain(line));
}

/// Writes an error to standard error if anybody can hear it.
pub fn complain(message: &str) {
    remark_line(&Line::of(Tone::Bad, "error:").then(Tone::Plain, format!(" {message}")));
}

fn remark_line(line: &Line) {
    let _ = writeln!(AutoStream::auto(std::io::stderr().lock()), "{}", line.coloured());
}

/// The lines of a text without what does a terminal harm.
fn harmless(text: &str) -> String {
    text.split('\n').map(|line| printable(line.into(), usize::MAX)).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: what a terminal makes colours of stands around a piece, and what a text brings of it is spelled out.
    #[test]
    fn only_the_program_colours_a_line() {
        let line = Line::of(Tone::Bad, "FAILS").then(Tone::Plain, " a\u{1b}[2Jb");
        let coloured = line.coloured();
        assert!(coloured.starts_with("\u{1b}["), "{coloured:?}");
        assert_eq!(anstream::adapter::strip_str(&coloured).to_string(), "FAILS a\\u{1b}[2Jb");
        assert_eq!(Line::plain("plain").coloured(), "plain");
    }
}
