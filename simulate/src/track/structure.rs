//! What a track consists of: a rail, what carries it, and a bridge under it.

use railspring_calibrate::beam::{BeamElement, BeamSection, deflection_functions, rotation_functions};

use crate::time::scenario::Kelvin;

/// A beam that bends in the vertical plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineBeam {
    /// Its section, of which deflection along z counts.
    pub section: BeamSection,
    /// Damping proportional to stiffness, s.
    pub damping: f64,
    /// Damping proportional to mass, 1/s.
    pub mass_damping: f64,
}

/// A bridge under the rail, with nodes where the rail has nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridge {
    /// Its beam.
    pub beam: LineBeam,
    /// Its first and last node.
    pub nodes: [usize; 2],
}

/// Which of the beams.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    /// The rail.
    Rail,
    /// The bridge.
    Bridge,
}

/// What a support acts against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Displacement along z.
    Vertical,
    /// Rotation in the vertical plane.
    Rotation,
}

/// A coordinate of a node that does not move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Held {
    /// The beam.
    pub of: Carrier,
    /// Its node.
    pub node: usize,
    /// The coordinate.
    pub direction: Direction,
}

/// What layers stand on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Onto {
    /// The ground.
    Ground,
    /// The bridge at the same place.
    Bridge,
}

/// A support that gives way: a layer of springs and dampers, or two with a mass between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layers {
    /// The beam that it carries.
    pub of: Carrier,
    /// Where, m from the rail's first end.
    pub x: f64,
    /// Which coordinate.
    pub direction: Direction,
    /// The upper layer, as the pad under a rail; of a rotation in N·m/rad and N·m·s/rad.
    pub upper: Kelvin,
    /// The mass below, kg, and the layer under it, as a sleeper on ballast.
    pub below: Option<(f64, Kelvin)>,
    /// What it stands on.
    pub onto: Onto,
}

/// A rail with all that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Length, m.
    pub length: f64,
    /// Number of elements of the rail, all as long.
    pub elements: usize,
    /// The rail.
    pub rail: LineBeam,
    /// The bridge.
    pub bridge: Option<Bridge>,
    /// A bed under the whole rail, a metre of it: N/m², N·s/m². It stands on the ground.
    pub bed: Option<Kelvin>,
    /// What does not move.
    pub held: Vec<Held>,
    /// What gives way.
    pub layers: Vec<Layers>,
}

impl Track {
    /// Whether something holds the rail at rest: the stiffness of its supports against both of its rigid motions, of which rounding would leave a
    /// little where there is none.
    pub fn is_held(&self) -> bool {
        let on_bridge = self.bridge.is_some() && self.holds(Carrier::Bridge, false);
        self.holds(Carrier::Rail, on_bridge)
    }

    /// Whether supports hold a beam; those that stand on the bridge if that is held.
    fn holds(&self, of: Carrier, on_bridge: bool) -> bool {
        if of == Carrier::Rail && self.bed.is_some_and(|bed| bed.stiffness > 0.0) {
            return true;
        }
        let stiff = |layers: &&Layers| {
            let below = layers.below.is_none_or(|(_, layer)| layer.stiffness > 0.0);
            layers.of == of
                && layers.upper.stiffness > 0.0
                && below
                && (layers.onto == Onto::Ground || on_bridge)
        };
        let pitch = self.length / self.elements as f64;
        let held = self.held.iter().filter(|held| held.of == of);
        let held = held.map(|held| (held.node as f64 * pitch, held.direction));
        let all = held.chain(self.layers.iter().filter(stiff).map(|layers| (layers.x, layers.direction)));
        // one against the deflection, and another one elsewhere or one against rotation
        let (mut first, mut turned) = (None, false);
        for (x, direction) in all {
            match (direction, first) {
                (Direction::Rotation, _) => turned = true,
                (Direction::Vertical, None) => first = Some(x),
                (Direction::Vertical, Some(before)) => turned |= (x - before).abs() > 1e-9 * self.length,
            }
        }
        first.is_some() && turned
    }
}

/// An element's matrix in its two nodes with deflection and rotation each.
pub(super) type Matrix4 = [[f64; 4]; 4];
/// A row that gives a displacement from the same.
pub(super) type Row4 = [f64; 4];

/// Deflection along z and rotation about y of both nodes among the degrees of freedom of [`BeamElement`].
const PLANE: [usize; 4] = [2, 4, 8, 10];

/// Stiffness and mass of an element of `length` m.
pub(super) fn matrices(section: &BeamSection, length: f64) -> [Matrix4; 2] {
    let element = BeamElement { section, length, angle: 0.0 };
    [element.stiffness(), element.mass()]
        .map(|matrix| PLANE.map(|row| PLANE.map(|column| matrix[(row, column)])))
}

/// 12·EI/(κGA·L²) of an element.
pub(super) fn shear_parameter(section: &BeamSection, length: f64) -> f64 {
    BeamElement { section, length, angle: 0.0 }.shear_parameters()[1]
}

/// The deflection at `xi`, 0 to 1. A positive rotation about y tilts the axis to negative z.
pub(super) fn deflection(section: &BeamSection, length: f64, xi: f64) -> Row4 {
    let [a, b, c, d] = deflection_functions(xi, length, shear_parameter(section, length));
    [a, -b, c, -d]
}

/// The rotation about y at `xi`.
pub(super) fn rotation(section: &BeamSection, length: f64, xi: f64) -> Row4 {
    let [a, b, c, d] = rotation_functions(xi, length, shear_parameter(section, length));
    [-a, b, -c, d]
}

/// The bending moment at `xi`, N·m, positive where the lower side is in tension.
pub(super) fn moment(section: &BeamSection, length: f64, xi: f64) -> Row4 {
    let f = shear_parameter(section, length);
    let (l, d) = (length, section.bending_z / (1.0 + f));
    let curvature = [
        (12.0 * xi - 6.0) / (l * l),
        (6.0 * xi - 4.0 - f) / l,
        (6.0 - 12.0 * xi) / (l * l),
        (6.0 * xi - 2.0 + f) / l,
    ];
    // EI times the slope of the rotation
    [-d * curvature[0], d * curvature[1], -d * curvature[2], d * curvature[3]]
}

/// Stiffness of a bed (1 N/m² along the element) in its nodes.
pub(super) fn bed(section: &BeamSection, length: f64) -> Matrix4 {
    let mut sum = [[0.0; 4]; 4];
    for (xi, weight) in railspring_profiles::quadrature::gauss_4_unit() {
        let row = deflection(section, length, xi);
        for i in 0..4 {
            for j in 0..4 {
                sum[i][j] += weight * length * row[i] * row[j];
            }
        }
    }
    sum
}
