//! OpenSees: `ElasticMultiLinear` in a `zeroLength`, as Python and as Tcl.
//!
//! OpenSees goes on with the slope of the last two points on either side: two points of no force in tension are a branch
//! without tension, and a load beyond the law's range is extrapolated, which the heading says.

use super::points::Points;
use super::spring::{ExportFile, Spring, commented};

/// Where the branch without tension begins, over the displacement of the first point. At the corner itself OpenSees takes
/// the stiffness of the branch, none, so that a spring that is not loaded yet would be singular at 0.
const CORNER: f64 = 1e-6;

/// What the Python file has besides the points: the spring between two nodes, and its displacements under loads.
const PYTHON: &str = r#"

def define(ops, material, element, rail_node, wheel_node, direction):
    """Puts the spring between two nodes at one place; the direction points from the rail to the wheel."""
    ops.uniaxialMaterial("ElasticMultiLinear", material, 0.0, "-strain", *DISPLACEMENT, "-stress", *FORCE)
    ops.element("zeroLength", element, rail_node, wheel_node, "-mat", material, "-dir", direction)


def pressed(ops, force_kn):
    """Compression (m) of the spring under a force of the law's range."""
    if not 0 < 1e3 * force_kn <= -FORCE[0]:
        raise ValueError(f"{force_kn} kN: expected a force above 0 and up to {-1e-3 * FORCE[0]} kN, where the law ends")
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    define(ops, 1, 1, 1, 2, 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(2, -1e3 * force_kn)
    ops.system("BandGeneral")
    ops.numberer("Plain")
    ops.constraints("Plain")
    ops.test("NormUnbalance", 1e-6 * force_kn, 100)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    if ops.analyze(1) != 0:
        raise RuntimeError(f"no equilibrium under {force_kn} kN")
    return -ops.nodeDisp(2, 1)


if __name__ == "__main__":
    # python wheel_rail_spring.py 10 50: the compression (m) under 10 and 50 kN
    import sys

    import openseespy.opensees as opensees

    for argument in sys.argv[1:]:
        print(argument, pressed(opensees, float(argument)))
"#;

/// What the Tcl file has besides the points.
const TCL: &str = r#"
# Puts the spring between two nodes at one place; the direction points from the rail to the wheel.
proc wheelRailSpring {material element railNode wheelNode direction} {
    global wheelRailDisplacement wheelRailForce
    uniaxialMaterial ElasticMultiLinear $material 0.0 -strain {*}$wheelRailDisplacement -stress {*}$wheelRailForce
    element zeroLength $element $railNode $wheelNode -mat $material -dir $direction
}
"#;

/// Both files.
pub(super) fn files(spring: &Spring) -> Vec<ExportFile> {
    let points = Points::of(spring);
    let own = [
        points.sentence(spring.range[0]),
        "units: N, m; displacement of the wheel from the rail and force are negative in compression".into(),
        "no tension: the last two points, the corner beside 0 so that the spring is not singular there; beyond the first one OpenSees goes on with the last slope, which is no law".into(),
    ];
    let heading = commented("#", &spring.heading("Contact spring of a wheel on a rail, OpenSees", &own));
    let corner = CORNER * points.points[1][0];
    let mut turned = points.compression_negative();
    turned.iter_mut().filter(|point| point[0] == 0.0).for_each(|point| point[0] = corner);
    let column = |column: usize, between: &str| -> String {
        turned.iter().map(|point| format!("    {:.9e}{between}\n", point[column])).collect()
    };
    let python =
        format!("{heading}\nDISPLACEMENT = [\n{}]\nFORCE = [\n{}]\n{PYTHON}", column(0, ","), column(1, ","));
    let tcl = format!(
        "{heading}\nset wheelRailDisplacement {{\n{}}}\nset wheelRailForce {{\n{}}}\n{TCL}",
        column(0, ""),
        column(1, "")
    );
    vec![
        ExportFile { name: "wheel_rail_spring.py".into(), text: python },
        ExportFile { name: "wheel_rail_spring.tcl".into(), text: tcl },
    ]
}
