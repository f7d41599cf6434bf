//! Measured pairs of wheels and rails that no program knows: surfaces of [`crate::shapes`] as instruments see them and programs write them. Lengths are mm.

use std::fmt::Write as _;

use crate::Random;
use crate::shapes::{Point, RAILS, RailClass, WHEELS, WheelClass, worn_head, worn_wheel};

/// How a surface was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Distance of the points, mm.
    pub step: f64,
    /// Standard deviation of the scatter across the surface, mm.
    pub scatter: f64,
    /// Inclination towards the track centre in the file.
    pub cant: f64,
    /// Length that is missing at the start and at the end, mm.
    pub cut: [f64; 2],
    /// Where the origin was, mm.
    pub origin: Point,
}

impl Measured {
    /// The points of a surface.
    pub fn points(&self, surface: &[Point], random: &mut Random) -> Vec<Point> {
        let mut along = vec![0.0];
        for pair in surface.windows(2) {
            let way = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            along.push(along[along.len() - 1] + way);
        }
        let whole = along[along.len() - 1];
        let count = ((whole - self.cut[0] - self.cut[1]) / self.step).floor().max(1.0) as usize;
        let (sin, cos) = (-self.cant.atan()).sin_cos();
        (0..=count)
            .map(|i| {
                let s = self.cut[0] + self.step * i as f64;
                let at = along.partition_point(|a| *a < s).clamp(1, surface.len() - 1);
                let t = (s - along[at - 1]) / (along[at] - along[at - 1]).max(1e-12);
                let [a, b] = [surface[at - 1], surface[at]];
                let (dy, dz) = (b[0] - a[0], b[1] - a[1]);
                let length = dy.hypot(dz).max(1e-12);
                let off = self.scatter * random.normal();
                let (y, z) = (a[0] + t * dy + off * dz / length, a[1] + t * dz - off * dy / length);
                [cos * y - sin * z - self.origin[0], sin * y + cos * z - self.origin[1]]
            })
            .collect()
    }
}

/// What a profile is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// MiniProf, `.ban` or `.whl`, z upwards; a rail's y to the track centre.
    MiniProf,
    /// Simpack, `.prr` or `.prw`, mm.
    Simpack,
    /// Simpack in metres.
    SimpackMetres,
    /// Semicolons and decimal commas.
    CsvComma,
    /// Blanks, without a heading.
    Text,
    /// Columns in inches, which the heading says.
    Inches,
    /// Columns from the field side on, z upwards.
    Reversed,
}

impl Dialect {
    /// All.
    pub const ALL: [Self; 7] = [
        Self::MiniProf,
        Self::Simpack,
        Self::SimpackMetres,
        Self::CsvComma,
        Self::Text,
        Self::Inches,
        Self::Reversed,
    ];

    /// Ending of the file's name.
    pub fn ending(self, wheel: bool) -> &'static str {
        match (self, wheel) {
            (Self::MiniProf, true) => "whl",
            (Self::MiniProf, false) => "ban",
            (Self::Simpack | Self::SimpackMetres, true) => "prw",
            (Self::Simpack | Self::SimpackMetres, false) => "prr",
            (Self::CsvComma, _) => "csv",
            _ => "txt",
        }
    }

    /// The text of a file; `tape` is the distance of a wheel's tape circle from its flange back.
    pub fn text(self, points: &[Point], wheel: bool, tape: f64) -> String {
        let mut text = String::new();
        match self {
            Self::MiniProf => {
                text += "MINIPROF\nProgramName=MiniProf\nColumnDef=X,Y,*\n";
                let _ = writeln!(text, "XYPoints={}\n", points.len());
                for [y, z] in points {
                    let _ = match wheel {
                        true => writeln!(text, "{:.4}\t{:.4}\t0.0", y + tape, z),
                        false => writeln!(text, "{:.4}\t{:.4}\t0.0", -y, -z),
                    };
                }
            }
            Self::Simpack | Self::SimpackMetres => {
                let unit = if self == Self::Simpack { 1000.0 } else { 1.0 };
                let kind = u8::from(wheel);
                let _ = write!(
                    text,
                    "header.begin\n  version = 1\n  type = {kind}\nheader.end\nspline.begin\n  units.len.f = {unit}\n  point.begin\n"
                );
                for [y, z] in points {
                    let _ = writeln!(text, "    {:.8} {:.8}", y * unit / 1000.0, z * unit / 1000.0);
                }
                text += "  point.end\nspline.end\n";
            }
            Self::CsvComma => {
                text += "y_mm;z_mm\n";
                for [y, z] in points {
                    text += &format!("{y:.4};{z:.4}\n").replace('.', ",");
                }
            }
            Self::Text => {
                for [y, z] in points {
                    let _ = writeln!(text, "{y:10.4} {z:10.4}");
                }
            }
            Self::Inches => {
                text += "y [in], z [in]\n";
                for [y, z] in points {
                    let _ = writeln!(text, "{:.6}, {:.6}", y / 25.4, z / 25.4);
                }
            }
            Self::Reversed => {
                for [y, z] in points.iter().rev() {
                    let _ = writeln!(text, "{y:.4}\t{:.4}", -z);
                }
            }
        }
        text
    }
}

/// A measured wheel on a measured rail, with the surfaces that they were measured from.
#[derive(Debug, Clone)]
pub struct MeasuredPair {
    /// What it is.
    pub name: String,
    /// File name, text and true surface of the wheel.
    pub wheel: (String, String, Vec<Point>),
    /// The same of the rail.
    pub rail: (String, String, Vec<Point>),
    /// The classes.
    pub classes: (WheelClass, RailClass),
    /// How they were measured.
    pub measured: [Measured; 2],
}

/// The measured pair of a seed.
pub fn measured_pair(seed: u64) -> MeasuredPair {
    let mut random = Random::new(seed.wrapping_mul(7919).wrapping_add(17));
    let (wheel, rail) = (random.one_of(&WHEELS), random.one_of(&RAILS));
    let worn = random.chance(0.75);
    let depth = |random: &mut Random, most: f64| if worn { random.between(0.0, most) } else { 0.0 };
    let tread = {
        let (hollow, flange) = (depth(&mut random, 2.0), depth(&mut random, 1.5));
        worn_wheel(&wheel.profile(), hollow, flange)
    };
    let head = {
        let (crown, side) = (depth(&mut random, 4.0), depth(&mut random, 4.0));
        worn_head(&rail.head(), crown, side)
    };
    let [wheel_dialect, rail_dialect] = [random.one_of(&Dialect::ALL), random.one_of(&Dialect::ALL)];
    let step = random.one_of(&[0.1, 0.2, 0.25, 0.5]);
    let scatter = random.one_of(&[0.0, 0.001, 0.002, 0.005, 0.01]);
    let mut cut = |most: f64| random.between(0.0, most);
    let wheel_cut = [cut(12.0), cut(10.0)];
    let rail_cut = [cut(18.0), cut(22.0)];
    let cant = random.one_of(&[0.0, 0.0, 0.0, 0.025, 0.05, 0.03]);
    let level = if random.chance(0.5) { 0.0 } else { random.between(-4.0, 4.0) };
    let on_wheel = Measured { step, scatter, cant: 0.0, cut: wheel_cut, origin: [0.0, 0.0] };
    let on_rail = Measured { step, scatter, cant, cut: rail_cut, origin: [level, level] };
    let name = format!(
        "{seed}: {}{} ({wheel_dialect:?}) on {} ({rail_dialect:?}), step {step}, scatter {scatter}, cant {cant}",
        if worn { "worn " } else { "" },
        wheel.name,
        rail.name
    );
    let wheel_text = wheel_dialect.text(&on_wheel.points(&tread, &mut random), true, wheel.tape);
    let rail_text = rail_dialect.text(&on_rail.points(&head, &mut random), false, 0.0);
    MeasuredPair {
        name,
        wheel: (format!("w{seed}.{}", wheel_dialect.ending(true)), wheel_text, tread),
        rail: (format!("r{seed}.{}", rail_dialect.ending(false)), rail_text, head),
        classes: (wheel, rail),
        measured: [on_wheel, on_rail],
    }
}
