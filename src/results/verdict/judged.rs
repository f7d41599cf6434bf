//! The verdicts of a study in words: for which loads and which use each contact element holds, and for which the springs do.

use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::by_angle::record::{FixedLoadRecord, ShiftRecord};
use crate::results::run::stage::Runs;
use crate::results::springs::form::LawErrorRecord;
use crate::results::springs::record::StiffnessRecord;
use crate::results::verdict::input::VerdictInput;
use crate::results::verdict::law_lines::form_in_use;
use crate::results::verdict::record::{
    INTENDED_USE, ScenarioVerdict, VerdictOn, VerdictSubject, VerificationRecord,
};
use crate::rounding::{significant, with_unit};
use crate::verify::{Line, touches_with_flange};

/// What verdicts are made from besides their lines.
pub(crate) struct Judging<'a> {
    pub input: &'a VerdictInput<'a>,
    pub stiffness: Option<&'a StiffnessRecord>,
    pub by_angle: Option<&'a StiffnessByAngleRecord>,
    pub runs: &'a [(String, Runs)],
}

impl Judging<'_> {
    /// The verdicts that have lines, the one that decides first.
    pub fn verdicts(&self, record: &VerificationRecord) -> Vec<VerdictOn> {
        let mut all: Vec<VerdictOn> =
            VerdictSubject::ALL.into_iter().filter_map(|on| self.verdict(record, on)).collect();
        all.sort_by_key(|of| of.on != record.decides);
        all
    }

    fn verdict(&self, record: &VerificationRecord, on: VerdictSubject) -> Option<VerdictOn> {
        let [hold, hold_by_solid, fail] = record.counts(on);
        if record.lines_on(on).all(|(subject, _)| subject == INTENDED_USE) {
            return None;
        }
        let (mut holds_for, mut not_for) = (Vec::new(), Vec::new());
        let (statics, loads) = match on {
            VerdictSubject::Element => (&record.statics, self.loads_of_element(on)),
            VerdictSubject::Lumped => (&record.lumped_statics, self.loads_of_element(on)),
            VerdictSubject::Springs => (&record.calibration, self.loads_of_law()),
        };
        // the law has loads for which it holds, and says so instead of failing as a whole
        let of_law = |line: &&Line| on == VerdictSubject::Springs && line.quantity.starts_with("law_");
        let failing = worst(statics.iter().filter(|line| !of_law(line)));
        match (failing, loads) {
            (Some(line), _) => not_for.push(format!("static loads: {}", reason(line))),
            (None, Some(loads)) => holds_for.push(format!("static loads {loads}")),
            (None, None) if statics.is_empty() => {}
            (None, None) => not_for.push("static loads: the law is off at each of them".into()),
        }
        not_for.extend(
            worst(record.requirements.iter()).map(|line| format!("the intended use: {}", reason(line))),
        );
        for judged in record.scenarios.iter().filter(|judged| judged.compared.is_some()) {
            let lines: Vec<&Line> = record
                .lines_on(on)
                .filter(|(subject, _)| *subject == judged.scenario)
                .map(|(_, l)| l)
                .collect();
            let case = self.case(judged);
            match worst(lines.iter().copied()) {
                _ if lines.is_empty() => not_for.push(format!("{case}: it did not run")),
                Some(line) => not_for.push(format!("{case}: {}", reason(line))),
                None => holds_for.push(case),
            }
        }
        Some(VerdictOn { on, hold, hold_by_solid, fail, holds_for, not_for })
    }

    /// The loads at which the law in use follows tangent and displacement of the solid within their limits, if there are some: the longest row
    /// of them.
    fn loads_of_law(&self) -> Option<String> {
        let form = self.stiffness?.form(form_in_use(self.input))?;
        let (tangent, displacement) = (self.input.limits.law_max, self.input.limits.law_displacement);
        let within = |at: &LawErrorRecord| {
            at.tangent.is_none_or(|off| off.abs() <= tangent) && at.displacement.abs() <= displacement
        };
        let follows: Vec<bool> = form.off.iter().map(within).collect();
        let mut at = 0;
        let rows = follows.chunk_by(|a, b| a == b).map(|row| {
            at += row.len();
            (row[0], at - row.len(), at - 1)
        });
        let (_, first, last) =
            rows.filter(|(follows, ..)| *follows).max_by_key(|(_, first, last)| last - first)?;
        Some(format!(
            "from {} to {} kN",
            significant(form.off[first].force_kn, 3),
            significant(form.off[last].force_kn, 3)
        ))
    }

    /// Loads and shifts at which an element's hub was compared with the solid's.
    fn loads_of_element(&self, on: VerdictSubject) -> Option<String> {
        let shifts = &self.by_angle?.shifts;
        let compared = |shift: &&ShiftRecord| shift.loads.iter().any(|load| hub(load, on).is_some());
        let compared: Vec<_> = shifts.iter().filter(compared).collect();
        let (first, last) = (compared.first()?, compared.last()?);
        let loads = compared.iter().flat_map(|shift| &shift.loads).map(|load| load.force_kn);
        let [least, most] = loads.fold([f64::INFINITY, 0.0_f64], |[a, b], f| [a.min(f), b.max(f)]);
        Some(format!(
            "from {} to {} kN along the contact normal at shifts from {} to {} mm",
            significant(least, 3),
            significant(most, 3),
            significant(first.shift_mm, 3),
            significant(last.shift_mm, 3)
        ))
    }

    /// A load case with the largest forces of the solid, and whether the flange touches.
    fn case(&self, judged: &ScenarioVerdict) -> String {
        let run = self.runs.iter().find(|(name, _)| *name == judged.scenario);
        let solid = run.and_then(|(_, runs)| runs.solid.as_ref());
        let flange = solid.is_some_and(|run| touches_with_flange(&run.history));
        let peaks = judged.compared.as_ref().map(|of| [of.solid_peak_p_kn, of.solid_peak_q_kn]);
        let [p, q] = peaks.unwrap_or([f64::NAN; 2]).map(|peak| significant(peak, 2));
        let contact = if flange { "flange contact" } else { "tread contact" };
        format!("load case {} ({contact}, P to {p} kN, Q to {q} kN)", judged.scenario)
    }
}

/// The line that fails most of those that fail by a number, else the first that fails; the derailment coefficient before all.
fn worst<'l>(lines: impl Iterator<Item = &'l Line>) -> Option<&'l Line> {
    let failing: Vec<&Line> = lines.filter(|line| !line.holds).collect();
    let ratio = failing.iter().find(|line| line.quantity == "ratio_max" && line.value.is_some());
    let finite = failing.iter().filter(|line| line.excess().is_finite());
    ratio.or(finite.max_by(|a, b| a.excess().total_cmp(&b.excess()))).or(failing.first()).copied()
}

/// Why a line fails, in few words.
fn reason(line: &Line) -> String {
    let limit = with_unit(Some(line.limit), &line.unit);
    match (&*line.quantity, line.value) {
        ("ratio_max", Some(value)) => format!("Q/P {} off (limit {limit})", significant(value, 2)),
        (_, Some(value)) if line.unit == "s" => {
            format!("{} {} ms (limit {} ms)", line.meaning, significant(1e3 * value, 2), 1e3 * line.limit)
        }
        (_, Some(value)) => format!("{} {} (limit {limit})", line.meaning, significant(value, 2)),
        (_, None) => format!("{} without a value", line.meaning),
    }
}

/// Flexibility of the hub of the condensed or the lumped element, µm/kN.
fn hub(load: &FixedLoadRecord, on: VerdictSubject) -> Option<[f64; 3]> {
    match on {
        VerdictSubject::Lumped => load.lumped_hub_um_per_kn,
        _ => load.condensed_hub_um_per_kn,
    }
}

/// Where the hub of the condensed or the lumped element is most flexible or most stiff beside that of the solid: lateral, coupling and vertical, each with
/// its shift (mm) and load (kN), among the loads that one contact carries, or that two share. The coupling is over the geometric mean of the other two.
pub(crate) fn hub_deviations(
    laws: &StiffnessByAngleRecord,
    on: VerdictSubject,
    shared: bool,
) -> [Option<(f64, f64, f64)>; 3] {
    let mut farthest = [None::<(f64, f64, f64)>; 3];
    for shift in &laws.shifts {
        for load in shift.loads.iter().filter(|load| (load.contacts.len() > 1) == shared) {
            let Some(own) = hub(load, on) else { continue };
            let solid = load.hub_um_per_kn;
            let scales = [solid[0], (solid[0] * solid[2]).sqrt(), solid[2]];
            for n in 0..3 {
                let off = ((own[n] - solid[n]) / scales[n]).abs();
                // what is no number is farther than all
                if farthest[n].is_none_or(|(most, ..)| !(off <= most)) {
                    farthest[n] = Some((off, shift.shift_mm, load.force_kn));
                }
            }
        }
    }
    farthest
}

/// A shift of the wheelset (mm) and a load (kN) in words.
pub(crate) fn place(shift_mm: f64, force_kn: f64) -> String {
    format!("with the wheelset {} mm aside under {force_kn} kN", (shift_mm * 1e3).round() / 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// Goal: each direction has its farthest place: lateral 2 %, coupling 5 % of the geometric mean of the other two, vertical 1 %, where the others are exact. Accuracy: ROUNDOFF.
    #[test]
    fn the_farthest_hub_is_found_in_each_direction() {
        const ROUNDOFF: f64 = 1e-12;
        let mut laws = samples::by_angle();
        let mut loads: Vec<_> = laws.shifts.iter_mut().flat_map(|shift| &mut shift.loads).collect();
        for load in &mut loads {
            load.hub_um_per_kn = [4.0, -0.5, 1.0];
            load.condensed_hub_um_per_kn = Some(load.hub_um_per_kn);
        }
        assert!(loads.len() > 2);
        loads[0].condensed_hub_um_per_kn = Some([4.08, -0.5, 1.0]);
        loads[1].condensed_hub_um_per_kn = Some([4.0, -0.6, 1.01]);
        let [first, second] = [loads[0].force_kn, loads[1].force_kn];
        let found = hub_deviations(&laws, VerdictSubject::Element, false).map(Option::unwrap);
        for ((off, _, load), (expected, at)) in
            found.into_iter().zip([(0.02, first), (0.05, second), (0.01, second)])
        {
            assert!((off - expected).abs() < ROUNDOFF && load == at, "{found:?}");
        }
        loads = laws.shifts.iter_mut().flat_map(|shift| &mut shift.loads).collect();
        loads.iter_mut().for_each(|load| load.condensed_hub_um_per_kn = None);
        assert_eq!(hub_deviations(&laws, VerdictSubject::Element, false), [None; 3]);
        let shift = laws.shifts.iter_mut().find(|shift| shift.loads.len() > 1).unwrap();
        let at = (shift.shift_mm, shift.loads[0].force_kn);
        let both = shift.loads[0].contacts[0];
        shift.loads[0].contacts.push(both);
        shift.loads[0].condensed_hub_um_per_kn = Some([4.0, -0.5, 1.04]);
        assert_eq!(
            hub_deviations(&laws, VerdictSubject::Element, false),
            [None; 3],
            "two contacts share the load"
        );
        let [.., Some((off, shift_mm, load))] = hub_deviations(&laws, VerdictSubject::Element, true) else {
            panic!("the shared load")
        };
        assert!((off - 0.04).abs() < ROUNDOFF && (shift_mm, load) == at, "{off}");
    }

    /// Goal: the derailment coefficient is named before a line that is farther beyond its limit, and one without a limit to divide by last.
    #[test]
    fn the_reason_is_the_derailment_coefficient() {
        let limits = crate::verify::Limits::default();
        let lines = [
            limits.separations_unmatched().line(Some(2.0)),
            limits.vertical_rms().line(Some(0.9)),
            limits.ratio_max().line(Some(0.29)),
        ];
        assert_eq!(reason(worst(lines.iter()).unwrap()), "Q/P 0.29 off (limit 0.05)");
        assert!(reason(worst(lines[..2].iter()).unwrap()).starts_with("P, RMS difference"));
        assert!(
            reason(worst(lines[..1].iter()).unwrap()).starts_with("Separations that only one model has 2.0")
        );
        assert!(worst([limits.vertical_rms().line(Some(0.01))].iter()).is_none());
    }
}
