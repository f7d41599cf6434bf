//! The condensed contact element: an elastic wheel on a rail of beams with an elastic head.
//!
//! The wheel is its condensed body: hub, modes and the static rest of its rim. The rail is a beam with the flexibility of its head in series.
//! Between them the contact is one of strips along the profiles with the stiffness of the solids
//! ([`railspring_calibrate::element`]): the normal forces have a potential, contacts may be many, and none is in tension. Nothing
//! is fitted to runs in time.
//!
//! A step is the implicit midpoint rule. The mean force of the contact over it is the one whose work is the
//! change of its potential (O. Gonzalez, "Time integration and discrete Hamiltonian systems", J. Nonlinear Sci. 6, 1996), so that a step of
//! whatever length makes no energy.

mod wheel;
mod contact;
mod model;
mod step;
mod statics;
mod run;

pub use model::CondensedModel;
pub use statics::HubStatics;

#[cfg(test)]
mod tests;
