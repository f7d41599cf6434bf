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

// Accuracy requirements, each with its reason in docs/verdict.md and its history in docs/limits-history.md. They were set from what planted errors
// change, and from the numerical uncertainty of the solid model: 0.4 to 1.8 % of P and Q.
limits! {
    vertical_rms: f64 = 0.03, [0.0, 1e6], Verification in "1",
        "P, RMS difference over the solid's peak";
    vertical_max: f64 = 0.10, [0.0, 1e6], Verification in "1",
        "P, largest difference over the solid's peak";
    lateral_rms: f64 = 0.03, [0.0, 1e6], Verification in "1",
        "Q, RMS difference over the solid's peak";
    lateral_max: f64 = 0.10, [0.0, 1e6], Verification in "1",
        "Q, largest difference over the solid's peak";
    ratio_rms: f64 = 0.02, [0.0, 1e6], Verification in "1",
        "Averaged Q/P, RMS difference";
    ratio_max: f64 = 0.05, [0.0, 1e6], Verification in "1",
        "Averaged Q/P, largest difference";
    ratio_window_s: f64 = 0.024, [1e-6, 1e3],
        "Time over which Q and P are averaged before they are divided, s; 2 m at 300 km/h"
            + "Q/P is compared where the uncertainty of both forces of the solid moves it by `ratio_max` at most";
    ratio_left_out: f64 = 0.50, [0.0, 1.0], Verification in "1",
        "Averaged Q/P of the solid not known, share of the time at which its averaged P is a tenth of the peak";
    separation_begin_s: f64 = 0.001, [0.0, 1e3], Verification in "s",
        "Separation begins, largest difference";
    separation_end_s: f64 = 0.001, [0.0, 1e3], Verification in "s",
        "Separation ends, largest difference";
    separations_unmatched: usize = 0, [0, 1000000], Verification in "1",
        "Separations that only one model has";
    departure_s: f64 = 0.001, [0.0, 1e3], Verification in "s",
        "Wheel leaves the profile, difference of the times";
    separation_shortest_s: f64 = 0.002, [0.0, 1e3],
        "Separations shorter than this are left out of the times, s";
    mode_fraction: f64 = 0.05, [0.0, 1.0], Verification in "1",
        "Time in each contact mode, difference of the fractions";
    statistics: f64 = 0.03, [0.0, 1e6], Verification in "1",
        "Mean, RMS and 5, 50 and 95 % quantiles of P and of Q, difference over the solid's peak"
            + "from where on the motion of the solid is not determined";
    separation_rate: f64 = 0.03, [0.0, 1e6], Verification in "1",
        "Undetermined motion: separations a second, difference over the solid's";
    energy_drift: f64 = 0.005, [0.0, 1e6], Consistency in "1",
        "Drift of the energy balance, largest of both models over the largest energy stored"
            + "what contacts that open or close within a step add or take; empty cells of a run have none";
    law_max: f64 = 0.15, [0.0, 1e6], Consistency in "1",
        "Law against the solid's tangent stiffness at the same load, largest relative difference"
            + "at the loads that the load cases use; of a table, between its loads";
    law_displacement: f64 = 0.03, [0.0, 1e6], Consistency in "1",
        "Integrated law against the solid's displacement at the same load, largest relative difference"
            + "at the loads that the load cases use; of the condensed element over the displacement under the largest load";
    hub_compliance: f64 = 0.03, [0.0, 1e6], Verification in "1",
        "Flexibility of the condensed element's hub against the solid, largest difference over shifts and loads of one contact"
            + "lateral and vertical over that of the solid, their coupling over the geometric mean of both";
    beam_missing: f64 = 0.02, [0.0, 1e6], Consistency in "1",
        "Rail beam against the solid rail, what it misses over the whole flexibility"
            + "at the first touch, the flexibility from the hub to the held ends; the larger of lateral and vertical";
    horizontal_spread: f64 = 0.10, [0.0, 1e6], Consistency in "1",
        "Horizontal stiffness, relative spread over the preloads";
    published_stiffness: f64 = 1.0, [0.0, 1e6], CrossCode in "1",
        "Foot-referenced tangent stiffness against the published law at 85 kN, relative difference";
}

/// A limit that is not the default one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChangedLimit {
    /// Key of the study, without its section.
    pub key: String,
    /// The limit in force.
    pub limit: f64,
    /// The default.
    pub default: f64,
}

impl ChangedLimit {
    /// Whether more passes than with the default; of a key that is no limit any change does.
    pub fn is_looser(&self) -> bool {
        self.limit > self.default || ["ratio_window_s", "separation_shortest_s"].contains(&&*self.key)
    }
}

impl std::fmt::Display for ChangedLimit {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "verification.{} = {} (default {})", self.key, self.limit, self.default)
    }
}

impl Limits {
    /// The limits that are not the default ones.
    pub fn changed(&self) -> Vec<ChangedLimit> {
        let values = |limits: &Self| serde_json::to_value(limits).expect("limits are plain data");
        let (own, default) = (values(self), values(&Self::default()));
        let number = |of: &serde_json::Value, key: &str| of[key].as_f64().unwrap_or(f64::NAN);
        let keys = default.as_object().into_iter().flat_map(serde_json::Map::keys);
        keys.filter(|key| own[&**key] != default[&**key])
            .map(|key| ChangedLimit {
                key: key.clone(),
                limit: number(&own, key),
                default: number(&default, key),
            })
            .collect()
    }
}
