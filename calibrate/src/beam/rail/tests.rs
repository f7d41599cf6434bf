use super::*;
use crate::analytic::beam::{Bending, Span, fixed_midspan_twist, restrained_warping_factor};
use nalgebra::{Cholesky, DMatrix, SymmetricEigen};
use std::f64::consts::PI;

/// Condition of the assembled stiffness (1e6 to 1e7 for 20 elements) times 1e-16, a factor of ten spare.
const ROUNDOFF: f64 = 1e-8;

const LENGTH: f64 = 0.555;

/// 60E1, from its published properties.
pub(in crate::beam) fn properties() -> SectionProperties {
    SectionProperties {
        area: 76.7e-4,
        centroid_height: 80.92e-3,
        ixx: 3038.3e-8,
        iyy: 512.3e-8,
        torsion_constant: 221.2e-8,
        warping_constant: 1.6e-8,
        shear_centre_height: 46.3e-3,
        shear_coefficient_vertical: 0.393,
        shear_coefficient_lateral: 0.54,
    }
}

fn section() -> BeamSection {
    BeamSection::rail(&properties(), &Material::STEEL, LENGTH, Torsion::SaintVenant).unwrap()
}

fn planes(section: &BeamSection, length: f64) -> [Bending; 2] {
    [(section.bending_y, section.shear_y), (section.bending_z, section.shear_z)]
        .map(|(bending_stiffness, shear_stiffness)| Bending { length, bending_stiffness, shear_stiffness })
}

fn relative(value: f64, exact: f64) -> f64 {
    (value / exact - 1.0).abs()
}

/// Source: Timoshenko beam, closed form. Goal: tip deflection of a cantilever (m/N), exact for any number of elements.
#[test]
fn cantilever_is_exact() {
    for elements in [1, 3, 20] {
        let section = section();
        let beam = RailBeam::new(section, LENGTH, elements, 0.0, [End::Fixed, End::Free]).unwrap();
        let flexibility = beam.section_flexibility(LENGTH);
        for (i, plane) in planes(&section, LENGTH).iter().enumerate() {
            assert!(relative(flexibility[(i, i)], plane.cantilever_deflection()) < ROUNDOFF);
        }
        assert!(relative(flexibility[(2, 2)], LENGTH / section.torsion) < ROUNDOFF);
    }
}

/// Source: Timoshenko beam, closed form. Goal: midspan deflections and twist with fixed and with pinned ends.
#[test]
fn midspan_is_exact() {
    let section = section();
    for (ends, pinned) in [([End::Fixed; 2], false), ([End::Pinned; 2], true)] {
        let beam = RailBeam::new(section, LENGTH, 20, 0.0, ends).unwrap();
        let flexibility = beam.section_flexibility(0.5 * LENGTH);
        for (i, plane) in planes(&section, LENGTH).iter().enumerate() {
            let exact =
                if pinned { plane.pinned_midspan_deflection() } else { plane.fixed_midspan_deflection() };
            assert!(relative(flexibility[(i, i)], exact) < ROUNDOFF);
        }
        assert!(relative(flexibility[(2, 2)], fixed_midspan_twist(LENGTH, section.torsion)) < ROUNDOFF);
    }
}

/// Goal: with the default torsion the midspan twist is Vlasov's, about four times stiffer than St-Venant's.
#[test]
fn default_torsion_includes_restrained_warping() {
    let beam = RailBeam::rail(&properties(), &Material::STEEL, LENGTH, 20, 0.0, Torsion::default()).unwrap();
    let twist = beam.section_flexibility(0.5 * LENGTH)[(2, 2)];
    let saint_venant = Material::STEEL.shear_modulus() * properties().torsion_constant;
    let warping = Material::STEEL.young * properties().warping_constant;
    let free = fixed_midspan_twist(LENGTH, saint_venant);
    assert!(relative(twist, free * restrained_warping_factor(LENGTH, saint_venant, warping)) < ROUNDOFF);
    assert!((3.5..5.5).contains(&(free / twist)), "{}", free / twist);
}

/// Goal: a force at the rail head works through its lever to the node line; the inclined section keeps its
/// invariants.
#[test]
fn attached_point_adds_lever_and_inclination_turns_axes() {
    let angle = 0.025;
    let level = RailBeam::new(section(), LENGTH, 20, 0.0, [End::Fixed; 2]).unwrap();
    let inclined = RailBeam::new(section(), LENGTH, 20, angle, [End::Fixed; 2]).unwrap();
    let offset = Vector2::new(0.003, -0.125);
    let (s, at_head) = (level.section_flexibility(0.5 * LENGTH), level.static_flexibility(offset));
    assert!(relative(at_head[(0, 0)], s[(0, 0)] + s[(2, 2)] * offset.y.powi(2)) < ROUNDOFF);
    assert!(relative(at_head[(1, 1)], s[(1, 1)] + s[(2, 2)] * offset.x.powi(2)) < ROUNDOFF);
    assert!(relative(at_head[(0, 1)], -s[(2, 2)] * offset.x * offset.y) < ROUNDOFF);
    let turn = nalgebra::Rotation2::new(angle);
    let turned = turn * at_head * turn.inverse();
    let direct = inclined.static_flexibility(turn * offset);
    assert!((turned - direct).norm() < ROUNDOFF * direct.norm());
}

/// Goal: between the nodes the element's own functions reproduce a finer mesh, up to the deflection of the
/// loaded element as a fixed-fixed beam, which nodal functions cannot hold.
#[test]
fn inside_an_element_only_its_own_deflection_is_missing() {
    let section = section();
    let coarse = RailBeam::new(section, LENGTH, 20, 0.0, [End::Fixed; 2]).unwrap();
    let fine = RailBeam::new(section, LENGTH, 40, 0.0, [End::Fixed; 2]).unwrap();
    let x = LENGTH * 19.0 / 40.0;
    let missing = planes(&section, LENGTH / 20.0)[1].fixed_midspan_deflection();
    let (short, full) = (coarse.section_flexibility(x)[(1, 1)], fine.section_flexibility(x)[(1, 1)]);
    assert!(relative(short + missing, full) < ROUNDOFF, "{short:e} + {missing:e} != {full:e}");
}

/// Source: the same beam with 20 elements, of which every node carries all digits. Goal: the static flexibility (m/N, rad/(N·m)) of a beam with ten
/// thousand elements, near either end and in the middle, whose assembled stiffness has a condition of 1e16. Accuracy: ROUNDOFF, and what the
/// functions of an element miss under its own load, (1/1000)³.
#[test]
fn short_elements_lose_no_digits() {
    let section = section();
    for ends in [[End::Fixed; 2], [End::Pinned; 2], [End::Fixed, End::Free], [End::Free, End::Fixed]] {
        let [coarse, fine] =
            [20, 10_000].map(|elements| RailBeam::new(section, LENGTH, elements, 0.3, ends).unwrap());
        for part in [0.05, 0.5, 0.95] {
            let [coarse, fine] = [&coarse, &fine].map(|beam| beam.section_flexibility(part * LENGTH));
            for i in 0..3 {
                for j in 0..3 {
                    let scale = (coarse[(i, i)] * coarse[(j, j)]).sqrt();
                    let off = (fine[(i, j)] - coarse[(i, j)]).abs();
                    assert!(off < ROUNDOFF * scale, "{ends:?} {part}: {coarse} {fine}");
                }
            }
        }
    }
}

/// Matrices of a beam with pinned ends, every unknown of its nodes, and which of these are free.
fn dense(section: &BeamSection, length: f64, elements: usize) -> [DMatrix<f64>; 2] {
    let element = BeamElement { section, length: length / elements as f64, angle: 0.0 };
    let size = 6 * (elements + 1);
    let free: Vec<usize> = (0..size).filter(|&i| i % 6 > 3 || i >= 6 && i < size - 6).collect();
    [element.mass(), element.stiffness()].map(|matrix| {
        let mut sum = DMatrix::zeros(size, size);
        for first in (0..6 * elements).step_by(6) {
            let mut own = sum.fixed_view_mut::<12, 12>(first, first);
            own += matrix;
        }
        DMatrix::from_fn(free.len(), free.len(), |i, j| sum[(free[i], free[j])])
    })
}

/// Source: simply supported Timoshenko beam, both branches. Goal: the first bending frequencies of the matrices of the elements. The static functions
/// miss the shear deflection of an element under its own inertia: an error of some (h/L)²·(n·π/L)²·EI/κGA, measured
/// 6.2e-5 with 20 elements and 1.5e-5 with 40.
#[test]
fn the_elements_vibrate_as_a_timoshenko_beam() {
    const DISCRETISATION: f64 = 1e-4;
    let mut section = section();
    section.centroid = [0.0, 0.0];
    let [mass, stiffness] = dense(&section, 2.0, 20);
    let factor = Cholesky::new(mass).unwrap().unpack();
    let half = factor.solve_lower_triangular(&stiffness).unwrap();
    let squares = SymmetricEigen::new(factor.solve_lower_triangular(&half.transpose()).unwrap()).eigenvalues;
    for plane in 0..2 {
        let inertia = [section.rotary_y, section.rotary_z][plane];
        let bending = planes(&section, 2.0)[plane];
        let span = Span { bending, mass_per_length: section.mass, rotary_inertia: inertia };
        for n in [1.0, 2.0] {
            let exact = span.branches(n * PI / 2.0)[0].0;
            let nearest = squares.iter().map(|s| relative(s.sqrt(), exact)).fold(f64::INFINITY, f64::min);
            assert!(nearest < DISCRETISATION * n.powi(4), "plane {plane} mode {n}: {nearest:e}");
        }
    }
}

#[test]
fn unusable_beams_are_named() {
    let message = |length, elements, ends| {
        RailBeam::new(section(), length, elements, 0.0, ends).unwrap_err().to_string()
    };
    assert!(message(-1.0, 20, [End::Fixed; 2]).contains("rail_length"));
    assert!(message(1.0, 0, [End::Fixed; 2]).contains("beam_elements"));
    assert!(message(1.0, 10_001, [End::Fixed; 2]).contains("10000"));
    for ends in [[End::Free; 2], [End::Pinned, End::Free], [End::Free, End::Pinned]] {
        assert!(message(1.0, 5, ends).contains("singular"));
    }
    let mut bad = properties();
    bad.torsion_constant = f64::NAN;
    let error = BeamSection::rail(&bad, &Material::STEEL, LENGTH, Torsion::default()).unwrap_err();
    assert!(error.to_string().contains("section of the beam"));
}
