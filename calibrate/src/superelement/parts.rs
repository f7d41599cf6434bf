//! A body as its equations are eliminated: whole, or by halves where it is its own mirror image.

use super::condensed::{CondensedBody, Interior};
use super::factored::Superelement;
use super::modes::{Modes, contact_loads};
use super::products::times;
use super::section_motion::{SectionLoads, SectionMotion};
use super::size::FactorSize;
use super::step::Step;
use crate::mesh::HexMesh;
use crate::solid::{MirrorHalf, Numbering, Symmetry, System};
use faer::Mat;
use nalgebra::Matrix3;
use railspring_profiles::error::Result;
use std::sync::Arc;

/// The nodes of a half are at rest in a motion that is less than this share of the whole one.
const AT_REST: f64 = 1e-9;

/// A body before it is condensed.
pub enum Parts<'a> {
    /// All equations together.
    Whole(Box<System<'a>>),
    /// The body's half in symmetric and in antisymmetric motions, which do not know of each other: one factor after the other.
    Halves {
        /// The mesh of both halves.
        whole: &'a HexMesh,
        /// The half.
        half: &'a MirrorHalf,
        /// Its equations, in the order of [`Symmetry::BOTH`].
        systems: Box<[System<'a>; 2]>,
    },
}

/// What a body is to be condensed to.
pub struct Wanted {
    /// Hash of what makes it ([`super::body_key`]).
    pub key: String,
    /// Largest number of modes; 0 for statics alone.
    pub modes: usize,
    /// Of a rail, loads on its section, whose motion is wanted.
    pub section: Option<SectionLoads>,
}

/// What is made of the factor of a part.
type OfFactor<'f, T> = Box<dyn Fn(&Superelement<'_>) -> Result<T> + 'f>;

/// What is wanted of a part beside its compliance.
struct Beside<'f> {
    modes: Option<OfFactor<'f, Modes>>,
    /// Forces on its nodes (`3·node + direction`, N), under which it moves.
    loads: Vec<Vec<f64>>,
}

/// How a part moves under loads.
struct Response {
    /// Displacements of the retained equations, in those of all nodes (`3·node + direction`, m).
    moved: Vec<Vec<f64>>,
    /// Work of each load on the displacements under each, J.
    work: Mat<f64>,
}

impl Response {
    /// `loads` are those of the equations, from which the inside is eliminated.
    fn new(numbering: &Numbering, mesh: &HexMesh, compliance: &Mat<f64>, loads: &Mat<f64>) -> Self {
        let (inside, condensed) = loads.as_ref().split_at_row(numbering.interior);
        let retained = compliance * condensed;
        let moved = |n: usize| {
            let mut solution = vec![0.0; numbering.equations];
            solution[numbering.interior..].copy_from_slice(retained.col_as_slice(n));
            numbering.expand(mesh, &solution)
        };
        Self {
            moved: (0..loads.ncols()).map(moved).collect(),
            work: inside.transpose() * inside + condensed.transpose() * &retained,
        }
    }
}

impl Beside<'_> {
    /// Steps of [`Self::condensed`].
    fn steps(&self) -> usize {
        if self.modes.is_some() { 4 } else { 2 }
    }

    /// The part, condensed, and how it moves; says which step `begins`.
    fn condensed(
        self,
        system: System<'_>,
        key: String,
        begins: &mut dyn FnMut(Step),
    ) -> Result<(CondensedBody, Response)> {
        let Self { modes, loads } = self;
        let (mesh, numbering) = (system.mesh, system.numbering.clone());
        let of_equations: Vec<Vec<f64>> = loads.iter().map(|load| numbering.gather(mesh, load)).collect();
        let mut loads = Mat::from_fn(numbering.equations, loads.len(), |e, n| of_equations[n][e]);
        let body = match modes {
            None => CondensedBody::without_factor(&system, key, loads.as_mut(), begins)?,
            Some(modes) => {
                let element = Superelement::in_steps(system, loads.as_mut(), begins)?;
                begins(Step::Modes);
                let modes = Some(modes(&element)?);
                CondensedBody { modes, ..element.condensed(key) }
            }
        };
        let response = Response::new(&numbering, mesh, &body.compliance, &loads);
        Ok((body, response))
    }
}

impl Parts<'_> {
    /// The size of the body and of its factors.
    ///
    /// # Errors
    /// A mesh whose factor cannot be counted.
    pub fn size(&self) -> Result<FactorSize> {
        match self {
            Self::Whole(system) => FactorSize::of(system.mesh, &system.numbering),
            Self::Halves { whole, half, systems } => {
                let of_half = FactorSize::of(&half.mesh, &systems[0].numbering)?;
                Ok(FactorSize {
                    parts: 2,
                    equations: self.equations(),
                    retained: 3 * whole.contact.nodes.len(),
                    multiplications: 2.0 * of_half.multiplications,
                    ..of_half
                })
            }
        }
    }

    /// Equations of the body.
    pub fn equations(&self) -> usize {
        let systems = match self {
            Self::Whole(system) => std::slice::from_ref(&**system),
            Self::Halves { systems, .. } => systems.as_slice(),
        };
        systems.iter().map(|system| system.numbering.degrees_of_freedom()).sum()
    }

    /// Assembles, factors and condenses the body; says which step `begins`, how many were done before it, and how many there are.
    ///
    /// # Errors
    /// Those of [`Superelement::new`] and of its modes.
    pub fn condensed(
        self,
        Wanted { key, modes, section }: Wanted,
        begins: &mut dyn FnMut(Step, usize, usize),
    ) -> Result<CondensedBody> {
        let equations = self.equations();
        let mut done = 0;
        let mut counted = |step, all| {
            begins(step, done, all);
            done += 1;
        };
        match self {
            Self::Whole(system) => {
                let mesh = system.mesh;
                let modes_of = |element: &Superelement<'_>| element.modes(modes);
                let beside = Beside {
                    modes: (modes > 0).then(|| Box::new(modes_of) as _),
                    loads: section.as_ref().map_or_else(Vec::new, |section| section.unit.to_vec()),
                };
                let all = beside.steps();
                let (body, response) = beside.condensed(*system, key, &mut |step| counted(step, all))?;
                let section = section.map(|section| {
                    let moved = [0, 1, 2].map(|k| response.moved[k].clone());
                    let work = Matrix3::from_fn(|i, k| response.work[(i, k)]);
                    SectionMotion::of(mesh, section.shear_centre, work, &moved)
                });
                Ok(CondensedBody { section, ..body })
            }
            Self::Halves { whole, half, systems } => {
                let counts = Modes::of_halves(modes);
                let modes_of = |symmetry: Symmetry| {
                    let of = move |element: &Superelement<'_>| {
                        let loads = contact_loads(whole, symmetry);
                        let loads: Vec<_> = loads.iter().map(|load| half.forces(symmetry, load)).collect();
                        element.modes_under(&loads, symmetry, counts[symmetry as usize])
                    };
                    (modes > 0).then(|| Box::new(of) as OfFactor<'_, Modes>)
                };
                // loads on the section in the plane are symmetric
                let of_half = |section: &SectionLoads| -> Vec<Vec<f64>> {
                    section.unit.iter().map(|load| half.forces(Symmetry::Symmetric, load)).collect()
                };
                let loads = section.as_ref().map_or_else(Vec::new, of_half);
                let [with, against] = Symmetry::BOTH;
                let [symmetric, antisymmetric] = *systems;
                let symmetric = (Beside { modes: modes_of(with), loads }, symmetric);
                let antisymmetric = (Beside { modes: modes_of(against), loads: Vec::new() }, antisymmetric);
                let all = symmetric.0.steps() + antisymmetric.0.steps();
                let mut condense = |(beside, system): (Beside<'_>, System<'_>)| {
                    beside.condensed(system, String::new(), &mut |step| counted(step, all))
                };
                let (symmetric, response) = condense(symmetric)?;
                let (antisymmetric, _) = condense(antisymmetric)?;
                let section = section.map(|section| {
                    let moved = [0, 1, 2].map(|k| {
                        let mut moved = vec![0.0; 3 * whole.nodes.len()];
                        half.add(Symmetry::Symmetric, &response.moved[k], &mut moved);
                        moved
                    });
                    // both halves do work
                    let work = Matrix3::from_fn(|i, k| 2.0 * response.work[(i, k)]);
                    SectionMotion::of(whole, section.shear_centre, work, &moved)
                });
                let compliance = joined(half, [&symmetric.compliance, &antisymmetric.compliance]);
                let modes = symmetric.modes.zip(antisymmetric.modes);
                Ok(CondensedBody {
                    key,
                    compliance: Arc::new(compliance),
                    grid: whole.contact.clone(),
                    nodes: whole.contact.nodes.iter().map(|&n| whole.nodes[n]).collect(),
                    equations,
                    mass: 2.0 * symmetric.mass,
                    surface: symmetric.surface,
                    section,
                    modes: modes.map(|(with, against)| Modes::joined(half, [with, against])),
                    of: String::new(),
                    file: None,
                })
            }
        }
    }

    /// Displacements of all nodes (`3·node + direction`, m) of a condensed `body` under each of the `forces` on its retained equations (N):
    /// the retained ones by its compliance, the others as these move them. A motion of a half that is less than 1e-9 of the whole one is left out.
    ///
    /// # Errors
    /// As [`Superelement::new`].
    pub fn displacements(self, body: &CondensedBody, forces: &[Vec<f64>]) -> Result<Vec<Vec<f64>>> {
        let retained: Vec<Vec<f64>> = forces.iter().map(|forces| times(&body.compliance, forces)).collect();
        match self {
            Self::Whole(system) => {
                let inside = Interior::new(*system)?;
                Ok(retained.iter().map(|retained| inside.moved(retained)).collect())
            }
            Self::Halves { whole, half, systems } => {
                let mut moved = vec![vec![0.0; 3 * whole.nodes.len()]; forces.len()];
                for (system, symmetry) in (*systems).into_iter().zip(Symmetry::BOTH) {
                    let parts: Vec<Vec<f64>> =
                        retained.iter().map(|retained| half.contact_part(symmetry, retained)).collect();
                    let moves = |(part, all): (&Vec<f64>, &Vec<f64>)| largest(part) > AT_REST * largest(all);
                    if !parts.iter().zip(&retained).any(moves) {
                        continue;
                    }
                    let inside = Interior::new(system)?;
                    for (moved, part) in moved.iter_mut().zip(&parts) {
                        half.add(symmetry, &inside.moved(part), moved);
                    }
                }
                Ok(moved)
            }
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// Compliance of the contact nodes of the whole from those of its half in symmetric and antisymmetric motions, m/N: a force is half of it with
/// and half of it against its mirror image, of which each half of the body carries one half.
fn joined(half: &MirrorHalf, [symmetric, antisymmetric]: [&Mat<f64>; 2]) -> Mat<f64> {
    let contact = half.contact();
    let rows = 3 * contact.iter().flatten().max().map_or(0, |last| last + 1);
    let mut whole = Mat::zeros(rows, rows);
    let moves = |symmetry: Symmetry, [at, image]: [usize; 2], d: usize| at != image || symmetry.sign(d) > 0.0;
    let sign = |d: usize| Symmetry::Symmetric.sign(d);
    for (b, &column) in contact.iter().enumerate() {
        for q in 0..3 {
            let [with, against] = [symmetric, antisymmetric].map(|part| part.col_as_slice(3 * b + q));
            for (a, &row) in contact.iter().enumerate() {
                for p in 0..3 {
                    let half = |symmetry, of_column: &[f64]| {
                        let both = moves(symmetry, row, p) && moves(symmetry, column, q);
                        if both { 0.5 * of_column[3 * a + p] } else { 0.0 }
                    };
                    let (s, t) = (half(Symmetry::Symmetric, with), half(Symmetry::Antisymmetric, against));
                    let (same, other) = (s + t, s - t);
                    whole[(3 * row[0] + p, 3 * column[0] + q)] = same;
                    whole[(3 * row[1] + p, 3 * column[1] + q)] = sign(p) * sign(q) * same;
                    if row[0] != row[1] {
                        whole[(3 * row[1] + p, 3 * column[0] + q)] = sign(p) * other;
                    }
                    if column[0] != column[1] {
                        whole[(3 * row[0] + p, 3 * column[1] + q)] = sign(q) * other;
                    }
                }
            }
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BlockOptions, mesh_block};
    use crate::solid::{Formulation, Material, Supports};
    use crate::superelement::Superelement;
    use nalgebra::{Point2, Point3};
    use std::f64::consts::FRAC_1_SQRT_2;

    /// Rounding times the condition of the blocks.
    const ROUNDOFF: f64 = 1e-9;

    /// A block whose middle is at x = 0, with finer elements there, and leaning sides: nothing but the mirror maps it onto itself.
    fn block(divisions: [usize; 3]) -> HexMesh {
        let mut mesh = mesh_block(&BlockOptions::uniform([0.05, 0.04, 0.03], divisions)).unwrap();
        for p in &mut mesh.nodes {
            let x = p.x / 0.025;
            *p = Point3::new(
                0.025 * x * (0.4 + 0.6 * x * x) * (1.0 + 4.0 * p.y),
                p.y + 0.2 * p.z,
                p.z * (1.0 + 3.0 * p.y),
            );
        }
        mesh
    }

    fn held(mesh: &HexMesh) -> Supports {
        Supports { held: mesh.foot.clone(), ..Supports::default() }
    }

    fn system<'a>(mesh: &'a HexMesh, supports: &Supports) -> System<'a> {
        System::new(mesh, Material::STEEL, Formulation::IncompatibleModes, supports).unwrap()
    }

    fn halves<'a>(mesh: &'a HexMesh, half: &'a MirrorHalf) -> Parts<'a> {
        let systems = Symmetry::BOTH.map(|symmetry| {
            let System { mesh, materials, formulation, numbering, .. } = system(&half.mesh, &half.supports);
            let numbering = half.numbered(&numbering, symmetry);
            System::with_numbering(mesh, materials, formulation, numbering).unwrap()
        });
        Parts::Halves { whole: mesh, half, systems: Box::new(systems) }
    }

    fn off(a: &[f64], b: &[f64]) -> f64 {
        assert_eq!(a.len(), b.len());
        largest(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>()) / largest(a)
    }

    /// Source: the same body as a whole. Goal: a body that is condensed by halves has its compliance (m/N),
    /// its equations and its mass. It has its modes: displacements of the contact nodes, stiffness, mass
    /// between them and the rigid motions. Nodes move as in the whole under forces that are neither symmetric
    /// nor antisymmetric, and under symmetric ones. Its section moves as the solution of the factor has it. The modes of the block on its
    /// own hub agree, too. Accuracy: ROUNDOFF. Without modes all else is the same to the byte.
    #[test]
    fn halves_are_the_whole() {
        let mesh = block([8, 5, 4]);
        let hub = Supports {
            followers: mesh.foot.clone(),
            master: Point3::new(0.0, 0.03, 0.1),
            ..Supports::default()
        };
        for supports in [held(&mesh), hub] {
            let half = MirrorHalf::of(&mesh, &supports).expect("its mirror image");
            assert!(
                half.mesh.hexes.len() == mesh.hexes.len() / 2 && half.mesh.nodes.len() < mesh.nodes.len()
            );
            // in the section across the track and down
            let unit = [[0.0, 1.0, 0.0], [0.0, 0.2, 3.0], [0.0, 2.0, -1.0]].map(|[x, y, z]| {
                let force = |p: &Point3<f64>| match p.x.abs() < 1e-9 {
                    true => [x, y + p.z, z + p.y],
                    false => [0.0; 3],
                };
                mesh.nodes.iter().flat_map(force).collect()
            });
            let loads = SectionLoads { shear_centre: Point2::new(0.01, 0.02), unit };
            let condense = |parts: Parts<'_>, modes: usize| {
                let wanted = Wanted { key: "block".into(), modes, section: Some(loads.clone()) };
                let mut begun = Vec::new();
                let condensed = parts.condensed(wanted, &mut |_, done, all| begun.push((done, all))).unwrap();
                let all = begun.len();
                assert_eq!(
                    begun,
                    (0..all).map(|done| (done, all)).collect::<Vec<_>>(),
                    "every step is announced"
                );
                condensed
            };
            let whole = condense(Parts::Whole(Box::new(system(&mesh, &supports))), 15);
            let by_halves = condense(halves(&mesh, &half), 15);
            let alone = condense(halves(&mesh, &half), 0);
            assert_eq!(alone, CondensedBody { modes: None, ..by_halves.clone() });
            let element = Superelement::new(system(&mesh, &supports)).unwrap();
            let motion = SectionMotion::new(&mesh, &loads, |forces| element.solve(forces));
            for found in [&whole, &by_halves] {
                let found = found.section.as_ref().expect("the motion of its section");
                assert_eq!(found.places(), motion.places());
                assert!(off(motion.flexibility.as_slice(), found.flexibility.as_slice()) < ROUNDOFF);
                (0..3).for_each(|k| assert!(off(motion.moved(k), found.moved(k)) < ROUNDOFF));
            }
            assert_eq!((by_halves.equations, &by_halves.grid), (whole.equations, &whole.grid));
            assert!((by_halves.mass / whole.mass - 1.0).abs() < ROUNDOFF);
            for column in 0..whole.compliance.ncols() {
                let [a, b] = [&whole, &by_halves].map(|body| body.compliance.col_as_slice(column));
                let differs = off(a, b);
                assert!(differs < ROUNDOFF, "column {column}: {differs:e}");
            }
            let of_whole = Symmetry::BOTH.map(|symmetry| {
                let count = Modes::of_halves(15)[symmetry as usize];
                element.modes_under(&contact_loads(&mesh, symmetry), symmetry, count).unwrap()
            });
            assert_eq!(of_whole.each_ref().map(Modes::count), [13, 2]);
            let found = by_halves.modes.as_ref().unwrap();
            assert_eq!(found.count(), 15);
            assert!(off(of_whole[0].rigid.as_slice(), found.rigid.as_slice()) < ROUNDOFF);
            // one of six is antisymmetric
            let place = [[0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 12, 13, 14].as_slice(), &[5, 11]];
            for (of_whole, place) in of_whole.iter().zip(place) {
                let stiffness = of_whole.stiffness(of_whole.count());
                let coupled = of_whole.coupling.amax();
                for (n, &mode) in place.iter().enumerate() {
                    assert!(off(of_whole.contact(n), found.contact(mode)) < ROUNDOFF, "mode {mode}");
                    for other in 0..15 {
                        let expected =
                            place.iter().position(|&at| at == other).map_or(0.0, |m| stiffness[(n, m)]);
                        let difference = (found.stiffness(15)[(mode, other)] - expected).abs();
                        assert!(difference < ROUNDOFF * stiffness.amax(), "{mode} {other}");
                    }
                    // couplings of the other symmetry are rounding in the whole
                    for motion in 0..6 {
                        let difference = of_whole.coupling(motion, n) - found.coupling(motion, mode);
                        assert!(difference.abs() < ROUNDOFF * coupled, "{motion} {mode}");
                    }
                }
            }
            let rows = whole.compliance.nrows();
            let columns = mesh.contact.along_track.len();
            let any: Vec<f64> = (0..rows).map(|e| (1.7 * e as f64).sin()).collect();
            let symmetric: Vec<f64> = (0..rows)
                .map(|e| {
                    let (at, d) = (e / 3, e % 3);
                    let image = at - at % columns + (columns - 1 - at % columns);
                    FRAC_1_SQRT_2 * (any[e] + Symmetry::Symmetric.sign(d) * any[3 * image + d])
                })
                .collect();
            let forces = [any, symmetric];
            let a = Parts::Whole(Box::new(system(&mesh, &supports))).displacements(&whole, &forces).unwrap();
            let b = halves(&mesh, &half).displacements(&by_halves, &forces).unwrap();
            a.iter().zip(&b).for_each(|(a, b)| assert!(off(a, b) < ROUNDOFF, "{:e}", off(a, b)));
        }
    }

    /// Goal: the sizes that are counted are those of the factors. Accuracy: MERGING of columns in threes instead of one by one.
    #[test]
    fn the_size_of_halves_is_that_of_their_factors() {
        const MERGING: f64 = 0.05;
        let mesh = block([14, 10, 12]);
        let supports = held(&mesh);
        let half = MirrorHalf::of(&mesh, &supports).expect("its mirror image");
        let (whole, size) = (
            Parts::Whole(Box::new(system(&mesh, &supports))).size().unwrap(),
            halves(&mesh, &half).size().unwrap(),
        );
        assert_eq!((size.parts, size.equations, size.retained), (2, whole.equations, whole.retained));
        let Parts::Halves { systems, .. } = halves(&mesh, &half) else { unreachable!("halves") };
        for system in *systems {
            let element = Superelement::new(system).unwrap();
            let stored = element.factor.stored_values() as f64;
            assert!((size.values as f64 / stored - 1.0).abs() < MERGING, "{} {stored}", size.values);
        }
        assert!(size.values < whole.values && size.multiplications < whole.multiplications);
    }

    /// Goal: no halves of a body with an element across the plane, that stands beside it, that is held on one side, that has a node off its
    /// place, and whose hub moves.
    #[test]
    fn what_is_not_its_mirror_image_has_no_half() {
        let mesh = block([8, 5, 4]);
        let none = |mesh: &HexMesh, supports: &Supports| MirrorHalf::of(mesh, supports).is_none();
        assert!(!none(&mesh, &held(&mesh)));
        let odd = block([7, 5, 4]);
        assert!(none(&odd, &held(&odd)));
        let mut beside = mesh.clone();
        beside.nodes.iter_mut().for_each(|p| p.x += 1e-3);
        assert!(none(&beside, &held(&beside)));
        let mut on_one_side = held(&mesh);
        on_one_side.held.retain(|&n| mesh.nodes[n].x > -0.01);
        assert!(none(&mesh, &on_one_side));
        let mut bent = mesh.clone();
        let corner = bent.hexes[0][0];
        bent.nodes[corner].y += 1e-6;
        assert!(none(&bent, &held(&bent)));
        let turning = Supports {
            followers: mesh.foot.clone(),
            master_free: [false, false, false, true, false, false],
            ..Supports::default()
        };
        assert!(none(&mesh, &turning));
    }
}
