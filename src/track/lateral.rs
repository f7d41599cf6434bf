//! A wheelset across the track: what the section `[lateral]` makes of a load case.

use std::path::Path;

use nalgebra::Point2;
use railspring_calibrate::law::StiffnessLaw;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::placement::{TrackGeometry, place_rail, touch};
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::units::{KILONEWTON_PER_METRE, MILLIMETRE};
use railspring_simulate::element::published::{MovingModel, WheelSprings, WheelsetContact, WheelsetSide};
use railspring_simulate::track::{
    Across, AcrossCase, Direction, Held, LayersAcross, ProbeAcross, Running, Start, StartAcross,
    SwayingWheelset, Track, TrackCase, TwoRails, UnevenRail,
};

use super::beams::{kelvin, sleeper_places};
use super::document::{LateralKeys, RunningKey, TrackDocument};
use super::excitation::{Found, LateralFunctions};
use super::profiles::{self, AnalysedRail, expected};

type Result<T> = std::result::Result<T, InputError>;

/// What only a wheelset across the track has.
pub(super) struct Parts {
    /// Still with the published law.
    sides: [WheelsetSide; 2],
    keys: LateralKeys,
    /// How far the rail's foot is below the node line, m.
    foot: f64,
}

fn refused(key: &str, value: &str, expected: &str, remedy: &str) -> InputError {
    InputError::new(key, value, expected, remedy)
}

/// The parts of a study with `[lateral]`, and whether the rest of it goes with them; files lie relative to `folder`.
pub(super) fn parts(
    document: &TrackDocument,
    keys: &LateralKeys,
    folder: &Path,
    found: &mut Found,
) -> Result<Parts> {
    let name = |kind: RunningKey| if kind == RunningKey::Force { "\"force\"" } else { "\"wheel\"" };
    if document.wheel.kind != RunningKey::Wheelset {
        let expected = "\"wheelset\": a single wheel or a force does not move across the track";
        let remedy = "set `wheel.kind = \"wheelset\"`, or remove `[lateral]`";
        return Err(refused("wheel.kind", name(document.wheel.kind), expected, remedy));
    }
    if document.bridge.is_some() {
        let expected = "no bridge under a wheelset across the track";
        let remedy = "remove `[bridge]`, or `[lateral]` for a bridge in the vertical plane";
        return Err(refused("bridge", "given", expected, remedy));
    }
    if document.contact.damping_kn_s_per_m != 0.0 {
        let expected = "no damper in the contact of two profiles";
        return Err(InputError::new(
            "contact.damping_kn_s_per_m",
            document.contact.damping_kn_s_per_m,
            expected,
            "leave it out",
        ));
    }
    let rail = &document.rail;
    if !rail.rigid && rail.section.is_some() {
        let expected = "`rail.profile`, whose section says how the rail bends laterally and twists";
        return Err(refused("rail.section", "given", expected, "give a standard rail as `rail.profile`"));
    }
    let suspended = document.wheel.suspended_mass_t > 0.0;
    if suspended && keys.suspension.is_none() {
        let expected = "the lateral spring and damper of a suspended mass";
        return Err(refused("lateral.suspension", "(missing)", expected, "add this key"));
    }
    if !suspended && (keys.suspension.is_some() || keys.suspended_height_m != 0.0) {
        let key = if keys.suspension.is_some() { "suspension" } else { "suspended_height_m" };
        let expected = "no such key for a wheelset without a suspended mass (`wheel.suspended_mass_t`)";
        return Err(refused(&format!("lateral.{key}"), "given", expected, "leave it out"));
    }
    held_across(document, keys)?;
    let right_rail = keys.rail_profile.as_deref().or(rail.profile.as_deref());
    let Some(right_rail) = right_rail else {
        let expected = "the rail whose running surface a rail has that does not move";
        return Err(refused("lateral.rail_profile", "(missing)", expected, "add this key"));
    };
    let left_rail = keys.left_rail_profile.as_deref();
    let left_wheel = keys.left_wheel_profile.as_deref();
    let right_key = if keys.rail_profile.is_some() { "lateral.rail_profile" } else { "rail.profile" };
    let of_right = profiles::rail(folder, right_key, right_rail, found)?;
    let of_left = match left_rail.filter(|name| *name != right_rail) {
        None => of_right.clone(),
        Some(name) => profiles::rail(folder, "lateral.left_rail_profile", name, found)?,
    };
    let right_wheel = profiles::wheel(folder, "lateral.wheel_profile", &keys.wheel_profile, found)?;
    let left_wheel = match left_wheel.filter(|name| *name != keys.wheel_profile) {
        None => right_wheel.clone(),
        Some(name) => profiles::wheel(folder, "lateral.left_wheel_profile", name, found)?,
    };
    let right = side(keys, &of_right, right_wheel, 1.0)?;
    let left = side(keys, &of_left, left_wheel, -1.0)?;
    let foot = match rail.profile.as_deref().filter(|_| !rail.rigid) {
        None => 0.0,
        Some(beam) if beam == right_rail => of_right.foot,
        Some(beam) => profiles::rail(folder, "rail.profile", beam, found)?.foot,
    };
    Ok(Parts { sides: [right, left], keys: keys.clone(), foot })
}

/// That what carries the rails vertically holds them across the track as well.
fn held_across(document: &TrackDocument, keys: &LateralKeys) -> Result<()> {
    let rail = &document.rail;
    for (section, given, across) in [
        ("sleepers", rail.sleepers.is_some(), keys.sleepers.is_some()),
        ("foundation", rail.foundation.is_some(), keys.foundation.is_some()),
    ] {
        let (value, expected, remedy) = match (given, across) {
            (true, false) => {
                ("(missing)", format!("what `[rail.{section}]` holds across the track"), "add this section")
            }
            (false, true) => (
                "given",
                format!("`[rail.{section}]`, which it belongs to"),
                "leave it out, or add that section",
            ),
            _ => continue,
        };
        return Err(refused(&format!("lateral.{section}"), value, &expected, remedy));
    }
    let (Some(sleepers), Some(vertical)) = (&keys.sleepers, &rail.sleepers) else { return Ok(()) };
    let ballast = [
        ("ballast_stiffness_kn_per_m", sleepers.ballast_stiffness_kn_per_m),
        ("ballast_damping_kn_s_per_m", sleepers.ballast_damping_kn_s_per_m),
    ];
    match (vertical.mass_kg, ballast) {
        (Some(_), [(key, None), _]) => Err(refused(
            &format!("lateral.sleepers.{key}"),
            "(missing)",
            "the lateral stiffness of the ballast under a sleeper with a mass",
            "add this key, or leave `rail.sleepers.mass_kg` out",
        )),
        (None, given) => match given.iter().find_map(|(key, value)| Some((key, (*value)?))) {
            None => Ok(()),
            Some((key, value)) => Err(InputError::new(
                format!("lateral.sleepers.{key}"),
                value,
                "no ballast without a sleeper of a mass between",
                "give `rail.sleepers.mass_kg`, or leave it out",
            )),
        },
        _ => Ok(()),
    }
}

/// A wheel of this profile on its rail; `toward` is 1 on the right side.
fn side(keys: &LateralKeys, rail: &AnalysedRail, curve: ProfileCurve, toward: f64) -> Result<WheelsetSide> {
    let geometry = TrackGeometry {
        gauge: keys.gauge_mm * MILLIMETRE,
        flange_back: keys.flange_back_mm * MILLIMETRE,
        inclination: keys.inclination,
        ..TrackGeometry::standard()
    };
    let section = &rail.section;
    let placed = place_rail(section, &geometry).map_err(|error| {
        // the track's own numbers are within their ranges
        let remedy = "give a profile that goes on further down the gauge side";
        InputError::new(&rail.key, format!("{:?}", rail.name), expected(error), remedy)
    })?;
    let arm = geometry.tape_y(&curve);
    let tape_y = arm + toward * keys.lateral_shift_mm * MILLIMETRE;
    let touch = touch(&placed, &curve, tape_y).map_err(|error| match error {
        Error::Input(error) => InputError::new(
            "lateral.lateral_shift_mm",
            keys.lateral_shift_mm,
            error.expected,
            "reduce it, or check `lateral.gauge_mm` and `lateral.flange_back_mm`",
        ),
        other => {
            InputError::new("lateral.lateral_shift_mm", other, "wheels that touch their rails", "reduce it")
        }
    })?;
    let node_line = placed.to_world(&Point2::new(0.0, section.height - rail.foot));
    let springs = WheelSprings {
        horizontal: keys.horizontal_stiffness_kn_per_m * KILONEWTON_PER_METRE,
        normal: StiffnessLaw::published().into(),
        longitudinal: keys.horizontal_stiffness_kn_per_m * KILONEWTON_PER_METRE,
    };
    Ok(WheelsetSide {
        rail: placed,
        node_line,
        wheel: curve,
        wheel_radius: 0.5 * keys.wheel_diameter_m,
        tape: Point2::new(tape_y, touch.tape_z),
        arm,
        springs,
    })
}

impl Parts {
    /// The load case across the track from the one in the vertical plane.
    pub fn across(
        self,
        case: TrackCase,
        functions: LateralFunctions,
        uneven: Vec<UnevenRail>,
        document: &TrackDocument,
    ) -> AcrossCase {
        let Self { sides, keys, foot } = self;
        let angle = sides[0].rail.angle;
        let sides = sides.map(|mut side| {
            side.springs.normal = case.wheels.law.clone();
            side
        });
        let lateral = keys.suspension.map(|keys| kelvin(keys.stiffness_kn_per_m, keys.damping_kn_s_per_m));
        let none = kelvin(0.0, 0.0);
        let wheelset = match case.running {
            Running::Wheelset(set) => SwayingWheelset {
                mass: set.mass,
                inertia: set.inertia,
                above: set.above,
                above_inertia: set.above_inertia,
                height: keys.suspended_height_m,
                vertical: set.suspension,
                lateral: lateral.unwrap_or(none),
                half_base: set.half_base,
            },
            // which `parts` refuses
            Running::Force | Running::Wheel(_) => unreachable!("a wheelset"),
        };
        let mut uneven = uneven.into_iter();
        let uneven = [(); 2].map(|()| uneven.next().unwrap_or_default());
        let start = match case.start {
            Start::Equilibrium => StartAcross::Equilibrium,
            Start::Above { height, velocity } => StartAcross::Above {
                height,
                velocity: [document.run.lateral_velocity_m_per_s.unwrap_or(0.0), velocity],
            },
        };
        let probes = case.probes.into_iter();
        let across = AcrossCase {
            rails: case.track.map(|track| two_rails(track, angle, foot, &keys, document)),
            wheelset,
            contact: WheelsetContact {
                sides,
                friction: keys.friction,
                penalty: MovingModel::DEFAULT_PENALTY,
                node_spacing: MovingModel::DEFAULT_NODE_SPACING,
            },
            uneven,
            steps: case.steps,
            time_step: case.time_step,
            inner_steps: case.inner_steps,
            gravity: case.gravity,
            lateral_force: functions.force,
            vertical_force: case.force,
            roll: case.roll,
            torsion: functions.torsion,
            ground: [functions.ground, case.ground],
            way: case.way,
            start,
            probes: probes
                .map(|probe| ProbeAcross { name: probe.name, rail: probe.rail, x: probe.x })
                .collect(),
        };
        if document.wheel.mirrored { across.mirrored() } else { across }
    }
}

/// Two rails whose supports hold them across the track: rigid ones and ends against sway and twist as well, springs not at all.
fn two_rails(rail: Track, angle: f64, foot: f64, keys: &LateralKeys, document: &TrackDocument) -> TwoRails {
    let mut held = Vec::new();
    for Held { node, direction, .. } in &rail.held {
        match direction {
            Direction::Vertical => held.extend([(*node, Across::Lateral), (*node, Across::Twist)]),
            Direction::Rotation => held.push((*node, Across::Turn)),
        }
    }
    let mut layers = Vec::new();
    if let Some((sleepers, vertical)) = keys.sleepers.as_ref().zip(document.rail.sleepers.as_ref()) {
        let mass = vertical.mass_kg;
        for x in sleeper_places(vertical, rail.length) {
            let ballast = kelvin(
                sleepers.ballast_stiffness_kn_per_m.unwrap_or(0.0),
                sleepers.ballast_damping_kn_s_per_m.unwrap_or(0.0),
            );
            layers.extend([
                LayersAcross {
                    x,
                    direction: Across::Lateral,
                    below_line: foot,
                    upper: kelvin(sleepers.pad_stiffness_kn_per_m, sleepers.pad_damping_kn_s_per_m),
                    below: mass.map(|mass| (mass, ballast)),
                },
                LayersAcross {
                    x,
                    direction: Across::Twist,
                    below_line: 0.0,
                    upper: kelvin(sleepers.twist_kn_m_per_rad, sleepers.twist_damping_kn_m_s_per_rad),
                    below: None,
                },
            ]);
        }
    }
    TwoRails {
        rail,
        angle,
        bed: keys.foundation.map(|bed| kelvin(bed.stiffness_kn_per_m2, bed.damping_kn_s_per_m2)),
        bed_below_line: foot,
        twist_bed: keys.foundation.map(|bed| kelvin(bed.twist_kn_m_per_rad_m, 0.0)),
        held,
        layers,
    }
}
