//! The meshes of the standard bodies: volume, quality, contact grid, node sets.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::super::faces::FACES;
use super::super::{Quality, quality};
use super::*;
use railspring_profiles::placement::{TrackGeometry, place_rail};
use railspring_profiles::section::{body_of_revolution, rail_section, wheel_section};

/// Rounding of sums over 20 000 elements, relative.
const ROUNDOFF: f64 = 1e-11;
/// Position on the curve, m: the sum of rounding in the transformation, far below 1 nm.
const ON_CURVE: f64 = 1e-9;
/// Section area with straight edges of length c on arcs of radius R: c²/(12 R)
/// per unit of outline. With c = 0.4 R that is 0.013 R: on the 0.4 m of arcs of
/// a wheel (R = 30 mm) 0.16e-3 m² of 23e-3 m² (0.7 %), on those of a rail less than 0.2 %.
const DISCRETISATION_RAIL: f64 = 2e-3;
const DISCRETISATION_WHEEL: f64 = 7e-3;
const LENGTH: f64 = 0.555;

fn rail() -> (RailSection, PlacedRail, HexMesh) {
    let section = rail_section("60E1").unwrap();
    let placed = place_rail(&section, &TrackGeometry::standard()).unwrap();
    let mesh = mesh_rail(&section, &placed, LENGTH, &MeshOptions::default()).unwrap();
    (section, placed, mesh)
}

fn wheel() -> (WheelSection, HexMesh) {
    let section = wheel_section("S1002", 0.858).unwrap();
    let mesh = mesh_wheel(&section, &MeshOptions::default()).unwrap();
    (section, mesh)
}

/// Every face belongs to one or two elements, which run through it in opposite
/// senses; the surface is closed and has the faces that sweeping the outline
/// gives, so no crack inside; every node is used.
fn assert_conforming(mesh: &HexMesh, surface_faces: usize) {
    let mut faces: BTreeMap<[usize; 4], Vec<[usize; 4]>> = BTreeMap::new();
    let mut used = vec![false; mesh.nodes.len()];
    for hex in &mesh.hexes {
        for face in FACES {
            let nodes = face.map(|i| hex[i]);
            let mut key = nodes;
            key.sort_unstable();
            faces.entry(key).or_default().push(nodes);
        }
        hex.iter().for_each(|&v| used[v] = true);
    }
    assert!(used.iter().all(|u| *u), "a node belongs to no element");
    let mut edges: BTreeMap<(usize, usize), i32> = BTreeMap::new();
    for sides in faces.values() {
        assert!(sides.len() <= 2, "a face belongs to {} elements", sides.len());
        if let [one, other] = sides[..] {
            let start = other.iter().position(|&v| v == one[0]).unwrap();
            assert_eq!(one[1], other[(start + 3) % 4], "two elements lie on the same side of a face");
        } else {
            for i in 0..4 {
                let (a, b) = (sides[0][i], sides[0][(i + 1) % 4]);
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
    }
    assert!(edges.values().all(|sum| *sum == 0), "the surface is not closed");
    assert_eq!(faces.values().filter(|sides| sides.len() == 1).count(), surface_faces);
}

fn assert_good(mesh: &HexMesh, most_nodes: usize) -> Quality {
    let q = quality(mesh).unwrap();
    assert!(q.min_scaled_jacobian >= 0.3, "{q:?}");
    assert!(q.mean_scaled_jacobian >= 0.9, "{q:?}");
    assert!(mesh.nodes.len() <= most_nodes, "{} nodes", mesh.nodes.len());
    q
}

/// Edges of the contact grid, the longest along the profile and along the track.
fn longest_edges(mesh: &HexMesh) -> (f64, f64) {
    let (rows, columns) = (mesh.contact.along_profile.len(), mesh.contact.along_track.len());
    let mut longest = (0.0_f64, 0.0_f64);
    for i in 0..rows {
        for k in 0..columns {
            let p = mesh.nodes[mesh.contact.node(i, k)];
            if i + 1 < rows {
                longest.0 = longest.0.max((mesh.nodes[mesh.contact.node(i + 1, k)] - p).norm());
            }
            if k + 1 < columns {
                longest.1 = longest.1.max((mesh.nodes[mesh.contact.node(i, k + 1)] - p).norm());
            }
        }
    }
    longest
}

#[test]
fn the_rail_has_its_volume_good_elements_and_conforms() {
    let (section, _, mesh) = rail();
    let q = assert_good(&mesh, 21_000);
    assert!((q.volume / (section.area.area * LENGTH) - 1.0).abs() < DISCRETISATION_RAIL, "{q:?}");
    let options = MeshOptions::default();
    let plane = mesh_section(&rail_outline(&section, &options).unwrap(), &options.rail_sizes()).unwrap();
    let layers = mesh.nodes.len() / plane.nodes.len();
    let faces = plane.boundary.len() * (layers - 1) + 2 * plane.quads.len();
    assert_conforming(&mesh, faces);
}

/// Goal: the numbers that are counted are those of the meshes, for the default sizes and others. The least numbers are of the layers below the contact zone alone: the same contact
/// nodes, and a part of the nodes that says how large the mesh is. Accuracy: LAYERS; with the default sizes they have 5439 of the rail's
/// 20,139 nodes and 9720 of the wheel's 68,328. With coarse elements they are less of it, and it is small.
#[test]
fn the_sizes_are_those_of_the_meshes() {
    const LAYERS: usize = 8;
    let coarse = MeshOptions {
        contact_element: 5e-3,
        contact_element_along: 4e-3,
        window_half_length: 17e-3,
        ..MeshOptions::default()
    };
    let (section, placed, _) = rail();
    let round = wheel_section("S1002", 0.858).unwrap();
    for (options, is_fine) in [(MeshOptions::default(), true), (coarse, false)] {
        let mesh = mesh_rail(&section, &placed, LENGTH, &options).unwrap();
        assert_eq!(rail_size(&section, LENGTH, &options).unwrap(), MeshSize::of(&mesh));
        let is_part = |least: MeshSize, of: &HexMesh| {
            let all = MeshSize::of(of);
            let fewest = if is_fine { all.nodes / LAYERS } else { all.contact };
            let is_within = (fewest..all.nodes).contains(&least.nodes);
            least.contact == all.contact && is_within && least.hexes < all.hexes
        };
        assert!(is_part(least_rail_size(&section, LENGTH, &options).unwrap(), &mesh));
        let mesh = mesh_wheel(&round, &options).unwrap();
        assert_eq!(wheel_size(&round, &options).unwrap(), MeshSize::of(&mesh));
        assert!(is_part(least_wheel_size(&round, &options).unwrap(), &mesh));
    }
}

#[test]
fn the_wheel_has_its_volume_good_elements_and_conforms() {
    let (section, mesh) = wheel();
    let q = assert_good(&mesh, 70_000);
    let options = MeshOptions::default();
    let plane = mesh_section(&wheel_outline(&section, &options).unwrap(), &options.wheel_sizes()).unwrap();
    let layers = mesh.nodes.len() / plane.nodes.len();
    // Between two layers a body of revolution becomes sin Δθ / Δθ of itself, whatever its section.
    let exact = body_of_revolution(&section, 1.0).mass;
    let angle = |l: usize| {
        let p = mesh.nodes[l % layers * plane.nodes.len()];
        p.x.atan2(p.z)
    };
    let (mut sum, mut around) = (0.0, 0.0);
    for l in 0..layers {
        let step = (angle(l + 1) - angle(l)).rem_euclid(2.0 * PI);
        sum += step.sin();
        around += step;
    }
    assert!((around / (2.0 * PI) - 1.0).abs() < ROUNDOFF);
    assert!((q.volume / (exact * sum / (2.0 * PI)) - 1.0).abs() < DISCRETISATION_WHEEL, "{q:?}");
    assert_conforming(&mesh, plane.boundary.len() * layers);
}

#[test]
fn the_rails_contact_nodes_lie_on_the_placed_curve_two_millimetres_apart() {
    let (section, placed, mesh) = rail();
    let grid = &mesh.contact;
    for (i, s) in grid.along_profile.iter().enumerate() {
        let on_curve = placed.curve.point(*s);
        for (k, x) in grid.along_track.iter().enumerate() {
            let p = mesh.nodes[grid.node(i, k)];
            assert!((p - nalgebra::Point3::new(*x, on_curve.x, on_curve.y)).norm() < ON_CURVE);
        }
    }
    let (profile, track) = longest_edges(&mesh);
    assert!(profile <= 2e-3 * (1.0 + ROUNDOFF) && track <= 2e-3 * (1.0 + ROUNDOFF), "{profile} {track}");
    // The zone ends where the options say.
    let (first, last) = (grid.along_profile[0], grid.along_profile[grid.along_profile.len() - 1]);
    assert!((section.running.point(first).y - 20e-3).abs() < ON_CURVE);
    assert!((section.running.point(last).x - 22e-3).abs() < ON_CURVE);
    assert!((grid.along_track[0] + MeshOptions::default().window_half_length).abs() < ON_CURVE);
}

/// Goal: the contact grid goes on beyond the window up to the first line at the wanted distance (m), on the same mesh, and has the size
/// that is said before; it keeps away from the rail's ends. Accuracy: equal numbers.
#[test]
fn the_contact_grid_goes_on_beyond_the_window() {
    let ((section, placed, rail), (wheel_section, wheel)) = (rail(), wheel());
    for wanted in [20e-3, 1.0] {
        let options = MeshOptions { contact_half_length: wanted, ..MeshOptions::default() };
        let long = mesh_rail(&section, &placed, LENGTH, &options).unwrap();
        assert_eq!((&long.nodes, &long.hexes), (&rail.nodes, &rail.hexes));
        let (lines, window) = (&long.contact.along_track, rail.contact.along_track.len());
        let beyond = (lines.len() - window) / 2;
        assert_eq!(lines[beyond..beyond + window], rail.contact.along_track);
        let last = lines[lines.len() - 1];
        assert!(if wanted < 0.5 * LENGTH { last >= wanted } else { last < 0.5 * LENGTH }, "{last}");
        assert!(wanted > 0.5 * LENGTH || lines[lines.len() - 2] < wanted, "{lines:?}");
        assert_eq!(rail_size(&section, LENGTH, &options).unwrap(), MeshSize::of(&long));
    }
    let options = MeshOptions { contact_half_length: 20e-3, ..MeshOptions::default() };
    let long = mesh_wheel(&wheel_section, &options).unwrap();
    assert_eq!((&long.nodes, &long.hexes), (&wheel.nodes, &wheel.hexes));
    let last = long.contact.along_track[long.contact.along_track.len() - 1];
    assert!(last * wheel_section.radius >= 20e-3 * (1.0 - ROUNDOFF), "{last}");
    assert_eq!(wheel_size(&wheel_section, &options).unwrap(), MeshSize::of(&long));
}

#[test]
fn the_wheels_contact_nodes_lie_on_the_revolved_curve_two_millimetres_apart() {
    let (section, mesh) = wheel();
    let grid = &mesh.contact;
    assert!(grid.along_profile.windows(2).all(|s| s[1] > s[0]));
    for (i, s) in grid.along_profile.iter().enumerate() {
        let p = section.running.point(*s);
        let rho = section.radius + p.y;
        for (k, theta) in grid.along_track.iter().enumerate() {
            let expected = nalgebra::Point3::new(rho * theta.sin(), p.x, rho * theta.cos());
            assert!((mesh.nodes[grid.node(i, k)] - expected).norm() < ON_CURVE);
        }
    }
    let (profile, track) = longest_edges(&mesh);
    // The flange, 15 mm below the tape circle, runs on a radius larger by 15/429.
    assert!(profile <= 2e-3 * (1.0 + ROUNDOFF) && track <= 2e-3 * 1.036, "{profile} {track}");
    let first = section.running.point(grid.along_profile[0]);
    assert!((first.y - 21e-3).abs() < ON_CURVE && first.x < -0.03);
}

#[test]
fn the_node_sets_are_complete() {
    let (section, placed, mesh) = rail();
    for (v, p) in mesh.nodes.iter().enumerate() {
        let local = placed.to_profile(&Point2::new(p.y, p.z));
        assert_eq!(mesh.foot.binary_search(&v).is_ok(), (local.y - section.height).abs() < ON_CURVE);
        assert_eq!(mesh.ends.binary_search(&v).is_ok(), (p.x.abs() - 0.5 * LENGTH).abs() < ON_CURVE);
    }
    assert!(!mesh.foot.is_empty() && !mesh.ends.is_empty());
    let (section, mesh) = wheel();
    for (v, p) in mesh.nodes.iter().enumerate() {
        let on_bore = (p.x.hypot(p.z) - section.bore_radius).abs() < ON_CURVE;
        assert_eq!(mesh.bore.binary_search(&v).is_ok(), on_bore);
    }
    assert!(!mesh.bore.is_empty());
}

#[test]
fn the_same_input_gives_the_same_mesh_to_the_last_bit() {
    let bits = |mesh: &HexMesh| -> Vec<u64> {
        mesh.nodes.iter().flat_map(|p| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()]).collect()
    };
    let (one, other) = (wheel().1, wheel().1);
    assert_eq!(bits(&one), bits(&other));
    assert_eq!(one, other);
}

#[test]
fn refinement_scales_the_spacing_and_keeps_the_zone() {
    let section = rail_section("60E1").unwrap();
    let placed = place_rail(&section, &TrackGeometry::standard()).unwrap();
    let coarse = mesh_rail(&section, &placed, LENGTH, &MeshOptions::default()).unwrap();
    let fine = mesh_rail(&section, &placed, LENGTH, &MeshOptions::default().refined(1.5)).unwrap();
    assert_good(&fine, 57_000);
    let (c, f) = (longest_edges(&coarse), longest_edges(&fine));
    // Whole numbers of elements: up to one part in 36 along the profile, 14 along the track.
    assert!((c.0 / f.0 / 1.5 - 1.0).abs() < 1.0 / 18.0 && (c.1 / f.1 / 1.5 - 1.0).abs() < 1.0 / 7.0);
    assert_eq!(coarse.contact.along_profile[0], fine.contact.along_profile[0]);
}

#[test]
fn bad_options_are_refused_by_key() {
    let section = rail_section("60E1").unwrap();
    let placed = place_rail(&section, &TrackGeometry::standard()).unwrap();
    let wheel = wheel_section("S1002", 0.858).unwrap();
    let message = |options: MeshOptions, length: f64| {
        mesh_rail(&section, &placed, length, &options).map(|_| ()).unwrap_err().to_string()
    };
    let default = MeshOptions::default();
    let zone = |face_depth: f64, field_y: f64| ContactZone { face_depth, field_y };
    assert!(message(default.clone(), 0.02).starts_with("rail_length = 0.02 m"));
    assert!(message(default.clone(), f64::NAN).starts_with("rail_length = NaN"));
    let cases = [
        ("contact_element", MeshOptions { contact_element: 0.0, ..default.clone() }),
        ("contact_element", MeshOptions { contact_element: f64::NAN, ..default.clone() }),
        ("growth", MeshOptions { growth: 0.9, ..default.clone() }),
        ("layers", MeshOptions { layers: Some(3), ..default.clone() }),
        ("rail_zone.face_depth", MeshOptions { rail_zone: zone(0.2, 22e-3), ..default.clone() }),
        ("rail_zone.field_y", MeshOptions { rail_zone: zone(20e-3, 0.2), ..default.clone() }),
        ("rail_zone.field_y", MeshOptions { rail_zone: zone(20e-3, -0.0362), ..default.clone() }),
    ];
    for (key, options) in cases {
        let text = message(options, LENGTH);
        assert!(text.starts_with(key), "{text}");
    }
    let options = MeshOptions { window_half_length: 0.3, ..default };
    let text = mesh_wheel(&wheel, &options).map(|_| ()).unwrap_err().to_string();
    assert!(text.starts_with("window_half_length"), "{text}");
}
