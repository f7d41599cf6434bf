//! The limits of the verdict, which are keys of the study: one table of key, default, range and meaning.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::line::{Criterion, Kind};

/// Makes [`Limits`], its defaults and its criteria from lines of
/// `key: type = default, [least, largest], meaning`, with the kind and the unit of the verdict's line after the range where
/// the key is the limit of one, and after the meaning what only its description in the schema adds.
macro_rules! limits {
    ($(
        $key:ident: $type:ident = $default:tt, [$least:tt, $largest:tt], $($kind:ident in $unit:tt,)?
            $meaning:literal $(+ $more:literal)?;
    )*) => {
        /// Limits of the verdict, as keys of the study. A line fails when its value exceeds its limit, or when it has no
        /// value.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, default)]
        pub struct Limits {
            $(
                #[doc = concat!($meaning, $("; ", $more,)? ".")]
                #[schemars(range(min = $least, max = $largest))]
                pub $key: $type,
            )*
        }

        impl Default for Limits {
            fn default() -> Self {
                Self { $($key: $default),* }
            }
        }

        impl Limits {
            $($(
                #[doc = concat!("Criterion: ", $meaning, ".")]
                #[allow(clippy::unnecessary_cast, reason = "a limit may be a number of events")]
                pub fn $key(&self) -> Criterion {
                    Criterion {
                        quantity: stringify!($key),
                        meaning: $meaning,
                        kind: Kind::$kind,
                        unit: $unit,
                        limit: self.$key as f64,
                    }
                }
            )?)*
        }
    };
}

// What a simple model can be asked for when impacts and weakly damped vibrations are in the load case (docs/verdict.md): the derailment
// coefficient, averaged, within the margin a safety case leaves (0.15, and 0.5 for a moment); the forces, whose vibrations
// lose phase after the first impact, within 0.15 of the peak in the mean and 0.75 at an instant; impacts and departures
// within 5 ms. Statistics lose no phase: a force goes with the root of the stiffness, as a rate does, and the law is
// within 0.15, so that they are within half of that. The drift of the energy: an impact that begins within a step is off by (ωh)²/8 of its impulse, 0.004 with steps whose (ωh)² is
// 0.03, and by twice that of its energy, 0.008; three impacts, one after another on what the last one left, 0.025; steps that a study gives may
// be longer by √2. The law within 15 % of the solid: a half-space program's own curve of S1002 on UIC60 is 8 % off any law of
// this form between 0.5 and 200 kN, and patches of a few contact elements add steps of the same size; its displacement, in
// which the steps average out, within 3 %: 2 % of the mesh and 1 % of the form. The beam within twice the 1 % that the mesh
// of the rail is off in bending. The published law belongs to another wheel and bounds only the order of magnitude.
limits! {
    vertical_rms: f64 = 0.15, [0.0, 1e6], Verification in "1",
        "P, RMS difference over the solid's peak";
    vertical_max: f64 = 0.75, [0.0, 1e6], Verification in "1",
        "P, largest difference over the solid's peak";
    lateral_rms: f64 = 0.15, [0.0, 1e6], Verification in "1",
        "Q, RMS difference over the solid's peak";
    lateral_max: f64 = 0.75, [0.0, 1e6], Verification in "1",
        "Q, largest difference over the solid's peak";
    ratio_rms: f64 = 0.15, [0.0, 1e6], Verification in "1",
        "Averaged Q/P, RMS difference";
    ratio_max: f64 = 0.50, [0.0, 1e6], Verification in "1",
        "Averaged Q/P, largest difference";
    ratio_window_s: f64 = 0.024, [1e-6, 1e3],
        "Time over which Q and P are averaged before they are divided, s; 2 m at 300 km/h"
            + "Q/P is compared where the averaged P carries it: where what both forces are worth leaves it off by `ratio_max` at most";
    separation_begin_s: f64 = 0.005, [0.0, 1e3], Verification in "s",
        "Separation begins, largest difference";
    separation_end_s: f64 = 0.005, [0.0, 1e3], Verification in "s",
        "Separation ends, largest difference";
    separations_unmatched: usize = 0, [0, 1000000], Verification in "1",
        "Separations that only one model has";
    departure_s: f64 = 0.005, [0.0, 1e3], Verification in "s",
        "Wheel leaves the profile, difference of the times";
    separation_shortest_s: f64 = 0.002, [0.0, 1e3],
        "Separations shorter than this are left out of the times, s";
    mode_fraction: f64 = 0.10, [0.0, 1.0], Verification in "1",
        "Time in each contact mode, difference of the fractions";
    statistics: f64 = 0.075, [0.0, 1e6], Verification in "1",
        "Mean, RMS and 5, 50 and 95 % quantiles of P and of Q, difference over the solid's peak"
            + "from where on the motion of the solid is not determined";
    separation_rate: f64 = 0.075, [0.0, 1e6], Verification in "1",
        "Undetermined motion: separations a second, difference over the solid's";
    energy_drift: f64 = 0.05, [0.0, 1e6], Consistency in "1",
        "Drift of the energy balance, largest of both models over the largest energy stored"
            + "what contacts that open or close within a step add or take; empty cells of a run have none";
    law_max: f64 = 0.15, [0.0, 1e6], Consistency in "1",
        "Law against the solid's tangent stiffness, largest relative difference";
    law_displacement: f64 = 0.03, [0.0, 1e6], Consistency in "1",
        "Integrated law against the solid's displacement, largest deviation of all references over the largest displacement";
    beam_missing: f64 = 0.02, [0.0, 1e6], Consistency in "1",
        "Rail beam against the solid rail, what it misses over the whole flexibility"
            + "at the first touch, the flexibility from the hub to the held ends; the larger of lateral and vertical";
    horizontal_spread: f64 = 0.10, [0.0, 1e6], Consistency in "1",
        "Horizontal stiffness, relative spread over the preloads";
    published_stiffness: f64 = 1.0, [0.0, 1e6], CrossCode in "1",
        "Foot-referenced tangent stiffness against the published law at 85 kN, relative difference";
}
