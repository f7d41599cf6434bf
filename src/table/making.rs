//! What is made of one case of a table: its bodies and its places, each kept in the store as soon as it is there.

use std::sync::Arc;

use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::calibration::Reference;
use railspring_calibrate::pair::{CondensedPair, PairBody};
use railspring_profiles::error::{Error, Result};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};
use serde::{Deserialize, Serialize};

use super::carried::{BodiesRecord, OwnRecord, checking, is_checked};
use super::document::{BodiesKey, DirectionKey, TableDocument};
use super::shared::{Common, OnBodies, Sharing, shares, wanted_on_standards};
use super::surfaces::MeasuredRecord;
use crate::engine::store::{Address, Artefact, Kind, Store};
use crate::hash::key;
use crate::results::bodies::estimate::{self, Beside, Resources, Room, Work};
use crate::results::bodies::geometry::{self, Geometry};
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::meshes::{self, Meshes};
use crate::results::bodies::places::tape_y;
use crate::results::bodies::record::ProfileRecord;
use crate::results::bodies::source::BodySource;
use crate::results::bodies::{coarser, solids, zones};
use crate::results::by_angle::make::{self, PlaceSettings};
use crate::results::by_angle::record::ShiftRecord;
use crate::results::springs::uncertainty;
use crate::study::{ResolvedKey, Study};

/// Part of an artefact: the place.
const PLACE: &str = "place.json";
/// The same: which bodies a pair has.
const PREPARED: &str = "prepared.json";

/// What a place has come to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaceRecord {
    /// The law; the shift is that towards the rail of the side.
    pub at: ShiftRecord,
    /// Radius on which the wheel rolls at the first touch, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling_radius_mm: Option<f64>,
    /// Tangent stiffness of Hertz's contact at the first touch, under normal forces as large as the loads of the columns, kN/m; empty where
    /// the bodies conform.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hertz_kn_per_m: Vec<f64>,
    /// What the measured surfaces are; none where neither was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<Arc<MeasuredRecord>>,
    /// The bodies that the measured surfaces were pressed on; none where neither was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bodies: Option<BodiesRecord>,
    /// What was found in the profiles and could not be repaired, a sentence each: the surface is unsure there, and its springs have no band.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings_left: Vec<String>,
    /// Uncertainty by the inputs at the loads of the columns; none where the table does not give `uncertainty`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<PlaceUncertainty>,
}

/// Uncertainty of a place by the inputs of its case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaceUncertainty {
    /// Loads, kN, with half widths of the bands of 95 % of displacement and tangent, relative.
    pub loads: Vec<(f64, [f64; 2])>,
    /// Why there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

impl PlaceRecord {
    /// The place that a store has at an address; `said` hears why an entry cannot be used.
    pub(super) fn taken(store: &Store, address: &Address, said: &dyn Monitor) -> Option<Self> {
        store.take_as(address, |artefact| Self::read(&artefact), &|text| said.notice(&text))
    }

    /// The place of an artefact of the store.
    ///
    /// # Errors
    /// [`railspring_profiles::error::InputError`] for one that is no place.
    fn read(artefact: &Artefact) -> Result<Self> {
        let content = artefact.part(PLACE).unwrap_or_default();
        let text = std::str::from_utf8(content).unwrap_or_default();
        crate::engine::output::parse_json(std::path::Path::new(PLACE), text, "table")
    }

    /// One without a law.
    pub(super) fn failed(shift_mm: f64, reason: &Error) -> Self {
        Self {
            at: ShiftRecord {
                shift_mm,
                touch: None,
                laws: Vec::new(),
                shared_from_kn: None,
                loads: Vec::new(),
                published_secant_ratio: None,
                error_band: None,
                reason: Some(reason.to_string()),
            },
            rolling_radius_mm: None,
            hertz_kn_per_m: Vec::new(),
            measured: None,
            bodies: None,
            findings_left: Vec::new(),
            uncertainty: None,
        }
    }
}

/// What the places of all cases have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings<'a> {
    /// Name of the table, for lists.
    pub name: &'a str,
    /// Along what the wheels are pressed.
    pub direction: DirectionKey,
    /// Whose bodies measured profiles are pressed on.
    pub bodies: BodiesKey,
    /// Loads of the columns, kN.
    pub stiffness_at_kn: &'a [f64],
}

impl<'a> Settings<'a> {
    /// Those of a table.
    pub fn of(document: &'a TableDocument) -> Self {
        let TableDocument { name, direction, stiffness_at_kn, .. } = document;
        Self { name, direction: *direction, bodies: document.bodies(), stiffness_at_kn }
    }

    /// Those of the same places on their own bodies.
    pub fn on_own(self) -> Self {
        Self { bodies: BodiesKey::Own, ..self }
    }

    /// Address of the place of a study at a shift towards the rail (mm).
    pub fn address(&self, study: &Study, towards: f64) -> Address {
        // the uncertainty of inputs is asked for where the table gives it
        let statics = if is_uncertain(study) { study.statics() } else { study.statics().exact() };
        // a wheel between two others is another one than the same wheel itself
        let between = shares(study, self.bodies) && study.wheel.diameter_measured;
        let depends_on = (statics, self.direction, self.bodies, self.stiffness_at_kn, towards, between);
        Address::of(Kind::Place, &depends_on)
    }
}

/// Whether a case gives the uncertainty of its inputs: it takes longer than the place itself, so that defaults alone do not ask for it.
pub(super) fn is_uncertain(study: &Study) -> bool {
    let given = |key: &ResolvedKey| key.section == "uncertainty" && key.given;
    study.statics().wants_error_band() && study.resolved.iter().any(given)
}

/// A case that is being made.
#[derive(Clone, Copy)]
pub(super) struct CaseWork<'a> {
    pub study: &'a Study,
    pub settings: Settings<'a>,
    pub store: &'a Store,
    /// Bodies that cases have in common.
    pub nominals: &'a Common<Ready>,
    /// Bodies whose rail serves again where it is that of the case.
    pub beside: Option<&'a CondensedPair>,
    /// Whether the store gets neither rail nor wheel of this case, though it is pressed on its own ones.
    pub lets_go: [bool; 2],
    pub resources: Resources<'a>,
    /// Who hears what the store does not keep.
    pub said: &'a dyn Monitor,
}

/// A body that a case is pressed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct BodyOfCase {
    /// Whether it is that of the coarser meshes, which the error band is from.
    pub coarser: bool,
    pub body: PairBody,
}

impl CaseWork<'_> {
    /// The case up to its meshes.
    ///
    /// # Errors
    /// What is wrong with the study, by its keys; more memory than there is.
    pub fn meshed(&self) -> Result<Meshed> {
        self.with_keys(|| {
            let input = SolidsInput::of(self.study);
            let geometry = geometry::geometry(input.statics)?;
            let options = zones::mesh_options(input.statics, &geometry);
            let work = Work { in_table: true, ..Work::of(&input, true, false) };
            let (meshes, beside) = estimate::meshes(&input, &geometry, options, &work, &self.resources)?;
            Ok(Meshed { geometry, meshes, beside })
        })
    }

    /// The case up to its condensed bodies, its own or those of its nominal profiles, taken from the store or made.
    ///
    /// # Errors
    /// As [`Self::meshed`]; those of condensing.
    pub fn ready(&self) -> Result<Ready> {
        let sharing = self.with_keys(|| Sharing::of(self.study, self.settings.bodies))?;
        let Some(sharing) = sharing else { return self.own() };
        let nominal = |study: &Study| {
            let case = CaseWork { study, ..*self };
            self.nominals.get(key(&study.statics()), || case.own())
        };
        let ready: Result<Vec<Arc<Ready>>> = sharing.nominals.iter().map(nominal).collect();
        match ready {
            Ok(ready) => self.carried(sharing, &ready),
            // a wheel turned to the next smaller diameter may have no rim left
            Err(Error::Input(_)) if sharing.nominals.len() > 1 => self.own(),
            Err(other) => Err(other),
        }
    }

    /// The case of its nominal profiles on its condensed bodies, if another case has had them made.
    pub fn nominal(&self) -> Option<Arc<Ready>> {
        let sharing = Sharing::of(self.study, self.settings.bodies).ok().flatten()?;
        self.nominals.known(&key(&sharing.nominals.first()?.statics()))
    }

    /// The case on ready bodies of its nominal profiles; on its own where these do not carry it.
    fn carried(&self, sharing: Sharing, ready: &[Arc<Ready>]) -> Result<Ready> {
        let nominals: Vec<&OnBodies> = ready.iter().map(|ready| &ready.on_bodies).collect();
        match sharing.on(self.study, &nominals) {
            Ok(on_bodies) => {
                let off = on_bodies.geometry.pair.off_bodies;
                let bodies = Some(BodiesRecord::off(self.settings.bodies, off, ready.len() > 1));
                Ok(Ready { bodies, ..Ready::new(self.study, ready[0].room, on_bodies) })
            }
            // another inclination, worn too far, or wheels with other nodes
            Err(Error::Input(_)) => self.own(),
            Err(other) => Err(other),
        }
    }

    /// What `with` makes of each case whose bodies are condensed for this one: those of its nominal profiles, or itself.
    ///
    /// # Errors
    /// Those of its files, and of `with`.
    pub fn with_bodies<T>(&self, with: impl Fn(&CaseWork<'_>) -> Result<T>) -> Result<Vec<T>> {
        match self.with_keys(|| Sharing::of(self.study, self.settings.bodies))? {
            Some(sharing) => {
                sharing.nominals.iter().map(|study| with(&CaseWork { study, ..*self })).collect()
            }
            None => Ok(vec![with(self)?]),
        }
    }

    /// The same with its own bodies. Where the store has them, nothing is meshed.
    ///
    /// # Errors
    /// As [`Self::ready`].
    fn own(&self) -> Result<Ready> {
        let known = self.kept().map_or(Ok(None), |prepared| self.own_from(&prepared))?;
        known.map_or_else(|| self.condensed(), Ok)
    }

    /// The case on its own bodies, which are condensed unless the store has them.
    fn condensed(&self) -> Result<Ready> {
        let meshed = self.meshed()?;
        let room = self.room(meshed.beside);
        let (bodies, coarser) = self.with_keys(|| {
            let Meshed { geometry, meshes, .. } = &meshed;
            let (statics, source) = (self.study.statics(), self.source(room));
            let bodies = source.condensed(&solids::solids(statics, geometry, meshes), "", 0)?;
            let coarser = statics
                .wants_error_band()
                .then(|| source.coarser(statics, geometry, meshes, 0))
                .transpose()?;
            Ok((bodies, coarser.map(|coarser| (meshes.contact_element(), coarser))))
        })?;
        if self.keeps_bodies() {
            self.keep(&self.prepared_of(&meshed));
        }
        Ok(Ready::new(self.study, room, OnBodies { geometry: meshed.geometry, bodies, coarser }))
    }

    /// Address of what the case needs to be pressed without its meshes.
    pub fn address_of_bodies(&self) -> Address {
        Address::of(Kind::Prepared, &self.study.statics())
    }

    /// What the store says that it needs.
    fn kept(&self) -> Option<Prepared> {
        let trouble = |text: String| self.said.notice(&text);
        self.store.take_as(&self.address_of_bodies(), |artefact| artefact.json(PREPARED), &trouble)
    }

    fn keep(&self, prepared: &Prepared) {
        let content = serde_json::to_vec(prepared).expect("records are plain data");
        let artefact = Artefact::default().with(PREPARED, content);
        let (address, name) = (self.address_of_bodies(), self.settings.name);
        self.store.keep(&address, "which bodies a pair has", name, &artefact, &|text| {
            self.said.notice(&text);
        });
    }

    fn room(&self, beside: Beside) -> Room {
        Room::of(beside, self.resources.budget)
    }

    /// The case on its own bodies without meshes; none where the store lacks one.
    ///
    /// # Errors
    /// Those of the geometry, and bodies that are no pair.
    fn own_from(&self, prepared: &Prepared) -> Result<Option<Ready>> {
        let Prepared { bodies: [own, coarser], contact_elements: [element, of_coarser], beside } = prepared;
        let (study, room) = (self.study, self.room(*beside));
        let of_pair = self.of_pair();
        let known = |keys: &[String]| {
            let bodies: Vec<_> = of_pair.iter().copied().zip(keys.iter().cloned()).collect();
            if keys.len() != of_pair.len() { Ok(None) } else { self.source(room).known(&bodies) }
        };
        self.with_keys(|| {
            let Some(bodies) = known(own)? else { return Ok(None) };
            let coarser = if study.statics().wants_error_band() {
                let Some(coarser) = known(coarser)? else { return Ok(None) };
                Some((*element, Ok(coarser::Coarser::new(*of_coarser, coarser))))
            } else {
                None
            };
            let geometry = geometry::geometry(study.statics())?;
            Ok(Some(Ready::new(study, room, OnBodies { geometry, bodies, coarser })))
        })
    }

    /// What the case needs to be pressed without its meshes, as the store says or as these tell; the store has it afterwards.
    ///
    /// # Errors
    /// As [`Self::meshed`].
    pub fn prepared(&self) -> Result<Prepared> {
        if let Some(kept) = self.kept() {
            return Ok(kept);
        }
        let prepared = self.prepared_of(&self.meshed()?);
        self.keep(&prepared);
        Ok(prepared)
    }

    /// What is in memory at the same time while the case is made.
    ///
    /// # Errors
    /// As [`Self::meshed`].
    pub fn memory(&self) -> Result<Beside> {
        self.prepared().map(|prepared| prepared.beside)
    }

    /// What the meshes tell. Coarser ones that cannot be made have no bodies: the place says why.
    pub fn prepared_of(&self, meshed: &Meshed) -> Prepared {
        let Meshed { geometry, meshes, .. } = meshed;
        let own_mesh = self.study.rail.mesh.is_none() && self.study.wheel.mesh.is_none();
        let coarser = (self.study.statics().wants_error_band() && own_mesh)
            .then(|| self.coarser(meshed))
            .and_then(Result::ok);
        let keys = |meshes: &Meshes| -> Vec<String> {
            let solids = solids::solids(self.study.statics(), geometry, meshes);
            self.of_pair().iter().map(|body| solids.key(*body)).collect()
        };
        Prepared {
            bodies: [keys(meshes), coarser.as_ref().map(keys).unwrap_or_default()],
            contact_elements: [Some(meshes), coarser.as_ref()]
                .map(|meshes| meshes.map_or(0.0, Meshes::contact_element)),
            beside: meshed.beside,
        }
    }

    /// The bodies of a case that is prepared, with their keys.
    pub fn bodies(&self, prepared: &Prepared) -> Vec<(BodyOfCase, String)> {
        let of = |(keys, coarser): (&Vec<String>, bool)| -> Vec<(BodyOfCase, String)> {
            let bodies = self.of_pair().iter().map(|body| BodyOfCase { coarser, body: *body });
            bodies.zip(keys.iter().cloned()).collect()
        };
        prepared.bodies.iter().zip([false, true]).flat_map(of).collect()
    }

    fn of_pair(&self) -> &'static [PairBody] {
        PairBody::of_pair(self.study.calibration.foot_held)
    }

    /// Condenses one body of the case, unless the store has it.
    ///
    /// # Errors
    /// Those of meshing and condensing.
    pub fn condense(&self, meshed: &Meshed, BodyOfCase { coarser, body }: BodyOfCase) -> Result<()> {
        let meshes = if coarser { &self.coarser(meshed)? } else { &meshed.meshes };
        self.source(self.room(meshed.beside)).one(
            &solids::solids(self.study.statics(), &meshed.geometry, meshes),
            body,
            0,
        )
    }

    fn coarser(&self, Meshed { geometry, meshes, .. }: &Meshed) -> Result<Meshes> {
        let options = coarser::coarser_options(geometry, meshes.options());
        meshes::remeshed_with(self.study.statics(), geometry, meshes, options)
    }

    /// Whether the store has the place at a shift towards the rail (mm), complete.
    fn has_place(&self, shift_mm: f64) -> bool {
        let address = self.settings.address(self.study, shift_mm);
        PlaceRecord::taken(self.store, &address, self.said).is_some()
    }

    /// Those of the shifts towards the rail (mm) at which the store has no place, or all of them if places are made `fresh`.
    pub fn missing(&self, shifts_mm: &[f64], fresh: bool) -> Vec<f64> {
        shifts_mm.iter().copied().filter(|shift| fresh || !self.has_place(*shift)).collect()
    }

    /// The place at a shift towards the rail (mm), kept in the store.
    ///
    /// # Errors
    /// An interruption.
    pub fn place(&self, ready: &Ready, shift_mm: f64) -> Result<PlaceRecord> {
        let Self { study, settings, store, .. } = self;
        let OnBodies { geometry, bodies, coarser } = &ready.on_bodies;
        let fixed_loads: Vec<f64> = settings.stiffness_at_kn.iter().map(|load| load * KILONEWTON).collect();
        let pressed = PlaceSettings {
            direction: settings.direction.into(),
            fixed_loads: &fixed_loads,
            of_thousands: settings.bodies != BodiesKey::Own,
        };
        let shift = shift_mm * MILLIMETRE;
        let coarser = coarser.as_ref().map(|(element, bodies)| (*element, bodies));
        let monitor = self.resources.monitor;
        let at = make::place(study.statics(), geometry, bodies, &pressed, shift, coarser, monitor)?;
        let mut record_of_bodies = ready.bodies.clone();
        if let Some(BodiesRecord { carried: Some(carried), .. }) = &mut record_of_bodies {
            let reference = Reference::from(study.calibration.reference).name();
            carried.widen_at(&at, reference);
            let own = self.on_own(shift_mm);
            carried.own = own.and_then(|own| OwnRecord::of(&at, &own.at, reference));
        }
        let record = PlaceRecord {
            rolling_radius_mm: at
                .touch
                .map(|touch| geometry.pair.wheel.radius / MILLIMETRE + touch.wheel_z_mm),
            hertz_kn_per_m: hertz(study, geometry, bodies, shift, &fixed_loads),
            measured: ready.measured.clone(),
            bodies: record_of_bodies,
            findings_left: geometry.profiles.iter().flat_map(ProfileRecord::left).collect(),
            uncertainty: is_uncertain(study).then(|| self.uncertainty(ready, shift, &at)).transpose()?,
            at,
        };
        let content = serde_json::to_vec(&record).expect("records are plain data");
        let artefact = Artefact::default().with(PLACE, content);
        let address = settings.address(study, shift_mm);
        store.keep(&address, "place of a table", settings.name, &artefact, &|text| self.said.notice(&text));
        Ok(record)
    }

    /// The place on its own bodies, where the store has it ([`CaseWork::check`]).
    fn on_own(&self, shift_mm: f64) -> Option<PlaceRecord> {
        let study = is_checked(self.study, self.settings.bodies).then(|| checking(self.study))?;
        let address = self.settings.on_own().address(&study, shift_mm);
        PlaceRecord::taken(self.store, &address, self.said)
    }

    /// The uncertainty of a place by the inputs, at the fixed loads that it carries.
    fn uncertainty(&self, ready: &Ready, shift: f64, at: &ShiftRecord) -> Result<PlaceUncertainty> {
        let (statics, OnBodies { geometry, bodies, .. }) = (self.study.statics(), &ready.on_bodies);
        let without = |reason: &str| PlaceUncertainty { loads: Vec::new(), missing: Some(reason.into()) };
        if self.settings.direction == DirectionKey::Normal {
            return Ok(without("samples are pressed vertically"));
        }
        let loads_kn: Vec<f64> = at.loads.iter().map(|load| load.force_kn).collect();
        if loads_kn.is_empty() {
            return Ok(without("the place carries no load"));
        }
        let loads: Vec<f64> = loads_kn.iter().map(|load| load * KILONEWTON).collect();
        let found = match geometry.pair.with_wheel_at(tape_y(statics, &geometry.pair, shift)) {
            Ok(pair) => uncertainty::at_loads(statics, &pair, bodies, &loads, self.resources.monitor)?,
            Err(reason) => Err(reason.to_string()),
        };
        Ok(match found {
            Ok(bands) => PlaceUncertainty { loads: loads_kn.into_iter().zip(bands).collect(), missing: None },
            Err(reason) => without(&reason),
        })
    }

    /// Whether the store keeps rail and wheel of the case: there are as many of measured profiles as files.
    fn keeps(&self) -> [bool; 2] {
        let [rail, wheel] = wanted_on_standards(self.study, self.settings.bodies);
        [!(rail || self.lets_go[0]), !(wheel || self.lets_go[1])]
    }

    /// Whether it keeps both.
    fn keeps_bodies(&self) -> bool {
        self.keeps() == [true; 2]
    }

    fn source(&self, room: Room) -> BodySource<'_> {
        BodySource {
            store: Some(self.store),
            keeps: self.keeps(),
            fresh: false,
            beside: self.beside,
            foot_held: self.study.calibration.foot_held,
            // the nominal bodies take memory beside these
            together: room.condensing && self.keeps_bodies(),
            study: &self.study.name,
            monitor: self.resources.monitor,
            trouble: Some(self.said),
        }
    }

    /// What `make` makes; what is wrong with the study is said by its keys.
    fn with_keys<T>(&self, make: impl FnOnce() -> Result<T>) -> Result<T> {
        make().map_err(|error| match error {
            Error::Input(input) => self.study.source.with_keys(input).into(),
            other => other,
        })
    }
}

/// A case up to its meshes.
pub(super) struct Meshed {
    geometry: Geometry,
    meshes: Meshes,
    beside: Beside,
}

/// A case up to its condensed bodies.
pub(super) struct Ready {
    room: Room,
    on_bodies: OnBodies,
    measured: Option<Arc<MeasuredRecord>>,
    bodies: Option<BodiesRecord>,
}

impl Ready {
    /// That of a case on its own bodies.
    fn new(study: &Study, room: Room, on_bodies: OnBodies) -> Self {
        let (statics, geometry) = (study.statics(), &on_bodies.geometry);
        let measured = MeasuredRecord::of(statics, geometry).map(Arc::new);
        let bodies = measured.is_some().then_some(BodiesRecord::OWN);
        Self { room, on_bodies, measured, bodies }
    }

    /// Its condensed bodies.
    pub fn bodies(&self) -> &CondensedPair {
        &self.on_bodies.bodies
    }

    /// What there is room for at the same time.
    pub fn room(&self) -> Room {
        self.room
    }
}

/// What a meshed case needs to be pressed elsewhere without its meshes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Prepared {
    /// Keys of the bodies of its meshes, and of those of coarser ones, each in the order of [`PairBody::of_pair`].
    bodies: [Vec<String>; 2],
    /// Larger edges of their contact elements, m.
    contact_elements: [f64; 2],
    /// What is in memory at the same time while the pair is made.
    beside: Beside,
}

/// Tangent stiffness of Hertz's contact of the profiles at a shift (m), with the radii of curvature at the first touch, under normal forces
/// as large as the loads (N), kN/m.
fn hertz(study: &Study, geometry: &Geometry, bodies: &CondensedPair, shift: f64, loads: &[f64]) -> Vec<f64> {
    let Ok(pair) = geometry.pair.with_wheel_at(tape_y(study.statics(), &geometry.pair, shift)) else {
        return Vec::new();
    };
    let [along, across] = pair.relative_radii();
    let modulus = bodies.rail_on_ends.surface.contact_modulus(&bodies.wheel.surface);
    let tangent = |load: &f64| {
        let contact = point_contact(*load, along, across, modulus)?;
        Ok(contact.tangent_stiffness / KILONEWTON_PER_METRE)
    };
    loads.iter().map(tangent).collect::<Result<_>>().unwrap_or_default()
}
