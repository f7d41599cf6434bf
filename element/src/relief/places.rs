//! The places of a rail where loads are summed, and the relief there.

use railspring_profiles::profile::ProfileCurve;

/// Distance of the places, m: a function is as wide as a contact under a usual load is long.
const SPACING: f64 = 8e-3;

/// Functions that are not zero at a place of the rail, and those of them before it.
pub(super) const WIDTH: usize = 6;
const BEFORE: usize = 2;

/// Distance at which a load of [`Influence::TYPICAL`] in a point would be as a contact of weight 1 is relieved by it, m. The weights are relative to it.
const SPREAD: f64 = 4.5e-3;

/// Distance `d` beyond which a load is one in a point, m.
const IN_A_POINT: f64 = 20e-3;

/// Third root of a load, N, to which others are added, so that the derivative of their relief is bounded.
const LEAST_ROOT: f64 = 2.0;

/// Newton steps to a third root, and the last one, relative: its square is rounding.
const NEWTONS: usize = 4;
const NEAR: f64 = 1e-8;

/// The third root of a load, N.
pub(super) fn root(load: f64) -> f64 {
    (load.max(0.0) + LEAST_ROOT * LEAST_ROOT * LEAST_ROOT).cbrt()
}

/// The same from the root of a load that is near, by Newton's method.
pub(super) fn root_from(near: f64, load: f64) -> f64 {
    let cube = load.max(0.0) + LEAST_ROOT * LEAST_ROOT * LEAST_ROOT;
    let mut root = near;
    for _ in 0..NEWTONS {
        let step = (root - cube / (root * root)) * (1.0 / 3.0);
        root -= step;
        if step.abs() < NEAR * root {
            return root;
        }
    }
    cube.cbrt()
}

/// How a load on a surface moves the surface around it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Influence {
    /// Displacement at a distance, times that, under a unit force: 1/(πE*), m²/N; 0 for strips that do not relieve each other.
    pub flexibility: f64,
}

impl Influence {
    /// A usual load, N.
    pub const TYPICAL: f64 = 60e3;
}

/// The places along a rail where loads are summed.
#[derive(Debug, Clone)]
pub struct ReliefPlaces {
    spacing: f64,
    length: f64,
    pub(super) count: usize,
    /// The factor C, m/N^(2/3).
    own: f64,
    /// The matrix M, m/N, by rows.
    beside: Vec<f64>,
}

/// What of the functions of a surface a place of it has.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Bells {
    pub(super) first: usize,
    pub(super) value: [f64; WIDTH],
}

/// The relief at all places, m; none at first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Relief {
    pub(super) at: Vec<f64>,
}

impl Relief {
    /// At a place, m.
    pub(super) fn of(&self, place: usize) -> f64 {
        self.at.get(place).copied().unwrap_or(0.0)
    }

    /// Takes over another.
    pub fn copy_from(&mut self, other: &Self) {
        self.at.clone_from(&other.at);
    }
}

impl ReliefPlaces {
    /// On a rail; none if its loads relieve nothing.
    pub fn new(rail: &ProfileCurve, influence: Influence) -> Option<Self> {
        let Influence { flexibility } = influence;
        if flexibility == 0.0 {
            return None;
        }
        let length = rail.length();
        let parts = (length / SPACING).ceil().max(1.0);
        let (spacing, count) = (length / parts, parts as usize + WIDTH);
        let normal = |i: usize| {
            let s = (i as f64 - BEFORE as f64) * spacing;
            rail.upward_normal(s.clamp(0.0, length))
        };
        let normals: Vec<_> = (0..count).map(normal).collect();
        let between = |i: usize, j: usize| {
            let turned = 0.5 * (1.0 + normals[i].dot(&normals[j]));
            flexibility * turned * turned / (spacing * i.abs_diff(j) as f64).hypot(IN_A_POINT)
        };
        let beside: Vec<f64> = (0..count * count).map(|n| between(n / count, n % count)).collect();
        // a load of the usual size between two places, whose relief there is that at the given distance
        let mut places = Self { spacing, length, count, own: 1.0, beside };
        let s = ((0.5 * parts).floor() + 0.25) * spacing;
        let [near, elsewhere] =
            places.made_by(&[(s, Influence::TYPICAL)]).map(|relief| places.at(&relief, s).0);
        places.own = (flexibility * Influence::TYPICAL / SPREAD - elsewhere) / near;
        Some(places)
    }

    /// The first function at an arc length, and how far from its place to the next one that is.
    fn split(&self, s: f64) -> (usize, f64) {
        let t = (s.clamp(0.0, self.length) / self.spacing).min((self.count - WIDTH) as f64 - 1e-9);
        let first = t as usize;
        (first, t - first as f64)
    }

    /// The functions at an arc length.
    pub(crate) fn bells(&self, s: f64) -> Bells {
        let (first, u) = self.split(s);
        let (v, u2) = (1.0 - u, u * u);
        let (v2, u4) = (v * v, u2 * u2);
        let value = [
            v2 * v2 * v,
            26.0 - 50.0 * u + u2 * (20.0 + 20.0 * u - 20.0 * u2 + 5.0 * u2 * u),
            66.0 - 60.0 * u2 + u4 * (30.0 - 10.0 * u),
            26.0 + 50.0 * u + u2 * (20.0 - 20.0 * u - 20.0 * u2 + 10.0 * u2 * u),
            1.0 + 5.0 * u + u2 * (10.0 + 10.0 * u + 5.0 * u2 - 5.0 * u2 * u),
            u4 * u,
        ];
        Bells { first, value: value.map(|b| b * (1.0 / 120.0)) }
    }

    /// A relief at an arc length, m, and its slope.
    pub fn at(&self, relief: &Relief, s: f64) -> (f64, f64) {
        let (first, u) = self.split(s);
        let Some(&[a, b, c, d, e, f]) = relief.at.get(first..first + WIDTH) else { return (0.0, 0.0) };
        // the polynomial from one place to the next
        let of = [
            a + 26.0 * b + 66.0 * c + 26.0 * d + e,
            5.0 * (e - a) + 50.0 * (d - b),
            10.0 * (a + e) + 20.0 * (b + d) - 60.0 * c,
            10.0 * (e - a) + 20.0 * (b - d),
            5.0 * (a + e) - 20.0 * (b + d) + 30.0 * c,
            f - a + 5.0 * (b - e) + 10.0 * (d - c),
        ];
        let [mut value, mut slope] = [0.0; 2];
        for factor in of.iter().rev() {
            slope = slope * u + value;
            value = value * u + factor;
        }
        (value * (1.0 / 120.0), slope * (1.0 / 120.0) / self.spacing)
    }

    /// A row of the matrix M, m/N.
    pub(super) fn beside(&self, place: usize) -> &[f64] {
        &self.beside[place * self.count..(place + 1) * self.count]
    }

    /// Near a load whose third root is `root`, m, and its derivative by that, m/N.
    pub(super) fn own(&self, root: f64) -> (f64, f64) {
        (self.own * (root * root - LEAST_ROOT * LEAST_ROOT), self.own * 2.0 / (3.0 * root))
    }

    /// What a load and its relief near it have of energy, J.
    pub(super) fn energy(&self, load: f64, root: f64) -> f64 {
        let least = LEAST_ROOT * LEAST_ROOT;
        let stored = 0.6 * (root.powi(5) - least * least * LEAST_ROOT) - least * load;
        load * self.own(root).0 - self.own * stored
    }

    /// What loads of weight 1 (arc length, m; force, N) make near themselves, and elsewhere.
    pub fn made_by(&self, loads: &[(f64, f64)]) -> [Relief; 2] {
        let mut at = vec![0.0; self.count];
        for &(s, force) in loads {
            let bells = self.bells(s);
            bells.value.iter().zip(&mut at[bells.first..]).for_each(|(b, at)| *at += b * force);
        }
        let elsewhere = (0..self.count).map(|i| self.beside(i).iter().zip(&at).map(|(m, g)| m * g).sum());
        let near = at.iter().map(|load| self.own(root(*load)).0).collect();
        [Relief { at: near }, Relief { at: elsewhere.collect() }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    impl Relief {
        pub(crate) fn times(&self, factor: f64) -> Self {
            Self { at: self.at.iter().map(|at| factor * at).collect() }
        }
    }

    fn flat() -> ProfileCurve {
        let points: Vec<_> = (0..=60).map(|i| Point2::new(5e-3 * f64::from(i), 0.0)).collect();
        ProfileCurve::from_points(&points, &[]).unwrap()
    }

    /// Source: K.L. Johnson, "Contact mechanics" (1985), equation 3.22, with the distance that the functions have for a load that is spread. Goal: where a usual
    /// load acts, the relief (m) is that at [`SPREAD`], wherever that is between two places; far from there it is F/(πE*·√(r² + d²)).
    /// Accuracy: the functions' sum of powers, 0.3 %; at 90 mm their width, 1 %.
    #[test]
    fn a_load_moves_a_surface_as_a_half_space() {
        const POWERS: f64 = 3e-3;
        const WIDTH: f64 = 1e-2;
        let influence = Influence { flexibility: 2.8e-12 };
        let places = ReliefPlaces::new(&flat(), influence).unwrap();
        for s in [0.1, 0.1011, 0.1023, 0.104, 0.1066] {
            let [near, elsewhere] = places.made_by(&[(s, Influence::TYPICAL)]);
            let at = |s: f64| places.at(&near, s).0 + places.at(&elsewhere, s).0;
            let here = at(s) * SPREAD / (influence.flexibility * Influence::TYPICAL);
            assert!((here - 1.0).abs() < POWERS, "{s}: {here}");
            let far =
                at(s + 0.09) * 0.09_f64.hypot(IN_A_POINT) / (influence.flexibility * Influence::TYPICAL);
            assert!((far - 1.0).abs() < WIDTH, "{s}: {far}");
        }
    }

    /// Goal: the slope of a relief is that of its values (central differences), with the ends of the rail. Accuracy: ROUNDOFF of the differences.
    #[test]
    fn a_relief_has_its_slope() {
        const ROUNDOFF: f64 = 1e-6;
        let places = ReliefPlaces::new(&flat(), Influence { flexibility: 2.8e-12 }).unwrap();
        let [near, _] = places.made_by(&[(0.011, 20e3), (0.1, 60e3)]);
        for i in 1..300 {
            let s = 1e-3 * f64::from(i) - 3e-4;
            let (_, slope) = places.at(&near, s);
            let exact = (places.at(&near, s + 1e-5).0 - places.at(&near, s - 1e-5).0) / 2e-5;
            assert!((slope - exact).abs() < ROUNDOFF * 1e-2, "{s}: {slope} {exact}");
        }
    }
}
