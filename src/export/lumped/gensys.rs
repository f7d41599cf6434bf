//! The pair for GENSYS: all constants, the wheel's coordinate system and its rigid mass, and the modes of the free wheel for a flexible one.
//!
//! Statements as the manual's pages on `func`, `lsys` and `mass` have them. Those of couplings and of flexible masses are not written: the order of their arguments was not found.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};
use railspring_profiles::error::{InputError, Result};
use railspring_simulate::element::condensed::parts::LumpedSet;

use super::constants::literal;
use super::pair::LumpedPair;
use crate::export::spring::{ExportFile, commented};

/// A mode of mass 1 kg of a wheel whose hub is free in y, z and about x.
struct FreeMode {
    /// Hz.
    frequency: f64,
    /// Motion of the hub's centre and of the rim at the origin of the profile: y, z and rotation about x (1/m).
    hub: Vector3<f64>,
    rim: Vector3<f64>,
}

/// The file.
///
/// # Errors
/// [`InputError`] for a wheel whose mass is none.
pub(in crate::export) fn files(pair: &LumpedPair<'_>) -> Result<Vec<ExportFile>> {
    let set = &pair.element.set;
    let remarks = [
        "SI units; x along the track, y to the field side, which is to the right on a right rail, z down, f about x",
        "left out, as the order of their arguments was not found: the mass with modes (m_flex_1) and the couplings of the bushing (coupl p_lin, k, c)",
        "the contact is that of GENSYS; take knwr of the contact alone where wheel and head have the flexibility that stands here",
    ];
    let mut text = commented("#", &pair.heading("GENSYS", &remarks));
    let mut add = |name: String, value: f64, meaning: &str| {
        let _ = writeln!(text, "func const {name:12} = {:22} # {meaning}", literal(value));
    };
    let radius = pair.surfaces.geometry.pair.wheel.radius;
    add("rs_m".into(), set.hub.mass, "kg, wheel");
    add("rs_Jf".into(), set.hub.inertia, "kg m^2, about x through the hub's centre");
    add("rs_ro".into(), radius, "m, of the tape circle");
    add("rs_ycg".into(), set.hub.gravity_centre[0], "m, centre of gravity from the hub's centre");
    add("rs_zcg".into(), set.hub.gravity_centre[1], "m");
    for (i, of) in set.oscillators.iter().enumerate() {
        let mut add =
            |name: &str, value: f64, meaning: &str| add(format!("rs_{name}{}", i + 1), value, meaning);
        add("fc", of.frequency, "Hz, oscillator of 1 kg, the hub held");
        add("sy", of.lateral, "motion of the rim along y");
        add("sz", set.offset * of.turn, "along z");
        add("sf", of.turn, "1/m, rotation");
        add("cy", of.coupling[0], "kg, mass between oscillator and hub along y");
        add("cz", of.coupling[1], "kg, along z");
        add("cf", of.turn_coupling, "kg m, with the hub's rotation");
    }
    for (i, mode) in free_modes(set)?.iter().enumerate() {
        let mut add =
            |name: &str, value: f64, meaning: &str| add(format!("rs_{name}{}", i + 1), value, meaning);
        add("ff", mode.frequency, "Hz, mode of 1 kg of the wheel free in y, z and f, beside the rigid mass");
        for (of, what, moved) in [("h", "hub", mode.hub), ("r", "rim", mode.rim)] {
            add(&format!("{of}y"), moved.x, &format!("{what} along y"));
            add(&format!("{of}z"), moved.y, "along z");
            add(&format!("{of}f"), moved.z, "1/m, rotation");
        }
    }
    for (sign, of, what) in [
        ("b", &set.bushing, "bushing between head and section of the rail"),
        ("s", &set.on_section, "the same on a section that is held"),
    ] {
        add(format!("rs_k{sign}y"), of.lateral, &format!("N/m, {what}"));
        add(format!("rs_k{sign}z"), of.vertical, "N/m");
        add(format!("rs_k{sign}f"), of.turn, "N m/rad");
        add(format!("rs_h{sign}"), of.height, "m, its elastic centre above the line of shear centres");
    }
    add(
        "rs_zsc".into(),
        pair.surfaces.geometry.pair.node_line().y,
        "m, line of shear centres below the top of the rail",
    );
    add("rs_betaw".into(), pair.damping[1], "s, damping over stiffness of the wheel");
    add("rs_betar".into(), pair.damping[0], "s, of the rail");
    text.push_str(
        "# the wheel as a rigid mass in the system of your vehicle (esys_1, to be replaced); J about y is not among the constants, and is that about x here\n\
         lsys l_local rs_lsys esys_1  0. 0. 0.\n\
         mass m_rigid_6 rs_wheel rs_lsys  0. 0. -rs_ro  rs_m rs_m rs_m  rs_Jf rs_Jf rs_Jf\n",
    );
    Ok(vec![ExportFile { name: "wheel_rail_gensys.ins".into(), text }])
}

/// The modes of a wheel whose hub is free, by ascending frequency, without the three motions of the rigid body.
fn free_modes(set: &LumpedSet) -> Result<Vec<FreeMode>> {
    let wheel = set.wheel();
    let (modes, count) = (&wheel.modes, wheel.modes.len());
    let size = 3 + count;
    let mass = DMatrix::from_fn(size, size, |i, j| match (i < 3, j < 3) {
        (true, true) => wheel.mass[(i, j)],
        (true, false) => modes[j - 3].coupling[i],
        (false, true) => modes[i - 3].coupling[j],
        (false, false) => f64::from(i == j),
    });
    let stiffness = DVector::from_fn(size, |i, _| if i < 3 { 0.0 } else { modes[i - 3].square });
    let factor = mass.cholesky().ok_or_else(|| {
        InputError::new(
            "stiffness_by_angle.json: lumped.hub",
            "no mass in some direction",
            "a hub and oscillators with a mass in every direction",
            "calibrate again",
        )
    })?;
    // L⁻¹·K·L⁻ᵀ
    let inverse = factor.l().try_inverse().unwrap_or_else(|| DMatrix::zeros(size, size));
    let natural = SymmetricEigen::new(&inverse * DMatrix::from_diagonal(&stiffness) * inverse.transpose());
    let mut order: Vec<usize> = (0..size).collect();
    order.sort_by(|a, b| natural.eigenvalues[*a].total_cmp(&natural.eigenvalues[*b]));
    let carried: Matrix3<f64> = wheel.carried_by_hub();
    let mode = |&n: &usize| {
        let shape = inverse.tr_mul(&natural.eigenvectors.column(n));
        let hub = Vector3::new(shape[0], shape[1], shape[2]);
        let own: Vector3<f64> = modes.iter().enumerate().map(|(i, mode)| mode.rim * shape[3 + i]).sum();
        let (mut hub, mut rim) = (hub, carried * hub + own);
        // whichever way a solver leaves it, the rim turns to the positive side
        if rim.z < 0.0 {
            (hub, rim) = (-hub, -rim);
        }
        FreeMode { frequency: natural.eigenvalues[n].max(0.0).sqrt() / TAU, hub, rim }
    };
    Ok(order[3..].iter().map(mode).collect())
}

/// Frequencies of the modes of a wheel whose hub is free, Hz.
#[cfg(test)]
pub(super) fn free_frequencies(set: &LumpedSet) -> Result<Vec<f64>> {
    Ok(free_modes(set)?.iter().map(|mode| mode.frequency).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;
    use railspring_simulate::element::condensed::parts::LumpedElement;

    /// Source: receptance of a rigid body with the modes of a free wheel, summed, against the same from the equations of hub and oscillators, solved. Goal: displacement of the rim under a force on it (m/N), in y, z and about x, at
    /// frequencies below, between and above the resonances. Accuracy: ROUNDOFF, a solution of five equations whose numbers are four powers of ten apart.
    #[test]
    fn free_modes_and_a_rigid_mass_are_the_wheel() {
        const ROUNDOFF: f64 = 1e-9;
        let set = LumpedElement::from(&samples::lumped()).set;
        let (wheel, modes) = (set.wheel(), free_modes(&set).unwrap());
        assert_eq!(modes.len(), set.oscillators.len());
        let carried = wheel.carried_by_hub();
        for frequency in [5.0, 150.0, 230.0, 600.0, 2000.0] {
            let square = (TAU * frequency).powi(2);
            let rigid = -(carried * wheel.mass.try_inverse().unwrap() * carried.transpose()) / square;
            let of_modes =
                |mode: &FreeMode| mode.rim * mode.rim.transpose() / ((TAU * mode.frequency).powi(2) - square);
            let found = rigid + modes.iter().map(of_modes).sum::<Matrix3<f64>>();
            let count = wheel.modes.len();
            let mut dynamic = DMatrix::zeros(3 + count, 3 + count);
            let mut forces = DMatrix::zeros(3 + count, 3);
            dynamic.view_mut((0, 0), (3, 3)).copy_from(&(-square * wheel.mass));
            forces.view_mut((0, 0), (3, 3)).copy_from(&carried.transpose());
            for (i, mode) in wheel.modes.iter().enumerate() {
                dynamic.view_mut((0, 3 + i), (3, 1)).copy_from(&(-square * mode.coupling));
                dynamic.view_mut((3 + i, 0), (1, 3)).copy_from(&(-square * mode.coupling.transpose()));
                dynamic[(3 + i, 3 + i)] = mode.square - square;
                forces.view_mut((3 + i, 0), (1, 3)).copy_from(&mode.rim.transpose());
            }
            let exact = forces.tr_mul(&dynamic.lu().solve(&forces).unwrap());
            let exact = exact.fixed_view::<3, 3>(0, 0).into_owned();
            assert!((found - exact).amax() < ROUNDOFF * exact.amax(), "{frequency}: {found} {exact}");
        }
    }
}
