//! What the loads on a surface take off the penetrations around them.
//!
//! A strip alone gives way where it is loaded. The rest of a half-space goes down beside it: by `F/(πE*·r)` at a distance `r` of a load (K.L. Johnson,
//! "Contact mechanics" (1985), equation 3.22), and as a load is spread along the track, by no more than at some distance within its own
//! contact. So a contact lies deeper than its strips are pressed, it is narrower than the profiles overlap, and contacts side by side relieve each
//! other.
//!
//! Let `q(s)` be the force per length of the strips at the arc length `s` of the rail, and `w(s)` their weight. `Bᵢ` are bell-shaped functions (B-splines of the
//! fifth degree, of the sum 1) at places along the rail. The loads are `gᵢ = ∫Bᵢ·w·q ds`. The penetration is reduced by `w(s)·Σ Bᵢ(s)·rᵢ`, with
//! `rᵢ = ∂W/∂gᵢ` and
//!
//! ```text
//! W = Σ C·gᵢ^(5/3)·3/5 + ½·Σ Mᵢⱼ·gᵢ·gⱼ,     Mᵢⱼ = 1/(πE*) · ((1 + cos θᵢⱼ)/2)² / √(dᵢⱼ² + d²)
//! ```
//!
//! Near a load the power is that of contacts, which grow with the third root of their loads; elsewhere it is Johnson's, with the angle `θ` between the normals.
//! W is convex, and so is the energy of the strips: at a pose there is one answer, and it goes on where contacts are born, merge and part.

mod places;
mod loading;

pub(super) use self::loading::{Loading, StripLoad};
pub(super) use self::places::Bells;
pub use self::places::{Influence, Relief, ReliefPlaces};
