//! Bodies of several materials beside their closed solutions: layers in series, in torsion, and between rigid circles.

use std::f64::consts::TAU;

use nalgebra::Point3;
use railspring_calibrate::mesh::{BlockOptions, HexMesh, SurfaceGrid, mesh_block};
use railspring_calibrate::solid::{
    Formulation, Material, Materials, MirrorHalf, Numbering, Supports, System, nodal_stress, von_mises,
};
use railspring_calibrate::superelement::{Superelement, body_key};
use railspring_profiles::field::InputField;

const RUBBER: Material = Material { young: 6e6, poisson: 0.49, density: 1200.0, damping: 0.0 };

/// A tube about the y axis with one element along it.
struct Tube {
    mesh: HexMesh,
    inner: Vec<usize>,
    outer: Vec<usize>,
    length: f64,
}

impl Tube {
    /// `around` elements around, rings of nodes at the `radii` (m); the contact surface is a single node in the middle of the wall.
    fn new(radii: &[f64], around: usize) -> Self {
        let (rings, length) = (radii.len(), 0.02);
        let node = |plane: usize, k: usize, ring: usize| (plane * around + k % around) * rings + ring;
        let place = |plane: usize, k: usize, ring: usize| {
            let (sin, cos) = (TAU * k as f64 / around as f64).sin_cos();
            Point3::new(radii[ring] * sin, (plane as f64 - 0.5) * length, radii[ring] * cos)
        };
        let every = || (0..2).flat_map(move |plane| (0..around).map(move |k| (plane, k)));
        let nodes = every().flat_map(|(plane, k)| (0..rings).map(move |ring| place(plane, k, ring)));
        let brick = |k: usize, ring: usize| {
            let face = |plane| {
                [(k, ring), (k, ring + 1), (k + 1, ring + 1), (k + 1, ring)]
                    .map(|(k, ring)| node(plane, k, ring))
            };
            let ([a, b, c, d], [e, f, g, h]) = (face(0), face(1));
            [a, b, c, d, e, f, g, h]
        };
        let hexes = (0..around).flat_map(|k| (0..rings - 1).map(move |ring| (k, ring)));
        let hexes = hexes.map(|(k, ring)| brick(k, ring)).collect();
        let on = |ring: usize| every().map(|(plane, k)| node(plane, k, ring)).collect();
        let middle = vec![node(0, 0, rings / 2)];
        let mesh = HexMesh {
            nodes: nodes.collect(),
            hexes,
            groups: Vec::new(),
            contact: SurfaceGrid { along_profile: vec![0.0], along_track: vec![0.0], nodes: middle },
            ends: Vec::new(),
            foot: Vec::new(),
            bore: Vec::new(),
        };
        Self { mesh, inner: on(0), outer: on(rings - 1), length }
    }

    /// Stiffness per length of the inner circle in one of its rigid motions (0 to 5: translations, rotations), the outer one held; nothing moves along
    /// the axis.
    fn stiffness(&self, materials: &[Material], element: Formulation, motion: usize) -> f64 {
        let mut master_free = [false; 6];
        master_free[motion] = true;
        let supports = Supports {
            held: self.outer.clone(),
            followers: self.inner.clone(),
            master: Point3::origin(),
            master_free,
        };
        let inside =
            (0..self.mesh.nodes.len()).filter(|v| !self.outer.contains(v) && !self.inner.contains(v));
        let plane: Vec<(usize, usize)> = inside.map(|v| (v, 1)).collect();
        let numbering = Numbering::new(&self.mesh, &supports).unwrap().with_at_rest(&plane);
        let system = System::with_numbering(&self.mesh, materials.to_vec(), element, numbering).unwrap();
        let compliance = Superelement::new(system).unwrap().compliance;
        let last = compliance.nrows() - 1;
        1.0 / (compliance[(last, last)] * self.length)
    }
}

/// A block whose upper half is of group 1, 0.05 × 0.04 × 0.03 m.
fn half_and_half() -> HexMesh {
    let mut mesh = mesh_block(&BlockOptions::uniform([0.05, 0.04, 0.03], [3, 3, 4])).unwrap();
    let upper = |hex: &[usize; 8]| hex.iter().map(|&v| mesh.nodes[v].z).sum::<f64>() > 8.0 * 0.015;
    mesh.groups = mesh.hexes.iter().map(|hex| usize::from(upper(hex))).collect();
    mesh
}

/// Source: a bar of two layers without Poisson's effect is a series of two springs, F·(h1/E1 + h2/E2)/A. Goal: displacement (m) of its face under
/// an even pressure, its mass (kg), and the stress in both layers (Pa), which is that of the load in each of the nodes that they share. Accuracy:
/// ROUNDOFF times a ratio of the moduli of 1e4.
#[test]
fn layers_are_in_series() {
    const ROUNDOFF: f64 = 1e-11;
    let [stiff, soft] = [(210e9, 7850.0), (21e6, 1200.0)].map(|(young, density)| Material {
        young,
        density,
        poisson: 0.0,
        damping: 0.0,
    });
    let mesh = half_and_half();
    let supports = Supports { held: mesh.foot.clone(), ..Supports::default() };
    let lower = mesh.group(mesh.hexes.iter().position(|hex| hex.contains(&mesh.foot[0])).unwrap());
    let (area, force) = (0.05 * 0.04, 1e3);
    for (materials, expected) in [([stiff, soft], [stiff, soft]), ([soft, soft], [soft, soft])] {
        let system =
            System::new(&mesh, materials.to_vec(), Formulation::IncompatibleModes, &supports).unwrap();
        let mass = system.nodal_mass().total();
        let exact: f64 = expected.iter().map(|m| m.density * area * 0.015).sum();
        assert!((mass / exact - 1.0).abs() < ROUNDOFF, "{mass} kg of {exact}");
        let element = Superelement::new(system).unwrap();
        // an even pressure on 3 × 3 faces: an inner node carries four quarters of a face
        let SurfaceGrid { along_profile, along_track, nodes } = &mesh.contact;
        let share = |i: usize, n: usize| if i == 0 || i + 1 == n { 0.5 } else { 1.0 } / (n - 1) as f64;
        let mut forces = vec![0.0; 3 * mesh.nodes.len()];
        for (at, &v) in nodes.iter().enumerate() {
            let (i, k) = (at / along_track.len(), at % along_track.len());
            forces[3 * v + 2] = force * share(i, along_profile.len()) * share(k, along_track.len());
        }
        let moved = element.solve(&forces);
        let exact = force / area * expected.iter().map(|m| 0.015 / m.young).sum::<f64>();
        for &v in nodes {
            assert!((moved[3 * v + 2].abs() / exact - 1.0).abs() < 1e4 * ROUNDOFF, "{}", moved[3 * v + 2]);
        }
        let (apart, of) = mesh.with_groups_apart();
        assert_eq!(apart.nodes.len(), mesh.nodes.len() + 16, "the nodes between both layers stand twice");
        let moved: Vec<f64> = of.iter().flat_map(|&v| moved[3 * v..3 * v + 3].to_vec()).collect();
        for stress in nodal_stress(&apart, &Materials::from(materials.to_vec()), &moved) {
            assert!((von_mises(stress) / (force / area) - 1.0).abs() < 1e4 * ROUNDOFF, "{stress:?}");
        }
    }
    assert_eq!(lower, usize::from(mesh.nodes[mesh.foot[0]].z > 0.015));
}

/// Source: circular shear, S.P. Timoshenko, J.N. Goodier, Theory of Elasticity (1970), art. 34: a tube of layers with G between a and b that is held
/// outside turns at its inner circle by T/(4π)·Σ(1/a² - 1/b²)/G per length. Goal: torsional stiffness (N) of steel between two rubbers, with both
/// elements; the order of the layers counts. Accuracy: DISCRETISATION, which falls with the square of the elements' size (slope 1.8 to 2.2); elements of
/// full integration, which do not bend, are ten times as far off.
#[test]
fn layers_turn_as_their_series() {
    const DISCRETISATION: [f64; 2] = [2e-3, 2e-2];
    let marks: [f64; 4] = [0.3, 0.33, 0.34, 0.38];
    let soft = Material { young: 3e6, ..RUBBER };
    let materials = [RUBBER, Material::STEEL, soft];
    let exact = 2.0 * TAU
        / marks
            .windows(2)
            .zip(&materials)
            .map(|(r, m)| (r[0].powi(-2) - r[1].powi(-2)) / m.shear_modulus())
            .sum::<f64>();
    let elements = [Formulation::IncompatibleModes, Formulation::FullIntegration];
    for (element, most) in elements.into_iter().zip(DISCRETISATION) {
        let error = |refined: usize| {
            let radii: Vec<f64> = (0..3 * refined)
                .map(|i| {
                    let (layer, part) = (i / refined, (i % refined) as f64 / refined as f64);
                    marks[layer] + part * (marks[layer + 1] - marks[layer])
                })
                .chain([marks[3]])
                .collect();
            let mut tube = Tube::new(&radii, 48 * refined);
            tube.mesh.groups = (0..tube.mesh.hexes.len()).map(|e| e % (radii.len() - 1) / refined).collect();
            (tube.stiffness(&materials, element, 4) / exact - 1.0).abs()
        };
        let [coarse, fine] = [error(1), error(2)];
        let slope = (coarse / fine).log2();
        assert!((1.8..2.2).contains(&slope), "{element:?}: {coarse:e} {fine:e}, slope {slope}");
        assert!(fine < most, "{element:?}: {fine:e}");
    }
}

/// Source: an elastic ring in plane strain between rigid circles of radii a and b, Kolosov's potentials with
/// φ = A ln z + B z²: a circle moves by δ under 2π(1+κ)·G·δ/(κ ln(b/a) - (b² - a²)/(κ(a² + b²))) per length,
/// κ = 3 - 4ν. With κ = 1 it is that of J.E. Adkins and A.N. Gent (1954) for rubber. Goal: the Poisson's
/// ratios for which elements of a layer of rubber serve, 30 mm on a radius of 330 mm. Printed is stiffness
/// over the exact one by the number of elements through the layer. Accuracy: within 0.3 % of the numbers that
/// `docs/meshes.md` has, beside which the limits of the study stand.
#[test]
fn nearly_incompressible_layers_lock_by_known_amounts() {
    const READING: f64 = 3e-3;
    let (a, b): (f64, f64) = (0.33, 0.36);
    // rows: elements through the layer 1, 2, 4, 8; columns: ν
    let ratios = [0.45, 0.49, 0.495, 0.499, 0.4995];
    let modes = [
        [0.982, 0.995, 1.024, 1.264, 1.566],
        [1.002, 1.008, 1.015, 1.064, 1.107],
        [1.001, 1.002, 1.004, 1.015, 1.025],
        [1.000, 1.001, 1.001, 1.004, 1.006],
    ];
    let full = [
        [0.988, 1.006, 1.035, 1.280, 1.586],
        [1.002, 1.009, 1.018, 1.107, 1.242],
        [1.001, 1.003, 1.006, 1.055, 1.145],
        [1.000, 1.001, 1.003, 1.042, 1.121],
    ];
    for (element, expected) in [(Formulation::IncompatibleModes, modes), (Formulation::FullIntegration, full)]
    {
        for (layers, expected) in [1, 2, 4, 8].into_iter().zip(expected) {
            let radii: Vec<f64> =
                (0..=layers).map(|i| a + (b - a) * f64::from(i) / f64::from(layers)).collect();
            let tube = Tube::new(&radii, 96);
            for (poisson, expected) in ratios.into_iter().zip(expected) {
                let material = Material { poisson, ..RUBBER };
                let kappa = 3.0 - 4.0 * poisson;
                let exact = TAU * (1.0 + kappa) * material.shear_modulus()
                    / (kappa * (b / a).ln() - (b * b - a * a) / (kappa * (a * a + b * b)));
                let found = tube.stiffness(&[material], element, 2) / exact;
                assert!(
                    (found - expected).abs() < READING,
                    "{element:?}, {layers} elements, {poisson}: {found:.4} instead of {expected}"
                );
            }
        }
    }
}

/// Goal: a body with other materials, and one with the same in other groups, is another body; one whose groups are of one material has the
/// compliance of that without groups, to the bit.
#[test]
fn groups_and_materials_belong_to_the_body() {
    let mesh = half_and_half();
    let plain = HexMesh { groups: Vec::new(), ..mesh.clone() };
    let supports = Supports { held: mesh.foot.clone(), ..Supports::default() };
    let element = Formulation::IncompatibleModes;
    let key = |mesh: &HexMesh, materials: &[Material]| {
        body_key(mesh, &Materials::from(materials.to_vec()), element, &supports)
    };
    let both = [Material::STEEL, RUBBER];
    let turned = HexMesh { groups: mesh.groups.iter().map(|g| 1 - g).collect(), ..mesh.clone() };
    let heavier = [Material::STEEL, Material { density: 1300.0, ..RUBBER }];
    let keys = [key(&mesh, &both), key(&turned, &both), key(&mesh, &heavier), key(&plain, &both[..1])];
    for (i, one) in keys.iter().enumerate() {
        assert!(keys[i + 1..].iter().all(|other| other != one), "{i}");
    }
    assert_eq!(key(&mesh, &both), keys[0]);
    let compliance = |mesh: &HexMesh, materials: &[Material]| {
        let system = System::new(mesh, materials.to_vec(), element, &supports).unwrap();
        Superelement::new(system).unwrap().compliance
    };
    let steel = [Material::STEEL; 2];
    assert_eq!(compliance(&mesh, &steel), compliance(&plain, &steel[..1]));
    assert_ne!(compliance(&mesh, &both), compliance(&plain, &steel[..1]));
}

/// Goal: a body whose groups are mirror images of themselves is taken by halves, with the groups of its elements; one whose groups are not is whole.
#[test]
fn halves_have_their_groups() {
    let mesh = half_and_half();
    let supports = Supports { held: mesh.foot.clone(), ..Supports::default() };
    let even = HexMesh {
        groups: Vec::new(),
        ..mesh_block(&BlockOptions::uniform([0.05, 0.04, 0.03], [4, 3, 4])).unwrap()
    };
    let middle = |hex: &[usize; 8], d: usize| hex.iter().map(|&v| even.nodes[v][d]).sum::<f64>() / 8.0;
    let by = |d: usize, at: f64| even.hexes.iter().map(|hex| usize::from(middle(hex, d) > at)).collect();
    let grouped = |groups: Vec<usize>| {
        let mesh = HexMesh { groups, ..even.clone() };
        let supports = Supports { held: mesh.foot.clone(), ..Supports::default() };
        MirrorHalf::of(&mesh, &supports).map(|half| half.mesh)
    };
    let half = grouped(by(2, 0.015)).expect("its own mirror image");
    assert_eq!((half.hexes.len(), half.groups.len()), (even.hexes.len() / 2, even.hexes.len() / 2));
    for (hex, group) in half.hexes.iter().zip(&half.groups) {
        let z = hex.iter().map(|&v| half.nodes[v].z).sum::<f64>() / 8.0;
        assert_eq!(*group, usize::from(z > 0.015));
    }
    assert!(grouped(by(0, 0.0)).is_none(), "the other side is of the other group");
    assert!(MirrorHalf::of(&mesh, &supports).is_none(), "an element lies across the plane");
}

/// Goal: groups without a material, two dampings, and a nearly incompressible layer of one element between others are refused.
#[test]
fn what_cannot_be_meshed_so_is_refused() {
    let mesh = half_and_half();
    let refused =
        |materials: &[Material]| Materials::from(materials.to_vec()).check(&mesh).unwrap_err().to_string();
    assert!(refused(&[Material::STEEL]).contains("1 for 2 groups"), "{}", refused(&[Material::STEEL]));
    let damped = Material { damping: 1e-6, ..RUBBER };
    assert!(refused(&[Material::STEEL, damped]).contains("one damping for the whole body"));
    let layers = |count: usize, poisson: f64| {
        let mut tube = Tube::new(&[0.3, 0.33, 0.345, 0.36, 0.4], 24);
        // rings of elements: steel, one or two of rubber, steel
        tube.mesh.groups =
            (0..tube.mesh.hexes.len()).map(|e| usize::from((1..=count).contains(&(e % 4)))).collect();
        let materials = Materials::from(vec![Material::STEEL, Material { poisson, ..RUBBER }]);
        let names = ["steel", "rubber"].map(String::from);
        materials.check_layers(&tube.mesh, &names, InputField::WheelMaterials)
    };
    let alone = layers(1, 0.499).unwrap_err().to_string();
    for part in [
        "wheel_materials = one element of \"rubber\" between others or held nodes around (",
        "two elements",
        "0.499",
    ] {
        assert!(alone.contains(part), "{part}: {alone}");
    }
    assert!(layers(2, 0.499).is_ok() && layers(1, 0.49).is_ok());
    // rubber on the bore, which is as rigid as another layer
    let on_bore = |count: usize| {
        let mut tube = Tube::new(&[0.3, 0.33, 0.345, 0.36, 0.4], 24);
        tube.mesh.groups = (0..tube.mesh.hexes.len()).map(|e| usize::from(e % 4 < count)).collect();
        tube.mesh.bore.clone_from(&tube.inner);
        let materials = Materials::from(vec![Material::STEEL, Material { poisson: 0.499, ..RUBBER }]);
        materials.check_layers(&tube.mesh, &["steel", "rubber"].map(String::from), InputField::WheelMaterials)
    };
    let alone = on_bore(1).unwrap_err().to_string();
    assert!(alone.contains("one element of \"rubber\""), "{alone}");
    assert!(on_bore(2).is_ok());
}
