//! The work of what moves a wheel along a rail: what the rail stores more than the contact forces and the torsion do on it.

use super::super::at_place::AtPlace;
use super::super::loads::in_runs;
use super::prepared::ReducedBody;
use nalgebra::DVector;

/// Work in a step, J.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Driven {
    /// On the modes.
    pub of_modes: f64,
    /// On what follows the forces at once.
    pub of_residual: f64,
}

/// An end of a step.
pub(super) struct Ends<'s> {
    pub at: &'s AtPlace,
    /// Forces on the contact nodes, N, and the torsion, N·m.
    pub forces: &'s [f64],
    /// Displacements of the coordinates.
    pub coordinates: &'s DVector<f64>,
}

impl ReducedBody<'_> {
    /// Between two ends of a step in which the contact has moved. In a step the forces do the mean of their values times the way; the difference of the shapes at both places is what the way is not
    /// of the coordinates, and that of the residuals what the contact would otherwise store of nothing.
    pub(super) fn driven(&self, [before, after]: [Ends<'_>; 2]) -> Driven {
        let (contact, held) = (self.contact_rows(), self.hub.len());
        let loads = |ends: &Ends| {
            let nodes = ends.forces[..contact].iter().copied().enumerate();
            in_runs(nodes.filter(|(_, force)| *force != 0.0))
        };
        let torsion = |ends: &Ends| ends.forces.get(contact).copied().unwrap_or_default();
        let (loads, torsions) = ([loads(&before), loads(&after)], [torsion(&before), torsion(&after)]);
        // forces of either end on the coordinates and the window's motions at either place
        let [of_before, of_after] = [&before, &after].map(|ends| [0, 1].map(|of| ends.at.on_all(&loads[of])));
        let coordinates = before.at.coordinates;
        let change = [0, 1].map(|of| &of_after[of] - &of_before[of]);
        let on_shapes = |of: usize, with: &DVector<f64>| change[of].rows(0, coordinates).dot(with);
        let of_modes = -0.5 * (on_shapes(0, after.coordinates) + on_shapes(1, before.coordinates));
        let statics = |a: &DVector<f64>, b: &DVector<f64>| {
            let modes = |v: &DVector<f64>| v.rows(held, coordinates - held).into_owned();
            modes(a).dot(&(&self.static_inverse * modes(b)))
        };
        let window = |of: &DVector<f64>| of.rows(coordinates, of.len() - coordinates).into_owned();
        let differs = &after.at.difference - &before.at.difference;
        let between = window(&of_before[0]).dot(&(differs * window(&of_before[1])))
            - statics(&of_after[0], &of_after[1])
            + statics(&of_before[0], &of_before[1]);
        // the torsion's own compliance is the same everywhere
        let unit = self.of_torsion(1.0);
        let turned = |of: usize| {
            let rows = loads[of].iter().flat_map(|load| load.rows.clone().zip(&load.forces));
            let twist: f64 =
                rows.map(|(row, force)| (after.at.twist[row] - before.at.twist[row]) * force).sum();
            twist - statics(&change[of], &unit)
        };
        let of_torsion = match torsions {
            [0.0, 0.0] => 0.0,
            [first, second] => first * turned(1) + second * turned(0),
        };
        Driven { of_modes, of_residual: -0.5 * (between + of_torsion) / self.stiffening() }
    }
}
