//! The groups of a DXF file: pairs of lines, a group code and its value; and the groups of one entity.

use nalgebra::Point2;

use crate::error::{Error, Result};
use crate::profile_file::text::{DecimalMark, error_on, lines, number};

/// A group: its code, its value and the line of the value.
#[derive(Clone, Copy)]
pub(super) struct Group<'a> {
    pub code: i32,
    pub value: &'a str,
    pub line: usize,
}

/// The groups of an entity after its name.
pub(super) struct Groups<'a> {
    pub file: &'a str,
    pub name: &'a str,
    pub line: usize,
    pub of: Vec<Group<'a>>,
}

impl Groups<'_> {
    pub fn number_of(&self, group: &Group) -> Result<f64> {
        number(group.value.trim(), DecimalMark::Point).ok_or_else(|| {
            let expected = format!("a finite number (group {} of {})", group.code, self.name);
            error_on(self.file, group.line, group.value, expected, "export the drawing again")
        })
    }

    pub fn last(&self, code: i32) -> Result<Option<f64>> {
        self.of.iter().rev().find(|group| group.code == code).map(|group| self.number_of(group)).transpose()
    }

    pub fn required(&self, code: i32) -> Result<f64> {
        self.last(code)?.ok_or_else(|| self.missing(code))
    }

    pub fn missing(&self, code: i32) -> Error {
        let expected = format!("{} with group {code}", self.name);
        error_on(self.file, self.line, self.name, expected, "export the drawing again")
    }

    pub fn all(&self, code: i32) -> Result<Vec<f64>> {
        self.of.iter().filter(|group| group.code == code).map(|group| self.number_of(group)).collect()
    }

    pub fn flags(&self, code: i32) -> Result<i64> {
        Ok(self.last(code)?.unwrap_or(0.0) as i64)
    }

    pub fn layer(&self) -> String {
        self.of.iter().find(|group| group.code == 8).map_or("0", |group| group.value.trim()).to_owned()
    }

    /// The text of the first group with this code, without blanks around it; none is empty.
    pub fn word(&self, code: i32) -> &str {
        self.of.iter().find(|group| group.code == code).map_or("", |group| group.value.trim())
    }

    /// Points whose x has this group, with their z, and their lines.
    pub fn points(&self, code: i32) -> Result<Vec<(Point2<f64>, f64, usize)>> {
        let mut points: Vec<(Point2<f64>, f64, usize)> = Vec::new();
        for group in &self.of {
            if group.code == code {
                points.push((Point2::new(self.number_of(group)?, f64::NAN), 0.0, group.line));
            } else if let Some(last) = points.last_mut() {
                if group.code == code + 10 {
                    last.0.y = self.number_of(group)?;
                } else if group.code == code + 20 {
                    last.1 = self.number_of(group)?;
                }
            }
        }
        if points.iter().any(|(p, _, _)| p.y.is_nan()) { Err(self.missing(code + 10)) } else { Ok(points) }
    }

    /// Whether the entity's own axes are those of the drawing (`Some(false)`), have x turned over (`Some(true)`), or
    /// lie in another plane.
    pub fn mirrored(&self) -> Result<Option<bool>> {
        /// Largest sine of an angle that is rounding.
        const ROUNDING: f64 = 1e-9;
        let normal =
            [self.last(210)?.unwrap_or(0.0), self.last(220)?.unwrap_or(0.0), self.last(230)?.unwrap_or(1.0)];
        let across = normal[0].hypot(normal[1]);
        Ok((across <= ROUNDING * normal[2].abs()).then_some(normal[2] < 0.0))
    }
}

/// The groups of a file. Comments (999) are left out; empty lines at the end are none.
pub(super) fn groups<'a>(name: &'a str, text: &'a str) -> impl Iterator<Item = Result<Group<'a>>> {
    let mut lines = lines(text);
    std::iter::from_fn(move || {
        loop {
            let (n, code) = lines.next()?;
            let value = lines.next();
            if code.trim().is_empty() && value.is_none_or(|(_, value)| value.trim().is_empty()) {
                return None;
            }
            let Ok(code) = code.trim().parse::<i32>() else {
                let expected = "a group code, a whole number alone on its line";
                return Some(Err(error_on(
                    name,
                    n,
                    code.trim(),
                    expected,
                    "export the drawing as ASCII DXF again",
                )));
            };
            let Some((line, value)) = value else {
                let expected = "a value after the group code";
                return Some(Err(error_on(
                    name,
                    n,
                    "",
                    expected,
                    "the file is cut off: export the drawing again",
                )));
            };
            if code != 999 {
                return Some(Ok(Group { code, value, line }));
            }
        }
    })
}
