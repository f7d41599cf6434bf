//! A pair with other inputs, pressed on the bodies of its nominal one.

use super::departure::Departure;
use crate::calibration::{
    LoadPoint, Pressed, Reference, calibrate_horizontal, load_points, press_loads_apart,
};
use crate::contact::{BeyondHalfSpace, HalfSpace, Side};
use crate::pair::{CondensedPair, ContactBody, ContactConditions, Pair};
use crate::solid::Material;
use faer::{Mat, Scale};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use std::sync::Arc;

/// How the pair is asked.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The track it stands in.
    pub track: TrackGeometry,
    /// How wheel and rail meet.
    pub contact: ContactConditions,
    /// What the displacement is measured against.
    pub reference: Reference,
    /// The loads, N, ascending.
    pub loads: &'a [f64],
    /// Preload of the horizontal stiffness, N.
    pub preload: f64,
}

/// A pair whose inputs are not known exactly.
pub struct UncertainPair<'a> {
    pair: &'a Pair,
    bodies: &'a CondensedPair,
    asked: Asked<'a>,
    /// The pair as it is taken to be under the loads, without friction: there the others start.
    nominal: Vec<Pressed>,
}

/// What a pair answers. All are positive.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    /// Displacement under each load, m.
    pub displacement: Vec<f64>,
    /// Tangent stiffness under each load, N/m.
    pub tangent: Vec<f64>,
    /// Area of the patch under each load, m²; without those that are asked to be quick.
    pub area: Vec<f64>,
    /// Largest pressure under each load, Pa; likewise.
    pub pressure: Vec<f64>,
    /// Horizontal stiffness under the preload, N/m; likewise.
    pub horizontal: Option<f64>,
}

impl<'a> UncertainPair<'a> {
    /// A `pair` as it is taken to be, on its bodies, and how it is `asked`.
    ///
    /// # Errors
    /// Bodies that are not of the pair, and loads that they do not carry.
    pub fn new(pair: &'a Pair, bodies: &'a CondensedPair, asked: Asked<'a>) -> Result<Self> {
        let smooth = ContactConditions { friction: 0.0, ..asked.contact };
        let placed = bodies.wheel_on_rail(pair, asked.reference, smooth)?;
        let nominal = press_loads_apart(&placed, asked.loads, "input uncertainty", &Silent)?;
        Ok(Self { pair, bodies, asked, nominal })
    }

    /// What the pair answers with inputs that depart. Without a departure of the friction the wheel is pressed without friction, which
    /// changes a displacement by less than its uncertainty changes it; the horizontal stiffness has the friction of the contact.
    /// `whole` asks for patches and horizontal stiffness as well.
    ///
    /// # Errors
    /// Surfaces too far off, a wheel that misses the rail, and numerics without an answer.
    pub fn answers(&self, departure: &Departure, whole: bool) -> Result<Answers> {
        let Asked { track, contact, reference, loads, preload } = self.asked;
        let pair = departure.pair(self.pair, &track)?;
        let of = |compliance: &Mat<f64>, young: f64| -> Option<Mat<f64>> {
            (young != 0.0).then(|| compliance * Scale(1.0 / (1.0 + young)))
        };
        let material = |of: Material, young: f64| Material {
            young: of.young * (1.0 + young),
            poisson: of.poisson + departure.poisson,
            ..of
        };
        let [on_rail, on_wheel] = self.bodies.of_pair(&pair, reference)?;
        let stiffer_rail = of(on_rail.compliance, departure.rail_young);
        let stiffer_wheel = of(on_wheel.compliance, departure.wheel_young);
        let of_rail = material(on_rail.material, departure.rail_young);
        let of_wheel = material(on_wheel.material, departure.wheel_young);
        let beyond = |body: &ContactBody, material: Material, side| {
            let other =
                |beyond: &Arc<BeyondHalfSpace>| Arc::new(beyond.with(HalfSpace::new(&material, side)));
            if material == body.material { body.beyond.cloned() } else { body.beyond.map(other) }
        };
        let beyond_rail = beyond(&on_rail, of_rail, Side::Base);
        let beyond_wheel = beyond(&on_wheel, of_wheel, Side::Opposing);
        let rail = ContactBody {
            compliance: stiffer_rail.as_ref().unwrap_or(on_rail.compliance),
            material: of_rail,
            beyond: beyond_rail.as_ref(),
            ..on_rail
        };
        let wheel = ContactBody {
            compliance: stiffer_wheel.as_ref().unwrap_or(on_wheel.compliance),
            material: of_wheel,
            beyond: beyond_wheel.as_ref(),
            ..on_wheel
        };
        let rubbing = ContactConditions { friction: contact.friction + departure.friction, ..contact };
        let smooth = ContactConditions { friction: 0.0, ..contact };
        let (placed, states) = if departure.friction == 0.0 {
            let placed = pair.wheel_on_rail(rail, wheel, smooth);
            // without friction there is no history, and the far field of the largest load serves the others
            let mut states: Vec<Pressed> = Vec::new();
            for (&load, near) in loads.iter().zip(&self.nominal).rev() {
                states.push(placed.press_beside(load, near, states.first())?);
            }
            states.reverse();
            (placed, states)
        } else {
            let placed = pair.wheel_on_rail(rail, wheel, rubbing);
            let states = press_loads_apart(&placed, loads, "input uncertainty", &Silent)?;
            (placed, states)
        };
        let points = load_points(&placed, &states, reference)?;
        let take = |of: fn(&LoadPoint) -> f64| points.iter().map(of).collect();
        let mut answers = Answers {
            displacement: take(|p| p.displacement),
            tangent: take(|p| p.solid_tangent),
            area: Vec::new(),
            pressure: Vec::new(),
            horizontal: None,
        };
        if whole {
            for patch in states.iter().map(|state| placed.patch_without_stresses(state)) {
                let values = patch?.values;
                answers.area.push(values.area);
                answers.pressure.push(values.max_pressure);
            }
            let placed = pair.wheel_on_rail(rail, wheel, rubbing);
            let found = calibrate_horizontal(&placed, &[preload], &[], &Silent)?;
            answers.horizontal = Some(found.stiffness);
        }
        Ok(answers)
    }
}
