//! The contact element whose hub gives way as that of the solids.

use nalgebra::Matrix2;

use crate::element::condensed::parts::{ElementBodies, PairElement, PlaceApproaches, StickingHub};
use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::Material;
use railspring_profiles::error::Result;

use super::lacking::{Hub, missing_in_head};
use super::model::CondensedModel;

/// How often the laws take up what the hub is off. With 60E1 and S1002, where one contact carries, it comes from 4.7 % of the solids' to 2.0 % with the change of the head and both times.
const ROUNDS: usize = 2;

/// The element of `bodies` of the `materials` of rail and wheel with laws by contact angle, and with what its hub is off under them, pressed with a coefficient of `friction`, taken up by the head and then by the
/// contact.
///
/// # Errors
/// Those of [`ElementBodies::element`].
pub fn fitted_element(
    mut bodies: ElementBodies,
    (beam, materials): (&RailBeam, [&Material; 2]),
    mut laws: Vec<PlaceApproaches>,
    friction: f64,
) -> Result<PairElement> {
    let pressed = |element: &PairElement, pair: &Pair, law: &PlaceApproaches| {
        let model = CondensedModel::of_pair(pair, beam.clone(), materials, element.clone());
        let hub = |at: &StickingHub| {
            model.pressed(law.along, at.load.force, friction).ok().map(|hub| hub.flexibility)
        };
        law.sticking.iter().map(hub).collect::<Vec<Option<Matrix2<f64>>>>()
    };
    let pairs = laws.iter().map(|law| bodies.pair().with_wheel_at(law.tape_y));
    let pairs = pairs.collect::<Result<Vec<Pair>>>()?;
    let element = bodies.element(&laws)?;
    let mut hubs = Vec::new();
    for (law, pair) in laws.iter().zip(&pairs) {
        let arm = pair.touch.point - pair.node_line();
        let found = law.sticking.iter().zip(pressed(&element, pair, law));
        let hub = |(solid, found)| Some(Hub { solid, found: found?, along: law.along, arm });
        hubs.extend(found.filter_map(hub));
    }
    let more = missing_in_head(&hubs);
    bodies.change_head(&more);
    let mut element = bodies.element(&laws)?;
    for _ in 0..ROUNDS {
        for (law, pair) in laws.iter_mut().zip(&pairs) {
            let found = pressed(&element, pair, law);
            law.take_up(&found);
        }
        element = bodies.element(&laws)?;
    }
    Ok(element)
}
