//! Meshes from elsewhere: the tool's own come back as they were, however they are numbered, and every mesh that cannot
//! be used is refused with its key, what is wrong and where.

use std::sync::OnceLock;

use super::super::{mesh_rail, mesh_wheel};
use super::*;
use railspring_profiles::placement::{PlacedRail, TrackGeometry, place_rail};
use railspring_profiles::section::{WheelSection, rail_section, wheel_section};

/// Rounding of a position of one metre, m, through a few operations.
const ROUNDOFF: f64 = 1e-14;
const LENGTH: f64 = 0.555;

fn options() -> MeshOptions {
    MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..MeshOptions::default() }
}

fn rail() -> &'static (PlacedRail, HexMesh) {
    static RAIL: OnceLock<(PlacedRail, HexMesh)> = OnceLock::new();
    RAIL.get_or_init(|| {
        let section = rail_section("60E1").unwrap();
        let placed = place_rail(&section, &TrackGeometry::standard()).unwrap();
        let mesh = mesh_rail(&section, &placed, LENGTH, &options()).unwrap();
        (placed, mesh)
    })
}

fn wheel() -> &'static (WheelSection, HexMesh) {
    static WHEEL: OnceLock<(WheelSection, HexMesh)> = OnceLock::new();
    WHEEL.get_or_init(|| {
        let section = wheel_section("S1002", 0.858).unwrap();
        let mesh = mesh_wheel(&section, &options()).unwrap();
        (section, mesh)
    })
}

/// The mesh as one from elsewhere; its contact nodes in no order.
fn given(mesh: &HexMesh) -> GivenMesh {
    GivenMesh {
        nodes: mesh.nodes.clone(),
        hexes: mesh.hexes.clone(),
        contact: mesh.contact.nodes.iter().rev().copied().collect(),
        held: if mesh.bore.is_empty() { mesh.foot.clone() } else { mesh.bore.clone() },
        groups: mesh.groups.clone(),
        group_names: Vec::new(),
    }
}

fn as_rail(given: GivenMesh) -> Result<HexMesh> {
    given_rail(given, &rail().0.curve, LENGTH, &options())
}

fn as_wheel(given: GivenMesh) -> Result<HexMesh> {
    let section = &wheel().0;
    given_wheel(given, &section.running, section.radius, &options())
}

/// The message for a spoilt rail.
fn refused(spoil: impl FnOnce(&mut GivenMesh)) -> String {
    let mut spoilt = given(&rail().1);
    spoil(&mut spoilt);
    as_rail(spoilt).map(|_| ()).unwrap_err().to_string()
}

/// The message for a spoilt wheel.
fn refused_wheel(spoil: impl FnOnce(&mut GivenMesh)) -> String {
    let mut spoilt = given(&wheel().1);
    spoil(&mut spoilt);
    as_wheel(spoilt).map(|_| ()).unwrap_err().to_string()
}

fn has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} in {text}");
    }
}

/// The grid has the same nodes, and their coordinates to rounding.
fn assert_same_grid(own: &HexMesh, back: &HexMesh) {
    assert_eq!(own.contact.nodes, back.contact.nodes);
    for (a, b) in [
        (&own.contact.along_profile, &back.contact.along_profile),
        (&own.contact.along_track, &back.contact.along_track),
    ] {
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < ROUNDOFF), "{a:?} {b:?}");
    }
}

#[test]
fn the_tools_own_meshes_come_back() {
    let own = &rail().1;
    let back = as_rail(given(own)).unwrap();
    assert_same_grid(own, &back);
    assert_eq!(
        (&own.nodes, &own.hexes, &own.ends, &own.foot),
        (&back.nodes, &back.hexes, &back.ends, &back.foot)
    );
    let own = &wheel().1;
    let back = as_wheel(given(own)).unwrap();
    assert_same_grid(own, &back);
    assert_eq!((&own.nodes, &own.hexes, &own.bore), (&back.nodes, &back.hexes, &back.bore));
}

/// Goal: numbers of nodes and elements, and the corner that an element begins with, mean nothing.
#[test]
fn another_numbering_gives_the_same_body() {
    let own = given(&rail().1);
    let count = own.nodes.len();
    // a stride without common divisor visits every number once
    let stride = (count / 3..).find(|s| gcd(*s, count) == 1).unwrap();
    let new = |v: usize| v * stride % count;
    let mut nodes = own.nodes.clone();
    (0..count).for_each(|v| nodes[new(v)] = own.nodes[v]);
    let turned = |h: &[usize; 8]| [h[1], h[2], h[3], h[0], h[5], h[6], h[7], h[4]].map(new);
    let renumber = |list: &[usize]| list.iter().map(|&v| new(v)).collect::<Vec<_>>();
    let back = as_rail(GivenMesh {
        nodes,
        hexes: own.hexes.iter().rev().map(turned).collect(),
        contact: renumber(&own.contact),
        held: renumber(&own.held),
        groups: Vec::new(),
        group_names: Vec::new(),
    })
    .unwrap();
    assert_eq!(back.contact.nodes, renumber(&rail().1.contact.nodes));
    assert_eq!(back.ends, sorted(renumber(&rail().1.ends)));
    assert_eq!(back.foot, sorted(renumber(&rail().1.foot)));
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Goal: the whole running surface may be named, all around a wheel and from end to end of a rail; the window takes
/// what it needs.
#[test]
fn a_longer_surface_is_cut_to_the_window() {
    let on_curve = |own: &HexMesh, section: &dyn Fn(&Point3<f64>) -> nalgebra::Point2<f64>| -> Vec<usize> {
        let rows = own.contact.along_track.len();
        let line: Vec<_> = own.contact.nodes.iter().step_by(rows).map(|&v| section(&own.nodes[v])).collect();
        (0..own.nodes.len())
            .filter(|&v| line.iter().any(|p| (section(&own.nodes[v]) - p).norm() < 1e-9))
            .collect()
    };
    let own = &rail().1;
    let contact = on_curve(own, &|p| nalgebra::Point2::new(p.y, p.z));
    assert!(contact.len() > 2 * own.contact.nodes.len());
    assert_same_grid(own, &as_rail(GivenMesh { contact, ..given(own) }).unwrap());
    let own = &wheel().1;
    let contact = on_curve(own, &|p| nalgebra::Point2::new(p.y, p.x.hypot(p.z)));
    assert!(contact.len() > 2 * own.contact.nodes.len());
    assert_same_grid(own, &as_wheel(GivenMesh { contact, ..given(own) }).unwrap());
}

#[test]
fn the_wrong_unit_is_named() {
    let text = refused(|m| m.nodes.iter_mut().for_each(|p| *p *= 1e3));
    has(&text, &["rail_mesh_unit = a rail of 555", "between 0.1 and 25 m", "`rail_mesh_unit` = \"mm\""]);
    let text = refused_wheel(|m| m.nodes.iter_mut().for_each(|p| *p *= 1e-3));
    has(&text, &["wheel_mesh_unit = a wheel of 0.00", "if the file is in m, set `wheel_mesh_unit` = \"m\""]);
}

#[test]
fn inverted_and_mirrored_elements_are_refused() {
    let one = refused(|m| {
        let h = m.hexes[17];
        m.hexes[17] = [h[4], h[5], h[6], h[7], h[0], h[1], h[2], h[3]];
    });
    has(&one, &["rail_mesh = 1 of ", "inverted or flat, the first around (", "correct these elements"]);
    let all = refused(|m| m.nodes.iter_mut().for_each(|p| p.x = -p.x));
    has(&all, &["rail_mesh = ", "the mesh is mirrored", "right-handed"]);
    let folded = refused_wheel(|m| m.nodes[m.held[5]].x = f64::NAN);
    has(&folded, &["wheel_mesh = ", "inverted or flat"]);
}

#[test]
fn pieces_cracks_and_repeated_elements_are_refused() {
    // elements of one layer of nodes get nodes of their own: a crack across the rail
    let crack = |m: &mut GivenMesh, apart: f64| {
        let cut = m.nodes[m.contact[0]].x;
        for v in 0..m.nodes.len() {
            if (m.nodes[v].x - cut).abs() < 1e-9 {
                let own = m.nodes.len();
                m.nodes.push(m.nodes[v] - Vector3::x() * apart);
                for hex in 0..m.hexes.len() {
                    let before = m.hexes[hex].iter().map(|&w| m.nodes[w].x).fold(f64::INFINITY, f64::min);
                    if before < cut - 1e-9 {
                        m.hexes[hex].iter_mut().filter(|w| **w == v).for_each(|w| *w = own);
                    }
                }
            }
        }
    };
    has(&refused(|m| crack(m, 0.0)), &["rail_mesh = nodes ", "merge coincident nodes"]);
    has(&refused(|m| crack(m, 1e-5)), &["rail_mesh = 2 pieces; the smallest, of "]);
    has(&refused(|m| m.hexes.push(m.hexes[40])), &["belongs to more than two hexahedra"]);
    has(&refused(|m| m.nodes.push(Point3::new(0.0, 0.0, -1.0))), &["belongs to no hexahedron"]);
    has(&refused(|m| m.hexes[0][0] = usize::MAX), &["rail_mesh = node 18446744073709551615"]);
}

#[test]
fn a_body_out_of_its_place_is_refused() {
    let moved = |by: Vector3<f64>| refused(|m| m.nodes.iter_mut().for_each(|p| *p += by));
    has(&moved(Vector3::new(1e-3, 0.0, 0.0)), &["rail_mesh = a rail from x = -276.500 to 278.500 mm"]);
    let side = moved(Vector3::new(0.0, 0.5e-3, 0.0));
    has(
        &side,
        &["rail_contact_surface = ", "lie off the running surface, the worst by 0.5", "within 0.1 mm"],
    );
    // The nodes stay on the crown, but not on the gauge face.
    let few = moved(Vector3::new(0.0, 0.11e-3, 0.0));
    has(&few, &["lie off the running surface, the worst by 0.1"]);
    let depth = refused_wheel(|m| m.nodes.iter_mut().for_each(|p| p.y += 1e-3));
    has(&depth, &["wheel_contact_surface = ", "the worst by 0.9"]);
    let half = refused_wheel(|m| {
        let below = |hex: &[usize; 8]| hex.iter().all(|&v| m.nodes[v].z > -1e-9);
        let hexes: Vec<[usize; 8]> = m.hexes.iter().copied().filter(below).collect();
        let used = sorted(hexes.iter().flatten().copied().collect());
        let new = |v: &usize| used.binary_search(v).unwrap();
        *m = GivenMesh {
            nodes: used.iter().map(|&v| m.nodes[v]).collect(),
            hexes: hexes.iter().map(|hex| hex.map(|v| new(&v))).collect(),
            contact: m.contact.iter().map(new).collect(),
            held: m.held.iter().filter(|&v| used.contains(v)).map(new).collect(),
            groups: Vec::new(),
            group_names: Vec::new(),
        };
    });
    has(&half, &["wheel_mesh = no nodes over 190.", "a full wheel"]);
}

#[test]
fn a_surface_that_is_no_grid_is_refused() {
    let columns = rail().1.contact.along_track.len();
    // one node slides along the track, across it, or is missing
    let slid = refused(|m| m.nodes[rail().1.contact.nodes[2 * columns + 2]].x += 20e-6);
    has(&slid, &["rail_contact_surface = ", "a swept grid"]);
    let missing = refused(|m| m.contact.retain(|v| *v != rail().1.contact.nodes[2 * columns + 2]));
    has(
        &missing,
        &["rail_contact_surface = 64 nodes in 13 rows and 5 columns; none at x = 0.000 mm in the row"],
    );
    let hole = refused(|m| {
        // an element away from the borders of the grid, so that all its nodes have other faces
        let grid = &rail().1.contact;
        let [a, b] = [grid.node(4, 2), grid.node(5, 3)];
        let inner = m.hexes.iter().position(|hex| hex.contains(&a) && hex.contains(&b)).unwrap();
        m.hexes.remove(inner);
    });
    has(&hole, &["rail_contact_surface = 47 outer faces on a grid with 48 cells"]);
    let corner = refused(|m| m.contact.retain(|v| *v != rail().1.contact.nodes[0]));
    has(&corner, &["rail_contact_surface = ", "none at x = -12.000 mm in the row"]);
    let short = refused(|m| m.contact.retain(|v| m.nodes[*v].x < 7e-3));
    has(&short, &["faces from x = -12.000 mm to x = 6.000 mm", "over the window of \u{b1}12.000 mm"]);
    let scattered = refused(|m| m.contact = vec![0, 50, 100]);
    has(&scattered, &["rail_contact_surface = 3 nodes, none of the mesh's outer faces"]);
    let elsewhere = refused_wheel(|m| {
        m.contact = m.contact.iter().map(|&v| (v + m.nodes.len() / 2) % m.nodes.len()).collect();
    });
    has(&elsewhere, &["wheel_contact_surface = "]);
}

#[test]
fn nodes_that_cannot_hold_the_body_are_refused() {
    let line = refused(|m| m.held.truncate(2));
    has(&line, &["rail_held_nodes = 2 nodes on a line", "at least three that are not on a line"]);
    let touching = refused(|m| m.held.extend(&rail().1.contact.nodes[..4]));
    has(&touching, &["rail_held_nodes = 4 nodes that belong to the contact surface too"]);
    has(&refused_wheel(|m| m.held.clear()), &["wheel_held_nodes = 0 nodes on a line"]);
}

/// Goal: groups come back with their mesh; two of them at the contact surface are refused with their names and the place, and groups that are no
/// groups of the hexahedra, too.
#[test]
fn one_group_is_at_the_contact_surface() {
    let mesh = &rail().1;
    let names = || ["steel", "other"].map(String::from).to_vec();
    let with = |groups: Vec<usize>| as_rail(GivenMesh { groups, group_names: names(), ..given(mesh) });
    let below = |z: f64| -> Vec<usize> {
        let lowest = |hex: &[usize; 8]| hex.iter().map(|&v| mesh.nodes[v].z).fold(f64::INFINITY, f64::min);
        mesh.hexes.iter().map(|hex| usize::from(lowest(hex) > z)).collect()
    };
    assert_eq!(with(below(0.1)).unwrap().groups, below(0.1));
    let both: Vec<usize> = mesh.hexes.iter().map(|hex| usize::from(mesh.nodes[hex[0]].y > 0.75)).collect();
    let text = with(both).unwrap_err().to_string();
    has(&text, &["rail_materials = ", "\"steel\"", "\"other\" at the contact surface, the latter around ("]);
    has(&with(vec![0; 3]).unwrap_err().to_string(), &["rail_mesh = 3 groups of"]);
    has(&with(vec![2; mesh.hexes.len()]).unwrap_err().to_string(), &["a group with a name"]);
}
