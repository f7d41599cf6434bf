//! The rail as a wheel in one place feels it: what a program needs that has no beams, or that has no share of a head in them.

use nalgebra::Vector3;
use railspring_calibrate::beam::{RailBeam, SectionModes};
use railspring_profiles::error::{InputError, Result};
use std::f64::consts::TAU;

use crate::element::condensed::parts::Bushing;
use crate::element::published::RailSupport;

use super::model::CondensedModel;

/// A mass of 1 kg on a spring that stands on the ground, and moves the head of the rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailOscillator {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Motion of the head under a unit displacement: y and z of the node line (m/m) and the rotation about x (rad/m), world axes.
    pub head: Vector3<f64>,
}

/// The rail under a wheel that stays in its place: natural modes of its beam as oscillators, and a bushing for what follows forces at once.
#[derive(Debug, Clone, PartialEq)]
pub struct RailAtWheel {
    /// By ascending frequency.
    pub oscillators: Vec<RailOscillator>,
    /// Between these and the head, without its parts between z and the others.
    pub bushing: Bushing,
}

impl CondensedModel {
    /// The rail at `x` (m from its first end) with the modes of its beam up to a frequency, Hz. Their damping is that of the rail's material, in proportion to stiffness.
    ///
    /// # Errors
    /// [`InputError`] for a rail that is no beam; [`railspring_profiles::error::NumericsError`] for a beam without mass.
    pub fn rail_at(&self, x: f64, highest: f64) -> Result<RailAtWheel> {
        let (beam, head) = (self.beam()?, self.head().at(x));
        let SectionModes { modes, rest } = beam.modes_at(x, highest)?;
        let oscillators = modes
            .iter()
            .map(|mode| RailOscillator {
                frequency: mode.square.sqrt() / TAU,
                head: head.share * mode.section,
            })
            .collect();
        let bushing = Bushing::of(&(head.flexibility + head.share * rest * head.share.transpose()));
        Ok(RailAtWheel { oscillators, bushing })
    }

    /// The bushing between the section of a beam without the share of its head and the head at `x` (m from the rail's first end): as flexible at rest. Near a held end, which makes the beam's section move more
    /// than the head, it is stiffer than that of the middle; without its parts between z and the others.
    ///
    /// # Errors
    /// [`InputError`] for a rail that is no beam.
    pub fn bushing_on_beam(&self, x: f64) -> Result<Bushing> {
        let (beam, head) = (self.beam()?.section_flexibility(x), self.head().at(x));
        Ok(Bushing::of(&(head.flexibility + head.share * beam * head.share.transpose() - beam)))
    }

    fn beam(&self) -> Result<&RailBeam> {
        match &self.support {
            RailSupport::Beam { beam, .. } => Ok(beam),
            RailSupport::Rigid => {
                InputError::refuse("rail", "rigid", "a rail of beams", "leave the rail as it is")
            }
        }
    }
}
