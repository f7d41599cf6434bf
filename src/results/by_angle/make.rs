//! The law by contact angle: the calibration's bodies with the wheel in other places across the track.

use nalgebra::Matrix2;
use railspring_calibrate::calibration::{ContactField, LoadPoint, NormalCalibration, Reference, Region};
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::pair::{
    AngleLaw, AngleSettings, CondensedPair, FixedLoad, PressDirection, ShiftLaw, TouchPoint,
    changed_by_shift, law_by_shift,
};
use railspring_element::pair_element::PairElement;
use railspring_profiles::error::{Error, Result, StopReason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::{
    KILONEWTON, KILONEWTON_PER_METRE, MEGAPASCAL, MILLIMETRE, SQUARE_MILLIMETRE,
};
use railspring_simulate::element::condensed::parts::{ElementBodies, LumpedElement, PlaceApproaches};
use railspring_simulate::element::condensed::{CondensedModel, fitted_element, fitted_lumped};
use railspring_simulate::element::published::{HubStatics, MovingModel, WheelSprings};

use crate::results::bodies::coarser::{CoarserBodies, bodies_of};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::places::{loads_by_angle, shifts, tape_y};
use crate::results::by_angle::element::{ElementRecord, HubDeviationRecord};
use crate::results::by_angle::input::ByAngleInput;
use crate::results::by_angle::lumped::{LumpedBandRecord, LumpedConstantsRecord, LumpedRecord};
use crate::results::by_angle::record::{
    AngleLawRecord, ContactRecord, FixedLoadRecord, FixedReferenceRecord, PatchBandRecord, ShiftRecord,
    ShiftTouchRecord, StiffnessByAngleRecord,
};
use crate::results::springs::band_record::ErrorBandRecord;
use crate::results::springs::error_band::band_record;
use crate::results::springs::make::{
    MICROMETRE_PER_KILONEWTON, contact_conditions, form_records, law_record, subsurface_values,
};
use crate::results::springs::record::StiffnessRecord;
use crate::study::{Statics, with_keys};
use crate::version;

/// The laws of the pair at the shifts of the study on the condensed bodies of its calibration, with their
/// error bands where the study wants them. The statics of both contact elements stand beside them, those of
/// the published one with the calibrated springs `stiffness`. `coarser` has the edge of the contact elements
/// of those bodies, m, and the bodies of coarser meshes or the reason why there are none.
///
/// # Errors
/// Loads that cannot be used, an interruption, and those of `coarser`; a shift without a law is an entry with its reason, and so is a
/// part of a band.
pub fn by_angle(
    input: &ByAngleInput<'_>,
    geometry: &Geometry,
    bodies: &CondensedPair,
    stiffness: &StiffnessRecord,
    coarser: impl FnOnce() -> Result<(f64, CoarserBodies)>,
    monitor: &dyn Monitor,
) -> Result<StiffnessByAngleRecord> {
    let (statics, pair) = (input.statics, &geometry.pair);
    let shifts = shifts(statics, input.shifts, pair);
    let loads = loads_by_angle(statics);
    let settings = AngleSettings {
        contact: contact_conditions(statics),
        direction: PressDirection::Normal,
        loads: &loads,
        fixed_loads: &statics.calibration.fixed_loads,
        stresses: true,
    };
    let places: Vec<f64> = shifts.iter().map(|shift| tape_y(statics, pair, *shift)).collect();
    let laws = law_by_shift(pair, bodies, &settings, &places, monitor)?;
    let coarser = statics.wants_error_band().then(coarser).transpose()?;
    let bands = match &coarser {
        Some((element, coarser)) => bands(geometry, bodies, (*element, coarser), &settings, &laws, monitor)?,
        None => vec![None; laws.len()],
    };
    let elements = input.modes.is_some().then(|| -> Result<_> {
        let places: Vec<PlaceApproaches> = laws.iter().filter_map(PlaceApproaches::of).collect();
        let beam = (&geometry.beam, statics.materials());
        let friction = statics.contact.friction;
        let bodies = ElementBodies::new(pair, bodies, geometry.beam.length())?;
        let element = fitted_element(&bodies, beam, places.clone(), friction)?;
        let band = coarser.as_ref().map(|(_, coarser)| lumped_band(geometry, &bodies, coarser));
        Ok((element, fitted_lumped(&bodies, beam, places, friction)?, band))
    });
    let (element, lumped, element_missing) = match elements {
        Some(Ok((element, lumped, band))) => (Some(element), Some((lumped, band)), None),
        Some(Err(reason)) => (None, None, Some(reason.to_string())),
        None => (None, None, None),
    };
    let entries = shifts.iter().zip(laws.into_iter().zip(bands));
    let mut records: Vec<ShiftRecord> =
        entries.map(|(shift, (law, band))| shift_record(*shift, law, band)).collect();
    let springs = published_springs(stiffness);
    let published = springs.as_ref().map(|springs| (springs, stiffness.wheel_mass()));
    let of_lumped = lumped.as_ref().map(|(lumped, _)| PairElement::from(lumped));
    let of_solids = [element.as_ref(), of_lumped.as_ref()];
    enter_statics(statics, geometry, (&mut records, &places), of_solids, published)?;
    let displacement = farthest(&records, |load| load.condensed_displacement_mm);
    let of_lumped = farthest(&records, |load| load.lumped_displacement_mm);
    Ok(StiffnessByAngleRecord {
        study: String::new(),
        friction: statics.contact.friction,
        element: element
            .as_ref()
            .map(|element| ElementRecord { displacement, ..ElementRecord::from(element) }),
        lumped: lumped.map(|(lumped, error_band)| LumpedRecord {
            displacement: of_lumped,
            error_band,
            ..LumpedRecord::from(&lumped)
        }),
        element_missing,
        shifts: records,
        pair: statics.pair(),
        // the stage knows with which contact zones
        input_hash: String::new(),
        version: env!("CARGO_PKG_VERSION").into(),
        commit: version::COMMIT.into(),
        content_blake3: String::new(),
    })
}

/// Along what the wheel of a place is pressed, and at which loads (N, ascending) displacement and stiffness are given.
#[derive(Debug, Clone, Copy)]
pub struct PlaceSettings<'a> {
    /// The direction.
    pub direction: PressDirection,
    /// The loads, within the range of the study's.
    pub fixed_loads: &'a [f64],
    /// Whether it is one of thousands of places: on a wider grid, and without the stresses below the patches, of which it has no columns.
    pub of_thousands: bool,
}

/// The law of the pair under the loads of the study at one shift (m) of the wheelset, on condensed bodies; with its error band where there
/// is `coarser`, the edge of their contact elements (m) and the bodies of coarser meshes. A place without a law has its reason.
///
/// # Errors
/// Loads that cannot be used, and an interruption.
pub fn place(
    statics: Statics<'_>,
    geometry: &Geometry,
    bodies: &CondensedPair,
    &PlaceSettings { direction, fixed_loads, of_thousands }: &PlaceSettings,
    shift: f64,
    coarser: Option<(f64, &CoarserBodies)>,
    monitor: &dyn Monitor,
) -> Result<ShiftRecord> {
    let pair = &geometry.pair;
    let loads = &statics.calibration.loads;
    let mut contact = contact_conditions(statics);
    if of_thousands && contact.field.is_fine() {
        contact.field = ContactField::HybridWider;
    }
    let settings = AngleSettings { contact, direction, loads, fixed_loads, stresses: !of_thousands };
    let laws = law_by_shift(pair, bodies, &settings, &[tape_y(statics, pair, shift)], monitor)?;
    let bands =
        coarser.map(|coarser| bands(geometry, bodies, coarser, &settings, &laws, monitor)).transpose()?;
    let law = laws.into_iter().next().expect("one place has one law");
    Ok(shift_record(shift, law, bands.and_then(|mut bands| bands.remove(0))))
}

/// Error bands of laws at the fixed loads, on a finer grid, on the bodies of coarser meshes and by the scatter of measured profiles.
///
/// # Errors
/// An interruption.
fn bands(
    geometry: &Geometry,
    bodies: &CondensedPair,
    (element, coarser): (f64, &CoarserBodies),
    settings: &AngleSettings,
    laws: &[ShiftLaw],
    monitor: &dyn Monitor,
) -> Result<Vec<Option<ErrorBandRecord>>> {
    let Geometry { pair, replicates, profiles, .. } = geometry;
    let changed = changed_by_shift(pair, bodies, bodies_of(coarser), replicates, settings, laws, monitor)?;
    let band = |(points, changed): (_, _)| band_record(&points, changed, element, (coarser, profiles));
    Ok(changed.into_iter().map(|changed| changed.map(band)).collect())
}

/// Error band of the constants of the lumped element, by the bodies of coarser meshes beside its own.
fn lumped_band(geometry: &Geometry, bodies: &ElementBodies<'_>, coarser: &CoarserBodies) -> LumpedBandRecord {
    let changes = match coarser {
        Ok(coarser) => ElementBodies::new(&geometry.pair, &coarser.bodies, geometry.beam.length())
            .map_err(|reason| reason.to_string())
            .and_then(|coarser| {
                let changes = bodies.lumped_set().changes_to(&coarser.lumped_set());
                changes.ok_or_else(|| "coarser bodies have another number of oscillators".into())
            }),
        Err(reason) => Err(reason.clone()),
    };
    LumpedBandRecord {
        coarser_element_mm: coarser.as_ref().ok().map(|coarser| coarser.contact_element / MILLIMETRE),
        missing: changes.as_ref().err().cloned(),
        constants: changes.ok().as_ref().map(LumpedConstantsRecord::from),
    }
}

fn shift_record(
    shift: f64,
    ShiftLaw { touch, law, .. }: ShiftLaw,
    error_band: Option<ErrorBandRecord>,
) -> ShiftRecord {
    let shift_mm = shift / MILLIMETRE;
    let touch = touch.map(touch_record);
    let entries = |law: AngleLaw| {
        let laws = law.laws.iter().map(|(_, law)| law_entry(law)).collect::<Result<Vec<_>>>()?;
        Ok((laws, law))
    };
    match law.and_then(entries) {
        Ok((laws, AngleLaw { fixed, ended, shared_from, .. })) => ShiftRecord {
            shift_mm,
            touch,
            laws,
            shared_from_kn: shared_from.map(|load| load / KILONEWTON),
            published_secant_ratio: published_secant_ratio(&fixed),
            loads: fixed.iter().map(load_record).collect(),
            error_band,
            reason: ended.map(|error| reason(shift_mm, error)),
        },
        Err(error) => ShiftRecord {
            shift_mm,
            touch,
            laws: Vec::new(),
            shared_from_kn: None,
            loads: Vec::new(),
            published_secant_ratio: None,
            error_band: None,
            reason: Some(reason(shift_mm, error)),
        },
    }
}

/// Why a shift has no law, or its law ends early, and what can be done about it.
fn reason(shift_mm: f64, error: Error) -> String {
    match error {
        Error::Numerics(cause) => {
            let advice = match cause.reason {
                StopReason::EndOfWindow => {
                    "; a longer patch needs a larger `mesh.window_half_length_mm`, or a smaller `calibration.load_max_kn`"
                }
                StopReason::EdgeOfCandidates => {
                    "; the contact leaves the contact zones of the meshes here: leave this shift out"
                }
                _ => "; try a shift beside it, or a finer mesh in `mesh.contact_element_mm`",
            };
            format!("{cause}{advice}")
        }
        Error::Input(mut cause) if cause.key == "lateral_shift" => {
            cause.key = "calibration.shifts_mm".into();
            cause.value = format!("{shift_mm} mm, {}", cause.value);
            let what = cause.remedy.split(';').next().unwrap_or_default();
            cause.remedy = format!("{what}; leave this shift out");
            cause.to_string()
        }
        Error::Input(cause) => with_keys(cause).to_string(),
        other => other.to_string(),
    }
}

/// Secant stiffness against the foot between the ends of the range of the publication, over that of its law.
fn published_secant_ratio(fixed: &[FixedLoad]) -> Option<f64> {
    /// The range, N.
    const RANGE: [f64; 2] = [20e3, 120e3];
    let displacement = |load: f64| {
        let mut points = fixed.iter().filter_map(|fixed| fixed.points.foot.as_ref());
        points.find(|point| point.force == load).map(|point| point.displacement)
    };
    let [from, to] = RANGE;
    let published = StiffnessLaw::published();
    Some(
        (published.displacement(to) - published.displacement(from))
            / (displacement(to)? - displacement(from)?),
    )
}

fn touch_record(TouchPoint { touch, on_rail, on_wheel, .. }: TouchPoint) -> ShiftTouchRecord {
    ShiftTouchRecord {
        contact_angle_deg: touch.contact_angle.to_degrees(),
        rail_y_mm: on_rail.x / MILLIMETRE,
        rail_z_mm: on_rail.y / MILLIMETRE,
        wheel_y_mm: on_wheel.x / MILLIMETRE,
        wheel_z_mm: on_wheel.y / MILLIMETRE,
    }
}

fn law_entry(calibration: &NormalCalibration) -> Result<AngleLawRecord> {
    Ok(AngleLawRecord {
        reference: calibration.reference.name().into(),
        law: law_record(&calibration.fit),
        forms: form_records(calibration)?,
    })
}

fn contact_record(contact: &Region) -> ContactRecord {
    ContactRecord {
        force_kn: contact.force / KILONEWTON,
        // the normal points out of the rail, and z down
        contact_angle_deg: (-contact.normal.x).atan2(-contact.normal.y).to_degrees(),
    }
}

/// Where the displacement of an element's hub, mm, is farthest from the solid's.
fn farthest(
    records: &[ShiftRecord],
    of_element: impl Fn(&FixedLoadRecord) -> Option<f64>,
) -> Option<HubDeviationRecord> {
    let beam = |load: &FixedLoadRecord| load.reference(Reference::Beam.name()).map(|at| at.displacement_mm);
    let of_place = |record: &ShiftRecord| -> Vec<HubDeviationRecord> {
        let Some(whole) = record.loads.last().and_then(beam) else { return Vec::new() };
        let deviation = |load: &FixedLoadRecord| {
            Some(HubDeviationRecord {
                max_rel_error: (of_element(load)? - beam(load)?).abs() / whole,
                shift_mm: record.shift_mm,
                force_kn: load.force_kn,
            })
        };
        record.loads.iter().filter_map(deviation).collect()
    };
    records.iter().flat_map(of_place).max_by(|a, b| a.max_rel_error.total_cmp(&b.max_rel_error))
}

/// Lateral, lateral with vertical, and vertical flexibility.
fn hub_values(flexibility: &Matrix2<f64>) -> [f64; 3] {
    [(0, 0), (0, 1), (1, 1)].map(|at| flexibility[at] / MICROMETRE_PER_KILONEWTON)
}

/// Flexibility, µm/kN, and displacement, mm, of a hub.
fn hub_statics(at: HubStatics) -> ([f64; 3], f64) {
    (hub_values(&at.flexibility), at.displacement / MILLIMETRE)
}

/// Enters the statics of the hubs of both contact elements under the fixed loads of shifts, where they carry
/// them. The tape circle is at `places` (y, m). The published element has its springs and the mass of its
/// wheel (kg). Its values stay unchanged without springs.
fn enter_statics(
    statics: Statics<'_>,
    geometry: &Geometry,
    (records, places): (&mut [ShiftRecord], &[f64]),
    of_solids: [Option<&PairElement>; 2],
    published: Option<(&WheelSprings, f64)>,
) -> Result<()> {
    let (materials, friction) = (statics.materials(), statics.contact.friction);
    for (record, tape_y) in records.iter_mut().zip(places).filter(|(record, _)| record.touch.is_some()) {
        let pair = geometry.pair.with_wheel_at(*tape_y)?;
        let along = *PressDirection::Normal.at(&pair);
        let beam = || geometry.beam.clone();
        let [condensed, lumped] = of_solids.map(|element| {
            element.map(|element| CondensedModel::of_pair(&pair, beam(), materials, element.clone()))
        });
        let published = published
            .map(|(springs, mass)| MovingModel::of_pair(&pair, beam(), materials, springs.clone(), mass));
        for load in &mut record.loads {
            let force = load.force_kn * KILONEWTON;
            let pressed = |model: &Option<CondensedModel>| {
                let of = model.as_ref()?.pressed(along, force, friction).ok()?;
                Some(hub_statics(of))
            };
            (load.condensed_hub_um_per_kn, load.condensed_displacement_mm) = pressed(&condensed).unzip();
            (load.lumped_hub_um_per_kn, load.lumped_displacement_mm) = pressed(&lumped).unzip();
            let Some(model) = &published else { continue };
            let of = model.pressed(along, force, friction).ok();
            (load.published_hub_um_per_kn, load.published_displacement_mm) = of.map(hub_statics).unzip();
        }
    }
    Ok(())
}

/// Laws with the statics of another condensed element in the place of theirs.
///
/// # Errors
/// Shifts at which the wheel misses the rail.
pub fn with_element(
    statics: Statics<'_>,
    geometry: &Geometry,
    laws: &StiffnessByAngleRecord,
    element: &PairElement,
) -> Result<StiffnessByAngleRecord> {
    let mut laws = laws.clone();
    let place = |shift: &ShiftRecord| tape_y(statics, &geometry.pair, shift.shift_mm * MILLIMETRE);
    let places: Vec<f64> = laws.shifts.iter().map(place).collect();
    let lumped = laws.lumped.as_ref().map(|lumped| PairElement::from(&LumpedElement::from(lumped)));
    let of_solids = [Some(element), lumped.as_ref()];
    enter_statics(statics, geometry, (&mut laws.shifts, &places), of_solids, None)?;
    let displacement = farthest(&laws.shifts, |load| load.condensed_displacement_mm);
    laws.element = Some(ElementRecord { displacement, ..ElementRecord::from(element) });
    Ok(laws)
}

/// The springs of the published element, if the calibration has them: the law against the rail's section and the horizontal stiffness.
fn published_springs(stiffness: &StiffnessRecord) -> Option<WheelSprings> {
    let beam = stiffness.references.iter().find(|law| law.reference == Reference::Beam.name())?;
    let horizontal = stiffness.horizontal_kn_per_m? * KILONEWTON_PER_METRE;
    let normal = StiffnessLaw::try_from(beam.law.constants).ok()?.into();
    Some(WheelSprings { horizontal, normal, longitudinal: horizontal })
}

fn load_record(fixed: &FixedLoad) -> FixedLoadRecord {
    let beam = &fixed.points.beam;
    let reference = |(reference, p): (Reference, &LoadPoint)| {
        let body = |part: f64| {
            matches!(reference, Reference::Foot | Reference::Beam).then_some(part / MICROMETRE_PER_KILONEWTON)
        };
        FixedReferenceRecord {
            reference: reference.name().into(),
            displacement_mm: p.displacement / MILLIMETRE,
            tangent_kn_per_m: p.solid_tangent / KILONEWTON_PER_METRE,
            local_um_per_kn: p.local_compliance / MICROMETRE_PER_KILONEWTON,
            wheel_um_per_kn: body(p.wheel_compliance),
            rail_um_per_kn: body(p.rail_compliance),
            sliding_um_per_kn: body(p.sliding_compliance),
        }
    };
    let [max_von_mises_mpa, von_mises_depth_mm, max_shear_mpa, shear_depth_mm] =
        subsurface_values(&fixed.patch);
    FixedLoadRecord {
        force_kn: beam.force / KILONEWTON,
        references: fixed.points.iter().map(reference).collect(),
        contacts: fixed.contacts.iter().map(contact_record).collect(),
        hub_um_per_kn: hub_values(&fixed.flexibility),
        condensed_hub_um_per_kn: None,
        condensed_displacement_mm: None,
        lumped_hub_um_per_kn: None,
        lumped_displacement_mm: None,
        published_hub_um_per_kn: None,
        published_displacement_mm: None,
        horizontal_kn_per_m: fixed.horizontal_stiffness / KILONEWTON_PER_METRE,
        tangential_kn_per_m: fixed.tangential_stiffness / KILONEWTON_PER_METRE,
        lateral_contact_um_per_kn: Some(fixed.lateral_contact / MICROMETRE_PER_KILONEWTON),
        contact_area_mm2: fixed.patch.area / SQUARE_MILLIMETRE,
        max_pressure_mpa: fixed.patch.max_pressure / MEGAPASCAL,
        semi_axis_along_mm: fixed.patch.semi_axis_along / MILLIMETRE,
        semi_axis_across_mm: fixed.patch.semi_axis_across / MILLIMETRE,
        max_von_mises_mpa,
        von_mises_depth_mm,
        max_shear_mpa,
        shear_depth_mm,
        patch_error_band: fixed.patch_band.map(|band| PatchBandRecord {
            contact_area: band.area,
            max_pressure: band.max_pressure,
            von_mises: band.mises.stress,
            von_mises_depth: band.mises.depth,
            shear: band.shear.stress,
            shear_depth: band.shear.depth,
        }),
    }
}
