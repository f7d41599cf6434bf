//! Two elastic rods of unequal length that collide, both free: Saint-Venant's impact.

use super::*;

/// Source: A. Barré de Saint-Venant (1867); Graff, section 2.4. A rod of the length L strikes one of 2·L at
/// rest, or is struck by it. The force is ρ·c·v·A/2 (N) for the time 2·L/c (s), in which a wave runs through
/// the shorter rod and back. Then the shorter rod has all of the momentum of its mass and speed that the
/// other one loses. The centres part with half of the speed (m/s) with which they met, whichever of them
/// moved. Half of the energy is left in waves of the longer rod. Goal: force, momentum of each rod (N·s),
/// speed at which the centres part. Accuracy: PLATEAU of the force, the front for what the waves bring back,
/// SOLVER for the sum of the momenta in every step.
#[test]
fn rods_of_unequal_length_part_with_half_of_their_speed() {
    let dt = LENGTH / wave_speed() / ELEMENTS as f64;
    for [lower, upper] in [[2, 1], [1, 2]] {
        let rod = |lengths: usize| bar(lengths as f64 * LENGTH, lengths * ELEMENTS);
        let rail = HexMesh { foot: vec![], ends: vec![], ..rod(lower) };
        let records = collide(
            Order::Full,
            [&rail, &upside_down(rod(upper))],
            steel(0.0),
            1e-6,
            &quiet(3 * ELEMENTS + 20, dt),
        );
        let (first, _) = contact_steps(&records);
        let wave = 2 * ELEMENTS;
        let plateau = &records[first + wave / 5..first + wave * 4 / 5];
        let off = largest(plateau.iter().map(|r| (r.force / (0.5 * wave_force()) - 1.0).abs()));
        assert!(off < PLATEAU, "{lower} {upper}: force {off}");
        let [below, above] = records[first + wave * 5 / 4].momentum.map(|m| m / (bar_mass() * SPEED));
        let start = upper as f64;
        let transferred = [below - 1.0, above - (start - 1.0)];
        assert!(
            transferred.iter().all(|off| off.abs() < front(ELEMENTS)),
            "{lower} {upper}: momentum {below} {above}"
        );
        let parting = below / lower as f64 - above / upper as f64;
        assert!((parting - 0.5).abs() < 1.5 * front(ELEMENTS), "{lower} {upper}: {parting}");
        let drift = largest(
            records
                .iter()
                .map(|r| ((r.momentum[0] + r.momentum[1]) / (start * bar_mass() * SPEED) - 1.0).abs()),
        );
        assert!(drift < SOLVER, "{drift:e}");
    }
}
