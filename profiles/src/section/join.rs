//! A measured running surface on a standard body.

use nalgebra::{Point2, Vector2};

use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::parabola::Parabola;
use crate::profile::{Piece, ProfileCurve};
use crate::profile_file::{Action, Finding, FindingKind};
use crate::units::MILLIMETRE;

/// Least length over which a measured surface passes into the standard one, m.
const LEAST_BLEND: f64 = 3.0 * MILLIMETRE;
/// Greatest such length, m.
const GREATEST_BLEND: f64 = 15.0 * MILLIMETRE;
/// Length of the transition as a multiple of the distance to be bridged.
const BLEND_TO_OFFSET: f64 = 8.0;
/// Greatest distance of a measured end from the standard surface, m.
const GREATEST_OFFSET: f64 = 5.0 * MILLIMETRE;
/// Greatest angle between the two surfaces at a measured end, degrees.
const GREATEST_TURN: f64 = 30.0;
/// Distance of the samples of the transition and of the standard surface, m.
const STEP: f64 = 0.2 * MILLIMETRE;
/// A knot this near to a cut is left out, m.
const NEAR_CUT: f64 = 0.02 * MILLIMETRE;

/// One end of the join: arc lengths at which the standard surface ends and the measured one begins.
struct Seam {
    standard: f64,
    measured: f64,
    offset: f64,
}

/// A measured curve with the standard one beyond its ends.
pub(super) struct Joined {
    pub curve: ProfileCurve,
    /// Arc lengths (m) at which the standard surface ends, the measured one begins and ends, and the standard one goes on; between are
    /// the transitions.
    pub seams: [f64; 4],
}

/// The measured curve with the standard one beyond its ends, joined with continuous tangents. The ends are those
/// of the standard curve. Where the measured curve reaches the standard's end or goes beyond, it is cut off before.
///
/// # Errors
/// [`InputError`] naming `field` if the ends of the measured curve do not lie near the standard one.
pub(super) fn join(
    standard: &ProfileCurve,
    measured: &ProfileCurve,
    field: InputField,
    findings: &mut Vec<Finding>,
) -> Result<Joined> {
    let start = seam(standard, measured, Side::Start, field)?;
    let end = seam(standard, measured, Side::End, field)?;
    if end.measured - start.measured < 2.0 * LEAST_BLEND || end.standard <= start.standard {
        return InputError::refuse(
            field,
            format!(
                "{:.2} mm on the standard surface",
                (end.measured - start.measured).max(0.0) / MILLIMETRE
            ),
            "a measured surface that covers the standard's contact range",
            remedy(field),
        );
    }
    for (seam, side) in [(&start, Side::Start), (&end, Side::End)] {
        let at = standard.point(seam.standard);
        let text = format!(
            "{} joined to the standard surface at y = {:.3}, z = {:.3} mm; distance bridged with continuous tangent",
            side.name(),
            at.x / MILLIMETRE,
            at.y / MILLIMETRE
        );
        findings.push(
            Finding::new(FindingKind::Joined, Action::Noted, text)
                .with_value(seam.offset / (1e-3 * MILLIMETRE), "\u{b5}m"),
        );
    }
    let mut pieces = part(standard, 0.0, start.standard, Samples::Even);
    let into = (standard.point(start.standard), direction(standard, start.standard, Side::End));
    let out = (measured.point(start.measured), without_scatter(measured, start.measured, Side::Start));
    pieces.push(transition(into, out));
    let mut surface = part(measured, start.measured, end.measured, Samples::Knots);
    let into = (measured.point(end.measured), without_scatter(measured, end.measured, Side::End));
    let tangents = |piece: Option<&mut Piece>, at: usize, tangent| {
        if let Some([from, to]) = piece.and_then(|piece| piece.end_tangents.as_mut()) {
            *[from, to][at] = tangent;
        }
    };
    tangents(surface.first_mut(), 0, out.1);
    tangents(surface.last_mut(), 1, into.1);
    pieces.extend(surface);
    let out = (standard.point(end.standard), direction(standard, end.standard, Side::Start));
    pieces.push(transition(into, out));
    pieces.extend(part(standard, end.standard, standard.length(), Samples::Even));
    let curve = ProfileCurve::from_pieces(pieces);
    let ends = [
        standard.point(start.standard),
        measured.point(start.measured),
        measured.point(end.measured),
        standard.point(end.standard),
    ];
    let seams = ends.map(|p| curve.closest(&p).0);
    Ok(Joined { curve, seams })
}

/// A curve between two of its arc lengths, with its own knots.
pub(super) fn trimmed(curve: &ProfileCurve, from: f64, to: f64) -> ProfileCurve {
    ProfileCurve::from_pieces(part(curve, from, to, Samples::Knots))
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Start,
    End,
}

impl Side {
    fn name(self) -> &'static str {
        match self {
            Self::Start => "measured start",
            Self::End => "measured end",
        }
    }
}

/// Where the standard surface is left (or reached again) and where the measured one begins (or ends).
fn seam(standard: &ProfileCurve, measured: &ProfileCurve, side: Side, field: InputField) -> Result<Seam> {
    // Arc lengths counted from the end in question, inwards.
    let from = |curve: &ProfileCurve, inwards: f64| match side {
        Side::Start => inwards,
        Side::End => curve.length() - inwards,
    };
    let inwards = |curve: &ProfileCurve, s: f64| from(curve, s);
    let end = measured.point(from(measured, 0.0));
    let (s, offset) = standard.closest(&end);
    let reach = inwards(standard, s);
    let blend = |offset: f64| (BLEND_TO_OFFSET * offset).clamp(LEAST_BLEND, GREATEST_BLEND);
    let mut found = Seam { standard: 0.0, measured: 0.0, offset };
    if reach > blend(offset) {
        found.standard = from(standard, reach - blend(offset));
        found.measured = from(measured, 0.0);
    } else {
        // The measured curve runs to the end of the standard one: cut it off where the transition begins. Its
        // offset there sets the length, so look twice.
        let mut length = LEAST_BLEND;
        for _ in 0..2 {
            let (cut, distance) = measured.closest(&standard.point(from(standard, length)));
            found = Seam { standard: from(standard, 0.0), measured: cut, offset: distance };
            length = blend(distance);
        }
    }
    let at_standard = standard.closest(&measured.point(found.measured)).0;
    let turn = standard.tangent(at_standard).angle(&direction(measured, found.measured, side)).to_degrees();
    if found.offset > GREATEST_OFFSET || turn > GREATEST_TURN {
        let p = measured.point(found.measured);
        return InputError::refuse(
            field,
            format!(
                "{} (y {:.2} mm, z {:.2} mm), {:.2} mm off the standard surface and turned by {turn:.1} degrees",
                side.name(),
                p.x / MILLIMETRE,
                p.y / MILLIMETRE,
                found.offset / MILLIMETRE,
            ),
            format!("at most {} mm and {GREATEST_TURN} degrees", GREATEST_OFFSET / MILLIMETRE),
            remedy(field),
        );
    }
    Ok(found)
}

/// What to do about a measured surface that does not lie on the standard one.
fn remedy(field: InputField) -> String {
    let aligned =
        if field == InputField::RailProfile { InputField::RailAligned } else { InputField::WheelAligned };
    format!(
        "check that the standard is the right one; a profile that is not in its frame, as one that is measured canted, needs \
         `{aligned}` = true"
    )
}

/// Unit tangent at `s`, at a breakpoint that of the side on which the curve goes on.
fn direction(curve: &ProfileCurve, s: f64, side: Side) -> Vector2<f64> {
    const INSIDE: f64 = 1e-9;
    match side {
        Side::Start => curve.tangent(s),
        Side::End => curve.tangent(s - INSIDE),
    }
}

/// Unit tangent at the end `s` of what is taken of a measured curve, from a parabola through its last 2 mm: a spline through points that
/// scatter by 10 µm ends up to 0.3 rad off, which the transition would carry on. Of a smooth curve its own tangent is the better one.
fn without_scatter(curve: &ProfileCurve, s: f64, side: Side) -> Vector2<f64> {
    const LENGTH: f64 = 2.0 * MILLIMETRE;
    const COUNT: usize = 41;
    /// Difference that a parabola leaves of the arcs and lines of a profile, rad.
    const OWN: f64 = 0.02;
    let own = direction(curve, s, side);
    let inwards = if side == Side::Start { LENGTH } else { -LENGTH };
    let places = (0..COUNT).map(|i| s + inwards * i as f64 / (COUNT - 1) as f64);
    let points: Vec<Point2<f64>> =
        places.map(|place| curve.point(place.clamp(0.0, curve.length()))).collect();
    let Some(along) = (points[COUNT - 1] - points[0]).try_normalize(f64::MIN_POSITIVE) else { return own };
    let along = along * inwards.signum();
    let across = Vector2::new(-along.y, along.x);
    let samples = points.iter().map(|p| {
        let offset = (p - points[0]) / LENGTH;
        (offset.dot(&along), 1.0, Vector2::new(offset.dot(&across), 0.0))
    });
    let Some(fitted) = Parabola::through(samples) else { return own };
    let tangent = (along + fitted.coefficients[(1, 0)] * across).normalize();
    if tangent.angle(&own) < OWN { own } else { tangent }
}

#[derive(Clone, Copy, PartialEq)]
enum Samples {
    /// Evenly spaced points.
    Even,
    /// The knots of the curve itself.
    Knots,
}

/// Pieces of a curve between two arc lengths, divided at its breakpoints.
fn part(curve: &ProfileCurve, from: f64, to: f64, samples: Samples) -> Vec<Piece> {
    let inside = |s: &f64| *s > from + NEAR_CUT && *s < to - NEAR_CUT;
    let mut ends = vec![from];
    ends.extend(curve.breakpoints().into_iter().filter(inside));
    ends.push(to);
    let own: Vec<f64> = match samples {
        Samples::Even => Vec::new(),
        Samples::Knots => curve.knots().to_vec(),
    };
    let mut pieces = Vec::new();
    for pair in ends.windows(2).filter(|pair| pair[1] > pair[0]) {
        let (s0, s1) = (pair[0], pair[1]);
        let inner: Vec<f64> = match samples {
            Samples::Even => {
                let count = ((s1 - s0) / STEP).ceil().max(1.0) as usize;
                (1..count).map(|i| s0 + (s1 - s0) * i as f64 / count as f64).collect()
            }
            Samples::Knots => {
                own.iter().copied().filter(|s| *s > s0 + NEAR_CUT && *s < s1 - NEAR_CUT).collect()
            }
        };
        let points =
            std::iter::once(s0).chain(inner).chain(std::iter::once(s1)).map(|s| curve.point(s)).collect();
        let tangents = [direction(curve, s0, Side::Start), direction(curve, s1, Side::End)];
        pieces.push(Piece { points, end_tangents: Some(tangents) });
    }
    pieces
}

/// A cubic from one point and direction to another.
fn transition(into: (Point2<f64>, Vector2<f64>), out: (Point2<f64>, Vector2<f64>)) -> Piece {
    let chord = out.0 - into.0;
    let length = chord.norm();
    let at = |t: f64| {
        let (t2, t3) = (t * t, t * t * t);
        into.0
            + length * (t3 - 2.0 * t2 + t) * into.1
            + (3.0 * t2 - 2.0 * t3) * chord
            + length * (t3 - t2) * out.1
    };
    let count = (length / STEP).ceil().max(4.0) as usize;
    let points = (0..=count).map(|i| at(i as f64 / count as f64)).collect();
    Piece { points, end_tangents: Some([into.1, out.1]) }
}
