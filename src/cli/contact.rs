//! The subcommand `profile contact`: rigid contact over the lateral shift.

mod parameters;
mod picture;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::rigid_contact::{
    ContactFunctions, ContactPoint, ProfileUncertainty, Roll, RunningFunction, WheelOnRail, Wheelset,
    WheelsetContact, WheelsetPosition,
};
use railspring_profiles::units::MILLIMETRE;

use self::parameters::{Found, Record, SAMPLES, amplitudes};
use self::picture::picture;
use super::failure::Failure;
use super::output::{remark, say};
use super::pair_args::{Given, Named, by_option, named};
use super::set_args::{SetArgs, setting};
use super::shapes::write;
use crate::engine::inputs::Inputs;
use crate::results::bodies::geometry::geometry;
use crate::results::bodies::sections::repairs;
use crate::study::{Setting, Study};

/// Which pair, and where.
#[derive(Debug, Args)]
pub(super) struct ContactArgs {
    /// A study, or a wheel and a rail: names of standards, or profile files, for instance `S1002 60E1`
    #[arg(value_name = "STUDY | WHEEL RAIL", num_args = 1..=2, required = true)]
    pair: Vec<String>,
    /// Wheel and rail of the left side where they are others, as seen on their own side; keys of [wheel] and [rail] in --set are for the right side then, those of the left side in --set-left
    #[arg(long, value_names = ["WHEEL", "RAIL"], num_args = 2)]
    left: Vec<String>,
    #[command(flatten)]
    set: SetArgs,
    /// A key of [wheel] or [rail] of the left side and its value, with --left; another radius is wheel.tape_diameter_m
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting, requires = "left")]
    set_left: Vec<Setting>,
    /// Slope of the rails with a named pair
    #[arg(long, value_name = "SLOPE", default_value_t = 0.025)]
    inclination: f64,
    /// Rolling radius at the tape circle with a named pair, mm
    #[arg(long, value_name = "MM", default_value_t = 460.0)]
    radius_mm: f64,
    /// Largest shift to either side, mm
    #[arg(long, value_name = "MM", default_value_t = 8.0)]
    shift_mm: f64,
    /// Step of the shift, mm
    #[arg(long, value_name = "MM", default_value_t = 0.1)]
    step_mm: f64,
    /// Yaw, mrad
    #[arg(long, value_name = "MRAD", default_value_t = 0.0, allow_negative_numbers = true)]
    yaw_mrad: f64,
    /// Points that would touch after the wheel is lowered by this much count too, µm
    #[arg(long, value_name = "UM", default_value_t = 0.0)]
    gap_um: f64,
    /// Keep the axle level instead of letting both wheels touch
    #[arg(long)]
    no_roll: bool,
    /// Radius of a curve for the rolling radii coefficient, m
    #[arg(long, value_name = "M")]
    curve_m: Option<f64>,
    /// Standard uncertainty of the form of the measured profiles, µm; the parameters are printed with the uncertainty (k = 2) that follows
    #[arg(long, value_name = "UM")]
    profile_uncertainty_um: Option<f64>,
    /// Standard uncertainty of the roll of each measured profile, degrees; as --profile-uncertainty-um
    #[arg(long, value_name = "DEG")]
    roll_uncertainty_deg: Option<f64>,
    /// Correlation length of the errors of the form along the profile, mm
    #[arg(long, value_name = "MM", default_value_t = 10.0)]
    correlation_mm: f64,
    /// Prefix of the files to write: PREFIX.csv has the contact points, PREFIX-conicity.csv the parameters over the amplitude, PREFIX.json all
    /// parameters and functions, PREFIX.svg the figure
    #[arg(short, long, value_name = "PREFIX", default_value = "contact")]
    output: PathBuf,
}

impl ContactArgs {
    /// Both sides, and the files that they are read from; says what was done to measured profiles.
    fn wheelset(&self) -> Result<(Wheelset, Inputs), Failure> {
        let Side { side: right, tape_y, mut files } = match self.pair.as_slice() {
            [wheel, rail] => self.named_side(wheel, rail, self.set.settings(), "--set")?,
            _ => side_of(&Study::read_with(self.pair[0].as_ref(), self.set.settings())?)?,
        };
        let left = match self.left.as_slice() {
            [wheel, rail] => {
                let of_side =
                    |set: &&Setting| ["wheel.", "rail."].iter().any(|section| set.key().starts_with(section));
                if let Some(set) = self.set_left.iter().find(|set| !of_side(set)) {
                    let remedy = "give keys of the track with --set";
                    let expected = "a key of [wheel] or [rail]";
                    return Err(InputError::new("--set-left", set.key(), expected, remedy).into());
                }
                let of_track = self.set.settings().iter().filter(|set| !of_side(set));
                let settings: Vec<Setting> = of_track.chain(&self.set_left).cloned().collect();
                let left = self.named_side(wheel, rail, &settings, "--set-left")?;
                files.extend(left.files);
                left.side
            }
            _ => right.clone(),
        };
        Ok((Wheelset { left, right, tape_y }, Inputs::of(files)))
    }

    /// The uncertainty of the profiles, if one is given.
    fn uncertainty(&self) -> Result<Option<ProfileUncertainty>, Failure> {
        if self.profile_uncertainty_um.is_none() && self.roll_uncertainty_deg.is_none() {
            return Ok(None);
        }
        let (form_um, roll_deg) =
            (self.profile_uncertainty_um.unwrap_or(0.0), self.roll_uncertainty_deg.unwrap_or(0.0));
        for (option, value, least, greatest) in [
            ("--profile-uncertainty-um", form_um, 0.0, 1000.0),
            ("--roll-uncertainty-deg", roll_deg, 0.0, 2.0),
            ("--correlation-mm", self.correlation_mm, 2.0, 1000.0),
        ] {
            if !(least..=greatest).contains(&value) {
                let expected = format!("{least} to {greatest}");
                return Err(InputError::new(option, value, expected, "check the value and its unit").into());
            }
        }
        Ok(Some(ProfileUncertainty {
            form: 1e-3 * form_um * MILLIMETRE,
            correlation: self.correlation_mm * MILLIMETRE,
            roll: roll_deg.to_radians(),
        }))
    }

    /// A side from names or files with these settings, which `option` gives.
    fn named_side(&self, wheel: &str, rail: &str, given: &[Setting], of: &str) -> Result<Side, Failure> {
        if !(100.0..=1000.0).contains(&self.radius_mm) {
            let expected = "100 to 1000 mm";
            return Err(InputError::new("--radius-mm", self.radius_mm, expected, "check its unit").into());
        }
        let option =
            |option: &str, key: &str, value: f64| Setting::new(option.into(), key, &value.to_string());
        let options = [
            option("--inclination", "rail.inclination", self.inclination),
            option("--radius-mm", "wheel.tape_diameter_m", 2e-3 * self.radius_mm),
        ];
        let settings: Vec<Setting> = options.into_iter().flatten().chain(given.iter().cloned()).collect();
        let pair = [Given::wheel("WHEEL", wheel), Given::rail("RAIL", rail)];
        let Named { study, .. } = named(None, pair, &settings).map_err(|failure| by_option(failure, of))?;
        side_of(&study).map_err(|failure| by_option(failure, of))
    }
}

/// A side of a wheelset.
struct Side {
    side: WheelOnRail,
    /// Distance of its tape circle from the middle of the track, m.
    tape_y: f64,
    /// What it is read from.
    files: Vec<PathBuf>,
}

/// The side of a study with the wheelset in the middle.
fn side_of(study: &Study) -> Result<Side, Failure> {
    let found = geometry(study.statics()).map_err(|error| Failure::of_stage(study, error))?;
    repairs(&found.profiles).iter().for_each(|line| remark(line));
    let side = WheelOnRail {
        rail: found.pair.placed,
        wheel: found.pair.wheel.running,
        radius: found.pair.wheel.radius,
    };
    let files = study.source.files().map(Path::to_path_buf).collect();
    Ok(Side { side, tape_y: found.pair.tape_y - study.track.lateral_shift, files })
}

/// The contacts of a wheelset at each lateral shift, m.
type Shifts = [(f64, WheelsetContact)];

/// Runs the subcommand.
pub(super) fn contact(args: &ContactArgs) -> Result<(), Failure> {
    let uncertainty = args.uncertainty()?;
    if let Some(curve) = args.curve_m.filter(|curve| !(10.0..=1e5).contains(curve)) {
        return Err(InputError::new("--curve-m", curve, "10 to 100000 m", "check its unit").into());
    }
    let prefix = args.output.with_extension("");
    let file = |ending: &str| {
        let mut name = prefix.clone().into_os_string();
        name.push(ending);
        PathBuf::from(name)
    };
    let (wheelset, inputs) = args.wheelset()?;
    [".csv", "-conicity.csv", ".json", ".svg"].iter().try_for_each(|ending| inputs.check(&file(ending)))?;
    let rows = contacts(args, &wheelset, args.shift_mm, args.step_mm)?;
    let functions = ContactFunctions::from_contacts(&wheelset, &rows)?;
    let found = found(args, uncertainty, &wheelset, &functions)?;
    say("shift mm   y rail mm   y wheel mm   angle rad   radius mm   difference mm   (right wheel)")?;
    for line in whole_millimetres(&wheelset, &rows, functions.running()) {
        say(&line)?;
    }
    found.table().iter().try_for_each(|line| say(line))?;
    match found.conicity_text(AMPLITUDE_MM) {
        Some(tangent) => say(&format!("equivalent conicity at {AMPLITUDE_MM} mm: {tangent}"))?,
        None => say(&match enough_shift(args, &wheelset)? {
            Some(shift) => format!(
                "no equivalent conicity at {AMPLITUDE_MM} mm: its wave needs shifts up to {shift:.2} mm, give --shift-mm {shift:.2}"
            ),
            None => format!(
                "no equivalent conicity at {AMPLITUDE_MM} mm: shifts up to {MOST_SHIFT_MM} mm have no wave of this amplitude"
            ),
        })?,
    }
    found.lines().iter().try_for_each(|line| say(line))?;
    for (file, content) in [
        (file(".csv"), csv(&wheelset, &rows)),
        (file("-conicity.csv"), found.csv()),
        (file(".json"), json(&found.record(&functions))),
        (file(".svg"), picture(&wheelset, &rows, &functions, &found)),
    ] {
        write(&file, &content, &inputs)?;
        say(&file.display().to_string())?;
    }
    Ok(())
}

/// A record as text.
fn json(record: &Record) -> String {
    serde_json::to_string_pretty(record).expect("a record is plain data") + "\n"
}

/// The parameters, with their uncertainty where that of the profiles is given.
fn found(
    args: &ContactArgs,
    uncertainty: Option<ProfileUncertainty>,
    wheelset: &Wheelset,
    functions: &ContactFunctions,
) -> Result<Found, Failure> {
    let amplitudes_mm = amplitudes(args.shift_mm);
    let amplitudes: Vec<f64> = amplitudes_mm.iter().map(|a| a * MILLIMETRE).collect();
    let clearance = wheelset.flange_clearance();
    let parameters = functions.parameters(&amplitudes, clearance);
    let uncertain = match uncertainty {
        None => None,
        Some(uncertainty) => {
            let of = |wheelset: &Wheelset| {
                let rows = contacts(args, wheelset, args.shift_mm, args.step_mm)?;
                let functions = ContactFunctions::from_contacts(wheelset, &rows)?;
                let parameters = functions.parameters(&amplitudes, wheelset.flange_clearance());
                let coefficient = Found::coefficient(args.curve_m, &parameters);
                Ok(parameters.values().into_iter().chain([coefficient]).collect())
            };
            remark(&format!("the uncertainty takes {SAMPLES} times as long as the table"));
            Some((uncertainty, uncertainty.propagate(wheelset, SAMPLES, of)?))
        }
    };
    Ok(Found { amplitudes_mm, parameters, clearance, curve: args.curve_m, uncertain })
}

/// Amplitude of the equivalent conicity that is printed, mm.
const AMPLITUDE_MM: f64 = 3.0;
/// Largest shift that is tried for it, mm.
const MOST_SHIFT_MM: f64 = 10.0;

/// The least shift (mm), in steps of 0.1 mm, with which there is an equivalent conicity, if there is any.
fn enough_shift(args: &ContactArgs, wheelset: &Wheelset) -> Result<Option<f64>, Failure> {
    /// Tenths of a millimetre in one.
    const PER_MM: f64 = 10.0;
    let enough = |tenths: u32| -> Result<bool, Failure> {
        let shift_mm = f64::from(tenths) / PER_MM;
        let rows = contacts(args, wheelset, shift_mm, shift_mm.min(1.0 / PER_MM))?;
        let functions = ContactFunctions::from_contacts(wheelset, &rows)?;
        Ok(functions.running().equivalent_conicity(AMPLITUDE_MM * MILLIMETRE).is_some())
    };
    let (mut low, mut high) = ((PER_MM * AMPLITUDE_MM) as u32 - 1, (PER_MM * MOST_SHIFT_MM) as u32);
    if !enough(high)? {
        return Ok(None);
    }
    while high - low > 1 {
        let middle = (low + high) / 2;
        if enough(middle)? { high = middle } else { low = middle }
    }
    Ok(Some(f64::from(high) / PER_MM))
}

/// The contacts at every shift up to `shift_mm` in steps of `step_mm`.
fn contacts(
    args: &ContactArgs,
    wheelset: &Wheelset,
    shift_mm: f64,
    step_mm: f64,
) -> Result<Vec<(f64, WheelsetContact)>, Error> {
    let parts = (2.0 * shift_mm / step_mm).round();
    if !(2.0..=100_000.0).contains(&parts) {
        return Err(InputError::new(
            "--step-mm",
            step_mm,
            "a step that divides the shifts into 2 to 100000 parts",
            "choose shift and step anew",
        )
        .into());
    }
    let roll = if args.no_roll { Roll::Fixed(0.0) } else { Roll::Coupled };
    let gap = args.gap_um.max(0.0) * 1e-3 * MILLIMETRE;
    let mut rows = Vec::new();
    for i in 0..=parts as usize {
        let lateral_shift = shift_mm * (2.0 * i as f64 / parts - 1.0) * MILLIMETRE;
        let position = WheelsetPosition { lateral_shift, yaw: 1e-3 * args.yaw_mrad, roll };
        rows.push((lateral_shift, wheelset.contacts(&position, gap)?));
    }
    Ok(rows)
}

/// Lateral position of a contact point in the wheel's profile frame, mm.
fn on_wheel_mm(wheelset: &Wheelset, point: &ContactPoint) -> f64 {
    wheelset.right.wheel.point(point.wheel_s).x / MILLIMETRE
}

/// All contact points of both wheels as CSV.
fn csv(wheelset: &Wheelset, rows: &Shifts) -> String {
    let mut csv = String::from(
        "shift_mm,side,point,gap_um,height_mm,roll_mrad,x_mm,y_mm,z_mm,y_wheel_mm,contact_angle_rad,rolling_radius_mm,rail_curvature_per_m,wheel_curvature_per_m\n",
    );
    for (shift, both) in rows {
        for (name, side) in [("left", &both.left), ("right", &both.right)] {
            for (index, p) in side.points.iter().enumerate() {
                // Writing to a string cannot fail.
                let _ = writeln!(
                    csv,
                    "{:.6},{name},{},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.8},{:.6},{:.6},{:.6}",
                    shift / MILLIMETRE,
                    index + 1,
                    p.gap / (1e-3 * MILLIMETRE),
                    side.height / MILLIMETRE,
                    1e3 * both.roll,
                    p.point.x / MILLIMETRE,
                    p.point.y / MILLIMETRE,
                    p.point.z / MILLIMETRE,
                    on_wheel_mm(wheelset, p),
                    p.contact_angle,
                    p.rolling_radius / MILLIMETRE,
                    p.rail_curvature,
                    p.wheel_curvature,
                );
            }
        }
    }
    csv
}

/// Lines of the table on the screen: the right wheel at the shifts that are whole millimetres.
fn whole_millimetres(wheelset: &Wheelset, rows: &Shifts, function: &RunningFunction) -> Vec<String> {
    let whole = |shift: f64| (shift / MILLIMETRE - (shift / MILLIMETRE).round()).abs() < 1e-6;
    let rows = rows.iter().zip(function.points()).filter(|((shift, _), _)| whole(*shift));
    rows.map(|((shift, both), point)| {
        let p = &both.right.points[0];
        format!(
            "{:8.2} {:11.3} {:12.3} {:11.5} {:11.4} {:15.4}",
            shift / MILLIMETRE,
            p.point.y / MILLIMETRE,
            on_wheel_mm(wheelset, p),
            p.contact_angle,
            p.rolling_radius / MILLIMETRE,
            point.difference / MILLIMETRE,
        )
    })
    .collect()
}
