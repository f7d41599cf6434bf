//! Placing measurements on their standards: synthetic ones whose place is known, and the benchmark's files.
//!
//! A hundred run by default, and 1,000 with `cargo place-profiles`, which prints what became of each class.

use std::collections::BTreeMap;

use nalgebra::{Point2, Vector2};
use railspring_calibrate::profile::rails::RAIL_NAMES;
use railspring_calibrate::profile::wheels::WHEEL_NAMES;
use railspring_calibrate::profile_file::{
    MeasuredPoint, MeasuredProfile, PrepareOptions, ProfileFormat, ProfileKind, ReadOptions, parse, prepare,
    repaired, write,
};
use railspring_calibrate::profile_placement::{
    PlaceOptions, Placed, Reference, Side, place, place_profile, rail_wear, wheel_wear,
};
use rayon::prelude::*;

/// One millimetre in metres.
const MM: f64 = 1e-3;

/// Numbers that are the same on every computer (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly spread between two values.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn chance(&mut self, part: f64) -> bool {
        self.between(0.0, 1.0) < part
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.next() % all.len() as u64) as usize]
    }

    /// Normal, of unit variance.
    fn normal(&mut self) -> f64 {
        let (u, v) = (self.between(f64::MIN_POSITIVE, 1.0), self.between(0.0, 1.0));
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// Depth of wear around a place: even on part of its width, then half a wave of the squared cosine, m.
struct Trough {
    middle: f64,
    half_width: f64,
    depth: f64,
    even: f64,
}

impl Trough {
    fn at(&self, s: f64) -> f64 {
        let t = ((s - self.middle).abs() / self.half_width - self.even).max(0.0) / (1.0 - self.even);
        if t < 1.0 { self.depth * (std::f64::consts::FRAC_PI_2 * t).cos().powi(2) } else { 0.0 }
    }
}

/// A measurement as a file, and where its points lie in truth.
struct Synthetic {
    standard: &'static str,
    reference: Reference,
    class: &'static str,
    file: String,
    content: String,
    truth: Vec<Point2<f64>>,
    /// How much deeper one side of a rail's head is worn, mean over the side, m.
    told_by_wear: bool,
}

/// Places on the standard's outline that are measured, from and to (m of arc length), and which class that is.
fn extent(random: &mut Random, reference: &Reference) -> ([f64; 2], &'static str) {
    let [from, to] = reference.running;
    match reference.kind {
        ProfileKind::Rail => match random.next() % 10 {
            0..=4 => ([from, to], "rail, head"),
            5..=6 => ([from, to + random.between(5.0, 15.0) * MM], "rail, head and one underside"),
            7 => ([from + random.between(0.0, 25.0) * MM, to], "rail, gauge side cut"),
            8 => ([from, to - random.between(0.0, 25.0) * MM], "rail, field side cut"),
            _ => {
                let cut = random.between(0.0, 14.0) * MM;
                ([from + cut, to - random.between(0.0, 14.0) * MM], "rail, both sides cut")
            }
        },
        ProfileKind::Wheel => {
            let back = from - random.between(1.0, 8.0) * MM;
            match random.next() % 10 {
                0..=4 => ([back, to - random.between(0.0, 3.0) * MM], "wheel"),
                5..=6 => ([back, to + random.between(2.0, 15.0) * MM], "wheel with field face"),
                7 => ([from + random.between(0.0, 20.0) * MM, to], "wheel, flange back cut"),
                8 => ([back, to - random.between(3.0, 30.0) * MM], "wheel, field side cut"),
                _ => {
                    let end = to - random.between(3.0, 30.0) * MM;
                    ([from + random.between(0.0, 12.0) * MM, end], "wheel, both sides cut")
                }
            }
        }
    }
}

/// Wear of up to 3 mm: on crown, gauge corner and gauge side of a rail, on tread and flange face of a wheel.
fn wear(random: &mut Random, reference: &Reference) -> Vec<Trough> {
    let curve = &reference.curve;
    let at = |y: f64| curve.s_at_y(y).unwrap();
    let mut depth = |most: f64| if random.chance(0.85) { random.between(0.05, most) * MM } else { 0.0 };
    let depths = [depth(3.0), depth(3.0)];
    let even = [random.between(0.0, 0.7), random.between(0.0, 0.7)];
    let mut between = |low: f64, high: f64| random.between(low, high);
    let trough = |i: usize, middle: f64, half_width: f64| Trough {
        middle,
        half_width,
        depth: depths[i],
        even: even[i],
    };
    match reference.kind {
        ProfileKind::Rail => {
            let half_head = -curve.point(reference.running[0]).x;
            let crown = at(between(-0.25, 0.1) * half_head);
            let side = reference.running[0] + between(0.0, 18.0) * MM;
            vec![trough(0, crown, between(0.3, 0.5) * half_head), trough(1, side, between(12.0, 22.0) * MM)]
        }
        ProfileKind::Wheel => {
            let tread = at(between(-5.0, 10.0) * MM);
            let face = curve.closest(&Point2::new(between(-42.0, -37.0) * MM, 11.0 * MM)).0;
            vec![trough(0, tread, between(18.0, 32.0) * MM), trough(1, face, between(8.0, 14.0) * MM)]
        }
    }
}

fn synthetic(seed: u64) -> Synthetic {
    let mut random = Random(seed.wrapping_mul(0x1234_5678_9abc_def1));
    let standard = if random.chance(0.5) { random.one_of(&RAIL_NAMES) } else { random.one_of(&WHEEL_NAMES) };
    let reference = Reference::standard(standard).unwrap();
    let curve = &reference.curve;
    let ([from, to], class) = extent(&mut random, &reference);
    let troughs = wear(&mut random, &reference);
    let step = random.between(0.1, 0.3) * MM;
    let noise = random.between(5.0, 20.0) * 1e-6;
    let gaps: Vec<[f64; 2]> = (0..random.next() % 3)
        .map(|_| {
            let start = random.between(from, to);
            [start, start + random.between(0.5, 3.0) * MM]
        })
        .collect();
    let mut points = Vec::new();
    let mut s = from;
    while s <= to {
        if !gaps.iter().any(|gap| (gap[0]..gap[1]).contains(&s)) {
            let deep: f64 = troughs.iter().map(|trough| trough.at(s)).sum::<f64>().min(3.0 * MM);
            let deep = if reference.runs(s) { deep } else { 0.0 };
            let scatter = Vector2::new(random.normal(), random.normal()) * noise;
            points.push(curve.point(s) - deep * reference.outward(s) + scatter);
        }
        s += step * random.between(0.8, 1.2);
    }
    let count = points.len() as u64;
    for _ in 0..random.next() % 4 {
        let at = (random.next() % count) as usize;
        points[at] +=
            Vector2::new(random.normal(), random.normal()).normalize() * random.between(0.2, 2.0) * MM;
    }
    // In the frame of the instrument.
    let (sin, cos) = random.between(-5.0, 5.0).to_radians().sin_cos();
    let shift = Vector2::new(random.between(-50.0, 50.0), random.between(-50.0, 50.0)) * MM;
    let mirrored = if random.chance(0.5) { -1.0 } else { 1.0 };
    let seen: Vec<Point2<f64>> = points
        .iter()
        .map(|p| Point2::new(mirrored * p.x, p.y))
        .map(|p| Point2::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y) + shift)
        .collect();
    let (file, content) = written(&mut random, reference.kind, &seen);
    // Mean over the side and corner of the head, as far as it is measured on both sides.
    let side = |s: f64| reference.keeps(s) && reference.runs(s) && (from..=to).contains(&s);
    let places: Vec<f64> = (0..).map(|i| from + f64::from(i) * 0.2 * MM).take_while(|s| *s < to).collect();
    let gauge: Vec<f64> = places.iter().copied().filter(|s| side(*s) && curve.point(*s).x < 0.0).collect();
    let field = places.iter().filter(|s| side(**s) && curve.point(**s).x > 0.0).count();
    let worn = |s: &f64| troughs.iter().map(|trough| trough.at(*s)).sum::<f64>().min(3.0 * MM);
    let mean = gauge.iter().map(worn).sum::<f64>() / gauge.len().max(1) as f64;
    let told_by_wear = gauge.len() > 30 && field > 30 && mean > 0.15 * MM;
    Synthetic { standard, reference, class, file, content, truth: points, told_by_wear }
}

/// One of the formats, in one of the units where the format leaves it open.
fn written(random: &mut Random, kind: ProfileKind, seen: &[Point2<f64>]) -> (String, String) {
    let rail = kind == ProfileKind::Rail;
    let rows = |unit: f64, separator: &str| {
        let row = |p: &Point2<f64>| format!("{:.9}{separator}{:.9}\n", p.x / unit, p.y / unit);
        seen.iter().map(row).collect::<String>()
    };
    let unit = random.one_of(&[MM, 1.0, 25.4 * MM]);
    match random.next() % 4 {
        0 => ("a.csv".into(), format!("y,z\n{}", rows(unit, ","))),
        1 => ("a.txt".into(), rows(unit, "\t")),
        2 => {
            let points: Vec<MeasuredPoint> =
                seen.iter().map(|&point| MeasuredPoint { point, line: 0, weight: 1.0 }).collect();
            let name = if rail { "a.prr" } else { "a.prw" };
            (name.into(), write(ProfileFormat::Simpack, kind, &points, "synthetic"))
        }
        _ => {
            let header = format!("FileName=a\nXYPoints={}\nColumnDef=X,Y\n\n", seen.len());
            (if rail { "a.ban" } else { "a.whl" }.into(), header + &rows(MM, ","))
        }
    }
}

/// What became of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Placed,
    /// Placed, and the program says that the side is not told.
    SideNotTold,
    /// The program says that the place is not determined.
    NotDetermined,
    NotRead,
    WrongSide,
    WrongPlace,
}

struct Case {
    outcome: Outcome,
    shift: f64,
    turn: f64,
    text: String,
}

fn tried(case: &Synthetic) -> Case {
    let reference = &case.reference;
    let options = ReadOptions { kind: Some(reference.kind), ..ReadOptions::default() };
    let fail = |text: String| Case { outcome: Outcome::NotRead, shift: f64::NAN, turn: f64::NAN, text };
    let profile = match parse(&case.file, case.content.as_bytes(), &options) {
        Ok(profile) => profile,
        Err(error) => return fail(error.to_string()),
    };
    let points = match repaired(&profile, &mut Vec::new()) {
        Ok(points) => points,
        Err(error) => return fail(error.to_string()),
    };
    let points: Vec<Point2<f64>> = points.iter().map(|p| p.point).collect();
    let placed = match place(&points, reference, PlaceOptions::default()) {
        Ok(Some(placed)) => placed,
        Ok(None) => return fail("no place".into()),
        Err(error) => return fail(error.to_string()),
    };
    let mut read = profile.points.clone();
    read.sort_by_key(|p| p.line);
    // Wheels are written from the field side in this format.
    if case.file == "a.prw" {
        read.reverse();
    }
    let found: Vec<Point2<f64>> = read.iter().map(|p| placed.motion.apply(&p.point)).collect();
    assert_eq!(found.len(), case.truth.len(), "{}: points lost in reading", case.file);
    judged(case, &placed, &found)
}

/// Compares places of the same points: both have the same noise, so that the difference is a rigid motion.
fn judged(case: &Synthetic, placed: &Placed, found: &[Point2<f64>]) -> Case {
    const SHIFT: f64 = 0.05 * MM;
    const TURN: f64 = 0.05;
    let (first, last) = (0, found.len() - 1);
    let (a, b) = (found[last] - found[first], case.truth[last] - case.truth[first]);
    // A third point tells whether one is the mirror image of the other.
    let third =
        |points: &[Point2<f64>]| (points[last] - points[first]).perp(&(points[last / 2] - points[first]));
    let turned_over = third(found) * third(&case.truth) < 0.0;
    let angle = b.perp(&a).atan2(b.dot(&a));
    // Where the true origin went.
    let back = case.truth[first].coords * -1.0;
    let (sin, cos) = angle.sin_cos();
    let origin = found[first] + Vector2::new(cos * back.x - sin * back.y, sin * back.x + cos * back.y);
    let (shift, turn) = (origin.coords.amax(), angle.to_degrees().abs());
    let mut text = format!(
        "{} {}: off {:.4} mm, {:.4}°; said ±{:.4} {:.4} mm {:.4}°, noise {:.1} µm, rms {:.1} µm, kept {:.1} of {:.1} mm, \
         unexplained {:.3}, size {:.4} ± {:.4}",
        case.file,
        case.standard,
        shift / MM,
        turn,
        placed.spread.y / MM,
        placed.spread.z / MM,
        placed.spread.angle.to_degrees(),
        1e6 * placed.noise,
        1e6 * placed.rms,
        placed.kept_length / MM,
        placed.length / MM,
        placed.unexplained,
        placed.size.factor,
        placed.size.uncertainty,
    );
    let not_told = matches!(placed.side, Side::NotTold { .. });
    let (shift, turn, wrong_side) = if turned_over && not_told && !case.told_by_wear {
        // The mirror image of a symmetric head, of which the program said that it cannot tell: compare that.
        let mirror: Vec<Point2<f64>> = found.iter().map(|p| Point2::new(-p.x, p.y)).collect();
        let flipped = judged(case, &Placed { side: Side::Outline, ..placed.clone() }, &mirror);
        text += &format!("; mirror image off {:.4} mm {:.4}°", flipped.shift / MM, flipped.turn);
        (flipped.shift, flipped.turn, false)
    } else {
        (shift, turn, turned_over)
    };
    let outcome = if !placed.determined() {
        Outcome::NotDetermined
    } else if wrong_side {
        Outcome::WrongSide
    } else if shift > SHIFT || turn > TURN {
        Outcome::WrongPlace
    } else if not_told {
        Outcome::SideNotTold
    } else {
        Outcome::Placed
    };
    Case { outcome, shift, turn, text }
}

/// Counts of the outcomes of each class.
fn counted(seeds: std::ops::Range<u64>, say: bool) -> BTreeMap<(&'static str, Outcome), usize> {
    let mut counts = BTreeMap::new();
    let seeds: Vec<u64> = seeds.collect();
    let tried: Vec<(Synthetic, Case)> = seeds
        .par_iter()
        .map(|&seed| {
            let case = synthetic(seed);
            let result = tried(&case);
            (case, result)
        })
        .collect();
    for (seed, (case, result)) in seeds.into_iter().zip(tried) {
        if say && !matches!(result.outcome, Outcome::Placed | Outcome::SideNotTold) {
            println!("{seed} {}, {:?}: {}", case.class, result.outcome, result.text);
        }
        *counts.entry((case.class, result.outcome)).or_insert(0) += 1;
    }
    counts
}

/// Source: standards worn, cut, turned, moved and written as files by this test. Goal: every one is read; where the program
/// says that the place is determined, it is within 0.05 mm (origin of the standard) and 0.05°, and the side is the right one
/// unless the program says that wear does not tell it. Returns how many are placed.
fn nothing_wrong(seeds: std::ops::Range<u64>, say: bool) -> usize {
    let counts = counted(seeds, say);
    let mut placed = 0;
    for ((class, outcome), count) in &counts {
        if say {
            println!("{class}: {outcome:?} {count}");
        }
        match outcome {
            Outcome::Placed | Outcome::SideNotTold => placed += count,
            Outcome::NotDetermined => {}
            Outcome::NotRead | Outcome::WrongSide | Outcome::WrongPlace => {
                panic!("{class}: {count} times {outcome:?}, {counts:?}")
            }
        }
    }
    placed
}

#[test]
fn synthetic_measurements_are_placed() {
    // The few others are cut so short, or are worn so far, that the program says so.
    let placed = nothing_wrong(0..100, false);
    assert!(placed >= 95, "{placed}");
}

/// As [`synthetic_measurements_are_placed`].
#[test]
#[ignore = "half a minute: cargo place-profiles"]
fn a_thousand_synthetic_measurements_are_placed() {
    let placed = nothing_wrong(0..1000, true);
    println!("{placed} of 1000 placed");
    assert!(placed >= 950, "{placed}");
}

/// Points of a standard's outline, noise-free, between two arc lengths from the start of its running surface, mm.
fn measured(
    reference: &Reference,
    [from, to]: [f64; 2],
    wear: impl Fn(Point2<f64>) -> f64,
) -> Vec<Point2<f64>> {
    let start = reference.running[0];
    let count = ((to - from) / 0.2) as usize;
    (0..=count)
        .map(|i| start + (from + (to - from) * i as f64 / count as f64) * MM)
        .map(|s| {
            let p = reference.curve.point(s);
            p - wear(p) * reference.outward(s)
        })
        .collect()
}

fn as_file(kind: ProfileKind, points: &[Point2<f64>]) -> MeasuredProfile {
    let rows: String = points.iter().map(|p| format!("{:.7},{:.7}\n", p.x / MM, p.y / MM)).collect();
    let options = ReadOptions { kind: Some(kind), ..ReadOptions::default() };
    parse("a.csv", rows.as_bytes(), &options).unwrap()
}

/// Goal: the file of a rail is refused for a wheel and the other way round, with a message that names what it is; neither is
/// ever said to be determined.
#[test]
fn files_of_the_other_body_are_refused() {
    for (name, other) in
        [("60E1", "S1002"), ("49E1", "EN13715-1in40"), ("S1002", "60E1"), ("EN13715-1in40", "30E1")]
    {
        let [own, other] = [name, other].map(|name| Reference::standard(name).unwrap());
        let length = (own.running[1] - own.running[0]) / MM;
        let points = measured(&own, [0.0, length], |_| 0.0);
        let error =
            place_profile(&as_file(other.kind, &points), &other, PlaceOptions::default()).unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("the file is that of the other body") && message.contains(name),
            "{message}"
        );
    }
    for seed in 0..20 {
        let case = synthetic(seed);
        let other = match Reference::standard(case.standard).unwrap().kind {
            ProfileKind::Rail => WHEEL_NAMES[seed as usize % WHEEL_NAMES.len()],
            ProfileKind::Wheel => RAIL_NAMES[seed as usize % RAIL_NAMES.len()],
        };
        let reference = Reference::standard(other).unwrap();
        let options = ReadOptions { kind: Some(reference.kind), ..ReadOptions::default() };
        let Ok(profile) = parse(&case.file, case.content.as_bytes(), &options) else { continue };
        let Ok(points) = repaired(&profile, &mut Vec::new()) else { continue };
        let points: Vec<Point2<f64>> = points.iter().map(|p| p.point).collect();
        if let Some(placed) = place(&points, &reference, PlaceOptions::default()).unwrap() {
            assert!(!placed.fits(), "{} as {other}: {:.3} unexplained", case.standard, placed.unexplained);
        }
    }
}

/// Source: EN 13715, S1002: flange height 28 mm, thickness 32.5 mm, qR 10.79 mm (from its own arcs); a rail lowered by 2 mm
/// over its crown and moved in by 1.5 mm at its gauge side. Goal: what is read off. Accuracy: DISCRETISATION, points
/// 0.2 mm apart.
#[test]
fn wear_is_read_off() {
    const DISCRETISATION: f64 = 0.005 * MM;
    let near = |found: Option<f64>, mm: f64| {
        let found = found.unwrap();
        assert!((found - mm * MM).abs() < DISCRETISATION, "{} instead of {mm} mm", found / MM);
    };
    let rail = Reference::standard("60E1").unwrap();
    let length = (rail.running[1] - rail.running[0]) / MM;
    // Full depth about the axis and the gauge face, nothing from 20 mm on to the field side; along the normals.
    let smooth = |t: f64| {
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let worn = |p: Point2<f64>| match (p.x < -35.0 * MM, p.x / MM) {
        (true, _) => 1.5 * MM,
        (false, y) if y < -20.0 => (2.0 - 0.5 * smooth((-y - 20.0) / 15.0)) * MM,
        (false, y) => 2.0 * MM * (1.0 - smooth((y - 5.0) / 15.0)),
    };
    let profile = as_file(ProfileKind::Rail, &measured(&rail, [0.0, length], worn));
    let (moved, placed) = place_profile(&profile, &rail, PlaceOptions::default()).unwrap();
    assert!(
        placed.determined() && !placed.motion.mirrored,
        "{:?} {:?} {:?}",
        placed.motion,
        placed.spread,
        placed.side
    );
    let curve = prepare(&moved, &PrepareOptions::default()).unwrap().curve;
    let found = rail_wear(&placed, &curve, &rail);
    near(found.vertical, 2.0);
    // The face leans 1:20: the horizontal distance is that much longer than the normal one.
    near(found.lateral, 1.5 * (1.0f64 + 0.05 * 0.05).sqrt());

    let wheel = Reference::standard("S1002").unwrap();
    let length = (wheel.running[1] - wheel.running[0]) / MM;
    let hollow = |p: Point2<f64>| 2.0 * MM * smooth(1.0 - (p.x / MM - 5.0).abs() / 30.0);
    for (worn, height, tread) in [(false, 28.0, 0.0), (true, 29.852, 1.852)] {
        let wear = |p: Point2<f64>| if worn { hollow(p) } else { 0.0 };
        let profile = as_file(ProfileKind::Wheel, &measured(&wheel, [-5.0, length], wear));
        let (moved, placed) = place_profile(&profile, &wheel, PlaceOptions::default()).unwrap();
        let curve = prepare(&moved, &PrepareOptions::default()).unwrap().curve;
        let found = wheel_wear(&placed, &curve, &wheel);
        near(found.flange_height, height);
        near(found.tread, tread);
        if worn {
            assert!(found.hollow.unwrap() > 0.2 * MM, "{found:?}");
        } else {
            near(found.flange_thickness, 32.5);
            near(found.flange_slope, 10.794);
            near(found.hollow, 0.0);
        }
    }
}

/// Goal: a measurement that is 2 % too large is said to be so; one of the right size is not.
#[test]
fn a_wrong_size_is_said() {
    let wheel = Reference::standard("S1002").unwrap();
    let length = (wheel.running[1] - wheel.running[0]) / MM;
    for (factor, right) in [(1.0, true), (1.02, false)] {
        let points: Vec<Point2<f64>> =
            measured(&wheel, [-5.0, length], |_| 0.0).iter().map(|p| p * factor).collect();
        let placed = place(&points, &wheel, PlaceOptions::default()).unwrap().unwrap();
        assert_eq!(placed.size.is_one(), right, "{:?}", placed.size);
    }
}

/// Goal: a piece of tread alone, evenly worn, which fits many places, is not said to be determined.
#[test]
fn a_tread_alone_is_not_determined() {
    let wheel = Reference::standard("EN13715-1in40").unwrap();
    let length = (wheel.running[1] - wheel.running[0]) / MM;
    let points = measured(&wheel, [length - 80.0, length - 30.0], |_| 1.0 * MM);
    let placed = place(&points, &wheel, PlaceOptions::default()).unwrap();
    assert!(placed.is_none_or(|placed| !placed.determined()));
}
