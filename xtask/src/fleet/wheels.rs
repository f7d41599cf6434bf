//! Files of synthetic measured wheels: worn S1002 in the dialects of several instruments, some of them broken.
//!
//! A wheel is that of its number: the same file on every machine, whatever the other wheels.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use railspring_profiles::error::Result;
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_testing::Random;
use railspring_testing::measured::{Dialect, Measured};
use railspring_testing::shapes::{Point, worn_wheel};

use super::files::unwritable;

/// The dialects of the instruments.
const DIALECTS: [Dialect; 5] =
    [Dialect::MiniProf, Dialect::Simpack, Dialect::CsvComma, Dialect::Text, Dialect::Reversed];
/// Of so many files one is broken.
const BROKEN: usize = 50;
/// Axles of a vehicle.
const AXLES: usize = 4;
/// Distance of the tape circle from the flange back, mm.
const TAPE: f64 = 70.0;
/// Largest step between points of the unworn profile, mm.
const STEP: f64 = 0.05;
/// Largest hollow of the tread and largest wear of the flange, mm.
const WEAR: [f64; 2] = [2.5, 2.0];
/// Lengths of the waves that wear leaves across the tread, mm, and their largest height over their length.
const WAVELENGTHS: [f64; 2] = [12.0, 40.0];
const STEEPNESS: f64 = 2e-4;

/// Writes the file of wheel `number` into a folder.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(folder: &Path, number: usize) -> Result<()> {
    let (name, text) = wheel(number)?;
    let path = folder.join(name);
    std::fs::write(&path, text).map_err(|cause| unwritable(&path, &cause).into())
}

/// Name and content of the file of wheel `number`.
fn wheel(number: usize) -> Result<(String, String)> {
    let mut random = Random::new(number as u64);
    let dialect = random.one_of(&DIALECTS);
    let name = format!("{:05}_{}-{number}.{}", number / AXLES, number % AXLES + 1, dialect.ending(true));
    let surface = waved(&worn(&mut random)?, &mut random);
    let measured = Measured {
        step: random.one_of(&[0.1, 0.2, 0.25, 0.5]),
        scatter: random.between(0.001, 0.008),
        cant: 0.0,
        cut: [random.between(0.0, 10.0), random.between(0.0, 8.0)],
        origin: [0.0, 0.0],
    };
    let mut text = dialect.text(&measured.points(&surface, &mut random), true, TAPE);
    if dialect == Dialect::MiniProf {
        // what an instrument notes of the measurement
        let mut head = String::new();
        let _ = writeln!(head, "Mileage={}", random.below(300_000));
        text.insert_str(text.find('\n').map_or(0, |end| end + 1), &head);
    }
    if number % BROKEN == BROKEN - 1 {
        text = broken(&text, &mut random);
    }
    Ok((name, text))
}

/// The surface of a worn wheel, mm.
fn worn(random: &mut Random) -> Result<Vec<Point>> {
    let nominal = wheel_profile("S1002")?;
    let points: Vec<Point> = nominal.sample(STEP * 1e-3).iter().map(|p| [p.x * 1e3, p.y * 1e3]).collect();
    let [hollow, flange] = WEAR.map(|most| random.between(0.0, most));
    Ok(worn_wheel(&points, hollow, flange))
}

/// The same with long waves across the tread, which no formula of wear has.
fn waved(surface: &[Point], random: &mut Random) -> Vec<Point> {
    let waves: Vec<[f64; 3]> = (0..3)
        .map(|_| {
            let length = random.between(WAVELENGTHS[0], WAVELENGTHS[1]);
            let phase = random.between(0.0, TAU);
            [random.between(0.0, STEEPNESS * length), TAU / length, phase]
        })
        .collect();
    let height = |y: f64| waves.iter().map(|[height, k, phase]| height * (k * y + phase).sin()).sum::<f64>();
    surface.iter().map(|&[y, z]| [y, z + height(y)]).collect()
}

/// What is left of a file where a measurement went wrong.
fn broken(text: &str, random: &mut Random) -> String {
    match random.below(4) {
        0 => String::new(),
        1 => text.lines().take(6).collect::<Vec<_>>().join("\n"),
        2 => text.replace(['4', '7'], "#"),
        _ => "measurement aborted\n".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the file of a number is always the same; all dialects come, and one of [`BROKEN`] files is broken.
    #[test]
    fn wheels_are_those_of_their_numbers() {
        let all: Vec<_> = (0..60).map(|number| wheel(number).unwrap()).collect();
        assert_eq!(all[7], wheel(7).unwrap());
        let endings: std::collections::BTreeSet<_> =
            all.iter().map(|(name, _)| name.rsplit('.').next().unwrap()).collect();
        assert_eq!(endings.into_iter().collect::<Vec<_>>(), ["csv", "prw", "txt", "whl"]);
        let short = all.iter().filter(|(_, text)| text.len() < 1000 || text.contains('#')).count();
        assert_eq!(short, 60 / BROKEN);
    }
}
