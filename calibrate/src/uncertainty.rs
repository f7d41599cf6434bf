//! Uncertainty of springs by the inputs of their pair.
//!
//! * [`Distribution`]: how an input may depart from its value;
//! * [`departures`]: quasi-random samples of all inputs, with what their answers say ([`percentile`], [`first_order_indices`]);
//! * [`propagate`]: the departures of all inputs through a model, to first order and by quasi-random samples;
//! * [`Departure`]: a pair whose inputs are other ones ([`Departure::pair`]);
//! * [`UncertainPair`]: the model, a pair that is pressed on the bodies of its nominal one.
//!
//! The guides are the *Guide to the expression of uncertainty in measurement* (JCGM 100:2008, first order) and its
//! supplement 1 (JCGM 101:2008, samples). Here the samples are those of a scrambled Sobol sequence, so that they repeat.

mod distribution;
mod samples;
mod propagate;
mod departure;
mod pressed;

pub use departure::{Departure, FARTHEST};
pub use distribution::{Distribution, normal_quantile};
pub use pressed::{Answers, Asked, UncertainPair};
pub use propagate::{Band, Effect, Input, Propagated, propagate};
pub use samples::{departures, first_order_indices, is_enough, percentile};
