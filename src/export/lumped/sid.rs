//! The wheel as standard input data of a flexible body (SID): the text format of O. Wallrapp, "Standardization of flexible body modeling in
//! multibody system codes, part I: definition of standard input data", Mech. Struct. Mach. 22 (1994), laid out as the program FEMBS writes it.
//!
//! The body's frame is at the hub's centre. Node 1 is the hub, node 2 the rim at the origin of the profile. The elastic coordinates are the oscillators. What a plane model does not have is
//! zero: inertia about the axle, and the terms of second order of a body that spins.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use nalgebra::{DMatrix, Vector3};
use railspring_simulate::element::condensed::parts::LumpedSet;

/// Column of the sign of equality.
const EQUALS: usize = 48;

/// Indents of the blocks of the body, of those of a node, and of what stands in either.
const BLOCK: usize = 11;
const NODE: usize = 16;
const OF_NODE: usize = 21;
const ENTRY: usize = 26;

/// The file of the wheel of a `set`, with its `damping` over stiffness, s.
pub(super) fn wheel(set: &LumpedSet, damping: f64) -> String {
    let wheel = set.wheel();
    let modes = &wheel.modes;
    let nq = modes.len();
    let of = |value: &dyn Fn(usize) -> Vector3<f64>| DMatrix::from_fn(3, nq, |i, mode| value(mode)[i]);
    // y, z and the rotation about x of the plane, in space
    let moved = |of: &Vector3<f64>| Vector3::new(0.0, of.x, of.y);
    let turned = |of: &Vector3<f64>| Vector3::new(of.z, 0.0, 0.0);
    let nothing = DMatrix::zeros(3, nq);
    let [rim, psi] = [of(&|mode| moved(&modes[mode].rim)), of(&|mode| turned(&modes[mode].rim))];
    let [ct, cr] = [of(&|mode| moved(&modes[mode].coupling)), of(&|mode| turned(&modes[mode].coupling))];
    let stiffness = DMatrix::from_fn(nq, nq, |i, j| if i == j { modes[i].square } else { 0.0 });
    let mut w = Writer::default();
    let title = format!("SID of a lumped wheel, railspring {}", env!("CARGO_PKG_VERSION"));
    let _ = writeln!(w.0, "{:5}{nq:4}    :No. nodes, No. modes:{title}", 2);
    w.line(1, "part");
    w.key(6, "new modal", " railspring_wheel");
    w.line(BLOCK, "refmod");
    w.key(NODE, "mass", &real(set.hub.mass));
    w.key(NODE, "nelastq", &format!("{nq:4}"));
    for (i, mode) in modes.iter().enumerate() {
        let name = format!(" Eigen Mode {:4} : {:12.3} Hz", i + 1, mode.square.sqrt() / TAU);
        w.key(NODE, &format!("ielastq ({:4})", i + 1), &name);
    }
    w.line(BLOCK, "end refmod");
    w.line(BLOCK, "frame");
    w.node(1, Vector3::zeros(), [&nothing, &nothing]);
    // the origin of the profile as seen from the hub
    let [y, z] = wheel.hub;
    w.node(2, Vector3::new(0.0, -y, -z), [&rim, &psi]);
    w.line(BLOCK, "end frame");
    let [y, z] = set.hub.gravity_centre.map(|m| m * set.hub.mass);
    w.block(
        BLOCK,
        "mdCM",
        &Taylor::of(DMatrix::from_column_slice(3, 1, &[0.0, y, z])).with(nq, |i, mode, _| ct[(i, mode)]),
    );
    // xx, yy, zz, xy, xz, yz; of a body of revolution about y
    let inertia = [set.hub.inertia, 0.0, set.hub.inertia, 0.0, 0.0, 0.0];
    w.block(BLOCK, "J", &Taylor::of(DMatrix::from_column_slice(6, 1, &inertia)).with(nq, |_, _, _| 0.0));
    w.block(BLOCK, "Ct", &Taylor::of(ct.transpose()).of_modes(nq));
    w.block(BLOCK, "Cr", &Taylor::of(cr.transpose()).of_modes(nq));
    w.block(BLOCK, "Me", &Taylor::symmetric(DMatrix::identity(nq, nq)));
    for (name, rows, columns) in [("Gr", 3, 3 * nq), ("Ge", nq, 3 * nq), ("Oe", nq, 6), ("ksigma", nq, 1)] {
        w.block(BLOCK, name, &Taylor::of(DMatrix::zeros(rows, columns)).of_modes(nq));
    }
    w.block(BLOCK, "Ke", &Taylor::symmetric(stiffness.clone()));
    w.block(BLOCK, "De", &Taylor::symmetric(stiffness * damping));
    w.line(6, "end modal");
    w.line(1, "end part");
    w.0
}

/// A matrix, with its changes by the elastic coordinates if it has any.
struct Taylor {
    constant: DMatrix<f64>,
    modes: usize,
    /// By row, coordinate and column.
    linear: Vec<(usize, usize, usize, f64)>,
    order: usize,
    structure: usize,
}

impl Taylor {
    /// Without changes: zero, or of any structure.
    fn of(constant: DMatrix<f64>) -> Self {
        let structure = if constant.amax() > 0.0 { 3 } else { 0 };
        Self { constant, modes: 0, linear: Vec::new(), order: 0, structure }
    }

    /// A symmetric one.
    fn symmetric(constant: DMatrix<f64>) -> Self {
        let modes = constant.nrows();
        Self { modes, structure: 2, ..Self::of(constant) }
    }

    /// For so many elastic coordinates.
    fn of_modes(self, modes: usize) -> Self {
        Self { modes, ..self }
    }

    /// With changes by so many elastic coordinates: by row, coordinate and column.
    fn with(self, modes: usize, change: impl Fn(usize, usize, usize) -> f64) -> Self {
        let mut linear = Vec::new();
        for column in 0..self.constant.ncols() {
            for row in 0..self.constant.nrows() {
                let all = (0..modes).map(|mode| (row, mode, column, change(row, mode, column)));
                linear.extend(all.filter(|entry| entry.3 != 0.0));
            }
        }
        let structure = if linear.is_empty() { self.structure } else { 3 };
        Self { modes, linear, order: 1, structure, ..self }
    }
}

/// Lines of a file.
#[derive(Default)]
struct Writer(String);

impl Writer {
    fn line(&mut self, indent: usize, text: &str) {
        let _ = writeln!(self.0, "{:indent$}{text}", "");
    }

    fn key(&mut self, indent: usize, key: &str, value: &str) {
        let _ = writeln!(self.0, "{:EQUALS$}={value}", format!("{:indent$}{key}", ""));
    }

    fn block(&mut self, indent: usize, name: &str, of: &Taylor) {
        self.line(indent, name);
        let (rows, columns) = of.constant.shape();
        for (key, value) in [
            ("order", of.order),
            ("nrow", rows),
            ("ncol", columns),
            ("nq", of.modes),
            ("nqn", 0),
            ("structure", of.structure),
        ] {
            self.key(ENTRY, key, &format!("{value:5}"));
        }
        for row in 0..rows {
            for column in (0..columns).filter(|column| of.constant[(row, *column)] != 0.0) {
                let value = real(of.constant[(row, column)]);
                self.key(ENTRY, &format!("m0({:2},{:2})", row + 1, column + 1), &value);
            }
        }
        for &(row, mode, column, value) in &of.linear {
            self.key(ENTRY, &format!("m1({:2},{:2},{:2})", row + 1, mode + 1, column + 1), &real(value));
        }
        self.line(indent, &format!("end {name}"));
    }

    /// A node with its displacements and rotations (3 × coordinates).
    fn node(&mut self, number: usize, origin: Vector3<f64>, [phi, psi]: [&DMatrix<f64>; 2]) {
        let nq = phi.ncols();
        self.key(NODE, "new node", &format!("{number:9}"));
        self.key(OF_NODE, "rframe", " body ref");
        let place = Taylor::of(DMatrix::from_column_slice(3, 1, origin.as_slice()));
        self.block(OF_NODE, "origin", &place.with(nq, |i, mode, _| phi[(i, mode)]));
        self.block(OF_NODE, "phi", &Taylor::of(phi.clone()).of_modes(nq));
        self.block(OF_NODE, "psi", &Taylor::of(psi.clone()).of_modes(nq));
        // with its ones: a reader of this format takes a unit matrix that only says it is one as zero
        let axes = Taylor::of(DMatrix::identity(3, 3));
        let turns = |row: usize, mode: usize, column: usize| -> f64 {
            let of_mode = Vector3::from_iterator(psi.column(mode).iter().copied());
            of_mode.cross_matrix()[(row, column)]
        };
        self.block(OF_NODE, "AP", &axes.with(nq, turns));
        self.line(NODE, "end node");
    }
}

/// A number as Fortran has it: a place for the sign, twelve digits.
fn real(value: f64) -> String {
    let space = if value < 0.0 { "" } else { " " };
    format!("{space}{}", scientific(value, 11, 'D'))
}

/// A number with so many digits behind its point, and two of its exponent behind a sign and a letter.
pub(super) fn scientific(value: f64, digits: usize, letter: char) -> String {
    let text = format!("{:.digits$E}", value + 0.0);
    let (mantissa, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}{letter}{sign}{:02}", exponent.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;
    use nalgebra::SymmetricEigen;
    use railspring_simulate::element::condensed::parts::LumpedElement;
    use std::collections::BTreeMap;

    /// Matrices of a file by their block and node, constant and by row, coordinate and column; in the order of the file.
    #[derive(Default)]
    struct Read {
        order: Vec<String>,
        constant: BTreeMap<String, DMatrix<f64>>,
        linear: BTreeMap<String, BTreeMap<[usize; 3], f64>>,
        mass: f64,
    }

    fn value(text: &str) -> f64 {
        text.trim().replace('D', "E").parse().unwrap()
    }

    /// Reads the layout that FEMBS writes: the sign of equality in column 49, blocks that end by their name.
    fn read(text: &str) -> Read {
        let mut read = Read::default();
        let (mut block, mut node, mut size) = (None, String::new(), [0; 2]);
        for line in text.lines().skip(1) {
            assert!(line.is_ascii() && line.trim_end() == line, "{line:?}");
            let Some((key, of)) =
                line.split_at_checked(48).and_then(|(key, rest)| Some((key.trim(), rest.strip_prefix('=')?)))
            else {
                let word = line.trim();
                if block.as_deref().is_some_and(|open| word == format!("end {open}")) {
                    block = None;
                } else if block.is_none()
                    && !word.starts_with("end ")
                    && !["part", "refmod", "frame"].contains(&word)
                {
                    block = Some(word.to_string());
                    read.order.push(format!("{node}{word}"));
                } else if word == "end node" {
                    node.clear();
                }
                continue;
            };
            let name = format!("{node}{}", block.as_deref().unwrap_or_default());
            let index: Vec<usize> = key
                .split_once('(')
                .map(|(_, list)| {
                    list.trim_end_matches(')').split(',').map(|i| i.trim().parse().unwrap()).collect()
                })
                .unwrap_or_default();
            match (key.split('(').next().unwrap(), &*index) {
                ("new node", _) => node = format!("{} ", of.trim()),
                ("mass", _) => read.mass = value(of),
                ("nrow", _) => size[0] = of.trim().parse().unwrap(),
                ("ncol", _) => size[1] = of.trim().parse().unwrap(),
                ("structure", _) => {
                    read.constant.insert(name, DMatrix::zeros(size[0], size[1]));
                }
                ("m0", &[row, column]) => {
                    read.constant.get_mut(&name).unwrap()[(row - 1, column - 1)] = value(of)
                }
                ("m1", &[row, mode, column]) => {
                    read.linear.entry(name).or_default().insert([row - 1, mode - 1, column - 1], value(of));
                }
                _ => {}
            }
        }
        read
    }

    /// Source: the order and the meaning of the blocks in files of FEMBS, and the equations of a flexible body about its frame (Wallrapp 1994). Goal: read again, the file has all blocks in their order, changes of places and
    /// axes that are those of its displacements and rotations, and, with the hub held and free in the plane, the frequencies (Hz) of the lumped wheel. Accuracy: WRITTEN, twelve digits of each number.
    #[test]
    fn the_file_is_the_wheel() {
        const WRITTEN: f64 = 1e-10;
        let set = LumpedElement::from(&samples::lumped()).set;
        let text = wheel(&set, 6e-6);
        let read = read(&text);
        let of_node = ["origin", "phi", "psi", "AP"];
        let nodes = ["1 ", "2 "].iter().flat_map(|node| of_node.map(|name| format!("{node}{name}")));
        let body = ["mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De"].map(String::from);
        assert_eq!(read.order, nodes.chain(body).collect::<Vec<_>>());
        assert_eq!(text.lines().next().unwrap()[..9], *"    2   2");
        let near = |found: f64, exact: f64| {
            assert!((found - exact).abs() <= WRITTEN * exact.abs(), "{found} {exact}")
        };
        let at = |name: &str| &read.constant[name];
        let count = set.oscillators.len();
        for (mode, of) in set.oscillators.iter().enumerate() {
            near(at("2 phi")[(1, mode)], of.lateral);
            near(at("2 phi")[(2, mode)], set.offset * of.turn);
            near(at("2 psi")[(0, mode)], of.turn);
            near(at("Ke")[(mode, mode)].sqrt() / TAU, of.frequency);
            near(at("De")[(mode, mode)], 6e-6 * at("Ke")[(mode, mode)]);
            near(read.linear["2 origin"][&[1, mode, 0]], of.lateral);
            // e_y turns to z, e_z against y
            near(read.linear["2 AP"][&[2, mode, 1]], of.turn);
            near(read.linear["2 AP"][&[1, mode, 2]], -of.turn);
        }
        let of_wheel = set.wheel();
        near(at("2 origin")[(2, 0)], -of_wheel.hub[1]);
        // y, z, rotation about x of the frame, and the elastic coordinates
        let mut mass = DMatrix::identity(3 + count, 3 + count);
        let [y, z] = [at("mdCM")[(1, 0)], at("mdCM")[(2, 0)]];
        for (i, j, value) in
            [(0, 0, read.mass), (1, 1, read.mass), (2, 2, at("J")[(0, 0)]), (0, 2, -z), (1, 2, y)]
        {
            (mass[(i, j)], mass[(j, i)]) = (value, value);
        }
        for mode in 0..count {
            for (i, value) in
                [at("Ct")[(mode, 1)], at("Ct")[(mode, 2)], at("Cr")[(mode, 0)]].into_iter().enumerate()
            {
                (mass[(i, 3 + mode)], mass[(3 + mode, i)]) = (value, value);
            }
        }
        let mut stiffness = DMatrix::zeros(3 + count, 3 + count);
        stiffness.view_mut((3, 3), (count, count)).copy_from(at("Ke"));
        let inverse = mass.cholesky().unwrap().l().try_inverse().unwrap();
        let mut squares: Vec<f64> = SymmetricEigen::new(&inverse * stiffness * inverse.transpose())
            .eigenvalues
            .iter()
            .copied()
            .collect();
        squares.sort_by(f64::total_cmp);
        let exact = super::super::gensys::free_frequencies(&set).unwrap();
        assert_eq!(exact.len(), count);
        for (found, exact) in squares[3..].iter().zip(exact) {
            near(found.sqrt() / TAU, exact);
        }
    }

    /// Goal: numbers as Fortran and Simpack have them.
    #[test]
    fn numbers_have_two_digits_of_exponent() {
        assert_eq!([real(-0.0123), real(1.5e9)], ["-1.23000000000D-02", " 1.50000000000D+09"]);
        assert_eq!(scientific(-0.0, 3, 'E'), "0.000E+00");
    }
}
