//! Measurements whose place is known: standards, worn, cut, turned, moved and written as files.

use nalgebra::{Point2, Vector2};
use railspring_profiles::profile::rails::RAIL_NAMES;
use railspring_profiles::profile::wheels::WHEEL_NAMES;
use railspring_profiles::profile_file::{MeasuredPoint, ProfileFormat, ProfileKind, write};
use railspring_profiles::profile_placement::Reference;
use railspring_testing::Random;

use super::MM;

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
pub struct Synthetic {
    pub standard: &'static str,
    pub reference: Reference,
    pub class: &'static str,
    pub file: String,
    pub content: String,
    pub truth: Vec<Point2<f64>>,
    /// Whether one side of a rail's head is worn by 0.15 mm more on the average, and both are measured.
    pub told_by_wear: bool,
}

/// Places on the standard's outline that are measured, from and to (m of arc length), and which class that is.
fn extent(random: &mut Random, reference: &Reference) -> ([f64; 2], &'static str) {
    let [from, to] = reference.running;
    match reference.kind {
        ProfileKind::Rail => match random.bits() % 10 {
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
            match random.bits() % 10 {
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

/// The measurement with this number.
pub fn synthetic(seed: u64) -> Synthetic {
    let mut random = Random::new(seed.wrapping_mul(0x1234_5678_9abc_def1));
    let standard = if random.chance(0.5) { random.one_of(&RAIL_NAMES) } else { random.one_of(&WHEEL_NAMES) };
    let reference = Reference::standard(standard).unwrap();
    let curve = &reference.curve;
    let ([from, to], class) = extent(&mut random, &reference);
    let troughs = wear(&mut random, &reference);
    let step = random.between(0.1, 0.3) * MM;
    let noise = random.between(5.0, 20.0) * 1e-6;
    let gaps: Vec<[f64; 2]> = (0..random.bits() % 3)
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
    for _ in 0..random.bits() % 4 {
        let at = (random.bits() % count) as usize;
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
    let miniprof = if rail { "a.ban" } else { "a.whl" };
    let count = seen.len();
    match random.bits() % 6 {
        0 => ("a.csv".into(), format!("y,z\n{}", rows(unit, ","))),
        1 => ("a.txt".into(), rows(unit, "\t")),
        2 => {
            let points: Vec<MeasuredPoint> =
                seen.iter().map(|&point| MeasuredPoint { point, line: 0, weight: 1.0 }).collect();
            let name = if rail { "a.prr" } else { "a.prw" };
            (name.into(), write(ProfileFormat::Simpack, kind, &points, "synthetic"))
        }
        // The three headers of MiniProf: keys with values, keys in quotes with more columns, free lines.
        3 => {
            let header = format!("FileName=a\nXYPoints={count}\nXOffset=0.0000\nColumnDef=X,Y\n\n");
            (miniprof.into(), header + &rows(MM, "\t"))
        }
        4 => {
            let header = format!("\"ProgramVer=2.41\n\"XYPoints={count}\n\"Column Def=N;Y;A;X\n\n");
            let row = |(i, p): (usize, &Point2<f64>)| {
                format!("{i};{:.9};0,5;{:.9}\n", p.y / MM, p.x / MM).replace('.', ",")
            };
            (miniprof.into(), header + &seen.iter().enumerate().map(row).collect::<String>())
        }
        _ => {
            let header = "MINIPROF 1.21\nmeasured by A. B.\n12.03.98 10:24\n\n";
            (miniprof.into(), header.to_owned() + &rows(MM, "  "))
        }
    }
}
