//! Made-up springs: the calibration, the laws by contact angle, and a lumped element.

use railspring_calibrate::law::{Solid, StiffnessLaw, fit_forms};
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};

use crate::results::bodies::record::{
    BodyMeshRecord, FindingRecord, GroupRecord, NamedRecord, ProfileRecord,
};
use crate::results::bodies::touch::{HertzRecord, TouchRecord};
use crate::results::by_angle::lumped::{
    BushingRecord, HubRecord, LinearStripRecord, LumpedRecord, OscillatorRecord,
};
use crate::results::by_angle::record::{
    AngleLawRecord, ContactRecord, FixedLoadRecord, FixedReferenceRecord, ShiftRecord, ShiftTouchRecord,
    StiffnessByAngleRecord,
};
use crate::results::springs::band_record::{
    BandPointRecord, ErrorBandRecord, HorizontalBandRecord, ReferenceBandRecord,
};
use crate::results::springs::form::FormRecord;
use crate::results::springs::law::LawConstants;
use crate::results::springs::record::{
    BeamFactors, BeamRecord, BoundRecord, ComplianceRecord, HorizontalPointRecord, HorizontalRecord,
    LawRecord, LoadCurveRow, PenaltyRecord, ReferenceRecord, StiffnessRecord, TangentRecord,
};
use crate::results::springs::uncertainty_record::{
    InputUncertaintyRecord, UncertainInputRecord, UncertainLawRecord, UncertainPointRecord, UncertainRecord,
};
use crate::study::PairRecord;

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
    let points: Vec<TangentRecord> = loads()
        .into_iter()
        .enumerate()
        .map(|(n, force_kn)| {
            displacement += (force_kn - before) / law.constants.tangent(0.5 * (force_kn + before)) * 1e3;
            before = force_kn;
            let tangent_kn_per_m = law.constants.tangent(force_kn) * (1.0 + 0.008 * (n as f64).sin());
            TangentRecord { force_kn, displacement_mm: displacement, tangent_kn_per_m }
        })
        .collect();
    let forms = forms(&law.constants, &points);
    ReferenceRecord { reference: name.into(), law, forms, points }
}

/// Laws of all forms of points.
fn forms(constants: &LawConstants, points: &[TangentRecord]) -> Vec<FormRecord> {
    let solid = |p: &TangentRecord| Solid {
        force: p.force_kn * KILONEWTON,
        tangent: p.tangent_kn_per_m * KILONEWTON_PER_METRE,
        displacement: p.displacement_mm * MILLIMETRE,
    };
    let solid: Vec<Solid> = points.iter().map(solid).collect();
    let power = StiffnessLaw::try_from(*constants).expect("the constants are a law");
    fit_forms(&solid, power).expect("the points have laws").iter().map(FormRecord::from).collect()
}

/// Bands of the three references at the loads, wider at small loads.
fn error_band(loads: &[f64]) -> ErrorBandRecord {
    let references = ["foot", "beam", "local"].map(|reference| {
        let points: Vec<BandPointRecord> = loads
            .iter()
            .map(|&force_kn| {
                let grid = 0.02 / force_kn.sqrt();
                BandPointRecord {
                    force_kn,
                    grid_displacement: Some(-grid),
                    grid_tangent: Some(2.0 * grid),
                    mesh_displacement: Some(0.004),
                    mesh_tangent: Some(-0.01),
                    scatter_displacement: None,
                    scatter_tangent: None,
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

/// Two inputs, of which the rail's inclination decides.
fn uncertainty() -> InputUncertaintyRecord {
    let input = |name: &str, key: &str, standard: f64, unit: &str, distribution: &str| UncertainInputRecord {
        name: name.into(),
        key: Some(format!("uncertainty.{key}")),
        standard: Some(standard),
        unit: unit.into(),
        distribution: distribution.into(),
    };
    let value = |changes: [f64; 2], sampled: bool| {
        let linear = changes[0].hypot(changes[1]);
        UncertainRecord {
            changes: changes.to_vec(),
            shares: changes.iter().map(|change| (change / linear).powi(2)).collect(),
            linear,
            sampled: sampled.then_some(1.1 * linear),
            percentiles: sampled.then_some([-2.4 * linear, 1.9 * linear]),
            input: 2.1 * linear,
            numerical: Some(0.02),
            combined: Some((2.1 * linear).hypot(0.02)),
        }
    };
    let point = |force_kn: f64| UncertainPointRecord {
        force_kn,
        displacement: value([0.02, 0.007], true),
        tangent: value([-0.05, 0.009], true),
        area: value([-0.07, 0.004], false),
        pressure: value([0.06, 0.005], false),
    };
    let sample = loads();
    InputUncertaintyRecord {
        inputs: vec![
            input("inclination of the rail", "inclination_deg", 0.1, "degrees", "normal"),
            input("Young's modulus of the wheel", "young_percent", 1.2, "%", "rectangular"),
        ],
        samples: 128,
        failed: 0,
        points: [0, sample.len() / 2, sample.len() - 1].map(|i| point(sample[i])).to_vec(),
        horizontal: Some(value([-0.004, 0.01], false)),
        law: Some(UncertainLawRecord {
            a_kn_per_m: 3e3,
            b_kn_per_m: 2e4,
            c: 0.012,
            covariance: [[9e6, -3e7, 5.0], [-3e7, 4e8, -200.0], [5.0, -200.0, 1.44e-4]],
        }),
        missing: None,
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
            error_band: Some(HorizontalBandRecord {
                meshes: vec![0.02, 0.021, 0.022, 0.023],
                band: Some(0.023),
                missing: None,
            }),
        }),
        law_end: None,
        horizontal_end: None,
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
        error_band: Some(error_band(&loads())),
        assumed: None,
        input_uncertainty: Some(uncertainty()),
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
        subsurface: Vec::new(),
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
                surface_young_gpa: None,
                surface_poisson: None,
                named: (body == "rail").then(|| NamedRecord {
                    held_nodes: 399,
                    contact_faces: 960,
                    groups: vec![GroupRecord { name: "rail".into(), elements: 16820 }],
                }),
            })
            .to_vec(),
        profiles: vec![ProfileRecord {
            body: "wheel".into(),
            file: "worn.prw".into(),
            content_hash: Some("cdcd".repeat(16)),
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
            hertz: Some(HertzRecord {
                semi_axis_along_mm: 1.3,
                semi_axis_across_mm: 0.9,
                max_pressure_mpa: 410.0,
            }),
            rail_radius_mm: 300.0,
            wheel_radius_mm: -330.0,
            rolling_radius_mm: 429.4,
        },
        pair: PairRecord { name: "60E1 and S1002".into(), hash: "89abcdef".repeat(8) },
        input_hash: "0123456789abcdef".repeat(4),
        version: "0.1.0".into(),
        commit: "commit 0123456789ab".into(),
        content_blake3: String::new(),
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
            solid_secant_kn_per_m: 1e3 * p.force_kn / p.displacement_mm,
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
            contact_area_rel_error_band: Some(0.004),
            max_pressure_rel_error_band: Some(0.02),
            von_mises_rel_error_band: Some(0.01),
            von_mises_depth_rel_error_band: Some(0.05),
            shear_rel_error_band: Some(0.01),
            shear_depth_rel_error_band: Some(0.05),
        })
        .collect()
}

/// Laws at three shifts: whole on the tread, up to 40 kN on the flange, none where the wheel misses the rail.
pub(crate) fn by_angle() -> StiffnessByAngleRecord {
    let sample = stiffness();
    let laws = || {
        let entry = |reference: &ReferenceRecord| AngleLawRecord {
            reference: reference.reference.clone(),
            law: reference.law,
            forms: reference.forms.clone(),
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
        contacts: vec![ContactRecord { force_kn: force, contact_angle_deg: angle }],
        hub_um_per_kn: [13.0, -0.002 * angle, 3.0 * force.powf(-0.3)],
        condensed_hub_um_per_kn: Some([12.9, -0.003 * angle, 3.1 * force.powf(-0.3)]),
        condensed_displacement_mm: Some(0.0101 * force.powf(0.7)),
        lumped_hub_um_per_kn: Some([12.8, -0.004 * angle, 3.2 * force.powf(-0.3)]),
        lumped_displacement_mm: Some(0.0103 * force.powf(0.7)),
        published_hub_um_per_kn: Some([12.5, 0.0, 2.5 * force.powf(-0.3)]),
        published_displacement_mm: Some(0.008 * force.powf(0.7)),
        horizontal_kn_per_m: 4e5,
        tangential_kn_per_m: 4.1e5,
        lateral_contact_um_per_kn: Some(2.2),
        contact_area_mm2: 80.0,
        max_pressure_mpa: 900.0,
        semi_axis_along_mm: 6.0,
        semi_axis_across_mm: 4.0,
        max_von_mises_mpa: Some(700.0),
        von_mises_depth_mm: Some(2.1),
        max_shear_mpa: Some(390.0),
        shear_depth_mm: Some(2.1),
        patch_error_band: None,
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
        shared_from_kn: None,
        loads: loads.iter().map(|force| load(*force, angle.unwrap_or_default())).collect(),
        published_secant_ratio: None,
        error_band: (!loads.is_empty()).then(|| error_band(loads)),
        reason: reason.map(String::from),
    };
    StiffnessByAngleRecord {
        element: None,
        lumped: None,
        element_missing: None,
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
        commit: "commit 0123456789ab".into(),
        content_blake3: String::new(),
    }
}

/// A lumped element of two oscillators.
pub(crate) fn lumped() -> LumpedRecord {
    let oscillator = |frequency_hz: f64, coupling_kg: [f64; 2], coupling_turn_kg_m: f64| OscillatorRecord {
        frequency_hz,
        rim_lateral: 0.1,
        rim_turn_per_m: -0.3,
        coupling_kg,
        coupling_turn_kg_m,
    };
    let bushing = |turn_knm_per_rad: f64| BushingRecord {
        lateral_kn_per_m: 1.5e6,
        vertical_kn_per_m: 6.9e6,
        turn_knm_per_rad,
        height_mm: 119.0,
    };
    let strip = |rail_s_mm: f64| LinearStripRecord { rail_s_mm, modulus_gpa: 120.0, tangential_gpa: 100.0 };
    LumpedRecord {
        hub: HubRecord {
            mass_kg: 307.8,
            inertia_kg_m2: 18.7,
            gravity_centre_mm: [-5.0, 0.5],
            centre_mm: [0.0, -429.0],
        },
        oscillators: vec![oscillator(188.0, [0.0, 0.3], -4.2), oscillator(265.0, [-15.5, 0.0], -0.03)],
        rim_offset_mm: 2.0,
        bushing: bushing(1.9e3),
        bushing_on_section: bushing(1.6e3),
        held_end: None,
        strips: vec![strip(0.0), strip(1.0)],
        strips_max_rel_error: 0.2,
        displacement: None,
        section_misfit: [0.01, 0.05],
        error_band: None,
    }
}
