//! Strips of the lines of a grid: where regions of contact lie apart on the profile, products pass over the empty lines between them.

/// Strips of equally many lines, one behind the other, that hold all points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strips {
    /// The first line of each, ascending; the first of all may lie before the first line that is used.
    starts: Vec<isize>,
    /// Lines of each.
    lines: usize,
}

/// Most strips.
const MOST: usize = 3;
/// Work of a product for a line of a strip: of its transforms, and of each strip that acts on it.
const TRANSFORMS: usize = 9;
const ACTING: usize = 2;
/// Strips begin at lines of the grid that are multiples of this, so that the distances between them are few.
const STEP: usize = 4;

impl Strips {
    /// Those that take the least work, of points on `lines` that count from the line `corner` of the grid.
    pub fn of(lines: impl Iterator<Item = usize>, corner: usize) -> Self {
        let mut used = Vec::new();
        for line in lines {
            if line >= used.len() {
                used.resize(line + 1, false);
            }
            used[line] = true;
        }
        let one = Self { starts: vec![0], lines: used.len() };
        // the empty lines between others, the most first
        let mut gaps: Vec<(usize, usize)> = Vec::new();
        let mut last = None;
        for line in (0..used.len()).filter(|&line| used[line]) {
            gaps.extend(last.filter(|last| line - last > STEP).map(|last| (last, line)));
            last = Some(line);
        }
        gaps.sort_by_key(|(before, after)| (before + used.len() - after, *before));
        let apart = |count: usize| {
            let mut chosen = gaps[..count - 1].to_vec();
            chosen.sort_unstable();
            let firsts = std::iter::once(0).chain(chosen.iter().map(|(_, after)| *after));
            let lasts = chosen.iter().map(|(before, _)| *before).chain([used.len() - 1]);
            let start = |line: usize| line as isize - ((corner + line) % STEP) as isize;
            let starts: Vec<isize> = firsts.map(start).collect();
            let lines = starts.iter().zip(lasts).map(|(start, last)| (last as isize + 1 - start) as usize);
            Self { lines: lines.max().unwrap_or(0), starts }
        };
        let others = (2..=MOST.min(gaps.len() + 1)).map(apart);
        others.fold(one, |best, other| if other.work() < best.work() { other } else { best })
    }

    fn work(&self) -> usize {
        self.count() * self.lines * (TRANSFORMS + ACTING * self.count())
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.starts.len()
    }

    /// Lines of each.
    pub fn lines(&self) -> usize {
        self.lines
    }

    /// The strip of a line, and which of its lines that is.
    pub fn place(&self, line: usize) -> (usize, usize) {
        let strip = self.starts.partition_point(|start| *start <= line as isize).saturating_sub(1);
        (strip, (line as isize - self.starts[strip]) as usize)
    }

    /// Lines from the strip `from` to the strip `to`.
    pub fn apart(&self, to: usize, from: usize) -> isize {
        self.starts[to] - self.starts[from]
    }

    /// From which number of lines on no two points are apart.
    pub fn reach(&self) -> usize {
        (self.starts[self.count() - 1] - self.starts[0]) as usize + self.lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: lines that lie together, or with few empty ones, are one strip from the first of them; those far apart are strips that hold every line, begin
    /// at multiples of [`STEP`], and do not overlap.
    #[test]
    fn regions_far_apart_have_strips_of_their_own() {
        let one = Strips::of((0..30).chain(40..60), 5);
        assert_eq!((one.count(), one.lines(), one.place(45)), (1, 60, (0, 45)));
        assert_eq!(Strips::of(std::iter::empty(), 5).lines(), 0);
        for (ranges, corner) in [
            (vec![0..10, 70..78], 6),
            (vec![0..9, 60..70, 130..135], 3),
            (vec![0..20, 100..120, 126..130], 0),
        ] {
            let lines: Vec<usize> = ranges.iter().cloned().flatten().collect();
            let strips = Strips::of(lines.iter().copied(), corner);
            assert_eq!(
                strips.count(),
                ranges.len().min(if ranges.len() == 3 && corner == 0 { 2 } else { 3 })
            );
            assert!(strips.starts.iter().all(|start| (start + corner as isize) % STEP as isize == 0));
            assert!(strips.starts.windows(2).all(|w| w[1] - w[0] >= strips.lines as isize));
            for line in lines {
                let (strip, within) = strips.place(line);
                assert!(within < strips.lines(), "{line} {strips:?}");
                assert_eq!(strips.starts[strip] + within as isize, line as isize);
                assert!((strips.starts[0] + strips.reach() as isize) > line as isize);
            }
        }
    }
}
