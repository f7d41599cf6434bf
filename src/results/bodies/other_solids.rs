//! The solid model in time with another grid of its contact and with other meshes, which show the error of these.

use railspring_calibrate::calibration::ContactField;
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::superelement::CondensedBody;
use railspring_profiles::error::{Error, Result, or_reason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::MILLIMETRE;
use railspring_simulate::solid::{ModeCount, OtherRun, RailPath, TransientModel, TransientRun};
use railspring_simulate::time::history::History;
use railspring_simulate::time::scenario::Scenario;

use crate::results::bodies::coarser::{on_coarser_meshes, with_longer_zones};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::input::SolidRunInput;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::solids::MovingBodies;
use crate::study::Statics;

/// Edges of the other contact elements over those of the study's. The elements of the bodies around them stay: they are those of the
/// condensed element as well, so that they move both models alike.
const COARSER: f64 = 1.5;

/// Bodies with coarser contact elements, which move in runs in time.
pub struct CoarserMoving {
    /// Sizes of the meshes.
    options: MeshOptions,
    /// Edge of the contact elements, m.
    contact_element: f64,
    bodies: MovingBodies,
}

/// The bodies, or why there are none.
pub type CoarserContact = std::result::Result<CoarserMoving, String>;

/// The bodies with coarser contact elements than `meshes`, which `condense` makes.
///
/// # Errors
/// An interruption.
pub fn coarser_contact(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    condense: impl FnOnce(&Meshes) -> Result<MovingBodies>,
) -> Result<CoarserContact> {
    let own = meshes.options();
    let options = MeshOptions {
        contact_element: COARSER * own.contact_element,
        contact_element_along: COARSER * own.contact_element_along,
        ..own.clone()
    };
    let options = with_longer_zones(geometry, options);
    let contact_element = options.contact_element.max(options.contact_element_along);
    on_coarser_meshes(statics, geometry, meshes, options.clone(), |coarser| {
        Ok(CoarserMoving { options, contact_element, bodies: condense(coarser)? })
    })
}

/// A load case on other solids.
pub(crate) struct OtherSolids<'a> {
    pub input: SolidRunInput<'a>,
    pub geometry: &'a Geometry,
    pub scenario: &'a Scenario,
    /// Modes of each body.
    pub modes: usize,
    pub monitor: &'a dyn Monitor,
}

impl OtherSolids<'_> {
    /// Runs beside that of the load case: its first time steps on a contact grid of half the spacing, and all of it on `coarser` contact elements. They have the longer steps that the
    /// load case was run with as well, where it could be: a grid changes the same with them.
    ///
    /// # Errors
    /// An interruption.
    pub fn runs(
        &self,
        run: &TransientRun,
        (meshes, own): (&Meshes, &MovingBodies),
        coarser: &(dyn Fn(usize) -> Result<CoarserContact> + Sync),
    ) -> Result<Vec<(String, OtherRun)>> {
        let has_longer = matches!(run.longer, Some(Ok(_)));
        let steps = self.scenario.inner_steps;
        let inner_steps = if has_longer { steps.doubled() } else { steps };
        let scenario = Scenario { inner_steps, ..self.scenario.clone() };
        // a finer grid takes several times as long, and changes the least of all
        let first = TransientModel::first_of(&scenario);
        let (_, field) = self.input.pair.contact.of_solids();
        let on_finer_grid = || {
            let finer = (field == ContactField::Hybrid).then_some(ContactField::HybridHalved);
            finer.map(|finer| or_reason(self.run(&first, own.both(), meshes.options(), finer))).transpose()
        };
        let on_coarser = || match coarser(self.modes)? {
            Ok(CoarserMoving { options, contact_element, bodies }) => {
                let run = or_reason(self.run(&scenario, bodies.both(), &options, field))?;
                Ok((format!("contact elements of {:.2} mm", contact_element / MILLIMETRE), run))
            }
            Err(reason) => Ok::<_, Error>(("coarser contact elements".into(), Err(reason))),
        };
        let (grid, mesh) = rayon::join(on_finer_grid, on_coarser);
        let grid = grid?.map(|run| ("a contact grid of half the spacing".into(), run));
        Ok(grid.into_iter().chain([mesh?]).collect())
    }

    fn run(
        &self,
        scenario: &Scenario,
        bodies: [&CondensedBody; 2],
        options: &MeshOptions,
        field: ContactField,
    ) -> Result<History> {
        let Self { input, geometry, modes, .. } = *self;
        let path = path_on(&input, geometry, options, (bodies[0], scenario, modes))?;
        let contact = (input.pair.contact.of_solids().0, field);
        let count = ModeCount::Given(modes);
        let model = TransientModel::reduced(&geometry.pair, bodies, count, input.damping, contact)?;
        let model = match &path {
            Some(path) => model.along(path),
            None => model,
        };
        model.run_alone(modes, scenario, self.monitor)
    }
}

/// The rail at all places of a wheel that moves along it, or stands elsewhere than in its middle, with as many modes as the bodies.
pub(crate) fn path_on(
    input: &SolidRunInput<'_>,
    geometry: &Geometry,
    options: &MeshOptions,
    (rail, scenario, modes): (&CondensedBody, &Scenario, usize),
) -> Result<Option<RailPath>> {
    let length = input.pair.rail.length;
    let wanted = RailPath::is_wanted(scenario, length);
    let of = (length, modes);
    let (material, element) = (&input.pair.rail.material, input.pair.element.formulation());
    let path = || RailPath::new(&geometry.pair, rail, options, material, element, of);
    wanted.then(path).transpose()
}
