//! Reference cases of EN 15302:2021: wheels A, B, C, H and I on rail A, mixed wheelsets, and wheelsets whose left wheel has 2 mm less diameter.
//!
//! The tables are no part of the project; the tests read them in the shared facts and print what `docs/conicity.md` has.

use nalgebra::{Point2, Vector2};
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::profile::{ProfileCurve, Segment};
use railspring_profiles::rigid_contact::{
    Roll, RunningFunction, RunningPoint, WheelOnRail, Wheelset, WheelsetPosition,
};
use railspring_testing::facts_text as facts;

/// Half the distance of the tape circles, m.
const TAPE: f64 = 0.750;

fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table.lines().filter(|l| !l.starts_with('#')).skip(1).map(|l| l.split(',').collect())
}

fn number(cell: &str) -> f64 {
    cell.parse().unwrap()
}

/// A reference profile as a curve; a break at every zone.
fn reference(table: &str, name: &str, origin: Vector2<f64>) -> ProfileCurve {
    let mut segments: Vec<Segment> = Vec::new();
    for row in rows(table).filter(|r| r[0] == name) {
        let value = |i: usize| number(row[i]);
        let z = |y: f64| match row[4] {
            "line" => value(8) + value(9) * y,
            kind => {
                let height = (value(6).powi(2) - (y - value(7)).powi(2)).max(0.0).sqrt();
                value(5) + if kind == "arc_upper" { height } else { -height }
            }
        };
        let place = |y: f64, z: f64| Point2::new(y, z) * 1e-3 + origin;
        let [start, end] = [2, 3].map(|i| place(value(i), z(value(i))));
        // The zones meet with steps of up to 1 µm, roundings of the tables: each is raised to its neighbour, which
        // keeps its slopes.
        let raised = segments.last().map_or_else(Vector2::zeros, |last| last.end() - start);
        segments.push(if row[4] == "line" {
            Segment::line(start + raised, end + raised)
        } else {
            Segment::arc(place(value(7), value(5)) + raised, start + raised, end + raised)
        });
    }
    ProfileCurve::from_segments(&segments, 0.1e-3)
}

/// The wheelset of a combination: its letters are the right and the left wheel, "mod" a left wheel of 918 mm.
fn wheelset(profiles: &str, name: &str) -> Wheelset {
    let rail = reference(profiles, "rail A", Vector2::new(TAPE, 0.0));
    let side = |wheel: char, radius: f64| WheelOnRail {
        rail: PlacedRail { curve: rail.clone(), angle: 0.0, origin: Point2::origin() },
        wheel: reference(profiles, &format!("wheel {wheel}"), Vector2::zeros()),
        radius,
    };
    let letters: Vec<char> = name.trim_end_matches("mod").chars().collect();
    let left_radius = if name.ends_with("mod") { 0.459 } else { 0.460 };
    let left = side(letters[letters.len() - 1], left_radius);
    Wheelset { left, right: side(letters[0], 0.460), tape_y: TAPE }
}

/// Names of the combinations of a table, in its order.
fn combinations(table: &str) -> Vec<String> {
    let mut names: Vec<String> = rows(table).map(|r| r[0].to_string()).collect();
    names.dedup();
    names
}

/// Largest and root mean square of differences, and where the largest is.
struct Differences(Vec<(f64, f64)>);

impl Differences {
    fn largest(&self) -> (f64, f64) {
        *self.0.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap()
    }

    fn rms(&self) -> f64 {
        (self.0.iter().map(|(_, off)| off * off).sum::<f64>() / self.0.len() as f64).sqrt()
    }
}

/// Source: rolling-radius difference, mm (`geometry/en15302_2021_deltaR.csv`). Goal: the difference without roll. Accuracy (TABLE): an
/// independent calculation of the same profiles is up to 0.0012 mm off the table, whose last digit is 0.001 mm. At rows flagged "joint" the contact
/// jumps between arcs (JUMP). Rows flagged "typo?" repeat their neighbour or miss a digit: their difference is printed only.
#[test]
fn rolling_radius_difference_of_en_15302() {
    const TABLE: f64 = 0.0012 + 0.0005;
    const JUMP: f64 = 0.04;
    let Some(profiles) = facts("geometry/en15302_profiles.csv") else { return };
    let Some(table) = facts("geometry/en15302_2021_deltaR.csv") else { return };
    let mut compared = 0;
    println!(
        "| wheels | rows | largest difference, mm | at, mm | RMS, mm | at jumps between arcs, mm | left out |"
    );
    println!("|---|---|---|---|---|---|---|");
    for name in combinations(&table) {
        let wheelset = wheelset(&profiles, &name);
        let (mut found, mut joints, mut typos) = (Vec::new(), Vec::new(), Vec::new());
        for row in rows(&table).filter(|r| r[0] == name) {
            let (shift, expected) = (number(row[1]), number(row[2]));
            let position = WheelsetPosition { lateral_shift: 1e-3 * shift, yaw: 0.0, roll: Roll::Fixed(0.0) };
            // At a jump the tables' roundings (up to 0.1 µm at the tread) decide which of two places touches.
            let both = wheelset.contacts(&position, 0.1e-6).unwrap();
            let off = both
                .right
                .points
                .iter()
                .flat_map(|r| both.left.points.iter().map(|l| 1e3 * (r.rolling_radius - l.rolling_radius)))
                .map(|difference| difference - expected)
                .min_by(|a, b| a.abs().total_cmp(&b.abs()))
                .unwrap();
            let (bound, kept) = match row[5] {
                "ok" => (TABLE, &mut found),
                "joint" => (JUMP, &mut joints),
                flag => {
                    assert_eq!(flag, "typo?");
                    (f64::INFINITY, &mut typos)
                }
            };
            assert!(off.abs() < bound, "{name} at {shift}: off by {off} from {expected}");
            kept.push((shift, off));
        }
        compared += found.len();
        let listed = |of: &[(f64, f64)]| {
            let each = of.iter().map(|(shift, off)| format!("{shift}: {off:.3}"));
            each.collect::<Vec<_>>().join(", ")
        };
        let found = Differences(found);
        let (at, largest) = found.largest();
        println!(
            "| {name} | {} | {:.4} | {at} | {:.4} | {} | {} |",
            found.0.len(),
            largest.abs(),
            found.rms(),
            listed(&joints),
            listed(&typos)
        );
    }
    assert_eq!(compared, 1438 - 9);
}

/// Source: the same table. Goal: the equivalent conicity from our profiles against that from the table's rolling-radius difference, both straight between rows, at
/// amplitudes of 1 to 6.4 mm. Accuracy: the difference of 0.0017 mm over twice the amplitude of 1 mm (TABLE); where jumps between arcs at a row are in the
/// wave, 0.04 mm over 2 · 6 mm come on top (JUMP).
#[test]
fn equivalent_conicity_from_the_table() {
    const TABLE: f64 = 0.0017 / 2.0;
    const JUMP: f64 = 0.04 / 12.0;
    let Some(profiles) = facts("geometry/en15302_profiles.csv") else { return };
    let Some(table) = facts("geometry/en15302_2021_deltaR.csv") else { return };
    println!("| wheels | amplitudes | largest difference | at, mm | RMS | at 3 mm, ours | from the table |");
    println!("|---|---|---|---|---|---|---|");
    for name in combinations(&table) {
        let point =
            |r: Vec<&str>| RunningPoint { shift: 1e-3 * number(r[1]), difference: 1e-3 * number(r[2]) };
        let mut points: Vec<_> =
            rows(&table).filter(|r| r[0] == name && r[5] != "typo?").map(point).collect();
        points.sort_by(|a, b| a.shift.total_cmp(&b.shift));
        let wheelset = wheelset(&profiles, &name);
        let own = points.iter().map(|p| {
            let position = WheelsetPosition { lateral_shift: p.shift, yaw: 0.0, roll: Roll::Fixed(0.0) };
            let both = wheelset.contacts(&position, 0.1e-6).unwrap();
            let pairs = both.right.points.iter().flat_map(|r| both.left.points.iter().map(move |l| (r, l)));
            let differences = pairs.map(|(r, l)| r.rolling_radius - l.rolling_radius);
            let near = |a: &f64, b: &f64| (a - p.difference).abs().total_cmp(&(b - p.difference).abs());
            RunningPoint { shift: p.shift, difference: differences.min_by(near).unwrap() }
        });
        let own = RunningFunction::from_points(own.collect()).unwrap();
        let expected = RunningFunction::from_points(points).unwrap();
        let amplitudes = (5..=32).map(|i| 0.2 * f64::from(i));
        let both = amplitudes.filter_map(|a| {
            let [own, expected] = [&own, &expected].map(|f| f.equivalent_conicity(1e-3 * a));
            Some((a, own? - expected?))
        });
        let found = Differences(both.collect());
        let (at, largest) = found.largest();
        let three = [&own, &expected].map(|f| f.equivalent_conicity(3e-3));
        println!(
            "| {name} | {} | {:.5} | {at:.1} | {:.5} | {} | {} |",
            found.0.len(),
            largest.abs(),
            found.rms(),
            three[0].map_or("-".into(), |value| format!("{value:.4}")),
            three[1].map_or("-".into(), |value| format!("{value:.4}")),
        );
        assert!(largest.abs() < TABLE + JUMP, "{name} at {at}: {largest}");
    }
}

/// Source: equivalent conicity of the same combinations with its extended tolerance (annex K; `geometry/en15302_2021_conicity.csv`, columns combination,
/// amplitude_mm, table, extended_low, extended_high), which the shared facts may lack. Goal: amplitudes of 1 to 7.4 mm, without roll. Accuracy: the extended
/// tolerance of the standard; away from steps of the rolling-radius difference 0.002 (SMOOTH: the table's last digit, and that of its own steps), which 80 % of the rows keep.
#[test]
#[ignore = "some seconds, and a table that the shared facts may lack: cargo long conicity_of_en_15302"]
fn conicity_of_en_15302() {
    const SMOOTH: f64 = 0.002;
    let Some(profiles) = facts("geometry/en15302_profiles.csv") else { return };
    let Some(table) = facts("geometry/en15302_2021_conicity.csv") else { return };
    println!(
        "| wheels | amplitudes | largest difference | at, mm | RMS | within {SMOOTH} | at 3 mm, ours | table |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let (mut smooth, mut all) = (0, 0);
    let mut outside = Vec::new();
    for name in combinations(&table) {
        let wheelset = wheelset(&profiles, &name);
        let function = RunningFunction::of(&wheelset, [-9e-3, 9e-3], 0.02e-3, Roll::Fixed(0.0)).unwrap();
        let mut found = Vec::new();
        let mut three = (0.0, 0.0);
        for row in rows(&table).filter(|r| r[0] == name) {
            let [amplitude, expected, low, high] = [1, 2, 3, 4].map(|i| number(row[i]));
            let own = function.equivalent_conicity(1e-3 * amplitude).unwrap_or(f64::NAN);
            // the last digit of the table's bounds
            if !(low - 0.0005..=high + 0.0005).contains(&own) {
                outside.push(format!("{name} at {amplitude}: {own} not in {low} to {high}"));
            }
            if amplitude == 3.0 {
                three = (own, expected);
            }
            found.push((amplitude, own - expected));
        }
        let found = Differences(found);
        let (at, largest) = found.largest();
        let within = found.0.iter().filter(|(_, off)| off.abs() < SMOOTH).count();
        println!(
            "| {name} | {} | {:.4} | {at} | {:.4} | {within} | {:.4} | {:.3} |",
            found.0.len(),
            largest.abs(),
            found.rms(),
            three.0,
            three.1
        );
        smooth += within;
        all += found.0.len();
    }
    println!("{smooth} of {all} within {SMOOTH}; outside of the extended tolerance: {outside:?}");
    assert!(outside.is_empty(), "{outside:?}");
    assert!(5 * smooth > 4 * all, "{smooth} of {all}");
}
