//! The refinement of the bodies that gives a wanted number of degrees of freedom.

use railspring::results::bodies::geometry::Geometry;
use railspring::study::Study;
use railspring_calibrate::mesh::{MeshOptions, rail_size, wheel_size};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;

/// Refinements between which is searched: elements so many times smaller than those of the study.
const RANGE: [f64; 2] = [0.35, 16.0];
/// Degrees of freedom may differ by this share from what is wanted: layers and rings are whole numbers.
const SIZE_TOLERANCE: f64 = 0.02;
/// Most sections that are meshed for one size.
const TRIALS: usize = 12;

/// Degrees of freedom over the refinement of the bodies, held nodes among them.
pub(super) struct Sizes<'a> {
    pub study: &'a Study,
    pub geometry: &'a Geometry,
    /// Sizes of the elements of the study's own bodies.
    pub options: &'a MeshOptions,
    /// The coarsest bodies that may be wanted: refinement and degrees of freedom.
    coarsest: (f64, f64),
}

impl<'a> Sizes<'a> {
    /// The sizes that the bodies of a study can have around its contact zone, which is meshed with `options`.
    ///
    /// # Errors
    /// Those of meshing a section.
    pub fn new(study: &'a Study, geometry: &'a Geometry, options: &'a MeshOptions) -> Result<Self> {
        let mut sizes = Self { study, geometry, options, coarsest: (RANGE[0], 0.0) };
        sizes.coarsest.1 = sizes.count(RANGE[0])?;
        Ok(sizes)
    }

    /// Degrees of freedom of the coarsest bodies.
    pub fn least(&self) -> f64 {
        self.coarsest.1
    }

    fn count(&self, refined: f64) -> Result<f64> {
        let options = self.options.with_bodies_refined(refined);
        let rail = rail_size(&self.geometry.pair.rail, self.study.rail.length, &options)?;
        let wheel = wheel_size(&self.geometry.pair.wheel, &options)?;
        Ok(3.0 * (rail.nodes + wheel.nodes) as f64)
    }

    /// The refinement for the wanted degrees of freedom, of which a coarser one has no more.
    ///
    /// # Errors
    /// [`InputError`] for sizes that the contact zone alone exceeds, or that take elements smaller than are searched; those of meshing a
    /// section, and an interruption.
    pub fn refinement(&mut self, wanted: usize, monitor: &dyn Monitor) -> Result<f64> {
        let target = wanted as f64;
        let count = |refined: f64| -> Result<(f64, f64)> {
            monitor.progress("size of the meshes", 0, 1)?;
            Ok((refined, self.count(refined)?))
        };
        let mut least = self.coarsest;
        if target < (1.0 - SIZE_TOLERANCE) * least.1 {
            return Err(InputError::new(
                "--from",
                wanted,
                format!("{:.0} or more, which the contact zone of the study takes", least.1.ceil()),
                "leave it out, or name a study with larger contact elements",
            )
            .into());
        }
        // the first one that has enough
        let mut most = least;
        while most.1 < target {
            least = most;
            if most.0 >= RANGE[1] {
                return Err(InputError::new(
                    "--to",
                    wanted,
                    format!("at most {:.0}, with elements {} times smaller", most.1, RANGE[1]),
                    "choose a smaller one, or name a study with smaller elements",
                )
                .into());
            }
            most = count((1.5 * most.0).min(RANGE[1]))?;
        }
        let found = between(least, most, target, &count)?;
        self.coarsest = least;
        Ok(found)
    }
}

/// The refinement between two, each with its count, that comes close to `target`.
fn between(
    mut least: (f64, f64),
    mut most: (f64, f64),
    target: f64,
    count: &dyn Fn(f64) -> Result<(f64, f64)>,
) -> Result<f64> {
    let off = |found: &(f64, f64)| (found.1 / target).ln().abs();
    let mut best = if off(&least) < off(&most) { least } else { most };
    for _ in 0..TRIALS {
        if off(&best) < SIZE_TOLERANCE {
            break;
        }
        let middle = count((least.0 * most.0).sqrt())?;
        if off(&middle) < off(&best) {
            best = middle;
        }
        if middle.1 < target {
            least = middle;
        } else {
            most = middle;
        }
    }
    Ok(best.0)
}
