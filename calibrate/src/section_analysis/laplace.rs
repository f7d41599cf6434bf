//! Laplace's equation with natural boundary conditions on nine-node quadrilaterals.

use std::collections::BTreeMap;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, Mat, Par, Side};
use nalgebra::{Matrix2, Point2, Vector2, center};

use crate::mesh::SectionMesh;
use railspring_profiles::error::{NumericsError, Result, StopReason};
use railspring_profiles::quadrature::GAUSS_3;

/// Right-hand sides at a point: ∫ ∇v·`flow`, and ∫ v `supply` for the other two problems.
pub(super) struct Source {
    pub flow: Vector2<f64>,
    pub supply: [f64; 2],
}

/// The discretised section.
pub(super) struct Laplace {
    /// Number of nodes, middle nodes included.
    size: usize,
    elements: Vec<Element>,
}

/// An element with its values at the nine Gauss points.
struct Element {
    nodes: [usize; 9],
    samples: [Sample; 9],
}

struct Sample {
    point: Point2<f64>,
    /// Weight times the area of the parameter square's image.
    weight: f64,
    shape: [f64; 9],
    gradient: [Vector2<f64>; 9],
}

impl Laplace {
    /// Puts nodes in the middle of the edges and elements of a mesh; those of the outline are moved by `on_outline`.
    pub fn new(mesh: &SectionMesh, on_outline: impl Fn(&Point2<f64>) -> Point2<f64>) -> Self {
        let mut points = mesh.nodes.clone();
        let mut edges = BTreeMap::new();
        let key = |a: usize, b: usize| (a.min(b), a.max(b));
        for (i, &a) in mesh.boundary.iter().enumerate() {
            let b = mesh.boundary[(i + 1) % mesh.boundary.len()];
            points[a] = on_outline(&mesh.nodes[a]);
            edges.insert(key(a, b), points.len());
            points.push(on_outline(&center(&mesh.nodes[a], &mesh.nodes[b])));
        }
        let mut elements = Vec::with_capacity(mesh.quads.len());
        for &[a, b, c, d] in &mesh.quads {
            let mut middle = |a: usize, b: usize| {
                *edges.entry(key(a, b)).or_insert_with(|| {
                    points.push(center(&points[a], &points[b]));
                    points.len() - 1
                })
            };
            let sides = [middle(a, b), middle(b, c), middle(c, d), middle(d, a)];
            let sum = |nodes: [usize; 4]| nodes.iter().map(|&n| points[n].coords).sum::<Vector2<f64>>();
            // The centre of the surface spanned between the four curved sides.
            let centre = Point2::from(0.5 * sum(sides) - 0.25 * sum([a, b, c, d]));
            points.push(centre);
            // By rows of the parameter square: -1, 0, 1 in either direction.
            let nodes = [a, sides[0], b, sides[3], points.len() - 1, sides[1], d, sides[2], c];
            let samples = std::array::from_fn(|g| sample(&nodes.map(|n| points[n]), g));
            elements.push(Element { nodes, samples });
        }
        Self { size: points.len(), elements }
    }

    /// ∫ f(p) dA.
    pub fn integrate<const N: usize>(&self, f: impl Fn(&Point2<f64>) -> [f64; N]) -> [f64; N] {
        self.sum(|sample, _| f(&sample.point))
    }

    /// ∫ f(p, u(p)) dA for the nodal values `u`.
    pub fn integrate_with<const N: usize>(
        &self,
        u: &[f64],
        f: impl Fn(&Point2<f64>, f64) -> [f64; N],
    ) -> [f64; N] {
        self.sum(|sample, nodes| {
            let value = (0..9).map(|i| sample.shape[i] * u[nodes[i]]).sum();
            f(&sample.point, value)
        })
    }

    /// ∫ |∇u|² dA.
    pub fn energy(&self, u: &[f64]) -> f64 {
        let [energy] = self.sum(|sample, nodes| {
            let gradient: Vector2<f64> = (0..9).map(|i| sample.gradient[i] * u[nodes[i]]).sum();
            [gradient.norm_squared()]
        });
        energy
    }

    /// `f` of every Gauss point, its share of the area and the gradients of the three solutions there.
    pub fn samples<T>(
        &self,
        solutions: [&Vec<f64>; 3],
        f: impl Fn(Point2<f64>, f64, [Vector2<f64>; 3]) -> T,
    ) -> Vec<T> {
        let of_element = |element: &Element| {
            let nodes = element.nodes;
            element.samples.each_ref().map(|sample| {
                let gradients =
                    solutions.map(|u| (0..9).map(|i| sample.gradient[i] * u[nodes[i]]).sum::<Vector2<f64>>());
                f(sample.point, sample.weight, gradients)
            })
        };
        self.elements.iter().flat_map(of_element).collect()
    }

    fn sum<const N: usize>(&self, f: impl Fn(&Sample, &[usize; 9]) -> [f64; N]) -> [f64; N] {
        let mut total = [0.0; N];
        for element in &self.elements {
            for sample in &element.samples {
                for (sum, value) in total.iter_mut().zip(f(sample, &element.nodes)) {
                    *sum += sample.weight * value;
                }
            }
        }
        total
    }

    /// Nodal values of the three solutions, each fixed to zero at the first node. The sources are functions of the
    /// point and of the value there of `known` nodal values (0 without).
    pub fn solve(
        &self,
        known: Option<&[f64]>,
        source: impl Fn(&Point2<f64>, f64) -> Source,
    ) -> Result<[Vec<f64>; 3]> {
        let mut triplets = Vec::with_capacity(45 * self.elements.len());
        let mut right = Mat::<f64>::zeros(self.size, 3);
        for Element { nodes, samples } in &self.elements {
            let mut stiffness = [[0.0; 9]; 9];
            for sample in samples {
                let value = known.map_or(0.0, |u| (0..9).map(|i| sample.shape[i] * u[nodes[i]]).sum());
                let Source { flow, supply } = source(&sample.point, value);
                for i in 0..9 {
                    let gradient = sample.weight * sample.gradient[i];
                    right[(nodes[i], 0)] += gradient.dot(&flow);
                    for k in 0..2 {
                        right[(nodes[i], k + 1)] += sample.weight * sample.shape[i] * supply[k];
                    }
                    for j in 0..9 {
                        stiffness[i][j] += gradient.dot(&sample.gradient[j]);
                    }
                }
            }
            for i in 0..9 {
                for j in 0..9 {
                    // The first node is held: its row and column fall out.
                    if nodes[i] <= nodes[j] && nodes[i] > 0 {
                        triplets.push(Triplet::new(nodes[i], nodes[j], stiffness[i][j]));
                    }
                }
            }
        }
        triplets.push(Triplet::new(0, 0, 1.0));
        for k in 0..3 {
            right[(0, k)] = 0.0;
        }
        self.factor_and_solve(&triplets, &mut right)?;
        Ok([0, 1, 2].map(|k| right.col_as_slice(k).to_vec()))
    }

    /// One thread, so that the result does not depend on their number.
    fn factor_and_solve(&self, triplets: &[Triplet<usize, usize, f64>], right: &mut Mat<f64>) -> Result<()> {
        let singular = || NumericsError::new("section analysis", StopReason::Singular, f64::NAN, 0);
        let upper =
            SparseColMat::try_new_from_triplets(self.size, self.size, triplets).map_err(|_| singular())?;
        let symbolic = factorize_symbolic_cholesky(
            upper.symbolic(),
            Side::Upper,
            SymmetricOrdering::Amd,
            Default::default(),
        )
        .map_err(|_| singular())?;
        let mut values = vec![0.0; symbolic.len_val()];
        let scratch = StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<f64>(3, Par::Seq),
        ]);
        let mut memory = MemBuffer::new(scratch);
        let factor = symbolic
            .factorize_numeric_llt(
                &mut values,
                upper.as_ref(),
                Side::Upper,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| singular())?;
        factor.solve_in_place_with_conj(Conj::No, right.as_mut(), Par::Seq, MemStack::new(&mut memory));
        Ok(())
    }
}

/// Values at the Gauss point `g` of the element with the given nodes.
fn sample(nodes: &[Point2<f64>; 9], g: usize) -> Sample {
    let ((xi, w_xi), (eta, w_eta)) = (GAUSS_3[g % 3], GAUSS_3[g / 3]);
    let (along_xi, along_eta) = (quadratic(xi), quadratic(eta));
    let mut point = Point2::origin();
    let mut jacobian = Matrix2::zeros();
    let mut shape = [0.0; 9];
    let mut gradient = [Vector2::zeros(); 9];
    for i in 0..9 {
        let ((p, dp), (q, dq)) = (along_xi[i % 3], along_eta[i / 3]);
        shape[i] = p * q;
        gradient[i] = Vector2::new(dp * q, p * dq);
        point += shape[i] * nodes[i].coords;
        jacobian += gradient[i] * nodes[i].coords.transpose();
    }
    let inverse = jacobian.try_inverse().unwrap_or_else(Matrix2::zeros);
    for g in &mut gradient {
        *g = inverse * *g;
    }
    Sample { point, weight: w_xi * w_eta * jacobian.determinant().abs(), shape, gradient }
}

/// Lagrange's quadratics through -1, 0, 1 and their derivatives.
fn quadratic(t: f64) -> [(f64, f64); 3] {
    [(0.5 * t * (t - 1.0), t - 0.5), (1.0 - t * t, -2.0 * t), (0.5 * t * (t + 1.0), t + 0.5)]
}
