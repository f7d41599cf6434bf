//! What belongs to a history besides its rows: the model's size, how the run ended, and the springs that it ran with.

use std::sync::Arc;

use nalgebra::Point2;
use railspring_element::pair_element::PairElement;
use railspring_profiles::units::MILLIMETRE;
use railspring_simulate::element::condensed::parts::LumpedElement;
use railspring_simulate::solid::Reduction;
use railspring_simulate::time::history::{Ending, History};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::by_angle::element::{ElementRecord, HubDeviationRecord};
use crate::results::by_angle::lumped::LumpedRecord;
use crate::results::springs::form::NormalLawRecord;
use crate::results::springs::record::BeamFactors;
use crate::rounding::significant;
use crate::study::ContactElementKey;
use crate::study::tables::FileRecord;
use crate::verify::{ModelChange, ModelRun, NumericalUncertainty, Spread, StepChange};

/// The run that a history is of, as a note beside its file.
pub const RUN_NOTE: &str = "run";

/// A run of one of the models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunRecord {
    /// Degrees of freedom of the model.
    pub degrees_of_freedom: usize,
    /// How the run ended: `completed`, where the wheel went when it left the rail, or which end of the surfaces the contact reached.
    pub ending: String,
    /// When the run ended, if not with its last step, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended_at_s: Option<f64>,
    /// Where the contact reached the end of the surfaces, if it did: y and z in the rail's profile frame, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended_at_rail_mm: Option<[f64; 2]>,
    /// Mass of the wheel that ran, kg: that of the load case if it has one, else that of the springs, of the condensed element or of the solid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wheel_mass_kg: Option<f64>,
    /// The springs of the simple model; none in a run of the solid model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub springs: Option<SpringsRecord>,
    /// The modes of the reduced bodies of the solid model; none at full order and in a run of the simple model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<ReductionRecord>,
    /// What steps of another length change; none where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step_change: Option<StepChange>,
    /// What an input that is 0.1 % larger changes; none where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<Spread>,
    /// What other discretisations of the model change, as far as that is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub discretisation: Vec<ModelChange>,
    /// The files with tables of its forces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tables: Vec<FileRecord>,
    /// What has to be known about the run, for instance that it leaves the law's fitted range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl RunRecord {
    /// The record of a run; `springs` are those of the simple model.
    pub fn new(
        history: &History,
        springs: Option<&SpringsRecord>,
        uncertainty: NumericalUncertainty,
        mut notes: Vec<String>,
    ) -> Self {
        let model = if springs.is_some() { "simple model" } else { "solid model" };
        notes.extend(lost_contact(history).map(|lost| format!("{model}: {lost}")));
        notes.push(match &uncertainty.steps {
            Ok(change) => format!("{model}: {change}"),
            Err(reason) => format!("{model}: the change with steps of another length is not known: {reason}"),
        });
        notes.push(match &uncertainty.spread {
            Ok(change) => format!("{model}: {change}"),
            Err(reason) => {
                format!("{model}: the change with an input that is 0.1 % larger is not known: {reason}")
            }
        });
        notes.extend(uncertainty.discretisation.iter().map(|of| match of {
            Ok(change) => format!("{model}: {change}"),
            Err(reason) => format!("{model}: {reason}"),
        }));
        Self {
            springs: springs.cloned(),
            step_change: uncertainty.steps.ok(),
            spread: uncertainty.spread.ok(),
            discretisation: uncertainty.discretisation.into_iter().filter_map(Result::ok).collect(),
            notes,
            ..Self::bare(history)
        }
    }

    /// The record of a run with its size and its end alone.
    pub fn bare(history: &History) -> Self {
        Self {
            degrees_of_freedom: history.degrees_of_freedom,
            ending: history.ending.name().into(),
            ended_at_s: history.ending.time(),
            ended_at_rail_mm: history.ending.rail().map(|place| [place.x, place.y].map(|at| at / MILLIMETRE)),
            wheel_mass_kg: None,
            springs: None,
            reduction: None,
            step_change: None,
            spread: None,
            discretisation: Vec::new(),
            tables: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The record of a run of the solid model.
    pub fn of_solid(
        history: &History,
        reduction: Option<&Reduction>,
        uncertainty: NumericalUncertainty,
    ) -> Self {
        let record = reduction.map(ReductionRecord::from);
        let unknown = reduction.filter(|reduction| reduction.time == 0.0).map(|_| {
            "solid model: the change with other modes is not known: a run with them ended in its first time step".into()
        });
        let notes = reduction.filter(|reduction| !reduction.suffices()).map(|reduction| {
            let [vertical, lateral] = reduction.change.map(|change| 100.0 * change);
            format!(
                "with {} modes of each body P still changes by {vertical:.2} % and Q by {lateral:.2} % of the peak; \
                 solid.transient = \"full\" does without modes",
                reduction.modes[0].max(reduction.modes[1])
            )
        });
        Self {
            reduction: record,
            ..Self::new(history, None, uncertainty, notes.into_iter().chain(unknown).collect())
        }
    }

    /// The run of a history, and the disturbed one if there is one, with its uncertainty.
    pub fn model<'a>(&'a self, history: &'a History, disturbed: Option<&'a History>) -> ModelRun<'a> {
        ModelRun {
            history,
            steps: self.step_change.as_ref(),
            disturbed: disturbed.zip(self.spread.as_ref()),
            discretisation: &self.discretisation,
        }
    }

    /// How the run ended; `None` if the record names no known ending.
    pub fn ending(&self) -> Option<Ending> {
        let rail = self.ended_at_rail_mm.map(|[y, z]| Point2::new(y * MILLIMETRE, z * MILLIMETRE));
        Ending::from_parts(&self.ending, self.ended_at_s, rail)
    }
}

/// A time in seconds, to the microsecond.
fn microseconds(time: f64) -> f64 {
    (time * 1e6).round() / 1e6
}

/// Says from when on a wheel that is still over the rail at the end of a run has no contact, and how far it is off then.
fn lost_contact(history: &History) -> Option<String> {
    let [.., before, end] = history.rows.as_slice() else { return None };
    if history.ending != Ending::Completed || !end.contacts.is_empty() {
        return None;
    }
    let last = history.rows.iter().rposition(|row| !row.contacts.is_empty());
    let since = match last {
        Some(last) => format!("no contact from {} s on", microseconds(history.rows[last + 1].time)),
        None => "no contact at any step".into(),
    };
    // the first row is just touching
    let above = (history.rows[last.unwrap_or(0)].wheel_z - end.wheel_z) / MILLIMETRE;
    let speed = (before.wheel_z - end.wheel_z) / (end.time - before.time);
    let (place, way) =
        (if above < 0.0 { "below" } else { "above" }, if speed < 0.0 { "falls" } else { "rises" });
    Some(format!(
        "{since}: at the end, at {} s, the wheel is {} mm {place} {} and {way} at {} m/s",
        microseconds(end.time),
        significant(above.abs(), 4),
        if last.is_some() { "its last contact" } else { "its start" },
        significant(speed.abs(), 3)
    ))
}

/// The modes of a reduced solid model, and their error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReductionRecord {
    /// Modes of the rail.
    pub rail_modes: usize,
    /// Modes of the wheel.
    pub wheel_modes: usize,
    /// Largest change of P with the modes, against a run with fewer, over its peak.
    pub vertical_change: f64,
    /// The same of Q.
    pub lateral_change: f64,
    /// Modes of rail and wheel in the run with fewer.
    pub against_modes: [usize; 2],
    /// Time up to which the two are compared, s.
    pub compared_until_s: f64,
}

impl From<&Reduction> for ReductionRecord {
    fn from(reduction: &Reduction) -> Self {
        let ([rail_modes, wheel_modes], [vertical_change, lateral_change]) =
            (reduction.modes, reduction.change);
        let (against_modes, compared_until_s) = (reduction.fewer, reduction.time);
        Self { rail_modes, wheel_modes, vertical_change, lateral_change, against_modes, compared_until_s }
    }
}

/// The springs and the wheel mass of a simple model, and where they are from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpringsRecord {
    /// Where the normal law is from.
    pub source: SpringsSource,
    /// The normal law.
    #[serde(flatten)]
    pub law: NormalLawRecord,
    /// Horizontal stiffness, kN/m.
    pub horizontal_kn_per_m: f64,
    /// Mass of the solid wheel, which scenarios without a wheel mass take, kg.
    pub wheel_mass_kg: f64,
    /// What the displacement of the law is measured against, if that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// Smallest and largest load of the fit, kN, if they are known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_kn: Option<[f64; 2]>,
    /// What makes the rail beam as flexible as the solid rail that the law was calibrated on.
    #[serde(default)]
    pub beam: BeamFactors,
    /// Contact element that the model runs with.
    #[serde(default)]
    pub contact_element: ContactElementKey,
    /// BLAKE3 hash of it, if it is made from the solids; none of the published element.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub element_blake3: Option<String>,
    /// Where its hub is farthest from that of the solid under statics.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub element_displacement: Option<HubDeviationRecord>,
    /// That element; in files it stands in `stiffness_by_angle.json`.
    #[serde(skip)]
    pub element: Option<Arc<SolidElementRecord>>,
    /// In which respects the law is not that of the study's own pair and rail model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// A contact element that is made from the solids.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum SolidElementRecord {
    /// The condensed one.
    Condensed(ElementRecord),
    /// The lumped one.
    Lumped(LumpedRecord),
}

impl SolidElementRecord {
    /// Which one it is.
    pub fn key(&self) -> ContactElementKey {
        match self {
            Self::Condensed(_) => ContactElementKey::Condensed,
            Self::Lumped(_) => ContactElementKey::Lumped,
        }
    }

    /// Where its hub is farthest from that of the solid under statics.
    pub fn displacement(&self) -> Option<HubDeviationRecord> {
        match self {
            Self::Condensed(element) => element.displacement,
            Self::Lumped(element) => element.displacement,
        }
    }
}

impl From<&SolidElementRecord> for PairElement {
    fn from(element: &SolidElementRecord) -> Self {
        match element {
            SolidElementRecord::Condensed(element) => element.into(),
            SolidElementRecord::Lumped(element) => (&LumpedElement::from(element)).into(),
        }
    }
}

/// Where a normal law is from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpringsSource {
    /// Calibrated by the study itself.
    Calibrated,
    /// The published constants.
    Published,
    /// A file that was named on the command line.
    File {
        /// The file as it was named.
        name: String,
        /// BLAKE3 hash of its content.
        blake3: String,
    },
}

#[cfg(test)]
mod tests {
    use railspring_simulate::time::history::{ContactMode, ContactState, HistoryRow};

    use super::*;

    /// A run of steps of 0.5 ms with a contact where `touches` says so; the wheel rises by 0.1 mm a step from the third on.
    fn run(touches: &[bool]) -> History {
        let contact = ContactState {
            mode: ContactMode::Stick,
            rail: Point2::origin(),
            wheel: Point2::origin(),
            normal_force: 1e3,
            tangential_force: 0.0,
        };
        let row = |(n, touches): (usize, &bool)| HistoryRow {
            time: n as f64 * 5e-4,
            vertical_force: if *touches { 1e3 } else { 0.0 },
            lateral_force: 0.0,
            wheel_y: 0.0,
            wheel_z: -1e-4 * n.saturating_sub(2) as f64,
            load_y: 0.0,
            energy: None,
            contacts: touches.then_some(contact).into_iter().collect(),
        };
        let rows = touches.iter().enumerate().map(row).collect();
        History { rows, degrees_of_freedom: 6, ending: Ending::Completed }
    }

    /// Goal: the record of a wheel that has no contact at the end says from when on, how far it is off and which way it goes; a wheel that has
    /// come back, or left the rail, has no such note.
    #[test]
    fn a_wheel_that_does_not_come_back_is_said() {
        let notes = |history: &History| {
            let uncertainty = || NumericalUncertainty {
                steps: Err("no".into()),
                spread: Err("no".into()),
                discretisation: Vec::new(),
            };
            RunRecord::new(history, None, uncertainty(), Vec::new()).notes
        };
        let lost = run(&[false, true, true, false, true, false, false]);
        let said = "solid model: no contact from 0.0025 s on: at the end, at 0.003 s, the wheel is 0.2000 mm above its last contact and rises at 0.200 m/s";
        assert_eq!(notes(&lost)[0], said);
        let never = notes(&run(&[false; 5])).remove(0);
        assert!(never.starts_with("solid model: no contact at any step: at the end, at 0.002 s,"), "{never}");
        assert!(never.contains("0.2000 mm above its start"), "{never}");
        assert_eq!(notes(&run(&[false, true, false, true])).len(), 2, "it has come back");
        let departed = Ending::Departed {
            time: 3.5e-3,
            departure: railspring_profiles::placement::Departure::FieldSide,
        };
        assert_eq!(notes(&History { ending: departed, ..lost }).len(), 2, "the ending says so");
    }
}
