//! A made-up head that ends beside its top.

use nalgebra::Point2;

use crate::results::bodies::outline_figure::BodyOutline;
use crate::results::bodies::surface_figure::{Changed, OffStandard, OnStandard, Origin, Part};

/// A square rail of 100 mm under a square wheel of 400 mm; the upper side of the rail was measured.
pub(crate) fn bodies() -> [BodyOutline; 2] {
    let square = |left: f64, top: f64, side: f64| -> Vec<Point2<f64>> {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side), (0.0, 0.0)];
        corners.map(|(y, z)| Point2::new((left + y) * 1e-3, (top + z) * 1e-3)).to_vec()
    };
    let rail = square(700.0, 0.0, 100.0);
    let measured = rail[..2].to_vec();
    [
        BodyOutline { body: "rail", outline: rail, measured },
        BodyOutline { body: "wheel", outline: square(600.0, -400.0, 400.0), measured: Vec::new() },
    ]
}

/// A measured head worn by 1 mm on an even standard, which goes on at its field side, with one point that was changed.
pub(crate) fn surface() -> OnStandard {
    let mm = |y: f64, z: f64| Point2::new(y * 1e-3, z * 1e-3);
    let part = |origin, points: &[(f64, f64)], running| Part {
        origin,
        points: points.iter().map(|(y, z)| mm(*y, *z)).collect(),
        length: points.windows(2).map(|w| 1e-3 * (w[1].0 - w[0].0).hypot(w[1].1 - w[0].1)).sum(),
        running,
    };
    let off = |y: f64, z: f64| OffStandard { point: mm(y, z), along: 1e-3 * (y + 36.0), missing: 1e-3 * z };
    OnStandard {
        body: "wheel".into(),
        file: "worn.prw".into(),
        standard: "S1002".into(),
        parts: vec![
            part(Origin::Measured, &[(-36.0, 1.0), (0.0, 1.0), (2.0, 1.0)], true),
            part(Origin::Transition, &[(2.0, 1.0), (6.0, 0.5), (10.0, 0.0)], true),
            part(Origin::Standard, &[(10.0, 0.0), (36.0, 0.0)], true),
            part(Origin::MeasuredUnused, &[(2.0, 1.0), (3.0, 1.0)], true),
            part(Origin::StandardUnused, &[(-36.0, 0.0), (10.0, 0.0)], true),
            part(Origin::Standard, &[(36.0, 0.0), (36.0, 20.0)], false),
        ],
        measured: vec![off(-36.0, 1.0), off(0.0, 1.0), off(2.0, 1.0)],
        transitions: vec![vec![off(2.0, 1.0), off(6.0, 0.5), off(10.0, 0.0)]],
        kept: vec![off(-36.0, 0.0)],
        read: 400,
        left: 399,
        changed: vec![Changed { read: off(-10.0, 1.31), change: 0.31e-3, line: 17 }],
    }
}
