//! What is measured of a contact patch: its size, its largest pressure and the stresses below it, each with its error.

use super::pressed::{Pressed, WheelOnRail};
use super::refined::Refined;
use crate::contact::{Hat, Peak, PointMode, Subsurface, hats, subsurface};
use railspring_profiles::error::Result;

/// Size of a contact patch and the stresses that it makes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PatchValues {
    /// Area that carries pressure, m².
    pub area: f64,
    /// Largest pressure at a point, Pa.
    pub max_pressure: f64,
    /// Semi-axis of the patch along the track, m: that of the Hertz ellipse with the same second moment of pressure.
    pub semi_axis_along: f64,
    /// Semi-axis of the patch across the track, m.
    pub semi_axis_across: f64,
    /// The largest stresses of a half-space below it; none where they are not sought, and for a contact on the nodes of a mesh, which do not resolve the pressure.
    pub below: Option<Subsurface>,
}

/// How far values of a patch are from those on cells twice as large, relative: an error of first order in the size of the cells is as large, one of second order a third
/// of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PatchBand {
    /// Of the area.
    pub area: f64,
    /// Of the largest pressure.
    pub max_pressure: f64,
    /// Of the largest von Mises stress and its depth.
    pub mises: PeakBand,
    /// Of the largest shear stress and its depth.
    pub shear: PeakBand,
}

/// The same of a largest stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakBand {
    /// Of the stress.
    pub stress: f64,
    /// Of its depth.
    pub depth: f64,
}

/// A contact patch.
#[derive(Debug, Clone)]
pub struct Patch {
    /// What is measured of it.
    pub values: PatchValues,
    /// Its pressure, on the finest grid of each region.
    pub hats: Vec<Hat>,
    /// Error bands of the values; none without stresses, and for a contact on the nodes of a mesh.
    pub band: Option<PatchBand>,
}

impl WheelOnRail<'_> {
    /// Measures the patch of a state: on the fine grid each of its regions on grids of its own.
    ///
    /// # Errors
    /// [`railspring_profiles::error::NumericsError`] where the pressure of a region is not found.
    pub fn patch(&self, state: &Pressed) -> Result<Patch> {
        self.measured(state, true)
    }

    /// As [`Self::patch`], without the stresses below it and without error bands, in two thirds of the time.
    ///
    /// # Errors
    /// Those of [`Self::patch`].
    pub fn patch_without_stresses(&self, state: &Pressed) -> Result<Patch> {
        self.measured(state, false)
    }

    fn measured(&self, state: &Pressed, stresses: bool) -> Result<Patch> {
        let Some(refined) = self.refined(state)? else {
            let carrying = state.points.iter().zip(&state.solution.modes);
            let carrying = carrying.filter(|(_, mode)| **mode != PointMode::Open);
            let area = carrying.map(|(point, _)| point.area).sum();
            let hats = hats(&state.points, &state.solution.forces);
            let mut values = measured(&hats, area, None);
            let points = state.points.iter().zip(&state.solution.forces);
            values.max_pressure = points.map(|(point, force)| force / point.area).fold(0.0, f64::max);
            return Ok(Patch { values, hats, band: None });
        };
        let Refined { twice, finest } = refined;
        let below =
            stresses.then(|| subsurface(&twice.hats, &finest.hats, self.materials[0].poisson)).flatten();
        let [below_twice, below_finest] = below.map_or([None; 2], |below| below.map(Some));
        let values = measured(&finest.hats, finest.area, below_finest);
        let band = band(&values, &measured(&twice.hats, twice.area, below_twice));
        Ok(Patch { values, hats: finest.hats, band })
    }

    /// The patches of `states`, side by side.
    ///
    /// # Errors
    /// Those of [`Self::patch`].
    pub fn patches(&self, states: &[Pressed]) -> Result<Vec<Patch>> {
        use rayon::prelude::*;
        states.par_iter().map(|state| self.patch(state)).collect()
    }
}

/// The pressure of a Hertz ellipse has the second moment a²/5 about its centre; that of a bilinear nodal pressure adds a sixth of its width
/// squared.
fn measured(hats: &[Hat], area: f64, below: Option<Subsurface>) -> PatchValues {
    let sum: f64 = hats.iter().map(|hat| hat.force).sum();
    let mean = |value: &dyn Fn(&Hat) -> f64| hats.iter().map(|hat| hat.force * value(hat)).sum::<f64>() / sum;
    let semi_axis = |axis: usize| {
        let centre = mean(&|hat| hat.place[axis]);
        (5.0 * mean(&|hat| (hat.place[axis] - centre).powi(2) + hat.widths[axis].powi(2) / 6.0)).sqrt()
    };
    PatchValues {
        area,
        max_pressure: hats.iter().map(|hat| hat.force / hat.widths.product()).fold(0.0, f64::max),
        semi_axis_across: semi_axis(0),
        semi_axis_along: semi_axis(1),
        below,
    }
}

/// Changes of values from those on cells twice as large.
fn band(values: &PatchValues, twice: &PatchValues) -> Option<PatchBand> {
    let change = |of: f64, before: f64| (before / of - 1.0).abs();
    let (below, before) = (values.below?, twice.below?);
    let peak = |of: &Peak, before: &Peak| PeakBand {
        stress: change(of.stress, before.stress),
        depth: change(of.depth, before.depth),
    };
    Some(PatchBand {
        area: change(values.area, twice.area),
        max_pressure: change(values.max_pressure, twice.max_pressure),
        mises: peak(&below.mises, &before.mises),
        shear: peak(&below.shear, &before.shear),
    })
}
