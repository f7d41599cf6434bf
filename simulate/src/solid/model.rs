//! What the transient solid model is made of.

use super::path::RailPath;
use crate::axle::axle_stiffness;
use nalgebra::Point2;
use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::mesh::{HexMesh, SurfaceGrid};
use railspring_calibrate::pair::{Pair, PairBody};
use railspring_calibrate::solid::{Formulation, Material, Materials};
use railspring_calibrate::superelement::{CondensedBody, Modes};
use railspring_profiles::error::Result;
use railspring_profiles::placement::PlacedRail;

/// Everything the transient solid model is made of.
pub struct TransientModel<'a> {
    /// Rail and wheel.
    pub bodies: SolidBodies<'a>,
    /// Materials at the contact surfaces of rail and wheel, with the damping of both bodies, which is the same.
    pub materials: [Material; 2],
    /// The placed rail, for positions in its profile frame.
    pub placed_rail: &'a PlacedRail,
    /// The rail's shear centre, world (y, z), m: about it its section turns under the wheel. None: it turns where the contact is.
    pub rail_axis: Option<Point2<f64>>,
    /// Contact surface of the rail.
    pub rail_surface: Surface<'a>,
    /// Contact surface of the wheel, just touching.
    pub wheel_surface: Surface<'a>,
    /// Stiffness of the axle against the hub's rotations about the track and about the vertical, N·m/rad, in scenarios that free them.
    pub axle: f64,
    /// How the contact conditions are enforced.
    pub enforcement: Enforcement,
    /// Where the contact lives.
    pub field: ContactField,
    /// The rail at all places of the wheel; none: the wheel stays in its middle. Of reduced bodies alone.
    pub path: Option<&'a RailPath>,
}

/// Rail and wheel of a transient model: the rail in the world frame with its ends held, the wheel in its body frame with its bore
/// following the master node at its centre.
#[derive(Clone, Copy)]
pub enum SolidBodies<'a> {
    /// All equations of the meshes, factored for the time step: what reduced bodies are compared with.
    Full {
        /// Mesh of the rail.
        rail: &'a HexMesh,
        /// Mesh of the wheel.
        wheel: &'a HexMesh,
        /// Materials of rail and wheel.
        materials: [&'a Materials; 2],
        /// Element of both.
        formulation: Formulation,
    },
    /// Condensed bodies with their modes ([`CondensedBody::modes`]).
    Reduced {
        /// The rail between its ends.
        rail: &'a CondensedBody,
        /// The wheel against its hub.
        wheel: &'a CondensedBody,
        /// How many of their modes are used.
        modes: ModeCount,
    },
}

/// How many modes of its bodies a reduced run uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModeCount {
    /// As many as it takes until P and Q change by less than 0.3 % of their peaks.
    Estimated,
    /// So many of each body, or all that it has.
    Given(usize),
}

impl<'a> TransientModel<'a> {
    /// The solid model of a pair at full order.
    pub fn of_pair(
        pair: &'a Pair,
        [rail, wheel]: [&'a HexMesh; 2],
        materials: [&'a Materials; 2],
        formulation: Formulation,
        contact: (Enforcement, ContactField),
    ) -> Self {
        let bodies = SolidBodies::Full { rail, wheel, materials, formulation };
        let surfaces = [materials[0].at_contact(rail), materials[1].at_contact(wheel)];
        Self::with(pair, bodies, [&rail.contact, &wheel.contact], surfaces, contact)
    }

    /// The solid model of a pair with reduced bodies: the rail between its ends and the wheel, both with modes and with a `damping`
    /// ([`Material::damping`]).
    ///
    /// # Errors
    /// Bodies that are not of the `pair` ([`Pair::check_body`]).
    pub fn reduced(
        pair: &'a Pair,
        [rail, wheel]: [&'a CondensedBody; 2],
        modes: ModeCount,
        damping: f64,
        contact: (Enforcement, ContactField),
    ) -> Result<Self> {
        pair.check_body(PairBody::RailOnEnds, rail)?;
        pair.check_body(PairBody::Wheel, wheel)?;
        let bodies = SolidBodies::Reduced { rail, wheel, modes };
        let surfaces = [rail, wheel].map(|body| Material { damping, ..body.surface });
        Ok(Self::with(pair, bodies, [&rail.grid, &wheel.grid], surfaces, contact))
    }

    /// The bodies of a pair with the grids of their contact surfaces.
    fn with(
        pair: &'a Pair,
        bodies: SolidBodies<'a>,
        [rail, wheel]: [&'a SurfaceGrid; 2],
        materials: [Material; 2],
        (enforcement, field): (Enforcement, ContactField),
    ) -> Self {
        Self {
            bodies,
            materials,
            placed_rail: &pair.placed,
            rail_axis: Some(pair.node_line()),
            rail_surface: pair.rail_surface(rail),
            wheel_surface: pair.wheel_surface(wheel),
            axle: axle_stiffness(pair, &materials[1]),
            enforcement,
            field,
            path: None,
        }
    }

    /// The same with a wheel that moves along its rail, or stands anywhere on it, and a torsion of that ([`RailPath::is_wanted`]).
    pub fn along(self, path: &'a RailPath) -> Self {
        Self { path: Some(path), ..self }
    }
}

impl TransientModel<'_> {
    /// Damping of both bodies, s.
    pub(super) fn damping(&self) -> f64 {
        self.materials[0].damping
    }

    /// The number of modes that the body with more of them has.
    pub(super) fn most_modes(&self) -> usize {
        let SolidBodies::Reduced { rail, wheel, .. } = self.bodies else { return 0 };
        let of_rail = self.path.map(RailPath::modes).or(rail.modes.as_ref());
        [of_rail, wheel.modes.as_ref()].into_iter().flatten().map(Modes::count).max().unwrap_or(0)
    }
}
