//! Paths joined where their ends meet.

use std::collections::BTreeMap;

use nalgebra::Point2;

use super::curves::Path;
use crate::error::Result;
use crate::profile_file::text::error_on;

/// Ends nearer to each other than this part of the drawing's extent are one place; programs write 1e-6 of it.
const SAME_PLACE: f64 = 1e-4;

/// An end of a path: the path's index, and 0 for its beginning or 1 for its end.
type End = (usize, usize);

/// Paths one after the other.
pub(super) struct Chain {
    pub path: Path,
    pub closed: bool,
    /// Greatest distance of two ends that were joined.
    pub largest_gap: f64,
}

/// The chains that paths make, in the order in which the file begins them, and the lines of paths that are left out: on
/// an earlier one, or as short as a gap.
///
/// # Errors
/// Three ends in one place.
pub(super) fn join(name: &str, paths: Vec<Path>) -> Result<(Vec<Chain>, Vec<usize>)> {
    let ends = |paths: &[Path]| -> Vec<[Point2<f64>; 2]> { paths.iter().filter_map(Path::ends).collect() };
    let near = SAME_PLACE * extent(&paths);
    let (paths, left_out) = distinct(paths, near);
    let ends = ends(&paths);
    let partners = partners(name, &paths, &ends, near)?;
    let mut taken = vec![false; paths.len()];
    let mut chains = Vec::new();
    for first in 0..paths.len() {
        if taken[first] {
            continue;
        }
        // Back to where the chain begins, or once around it.
        let mut begin = (first, 0);
        while let Some((path, end)) = partners[begin.0][begin.1].filter(|(path, _)| *path != first) {
            begin = (path, 1 - end);
        }
        chains.push(follow(begin, &paths, &ends, &partners, &mut taken));
    }
    Ok((chains, left_out))
}

/// The chain from an end of a path on.
fn follow(
    begin: End,
    paths: &[Path],
    ends: &[[Point2<f64>; 2]],
    partners: &[[Option<End>; 2]],
    taken: &mut [bool],
) -> Chain {
    let mut chain = Chain { path: Path::default(), closed: false, largest_gap: 0.0 };
    let mut at = Some(begin);
    let mut least = usize::MAX;
    while let Some((index, entered)) = at {
        if taken[index] {
            chain.closed = true;
            break;
        }
        taken[index] = true;
        let mut path = paths[index].clone();
        if entered == 1 {
            path.reverse();
        }
        // The layer of the entity that comes first in the file.
        if index < least {
            (least, chain.path.layer) = (index, path.layer);
        }
        chain.path.pieces.extend(path.pieces);
        at = partners[index][1 - entered];
        if let Some((next, end)) = at {
            let gap = (ends[next][end] - ends[index][1 - entered]).norm();
            chain.largest_gap = chain.largest_gap.max(gap);
        }
    }
    chain
}

/// For each end of each path the end that it meets.
fn partners(
    name: &str,
    paths: &[Path],
    ends: &[[Point2<f64>; 2]],
    near: f64,
) -> Result<Vec<[Option<End>; 2]>> {
    let cell = |p: &Point2<f64>| [(p.x / near).floor() as i64, (p.y / near).floor() as i64];
    let mut cells: BTreeMap<[i64; 2], Vec<End>> = BTreeMap::new();
    for (path, of) in ends.iter().enumerate() {
        for (end, p) in of.iter().enumerate() {
            cells.entry(cell(p)).or_default().push((path, end));
        }
    }
    let mut partners = vec![[None; 2]; paths.len()];
    for (path, of) in ends.iter().enumerate() {
        for (end, p) in of.iter().enumerate() {
            let [i, j] = cell(p);
            let around =
                (-1..=1).flat_map(|a| (-1..=1).map(move |b| [i.saturating_add(a), j.saturating_add(b)]));
            let mut meeting = around
                .filter_map(|key| cells.get(&key))
                .flatten()
                .filter(|(q, e)| (*q, *e) != (path, end) && (ends[*q][*e] - p).norm() <= near);
            partners[path][end] = meeting.next().copied();
            if let (Some(one), Some(other)) = (partners[path][end], meeting.next()) {
                let line = paths[path].pieces[0].1;
                let lines = [one.0, other.0].map(|path| paths[path].pieces[0].1);
                return Err(error_on(
                    name,
                    line,
                    &format!("({:.6}, {:.6})", p.x, p.y),
                    format!(
                        "two lines that meet, not three: those of lines {}, {} as well",
                        lines[0], lines[1]
                    ),
                    "leave the running surface alone on a layer, or delete what branches off",
                ));
            }
        }
    }
    Ok(partners)
}

/// Extent of the paths: one that is closed has both ends in one place.
fn extent(paths: &[Path]) -> f64 {
    let pieces = paths.iter().flat_map(|path| &path.pieces);
    let mut all = pieces.flat_map(|(piece, _)| [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| piece.point(t)));
    let Some(first) = all.next() else { return 0.0 };
    let (low, high) = all.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
    (high - low).norm().max(f64::MIN_POSITIVE)
}

/// Paths without those that lie on an earlier one or are not longer than `near`, and the lines of these.
fn distinct(paths: Vec<Path>, near: f64) -> (Vec<Path>, Vec<usize>) {
    let key = |path: &Path| {
        let mut ends: Vec<[u64; 2]> = path
            .pieces
            .iter()
            .flat_map(|(piece, _)| [piece.point(0.5), piece.ends()[0], piece.ends()[1]])
            // So that zero has one sign.
            .map(|p| [(p.x + 0.0).to_bits(), (p.y + 0.0).to_bits()])
            .collect();
        ends.sort_unstable();
        ends
    };
    let mut seen = std::collections::BTreeSet::new();
    let (first, again): (Vec<Path>, Vec<Path>) =
        paths.into_iter().partition(|path| path.length() > near && seen.insert(key(path)));
    (first, again.iter().map(|path| path.pieces[0].1).collect())
}
