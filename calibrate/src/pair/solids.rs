//! The bodies of a pair before they are condensed: what they are made from, and how each is held.

use super::geometry::Pair;
use crate::mesh::HexMesh;
use crate::section_analysis::StressSample;
use crate::solid::{Formulation, Materials, MirrorHalf, Numbering, Supports, Symmetry, System};
use crate::superelement::{CondensedBody, Parts, Step, Wanted, body_key};
use nalgebra::Point2;
use railspring_profiles::error::Result;
use std::sync::OnceLock;

/// A body of a pair, by how it is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairBody {
    /// The wheel against its hub.
    Wheel,
    /// The rail with its foot fixed.
    RailOnFoot,
    /// The rail with its ends fixed, which is the solid of a rail beam: it comes with the motion of its section.
    RailOnEnds,
}

impl PairBody {
    /// All of them; the wheel, whose factor is the largest, comes first.
    pub const ALL: [Self; 3] = [Self::Wheel, Self::RailOnEnds, Self::RailOnFoot];

    /// What a pair is condensed to: wheel and rail between its ends, and the rail on its foot where laws against that are wanted.
    pub fn of_pair(foot_held: bool) -> &'static [Self] {
        match foot_held {
            true => &Self::ALL,
            false => &[Self::Wheel, Self::RailOnEnds],
        }
    }

    /// Whether it moves in runs in time, which take its modes.
    pub fn is_in_time(self) -> bool {
        self != Self::RailOnFoot
    }

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wheel => "wheel",
            Self::RailOnFoot => "rail on its foot",
            Self::RailOnEnds => "rail between its ends",
        }
    }
}

/// The orders of the bodies' equations, each found once, and the halves of bodies that are their own mirror
/// images. An order takes as long to find as the assembly of a body. The prediction of its memory, the
/// condensed body and its inside ask for it in turn. Orders belong to the meshes, whatever material and
/// element.
#[derive(Debug, Clone, Default)]
pub struct Orders([OfBody; 3]);

/// What is known of a body.
#[derive(Debug, Clone, Default)]
struct OfBody {
    whole: OnceLock<Numbering>,
    half: OnceLock<Option<MirrorHalf>>,
    of_half: OnceLock<Numbering>,
}

/// Wheel and rail of a pair as solids.
#[derive(Clone, Copy)]
pub struct PairSolids<'a> {
    /// The pair.
    pub pair: &'a Pair,
    /// Mesh of the rail, in the world frame.
    pub rail: &'a HexMesh,
    /// Mesh of the wheel, in its body frame.
    pub wheel: &'a HexMesh,
    /// Materials of the rail and of the wheel.
    pub materials: [&'a Materials; 2],
    /// Element of both.
    pub element: Formulation,
    /// Orders of the equations on these meshes, as far as they are known.
    pub orders: &'a Orders,
}

impl<'a> PairSolids<'a> {
    /// Hash of what a body is made from; that of the condensed body.
    pub fn key(&self, body: PairBody) -> String {
        let (mesh, supports) = self.held(body);
        let key = body_key(mesh, self.materials(body), self.element, &supports);
        match body {
            PairBody::Wheel | PairBody::RailOnFoot => key,
            PairBody::RailOnEnds => {
                let mut hasher = blake3::Hasher::new();
                hasher.update(key.as_bytes());
                let Point2 { coords: line } = self.pair.node_line();
                let placed = [self.pair.placed.angle, self.pair.placed.origin.x, self.pair.placed.origin.y];
                let samples = self.pair.shear_stresses.iter().flat_map(|sample| {
                    let StressSample { point, area, stress } = sample;
                    [point.x, point.y, *area].into_iter().chain(stress.iter().flat_map(|s| [s.x, s.y]))
                });
                for value in placed.into_iter().chain([line.x, line.y]).chain(samples) {
                    hasher.update(&value.to_le_bytes());
                }
                hasher.finalize().to_hex().to_string()
            }
        }
    }

    /// Assembles, factors and condenses a body, whose hash is `key` ([`PairSolids::key`]).
    ///
    /// # Errors
    /// An inverted element, and a rail without an element at the contact.
    pub fn condense(&self, body: PairBody, key: String) -> Result<CondensedBody> {
        self.condense_in_time(body, key, 0)
    }

    /// The same with at most `modes` modes where the body moves in runs in time ([`PairBody::is_in_time`]).
    ///
    /// # Errors
    /// As [`Self::condense`].
    pub fn condense_in_time(&self, body: PairBody, key: String, modes: usize) -> Result<CondensedBody> {
        self.condense_in_steps(body, key, modes, &mut |_, _, _| ())
    }

    /// The same, which says which step `begins`, how many were done before it, and how many there are.
    ///
    /// # Errors
    /// As [`Self::condense`].
    pub fn condense_in_steps(
        &self,
        body: PairBody,
        key: String,
        modes: usize,
        begins: &mut dyn FnMut(Step, usize, usize),
    ) -> Result<CondensedBody> {
        let section = || self.pair.section_loads(self.rail, 0.0);
        let section = (body == PairBody::RailOnEnds).then(section).transpose()?;
        let modes = if body.is_in_time() { modes } else { 0 };
        let condensed = self.parts(body)?.condensed(Wanted { key, modes, section }, begins)?;
        Ok(CondensedBody { of: self.pair.named(body), ..condensed })
    }

    /// The body as its equations are eliminated: by halves, if it is its own mirror image.
    ///
    /// # Errors
    /// As [`Self::system`].
    pub fn parts(&self, body: PairBody) -> Result<Parts<'a>> {
        let (whole, supports) = self.held(body);
        let Orders(known) = self.orders;
        let known = &known[body as usize];
        let Some(half) = known.half.get_or_init(|| MirrorHalf::of(whole, &supports)) else {
            return Ok(Parts::Whole(Box::new(self.system(body)?)));
        };
        let numbering = ordered(&known.of_half, &half.mesh, &half.supports)?;
        let system = |symmetry| {
            let numbering = half.numbered(&numbering, symmetry);
            System::with_numbering(&half.mesh, self.materials(body).clone(), self.element, numbering)
        };
        let [symmetric, antisymmetric] = Symmetry::BOTH;
        Ok(Parts::Halves { whole, half, systems: Box::new([system(symmetric)?, system(antisymmetric)?]) })
    }

    /// The whole body with its supports and the order of its equations.
    ///
    /// # Errors
    /// An impossible material, and a mesh that cannot be ordered.
    pub fn system(&self, body: PairBody) -> Result<System<'a>> {
        let (mesh, supports) = self.held(body);
        let Orders(known) = self.orders;
        let numbering = ordered(&known[body as usize].whole, mesh, &supports)?;
        System::with_numbering(mesh, self.materials(body).clone(), self.element, numbering)
    }

    fn materials(&self, body: PairBody) -> &'a Materials {
        let [rail, wheel] = self.materials;
        match body {
            PairBody::Wheel => wheel,
            PairBody::RailOnFoot | PairBody::RailOnEnds => rail,
        }
    }

    fn held(&self, body: PairBody) -> (&'a HexMesh, Supports) {
        let fixed = |nodes: &[usize]| Supports { held: nodes.to_vec(), ..Supports::default() };
        match body {
            PairBody::Wheel => {
                (self.wheel, Supports { followers: self.wheel.bore.clone(), ..Supports::default() })
            }
            PairBody::RailOnFoot => (self.rail, fixed(&self.rail.foot)),
            PairBody::RailOnEnds => (self.rail, fixed(&self.rail.ends)),
        }
    }
}

/// The order of the equations of a mesh, which is found once.
fn ordered(known: &OnceLock<Numbering>, mesh: &HexMesh, supports: &Supports) -> Result<Numbering> {
    if let Some(numbering) = known.get() {
        return Ok(numbering.clone());
    }
    let numbering = Numbering::new(mesh, supports)?;
    Ok(known.get_or_init(|| numbering).clone())
}
