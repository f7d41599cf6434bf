//! The parameters of a contact (EN 15302) as lines, table and record.

use std::fmt::Write;

use railspring_profiles::rigid_contact::{ContactFunctions, Parameters, ProfileUncertainty, Spread};
use railspring_profiles::units::MILLIMETRE;
use serde::Serialize;

/// Disturbed wheelsets from which uncertainties are: their standard deviation is known to 7 %.
pub(super) const SAMPLES: usize = 100;
/// Coverage factor of the uncertainties on the screen.
const COVERAGE: f64 = 2.0;

/// Amplitudes of the parameters, mm: every half millimetre up to `largest_mm`.
pub(super) fn amplitudes(largest_mm: f64) -> Vec<f64> {
    (1..).map(|i| 0.5 * f64::from(i)).take_while(|a| *a <= largest_mm).collect()
}

/// A number that was given, without what the conversion of its unit has left.
fn plain(value: f64) -> f64 {
    (1e9 * value).round() / 1e9
}

/// The parameters that were found.
pub(super) struct Found {
    /// Amplitudes, mm.
    pub amplitudes_mm: Vec<f64>,
    /// Their values.
    pub parameters: Parameters,
    /// Shift that brings the left and the right flange to the rail, m.
    pub clearance: Option<[f64; 2]>,
    /// Radius of the curve that was asked for, m.
    pub curve: Option<f64>,
    /// What the uncertainty of the profiles makes of the values, in the order of `Parameters::values`, and at last of the rolling radii
    /// coefficient in that curve.
    pub uncertain: Option<(ProfileUncertainty, Vec<Option<Spread>>)>,
}

/// A value with its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Value {
    value: f64,
    standard_uncertainty: Option<f64>,
}

impl Value {
    /// As text in a unit of `scale`, the uncertainty with k = 2.
    fn text(self, scale: f64, digits: usize) -> String {
        let value = format!("{:.digits$}", self.value / scale);
        match self.standard_uncertainty {
            Some(u) => format!("{value} ± {:.digits$}", COVERAGE * u / scale),
            None => value,
        }
    }

    /// In a unit of `scale`.
    fn per(self, scale: f64) -> Self {
        Self { value: self.value / scale, standard_uncertainty: self.standard_uncertainty.map(|u| u / scale) }
    }
}

/// The parameters at an amplitude.
#[derive(Serialize)]
struct AtAmplitude {
    amplitude_mm: f64,
    equivalent_conicity: Option<Value>,
    contact_angle_parameter: Option<Value>,
    roll_parameter: Option<Value>,
}

/// The functions at a shift.
#[derive(Serialize)]
struct AtShift {
    shift_mm: f64,
    rolling_radius_difference_mm: f64,
    contact_tangent_difference: f64,
    roll_mrad: f64,
}

/// The uncertainty of the profiles that was given.
#[derive(Serialize)]
struct Given {
    profile_um: f64,
    correlation_mm: f64,
    roll_deg: f64,
    samples: usize,
}

/// What PREFIX.json holds.
#[derive(Serialize)]
pub(super) struct Record {
    amplitudes: Vec<AtAmplitude>,
    nonlinearity_per_mm: Option<Value>,
    flange_clearance_left_mm: Option<f64>,
    flange_clearance_right_mm: Option<f64>,
    curve_radius_without_slip_m: Option<Value>,
    curve_m: Option<f64>,
    rolling_radii_coefficient: Option<Value>,
    uncertainty_of_profiles: Option<Given>,
    shifts: Vec<AtShift>,
}

impl Found {
    /// The spread of the value with this index.
    fn spread(&self, index: usize) -> Option<Spread> {
        self.uncertain.as_ref().and_then(|(_, spreads)| spreads.get(index).copied().flatten())
    }

    /// A value with its uncertainty.
    fn with(value: Option<f64>, spread: Option<Spread>) -> Option<Value> {
        value.map(|value| Value { value, standard_uncertainty: spread.map(|spread| spread.standard) })
    }

    fn spreads(&self) -> Parameters<Spread> {
        let spreads = self.uncertain.as_ref().map_or(&[][..], |(_, spreads)| spreads);
        Parameters::from_values(self.amplitudes_mm.len(), spreads)
    }

    fn at_amplitudes(&self) -> Vec<AtAmplitude> {
        let (values, spreads) = (&self.parameters, self.spreads());
        let rows = self.amplitudes_mm.iter().enumerate().map(|(i, amplitude)| AtAmplitude {
            amplitude_mm: *amplitude,
            equivalent_conicity: Self::with(values.conicity[i], spreads.conicity[i]),
            contact_angle_parameter: Self::with(values.contact_angle[i], spreads.contact_angle[i]),
            roll_parameter: Self::with(values.roll[i], spreads.roll[i]),
        });
        rows.filter(|row| row.equivalent_conicity.is_some()).collect()
    }

    fn nonlinearity(&self) -> Option<Value> {
        Self::with(self.parameters.nonlinearity, self.spreads().nonlinearity)
    }

    fn curve_radius(&self) -> Option<Value> {
        Self::with(self.parameters.curve_radius, self.spreads().curve_radius)
    }

    /// Rolling radii coefficient in the curve.
    pub fn coefficient(curve: Option<f64>, parameters: &Parameters) -> Option<f64> {
        Some(curve? / parameters.curve_radius?)
    }

    fn coefficient_value(&self) -> Option<Value> {
        let last = self.parameters.values().len();
        Self::with(Self::coefficient(self.curve, &self.parameters), self.spread(last))
    }

    /// Conicity less and plus its uncertainty (k = 2) over the amplitude, mm.
    pub fn band(&self) -> Vec<(f64, [f64; 2])> {
        let ends = |row: AtAmplitude| {
            let conicity = row.equivalent_conicity?;
            let half = COVERAGE * conicity.standard_uncertainty?;
            Some((row.amplitude_mm, [conicity.value - half, conicity.value + half]))
        };
        self.at_amplitudes().into_iter().filter_map(ends).collect()
    }

    /// Equivalent conicity at an amplitude of `amplitude_mm`, if it is one of the table, as text.
    pub fn conicity_text(&self, amplitude_mm: f64) -> Option<String> {
        let row = self.at_amplitudes().into_iter().find(|row| row.amplitude_mm == amplitude_mm)?;
        row.equivalent_conicity.map(|conicity| conicity.text(1.0, 4))
    }

    /// Lines of the table over the amplitude.
    pub fn table(&self) -> Vec<String> {
        let head = ["amplitude mm", "equivalent conicity", "contact-angle parameter", "roll parameter"];
        let line = |cells: [String; 4]| {
            let [a, b, c, d] = cells;
            format!("{a:>12}   {b:>19}   {c:>23}   {d:>17}")
        };
        let text = |value: Option<Value>| value.map_or("-".into(), |value| value.text(1.0, 4));
        let rows = self.at_amplitudes().into_iter().map(|row| {
            line([
                format!("{:.1}", row.amplitude_mm),
                text(row.equivalent_conicity),
                text(row.contact_angle_parameter),
                text(row.roll_parameter),
            ])
        });
        [line(head.map(String::from))].into_iter().chain(rows).collect()
    }

    /// Lines of what has no amplitude.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(slope) = self.nonlinearity() {
            // 1/m
            let slope = slope.text(1.0 / MILLIMETRE, 4);
            lines.push(format!("nonlinearity parameter, from 2 to 4 mm: {slope} 1/mm"));
        }
        match self.clearance.map(|clearance| clearance.map(|c| c / MILLIMETRE)) {
            None => {
                lines.push("no flange clearance: a profile does not reach its flange or gauge face".into())
            }
            Some([left, right]) => {
                lines.push(format!("flange clearance: {left:.2} mm to the left, {right:.2} mm to the right"));
                lines.push(match self.curve_radius() {
                    Some(radius) => {
                        format!("rolls without slip through curves down to {} m", radius.text(1.0, 0))
                    }
                    None => "rolls through no curve without slip at the flange clearance, or the shifts end before it"
                        .into(),
                });
            }
        }
        if let (Some(curve), Some(coefficient)) = (self.curve, self.coefficient_value()) {
            let coefficient = coefficient.text(1.0, 3);
            lines.push(format!("rolling radii coefficient in a curve of {curve} m: {coefficient}"));
        }
        if let Some((given, _)) = &self.uncertain {
            lines.push(format!(
                "± has k = 2, from {SAMPLES} samples: form {} µm over {} mm, roll {} degrees; where it is missing, a sample has no value",
                plain(given.form / (1e-3 * MILLIMETRE)),
                plain(given.correlation / MILLIMETRE),
                plain(given.roll.to_degrees())
            ));
        }
        lines
    }

    /// The table over the amplitude as CSV, with standard uncertainties.
    pub fn csv(&self) -> String {
        let mut csv = String::from(
            "amplitude_mm,equivalent_conicity,equivalent_conicity_u,contact_angle_parameter,contact_angle_parameter_u,roll_parameter,roll_parameter_u\n",
        );
        let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6}"));
        let both = |value: Option<Value>| {
            let u = value.and_then(|value| value.standard_uncertainty);
            format!("{},{}", number(value.map(|value| value.value)), number(u))
        };
        for row in self.at_amplitudes() {
            // Writing to a string cannot fail.
            let _ = writeln!(
                csv,
                "{:.1},{},{},{}",
                row.amplitude_mm,
                both(row.equivalent_conicity),
                both(row.contact_angle_parameter),
                both(row.roll_parameter)
            );
        }
        csv
    }

    /// All of it as a record, with the functions over the shift.
    pub fn record(&self, functions: &ContactFunctions) -> Record {
        let clearance = |side: usize| self.clearance.map(|clearance| clearance[side] / MILLIMETRE);
        let shifts = functions.points().iter().zip(functions.running().points()).map(|(p, q)| AtShift {
            shift_mm: p.shift / MILLIMETRE,
            rolling_radius_difference_mm: q.difference / MILLIMETRE,
            contact_tangent_difference: p.tangent_difference,
            roll_mrad: 1e3 * p.roll,
        });
        Record {
            amplitudes: self.at_amplitudes(),
            nonlinearity_per_mm: self.nonlinearity().map(|value| value.per(1.0 / MILLIMETRE)),
            flange_clearance_left_mm: clearance(0),
            flange_clearance_right_mm: clearance(1),
            curve_radius_without_slip_m: self.curve_radius(),
            curve_m: self.curve,
            rolling_radii_coefficient: self.coefficient_value(),
            uncertainty_of_profiles: self.uncertain.as_ref().map(|(given, _)| Given {
                profile_um: plain(given.form / (1e-3 * MILLIMETRE)),
                correlation_mm: plain(given.correlation / MILLIMETRE),
                roll_deg: plain(given.roll.to_degrees()),
                samples: SAMPLES,
            }),
            shifts: shifts.collect(),
        }
    }
}
