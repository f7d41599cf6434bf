//! What calibration and laws by contact angle say that they are worth, against a finer computation.

use railspring_calibrate::calibration::{ContactField, Enforcement, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{
    AngleLaw, AngleSettings, COARSER, Change, Changes, CondensedPair, ContactConditions, Laws, Pair,
    PairBody, PressDirection, ShiftLaw, Solid, changed_by_shift, error_bands, horizontal_changes,
    law_by_shift,
};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile_file::{
    MeasuredPoint, MeasuredProfile, PrepareOptions, Prepared, ProfileFormat, ProfileKind, REPLICATES, prepare,
};
use railspring_profiles::section::{rail_section, rail_section_with_head, wheel_section};
use railspring_testing::Random;

/// N.
const LOADS: [f64; 4] = [10e3, 30e3, 60e3, 100e3];
/// N.
const PRELOADS: [f64; 2] = [20e3, 80e3];

fn pair() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap()
}

fn condensed(pair: &Pair, options: &MeshOptions) -> CondensedPair {
    let meshes = pair.mesh(0.555, options).unwrap();
    meshes.condense(pair, &PairBody::ALL, Material::STEEL, Formulation::IncompatibleModes, &Silent).unwrap()
}

fn contact(field: ContactField) -> ContactConditions {
    ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field }
}

fn laws(pair: &Pair, bodies: &CondensedPair, field: ContactField) -> Laws {
    bodies.press(pair, contact(field), &LOADS, &Silent).unwrap().laws().unwrap()
}

/// Elements of all sizes times `factor`, with a window of four elements at least.
fn sizes(factor: f64) -> MeshOptions {
    let window_half_length = f64::max(14e-3, 6e-3 * factor);
    MeshOptions { window_half_length, ..MeshOptions::default().refined(1.0 / factor) }
}

/// The same with contact zones that go so far down both faces that elements of 8 mm hold the contact on the flange.
fn sizes_for_the_flange(factor: f64) -> MeshOptions {
    let mut sizes = sizes(factor);
    (sizes.rail_zone.face_depth, sizes.wheel_zone.face_depth) = (27e-3, 27e-3);
    sizes
}

/// Source: the same pair on elements half as large. Goal: the largest band of each law, relative, holds the
/// largest change of displacement and of tangent to the finer computation. The band of the horizontal
/// stiffness holds its change at every preload. Where the mesh decides (foot and section), the band is at
/// most four times the change. Accuracy: an error of order p is the change with elements twice as large over
/// 2^p - 1, of which 1 - 2^-p shows here. The band is then twice the change for p = 1, four times for p = 2
/// and eight times for p = 3. Order 3 is that of the horizontal stiffness, for which the disc of the wheel
/// bends. There 5.2 times were measured: the coarser elements are as long as the disc is high. MODEL: the
/// approach alone is a difference of the motion of the hub and that of bodies, integrated over loads. It
/// changes by 0.1 % with the steps of that integral.
///
/// Bands of a mesh that is compared with itself have the part of the grid alone, and do not hold the change.
#[test]
#[ignore = "a quarter of a minute: cargo long error_band"]
fn the_band_holds_what_a_finer_computation_changes() {
    const MODEL: f64 = 1e-3;
    let pair = pair();
    let [coarser, base, fine] = [2.0 * COARSER, 2.0, 1.0].map(|factor| condensed(&pair, &sizes(factor)));
    let of_base = laws(&pair, &base, ContactField::Hybrid);
    let solid = Solid::of_calibration(&pair, &base, contact(ContactField::Hybrid), &of_base, &[]);
    let grid = solid.grid_changes(&Silent).unwrap();
    let [to_coarser, to_equal, to_fine] =
        [&coarser, &base, &fine].map(|bodies| solid.mesh_changes(bodies, &Silent).unwrap());
    let to_fine = error_bands(&solid.points, None, Some(&to_fine), None);
    let contact = contact(ContactField::Hybrid);
    let stiffness = |bodies: &CondensedPair| {
        let pressed = bodies.press(&pair, contact, &LOADS, &Silent).unwrap();
        pressed.horizontal(Reference::Beam, &PRELOADS, &Silent).unwrap().points
    };
    let points = stiffness(&base);
    let changes = horizontal_changes(&pair, &coarser, contact, Reference::Beam, &points, &Silent).unwrap();
    let half = changes.iter().fold(0.0, |largest: f64, change| largest.max(change.abs()));
    for (fine, point) in stiffness(&fine).iter().zip(&points) {
        let change = (fine.stiffness / point.stiffness - 1.0).abs();
        println!("horizontal at {} N: band {half:.5}, change {change:.5}", point.preload);
        assert!(change <= half && half < 8.0 * change, "{changes:?}, {change}");
    }
    let bands = error_bands(&solid.points, grid.as_ref(), Some(&to_coarser), None);
    let of_equal = error_bands(&solid.points, grid.as_ref(), Some(&to_equal), None);
    assert_eq!(bands.len(), 3);
    for ((band, change), equal) in bands.iter().zip(&to_fine).zip(&of_equal) {
        let (half, found, equal) = (band.largest(), change.largest(), equal.largest());
        println!("{:?}: band {half:.5?}, change {found:.5?}, of equal meshes {equal:.5?}", band.reference);
        let allowed = if band.reference == Reference::Local { MODEL } else { 0.0 };
        assert!(found.displacement <= half.displacement + allowed, "{band:?} {change:?}");
        assert!(found.tangent <= half.tangent, "{band:?} {change:?}");
        if band.reference != Reference::Local {
            assert!(half.displacement < 4.0 * found.displacement, "{band:?} {change:?}");
            assert!(equal.displacement < found.displacement, "{equal:?} {change:?}");
        }
    }
}

/// Goal: a contact on the nodes of the meshes has no part of a grid, and its band is that of the meshes.
#[test]
fn the_contact_between_elements_has_no_grid() {
    let pair = pair();
    let [coarser, base] = [2.0 * COARSER, 2.0].map(|factor| condensed(&pair, &sizes(factor)));
    let of_base = laws(&pair, &base, ContactField::Elements);
    let solid = Solid::of_calibration(&pair, &base, contact(ContactField::Elements), &of_base, &[]);
    let changed = solid.changed(Some(&coarser), &Silent).unwrap();
    assert!(changed.grid.as_ref().unwrap().is_none());
    let mesh = changed.mesh.unwrap();
    let bands = error_bands(&solid.points, None, mesh.as_ref(), None);
    // the staircase of nodes: tangents change by per cents from mesh to mesh
    assert!(bands.iter().all(|band| (0.01..1.0).contains(&band.largest().tangent)), "{bands:?}");
}

/// Loads and fixed loads of the laws by contact angle, N: their patches fit the windows of `sizes`.
const ANGLE_LOADS: [f64; 4] = [5e3, 10e3, 20e3, 30e3];
const FIXED: [f64; 3] = [10e3, 20e3, 30e3];

fn by_shift(pair: &Pair, bodies: &CondensedPair, settings: &AngleSettings, shifts: &[f64]) -> Vec<ShiftLaw> {
    let tape_ys: Vec<f64> = shifts.iter().map(|shift| pair.tape_y + shift).collect();
    law_by_shift(pair, bodies, settings, &tape_ys, &Silent).unwrap()
}

fn law(entry: &ShiftLaw) -> &AngleLaw {
    entry.law.as_ref().unwrap_or_else(|reason| panic!("tape circle at {} m: {reason}", entry.tape_y))
}

/// Source: the laws of the same pair on elements half as large. Goal: on the flange, at 6.5, 7 and 8 mm, for little and much friction, the
/// bands of displacement and tangent at every fixed load and with every reference are finite, and those of foot and section hold the
/// change to the finer laws, relative. Accuracy: as for the calibration; tangents, whose contact has one more cell or not from grid to
/// grid, have the largest band of their fixed loads.
#[test]
#[ignore = "a quarter of a minute: cargo long error_band"]
fn the_band_on_the_flange_holds_what_a_finer_computation_changes() {
    let pair = pair();
    let [coarser, base, fine] =
        [2.0 * COARSER, 2.0, 1.0].map(|factor| condensed(&pair, &sizes_for_the_flange(factor)));
    let shifts = [6.5e-3, 7e-3, 8e-3];
    for friction in [0.05, 0.6] {
        let contact = ContactConditions { friction, ..contact(ContactField::Hybrid) };
        let (direction, fixed_loads) = (PressDirection::Normal, &FIXED[..]);
        let settings =
            AngleSettings { contact, direction, loads: &ANGLE_LOADS, fixed_loads, stresses: false };
        let laws = by_shift(&pair, &base, &settings, &shifts);
        let finer = by_shift(&pair, &fine, &settings, &shifts);
        let changed = changed_by_shift(&pair, &base, Some(&coarser), &[], &settings, &laws, &Silent).unwrap();
        for (((shift, entry), finer), changed) in shifts.iter().zip(&laws).zip(&finer).zip(changed) {
            let case = format!("{shift} m, friction {friction}");
            let (points, changed) = changed.unwrap();
            let (grid, mesh) = (changed.grid.unwrap(), changed.mesh.unwrap());
            assert!(grid.is_some() && mesh.is_some(), "{case}");
            let bands = error_bands(&points, grid.as_ref(), mesh.as_ref(), None);
            assert_eq!(bands.len(), 3);
            for band in &bands {
                assert_eq!(band.points.len(), FIXED.len());
                let largest = band.largest();
                for (k, point) in band.points.iter().enumerate() {
                    let half = point.band();
                    let finite = |v: f64| v.is_finite() && v > 0.0 && v < 0.3;
                    assert!(finite(half.displacement) && finite(half.tangent), "{case}: {band:?}");
                    let [of_base, of_fine] =
                        [entry, finer].map(|entry| *law(entry).fixed[k].points.get(band.reference).unwrap());
                    assert_eq!(point.force, of_fine.force);
                    let change = Change {
                        displacement: of_fine.displacement / of_base.displacement - 1.0,
                        tangent: of_fine.solid_tangent / of_base.solid_tangent - 1.0,
                    };
                    println!("{case}, {:?}: {point:.5?}, to the finer {change:.5?}", band.reference);
                    if band.reference != Reference::Local {
                        assert!(
                            change.displacement.abs() <= half.displacement,
                            "{case}: {band:?} {change:?}"
                        );
                        assert!(change.tangent.abs() <= largest.tangent, "{case}: {band:?} {change:?}");
                    }
                }
            }
        }
    }
}

/// Source: the bands of the calibration. Goal: where the wheel of the calibration stands, pressed down, a law by angle has its bands at the
/// loads that both have pressed, relative, against foot and section. Accuracy: the part of the grid, without friction, is the same to
/// SOLVER, 1e-6. MODEL: the part of the meshes has other steps of the load, which are the history of friction; they change it by a
/// hundredth. (The approach alone, whose change by the meshes is a thirtieth of that, is integrated over those steps.)
#[test]
fn the_place_of_the_calibration_has_its_bands() {
    const SOLVER: f64 = 1e-6;
    const MODEL: f64 = 0.01;
    let pair = pair();
    let [coarser, base] = [2.0 * COARSER, 2.0].map(|factor| condensed(&pair, &sizes(factor)));
    let conditions = contact(ContactField::Hybrid);
    let of_base = laws(&pair, &base, ContactField::Hybrid);
    let solid = Solid::of_calibration(&pair, &base, conditions, &of_base, &[]);
    let calibration = solid.changed(Some(&coarser), &Silent).unwrap();
    let fixed_loads = &LOADS[1..];
    let settings = AngleSettings {
        contact: conditions,
        direction: PressDirection::Vertical,
        loads: &LOADS,
        fixed_loads,
        stresses: false,
    };
    let entries = by_shift(&pair, &base, &settings, &[0.0]);
    let changed = changed_by_shift(&pair, &base, Some(&coarser), &[], &settings, &entries, &Silent).unwrap();
    let [Some((points, changed))] = &changed[..] else { panic!("one band") };
    let (mesh, wanted) = (changed.mesh.as_ref().unwrap(), calibration.mesh.unwrap());
    let (mesh, wanted) = (mesh.as_ref().unwrap(), wanted.unwrap());
    let grids = [changed.grid.as_ref().unwrap().clone().unwrap(), calibration.grid.unwrap().unwrap()];
    for reference in [Reference::Foot, Reference::Beam] {
        let with = |changes: &Changes, load: usize| changes.get(reference).unwrap()[load];
        for (k, load) in [(0, 1), (2, 3)] {
            assert_eq!(points.get(reference).unwrap()[k], of_base.get(reference).unwrap().points[load]);
            let (found, wanted) = (with(mesh, k), with(&wanted, load));
            println!("{reference:?}: meshes {found:.5?}, calibration {wanted:.5?}");
            assert!((found.displacement / wanted.displacement - 1.0).abs() < MODEL, "{found:?} {wanted:?}");
            assert!((found.tangent / wanted.tangent - 1.0).abs() < MODEL, "{found:?} {wanted:?}");
        }
        let [found, wanted] = [with(&grids[0], 0), with(&grids[1], 1)];
        println!("{reference:?}: grid {found:.6?}, calibration {wanted:.6?}");
        assert!((found.displacement - wanted.displacement).abs() < SOLVER, "{found:?} {wanted:?}");
        assert!((found.tangent - wanted.tangent).abs() < SOLVER, "{found:?} {wanted:?}");
    }
}

/// Points of the head of 60E1 every 0.25 mm that scatter by 2 µm across it, prepared.
fn measured_head(head: &ProfileCurve, seed: u64) -> Prepared {
    const STEP: f64 = 0.25e-3;
    const SCATTER: f64 = 2e-6;
    let mut random = Random::new(seed);
    let count = (head.length() / STEP) as usize;
    let points = (0..=count).map(|i| {
        let s = STEP * i as f64;
        let point = head.point(s) + SCATTER * random.normal() * head.upward_normal(s);
        MeasuredPoint { point, line: i + 1, weight: 1.0 }
    });
    let profile = MeasuredProfile {
        name: "made".into(),
        format: ProfileFormat::Text,
        kind: ProfileKind::Rail,
        points: points.collect(),
        findings: Vec::new(),
        drawn: None,
        side_by_groove: false,
    };
    prepare(&profile, &PrepareOptions::default()).unwrap()
}

/// Source: the displacements and tangents of 30 measurements of the same head. The jackknife estimates their
/// standard deviation from each of them. Goal: the root mean square of the estimates is that standard
/// deviation, at every load, relative. Accuracy: STATISTICS, three times √(1/(2·29) + 1/(2·90)): the
/// deviation of 30 values, and 30 estimates of three degrees of freedom. QUADRATIC: the jackknife counts the
/// variance of quadratic terms in the scatter twice (Efron and Stein, The jackknife estimate of variance,
/// 1981). An estimate is then √2 too large at most. Here the tangent at 10 kN, where two regions touch, is
/// too large by 1.55.
#[test]
#[ignore = "a quarter of a minute: cargo long error_band"]
fn the_scatter_of_measurements_is_in_the_band() {
    const STATISTICS: f64 = 0.45;
    const QUADRATIC: f64 = std::f64::consts::SQRT_2;
    const COUNT: u64 = 30;
    let pair = pair();
    let track = TrackGeometry::standard();
    let bodies = condensed(&pair, &sizes(2.0));
    let conditions = contact(ContactField::Hybrid);
    let (mut found, mut estimates) = (Vec::new(), Vec::new());
    for seed in 0..COUNT {
        let measured = measured_head(&pair.rail.running, seed);
        let on = |curve: &ProfileCurve| {
            let section = rail_section_with_head(pair.rail.clone(), curve, &mut Vec::new()).unwrap();
            pair.with_surfaces(section, pair.wheel.clone(), &track).unwrap()
        };
        let own = on(&measured.curve);
        let replicates: Vec<Pair> = measured.replicates.iter().map(on).collect();
        assert_eq!(replicates.len(), REPLICATES);
        let laws = laws(&own, &bodies, ContactField::Hybrid);
        let solid = Solid::of_calibration(&own, &bodies, conditions, &laws, &replicates);
        let scatter = solid.scatter_changes(&Silent).unwrap().unwrap();
        // twice the standard uncertainty
        estimates
            .push(scatter.beam.iter().map(|c| [0.5 * c.displacement, 0.5 * c.tangent]).collect::<Vec<_>>());
        found.push(laws.beam.points.iter().map(|p| [p.displacement, p.solid_tangent]).collect::<Vec<_>>());
    }
    let count = COUNT as f64;
    for load in 0..LOADS.len() {
        for part in 0..2 {
            let mean = found.iter().map(|all| all[load][part]).sum::<f64>() / count;
            let squares: f64 = found.iter().map(|all| (all[load][part] / mean - 1.0).powi(2)).sum();
            let deviation = (squares / (count - 1.0)).sqrt();
            let estimate = (estimates.iter().map(|all| all[load][part].powi(2)).sum::<f64>() / count).sqrt();
            println!("{} kN, {part}: {deviation:.5}, estimated {estimate:.5}", LOADS[load] / 1e3);
            let range = 1.0 - STATISTICS..QUADRATIC * (1.0 + STATISTICS);
            assert!(range.contains(&(estimate / deviation)), "{load} {part}: {deviation} {estimate}");
        }
    }
}
