//! Laws of all forms between files and the library, and how far each is off.

use railspring_calibrate::law::{
    Form, FormFit, LawError, NormalLaw, REFERENCE_FORCE, SeriesLaw, StepConstants, StepLaw, StiffnessLaw,
    TableLaw,
};
use railspring_profiles::error::{Error, Result};
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::law::LawConstants;
use crate::rounding::significant;

/// Largest relative errors for which it is said from which load on a law keeps them.
const LIMITS: [f64; 4] = [0.01, 0.02, 0.05, 0.07];

/// A normal law with its form: the tangent stiffness over the normal force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "form", rename_all = "kebab-case")]
pub enum NormalLawRecord {
    /// `k = a + b·(f/f0)^c`.
    Power(LawConstants),
    /// `1/k = 1/(b·(f/f0)^c) + 1/s`.
    Series(SeriesConstants),
    /// `k = b·(f/f0)^c · (1 + t)^((e - c)/p) · (1 + d·t/(1 + t))` with `t = (f/f1)^p`.
    Steps(StepsConstants),
    /// The tangents of the solid, a monotone cubic of ln k over ln f between them.
    Table(TablePoints),
}

/// Constants of a power in series with a linear spring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SeriesConstants {
    /// Factor of the power, kN/m.
    pub b_kn_per_m: f64,
    /// Exponent.
    pub c: f64,
    /// Reference force, kN.
    pub f0_kn: f64,
    /// The linear spring, kN/m; none where it does not give way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub s_kn_per_m: Option<f64>,
}

/// Constants of two powers with a step between.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StepsConstants {
    /// Factor of the power below the step, kN/m.
    pub b_kn_per_m: f64,
    /// Exponent below the step.
    pub c: f64,
    /// Reference force, kN.
    pub f0_kn: f64,
    /// Force of the step, kN.
    pub f1_kn: f64,
    /// Sharpness of the step.
    pub p: f64,
    /// Rise of the stiffness across the step, relative.
    pub d: f64,
    /// Exponent above the step.
    pub e: f64,
}

/// Tangents by load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TablePoints {
    /// Forces, kN, and tangent stiffness, kN/m.
    pub table_kn_and_kn_per_m: Vec<[f64; 2]>,
    /// Exponent of the power law below the first force; left out, that of the power law that touches the table there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exponent_below: Option<f64>,
}

impl NormalLawRecord {
    /// The form.
    pub fn form(&self) -> Form {
        match self {
            Self::Power(_) => Form::Power,
            Self::Series(_) => Form::Series,
            Self::Steps(_) => Form::Steps,
            Self::Table(_) => Form::Table,
        }
    }

    /// The law in a line, in units of files, `digits` significant digits.
    pub fn formula(&self, digits: i32) -> String {
        let text = |value: f64| significant(value, digits);
        match self {
            Self::Power(LawConstants { a_kn_per_m: a, b_kn_per_m: b, c, f0_kn }) => {
                format!("k(f) = {} + {}\u{b7}(f/{f0_kn} kN)^{} kN/m", text(*a), text(*b), text(*c))
            }
            Self::Series(SeriesConstants { b_kn_per_m: b, c, f0_kn, s_kn_per_m }) => {
                let spring = s_kn_per_m.map_or_else(String::new, |s| format!(" + 1/{}", text(s)));
                format!("1/k(f) = 1/({}\u{b7}(f/{f0_kn} kN)^{}){spring} m/kN", text(*b), text(*c))
            }
            Self::Steps(StepsConstants { b_kn_per_m: b, c, f0_kn, f1_kn, p, d, e }) => format!(
                "k(f) = {}\u{b7}(f/{f0_kn} kN)^{}\u{b7}(1 + t)^(({} - {})/{})\u{b7}(1 + {}\u{b7}t/(1 + t)) kN/m, t = (f/{} kN)^{}",
                text(*b),
                text(*c),
                text(*e),
                text(*c),
                text(*p),
                text(*d),
                text(*f1_kn),
                text(*p)
            ),
            Self::Table(TablePoints { table_kn_and_kn_per_m: points, .. }) => {
                format!(
                    "{} tangents of the solid, ln k over ln f a monotone cubic between them",
                    points.len()
                )
            }
        }
    }
}

impl From<&NormalLaw> for NormalLawRecord {
    fn from(law: &NormalLaw) -> Self {
        let f0_kn = REFERENCE_FORCE / KILONEWTON;
        match law {
            NormalLaw::Power(law) => Self::Power((*law).into()),
            NormalLaw::Series(law) => Self::Series(SeriesConstants {
                b_kn_per_m: law.b() / KILONEWTON_PER_METRE,
                c: law.c(),
                f0_kn,
                s_kn_per_m: law.s().map(|s| s / KILONEWTON_PER_METRE),
            }),
            NormalLaw::Steps(law) => {
                let StepConstants { b, c, step_force, sharpness, rise, exponent_above } = law.constants();
                Self::Steps(StepsConstants {
                    b_kn_per_m: b / KILONEWTON_PER_METRE,
                    c,
                    f0_kn,
                    f1_kn: step_force / KILONEWTON,
                    p: sharpness,
                    d: rise,
                    e: exponent_above,
                })
            }
            NormalLaw::Table(law) => {
                let knots = law.knots().map(|(force, k)| [force / KILONEWTON, k / KILONEWTON_PER_METRE]);
                let exponent_below = Some(law.exponent_below());
                Self::Table(TablePoints { table_kn_and_kn_per_m: knots.collect(), exponent_below })
            }
        }
    }
}

impl TryFrom<&NormalLawRecord> for NormalLaw {
    type Error = Error;

    /// # Errors
    /// [`railspring_profiles::error::InputError`] with key `law` for constants that are no law.
    fn try_from(record: &NormalLawRecord) -> Result<Self> {
        // b·(f/f0)^c = b·(r/f0)^c·(f/r)^c with the reference force r of the library
        let factor = |b_kn_per_m: f64, c: f64, f0_kn: f64| {
            b_kn_per_m * KILONEWTON_PER_METRE * (REFERENCE_FORCE / (f0_kn * KILONEWTON)).powf(c)
        };
        Ok(match record {
            NormalLawRecord::Power(constants) => StiffnessLaw::try_from(*constants)?.into(),
            NormalLawRecord::Series(SeriesConstants { b_kn_per_m, c, f0_kn, s_kn_per_m }) => {
                let s = s_kn_per_m.map(|s| s * KILONEWTON_PER_METRE);
                SeriesLaw::new(factor(*b_kn_per_m, *c, *f0_kn), *c, s)?.into()
            }
            NormalLawRecord::Steps(StepsConstants { b_kn_per_m, c, f0_kn, f1_kn, p, d, e }) => {
                StepLaw::new(StepConstants {
                    b: factor(*b_kn_per_m, *c, *f0_kn),
                    c: *c,
                    step_force: f1_kn * KILONEWTON,
                    sharpness: *p,
                    rise: *d,
                    exponent_above: *e,
                })?
                .into()
            }
            NormalLawRecord::Table(TablePoints { table_kn_and_kn_per_m, exponent_below }) => {
                let point = |[force, k]: &[f64; 2]| (force * KILONEWTON, k * KILONEWTON_PER_METRE);
                let (forces, tangents): (Vec<f64>, Vec<f64>) =
                    table_kn_and_kn_per_m.iter().map(point).unzip();
                TableLaw::with_exponent_below(&forces, &tangents, *exponent_below)?.into()
            }
        })
    }
}

/// A law of one form for the solid, and how far it is off at each load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FormRecord {
    /// The law.
    #[serde(flatten)]
    pub law: NormalLawRecord,
    /// Its largest error of the tangent; none of a table of four loads.
    pub tangent: Option<FarthestRecord>,
    /// Its largest error of the displacement, integrated from no load.
    pub displacement: FarthestRecord,
    /// From which load on it keeps some limits.
    pub within: Vec<WithinRecord>,
    /// By load, ascending.
    pub off: Vec<LawErrorRecord>,
}

/// Where a law is farthest from the solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FarthestRecord {
    /// Largest relative error, over the value of the solid at its load.
    pub max_rel_error: f64,
    /// That load, kN.
    pub force_kn: f64,
}

/// From which load on a law keeps a limit up to the largest load; none where it is beyond the limit at the largest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WithinRecord {
    /// The relative error.
    pub limit: f64,
    /// With the tangent, kN.
    pub tangent_from_kn: Option<f64>,
    /// With the displacement, kN.
    pub displacement_from_kn: Option<f64>,
}

/// Relative errors of a law at a load, positive where the law is above the solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LawErrorRecord {
    /// Load, kN.
    pub force_kn: f64,
    /// Of the tangent. A table has the tangents of the solid: here stands that of the table of the other loads, which tells what lies
    /// between them; none at the first and the last load.
    pub tangent: Option<f64>,
    /// Of the displacement.
    pub displacement: f64,
}

impl From<&FormFit> for FormRecord {
    fn from(fit: &FormFit) -> Self {
        let record = |&LawError { force, tangent, displacement }: &LawError| LawErrorRecord {
            force_kn: force / KILONEWTON,
            tangent,
            displacement,
        };
        let off: Vec<LawErrorRecord> = fit.errors.iter().map(record).collect();
        Self {
            law: (&fit.law).into(),
            tangent: farthest(off.iter(), |at| at.tangent),
            displacement: farthest(off.iter(), |at| Some(at.displacement)).expect("there are loads"),
            within: LIMITS
                .map(|limit| WithinRecord {
                    limit,
                    tangent_from_kn: from(&off, limit, |at| at.tangent),
                    displacement_from_kn: from(&off, limit, |at| Some(at.displacement)),
                })
                .into(),
            off,
        }
    }
}

/// Where a law is farthest off by `value`; one that is no number is farther than all.
pub(crate) fn farthest<'a>(
    off: impl Iterator<Item = &'a LawErrorRecord>,
    value: impl Fn(&LawErrorRecord) -> Option<f64>,
) -> Option<FarthestRecord> {
    off.filter_map(|at| Some(FarthestRecord { max_rel_error: value(at)?.abs(), force_kn: at.force_kn }))
        .reduce(|most, at| if at.max_rel_error <= most.max_rel_error { most } else { at })
}

/// The smallest load from which on `value` keeps a limit.
fn from(off: &[LawErrorRecord], limit: f64, value: impl Fn(&LawErrorRecord) -> Option<f64>) -> Option<f64> {
    let known = off.iter().filter_map(|at| Some((at.force_kn, value(at)?)));
    let known: Vec<(f64, f64)> = known.collect();
    let beyond = known.iter().rposition(|(_, off)| !(off.abs() <= limit));
    known.get(beyond.map_or(0, |beyond| beyond + 1)).map(|(force, _)| *force)
}

impl FormRecord {
    /// Its errors at the loads from `low` to `high` (kN) and at the next ones either side, which bound what lies between: those of the whole law where nothing is said.
    pub fn over(&self, loads: Option<[f64; 2]>) -> &[LawErrorRecord] {
        let Some([low, high]) = loads else { return &self.off };
        let first = self.off.partition_point(|at| at.force_kn <= low).saturating_sub(1);
        let last = self.off.partition_point(|at| at.force_kn < high).min(self.off.len() - 1);
        &self.off[first..=last.max(first)]
    }

    /// From which load on `value` keeps a limit, kN.
    pub fn kept_from(&self, limit: f64, value: impl Fn(&LawErrorRecord) -> Option<f64>) -> Option<f64> {
        from(&self.off, limit, value)
    }

    /// From which load on tangent and displacement keep a limit, kN.
    pub fn holds_from(&self, limit: f64) -> Option<f64> {
        let tangent = from(&self.off, limit, |at| at.tangent);
        let displacement = from(&self.off, limit, |at| Some(at.displacement))?;
        // where no load tells of the tangent, none is beyond
        let known = self.off.iter().any(|at| at.tangent.is_some());
        if known { Some(tangent?.max(displacement)) } else { Some(displacement) }
    }

    /// Its largest errors in words.
    pub fn largest_errors(&self) -> String {
        let part = |of: Option<FarthestRecord>| {
            of.map_or_else(
                || "not known".into(),
                |FarthestRecord { max_rel_error, force_kn }| {
                    format!("{} % at {} kN", significant(1e2 * max_rel_error, 2), significant(force_kn, 3))
                },
            )
        };
        let tangent = if self.law.form() == Form::Table { "tangent between loads" } else { "tangent" };
        format!("{tangent} {}, displacement {}", part(self.tangent), part(Some(self.displacement)))
    }
}

/// Errors of the published form, and which other form is nearer to the solid, in a line.
pub(crate) fn best_of_forms(forms: &[FormRecord]) -> Option<String> {
    /// Largest errors that a law is said to hold with; an error is rarely known better.
    const HOLDS: f64 = 0.01;
    let largest =
        |of: &FormRecord| of.displacement.max_rel_error.max(of.tangent.map_or(0.0, |t| t.max_rel_error));
    let power = forms.iter().find(|of| of.law.form() == Form::Power)?;
    let [low, high] =
        [power.off.first()?.force_kn, power.off.last()?.force_kn].map(|load| significant(load, 3));
    let best = forms.iter().min_by(|a, b| largest(a).total_cmp(&largest(b)))?;
    let published =
        format!("largest errors of the published form from {low} to {high} kN: {}", power.largest_errors());
    let from = |limit: f64| {
        let percent = significant(1e2 * limit, 1);
        let from = power.holds_from(limit)?;
        Some(format!(", within {percent} % from {} kN on", significant(from, 3)))
    };
    let kept = LIMITS.iter().find_map(|limit| from(*limit)).unwrap_or_default();
    if best.law.form() == Form::Power {
        return Some(format!("{published}{kept}; no other form is nearer"));
    }
    let verb = if largest(best) <= HOLDS { "holds" } else { "is nearest" };
    Some(format!("{published}{kept}; `{}` {verb}: {}", best.law.form().name(), best.largest_errors()))
}
