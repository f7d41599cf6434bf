//! The figure of the time of a step of the moving solver over the elements of the rail, beside other programs.

use plotters::style::RGBColor;

use super::figures::WIDTH;
use super::panel::{Panel, stacked_logarithmic};
use super::plot::{BLUE, DARK, DARK_RED, Dash, GREY, Marker, ORANGE, RED, Series};
use crate::records::StepTimesRecord;

/// Looks of the program's own curves and of those of others.
const OWN: [(RGBColor, Dash, Marker); 3] = [
    (DARK, Dash::Solid, Marker::Disc),
    (BLUE, Dash::Solid, Marker::Triangle),
    (RED, Dash::Solid, Marker::Square),
];
const OTHERS: [(RGBColor, Dash, Marker); 3] = [
    (GREY, Dash::Dashed, Marker::Disc),
    (ORANGE, Dash::Dotted, Marker::Triangle),
    (DARK_RED, Dash::Dashed, Marker::Square),
];

/// Microseconds a step over the elements, with how the numbers of others were made.
pub fn figure(record: &StepTimesRecord, peers_made: &str) -> String {
    let mut series = Vec::new();
    let names = record.times.iter().map(|time| (time.case.as_str(), time.element.as_str()));
    for ((case, element), (color, dash, marker)) in distinct(names).into_iter().zip(OWN.into_iter().cycle()) {
        let of = record.times.iter().filter(|time| time.case == case && time.element == element);
        let points = of.map(|time| (time.elements as f64, time.microseconds)).collect();
        series.push(Series::joined(&format!("{case}, {element} element"), points, color, dash, marker));
    }
    let programs = record.peers.iter().map(|peer| (peer.case.as_str(), peer.program.as_str()));
    for ((case, program), (color, dash, marker)) in
        distinct(programs).into_iter().zip(OTHERS.into_iter().cycle())
    {
        let of = record.peers.iter().filter(|peer| peer.case == case && peer.program == program);
        let points = of.map(|peer| (peer.elements as f64, peer.least_microseconds)).collect();
        series.push(Series::joined(&format!("{case}, {program}"), points, color, dash, marker));
    }
    let panel = Panel {
        x_label: "beam elements".into(),
        y_label: "time of a step (\u{b5}s)".into(),
        from_zero: false,
        series,
    };
    let processor = record.machine.processor.as_deref().unwrap_or("unknown processor");
    let notes = [
        format!(
            "{processor}, {} cores; {}, shortest of {} runs on one thread.",
            record.machine.cores, record.clock, record.repeats
        ),
        format!("{peers_made}."),
    ];
    stacked_logarithmic(WIDTH, 420, &[panel], &notes)
}

/// The pairs in their order, each once.
fn distinct<'a>(pairs: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<(&'a str, &'a str)> {
    let mut known = Vec::new();
    for pair in pairs {
        if !known.contains(&pair) {
            known.push(pair);
        }
    }
    known
}
