//! Source: grooved rails of lines and arcs with the widths and depths of 59R1 (EN 14811: groove 42 mm, keeper 15 mm) and 60R2 (36 mm, 21 mm), drawn here. Goal: the
//! running head alone, whose gauge point lies where it was drawn, 14 mm below the top. Units: mm in the files, m. Accuracy: ROUNDOFF.

use super::*;
use crate::error::Error;
use crate::profile_file::{
    Action, Finding, FindingKind, MeasuredProfile, PrepareOptions, ProfileKind, ReadOptions, parse, prepare,
};

/// ROUNDOFF, m: the digits of the files, 1e-5 mm, at two points between which a straight gauge face is met.
const ROUNDOFF: f64 = 1e-8;
/// Half of the width of the head, mm: where its gauge point is.
const HALF: f64 = 28.0;

/// Dimensions, mm.
#[derive(Clone, Copy)]
struct Grooved {
    /// Width of the groove 14 mm below the top, and its depth.
    groove: [f64; 2],
    /// Width of the keeper; none if the measurement ends this far from the gauge point on the floor.
    keeper: Result<f64, f64>,
    /// How far the keeper's top is below that of the head.
    lower: f64,
    /// To which depth the field side was measured.
    field: f64,
}

const R59: Grooved = Grooved { groove: [42.0, 47.0], keeper: Ok(15.0), lower: 0.0, field: 30.0 };
const R60: Grooved = Grooved { groove: [36.0, 47.0], keeper: Ok(21.0), ..R59 };

fn line(points: &mut Vec<[f64; 2]>, to: [f64; 2]) {
    const STEP: f64 = 0.25;
    let from = points[points.len() - 1];
    let parts = ((to[0] - from[0]).hypot(to[1] - from[1]) / STEP).ceil().max(1.0) as u32;
    let at = |i: u32, k: usize| from[k] + (to[k] - from[k]) * f64::from(i) / f64::from(parts);
    points.extend((1..=parts).map(|i| [at(i, 0), at(i, 1)]));
}

/// To the second angle, degrees, counted from the field side to above.
fn arc(points: &mut Vec<[f64; 2]>, [y, z]: [f64; 2], radius: f64, [from, to]: [f64; 2]) {
    const STEP: f64 = 1.5;
    let parts = ((to - from).abs() / STEP).ceil();
    for i in 1..=parts as u32 {
        let (sin, cos) = (from + (to - from) * f64::from(i) / parts).to_radians().sin_cos();
        points.push([y + radius * cos, z - radius * sin]);
    }
}

impl Grooved {
    /// From the field side of the head over groove and keeper; y to the field side, z down.
    fn points(&self) -> Vec<[f64; 2]> {
        /// Corners of the head, and fillet of the groove's floor.
        const CORNER: f64 = 13.0;
        const FILLET: f64 = 10.0;
        let [groove, depth] = self.groove;
        // The gauge face leans outwards by 1:6.
        let lean = (1.0f64 / 6.0).atan();
        let (sin, cos) = lean.sin_cos();
        // On the face 14 mm below the top is the gauge point: the corner's arc touches the face above it.
        let touch = CORNER - CORNER * sin;
        let corner = -HALF + (14.0 - touch) / 6.0 + CORNER * cos;
        let end = depth - FILLET + FILLET * sin;
        let face = |z: f64| -HALF - (z - 14.0) / 6.0;
        let mut points = vec![[HALF, self.field]];
        if self.field > CORNER {
            line(&mut points, [HALF, CORNER]);
            arc(&mut points, [HALF - CORNER, CORNER], CORNER, [0.0, 90.0]);
        } else {
            points[0] = [HALF - CORNER, 0.0];
        }
        line(&mut points, [corner, 0.0]);
        arc(&mut points, [corner, CORNER], CORNER, [90.0, 180.0 - lean.to_degrees()]);
        line(&mut points, [face(end), end]);
        let floor = [face(end) - FILLET * cos, depth - FILLET];
        arc(&mut points, floor, FILLET, [-lean.to_degrees(), -90.0]);
        let keeper = match self.keeper {
            Ok(keeper) => keeper,
            Err(to) => {
                line(&mut points, [-HALF - to, depth]);
                return points;
            }
        };
        let inner = -HALF - groove;
        line(&mut points, [inner + 8.0, depth]);
        arc(&mut points, [inner + 8.0, depth - 8.0], 8.0, [-90.0, -180.0]);
        line(&mut points, [inner, self.lower + 3.0]);
        arc(&mut points, [inner - 3.0, self.lower + 3.0], 3.0, [0.0, 90.0]);
        line(&mut points, [inner - keeper + 2.0, self.lower]);
        arc(&mut points, [inner - keeper + 2.0, self.lower + 2.0], 2.0, [90.0, 180.0]);
        line(&mut points, [inner - keeper, self.lower + 20.0]);
        points
    }

    /// The rows of a file, with y and z turned over or not.
    fn rows(&self, [across, down]: [f64; 2]) -> String {
        self.points().iter().map(|[y, z]| format!("{:.5} {:.5}\n", across * y, down * z)).collect()
    }
}

fn read(name: &str, text: &str, options: &ReadOptions) -> MeasuredProfile {
    parse(name, text.as_bytes(), options).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// y where the gauge face is 14 mm below the highest point, m.
fn gauge_point(points: &[MeasuredPoint]) -> f64 {
    let top = points.iter().map(|p| p.point.y).fold(f64::INFINITY, f64::min);
    let level = top + 14.0 * MILLIMETRE;
    let pair = points.windows(2).find(|w| (w[0].point.y >= level) && (w[1].point.y < level)).unwrap();
    let [a, b] = [pair[0].point, pair[1].point];
    a.x + (level - a.y) / (b.y - a.y) * (b.x - a.x)
}

fn aside(profile: &MeasuredProfile) -> Vec<&Finding> {
    profile.findings.iter().filter(|f| f.kind == FindingKind::PassedOver).collect()
}

/// Whether the running head alone was read, and one finding says which rows were set aside.
fn check(name: &str, rail: &Grooved, profile: &MeasuredProfile, rows: usize, heading: usize) {
    let gauge = gauge_point(&profile.points);
    println!("{name}: {} points, gauge point {:.6} mm", profile.points.len(), gauge / MILLIMETRE);
    assert!((gauge + HALF * MILLIMETRE).abs() < ROUNDOFF, "{name}: {gauge}");
    assert!(profile.side_by_groove && profile.kind == ProfileKind::Rail, "{name}");
    let found = aside(profile);
    assert_eq!(found.len(), 1, "{name}: {:?}", profile.findings);
    let (first, last) = found[0].lines.unwrap();
    let lines: Vec<usize> = profile.points.iter().map(|p| p.line).collect();
    assert_eq!(last - first + 1 + lines.len(), rows, "{name}: {}", found[0]);
    assert!(
        lines.iter().all(|line| !(first..=last).contains(line) && *line > heading),
        "{name}: {}",
        found[0]
    );
    // The gauge face stays down to 0.7 of the groove's depth.
    let lowest = profile.points[0].point.y / MILLIMETRE;
    assert!((lowest - 0.7 * rail.groove[1]).abs() < 0.26, "{name}: {lowest}");
    let depth = format!("{:.0} mm deep", rail.groove[1] - rail.lower.max(0.0));
    assert!(found[0].text.contains(&depth), "{name}: {}", found[0]);
    assert!(prepare(profile, &PrepareOptions::default()).is_ok());
}

#[test]
fn the_running_head_is_taken_and_the_keeper_set_aside() {
    for (name, rail) in [
        ("59R1", R59),
        ("60R2", R60),
        ("keeper 5 mm lower", Grooved { keeper: Ok(13.0), lower: 5.0, ..R59 }),
        ("keeper 15 mm higher", Grooved { lower: -15.0, ..R59 }),
        ("shallow groove", Grooved { groove: [42.0, 25.0], ..R59 }),
        ("field side not measured", Grooved { field: 0.0, ..R59 }),
    ] {
        for turned in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            let text = rail.rows(turned);
            let profile = read("a.txt", &text, &ReadOptions::default());
            check(&format!("{name} {turned:?}"), &rail, &profile, text.lines().count(), 0);
            let left: Vec<&Finding> = profile.findings.iter().filter(|f| f.action == Action::Left).collect();
            assert!(left.is_empty(), "{name}: {left:?}");
            let said =
                profile.findings.iter().any(|f| f.text.contains("the groove is at the end of large y"));
            assert_eq!(said, turned[0] < 0.0, "{name}: {:?}", profile.findings);
            // The same rows from the keeper to the field side.
            let reversed: String = text.lines().rev().map(|line| format!("{line}\n")).collect();
            let profile = read("a.txt", &reversed, &ReadOptions::default());
            check(name, &rail, &profile, text.lines().count(), 0);
        }
    }
}

#[test]
fn a_measurement_may_end_in_the_groove() {
    for (name, to, options) in [
        ("to the middle of the floor", 30.0, ReadOptions::default()),
        ("to the keeper", 42.0, ReadOptions { kind: Some(ProfileKind::Rail), ..ReadOptions::default() }),
    ] {
        let rail = Grooved { keeper: Err(to), ..R59 };
        for turned in [[1.0, 1.0], [-1.0, -1.0]] {
            let text = rail.rows(turned);
            let profile = read("a.txt", &text, &options);
            check(&format!("{name} {turned:?}"), &rail, &profile, text.lines().count(), 0);
        }
    }
    // On the fillet there is nothing to set aside.
    let rail = Grooved { keeper: Err(0.0), ..R59 };
    let points = rail.points();
    let text: String = points
        .iter()
        .filter(|[y, z]| *y > 0.0 || *z < 44.0)
        .map(|[y, z]| format!("{y:.5} {z:.5}\n"))
        .collect();
    let profile = read("a.txt", &text, &ReadOptions::default());
    assert!(!profile.side_by_groove && aside(&profile).is_empty(), "{:?}", profile.findings);
    assert!((gauge_point(&profile.points) + HALF * MILLIMETRE).abs() < ROUNDOFF);
    // Beside a low rail there is its foot at both sides; on one side alone it would be the floor of a groove.
    let sides = [
        [-32.0, 60.0],
        [-20.0, 60.0],
        [-20.0, 3.0],
        [-17.0, 0.0],
        [17.0, 0.0],
        [20.0, 3.0],
        [20.0, 60.0],
        [32.0, 60.0],
    ];
    let mut rows = vec![sides[0]];
    sides[1..].iter().for_each(|to| line(&mut rows, *to));
    let made = |rows: &[[f64; 2]]| -> Vec<MeasuredPoint> {
        let point = |[y, z]: &[f64; 2]| nalgebra::Point2::new(y * MILLIMETRE, z * MILLIMETRE);
        rows.iter().map(|row| MeasuredPoint { point: point(row), line: 1, weight: 1.0 }).collect()
    };
    assert_eq!(open_groove(&made(&rows), -1.0), None);
    rows.retain(|[y, _]| *y <= 20.0);
    assert!(open_groove(&made(&rows), -1.0).is_some());
    // A rail seen with its foot is no groove upside down.
    let sides = [[-75.0, 150.0], [-40.0, 140.0], [-36.0, 40.0], [-36.0, 3.0], [-33.0, 0.0]];
    let mut rows = vec![sides[0]];
    sides[1..].iter().for_each(|to| line(&mut rows, *to));
    line(&mut rows, [33.0, 0.0]);
    sides.iter().rev().for_each(|[y, z]| line(&mut rows, [-y, *z]));
    assert_eq!(groove(&made(&rows)), None);
}

/// Points that scatter by 20 µm across and along the profile.
#[test]
fn scatter_hides_no_groove() {
    let mut state = 1u64;
    let mut noise = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        0.04 * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
    };
    for lower in [0.0, 5.0, -15.0] {
        let rows: String = Grooved { lower, ..R59 }
            .points()
            .iter()
            .map(|[y, z]| format!("{:.5} {:.5}\n", y + noise(), z + noise()))
            .collect();
        let profile = read("a.txt", &rows, &ReadOptions::default());
        assert!(profile.side_by_groove && aside(&profile).len() == 1, "{lower}: {:?}", profile.findings);
        // Half of the scatter, at points on a face that leans by 1:6.
        assert!((gauge_point(&profile.points) + HALF * MILLIMETRE).abs() < 0.03 * MILLIMETRE);
    }
}

/// Simpack's header and the user say the side; MiniProf's axes are only what is usual.
#[test]
fn a_groove_at_the_stated_field_side_is_said() {
    let left = |profile: &MeasuredProfile| -> Vec<String> {
        let found = profile.findings.iter().filter(|f| f.action == Action::Left);
        found.map(|f| f.text.clone()).filter(|text| text.contains("groove is at the field side")).collect()
    };
    let simpack = |across: f64| {
        let rows = R59.rows([across, 1.0]);
        let ordered: String =
            if across > 0.0 { rows.lines().rev().map(|l| format!("{l}\n")).collect() } else { rows };
        format!(
            "header.begin\n type = 0\nheader.end\nspline.begin\n units.len.f = 1000\n point.begin\n{ordered}point.end\nspline.end\n"
        )
    };
    let stated = read("a.prr", &simpack(1.0), &ReadOptions::default());
    assert_eq!(left(&stated), [] as [&str; 0]);
    assert!((gauge_point(&stated.points) + HALF * MILLIMETRE).abs() < ROUNDOFF);
    let wrong = read("a.prr", &simpack(-1.0), &ReadOptions::default());
    assert!(left(&wrong)[0].contains("as the header has it"), "{:?}", wrong.findings);
    // As requested, whatever the groove says.
    for (across, mirror_y) in [(1.0, true), (-1.0, false)] {
        let options = ReadOptions { mirror_y: Some(mirror_y), ..ReadOptions::default() };
        let profile = read("a.txt", &R59.rows([across, 1.0]), &options);
        assert!(left(&profile)[0].contains("as requested"), "{:?}", profile.findings);
        assert!(aside(&profile).len() == 1 && profile.points[0].point.x < -HALF * MILLIMETRE + ROUNDOFF);
    }
    // MiniProf: y to the track centre and z upwards, or y to the field side.
    for across in [-1.0, 1.0] {
        let profile = read("a.ban", &R59.rows([across, -1.0]), &ReadOptions::default());
        assert_eq!(left(&profile), [] as [&str; 0]);
        assert!((gauge_point(&profile.points) + HALF * MILLIMETRE).abs() < ROUNDOFF);
        let kept = profile.findings.iter().any(|f| f.text.contains("not turned over as MiniProf rails are"));
        assert_eq!(kept, across > 0.0, "{:?}", profile.findings);
    }
}

/// Neither head of a crossing is the running head: wing and nose of like width, a groove that is too wide for one, and points that do not run
/// through head, groove and keeper.
#[test]
fn other_grooves_are_refused() {
    let mut points = R59.points();
    points.swap(40, 600);
    let shuffled: String = points.iter().map(|[y, z]| format!("{y:.5} {z:.5}\n")).collect();
    for (name, text) in [
        ("crossing", Grooved { keeper: Ok(40.0), ..R59 }.rows([1.0, 1.0])),
        ("wide", Grooved { groove: [60.0, 47.0], ..R59 }.rows([1.0, 1.0])),
        ("shuffled", shuffled),
    ] {
        match parse("a.txt", text.as_bytes(), &ReadOptions::default()) {
            Err(Error::Input(error)) => {
                let message = error.to_string();
                assert!(message.contains("two heads with a groove"), "{name}: {message}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}
