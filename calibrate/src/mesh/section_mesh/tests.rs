//! Sections filled with quadrilaterals: area, conformity, quality, outlines that are refused.

use super::*;

/// Position of nodes and areas that are exact but for rounding, relative.
const ROUNDOFF: f64 = 1e-12;
const SIZES: SectionSizes = SectionSizes {
    layers: 2,
    first_layer: 2e-3,
    layer_growth: 1.25,
    growth: 0.3,
    largest: 12e-3,
    of_thickness: 0.575,
    of_radius: 0.4,
};

/// A head 80 x 30 mm whose upper side (towards smaller z) has a contact zone of
/// 40 mm, on a web 15 mm thick that swings sideways by `swing`, 120 mm deep.
fn head_on_a_web(swing: f64) -> SectionOutline {
    let fine = (0..=20)
        .map(|i| {
            let y = -20e-3 + 2e-3 * f64::from(i);
            SurfacePoint { point: Point2::new(y, 0.0), inward: Vector2::new(0.0, 1.0), s: y + 20e-3 }
        })
        .collect();
    let web = |side: f64, k: u32| {
        let part = f64::from(k) / 200.0;
        let middle = swing * (std::f64::consts::PI * part).sin().powi(2);
        Point2::new(middle + 7.5e-3 * side, 30e-3 + 120e-3 * part)
    };
    let mut rest = vec![Point2::new(20e-3, 0.0), Point2::new(40e-3, 0.0), Point2::new(40e-3, 30e-3)];
    rest.extend((0..=200).map(|k| web(1.0, k)));
    rest.extend((0..=200).rev().map(|k| web(-1.0, k)));
    rest.extend([Point2::new(-40e-3, 30e-3), Point2::new(-40e-3, 0.0), Point2::new(-20e-3, 0.0)]);
    SectionOutline { fine, rest }
}

#[test]
fn straight_edges_are_met_exactly() {
    let mesh = mesh_section(&head_on_a_web(0.0), &SIZES).unwrap();
    let exact = 80e-3 * 30e-3 + 15e-3 * 120e-3;
    assert!((mesh.area() / exact - 1.0).abs() < ROUNDOFF, "{}", mesh.area());
    assert!(mesh.min_scaled_jacobian() > 0.4, "{}", mesh.min_scaled_jacobian());
}

/// Goal: layers of 9 mm under a head whose corners are rounded with 8 mm inside the contact zone. Straight down to the centre of
/// the rounding they would fold; they are made thinner as a whole, and the area is that of the outline. Accuracy: chords.
#[test]
fn layers_deeper_than_a_rounding_are_made_thinner() {
    const RADIUS: f64 = 8e-3;
    let quarter = 0.5 * std::f64::consts::PI * RADIUS;
    // from the left side over the top to the right side, 60 mm wide
    let at = |s: f64| {
        let (side, top) = (10e-3, 44e-3);
        let corner = |t: f64, y: f64| {
            let angle = std::f64::consts::PI + t / RADIUS;
            let outward = Vector2::new(angle.cos(), angle.sin());
            (Point2::new(y, RADIUS) + RADIUS * outward, -outward)
        };
        match s {
            s if s < side => (Point2::new(-30e-3, RADIUS + side - s), Vector2::new(1.0, 0.0)),
            s if s < side + quarter => corner(s - side, -22e-3),
            s if s < side + quarter + top => {
                (Point2::new(-22e-3 + s - side - quarter, 0.0), Vector2::new(0.0, 1.0))
            }
            s if s < side + 2.0 * quarter + top => corner(s - side - top, 22e-3),
            s => (Point2::new(30e-3, RADIUS + s - (side + 2.0 * quarter + top)), Vector2::new(-1.0, 0.0)),
        }
    };
    let length = 20e-3 + 44e-3 + 2.0 * quarter;
    let fine: Vec<SurfacePoint> = (0..=24)
        .map(|i| length * f64::from(i) / 24.0)
        .map(|s| {
            let (point, inward) = at(s);
            SurfacePoint { point, inward, s }
        })
        .collect();
    let rest = vec![fine[24].point, Point2::new(30e-3, 40e-3), Point2::new(-30e-3, 40e-3), fine[0].point];
    let outline = SectionOutline { fine, rest };
    let sizes = SectionSizes { first_layer: 4e-3, ..SIZES };
    let mesh = mesh_section(&outline, &sizes).unwrap();
    assert!(mesh.min_scaled_jacobian() > 0.3, "{}", mesh.min_scaled_jacobian());
    let exact = 60e-3 * 40e-3 - (2.0 - 0.5 * std::f64::consts::PI) * RADIUS * RADIUS;
    // DISCRETISATION: chords of 4 mm on the two quarters, c²/(12 R) on 25 mm, and an edge across the end of each.
    assert!((mesh.area() / exact - 1.0).abs() < 5e-3, "{}", mesh.area() / exact - 1.0);
}

/// Source: the tread of a cylindrical wheel, whose vertices lie 1e-60 m beside zero. Goal: it is meshed as one at zero.
/// Accuracy: the same elements.
#[test]
fn coordinates_that_are_nearly_zero_are_zero() {
    let exact = head_on_a_web(0.0);
    let mut outline = exact.clone();
    outline.fine.iter_mut().for_each(|p| p.point.y = 1e-60);
    let quads = |outline| mesh_section(outline, &SIZES).unwrap().quads;
    assert_eq!(quads(&outline), quads(&exact));
}

#[test]
fn a_curved_web_keeps_its_area() {
    let outline = head_on_a_web(40e-3);
    let mesh = mesh_section(&outline, &SIZES).unwrap();
    let exact = 80e-3 * 30e-3 + 15e-3 * 120e-3;
    // DISCRETISATION: nodes that leave the outline by c²/(12 R) = 0.2 mm in place of its chords of 10 mm on radii of 40 mm;
    // at the four corners of 0.25 m of web half an edge keeps its chord.
    assert!((mesh.area() / exact - 1.0).abs() < 4.0 * 5e-3 * 0.2e-3 / exact, "{}", mesh.area());
    assert!(mesh.min_scaled_jacobian() > 0.3, "{}", mesh.min_scaled_jacobian());
}

/// Source: the area of a disc 20 mm thick on a head, with fillets of radius 25 mm: `(1 - π/4) R²` each. Goal: the mesh has that
/// area, with three elements on a fillet, where chords alone are 2/3 of their height `c²/(8 R)` too thick. Accuracy:
/// DISCRETISATION of the ends of each fillet, half an edge with its chord: a third of what chords would make.
#[test]
fn fillets_keep_their_area() {
    const RADIUS: f64 = 25e-3;
    let (half, top, bottom) = (10e-3, 30e-3, 130e-3);
    let mut outline = head_on_a_web(0.0);
    let fillet = |side: f64| {
        (0..=100).map(move |k| {
            let (sin, cos) = (0.5 * std::f64::consts::PI * f64::from(k) / 100.0).sin_cos();
            Point2::new(side * (half + RADIUS * (1.0 - sin)), top + RADIUS * (1.0 - cos))
        })
    };
    let mut rest = vec![Point2::new(20e-3, 0.0), Point2::new(40e-3, 0.0), Point2::new(40e-3, top)];
    rest.extend(fillet(1.0));
    rest.extend([Point2::new(half, bottom), Point2::new(-half, bottom)]);
    rest.extend(fillet(-1.0).collect::<Vec<_>>().into_iter().rev());
    rest.extend([Point2::new(-40e-3, top), Point2::new(-40e-3, 0.0), Point2::new(-20e-3, 0.0)]);
    outline.rest = rest;
    let mesh = mesh_section(&outline, &SIZES).unwrap();
    let corner = (1.0 - 0.25 * std::f64::consts::PI) * RADIUS * RADIUS;
    let exact = 80e-3 * 30e-3 + 2.0 * half * (bottom - top) + 2.0 * corner;
    let chord = 0.4 * RADIUS;
    let of_chords = 2.0 * 0.5 * std::f64::consts::PI * RADIUS * chord * chord / (12.0 * RADIUS);
    let off = mesh.area() - exact;
    assert!(off.abs() < of_chords / 3.0, "{off} m² off, chords {of_chords}");
}

#[test]
fn a_web_has_two_elements_across_and_none_much_longer_than_half_its_thickness() {
    let mesh = mesh_section(&head_on_a_web(0.0), &SectionSizes { largest: 50e-3, ..SIZES }).unwrap();
    let inside = |p: &&Point2<f64>| (p.y - 90e-3).abs() < 30e-3;
    let on_outline = mesh.boundary.iter().map(|&v| &mesh.nodes[v]).filter(inside).count();
    let all = mesh.nodes.iter().filter(inside).count();
    // Steps of up to 8.6 mm on two sides of 60 mm; a third row of nodes in the middle.
    assert!(on_outline >= 12, "{on_outline} nodes on the sides of the web");
    assert!(all > on_outline + on_outline / 3, "{all} nodes in the web, {on_outline} of them on its sides");
}

#[test]
fn the_outline_is_walked_once_and_the_contact_zone_is_on_it() {
    let outline = head_on_a_web(20e-3);
    let mesh = mesh_section(&outline, &SIZES).unwrap();
    let mut sorted = mesh.boundary.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), mesh.boundary.len());
    let around: f64 = (1..mesh.boundary.len() - 1)
        .map(|k| {
            let p = |k: usize| &mesh.nodes[mesh.boundary[k]];
            signed_area(p(0), p(k), p(k + 1))
        })
        .sum();
    assert!((around / mesh.area() - 1.0).abs() < ROUNDOFF);
    for ((node, s), surface) in mesh.contact.iter().zip(&mesh.contact_s).zip(&outline.fine) {
        assert_eq!((mesh.nodes[*node], *s), (surface.point, surface.s));
    }
}

#[test]
fn the_sense_of_the_outline_does_not_matter() {
    // The same section mirrored in z, so that its outline runs the other way round.
    let mirror = |p: &Point2<f64>| Point2::new(p.x, -p.y);
    let outline = head_on_a_web(10e-3);
    let mirrored = SectionOutline {
        fine: outline
            .fine
            .iter()
            .map(|p| SurfacePoint { point: mirror(&p.point), inward: Vector2::new(0.0, -1.0), s: p.s })
            .collect(),
        rest: outline.rest.iter().map(mirror).collect(),
    };
    let (one, other) = (mesh_section(&outline, &SIZES).unwrap(), mesh_section(&mirrored, &SIZES).unwrap());
    assert!(one.area() > 0.0 && other.area() > 0.0);
    assert_eq!(one.contact_s, other.contact_s);
    for (a, b) in one.contact.iter().zip(&other.contact) {
        assert_eq!(one.nodes[*a], mirror(&other.nodes[*b]));
    }
}

/// A plate 80 mm wide, of this depth, m, with the contact zone of 40 mm on its upper side.
fn plate(depth: f64) -> SectionOutline {
    let fine = head_on_a_web(0.0).fine;
    let corners = [(20e-3, 0.0), (40e-3, 0.0), (40e-3, depth), (-40e-3, depth), (-40e-3, 0.0), (-20e-3, 0.0)];
    SectionOutline { fine, rest: corners.map(|(y, z)| Point2::new(y, z)).to_vec() }
}

/// Goal: layers of 9 mm become thinner where they do not fit. A plate of 9.5 mm, in which they leave too flat
/// elements, is filled with 0.7 of their thickness. A plate of 5 mm, in which they do not fit at all, is
/// filled with 0.35 of it. The sharp corners of its edges, which are as near to each other, are met. A plate
/// of 3.3 mm is refused with the place. Accuracy: rounding.
#[test]
fn layers_are_thinner_where_the_section_is() {
    let sizes = SectionSizes { first_layer: 4e-3, ..SIZES };
    for (depth, refused, taken) in [(9.5e-3, &[1.0][..], 0.7), (5e-3, &[1.0, 0.7, 0.5], 0.35)] {
        let outline = plate(depth);
        let rest = &outline.rest[1..outline.rest.len() - 1];
        let closed: Vec<Point2<f64>> =
            outline.fine.iter().map(|p| p.point).chain(rest.iter().copied()).collect();
        for part in refused {
            let sizes = SectionSizes { first_layer: part * sizes.first_layer, ..sizes };
            let built = Builder::new(&outline, &sizes, &closed).build();
            let least = built.map_or(0.0, |mesh| mesh.min_scaled_jacobian());
            assert!(least < LEAST_JACOBIAN, "{depth} m, {part}: {least}");
        }
        let mesh = mesh_section(&outline, &sizes).unwrap();
        assert!(mesh.min_scaled_jacobian() > LEAST_JACOBIAN, "{depth} m: {}", mesh.min_scaled_jacobian());
        let first = (mesh.nodes[1] - mesh.nodes[0]).norm() / sizes.first_layer;
        assert!((first - taken).abs() < ROUNDOFF, "{depth} m: {first}");
        assert!((mesh.area() / (80e-3 * depth) - 1.0).abs() < ROUNDOFF, "{depth} m: {}", mesh.area());
    }
    let said = mesh_section(&plate(3.3e-3), &sizes).map(|_| ()).unwrap_err().to_string();
    assert!(said.contains("an element of scaled Jacobian 0.") && said.contains("at y = "), "{said}");
}

#[test]
fn bad_outlines_are_refused() {
    let message =
        |outline: &SectionOutline| mesh_section(outline, &SIZES).map(|_| ()).unwrap_err().to_string();
    let mut odd = head_on_a_web(0.0);
    odd.fine.pop();
    assert!(message(&odd).contains("19 elements"), "{}", message(&odd));
    let mut crossing = head_on_a_web(0.0);
    crossing.rest[1] = Point2::new(40e-3, 200e-3);
    crossing.rest[2] = Point2::new(-60e-3, 100e-3);
    assert!(message(&crossing).starts_with("section outline"), "{}", message(&crossing));
    let mut broken = head_on_a_web(0.0);
    broken.rest[1].x = f64::NAN;
    assert!(message(&broken).starts_with("section outline"), "{}", message(&broken));
}
