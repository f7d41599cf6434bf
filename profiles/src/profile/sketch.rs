//! A line as its file draws it, with the places at which it is at fault.

use nalgebra::Point2;

/// The axes of what lies as its file has it.
pub(crate) const OF_THE_FILE: &str = "in the axes of the file";
/// The axes of a table of lines and arcs, which says how it lies.
pub(crate) const OF_THE_PROFILE: &str = "y to the field side, z down";

/// Faults at the ends of a line that should be closed.
const BEGINS: &str = "begins here, open";
const ENDS: &str = "ends here, open";

/// An outline or a running surface as it is drawn, and the places at which it is at fault, m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sketch {
    /// Its connected parts, points along each; none where the file has no line.
    pub strokes: Vec<Vec<Point2<f64>>>,
    /// Places at which it is open, steps, turns back or crosses itself, and which of these it is.
    pub faults: Vec<(Point2<f64>, String)>,
    /// The axes of both, in words.
    pub axes: &'static str,
}

impl Sketch {
    /// Replaces what is drawn.
    pub(crate) fn draw(&mut self, strokes: Vec<Vec<Point2<f64>>>, axes: &'static str) {
        (self.strokes, self.axes) = (strokes, axes);
    }

    /// The one line that is drawn, if it is open: a running surface alone, perhaps.
    pub fn open_line(&self) -> Option<&[Point2<f64>]> {
        let [stroke] = &self.strokes[..] else { return None };
        (self.faults.iter().filter(|(_, fault)| [BEGINS, ENDS].contains(&fault.as_str())).count() == 2)
            .then_some(stroke)
    }

    /// Marks the ends of a line that should be closed.
    pub(crate) fn mark_ends(&mut self, begin: Point2<f64>, end: Point2<f64>) {
        self.mark(begin, BEGINS);
        self.mark(end, ENDS);
    }

    /// Marks a place.
    pub(crate) fn mark(&mut self, at: Point2<f64>, fault: impl Into<String>) {
        self.faults.push((at, fault.into()));
    }
}
