//! Forces and sprung masses that cross a rail on two supports, against the literature.

use std::f64::consts::PI;

use super::*;
use railspring_calibrate::analytic::beam::{Bending, Span};
use railspring_calibrate::beam::{BeamSection, End};

const GRAVITY: f64 = 9.81;

/// A simply supported span.
struct Bridge {
    bending: Bending,
    mass_per_length: f64,
    rotary_inertia: f64,
}

impl Bridge {
    /// Without shear and rotary inertia: E (Pa), I (m⁴), kg/m, length (m).
    fn slender(young: f64, inertia: f64, mass_per_length: f64, length: f64) -> Self {
        let bending_stiffness = young * inertia;
        let bending = Bending { length, bending_stiffness, shear_stiffness: f64::INFINITY };
        Self { bending, mass_per_length, rotary_inertia: 0.0 }
    }

    fn beam(&self, elements: usize) -> RailBeam {
        let Bending { length, bending_stiffness, shear_stiffness } = self.bending;
        let section = BeamSection {
            axial: 1e12,
            bending_y: bending_stiffness,
            bending_z: bending_stiffness,
            shear_y: shear_stiffness,
            shear_z: shear_stiffness,
            torsion: 1e12,
            mass: self.mass_per_length,
            rotary_y: self.rotary_inertia,
            rotary_z: self.rotary_inertia,
            polar: self.mass_per_length,
            centroid: [0.0; 2],
        };
        RailBeam::new(section, length, elements, 0.0, [End::Pinned; 2]).unwrap()
    }
}

/// Deflection downwards of the middle of the rail, m.
fn middle(dynamics: &RailDynamics, state: &RailState) -> f64 {
    deflection(dynamics, 0.5 * dynamics.beam.length(), state)
}

/// Deflection downwards at `x`, m.
fn deflection(dynamics: &RailDynamics, x: f64, state: &RailState) -> f64 {
    let SectionRows { element, rows: [_, z, _] } = &dynamics.section(x).section;
    -(0..2).map(|node| dot(&z[node], &state.displacements[element + node])).sum::<f64>()
}

/// Source: Frýba's series, chapter 1, with the shear branch for the Timoshenko beam. Goal: deflection (m) of
/// the middle of a beam on two supports under a constant force of 100 kN that crosses it, at ten times. Beams
/// are a rail of 4 m with shear and rotary inertia at 60 m/s, and a bridge of 25 m without either at 25 and
/// 83 m/s. They have 20 elements and 4000 steps. The force comes down and goes up again, so that what the
/// beam has in the end (J) is what drives the force. Accuracy: DISCRETISATION, 0.1 % of the largest
/// deflection. The scheme's period error is (ωΔt)²/12, 1e-4 for the first modes. Inside an element its own
/// deflection under the force is missing, 1/20³. ROUNDOFF of 4000 steps, over the force times the largest
/// deflection.
#[test]
fn a_moving_force_matches_the_series() {
    const DISCRETISATION: f64 = 1e-3;
    const ROUNDOFF: f64 = 1e-7;
    let rail = Bridge {
        bending: Bending { length: 4.0, bending_stiffness: 6.38e6, shear_stiffness: 2.43e8 },
        mass_per_length: 60.2,
        rotary_inertia: 0.2385,
    };
    let bridge = || Bridge::slender(3.5e10, 1.3901, 18358.0, 25.0);
    for (bridge, speed) in [(rail, 60.0), (bridge(), 25.0), (bridge(), 300.0 / 3.6)] {
        let (steps, force, beam) = (4000, 1e5, bridge.beam(20));
        let Bridge { bending, mass_per_length, rotary_inertia } = bridge;
        let span = Span { bending, mass_per_length, rotary_inertia };
        let dynamics = RailDynamics::new(&beam, 0.0);
        let dt = beam.length() / speed / f64::from(steps);
        let part = dynamics.over(&Newmark::new(dt, 0.0)).unwrap();
        let mut state = dynamics.start(&RailLoad { x: 0.0, torsion: 0.0 }, Vector3::zeros()).unwrap();
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        let (mut driven, mut stored) = (0.0, 0.0);
        for step in 1..=steps {
            let time = f64::from(step) * dt;
            let load = RailLoad { x: speed * time, torsion: 0.0 };
            let next = part.advance(&state, &load, &[0.0, -force, 0.0]);
            let forces = if step == 1 { [0.0, -force] } else { [-force; 2] };
            let forces = forces.map(|force| Vector3::new(0.0, force, 0.0));
            driven += dynamics.driven([&state, &next], [Matrix3::identity(); 2], forces);
            let energy = dynamics.energy(&state, &next, 0.0, dt);
            stored = energy.kinetic + energy.elastic;
            state = next;
            if step % 400 == 0 {
                let exact = span.moving_force_deflection(force, speed, 0.5 * beam.length(), time, 200);
                worst = worst.max((middle(&dynamics, &state) - exact).abs());
                largest = largest.max(exact);
            }
        }
        assert!(worst < DISCRETISATION * largest, "{speed} m/s: {worst:e} of {largest:e}");
        let all = force * largest;
        assert!(
            stored > 1e-4 * all && (driven - stored).abs() < ROUNDOFF * all,
            "{driven} {stored} of {all}"
        );
    }
}

/// A mass on spring and damper that crosses a bridge with a rise of its surface.
struct Crossing {
    bridge: Bridge,
    stiffness: f64,
    damping: f64,
    /// Height of the surface beyond the ramp, which rises from a third of the length to its half, m.
    rise: f64,
    speed: f64,
    acceleration: f64,
}

/// What was seen of a crossing, one value a step.
#[derive(Default)]
struct Seen {
    time: Vec<f64>,
    place: Vec<f64>,
    /// Deflection of the middle, m.
    middle: Vec<f64>,
    /// Acceleration of the mass downwards, m/s², and force on the bridge, N.
    acceleration: Vec<f64>,
    force: Vec<f64>,
}

const MASS: f64 = 5750.0;
const STIFFNESS: f64 = 1.595e6;

impl Crossing {
    fn height(&self, x: f64) -> f64 {
        let length = self.bridge.bending.length;
        self.rise * ((x / length - 1.0 / 3.0) * 6.0).clamp(0.0, 1.0)
    }

    /// The mass starts in balance over the first support. The damper feels the change of its length over a step, an error of first order in the length
    /// of the step.
    fn run(&self, steps: usize) -> Seen {
        let beam = self.bridge.beam(40);
        let dynamics = RailDynamics::new(&beam, 0.0);
        let (length, v, a) = (beam.length(), self.speed, self.acceleration);
        let duration = 2.0 * length / (v + (v * v + 2.0 * a * length).sqrt());
        let dt = duration / steps as f64;
        let scheme = Newmark::new(dt, 0.0);
        let part = dynamics.over(&scheme).unwrap();
        let start = RailLoad { x: 0.0, torsion: 0.0 };
        let (mut state, mut next) = (dynamics.start(&start, Vector3::zeros()).unwrap(), RailState::default());
        let weight = MASS * GRAVITY;
        let mut mass = Motion { u: weight / self.stiffness, ..Motion::default() };
        let mut shortened = mass.u;
        let mut seen = Seen::default();
        for step in 1..=steps {
            let time = step as f64 * dt;
            let x = (v * time + 0.5 * a * time * time).min(length);
            let own = 1.0 / (MASS * scheme.acceleration);
            let free = own * (weight + MASS * scheme.inertia(&mass));
            let step = part.predict(&state, &RailLoad { x, torsion: 0.0 }, &mut next);
            // directions 2 and down are opposite
            let of_beam = -step.free()[1];
            let flexibility = own + step.flexibility()[(1, 1)];
            let per_length = self.damping / dt;
            let carried = free - of_beam + self.height(x) + flexibility * per_length * shortened;
            let now = carried / (1.0 + flexibility * (self.stiffness + per_length));
            let force = self.stiffness * now + per_length * (now - shortened);
            step.finish(&[0.0, -force, 0.0]);
            mass = scheme.advance(&mass, free - own * force);
            std::mem::swap(&mut state, &mut next);
            shortened = now;
            seen.time.push(time);
            seen.place.push(x);
            seen.middle.push(middle(&dynamics, &state));
            seen.acceleration.push(mass.a);
            seen.force.push(force);
        }
        seen
    }
}

impl Seen {
    /// The middle at a share of the time, m.
    fn at(&self, share: f64) -> f64 {
        self.middle[(share * self.middle.len() as f64).round() as usize - 1]
    }

    /// Largest deflection of the middle, m, with place (m) and time (s).
    fn largest(&self) -> (f64, f64, f64) {
        let most = (0..self.middle.len()).max_by(|&i, &j| self.middle[i].total_cmp(&self.middle[j])).unwrap();
        (self.middle[most], self.place[most], self.time[most])
    }
}

fn bounds(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)])
}

/// Source: program VBI-2D (cases A to A4): a mass of 5750 kg on a spring of 1.595e6 N/m crosses a bridge of
/// 25 m at 25 m/s, its weight on the bridge. A2 has a ramp of 10 mm. A3 has a damper of 4e5 N·s/m and the
/// ramp. A4 also gains 10 m/s². Goal: deflection (m) of the middle at a quarter, half and three quarters of a
/// second, and the largest with the place (m) or the time (s) at which it is reached. 40 elements, 20,000
/// steps. Accuracy: DISCRETISATION, that of the program: 0.1 % of the largest deflection. MODEL: 0.2 % where
/// a damper drives over a kink. The source prints neither its step nor whether its damper feels the slope of
/// the bridge, which changes 0.05 %. The place of a maximum, which is flat, is found to 1 % of the length.
#[test]
fn a_sprung_mass_crosses_as_in_vbi_2d() {
    const DISCRETISATION: f64 = 1e-3;
    const MODEL: f64 = 2e-3;
    let crossing = |rise, damping, acceleration| {
        let bridge = Bridge::slender(3.5e10, 1.3901, 18358.0, 25.0);
        Crossing { bridge, stiffness: STIFFNESS, damping, rise, speed: 25.0, acceleration }.run(20_000)
    };
    let seen = crossing(0.0, 0.0, 0.0);
    for (share, expected) in [(0.25, 2.5643e-4), (0.5, 3.6733e-4), (0.75, 2.4006e-4)] {
        let found = seen.at(share);
        assert!((found - expected).abs() < DISCRETISATION * 4.18545e-4, "{share} s: {found:e} {expected:e}");
    }
    for (case, seen, expected, place, accuracy) in [
        ("A", seen, 4.18545e-4, Some(10.90), DISCRETISATION),
        ("A2", crossing(0.01, 0.0, 0.0), 4.6721e-4, Some(11.35), DISCRETISATION),
        ("A3", crossing(0.01, 4e5, 0.0), 4.6260e-4, Some(10.60), MODEL),
        ("A4", crossing(0.01, 4e5, 10.0), 4.6912e-4, None, MODEL),
    ] {
        let (largest, x, time) = seen.largest();
        assert!((largest / expected - 1.0).abs() < accuracy, "{case}: {largest:e} {expected:e}");
        match place {
            Some(place) => assert!((x - place).abs() < 0.01 * 25.0, "{case}: {x}"),
            None => assert!((time - 0.414).abs() < 0.01 * 0.414, "{case}: {time}"),
        }
    }
}

/// Source: an independent calculation with the parameters of Yang and Yau's example: E 2.87e9 Pa, I 2.90 m⁴, 2303 kg/m, 25 m, the same mass and spring at 100 km/h. Goal:
/// deflection (m) of the middle at a quarter, half and three quarters of the crossing, the largest and its place (m); acceleration (m/s²)
/// of the mass and the force (N) on the bridge. Accuracy: DISCRETISATION 0.1 %, of the largest where it is one of a history.
#[test]
fn a_sprung_mass_crosses_as_in_yang_and_yau() {
    const DISCRETISATION: f64 = 1e-3;
    let bridge = Bridge::slender(2.87e9, 2.90, 2303.0, 25.0);
    let first = PI / 2.0 * (2.87e9 * 2.90 / 2303.0_f64).sqrt() / 25.0_f64.powi(2);
    assert!((first / 4.778 - 1.0).abs() < DISCRETISATION, "another bridge: {first} Hz");
    let crossing = Crossing {
        bridge,
        stiffness: STIFFNESS,
        damping: 0.0,
        rise: 0.0,
        speed: 100.0 / 3.6,
        acceleration: 0.0,
    };
    let seen = crossing.run(20_000);
    let (largest, place, _) = seen.largest();
    let [least, most] = bounds(&seen.force);
    let [down, up] = bounds(&seen.acceleration);
    for (found, expected, scale) in [
        (seen.at(0.25), 1.3985e-3, 2.4073e-3),
        (seen.at(0.5), 2.0133e-3, 2.4073e-3),
        (seen.at(0.75), 1.3132e-3, 2.4073e-3),
        (largest, 2.4073e-3, 2.4073e-3),
        (place, 10.31, 10.31),
        (least, 55.590e3, 57e3),
        (most, 57.258e3, 57e3),
        (-down, 0.1480, 0.1480),
        (up, 0.1422, 0.1422),
    ] {
        assert!((found - expected).abs() < DISCRETISATION * scale, "{found:e} {expected:e}");
    }
}
