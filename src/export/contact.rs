//! CONTACT (Vollebregt, module 1): profiles in place, and a case for each of some loads with the massless rail behind the contact.
//!
//! The half-spaces of CONTACT are the `local` part of a law. What the law has besides, the bodies, is linear, and stands
//! behind the contact as the massless rail (F = 3): 1/k_z is the difference of the tangent compliances against the
//! reference and against `local`. Profiles are in place, so that CONTACT neither inclines (CANT 0) nor raises the rail; it
//! moves it to the gauge as [`railspring_profiles::placement::place_rail`] does.

use std::fmt::Write as _;

use nalgebra::Point2;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::profile::ProfileKind;
use railspring_profiles::profile_file::{MeasuredPoint, ProfileFormat, write};
use railspring_profiles::units::{GIGAPASCAL, KILONEWTON, MEGAPASCAL, MILLIMETRE};

use super::spring::{ExportFile, Spring, commented, plain};
use super::surfaces::Surfaces;
use crate::results::springs::record::TangentRecord;
use crate::study::Study;
use crate::table::document::DirectionKey;

/// Least coefficient of friction that CONTACT reads (`FKIN`, friction law L = 0).
const LEAST_FRICTION: f64 = 1e-4;

/// A load with what stands behind the contact there.
struct Load {
    /// N.
    force: f64,
    /// Vertical stiffness of the massless rail, N/mm.
    k_z: f64,
}

/// Both profiles and the cases.
///
/// # Errors
/// [`InputError`] for springs along another direction than down or without a horizontal stiffness, and for a reference that has nothing
/// besides the contact.
pub(super) fn files(spring: &Spring, surfaces: &Surfaces<'_>) -> Result<Vec<ExportFile>> {
    if spring.direction == DirectionKey::Normal {
        let expected = "\"vertical\": the massless rail of CONTACT goes down";
        let remedy = "make the table with direction = \"vertical\"";
        return Err(InputError::new("direction", "\"normal\"", expected, remedy).into());
    }
    let loads = loads(spring)?;
    let k_y = spring.horizontal_kn_per_m.ok_or_else(|| {
        InputError::new(
            "horizontal_kn_per_m",
            "(none)",
            "the horizontal stiffness, for the massless rail of CONTACT",
            "calibrate so that it is found; stiffness.json or the row of the table says why it was not",
        )
    })?;
    let profile = |kind: ProfileKind, name: &str, origin: &str, points: &[Point2<f64>]| {
        let own = [
            format!("units: mm; y to the field side of the right rail, z down; {origin}"),
            Surfaces::sentence(),
        ];
        let what = format!("Profile of the {} for CONTACT and Simpack", kind.name());
        let heading = commented("!", &spring.heading(&what, &own));
        let measured = |(i, &point)| MeasuredPoint { point, line: i + 1, weight: 1.0 };
        let points: Vec<MeasuredPoint> = points.iter().enumerate().map(measured).collect();
        let text = write(ProfileFormat::Simpack, kind, &points, &plain(&spring.source[1]));
        ExportFile { name: name.into(), text: format!("{heading}{text}") }
    };
    let rail = profile(
        ProfileKind::Rail,
        "rail.prr",
        "inclined as in the track, y = 0, z = 0 at its highest point",
        &surfaces.rail(surfaces.top_y()),
    );
    let wheel =
        profile(ProfileKind::Wheel, "wheel.prw", "y = 0, z = 0 on the tape circle", &surfaces.wheel());
    // 1 kN/m is 1 N/mm
    let wheel_constants = wheel_constants(spring, surfaces.study)?;
    let text = cases(spring, surfaces, &loads, k_y, wheel_constants);
    let cases = ExportFile { name: "contact.inp".into(), text };
    Ok(vec![rail, wheel, cases])
}

/// The loads of the solid model next to those that are shown, with k_z from its tangents there.
fn loads(spring: &Spring) -> Result<Vec<Load>> {
    let nearest = |wanted: f64| {
        let away = |point: &&TangentRecord| (point.force_kn * KILONEWTON - wanted).abs();
        spring.points.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
    };
    let mut loads: Vec<Load> = Vec::new();
    // half-spaces are what CONTACT computes itself
    let shown = if spring.reference == "half-spaces" { Vec::new() } else { spring.shown_loads() };
    for wanted in shown {
        let Some(point) = nearest(wanted) else { continue };
        let Some(beside) = spring.local.iter().find(|p| p.force_kn == point.force_kn) else { continue };
        let compliance = 1.0 / point.tangent_kn_per_m - 1.0 / beside.tangent_kn_per_m;
        let force = point.force_kn * KILONEWTON;
        if compliance > 0.0 && loads.iter().all(|load| load.force != force) {
            loads.push(Load { force, k_z: 1.0 / compliance });
        }
    }
    if !loads.is_empty() {
        return Ok(loads);
    }
    Err(InputError::new(
        "--reference",
        format!("{:?}", spring.reference),
        "a reference with more than the contact itself, for the massless rail of CONTACT",
        "take \"beam\" or \"foot\"",
    )
    .into())
}

/// Shear modulus (MPa) and Poisson's ratio of a body from Young's modulus (Pa).
fn constants(young: f64, poisson: f64) -> [f64; 2] {
    [young / (2.0 * (1.0 + poisson)) / MEGAPASCAL, poisson]
}

/// Those of the wheel at its running surface.
fn wheel_constants(spring: &Spring, study: &Study) -> Result<[f64; 2]> {
    if let Some([young_gpa, poisson]) = spring.wheel_surface {
        return Ok(constants(young_gpa * GIGAPASCAL, poisson));
    }
    let of_groups: Vec<_> =
        study.wheel.materials.of_groups().iter().map(|m| constants(m.young, m.poisson)).collect();
    match of_groups.first().filter(|first| of_groups.iter().all(|other| other == *first)) {
        Some(first) => Ok(*first),
        None => Err(InputError::new(
            "wheel.materials",
            format!("{} groups", of_groups.len()),
            "one material, or the stiffness.json of a calibration, which says what is at the running surface",
            "export from the stiffness.json of a study of this pair: a row of a table does not say which group carries the contact",
        )
        .into()),
    }
}

fn cases(
    spring: &Spring,
    surfaces: &Surfaces<'_>,
    loads: &[Load],
    k_y: f64,
    [wheel_shear, wheel_nu]: [f64; 2],
) -> String {
    let own = [
        "units: mm, N, MPa; right wheel, y to the right, z down".into(),
        "one case for each load, rolling without creepage (T = 3): the massless rail needs T = 1 or more".into(),
        format!(
            "massless rail (F = 3): KZRAIL is what the law has besides the contact, from the tangents against {} and local",
            spring.reference
        ),
        "KYRAIL is the horizontal stiffness of the sticking wheel; the small tangential compliance of the contact is in it".into(),
        "PEN and the force over it are those of the contact; the hub goes down by the rail's deflection more".into(),
        "written by the user guide and the reader of CONTACT 25; this combination of digits (T = 3, F = 3) runs there".into(),
    ];
    let mut text = commented(
        "%",
        &spring.heading("Wheel on rail for CONTACT, module 1, with rail.prr and wheel.prw", &own),
    );
    let (study, pair) = (surfaces.study, &surfaces.geometry.pair);
    let [shear, nu] = constants(study.rail.material.young, study.rail.material.poisson);
    let track = &study.track;
    let [gauge, height, backs, shift, radius, back] = [
        track.gauge,
        track.gauge_height,
        track.flange_back,
        track.lateral_shift,
        pair.wheel.radius,
        pair.wheel.running.point(0.0).x,
    ]
    .map(|length| format!("{:.6}", length / MILLIMETRE));
    for (number, Load { force, k_z }) in loads.iter().enumerate() {
        let _ = write!(
            text,
            "% case {case}\n\
             1 MODULE\n\
             1203130     C-P-B-T-N-F-S   CONFIG, PVTIME, BOUND, TANG, NORM, FORCE, STRESS\n\
             0022033     V-L-D-C-M-Z-E   VARFRC, FRCLAW, DISCNS, INFLCF, MATER, ZTRACK, EWHEEL\n\
             0001241     H-G-I-A-O-W-R   HEAT, GAUSEI, IESTIM, MATFIL, OUTPUT, FLOW, RETURN\n\
             999 100 30 1 1.0E-05        MAXGS, MAXIN, MAXNR, MAXOUT, EPS\n\
             {friction} {friction}                     FSTAT, FKIN\n\
             {nu} {wheel_nu} {shear:.3} {wheel_shear:.3}   POISS 1,2, GG 1,2\n\
             0.2 0.2 1.0 90d 8.0 4.0     DX, DS, DQREL, A_SEP, D_SEP, D_COMB\n\
             {height} 0 {gauge} 0.0      GAUGHT, GAUGSQ, GAUGWD, CANT\n\
             'rail.prr' 0 1.0 0.0        RFNAME, MIRRORY, SCALE, SMOOTH\n\
             0.0 0.0 0.0 0.0 0.0 0.0     DY, DZ, DROLLR, VY, VZ, VROLL\n\
             {k_y:.6e} 0.0 {k_z:.6e} 0.0   KYRAIL, FYRAIL, KZRAIL, FZRAIL\n\
             {backs} {back} {radius}     FBDIST, FBPOS, NOMRAD\n\
             'wheel.prw' 0 1.0 0.0       WFNAME, MIRRORY, SCALE, SMOOTH\n\
             0.0 {shift} {force:.6} 0.0 0.0 0.0   S, Y, FZ, ROLL, YAW, PITCH\n\
             2000.0 0.0 0.0 0.0 0.0 {pitch:.9}   VS, VY, VZ, VROLL, VYAW, VPITCH\n",
            case = number + 1,
            friction = study.contact.friction.max(LEAST_FRICTION),
            pitch = -2000.0 * MILLIMETRE / pair.wheel.radius,
        );
    }
    text.push_str("0 MODULE\n");
    text
}
