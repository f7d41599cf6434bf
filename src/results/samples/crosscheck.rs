//! Made-up answers of reference solvers.

use crate::results::crosscheck::in_time::compare::{checks, limits};
use crate::results::crosscheck::record::{
    Cause, Check, CrosscheckRecord, ExchangedMesh, ForcesInTime, HUB_DISPLACEMENT, Limit, Provenance,
    Question, RunInTime, SectionCell, SectionDifference, TANGENT_STIFFNESS, Timing,
};
use crate::results::samples::springs::stiffness;

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
        in_time: None,
        content_blake3: String::new(),
    }
}

/// A load case in time: both programs with two lengths of steps, an impact that the reference sees a little smaller.
pub(crate) fn crosscheck_in_time() -> CrosscheckRecord {
    let time_ms: Vec<f64> = (0..=60).map(|n| 0.5 * f64::from(n)).collect();
    let run = |program: &str, step_us: f64, share: f64| {
        let p_kn: Vec<f64> =
            time_ms.iter().map(|t| 34.0 * share * (-0.5 * (t - 16.0) * (t - 16.0)).exp()).collect();
        let q_kn = p_kn.iter().map(|p| 3.0 * p).collect();
        RunInTime { program: program.into(), step_us, p_kn, q_kn }
    };
    let runs = vec![
        run("railspring", 12.5, 1.0),
        run("railspring", 25.0, 1.001),
        run("scikit-fem 11", 12.5, 0.99),
        run("scikit-fem 11", 25.0, 0.993),
    ];
    let forces = ForcesInTime { case: "constant".into(), time_ms, runs };
    CrosscheckRecord { checks: checks(&forces), limits: limits(), in_time: Some(forces), ..crosscheck() }
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
