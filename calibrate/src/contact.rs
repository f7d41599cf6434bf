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
//!
//! # The problem
//!
//! Each contact point `j` has a normal force `p` and a tangential force `τ` of two components, on the opposing body, in N. `f` has the forces of all
//! points. The hub moves by `u` along its free directions, and carries the wanted forces `F` there. `C` is the compliance of both bodies (m/N), `B`
//! has the components of the hub's directions along the rows, and `g₀` the gaps and slips without contact forces. Gaps and slips are
//!
//! ```text
//! g = g₀ + C·f + B·u,      Bᵀ·f = F
//! ```
//!
//! # Complementarity
//!
//! The gap `n` and the slip `s` of a point, which are its rows of `g`, obey Signorini's and Coulomb's conditions with the friction `µ`:
//!
//! ```text
//! n ≥ 0,   p ≥ 0,   n·p = 0
//! |τ| ≤ µ·p,   s = 0 where |τ| < µ·p,   else s = -λ·τ with λ ≥ 0
//! ```
//!
//! With a stiffness `r` of the point (N/m) these are two projections. Its value changes the iteration, not the solution:
//!
//! ```text
//! p = max(0, p - r·n)
//! τ = the point of the disc of radius µ·max(0, p - r·n) that is nearest to v = τ - r·s
//! ```
//!
//! The residual is the difference of both sides, and of `Bᵀ·f` and `F`, over the largest force.
//!
//! # Newton step
//!
//! The trial forces decide the mode of each point. With the modes held the step `Δf`, `Δu` solves a linear system, one block a point:
//!
//! ```text
//! open      p - r·n ≤ 0       Δp = -p,  Δτ = -τ
//! closed    p - r·n > 0       r·Δn = -r·n
//!   sticks  |v| ≤ µ·(p - r·n) r·Δs = -r·s
//!   slips   else              (I - E)·Δτ + E·r·Δs - µ·t·Δp = µ·p·t - τ,   t = v/|v|,   E = µ·p/|v|·(I - t·tᵀ)
//! hub                         Bᵀ·Δf = F - Bᵀ·f
//! ```
//!
//! with `Δn`, `Δs` the rows of `C·Δf + B·Δu`. Few rows are solved by a dense factor, many by GMRES with products of `C` (`iterative`). P. Alart and
//! A. Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991).

mod rigid_motion;
mod surface;
mod point;
mod pairing;
mod lattice;
mod compliance;
mod half_space;
mod beyond;
mod operator;
mod mirrored_transform;
mod convolution;
mod strips;
mod near_field;
mod hybrid;
mod state;
mod mirrored;
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

pub use beyond::BeyondHalfSpace;
pub use compliance::at_points;
pub use compliance::{BodyCompliance, Compliance, NodalCompliance, PenaltySprings, Terms, total};
pub use half_space::HalfSpace;
pub use half_space::displacement_far_from;
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
pub use surface::{BetweenNodes, Shape, Surface};
pub use surface::{corners, widened};
