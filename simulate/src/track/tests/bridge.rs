//! A rail on a bridge, with pads between.

use super::*;

/// A rail on pads (N/m) at every node; those of the first and last two nodes stand on the ground, the others on a bridge that its own ends carry.
pub fn on_a_bridge(elements: usize, pitch: f64, pad: f64) -> Track {
    let nodes = [2, elements - 2];
    let mut track = on_sleepers(elements, pitch);
    track.layers = (0..=elements)
        .map(|node| Layers {
            of: Carrier::Rail,
            x: node as f64 * pitch,
            direction: Direction::Vertical,
            upper: kelvin(pad, 1e3),
            below: None,
            onto: if (nodes[0]..=nodes[1]).contains(&node) { Onto::Bridge } else { Onto::Ground },
        })
        .collect();
    let beam = LineBeam { section: slender(4.0e9, 5000.0), damping: 1e-4, mass_damping: 0.0 };
    track.bridge = Some(Bridge { beam, nodes });
    track.held.extend(nodes.map(|node| Held { of: Carrier::Bridge, node, direction: Direction::Vertical }));
    track
}

/// Source: program VBI-2D, case A. Goal: a bridge of that case that carries a rail on stiff pads has the largest deflection (m) at its middle that the bridge alone has. MODEL: rail and bridge bend
/// together, 1.3e-4 of the bridge's stiffness, and 3e-3 of its mass, which moves the result by a quarter of that. Accuracy: MODEL.
#[test]
fn a_bridge_with_a_rail_on_it_is_the_bridge() {
    const MODEL: f64 = 2e-3;
    let mut track = on_a_bridge(44, 25.0 / 40.0, 1e12);
    track.bridge.as_mut().unwrap().beam = beam(slender(3.5e10 * 1.3901, 18358.0));
    let start = 2.0 * 25.0 / 40.0;
    let way = Way::uniform(start, 25.0, 0.0, 1.0);
    let case = TrackCase {
        probes: vec![probe(Carrier::Bridge, start + 12.5)],
        ..case(Some(track), 5750.0, linear(1.595e6), way, [4000.0, 1.0])
    };
    let largest = lowest(&run(&case), 0).probes[0].deflection;
    assert!((largest / 4.18545e-4 - 1.0).abs() < MODEL, "{largest:e}");
}

/// Source: statics. A force in the middle of a bridge that hardly bends goes through pads: the rail deflects against it as a beam on a Winkler bed of pad stiffness over their distance,
/// F·β/(2k), β⁴ = k/(4EI). The bridge deflects by F·L³/(48EI). Goal: both (m). DISCRETISATION: pads a twelfth of the characteristic length 1/β apart, a hundredth of a per cent; ENDS: e^(−βL/2) with L of 24 m.
/// MODEL: shear of the rail adds, which is left out here.
#[test]
fn a_force_goes_through_the_pads_into_the_bridge() {
    const DISCRETISATION: f64 = 1e-3;
    let (elements, pitch, pad, force) = (200, 0.12, 6e6, 1e5);
    let mut track = on_a_bridge(elements, pitch, pad);
    track.rail = beam(slender(6.38e6, 60.2));
    let stiffness = 4.0e12;
    track.bridge.as_mut().unwrap().beam = beam(slender(stiffness, 5000.0));
    let dynamics = TrackDynamics::<4>::new(&track);
    let middle = 12.0;
    let rest = dynamics.at_rest(middle, force).unwrap();
    let seen = |of| dynamics.seen(&rest, of, middle, (middle, force)).deflection;
    let bed = pad / pitch;
    let beta = (bed / (4.0 * 6.38e6)).powf(0.25);
    let expected = force * beta / (2.0 * bed);
    let of_bridge = seen(Carrier::Bridge);
    assert!(((seen(Carrier::Rail) - of_bridge) / expected - 1.0).abs() < DISCRETISATION, "{expected:e}");
    // the pads spread the force over a few metres of the bridge
    let bent = force * (196.0 * pitch).powi(3) / (48.0 * stiffness);
    assert!((of_bridge / bent - 1.0).abs() < 0.02, "{of_bridge:e} {bent:e}");
}
