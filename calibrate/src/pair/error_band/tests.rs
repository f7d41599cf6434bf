//! Changes, and the bands that they add up to.

use super::*;
use crate::law::StiffnessLaw;

/// ROUNDOFF: some sums and products of numbers of order one.
const ROUNDOFF: f64 = 1e-12;

/// A made-up solid at four loads, displacement and tangent times the given factors at the last load.
fn points(displacement: f64, tangent: f64) -> SolidPoints {
    let of_a_reference = {
        let law = StiffnessLaw::published();
        let point = |force: f64| LoadPoint {
            force,
            displacement: law.displacement(force) * if force > 80e3 { displacement } else { 1.0 },
            solid_tangent: law.tangent(force) * if force > 80e3 { tangent } else { 1.0 },
            local_compliance: 0.0,
            wheel_compliance: 0.0,
            rail_compliance: 0.0,
            sliding_compliance: 0.0,
            penalty_error: 0.0,
            active_points: 0,
        };
        [10e3, 40e3, 70e3, 100e3].map(point).to_vec()
    };
    ByReference {
        foot: Some(of_a_reference.clone()),
        beam: of_a_reference.clone(),
        local: of_a_reference,
        half_spaces: None,
    }
}

/// Goal: the first and the last load are among those of the halved grid, none twice, and all where they are few.
#[test]
fn the_loads_of_the_halved_grid_span_the_range() {
    for (count, most) in (1..60).flat_map(|count| [(count, 2), (count, 3), (count, LOADS_HALVED)]) {
        let among = spread(count, most);
        assert_eq!((among.len(), among[0], among[among.len() - 1]), (count.min(most), 0, count - 1));
        assert!(among.windows(2).all(|pair| pair[0] < pair[1]), "{among:?}");
    }
}

/// Goal: changes of opposite sign do not take each other's place in the band; a part that is missing adds nothing; the largest
/// is that of all loads, relative. Accuracy: ROUNDOFF.
#[test]
fn the_band_is_the_sum_of_the_sizes_of_the_changes() {
    let base = points(1.0, 1.0);
    let to = |other| changes(&base, &[0, 1, 2, 3], &base, &other);
    let (mesh, grid) = (to(points(1.01, 0.97)), to(points(0.996, 1.02)));
    let near = |a: f64, b: f64| (a - b).abs() < ROUNDOFF;
    for (bands, displacement, tangent) in [
        (error_bands(&base, Some(&grid), Some(&mesh), None), 0.014, 0.05),
        (error_bands(&base, None, Some(&mesh), None), 0.01, 0.03),
        (error_bands(&base, Some(&grid), None, None), 0.004, 0.02),
        (error_bands(&base, None, None, Some(&grid)), 0.004, 0.02),
        (error_bands(&base, None, None, None), 0.0, 0.0),
    ] {
        for band in bands {
            let (largest, first) = (band.largest(), band.points[0].band());
            assert!(near(largest.displacement, displacement) && near(largest.tangent, tangent), "{band:?}");
            assert!(near(first.displacement, 0.0) && near(first.tangent, 0.0), "{band:?}");
            assert_eq!(band.points.len(), 4);
        }
    }
}

/// Source: the changes at the loads that were pressed. Goal: at a load between two of those the larger of the two, relative. Accuracy:
/// ROUNDOFF.
#[test]
fn between_two_loads_the_larger_change_counts() {
    let (base, other) = (points(1.0, 1.0), points(1.01, 0.97));
    let among = [0, 2, 3];
    let of = |all: &SolidPoints| all.map(|all| among.map(|load| all[load]).to_vec());
    let wanted = [[0.0; 2], [0.0; 2], [0.0; 2], [0.01, -0.03]];
    for (_, change) in changes(&base, &among, &of(&base), &of(&other)).iter() {
        for (found, [displacement, tangent]) in change.iter().zip(wanted) {
            assert!((found.displacement - displacement).abs() < ROUNDOFF, "{change:?}");
            assert!((found.tangent - tangent).abs() < ROUNDOFF, "{change:?}");
        }
    }
    // all but the first are between the first and the last, or beyond an only one, which is the last
    for (among, first) in [(vec![0, 3], 1), (vec![3], 0)] {
        let of = |all: &SolidPoints| all.map(|all| among.iter().map(|&load| all[load]).collect());
        for (_, change) in changes(&base, &among, &of(&base), &of(&other)).iter() {
            for found in &change[first..] {
                assert!((found.displacement - 0.01).abs() < ROUNDOFF, "{change:?}");
                assert!((found.tangent + 0.03).abs() < ROUNDOFF, "{change:?}");
            }
        }
    }
    let beyond = changes(&other, &[0], &of(&base), &of(&base));
    let all: Vec<&Change> = beyond.iter().flat_map(|(_, changes)| changes).collect();
    assert!(all.len() == 12 && all.iter().all(|c| c.displacement.abs() < ROUNDOFF), "{beyond:?}");
}
