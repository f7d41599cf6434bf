//! A rail beam made as flexible at midspan as the solid rail that it represents.
//!
//! The ends of a short solid rail cannot warp, nor can its middle by symmetry; Timoshenko's beam knows
//! nothing of it and is up to a sixth too flexible. The correction puts the difference into the shear and
//! torsion stiffness, so that beam and stiffness law in series are the solid at the contact. With the length it goes to 1.

use nalgebra::{Matrix2, Matrix3, Rotation2, Vector2};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;

use super::rail::RailBeam;
use super::section::BeamCorrection;

/// Share of shear (or twist) in the flexibility below which it cannot be distinguished from the mesh's error in bending,
/// which is one per cent of the whole (measured on 60E1, sections of 12 mm elements); the factor then stays 1.
const LEAST_SHARE: f64 = 0.1;
/// Factors outside would not be a correction any more: the rail is too short for a beam.
const SOUND: std::ops::RangeInclusive<f64> = 0.5..=2.0;

impl BeamCorrection {
    /// The correction of `beam` that gives it the flexibility `carried` (y, z; m/N) at midspan, at `offset`
    /// (y, z; m) from the node line. Lateral and vertical flexibility are met exactly. The solid's
    /// flexibility under beam forces on its `section` (y, z in m, rotation about x in rad) gives the share of
    /// shear in the lateral one. World axes.
    ///
    /// # Errors
    /// [`InputError`] for a rail too short to be a beam.
    pub fn fit(
        beam: &RailBeam,
        offset: Vector2<f64>,
        carried: &Matrix2<f64>,
        section: &Matrix3<f64>,
    ) -> Result<Self> {
        let back = Rotation2::new(-beam.angle());
        let arm = back * offset;
        let carried = back * carried * back.inverse();
        let lateral = (back * section.fixed_view::<2, 2>(0, 0) * back.inverse())[(0, 0)];
        let length = beam.length();
        let [shear_y, shear_z] =
            [beam.section().shear_y, beam.section().shear_z].map(|stiffness| length / (4.0 * stiffness));
        let straight = beam.in_section_axes(0.5 * length);
        let (flexible_y, flexible_z, twist) = (straight[(0, 0)], straight[(1, 1)], straight[(2, 2)]);

        let factor = |was: f64, wanted: f64, whole: f64| -> Result<f64> {
            if was < LEAST_SHARE * whole {
                return Ok(1.0);
            }
            let factor = was / wanted;
            if SOUND.contains(&factor) { Ok(factor) } else { Err(too_short(length, factor).into()) }
        };
        let of_shear_y = factor(shear_y, shear_y + lateral - flexible_y, flexible_y)?;
        let flexible_y = flexible_y + shear_y / of_shear_y - shear_y;
        let by_twist = arm.y * arm.y;
        let of_torsion = factor(by_twist * twist, carried[(0, 0)] - flexible_y, carried[(0, 0)])?;
        let vertical = carried[(1, 1)] - arm.x * arm.x * twist / of_torsion;
        let of_shear_z = factor(shear_z, shear_z + vertical - flexible_z, flexible_z)?;
        Ok(Self { shear_y: of_shear_y, shear_z: of_shear_z, torsion: of_torsion })
    }
}

/// Length from which a rail of steel bends as a beam, m.
const LONG_ENOUGH: f64 = 0.4;

fn too_short(length: f64, factor: f64) -> InputError {
    InputError::new(
        InputField::RailLength,
        format!("{length} m"),
        format!(
            "a rail that bends as a beam; this one would need its shear or torsion stiffness times {factor:.2} (0.5 to 2 are sound)"
        ),
        match length < LONG_ENOUGH {
            true => "take a rail of 0.4 m or longer, or another reference than the beam",
            false => {
                "the rail is long enough: its elements may be too stiff. Take finer ones, elements that do not lock near a Poisson's ratio of 0.5 \
                 (fully integrated ones do), or another reference than the beam"
            }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::super::rail::tests::properties;
    use super::*;
    use crate::beam::Torsion;
    use crate::solid::Material;

    /// Condition of the assembled stiffness times 1e-16, as for the beam itself.
    const ROUNDOFF: f64 = 1e-8;

    /// 60E1, inclined as in the track.
    fn beam(length: f64) -> RailBeam {
        RailBeam::rail(&properties(), &Material::STEEL, length, 20, -0.025, Torsion::default()).unwrap()
    }

    /// Goal: a stub whose solid is 10 to 20 % stiffer than its beam gets factors with which the beam has the solid's
    /// lateral and vertical flexibility (m/N) at the contact, on the axis of the section and at the gauge corner.
    #[test]
    fn the_corrected_beam_is_the_solid() {
        let beam = beam(0.555);
        for offset in [Vector2::new(0.003, -0.125), Vector2::new(-0.034, -0.115)] {
            let solid = beam.static_flexibility(offset).component_mul(&Matrix2::new(0.9, 0.9, 0.9, 0.8));
            let section = beam.section_flexibility(0.5 * beam.length()) * 0.95;
            let correction = BeamCorrection::fit(&beam, offset, &solid, &section).unwrap();
            let corrected = beam.corrected(&correction).unwrap().static_flexibility(offset);
            let back = Rotation2::new(-beam.angle());
            let [wanted, found] = [solid, corrected].map(|m| back * m * back.inverse());
            for axis in 0..2 {
                let ratio = found[(axis, axis)] / wanted[(axis, axis)];
                assert!((ratio - 1.0).abs() < ROUNDOFF, "axis {axis}: {ratio} {correction:?}");
            }
            assert!(correction.shear_z > 1.1, "{correction:?}");
        }
    }

    /// Goal: what the beam has already needs no correction, bending alone in a long rail gets none, and a rail that is no
    /// beam is refused by its length.
    #[test]
    fn no_more_is_corrected_than_is_known() {
        let offset = Vector2::new(0.003, -0.125);
        let fit = |length: f64, scale: f64| {
            let beam = beam(length);
            let section = beam.section_flexibility(0.5 * length);
            BeamCorrection::fit(&beam, offset, &(beam.static_flexibility(offset) * scale), &section)
        };
        let same = fit(0.555, 1.0).unwrap();
        for factor in [same.shear_y, same.shear_z, same.torsion] {
            assert!((factor - 1.0).abs() < ROUNDOFF, "{same:?}");
        }
        let long = fit(20.0, 1.01).unwrap();
        assert_eq!((long.shear_y, long.shear_z), (1.0, 1.0));
        let error = fit(0.2, 0.3).unwrap_err().to_string();
        assert!(error.contains("rail") && error.contains("0.2 m"), "{error}");
    }
}
