//! The contact elements whose hub gives way as that of the solids.

use nalgebra::Matrix2;

use crate::element::condensed::parts::{ElementBodies, LumpedElement, PlaceApproaches, StickingHub};
use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::Material;
use railspring_element::pair_element::PairElement;
use railspring_profiles::error::Result;

use super::lacking::{HeadParts, Hub, OF_BUSHING, WHOLE, missing_in_head};
use super::model::CondensedModel;

/// How often the laws take up what the hub is off. With 60E1 and S1002, where one contact carries, it comes from 4.7 % of the solids' to 2.0 % with the change of the head and both times.
const ROUNDS: usize = 2;

/// The element of `bodies` of the `materials` of rail and wheel with laws by contact angle, and with what its hub is off under them, pressed with a coefficient of `friction`, taken up by the head and then by the
/// contact.
///
/// # Errors
/// Those of [`ElementBodies::element`].
pub fn fitted_element(
    bodies: &ElementBodies,
    rail: (&RailBeam, [&Material; 2]),
    laws: Vec<PlaceApproaches>,
    friction: f64,
) -> Result<PairElement> {
    fitted(bodies, rail, (laws, WHOLE), friction, ElementBodies::element, PairElement::clone)
}

/// The lumped element of the same.
///
/// # Errors
/// Those of [`ElementBodies::lumped`].
pub fn fitted_lumped(
    bodies: &ElementBodies,
    rail: (&RailBeam, [&Material; 2]),
    laws: Vec<PlaceApproaches>,
    friction: f64,
) -> Result<LumpedElement> {
    fitted(bodies, rail, (laws, OF_BUSHING), friction, ElementBodies::lumped, |element| element.into())
}

/// The element that `make` has of bodies and laws and that runs as `parts` say, with what its hub is off taken up.
fn fitted<'a, E>(
    bodies: &ElementBodies<'a>,
    (beam, materials): (&RailBeam, [&Material; 2]),
    (mut laws, head): (Vec<PlaceApproaches>, HeadParts),
    friction: f64,
    make: impl Fn(&ElementBodies<'a>, &[PlaceApproaches]) -> Result<E>,
    parts: impl Fn(&E) -> PairElement,
) -> Result<E> {
    let pressed = |element: &E, pair: &Pair, law: &PlaceApproaches| {
        let model = CondensedModel::of_pair(pair, beam.clone(), materials, parts(element));
        let hub = |at: &StickingHub| {
            model.pressed(law.along, at.load.force, friction).ok().map(|hub| hub.flexibility)
        };
        law.sticking.iter().map(hub).collect::<Vec<Option<Matrix2<f64>>>>()
    };
    let mut bodies = bodies.clone();
    let pairs = laws.iter().map(|law| bodies.pair().with_wheel_at(law.tape_y));
    let pairs = pairs.collect::<Result<Vec<Pair>>>()?;
    let element = make(&bodies, &laws)?;
    let mut hubs = Vec::new();
    for (law, pair) in laws.iter().zip(&pairs) {
        let arm = pair.touch.point - pair.node_line();
        let found = law.sticking.iter().zip(pressed(&element, pair, law));
        let hub = |(solid, found)| Some(Hub { solid, found: found?, along: law.along, arm });
        hubs.extend(found.filter_map(hub));
    }
    let more = missing_in_head(&hubs, head);
    bodies.change_head(&more);
    let mut element = make(&bodies, &laws)?;
    for _ in 0..ROUNDS {
        for (law, pair) in laws.iter_mut().zip(&pairs) {
            let found = pressed(&element, pair, law);
            law.take_up(&found);
        }
        element = make(&bodies, &laws)?;
    }
    Ok(element)
}
