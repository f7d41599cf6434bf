//! A checked study in SI units, and what follows from its keys together.

use std::collections::BTreeMap;

use railspring_calibrate::mesh::MeshOptions;
use railspring_simulate::solid::START_MODES;

use super::analysis::{
    CalibrationSettings, ContactSettings, SimulationSettings, StudyScenario, UncertaintySettings,
};
use super::document::{
    ContactElementKey, ElementKey, IntendedUseKeys, LawKey, OutputKeys, ReviewKeys, SECTIONS, SolidKeys,
    TransientKey,
};
use super::force_curve::ForceCurve;
use super::pair::{Rail, Track, Wheel};
use super::record::ResolvedKeys;
use super::source::Source;
use super::statics::Statics;
use crate::verify::Limits;

/// A checked study, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Short name; names the output folder.
    pub name: String,
    /// What the study is about.
    pub description: String,
    /// What the springs are for.
    pub intended_use: IntendedUseKeys,
    /// The rail.
    pub rail: Rail,
    /// The wheel.
    pub wheel: Wheel,
    /// Damping of both bodies, s ([`Material::damping`](railspring_calibrate::solid::Material::damping)): that of their materials here is zero, because statics have none.
    pub damping: f64,
    /// Where the wheel is on the track.
    pub track: Track,
    /// The solid meshes.
    pub mesh: MeshOptions,
    /// Formulation of the eight-node brick.
    pub element: ElementKey,
    /// Wanted error band of the law in use, relative.
    pub target_error: Option<f64>,
    /// Contact between the solids.
    pub contact: ContactSettings,
    /// Loads and reference of the law.
    pub calibration: CalibrationSettings,
    /// Standard uncertainties of the inputs.
    pub uncertainty: UncertaintySettings,
    /// Lateral shifts of the laws by contact angle, m, ascending; `None` leaves them to the program.
    pub shifts: Option<Vec<f64>>,
    /// Whether contact elements are made of the solids; `None` where there is a load case.
    pub elements: Option<bool>,
    /// The simple model.
    pub simulation: SimulationSettings,
    /// The solid model in time.
    pub solid: SolidKeys,
    /// Load cases by name.
    pub scenarios: BTreeMap<String, StudyScenario>,
    /// Name of the load case whose histories have the plain file names.
    pub main_scenario: Option<String>,
    /// Limits of the verdict.
    pub limits: Limits,
    /// The measured curve that the law is compared with.
    pub measured: Option<ForceCurve>,
    /// Who made and who reviewed the study.
    pub review: ReviewKeys,
    /// Files for other programs.
    pub output: OutputKeys,
    /// All keys with their values, defaults filled in; the keys of each section by name.
    pub resolved: ResolvedKeys,
    /// The file the study came from.
    pub source: Source,
}

impl Study {
    /// What the statics of the pair are made from.
    pub fn statics(&self) -> Statics<'_> {
        Statics {
            rail: &self.rail,
            wheel: &self.wheel,
            track: self.track,
            mesh: &self.mesh,
            target_error: self.target_error,
            window_given: self.source.gives("mesh.window_half_length_mm"),
            element: self.element,
            contact: self.contact,
            calibration: &self.calibration,
            uncertainty: &self.uncertainty,
            beam_elements: self.simulation.rail_elements,
        }
    }

    /// Whether there are to be laws by contact angle.
    pub fn wants_by_angle(&self) -> bool {
        self.shifts.as_ref().is_none_or(|shifts| !shifts.is_empty())
    }

    /// Contact element of the simple model.
    pub fn element(&self) -> ContactElementKey {
        let SimulationSettings { element, law, horizontal, .. } = &self.simulation;
        let of_own_springs = *law == LawKey::Calibrated && horizontal.is_none();
        let of_solids = self.wants_by_angle() && self.elements != Some(false);
        element.unwrap_or(match of_solids && of_own_springs {
            true => ContactElementKey::Condensed,
            false => ContactElementKey::Published,
        })
    }

    /// Whether the condensed and the lumped element are made: the simple model runs with one of them, or they stand beside the published one.
    pub fn wants_condensed(&self) -> bool {
        self.wants_by_angle() && self.elements.unwrap_or(!self.scenarios.is_empty())
    }

    /// Modes that the bodies are condensed with: those that reduced runs begin with, and the condensed element has; none where there is
    /// neither.
    pub fn modes(&self) -> usize {
        let reduced = self.solid.transient == TransientKey::Reduced;
        let runs = self.scenarios.values().any(|case| case.solid);
        match reduced && runs {
            true => self.solid.modes.unwrap_or(START_MODES),
            false if self.wants_condensed() => START_MODES,
            false => 0,
        }
    }

    /// Makes the study one of many: it holds together with `other`, which it resembles, what both have alike, and no content of measured
    /// profiles, which are read again when they are wanted.
    pub(crate) fn as_one_of_many(&mut self, other: Option<&Self>) {
        let measured = [&mut self.rail.measured, &mut self.wheel.measured];
        measured.into_iter().flatten().for_each(|measured| measured.content.let_go());
        let Some(other) = other else { return };
        self.resolved.share(&other.resolved);
        self.source.share(&other.source);
        for (own, other) in
            [(&mut self.rail.section, &other.rail.section), (&mut self.wheel.section, &other.wheel.section)]
        {
            if own == other {
                own.clone_from(other);
            }
        }
    }

    /// Whether a dotted key belongs to the study file, so that a message can name its line.
    pub fn owns(&self, key: &str) -> bool {
        let section = key.split(['.', '[']).next().unwrap_or_default();
        section == "name" || SECTIONS.contains(&section)
    }
}
