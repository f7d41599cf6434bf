//! What the meshes, the factors and the contact of a study will take, before they take it.
//!
//! Refusing what the machine cannot hold is the only defence there is: a program that gets no memory is ended by the system.

mod machine;
mod condensing;
mod work;
mod pressing;
mod needs;
mod table;

use std::path::Path;

use railspring_calibrate::mesh::{
    MeshOptions, MeshSize, least_rail_size, least_wheel_size, rail_size, wheel_size,
};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::MILLIMETRE;

use crate::results::bodies::estimate::condensing::{FILL, NODE, VALUE};
use crate::results::bodies::estimate::machine::available;
use crate::results::bodies::estimate::needs::reference_memory;
use crate::results::bodies::geometry::{self, Geometry};
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::meshes::{self, Meshes};
use crate::results::bodies::zones;
use crate::study::{Statics, TransientKey};

pub use self::condensing::{CONTACT_OF_STEP, condensing, least_memory, stepping};
pub use self::machine::GIB;
pub use self::needs::{Beside, Estimate, StageEstimate};
pub(crate) use self::pressing::as_on_tread;
pub use self::work::Work;

/// Share of them in the factor of one half of a body: half of the equations to the power 4/3.
const OF_HALVES: f64 = 0.4;
/// A first look may be wrong by this factor.
const FIRST_LOOK: f64 = 2.0;
/// A body needs no more than this multiple of what its layers below the contact zone need; with default elements it needs four times as much.
const OF_LAYERS: f64 = 10.0;

/// How much memory there is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Budget {
    /// The user's limit, bytes.
    limit: Option<f64>,
}

impl Budget {
    /// What the machine has, or what the user allows, in GiB.
    pub fn new(limit_gib: Option<f64>) -> Self {
        Self { limit: limit_gib.map(|gib| gib * GIB) }
    }

    /// Bytes that may be used and who says so; `None` where the system does not say.
    pub fn bytes(self) -> Option<(f64, &'static str)> {
        match self.limit {
            Some(limit) => Some((limit, "allowed by --memory-limit")),
            None => available().map(|bytes| (bytes, "available on this machine")),
        }
    }

    /// Whether so many bytes may be used; where the system does not say, all may.
    pub fn holds(self, bytes: f64) -> bool {
        self.bytes().is_none_or(|(budget, _)| bytes <= budget)
    }

    /// Refuses sizes of elements that this machine cannot hold by far, before a mesh is made.
    ///
    /// # Errors
    /// [`InputError`] with sizes that would do; those of meshing a section.
    pub fn check_sizes(self, input: &SolidsInput<'_>, geometry: &Geometry, work: &Work) -> Result<()> {
        let Some((budget, whose)) = self.bytes() else { return Ok(()) };
        let needed = |input: &SolidsInput<'_>| -> Result<(f64, usize)> {
            let of = |sizes: &[MeshSize]| {
                (first_look(sizes, input, work), sizes.iter().map(|size| 3 * size.nodes).sum())
            };
            // sections of the finest elements take longer than all else to be refused
            let least = of(&least_sizes(input, geometry)?);
            // and where even the most is little, they will be meshed anyway
            if least.0 > FIRST_LOOK * budget || OF_LAYERS * least.0 <= FIRST_LOOK * budget {
                return Ok(least);
            }
            Ok(of(&sizes(input, geometry)?))
        };
        let (memory, equations) = needed(input)?;
        if memory <= FIRST_LOOK * budget {
            return Ok(());
        }
        Err(refusal(input, memory, equations, (budget, whose), &|input| needed(input).map(|n| n.0)).into())
    }

    /// Estimates what the meshes take.
    ///
    /// # Errors
    /// [`InputError`] with sizes that would do, where it is more than there is.
    pub fn check(
        self,
        input: &SolidsInput<'_>,
        geometry: &Geometry,
        meshes: &Meshes,
        work: &Work,
    ) -> Result<Estimate> {
        let estimate = Estimate::of(input, geometry, meshes, work)?;
        let Some((budget, whose)) = self.bytes() else { return Ok(estimate) };
        let memory = estimate.memory();
        if memory <= budget {
            return Ok(estimate);
        }
        // what the first look says of other sizes, in proportion
        let look = |input: &SolidsInput<'_>| Ok(first_look(&sizes(input, geometry)?, input, work));
        let here = look(input)?;
        let needed = |input: &SolidsInput<'_>| look(input).map(|there| memory * there / here);
        Err(refusal(input, memory, estimate.degrees_of_freedom(), (budget, whose), &needed).into())
    }
}

/// What the memory has room for at the same time; without that, one is done after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Room {
    /// The factors of all bodies of a calibration.
    pub condensing: bool,
    /// The stages that do not need each other.
    pub stages: bool,
    /// Further pairs of a table, with their places and the bodies that are condensed at a time, beside one.
    pub more_pairs: usize,
}

impl Room {
    /// What is needed is wrong by this factor at most, and bodies may become larger as their contact zones do.
    const MARGIN: f64 = 1.5;

    /// What a `budget` has room for.
    pub fn of(Beside { condensing, stages }: Beside, budget: Budget) -> Self {
        let times = |bytes: f64| budget.bytes().map_or(1.0, |(budget, _)| budget / (Self::MARGIN * bytes));
        // the stages of one pair are as much as the places of one and the bodies of the next
        let more_pairs = times(stages) as usize;
        Self { condensing: times(condensing) >= 1.0, stages: more_pairs > 0, more_pairs }
    }
}

/// What a command works with.
#[derive(Clone, Copy)]
pub struct Resources<'a> {
    /// How much memory there is.
    pub budget: Budget,
    /// The Python that reads mesh files and runs the reference; `None`: the virtual environment of the cache folder.
    pub interpreter: Option<&'a Path>,
    /// Who hears how far it is.
    pub monitor: &'a dyn Monitor,
}

impl<'a> Resources<'a> {
    /// The memory of the machine and the Python of the cache folder.
    pub fn of_the_machine(monitor: &'a dyn Monitor) -> Self {
        Self { budget: Budget::default(), interpreter: None, monitor }
    }
}

/// The estimate of a study without doing anything else.
///
/// # Errors
/// Those of geometry and meshing, and sizes that the machine cannot hold.
pub fn dry_run(input: &SolidsInput<'_>, work: &Work, resources: &Resources<'_>) -> Result<Estimate> {
    let geometry = geometry::geometry(input.statics)?;
    zones::check_loads(input.statics, &geometry, resources.monitor)?;
    input.say_notes(resources.monitor);
    let options = zones::mesh_options(input.statics, &geometry);
    made(input, &geometry, options, work, resources).map(|(_, estimate)| estimate)
}

/// Meshes for `work`, which must be within the budget, the tool's own with `options`, and what is in memory at the same time; the monitor gets what is
/// expected.
///
/// # Errors
/// Those of meshing, and sizes that the machine cannot hold.
pub fn meshes(
    input: &SolidsInput<'_>,
    geometry: &Geometry,
    options: MeshOptions,
    work: &Work,
    resources: &Resources<'_>,
) -> Result<(Meshes, Beside)> {
    let (meshes, estimate) = made(input, geometry, options, work, resources)?;
    resources.monitor.notice(&estimate.text());
    Ok((meshes, estimate.beside))
}

fn made(
    input: &SolidsInput<'_>,
    geometry: &Geometry,
    options: MeshOptions,
    work: &Work,
    &Resources { budget, interpreter, monitor }: &Resources<'_>,
) -> Result<(Meshes, Estimate)> {
    budget.check_sizes(input, geometry, work)?;
    let meshes = meshes::meshes(
        input.statics,
        geometry,
        options,
        (interpreter, budget.bytes().map(|(bytes, _)| bytes)),
        monitor,
    )?;
    let estimate = budget.check(input, geometry, &meshes, work)?;
    Ok((meshes, estimate))
}

/// What the tool's own meshes have at least, without their sections.
fn least_sizes(input: &SolidsInput<'_>, geometry: &Geometry) -> Result<Vec<MeshSize>> {
    let options = zones::mesh_options(input.statics, geometry);
    let mut sizes = Vec::new();
    if input.statics.rail.mesh.is_none() {
        sizes.push(least_rail_size(&geometry.pair.rail, input.statics.rail.length, &options)?);
    }
    if input.statics.wheel.mesh.is_none() {
        sizes.push(least_wheel_size(&geometry.pair.wheel, &options)?);
    }
    Ok(sizes)
}

/// Sizes of the tool's own meshes; bodies with a mesh from a file have none.
fn sizes(input: &SolidsInput<'_>, geometry: &Geometry) -> Result<Vec<MeshSize>> {
    let options = zones::mesh_options(input.statics, geometry);
    let mut sizes = Vec::new();
    if input.statics.rail.mesh.is_none() {
        sizes.push(rail_size(&geometry.pair.rail, input.statics.rail.length, &options)?);
    }
    if input.statics.wheel.mesh.is_none() {
        sizes.push(wheel_size(&geometry.pair.wheel, &options)?);
    }
    Ok(sizes)
}

/// Bytes of bodies by the numbers of their meshes alone. Those that the program makes are their own mirror images, of which only full order in
/// time factors the whole.
fn first_look(sizes: &[MeshSize], input: &SolidsInput<'_>, work: &Work) -> f64 {
    let by_halves = work.solids.is_empty() || input.solid.transient == TransientKey::Reduced;
    let of_body = |size: &MeshSize| {
        let mesh = NODE * size.nodes as f64;
        if *work == Work::default() {
            return mesh;
        }
        let values = FILL * (3.0 * size.nodes as f64).powf(4.0 / 3.0);
        let dense = (3.0 * size.contact as f64).powi(2);
        let own = VALUE * if by_halves { OF_HALVES * values + 1.5 * dense } else { values + 2.0 * dense };
        mesh + work.reference.map_or(own, |purpose| own.max(reference_memory(purpose, values)))
    };
    sizes.iter().map(of_body).sum()
}

/// The refusal of a study, with sizes of the contact elements for which `needed` stays within the budget.
fn refusal(
    input: &SolidsInput<'_>,
    memory: f64,
    equations: usize,
    (budget, whose): (f64, &str),
    needed: &dyn Fn(&SolidsInput<'_>) -> Result<f64>,
) -> InputError {
    let [across, along] = [input.statics.mesh.contact_element, input.statics.mesh.contact_element_along];
    let larger = [1.1, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0].into_iter().find_map(|factor| {
        let mesh = MeshOptions {
            contact_element: factor * across,
            contact_element_along: factor * along,
            ..input.statics.mesh.clone()
        };
        let coarser = SolidsInput { statics: Statics { mesh: &mesh, ..input.statics }, ..*input };
        let fits = needed(&coarser).is_ok_and(|memory| memory < budget);
        let [across, along] = [across, along].map(|edge| factor * edge / MILLIMETRE);
        fits.then(|| {
            format!("mesh.contact_element_mm = {across:.2} and mesh.contact_element_along_mm = {along:.2}")
        })
    });
    let remedy = match larger {
        Some(sizes) => format!("take {sizes}, or a shorter mesh.window_half_length_mm"),
        None => "take larger elements (mesh.contact_element_mm, mesh.rail_section_element_mm, \
                 mesh.wheel_section_element_mm) or a coarser mesh file"
            .into(),
    };
    InputError::new(
        "mesh.contact_element_mm",
        format!(
            "{} ({equations} degrees of freedom, about {:.1} GiB of memory)",
            across / MILLIMETRE,
            memory / GIB
        ),
        format!("a study of at most {:.1} GiB, which is what is {whose}", budget / GIB),
        format!("{remedy}; --memory-limit GIB sets another limit"),
    )
}

#[cfg(test)]
mod tests {
    use railspring_profiles::monitor::Silent;

    use super::*;
    use crate::results::bodies::meshes::FINER;
    use crate::study::Study;

    const COARSE: &str = include_str!("../../../tests/studies/coarse.toml");

    fn study(text: &str) -> Study {
        Study::parse(Path::new("study.toml"), text).unwrap_or_else(|e| panic!("{e}"))
    }

    fn estimate(study: &Study, limit_gib: Option<f64>) -> Result<Estimate> {
        let resources = Resources { budget: Budget::new(limit_gib), ..Resources::of_the_machine(&Silent) };
        let input = SolidsInput::of(study);
        dry_run(&input, &Work::of(&input, true, true), &resources)
    }

    /// Source: the degrees of freedom and the factors of the study's own run. Goal: equations exactly; every stage has
    /// memory and time, and finer elements take more of both.
    #[test]
    fn the_estimate_counts_what_the_study_has() {
        let coarse = study(COARSE);
        let found = estimate(&coarse, Some(64.0)).unwrap_or_else(|e| panic!("{e}"));
        let geometry = geometry::geometry(coarse.statics()).unwrap();
        let options = zones::mesh_options(coarse.statics(), &geometry);
        let meshes = meshes::meshes(coarse.statics(), &geometry, options, (None, None), &Silent).unwrap();
        let held = meshes.rail.ends.len() + meshes.wheel.bore.len();
        assert_eq!(
            found.degrees_of_freedom(),
            3 * (meshes.rail.nodes.len() + meshes.wheel.nodes.len() - held)
        );
        assert_eq!(found.stages.len(), 1 + coarse.scenarios.values().filter(|case| case.solid).count());
        let mut with_shifts = coarse.clone();
        with_shifts.shifts = Some(vec![0.0, 2e-3]);
        let two = estimate(&with_shifts, Some(64.0)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(two.stages[1].stage, "law by contact angle");
        with_shifts.shifts = Some((0..40).map(|n| f64::from(n) * 1e-4).collect());
        let many = estimate(&with_shifts, Some(64.0)).unwrap_or_else(|e| panic!("{e}"));
        assert!(0.0 < two.stages[1].seconds && two.stages[1].seconds < many.stages[1].seconds);
        assert!(two.stages[1].memory > 0.0);
        let mut finer = coarse.clone();
        finer.mesh.contact_element *= 0.7;
        finer.mesh.contact_element_along *= 0.7;
        let more = estimate(&finer, Some(64.0)).unwrap_or_else(|e| panic!("{e}"));
        for (stage, more) in found.stages.iter().zip(&more.stages) {
            assert!(0.0 < stage.memory && stage.memory < more.memory, "{stage:?} {more:?}");
            assert!(0.0 < stage.seconds && stage.seconds < more.seconds, "{stage:?} {more:?}");
        }
    }

    /// Goal: where meshes are refined for a wanted error, that is said with what the next finer ones take, which is more than these do, and
    /// is not among the stages; without, there is no such line. The next finer ones are those of the study with elements √2 smaller. Accuracy:
    /// MODEL, the factor grows with the power 4/3 of the nodes; half of the memory.
    #[test]
    fn refinements_are_said_and_not_counted() {
        const MODEL: f64 = 0.5;
        let coarse = study(COARSE);
        let as_is = estimate(&coarse, Some(64.0)).unwrap();
        assert!(as_is.finer.is_none() && !as_is.text().contains("target_error"), "{}", as_is.text());
        let refined = study(&COARSE.replace("[mesh]\n", "[mesh]\ntarget_error = 0.01\n"));
        let found = estimate(&refined, Some(64.0)).unwrap();
        let text = found.text();
        assert!(text.contains("not counted: meshes that mesh.target_error refines"), "{text}");
        assert_eq!(found.stages[0], as_is.stages[0]);
        let mut finer = coarse;
        finer.mesh = finer.mesh.refined(FINER);
        let (said, counted) = (found.finer.unwrap(), &estimate(&finer, Some(64.0)).unwrap().stages[0]);
        assert!(said.memory > as_is.stages[0].memory && said.seconds > as_is.stages[0].seconds);
        assert!((said.memory / counted.memory - 1.0).abs() < MODEL, "{said:?} {counted:?}");
    }

    /// Goal: what is not refused but has no room beside other stages is done one after the other; stages beside each other take more
    /// than the largest of them alone, and so do both bodies with their margin; with plenty of memory, all are.
    #[test]
    fn a_tight_memory_leaves_no_room_beside_others() {
        let mut coarse = study(COARSE);
        coarse.shifts = Some(vec![0.0, 2e-3]);
        let need = estimate(&coarse, Some(64.0)).unwrap();
        let room = |limit: f64| Room::of(need.beside, Budget::new(Some(limit / GIB)));
        assert_eq!(room(1.001 * need.memory()), Room::default());
        let Room { condensing, stages, more_pairs } = room(64.0 * GIB);
        assert!(condensing && stages && more_pairs > 1);
        let Beside { condensing, stages } = need.beside;
        assert!(Room::MARGIN * condensing > need.memory() && stages > need.memory(), "{:?}", need.beside);
        let least = Room::MARGIN * condensing.min(stages);
        assert_ne!(room(1.001 * least), Room::default());
        let together = need.beside.together();
        let holds = |bytes: f64| Budget::new(Some(bytes / GIB)).holds(together);
        assert!(together > condensing.max(stages) && holds(1.001 * together) && !holds(0.999 * together));
    }

    /// Goal: a study that needs more than there is is refused by the first look (elements of 0.5 mm, which need twenty times
    /// the limit) and by the count (a limit just below the need), with keys, numbers and sizes that would do.
    #[test]
    fn what_cannot_be_held_is_refused_with_sizes_that_can() {
        let coarse = study(COARSE);
        let need = estimate(&coarse, Some(64.0)).unwrap().memory();
        let refused = |study: &Study, limit: f64| estimate(study, Some(limit)).unwrap_err().to_string();
        let said = refused(&coarse, 0.9 * need / GIB);
        assert!(said.starts_with("mesh.contact_element_mm = 6 ("), "{said}");
        for part in ["degrees of freedom", "allowed by --memory-limit", "mesh.contact_element_along_mm = "] {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert!(estimate(&coarse, Some(1.001 * need / GIB)).is_ok());
        let mut finest = coarse.clone();
        finest.mesh.contact_element = 0.5e-3;
        finest.mesh.contact_element_along = 0.5e-3;
        let said = refused(&finest, 1.0);
        assert!(
            said.starts_with("mesh.contact_element_mm = 0.5 (") && said.contains("take mesh.contact"),
            "{said}"
        );
    }

    /// Source: elements of 0.05 mm, whose sections have a hundred thousand nodes and take many minutes to mesh. Goal: refused without meshing one, within
    /// seconds (a minute, for a busy machine), with the least number of equations. With elements of 0.2 mm sizes that would do are said as well.
    #[test]
    fn what_is_far_too_large_is_refused_before_it_is_meshed() {
        let refused = |element: f64| {
            let mut study = study(COARSE);
            (study.mesh.contact_element, study.mesh.contact_element_along) = (element, element);
            let begun = std::time::Instant::now();
            let said = estimate(&study, Some(8.0)).unwrap_err().to_string();
            assert!(begun.elapsed() < std::time::Duration::from_secs(60), "{:?}", begun.elapsed());
            said
        };
        let said = refused(0.05e-3);
        assert!(
            said.starts_with("mesh.contact_element_mm = 0.05 (") && said.contains("take larger elements"),
            "{said}"
        );
        let said = refused(0.2e-3);
        assert!(
            said.starts_with("mesh.contact_element_mm = 0.2 (") && said.contains("take mesh.contact"),
            "{said}"
        );
    }
}
