//! Regions of contact on grids of their own.
//!
//! A load is settled on one uniform grid, with cells for the patch that carries most. A narrow region beside it has few of them, and a
//! pressure that rises over a jump of curvature has few in any patch. So each region is solved again on grids that are as fine as
//! it needs, the hub and the forces of all others held: these act from a distance, and a region's own force changes little.

use super::far_field::Solids;
use super::fine::FineContact;
use super::grid::{area, touches_border, widths};
use super::pressed::{ContactField, Pressed, WheelOnRail};
use super::regions::regions_of;
use crate::contact::{ContactPoint, Hat, Lattice, Problem, displacement_far_from, gaps, hats, solve_held};
use nalgebra::{Vector2, Vector3};
use railspring_profiles::error::Result;
use std::collections::BTreeMap;

/// Cells across a region that are wanted at least, in either direction.
const CELLS_ACROSS: f64 = 16.0;
/// Change of the largest pressure and of the area, relative, at which cells are halved no more: the error that is left is a third of it where it goes with the square of the cells.
const SETTLED: Size = Size { pressure: 0.02, area: 0.02 };
/// The same on the wider grid of thousands of pairs.
const SETTLED_OF_THOUSANDS: Size = Size { pressure: 0.02, area: 0.05 };
/// Halvings of the grid of the load at most, and points of a region at most.
const HALVINGS: i32 = 5;
const MOST_POINTS: usize = 12_000;
/// How far beyond the points that carry load on one grid those are sought of the next, in cells of the coarser one, and how often that is doubled.
const REACH: f64 = 1.5;
const WIDENINGS: usize = 4;

/// Largest pressure, Pa, and area, m².
#[derive(Debug, Clone, Copy)]
struct Size {
    pressure: f64,
    area: f64,
}

/// A region on a grid.
struct OnGrid {
    contact: FineContact,
    points: Vec<ContactPoint>,
    /// Normal forces, N.
    normal: Vec<f64>,
    /// The same of the points that carry.
    hats: Vec<Hat>,
    size: Size,
}

impl OnGrid {
    fn new(lattice: &Lattice, points: Vec<ContactPoint>, contact: FineContact, normal: Vec<f64>) -> Self {
        let size = Size {
            pressure: normal.iter().zip(&points).map(|(force, point)| force / point.area).fold(0.0, f64::max),
            area: area(lattice, &points, &normal),
        };
        Self { hats: hats(&points, &normal), contact, points, normal, size }
    }
}

/// The regions of a settled load, each on two grids.
pub(super) struct Refined {
    /// On cells twice as large as the finest.
    pub twice: OfAll,
    /// On the finest.
    pub finest: OfAll,
}

/// All regions.
pub(super) struct OfAll {
    /// Pressure.
    pub hats: Vec<Hat>,
    /// m².
    pub area: f64,
}

impl OfAll {
    fn new<'a>(regions: impl Iterator<Item = &'a OnGrid>) -> Self {
        let mut all = Self { hats: Vec::new(), area: 0.0 };
        for region in regions {
            all.hats.extend(&region.hats);
            all.area += region.size.area;
        }
        all
    }
}

/// A settled load, the regions of which are refined.
struct Settled<'a> {
    solids: Solids<'a>,
    state: &'a Pressed,
    fine: &'a FineContact,
    grid: &'a crate::mesh::SurfaceGrid,
    /// Numbers of the points of each region.
    regions: Vec<Vec<usize>>,
    /// That of [`solve_held`].
    tolerance: f64,
}

impl WheelOnRail<'_> {
    /// The regions of a `state` on grids of their own; `None` for a contact on the nodes of the meshes.
    ///
    /// # Errors
    /// Those of [`solve_held`].
    pub(super) fn refined(&self, state: &Pressed) -> Result<Option<Refined>> {
        let Some(fine) = state.fine() else { return Ok(None) };
        let regions = regions_of(state);
        let solids = self.solids(&state.hub);
        let (grid, tolerance) = (self.rail_surface.grid, self.field.held_to());
        let settled = Settled { solids, state, fine, grid, regions, tolerance };
        let mut found: Vec<Region> =
            (0..settled.regions.len()).map(|r| settled.first(r)).collect::<Result<_>>()?;
        let change = if self.field == ContactField::HybridWider { SETTLED_OF_THOUSANDS } else { SETTLED };
        while let Some(r) = wanting(&found, change) {
            found[r].halve(&settled, r)?;
        }
        Ok(Some(Refined {
            twice: OfAll::new(found.iter().map(|region| &region.twice)),
            finest: OfAll::new(found.iter().map(|region| &region.finest)),
        }))
    }
}

/// The region whose cells are to be halved, as values have not `settled` to this change; `None` where no more is wanted or possible.
fn wanting(regions: &[Region], settled: Size) -> Option<usize> {
    let largest = |of: fn(&Region) -> f64| {
        regions.iter().map(of).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
    };
    let (r, pressure) = largest(|region| region.finest.size.pressure);
    let (_, before) = largest(|region| region.twice.size.pressure);
    if (before / pressure - 1.0).abs() > settled.pressure && regions[r].can_be_halved() {
        return Some(r);
    }
    let sum: f64 = regions.iter().map(|region| region.finest.size.area).sum();
    let (r, change) = largest(|region| (region.finest.size.area - region.twice.size.area).abs());
    (change > settled.area * sum && regions[r].can_be_halved()).then_some(r)
}

/// A region on its two finest grids.
struct Region {
    /// Halvings of the grid of the load, by direction.
    halvings: [i32; 2],
    twice: OnGrid,
    finest: OnGrid,
}

impl Region {
    fn can_be_halved(&self) -> bool {
        self.halvings[0] < HALVINGS && 4 * self.finest.points.len() < MOST_POINTS
    }

    fn halve(&mut self, settled: &Settled, r: usize) -> Result<()> {
        let halvings = self.halvings.map(|h| h + 1);
        let finer = settled.solve(r, halvings, Some(&self.finest))?;
        self.twice = std::mem::replace(&mut self.finest, finer);
        self.halvings = halvings;
        Ok(())
    }
}

impl Settled<'_> {
    fn lattice(&self, halvings: [i32; 2]) -> Lattice {
        let cell = self.fine.lattice.cell;
        let halved = Vector2::new(cell.x * 0.5_f64.powi(halvings[0]), cell.y * 0.5_f64.powi(halvings[1]));
        Lattice::over(self.grid, halved)
    }

    /// A region on the first grids.
    fn first(&self, r: usize) -> Result<Region> {
        let (points, forces) = (&self.state.points, &self.state.solution.forces);
        let mut own = vec![0.0; points.len()];
        self.regions[r].iter().for_each(|&j| own[j] = forces[j]);
        let across = widths(&self.fine.lattice, points, &own);
        let halvings = [0, 1].map(|axis| {
            let wanted = (CELLS_ACROSS * self.fine.lattice.cell[axis] / across[axis]).log2().ceil();
            (wanted as i32).clamp(1 - axis as i32, HALVINGS)
        });
        let twice = match halvings.map(|h| h - 1) {
            [0, 0] => self.of_load(r),
            coarser => self.solve(r, coarser, None)?,
        };
        let finest = self.solve(r, halvings, Some(&twice))?;
        Ok(Region { halvings, twice, finest })
    }

    /// A region on the grid of the load itself.
    fn of_load(&self, r: usize) -> OnGrid {
        let (points, forces) = (&self.state.points, &self.state.solution.forces);
        let nodes: Vec<_> = self.regions[r].iter().map(|&j| points[j].index).collect();
        let (own, contact) = self.fine.at_nodes(&self.solids, self.fine.lattice, &nodes);
        let of_load = |point: &ContactPoint| {
            let at = points.binary_search_by_key(&point.index, |point| point.index);
            at.map_or(0.0, |j| forces[j])
        };
        let normal = own.iter().map(of_load).collect();
        OnGrid::new(&self.fine.lattice, own, contact, normal)
    }

    /// A region on the grid of the load halved so often, from the forces on a coarser grid, or those of the load.
    fn solve(&self, r: usize, halvings: [i32; 2], coarser: Option<&OnGrid>) -> Result<OnGrid> {
        let lattice = self.lattice(halvings);
        let mut reach = REACH;
        let mut found = self.solve_within(r, lattice, coarser, reach)?;
        for _ in 0..WIDENINGS {
            if !touches_border(&found.points, &found.normal) {
                break;
            }
            reach *= 2.0;
            let wider = self.solve_within(r, lattice, coarser, reach)?;
            if wider.points.len() == found.points.len() {
                break;
            }
            found = wider;
        }
        Ok(found)
    }

    fn solve_within(
        &self,
        r: usize,
        lattice: Lattice,
        coarser: Option<&OnGrid>,
        reach: f64,
    ) -> Result<OnGrid> {
        let (points, forces) = (&self.state.points, &self.state.solution.forces);
        let n = points.len();
        let directions = forces.len() / n;
        let inside = |j: usize| self.regions[r].binary_search(&j).is_ok();
        let nodes = match coarser {
            Some(on) => {
                let carrying = (0..on.points.len()).filter(|&j| on.normal[j] > 0.0);
                self.nodes_around(r, carrying.map(|j| &on.points[j]), &lattice, reach)
            }
            None => self.nodes_around(r, self.regions[r].iter().map(|&j| &points[j]), &lattice, reach),
        };
        let (own, contact) = self.fine.at_nodes(&self.solids, lattice, &nodes);
        let count = own.len();
        // the forces of the load on the points of this grid, and those of the other regions
        let of_load = self.fine.carry_over(points, forces, &lattice, &own, 1.0);
        let mut others = forces.clone();
        (0..others.len()).filter(|row| inside(row % n)).for_each(|row| others[row] = 0.0);
        let mut free = self.fine.far_motion(&others, &contact);
        for j in (0..n).filter(|&j| !inside(j) && forces[j] > 0.0) {
            let force = Vector3::from_fn(|d, _| others.get(d * n + j).copied().unwrap_or(0.0));
            for (free, point) in free.iter_mut().zip(&own) {
                *free +=
                    displacement_far_from(self.fine.bodies(), &(point.position - points[j].position), &force)
                        .x;
            }
        }
        if directions == 3 {
            let mut tangential = of_load.clone();
            tangential[..count].fill(0.0);
            contact.operator().add_product(&tangential, &mut free);
        }
        free.truncate(count);
        free.iter_mut().zip(gaps(&own)).for_each(|(free, gap)| *free += gap);
        let start = match coarser {
            Some(on) => on.contact.carry_over(&on.points, &on.normal, &lattice, &own, 1.0),
            None => of_load[..count].to_vec(),
        };
        let alone = contact.operator().normal();
        let compliance = alone.as_deref().unwrap_or(contact.operator());
        let problem = Problem { points: &own, compliance, free: &free, friction: 0.0, hub: &[] };
        let normal = solve_held(&problem, &start, self.tolerance)?;
        drop(alone);
        Ok(OnGrid::new(&lattice, own, contact, normal))
    }

    /// Nodes of a `lattice` within the `reach`, in cells of the coarser of both grids, of the `carrying` points of a region (in the order of their lines), as
    /// far as half the way to its neighbours.
    fn nodes_around<'p>(
        &self,
        r: usize,
        carrying: impl Iterator<Item = &'p ContactPoint>,
        lattice: &Lattice,
        reach: f64,
    ) -> Vec<(usize, usize)> {
        let place = |r: usize, last: bool| {
            let region = &self.regions[r];
            self.state.points[region[if last { region.len() - 1 } else { 0 }]].position.x
        };
        let [(low, high), (behind, ahead)] = [&self.grid.along_profile, &self.grid.along_track]
            .map(|lines| (lines[0], lines[lines.len() - 1]));
        let low = if r > 0 { 0.5 * (place(r - 1, true) + place(r, false)) } else { low };
        let high =
            if r + 1 < self.regions.len() { 0.5 * (place(r, true) + place(r + 1, false)) } else { high };
        // from where to where points carry, by their line
        let mut lines: Vec<(f64, f64, f64, Vector2<f64>)> = Vec::new();
        for point in carrying {
            let (s, x) = (point.position.x, point.position.y);
            match lines.last_mut() {
                Some((line, _, end, _)) if *line == s => *end = x,
                _ => lines.push((s, x, x, reach * point.widths.sup(&lattice.cell))),
            }
        }
        let mut wanted: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
        for (s, first, last, reach) in lines {
            let columns = lattice.columns_within((first - reach.y).max(behind), (last + reach.y).min(ahead));
            for line in lattice.lines_within(0, (s - reach.x).max(low), (s + reach.x).min(high)) {
                let ends = wanted.entry(line).or_insert((columns.start, columns.end));
                *ends = (ends.0.min(columns.start), ends.1.max(columns.end));
            }
        }
        wanted.into_iter().flat_map(|(line, (first, end))| (first..end).map(move |k| (line, k))).collect()
    }
}
