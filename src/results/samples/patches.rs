//! Made-up contact patches.

use crate::results::patches::record::{BelowRecord, PatchRecord, PatchesRecord, PointState};

/// Stresses below a patch, of about the right shape.
fn below(semi_axis: f64, largest: f64) -> BelowRecord {
    let depth_mm: Vec<f64> = (0..60).map(|n| 0.05 * f64::from(n) * semi_axis).collect();
    let shape = |depth: f64| 2.5 * (depth / semi_axis + 0.1) * (-1.9 * depth / semi_axis).exp();
    let von_mises_mpa: Vec<f64> = depth_mm.iter().map(|depth| largest * shape(*depth)).collect();
    let shear_mpa = von_mises_mpa.iter().map(|stress| 0.55 * stress).collect();
    BelowRecord { across_mm: 0.0, along_mm: 0.0, depth_mm, von_mises_mpa, shear_mpa }
}

/// Patches of Hertz' shape on the crown.
pub(crate) fn patches() -> PatchesRecord {
    let patch = |force_kn: f64| {
        let [a, b] = [1.2, 1.4].map(|axis| axis * f64::cbrt(force_kn));
        let lines = |semi: f64| (-12..=12).map(|n| 0.1 * f64::from(n) * semi).collect::<Vec<f64>>();
        let (across_mm, along_mm) = (lines(a), lines(b));
        let each = |s: &f64| along_mm.iter().map(|x| (s / a).hypot(x / b)).collect::<Vec<f64>>();
        let radii: Vec<Vec<f64>> = across_mm.iter().map(each).collect();
        let state = |r: &f64| match *r {
            r if r < 0.6 => PointState::Stick,
            r if r < 1.0 => PointState::Slip,
            _ => PointState::Open,
        };
        let largest = 260.0 * force_kn.cbrt();
        PatchRecord {
            force_kn,
            rail_y_mm: across_mm.iter().map(|s| s - 12.1).collect(),
            rail_z_mm: across_mm.iter().map(|s| 0.4 - 0.04 * s).collect(),
            pressure_mpa: radii
                .iter()
                .map(|row| row.iter().map(|r| largest * (1.0 - r * r).max(0.0).sqrt()).collect())
                .collect(),
            state: radii.iter().map(|row| row.iter().map(state).collect()).collect(),
            max_pressure_mpa: largest,
            below: Some(below(a, largest)),
            across_mm,
            along_mm,
        }
    };
    PatchesRecord {
        study: "sample".into(),
        reference: "beam".into(),
        field: "hybrid".into(),
        friction: 0.5,
        patches: [1.0, 52.0, 150.0].map(patch).to_vec(),
        input_hash: "0123456789abcdef".repeat(4),
        version: "0.1.0".into(),
    }
}
