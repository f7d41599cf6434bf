//! Equilibria.

use super::*;
use railspring_profiles::monitor::Silent;

/// Condition of a chain of elements times rounding.
const ROUNDOFF: f64 = 1e-7;

/// Source: statics of a beam of two spans L under a force P in the middle of one: deflection there 23·P·L³/(1536·EI), moment there 13·P·L/64, over the middle support
/// −3·P·L/32. Goal: these (m, N·m), with the force at a node and inside an element, where the moment of the clamped element is added. Accuracy: ROUNDOFF; inside of an element
/// the deflection lacks that of the clamped element, P·h³/(192·EI), which is added here.
#[test]
fn a_beam_of_two_spans() {
    let (bending, span, force) = (6e6, 3.0, 1e5);
    for elements in [8, 20, 10, 6] {
        let mut track = on_two_supports(slender(bending, 60.0), 2.0 * span, elements);
        track.held.push(Held { of: Carrier::Rail, node: elements / 2, direction: Direction::Vertical });
        let dynamics = TrackDynamics::<2>::new(&track);
        let at = 0.5 * span;
        let rest = dynamics.at_rest(at, force).unwrap();
        let seen = |x: f64| dynamics.seen(&rest, Carrier::Rail, x, (at, force));
        let pitch = 2.0 * span / f64::from(elements as u32);
        let inside = if elements % 4 == 0 { 0.0 } else { force * pitch.powi(3) / (192.0 * bending) };
        for (found, expected) in [
            (seen(at).deflection + inside, 23.0 * force * span.powi(3) / (1536.0 * bending)),
            (seen(at).moment, 13.0 * force * span / 64.0),
            (seen(span).moment, -3.0 * force * span / 32.0),
            (seen(0.5 * at).moment, 13.0 * force * span / 128.0),
        ] {
            assert!((found / expected - 1.0).abs() < ROUNDOFF, "{elements}: {found:e} {expected:e}");
        }
    }
}

/// Source: beams on a Winkler bed without ends: deflection F·β/(2k) and moment F/(4β) under the force, β⁴ = k/(4EI), the rail's ends free. Goal: both (m, N·m). DISCRETISATION: the bed's force inside
/// of an element, (βh)⁴ and less; ENDS: e^(−βL/2) = 7e-6.
#[test]
fn a_rail_on_a_bed() {
    const DISCRETISATION: f64 = 1e-4;
    let (bed, bending, force) = (5e7, 6.38e6, 1e5);
    let mut track = on_two_supports(slender(bending, 60.2), 20.0, 400);
    track.held.clear();
    track.bed = Some(kelvin(bed, 0.0));
    let beta = (bed / (4.0 * bending)).powf(0.25);
    let dynamics = TrackDynamics::<2>::new(&track);
    let rest = dynamics.at_rest(10.0, force).unwrap();
    let seen = dynamics.seen(&rest, Carrier::Rail, 10.0, (10.0, force));
    for (found, expected) in
        [(seen.deflection, force * beta / (2.0 * bed)), (seen.moment, force / (4.0 * beta))]
    {
        assert!((found / expected - 1.0).abs() < 10.0 * DISCRETISATION, "{found:e} {expected:e}");
    }
    assert!((seen.deflection / (force * beta / (2.0 * bed)) - 1.0).abs() < DISCRETISATION);
}

/// Goal: a wheel with a mass above that starts in balance on sleepers, or on a rail on a bridge, stays there: the force (N) is the weight and nothing moves (m) in 200 steps. The law is the published one. Accuracy: ROUNDOFF.
#[test]
fn what_is_in_balance_stays() {
    let wheel = SprungWheel { mass: 900.0, above: 5000.0, suspension: kelvin(1.2e6, 4e4) };
    for track in [on_sleepers(40, 0.3), bridge::on_a_bridge(40, 0.3, 1e8)] {
        let wheels = Wheels { law: StiffnessLaw::published().into(), ..linear(1.0) };
        let case = TrackCase {
            running: Running::Wheel(wheel),
            force: TimeFunction::constant(2e4),
            probes: vec![probe(Carrier::Rail, 5.7)],
            ..case(Some(track), 0.0, wheels, Way::uniform(5.71, 0.0, 0.0, 1.0), [200.0, 0.1])
        };
        let run = run(&case);
        let weight = 5900.0 * 9.81 + 2e4;
        let first = &run.rows[0];
        assert!(first.probes[0].deflection > 1e-5, "{first:?}");
        for row in &run.rows {
            assert!((row.wheels[0].force / weight - 1.0).abs() < ROUNDOFF, "{row:?}");
            let moved = (row.probes[0].deflection - first.probes[0].deflection).abs()
                + (row.wheels[0].z - first.wheels[0].z).abs();
            assert!(moved < ROUNDOFF * first.probes[0].deflection, "{row:?}");
        }
    }
}

/// Goal: where there is no equilibrium it is said why: a rail that nothing holds, one on dampers alone, one that turns about a pin, a mass above without a spring, a wheel that is lifted, a start off the rail.
#[test]
fn a_balance_that_there_is_not_is_named() {
    let way = Way::uniform(3.0, 0.0, 0.0, 1.0);
    let sleepers = || on_sleepers(20, 0.3);
    let mut free = sleepers();
    free.layers.clear();
    let damped = |elements: usize, pitch: f64| {
        let mut track = on_sleepers(elements, pitch);
        let loose = |layers: &mut Layers| layers.below = Some((150.0, kelvin(0.0, 5e4)));
        track.layers.iter_mut().for_each(loose);
        track
    };
    let mut on_one_pin = sleepers();
    on_one_pin.layers.clear();
    on_one_pin.held.push(Held { of: Carrier::Rail, node: 4, direction: Direction::Vertical });
    let of = |track: Track| case(Some(track), 900.0, linear(1e9), way.clone(), [10.0, 0.01]);
    let hangs = SprungWheel { mass: 900.0, above: 5000.0, suspension: kelvin(0.0, 4e4) };
    let hanging = TrackCase { running: Running::Wheel(hangs), ..of(sleepers()) };
    let lifted = TrackCase { force: TimeFunction::constant(-2e4), ..of(sleepers()) };
    let off = TrackCase { way: Way::uniform(7.0, 0.0, 0.0, 1.0), ..of(sleepers()) };
    for (case, said) in [
        (of(free), "supports hold vertically"),
        (of(damped(20, 0.3)), "supports hold vertically"),
        // of so many elements rounding leaves no stiffness at all
        (of(damped(120, 0.1)), "supports hold vertically"),
        (of(on_one_pin), "supports hold vertically"),
        (hanging, "spring under the mass above"),
        (lifted, "press every wheel"),
        (off, "on the rail"),
    ] {
        let error = case.run(&Silent).unwrap_err().to_string();
        assert!(error.starts_with("start") && error.contains(said), "{error}");
    }
}

/// Goal: a run whose wheel comes to the end of the rail ends there with its rows, and says when (s).
#[test]
fn the_end_of_the_rail_ends_a_run() {
    let way = Way::uniform(5.0, 10.0, 0.0, 1.0);
    let case = case(Some(on_sleepers(20, 0.3)), 900.0, linear(1e9), way, [200.0, 0.2]);
    let run = run(&case);
    assert_eq!(run.rows.len(), 101);
    let TrackEnding::RailEnd { time } = run.ending else { panic!("{:?}", run.ending) };
    assert!((time - 0.101).abs() < 1e-12, "{time}");
}
