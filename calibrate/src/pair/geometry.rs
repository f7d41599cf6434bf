//! The two sections in place.

use crate::beam::{RailBeam, Torsion};
use crate::contact::{PairingLimits, Surface, pair};
use crate::mesh::{HexMesh, MeshOptions, SurfaceGrid, mesh_rail, mesh_wheel};
use crate::section_analysis::{RailAnalysis, SectionProperties, StressSample, rail_analysis};
use crate::solid::Material;
use crate::superelement::SectionLoads;
use nalgebra::{Point2, Vector2};
use railspring_profiles::error::Result;
use railspring_profiles::placement::{PlacedRail, Touch, TrackGeometry, place_rail, touch};
use railspring_profiles::section::{RailSection, WheelSection};

/// A wheel on a rail, as two sections in a track.
#[derive(Debug, Clone)]
pub struct Pair {
    /// Section of the rail, in its profile frame.
    pub rail: RailSection,
    /// Section of the wheel, in its profile frame.
    pub wheel: WheelSection,
    /// The rail's section as that of a beam.
    pub properties: SectionProperties,
    /// Shear stresses of the beam's forces on that section, in the profile frame.
    pub shear_stresses: Vec<StressSample>,
    /// The rail in the track.
    pub placed: PlacedRail,
    /// Lateral world position of the tape circle, m.
    pub tape_y: f64,
    /// Where the lowered wheel first touches.
    pub touch: Touch,
    /// How far the surfaces may lie off their bodies: not at all but on bodies of others ([`Pair::carry`]), and where they depart from them
    /// ([`Departure`](crate::uncertainty::Departure)).
    pub off_bodies: OffBodies,
}

/// How far surfaces may lie off the contact nodes of their bodies, m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OffBodies {
    /// That of the rail.
    pub rail: f64,
    /// That of the wheel.
    pub wheel: f64,
}

impl OffBodies {
    /// Both farther by so much, m.
    pub(crate) fn farther(&self, by: f64) -> Self {
        Self { rail: self.rail + by, wheel: self.wheel + by }
    }
}

/// The meshes of both bodies.
#[derive(Debug, Clone)]
pub struct PairMeshes {
    /// The rail, in the world frame.
    pub rail: HexMesh,
    /// The wheel, in its body frame.
    pub wheel: HexMesh,
}

impl Pair {
    /// Places both sections in the track and lowers the wheel until it touches.
    ///
    /// # Errors
    /// A wheel that misses the rail, and a section that cannot be analysed.
    pub fn new(rail: RailSection, wheel: WheelSection, track: &TrackGeometry) -> Result<Self> {
        let placed = place_rail(&rail, track)?;
        let tape_y = track.tape_y(&wheel.running);
        let touch = touch(&placed, &wheel.running, tape_y)?;
        let RailAnalysis { properties, stresses: shear_stresses } = rail_analysis(&rail)?;
        Ok(Self {
            rail,
            wheel,
            properties,
            shear_stresses,
            placed,
            tape_y,
            touch,
            off_bodies: OffBodies::default(),
        })
    }

    /// The same two sections with the wheel's tape circle at another lateral world position (m): the sections and the rail's place
    /// stay, the first touch is found anew.
    ///
    /// # Errors
    /// A wheel that misses the rail.
    pub fn with_wheel_at(&self, tape_y: f64) -> Result<Self> {
        let touch = touch(&self.placed, &self.wheel.running, tape_y)?;
        Ok(Self { tape_y, touch, ..self.clone() })
    }

    /// Other surfaces on the same bodies, which differ from these by micrometres: the rail as a beam stays, the places are found anew.
    ///
    /// # Errors
    /// A wheel that misses the rail.
    pub fn with_surfaces(
        &self,
        rail: RailSection,
        wheel: WheelSection,
        track: &TrackGeometry,
    ) -> Result<Self> {
        let tape_y = track.tape_y(&wheel.running);
        self.with_surfaces_at(rail, wheel, track, tape_y)
    }

    /// The same with the wheel's tape circle at a lateral world position, m.
    ///
    /// # Errors
    /// A wheel that misses the rail.
    pub(crate) fn with_surfaces_at(
        &self,
        rail: RailSection,
        wheel: WheelSection,
        track: &TrackGeometry,
        tape_y: f64,
    ) -> Result<Self> {
        let placed = place_rail(&rail, track)?;
        let touch = touch(&placed, &wheel.running, tape_y)?;
        Ok(Self { rail, wheel, placed, tape_y, touch, ..self.clone() })
    }

    /// The rail as a beam of a length (m), fixed at both ends, of so many elements.
    ///
    /// # Errors
    /// A length that is no length, and no element.
    pub fn beam(&self, material: &Material, length: f64, elements: usize) -> Result<RailBeam> {
        let torsion = Torsion::RestrainedWarping;
        RailBeam::rail(&self.properties, material, length, elements, self.placed.angle, torsion)
    }

    /// Meshes of both bodies, the rail of a length (m) centred at the contact.
    ///
    /// # Errors
    /// Settings that give an inverted or flat element.
    pub fn mesh(&self, rail_length: f64, options: &MeshOptions) -> Result<PairMeshes> {
        let (rail, wheel) = rayon::join(
            || mesh_rail(&self.rail, &self.placed, rail_length, options),
            || mesh_wheel(&self.wheel, options),
        );
        Ok(PairMeshes { rail: rail?, wheel: wheel? })
    }

    /// World position (y, z) of the wheel profile's origin when it just touches, m.
    pub fn tape(&self) -> Vector2<f64> {
        Vector2::new(self.tape_y, self.touch.tape_z)
    }

    /// World position (y, z) at which the beam's node line, the line of shear centres, passes, m.
    pub fn node_line(&self) -> Point2<f64> {
        self.placed.to_world(&Point2::new(0.0, self.rail.height - self.properties.shear_centre_height))
    }

    /// The beam's forces as loads on the section x = `x` (m) of the `mesh` of this rail.
    ///
    /// # Errors
    /// Those of [`SectionLoads::new`].
    pub fn section_loads(&self, mesh: &HexMesh, x: f64) -> Result<SectionLoads> {
        SectionLoads::new(mesh, &self.shear_stresses, &self.placed, self.node_line(), x)
    }

    /// Relative radii of curvature along the track and across at the first touch, m.
    pub fn relative_radii(&self) -> [f64; 2] {
        let rail = self.placed.curve.curvature(self.touch.rail_s);
        // The wheel's material lies above its curve, so a bulge of the wheel has negative curvature.
        let wheel = -self.wheel.running.curvature(self.touch.wheel_s);
        let rolling_radius = self.wheel.radius + self.wheel.running.point(self.touch.wheel_s).y;
        [rolling_radius / self.touch.contact_angle.cos(), 1.0 / (rail + wheel)]
    }

    /// Number of contact points whose gap is smaller than `largest_gap` (m) with the wheel lowered from first touch, m.
    pub fn candidates(&self, meshes: [&HexMesh; 2], lowering: f64, largest_gap: f64) -> usize {
        let [rail, wheel] = meshes;
        let mut wheel = self.wheel_surface(&wheel.contact);
        wheel.origin.y += lowering;
        pair(&self.rail_surface(&rail.contact), &wheel, PairingLimits { largest_gap }).len()
    }

    /// Contact surface of the rail at rest.
    pub fn rail_surface<'a>(&'a self, grid: &'a SurfaceGrid) -> Surface<'a> {
        Surface::extruded(&self.placed.curve, grid)
    }

    /// Contact surface of the wheel where it just touches.
    pub fn wheel_surface<'a>(&'a self, grid: &'a SurfaceGrid) -> Surface<'a> {
        Surface::revolved(&self.wheel.running, grid, self.wheel.radius, self.tape())
    }

    /// Weights of the rail's contact nodes whose mean is the point of the first touch, at x = 0.
    pub(super) fn touch_weights(&self, grid: &SurfaceGrid) -> Vec<f64> {
        // the two grid lines around a coordinate and their weights; the nearest line beside the grid
        let around = |lines: &[f64], at: f64| {
            let upper = lines.partition_point(|line| *line < at).clamp(1, lines.len() - 1);
            let t = ((at - lines[upper - 1]) / (lines[upper] - lines[upper - 1])).clamp(0.0, 1.0);
            [(upper - 1, 1.0 - t), (upper, t)]
        };
        let mut weights = vec![0.0; grid.nodes.len()];
        for (i, u) in around(&grid.along_profile, self.touch.rail_s) {
            for (k, v) in around(&grid.along_track, 0.0) {
                weights[i * grid.along_track.len() + k] += u * v;
            }
        }
        weights
    }
}
