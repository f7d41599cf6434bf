//! How the hexahedra of a mesh hang together: outer faces and pieces.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Point3;

/// Faces of a hexahedron, outward.
pub(super) const FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// The faces of a mesh.
pub(super) struct Faces {
    /// Faces that belong to one hexahedron, outward, in the order of the hexahedra.
    pub outer: Vec<[usize; 4]>,
    /// A face of more than two hexahedra, if there is one.
    pub overfull: Option<[usize; 4]>,
    /// Number of pieces whose hexahedra are joined by common faces.
    pub pieces: usize,
    /// A hexahedron of the smallest piece, and how many that piece has.
    pub smallest: (usize, usize),
}

/// A hexahedron of a group that lies by itself between two other ones or those and nodes that are `rigid`: it meets them at opposite faces.
pub(super) fn single_layer(
    hexes: &[[usize; 8]],
    group: impl Fn(usize) -> usize,
    rigid: &[bool],
    wanted: usize,
) -> Option<usize> {
    let key = |hex: &[usize; 8], face: usize| {
        let mut key = FACES[face].map(|i| hex[i]);
        key.sort_unstable();
        key
    };
    let others: BTreeSet<[usize; 4]> = (0..hexes.len())
        .filter(|&e| group(e) != wanted)
        .flat_map(|e| (0..FACES.len()).map(move |face| key(&hexes[e], face)))
        .collect();
    let bounded = |face: [usize; 4]| face.iter().all(|&v| rigid[v]) || others.contains(&face);
    (0..hexes.len()).filter(|&e| group(e) == wanted).find(|&e| {
        [[0, 1], [2, 4], [3, 5]].iter().any(|faces| faces.iter().all(|&face| bounded(key(&hexes[e], face))))
    })
}

impl Faces {
    /// Finds the faces and pieces of `hexes`.
    pub fn new(hexes: &[[usize; 8]]) -> Self {
        // the hexahedra of every face, whichever corner it starts from
        let mut owners: BTreeMap<[usize; 4], Vec<(usize, usize)>> = BTreeMap::new();
        for (e, hex) in hexes.iter().enumerate() {
            for (f, face) in FACES.iter().enumerate() {
                let mut key = face.map(|i| hex[i]);
                key.sort_unstable();
                owners.entry(key).or_default().push((e, f));
            }
        }
        let mut piece: Vec<usize> = (0..hexes.len()).collect();
        let mut alone = Vec::new();
        let mut overfull = None;
        for (key, of) in &owners {
            if of.len() > 2 {
                overfull = overfull.or(Some(*key));
            }
            if let [(e, f)] = of[..] {
                alone.push((e, f));
            }
            for pair in of.windows(2) {
                let (a, b) = (root(&mut piece, pair[0].0), root(&mut piece, pair[1].0));
                piece[a.max(b)] = a.min(b);
            }
        }
        alone.sort_unstable();
        let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
        for e in 0..hexes.len() {
            *sizes.entry(root(&mut piece, e)).or_default() += 1;
        }
        let smallest = sizes.iter().min_by_key(|(e, size)| (**size, **e)).map_or((0, 0), |(e, n)| (*e, *n));
        Self {
            outer: alone.into_iter().map(|(e, f)| FACES[f].map(|i| hexes[e][i])).collect(),
            overfull,
            pieces: sizes.len(),
            smallest,
        }
    }
}

/// First member of the piece of `e`, with the way there shortened.
fn root(piece: &mut [usize], mut e: usize) -> usize {
    while piece[e] != e {
        piece[e] = piece[piece[e]];
        e = piece[e];
    }
    e
}

/// The first two nodes that lie nearer to each other than `distance`, m.
pub(super) fn coincident(nodes: &[Point3<f64>], distance: f64) -> Option<(usize, usize)> {
    // in cells twice as wide as the distance, a near node lies in one of the eight cells around it
    let cell =
        |p: &Point3<f64>, offset: f64| [0, 1, 2].map(|d| ((p[d] + offset) / (2.0 * distance)).floor() as i64);
    let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    for (v, p) in nodes.iter().enumerate() {
        let (low, high) = (cell(p, -distance), cell(p, distance));
        for corner in 0..8 {
            let key = [0, 1, 2].map(|d| if corner >> d & 1 == 0 { low[d] } else { high[d] });
            if (0..3).any(|d| corner >> d & 1 == 1 && low[d] == high[d]) {
                continue;
            }
            let near = cells.get(&key).into_iter().flatten();
            if let Some(&other) = near.into_iter().find(|&&other| (nodes[other] - p).norm() < distance) {
                return Some((other, v));
            }
        }
        cells.entry(cell(p, 0.0)).or_default().push(v);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::{BlockOptions, mesh_block};
    use super::*;

    #[test]
    fn a_block_is_one_piece_with_its_outer_faces() {
        let mesh = mesh_block(&BlockOptions::uniform([1.0, 1.0, 1.0], [4, 3, 2])).unwrap();
        let faces = Faces::new(&mesh.hexes);
        assert_eq!((faces.pieces, faces.overfull), (1, None));
        assert_eq!(faces.outer.len(), 2 * (4 * 3 + 3 * 2 + 4 * 2));
        // a face of an outward list turns its back on the middle
        for face in &faces.outer {
            let [a, b, c, d] = face.map(|v| mesh.nodes[v]);
            let middle = Point3::from((a.coords + b.coords + c.coords + d.coords) / 4.0);
            let block_middle =
                mesh.nodes.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / mesh.nodes.len() as f64;
            assert!((b - a).cross(&(c - a)).dot(&(middle.coords - block_middle)) > 0.0);
        }
    }

    #[test]
    fn pieces_and_repeated_elements_are_found() {
        let mesh = mesh_block(&BlockOptions::uniform([1.0, 1.0, 1.0], [3, 1, 1])).unwrap();
        let faces = Faces::new(&[mesh.hexes[0], mesh.hexes[2]]);
        assert_eq!((faces.pieces, faces.smallest), (2, (0, 1)));
        assert_eq!(faces.outer.len(), 12);
        let twice = [mesh.hexes[0], mesh.hexes[1], mesh.hexes[1]];
        assert!(Faces::new(&twice).overfull.is_some());
    }

    #[test]
    fn coincident_nodes_are_found_across_cells() {
        let at = |x: f64| Point3::new(x, 0.5, -0.25);
        assert_eq!(coincident(&[at(0.0), at(1.0), at(1.0 + 0.9e-6)], 1e-6), Some((1, 2)));
        assert_eq!(coincident(&[at(-0.4e-6), at(0.4e-6)], 1e-6), Some((0, 1)));
        assert_eq!(coincident(&[at(0.0), at(1.0), at(1.0 + 1.1e-6)], 1e-6), None);
    }
}
