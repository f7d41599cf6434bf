//! A rail as a wheel that moves along it meets it: its modes at every place, and what its flexibility has there that it has not in the middle.
//!
//! A condensed rail has its contact nodes in the middle, on small elements. They resolve the head under a
//! patch, which is the same wherever the wheel is. Bending, torsion and the ends that hold sections differ
//! from place to place. Their effect is smooth along the patch. So the window of contact nodes goes with the
//! wheel. The rail comes from a second solid, of equal elements along the whole rail with all of its running
//! surface as contact nodes. Its modes move these nodes, between them by splines along the rail and its
//! profile. The flexibility of the window's nodes is that of the middle with the difference of the second
//! solid's between both places. The window moves by whole elements, so that the second solid's own error in a
//! patch is the same at both. Of the flexibility in the middle only the motion of the nodes against their
//! section counts. Bending and torsion are then those of one solid everywhere.
//!
//! What remains of the flexibility beyond the modes is then, but for the detail under a patch, the second solid's own, which stores no negative energy at any place.

use super::along::Along;
use crate::time::scenario::Scenario;
use faer::Mat;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use railspring_calibrate::mesh::{MeshOptions, mesh_rail_path, rail_grid_half_length};
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::{CondensedBody, Modes, SectionMotion, Superelement};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;

/// Length of the elements along the track, m, and the largest edges of those of the running surface and, at least, of the section.
const LAYER: f64 = 10e-3;
const SURFACE: f64 = 6e-3;
const SECTION: f64 = 12e-3;
/// The longest rail, m: all of its running surface is in one dense matrix.
const LONGEST: f64 = 1.5;
/// Motions of the window that carry less than this share of the largest difference of flexibilities are left out.
const KEPT: f64 = 1e-4;

/// A solid rail between its ends at all places of a wheel.
pub struct RailPath {
    length: f64,
    reach: f64,
    modes: Modes,
    /// Displacements of the nodes of a line of the window across the track (`3·line + axis`) along the rail: in each mode, then under a unit torque on the middle section; of a value by node, then by column.
    surface: Along,
    lines: usize,
    /// Places of the window's lines along the track from its middle, m.
    across: Vec<f64>,
    /// Motions of the contact nodes that the flexibility differs in, a column for each.
    pub(super) window: Mat<f64>,
    /// The differences between these motions' forces along the rail, m/N.
    difference: Along,
    /// Work of a unit torque on the middle section on the modes.
    pub(super) twist: DVector<f64>,
    /// Rotation of that section under it, rad/(N·m).
    pub(super) twisted: f64,
}

/// A rail where the wheel is.
pub(super) struct PathPlace {
    /// Displacements of the contact nodes in the modes, a column for each.
    pub shapes: Mat<f64>,
    /// The same under a unit torque on the middle section.
    pub twist: Vec<f64>,
    /// What the flexibility differs by from that in the middle, between the motions of the window.
    pub difference: DMatrix<f64>,
}

/// The second solid.
struct Whole {
    compliance: Mat<f64>,
    modes: Modes,
    twist: Vec<f64>,
    section: SectionMotion,
    /// Arc lengths of its lines along the profile, m.
    profile: Vec<f64>,
    /// Lines across the track without those of the ends, and their distance, m.
    sections: usize,
    pitch: f64,
}

impl Whole {
    fn new(
        pair: &Pair,
        options: &MeshOptions,
        (material, element): (&Material, Formulation),
        length: f64,
        count: usize,
    ) -> Result<Self> {
        let options = MeshOptions {
            contact_element: SURFACE,
            window_half_length: LAYER,
            contact_half_length: 0.0,
            layers: None,
            first_layer: None,
            rail_section_element: options.rail_section_element.max(SECTION),
            ..options.clone()
        };
        let mesh = mesh_rail_path(&pair.rail, &pair.placed, length, layers(length), &options)?;
        let supports = Supports { held: mesh.ends.clone(), ..Supports::default() };
        let solid = Superelement::new(System::new(&mesh, *material, element, &supports)?)?;
        let loads = pair.section_loads(&mesh, 0.0)?;
        let section = SectionMotion::new(&mesh, &loads, |forces| solid.solve(forces));
        let [_, _, torque] = &loads.unit;
        let (modes, twist) = solid.modes_along(torque, count)?;
        let contact = &mesh.contact;
        let sections = contact.along_track.len();
        Ok(Self {
            compliance: solid.compliance,
            modes,
            twist,
            section,
            profile: contact.along_profile.clone(),
            sections,
            pitch: length / (sections + 1) as f64,
        })
    }

    /// Rows of the contact nodes in some of the sections, `3·(line·sections + section) + axis`.
    fn rows(&self, sections: std::ops::Range<usize>) -> Vec<usize> {
        let nodes = (0..self.profile.len())
            .flat_map(|line| sections.clone().map(move |section| line * self.sections + section));
        nodes.flat_map(|node| (0..3).map(move |axis| 3 * node + axis)).collect()
    }
}

/// Elements along a rail, an even number.
fn layers(length: f64) -> usize {
    2 * (0.5 * length / LAYER).ceil().max(1.0) as usize
}

/// Lines of the second solid on either side of the middle of a window that reaches as far as `half_length`, m.
fn lines_over(half_length: f64, pitch: f64) -> usize {
    ((half_length / pitch) * (1.0 - 1e-9)).ceil().max(2.0) as usize
}

impl RailPath {
    /// The rail of a `pair` with the `length` (m) of the one that is condensed to the `window` of contact nodes in its middle, with at most `count` modes; `options` are those of its mesh.
    ///
    /// # Errors
    /// [`InputError`] for a rail that is too long, or too short for the window anywhere else than in its middle; an inverted element.
    pub fn new(
        pair: &Pair,
        window: &CondensedBody,
        options: &MeshOptions,
        material: &Material,
        element: Formulation,
        (length, count): (f64, usize),
    ) -> Result<Self> {
        let across = window.grid.along_track.clone();
        let half_length = across.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let pitch = length / layers(length) as f64;
        let beside = lines_over(half_length, pitch);
        let reach = (beside + 1) as f64 * pitch;
        let refuse = |expected: String, advice: &str| {
            InputError::new(InputField::RailLength, format!("{length} m"), expected, advice)
        };
        if length > LONGEST {
            let expected = format!("{LONGEST} m at most for a solid rail along which a wheel moves");
            let advice = format!("set `{}` = false, or shorten the rail", InputField::SolidModel);
            return Err(refuse(expected, &advice).into());
        }
        let places = layers(length) + 1 - 2 * (beside + 1);
        if layers(length) + 1 < 2 * (beside + 1) + Along::LEAST {
            let expected =
                format!("more than {:.3} m, of which the wheel may move along the middle", 2.0 * reach);
            return Err(refuse(expected, "take a longer rail or a shorter `window_half_length`").into());
        }
        let whole = Whole::new(pair, options, (material, element), length, count)?;
        let s = &whole.profile;
        let spacing = (s[s.len() - 1] - s[0]) / (s.len() - 1) as f64;
        let along_profile = Along::weights(s[0], spacing, s.len(), &window.grid.along_profile);
        let surface = surface(&whole, &along_profile, length);
        let own = window.section.as_ref().ok_or_else(|| {
            InputError::new(
                "condensed rail",
                "no motion of its section",
                "a rail that is condensed between its ends",
                "condense it with `PairSolids::condense`",
            )
        })?;
        let (window, difference) = difference(&whole, own, &along_profile, (&across, beside, places));
        Ok(Self {
            length,
            reach,
            surface,
            lines: along_profile.nrows(),
            across,
            window,
            difference: Along::new(reach - 0.5 * length, pitch, difference),
            twist: DVector::from_column_slice(&whole.twist),
            twisted: whole.section.flexibility[(2, 2)],
            modes: whole.modes,
        })
    }

    /// Whether a load case has more of a rail than its middle: one with a torsion, or with a wheel that moves or stands elsewhere.
    pub fn is_wanted(scenario: &Scenario, length: f64) -> bool {
        let elsewhere = scenario.start_x.is_some_and(|x| (x - 0.5 * length).abs() > 1e-9 * length);
        elsewhere || scenario.speed != 0.0 || scenario.rail_torsion.is_some()
    }

    /// How near an end of a rail of a `length` (m) with the mesh of `options` the wheel may come, m.
    pub fn reach(length: f64, options: &MeshOptions) -> f64 {
        let pitch = length / layers(length) as f64;
        (lines_over(rail_grid_half_length(length, options), pitch) + 1) as f64 * pitch
    }

    /// Checks that a wheel stays on the `length` (m) of a rail but for the `reach` (m) at either end.
    ///
    /// # Errors
    /// [`InputError`] with the place where it does not.
    pub fn check(scenario: &Scenario, length: f64, reach: f64) -> std::result::Result<(), InputError> {
        let start = scenario.start_x.unwrap_or(0.5 * length);
        let duration = scenario.steps as f64 * scenario.time_step;
        let end = start + scenario.speed * duration;
        let slack = 1e-9 * length;
        let within = |x: f64| x >= reach - slack && x <= length - reach + slack;
        // rounded into the range, so that its ends can be taken as they are printed
        let (first, last) =
            ((reach * 1e4 - 1e-6).ceil() * 1e-4, ((length - reach) * 1e4 + 1e-6).floor() * 1e-4);
        let expected = format!("{first:.4} to {last:.4} m, as far as the solid rail knows of a contact");
        let without = format!(
            "lengthen the rail (`{}`), or set `{}` = false and the simple model runs alone",
            InputField::RailLength,
            InputField::SolidModel
        );
        if !within(start) {
            let advice = format!("start in that range, {without}");
            return Err(InputError::new(InputField::StartX, format!("{start} m"), expected, advice));
        }
        if !within(end) {
            let value = format!("{} m/s, which brings the wheel from {start} to {end} m", scenario.speed);
            let advice = format!(
                "lower the speed, take fewer steps (`{}`), start elsewhere (`{}`), {without}",
                InputField::Steps,
                InputField::StartX
            );
            return Err(InputError::new(InputField::Speed, value, expected, advice));
        }
        Ok(())
    }

    /// Checks that a load case stays where it has the rail.
    pub(super) fn holds(&self, scenario: &Scenario) -> std::result::Result<(), InputError> {
        Self::check(scenario, self.length, self.reach)
    }

    /// Place of the wheel from the middle of the rail at time `t` (s), m.
    pub(super) fn place(&self, scenario: &Scenario, t: f64) -> f64 {
        scenario.start_x.map_or(0.0, |x| x - 0.5 * self.length) + scenario.speed * t
    }

    /// The modes.
    pub(super) fn modes(&self) -> &Modes {
        &self.modes
    }

    /// The rail with the first `count` modes where the wheel is at `x`, m from the middle.
    pub(super) fn at(&self, x: f64, count: usize) -> PathPlace {
        let (rows, columns) = (3 * self.lines, self.across.len());
        let all = self.modes.count() + 1;
        let mut shapes = Mat::zeros(rows * columns, count);
        let mut twist = vec![0.0; rows * columns];
        for (place, offset) in self.across.iter().enumerate() {
            let values = self.surface.at(x + offset);
            for row in 0..rows {
                let of_node = &values.as_slice()[row * all..(row + 1) * all];
                let to = 3 * ((row / 3) * columns + place) + row % 3;
                (0..count).for_each(|mode| shapes[(to, mode)] = of_node[mode]);
                twist[to] = of_node[all - 1];
            }
        }
        let motions = self.window.ncols();
        let values = self.difference.at(x);
        PathPlace {
            shapes,
            twist,
            difference: DMatrix::from_column_slice(motions, motions, values.as_slice()),
        }
    }
}

/// Modes and twist on the lines of the window along the profile, along the rail; at its ends nothing moves.
fn surface(whole: &Whole, along_profile: &DMatrix<f64>, length: f64) -> Along {
    let (lines, own, all) = (along_profile.nrows(), whole.profile.len(), whole.modes.count() + 1);
    let of_column = |column: usize| match column + 1 < all {
        true => whole.modes.contact(column),
        false => whole.section.moved(2),
    };
    let mut values = DMatrix::zeros(3 * lines * all, whole.sections + 2);
    for column in 0..all {
        let moved = of_column(column);
        for section in 0..whole.sections {
            let of_own =
                DMatrix::from_fn(own, 3, |line, axis| moved[3 * (line * whole.sections + section) + axis]);
            let of_window = along_profile * of_own;
            for (line, axis) in (0..lines).flat_map(|line| (0..3).map(move |axis| (line, axis))) {
                values[((3 * line + axis) * all + column, section + 1)] = of_window[(line, axis)];
            }
        }
    }
    Along::new(-0.5 * length, whole.pitch, values)
}

/// What the flexibility of a window of `beside` sections on either side has at so many `places` beyond that in the middle: the motions of the window's nodes in which it differs, and the differences between these,
/// a column for each place.
fn difference(
    whole: &Whole,
    own_section: &SectionMotion,
    along_profile: &DMatrix<f64>,
    (across, beside, places): (&[f64], usize, usize),
) -> (Mat<f64>, DMatrix<f64>) {
    let at = |first: usize| {
        let rows = whole.rows(first..first + 2 * beside + 1);
        DMatrix::from_fn(rows.len(), rows.len(), |i, k| {
            0.5 * (whole.compliance[(rows[i], rows[k])] + whole.compliance[(rows[k], rows[i])])
        })
    };
    let middle = at(whole.sections / 2 - beside);
    let differences: Vec<DMatrix<f64>> = (0..places).map(|place| at(place) - &middle).collect();
    let scale = differences.iter().map(|difference| difference.amax()).fold(f64::MIN_POSITIVE, f64::max);
    let size = middle.nrows();
    let mut squares = DMatrix::zeros(size, size);
    for difference in &differences {
        let scaled = difference / scale;
        squares.gemm(1.0, &scaled, &scaled, 1.0);
    }
    let eigen = SymmetricEigen::new(squares);
    let largest = eigen.eigenvalues.max();
    let kept: Vec<usize> =
        (0..size).filter(|&n| eigen.eigenvalues[n] > KEPT * KEPT * largest && largest > 0.0).collect();
    let motions = DMatrix::from_fn(size, kept.len(), |row, n| eigen.eigenvectors[(row, kept[n])]);
    let (sections, columns) = (2 * beside + 1, across.len());
    let first = -(beside as f64) * whole.pitch;
    let along_track = Along::weights(first, whole.pitch, sections, across);
    // motions of the second solid's window at the nodes of the window
    let at_nodes = |motion: &dyn Fn(usize) -> f64, to: &mut [f64]| {
        for axis in 0..3 {
            let of_whole = DMatrix::from_fn(whole.profile.len(), sections, |line, section| {
                motion(3 * (line * sections + section) + axis)
            });
            let of_window = along_profile * of_whole * along_track.transpose();
            for (line, column) in (0..along_profile.nrows()).flat_map(|l| (0..columns).map(move |c| (l, c))) {
                to[3 * (line * columns + column) + axis] = of_window[(line, column)];
            }
        }
    };
    // the part of the section in either solid, T·Sᵀ + S·Tᵀ - T·F·Tᵀ of what its own forces move, S, and what moves with it, T
    let rigid = own_section.arms();
    let of_middle = whole.rows(whole.sections / 2 - beside..whole.sections / 2 + beside + 1);
    let count = kept.len() + 9;
    let mut window = Mat::zeros(3 * along_profile.nrows() * columns, count);
    for n in 0..kept.len() {
        at_nodes(&|row| motions[(row, n)], window.col_as_slice_mut(n));
    }
    for k in 0..3 {
        let of_whole = whole.section.moved(k);
        window.col_as_slice_mut(kept.len() + k).copy_from_slice(&rigid[k]);
        window.col_as_slice_mut(kept.len() + 3 + k).copy_from_slice(own_section.moved(k));
        at_nodes(&|row| of_whole[of_middle[row]], window.col_as_slice_mut(kept.len() + 6 + k));
    }
    let mut values = DMatrix::zeros(count * count, places);
    for (place, difference) in differences.iter().enumerate() {
        let mut between = DMatrix::zeros(count, count);
        let kept_part = motions.transpose() * difference * &motions;
        between.view_mut((0, 0), (kept.len(), kept.len())).copy_from(&kept_part);
        for i in 0..3 {
            for k in 0..3 {
                let of_own = own_section.flexibility[(i, k)] - whole.section.flexibility[(i, k)];
                between[(kept.len() + i, kept.len() + k)] += of_own;
            }
            for (motion, sign) in [(3 + i, -1.0), (6 + i, 1.0)] {
                between[(kept.len() + i, kept.len() + motion)] += sign;
                between[(kept.len() + motion, kept.len() + i)] += sign;
            }
        }
        values.column_mut(place).copy_from_slice(between.as_slice());
    }
    (window, values)
}

#[cfg(test)]
mod tests;
