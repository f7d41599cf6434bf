//! Error bands of the laws of a calibration, and finer meshes where a study wants narrower bands.

use railspring_calibrate::calibration::Reference;
use railspring_calibrate::pair::{
    BandPoint, Changed, CondensedPair, ErrorBand, Solid, SolidPoints, error_bands, horizontal_changes,
};
use railspring_profiles::error::{Error, InputError, Result, or_reason};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};

use crate::results::bodies::coarser::{COARSER_MESHES, Coarser, CoarserBodies, bodies_of};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::{FINER, Meshes, remeshed_with};
use crate::results::bodies::record::ProfileRecord;
use crate::results::springs::band_record::{
    BandPointRecord, ErrorBandRecord, HorizontalBandRecord, ReferenceBandRecord, TargetRecord,
};
use crate::results::springs::make::{FittedSprings, contact_conditions};
use crate::study::Statics;

/// Refuses a wanted error of meshes that the program cannot refine.
///
/// # Errors
/// [`InputError`] with the key.
pub fn check_target(statics: Statics<'_>) -> Result<()> {
    let (Some(target), Some(file)) =
        (statics.target_error, statics.rail.mesh.as_ref().or(statics.wheel.mesh.as_ref()))
    else {
        return Ok(());
    };
    Err(InputError::new(
        "mesh.target_error",
        target,
        format!("meshes of the program's own, which it can refine, in place of {}", file.file),
        "leave the key out, or the mesh file",
    )
    .into())
}

/// The bands of the laws of `bodies` on `meshes`, and of the horizontal stiffness, if there is one: on a grid of half the spacing, and on the bodies of
/// `coarser` meshes. A part that does not come to an answer is missing and takes nothing from the springs.
///
/// # Errors
/// An interruption.
pub fn error_band(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    bodies: &CondensedPair,
    found: &FittedSprings,
    coarser: &CoarserBodies,
    monitor: &dyn Monitor,
) -> Result<(ErrorBandRecord, Option<HorizontalBandRecord>)> {
    let (pair, contact) = (&geometry.pair, contact_conditions(statics));
    let solid = Solid::of_calibration(pair, bodies, contact, &found.laws, &geometry.replicates);
    let changed = solid.changed(bodies_of(coarser), monitor)?;
    let band = band_record(&solid.points, changed, meshes.contact_element(), (coarser, &geometry.profiles));
    let Some(found) = &found.horizontal else { return Ok((band, None)) };
    let reference = Reference::from(statics.calibration.reference);
    let changes = match coarser {
        Ok(Coarser { bodies, .. }) => {
            or_reason(horizontal_changes(pair, bodies, contact, reference, &found.points, monitor))?
        }
        Err(reason) => Err(reason.clone()),
    };
    Ok((band, Some(horizontal_record(changes))))
}

fn horizontal_record(changes: std::result::Result<Vec<f64>, String>) -> HorizontalBandRecord {
    match changes {
        Ok(meshes) => {
            let largest = meshes.iter().fold(0.0, |largest: f64, change| largest.max(change.abs()));
            HorizontalBandRecord { meshes, band: Some(largest), missing: None }
        }
        Err(reason) => {
            let missing = Some(format!("{COARSER_MESHES}: {reason}"));
            HorizontalBandRecord { meshes: Vec::new(), band: None, missing }
        }
    }
}

/// The bands of a solid under its loads, from its changes with the grid and to the `coarser` bodies; `contact_element` is the edge of the
/// contact elements of the meshes of that solid, m. What is left to look at in the `profiles` has no band: a hole may hide anything.
pub(crate) fn band_record(
    points: &SolidPoints,
    Changed { grid, mesh, scatter }: Changed,
    contact_element: f64,
    (coarser, profiles): (&CoarserBodies, &[ProfileRecord]),
) -> ErrorBandRecord {
    let mut missing: Vec<String> = profiles.iter().flat_map(ProfileRecord::left).collect();
    let mut lacks = |part: &str, reason: &str| missing.push(format!("{part}: {reason}"));
    let grid = grid.unwrap_or_else(|error| {
        lacks("the grid of half the spacing", &error.to_string());
        None
    });
    if let Err(reason) = coarser {
        lacks(COARSER_MESHES, reason);
    }
    let mesh = mesh.unwrap_or_else(|error| {
        lacks(COARSER_MESHES, &error.to_string());
        None
    });
    let scatter = scatter.unwrap_or_else(|error| {
        lacks("the scatter of the profiles", &error.to_string());
        None
    });
    let bands = error_bands(points, grid.as_ref(), mesh.as_ref(), scatter.as_ref());
    ErrorBandRecord {
        contact_element_mm: contact_element / MILLIMETRE,
        coarser_element_mm: coarser.as_ref().ok().map(|coarser| coarser.contact_element / MILLIMETRE),
        target: None,
        references: bands.iter().map(|band| reference_record(band, missing.is_empty())).collect(),
        missing,
    }
}

fn reference_record(band: &ErrorBand, complete: bool) -> ReferenceBandRecord {
    let largest = complete.then(|| band.largest());
    let point = |point: &BandPoint| {
        let whole = complete.then(|| point.band());
        BandPointRecord {
            force_kn: point.force / KILONEWTON,
            grid_displacement: point.grid.map(|change| change.displacement),
            grid_tangent: point.grid.map(|change| change.tangent),
            mesh_displacement: point.mesh.map(|change| change.displacement),
            mesh_tangent: point.mesh.map(|change| change.tangent),
            scatter_displacement: point.scatter.map(|change| change.displacement),
            scatter_tangent: point.scatter.map(|change| change.tangent),
            displacement: whole.map(|change| change.displacement),
            tangent: whole.map(|change| change.tangent),
        }
    };
    ReferenceBandRecord {
        reference: band.reference.name().into(),
        displacement: largest.map(|change| change.displacement),
        tangent: largest.map(|change| change.tangent),
        points: band.points.iter().map(point).collect(),
    }
}

/// The next finer meshes, if the `band` of the law in use is wider than the study wants; `accept` has seen them. The band has what the
/// wish has come to so far.
///
/// # Errors
/// An interruption.
pub fn finer_meshes(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    band: &mut ErrorBandRecord,
    accept: impl Fn(&Meshes) -> Result<()>,
    monitor: &dyn Monitor,
) -> Result<Option<Meshes>> {
    let Some(wanted) = statics.target_error else { return Ok(None) };
    let target = TargetRecord { wanted, refinements: meshes.refinements(statics.mesh), not_reached: None };
    let target = band.target.insert(target);
    let in_use = statics.calibration.reference.name();
    let Some(of) = band.references.iter().find(|of| of.reference == in_use) else { return Ok(None) };
    let Some(found) = of.largest() else {
        target.not_reached = Some(format!("no band: {}", band.missing.join("; ")));
        return Ok(None);
    };
    if found <= wanted {
        return Ok(None);
    }
    let size = |change: Option<f64>| change.unwrap_or(0.0).abs();
    let stays = of.points.iter().flat_map(|p| {
        let displacement = size(p.grid_displacement) + size(p.scatter_displacement);
        [displacement, size(p.grid_tangent) + size(p.scatter_tangent)]
    });
    let stays = stays.fold(0.0, f64::max);
    if stays > wanted {
        target.not_reached = Some(format!(
            "the band is {:.2} %, of which the grid of the contact and the scatter of measured profiles are {:.2} %; finer meshes do not change that",
            1e2 * found,
            1e2 * stays
        ));
        return Ok(None);
    }
    let finer = remeshed_with(statics, geometry, meshes, meshes.options().refined(FINER));
    match finer.and_then(|finer| accept(&finer).map(|()| finer)) {
        Ok(finer) => {
            monitor.notice(&format!(
                "error band of {:.2} % with contact elements of {:.2} mm, wanted {:.2} %; meshed again with {:.2} mm",
                1e2 * found,
                meshes.contact_element() / MILLIMETRE,
                1e2 * wanted,
                finer.contact_element() / MILLIMETRE
            ));
            Ok(Some(finer))
        }
        Err(Error::Interrupted) => Err(Error::Interrupted),
        Err(error) => {
            target.not_reached =
                Some(format!("the band is {:.2} %; the next finer meshes: {error}", 1e2 * found));
            Ok(None)
        }
    }
}
