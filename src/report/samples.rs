//! Made-up results for the tests of the report: smooth stand-ins of the right
//! size and shape, no physics.

use std::f64::consts::{PI, TAU};

use nalgebra::Point2;
use railspring_calibrate::history::{ContactMode, ContactState, Ending, History, HistoryRow};

use crate::records::{
    AngleLawRecord, BandPointRecord, BeamFactors, BeamRecord, BodyMeshRecord, BoundRecord, ComplianceRecord,
    DisplacementRecord, ErrorBandRecord, FindingRecord, FixedLoadRecord, FixedReferenceRecord,
    HorizontalPointRecord, HorizontalRecord, LawConstants, LawRecord, LoadCurveRow, Measured, PairRecord,
    PenaltyRecord, ProfileRecord, ReferenceBandRecord, ReferenceRecord, ResolvedKey, ShiftRecord,
    ShiftTouchRecord, StageMeasure, StiffnessByAngleRecord, StiffnessRecord, TableRecord, TangentRecord,
    TouchRecord,
};

use crate::records::crosscheck::{
    Cause, Check, CrosscheckRecord, ExchangedMesh, HUB_DISPLACEMENT, Limit, Provenance, Question,
    SectionCell, SectionDifference, TANGENT_STIFFNESS, Timing,
};

use super::ProfilePair;

mod patches;

pub(crate) use patches::patches;

/// A run with sliding, a flange contact from 0.01 s on and one separation.
pub(crate) fn history(shift: f64) -> History {
    let rows = (0..=550)
        .map(|n| {
            let time = n as f64 * 0.0005;
            let apart = (0.146 + shift..0.171 + shift).contains(&time);
            let vertical_force =
                if apart { 0.0 } else { (12e3 + 61e3 * (TAU * 10.0 * (time - shift)).sin()).max(2e3) };
            let lateral_force = if apart {
                0.0
            } else {
                20e3 * (1.0 - (-time / 0.01).exp()) + 1e3 * (TAU * 60.0 * time).sin()
            };
            let wheel_y = 0.0067 * (1.0 - (-time / 0.006).exp());
            let contact = |mode, rail, wheel, share: f64| ContactState {
                mode,
                rail,
                wheel,
                normal_force: share * vertical_force,
                tangential_force: 0.2 * share * vertical_force,
            };
            let on_flange = time > 0.01;
            let mut contacts = Vec::new();
            if on_flange {
                let mode = if time > 0.03 { ContactMode::Stick } else { ContactMode::Slip };
                contacts.push(contact(mode, Point2::new(-0.0335, 0.0087), Point2::new(-0.0380, 0.0080), 0.6));
            }
            contacts.push(contact(
                ContactMode::Slip,
                Point2::new(-0.011, 0.0003),
                Point2::new(-0.015 - wheel_y, 0.0006),
                1.0,
            ));
            if apart {
                contacts.clear();
            }
            HistoryRow {
                time,
                vertical_force,
                lateral_force,
                wheel_y,
                wheel_z: -0.0004 * (PI * time * 20.0).sin(),
                load_y: 0.0,
                contacts,
            }
        })
        .collect();
    History { rows, degrees_of_freedom: 116, ending: Ending::Completed }
}

fn law(a: f64, b: f64, c: f64) -> LawRecord {
    LawRecord {
        constants: LawConstants { a_kn_per_m: a, b_kn_per_m: b, c, f0_kn: 1.0 },
        range_kn: [1.0, 150.0],
        rms_rel_error: 0.0031,
        max_rel_error: 0.0084,
        at_bound: BoundRecord { a: a == 0.0, b: false, c: false },
        a_standard_error_kn_per_m: if a == 0.0 { 0.0 } else { 1.2e4 },
        b_standard_error_kn_per_m: 0.9e4,
        c_standard_error: 0.0042,
    }
}

fn loads() -> Vec<f64> {
    (0..24).map(|n| 150f64.powf(n as f64 / 23.0)).collect()
}

fn reference(name: &str, law: LawRecord) -> ReferenceRecord {
    let mut displacement = 0.0;
    let mut before = 0.0;
    let points = loads()
        .into_iter()
        .enumerate()
        .map(|(n, force_kn)| {
            displacement += (force_kn - before) / law.constants.tangent(0.5 * (force_kn + before)) * 1e3;
            before = force_kn;
            let tangent_kn_per_m = law.constants.tangent(force_kn) * (1.0 + 0.008 * (n as f64).sin());
            TangentRecord { force_kn, displacement_mm: displacement, tangent_kn_per_m }
        })
        .collect();
    let displacement = DisplacementRecord { max_rel_error: 0.012, force_kn: 20.0 };
    let table = TableRecord { max_rel_error: Some(0.02), max_rel_displacement: Some(0.001), displacement };
    ReferenceRecord { reference: name.into(), law, displacement, table, points }
}

/// Bands of the three references at the loads of their points, wider at small loads.
fn error_band() -> ErrorBandRecord {
    let references = ["foot", "beam", "local"].map(|reference| {
        let points: Vec<BandPointRecord> = loads()
            .into_iter()
            .map(|force_kn| {
                let grid = 0.02 / force_kn.sqrt();
                BandPointRecord {
                    force_kn,
                    grid_displacement: Some(-grid),
                    grid_tangent: Some(2.0 * grid),
                    mesh_displacement: Some(0.004),
                    mesh_tangent: Some(-0.01),
                    displacement: Some(grid + 0.004),
                    tangent: Some(2.0 * grid + 0.01),
                }
            })
            .collect();
        let largest = |of: fn(&BandPointRecord) -> Option<f64>| points.iter().filter_map(of).reduce(f64::max);
        ReferenceBandRecord {
            reference: reference.into(),
            displacement: largest(|p| p.displacement),
            tangent: largest(|p| p.tangent),
            points,
        }
    });
    ErrorBandRecord {
        contact_element_mm: 2.0,
        coarser_element_mm: Some(2.83),
        missing: Vec::new(),
        target: None,
        references: references.to_vec(),
    }
}

/// Springs of about the published size.
pub(crate) fn stiffness() -> StiffnessRecord {
    StiffnessRecord {
        study: "sample".into(),
        reference: "beam".into(),
        law: law(2.0e4, 3.9e5, 0.245),
        horizontal_kn_per_m: Some(4.2e5),
        horizontal: Some(HorizontalRecord {
            relative_spread: 0.031,
            points: [20.0, 50.0, 85.0, 120.0]
                .map(|p| HorizontalPointRecord {
                    preload_kn: p,
                    stiffness_kn_per_m: 4.2e5 + 60.0 * p,
                    deviation: p * 1e-4,
                })
                .to_vec(),
        }),
        horizontal_missing: None,
        beam: BeamRecord {
            length_m: 0.555,
            factors: BeamFactors {
                shear_lateral_factor: 1.12,
                shear_vertical_factor: 1.11,
                torsion_factor: 0.83,
            },
            solid_um_per_kn: [3.9, 0.66],
            uncorrected_um_per_kn: [3.4, 0.72],
            corrected_um_per_kn: [3.9, 0.66],
            missing: 0.0,
        },
        references: vec![
            reference("foot", law(3.0e4, 2.94e5, 0.241104)),
            reference("beam", law(2.0e4, 3.9e5, 0.245)),
            reference("local", law(0.0, 3.4e5, 0.331)),
        ],
        error_band: Some(error_band()),
        compliance_split: [5.0, 20.0, 50.0, 85.0, 150.0]
            .map(|p: f64| ComplianceRecord {
                force_kn: p,
                local_um_per_kn: 2.9 / p.cbrt(),
                wheel_um_per_kn: 0.21,
                rail_um_per_kn: 0.16,
                beam_um_per_kn: 0.14,
                beam_missing_um_per_kn: 0.01,
            })
            .to_vec(),
        penalty: PenaltyRecord {
            enforcement: "exact".into(),
            penalty_kn_per_m: 1e6,
            penetration_over_displacement: Some(6.2e-4),
        },
        mesh: ["rail", "wheel"]
            .map(|body| BodyMeshRecord {
                body: body.into(),
                file: (body == "rail").then(|| "meshes/rail.msh".into()),
                nodes: 19211,
                elements: 16820,
                degrees_of_freedom: 57633,
                contact_nodes: 1040,
                contact_element_mm: 2.0,
                min_scaled_jacobian: 0.31,
                mean_scaled_jacobian: 0.87,
                mass_kg: 283.4,
            })
            .to_vec(),
        profiles: vec![ProfileRecord {
            body: "wheel".into(),
            file: "worn.prw".into(),
            format: "Simpack".into(),
            standard: "S1002".into(),
            points: 400,
            findings: vec![FindingRecord {
                kind: "spike".into(),
                first_line: Some(17),
                last_line: Some(18),
                value: Some(0.31),
                unit: Some("mm".into()),
                action: "repaired".into(),
                text: "off the line of its neighbours: dropped".into(),
            }],
        }],
        touch: TouchRecord {
            rail_y_mm: -12.1,
            rail_z_mm: 0.4,
            wheel_y_mm: -10.9,
            wheel_z_mm: 0.4,
            angle_deg: 2.6,
            hertz_kn_per_m: 3.4e5,
            rail_radius_mm: 300.0,
            wheel_radius_mm: -330.0,
            rolling_radius_mm: 429.4,
        },
        pair: PairRecord { name: "60E1 and S1002".into(), hash: "89abcdef".repeat(8) },
        input_hash: "0123456789abcdef".repeat(4),
        version: "0.1.0".into(),
    }
}

/// A load curve of the same springs.
pub(crate) fn load_curve() -> Vec<LoadCurveRow> {
    let stiffness = stiffness();
    let in_use = &stiffness.references[1];
    in_use
        .points
        .iter()
        .map(|p| LoadCurveRow {
            reference: "beam".into(),
            force_kn: p.force_kn,
            displacement_mm: p.displacement_mm,
            law_displacement_mm: 1.01 * p.displacement_mm,
            solid_tangent_kn_per_m: p.tangent_kn_per_m,
            law_tangent_kn_per_m: in_use.law.constants.tangent(p.force_kn),
            contact_area_mm2: 6.0 * p.force_kn.powf(2.0 / 3.0),
            max_pressure_mpa: 260.0 * p.force_kn.cbrt(),
            semi_axis_along_mm: 1.4 * p.force_kn.cbrt(),
            semi_axis_across_mm: 1.2 * p.force_kn.cbrt(),
            max_von_mises_mpa: Some(160.0 * p.force_kn.cbrt()),
            von_mises_depth_mm: Some(0.6 * p.force_kn.cbrt()),
            max_shear_mpa: Some(82.0 * p.force_kn.cbrt()),
            shear_depth_mm: Some(0.65 * p.force_kn.cbrt()),
        })
        .collect()
}

/// Rough outlines of a rail head and a wheel.
pub(crate) fn profiles() -> ProfilePair {
    let mm = |points: &[(f64, f64)]| points.iter().map(|(y, z)| Point2::new(y * 1e-3, z * 1e-3)).collect();
    ProfilePair {
        rail: mm(&[
            (-8.0, 60.0),
            (-12.0, 45.0),
            (-36.0, 37.0),
            (-36.0, 14.0),
            (-33.0, 7.0),
            (-26.0, 2.2),
            (-10.0, 0.2),
            (0.0, 0.0),
            (10.0, 0.2),
            (26.0, 2.2),
            (33.0, 7.0),
            (36.0, 14.0),
            (36.0, 37.0),
            (12.0, 45.0),
            (8.0, 60.0),
        ]),
        rail_angle: -0.025,
        rail_origin: Point2::new(0.7535, 0.0002),
        wheel: mm(&[
            (-70.0, -80.0),
            (-70.0, 18.0),
            (-63.0, 27.0),
            (-55.0, 28.0),
            (-48.0, 22.0),
            (-44.0, 14.0),
            (-38.5, 6.0),
            (-30.0, 1.8),
            (-20.0, 0.7),
            (0.0, 0.0),
            (30.0, -1.0),
            (60.0, -3.0),
            (65.0, -8.0),
            (65.0, -80.0),
        ]),
        wheel_origin: Point2::new(0.75, -0.0003),
        touch: Point2::new(0.742, 0.0004),
    }
}

/// Some keys.
pub(crate) fn inputs() -> Vec<ResolvedKey> {
    [
        ("rail", "profile", "60E1", true),
        ("rail", "length_m", "0.555", false),
        ("track", "gauge_mm", "1435", false),
    ]
    .map(|(section, key, value, given)| ResolvedKey {
        section: section.into(),
        key: key.into(),
        value: value.into(),
        given,
    })
    .to_vec()
}

/// Some measures.
pub(crate) fn measured() -> Measured {
    let stage = |name: &str, seconds| StageMeasure {
        stage: name.into(),
        key: String::new(),
        seconds,
        peak_memory_mib: Some(812.0),
        taken: false,
    };
    Measured {
        begun_utc: "2016-01-31T12:00:00Z".into(),
        host: "host".into(),
        threads: 2,
        stages: vec![stage("superelements", 41.2), stage("solid model, sample", 102.7)],
    }
}

/// Two reference solvers, three problems, one load that fails and one without an answer.
pub(crate) fn crosscheck() -> CrosscheckRecord {
    let mut checks = Vec::new();
    let loads = [5.0, 10.0, 20.0, 40.0, 60.0, 85.0, 120.0, 150.0];
    let problems = [
        ("contact without friction", "scikit-fem 11", 5e-3, Cause::Discretisation),
        ("contact with friction 0.5", "scikit-fem 11", 5e-3, Cause::Discretisation),
        ("incompatible modes against elements of second order", "scikit-fem 11", 2e-2, Cause::Discretisation),
        ("contact without friction, faceted surfaces", "CalculiX 2.20", 1e-2, Cause::Model),
    ];
    checks.push(Check::new(
        "rail, same mesh and element",
        "rail: nodal displacements under given forces, largest difference",
        None,
        "mm",
        (0.1234567, 0.1234567),
        "scikit-fem 11",
        7.7e-14,
        (1e-9, Cause::Roundoff),
    ));
    for (k, (problem, reference_solver, limit, cause)) in problems.into_iter().enumerate() {
        for load in loads {
            let hub = (1.0 - 0.02 * f64::from(k == 2)) * 1.9e-3 * f64::powf(load, 0.85);
            let off = limit * (1.1 - 0.002 * load) * if k % 2 == 0 { -0.8 } else { 0.95 };
            let theirs = if k == 3 && load == 150.0 { f64::NAN } else { hub * (1.0 + off) };
            let of = |quantity, unit, (tool, theirs): (f64, f64), limit| {
                let difference = (theirs / tool - 1.0).abs();
                Check::new(
                    problem,
                    quantity,
                    Some(load * 1e3),
                    unit,
                    (tool, theirs),
                    reference_solver,
                    difference,
                    (limit, cause),
                )
            };
            checks.push(of(HUB_DISPLACEMENT, "mm", (hub, theirs), limit));
            let tangent = 1e3 * load / hub / 0.85;
            checks.push(of(TANGENT_STIFFNESS, "kN/m", (tangent, tangent * (1.0 - 2.1 * off)), 2.0 * limit));
        }
    }
    let timings = problems.map(|(problem, reference_solver, ..)| Timing {
        problem: problem.into(),
        reference_solver: reference_solver.into(),
        degrees_of_freedom: 114_396,
        loads: loads.len(),
        tool_seconds: 5.4,
        reference_seconds: 61.2,
    });
    CrosscheckRecord {
        study: "sample".into(),
        holds: false,
        input_hash: stiffness().input_hash,
        version: "0.1.0".into(),
        begun_utc: "2016-01-31T12:00:00Z".into(),
        host: "sample".into(),
        reference: Provenance {
            package: "railspring-reference 0.1.0".into(),
            package_hash: "ab".repeat(32),
            python: "3.11.2".into(),
            solver: "SuperLU of scipy 1.17".into(),
            packages: [("numpy", "2.3"), ("scikit-fem", "11")].map(|(n, v)| (n.into(), v.into())).into(),
            input_sha256: "cd".repeat(32),
            date_utc: "2016-01-31T12:05:00Z".into(),
            seconds: 301.2,
        },
        calculix: Some("CalculiX 2.20".into()),
        questions: vec![Question {
            name: "same_mesh".into(),
            reference_solver: "scikit-fem 11".into(),
            text: "Hub displacement?".into(),
        }],
        meshes: vec![ExchangedMesh {
            body: "rail".into(),
            purpose: "same mesh".into(),
            nodes: 14_000,
            elements: 12_000,
            degrees_of_freedom: 42_000,
        }],
        limits: vec![Limit {
            cause: Cause::Roundoff,
            value: 1e-9,
            applies_to: "displacements".into(),
            derivation: "rounding times condition number".into(),
        }],
        curves: Vec::new(),
        checks,
        timings: timings.into(),
    }
}

/// A body of 12 by 20 elements with a difference that grows towards a corner.
pub(crate) fn sections() -> Vec<SectionDifference> {
    let cells = |height: f64| {
        (0..240)
            .map(|n| {
                let (y, z) = (f64::from(n % 12) * 10.0 - 60.0, f64::from(n / 12) * height / 20.0);
                let next = z + height / 20.0;
                SectionCell {
                    corners_mm: vec![[y, z], [y + 10.0, z], [y + 10.0, next], [y, next]],
                    difference_mm: 4.4e-14 * (y / 60.0 + z / height + 1.0).abs() / 3.0,
                }
            })
            .collect()
    };
    [("rail", 172.0), ("wheel", 430.0)]
        .map(|(body, height)| SectionDifference {
            body: body.into(),
            largest_displacement_mm: 0.123,
            largest_difference_mm: 4.6e-14,
            largest_at_mm: [12.0, 55.0, height],
            largest_on_section_mm: [55.0, height],
            turned_deg: (body == "wheel").then_some(1.6),
            cells: cells(height),
        })
        .into()
}

/// Laws at three shifts: whole on the tread, up to 40 kN on the flange, none where the wheel misses the rail.
pub(crate) fn by_angle() -> StiffnessByAngleRecord {
    let sample = stiffness();
    let laws = || {
        let entry = |reference: &ReferenceRecord| AngleLawRecord {
            reference: reference.reference.clone(),
            law: reference.law,
            displacement: reference.displacement,
        };
        sample.references.iter().map(entry).collect::<Vec<_>>()
    };
    let load = |force: f64, angle: f64| FixedLoadRecord {
        force_kn: force,
        references: sample
            .references
            .iter()
            .enumerate()
            .map(|(n, reference)| FixedReferenceRecord {
                reference: reference.reference.clone(),
                displacement_mm: 0.01 * force.powf(0.7),
                tangent_kn_per_m: (3.0 + n as f64) * 1e5 * force.powf(0.3) * (1.0 - 0.005 * angle),
                local_um_per_kn: 0.5,
                wheel_um_per_kn: (reference.reference != "local").then_some(0.1),
                rail_um_per_kn: (reference.reference != "local").then_some(0.2),
                sliding_um_per_kn: (reference.reference != "local").then_some(0.0),
            })
            .collect(),
        horizontal_kn_per_m: 4e5,
        tangential_kn_per_m: 4.1e5,
        contact_area_mm2: 80.0,
        max_pressure_mpa: 900.0,
        semi_axis_along_mm: 6.0,
        semi_axis_across_mm: 4.0,
        max_von_mises_mpa: Some(700.0),
        von_mises_depth_mm: Some(2.1),
        max_shear_mpa: Some(390.0),
        shear_depth_mm: Some(2.1),
    };
    let touch = |angle: f64| ShiftTouchRecord {
        contact_angle_deg: angle,
        rail_y_mm: -angle / 2.0,
        rail_z_mm: angle / 5.0,
        wheel_y_mm: -angle / 2.0,
        wheel_z_mm: angle / 5.0,
    };
    let shift = |shift_mm: f64, angle: Option<f64>, loads: &[f64], reason: Option<&str>| ShiftRecord {
        shift_mm,
        touch: angle.map(touch),
        laws: if loads.is_empty() { Vec::new() } else { laws() },
        loads: loads.iter().map(|force| load(*force, angle.unwrap_or_default())).collect(),
        published_secant_ratio: None,
        reason: reason.map(String::from),
    };
    StiffnessByAngleRecord {
        study: "sample".into(),
        friction: 0.5,
        shifts: vec![
            shift(-60.0, None, &[], Some("the wheel misses the rail")),
            shift(0.0, Some(1.4), &[20.0, 40.0, 80.0], None),
            shift(4.0, Some(5.8), &[20.0, 40.0, 80.0], None),
            shift(7.0, Some(70.0), &[20.0, 40.0], Some("the contact reached the end of the window")),
        ],
        pair: sample.pair.clone(),
        input_hash: "ef".repeat(32),
        version: "0.1.0".into(),
    }
}
