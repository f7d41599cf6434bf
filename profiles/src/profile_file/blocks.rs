//! Points of a file in blocks: which block is the profile.
//!
//! Lines without numbers part the points of a file. A block that goes on where the one before it ended belongs to it;
//! one that lies beside another, or that is headed as limits or a reference, does not.

use nalgebra::Point2;

use super::finding::{Action, Finding, FindingKind};
use super::measured::{MeasuredPoint, push};
use super::part::Part;
use super::rows::{Numbers, PassedOver, Row, broken, row};
use super::text::{DecimalMark, error_on, shown};
use crate::error::Result;

/// Longest step between two parts of one profile, as a part of its extent.
const LONGEST_STEP: f64 = 0.25;
/// Points nearer to another block than this part of its extent lie on it.
const ON_IT: f64 = 0.02;
/// Letters of a line that are compared with titles.
const LONGEST_TITLE_WORD: usize = 20;
/// Blocks that a message lists.
const LISTED: usize = 12;
/// Fewest points of a profile.
const FEWEST: usize = 4;

/// Points between two other lines.
struct Block {
    /// What heads it, if a line does.
    title: Option<String>,
    /// Whether it can go on the one before it.
    may_continue: bool,
    points: Vec<MeasuredPoint>,
}

/// Collects the points of a file.
pub(super) struct Blocks<'a> {
    name: &'a str,
    pub mark: DecimalMark,
    /// What is no point.
    pub passed: PassedOver,
    blocks: Vec<Block>,
    /// Whether the last line was a row.
    in_rows: bool,
    title: Option<String>,
    /// Whether the next row is none of the block before it.
    separate: bool,
    unit: Option<(f64, usize)>,
}

/// The points of the block that is the profile.
pub(super) struct Chosen {
    pub points: Vec<MeasuredPoint>,
    /// Unit that stands in the rows, m, and its line.
    pub unit: Option<(f64, usize)>,
    /// What was passed over.
    pub findings: Vec<Finding>,
}

impl<'a> Blocks<'a> {
    pub fn new(name: &'a str, mark: DecimalMark) -> Self {
        let (passed, blocks) = (PassedOver::default(), Vec::new());
        Self { name, mark, passed, blocks, in_rows: false, title: None, separate: false, unit: None }
    }

    /// Takes a line if it is a row; its numbers if it is a point.
    ///
    /// # Errors
    /// A row of a block that has one coordinate alone, another unit than the rows before it, or too many points.
    pub fn line(&mut self, n: usize, text: &str, columns: (usize, usize)) -> Result<bool> {
        match row(text, self.mark, columns) {
            Row::Point(numbers) => self.point(n, text, &numbers).map(|()| true),
            Row::NoValues if self.in_rows => {
                self.passed.no_values(n);
                Ok(true)
            }
            Row::Broken(column, found) if self.in_rows => Err(broken(self.name, n, column, &found)),
            _ => Ok(false),
        }
    }

    fn point(&mut self, n: usize, text: &str, numbers: &Numbers) -> Result<()> {
        if let Some(unit) = numbers.unit {
            let stated = self.unit.get_or_insert((unit, n));
            if stated.0 != unit {
                let expected = format!("the unit of line {}", stated.1);
                return Err(error_on(self.name, n, &shown(text), expected, "give all rows in one unit"));
            }
        }
        self.passed.words(n, &numbers.words);
        if !self.in_rows {
            let title = self.title.take();
            let separate = std::mem::take(&mut self.separate);
            let may_continue = title.is_none() && !separate && !self.blocks.is_empty();
            self.blocks.push(Block { title, may_continue, points: Vec::new() });
            self.in_rows = true;
        }
        let Some(block) = self.blocks.last_mut() else { return Ok(()) };
        push(self.name, &mut block.points, numbers.y, numbers.z, n, 1.0)
    }

    /// A line that is no row: the next row may begin another block.
    pub fn part(&mut self) {
        self.in_rows = false;
    }

    /// A line that says that measured points follow; `anew` if other measured points came before.
    pub fn measured(&mut self, anew: bool) {
        self.part();
        self.title = None;
        self.separate = anew || self.blocks.last().is_some_and(|block| block.title.is_some());
    }

    /// Number of points of the block that was begun last.
    pub fn last_count(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.points.len())
    }

    /// A line that heads what follows.
    pub fn head(&mut self, title: &str) {
        self.part();
        self.title = Some(shown(title));
    }

    /// Chooses the profile: the block of this name or number, or else the only one that can be the profile.
    ///
    /// # Errors
    /// Several blocks that can, or none of that name; no points.
    pub fn choose(mut self, part: &Part, announced: Option<usize>) -> Result<Chosen> {
        let mut blocks = joined(std::mem::take(&mut self.blocks));
        if blocks.is_empty() {
            let remedy = "give the file as the instrument writes it, with its points";
            return Err(error_on(self.name, 1, "no points", "rows of numbers, y and z in columns", remedy));
        }
        let worded = std::mem::take(&mut self.passed.worded);
        let mut findings = std::mem::take(&mut self.passed).findings();
        if part.name.is_none() {
            let is_other = |block: &Block| block.title.as_deref().is_some_and(is_other);
            if blocks.iter().any(|block| !is_other(block)) {
                let (others, rest) = blocks.into_iter().partition(is_other);
                pass_over(others, "limits or a reference, not the measured profile", &mut findings);
                blocks = rest;
            }
            if blocks.iter().any(|block| block.points.len() >= FEWEST) {
                let (small, rest) = blocks.into_iter().partition(|block: &Block| block.points.len() < FEWEST);
                pass_over(small, "too few points for a profile", &mut findings);
                blocks = rest;
            }
            let (again, rest) = repeated(blocks);
            pass_over(again, "the same points again", &mut findings);
            blocks = rest;
            if blocks.len() > 1
                && let [chosen] = blocks
                    .iter()
                    .enumerate()
                    .filter(|(_, block)| Some(block.points.len()) == announced)
                    .map(|(i, _)| i)
                    .collect::<Vec<_>>()[..]
            {
                let profile = blocks.swap_remove(chosen);
                pass_over(blocks, "not the points that XYPoints counts", &mut findings);
                blocks = vec![profile];
            }
        }
        let number = |part: &str| part.trim().parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let chosen = match part.name {
            None if blocks.len() == 1 => Some(0),
            None => None,
            Some(part) => blocks
                .iter()
                .position(|block| block.title.as_deref().is_some_and(|title| plain(title) == plain(part)))
                .or_else(|| number(part).filter(|i| *i < blocks.len())),
        };
        let Some(chosen) = chosen else { return Err(self.several(&blocks, part)) };
        let mut profile = blocks.remove(chosen);
        drop_strangers(&mut profile.points, &worded, &mut findings);
        pass_over(blocks, "another part of the file", &mut findings);
        Ok(Chosen { points: profile.points, unit: self.unit, findings })
    }

    fn several(&self, blocks: &[Block], part: &Part) -> crate::error::Error {
        let line =
            blocks.get(1).or(blocks.first()).and_then(|block| block.points.first()).map_or(1, |p| p.line);
        let mut list: Vec<String> =
            blocks.iter().enumerate().take(LISTED).map(|(i, block)| describe(i, block)).collect();
        if blocks.len() > LISTED {
            list.push(format!("and {} more", blocks.len() - LISTED));
        }
        let list = list.join("; ");
        let field = &part.field;
        match part.name {
            Some(part) => error_on(
                self.name,
                line,
                part,
                format!("the name or the number of a part of the file: {list}"),
                format!("give {field} as one of them, or leave it out where there is only one"),
            ),
            None => error_on(
                self.name,
                line,
                &format!("{} profiles", blocks.len()),
                format!("a single profile; the file has {list}"),
                format!("say which of them is the profile: give {field}, its name or number"),
            ),
        }
    }
}

/// Drops rows that are no neighbours of the points: lines of words that begin with two numbers, and before the first
/// row one with the number of rows. `worded` are the lines with words after their numbers.
pub(super) fn drop_strangers(points: &mut Vec<MeasuredPoint>, worded: &[usize], findings: &mut Vec<Finding>) {
    /// A neighbour is nearer than this many median steps.
    const NEIGHBOUR: f64 = 20.0;
    /// Words on more than this share of the rows belong to the rows.
    const COMMON: f64 = 0.1;
    let steps: Vec<f64> = points.windows(2).map(|w| (w[1].point - w[0].point).norm()).collect();
    let mut sorted = steps.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(far) = sorted.get(sorted.len() / 2).map(|median| NEIGHBOUR * median) else { return };
    let rare = (worded.len() as f64) < COMMON * points.len() as f64;
    let alone = |i: usize| {
        let before = i.checked_sub(1).is_none_or(|before| steps[before] > far);
        before && steps.get(i).is_none_or(|step| *step > far)
    };
    let rows = (points.len() - 1) as f64;
    let stranger = |i: usize| {
        let counts = i == 0 && points[0].point.iter().any(|value| *value == rows);
        alone(i) && (counts || (rare && worded.binary_search(&points[i].line).is_ok()))
    };
    let strangers: Vec<usize> = (0..points.len()).filter(|i| stranger(*i)).collect();
    for i in strangers.into_iter().rev() {
        let text = "two numbers of a heading or a sentence, far from the points: no point";
        let line = points.remove(i).line;
        findings.push(Finding::new(FindingKind::PassedOver, Action::Noted, text).on_lines(line, line));
    }
}

/// A title in small letters without blanks.
fn plain(title: &str) -> String {
    title.to_lowercase().chars().filter(|c| !c.is_whitespace()).collect()
}

fn lines(block: &Block) -> (usize, usize) {
    (block.points[0].line, block.points[block.points.len() - 1].line)
}

fn describe(index: usize, block: &Block) -> String {
    let (first, last) = lines(block);
    let title = block.title.as_ref().map(|title| format!(" \"{title}\"")).unwrap_or_default();
    format!("{}{title} (lines {first} to {last}, {} points)", index + 1, block.points.len())
}

fn pass_over(blocks: Vec<Block>, why: &str, findings: &mut Vec<Finding>) {
    for block in blocks {
        let (first, last) = lines(&block);
        let title = block.title.map(|title| format!(" of \"{title}\"")).unwrap_or_default();
        let count = if first == last { "1 point".into() } else { format!("{} points", block.points.len()) };
        let text = format!("{count}{title}: {why}");
        findings.push(Finding::new(FindingKind::PassedOver, Action::Noted, text).on_lines(first, last));
    }
}

/// Words in the titles of points that are no measured profile.
pub(super) const OTHERS: [&str; 10] = [
    "alarm",
    "limit",
    "reference",
    "refprofile",
    "nominal",
    "standard",
    "template",
    "target",
    "tolerance",
    "maintenance",
];

/// Whether a title is that of limits or a reference.
fn is_other(title: &str) -> bool {
    let plain = plain(title);
    OTHERS.iter().any(|word| plain.contains(word)) || plain == "ref"
}

/// Whether a line begins as the title of limits or a reference does.
pub(super) fn heads_others(line: &str) -> bool {
    let plain: String =
        line.to_lowercase().chars().filter(|c| c.is_alphanumeric()).take(LONGEST_TITLE_WORD).collect();
    OTHERS.iter().any(|word| plain.starts_with(word))
}

/// Joins blocks that go on where the one before them ended.
fn joined(blocks: Vec<Block>) -> Vec<Block> {
    let extent = extent(blocks.iter().flat_map(|block| &block.points));
    let mut joined: Vec<Block> = Vec::new();
    for block in blocks {
        match joined.last_mut() {
            Some(last) if block.may_continue && goes_on(&last.points, &block.points, extent) => {
                last.points.extend(block.points);
            }
            _ => joined.push(block),
        }
    }
    joined
}

/// Extent in both directions without the outermost 2 % of the points on either side.
pub(super) fn extent<'a>(points: impl Iterator<Item = &'a MeasuredPoint> + Clone) -> f64 {
    let spread = |mut values: Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        let cut = values.len() / 50;
        values.get(cut).map_or(0.0, |low| values[values.len() - 1 - cut] - low)
    };
    let y = spread(points.clone().map(|p| p.point.x).collect());
    y.hypot(spread(points.map(|p| p.point.y).collect()))
}

fn goes_on(before: &[MeasuredPoint], after: &[MeasuredPoint], extent: f64) -> bool {
    let (Some(end), Some(start)) = (before.last(), after.first()) else { return true };
    let (shorter, longer) = if before.len() < after.len() { (before, after) } else { (after, before) };
    (start.point - end.point).norm() <= LONGEST_STEP * extent && !lies_on(shorter, longer, extent)
}

/// Whether most of the points lie beside others.
fn lies_on(points: &[MeasuredPoint], others: &[MeasuredPoint], extent: f64) -> bool {
    /// Points that are looked at, and others that they are compared with.
    const MOST_POINTS: usize = 200;
    if points.len() < FEWEST {
        return false;
    }
    let thinned = |points: &[MeasuredPoint]| -> Vec<Point2<f64>> {
        points.iter().step_by(points.len().div_ceil(MOST_POINTS)).map(|p| p.point).collect()
    };
    let others = thinned(others);
    let sample = thinned(points);
    let near = |p: &Point2<f64>| others.iter().any(|q| (q - p).norm() < ON_IT * extent);
    2 * sample.iter().filter(|p| near(p)).count() > sample.len()
}

/// Blocks whose points have been given before, and the others.
fn repeated(blocks: Vec<Block>) -> (Vec<Block>, Vec<Block>) {
    let same = |a: &Block, b: &Block| {
        a.points.len() == b.points.len() && a.points.iter().zip(&b.points).all(|(p, q)| p.point == q.point)
    };
    let (mut again, mut first): (Vec<Block>, Vec<Block>) = (Vec::new(), Vec::new());
    for block in blocks {
        if first.iter().any(|before| same(before, &block)) { again.push(block) } else { first.push(block) }
    }
    (again, first)
}
