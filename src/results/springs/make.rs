//! The calibration: superelements, load curve, laws, horizontal stiffness.

use std::sync::Arc;

use nalgebra::Matrix2;
use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::calibration::{
    HorizontalCalibration, LoadPoint, NormalCalibration, Patch, PatchBand, PatchValues, Reference,
};
use railspring_calibrate::contact::{Peak, Subsurface};
use railspring_calibrate::law::LawFit;
use railspring_calibrate::mesh::{HexMesh, quality};
use railspring_calibrate::pair::{CondensedPair, ContactConditions, Laws, PairBody, PairStates, SeriesBeam};
use railspring_calibrate::superelement::CondensedBody;
use railspring_profiles::error::{Error, InputError, Result, unless_interrupted};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::{
    GIGAPASCAL, KILONEWTON, KILONEWTON_PER_METRE, MEGAPASCAL, MILLIMETRE, SQUARE_MILLIMETRE,
};

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::mesh_files::named;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::record::BodyMeshRecord;
use crate::results::bodies::solids::{rail_in_use, solids};
use crate::results::bodies::touch::{HertzRecord, TouchRecord};
use crate::results::patches::make::{chosen, patch_record};
use crate::results::patches::record::PatchesRecord;
use crate::results::springs::fields::{FieldFile, PressedSolids, field_files};
use crate::results::springs::form::FormRecord;
use crate::results::springs::law::LawConstants;
use crate::results::springs::record::{
    BeamRecord, BoundRecord, ComplianceRecord, HorizontalPointRecord, HorizontalRecord, LawRecord,
    LoadCurveRow, LoadEndRecord, PenaltyRecord, ReferenceRecord, StiffnessRecord, SubsurfaceBandRecord,
    SubsurfaceRecord, TangentRecord,
};
use crate::rounding::significant;
use crate::study::{EnforcementKey, MeshFile, OutputKeys, Statics};
use crate::version;

/// One m/N in µm/kN.
pub(crate) const MICROMETRE_PER_KILONEWTON: f64 = 1e-9;

/// The springs as they were found, for their error bands.
pub struct FittedSprings {
    /// The laws.
    pub laws: Laws,
    /// The horizontal stiffness; none where there is no answer.
    pub horizontal: Option<HorizontalCalibration>,
}

/// A pair under the loads of a study, with its laws and its horizontal stiffness. It borrows nothing.
pub struct PressedStudy {
    beam: SeriesBeam,
    states: Arc<PairStates>,
    found: FittedSprings,
    horizontal_failure: Option<Error>,
    /// Why there are not all loads, preloads or springs.
    ended: Option<Error>,
}

impl PressedStudy {
    /// The springs as they were found.
    pub fn found(&self) -> &FittedSprings {
        &self.found
    }

    /// Why laws or horizontal stiffness end before their largest load, or why there is no horizontal stiffness.
    pub fn ended(&self) -> Option<&Error> {
        self.ended.as_ref()
    }
}

/// What the calibration hands on.
pub struct Calibration {
    /// `stiffness.json`.
    pub stiffness: StiffnessRecord,
    /// `load_curve.csv`.
    pub load_curve: Vec<LoadCurveRow>,
    /// `contact_patches.json`.
    pub patches: PatchesRecord,
    /// Why the horizontal stiffness is missing, if it is.
    pub horizontal_failure: Option<Error>,
}

impl Calibration {
    /// One that was kept: a store and an output folder keep what is finished, with the reasons of what is not in its record.
    pub fn kept(stiffness: StiffnessRecord, load_curve: Vec<LoadCurveRow>, patches: PatchesRecord) -> Self {
        Self { stiffness, load_curve, patches, horizontal_failure: None }
    }
}

/// Refuses a calibration without friction.
///
/// # Errors
/// [`InputError`] with the key.
pub fn check_friction(statics: Statics<'_>) -> Result<()> {
    if statics.contact.friction == 0.0 {
        return Err(InputError::new(
            "contact.friction",
            "0",
            "a positive coefficient: the horizontal stiffness is that of a sticking wheel",
            "give the coefficient of the pair; a load case may have its own, 0 too, in scenario.NAME.friction",
        )
        .into());
    }
    Ok(())
}

/// How wheel and rail meet in the calibration of a study.
pub fn contact_conditions(statics: Statics<'_>) -> ContactConditions {
    let (enforcement, field) = statics.contact.of_solids();
    ContactConditions { friction: statics.contact.friction, enforcement, field }
}

/// The pair under the loads of a study: the laws and the horizontal stiffness.
///
/// Laws and a horizontal stiffness that end before the largest load, and a horizontal stiffness without an answer, are no error here: what
/// is finished is worth keeping.
///
/// # Errors
/// A load that cannot be carried, a rail too short to be a beam, and numerics without an answer.
pub fn press(
    statics: Statics<'_>,
    geometry: &Geometry,
    bodies: &CondensedPair,
    monitor: &dyn Monitor,
) -> Result<PressedStudy> {
    let pair = &geometry.pair;
    let beam = SeriesBeam::new(pair, bodies, &geometry.beam)?;
    let contact = contact_conditions(statics);
    let pressed = bodies.press(pair, contact, &statics.calibration.loads, monitor)?;
    let laws = pressed.laws()?;
    let reference = Reference::from(statics.calibration.reference);
    let horizontal = pressed.horizontal(reference, &statics.calibration.horizontal_preloads, monitor);
    let (horizontal, horizontal_failure) = match unless_interrupted(horizontal)? {
        Ok(horizontal) => (Some(horizontal), None),
        Err(failure) => (None, Some(failure)),
    };
    let horizontal_end = horizontal.as_ref().and_then(|horizontal| horizontal.ended.clone());
    let ended = pressed.ended().cloned().or(horizontal_failure.clone()).or(horizontal_end);
    let (states, found) = (pressed.into_states(), FittedSprings { laws, horizontal });
    Ok(PressedStudy { beam, states, found, horizontal_failure, ended })
}

/// The load curve, the laws and the horizontal stiffness as records, and the files of the fields.
///
/// # Errors
/// Numerics without an answer.
pub fn calibrate(
    (statics, output): (Statics<'_>, &OutputKeys),
    geometry: &Geometry,
    meshes: &Meshes,
    bodies: &CondensedPair,
    pressed: &PressedStudy,
) -> Result<(Calibration, Vec<FieldFile>)> {
    let pair = &geometry.pair;
    let PressedStudy { beam, states, found: FittedSprings { laws, horizontal }, horizontal_failure, .. } =
        pressed;
    let pressed = bodies.pressed(pair, contact_conditions(statics), states.clone());
    let reference = Reference::from(statics.calibration.reference);
    let in_use = laws.get(reference).expect("the law in use is made");
    let in_series = (reference != Reference::Foot).then_some(beam);
    let states = pressed.states(reference)?;
    let pressed_solids = PressedSolids {
        states,
        bodies: [(rail_in_use(statics), bodies.rail(reference)?), (PairBody::Wheel, &bodies.wheel)],
        solids: solids(statics, geometry, meshes),
        carried: in_series.map_or_else(Matrix2::zeros, |beam| beam.solid),
    };
    let fields = field_files(&pressed_solids, geometry, meshes, output)?;
    let stiffness = horizontal.as_ref().map(|h| h.stiffness);
    let [of_rail, of_wheel] = meshes.contact_elements;
    let measured = pressed.patches(reference)?;
    let record = StiffnessRecord {
        study: String::new(),
        reference: reference.name().into(),
        law: law_record(&in_use.fit),
        law_end: pressed.ended().map(|reason| load_end(&statics.calibration.loads, states.len(), reason)),
        horizontal_kn_per_m: stiffness.map(|k| k / KILONEWTON_PER_METRE),
        horizontal: horizontal.as_ref().map(horizontal_record),
        horizontal_end: horizontal.as_ref().and_then(|horizontal| {
            let preloads = &statics.calibration.horizontal_preloads;
            horizontal.ended.as_ref().map(|reason| load_end(preloads, horizontal.points.len(), reason))
        }),
        horizontal_missing: horizontal_failure.as_ref().map(ToString::to_string),
        beam: beam_record(beam, geometry, &laws.beam, stiffness.filter(|_| in_series.is_some())),
        references: laws.iter().map(|(_, law)| reference_record(law)).collect::<Result<_>>()?,
        error_band: None,
        assumed: None,
        input_uncertainty: None,
        compliance_split: in_use.points.iter().map(|p| compliance_record(p, in_series)).collect(),
        subsurface: in_use.points.iter().zip(&measured).filter_map(subsurface_record).collect(),
        penalty: PenaltyRecord {
            enforcement: match statics.contact.enforcement {
                EnforcementKey::Exact => "exact",
                EnforcementKey::Penalty => "penalty",
            }
            .into(),
            penalty_kn_per_m: statics.contact.penalty / KILONEWTON_PER_METRE,
            penetration_over_displacement: (statics.contact.enforcement == EnforcementKey::Penalty)
                .then(|| in_use.points.iter().map(|p| p.penalty_error).fold(0.0, f64::max)),
        },
        mesh: vec![
            mesh_record("rail", &meshes.rail, &statics.rail.mesh, of_rail, &bodies.rail_on_ends)?,
            mesh_record("wheel", &meshes.wheel, &statics.wheel.mesh, of_wheel, &bodies.wheel)?,
        ],
        profiles: geometry.profiles.clone(),
        touch: touch_record(geometry, bodies),
        pair: statics.pair(),
        // the stage knows its address
        input_hash: String::new(),
        version: env!("CARGO_PKG_VERSION").into(),
        commit: version::COMMIT.into(),
        content_blake3: String::new(),
    };
    let row = |(point, patch)| load_curve_row(reference, point, &in_use.fit, patch);
    let load_curve = in_use.points.iter().zip(&measured).map(row).collect();
    let poisson = statics.rail.material.poisson;
    let patch = |index: usize| patch_record(pair, &states[index], &measured[index], poisson);
    let patches = PatchesRecord {
        study: String::new(),
        reference: reference.name().into(),
        field: statics.contact.field.name().into(),
        friction: statics.contact.friction,
        patches: chosen(states.len()).into_iter().map(patch).collect(),
        // the stage knows its address
        input_hash: String::new(),
        version: env!("CARGO_PKG_VERSION").into(),
    };
    let horizontal_failure = horizontal_failure.clone();
    Ok((Calibration { stiffness: record, load_curve, patches, horizontal_failure }, fields))
}

/// The springs as they were found, before their error bands, in a line.
pub fn law_so_far(statics: Statics<'_>, found: &FittedSprings) -> String {
    let reference = Reference::from(statics.calibration.reference);
    let law = found.laws.get(reference).map(|law| law.fit.law);
    let law = law.map_or_else(String::new, |law| {
        let LawConstants { a_kn_per_m, b_kn_per_m, c, f0_kn } = law.into();
        let [a, b, c] = [a_kn_per_m, b_kn_per_m, c].map(|value| significant(value, 4));
        format!("k(f) = {a} + {b}\u{b7}(f/{f0_kn} kN)^{c} kN/m against {}", reference.name())
    });
    let horizontal = found.horizontal.as_ref().map_or_else(
        || "no horizontal stiffness".to_owned(),
        |h| format!("k_h = {} kN/m", significant(h.stiffness / KILONEWTON_PER_METRE, 4)),
    );
    format!("law: {law}, {horizontal}; error bands and laws by contact angle follow")
}

/// The end of ascending `loads` (N) after the first `carried` ones.
fn load_end(loads: &[f64], carried: usize, reason: &Error) -> LoadEndRecord {
    LoadEndRecord {
        loads_left_out: loads.len() - carried,
        largest_wanted_kn: loads.last().map_or(f64::NAN, |load| load / KILONEWTON),
        reason: reason.to_string(),
    }
}

/// `horizontal` is the stiffness in series with the beam, N/m.
fn beam_record(
    beam: &SeriesBeam,
    geometry: &Geometry,
    law: &NormalCalibration,
    horizontal: Option<f64>,
) -> BeamRecord {
    let stiffest = law.points.iter().map(|p| p.solid_tangent).fold(0.0, f64::max);
    let diagonal = |m: &Matrix2<f64>| [m[(0, 0)], m[(1, 1)]].map(|v| v / MICROMETRE_PER_KILONEWTON);
    BeamRecord {
        length_m: geometry.beam.length(),
        factors: beam.correction.into(),
        solid_um_per_kn: diagonal(&beam.solid),
        uncorrected_um_per_kn: diagonal(&beam.uncorrected),
        corrected_um_per_kn: diagonal(&beam.corrected),
        missing: beam.missing(1, stiffest).max(horizontal.map_or(0.0, |k| beam.missing(0, k))),
    }
}

fn horizontal_record(horizontal: &HorizontalCalibration) -> HorizontalRecord {
    let stiffnesses = horizontal.points.iter().map(|p| p.stiffness);
    HorizontalRecord {
        relative_spread: (stiffnesses.clone().fold(f64::NEG_INFINITY, f64::max)
            - stiffnesses.fold(f64::INFINITY, f64::min))
            / horizontal.stiffness,
        points: horizontal
            .points
            .iter()
            .map(|p| HorizontalPointRecord {
                preload_kn: p.preload / KILONEWTON,
                stiffness_kn_per_m: p.stiffness / KILONEWTON_PER_METRE,
                deviation: p.stiffness / horizontal.stiffness - 1.0,
            })
            .collect(),
        error_band: None,
    }
}

pub(crate) fn law_record(fit: &LawFit) -> LawRecord {
    let [a, b, c] = fit.standard_error;
    LawRecord {
        constants: fit.law.into(),
        range_kn: [fit.range.0 / KILONEWTON, fit.range.1 / KILONEWTON],
        rms_rel_error: fit.rms_relative_error,
        max_rel_error: fit.max_relative_error,
        at_bound: BoundRecord { a: fit.at_bound[0], b: fit.at_bound[1], c: fit.at_bound[2] },
        a_standard_error_kn_per_m: a / KILONEWTON_PER_METRE,
        b_standard_error_kn_per_m: b / KILONEWTON_PER_METRE,
        c_standard_error: c,
    }
}

/// Laws of all forms for a calibration.
pub(crate) fn form_records(calibration: &NormalCalibration) -> Result<Vec<FormRecord>> {
    Ok(calibration.forms()?.iter().map(FormRecord::from).collect())
}

fn reference_record(calibration: &NormalCalibration) -> Result<ReferenceRecord> {
    Ok(ReferenceRecord {
        reference: calibration.reference.name().into(),
        law: law_record(&calibration.fit),
        forms: form_records(calibration)?,
        points: calibration.points.iter().map(tangent_record).collect(),
    })
}

fn tangent_record(p: &LoadPoint) -> TangentRecord {
    TangentRecord {
        force_kn: p.force / KILONEWTON,
        displacement_mm: p.displacement / MILLIMETRE,
        tangent_kn_per_m: p.solid_tangent / KILONEWTON_PER_METRE,
    }
}

fn compliance_record(p: &LoadPoint, beam: Option<&SeriesBeam>) -> ComplianceRecord {
    let vertical =
        |m: fn(&SeriesBeam) -> Matrix2<f64>| beam.map_or(0.0, |b| m(b)[(1, 1)] / MICROMETRE_PER_KILONEWTON);
    ComplianceRecord {
        force_kn: p.force / KILONEWTON,
        local_um_per_kn: p.local_compliance / MICROMETRE_PER_KILONEWTON,
        wheel_um_per_kn: p.wheel_compliance / MICROMETRE_PER_KILONEWTON,
        rail_um_per_kn: p.rail_compliance / MICROMETRE_PER_KILONEWTON,
        beam_um_per_kn: vertical(|b| b.corrected),
        beam_missing_um_per_kn: vertical(|b| b.solid - b.corrected),
    }
}

fn load_curve_row(
    reference: Reference,
    p: &LoadPoint,
    fit: &LawFit,
    Patch { values: patch, band, .. }: &Patch,
) -> LoadCurveRow {
    let [max_von_mises_mpa, von_mises_depth_mm, max_shear_mpa, shear_depth_mm] = subsurface_values(patch);
    let band = |of: fn(&PatchBand) -> f64| band.as_ref().map(of);
    LoadCurveRow {
        reference: reference.name().into(),
        force_kn: p.force / KILONEWTON,
        displacement_mm: p.displacement / MILLIMETRE,
        law_displacement_mm: fit.law.displacement(p.force) / MILLIMETRE,
        solid_secant_kn_per_m: p.force / p.displacement / KILONEWTON_PER_METRE,
        solid_tangent_kn_per_m: p.solid_tangent / KILONEWTON_PER_METRE,
        law_tangent_kn_per_m: fit.law.tangent(p.force) / KILONEWTON_PER_METRE,
        contact_area_mm2: patch.area / SQUARE_MILLIMETRE,
        max_pressure_mpa: patch.max_pressure / MEGAPASCAL,
        semi_axis_along_mm: patch.semi_axis_along / MILLIMETRE,
        semi_axis_across_mm: patch.semi_axis_across / MILLIMETRE,
        max_von_mises_mpa,
        von_mises_depth_mm,
        max_shear_mpa,
        shear_depth_mm,
        contact_area_rel_error_band: band(|band| band.area),
        max_pressure_rel_error_band: band(|band| band.max_pressure),
        von_mises_rel_error_band: band(|band| band.mises.stress),
        von_mises_depth_rel_error_band: band(|band| band.mises.depth),
        shear_rel_error_band: band(|band| band.shear.stress),
        shear_depth_rel_error_band: band(|band| band.shear.depth),
    }
}

fn subsurface_record((point, patch): (&LoadPoint, &Patch)) -> Option<SubsurfaceRecord> {
    let [mises, mises_depth, shear, shear_depth] = subsurface_values(&patch.values);
    Some(SubsurfaceRecord {
        force_kn: point.force / KILONEWTON,
        max_von_mises_mpa: mises?,
        von_mises_depth_mm: mises_depth?,
        max_shear_mpa: shear?,
        shear_depth_mm: shear_depth?,
        error_band: patch.band.map(|band| SubsurfaceBandRecord {
            von_mises: band.mises.stress,
            von_mises_depth: band.mises.depth,
            shear: band.shear.stress,
            shear_depth: band.shear.depth,
        }),
    })
}

/// Largest von Mises stress below a patch, MPa, its depth, mm, and the same of the shear stress.
pub(crate) fn subsurface_values(patch: &PatchValues) -> [Option<f64>; 4] {
    let values = |below: &Subsurface| {
        let of = |peak: &Peak| [peak.stress / MEGAPASCAL, peak.depth / MILLIMETRE];
        let ([mises, mises_depth], [shear, shear_depth]) = (of(&below.mises), of(&below.shear));
        [mises, mises_depth, shear, shear_depth]
    };
    patch.below.as_ref().map(values).map_or([None; 4], |values| values.map(Some))
}

fn mesh_record(
    body: &str,
    mesh: &HexMesh,
    file: &Option<MeshFile>,
    contact_element: f64,
    condensed: &CondensedBody,
) -> Result<BodyMeshRecord> {
    let quality = quality(mesh)?;
    let grouped = file.as_ref().is_some_and(|file| !file.groups.is_empty());
    let surface = grouped.then_some(&condensed.surface);
    Ok(BodyMeshRecord {
        body: body.into(),
        file: file.as_ref().map(|file| file.file.clone()),
        nodes: mesh.nodes.len(),
        elements: mesh.hexes.len(),
        degrees_of_freedom: condensed.equations,
        contact_nodes: mesh.contact.nodes.len(),
        contact_element_mm: contact_element / MILLIMETRE,
        min_scaled_jacobian: quality.min_scaled_jacobian,
        mean_scaled_jacobian: quality.mean_scaled_jacobian,
        mass_kg: condensed.mass,
        surface_young_gpa: surface.map(|surface| surface.young / GIGAPASCAL),
        surface_poisson: surface.map(|surface| surface.poisson),
        named: file.as_ref().map(|file| named(mesh, file)),
    })
}

fn touch_record(geometry: &Geometry, bodies: &CondensedPair) -> TouchRecord {
    let touch = &geometry.pair.touch;
    let rail = geometry.pair.rail.running.point(touch.rail_s);
    let wheel = geometry.pair.wheel.running.point(touch.wheel_s);
    let rail_curvature = geometry.pair.placed.curve.curvature(touch.rail_s);
    // the wheel's material lies above its curve, so a bulge of the wheel has negative curvature
    let wheel_curvature = -geometry.pair.wheel.running.curvature(touch.wheel_s);
    let rolling_radius = geometry.pair.wheel.radius + wheel.y;
    let [along, across] = geometry.pair.relative_radii();
    let modulus = bodies.rail_on_ends.surface.contact_modulus(&bodies.wheel.surface);
    let hertz = point_contact(KILONEWTON, along, across, modulus);
    TouchRecord {
        rail_y_mm: rail.x / MILLIMETRE,
        rail_z_mm: rail.y / MILLIMETRE,
        wheel_y_mm: wheel.x / MILLIMETRE,
        wheel_z_mm: wheel.y / MILLIMETRE,
        angle_deg: touch.contact_angle.to_degrees(),
        hertz_kn_per_m: hertz.as_ref().map_or(f64::NAN, |h| h.tangent_stiffness / KILONEWTON_PER_METRE),
        hertz: hertz.ok().map(|h| HertzRecord {
            semi_axis_along_mm: h.semi_axis_x / MILLIMETRE,
            semi_axis_across_mm: h.semi_axis_y / MILLIMETRE,
            max_pressure_mpa: h.max_pressure / MEGAPASCAL,
        }),
        rail_radius_mm: 1.0 / rail_curvature / MILLIMETRE,
        wheel_radius_mm: 1.0 / wheel_curvature / MILLIMETRE,
        rolling_radius_mm: rolling_radius / MILLIMETRE,
    }
}
