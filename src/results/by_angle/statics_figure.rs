//! The figure of the hub's statics: the solid and the contact elements over shift and load.

use plotters::prelude::*;

use crate::report::number::{WIDTH, number};
use crate::report::panel::{Panel, stacked_over_names};
use crate::report::plot::{BLUE, DARK, Dash, Marker, ORANGE, RED, Series};
use crate::results::by_angle::record::{FixedLoadRecord, ShiftRecord, StiffnessByAngleRecord};
use crate::rounding::with_minus_signs;

/// How much of the distance of two shifts their loads take.
const SPREAD: f64 = 0.7;

/// A model with its look, and its values at a load: flexibility of the hub, µm/kN, and displacement along the normal, mm.
struct Model {
    name: &'static str,
    look: (RGBColor, Dash, Marker),
    hub: fn(&FixedLoadRecord) -> Option<[f64; 3]>,
    displacement: fn(&FixedLoadRecord) -> Option<f64>,
}

static MODELS: [Model; 4] = [
    Model {
        name: "solid",
        look: (DARK, Dash::Solid, Marker::Disc),
        hub: |load| Some(load.hub_um_per_kn),
        displacement: |load| load.reference("beam").map(|at| at.displacement_mm),
    },
    Model {
        name: "condensed element",
        look: (RED, Dash::Dashed, Marker::Triangle),
        hub: |load| load.condensed_hub_um_per_kn,
        displacement: |load| load.condensed_displacement_mm,
    },
    Model {
        name: "lumped element",
        look: (BLUE, Dash::Dashed, Marker::Circle),
        hub: |load| load.lumped_hub_um_per_kn,
        displacement: |load| load.lumped_displacement_mm,
    },
    Model {
        name: "published element",
        look: (ORANGE, Dash::Dotted, Marker::Square),
        hub: |load| load.published_hub_um_per_kn,
        displacement: |load| load.published_displacement_mm,
    },
];

/// Flexibility of the hub against the rail's section and its displacement along the contact normal. The shifts stand at equal distances, and at each of them the loads in
/// their order as a short curve. None without a contact element that was pressed.
pub fn statics(laws: &StiffnessByAngleRecord) -> Option<String> {
    let shifts: Vec<&ShiftRecord> = laws.shifts.iter().filter(|shift| !shift.loads.is_empty()).collect();
    let known =
        |model: &Model| shifts.iter().flat_map(|shift| &shift.loads).any(|load| (model.hub)(load).is_some());
    if !MODELS[1..].iter().any(known) {
        return None;
    }
    let loads = || shifts.iter().flat_map(|shift| &shift.loads).map(|load| load.force_kn);
    let (least, most) = (loads().fold(f64::INFINITY, f64::min), loads().fold(0.0, f64::max));
    let place = |shift: usize, force: f64| {
        let along = if most > least { (force - least) / (most - least) - 0.5 } else { 0.0 };
        shift as f64 + SPREAD * along
    };
    let curve = |model: &Model, value: &dyn Fn(&FixedLoadRecord) -> Option<f64>| {
        let of_shift = |(n, shift): (usize, &&ShiftRecord)| -> Vec<(f64, f64)> {
            let point = |load: &FixedLoadRecord| (place(n, load.force_kn), value(load).unwrap_or(f64::NAN));
            // what is not finite parts one shift from the next
            shift.loads.iter().map(point).chain([(f64::NAN, f64::NAN)]).collect()
        };
        let points: Vec<(f64, f64)> = shifts.iter().enumerate().flat_map(of_shift).collect();
        let (color, dash, marker) = model.look;
        let drawn = points.iter().any(|(_, y)| y.is_finite());
        drawn.then(|| Series::joined(model.name, points, color, dash, marker))
    };
    let panel = |y_label: &str, from_zero: bool, series: Vec<Series>| {
        let x_label =
            "lateral shift of the wheelset and contact angle; within each, the load along the normal";
        Panel { from_zero, ..Panel::new(x_label, y_label, series) }
    };
    let hub = |k: usize| {
        MODELS.iter().filter_map(|model| curve(model, &|load| Some((model.hub)(load)?[k]))).collect()
    };
    let over_solid = |model: &'static Model| {
        move |load: &FixedLoadRecord| Some((model.displacement)(load)? / (MODELS[0].displacement)(load)?)
    };
    let displacement = MODELS.iter().filter_map(|model| curve(model, &over_solid(model)));
    let panels = [
        panel("lateral, \u{b5}m/kN", false, hub(0)),
        panel("coupling, \u{b5}m/kN", true, hub(1)),
        panel("vertical, \u{b5}m/kN", true, hub(2)),
        panel("displacement, solid = 1", false, displacement.collect()),
    ];
    let names: Vec<[String; 2]> = shifts
        .iter()
        .map(|shift| {
            let angle = shift.angle().map_or_else(String::new, |angle| format!("{angle:.1}\u{b0}"));
            [format!("{} mm", number(shift.shift_mm)), with_minus_signs(&angle)]
        })
        .collect();
    Some(stacked_over_names(WIDTH, 165, &panels, &[], &names))
}

/// What the figure shows.
pub fn caption(laws: &StiffnessByAngleRecord) -> String {
    let loads = || laws.shifts.iter().flat_map(|shift| &shift.loads).map(|load| load.force_kn);
    let (least, most) = (loads().fold(f64::INFINITY, f64::min), loads().fold(0.0, f64::max));
    format!(
        "Flexibility of the hub against the rail's section under small further forces, everything sticking: lateral, lateral with vertical, and vertical; below, the hub's displacement along \
         the contact normal over that of the solid. At each place of the wheelset the loads go from {} to {} kN, from left to right. The published element has the tangent of its law at the vertical force that it carries there, \
         its constant horizontal stiffness, and no coupling; it is pressed on its own contact nodes with friction {}. The first and the last axis do not begin at zero.",
        number(least),
        number(most),
        number(laws.friction)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// Goal: a curve for each model in each of the four panels, cut between the shifts; the published element's is left out where it was not pressed, and all of the figure where
    /// no element was.
    #[test]
    fn every_model_that_was_pressed_is_drawn() {
        let mut laws = samples::by_angle();
        let shifts = laws.shifts.iter().filter(|shift| !shift.loads.is_empty()).count();
        let squares = |figure: &str| figure.matches("#E28C1E").count();
        let figure = statics(&laws).unwrap();
        let discs = figure.matches("<circle").count();
        let points: usize = laws.shifts.iter().map(|shift| shift.loads.len()).sum();
        // and that of the legend; an open circle of the lumped element is two
        assert_eq!(discs, 3 * (4 * points + 1));
        assert!(shifts > 1 && squares(&figure) > 4 * points && figure.contains("published element"));
        let loads = |laws: &mut StiffnessByAngleRecord, change: fn(&mut FixedLoadRecord)| {
            laws.shifts.iter_mut().flat_map(|shift| &mut shift.loads).for_each(change);
        };
        loads(&mut laws, |load| {
            (load.published_hub_um_per_kn, load.published_displacement_mm) = (None, None);
        });
        let figure = statics(&laws).unwrap();
        assert!(squares(&figure) == 0 && !figure.contains("published element"));
        loads(&mut laws, |load| {
            (load.condensed_hub_um_per_kn, load.condensed_displacement_mm) = (None, None);
        });
        assert!(statics(&laws).is_some_and(|figure| !figure.contains("condensed element")));
        loads(&mut laws, |load| load.lumped_hub_um_per_kn = None);
        assert!(statics(&laws).is_none());
    }
}
