//! Contact of two condensed bodies on a fine grid that follows the patch.

use super::far_field::{FarField, Solids};
use crate::contact::{
    ComplianceOperator, ContactPoint, HalfSpace, Hybrid, Lattice, NearField, Share, Shares, Side, corners,
    nodal_forces, widened,
};
use crate::mesh::SurfaceGrid;
use nalgebra::{Point2, Vector2};
use railspring_profiles::error::StopReason;
use std::sync::Arc;

/// Coarse nodes around those in reach for which a far field is made as well, so that it lasts for some loads.
const SPARE_NODES: usize = 2;

/// A fine grid in the reach of the contact, and the compliance of its points.
pub struct FineContact {
    /// The grid of its points.
    pub lattice: Lattice,
    far: Arc<FarField>,
    hybrid: Hybrid,
    half_spaces: [HalfSpace; 2],
}

impl FineContact {
    /// The grid `lattice` around the nodes `region` of the rail's grid, with its points; far field and table of `known` serve
    /// again where they can. Of the points only those in reach of the `displaced` bodies remain.
    pub fn new(
        solids: &Solids,
        lattice: Lattice,
        region: &[bool],
        known: Option<&Self>,
        displaced: &Displaced,
        directions: usize,
    ) -> (Vec<ContactPoint>, Self) {
        let rail = &solids.rail_surface;
        let region = with_mirror_image(region, rail.grid);
        let cells = cells_at(rail.grid, &region);
        let columns = rail.grid.along_track.len();
        let mut needed = vec![false; region.len()];
        for &(i, k) in &cells {
            for node in [i * columns + k, (i + 1) * columns + k] {
                needed[node] = true;
                needed[node + 1] = true;
            }
        }
        let far = match known {
            Some(known) if known.far.serves(&needed, directions, rail) => known.far.clone(),
            _ => Arc::new(FarField::new(solids, widened(&needed, columns, SPARE_NODES), directions)),
        };
        let mut shares = Vec::new();
        let mut points = points_in(&cells, &lattice, solids);
        points.retain_mut(|point| {
            let Some((share, cut)) = far.shares(rail, &point.position) else { return false };
            point.at_edge = cut || at_end(rail.grid, &lattice, &point.position);
            shares.push(share.map(|(coarse, weight)| {
                Share::new(coarse, weight, &far.points[coarse].normal, &point.normal)
            }));
            true
        });
        let mut near = displaced.near(&far, &points, &shares, directions);
        if far.twins.is_some() {
            near = with_twins(&near, &points, &lattice);
        }
        let mut keep = near.iter();
        points.retain(|_| *keep.next().unwrap_or(&false));
        let mut keep = near.iter();
        shares.retain(|_| *keep.next().unwrap_or(&false));
        let near = NearField::on_grid(lattice.cell, &solids.half_spaces, &points, directions);
        let same_far = known.filter(|known| Arc::ptr_eq(&known.far, &far));
        let hybrid = Hybrid::new(near, &far.sum, shares, same_far.map(|known| &known.hybrid))
            .mirrored(far.twins.clone());
        (points, Self { lattice, far, hybrid, half_spaces: solids.half_spaces })
    }

    /// The points at `nodes` of another `lattice` (ascending), and their compliance with the far field of this contact; those beyond it are left out.
    pub(super) fn at_nodes(
        &self,
        solids: &Solids,
        lattice: Lattice,
        nodes: &[(usize, usize)],
    ) -> (Vec<ContactPoint>, Self) {
        let rail = &solids.rail_surface;
        let mut points = lattice.points(rail, &solids.wheel_surface, nodes);
        let mut shares = Vec::new();
        points.retain_mut(|point| {
            let Some((share, cut)) = self.far.shares(rail, &point.position) else { return false };
            point.at_edge = cut || at_end(rail.grid, &lattice, &point.position);
            shares.push(share.map(|(coarse, weight)| {
                Share::new(coarse, weight, &self.far.points[coarse].normal, &point.normal)
            }));
            true
        });
        let directions = self.hybrid.rows().checked_div(self.hybrid.points()).unwrap_or(1);
        let near = NearField::on_grid(lattice.cell, &self.half_spaces, &points, directions);
        let hybrid =
            Hybrid::new(near, &self.far.sum, shares, Some(&self.hybrid)).mirrored(self.far.twins.clone());
        (points, Self { lattice, far: self.far.clone(), hybrid, half_spaces: self.half_spaces })
    }

    /// Displacements of the points of a contact `to` with the same far field, m, by direction and point: those under `forces` on the points of this
    /// one, less what the half-spaces are.
    pub(super) fn far_motion(&self, forces: &[f64], to: &Self) -> Vec<f64> {
        let coarse = crate::superelement::times(&self.far.sum, &self.hybrid.carried(forces));
        let count = self.far.points.len();
        let mut motion = vec![0.0; to.hybrid.rows()];
        to.hybrid.interpolate(|d, point| coarse[d * count + point], &mut motion);
        motion
    }

    /// Half-spaces of rail and wheel.
    pub(super) fn bodies(&self) -> &[HalfSpace] {
        &self.half_spaces
    }

    /// Compliance of the points.
    pub fn operator(&self) -> &dyn ComplianceOperator {
        &self.hybrid
    }

    /// Forces of the points on the nodes of a body's contact grid, as many as `equations`, N.
    pub fn nodal_forces(&self, side: Side, forces: &[f64], equations: usize) -> Vec<f64> {
        nodal_forces(&self.far.points, side, &self.hybrid.carried(forces), equations)
    }

    /// Whether its far field serves where the bodies are now.
    pub(super) fn is_near(&self, solids: &Solids) -> bool {
        self.far.is_near(solids)
    }

    /// Whether both contacts have one far field.
    pub fn shares_far_field(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.far, &other.far)
    }

    /// Displacements of the opposing surface against the base at the points, m, by direction and point: those of the contact
    /// nodes of the bodies (`3·node + axis`, m), as the forces of the points reach these nodes.
    pub fn motion_of_nodes(&self, rail: &[f64], wheel: &[f64]) -> Vec<f64> {
        let coarse = |d: usize, point: usize| self.far.points[point].opening(d, [rail, wheel]);
        let mut motion = vec![0.0; self.hybrid.rows()];
        self.hybrid.interpolate(coarse, &mut motion);
        motion
    }

    /// `values` of the points `own`, by direction and point, at the places of other `points`, bilinear between points; zero where
    /// there are none around.
    pub fn values_at(&self, own: &[ContactPoint], values: &[f64], points: &[ContactPoint]) -> Vec<f64> {
        let n = own.len();
        let directions = values.len().checked_div(n).unwrap_or(0);
        let place = Numbers::of(own);
        let mut found = vec![0.0; directions * points.len()];
        for (j, point) in points.iter().enumerate() {
            for (from, weight) in around(&self.lattice, &place, &point.position).into_iter().flatten() {
                for d in 0..directions {
                    found[d * points.len() + j] += weight * values[d * n + from];
                }
            }
        }
        found
    }

    /// Compliance under `forces` on the points, fᵀ·C·f in m·N, in parts: the half-spaces by the normal forces, then
    /// wheel and rail beyond that.
    pub fn split(&self, forces: &[f64]) -> [f64; 3] {
        let near = self.hybrid.near();
        let mut normal = forces.to_vec();
        let directions = self.hybrid.rows() / self.hybrid.points().max(1);
        normal[forces.len() / directions.max(1)..].fill(0.0);
        let carried = self.hybrid.carried(forces);
        let beyond = |body: HalfSpace| {
            let tangential = if directions == 1 {
                0.0
            } else {
                near.quadratic(&[body], forces) - near.quadratic(&[body], &normal)
            };
            tangential + self.far.quadratic(body.side, &carried)
        };
        let [rail, wheel] = self.half_spaces;
        [near.quadratic(&self.half_spaces, &normal), beyond(wheel), beyond(rail)]
    }

    /// Compliance of both half-spaces under `forces` on the points, m·N.
    pub fn half_spaces(&self, forces: &[f64]) -> f64 {
        self.hybrid.near().quadratic(&self.half_spaces, forces)
    }

    /// Lateral displacement and that along the track (m) of the opposing surface against the base at other `points`, with
    /// the compliance of the points `own` under their `forces`; `to` is the grid of those other points. Beyond the points `own` there are the half-spaces between nodes of
    /// their grid, and the far field of the other grid.
    pub fn tangential_at(
        &self,
        own: &[ContactPoint],
        forces: &[f64],
        solids: &Solids,
        to: &Self,
        points: &[ContactPoint],
    ) -> Vec<Vector2<f64>> {
        let n = own.len();
        let place = Numbers::of(own);
        let corners: Vec<[((usize, usize), f64); 4]> =
            points.iter().map(|point| corners_around(&self.lattice, &point.position)).collect();
        let is_own = |corners: &[((usize, usize), f64); 4]| {
            corners.iter().all(|(node, weight)| *weight <= LEAST_WEIGHT || place.at(*node).is_some())
        };
        let mut motion = vec![0.0; forces.len()];
        self.hybrid.add_product(forces, &mut motion);
        let beyond: Vec<usize> = (0..points.len()).filter(|&j| !is_own(&corners[j])).collect();
        let carrying: Vec<usize> = (0..n).filter(|&j| (0..3).any(|d| forces[d * n + j] != 0.0)).collect();
        let mut wanted: Vec<(usize, usize)> =
            beyond.iter().flat_map(|&j| corners[j]).map(|(node, _)| node).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let near = self.hybrid.near().seen_from(&carrying, &wanted, |row| {
            let (d, j) = (row / carrying.len(), carrying[row % carrying.len()]);
            forces[d * n + j]
        });
        let far = if beyond.is_empty() { Vec::new() } else { to.far_under(own, forces, &carrying, solids) };
        let rows = to.far.points.len();
        let mut found: Vec<Vector2<f64>> = corners
            .iter()
            .map(|corners| {
                let own = corners.iter().filter_map(|(node, weight)| Some((place.at(*node)?, *weight)));
                own.map(|(j, weight)| Vector2::new(motion[n + j], motion[2 * n + j]) * weight).sum()
            })
            .collect();
        for j in beyond {
            let at = |(node, weight): &((usize, usize), f64)| {
                let place = wanted.binary_search(node).expect("one of the nodes that are wanted");
                Vector2::new(near[wanted.len() + place], near[2 * wanted.len() + place]) * *weight
            };
            found[j] = corners[j].iter().map(at).sum();
            if let Some((shares, _)) = to.far.shares(&solids.rail_surface, &points[j].position) {
                for (coarse, weight) in shares {
                    found[j] += Vector2::new(far[rows + coarse], far[2 * rows + coarse]) * weight;
                }
            }
        }
        found
    }

    /// Displacements of the points of this far field under the `forces` of points of another grid, m, by direction and point.
    fn far_under(
        &self,
        points: &[ContactPoint],
        forces: &[f64],
        carrying: &[usize],
        solids: &Solids,
    ) -> Vec<f64> {
        let (n, rows) = (points.len(), self.far.points.len());
        let mut carried = vec![0.0; self.far.sum.nrows()];
        for &j in carrying {
            let Some((shares, _)) = self.far.shares(&solids.rail_surface, &points[j].position) else {
                continue;
            };
            for (coarse, weight) in shares {
                (0..3).for_each(|d| carried[d * rows + coarse] += weight * forces[d * n + j]);
            }
        }
        crate::superelement::times(&self.far.sum, &carried)
    }

    /// Forces of the points `own` at the places of other `points` of a `lattice`: the same pressure and traction, bilinear
    /// between points, on a patch and with a pressure that are larger by the factor `growth`.
    pub fn carry_over(
        &self,
        own: &[ContactPoint],
        forces: &[f64],
        lattice: &Lattice,
        points: &[ContactPoint],
        growth: f64,
    ) -> Vec<f64> {
        let n = own.len();
        let directions = forces.len().checked_div(n).unwrap_or(1);
        let place = Numbers::of(own);
        let area = lattice.cell.x * lattice.cell.y / (self.lattice.cell.x * self.lattice.cell.y);
        let sum: f64 = forces[..n].iter().sum();
        let centre: Vector2<f64> =
            own.iter().zip(forces).map(|(point, force)| point.position.coords * (force / sum)).sum();
        let mut start = vec![0.0; directions * points.len()];
        for (j, point) in points.iter().enumerate() {
            let before = Point2::from(centre + (point.position.coords - centre) / growth);
            let corners = around(&self.lattice, &place, &before);
            for (from, weight) in corners.into_iter().flatten() {
                for d in 0..directions {
                    start[d * points.len() + j] += growth * area * weight * forces[d * n + from];
                }
            }
        }
        start
    }

    /// Why the points that carry load are not all there are: the patch reaches the end of a mesh's contact grid.
    pub fn edge_reached(
        &self,
        points: &[ContactPoint],
        forces: &[f64],
        rail: &SurfaceGrid,
    ) -> Option<StopReason> {
        let mut reached = None;
        for (point, _) in points.iter().zip(forces).filter(|(point, force)| point.at_edge && **force > 0.0) {
            let lines = &rail.along_track;
            let line = lines.partition_point(|x| *x <= point.position.y);
            // its cell lies between the lines before and behind it
            if line > 2 && line + 2 < lines.len() {
                return Some(StopReason::EdgeOfCandidates);
            }
            reached = Some(StopReason::EndOfWindow);
        }
        reached
    }
}

/// Whether the next point of a lattice lies on or beyond the end of a mesh's contact grid, where there may be none.
fn at_end(grid: &SurfaceGrid, lattice: &Lattice, place: &Point2<f64>) -> bool {
    [&grid.along_profile, &grid.along_track].into_iter().enumerate().any(|(axis, lines)| {
        // on a line, but for rounding
        let cell = lattice.cell[axis] * (1.0 + 1e-6);
        place[axis] - cell < lines[0] || place[axis] + cell > lines[lines.len() - 1]
    })
}

/// Displacements of both bodies beyond their places, with which only points whose gap is smaller than `margin` (m) are in reach.
pub struct Displaced<'a> {
    /// Displacement of the opposing surface against the base at a point of the contact grid in a direction, m.
    pub opening: &'a dyn Fn(&ContactPoint, usize) -> f64,
    /// Gap below which points are in reach, m.
    pub margin: f64,
}

impl Displaced<'_> {
    /// Which of the points, with their `shares` in those of the far field, are in reach, or beside one that is.
    fn near(
        &self,
        far: &FarField,
        points: &[ContactPoint],
        shares: &[Shares],
        directions: usize,
    ) -> Vec<bool> {
        let of = self.opening;
        // normal and lateral ones of the points of the far field that there are shares in
        let mut motions = vec![None; far.points.len()];
        for share in shares.iter().flatten() {
            let point = &far.points[share.point];
            motions[share.point].get_or_insert_with(|| Vector2::new(of(point, 0), of(point, 1)));
        }
        let moved = |share: &Share| {
            let motion = motions[share.point].unwrap_or_default();
            share.weight * if directions == 1 { motion.x } else { share.turn.dot(&motion) }
        };
        let closed: Vec<bool> = points
            .iter()
            .zip(shares)
            .map(|(point, shares)| point.gap + shares.iter().map(moved).sum::<f64>() < self.margin)
            .collect();
        let mut near = closed.clone();
        for j in (0..points.len()).filter(|&j| closed[j]) {
            let (i, k) = points[j].index;
            for (a, b) in [(i + 1, k), (i.wrapping_sub(1), k), (i, k + 1), (i, k.wrapping_sub(1))] {
                if let Ok(beside) = points.binary_search_by_key(&(a, b), |point| point.index) {
                    near[beside] = true;
                }
            }
        }
        near
    }
}

/// Nodes of a grid with their mirror images along the track, where the grid has these: what lies on a line of the grid belongs to the cell on one of its sides.
fn with_mirror_image(region: &[bool], grid: &SurfaceGrid) -> Vec<bool> {
    let x = &grid.along_track;
    let (columns, last) = (x.len(), x.len() - 1);
    let is_mirrored = (0..columns).all(|k| (x[k] + x[last - k]).abs() <= 1e-9 * x[last].abs());
    if !is_mirrored {
        return region.to_vec();
    }
    (0..region.len())
        .map(|node| region[node] || region[node / columns * columns + last - node % columns])
        .collect()
}

/// Those of the points `near` whose mirror image along the track is near as well: at the ends of the far field rounding decides on which side there is a point.
fn with_twins(near: &[bool], points: &[ContactPoint], lattice: &Lattice) -> Vec<bool> {
    let twin = |point: &ContactPoint| {
        let (line, column) = point.index;
        let twin = (line, (2 * lattice.middle).checked_sub(column)?);
        points.binary_search_by_key(&twin, |point| point.index).ok()
    };
    points
        .iter()
        .zip(near)
        .map(|(point, is_near)| *is_near && twin(point).is_some_and(|twin| near[twin]))
        .collect()
}

/// The numbers of the points of a list by their places on the grid, of the rectangle of its lines that holds all.
struct Numbers {
    corner: (usize, usize),
    columns: usize,
    numbers: Vec<Option<usize>>,
}

impl Numbers {
    fn of(points: &[ContactPoint]) -> Self {
        let range = |line: fn(&ContactPoint) -> usize| {
            let first = points.iter().map(line).min().unwrap_or(0);
            (first, points.iter().map(line).max().map_or(0, |last| last + 1 - first))
        };
        let ((first, rows), (column, columns)) = (range(|point| point.index.0), range(|point| point.index.1));
        let mut numbers = vec![None; rows * columns];
        for (j, point) in points.iter().enumerate() {
            numbers[(point.index.0 - first) * columns + point.index.1 - column] = Some(j);
        }
        Self { corner: (first, column), columns, numbers }
    }

    fn at(&self, (i, k): (usize, usize)) -> Option<usize> {
        let (i, k) = (i.checked_sub(self.corner.0)?, k.checked_sub(self.corner.1)?);
        if k < self.columns { *self.numbers.get(i * self.columns + k)? } else { None }
    }
}

/// The least weight of a corner that is needed.
const LEAST_WEIGHT: f64 = 1e-6;

/// The four nodes of a lattice around a place with their bilinear weights; the first ones for a place before them.
fn corners_around(lattice: &Lattice, position: &Point2<f64>) -> [((usize, usize), f64); 4] {
    let split = |axis: usize| {
        let line = lattice.coordinate(axis, position[axis]).max(0.0);
        // on a line, but for rounding, its neighbour is not needed
        let whole = if (line - line.round()).abs() < Lattice::ON_LINE { line.round() } else { line.floor() };
        (whole as usize, (line - whole).clamp(0.0, 1.0))
    };
    let ((i, u), (k, v)) = (split(0), split(1));
    corners(u, v).map(|(a, b, weight)| ((i + a, k + b), weight))
}

/// The four points around a place with their bilinear weights; `None` where one is not there.
fn around(lattice: &Lattice, place: &Numbers, position: &Point2<f64>) -> Option<[(usize, f64); 4]> {
    let on_grid = |axis: usize| lattice.coordinate(axis, position[axis]) >= -Lattice::ON_LINE;
    if !(on_grid(0) && on_grid(1)) {
        return None;
    }
    let mut found = [(0, 0.0); 4];
    for (corner, (node, weight)) in found.iter_mut().zip(corners_around(lattice, position)) {
        if weight > LEAST_WEIGHT {
            *corner = (place.at(node)?, weight);
        }
    }
    Some(found)
}

/// Points of a `lattice` in the cells of the rail's grid around the nodes `region`.
pub(super) fn points_around(region: &[bool], lattice: &Lattice, solids: &Solids) -> Vec<ContactPoint> {
    points_in(&cells_at(solids.rail_surface.grid, region), lattice, solids)
}

/// Points of a `lattice` in cells of the rail's grid, by the first nodes of these.
fn points_in(cells: &[(usize, usize)], lattice: &Lattice, solids: &Solids) -> Vec<ContactPoint> {
    let grid = solids.rail_surface.grid;
    let (s, x) = (&grid.along_profile, &grid.along_track);
    let mut nodes = Vec::new();
    for &(i, k) in cells {
        let columns = lattice.columns_within(x[k], x[k + 1]);
        for a in lattice.lines_within(0, s[i], s[i + 1]) {
            nodes.extend(columns.clone().map(|b| (a, b)));
        }
    }
    nodes.sort_unstable();
    nodes.dedup();
    lattice.points(&solids.rail_surface, &solids.wheel_surface, &nodes)
}

/// First nodes of the cells with a corner in `region`.
fn cells_at(grid: &SurfaceGrid, region: &[bool]) -> Vec<(usize, usize)> {
    let columns = grid.along_track.len();
    let corner = |i: usize, k: usize| region[i * columns + k];
    let all = (0..grid.along_profile.len() - 1).flat_map(|i| (0..columns - 1).map(move |k| (i, k)));
    all.filter(|&(i, k)| corner(i, k) || corner(i, k + 1) || corner(i + 1, k) || corner(i + 1, k + 1))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: where a cell divides the contact window, the last points that may carry load at its two ends are both at its end, though
    /// there is a line of the lattice on either of them, and rounding has its part in where it lies.
    #[test]
    fn both_ends_of_a_window_are_ends() {
        let lines = |n: i32, step: f64| (-n..=n).map(|k| f64::from(k) * step).collect::<Vec<_>>();
        let grid =
            SurfaceGrid { along_profile: lines(8, 2e-3), along_track: lines(8, 1.5e-3), nodes: Vec::new() };
        for halvings in 0..6 {
            let cell = Vector2::new(0.65e-3, 0.5e-3 * 0.5_f64.powi(halvings));
            let lattice = Lattice::over(&grid, cell);
            let beside = 12e-3 - cell.y;
            for (x, is_end) in [(beside, true), (beside - cell.y, false)] {
                for x in [x, -x, x * (1.0 + 1e-12), -x * (1.0 - 1e-12)] {
                    assert_eq!(at_end(&grid, &lattice, &Point2::new(0.0, x)), is_end, "{x} {cell}");
                }
            }
        }
    }
}
