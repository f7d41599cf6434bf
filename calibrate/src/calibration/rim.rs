//! The rim of a patch on a fine grid, and the tangent.
//!
//! A point carries load or none, so that a patch is as large as a whole number of cells. The tangent of just these points is that of a
//! patch which is too large or too small by a part of the cells at its rim: by 0.5 % with sixteen cells across, and at random. The forces are not: with the
//! load, points join the patch one after the other, and the tangents in between are right in the mean. So the tangent is that of a way over which some cells of the rim
//! join, with the curvature that the approach has in Hertz' contact.

use super::grid::{regions_on_grid, touches_border};
use super::pressed::{Answer, Pressed, WheelOnRail};
use crate::contact::{ComplianceOperator, Factors, PointMode, Problem, Solution, response_to, solve_held};

/// Parts of a load by which it changes over the way, the first that leaves the patches as many as they are. With sixteen cells across a round patch the first leaves 0.1 % of
/// scatter in the tangent, the second 0.2 % and the third 0.3 %.
const PARTS: [f64; 3] = [0.225, 0.11, 0.055];

/// The normal contact of a state, with the hub moved along its direction.
struct Normal<'a> {
    state: &'a Pressed,
    compliance: &'a dyn ComplianceOperator,
    answer: &'a Answer,
    /// Normal components of the direction at the points.
    weights: Vec<f64>,
    /// Gaps without normal forces, m.
    free: Vec<f64>,
    /// That of [`solve_held`].
    tolerance: f64,
}

impl WheelOnRail<'_> {
    /// What is to be added to the tangent compliance of the points that carry load at a state, m/N, for that of the whole patch. It is 0 on the nodes of meshes, and where
    /// a patch begins so near the load that no way is short enough.
    pub(super) fn rim_compliance(&self, state: &Pressed, answer: &Answer) -> f64 {
        let Some(fine) = state.fine() else { return 0.0 };
        let n = state.points.len();
        let alone = fine.operator().normal();
        let compliance = alone.as_deref().unwrap_or(fine.operator());
        let along = self.world_direction();
        let weights = state.points.iter().map(|point| point.direction(0).dot(&along)).collect();
        let forces = &state.solution.forces[..n];
        let mut free = vec![0.0; n];
        compliance.add_product(forces, &mut free);
        free.iter_mut().zip(&state.solution.separation).for_each(|(free, gap)| *free = gap - *free);
        let tolerance = self.field.held_to();
        Normal { state, compliance, answer, weights, free, tolerance }.rim()
    }
}

impl Normal<'_> {
    fn rim(&self) -> f64 {
        let n = self.state.points.len();
        let forces = &self.state.solution.forces[..n];
        let Some(of_points) = self.compliance_of_points() else { return 0.0 };
        let load = self.along(forces);
        let patches = regions_on_grid(&self.state.points, forces);
        for part in PARTS {
            let way = part * load * of_points;
            // a way to where the contact does not settle is too long, too
            let [Some(less), Some(more)] = [-way, way].map(|way| self.moved(way)) else { continue };
            let whole = |forces: &[f64]| {
                regions_on_grid(&self.state.points, forces) == patches
                    && !touches_border(&self.state.points, forces)
            };
            if whole(&less) && whole(&more) {
                let [down, up] = [load - self.along(&less), self.along(&more) - load];
                if down > 0.0 && up > 0.0 {
                    return between(way / down, way / up, down / load, up / load) - of_points;
                }
            }
        }
        0.0
    }

    /// Forces along the direction of the hub, N.
    fn along(&self, forces: &[f64]) -> f64 {
        -forces.iter().zip(&self.weights).map(|(force, weight)| force * weight).sum::<f64>()
    }

    /// The tangent compliance of just the points that carry load, m/N.
    fn compliance_of_points(&self) -> Option<f64> {
        let n = self.state.points.len();
        let Solution { forces, separation, modes, .. } = &self.state.solution;
        let carrying =
            |mode: &PointMode| if *mode == PointMode::Open { PointMode::Open } else { PointMode::Stick };
        let solution = Solution {
            forces: forces[..n].to_vec(),
            separation: separation[..n].to_vec(),
            modes: modes.iter().map(carrying).collect(),
            hub: Vec::new(),
            iterations: 0,
        };
        let rates = std::slice::from_ref(&self.answer.rates);
        let change =
            response_to(&self.problem(&self.free), &solution, rates, false, &mut Factors::default())?;
        Some(1.0 / self.along(change.col_as_slice(0)))
    }

    fn problem<'p>(&'p self, free: &'p [f64]) -> Problem<'p> {
        Problem { points: &self.state.points, compliance: self.compliance, free, friction: 0.0, hub: &[] }
    }

    /// The normal forces, N, with the hub moved by a `way`, m.
    fn moved(&self, way: f64) -> Option<Vec<f64>> {
        let n = self.state.points.len();
        let free: Vec<f64> =
            self.free.iter().zip(&self.answer.rates).map(|(gap, rate)| gap + way * rate).collect();
        let change = self.answer.forces[..n].iter().zip(&self.state.solution.forces);
        let start: Vec<f64> = change.map(|(change, force)| (force + way * change).max(0.0)).collect();
        solve_held(&self.problem(&free), &start, self.tolerance).ok()
    }
}

/// The compliance at a load by those over ways `down` and `up` from it, m/N, over which the load changes by the parts `less` and `more`. With Hertz' contact in
/// series with bodies `C = A + B·F^(-1/3)`, so that `F·C'' = -4/3·C'`.
fn between(down: f64, up: f64, less: f64, more: f64) -> f64 {
    let (below, above) = (0.5 * less + 2.0 / 9.0 * less * less, 0.5 * more - 2.0 / 9.0 * more * more);
    (below * up + above * down) / (below + above)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: `δ = A·F + 3/2·B·F^(2/3)`, bodies in series with Hertz' contact. Goal: the compliance at a load, m/N, by the loads a way below and above it. Accuracy: the
    /// next term of the curvature, 2e-5. Their mean is 0.4 % off.
    #[test]
    fn the_curvature_is_that_of_hertz() {
        const CURVATURE: f64 = 2e-5;
        for (bodies, contact) in [(0.0, 1.0), (1.0, 1.0), (3.0, 0.5)] {
            let approach = |load: f64| bodies * load + 1.5 * contact * load.powf(2.0 / 3.0);
            let exact = bodies + contact;
            for part in PARTS {
                let way = part * exact;
                let load = |wanted: f64| {
                    let (mut low, mut high) = (0.1, 3.0);
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        *if approach(middle) < wanted { &mut low } else { &mut high } = middle;
                    }
                    low
                };
                let [less, more] = [1.0 - load(approach(1.0) - way), load(approach(1.0) + way) - 1.0];
                let found = between(way / less, way / more, less, more);
                assert!((found / exact - 1.0).abs() < CURVATURE, "{bodies} {part}: {found} {exact}");
            }
        }
    }
}
