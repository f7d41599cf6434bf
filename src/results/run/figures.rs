//! The figures of a load case: the contact elements of the simple model and the solid model over time.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::time::history::{ContactMode, History, HistoryRow};

use crate::report::legend::{Entry, draw_legend, legend_height};
use crate::report::number::{WIDTH, round};
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{
    BLUE, DARK, Dash, Drawn, GREY, LIGHT, ORANGE, PALE_BLUE, RED, Series, frame, label, nice_step, px,
    stroke, svg, tick,
};
use crate::results::run::uncertain_record::{Quantiles, UncertainRow, UncertainRun, band as band_of};
use crate::verify::{Band, Carrying, FLANGE_SIDE, averaged_ratio};

/// A run of a model, as figures show it.
#[derive(Debug, Clone, Copy)]
pub struct ModelRun<'a> {
    /// What figures call it: `solid`, or the contact element of the simple model.
    pub name: &'a str,
    /// The run.
    pub history: &'a History,
    /// Where its averaged P carries Q/P.
    pub carrying: Carrying,
}

/// The runs of one scenario.
#[derive(Debug, Clone)]
pub struct ScenarioRun<'a> {
    /// Name of the scenario.
    pub name: &'a str,
    /// What happens in it.
    pub description: &'a str,
    /// Times of the pictures of the contact positions, s.
    pub snapshots: &'a [f64],
    /// The simple model's runs: with the study's contact element, then with each other one that ran.
    pub elements: Vec<ModelRun<'a>>,
    /// The solid model's run, if it ran.
    pub solid: Option<ModelRun<'a>>,
    /// The numerical uncertainty of the solid's run at each of its times, if that is known.
    pub band: Option<Band>,
    /// The simple model with inputs that are not known exactly, if it ran.
    pub uncertain: Option<&'a UncertainRun>,
}

/// P and Q of all models over time.
pub fn forces(run: &ScenarioRun<'_>) -> String {
    let panel = |symbol: &str,
                 name: &str,
                 which: usize,
                 value: fn(&HistoryRow) -> f64,
                 inputs: fn(&UncertainRow) -> Quantiles| {
        let points = |of: &ModelRun<'_>| -> Vec<(f64, f64)> {
            of.history.rows.iter().map(|row| (row.time, value(row) / KILONEWTON)).collect()
        };
        let width = |band: &Band| -> Vec<Option<f64>> {
            band.forces[which].iter().map(|width| width.map(|width| width / KILONEWTON)).collect()
        };
        Panel::from_zero("time, s", &format!("{name} {symbol}, kN"), curves(run, points, width, inputs))
    };
    stacked(
        WIDTH,
        300,
        &[
            panel("P", "vertical force", 0, |row| row.vertical_force, |row| row.p),
            panel("Q", "lateral force", 1, |row| row.lateral_force, |row| row.q),
        ],
    )
}

/// Q/P averaged over the window, of all models, where the averaged P of each carries it.
pub fn ratio(run: &ScenarioRun<'_>, window: f64) -> String {
    let points = |of: &ModelRun<'_>| -> Vec<(f64, f64)> {
        let ratios = averaged_ratio(of.history, window, &of.carrying);
        let rows = of.history.rows.iter().zip(ratios);
        rows.map(|(row, ratio)| (row.time, ratio.unwrap_or(f64::NAN))).collect()
    };
    stacked(
        WIDTH,
        300,
        &[Panel::from_zero(
            "time, s",
            &format!("Q/P averaged over {} ms", round(window * 1e3)),
            curves(run, points, |band| band.ratio.clone(), |row| row.ratio),
        )],
    )
}

/// Lateral and vertical displacement of the wheel centre, of all models.
pub fn wheel(run: &ScenarioRun<'_>) -> String {
    let panel = |name: &str, value: fn(&HistoryRow) -> f64| {
        Panel::from_zero(
            "time, s",
            name,
            curves(
                run,
                |of| of.history.rows.iter().map(|row| (row.time, value(row) / MILLIMETRE)).collect(),
                |_| Vec::new(),
                |_| None,
            ),
        )
    };
    stacked(
        WIDTH,
        220,
        &[
            panel("wheel to the field side, mm", |row| row.wheel_y),
            panel("wheel down, mm", |row| row.wheel_z),
        ],
    )
}

/// What the figures show of the band around the solid, as a sentence; empty without a band.
pub fn band_caption(run: &ScenarioRun<'_>) -> String {
    let Some(band) = &run.band else { return String::new() };
    let ms = |time: f64| round(time * 1e3);
    let steps = band.steps_until_s.map(|until| {
        let last = run.solid.as_ref().and_then(|solid| solid.history.rows.last()).map(|row| row.time);
        let later = match last.is_some_and(|last| last > until) {
            true => ", and taken to be the same after them, where it was not compared",
            false => "",
        };
        format!("the RMS change with steps of another length over {} ms{later}", ms(until))
    });
    let input = band.spread_until_s.map(|until| {
        format!("the change at each instant with an input that is 0.1 % larger, up to {} ms", ms(until))
    });
    let parts: Vec<String> = steps.into_iter().chain(input).collect();
    let squares = if parts.len() == 2 { "the root of the squares of " } else { "" };
    format!(" Band: the numerical uncertainty of the solid, {squares}{}.", parts.join(" and "))
}

/// What the figures show of the band by the inputs, as a sentence; empty without one.
pub fn inputs_caption(run: &ScenarioRun<'_>) -> String {
    run.uncertain.map_or_else(String::new, |of| {
        format!(
            " Light band: between 2.5 and 97.5 % at each instant of {}, whose inputs depart by their uncertainties.",
            of.record.counts()
        )
    })
}

/// Curves of all models over the band by the `inputs` and that around the solid, whose half widths are those at the solid's points.
fn curves(
    run: &ScenarioRun<'_>,
    points: impl Fn(&ModelRun<'_>) -> Vec<(f64, f64)>,
    width: impl Fn(&Band) -> Vec<Option<f64>>,
    inputs: fn(&UncertainRow) -> Quantiles,
) -> Vec<Series> {
    let ends = |row: &UncertainRow| (row.time, inputs(row).map_or([f64::NAN; 2], band_of));
    let by_inputs = run.uncertain.into_iter().flat_map(|of| {
        let ends: Vec<(f64, [f64; 2])> = of.rows.iter().map(ends).collect();
        Series::band("95 % by the inputs", &ends, LIGHT)
    });
    let solid = run.solid.as_ref().map(&points);
    let band = solid.iter().zip(&run.band).flat_map(|(solid, band)| {
        let around = |((x, y), width): (&(f64, f64), Option<f64>)| {
            let width = width.unwrap_or(f64::NAN);
            (*x, [y - width, y + width])
        };
        let ends: Vec<(f64, [f64; 2])> = solid.iter().zip(width(band)).map(around).collect();
        Series::band("uncertainty of the solid", &ends, PALE_BLUE)
    });
    let mut series: Vec<Series> = by_inputs.chain(band).collect();
    // thin, so that the band is seen beside it
    let line =
        |points: &Vec<(f64, f64)>| Series::line("solid model", points.clone(), DARK, Dash::Solid).thin();
    series.extend(solid.iter().map(line));
    let looks = match run.solid {
        Some(_) => [(RED, Dash::Dashed), (BLUE, Dash::Dashed), (ORANGE, Dash::Dotted)],
        None => [(RED, Dash::Solid), (BLUE, Dash::Dashed), (ORANGE, Dash::Dotted)],
    };
    // the study's element lies on top
    for (of, (color, dash)) in run.elements.iter().zip(looks).rev() {
        series.push(Series::line(&format!("{} element", of.name), points(of), color, dash));
    }
    series
}

/// Contact modes of tread and flange over time, of all models.
pub fn modes(run: &ScenarioRun<'_>) -> String {
    const ROW: u32 = 24;
    const LEFT: u32 = 140;
    let entries =
        [Entry::patch("sticking", DARK), Entry::patch("sliding", ORANGE), Entry::patch("separated", WHITE)];
    let models: Vec<&ModelRun<'_>> = run.elements.iter().chain(&run.solid).collect();
    let top = legend_height(WIDTH, &entries);
    let body = models.len() as u32 * (2 * ROW + 8);
    let last = models.iter().filter_map(|of| of.history.rows.last()).map(|row| row.time);
    let end = last.fold(0.0, f64::max);
    // A run without a step still needs an axis of some length.
    let end = if end > 0.0 { end } else { 1.0 };
    let step = nice_step(end / 8.0);
    svg(WIDTH, top + body + 46, |root| {
        let (legend, rest) = root.split_vertically(px(top));
        draw_legend(&legend, WIDTH, &entries)?;
        let x_of = |time: f64| px(LEFT) + (f64::from(px(WIDTH - LEFT - 20)) * time / end) as i32;
        let text = |content: String, at: (i32, i32), horizontal, vertical, size| -> Drawn {
            rest.draw(&Text::new(content, at, label(size, horizontal, vertical)))?;
            Ok(())
        };
        let mut y = 0;
        for ModelRun { name, history, .. } in &models {
            for (region, on_flange) in [("tread", false), ("flange", true)] {
                let (a, b) = (px(y + 2), px(y + ROW - 2));
                text(
                    format!("{name}, {region}"),
                    (px(LEFT - 8), (a + b) / 2),
                    HPos::Right,
                    VPos::Center,
                    12,
                )?;
                for (mode, begin, end) in spans(history, on_flange) {
                    let color = match mode {
                        ContactMode::Stick => DARK,
                        ContactMode::Slip => ORANGE,
                        ContactMode::Separated => continue,
                    };
                    rest.draw(&Rectangle::new([(x_of(begin), a), (x_of(end), b)], color.filled()))?;
                }
                rest.draw(&frame([(x_of(0.0), a), (x_of(end), b)], stroke(GREY, 7)))?;
                y += ROW;
            }
            y += 8;
        }
        let base = px(y);
        rest.draw(&PathElement::new([(x_of(0.0), base), (x_of(end), base)], stroke(BLACK, 8)))?;
        for n in 0..=(end / step + 1e-9).floor() as usize {
            let time = n as f64 * step;
            rest.draw(&PathElement::new([(x_of(time), base), (x_of(time), base + px(4))], stroke(BLACK, 8)))?;
            text(tick(time, step), (x_of(time), base + px(7)), HPos::Center, VPos::Top, 11)?;
        }
        text("time, s".into(), ((x_of(0.0) + x_of(end)) / 2, base + px(24)), HPos::Center, VPos::Top, 12)
    })
}

/// Times of equal mode on the tread or the flange: (mode, begin, end).
fn spans(history: &History, on_flange: bool) -> Vec<(ContactMode, f64, f64)> {
    let mut spans: Vec<(ContactMode, f64, f64)> = Vec::new();
    for pair in history.rows.windows(2) {
        let here = || pair[1].contacts.iter().filter(|c| (c.wheel.x < FLANGE_SIDE) == on_flange);
        let mode = match here().next() {
            None => ContactMode::Separated,
            Some(_) if here().any(|c| c.mode == ContactMode::Stick) => ContactMode::Stick,
            Some(_) => ContactMode::Slip,
        };
        match spans.last_mut() {
            Some(last) if last.0 == mode => last.2 = pair[1].time,
            _ => spans.push((mode, pair[0].time, pair[1].time)),
        }
    }
    spans
}
