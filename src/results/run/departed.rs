//! A load case on the simple model of a pair whose inputs depart.

use railspring_calibrate::law::{NormalLaw, TableLaw};
use railspring_calibrate::solid::Material;
use railspring_calibrate::uncertainty::Departure;
use railspring_element::held_end::{EndPlace, HeldEnd};
use railspring_element::law::{StripPlace, StripStiffness};
use railspring_element::modulus::StripModulus;
use railspring_element::pair_element::PairElement;
use railspring_element::relief::Influence;
use railspring_element::wheel::{ElasticWheel, RimMode};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::history::History;
use railspring_simulate::time::scenario::Scenario;

use crate::results::bodies::geometry::Geometry;
use crate::results::run::input::SimpleRunInput;
use crate::results::run::make::{SimpleModel, Springs};
use crate::results::springs::uncertainty_record::{
    InputUncertaintyRecord, UncertainInputRecord, between_loads,
};
use crate::study::{ContactElementKey, Rail, Wheel};

/// Loads at which a law with other inputs has the tangents of its own times their change.
const KNOTS: usize = 48;

/// A load case, and what its simple model is made from.
pub(crate) struct Departing<'a> {
    pub input: SimpleRunInput<'a>,
    pub geometry: &'a Geometry,
    /// The track that the pair stands in.
    pub track: TrackGeometry,
    pub springs: &'a Springs,
    /// How the springs of the published element change; without any they stay.
    pub changes: Option<SpringChanges>,
}

impl Departing<'_> {
    /// The run with a `departure`, of inputs that depart `by` so many standard uncertainties. Surfaces, places and friction depart themselves. The moduli scale
    /// the beam and what of an element is elastic; the springs of the published element depart to first order.
    ///
    /// # Errors
    /// Surfaces too far off, a wheel that misses the rail, and iterations that do not converge.
    pub fn run(&self, departure: &Departure, by: &[f64], monitor: &dyn Monitor) -> Result<History> {
        let pair = departure.pair(&self.geometry.pair, &self.track)?;
        let SimpleRunInput { rail, wheel, case, .. } = self.input;
        let stiffer = |of: Material, by: f64| Material { young: of.young * (1.0 + by), ..of };
        let rail = Rail { material: stiffer(rail.material, departure.rail_young), ..rail.clone() };
        let wheel = Wheel { material: stiffer(wheel.material, departure.wheel_young), ..wheel.clone() };
        let input = SimpleRunInput { rail: &rail, wheel: &wheel, ..self.input };
        let beam = pair.beam(&rail.material, rail.length, input.simulation.rail_elements)?;
        let springs = match (&self.springs.element, &self.changes) {
            (Some((key, element)), _) => {
                let element =
                    stiffened(element, departure, [&self.input.rail.material, &self.input.wheel.material]);
                Springs { element: Some((*key, element)), ..self.springs.clone() }
            }
            (None, Some(changes)) => changes.apply(self.springs, by)?,
            (None, None) => self.springs.clone(),
        };
        let model = SimpleModel::new(&input, &pair, &beam, &springs)?;
        let steps = input.simulation.steps(model.element());
        let scenario = Scenario {
            friction: (case.friction + departure.friction).max(0.0),
            // the steps that show the error of those of the published element; each of its steps costs four times one of the others
            inner_steps: match model.element() {
                ContactElementKey::Published => steps.doubled(),
                ContactElementKey::Condensed | ContactElementKey::Lumped => steps,
            },
            ..case.clone()
        };
        model.run(&scenario, monitor)
    }
}

/// An element of bodies of other `materials`, of rail and wheel: wheel and head have their own, the strips that of both together, with Poisson's ratio.
fn stiffened(element: &PairElement, departure: &Departure, materials: [&Material; 2]) -> PairElement {
    let [rail, wheel] = [1.0 + departure.rail_young, 1.0 + departure.wheel_young];
    let other = |of: &Material, young: f64| Material {
        young: of.young * young,
        poisson: of.poisson + departure.poisson,
        ..*of
    };
    let [of_rail, of_wheel] = materials;
    let contact =
        other(of_rail, rail).contact_modulus(&other(of_wheel, wheel)) / of_rail.contact_modulus(of_wheel);
    let mode = |mode: &RimMode| RimMode { square: mode.square * wheel, ..*mode };
    let place = |place: &EndPlace| EndPlace {
        flexibility: place.flexibility / rail,
        twist: place.twist / rail,
        ..*place
    };
    let strip = |place: &StripPlace| StripPlace {
        modulus: StripModulus {
            normal: place.modulus.normal * contact,
            tangential: place.modulus.tangential * contact,
            ..place.modulus
        },
        ..*place
    };
    let strips = &element.strips;
    PairElement {
        wheel: ElasticWheel {
            modes: element.wheel.modes.iter().map(mode).collect(),
            rest: element.wheel.rest / wheel,
            ..element.wheel.clone()
        },
        head: element.head / rail,
        held_end: element
            .held_end
            .as_ref()
            .map(|end| HeldEnd { places: end.places.iter().map(place).collect(), ..end.clone() }),
        strips: StripStiffness::new(
            strips.places().iter().map(strip).collect(),
            Influence { flexibility: strips.influence.flexibility / contact },
            strips.misfit,
        ),
        misfit: element.misfit,
    }
}

/// How law and horizontal stiffness change with each input, to first order: logarithms over one standard uncertainty.
pub(crate) struct SpringChanges {
    /// Loads, N, ascending.
    loads: Vec<f64>,
    /// Of the tangent, `[load][input]`.
    tangent: Vec<Vec<f64>>,
    /// Of the horizontal stiffness, by input; none of one that the study gives.
    horizontal: Option<Vec<f64>>,
}

impl SpringChanges {
    /// Those of a calibration for the same `inputs`; none where it does not have them. `with_horizontal` says whether the horizontal stiffness is its own, too.
    pub fn of(
        record: &InputUncertaintyRecord,
        inputs: &[UncertainInputRecord],
        with_horizontal: bool,
    ) -> Option<Self> {
        let places = inputs.iter().map(|input| record.inputs.iter().position(|of| of.name == input.name));
        let places: Vec<usize> = places.collect::<Option<_>>()?;
        let of_inputs = |changes: &[f64]| places.iter().map(|&at| changes[at]).collect();
        let horizontal = record.horizontal.as_ref().filter(|_| with_horizontal);
        (record.points.len() > 1).then(|| Self {
            loads: record.points.iter().map(|point| point.force_kn * KILONEWTON).collect(),
            tangent: record.points.iter().map(|point| of_inputs(&point.tangent.changes)).collect(),
            horizontal: horizontal.map(|of| of_inputs(&of.changes)),
        })
    }

    /// Springs with inputs that depart `by` so many standard uncertainties: the law goes through its own tangents times their change.
    fn apply(&self, springs: &Springs, by: &[f64]) -> Result<Springs> {
        let change = |of: &[f64]| -> f64 { of.iter().zip(by).map(|(change, by)| change * by).sum() };
        let at_loads: Vec<f64> = self.tangent.iter().map(|of| change(of)).collect();
        let tangent = |force: f64| {
            let (below, part) = between_loads(&self.loads, force);
            let at_load = at_loads[below] + part * (at_loads[below + 1] - at_loads[below]);
            springs.normal.tangent(force) * at_load.exp()
        };
        let (first, last) = (self.loads[0], self.loads[self.loads.len() - 1]);
        let (forces, below) = match &springs.normal {
            NormalLaw::Table(table) => {
                (table.knots().map(|(force, _)| force).collect(), Some(table.exponent_below()))
            }
            _ => {
                let at = |n: usize| first * (last / first).powf(n as f64 / (KNOTS - 1) as f64);
                ((0..KNOTS).map(at).collect::<Vec<f64>>(), None)
            }
        };
        let tangents: Vec<f64> = forces.iter().map(|force| tangent(*force)).collect();
        Ok(Springs {
            normal: NormalLaw::Table(TableLaw::with_exponent_below(&forces, &tangents, below)?),
            horizontal: springs.horizontal * self.horizontal.as_deref().map_or(0.0, change).exp(),
            ..springs.clone()
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};
    use railspring_calibrate::law::StiffnessLaw;

    use super::*;
    use crate::results::samples;
    use crate::results::springs::record::BeamFactors;

    /// Source: linear elasticity. Goal: with both moduli larger by 1 % all flexibilities of an element are smaller by that and its strips stiffer, masses and places stay; another
    /// Poisson's ratio changes the strips alone, by (1 - ν²). Accuracy: ROUNDOFF.
    #[test]
    fn elements_of_stiffer_bodies_are_stiffer() {
        const ROUNDOFF: f64 = 1e-14;
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < ROUNDOFF;
        let modulus = StripModulus { normal: 1e11, hardening: 0.2, tangential: 8e10, relief: 0.9 };
        let element = PairElement {
            wheel: ElasticWheel {
                mass: Matrix3::identity() * 300.0,
                hub: [0.0, -0.43],
                modes: vec![RimMode {
                    square: 1e6,
                    rim: Vector3::repeat(0.02),
                    coupling: Vector3::repeat(0.5),
                }],
                rest: Matrix3::identity() * 1e-9,
            },
            head: Matrix3::identity() * 2e-9,
            held_end: Some(HeldEnd {
                inset: 0.1,
                places: vec![EndPlace {
                    distance: 0.2,
                    flexibility: Matrix3::identity() * 3e-9,
                    twist: Vector3::repeat(1e-9),
                }],
            }),
            strips: StripStiffness::new(
                [0.0, 0.01].map(|rail_s| StripPlace { rail_s, modulus }).to_vec(),
                Influence { flexibility: 2.8e-12 },
                0.1,
            ),
            misfit: [0.0; 2],
        };
        let steel = [&Material::STEEL; 2];
        let by = Departure { rail_young: 0.01, wheel_young: 0.01, ..Departure::default() };
        let other = stiffened(&element, &by, steel);
        for (of, own) in [
            (other.wheel.rim_flexibility()[(0, 0)], element.wheel.rim_flexibility()[(0, 0)]),
            (other.head[(1, 1)], element.head[(1, 1)]),
            (other.head_on_rail()[(1, 1)], element.head_on_rail()[(1, 1)]),
            (other.strips.influence.flexibility, element.strips.influence.flexibility),
        ] {
            assert!(near(of * 1.01, own), "{of} {own}");
        }
        let [strip, own] = [&other, &element].map(|of| of.strips.places()[1].modulus);
        assert!(near(strip.normal, 1.01 * own.normal) && near(strip.tangential, 1.01 * own.tangential));
        assert_eq!((strip.hardening, strip.relief), (own.hardening, own.relief));
        assert_eq!((other.wheel.mass, other.wheel.hub), (element.wheel.mass, element.wheel.hub));
        let softer = stiffened(&element, &Departure { poisson: -0.02, ..Departure::default() }, steel);
        let [own, other] = [Material::STEEL.poisson, Material::STEEL.poisson - 0.02].map(|nu| 1.0 - nu * nu);
        assert!(near(softer.strips.places()[0].modulus.normal / modulus.normal, own / other));
        assert_eq!((softer.wheel, softer.head), (element.wheel, element.head));
    }

    /// Source: the constants of the samples, relative changes over one standard uncertainty. Goal: springs without departures have the tangents of their law from the first to the
    /// last load, N/m; with departures those of a load with changes have them times the exponential of the sum, and so has the horizontal stiffness, unless the study
    /// gives it. Accuracy: INTERPOLATION of a power by a cubic over 48 loads.
    #[test]
    fn springs_depart_to_first_order() {
        const INTERPOLATION: f64 = 1e-6;
        let record = samples::stiffness().input_uncertainty.unwrap();
        let law = StiffnessLaw::new(3e7, 2.94e8, 0.241104).unwrap();
        let springs = Springs {
            normal: law.into(),
            horizontal: 4e8,
            wheel_mass: 300.0,
            beam: BeamFactors::default().into(),
            element: None,
        };
        let changes = |with_horizontal| SpringChanges::of(&record, &record.inputs, with_horizontal).unwrap();
        let same = changes(true).apply(&springs, &[0.0; 2]).unwrap();
        assert_eq!(same.horizontal, springs.horizontal);
        for force in [1e3, 7e3, 33e3, 149e3] {
            assert!((same.normal.tangent(force) / law.tangent(force) - 1.0).abs() < INTERPOLATION, "{force}");
        }
        let by = [1.5, -0.5];
        let other = changes(true).apply(&springs, &by).unwrap();
        let expected = |of: &[f64]| (by[0] * of[0] + by[1] * of[1]).exp();
        for point in &record.points {
            let force = point.force_kn * KILONEWTON;
            let found = other.normal.tangent(force) / law.tangent(force);
            assert!((found / expected(&point.tangent.changes) - 1.0).abs() < 1e-3, "{force}: {found}");
        }
        let of_horizontal = expected(&record.horizontal.as_ref().unwrap().changes);
        assert!((other.horizontal / springs.horizontal / of_horizontal - 1.0).abs() < INTERPOLATION);
        assert_eq!(changes(false).apply(&springs, &by).unwrap().horizontal, springs.horizontal);
        // of inputs that the calibration does not have nothing is known
        let mut others = record.inputs.clone();
        others[0].name = "another input".into();
        assert!(SpringChanges::of(&record, &others, true).is_none());
    }
}
