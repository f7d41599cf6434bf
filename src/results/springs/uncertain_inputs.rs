//! The inputs of a study that are not known exactly: how each departs, and what it departs in.

use std::f64::consts::PI;

use railspring_calibrate::uncertainty::{Departure, Distribution, Input};
use railspring_profiles::units::MILLIMETRE;

use crate::results::springs::uncertainty_record::UncertainInputRecord;
use crate::study::Statics;

/// Largest standard uncertainty of the friction as a part of it, so that it stays positive.
const LARGEST_FRICTION: f64 = 0.5;

/// An input of the study.
struct Source {
    name: &'static str,
    key: &'static str,
    unit: &'static str,
    /// The unit of its key in SI units.
    in_si: f64,
    /// Standard uncertainty in SI units.
    standard: f64,
    distribution: Distribution,
    /// Whether samples of the pressed pair depart in it.
    sampled: bool,
    /// Puts in a departure, in SI units.
    depart: fn(&mut Departure, f64),
}

/// The inputs of a study that are not known exactly, those with a standard uncertainty alone.
pub struct UncertainInputs {
    sources: Vec<Source>,
    /// Length of the waves of the profiles' form, m.
    wavelength: f64,
}

impl UncertainInputs {
    /// Those of a study.
    pub fn of(statics: Statics<'_>) -> Self {
        Self { sources: sources(statics), wavelength: statics.uncertainty.form_wavelength }
    }

    /// Why there are no samples of them, if so: the study asks for none.
    pub fn without_samples(statics: Statics<'_>) -> Option<&'static str> {
        if !statics.wants_error_band() {
            return Some("calibration.error_band is false");
        }
        if statics.uncertainty.samples == 0 {
            return Some("uncertainty.samples is 0");
        }
        Self::of(statics).sources.is_empty().then_some("all standard uncertainties are 0")
    }

    /// Each as it goes through the pressed pair.
    pub fn inputs(&self) -> Vec<Input> {
        self.sources
            .iter()
            .map(|source| Input { distribution: source.distribution, sampled: source.sampled })
            .collect()
    }

    /// How the pair departs with all of them, each by so many standard uncertainties.
    pub fn departure(&self, by: &[f64]) -> Departure {
        let mut departure = Departure { wavelength: self.wavelength, ..Departure::default() };
        for (source, by) in self.sources.iter().zip(by) {
            (source.depart)(&mut departure, by * source.standard);
        }
        departure
    }

    /// What files have of them.
    pub fn records(&self) -> Vec<UncertainInputRecord> {
        self.sources.iter().map(Source::record).collect()
    }
}

impl Source {
    fn record(&self) -> UncertainInputRecord {
        UncertainInputRecord {
            name: self.name.into(),
            key: Some(format!("uncertainty.{}", self.key)),
            standard: Some(self.standard / self.in_si),
            unit: self.unit.into(),
            distribution: match self.distribution {
                Distribution::Normal => "normal",
                Distribution::Rectangular => "rectangular",
            }
            .into(),
        }
    }
}

/// The inputs of a study that are not known exactly.
fn sources(statics: Statics<'_>) -> Vec<Source> {
    const MILLIMETRES: (&str, f64) = ("mm", MILLIMETRE);
    const MICROMETRES: (&str, f64) = ("\u{b5}m", 1e-3 * MILLIMETRE);
    const DEGREES: (&str, f64) = ("degrees", PI / 180.0);
    const PER_CENT: (&str, f64) = ("%", 1e-2);
    const NUMBER: (&str, f64) = ("", 1.0);
    let of = statics.uncertainty;
    let ([rail_roll, wheel_roll], [rail_form, wheel_form]) = (of.roll, of.form);
    let source = |name, key, (unit, in_si), standard, depart| Source {
        name,
        key,
        unit,
        in_si,
        standard,
        distribution: Distribution::Normal,
        sampled: true,
        depart,
    };
    let rectangular = |source: Source| Source { distribution: Distribution::Rectangular, ..source };
    let to_first_order = |source: Source| Source { sampled: false, ..source };
    let friction = of.friction.min(LARGEST_FRICTION * statics.contact.friction);
    let all = [
        source("place of the wheel across the track", "lateral_mm", MILLIMETRES, of.lateral, |d, by| {
            d.lateral += by
        }),
        // a wider gauge moves this rail to the field side by half of it
        source("track gauge", "gauge_mm", MILLIMETRES, of.gauge, |d, by| d.lateral -= 0.5 * by),
        source("distance of the flange backs", "flange_back_mm", MILLIMETRES, of.flange_back, |d, by| {
            d.lateral += 0.5 * by
        }),
        source("inclination of the rail", "inclination_deg", DEGREES, of.inclination, |d, by| {
            d.rail_roll += by
        }),
        source("turn of the rail profile", "rail_roll_deg", DEGREES, rail_roll, |d, by| d.rail_roll += by),
        source("turn of the wheel profile", "wheel_roll_deg", DEGREES, wheel_roll, |d, by| {
            d.wheel_roll += by
        }),
        source("form of the rail profile (cosine)", "rail_form_um", MICROMETRES, rail_form, |d, by| {
            d.rail_waves[0] += by
        }),
        source("form of the rail profile (sine)", "rail_form_um", MICROMETRES, rail_form, |d, by| {
            d.rail_waves[1] += by
        }),
        source("form of the wheel profile (cosine)", "wheel_form_um", MICROMETRES, wheel_form, |d, by| {
            d.wheel_waves[0] += by
        }),
        source("form of the wheel profile (sine)", "wheel_form_um", MICROMETRES, wheel_form, |d, by| {
            d.wheel_waves[1] += by
        }),
        source("diameter of the wheel", "tape_diameter_mm", MILLIMETRES, of.tape_diameter, |d, by| {
            d.radius += 0.5 * by
        }),
        to_first_order(rectangular(source("friction", "friction", NUMBER, friction, |d, by| {
            d.friction += by
        }))),
        to_first_order(rectangular(source(
            "Young's modulus of the rail",
            "young_percent",
            PER_CENT,
            of.young,
            |d, by| d.rail_young += by,
        ))),
        to_first_order(rectangular(source(
            "Young's modulus of the wheel",
            "young_percent",
            PER_CENT,
            of.young,
            |d, by| d.wheel_young += by,
        ))),
        rectangular(source("Poisson's ratio", "poisson", NUMBER, of.poisson, |d, by| d.poisson += by)),
    ];
    all.into_iter().filter(|source| source.standard > 0.0).collect()
}
