//! STEM and ROSE: a power of the displacement, `F = (x / coefficient)^power` in N and m.
//!
//! Both programs evaluate that formula (UVEC's `HertzianContact`), with the coefficient inside the power. For a law without
//! a constant part, `dF/dx = b·(F/f0)^c`, separation gives `x = f0^c·F^(1-c) / (b·(1-c))`: the power is `1/(1-c)` and the
//! coefficient `f0^c / (b·(1-c))`, in m/N^(1-c). A law with a constant part is no power; the straight line of least squares through
//! ln F over ln x is the best one, and the file says how good it is.

use std::fmt::Write as _;

use railspring_calibrate::law::{NormalLaw, REFERENCE_FORCE, StiffnessLaw};

use super::spring::{ExportFile, Spring, commented};

/// Loads of the fit and of its error, evenly apart in ln F.
const LOADS: usize = 200;

/// A law `F = (x / coefficient)^power`.
struct PowerLaw {
    coefficient: f64,
    power: f64,
}

impl PowerLaw {
    fn of(spring: &Spring) -> Self {
        if let NormalLaw::Power(StiffnessLaw { a: 0.0, b, c }) = spring.law {
            let rest = 1.0 - c;
            return Self { coefficient: REFERENCE_FORCE.powf(c) / (b * rest), power: 1.0 / rest };
        }
        let points: Vec<[f64; 2]> =
            loads(spring).map(|force| [spring.law.displacement(force).ln(), force.ln()]).collect();
        let mean =
            |column: usize| points.iter().map(|point| point[column]).sum::<f64>() / points.len() as f64;
        let [x, y] = [mean(0), mean(1)];
        let (products, squares) = points.iter().fold((0.0, 0.0), |(products, squares), point| {
            (products + (point[0] - x) * (point[1] - y), squares + (point[0] - x).powi(2))
        });
        let power = products / squares;
        Self { coefficient: (x - y / power).exp(), power }
    }

    fn force(&self, displacement: f64) -> f64 {
        (displacement / self.coefficient).powf(self.power)
    }

    /// Largest deviations of force and tangent from the law over its range.
    fn errors(&self, spring: &Spring) -> [f64; 2] {
        loads(spring).fold([0.0; 2], |[of_force, of_tangent], force| {
            let displacement = spring.law.displacement(force);
            let found = self.force(displacement);
            let tangent = self.power * found / displacement;
            let error = |ratio: f64| (ratio - 1.0).abs();
            [of_force.max(error(found / force)), of_tangent.max(error(tangent / spring.law.tangent(force)))]
        })
    }
}

/// Loads over the range of the law, N.
fn loads(spring: &Spring) -> impl Iterator<Item = f64> {
    let [low, high] = spring.range;
    (0..LOADS).map(move |i| low * (high / low).powf(i as f64 / (LOADS - 1) as f64))
}

/// Static loads of linear springs, N: as far as they lie in the range of the law.
const STATIC: [f64; 6] = [20e3, 40e3, 60e3, 80e3, 100e3, 120e3];

/// The contact of STEM's vehicle models, with linear springs for small motions about a static load.
pub(super) fn stem(spring: &Spring) -> ExportFile {
    let keys = ["contact_coefficient", "contact_power"];
    let mut file = file(spring, "STEM (UVEC)", "stem_contact.py", keys);
    let [low, high] = spring.range;
    let _ = write!(
        file.text,
        "\n# Linear springs by static load, N: the law's tangent there, for small motions about it. Under the load itself they are pressed by F/k, not by the law's displacement.\n\
         # With a power of 1 UVEC 1.1.4 knows no separation: in a gap it pushes as much as where it is pressed as deep. Take them only where the wheel stays on the rail.\n\
         LINEAR = {{\n"
    );
    for load in STATIC.into_iter().filter(|load| (low..=high).contains(load)) {
        let give = 1.0 / spring.law.tangent(load);
        let _ = writeln!(file.text, "    {load}: {{\"{}\": {give:e}, \"{}\": 1.0}},", keys[0], keys[1]);
    }
    file.text.push_str("}\n");
    file
}

/// The contact of ROSE.
pub(super) fn rose(spring: &Spring) -> ExportFile {
    file(spring, "ROSE", "rose_contact.py", ["hertzian_contact_coef", "hertzian_power"])
}

fn file(spring: &Spring, program: &str, name: &str, keys: [&str; 2]) -> ExportFile {
    let law = PowerLaw::of(spring);
    let [low, high] = spring.range;
    let of_law = if matches!(spring.law, NormalLaw::Power(StiffnessLaw { a: 0.0, .. })) {
        "the law's own power and coefficient in closed form: it has no constant part".into()
    } else {
        let [force, tangent] = law.errors(spring);
        format!(
            "best power for a law that is none: from {low} to {high} N the force is within {:.2} %, the tangent within \
             {:.2} % of the law",
            1e2 * force,
            1e2 * tangent
        )
    };
    let own = [
        format!("F = (x / {})^{}, F in N, x in m", keys[0], keys[1]),
        of_law,
        format!("beyond {high} N the program goes on with the same power, which is no law"),
    ];
    let mut text =
        commented("#", &spring.heading(&format!("Contact spring of a wheel on a rail, {program}"), &own));
    let _ = write!(
        text,
        "\nCONTACT = {{\n    \"{}\": {:e},\n    \"{}\": {},\n}}\n",
        keys[0], law.coefficient, keys[1], law.power
    );
    ExportFile { name: name.into(), text }
}
