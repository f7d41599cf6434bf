//! The generating dimensions of the standard rails, as their drawings give them: a row each of the table `rails.csv`.

use std::sync::LazyLock;

use super::table::rows;
use crate::error::{Error, Result, on_line};

/// Name of the table, for messages.
const FILE: &str = "rails.csv";
/// The table; its comments say what the columns are.
const TABLE: &str = include_str!("rails.csv");

/// A standard rail.
pub struct StandardRail {
    /// Name, spelled as the standard does.
    pub name: &'static str,
    /// What it is and, where that is not sure, what it was checked against.
    pub description: &'static str,
    row: Row,
}

/// The standard rails. Sources and checks: `data/profiles/README.md`.
pub static STANDARD_RAILS: LazyLock<Vec<StandardRail>> = LazyLock::new(|| table(TABLE));

/// Their names.
pub static RAIL_NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| STANDARD_RAILS.iter().map(|rail| rail.name).collect());

/// The rails of a table.
fn table(text: &'static str) -> Vec<StandardRail> {
    let mut rows = rows(text);
    let heading = rows.next().map_or("", |(_, heading)| heading);
    let rail = |(line, text): (usize, &'static str)| {
        let row = Row { line, heading, text };
        let word = |column| row.cell(column).unwrap_or_default();
        StandardRail { name: word("name"), description: word("description"), row }
    };
    rows.map(rail).collect()
}

/// What the drawing of a flat-bottom rail gives, mm; depths count from the top of the rail, slopes are depth over width.
pub(super) struct Drawing {
    pub head: Head,
    /// Slope of the underside of the head and of the inner top of the foot.
    pub fishing_slope: f64,
    pub web: Web,
    pub foot: Foot,
}

pub(super) struct Head {
    /// Radii of the arcs from the crown to the side.
    pub radii: Vec<f64>,
    /// Half-widths at which each radius gives way to the next.
    pub joints: Vec<f64>,
    /// Inclination of the side: width over depth.
    pub side_slope: f64,
    /// Radius of the lower corner, between the straight side and the underside.
    pub lower_corner: f64,
    /// Apex of the slopes of the underside, on the axis.
    pub apex: f64,
}

pub(super) struct Web {
    /// Half of the least thickness; the sides are straight where no arc of the necks is.
    pub half_thickness: f64,
    /// From the underside of the head into the web.
    pub upper: Neck,
    /// From the web into the foot.
    pub lower: Neck,
}

/// Concave arcs between a sloping line and the side of the web.
pub(super) struct Neck {
    pub fillet: f64,
    pub middle: Option<Middle>,
    /// Arc of the web's side; without one the side is straight up to the fillet.
    pub side: Option<SideArc>,
}

/// An arc between the fillet and the arc of the web's side, whose centre lies `rise` beyond that of the latter.
pub(super) struct Middle {
    pub radius: f64,
    pub rise: f64,
}

/// Arc of the web's side, which is thinnest at `depth`.
pub(super) struct SideArc {
    pub radius: f64,
    pub depth: f64,
}

pub(super) struct Foot {
    /// Apex of the inner slopes of the top, on the axis.
    pub apex: f64,
    /// Outer part of the top; without one the inner slope runs on to the toe.
    pub outer: Option<OuterTop>,
    pub half_width: f64,
    /// Radii of the upper and lower rounding of the toe.
    pub toe: [f64; 2],
    /// Height of the rail.
    pub bottom: f64,
}

pub(super) struct OuterTop {
    /// Radius between inner and outer slope.
    pub bend: f64,
    pub slope: f64,
    /// Depth at which the outer slope and the toe would meet in a sharp corner.
    pub corner_depth: f64,
}

impl Neck {
    /// A fillet to a straight side.
    pub(super) const fn plain(fillet: f64) -> Self {
        Self { fillet, middle: None, side: None }
    }

    /// A fillet to an arc of the web's side.
    fn to_arc(fillet: f64, radius: f64, depth: f64) -> Self {
        Self { fillet, middle: None, side: Some(SideArc { radius, depth }) }
    }

    /// A fillet, a middle arc (`middle`: radius and rise), and an arc of the web's side.
    fn with_middle(fillet: f64, [middle, rise]: [f64; 2], radius: f64, depth: f64) -> Self {
        Self { middle: Some(Middle { radius: middle, rise }), ..Self::to_arc(fillet, radius, depth) }
    }
}

/// A row of the table.
#[derive(Clone, Copy)]
struct Row {
    line: usize,
    heading: &'static str,
    text: &'static str,
}

impl Row {
    fn cell(&self, column: &str) -> Option<&'static str> {
        let mut cells = self.heading.split(';').zip(self.text.split(';'));
        cells.find(|(name, _)| name.trim() == column).map(|(_, cell)| cell.trim())
    }

    fn refuse(&self, column: &str, expected: &str) -> Error {
        let value = format!("{column} = {:?}", self.cell(column).unwrap_or_default());
        on_line(FILE, self.line, value, expected, "correct or complete the row")
    }

    /// The numbers of a cell; a slope 1:20 is 1 over 20.
    fn numbers(&self, column: &str) -> Result<Vec<f64>> {
        let number = |word: &str| -> Option<f64> {
            let (over, under) = word.split_once(':').unwrap_or((word, "1"));
            let value = over.parse::<f64>().ok()? / under.parse::<f64>().ok()?;
            (value.is_finite() && value >= 0.0).then_some(value)
        };
        let words = self.cell(column).unwrap_or_default().split_whitespace();
        words
            .map(number)
            .collect::<Option<_>>()
            .ok_or_else(|| self.refuse(column, "numbers from 0, or slopes 1:20"))
    }

    fn all<const N: usize>(&self, column: &str) -> Result<[f64; N]> {
        let counted = |_| self.refuse(column, &format!("as many numbers as its heading says: {N}"));
        self.numbers(column)?.try_into().map_err(counted)
    }

    fn one(&self, column: &str) -> Result<f64> {
        self.all(column).map(|[value]| value)
    }

    fn neck(&self, column: &str) -> Result<Neck> {
        match *self.numbers(column)? {
            [fillet] => Ok(Neck::plain(fillet)),
            [fillet, radius, depth] => Ok(Neck::to_arc(fillet, radius, depth)),
            [fillet, middle, rise, radius, depth] => {
                Ok(Neck::with_middle(fillet, [middle, rise], radius, depth))
            }
            _ => Err(self.refuse(column, "1, 3 or 5 numbers")),
        }
    }
}

impl StandardRail {
    /// Its drawing.
    ///
    /// # Errors
    /// [`crate::error::InputError`] with the line of the table for a row that is no drawing.
    pub(super) fn drawing(&self) -> Result<Drawing> {
        let row = &self.row;
        let head = Head {
            radii: row.numbers("radii")?,
            joints: row.numbers("joints")?,
            side_slope: row.one("side_slope")?,
            lower_corner: row.one("lower_corner")?,
            apex: row.one("head_apex")?,
        };
        if head.radii.len() != head.joints.len() + 1 {
            return Err(row.refuse("joints", "one number less than radii"));
        }
        let outer = match row.numbers("outer_top")?.len() {
            0 => None,
            _ => row
                .all("outer_top")
                .map(|[bend, slope, corner_depth]| Some(OuterTop { bend, slope, corner_depth }))?,
        };
        let web = Web {
            half_thickness: row.one("half_web")?,
            upper: row.neck("upper_neck")?,
            lower: row.neck("lower_neck")?,
        };
        let foot = Foot {
            apex: row.one("foot_apex")?,
            outer,
            half_width: row.one("half_foot")?,
            toe: row.all("toe")?,
            bottom: row.one("height")?,
        };
        if !(head.apex < foot.apex && foot.apex < foot.bottom && web.half_thickness < foot.half_width) {
            return Err(
                row.refuse("height", "head, web and foot below each other, and a web narrower than the foot")
            );
        }
        Ok(Drawing { head, fishing_slope: row.one("fishing_slope")?, web, foot })
    }

    /// The error of a drawing whose arcs do not reach each other.
    pub(super) fn refuse_arcs(&self) -> Error {
        self.row.refuse("radii", "arcs and slopes that reach each other, here or in another column")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heading and first row of the table.
    fn example() -> (&'static str, &'static str) {
        let mut rows = rows(TABLE).map(|(_, row)| row);
        (rows.next().unwrap(), rows.next().unwrap())
    }

    /// Source: rows that differ from that of 60E1 in one cell. Goal: what is no drawing is refused, with the line and the column. Exact.
    #[test]
    fn a_row_that_is_no_drawing_is_refused() {
        let (heading, row) = example();
        for (cell, other, column) in [
            (";300 80 13;", ";300 80;", "joints"),
            (";300 80 13;", ";300 eighty 13;", "radii"),
            (";1:2.75;", ";1:0;", "fishing_slope"),
            (";1:2.75;", ";;", "fishing_slope"),
            (";51;", ";-51;", "head_apex"),
            (";51;", ";151;", "height"),
            (";7 35 19.5 120 79.75;", ";7 35;", "upper_neck"),
            (";40 1:14 160.5;", ";40 1:14;", "outer_top"),
            (";172", "", "height"),
        ] {
            assert_eq!(row.matches(cell).count(), 1, "{cell}");
            let text = format!("# a comment\n{heading}\n{}\n", row.replace(cell, other));
            let rails = table(text.leak());
            assert_eq!((rails.len(), rails[0].name), (1, "60E1"));
            let refused = rails[0].drawing().err().unwrap().to_string();
            assert!(refused.contains("rails.csv:3") && refused.contains(column), "{cell} {other}: {refused}");
        }
    }

    /// Goal: every row has a cell for every column, and a name that no other has. Exact.
    #[test]
    fn the_table_is_complete() {
        let columns = example().0.split(';').count();
        assert!(rows(TABLE).all(|(_, row)| row.split(';').count() == columns));
        let names: std::collections::BTreeSet<_> = RAIL_NAMES.iter().collect();
        assert!(names.len() == RAIL_NAMES.len() && !names.contains(&""));
        assert!(STANDARD_RAILS.iter().all(|rail| rail.drawing().is_ok() && !rail.description.is_empty()));
    }
}
