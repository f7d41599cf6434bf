//! How the difference of the two models stands to what uncertain inputs change. No limit depends on it.

use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::history::{History, HistoryRow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::run::stage::Run;
use crate::results::run::uncertain_record::{
    Quantiles, UncertainRow, UncertainRun, UncertainRunRecord, band,
};
use crate::rounding::significant;
use crate::verify::{Comparison, Limits, averaged_ratio};

/// The bands of a load case by uncertain inputs beside the difference of the two models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InputBands {
    /// Vertical force; widths and differences over the solid's peak, without a solid over that of the simple model.
    pub vertical: BandBeside,
    /// The same of the lateral force.
    pub lateral: BandBeside,
    /// Averaged Q/P, as it is; none where it has no band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<BandBeside>,
    /// The samples.
    pub of: UncertainRunRecord,
}

/// A band of 95 % by uncertain inputs beside the difference of the two models, over the same time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BandBeside {
    /// Half width of the band, RMS.
    pub inputs: f64,
    /// Difference of the two models, RMS, as the verdict has it; none without a solid run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub models: Option<f64>,
    /// Share of the time steps with a band at which the solid lies within it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid_within: Option<f64>,
}

impl InputBands {
    /// The bands of a load case beside its `simple` and its `solid` run, and their comparison; none without a time step that has a band.
    pub(crate) fn of(
        uncertain: &UncertainRun,
        simple: &History,
        (solid, comparison): (Option<&Run>, Option<&Comparison>),
        limits: &Limits,
    ) -> Option<Self> {
        let line = |quantity: &str| comparison?.lines.iter().find(|line| line.quantity == quantity);
        let beside = |of: fn(&UncertainRow) -> Quantiles,
                      scale: f64,
                      quantity: &str,
                      solid: Option<Vec<Option<f64>>>| {
            let line = line(quantity);
            let [begin, end] =
                line.and_then(|line| line.over_s).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            let bands: Vec<(usize, [f64; 2])> = uncertain
                .rows
                .iter()
                .enumerate()
                .filter(|(_, row)| (begin..=end).contains(&row.time))
                .filter_map(|(n, row)| Some((n, band(of(row)?))))
                .collect();
            let squares: f64 = bands.iter().map(|(_, [low, high])| (0.5 * (high - low)).powi(2)).sum();
            let inputs = (squares / bands.len() as f64).sqrt() / scale;
            let solid_within = solid.and_then(|solid| {
                let both = bands.iter().filter_map(|(n, band)| Some(((*solid.get(*n)?)?, band)));
                let within: Vec<bool> =
                    both.map(|(value, [low, high])| (*low..=*high).contains(&value)).collect();
                let count = within.iter().filter(|within| **within).count();
                (!within.is_empty()).then(|| count as f64 / within.len() as f64)
            });
            inputs.is_finite().then(|| BandBeside {
                inputs,
                models: line.and_then(|line| line.value),
                solid_within,
            })
        };
        let force = |value: fn(&HistoryRow) -> f64| {
            let of = |run: &History| -> Vec<Option<f64>> {
                run.rows.iter().map(|row| Some(value(row) / KILONEWTON)).collect()
            };
            let peak = of(solid.map_or(simple, |run| &run.history))
                .into_iter()
                .flatten()
                .fold(0.0, |most: f64, value| most.max(value.abs()));
            (peak, solid.map(|run| of(&run.history)))
        };
        let (peak_p, solid_p) = force(|row| row.vertical_force);
        let (peak_q, solid_q) = force(|row| row.lateral_force);
        let ratio = solid.map(|run| {
            averaged_ratio(&run.history, limits.ratio_window_s, &run.model().carrying(limits.ratio_max))
        });
        Some(Self {
            vertical: beside(|row| row.p, peak_p, "vertical_rms", solid_p)?,
            lateral: beside(|row| row.q, peak_q, "lateral_rms", solid_q)?,
            ratio: beside(|row| row.ratio, 1.0, "ratio_rms", ratio),
            of: uncertain.record.clone(),
        })
    }

    /// The bands beside the difference of the models, a sentence for each quantity.
    pub fn sentences(&self) -> Vec<String> {
        let percent = |value: f64| format!("{} %", significant(1e2 * value, 2));
        let share = |value: f64| format!("{:.0} %", 1e2 * value);
        let of = |name: &str, of: &BandBeside, text: &dyn Fn(f64) -> String, of_peak: &str| {
            let models = of.models.map_or_else(String::new, |models| {
                format!("models differ by {}{of_peak} (RMS), ", text(models))
            });
            let within = of.solid_within.map_or_else(String::new, |within| {
                format!(", the solid lies within {} of the time", share(within))
            });
            format!("{name}: {models}inputs by \u{b1}{}{of_peak} (95 %, RMS){within}", text(of.inputs))
        };
        let plain = |value: f64| significant(value, 2);
        let peak = " of the peak";
        [
            Some(of("P", &self.vertical, &percent, peak)),
            Some(of("Q", &self.lateral, &percent, peak)),
            self.ratio.as_ref().map(|ratio| of("averaged Q/P", ratio, &plain, "")),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// The same as a note.
    pub fn note(&self) -> String {
        format!("uncertain inputs, {}: {}", self.of.counts(), self.sentences().join("; "))
    }
}
