//! Figure of `profile contact`: the pair with its contact points, contact functions and conicity.

use railspring_profiles::rigid_contact::{ContactFunctions, Wheelset, WheelsetContact};
use railspring_profiles::units::MILLIMETRE;

use super::parameters::Found;
use crate::report::panel::{Panel, stacked};
use crate::report::plot::{BLUE, DARK, Dash, GREY, LIGHT, RED, Series};

/// Wheel above rail with lines between the points that touch, rolling-radius difference, contact angles and conicity.
pub(super) fn picture(
    wheelset: &Wheelset,
    rows: &[(f64, WheelsetContact)],
    functions: &ContactFunctions,
    found: &Found,
) -> String {
    /// How far the wheel is drawn above the rail, mm.
    const LIFT: f64 = 25.0;
    /// About this many lines are drawn.
    const LINES: usize = 32;
    let side = &wheelset.right;
    let on_rail = |p: nalgebra::Point2<f64>| (p.x / MILLIMETRE, -p.y / MILLIMETRE);
    let on_wheel = |p: nalgebra::Point2<f64>| ((p.x + wheelset.tape_y) / MILLIMETRE, LIFT - p.y / MILLIMETRE);
    let sample = 0.25 * MILLIMETRE;
    let rail: Vec<_> = side.rail.curve.sample(sample).into_iter().map(on_rail).collect();
    let wheel: Vec<_> = side.wheel.sample(sample).into_iter().map(on_wheel).collect();
    // Lines are parted by a point that is not finite.
    let mut lines = Vec::new();
    for (_, both) in rows.iter().step_by(rows.len().div_ceil(LINES)) {
        for p in &both.right.points {
            lines.push(on_wheel(side.wheel.point(p.wheel_s)));
            lines.push(on_rail(side.rail.curve.point(p.rail_s)));
            lines.push((f64::NAN, f64::NAN));
        }
    }
    let running = functions.running().points();
    let difference = running.iter().map(|p| (p.shift / MILLIMETRE, p.difference / MILLIMETRE)).collect();
    let tangents = functions.points().iter().map(|p| (p.shift / MILLIMETRE, p.tangent_difference)).collect();
    let mut conicity = vec![Series::line("equivalent conicity", fine(functions), DARK, Dash::Dashed)];
    conicity.splice(0..0, Series::band("its uncertainty, k = 2", &found.band(), LIGHT));
    let panels = [
        Panel::new(
            "y from the track centre, wheelset in the middle (mm)",
            "height, the wheel lifted (mm)",
            vec![
                Series::line("points that touch", lines, RED, Dash::Solid),
                Series::line("wheel", wheel, DARK, Dash::Solid),
                Series::line("rail", rail, GREY, Dash::Solid),
            ],
        ),
        Panel::new(
            "lateral shift (mm)",
            "rolling-radius difference (mm)",
            vec![Series::line("rolling-radius difference", difference, BLUE, Dash::Solid)],
        ),
        Panel::new(
            "lateral shift (mm)",
            "tan γ right − tan γ left",
            vec![Series::line("difference of the contact angles' tangents", tangents, BLUE, Dash::Dashed)],
        ),
        Panel::from_zero("amplitude (mm)", "equivalent conicity", conicity),
    ];
    stacked(760, 330, &panels)
}

/// Equivalent conicity at every tenth of a millimetre of amplitude, mm.
fn fine(functions: &ContactFunctions) -> Vec<(f64, f64)> {
    let last = functions.points().last().map_or(0.0, |p| p.shift / MILLIMETRE);
    let amplitudes = (5..).map(|i| 0.1 * f64::from(i)).take_while(|a| *a <= last);
    let of = |a: f64| functions.running().equivalent_conicity(a * MILLIMETRE).map(|tangent| (a, tangent));
    amplitudes.filter_map(of).collect()
}
