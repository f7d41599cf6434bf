//! The constants of a stiffness law between files and the library.

use railspring_calibrate::law::{REFERENCE_FORCE, StiffnessLaw};
use railspring_profiles::error::{Error, Result};
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Constants of a law `k(f) = a + b·(f/f0)^c` as files have them. The library's law has another reference force, so
/// that only `TryFrom` and `From` turn one into the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LawConstants {
    /// Constant part, kN/m.
    pub a_kn_per_m: f64,
    /// Factor of the power, kN/m.
    pub b_kn_per_m: f64,
    /// Exponent.
    pub c: f64,
    /// Reference force, kN.
    pub f0_kn: f64,
}

impl LawConstants {
    /// Tangent stiffness at a force, kN/m and kN.
    pub fn tangent(&self, force_kn: f64) -> f64 {
        self.a_kn_per_m + self.b_kn_per_m * (force_kn / self.f0_kn).powf(self.c)
    }
}

impl From<StiffnessLaw> for LawConstants {
    fn from(law: StiffnessLaw) -> Self {
        Self {
            a_kn_per_m: law.a / KILONEWTON_PER_METRE,
            b_kn_per_m: law.b / KILONEWTON_PER_METRE,
            c: law.c,
            f0_kn: REFERENCE_FORCE / KILONEWTON,
        }
    }
}

impl TryFrom<LawConstants> for StiffnessLaw {
    type Error = Error;

    /// # Errors
    /// [`railspring_profiles::error::InputError`] with key `law` for constants that are no law.
    fn try_from(constants: LawConstants) -> Result<Self> {
        let [a, b] = [constants.a_kn_per_m, constants.b_kn_per_m].map(|k| k * KILONEWTON_PER_METRE);
        // b·(f/f0)^c = b·(r/f0)^c·(f/r)^c with the reference force r of `StiffnessLaw`.
        let b = b * (REFERENCE_FORCE / (constants.f0_kn * KILONEWTON)).powf(constants.c);
        Self::new(a, b, constants.c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ROUNDOFF: a power and some products of numbers of order one.
    const ROUNDOFF: f64 = 1e-14;
    const LAWS: [(f64, f64, f64); 4] =
        [(3e7, 2.94e8, 0.241_104), (0.0, 4.5e8, 1.0 / 3.0), (7e8, 0.0, 0.0), (1e7, 1e9, 0.9)];

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() <= ROUNDOFF * b.abs()
    }

    /// Goal: a law of the library survives its way into a file and back, and the file's constants have its tangent, kN/m
    /// at 1, 12 and 85 kN. Accuracy: ROUNDOFF.
    #[test]
    fn from_the_library_to_a_file_and_back() {
        for (a, b, c) in LAWS {
            let law = StiffnessLaw::new(a, b, c).unwrap();
            let constants = LawConstants::from(law);
            assert_eq!(constants.f0_kn, 1.0);
            let back = StiffnessLaw::try_from(constants).unwrap();
            assert!(near(back.a, a) && near(back.b, b) && back.c == c, "{law:?} {back:?}");
            for force in [1.0, 12.0, 85.0] {
                assert!(near(1e3 * constants.tangent(force), law.tangent(1e3 * force)), "{law:?} {force} kN");
            }
        }
    }

    /// Goal: constants with any reference force have the same tangent in the file, in the library, and in the file that
    /// the library's law is written to; with f0 = 10 kN its factor is b/10^c. Accuracy: ROUNDOFF.
    #[test]
    fn from_a_file_to_the_library_and_back() {
        for (a, b, c) in LAWS {
            for f0_kn in [1.0, 10.0, 0.05, 85.0] {
                let file = LawConstants { a_kn_per_m: 1e-3 * a, b_kn_per_m: 1e-3 * b, c, f0_kn };
                let law = StiffnessLaw::try_from(file).unwrap();
                let back = LawConstants::from(law);
                assert!(near(back.b_kn_per_m, file.b_kn_per_m / f0_kn.powf(c)), "{file:?} {back:?}");
                for force in [1.0, 12.0, 85.0] {
                    let expected = file.tangent(force);
                    assert!(near(1e-3 * law.tangent(1e3 * force), expected), "{file:?} {force} kN");
                    assert!(near(back.tangent(force), expected), "{file:?} {force} kN");
                }
            }
        }
    }

    /// Goal: constants that are no law are refused on their way into the library.
    #[test]
    fn impossible_constants_are_refused() {
        let good = LawConstants { a_kn_per_m: 3e4, b_kn_per_m: 2.94e5, c: 0.24, f0_kn: 1.0 };
        for wrong in [
            LawConstants { a_kn_per_m: -1.0, ..good },
            LawConstants { b_kn_per_m: f64::NAN, ..good },
            LawConstants { c: 1.0, ..good },
            LawConstants { f0_kn: 0.0, ..good },
        ] {
            assert!(StiffnessLaw::try_from(wrong).is_err(), "{wrong:?}");
        }
    }
}
