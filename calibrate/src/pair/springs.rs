//! From two profiles to their springs in one call.

use super::bodies::{ContactConditions, Laws};
use super::geometry::Pair;
use super::solids::PairBody;
use crate::calibration::{ContactField, Enforcement, HorizontalCalibration, Reference};
use crate::mesh::MeshOptions;
use crate::solid::{Formulation, Material};
use railspring_profiles::error::{Error, Result};
use railspring_profiles::monitor::{Monitor, Silent};

/// How a pair is meshed, pressed and fitted. The default values are those of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// Length of the rail between its held ends, m.
    pub rail_length: f64,
    /// Sizes of the elements.
    pub mesh: MeshOptions,
    /// Material of both bodies.
    pub material: Material,
    /// The bricks.
    pub element: Formulation,
    /// How wheel and rail meet.
    pub contact: ContactConditions,
    /// Vertical preloads of the horizontal stiffness, N, ascending. Those above the largest load are left out;
    /// where all are, the largest load is the preload.
    pub preloads: Vec<f64>,
    /// Whether the law against the held foot is made as well, for which the rail is condensed twice.
    pub foot_held: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        let mesh = MeshOptions::default();
        Self {
            rail_length: 0.555,
            // a patch of the flange is longer than the window; the fine grid goes on beyond it
            mesh: MeshOptions { contact_half_length: 2.0 * mesh.window_half_length, ..mesh },
            material: Material::STEEL,
            element: Formulation::IncompatibleModes,
            contact: ContactConditions {
                friction: 0.5,
                enforcement: Enforcement::Exact,
                field: ContactField::Hybrid,
            },
            preloads: vec![20e3, 50e3, 85e3, 120e3],
            foot_held: false,
        }
    }
}

/// The springs of a pair.
#[derive(Debug, Clone)]
pub struct PairSprings {
    /// Normal laws with every reference.
    pub laws: Laws,
    /// Horizontal stiffness of a sticking wheel against the rail's section.
    pub horizontal: HorizontalCalibration,
    /// Why the laws end before the largest load, if they do.
    pub ended: Option<Error>,
}

impl Pair {
    /// The springs of this pair under vertical `loads` (N, ascending, four or more), with the options of a study.
    ///
    /// # Errors
    /// As [`Self::fit_with`].
    pub fn fit(&self, loads: &[f64]) -> Result<PairSprings> {
        self.fit_with(loads, &FitOptions::default(), &Silent)
    }

    /// The same with other `options`. It meshes and condenses the bodies, presses the wheel on the rail and fits
    /// the laws. [`Self::mesh`] and what follows on it are the same steps one by one, for bodies that serve again.
    ///
    /// # Errors
    /// Meshes that the options do not allow, loads that are not ascending or that the contact zone does not carry,
    /// contact that does not converge, and an interruption.
    pub fn fit_with(
        &self,
        loads: &[f64],
        options: &FitOptions,
        monitor: &dyn Monitor,
    ) -> Result<PairSprings> {
        let FitOptions { material, element, contact, .. } = *options;
        let wanted = PairBody::of_pair(options.foot_held);
        let meshes = self.mesh(options.rail_length, &options.mesh)?;
        let bodies = meshes.condense(self, wanted, material, element, monitor)?;
        let pressed = bodies.press(self, contact, loads, monitor)?;
        let laws = pressed.laws()?;
        let carried = laws.beam.points.last().map_or(0.0, |point| point.force);
        let mut preloads: Vec<f64> =
            options.preloads.iter().copied().filter(|load| *load <= carried).collect();
        if preloads.is_empty() {
            preloads.push(carried);
        }
        let horizontal = pressed.horizontal(Reference::Beam, &preloads, monitor)?;
        Ok(PairSprings { laws, horizontal, ended: pressed.ended().cloned() })
    }
}
