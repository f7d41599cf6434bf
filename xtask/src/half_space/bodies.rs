//! The bodies that are pressed: real ones, stiff ones with the same surfaces, and half-spaces.

use nalgebra::{Point2, Vector2};
use railspring_calibrate::calibration::{ContactField, Enforcement, Reference, WheelOnRail};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{CondensedPair, ContactBody, ContactConditions, Pair, PairBody};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::rails::rail_outline;
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::profile::{ProfileCurve, Segment};
use railspring_profiles::section::{
    RailSection, WheelSection, rail_section, rail_section_of, wheel_section, wheel_section_of,
};

/// Diameter at the tape circle and steel of the tables (CONTACT: G 82 GPa, Poisson 0.28).
const TAPE_DIAMETER: f64 = 0.92;
const STEEL: Material = Material { young: 209.92e9, poisson: 0.28, ..Material::STEEL };
/// Length of the rail, m: that of the default study.
const RAIL_LENGTH: f64 = 0.555;
/// Half length of the contact grid along the track, m: twice the window, as in a study; the patches of a flange go beyond the window.
const CONTACT_HALF_LENGTH: f64 = 24e-3;

/// What gives way below the two surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PressedOn {
    /// Half-spaces, as in the tables.
    HalfSpaces,
    /// Half-spaces on a grid of half the spacing.
    HalfSpacesHalved,
    /// Solids whose head and rim hardly roll.
    Stiff,
    /// The solids of wheel and rail.
    Flexible,
}

impl PressedOn {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::HalfSpaces, Self::HalfSpacesHalved, Self::Stiff, Self::Flexible];

    /// Its place among all.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::HalfSpaces => "half-spaces",
            Self::HalfSpacesHalved => "half-spaces, half the grid",
            Self::Stiff => "stiff bodies",
            Self::Flexible => "flexible bodies",
        }
    }

    /// What the approach is.
    pub fn reference(self) -> Reference {
        match self {
            Self::HalfSpaces | Self::HalfSpacesHalved => Reference::HalfSpaces,
            Self::Stiff | Self::Flexible => Reference::Local,
        }
    }

    /// The stem of its figure.
    pub fn file(self) -> &'static str {
        match self {
            Self::HalfSpaces => "half-spaces",
            Self::HalfSpacesHalved => "half-spaces-halved",
            Self::Stiff => "stiff-bodies",
            Self::Flexible => "flexible-bodies",
        }
    }
}

/// A pair with its condensed bodies.
struct Solid {
    pair: Pair,
    bodies: CondensedPair,
}

/// The real pair and the stiff one.
pub struct Pairs {
    /// Standard rail.
    pub rail: String,
    /// Standard wheel.
    pub wheel: String,
    flexible: Solid,
    stiff: Solid,
}

/// Meshes and condenses the bodies of two standard profiles, and stiff ones.
///
/// # Errors
/// Unknown profiles, and sections that cannot be meshed.
pub fn both_pairs(rail: &str, wheel: &str, monitor: &dyn Monitor) -> Result<Pairs> {
    let flexible = solid(rail_section(rail)?, wheel_section(wheel, TAPE_DIAMETER)?, monitor)?;
    let stiff = solid(stiff_rail(rail)?, stiff_wheel(wheel)?, monitor)?;
    Ok(Pairs { rail: rail.to_owned(), wheel: wheel.to_owned(), flexible, stiff })
}

fn solid(rail: RailSection, wheel: WheelSection, monitor: &dyn Monitor) -> Result<Solid> {
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard())?;
    let options = MeshOptions { contact_half_length: CONTACT_HALF_LENGTH, ..MeshOptions::default() };
    let meshes = pair.mesh(RAIL_LENGTH, &options)?;
    let element = Formulation::IncompatibleModes;
    let bodies = meshes.condense(&pair, PairBody::of_pair(false), STEEL, element, monitor)?;
    Ok(Solid { pair, bodies })
}

/// The head of a standard rail on a block of 150 mm by its height.
fn stiff_rail(name: &str) -> Result<RailSection> {
    const HALF_WIDTH: f64 = 75e-3;
    const HEIGHT: f64 = 172e-3;
    let mut outline = rail_outline(name)?;
    let (first, last) = (outline.running[0].start(), outline.running[outline.running.len() - 1].end());
    let field = [
        last,
        last + Vector2::new(-4e-3, 4e-3),
        Point2::new(HALF_WIDTH, last.y + 60e-3),
        Point2::new(HALF_WIDTH, HEIGHT),
    ];
    let mirrored = |p: &Point2<f64>| Point2::new(-p.x, p.y);
    let mut around: Vec<_> = field.iter().copied().chain(field.iter().rev().map(mirrored)).collect();
    if let Some(end) = around.last_mut() {
        *end = first;
    }
    outline.rest = around.windows(2).map(|ends| Segment::line(ends[0], ends[1])).collect();
    Ok(rail_section_of(&format!("stiff {name}"), outline))
}

/// A standard wheel's surface on a disc as wide as the wheel.
fn stiff_wheel(name: &str) -> Result<WheelSection> {
    /// Depth of the disc from the tape circle to its bore, m.
    const DEPTH: f64 = 260e-3;
    let running: ProfileCurve = wheel_profile(name)?;
    let (back, tread) = (running.point(0.0), running.point(running.length()));
    let face = tread + Vector2::new(5e-3, -5e-3);
    let around = [tread, face, Point2::new(face.x, -DEPTH), Point2::new(back.x, -DEPTH), back];
    let rest = around.windows(2).map(|ends| Segment::line(ends[0], ends[1])).collect();
    wheel_section_of(&format!("stiff {name}"), running, rest, TAPE_DIAMETER)
}

impl Pairs {
    /// The pair with the wheel shifted towards its flange, mm, on the bodies that are asked for.
    ///
    /// # Errors
    /// A wheel that misses the rail.
    pub fn at(&self, shift_mm: f64, on: PressedOn) -> Result<Place<'_>> {
        let solid = if on == PressedOn::Stiff { &self.stiff } else { &self.flexible };
        let pair = solid.pair.with_wheel_at(solid.pair.tape_y + shift_mm * 1e-3)?;
        Ok(Place { pair, bodies: &solid.bodies, on })
    }
}

/// A wheel in a place across the track.
pub struct Place<'a> {
    /// The sections in place.
    pub pair: Pair,
    bodies: &'a CondensedPair,
    on: PressedOn,
}

impl Place<'_> {
    /// The wheel on the rail, without friction, pressed downwards.
    ///
    /// # Errors
    /// Bodies that are not of the pair.
    pub fn wheel_on_rail(&self) -> Result<WheelOnRail<'_>> {
        let field = match self.on {
            PressedOn::HalfSpacesHalved => ContactField::HybridHalved,
            _ => ContactField::Hybrid,
        };
        let CondensedPair { rail_on_ends, wheel, .. } = self.bodies;
        match self.on {
            PressedOn::HalfSpaces | PressedOn::HalfSpacesHalved => {
                Ok(self.pair.half_spaces_on_rail([&rail_on_ends.grid, &wheel.grid], [STEEL; 2], field))
            }
            PressedOn::Stiff | PressedOn::Flexible => {
                let rail = self.pair.contact_body(PairBody::RailOnEnds, rail_on_ends)?;
                let rail = ContactBody { compliance: self.bodies.against_section(), ..rail };
                let wheel = self.pair.contact_body(PairBody::Wheel, wheel)?;
                let contact = ContactConditions { friction: 0.0, enforcement: Enforcement::Exact, field };
                Ok(self.pair.wheel_on_rail(rail, wheel, contact))
            }
        }
    }
}
