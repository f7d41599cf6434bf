//! Surfaces of wheels and rails that no program knows: drawn from the dimensions of the world's practice, and worn.
//!
//! The shapes are those of a class of wheels or rails, not of a standard: crown, corner and side of a head, tread, throat, flange and tip of a wheel with
//! radii and slopes from public dimensions. Lengths are mm; y is to the field side, z down.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

/// A point (y, z), mm.
pub type Point = [f64; 2];

/// Longest step of a surface, mm.
const STEP: f64 = 0.02;

/// A line that is drawn on and on: straight pieces and arcs that follow each other tangentially.
struct Pen {
    points: Vec<Point>,
    /// Direction, rad, from y towards z.
    angle: f64,
}

impl Pen {
    fn at(start: Point, angle: f64) -> Self {
        Self { points: vec![start], angle }
    }

    fn last(&self) -> Point {
        self.points[self.points.len() - 1]
    }

    fn straight(&mut self, length: f64) {
        let [y, z] = self.last();
        let count = (length / STEP).ceil().max(1.0) as usize;
        let (sin, cos) = self.angle.sin_cos();
        self.points.extend((1..=count).map(|i| {
            let s = length * i as f64 / count as f64;
            [y + s * cos, z + s * sin]
        }));
    }

    /// An arc to a direction; it turns the way that leads there.
    fn arc(&mut self, radius: f64, to: f64) {
        let turn = to - self.angle;
        let side = turn.signum();
        let [y, z] = self.last();
        let (sin, cos) = self.angle.sin_cos();
        let centre = [y - side * radius * sin, z + side * radius * cos];
        let count = (radius * turn.abs() / STEP).ceil().max(1.0) as usize;
        for i in 1..=count {
            let angle = self.angle + turn * i as f64 / count as f64;
            let (sin, cos) = angle.sin_cos();
            self.points.push([centre[0] + side * radius * sin, centre[1] - side * radius * cos]);
        }
        self.angle = to;
    }

    /// An arc up to a distance across from where it begins, turning towards positive angles.
    fn arc_across(&mut self, radius: f64, y: f64) {
        let from = self.angle.sin() + (y - self.last()[0]) / radius;
        self.arc(radius, from.clamp(-1.0, 1.0).asin());
    }
}

/// What `make` makes of the rows of a table below its heading: a name, and numbers, with semicolons between.
fn rows<T, const N: usize>(table: &'static str, make: impl Fn(&'static str, [f64; N]) -> T) -> Vec<T> {
    let row = |line: &'static str| {
        let mut cells = line.split(';').map(str::trim);
        let name = cells.next().expect("a line has a first cell");
        let numbers: Vec<f64> = cells.map(|cell| cell.parse().expect("a number")).collect();
        make(name, numbers.try_into().expect("a number for each column"))
    };
    table.lines().skip(1).map(row).collect()
}

/// A class of rails: what its head is like, and the sizes of its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailClass {
    /// Where such rails are in use.
    pub name: &'static str,
    /// Width of the head 14 mm below its top.
    pub head: f64,
    /// Radius of the crown, where it ends (half the width), and the radius of the shoulder; 0 without one.
    pub crown: [f64; 3],
    /// Radius of the corner.
    pub corner: f64,
    /// Inclination of the side: width over depth.
    pub side: f64,
    /// Depth at which the side ends.
    pub depth: f64,
    /// Height, foot and web.
    pub body: [f64; 3],
}

/// Classes of rails, from the dimensions of catalogues and textbooks.
pub static RAILS: LazyLock<Vec<RailClass>> = LazyLock::new(|| {
    rows(include_str!("shapes/rails.csv"), |name, [head, c0, c1, c2, corner, side, depth, b0, b1, b2]| {
        RailClass { name, head, crown: [c0, c1, c2], corner, side, depth, body: [b0, b1, b2] }
    })
});

impl RailClass {
    /// The head from the gauge to the field side, top at the origin.
    pub fn head(&self) -> Vec<Point> {
        let slope = FRAC_PI_2 - self.side.atan();
        let half = |shoulder: f64| {
            let mut pen = Pen::at([0.0, 0.0], 0.0);
            pen.arc_across(self.crown[0], self.crown[1].min(shoulder));
            if self.crown[2] > 0.0 && shoulder > self.crown[1] {
                pen.arc_across(self.crown[2], shoulder);
            } else if shoulder > self.crown[1] {
                pen.arc_across(self.crown[0], shoulder);
            }
            pen.arc(self.corner, slope);
            let [_, z] = pen.last();
            pen.straight((self.depth - z).max(1.0) / slope.sin());
            pen
        };
        let width = |pen: &Pen| {
            let at = pen.points.partition_point(|p| p[1] < 14.0);
            2.0 * pen.points[at.min(pen.points.len() - 1)][0]
        };
        let (mut low, mut high) = (0.2 * self.head, 0.5 * self.head);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if width(&half(middle)) < self.head { low = middle } else { high = middle }
        }
        let right = half(low).points;
        right.iter().rev().map(|p| [-p[0], p[1]]).chain(right[1..].iter().copied()).collect()
    }
}

/// A class of wheels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelClass {
    /// Where such wheels are in use.
    pub name: &'static str,
    /// Slope of the tread at the tape circle, and farther out.
    pub slopes: [f64; 2],
    /// Where the outer slope begins, and where the rim ends.
    pub ends: [f64; 2],
    /// Thickness of the flange 10 mm above the tape circle.
    pub thickness: f64,
    /// Radii of the throat: at the tread, and at the flange.
    pub throat: [f64; 2],
    /// Inclination of the flange face, degrees.
    pub face: f64,
    /// Height of the flange, and its outer and inner radius at the tip.
    pub flange: [f64; 3],
    /// Distance of the tape circle from the flange back.
    pub tape: f64,
    /// Diameter at the tape circle.
    pub diameter: f64,
}

/// Classes of wheels, from public dimensions.
pub static WHEELS: LazyLock<Vec<WheelClass>> = LazyLock::new(|| {
    rows(
        include_str!("shapes/wheels.csv"),
        |name, [s0, s1, e0, e1, thickness, t0, t1, face, f0, f1, f2, tape, diameter]| WheelClass {
            name,
            slopes: [s0, s1],
            ends: [e0, e1],
            thickness,
            throat: [t0, t1],
            face,
            flange: [f0, f1, f2],
            tape,
            diameter,
        },
    )
});

impl WheelClass {
    /// The profile from the flange back to the end of the tread, tape circle at the origin. The back is vertical for 15 mm.
    pub fn profile(&self) -> Vec<Point> {
        // from the tape circle towards the flange, mirrored: y' = -y, so that the pen goes to positive y'
        let tread = self.slopes[0].atan();
        let to_back = |straight: f64| {
            let mut inner = Pen::at([0.0, 0.0], tread);
            inner.straight(straight);
            let face = self.face.to_radians();
            // half of the turn by the flatter radius
            let between = tread + 0.35 * (face - tread);
            if self.throat[0] > self.throat[1] {
                let flat = (between - tread).min(10.0_f64.to_radians());
                inner.arc(self.throat[0], tread + flat);
            }
            inner.arc(self.throat[1], face);
            // the tip's outer arc ends at the height of the flange
            let rise = self.flange[1] * (1.0 - face.cos());
            let [_, z] = inner.last();
            inner.straight(((self.flange[0] - rise - z) / face.sin()).max(0.5));
            inner.arc(self.flange[1], 0.0);
            inner.arc(self.flange[2], -FRAC_PI_2);
            inner.straight(15.0 - self.flange[2].min(10.0) * 0.5);
            inner
        };
        // the throat begins where the flange gets its thickness
        let (mut low, mut high) = (0.1, self.tape);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let points = to_back(middle).points;
            let at = points.iter().position(|p| p[1] >= 10.0);
            let face = at.map_or(f64::INFINITY, |at| points[at][0]);
            if self.tape - face > self.thickness { low = middle } else { high = middle }
        }
        let inner = to_back(low);
        // the back lies where the tape circle has it: the tip is stretched or pressed level
        let back = inner.last()[0];
        let top = inner.points.iter().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
        let tip = inner.points.iter().position(|p| p[1] == top).unwrap_or(0);
        let gap = self.tape - back;
        let tip_y = inner.points[tip][0];
        let mut points: Vec<Point> = inner.points[..=tip].to_vec();
        if gap > 0.0 {
            let count = (gap / STEP).ceil() as usize;
            points.extend((1..=count).map(|i| [tip_y + gap * i as f64 / count as f64, top]));
            points.extend(inner.points[tip + 1..].iter().map(|p| [p[0] + gap, p[1]]));
        } else {
            let squeeze = (self.tape - tip_y) / (back - tip_y);
            points.extend(inner.points[tip + 1..].iter().map(|p| [tip_y + squeeze * (p[0] - tip_y), p[1]]));
        }
        let mut outer = Pen::at([0.0, 0.0], -tread);
        outer.straight(self.ends[0]);
        outer.angle = -self.slopes[1].atan();
        outer.straight((self.ends[1] - self.ends[0]) / outer.angle.cos());
        points.iter().rev().map(|p| [-p[0], p[1]]).chain(outer.points[1..].iter().copied()).collect()
    }
}

/// What wear takes from a head: off the crown and off the gauge side, mm.
pub fn worn_head(head: &[Point], crown: f64, side: f64) -> Vec<Point> {
    let width = head.iter().map(|p| p[0].abs()).fold(0.0, f64::max);
    head.iter()
        .map(|&[y, z]| {
            // more at the gauge corner than in the field
            let share = (1.0 - ((y + 0.2 * width) / (1.1 * width)).powi(2)).max(0.0);
            let down = crown * share * (1.0 - (z / 20.0).clamp(0.0, 1.0));
            let gauge = (-y / width - 0.55).clamp(0.0, 0.45) / 0.45;
            let across = side * gauge * gauge * (3.0 - 2.0 * gauge);
            [y + across, z + down]
        })
        .collect()
}

/// What wear takes from a wheel: the hollow of the tread and off the flange face, mm.
pub fn worn_wheel(profile: &[Point], hollow: f64, flange: f64) -> Vec<Point> {
    let tip = profile.iter().fold([0.0, f64::NEG_INFINITY], |a, b| if b[1] > a[1] { *b } else { a });
    profile
        .iter()
        .map(|&[y, z]| {
            let up = hollow * (-((y + 3.0) / 16.0).powi(2)).exp() * (1.0 - (z / 12.0).clamp(0.0, 1.0));
            let on_face = y > tip[0] + 2.0;
            let part = if on_face { (z / tip[1]).clamp(0.0, 1.0) } else { 0.0 };
            let across = flange * (PI * part).sin().max(0.0) * f64::from(z > 1.0);
            [y - across, z - up]
        })
        .collect()
}
