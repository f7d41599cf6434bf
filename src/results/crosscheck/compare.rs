//! The tool's answers against a reference solver's: quantity by quantity, with limits
//! that say where a difference may come from.

use std::path::Path;

use nalgebra::Vector3;
use railspring_calibrate::calibration::{HorizontalPoint, PatchValues};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::input;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE, SQUARE_MILLIMETRE};
use serde::Deserialize;

use crate::engine::output::{OutputFolder, read_json};
use crate::results::crosscheck::answers::{AnsweredBody, AnsweredCurve, Answers};
use crate::results::crosscheck::exchange::{BODIES, Case};
use crate::results::crosscheck::record::{
    Cause, Check, HORIZONTAL_STIFFNESS, HUB_DISPLACEMENT, Limit, Provenance, TANGENT_STIFFNESS, Timing,
};

/// Same equations, other order of sums: about 1e-16 times the condition number of the meshes, 1e6.
pub const ROUNDOFF: f64 = 1e-9;
/// Hub displacement of two contact formulations with the same contact nodes: they take their integrals over a cell
/// by other rules and along other normals, which moves the nodes' gaps by shares of their curvature over a cell.
pub const DISCRETISATION_DISPLACEMENT: f64 = 5e-3;
/// Tangent stiffness of the same: one order lower in the element size than the displacement.
pub const DISCRETISATION_TANGENT: f64 = 1e-2;
/// Contact area of the same, in rings of elements around the patch: a node at its border may carry or not.
pub const DISCRETISATION_RINGS: f64 = 1.0;
/// Hub displacement with the contact forces on the nodes of the other surface: either side has an error of its own.
pub const DISCRETISATION_SURFACE: f64 = 2.0 * DISCRETISATION_DISPLACEMENT;
/// Tangent stiffness of the same: of the six nodes that carry the smallest load two more or less may do so, a third
/// of the area; stiffness goes with its root, and two thirds of the compliance are local: 1/2 · 1/3 · 2/3.
pub const DISCRETISATION_NODES: f64 = 0.11;
/// First-order bricks with incompatible modes against elements of second order on another mesh.
pub const DISCRETISATION_ELEMENT: f64 = 2e-2;
/// Lateral flexibility of each body in another program: its element of the same name has the same modes, mapped in another way where elements are
/// distorted. Both elements converge to the same body, so that they differ by no more than one of them from elements of second order.
pub const MODEL_ELEMENT: f64 = DISCRETISATION_ELEMENT;
/// Another program's own contact between the same facets.
pub const MODEL: f64 = 1e-2;

/// The limits that the checks use, for whoever must assess them.
pub fn limits(checks: &[Check]) -> Vec<Limit> {
    let contact = "another contact formulation on the same mesh and contact nodes";
    let surface = "contact forces on the nodes of the other surface";
    let element = "elements of second order on another mesh";
    let all = [
        (
            Cause::Roundoff,
            ROUNDOFF,
            "displacements and compliances on the same mesh and element, loads, sign of the Jacobian".into(),
            "the same equations in another order: rounding of 1e-16 times the condition number of the meshes, 1e6, \
             with a margin of ten",
        ),
        (
            Cause::Discretisation,
            DISCRETISATION_DISPLACEMENT,
            format!("{HUB_DISPLACEMENT} and {HORIZONTAL_STIFFNESS}, {contact}"),
            "integrals over a cell by other rules and along other normals, a share of the gap's curvature over a cell",
        ),
        (
            Cause::Discretisation,
            DISCRETISATION_TANGENT,
            format!("{TANGENT_STIFFNESS}, {contact}"),
            "one order lower in the element size than the displacement",
        ),
        (
            Cause::Discretisation,
            DISCRETISATION_RINGS,
            "contact area, in rings of elements around the patch".into(),
            "a node at the border of the patch may carry or not",
        ),
        (
            Cause::Discretisation,
            DISCRETISATION_SURFACE,
            format!("{HUB_DISPLACEMENT}, {surface}"),
            "either side has a discretisation error of its own",
        ),
        (
            Cause::Discretisation,
            DISCRETISATION_NODES,
            format!("{TANGENT_STIFFNESS}, {surface}"),
            "two of six nodes more or less carry the smallest load, a third of the area; stiffness goes with its root, \
             and two thirds of the compliance are local: 1/2 · 1/3 · 2/3",
        ),
        (
            Cause::Discretisation,
            DISCRETISATION_ELEMENT,
            format!("{HUB_DISPLACEMENT} and {HORIZONTAL_STIFFNESS}, {element}"),
            "first-order bricks bend too stiffly by about the square of element over wall thickness",
        ),
        (
            Cause::Discretisation,
            2.0 * DISCRETISATION_ELEMENT,
            format!("{TANGENT_STIFFNESS}, {element}"),
            "twice that of the displacement: one order lower in the element size",
        ),
        (
            Cause::Model,
            MODEL_ELEMENT,
            "lateral flexibility of a body in another program".into(),
            "an element of the same kind whose inner modes are mapped in another way where it is distorted: no more than elements of \
             second order differ",
        ),
        (
            Cause::Model,
            MODEL,
            "another program with its own contact".into(),
            "contact forces and gaps between the same facets weighted by other functions",
        ),
    ];
    all.into_iter()
        .filter(|(cause, value, ..)| checks.iter().any(|c| c.cause == *cause && c.limit == *value))
        .map(|(cause, value, applies_to, derivation)| Limit {
            cause,
            value,
            applies_to,
            derivation: derivation.into(),
        })
        .collect()
}

/// What the reference wrote.
#[derive(Debug, Clone, Deserialize)]
pub struct ReferenceResult {
    elastic: std::collections::BTreeMap<String, ElasticResult>,
    contact: std::collections::BTreeMap<String, CurveResult>,
    /// Versions, hash, date, time.
    pub provenance: Provenance,
    #[serde(skip)]
    displacement: Vec<Vec<Vector3<f64>>>,
}

#[derive(Debug, Clone, Deserialize)]
struct ElasticResult {
    displacement_file: String,
    compliance_columns: Vec<Vec<f64>>,
    smallest_jacobian: f64,
}

#[derive(Debug, Clone, Deserialize)]
struct CurveResult {
    rows: Vec<RowResult>,
    horizontal: Vec<HorizontalResult>,
    degrees_of_freedom: usize,
    seconds: f64,
}

#[derive(Debug, Clone, Deserialize)]
struct HorizontalResult {
    load_n: f64,
    stiffness_n_per_m: f64,
}

#[derive(Debug, Clone, Deserialize)]
struct RowResult {
    load_n: f64,
    hub_m: f64,
    tangent_n_per_m: f64,
    area_m2: f64,
}

impl ReferenceResult {
    /// Reads `reference.json` and the displacement files of an exchange folder.
    ///
    /// # Errors
    /// Files that are absent or of another layout.
    pub fn read(folder: &OutputFolder) -> Result<Self> {
        let mut result: Self = read_json(&folder.file("reference.json"), "crosscheck")?;
        for body in BODIES {
            let elastic = result.elastic(body)?;
            let path = folder.file(&elastic.displacement_file);
            result.displacement.push(read_vectors(&path)?);
        }
        Ok(result)
    }

    fn elastic(&self, body: &str) -> Result<&ElasticResult> {
        self.elastic.get(body).ok_or_else(|| incomplete("elastic", body).into())
    }

    /// Nodal displacements of a body (0 rail, 1 wheel) under the given forces, m.
    pub fn displacement(&self, body: usize) -> &[Vector3<f64>] {
        &self.displacement[body]
    }

    /// Name of the reference solver with its version.
    pub fn solver_name(&self) -> String {
        let version = self.provenance.packages.get("scikit-fem").map_or("", String::as_str);
        format!("scikit-fem {version}")
    }
}

fn incomplete(section: &str, name: &str) -> InputError {
    InputError::new(
        "reference.json",
        format!("no {section}.{name}"),
        "a result for every question",
        "run `railspring crosscheck` again",
    )
}

/// Largest answer that is read, bytes.
const LARGEST: u64 = 4 << 30;

fn read_vectors(path: &Path) -> Result<Vec<Vector3<f64>>> {
    let bytes = input::read(path, LARGEST).map_err(|cause| {
        InputError::new(
            path.display().to_string(),
            cause,
            "displacements as the reference writes them",
            "run `railspring crosscheck` again",
        )
    })?;
    let (values, _) = bytes.as_chunks::<8>();
    let values: Vec<f64> = values.iter().map(|v| f64::from_le_bytes(*v)).collect();
    Ok(values.chunks_exact(3).map(|u| Vector3::new(u[0], u[1], u[2])).collect())
}

/// All checks against the reference, and the times.
///
/// # Errors
/// An answer that is not there.
pub fn compare(
    answers: &Answers,
    contact_element: f64,
    cases: &[Case],
    reference: &ReferenceResult,
) -> Result<(Vec<Check>, Vec<Timing>)> {
    let reference_solver = reference.solver_name();
    let mut checks = Vec::new();
    for (k, (name, body)) in BODIES.iter().zip([&answers.rail, &answers.wheel]).enumerate() {
        elastic_checks(
            name,
            body,
            reference.displacement(k),
            reference.elastic(name)?,
            &reference_solver,
            &mut checks,
        );
    }
    let mut timings = Vec::new();
    for &case in cases {
        let (problem, curve) = match case {
            Case::SameMesh => ("contact without friction".to_string(), &answers.frictionless),
            Case::SameMeshFriction => match &answers.frictional {
                Some(curve) => (format!("contact with friction {}", answers.friction), curve),
                None => continue,
            },
            Case::OtherSurface => {
                ("contact without friction, forces on the wheel's nodes".to_string(), &answers.frictionless)
            }
            Case::SecondOrder => {
                (format!("{} against elements of second order", answers.element), &answers.frictionless)
            }
        };
        let theirs = reference
            .contact
            .get(case.name())
            .filter(|theirs| theirs.rows.len() == curve.points.len())
            .ok_or_else(|| incomplete("contact", case.name()))?;
        curve_checks(&problem, case, curve, theirs, contact_element, &reference_solver, &mut checks);
        let asked = matches!(case, Case::SameMeshFriction | Case::SecondOrder);
        if asked && theirs.horizontal.len() != answers.horizontal.len() {
            return Err(incomplete("horizontal", case.name()).into());
        }
        for (own, theirs) in answers.horizontal.iter().zip(&theirs.horizontal) {
            checks.push(horizontal_check(&problem, case, own, theirs, &reference_solver));
        }
        timings.push(Timing {
            problem,
            reference_solver: reference_solver.clone(),
            degrees_of_freedom: theirs.degrees_of_freedom,
            loads: theirs.rows.len(),
            tool_seconds: curve.seconds,
            reference_seconds: theirs.seconds,
        });
    }
    Ok((checks, timings))
}

fn elastic_checks(
    name: &str,
    body: &AnsweredBody,
    displacement: &[Vector3<f64>],
    theirs: &ElasticResult,
    reference_solver: &str,
    checks: &mut Vec<Check>,
) {
    let problem = format!("{name}, same mesh and element");
    let mut check = |quantity: &str, unit: &str, values: (f64, f64), difference: f64| {
        let (quantity, limit) = (format!("{name}: {quantity}"), (ROUNDOFF, Cause::Roundoff));
        checks.push(Check::new(&problem, &quantity, None, unit, values, reference_solver, difference, limit));
    };
    let sign = theirs.smallest_jacobian.signum();
    check("sign of the smallest Jacobian determinant", "1", (1.0, sign), (1.0 - sign).abs());
    let largest = |field: &[Vector3<f64>]| field.iter().map(Vector3::norm).fold(0.0, f64::max);
    let scale = largest(&body.displacement);
    let difference = if displacement.len() == body.displacement.len() {
        displacement.iter().zip(&body.displacement).map(|(a, b)| (a - b).norm()).fold(0.0, f64_max)
    } else {
        f64::NAN
    };
    let values = (scale / MILLIMETRE, largest(displacement) / MILLIMETRE);
    let quantity = "nodal displacements under given forces, largest difference";
    check(quantity, "mm", values, difference / scale);
    for (k, own) in body.compliance.iter().enumerate() {
        let size = |column: &[f64]| column.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let theirs = theirs.compliance_columns.get(k).map_or(&[][..], Vec::as_slice);
        let difference = if theirs.len() == own.len() {
            own.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64_max)
        } else {
            f64::NAN
        };
        let values = (size(own) * KILONEWTON / MILLIMETRE, size(theirs) * KILONEWTON / MILLIMETRE);
        check("compliance columns, largest difference", "mm/kN", values, difference / size(own));
    }
}

/// The horizontal stiffness of one preload.
fn horizontal_check(
    problem: &str,
    case: Case,
    own: &HorizontalPoint,
    theirs: &HorizontalResult,
    reference_solver: &str,
) -> Check {
    let limit = match case {
        Case::SecondOrder => DISCRETISATION_ELEMENT,
        _ => DISCRETISATION_DISPLACEMENT,
    };
    // an answer to another load is none
    let same = (theirs.load_n / own.preload - 1.0).abs() <= ROUNDOFF;
    let stiffness = if same { theirs.stiffness_n_per_m } else { f64::NAN };
    Check::new(
        problem,
        HORIZONTAL_STIFFNESS,
        Some(own.preload),
        "kN/m",
        (own.stiffness / KILONEWTON_PER_METRE, stiffness / KILONEWTON_PER_METRE),
        reference_solver,
        (stiffness / own.stiffness - 1.0).abs(),
        (limit, Cause::Discretisation),
    )
}

/// The larger one; not a number if either is.
fn f64_max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn curve_checks(
    problem: &str,
    case: Case,
    curve: &AnsweredCurve,
    theirs: &CurveResult,
    contact_element: f64,
    reference_solver: &str,
    checks: &mut Vec<Check>,
) {
    let (displacement, tangent) = match case {
        Case::SecondOrder => (DISCRETISATION_ELEMENT, 2.0 * DISCRETISATION_ELEMENT),
        Case::OtherSurface => (DISCRETISATION_SURFACE, DISCRETISATION_NODES),
        Case::SameMesh | Case::SameMeshFriction => (DISCRETISATION_DISPLACEMENT, DISCRETISATION_TANGENT),
    };
    for ((own, patch), theirs) in curve.points.iter().zip(&curve.patches).zip(&theirs.rows) {
        let mut check = |(quantity, unit, factor), (tool, other): (f64, f64), difference, limit| {
            let values = (tool / factor, other / factor);
            let load = Some(own.force);
            checks.push(Check::new(
                problem,
                quantity,
                load,
                unit,
                values,
                reference_solver,
                difference,
                limit,
            ));
        };
        let relative = |(tool, other): (f64, f64)| (other / tool - 1.0).abs();
        let values = (own.force, theirs.load_n);
        check(("load", "kN", KILONEWTON), values, relative(values), (ROUNDOFF, Cause::Roundoff));
        let (values, limit) = ((own.displacement, theirs.hub_m), (displacement, Cause::Discretisation));
        check((HUB_DISPLACEMENT, "mm", MILLIMETRE), values, relative(values), limit);
        let (values, limit) = ((own.solid_tangent, theirs.tangent_n_per_m), (tangent, Cause::Discretisation));
        check((TANGENT_STIFFNESS, "kN/m", KILONEWTON_PER_METRE), values, relative(values), limit);
        if case != Case::SecondOrder {
            let quantity = ("contact area, difference in rings of elements", "mm²", SQUARE_MILLIMETRE);
            let values = (patch.area, theirs.area_m2);
            let rings = (patch.area - theirs.area_m2).abs() / (perimeter(patch) * contact_element);
            check(quantity, values, rings, (DISCRETISATION_RINGS, Cause::Discretisation));
        }
    }
}

/// Perimeter of the contact ellipse, m (S. Ramanujan's first approximation, 1914).
fn perimeter(patch: &PatchValues) -> f64 {
    let (a, b) = (patch.semi_axis_along, patch.semi_axis_across);
    std::f64::consts::PI * (3.0 * (a + b) - ((3.0 * a + b) * (a + 3.0 * b)).sqrt())
}
