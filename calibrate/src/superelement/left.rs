//! What fronts leave between equations, in one piece of memory.
//!
//! Pieces by themselves would leave gaps between what else the program has, and the memory of a table would grow with them.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

/// Columns of a block of what a front leaves.
const COLUMNS: usize = 128;

/// Rows and columns of the blocks of columns that the lower triangle of a matrix of so many `rows` is kept in, one after the other.
fn blocks(rows: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..rows).step_by(COLUMNS).map(move |first| [rows - first, COLUMNS.min(rows - first)])
}

/// How many values the blocks of a matrix of so many `rows` have.
pub(super) fn values_of(rows: usize) -> usize {
    blocks(rows).map(|[rows, columns]| rows * columns).sum()
}

/// Where the values of a column of a matrix of so many `rows` are, and which row is the first of them.
fn column_of(rows: usize, column: usize) -> (Range<usize>, usize) {
    let block = column / COLUMNS;
    let first = block * COLUMNS;
    let before: usize = blocks(rows).take(block).map(|[rows, columns]| rows * columns).sum();
    let begin = before + (column - first) * (rows - first);
    (begin..begin + rows - first, first)
}

/// What a front has left between equations: the lower triangle, by blocks of columns.
pub(super) struct Left<'v> {
    pub rows: &'v [usize],
    pub values: &'v [f64],
}

impl Left<'_> {
    /// Hands over each equation with those from it on, and the values between it and these.
    pub fn each_column(&self, mut to: impl FnMut(usize, &[usize], &[f64])) {
        let mut values = self.values;
        for [height, width] in blocks(self.rows.len()) {
            let rows = &self.rows[self.rows.len() - height..];
            let (block, others) = values.split_at(height * width);
            for (c, column) in block.chunks_exact(height).enumerate() {
                to(rows[c], &rows[c..], &column[c..]);
            }
            values = others;
        }
    }

    /// Adds it to a front, the columns that it eliminates and what it leaves, in which the equations have these places.
    pub fn add_to(&self, mut panel: MatMut<'_, f64>, left: &mut [f64], place: &[usize]) {
        let eliminated = panel.ncols();
        let rest = panel.nrows() - eliminated;
        self.each_column(|column, rows, values| {
            let at = place[column];
            let (to, first) = match at < eliminated {
                true => {
                    let column = panel.as_mut().col_mut(at);
                    (column.try_as_col_major_mut().expect("column major").as_slice_mut(), 0)
                }
                false => {
                    let (column, first) = column_of(rest, at - eliminated);
                    (&mut left[column], eliminated + first)
                }
            };
            rows.iter().zip(values).for_each(|(row, value)| to[place[*row] - first] += value);
        });
    }
}

/// Subtracts `B·Bᵀ` from the blocks of a matrix.
pub(super) fn subtract_square(mut values: &mut [f64], b: MatRef<'_, f64>, threads: Par) {
    for [height, width] in blocks(b.nrows()) {
        let (block, others) = std::mem::take(&mut values).split_at_mut(height * width);
        values = others;
        let block = MatMut::from_column_major_slice_mut(block, height, width);
        let (mut of_top, mut of_below) = block.split_at_row_mut(width);
        let (top, below) = b.subrows(b.nrows() - height, height).split_at_row(width);
        triangular::matmul(
            of_top.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            top,
            BlockStructure::Rectangular,
            top.transpose(),
            BlockStructure::Rectangular,
            -1.0,
            threads,
        );
        matmul(of_below.as_mut(), Accum::Add, below, top.transpose(), -1.0, threads);
    }
}

/// What fronts have left, one after the other, and room for a front behind.
pub(super) struct Stack {
    values: Vec<f64>,
    /// In the order of their places.
    waiting: Vec<Waiting>,
}

/// What a front has left.
struct Waiting {
    /// The front that it waits for.
    next: usize,
    rows: Vec<usize>,
    /// Where its values begin.
    begin: usize,
}

impl Waiting {
    fn values(&self) -> Range<usize> {
        self.begin..self.begin + values_of(self.rows.len())
    }
}

impl Stack {
    /// One with room for so many values.
    pub fn new(values: usize) -> Self {
        Self { values: vec![0.0; values], waiting: Vec::new() }
    }

    /// Where the last of those that wait ends.
    fn end(&self) -> usize {
        self.waiting.last().map_or(0, |last| last.values().end)
    }

    /// What waits for a `front`, and so many zeros behind all that waits.
    pub fn front(&mut self, front: usize, count: usize) -> (Vec<Left<'_>>, &mut [f64]) {
        if self.end() + count > self.values.len() {
            self.close_gaps();
        }
        let end = self.end();
        let (before, behind) = self.values.split_at_mut(end);
        let zeros = &mut behind[..count];
        zeros.fill(0.0);
        let of_front = self.waiting.iter().filter(|waiting| waiting.next == front);
        let left = of_front.map(|one| Left { rows: &one.rows, values: &before[one.values()] });
        (left.collect(), zeros)
    }

    /// Lets go what waited for a `front`. What that left between `rows`, `offset` values from the place of the front on, waits for the `next` one, if there is one.
    pub fn made(&mut self, front: usize, rows: Vec<usize>, offset: usize, next: Option<usize>) {
        let from = self.end() + offset;
        self.waiting.retain(|waiting| waiting.next != front);
        if let Some(next) = next {
            let begin = self.end();
            self.values.copy_within(from..from + values_of(rows.len()), begin);
            self.waiting.push(Waiting { next, rows, begin });
        }
    }

    /// Moves what waits to the front, so that all room is behind it.
    fn close_gaps(&mut self) {
        let mut begin = 0;
        for waiting in &mut self.waiting {
            self.values.copy_within(waiting.values(), begin);
            waiting.begin = begin;
            begin = waiting.values().end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: what waits is the same after others before it have gone and the gaps are closed, and a front begins with zeros.
    #[test]
    fn what_waits_is_the_same_when_gaps_are_closed() {
        let rows = |first: usize| vec![first, first + 1, first + 2];
        let each = values_of(3);
        let mut stack = Stack::new(3 * each);
        // two that wait for others, of which the second goes first
        for (front, next) in [(0, 3), (1, 2)] {
            let (before, values) = stack.front(front, each);
            assert!(before.is_empty() && values.iter().all(|value| *value == 0.0));
            values.iter_mut().enumerate().for_each(|(n, value)| *value = (10 * front + n) as f64);
            stack.made(front, rows(front), 0, Some(next));
        }
        let (before, values) = stack.front(2, each);
        assert_eq!(before.iter().map(|left| left.rows.to_vec()).collect::<Vec<_>>(), [rows(1)]);
        assert_eq!(before[0].values[4], 14.0);
        values.fill(20.0);
        stack.made(2, rows(2), 0, Some(4));
        let (before, _) = stack.front(3, each);
        assert_eq!(before[0].values[4], 4.0);
        stack.made(3, rows(3), 0, None);
        // there is room for two only where the gap of the first is closed
        let (before, values) = stack.front(4, 2 * each);
        assert!(before[0].values.iter().all(|value| *value == 20.0));
        assert!(values.iter().all(|value| *value == 0.0));
    }

    /// Goal: the values of a column are those of its block from its first row on, in a matrix of several blocks.
    #[test]
    fn columns_are_those_of_blocks() {
        let all: Vec<usize> = (0..300).collect();
        let values: Vec<f64> = (0..values_of(300)).map(|n| n as f64).collect();
        Left { rows: &all, values: &values }.each_column(|column, rows, found| {
            let (place, first) = column_of(300, column);
            assert_eq!((&values[place][column - first..], rows.len()), (found, 300 - column));
        });
    }
}
