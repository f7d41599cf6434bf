//! Blocks of a drawing where `INSERT` puts them: moved, turned, scaled and turned over, and one in another.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use nalgebra::Point2;

use super::blocks::{Blocks, Insert, listed};
use super::entities::{Entity, Shape, entities_of};
use super::placement::Placement;
use crate::error::{Error, Result};
use crate::profile_file::finding::{Action, Finding, FindingKind};
use crate::profile_file::text::error_on;

/// Most blocks that lie one in another; drawings have two or three.
const DEEPEST: usize = 16;
/// Most entities that the blocks of a drawing come to where they are inserted.
const MOST: usize = 1_000_000;

/// The entities with those of the blocks in the place of their insertions, and a finding that names the blocks. On layer
/// 0 of a block they are on the layer of its insertion.
///
/// # Errors
/// [`crate::error::InputError`] with the line of the insertion for a block that there is not or that is there twice, that
/// contains itself, and for too many blocks one in another or too many entities.
pub(super) fn in_place(
    blocks: &Blocks<'_>,
    file: &str,
    entities: Vec<Entity>,
) -> Result<(Vec<Entity>, Option<Finding>)> {
    let lines = entities.iter().filter(|e| matches!(e.shape, Shape::Insert(_))).map(|e| e.line);
    let Some((first, last)) = lines.clone().min().zip(lines.max()) else { return Ok((entities, None)) };
    let mut filling =
        Filling { file, blocks, read: BTreeMap::new(), within: Vec::new(), found: Vec::new(), copied: 0 };
    for entity in entities {
        filling.put(&entity, &entity.layer, &Placement::identity())?;
    }
    let names: BTreeSet<&str> = filling.read.values().map(|(name, _)| *name).collect();
    let text = format!("blocks, read where the drawing inserts them: {}", listed(names.into_iter()));
    let finding = Finding::new(FindingKind::Columns, Action::Noted, text).on_lines(first, last);
    Ok((filling.found, Some(finding)))
}

/// A drawing that is being filled with its blocks.
struct Filling<'b, 'a> {
    file: &'b str,
    blocks: &'b Blocks<'a>,
    /// Name and entities of the blocks that were inserted so far, by their names in lower case.
    read: BTreeMap<String, (&'b str, Rc<Vec<Entity>>)>,
    /// The blocks within which the next entity lies.
    within: Vec<String>,
    found: Vec<Entity>,
    /// Entities of blocks so far.
    copied: usize,
}

impl Filling<'_, '_> {
    /// Puts an entity on a layer, and what it inserts.
    fn put(&mut self, entity: &Entity, layer: &str, placement: &Placement) -> Result<()> {
        let shape = match &entity.shape {
            Shape::Insert(insert) => return self.insert(insert, entity.line, layer, placement),
            Shape::Path(path) => Shape::Path(path.placed(placement)),
            Shape::Point(at) => Shape::Point(placement.of(*at)),
            other => other.clone(),
        };
        self.found.push(Entity { layer: layer.to_owned(), line: entity.line, shape });
        Ok(())
    }

    fn insert(&mut self, insert: &Insert, line: usize, layer: &str, placement: &Placement) -> Result<()> {
        /// Bits of a block whose entities are in another file, without and with blocks of its own in it.
        const EXTERNAL: i64 = 4 | 8;
        let key = insert.block.to_lowercase();
        let Some(block) = self.blocks.of.get(&key) else {
            let expected = "the name of a block that the drawing has";
            let remedy = "export the drawing with its blocks, or explode this one before";
            return Err(self.refuse(line, &insert.block, expected, remedy));
        };
        if let Some(again) = block.again {
            let expected =
                format!("one block of this name; lines {} and {again} have one each", block.head.line);
            return Err(self.refuse(line, &insert.block, &expected, "rename one of the two"));
        }
        if self.within.contains(&key) {
            let value =
                self.within.iter().chain([&key]).rev().map(String::as_str).collect::<Vec<_>>().join(" in ");
            let remedy = "take the block out of itself, or explode it before the export";
            return Err(self.refuse(line, &value, "blocks that do not contain themselves", remedy));
        }
        if self.within.len() == DEEPEST {
            let value = format!("more than {DEEPEST} blocks, one in another");
            let remedy = "explode the outer ones before the export";
            return Err(self.refuse(line, &value, "blocks in a few blocks", remedy));
        }
        if block.head.flags(70)? & EXTERNAL != 0 {
            let shape = Shape::Unread("INSERT of another drawing".into());
            self.found.push(Entity { layer: layer.to_owned(), line, shape });
            return Ok(());
        }
        let [columns, rows] = insert.counts;
        let base = block.head.points(10)?.first().map_or(Point2::origin(), |point| point.0);
        let entities = match self.read.get(&key) {
            Some((_, entities)) => Rc::clone(entities),
            None => {
                let entities = Rc::new(entities_of(&block.entities)?);
                self.read.insert(key.clone(), (block.head.word(2), Rc::clone(&entities)));
                entities
            }
        };
        let copies = columns.saturating_mul(rows);
        self.copied = self.copied.saturating_add(copies.saturating_mul(entities.len().max(1)));
        if self.copied > MOST {
            let expected = format!("blocks with at most {MOST} entities altogether where they are inserted");
            let remedy = "export the profile alone, without the rest of the drawing";
            return Err(self.refuse(line, &insert.block, &expected, remedy));
        }
        self.within.push(key);
        for copy in 0..copies {
            let here = placement.after(&insert.placement(base, [copy % columns, copy / columns]));
            for entity in entities.iter() {
                let layer = if entity.layer == "0" { layer } else { &entity.layer };
                self.put(entity, layer, &here)?;
            }
        }
        self.within.pop();
        Ok(())
    }

    fn refuse(&self, line: usize, value: &str, expected: &str, remedy: &str) -> Error {
        error_on(self.file, line, value, expected, remedy)
    }
}

#[cfg(test)]
mod tests;
