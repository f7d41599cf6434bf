//! What the stages of a study need: nodes, equations, contact nodes and the values of the factors are counted; bytes and seconds follow
//! from them with the constants below, which were measured on whole runs.

use railspring_calibrate::mesh::{MeshOptions, MeshSize, rail_size, wheel_size};
use railspring_calibrate::pair::{LOADS_COARSER, LOADS_HALVED, PairBody, loads_in_turn};
use railspring_calibrate::superelement::FactorSize;
use railspring_profiles::error::Result;
use serde::{Deserialize, Serialize};

use crate::python::Purpose;
use crate::results::bodies::estimate::condensing::{ENTRY, MASS, NODE, VALUE, factor, largest, stepping};
use crate::results::bodies::estimate::machine::slowness;
use crate::results::bodies::estimate::pressing::{
    Candidates, SECONDS_STEP, as_on_tread, changed, of_place, pressing, shares, ways_held,
};
use crate::results::bodies::estimate::work::{Work, steps_in_each};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::meshes::{FINER, Meshes};
use crate::results::bodies::{coarser, others, places, solids};
use crate::study::{FieldKey, TransientKey};

/// Bytes of Python with NumPy and SciPy.
const PYTHON: f64 = 300e6;
/// Bytes of the program itself with its profiles and texts.
const PROGRAM: f64 = 40e6;
/// Seconds to assemble a hexahedron.
const SECONDS_ASSEMBLY: f64 = 13e-6;
/// Seconds to order a node.
const SECONDS_ORDER: f64 = 3.3e-6;
/// Multiplications a second of a factorisation.
const SPEED: f64 = 60e9;
/// Bytes a second of a substitution, which reads the factor twice.
const BANDWIDTH: f64 = 10e9;
/// Seconds of a place in which elements of the solids are fitted.
const SECONDS_ELEMENT: f64 = 1.0;
/// Seconds of a load of the calibration, with patch, stresses, fields and its share of the horizontal stiffness.
const SECONDS_WHOLE_LOAD: f64 = 0.2;
/// Seconds of a sample of the uncertain inputs on one thread: four loads without friction.
const SECONDS_SAMPLE: f64 = 0.055;
/// What the changes of one input at a time take, in samples: two of each of some ten inputs, with patches and horizontal stiffness.
const SAMPLES_ALONE: f64 = 60.0;
/// Runs that are in memory together: with all modes, with fewer, and with a larger input.
const RUNS: usize = 3;
/// Steps that a reduced run does with fewer modes as well, at the usual time step.
const STEPS_COMPARED: f64 = 120.0;
/// Share of a substitution that one of several at the same time takes.
const SOLVED_AT_ONCE: f64 = 0.2;

/// Memory of the reference's Python, bytes, for the values of the study's factors; measured on studies of 20 and
/// 113 million values, of second order on 45 and 276 million.
pub(crate) fn reference_memory(purpose: Purpose, values: f64) -> f64 {
    let per_value = match purpose {
        Purpose::FirstOrder => 22.0,
        Purpose::SecondOrder => 70.0,
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
    /// Time of condensing both bodies, and those of coarser meshes where the study has error bands, s; they are among the stages.
    pub condensing_seconds: f64,
    /// Time of a wheel in a place on its tread on one thread, with error bands where they are wanted, without elements, s.
    pub place_seconds: f64,
    /// The calibration on the next finer meshes, where the study has a wanted error of meshes: how often they are refined is not known
    /// before, so that no refinement is among the stages.
    pub finer: Option<StageEstimate>,
    /// Largest memory where stages that do not need each other are done at the same time, bytes.
    pub(crate) beside: Beside,
}

/// Memory of stages at the same time, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beside {
    /// All bodies of the calibration factored together.
    pub condensing: f64,
    /// The fields and the error bands of the calibration, its laws by contact angle, and runs on the solids.
    pub stages: f64,
}

impl Beside {
    /// Where the bodies of a pair are made beside the stages of another one.
    pub fn together(self) -> f64 {
        self.condensing + self.stages
    }
}

impl Estimate {
    /// What the stages of a study take on these meshes.
    ///
    /// # Errors
    /// Those of counting the equations and the sizes of other meshes.
    pub(crate) fn of(
        input: &SolidsInput<'_>,
        geometry: &Geometry,
        meshes: &Meshes,
        work: &Work,
    ) -> Result<Self> {
        let solids = solids::solids(input.statics, geometry, meshes);
        let count = |body: PairBody| -> Result<FactorSize> { solids.parts(body)?.size() };
        // references factor whole bodies, and so does full order in time
        let whole = |mesh: MeshSize, body: PairBody| -> Result<Body> {
            let system = solids.system(body)?;
            Ok(Body { mesh, size: FactorSize::of(system.mesh, &system.numbering)? })
        };
        let (rail, wheel) = rayon::join(|| count(PairBody::RailOnEnds), || count(PairBody::Wheel));
        let rail = Body { mesh: MeshSize::of(&meshes.rail), size: rail? };
        let wheel = Body { mesh: MeshSize::of(&meshes.wheel), size: wheel? };
        let base = PROGRAM + NODE * (rail.mesh.nodes + wheel.mesh.nodes) as f64;
        let pair = Pair { input, geometry, meshes, rail, wheel, base };
        let Pair { rail, wheel, .. } = &pair;
        let mut stages = Vec::new();
        let mut finer = None;
        let mut beside = Beside::default();
        let (mut condensing_seconds, mut place_seconds) = (0.0, 0.0);
        if work.calibrate {
            condensing_seconds = pair.condensing_seconds();
            if input.statics.wants_error_band() && input.statics.meshes_are_ours() {
                condensing_seconds += pair.coarser()?.condensing_seconds();
            }
            let candidates = Candidates::of(input, geometry, meshes);
            stages.push(pair.calibration(candidates, !work.in_table));
            let loads = match work.in_table {
                true => {
                    loads_in_turn(&input.statics.calibration.loads, &input.statics.calibration.fixed_loads)
                }
                false => places::loads_by_angle(input.statics),
            };
            place_seconds = of_place(input, &loads, candidates);
            if input.wants_by_angle {
                stages.push(pair.by_angle(candidates, place_seconds)?);
            }
            if input.statics.wants_error_band() {
                stages.push(pair.error_band()?);
                stages.extend(pair.uncertainty());
            }
            let ways = ways_held(input.statics);
            let modes = input.modes as f64;
            beside.condensing =
                base + wheel.making(modes) + rail.making(modes) + (ways - 1.0) * rail.making(0.0);
            beside.stages = stages.iter().map(|stage| stage.memory).sum();
            stages.extend(pair.others());
            if input.statics.target_error.is_some() && input.statics.meshes_are_ours() {
                let on_finer = pair.resized(&meshes.options().refined(FINER))?;
                let more = on_finer.rail.mesh.contact as f64 / rail.mesh.contact as f64;
                finer = Some(on_finer.calibration(candidates.times(more), !work.in_table));
            }
        }
        if let Some(purpose) = work.reference {
            let bodies = [whole(rail.mesh, PairBody::RailOnEnds)?, whole(wheel.mesh, PairBody::Wheel)?];
            let values = bodies.iter().map(|body| body.size.values as f64).sum();
            stages.push(StageEstimate {
                stage: "reference".into(),
                memory: reference_memory(purpose, values),
                seconds: reference_seconds(purpose, values),
            });
        }
        let both = [rail, wheel];
        let substitution = |bodies: [&Body; 2]| -> f64 {
            bodies.map(|body| 2.0 * VALUE * body.size.values as f64 / BANDWIDTH).iter().sum()
        };
        for (n, (name, steps)) in work.solids.iter().enumerate() {
            let steps = *steps as f64;
            let within = input.solid.steps();
            let other = if within.doubled() == within { 0.0 } else { 1.0 };
            let compared = steps.min(STEPS_COMPARED * steps_in_each(input));
            let (memory, seconds) = match input.solid.transient {
                TransientKey::Full => {
                    let bodies =
                        [whole(rail.mesh, PairBody::RailOnEnds)?, whole(wheel.mesh, PairBody::Wheel)?];
                    let bodies = bodies.each_ref();
                    (
                        bodies.map(Body::making_in_time).iter().sum::<f64>(),
                        // the first steps are done a second time with twice the length
                        bodies.map(|body| (1.0 + other) * body.seconds()).iter().sum::<f64>()
                            + (steps + 0.5 * other * compared) * (substitution(bodies) + SECONDS_STEP),
                    )
                }
                TransientKey::Reduced => {
                    let modes = input.modes as f64;
                    let condensing = pair.condensing(0.0, modes);
                    let stepping =
                        both.map(|body| stepping(&body.size, input.modes, RUNS)).iter().sum::<f64>();
                    // on two threads: the run and the same with a larger input, the run with longer steps and its first steps with fewer
                    // modes; where there are error bands, its first steps on a finer grid and all longer ones on other contact elements
                    let beside = 0.5 * (other * steps + (1.0 + other) * compared);
                    let banded = f64::from(input.statics.wants_error_band());
                    let other_solids = banded * (compared + 0.5 * steps);
                    let contact = (steps + 0.5 * (beside + other_solids)) * SECONDS_STEP;
                    let making = both.map(|body| body.seconds()).iter().sum::<f64>();
                    let contact = contact + banded * making;
                    // the calibration, and the load case before, leave their bodies
                    if work.calibrate || n > 0 {
                        (stepping, contact)
                    } else {
                        (
                            condensing.max(stepping),
                            contact + making + modes * SOLVED_AT_ONCE * substitution(both),
                        )
                    }
                }
            };
            stages.push(StageEstimate {
                stage: format!("solid model, {name}"),
                memory: base + memory,
                seconds,
            });
        }
        let slowness = slowness();
        stages.iter_mut().chain(&mut finer).for_each(|stage| stage.seconds *= slowness);
        condensing_seconds *= slowness;
        place_seconds *= slowness;
        // one load case after the other
        let in_time = &stages[stages.len() - work.solids.len()..];
        beside.stages += in_time.iter().map(|stage| stage.memory).fold(0.0, f64::max);
        Ok(Self {
            bodies: [rail.size, wheel.size],
            contact_nodes: [rail.mesh.contact, wheel.mesh.contact],
            stages,
            condensing_seconds,
            place_seconds,
            finer,
            beside,
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
}

/// One body: its mesh and its factor.
struct Body {
    mesh: MeshSize,
    size: FactorSize,
}

impl Body {
    /// Bytes of the matrix of the contact nodes.
    fn dense(&self) -> f64 {
        VALUE * (self.size.retained as f64).powi(2)
    }

    /// Largest memory on the way there, with so many modes, bytes.
    fn making(&self, modes: f64) -> f64 {
        largest(&self.size, modes, modes > 0.0)
    }

    /// Bytes of the inside of the body: the factor and the matrix.
    fn inside(&self) -> f64 {
        factor(self.size.inside) + ENTRY * self.size.entries as f64
    }

    /// Time to make it, s: half of the multiplications.
    fn seconds_inside(&self) -> f64 {
        // the symmetric half alone
        (SECONDS_ASSEMBLY * self.mesh.hexes as f64 + 0.5 * self.size.multiplications / SPEED)
            / self.size.parts as f64
    }

    /// The same for a body at full order in time, which has its mass and its damping besides.
    fn making_in_time(&self) -> f64 {
        largest(&self.size, 0.0, true) + ENTRY * self.size.entries as f64 + MASS * self.mesh.nodes as f64
    }

    /// The same body on a mesh of another size, whose factor grows as that of a body that is refined: the values with the power
    /// 4/3 of its nodes, the multiplications with their square.
    fn resized(&self, mesh: MeshSize) -> Self {
        let ratio = mesh.nodes as f64 / self.mesh.nodes as f64;
        let times = |count: usize, power: f64| (count as f64 * ratio.powf(power)) as usize;
        let size = FactorSize {
            parts: self.size.parts,
            equations: times(self.size.equations, 1.0),
            retained: 3 * mesh.contact,
            entries: times(self.size.entries, 1.0),
            values: times(self.size.values, 4.0 / 3.0),
            alone: times(self.size.alone, 4.0 / 3.0),
            beside: times(self.size.beside, 4.0 / 3.0),
            inside: times(self.size.inside, 4.0 / 3.0),
            multiplications: self.size.multiplications * ratio.powi(2),
        };
        Self { mesh, size }
    }

    /// Time of order, assembly, factor and reduction, s.
    fn seconds(&self) -> f64 {
        let parts = self.size.parts as f64;
        let reduction = parts * (self.size.retained as f64 / parts).powi(3);
        SECONDS_ORDER * self.mesh.nodes as f64
            + SECONDS_ASSEMBLY * self.mesh.hexes as f64
            + (self.size.multiplications + reduction) / SPEED
    }
}

/// The pair of a study on meshes.
struct Pair<'a> {
    input: &'a SolidsInput<'a>,
    geometry: &'a Geometry,
    meshes: &'a Meshes,
    rail: Body,
    wheel: Body,
    /// Bytes of program and meshes.
    base: f64,
}

impl Pair<'_> {
    /// The calibration without its error bands; with the fields under its loads, which need the inside of both bodies.
    fn calibration(&self, candidates: Candidates, fields: bool) -> StageEstimate {
        let Self { input, rail, wheel, base, .. } = self;
        let ways = ways_held(self.input.statics);
        let of_states = |share: &f64| Candidates::dense(share * candidates.kept);
        let states = ways * shares(&input.statics.calibration.loads).iter().map(of_states).sum::<f64>();
        let modes = input.modes as f64;
        // one more of the rail is against its section; beside the pressed bodies the inside of one of them at a time
        let pressed = wheel.dense() + (ways + 1.0) * rail.dense() + states;
        let (inside, seconds_inside) = match fields {
            true => (wheel.inside().max(rail.inside()), wheel.seconds_inside() + rail.seconds_inside()),
            false => (0.0, 0.0),
        };
        let memory = [
            self.condensing((ways - 1.0) * rail.dense(), modes),
            pressed + ways * Candidates::dense(candidates.first) + inside,
        ];
        StageEstimate {
            stage: "calibration".into(),
            memory: base + memory.into_iter().fold(0.0, f64::max),
            seconds: self.condensing_seconds()
                + seconds_inside
                + ways * pressing(input, &input.statics.calibration.loads, candidates)
                + SECONDS_WHOLE_LOAD * input.statics.calibration.loads.len() as f64,
        }
    }

    /// Time of condensing wheel and rail, s.
    fn condensing_seconds(&self) -> f64 {
        self.wheel.seconds() + ways_held(self.input.statics) * self.rail.seconds()
    }

    /// Bytes of the bodies with `modes` modes: the wheel, which is condensed first, or the rail after it and after another of so many bytes.
    fn condensing(&self, other: f64, modes: f64) -> f64 {
        let Self { rail, wheel, .. } = self;
        wheel.making(modes).max(wheel.dense() + other + rail.making(modes))
    }

    /// The laws by contact angle with their error bands; a place on the tread takes so many seconds on one thread.
    fn by_angle(&self, candidates: Candidates, place_seconds: f64) -> Result<StageEstimate> {
        let Self { input, geometry, rail, wheel, base, .. } = self;
        // each thread presses the wheel in one place, and keeps no state but the last
        let shifts = places::shifts(input.statics, input.shifts, &geometry.pair);
        let threads = (rayon::current_num_threads() as f64).min(shifts.len() as f64);
        // one more of the rail is against its section
        let mut kept = wheel.dense() + (ways_held(input.statics) + 1.0) * rail.dense();
        if input.statics.wants_error_band() && input.statics.meshes_are_ours() {
            let Self { rail, wheel, .. } = self.coarser()?;
            kept += wheel.dense() + (ways_held(input.statics) + 1.0) * rail.dense();
        }
        let fitted = if input.modes > 0 { SECONDS_ELEMENT * shifts.len() as f64 } else { 0.0 };
        Ok(StageEstimate {
            stage: "law by contact angle".into(),
            memory: base + kept + 2.0 * threads * Candidates::dense(candidates.first),
            seconds: (as_on_tread(input.statics, geometry, &shifts) * place_seconds + fitted) / threads,
        })
    }

    /// The same pair on the program's meshes with other sizes.
    fn resized(&self, options: &MeshOptions) -> Result<Self> {
        let Self { input, geometry, rail, wheel, .. } = self;
        let (on_rail, on_wheel) = rayon::join(
            || rail_size(&geometry.pair.rail, input.statics.rail.length, options),
            || wheel_size(&geometry.pair.wheel, options),
        );
        Ok(Self { rail: rail.resized(on_rail?), wheel: wheel.resized(on_wheel?), ..*self })
    }

    /// The same pair on the coarser meshes of the error bands.
    fn coarser(&self) -> Result<Self> {
        self.resized(&coarser::coarser_options(self.geometry, self.meshes.options()))
    }

    /// The pair with others in the place of the bodies and places that are assumed, one after the other, if any are.
    fn others(&self) -> Option<StageEstimate> {
        let Self { input, geometry, rail, wheel, base, .. } = self;
        let [rails, wheels] = others::others_by_body(input.statics, geometry).map(|count| count as f64);
        if rails + wheels == 0.0 {
            return None;
        }
        let (_, of_a_load) = changed(input);
        let loads = input.statics.calibration.loads.len().min(LOADS_COARSER) as f64;
        let pressed = (rails + wheels) * loads * of_a_load;
        let seconds = rails * rail.seconds() + wheels * wheel.seconds() + pressed;
        let memory = base + rail.dense() + wheel.dense() + self.condensing(0.0, 0.0);
        Some(StageEstimate { stage: "other bodies and places".into(), memory, seconds })
    }

    /// The springs with other inputs, on the bodies that there are; a contact between elements has none.
    fn uncertainty(&self) -> Option<StageEstimate> {
        let Self { input, rail, wheel, base, .. } = self;
        let samples = SAMPLES_ALONE + input.statics.uncertainty.samples as f64;
        (input.statics.contact.field == FieldKey::Hybrid).then(|| StageEstimate {
            stage: "uncertainty of the inputs".into(),
            memory: base + rail.dense() + wheel.dense(),
            seconds: samples * SECONDS_SAMPLE / rayon::current_num_threads() as f64,
        })
    }

    /// The error bands of the laws: the bodies of coarser meshes beside those of the laws, and the loads on both and on the halved grid.
    fn error_band(&self) -> Result<StageEstimate> {
        let Self { input, rail, wheel, base, .. } = self;
        let ways = ways_held(self.input.statics);
        let kept = (ways + 1.0) * rail.dense() + wheel.dense();
        let loads = input.statics.calibration.loads.len() as f64;
        let (on_grids, of_a_load) = changed(input);
        let seconds = loads.min(LOADS_HALVED as f64) * on_grids;
        let mut estimate = StageEstimate { stage: "error band".into(), memory: base + kept, seconds };
        if input.statics.meshes_are_ours() {
            let on_coarser = self.coarser()?;
            let Self { rail, wheel, .. } = &on_coarser;
            estimate.memory += on_coarser.condensing((ways - 1.0) * rail.dense(), 0.0);
            estimate.seconds +=
                wheel.seconds() + ways * (rail.seconds() + 2.0 * loads.min(LOADS_COARSER as f64) * of_a_load);
        }
        Ok(estimate)
    }
}
