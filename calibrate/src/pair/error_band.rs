//! What the laws of a pair are worth: how far they change with the grid of the contact and with the meshes of the bodies.
//!
//! Twice as large elements change a law by what it is still away from its limit if the error is of first order in the size of the
//! elements, and by three times as much if it is of second order. The error of the bodies lies between (order 1.35 was seen, from their
//! corners and their elements of unlike shape), so that the change holds it. Half the spacing of the grid, whose error is of second order, changes
//! the law by three quarters of it. Where the bodies are meshes alone there is no finer grid, and the coarser mesh has the steps from
//! node to node in it as well.

use super::bodies::{CondensedPair, ContactConditions, PressedPair};
use super::by_shift::AngleLaw;
use super::geometry::Pair;
use crate::calibration::{ContactField, LoadPoint, NormalCalibration, Reference, load_points, press_loads};
use crate::error::Result;
use crate::monitor::Monitor;

/// The laws of one pair against foot, section and of the approach alone, in the order of [`AngleLaw::REFERENCES`].
pub type Laws = [NormalCalibration; 3];

/// Ratio of the elements of the coarser mesh to those of the mesh whose error it shows: with it an error of first order changes by
/// itself, and one of a higher order by more.
pub const COARSER: f64 = 2.0;

/// Loads at which the grid is halved, at most: one takes as long as a dozen on the grid itself.
pub const LOADS_HALVED: usize = 8;

/// Numbers of so many of `count` loads, evenly from the first to the last.
fn spread(count: usize) -> Vec<usize> {
    let most = count.min(LOADS_HALVED);
    (0..most).map(|n| n * (count - 1) / (most - 1).max(1)).collect()
}

/// Relative change of displacement and tangent at a load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Change {
    /// Of the displacement.
    pub displacement: f64,
    /// Of the tangent stiffness.
    pub tangent: f64,
}

impl Change {
    /// From the solid at a load to `other`, which is the same computed otherwise.
    pub fn between(point: &LoadPoint, other: &LoadPoint) -> Self {
        Self {
            displacement: other.displacement / point.displacement - 1.0,
            tangent: other.solid_tangent / point.solid_tangent - 1.0,
        }
    }

    /// Of two changes the larger displacement and the larger tangent, by their sizes.
    fn larger(self, other: Self) -> Self {
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        Self {
            displacement: larger(self.displacement, other.displacement),
            tangent: larger(self.tangent, other.tangent),
        }
    }

    /// As displacement and compliance of `point` change by what they differ between two computations.
    fn added(point: &LoadPoint, one: &LoadPoint, other: &LoadPoint) -> Self {
        let compliance = 1.0 / point.solid_tangent + 1.0 / other.solid_tangent - 1.0 / one.solid_tangent;
        Self {
            displacement: (other.displacement - one.displacement) / point.displacement,
            tangent: 1.0 / (compliance * point.solid_tangent) - 1.0,
        }
    }
}

/// What a law is worth at one load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPoint {
    /// Load, N.
    pub force: f64,
    /// Change with the grid of the contact halved; none for a contact on the nodes of the meshes.
    pub grid: Option<Change>,
    /// Change with a coarser mesh of both bodies; none where there is none.
    pub mesh: Option<Change>,
}

impl BandPoint {
    /// Half the width of the band: the sizes of both changes together.
    pub fn band(&self) -> Change {
        let sum =
            |of: fn(Change) -> f64| [self.grid, self.mesh].into_iter().flatten().map(|c| of(c).abs()).sum();
        Change { displacement: sum(|c| c.displacement), tangent: sum(|c| c.tangent) }
    }
}

/// What a law is worth, load by load.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBand {
    /// The reference of the law.
    pub reference: Reference,
    /// The loads.
    pub points: Vec<BandPoint>,
}

impl ErrorBand {
    /// The largest band of all loads, that of the displacement and that of the tangent each by itself.
    pub fn largest(&self) -> Change {
        self.points.iter().map(BandPoint::band).fold(Change::default(), |largest, band| Change {
            displacement: largest.displacement.max(band.displacement),
            tangent: largest.tangent.max(band.tangent),
        })
    }
}

/// The bands of `laws` from their changes by reference and load, as [`CondensedPair::grid_changes`] and [`mesh_changes`] have them.
pub fn error_bands(
    laws: &Laws,
    grid: Option<&[Vec<Change>; 3]>,
    mesh: Option<&[Vec<Change>; 3]>,
) -> [ErrorBand; 3] {
    [0, 1, 2].map(|i| {
        let at =
            |changes: Option<&[Vec<Change>; 3]>, load: usize| changes.and_then(|c| c[i].get(load).copied());
        let point = |(load, p): (usize, &LoadPoint)| BandPoint {
            force: p.force,
            grid: at(grid, load),
            mesh: at(mesh, load),
        };
        ErrorBand {
            reference: laws[i].reference,
            points: laws[i].points.iter().enumerate().map(point).collect(),
        }
    })
}

/// Changes from `laws` to those of a `coarser` mesh under the same loads.
pub fn mesh_changes(laws: &Laws, coarser: &Laws) -> [Vec<Change>; 3] {
    [0, 1, 2].map(|i| {
        let both = laws[i].points.iter().zip(&coarser[i].points);
        both.map(|(point, other)| Change::between(point, other)).collect()
    })
}

impl PressedPair<'_> {
    /// The laws with every reference.
    ///
    /// # Errors
    /// Those of [`PressedPair::fit`].
    pub fn laws(&self) -> Result<Laws> {
        let [foot, beam, local] = AngleLaw::REFERENCES.map(|reference| self.fit(reference));
        Ok([foot?, beam?, local?])
    }
}

impl CondensedPair {
    /// Changes from the `laws` of these bodies in `contact` to those on a grid of half the spacing; none for a contact on the nodes of
    /// the meshes.
    ///
    /// The grid concerns the normal contact, which is the same whatever holds the rail. So the wheel is pressed on both grids without
    /// friction and with the foot held, and what displacement and compliance change by there, they change by in every law. At a load
    /// between two of those, which are few, the larger change of the two counts.
    ///
    /// # Errors
    /// Those of [`press_loads`] and of the tangents.
    pub fn grid_changes(
        &self,
        pair: &Pair,
        contact: ContactConditions,
        laws: &Laws,
        monitor: &dyn Monitor,
    ) -> Result<Option<[Vec<Change>; 3]>> {
        if contact.field == ContactField::Elements {
            return Ok(None);
        }
        let among = spread(laws[0].points.len());
        let loads: Vec<f64> = among.iter().map(|&i| laws[0].points[i].force).collect();
        let on_grid = |field| -> Result<[Vec<LoadPoint>; 2]> {
            let conditions = ContactConditions { field, friction: 0.0, ..contact };
            let wheel_on_rail = self.wheel_on_rail(pair, Reference::Foot, conditions);
            let states = press_loads(&wheel_on_rail, &loads, "error of the grid", monitor)?;
            let points = |reference| load_points(&wheel_on_rail, &states, reference);
            Ok([points(Reference::Foot)?, points(Reference::Local)?])
        };
        let [foot, local] = on_grid(ContactField::Hybrid)?;
        let [foot_halved, local_halved] = on_grid(ContactField::HybridHalved)?;
        let changes = |law: &NormalCalibration, points: &[LoadPoint], halved: &[LoadPoint]| -> Vec<Change> {
            let of = |i: usize, at: usize| Change::added(&law.points[i], &points[at], &halved[at]);
            let between = |i: usize| {
                let upper = among.partition_point(|&load| load < i);
                let lower = if among[upper] == i { upper } else { upper - 1 };
                of(i, lower).larger(of(i, upper))
            };
            (0..law.points.len()).map(between).collect()
        };
        Ok(Some([
            changes(&laws[0], &foot, &foot_halved),
            changes(&laws[1], &foot, &foot_halved),
            changes(&laws[2], &local, &local_halved),
        ]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::StiffnessLaw;

    /// ROUNDOFF: some sums and products of numbers of order one.
    const ROUNDOFF: f64 = 1e-12;

    /// The laws of a made-up solid at three loads, displacement and tangent times the given factors at the last load.
    fn laws(displacement: f64, tangent: f64) -> Laws {
        AngleLaw::REFERENCES.map(|reference| {
            let law = StiffnessLaw::published();
            let point = |force: f64| LoadPoint {
                force,
                displacement: law.displacement(force) * if force > 80e3 { displacement } else { 1.0 },
                solid_tangent: law.tangent(force) * if force > 80e3 { tangent } else { 1.0 },
                contact_area: 0.0,
                max_pressure: 0.0,
                semi_axis_along: 0.0,
                semi_axis_across: 0.0,
                local_compliance: 0.0,
                wheel_compliance: 0.0,
                rail_compliance: 0.0,
                sliding_compliance: 0.0,
                penalty_error: 0.0,
                active_points: 0,
            };
            NormalCalibration::new(reference, [10e3, 40e3, 70e3, 100e3].map(point).to_vec()).unwrap()
        })
    }

    /// Goal: the first and the last load are among those of the halved grid, none twice, and all where they are few.
    #[test]
    fn the_loads_of_the_halved_grid_span_the_range() {
        for count in 1..60 {
            let among = spread(count);
            assert_eq!(
                (among.len(), among[0], among[among.len() - 1]),
                (count.min(LOADS_HALVED), 0, count - 1)
            );
            assert!(among.windows(2).all(|pair| pair[0] < pair[1]), "{among:?}");
        }
    }

    /// Goal: changes of opposite sign do not take each other's place in the band; a part that is missing adds nothing; the largest
    /// is that of all loads, relative. Accuracy: ROUNDOFF.
    #[test]
    fn the_band_is_the_sum_of_the_sizes_of_the_changes() {
        let base = laws(1.0, 1.0);
        let mesh = mesh_changes(&base, &laws(1.01, 0.97));
        let grid = mesh_changes(&base, &laws(0.996, 1.02));
        let near = |a: f64, b: f64| (a - b).abs() < ROUNDOFF;
        for (bands, displacement, tangent) in [
            (error_bands(&base, Some(&grid), Some(&mesh)), 0.014, 0.05),
            (error_bands(&base, None, Some(&mesh)), 0.01, 0.03),
            (error_bands(&base, Some(&grid), None), 0.004, 0.02),
            (error_bands(&base, None, None), 0.0, 0.0),
        ] {
            for band in bands {
                let (largest, first) = (band.largest(), band.points[0].band());
                assert!(
                    near(largest.displacement, displacement) && near(largest.tangent, tangent),
                    "{band:?}"
                );
                assert_eq!(first, Change::default());
                assert_eq!(band.points.len(), 4);
            }
        }
    }
}
