//! S1002 pressed on UIC60 and 60E1 against a half-space program and the published law.

use nalgebra::Vector3;
use railspring_calibrate::calibration::{
    ContactField, DOWNWARDS, Enforcement, LoadPoint, PatchValues, Reference, WheelOnRail,
    calibrate_horizontal, calibrate_normal, press_loads,
};
use railspring_calibrate::contact::{
    FreeDirection, HalfSpace, PairingLimits, Problem, Surface, gaps, hub_response, pair, solve, total,
};
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{Pair, PairMeshes};
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::Superelement;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use std::sync::OnceLock;

struct Case {
    rail: &'static str,
    tape_diameter: f64,
    lateral_shift: f64,
    material: Material,
    enforcement: Enforcement,
}

/// Both bodies of a case in place, meshed as by default.
struct Bodies {
    pair: Pair,
    meshes: PairMeshes,
}

impl Bodies {
    fn new(case: &Case) -> Self {
        let track = TrackGeometry { lateral_shift: case.lateral_shift, ..TrackGeometry::standard() };
        let (rail, wheel) = (rail_section(case.rail), wheel_section("S1002", case.tape_diameter));
        let pair = Pair::new(rail.unwrap(), wheel.unwrap(), &track).unwrap();
        let meshes = pair.mesh(0.555, &MeshOptions::default()).unwrap();
        Self { pair, meshes }
    }

    fn rail_surface(&self) -> Surface<'_> {
        self.pair.rail_surface(&self.meshes.rail.contact)
    }

    fn wheel_surface(&self) -> Surface<'_> {
        self.pair.wheel_surface(&self.meshes.wheel.contact)
    }
}

/// Load points with the foot held, by reference, the patches, and the horizontal stiffness at the first load.
fn press(
    case: &Case,
    loads: &[f64],
    references: &[Reference],
) -> (Vec<Vec<LoadPoint>>, Vec<PatchValues>, f64) {
    let bodies = Bodies::new(case);
    let condense = |mesh, supports: Supports| {
        let system = System::new(mesh, case.material, Formulation::IncompatibleModes, &supports).unwrap();
        Superelement::new(system).unwrap()
    };
    let (rail_element, wheel_element) = rayon::join(
        || {
            condense(
                &bodies.meshes.rail,
                Supports { held: bodies.meshes.rail.foot.clone(), ..Default::default() },
            )
        },
        || {
            condense(
                &bodies.meshes.wheel,
                Supports { followers: bodies.meshes.wheel.bore.clone(), ..Default::default() },
            )
        },
    );
    let pair = WheelOnRail {
        bodies: railspring_calibrate::calibration::Bodies::Condensed {
            rail: &rail_element.compliance,
            wheel: &wheel_element.compliance,
            mirrored: false,
        },
        rail_surface: bodies.rail_surface(),
        wheel_surface: bodies.wheel_surface(),
        friction: 0.5,
        enforcement: case.enforcement,
        field: ContactField::Elements,
        materials: [case.material; 2],
        along: DOWNWARDS,
        beyond: OnceLock::new(),
    };
    let states = press_loads(&pair, loads, "press", &Silent).unwrap();
    let points = references
        .iter()
        .map(|&reference| calibrate_normal(&pair, &states, reference).unwrap().points)
        .collect();
    let horizontal = calibrate_horizontal(&pair, &loads[..1], &[], &Silent).unwrap();
    let patches = states.iter().map(|state| pair.patch(state).unwrap().values).collect();
    (points, patches, horizontal.stiffness)
}

/// Rows `[force N, tangent N/mm, area mm², largest pressure MPa]` of one set of the half-space program's table.
struct HalfSpaceTable(Vec<[f64; 4]>);

impl HalfSpaceTable {
    /// `None`, with a note, where the table is not there.
    fn read(set: &str) -> Option<Self> {
        let text = railspring_testing::facts_text("contact/normal_contact_S1002_UIC60_R460.csv")?;
        // columns: set, side, y_ws, fz, approach, kt, fn, pen, delta, y_rail, y_wheel, area, pmax, npatch, dx
        let row = |line: &str| {
            let c: Vec<&str> = line.split(',').collect();
            [3, 5, 11, 12].map(|i| c[i].parse().unwrap())
        };
        Some(Self(text.lines().filter(|l| l.contains(set)).map(row).collect()))
    }

    /// Ours over theirs: `[tangent N/m, area m², largest pressure Pa]`.
    fn ratios(&self, load: f64, ours: [f64; 3]) -> [f64; 3] {
        let units = [1e3, 1e-6, 1e6];
        std::array::from_fn(|i| ours[i] / (self.at(load, i + 1) * units[i]))
    }

    fn at(&self, load: f64, column: usize) -> f64 {
        let rows = &self.0;
        let i = rows.partition_point(|r| r[0] < load).clamp(1, rows.len() - 1);
        let t = (load - rows[i - 1][0]) / (rows[i][0] - rows[i - 1][0]);
        rows[i - 1][column] + t * (rows[i][column] - rows[i - 1][column])
    }
}

/// Source: CONTACT 25.2 (Vollebregt and Kalker), S1002 on UIC60 at 1:40, rolling radius 460 mm, half-spaces
/// of G = 82 GPa and ν = 0.28, cells of 0.1 mm. Loads are from 60 to 150 kN. The wheel is centred and 3 mm
/// away from the flange, where one region carries the load, and 3 mm towards it. Goal: tangent (N/m), area
/// (m²), largest pressure (Pa).
///
/// DISCRETISATION of contact points 2 by 1.5 mm apart. Tangent: what one point of thirty carries is 3 % of the slope at most,
/// with the program's own 0.2 % and the mesh's 2 % (against elements of half the size) 5 %. Area: points count whole, and
/// half a point, 0.9 mm, along a rim of 50 mm is 30 % of a patch of 150 mm²; half of it is 15 %, and the stiffer near field of
/// the mesh takes another row at the ends, 20 %. The largest pressure is a nodal value, 10 % on half-spaces and twice
/// that on the mesh; it is not compared where the patch lies over the jumps of curvature, where it peaks within a millimetre. Towards the flange
/// the load wanders, and rim and head roll under it: the tangent of the solids is 6 % off there, and that of half-spaces alone is compared.
#[test]
fn the_local_stiffness_is_that_of_a_half_space_program() {
    for (set, lateral_shift, compared) in
        [(",LEFT,3,", -3e-3, 3), (",RIGHT,0,", 0.0, 2), (",RIGHT,3,", 3e-3, 2)]
    {
        let Some(table) = HalfSpaceTable::read(set) else { return };
        let case = Case {
            rail: "UIC60",
            tape_diameter: 0.92,
            lateral_shift,
            material: Material { young: 209.92e9, poisson: 0.28, ..Material::STEEL },
            enforcement: Enforcement::Exact,
        };
        let loads = [60e3, 85e3, 120e3, 150e3];
        for (load, found) in loads.iter().zip(half_space(&case, &loads)) {
            let ratios = table.ratios(*load, found);
            println!(
                "{set} {:.0} kN, half-spaces: tangent, area, largest pressure {ratios:.3?}",
                load * 1e-3
            );
            for (ratio, limit) in ratios.iter().zip([0.05, 0.15, 0.10]).take(compared) {
                assert!((ratio - 1.0).abs() < limit, "half-spaces, {set} {load} N: {ratios:?}");
            }
        }
        let rolls = lateral_shift > 0.0;
        let (points, patches, _) = press(&case, &loads, &[Reference::Local]);
        for (p, patch) in points[0].iter().zip(&patches) {
            let ratios = table.ratios(p.force, [p.solid_tangent, patch.area, patch.max_pressure]);
            println!("{set} {:.0} kN, solids: tangent, area, largest pressure {ratios:.3?}", p.force * 1e-3);
            let of_solids = ratios.iter().zip([0.05, 0.20, 0.20]).take(compared).skip(usize::from(rolls));
            for (ratio, limit) in of_solids {
                assert!((ratio - 1.0).abs() < limit, "solids, {set} {} N: {ratios:?}", p.force);
            }
        }
    }
}

/// Tangent stiffness, contact area and largest pressure under each load, our pairing on half-spaces.
fn half_space(case: &Case, loads: &[f64]) -> Vec<[f64; 3]> {
    let bodies = Bodies::new(case);
    let points = pair(&bodies.rail_surface(), &bodies.wheel_surface(), PairingLimits { largest_gap: 0.2e-3 });
    let [rail, wheel] = HalfSpace::both(&case.material);
    let (compliance, free) = (total(&[&rail, &wheel], &points, 1), gaps(&points));
    loads
        .iter()
        .map(|load| {
            let hub = [FreeDirection { along: Vector3::z_axis(), force: -load }];
            let problem =
                Problem { points: &points, compliance: &compliance, free: &free, friction: 0.0, hub: &hub };
            let solution = solve(&problem, &vec![0.0; points.len()]).unwrap();
            let tangent =
                hub_response(&problem, &solution, &[Vector3::z_axis()], false).unwrap().stiffness[(0, 0)];
            let pressures = solution.forces.iter().zip(&points).map(|(f, point)| f / point.area);
            let carrying = points.iter().zip(&solution.forces).filter(|(_, f)| **f > 0.0);
            let area = carrying.map(|(point, _)| point.area).sum();
            [tangent, area, pressures.fold(0.0, f64::max)]
        })
        .collect()
}

/// Source: the published law (0.888e6 kN/m at 85 kN; the window 0.85e6 to 1.10e6 kN/m allows for another wheel body).
/// Goal: with the foot held, S1002 that touches the crown of 60E1 alone (4 mm away from the flange) lies in the window.
/// Centred it touches crown and gauge corner over 25 mm and is stiffer than the window, which MODEL, not mesh, explains: the
/// half-space program's local stiffness alone rises from 1.42e6 to 1.77e6 kN/m between the two positions.
#[test]
#[ignore = "a quarter of a minute: cargo long press"]
fn the_foot_stiffness_at_85_kn_is_near_the_published_law() {
    let window = 0.85e9..1.10e9;
    assert!(window.contains(&StiffnessLaw::published().tangent(85e3)));
    let tangent = |lateral_shift: f64, enforcement: Enforcement| {
        let case = Case {
            rail: "60E1",
            tape_diameter: 0.858,
            lateral_shift,
            material: Material::STEEL,
            enforcement,
        };
        let (points, _, horizontal) = press(&case, &[30e3, 60e3, 85e3, 110e3], &[Reference::Foot]);
        assert!(horizontal > 1e7 && horizontal < 1e9, "horizontal stiffness {horizontal}");
        points[0][2]
    };
    let crown = tangent(-4e-3, Enforcement::Exact);
    println!("crown alone: {:.4e} N/m", crown.solid_tangent);
    assert!(window.contains(&crown.solid_tangent), "{}", crown.solid_tangent);
    let centred = tangent(0.0, Enforcement::Exact);
    println!("centred: {:.4e} N/m", centred.solid_tangent);
    assert!(
        centred.solid_tangent > window.end && centred.solid_tangent < 1.25e9,
        "{}",
        centred.solid_tangent
    );
    // what the published springs let through, they give back by spreading the pressure
    let penalty = tangent(-4e-3, Enforcement::Penalty(1e9));
    println!(
        "published penalty: {:.4e} N/m, penetration {:.4}",
        penalty.solid_tangent, penalty.penalty_error
    );
    assert!((penalty.solid_tangent / crown.solid_tangent - 1.0).abs() < 0.05);
    assert!(penalty.penalty_error > 1e-3, "the published criterion does not hold on so coarse a mesh");
}
