//! A mass that falls on a spring with a stiffness law: peak by energy, contact
//! time by quadrature. Gravity during the contact is left out.

use crate::law::StiffnessLaw;
use railspring_profiles::root::bisection;

/// Largest compression, force and duration of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drop {
    /// Largest force, N.
    pub peak_force: f64,
    /// Largest displacement, m.
    pub peak_displacement: f64,
    /// Time from touching to leaving, s.
    pub contact_time: f64,
}

/// Drop of `mass` (kg) that touches the spring at `speed` (m/s): `E(δ) = m·v²/2`.
pub fn drop(law: &StiffnessLaw, mass: f64, speed: f64) -> Drop {
    let energy = 0.5 * mass * speed * speed;
    let peak_displacement = displacement_of_energy(law, energy);
    // T = 2∫dδ/√(2(E0 − E)/m); with δ = δmax·(1 − s²) the integrand is smooth at the turning point.
    let integrand = |s: f64| {
        let remaining = energy - law.energy(peak_displacement * (1.0 - s * s));
        4.0 * peak_displacement * s / (2.0 * remaining / mass).sqrt()
    };
    // Midpoint rule: the kink of the power law at δ = 0 is far weaker than its error of 1e-7.
    const INTERVALS: usize = 2000;
    let h = 1.0 / INTERVALS as f64;
    let contact_time = h * (0..INTERVALS).map(|i| integrand((i as f64 + 0.5) * h)).sum::<f64>();
    Drop { peak_force: law.force(peak_displacement), peak_displacement, contact_time }
}

/// Displacement (m) at which the spring stores `energy` (J), by bisection.
pub fn displacement_of_energy(law: &StiffnessLaw, energy: f64) -> f64 {
    if energy <= 0.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1e-6);
    while law.energy(high) < energy && high < 1e6 {
        (low, high) = (high, 2.0 * high);
    }
    bisection(low, high, |displacement| !(law.energy(displacement) < energy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn fall(height: f64) -> f64 {
        (2.0 * 9.81 * height).sqrt()
    }

    /// Source: independent energy solutions, printed to four digits (kN, mm, ms).
    #[test]
    fn agrees_with_printed_drops() {
        // Half a unit of the fourth digit of 1.489 and of 0.1478.
        const PRINTED: f64 = 4e-4;
        let hertz = StiffnessLaw { a: 0.0, b: 1.5 * 9.239e10f64.powf(2.0 / 3.0) * 10.0, c: 1.0 / 3.0 };
        let published = StiffnessLaw::published();
        for (law, mass, height, kilonewton, millimetre, millisecond) in [
            (hertz, 283.0, 0.010, 309.8, 0.2240, Some(1.489)),
            (hertz, 1000.0, 0.001, 165.96, 0.1478, Some(3.105)),
            (hertz, 1000.0, 0.010, 660.7, 0.3712, Some(2.466)),
            (published, 283.0, 0.010, 235.0, 0.2716, None),
            (published, 1000.0, 0.001, 130.45, 0.1728, None),
            (published, 1000.0, 0.010, 480.4, 0.4701, None),
        ] {
            let result = drop(&law, mass, fall(height));
            assert!((result.peak_force / (kilonewton * 1e3) - 1.0).abs() < PRINTED, "{result:?}");
            assert!((result.peak_displacement / (millimetre * 1e-3) - 1.0).abs() < PRINTED, "{result:?}");
            if let Some(time) = millisecond {
                assert!((result.contact_time / (time * 1e-3) - 1.0).abs() < PRINTED, "{result:?}");
            }
        }
    }

    /// Limit: a linear spring is left after half a period, with peak force v·√(k·m).
    #[test]
    fn linear_spring_is_left_after_half_a_period() {
        // Midpoint rule with 2000 intervals and 60 halvings.
        const DISCRETISATION: f64 = 1e-6;
        let law = StiffnessLaw { a: 1e8, b: 0.0, c: 0.0 };
        let result = drop(&law, 400.0, 0.5);
        assert!((result.contact_time / (PI * (400.0 / 1e8f64).sqrt()) - 1.0).abs() < DISCRETISATION);
        assert!((result.peak_force / (0.5 * (1e8f64 * 400.0).sqrt()) - 1.0).abs() < DISCRETISATION);
    }
}
