//! Surface-to-surface contact of two bodies on their smooth profile curves.
//!
//! * [`Surface`] and [`pair`]: which point of one surface faces which point of
//!   the other, the gap, and the consistent weights of the nodes of both.
//! * [`Compliance`]: contact forces in, change of gap and slip out. Superelements,
//!   the half-spaces and the published penalty springs implement it.
//! * [`ComplianceOperator`]: the same as the solver sees it: products, and the matrix where there is load.
//! * [`solve`]: unilateral contact with Coulomb friction.
//!
//! The unknowns are nodal pressures on the base surface (the rail), bilinear
//! between its nodes; gaps are their weighted means. Integration runs over the
//! intersections of the cells of both surfaces, so a uniform pressure crosses
//! non-matching meshes exactly (patch test).

mod rigid_motion;
mod surface;
mod point;
mod pairing;
mod lattice;
mod compliance;
mod half_space;
mod operator;
mod convolution;
mod near_field;
mod hybrid;
mod state;
mod dense;
mod gmres;
mod iterative;
mod newton;
mod conjugate_gradients;
mod preconditioned;
mod start;
mod sweeps;
mod solver;
mod point_force;
mod subsurface;

pub use compliance::{BodyCompliance, Compliance, NodalCompliance, PenaltySprings, Terms, total};
pub use half_space::HalfSpace;
pub use half_space::{add_half_spaces, displacement_far_from};
pub use hybrid::{Hybrid, Share, Shares};
pub use iterative::Factors;
pub use lattice::Lattice;
pub use near_field::NearField;
pub use newton::TOLERANCE;
pub use operator::ComplianceOperator;
pub use pairing::{PairingLimits, pair};
pub use pairing::{locate, nodes_near, pair_nodes};
pub use point::{ContactPoint, NodeWeight, Side, flat_grid, gaps, nodal_forces, resultant};
pub use point_force::PatchStress;
pub use rigid_motion::RigidMotion;
pub use solver::{FreeDirection, HubResponse, PointMode, Problem, Solution, hub_response, solve};
pub use solver::{hub_response_with, response_to, solve_held, solve_to, solve_with};
pub use subsurface::{Hat, Peak, Subsurface, hats, stress_below, subsurface};
pub use surface::corners;
pub use surface::{BetweenNodes, Shape, Surface};
