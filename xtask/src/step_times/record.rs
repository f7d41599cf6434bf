//! `moving.json` and `moving.csv`: the time of a step of the moving solver.

use railspring::engine::measured::MachineRecord;
use railspring::engine::output::to_csv;
use serde::{Deserialize, Serialize};

/// Name of the published load case in as many steps as a host of the element takes, whose time is that of such a step.
pub const HOSTED: &str = "4.1 in equal steps";
/// Steps in each of the history.
pub const HOSTED_STEPS: usize = 16;
/// Name of a span for vehicles.
pub const BRIDGE: &str = "bridge of 25 m";

/// `moving.json`: every case that was timed, and the same by other programs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepTimesRecord {
    /// When the runs began, UTC.
    pub begun_utc: String,
    /// What they ran on.
    pub machine: MachineRecord,
    /// Clock of the times: `CPU time`, or `wall clock` where the system does not say.
    pub clock: String,
    /// Runs of each case, of which the shortest counts.
    pub repeats: usize,
    /// The cases, of each element in turn.
    pub times: Vec<StepTime>,
    /// Steps of other programs, timed in turns with these; none where they were not asked for.
    pub peers: Vec<PeerTime>,
}

/// The time of a step in one case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepTime {
    /// Name of the case.
    pub case: String,
    /// Contact element.
    pub element: String,
    /// Beam elements of the rail.
    pub elements: usize,
    /// Degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Time steps of the history of a run; in the case of a host all of the integration.
    pub steps: usize,
    /// Steps of the integration in each of them, on the average.
    pub inner_steps: f64,
    /// Iterations of a step of the integration.
    pub iterations: f64,
    /// Time of the shortest run over its steps, preparation included, µs.
    pub microseconds: f64,
    /// The median of the runs, µs a step.
    pub median_microseconds: f64,
    /// The longest, µs a step.
    pub longest_microseconds: f64,
}

/// The time of a step of another program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PeerTime {
    /// Name of the case with which it is compared.
    pub case: String,
    /// Program and its elements.
    pub program: String,
    /// Beam elements of the rail; of a host those of the study, whose modes it has.
    pub elements: usize,
    /// Time of its shortest run over its steps, without preparation, µs.
    pub microseconds: f64,
    /// The median of the runs, µs a step.
    pub median_microseconds: f64,
    /// The longest, µs a step.
    pub longest_microseconds: f64,
}

/// A row of `moving.csv`.
#[derive(Serialize)]
struct Row<'a> {
    case: &'a str,
    program: &'a str,
    elements: usize,
    least_us_a_step: f64,
    most_us_a_step: f64,
    integration_steps_a_step: Option<f64>,
    iterations_a_step: Option<f64>,
}

impl StepTimesRecord {
    /// The other programs' times of a case with so many elements.
    pub fn peers_of(&self, case: &str, elements: usize) -> impl Iterator<Item = &PeerTime> {
        self.peers.iter().filter(move |peer| peer.case == case && peer.elements == elements)
    }

    /// A row for each case of each element, then those of other programs.
    pub fn csv(&self) -> Vec<u8> {
        let own = self.times.iter().map(|time| Row {
            case: &time.case,
            program: &time.element,
            elements: time.elements,
            least_us_a_step: time.microseconds,
            most_us_a_step: time.longest_microseconds,
            integration_steps_a_step: Some(time.inner_steps),
            iterations_a_step: Some(time.inner_steps * time.iterations),
        });
        let others = self.peers.iter().map(|peer| Row {
            case: &peer.case,
            program: &peer.program,
            elements: peer.elements,
            least_us_a_step: peer.microseconds,
            most_us_a_step: peer.longest_microseconds,
            integration_steps_a_step: None,
            iterations_a_step: None,
        });
        to_csv(&own.chain(others).collect::<Vec<_>>())
    }
}
