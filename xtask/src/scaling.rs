//! How time and memory of the solid model grow with its degrees of freedom: the same pair with bodies of more and more elements.
//!
//! The contact zone stays as it is; what is refined are the bodies ([`railspring_calibrate::mesh::MeshOptions::with_bodies_refined`]). Each body is condensed by
//! itself, stage by stage, so that a stage has its own time and its own peak of the memory. What a size takes is predicted before
//! it is taken.

mod clock;
mod power;
mod record;
pub mod figure;
mod parts;
mod sizes;

use power::PowerLaw;
use railspring::engine::measure::{Stopwatch, machine, now_utc};
use railspring::results::bodies::estimate::{CONTACT_OF_STEP, GIB, Resources, least_memory};
use railspring::results::bodies::{geometry, meshes, solids, zones};
use railspring::study::Study;
use railspring_profiles::error::{InputError, Result};
use railspring_simulate::solid::START_MODES;
use record::{BOTH, ExponentRecord, PredictedRecord, ScalingBody, ScalingSize, SkippedSize};
use sizes::Sizes;

pub use record::ScalingRecord;

/// Bytes of a mebibyte.
const MIB: f64 = 1024.0 * 1024.0;
/// Rows of the dense product with which the factorisations are compared: as many as the largest supernodes have columns.
const PRODUCT: usize = 1024;

/// The sizes of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// Degrees of freedom of the smallest; none: [`FROM`], or the least that the study's contact zone allows.
    pub from: Option<usize>,
    /// Degrees of freedom of the largest.
    pub to: usize,
    /// How many sizes, in equal ratios.
    pub sizes: usize,
}

/// Degrees of freedom of the smallest size, unless it is given.
pub const FROM: usize = 50_000;

impl Sweep {
    /// Degrees of freedom of all sizes; `least` are those of the coarsest bodies.
    ///
    /// # Errors
    /// [`InputError`] for a smallest size that is not below the largest.
    fn wanted(&self, least: f64) -> Result<Vec<usize>> {
        let from = self.from.unwrap_or(FROM.max(least.ceil() as usize));
        if from >= self.to {
            let remedy = "choose a larger one, or a smaller --from";
            return Err(InputError::new("--to", self.to, format!("more than {from}"), remedy).into());
        }
        let ratio = self.to as f64 / from as f64;
        let part = |n: usize| n as f64 / (self.sizes.max(2) - 1) as f64;
        Ok((0..self.sizes).map(|n| (from as f64 * ratio.powf(part(n))).round() as usize).collect())
    }
}

/// Measures the sizes one after the other; `each` gets what is finished after every size, and at the end.
///
/// # Errors
/// Bodies with meshes from files, sizes that no refinement gives, those of the stages and of `each`, and an interruption.
pub fn sweep(
    study: &Study,
    sweep: &Sweep,
    resources: &Resources<'_>,
    each: &mut dyn FnMut(&ScalingRecord) -> Result<()>,
) -> Result<ScalingRecord> {
    refuse_mesh_files(study)?;
    let geometry = geometry::geometry(study.statics())?;
    let options = zones::mesh_options(study.statics(), &geometry);
    let mut sizes = Sizes::new(study, &geometry, &options)?;
    let wanted = sweep.wanted(sizes.least())?;
    let mut record = ScalingRecord {
        study: study.name.clone(),
        begun_utc: now_utc(),
        machine: machine(),
        threads: rayon::current_num_threads(),
        modes: study.solid.modes.unwrap_or(START_MODES),
        sizes: Vec::new(),
        skipped: Vec::new(),
        exponents: Vec::new(),
    };
    for (n, &wanted) in wanted.iter().enumerate() {
        resources.monitor.progress("sizes", n, sweep.sizes)?;
        let measure = match record.skipped.last() {
            Some(smaller) => Measure::TooLarge(smaller.grown(wanted)),
            None => size(&mut sizes, wanted, resources)?,
        };
        match measure {
            Measure::Done(size) => {
                resources.monitor.notice(&line(&size));
                record.sizes.push(size);
            }
            Measure::TooLarge(skipped) => {
                resources.monitor.notice(&format!(
                    "{} degrees of freedom are left out: about {:.1} GiB of memory, of which there are {:.1} GiB",
                    skipped.wanted, skipped.needed_gib, skipped.available_gib
                ));
                record.skipped.push(skipped);
            }
        }
        record.exponents = exponents(&record.sizes);
        each(&record)?;
    }
    resources.monitor.progress("sizes", sweep.sizes, sweep.sizes)?;
    Ok(record)
}

/// Refuses bodies whose mesh the program cannot refine.
fn refuse_mesh_files(study: &Study) -> Result<()> {
    for (key, file) in [("rail.mesh", &study.rail.mesh), ("wheel.mesh", &study.wheel.mesh)] {
        if let Some(file) = file {
            return Err(InputError::new(
                key,
                &file.file,
                "a body that the program meshes itself, so that it can be refined",
                "leave the mesh file out, or name another study with --study",
            )
            .into());
        }
    }
    Ok(())
}

/// What came of a size.
enum Measure {
    Done(ScalingSize),
    TooLarge(SkippedSize),
}

/// All stages of one size.
fn size(sizes: &mut Sizes<'_>, wanted: usize, resources: &Resources<'_>) -> Result<Measure> {
    let Resources { budget, interpreter, monitor } = *resources;
    let too_large = |needed: f64| {
        let (available, _) = budget.bytes().filter(|(available, _)| needed > *available)?;
        Some(Measure::TooLarge(SkippedSize {
            wanted,
            needed_gib: needed / GIB,
            available_gib: available / GIB,
        }))
    };
    if let Some(skipped) = too_large(least_memory(wanted)) {
        return Ok(skipped);
    }
    let refined = sizes.refinement(wanted, monitor)?;
    let Sizes { study, geometry, options, .. } = *sizes;
    let options = options.with_bodies_refined(refined);
    let (meshes, mesh) = parts::timed("mesh", || {
        meshes::meshes(study.statics(), geometry, options, (interpreter, None), monitor)
    })?;
    let solids = solids::solids(study.statics(), geometry, &meshes);
    let modes = study.solid.modes.unwrap_or(START_MODES);
    let ordered = parts::Ordered::both(&solids, modes, monitor)?;
    let resident = Stopwatch::start().read().1.unwrap_or(0.0) * MIB;
    let condensing = ordered.iter().map(|body| body.memory).fold(0.0, f64::max);
    let stepping: f64 = ordered.iter().map(|body| body.stepping).sum();
    let predicted = resident + condensing.max(stepping + CONTACT_OF_STEP);
    if let Some(skipped) = too_large(predicted) {
        return Ok(skipped);
    }
    let product = railspring_calibrate::superelement::product_speed(PRODUCT);
    let [rail, wheel] = ordered;
    let (rail, on_ends) = rail.condensed(modes, product, monitor)?;
    let (wheel, on_hub) = wheel.condensed(modes, product, monitor)?;
    let mut size = ScalingSize {
        wanted,
        degrees_of_freedom: on_ends.degrees_of_freedom + on_hub.degrees_of_freedom,
        refined,
        product_gflops: 2e-9 * product,
        bodies: vec![on_ends, on_hub],
        stages: vec![mesh],
        memory: PredictedRecord { predicted_mib: predicted / MIB, found_mib: None },
        notes: Vec::new(),
    };
    parts::contact(study, geometry, [&rail, &wheel], &mut size, monitor)?;
    let of_bodies = size.bodies.iter().flat_map(|body| &body.stages);
    size.memory.found_mib =
        of_bodies.chain(&size.stages).filter_map(|stage| stage.peak_memory_mib).reduce(f64::max);
    Ok(Measure::Done(size))
}

/// Stages in the order of the tables.
const STAGES: [&str; 8] =
    ["mesh", "ordering", "assembly", "factorisation", "condensation", "modes", "one load", "one step"];

/// A finished size in words.
fn line(size: &ScalingSize) -> String {
    let seconds = STAGES
        .iter()
        .filter_map(|stage| Some(format!("{stage} {:.3} s", size.seconds(stage)?)))
        .collect::<Vec<_>>();
    let memory = size.memory.found_mib.map_or_else(String::new, |mib| format!(", {mib:.0} MiB"));
    format!(
        "{} degrees of freedom: {}{memory} ({:.0} expected)",
        size.degrees_of_freedom,
        seconds.join(", "),
        size.memory.predicted_mib
    )
}

/// The powers with which everything grows.
fn exponents(sizes: &[ScalingSize]) -> Vec<ExponentRecord> {
    let mut found = Vec::new();
    let mut add = |quantity: &str, unit: &str, of: &str, points: Vec<(f64, f64)>| {
        found.extend(PowerLaw::fit(&points).map(|law| ExponentRecord {
            quantity: quantity.into(),
            unit: unit.into(),
            of: of.into(),
            exponent: law.exponent,
            standard_error: law.standard_error,
            at_100k: law.at(1e5),
            sizes: law.points,
        }));
    };
    let both = |of: &dyn Fn(&ScalingSize) -> Option<f64>| -> Vec<(f64, f64)> {
        sizes.iter().filter_map(|size| Some((size.degrees_of_freedom as f64, of(size)?))).collect()
    };
    for stage in STAGES {
        add(stage, "s", BOTH, both(&|size| size.seconds(stage)));
    }
    add("largest memory", "MiB", BOTH, both(&|size| size.memory.found_mib));
    add("values in the factors", "", BOTH, both(&|size| Some(size.factor_values())));
    add("multiplications of the factorisations", "", BOTH, both(&|size| Some(size.multiplications())));
    let names = sizes
        .first()
        .map_or_else(Vec::new, |size| size.bodies.iter().map(|body| body.body.clone()).collect());
    for (n, name) in names.iter().enumerate() {
        let of = |value: &dyn Fn(&ScalingBody) -> f64| -> Vec<(f64, f64)> {
            let bodies = sizes.iter().filter_map(|size| size.bodies.get(n));
            bodies.map(|body| (body.degrees_of_freedom as f64, value(body))).collect()
        };
        add("values in the factor", "", name, of(&|body| body.factor_values as f64));
        add("multiplications of the factorisation", "", name, of(&|body| body.multiplications));
    }
    found
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use railspring::results::bodies::estimate::Budget;
    use railspring_profiles::error::Error;
    use railspring_profiles::monitor::Monitor;

    use super::*;

    const COARSE: &str = include_str!("../../tests/studies/coarse.toml");

    /// Stops when the second size begins.
    struct Stopped;

    impl Monitor for Stopped {
        fn progress(&self, stage: &str, done: usize, _: usize) -> Result<()> {
            if stage == "sizes" && done > 0 { Err(Error::Interrupted) } else { Ok(()) }
        }
    }

    /// Goal: a sweep that is interrupted has handed on what was finished, whole.
    #[test]
    fn an_interrupted_sweep_leaves_its_finished_sizes() {
        let study = Study::parse(Path::new("coarse.toml"), COARSE).unwrap_or_else(|e| panic!("{e}"));
        let resources = Resources { budget: Budget::default(), interpreter: None, monitor: &Stopped };
        let mut records = Vec::new();
        let sizes = Sweep { from: Some(24_000), to: 40_000, sizes: 2 };
        let stopped = sweep(&study, &sizes, &resources, &mut |record| {
            records.push(record.clone());
            Ok(())
        });
        assert!(matches!(stopped, Err(Error::Interrupted)));
        assert_eq!((records.len(), records[0].sizes.len()), (1, 1));
        let size = &records[0].sizes[0];
        assert!(STAGES.iter().all(|stage| size.seconds(stage).is_some()), "{size:?}");
        assert!(records[0].exponents.is_empty() && size.factor_values() > 0.0);
    }
}
