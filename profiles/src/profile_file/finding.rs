//! What was found in a profile file, and what was done about it.

use std::fmt;

/// What a finding is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum FindingKind {
    /// The header disagrees with the content, or lacks something.
    Header,
    /// Something in the file that is no part of the profile, or was not understood.
    PassedOver,
    /// The unit was inferred from the size.
    Unit,
    /// The columns were inferred from their content.
    Columns,
    /// The wheel or rail that the file says it is does not have the shape of one.
    Shape,
    /// y counts the other way.
    Mirrored,
    /// z counts the other way.
    UpsideDown,
    /// The origin was moved, or lies elsewhere than expected.
    Origin,
    /// The points run from the field side.
    Reversed,
    /// Points in no order along the profile.
    OutOfOrder,
    /// Points on top of each other.
    Duplicate,
    /// Points that step back, as from stitched scans.
    ZigZag,
    /// Points far off the line of their neighbours.
    Spike,
    /// The line crosses itself.
    Loop,
    /// A long step between neighbouring points.
    Gap,
    /// A real corner.
    Kink,
    /// Scatter about a smooth line.
    Noise,
    /// The profile ends within the range in which wheel and rail can touch.
    TooShort,
    /// Points were moved onto a smoothing spline.
    Smoothed,
    /// Points closer together than the curve needs.
    Thinned,
    /// The profile was turned and moved onto a standard section.
    Aligned,
    /// The profile was joined to a standard section.
    Joined,
}

impl FindingKind {
    /// Name in messages and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Header => "header",
            Self::PassedOver => "passed over",
            Self::Unit => "unit",
            Self::Columns => "columns",
            Self::Shape => "shape",
            Self::Mirrored => "mirrored",
            Self::UpsideDown => "upside down",
            Self::Origin => "origin",
            Self::Reversed => "reversed",
            Self::OutOfOrder => "out of order",
            Self::Duplicate => "duplicate",
            Self::ZigZag => "zig-zag",
            Self::Spike => "spike",
            Self::Loop => "loop",
            Self::Gap => "gap",
            Self::Kink => "kink",
            Self::Noise => "noise",
            Self::TooShort => "too short",
            Self::Smoothed => "smoothed",
            Self::Thinned => "thinned",
            Self::Aligned => "aligned",
            Self::Joined => "joined",
        }
    }
}

/// What became of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Worth knowing; nothing had to be done.
    Noted,
    /// Repaired as the text says.
    Repaired,
    /// Not repaired: the user should look at it.
    Left,
}

impl Action {
    /// Name in messages and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Noted => "noted",
            Self::Repaired => "repaired",
            Self::Left => "left",
        }
    }
}

/// Something found in a profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is about.
    pub kind: FindingKind,
    /// First and last line of the file that it concerns; `None` if it concerns the whole profile.
    pub lines: Option<(usize, usize)>,
    /// The value that gave rise to it, with its unit.
    pub value: Option<(f64, &'static str)>,
    /// What became of it.
    pub action: Action,
    /// What it is and what was done, in words.
    pub text: String,
}

impl Finding {
    /// A finding about the whole profile.
    pub fn new(kind: FindingKind, action: Action, text: impl Into<String>) -> Self {
        Self { kind, lines: None, value: None, action, text: text.into() }
    }

    pub(crate) fn on_lines(mut self, first: usize, last: usize) -> Self {
        self.lines = Some((first.min(last), first.max(last)));
        self
    }

    pub(crate) fn with_value(mut self, value: f64, unit: &'static str) -> Self {
        self.value = Some((value, unit));
        self
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.lines {
            Some((first, last)) if first == last => write!(f, "line {first}: ")?,
            Some((first, last)) => write!(f, "lines {first} to {last}: ")?,
            None => {}
        }
        write!(f, "{}", self.kind.name())?;
        if let Some((value, unit)) = self.value {
            write!(f, " {} {unit}", short(value))?;
        }
        write!(f, " ({}): {}", self.action.name(), self.text)
    }
}

/// Four significant digits.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// Collects findings of one kind; beyond a number of them only counts, so that a bad file gives no endless list.
pub(super) struct Findings<'a> {
    to: &'a mut Vec<Finding>,
    kind: FindingKind,
    listed: usize,
    more: Option<(usize, usize, usize, Action)>,
}

/// Most findings of one kind that are listed one by one.
const MOST_LISTED: usize = 20;

impl<'a> Findings<'a> {
    pub fn new(to: &'a mut Vec<Finding>, kind: FindingKind) -> Self {
        Self { to, kind, listed: 0, more: None }
    }

    pub fn add(&mut self, lines: (usize, usize), value: (f64, &'static str), action: Action, text: &str) {
        let (first, last) = (lines.0.min(lines.1), lines.0.max(lines.1));
        if self.listed < MOST_LISTED {
            self.listed += 1;
            let finding = Finding::new(self.kind, action, text);
            self.to.push(finding.on_lines(first, last).with_value(value.0, value.1));
        } else {
            let (count, from, to, _) = self.more.unwrap_or((0, first, last, action));
            self.more = Some((count + 1, from.min(first), to.max(last), action));
        }
    }
}

impl Drop for Findings<'_> {
    fn drop(&mut self) {
        if let Some((count, first, last, action)) = self.more {
            let text = format!("{count} more of this kind, dealt with alike");
            self.to.push(Finding::new(self.kind, action, text).on_lines(first, last));
        }
    }
}
