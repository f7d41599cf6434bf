//! A law as a person writes it.

use railspring_calibrate::law::Form;
use railspring_profiles::error::{InputError, Result};
use serde::Deserialize;

use crate::results::springs::form::{NormalLawRecord, SeriesConstants, StepsConstants, TablePoints};
use crate::results::springs::law::LawConstants;
use crate::results::springs::record::{LawRecord, StiffnessRecord};

/// A law as a person writes it: the constants and units of `stiffness.json`, and what is known about them.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenLaw {
    #[serde(default)]
    pub form: Form,
    pub a_kn_per_m: Option<f64>,
    pub b_kn_per_m: Option<f64>,
    pub c: Option<f64>,
    pub f0_kn: Option<f64>,
    pub s_kn_per_m: Option<f64>,
    pub f1_kn: Option<f64>,
    pub p: Option<f64>,
    pub d: Option<f64>,
    pub e: Option<f64>,
    pub table_kn_and_kn_per_m: Option<Vec<[f64; 2]>>,
    pub exponent_below: Option<f64>,
    pub horizontal_kn_per_m: Option<f64>,
    pub wheel_mass_kg: Option<f64>,
    pub reference: Option<String>,
    pub range_kn: Option<[f64; 2]>,
}

/// Largest stiffness and force of a law, kN/m and kN: a thousand times a thousand times that of steel wheels.
pub(super) const LARGEST_STIFFNESS: f64 = 1e12;

/// The keys that a law of a form has; a linear spring may be left out.
fn keys(form: Form) -> &'static [&'static str] {
    match form {
        Form::Power => &["a_kn_per_m", "b_kn_per_m", "c", "f0_kn"],
        Form::Series => &["b_kn_per_m", "c", "f0_kn", "s_kn_per_m"],
        Form::Steps => &["b_kn_per_m", "c", "f0_kn", "f1_kn", "p", "d", "e"],
        Form::Table => &["table_kn_and_kn_per_m", "exponent_below"],
    }
}

impl WrittenLaw {
    /// That of a calibration in use, of the form of a power.
    pub fn of(calibration: &StiffnessRecord) -> Self {
        let LawRecord { constants, range_kn, .. } = &calibration.law;
        Self {
            a_kn_per_m: Some(constants.a_kn_per_m),
            b_kn_per_m: Some(constants.b_kn_per_m),
            c: Some(constants.c),
            f0_kn: Some(constants.f0_kn),
            range_kn: Some(*range_kn),
            horizontal_kn_per_m: calibration.horizontal_kn_per_m,
            reference: Some(calibration.reference.clone()),
            ..Self::default()
        }
    }

    /// The law; `name` is the file.
    ///
    /// # Errors
    /// [`InputError`] whose key is the file with the key in it: one that is missing, one that the form does not have, and constants that are no
    /// law: k has to be positive and must not fall, and its displacement has to be finite.
    pub fn law(&self, name: &str) -> Result<NormalLawRecord> {
        self.foreign(name)?;
        let given = |key: &str, value| -> Result<f64> { given(name, key, value) };
        let at_least_0 = |key: &str, value| -> Result<f64> {
            let value = given(key, value)?;
            match (0.0..=LARGEST_STIFFNESS).contains(&value) {
                true => Ok(value),
                false => Err(wrong(name, key, value, "a number from 0 to 1e12").into()),
            }
        };
        let positive = |key: &str, value| -> Result<f64> {
            let value = given(key, value)?;
            match value > 0.0 && value <= LARGEST_STIFFNESS {
                true => Ok(value),
                false => Err(wrong(name, key, value, "a number above 0 and up to 1e12").into()),
            }
        };
        let exponent = |key: &str, value| -> Result<f64> {
            let value = given(key, value)?;
            let good = (0.0..1.0).contains(&value);
            if good { Ok(value) } else { Err(wrong(name, key, value, "a number from 0 to below 1").into()) }
        };
        Ok(match self.form {
            Form::Power => {
                let a_kn_per_m = at_least_0("a_kn_per_m", self.a_kn_per_m)?;
                let b_kn_per_m = at_least_0("b_kn_per_m", self.b_kn_per_m)?;
                let c = exponent("c", self.c)?;
                if a_kn_per_m + b_kn_per_m == 0.0 {
                    let expected = "a number above 0, because a_kn_per_m is 0";
                    return Err(wrong(name, "b_kn_per_m", 0.0, expected).into());
                }
                let f0_kn = positive("f0_kn", self.f0_kn)?;
                NormalLawRecord::Power(LawConstants { a_kn_per_m, b_kn_per_m, c, f0_kn })
            }
            Form::Series => NormalLawRecord::Series(SeriesConstants {
                b_kn_per_m: positive("b_kn_per_m", self.b_kn_per_m)?,
                c: exponent("c", self.c)?,
                f0_kn: positive("f0_kn", self.f0_kn)?,
                s_kn_per_m: self.s_kn_per_m.map(|s| positive("s_kn_per_m", Some(s))).transpose()?,
            }),
            Form::Steps => NormalLawRecord::Steps(StepsConstants {
                b_kn_per_m: positive("b_kn_per_m", self.b_kn_per_m)?,
                c: exponent("c", self.c)?,
                f0_kn: positive("f0_kn", self.f0_kn)?,
                f1_kn: positive("f1_kn", self.f1_kn)?,
                p: positive("p", self.p)?,
                d: at_least_0("d", self.d)?,
                e: exponent("e", self.e)?,
            }),
            Form::Table => {
                let table_kn_and_kn_per_m = self.table_kn_and_kn_per_m.clone().ok_or_else(|| {
                    let expected = "pairs of force, kN, and tangent stiffness, kN/m";
                    InputError::new(
                        format!("{name}: table_kn_and_kn_per_m"),
                        "(missing)",
                        expected,
                        "add the key to the file",
                    )
                })?;
                let exponent_below =
                    self.exponent_below.map(|c| exponent("exponent_below", Some(c))).transpose()?;
                NormalLawRecord::Table(TablePoints { table_kn_and_kn_per_m, exponent_below })
            }
        })
    }

    /// Refuses a constant that the form does not have.
    fn foreign(&self, name: &str) -> Result<()> {
        let table = self.table_kn_and_kn_per_m.as_ref().map(|_| f64::NAN);
        let constants = [
            ("a_kn_per_m", self.a_kn_per_m),
            ("b_kn_per_m", self.b_kn_per_m),
            ("c", self.c),
            ("f0_kn", self.f0_kn),
            ("s_kn_per_m", self.s_kn_per_m),
            ("f1_kn", self.f1_kn),
            ("p", self.p),
            ("d", self.d),
            ("e", self.e),
            ("table_kn_and_kn_per_m", table),
            ("exponent_below", self.exponent_below),
        ];
        let keys = keys(self.form);
        let Some((key, _)) = constants.iter().find(|(key, value)| value.is_some() && !keys.contains(key))
        else {
            return Ok(());
        };
        Err(InputError::new(
            format!("{name}: {key}"),
            "(given)",
            format!("the keys of a law of the form {:?}: {}", self.form.name(), keys.join(", ")),
            "remove it, or give another `form`",
        )
        .into())
    }
}

fn wrong(name: &str, key: &str, value: f64, expected: &str) -> InputError {
    // not with three hundred digits
    let value = if value.abs() < 1e16 { value.to_string() } else { format!("{value:e}") };
    InputError::new(format!("{name}: {key}"), value, expected, "correct the file")
}

/// A number of the file.
///
/// # Errors
/// [`InputError`] for one that is missing.
pub(super) fn given(name: &str, key: &str, value: Option<f64>) -> Result<f64> {
    value.ok_or_else(|| {
        InputError::new(format!("{name}: {key}"), "(missing)", "a number", "add the key to the file").into()
    })
}
