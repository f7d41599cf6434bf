//! The figure of the differences over the load, a panel for each quantity.

use railspring::report::number::WIDTH;
use railspring::report::panel::{Panel, stacked_with_notes};
use railspring::report::plot::{
    BLUE, DARK, DARK_RED, Dash, GREY, Marker, ORANGE, PALE_BLUE, RED, RGBColor, Series,
};

use super::bodies::PressedOn;
use super::record::{Comparison, QUANTITIES};

/// Looks of the places: neighbours differ in colour and in marker.
const LOOKS: [(RGBColor, Marker); 8] = [
    (DARK, Marker::Disc),
    (RED, Marker::Square),
    (BLUE, Marker::Triangle),
    (ORANGE, Marker::Circle),
    (PALE_BLUE, Marker::Square),
    (DARK_RED, Marker::Triangle),
    (GREY, Marker::Disc),
    (RED, Marker::Circle),
];

/// Differences of what is pressed on half-spaces or bodies, with the limits.
pub fn figure(comparison: &Comparison, on: PressedOn) -> String {
    let panel = |(n, (name, _, limit)): (usize, (&str, &str, f64))| {
        let of = |place: &str| -> Vec<(f64, f64)> {
            let rows = comparison.judged().filter(|row| row.place() == place);
            rows.map(|row| (row.load_kn, 100.0 * row.difference(on, n))).collect()
        };
        let places = comparison.places();
        let mut series: Vec<Series> = places
            .iter()
            .zip(LOOKS.into_iter().cycle())
            .map(|(place, (color, marker))| {
                Series::joined(&format!("{place} mm"), of(place), color, Dash::Solid, marker)
            })
            .collect();
        let loads = || comparison.judged().map(|row| row.load_kn);
        let ends = [loads().fold(f64::INFINITY, f64::min), loads().fold(0.0, f64::max)];
        for side in [-limit, limit] {
            let line = ends.iter().map(|load| (*load, 100.0 * side)).collect();
            series.push(Series::line("limit", line, GREY, Dash::Dashed));
        }
        Panel::from_zero("vertical load (kN)", &format!("{name} (%)"), series)
    };
    let panels: Vec<Panel> = QUANTITIES.into_iter().enumerate().map(panel).collect();
    let notes = [format!("Pressed on {}, against the tables of the half-space program.", on.name())];
    stacked_with_notes(WIDTH, 260, &panels, &notes)
}
