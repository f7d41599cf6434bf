//! The blocks of a drawing as the file has them, and what an `INSERT` says.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Point2, Rotation2, Vector2};

use super::groups::Groups;
use super::placement::Placement;
use crate::error::Result;
use crate::profile_file::text::{error_on, shown};

/// Blocks that are named.
const LISTED: usize = 8;

/// A block at a place, in rows and columns if there are several.
#[derive(Debug, Clone)]
pub(super) struct Insert {
    /// Name of the block as it is written.
    pub block: String,
    at: Vector2<f64>,
    scale: [f64; 2],
    /// rad.
    rotation: f64,
    /// Whether x is turned over after all else.
    mirrored: bool,
    /// Columns and rows.
    pub counts: [usize; 2],
    /// Distances of columns and rows.
    spacing: Vector2<f64>,
}

impl Insert {
    /// The insertion that an entity says; none in another plane.
    pub fn of(groups: &Groups) -> Result<Option<Self>> {
        for code in [41, 42] {
            if let Some(group) = groups.of.iter().rev().find(|group| group.code == code)
                && groups.number_of(group)? == 0.0
            {
                let expected = format!("a scale other than 0 (group {code} of INSERT)");
                let remedy = "insert the block with its scale, and export the drawing again";
                return Err(error_on(groups.file, group.line, group.value.trim(), expected, remedy));
            }
        }
        let Some(mirrored) = groups.mirrored()? else { return Ok(None) };
        let (at, _, _) = *groups.points(10)?.first().ok_or_else(|| groups.missing(10))?;
        let or = |code: i32, without: f64| groups.last(code).map(|value| value.unwrap_or(without));
        let count = |code: i32| or(code, 1.0).map(|count| count.max(1.0) as usize);
        Ok(Some(Self {
            block: groups.word(2).to_owned(),
            at: at.coords,
            scale: [or(41, 1.0)?, or(42, 1.0)?],
            rotation: or(50, 0.0)?.to_radians(),
            mirrored,
            counts: [count(70)?, count(71)?],
            spacing: Vector2::new(or(44, 0.0)?, or(45, 0.0)?),
        }))
    }

    /// Where the block with this base point goes, in this column and row: the rows are turned with the block, and not
    /// scaled.
    pub fn placement(&self, base: Point2<f64>, [column, row]: [usize; 2]) -> Placement {
        let turned = Rotation2::new(self.rotation);
        let [x, y] = self.scale;
        let linear = turned.into_inner() * Matrix2::new(x, 0.0, 0.0, y);
        let further = turned * Vector2::new(column as f64 * self.spacing.x, row as f64 * self.spacing.y);
        let put = Placement { linear, shift: self.at + further - linear * base.coords };
        if self.mirrored { Placement::mirror().after(&put) } else { put }
    }
}

/// A block as the file has it.
pub(super) struct Block<'a> {
    /// BLOCK itself: name, base point, what kind of block it is.
    pub head: Groups<'a>,
    /// What it consists of; not looked at unless the block is inserted.
    pub entities: Vec<Groups<'a>>,
    /// The line of another block with this name.
    pub again: Option<usize>,
}

/// The blocks of a drawing by their names in lower case.
#[derive(Default)]
pub(super) struct Blocks<'a> {
    pub of: BTreeMap<String, Block<'a>>,
    /// Name of the block whose entities are read.
    open: Option<String>,
}

impl<'a> Blocks<'a> {
    /// Adds the next groups of the section of blocks.
    pub fn add(&mut self, groups: Groups<'a>) {
        match groups.name {
            "BLOCK" => {
                let (key, line) = (groups.word(2).to_lowercase(), groups.line);
                if let Some(block) = self.of.get_mut(&key) {
                    block.again = Some(line);
                    self.open = None;
                } else {
                    self.of.insert(key.clone(), Block { head: groups, entities: Vec::new(), again: None });
                    self.open = Some(key);
                }
            }
            "ENDBLK" => self.open = None,
            _ => {
                if let Some(block) = self.open.as_ref().and_then(|key| self.of.get_mut(key)) {
                    block.entities.push(groups);
                }
            }
        }
    }

    /// The names of the blocks that users make, for messages; none is empty.
    pub fn list(&self) -> String {
        // Those of layouts, dimensions and hatches begin with a star.
        let names = self.of.values().map(|block| block.head.word(2)).filter(|name| !name.starts_with('*'));
        listed(names)
    }
}

/// Some names in quotes.
pub(super) fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let all: Vec<&str> = names.collect();
    let mut list: Vec<String> = all.iter().take(LISTED).map(|name| format!("\"{}\"", shown(name))).collect();
    if all.len() > LISTED {
        list.push(format!("and {} more", all.len() - LISTED));
    }
    list.join(", ")
}
