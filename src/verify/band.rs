//! How far a run is from itself at each of its times, for the band around it in figures.

use super::change::{FORCES, scales};
use super::limits::Limits;
use super::model_run::ModelRun;
use super::series::column;
use super::signals::averaged_ratio;

/// How far a run is from itself, row by row of its history: other steps and an input that is 0.1 % larger together as the root of their squares, as in the
/// verdict's lines.
///
/// The run with other steps is not kept. Its part is the RMS change of the time over which it was compared, at every time: of later times nothing else is
/// known, and errors of steps do not become smaller. The larger input's part is the change at that very time, and where the disturbed run has ended there is
/// no band.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Of P and of Q, N.
    pub forces: [Vec<Option<f64>>; 2],
    /// Of the averaged Q/P, where both runs have it.
    pub ratio: Vec<Option<f64>>,
    /// Time up to which other steps were compared, s; none where they are no part of the band.
    pub steps_until_s: Option<f64>,
    /// Time up to which the disturbed run goes, s; none where it is no part of the band.
    pub spread_until_s: Option<f64>,
}

impl Band {
    /// The band of a run, its averages as the limits have them; none where nothing is known of its uncertainty.
    pub fn around(run: &ModelRun<'_>, limits: &Limits) -> Option<Self> {
        if run.steps.is_none() && run.disturbed.is_none() {
            return None;
        }
        let (history, disturbed) = (run.history, run.disturbed.map(|(other, _)| other));
        let rows = history.rows.len();
        let change = run.steps.map(|steps| steps.of.change);
        let scales = scales(history);
        let by_steps = change.map_or([0.0; 2], |c| [c.p_rms * scales[0], c.q_rms * scales[1]]);
        // of a run without a disturbed one the steps alone
        let beside = |own: &[f64], other: Option<&[f64]>, by_steps: f64| -> Vec<Option<f64>> {
            let by_input = |n: usize| match other {
                None => Some(0.0),
                Some(other) => other.get(n).map(|value| value - own[n]),
            };
            (0..rows).map(|n| Some(by_steps.hypot(by_input(n)?))).collect()
        };
        let forces = [0, 1].map(|k| {
            let own = column(history, FORCES[k]);
            let other = disturbed.map(|other| column(other, FORCES[k]));
            beside(&own, other.as_deref(), by_steps[k])
        });
        let carrying = run.carrying(limits.ratio_max);
        // what is not carried is no number, and neither is a difference of it
        let ratio = |of| -> Vec<f64> {
            let ratios = averaged_ratio(of, limits.ratio_window_s, &carrying);
            ratios.into_iter().map(|ratio| ratio.unwrap_or(f64::NAN)).collect()
        };
        let (own, other) = (ratio(history), disturbed.map(ratio));
        let by_steps = change.and_then(|c| c.ratio_rms).unwrap_or(0.0);
        let ratio = beside(&own, other.as_deref(), by_steps);
        Some(Self {
            forces,
            ratio: ratio.into_iter().map(|width| width.filter(|width| width.is_finite())).collect(),
            steps_until_s: run.steps.map(|steps| steps.of.until_s),
            spread_until_s: disturbed.and_then(|other| other.rows.last()).map(|row| row.time),
        })
    }
}

#[cfg(test)]
mod tests {
    use railspring_simulate::time::history::{Ending, History};
    use railspring_simulate::time::steps::InnerSteps;

    use super::*;
    use crate::verify::Spread;
    use crate::verify::StepChange;
    use crate::verify::tests::forces_alone;

    /// ROUNDOFF: sums and roots of some numbers of order 1e5.
    const ROUNDOFF: f64 = 1e-9;

    /// P of 100 kN and `more` (N), Q a fifth of it, at `count` times of 1 ms.
    fn run(count: usize, more: impl Fn(usize) -> f64) -> History {
        let row = |n: usize| forces_alone(n as f64 * 1e-3, 100e3 + more(n), 0.2 * (100e3 + more(n)));
        History { rows: (0..count).map(row).collect(), degrees_of_freedom: 1, ending: Ending::Completed }
    }

    /// Goal: half widths of P, Q (N) and averaged Q/P over 21 ms. Steps that change P by 2 kN everywhere are
    /// 2 kN at all times, also after the 11 ms that were compared. An input that changes it by 1.5 kN from 10
    /// ms on adds as the root of the squares, 2.5 kN. It ends the band with its run at 15 ms. Q/P does not
    /// change. Accuracy: ROUNDOFF.
    #[test]
    fn steps_and_input_add_as_squares_where_they_are_known() {
        let history = run(21, |_| 0.0);
        let steps = StepChange::between([&history, &run(12, |_| 2e3)], [InnerSteps::Equal(2); 2], 1e-3, None)
            .unwrap();
        let other = run(16, |n| if n < 10 { 0.0 } else { 1.5e3 });
        let spread = Spread::between(&history, &other, "lateral force").unwrap();
        let limits = Limits::default();
        let with = |steps, disturbed| {
            let run = ModelRun { steps, disturbed, ..ModelRun::alone(&history) };
            Band::around(&run, &limits)
        };
        let near = |value: Option<f64>, expected: f64| (value.unwrap() - expected).abs() < ROUNDOFF * 1e5;
        let band = with(Some(&steps), Some((&other, &spread))).unwrap();
        assert!(near(band.forces[0][9], 2e3) && near(band.forces[0][10], 2.5e3), "{band:?}");
        assert!(near(band.forces[0][15], 2.5e3) && near(band.forces[1][15], 500.0), "{band:?}");
        assert_eq!((band.forces[0][16], band.forces[1][20], band.ratio[16]), (None, None, None));
        assert!(band.ratio[..16].iter().all(|width| width.unwrap() < ROUNDOFF), "{band:?}");
        assert!((band.steps_until_s.unwrap() - 11e-3).abs() < ROUNDOFF);
        assert!((band.spread_until_s.unwrap() - 15e-3).abs() < ROUNDOFF);
        let band = with(Some(&steps), None).unwrap();
        assert!(near(band.forces[0][20], 2e3) && band.spread_until_s.is_none(), "{band:?}");
        let band = with(None, Some((&other, &spread))).unwrap();
        assert!(near(band.forces[0][9], 0.0) && near(band.forces[0][10], 1.5e3), "{band:?}");
        assert_eq!(with(None, None), None);
    }
}
