//! What the meshes, the factors and the contact of a study will take, before they take it.
//!
//! Nodes, equations, contact nodes and the values of the factors are counted; bytes and seconds follow from them with the
//! constants below, which were measured on whole runs. Refusing what the machine cannot hold is the only defence
//! there is: a program that gets no memory is ended by the system.

use std::fmt::Write;
use std::path::Path;

use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::mesh::{HexMesh, MeshOptions, MeshSize, rail_size, wheel_size};
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::pair::LOADS_HALVED;
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::FactorSize;
use railspring_calibrate::units::MILLIMETRE;

use crate::python::Purpose;
use crate::stages::{self, Geometry, Meshes};
use crate::study::{FieldKey, Study};

/// Bytes of a gibibyte.
const GIB: f64 = 1024.0 * 1024.0 * 1024.0;
/// Bytes of a value.
const VALUE: f64 = 8.0;
/// Bytes of an entry of a sparse matrix: value and row.
const ENTRY: f64 = 16.0;
/// Bytes a hexahedron while a matrix is assembled: its stiffness (4.6 kB), 300 triplets, and their sorting.
const ASSEMBLY: f64 = 17e3;
/// Bytes a node of a mesh, its hexahedra and the lists of its neighbours.
const NODE: f64 = 1.0e3;
/// Bytes of Python with NumPy and SciPy.
const PYTHON: f64 = 300e6;
/// Bytes of the program itself with its profiles and texts.
const PROGRAM: f64 = 40e6;
/// Indices of the factors, work space of the factorisation, and what the allocator keeps; measured 1.11 to 1.17.
const OVERHEAD: f64 = 1.15;
/// Gap up to which points are candidates before the first solution at a load, m.
const FIRST_GAP: f64 = 0.15e-3;
/// Gap up to which they are kept with the load, m.
const KEPT_GAP: f64 = 20e-6;
/// Displacement of the hub under load, m/N, the rail held at its ends.
const FLEXIBILITY: f64 = 1.5e-9;
/// Values of a factor for every equation to the power of 4/3, for a first look before there is a mesh. Measured: 20.
const FILL: f64 = 20.0;
/// A first look may be wrong by this factor.
const FIRST_LOOK: f64 = 2.0;
/// Seconds to assemble a hexahedron.
const SECONDS_ASSEMBLY: f64 = 40e-6;
/// Seconds to order a node.
const SECONDS_ORDER: f64 = 10e-6;
/// Multiplications a second of a factorisation.
const SPEED: f64 = 20e9;
/// Bytes a second of a substitution, which reads the factor twice.
const BANDWIDTH: f64 = 10e9;
/// Seconds of a load for every pair of candidates.
const SECONDS_PAIR: f64 = 3e-7;
/// Seconds of a load on a fine grid, with friction.
const SECONDS_FINE: f64 = 0.1;
/// Seconds of a load on a grid of half its spacing and on the grid itself, without friction.
const SECONDS_HALVED: f64 = 0.8;
/// Seconds of contact in a time step.
const SECONDS_STEP: f64 = 0.03;

/// Memory of the reference's Python, bytes, for the values of the study's factors; measured on studies of 20 and
/// 113 million values.
fn reference_memory(purpose: Purpose, values: f64) -> f64 {
    let per_value = match purpose {
        Purpose::FirstOrder => 22.0,
        Purpose::SecondOrder => 104.0,
    };
    PYTHON + per_value * values
}

/// Time of the same, s.
fn reference_seconds(purpose: Purpose, values: f64) -> f64 {
    let per_value = match purpose {
        Purpose::FirstOrder => 0.6e-6,
        Purpose::SecondOrder => 3e-6,
    };
    per_value * values
}

/// What a command is going to do with the solids.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Work {
    /// Whether it calibrates, or answers the questions of a cross-check, which takes as much.
    pub calibrate: bool,
    /// Load cases of the solid model: name and steps.
    pub solids: Vec<(String, usize)>,
    /// The questions to the reference.
    pub reference: Option<Purpose>,
}

impl Work {
    /// What the study asks for: with or without the calibration, with or without its load cases.
    pub fn of(study: &Study, calibrate: bool, solids: bool) -> Self {
        let cases = study.scenarios.iter().filter(|(_, case)| solids && case.solid);
        let solids = cases.map(|(name, case)| (name.clone(), case.scenario.steps)).collect();
        Self { calibrate, solids, reference: None }
    }

    /// The tool's part of a cross-check, and that of the reference.
    pub fn of_crosscheck(reference: Purpose) -> Self {
        Self { calibrate: true, reference: Some(reference), ..Self::default() }
    }
}

/// Memory and time of one stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StageEstimate {
    /// What is done.
    pub stage: String,
    /// Largest memory, bytes.
    pub memory: f64,
    /// Time, s.
    pub seconds: f64,
}

/// What a study takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Rail and wheel.
    pub bodies: [FactorSize; 2],
    /// Their contact nodes.
    pub contact_nodes: [usize; 2],
    /// The stages that are to be done.
    pub stages: Vec<StageEstimate>,
}

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
    fn bytes(self) -> Option<(f64, &'static str)> {
        match self.limit {
            Some(limit) => Some((limit, "allowed by --memory-limit")),
            None => available().map(|bytes| (bytes, "available on this machine")),
        }
    }

    /// Refuses sizes of elements that this machine cannot hold by far, before a mesh is made.
    ///
    /// # Errors
    /// [`InputError`] with sizes that would do; those of meshing a section.
    pub fn check_sizes(self, study: &Study, geometry: &Geometry, work: &Work) -> Result<()> {
        let Some((budget, whose)) = self.bytes() else { return Ok(()) };
        let needed = |study: &Study| -> Result<(f64, usize)> {
            let sizes = sizes(study, geometry)?;
            let memory: f64 = sizes.iter().map(|size| first_look(size, work)).sum();
            Ok((memory, sizes.iter().map(|size| 3 * size.nodes).sum()))
        };
        let (memory, equations) = needed(study)?;
        if memory <= FIRST_LOOK * budget {
            return Ok(());
        }
        Err(refusal(study, memory, equations, (budget, whose), &|study| needed(study).map(|n| n.0)).into())
    }

    /// Estimates what the meshes take.
    ///
    /// # Errors
    /// [`InputError`] with sizes that would do, where it is more than there is.
    pub fn check(self, study: &Study, geometry: &Geometry, meshes: &Meshes, work: &Work) -> Result<Estimate> {
        let estimate = Estimate::of(study, geometry, meshes, work)?;
        let Some((budget, whose)) = self.bytes() else { return Ok(estimate) };
        let memory = estimate.memory();
        if memory <= budget {
            return Ok(estimate);
        }
        // what the first look says of other sizes, in proportion
        let look = |study: &Study| -> Result<f64> {
            Ok(sizes(study, geometry)?.iter().map(|size| first_look(size, work)).sum())
        };
        let here = look(study)?;
        let needed = |study: &Study| look(study).map(|there| memory * there / here);
        Err(refusal(study, memory, estimate.degrees_of_freedom(), (budget, whose), &needed).into())
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

impl Estimate {
    fn of(study: &Study, geometry: &Geometry, meshes: &Meshes, work: &Work) -> Result<Self> {
        let count = |mesh: &HexMesh, supports: Supports| -> Result<FactorSize> {
            // neither material nor element changes a number
            let system = System::new(mesh, Material::STEEL, Formulation::IncompatibleModes, &supports)?;
            FactorSize::of(mesh, &system.numbering)
        };
        let (rail, wheel) = rayon::join(
            || count(&meshes.rail, Supports { held: meshes.rail.ends.clone(), ..Supports::default() }),
            || count(&meshes.wheel, Supports { followers: meshes.wheel.bore.clone(), ..Supports::default() }),
        );
        let rail = Body { mesh: MeshSize::of(&meshes.rail), size: rail? };
        let wheel = Body { mesh: MeshSize::of(&meshes.wheel), size: wheel? };
        let base = PROGRAM + NODE * (rail.mesh.nodes + wheel.mesh.nodes) as f64;
        let mut stages = Vec::new();
        if work.calibrate {
            let loads = &study.calibration.loads;
            let largest = loads.last().copied().unwrap_or(0.0);
            let at = |gap| {
                geometry.pair.candidates([&meshes.rail, &meshes.wheel], FLEXIBILITY * largest, gap) as f64
            };
            let (first, kept) = (at(FIRST_GAP), at(KEPT_GAP));
            // patches grow with the cube root of the load in each direction
            let shares: Vec<f64> = loads.iter().map(|load| (load / largest).powf(2.0 / 3.0)).collect();
            let dense = |points: f64| VALUE * (3.0 * points).powi(2);
            let states = 2.0 * shares.iter().map(|share| dense(share * kept)).sum::<f64>();
            let all_kept = wheel.kept() + 2.0 * rail.kept();
            let memory = [
                wheel.making() + rail.making(),
                wheel.kept() + rail.kept() + rail.making(),
                all_kept + states + 2.0 * dense(first),
            ];
            let pressing = match study.contact.field {
                FieldKey::Elements => {
                    shares.iter().map(|share| SECONDS_PAIR * (share * first).powi(2)).sum::<f64>()
                }
                FieldKey::Hybrid => SECONDS_FINE * loads.len() as f64,
            };
            stages.push(StageEstimate {
                stage: "calibration".into(),
                memory: base + OVERHEAD * memory.into_iter().fold(0.0, f64::max),
                seconds: wheel.seconds() + 2.0 * rail.seconds() + 2.0 * pressing,
            });
            if study.wants_by_angle() {
                // each thread presses the wheel in one place, and keeps no state but the last
                let shifts = stages::shifts(study, &geometry.pair).len() as f64;
                let threads = (rayon::current_num_threads() as f64).min(shifts);
                stages.push(StageEstimate {
                    stage: "law by contact angle".into(),
                    memory: base + OVERHEAD * (all_kept + 2.0 * threads * dense(first)),
                    seconds: 2.0 * pressing * (shifts / threads).ceil(),
                });
            }
        }
        if work.calibrate && study.wants_error_band() {
            stages.push(error_band(study, geometry, meshes, [&rail, &wheel], base)?);
        }
        if let Some(purpose) = work.reference {
            let values = (rail.size.values + wheel.size.values) as f64;
            stages.push(StageEstimate {
                stage: "reference".into(),
                memory: reference_memory(purpose, values),
                seconds: reference_seconds(purpose, values),
            });
        }
        let both = [&rail, &wheel];
        let substitution: f64 =
            both.map(|body| 2.0 * VALUE * body.size.values as f64 / BANDWIDTH).iter().sum();
        for (name, steps) in &work.solids {
            stages.push(StageEstimate {
                stage: format!("solid model, {name}"),
                memory: base + OVERHEAD * both.map(Body::making_in_time).iter().sum::<f64>(),
                seconds: both.map(|body| body.seconds()).iter().sum::<f64>()
                    + *steps as f64 * (substitution + SECONDS_STEP),
            });
        }
        Ok(Self {
            bodies: [rail.size, wheel.size],
            contact_nodes: [rail.mesh.contact, wheel.mesh.contact],
            stages,
        })
    }

    /// Equations of both bodies.
    pub fn degrees_of_freedom(&self) -> usize {
        self.bodies.iter().map(|body| body.equations).sum()
    }

    /// Largest memory of all stages, bytes.
    pub fn memory(&self) -> f64 {
        self.stages.iter().map(|stage| stage.memory).fold(0.0, f64::max)
    }

    /// What is expected, a line each.
    pub fn text(&self) -> String {
        let mut text = format!(
            "expected: {} degrees of freedom, {} contact nodes, {:.0} million values in the factors",
            self.degrees_of_freedom(),
            self.contact_nodes.iter().sum::<usize>(),
            self.bodies.iter().map(|body| body.values as f64).sum::<f64>() / 1e6
        );
        for StageEstimate { stage, memory, seconds } in &self.stages {
            let _ = write!(text, "\n  {stage}: about {:.1} GiB and {}", memory / GIB, duration(*seconds));
        }
        if let Some(bytes) = available() {
            let _ = write!(text, "\n  available: {:.1} GiB", bytes / GIB);
        }
        text
    }
}

/// The estimate of a study without doing anything else.
///
/// # Errors
/// Those of geometry and meshing, and sizes that the machine cannot hold.
pub fn dry_run(study: &Study, work: &Work, resources: &Resources<'_>) -> Result<Estimate> {
    let geometry = stages::geometry(study)?;
    stages::check_loads(study, &geometry, resources.monitor)?;
    let options = stages::mesh_options(study, &geometry);
    made(study, &geometry, options, work, resources).map(|(_, estimate)| estimate)
}

/// Meshes for `work`, which must be within the budget, the tool's own with `options`; the monitor gets what is expected.
///
/// # Errors
/// Those of meshing, and sizes that the machine cannot hold.
pub fn meshes(
    study: &Study,
    geometry: &Geometry,
    options: MeshOptions,
    work: &Work,
    resources: &Resources<'_>,
) -> Result<Meshes> {
    let (meshes, estimate) = made(study, geometry, options, work, resources)?;
    resources.monitor.notice(&estimate.text());
    Ok(meshes)
}

fn made(
    study: &Study,
    geometry: &Geometry,
    options: MeshOptions,
    work: &Work,
    &Resources { budget, interpreter, monitor }: &Resources<'_>,
) -> Result<(Meshes, Estimate)> {
    budget.check_sizes(study, geometry, work)?;
    let meshes = stages::meshes(study, geometry, options, interpreter, monitor)?;
    let estimate = budget.check(study, geometry, &meshes, work)?;
    Ok((meshes, estimate))
}

/// One body: its mesh and its factor.
struct Body {
    mesh: MeshSize,
    size: FactorSize,
}

impl Body {
    /// Bytes of a body that is factored and reduced.
    fn kept(&self) -> f64 {
        VALUE * (self.size.values as f64 + (self.size.retained as f64).powi(2))
    }

    /// Largest memory on the way there, bytes.
    fn making(&self) -> f64 {
        let values = VALUE * self.size.values as f64;
        let dense = VALUE * (self.size.retained as f64).powi(2);
        let factored = ENTRY * self.size.entries as f64 + values + 2.0 * dense;
        factored.max(ASSEMBLY * self.mesh.hexes as f64)
    }

    /// The same for a body in time, which has its mass and its damping besides.
    fn making_in_time(&self) -> f64 {
        const MASS: f64 = 27.0 * 12.0;
        self.making() + ENTRY * self.size.entries as f64 + MASS * self.mesh.nodes as f64
    }

    /// The same body on a mesh of another size, whose factor grows as that of a body that is refined: the values with the power
    /// 4/3 of its nodes, the multiplications with their square.
    fn resized(&self, mesh: MeshSize) -> Self {
        let ratio = mesh.nodes as f64 / self.mesh.nodes as f64;
        let times = |count: usize, power: f64| (count as f64 * ratio.powf(power)) as usize;
        let size = FactorSize {
            equations: times(self.size.equations, 1.0),
            retained: 3 * mesh.contact,
            entries: times(self.size.entries, 1.0),
            values: times(self.size.values, 4.0 / 3.0),
            multiplications: self.size.multiplications * ratio.powi(2),
        };
        Self { mesh, size }
    }

    /// Time of order, assembly, factor and reduction, s.
    fn seconds(&self) -> f64 {
        let reduction = (self.size.retained as f64).powi(3);
        SECONDS_ORDER * self.mesh.nodes as f64
            + SECONDS_ASSEMBLY * self.mesh.hexes as f64
            + (self.size.multiplications + reduction) / SPEED
    }
}

/// The error bands of the laws: the bodies of coarser meshes beside those of the laws, and the loads on both and on the halved grid.
fn error_band(
    study: &Study,
    geometry: &Geometry,
    meshes: &Meshes,
    [rail, wheel]: [&Body; 2],
    base: f64,
) -> Result<StageEstimate> {
    let dense = |body: &Body| VALUE * (body.size.retained as f64).powi(2);
    let kept = 2.0 * dense(rail) + dense(wheel);
    let loads = study.calibration.loads.len() as f64;
    let (on_grids, of_a_load) = match study.contact.field {
        FieldKey::Hybrid => (loads.min(LOADS_HALVED as f64) * SECONDS_HALVED, SECONDS_FINE),
        FieldKey::Elements => (0.0, SECONDS_STEP),
    };
    let mut estimate =
        StageEstimate { stage: "error band".into(), memory: base + OVERHEAD * kept, seconds: on_grids };
    // a mesh from a file is not made coarser
    if study.rail.mesh.is_none() && study.wheel.mesh.is_none() {
        let options = stages::coarser_options(meshes.options());
        let rail = rail.resized(rail_size(&geometry.pair.rail, study.rail.length, &options)?);
        let wheel = wheel.resized(wheel_size(&geometry.pair.wheel, &options)?);
        estimate.memory += OVERHEAD * (dense(&wheel) + dense(&rail) + wheel.making() + rail.making());
        estimate.seconds += wheel.seconds() + 2.0 * rail.seconds() + 2.0 * loads * of_a_load;
    }
    Ok(estimate)
}

/// Sizes of the tool's own meshes; bodies with a mesh from a file have none.
fn sizes(study: &Study, geometry: &Geometry) -> Result<Vec<MeshSize>> {
    let options = stages::mesh_options(study, geometry);
    let mut sizes = Vec::new();
    if study.rail.mesh.is_none() {
        sizes.push(rail_size(&geometry.pair.rail, study.rail.length, &options)?);
    }
    if study.wheel.mesh.is_none() {
        sizes.push(wheel_size(&geometry.pair.wheel, &options)?);
    }
    Ok(sizes)
}

/// Bytes of a body by the numbers of its mesh alone.
fn first_look(size: &MeshSize, work: &Work) -> f64 {
    if *work == Work::default() {
        return NODE * size.nodes as f64;
    }
    let values = FILL * (3.0 * size.nodes as f64).powf(4.0 / 3.0);
    let dense = (3.0 * size.contact as f64).powi(2);
    let factors = if work.calibrate { 1.5 } else { 1.0 };
    let own = VALUE * (factors * values + (factors + 1.0) * dense);
    let factored = work.reference.map_or(own, |purpose| own.max(reference_memory(purpose, values)));
    factored.max(ASSEMBLY * size.hexes as f64) + NODE * size.nodes as f64
}

/// The refusal of a study, with sizes of the contact elements for which `needed` stays within the budget.
fn refusal(
    study: &Study,
    memory: f64,
    equations: usize,
    (budget, whose): (f64, &str),
    needed: &dyn Fn(&Study) -> Result<f64>,
) -> InputError {
    let [across, along] = [study.mesh.contact_element, study.mesh.contact_element_along];
    let larger = [1.1, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0].into_iter().find_map(|factor| {
        let mut coarser = study.clone();
        coarser.mesh.contact_element = factor * across;
        coarser.mesh.contact_element_along = factor * along;
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

/// Seconds in words, in two digits.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "1 s".into(),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

/// Bytes that this process can still get; `None` where the system does not say.
fn available() -> Option<f64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| meminfo(&text));
    // a container may have less than the machine; "max" is no number
    let group = |folder: &str, [limit, used, cached]: [&str; 3]| -> Option<f64> {
        let file = |name: &str| read(&format!("{folder}/{name}"));
        let number = |name: &str| file(name)?.trim().parse::<f64>().ok();
        // what is used has the files in it that were read and can go
        let cached = file("memory.stat").and_then(|text| statistic(&text, cached)).unwrap_or(0.0);
        Some((number(limit)? - number(used)? + cached).max(0.0))
    };
    let groups = [
        group("/sys/fs/cgroup", ["memory.max", "memory.current", "inactive_file"]),
        group(
            "/sys/fs/cgroup/memory",
            ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"],
        ),
    ];
    groups.into_iter().flatten().chain(machine).reduce(f64::min)
}

/// The value of a line of `memory.stat`.
fn statistic(text: &str, name: &str) -> Option<f64> {
    let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '))?;
    value.trim().parse().ok()
}

/// Bytes on the line `MemAvailable` of `/proc/meminfo`.
fn meminfo(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? * 1024.0)
}

#[cfg(test)]
mod tests {
    use railspring_calibrate::monitor::Silent;

    use super::*;

    const COARSE: &str = include_str!("../tests/studies/coarse.toml");

    fn study(text: &str) -> Study {
        Study::parse(Path::new("study.toml"), text).unwrap_or_else(|e| panic!("{e}"))
    }

    fn estimate(study: &Study, limit_gib: Option<f64>) -> Result<Estimate> {
        let resources = Resources { budget: Budget::new(limit_gib), ..Resources::of_the_machine(&Silent) };
        dry_run(study, &Work::of(study, true, true), &resources)
    }

    #[test]
    fn memory_and_time_read_well() {
        assert_eq!(meminfo("MemTotal: 9 kB\nMemAvailable:   2048 kB\n"), Some(2_097_152.0));
        assert_eq!(meminfo("MemTotal: 9 kB\n"), None);
        let lines = "file 12\ninactive_file_x 9\ninactive_file 4096\n";
        assert_eq!((statistic(lines, "inactive_file"), statistic(lines, "active")), (Some(4096.0), None));
        assert_eq!([0.2, 42.4, 150.0, 9000.0].map(duration), ["1 s", "42 s", "2 min", "2 h"]);
    }

    /// Source: the degrees of freedom and the factors of the study's own run. Goal: equations exactly; every stage has
    /// memory and time, and finer elements take more of both.
    #[test]
    fn the_estimate_counts_what_the_study_has() {
        let coarse = study(COARSE);
        let found = estimate(&coarse, Some(64.0)).unwrap_or_else(|e| panic!("{e}"));
        let geometry = stages::geometry(&coarse).unwrap();
        let options = stages::mesh_options(&coarse, &geometry);
        let meshes = stages::meshes(&coarse, &geometry, options, None, &Silent).unwrap();
        let held = meshes.rail.ends.len() + meshes.wheel.bore.len();
        assert_eq!(
            found.degrees_of_freedom(),
            3 * (meshes.rail.nodes.len() + meshes.wheel.nodes.len() - held)
        );
        assert_eq!(found.stages.len(), 1 + coarse.scenarios.values().filter(|case| case.solid).count());
        let mut with_shifts = coarse.clone();
        with_shifts.calibration.shifts = Some(vec![0.0, 2e-3]);
        let two = estimate(&with_shifts, Some(64.0)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(two.stages[1].stage, "law by contact angle");
        with_shifts.calibration.shifts = Some((0..40).map(|n| f64::from(n) * 1e-4).collect());
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

    /// Goal: a study that needs more than there is is refused by the first look (elements of 0.2 mm, which no machine
    /// holds) and by the count (a limit just below the need), with keys, numbers and sizes that would do.
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
        finest.mesh.contact_element = 0.2e-3;
        finest.mesh.contact_element_along = 0.2e-3;
        let said = refused(&finest, 64.0);
        assert!(
            said.starts_with("mesh.contact_element_mm = 0.2 (") && said.contains("take mesh.contact"),
            "{said}"
        );
    }
}
