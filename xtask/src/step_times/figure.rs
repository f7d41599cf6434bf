//! The figure of the time of a step of the moving solver over the elements of the rail, beside other programs.

use railspring::report::number::WIDTH;
use railspring::report::panel::{Panel, stacked_logarithmic};
use railspring::report::plot::{DARK, DARK_RED, Dash, GREY, Marker, ORANGE, RED, RGBColor, Series};

use super::record::{HOSTED, StepTimesRecord};

/// Looks of the program's own curves: a colour for each element, a marker for each case.
const ELEMENTS: [RGBColor; 2] = [DARK, RED];
const CASES: [Marker; 4] = [Marker::Disc, Marker::Circle, Marker::Triangle, Marker::Square];
/// Those of others.
const OTHERS: [(RGBColor, Dash, Marker); 3] = [
    (GREY, Dash::Dashed, Marker::Disc),
    (ORANGE, Dash::Dotted, Marker::Triangle),
    (DARK_RED, Dash::Dashed, Marker::Square),
];

/// Microseconds a step over the elements; hosts have one rail.
pub fn figure(record: &StepTimesRecord) -> String {
    let mut series = Vec::new();
    let times = record.times.iter().filter(|time| time.case != HOSTED);
    let names = || times.clone().map(|time| (time.case.as_str(), time.element.as_str()));
    let place = |of: Vec<&str>, name: &str| of.iter().position(|known| *known == name).unwrap_or(0);
    for (case, element) in distinct(names()) {
        let color = ELEMENTS[place(distinct(names().map(|name| name.1)), element) % ELEMENTS.len()];
        let marker = CASES[place(distinct(names().map(|name| name.0)), case) % CASES.len()];
        let of = times.clone().filter(|time| time.case == case && time.element == element);
        let points = of.map(|time| (time.elements as f64, time.microseconds)).collect();
        series.push(Series::joined(
            &format!("{case}, {element} element"),
            points,
            color,
            Dash::Solid,
            marker,
        ));
    }
    let peers = record.peers.iter().filter(|peer| peer.case != HOSTED);
    let programs = peers.clone().map(|peer| (peer.case.as_str(), peer.program.as_str()));
    for ((case, program), (color, dash, marker)) in
        distinct(programs).into_iter().zip(OTHERS.into_iter().cycle())
    {
        let of = peers.clone().filter(|peer| peer.case == case && peer.program == program);
        let points = of.map(|peer| (peer.elements as f64, peer.microseconds)).collect();
        series.push(Series::joined(&format!("{case}, {program}"), points, color, dash, marker));
    }
    let panel = Panel {
        x_label: "beam elements".into(),
        y_label: "time of a step (\u{b5}s)".into(),
        from_zero: false,
        series,
    };
    let processor = record.machine.processor.as_deref().unwrap_or("unknown processor");
    let note = format!(
        "{processor}, {} cores; {}, shortest of {} runs on one thread, all in turns.",
        record.machine.cores, record.clock, record.repeats
    );
    stacked_logarithmic(WIDTH, 420, &[panel], &[note])
}

/// Names in their order, each once.
fn distinct<T: PartialEq>(names: impl Iterator<Item = T>) -> Vec<T> {
    let mut known = Vec::new();
    for name in names {
        if !known.contains(&name) {
            known.push(name);
        }
    }
    known
}
