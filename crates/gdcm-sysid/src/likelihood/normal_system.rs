//! Normal equations of the cost, in Gram form (M14.4, M14.8).
//!
//! ```text
//! At each line, every Jacobian column of W G U is a vector v (outputs) times a scalar s:
//!    block       v = (W C R)_2      s = -X_1, -X_2 (a pair), X (a single pole)
//!    B_ij        v = (W C R)_i      s = U_j
//!    C_oi, D_oj  v = W e_o          s = X_i, U_j
//!    tau_i, c1_o, c0_o: v = (W C R)_i, W e_o, W e_o, s = 1, 1/(j omega), 1
//!    missing samples: v = W e_o or W G_j, s = b_q (M14.21)
//!    R = (j omega - A)^-1,  X = R (B U + tau),  U with the missing samples completed
//! 1  J'J[p, q] = sum_k Re(v_p^H v_q  s_p^* s_q): a product of two matrices,
//!    (pairs of v) x (lines) times (lines) x (pairs of s)
//! 2  transient eliminated: G = J'J - J'T (T'T)^+ T'J
//! 3  g = J'e, as e is orthogonal to T
//! ```
//!
//! With tau in X the gradient is exact: variable projection in the form of L. Kaufman, "A variable
//! projection method for solving separable nonlinear least squares problems", BIT 15, 1975.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::each;

use super::blocks::{Block, BlockModel};
use super::cost::{DEPENDENT, Likelihood, SegmentCost, SpectralLines, whiten};
use super::gram_matrix::{pseudo_inverse_root, scale_columns};
use super::linear_model::LinearModel;
use crate::spectra::gap_hat::GapHat;

/// `G` and `g`: a step `d` changes the cost by `-2 g'd + d'G d`.
#[derive(Clone, Debug)]
pub(crate) struct NormalSystem {
    /// `G = J'J`, with the transients eliminated.
    pub(crate) matrix: DMatrix<f64>,
    /// `g = J'e`.
    pub(crate) gradient: DVector<f64>,
}

impl NormalSystem {
    /// Returns the sum of systems with this many parameters; zero if there are none.
    pub(crate) fn sum<'s>(parameters: usize, systems: impl IntoIterator<Item = &'s Self>) -> Self {
        let mut sum = Self {
            matrix: DMatrix::zeros(parameters, parameters),
            gradient: DVector::zeros(parameters),
        };
        for system in systems {
            sum.matrix += &system.matrix;
            sum.gradient += &system.gradient;
        }
        sum
    }

    /// Returns this system minus another.
    pub(crate) fn without(&self, other: &Self) -> Self {
        Self {
            matrix: &self.matrix - &other.matrix,
            gradient: &self.gradient - &other.gradient,
        }
    }

    /// Computes the Levenberg-Marquardt step, `(G + lambda diag G) d = g`; `None` if it is not
    /// finite.
    pub(crate) fn damped_step(&self, lambda: f64) -> Option<DVector<f64>> {
        let mut scaled = self.matrix.clone();
        let scales = scale_columns(&mut scaled);
        for (k, scale) in scales.iter().enumerate() {
            scaled[(k, k)] = if *scale > 0.0 { 1.0 + lambda } else { 1.0 };
        }
        let step = scaled
            .cholesky()?
            .solve(&self.gradient.component_mul(&scales))
            .component_mul(&scales);
        if step.iter().all(|entry| entry.is_finite()) {
            Some(step)
        } else {
            None
        }
    }
}

/// Computes the systems of all segments at a model; `parts` are the segment costs there.
pub(crate) fn normal_systems(
    likelihood: &Likelihood,
    model: &BlockModel,
    parts: &[SegmentCost],
) -> Option<Vec<NormalSystem>> {
    let segments = likelihood.segments.iter().zip(parts);
    each(likelihood.executor, segments, |(lines, part)| {
        Gram::new(lines, model, part).system()
    })
    .into_iter()
    .collect()
}

/// Sums the normal systems of a record; `systems` holds the normal systems of all segments.
pub(crate) fn system_of_record(
    likelihood: &Likelihood,
    record: usize,
    systems: &[NormalSystem],
) -> NormalSystem {
    let parameters = systems.first().map_or(0, |system| system.gradient.len());
    let own = likelihood
        .segments
        .iter()
        .zip(systems)
        .filter(|(segment, _)| segment.record == record)
        .map(|(_, system)| system);
    NormalSystem::sum(parameters, own)
}

/// Computes `J'd` of a segment; `part` holds the column `d` as its residual, with the transient
/// removed.
pub(crate) fn gradient_along(
    lines: &SpectralLines,
    model: &BlockModel,
    part: &SegmentCost,
) -> DVector<f64> {
    let mut gram = Gram::new(lines, model, part);
    gram.add_gradient();
    gram.gradient
}

/// Indices of two vectors, or of two scalars, to be multiplied.
#[derive(Clone, Copy)]
struct IndexPair {
    left: usize,
    right: usize,
}

/// Returns the pairs of indices below `count` whose second index is not smaller than the first.
fn ordered_pairs(count: usize) -> Vec<IndexPair> {
    let mut pairs = Vec::new();
    for left in 0..count {
        for right in left..count {
            pairs.push(IndexPair { left, right });
        }
    }
    pairs
}

/// Returns all pairs of a first index below `lefts` and a second below `rights`.
fn all_pairs(lefts: usize, rights: usize) -> Vec<IndexPair> {
    let mut pairs = Vec::new();
    for left in 0..lefts {
        for right in 0..rights {
            pairs.push(IndexPair { left, right });
        }
    }
    pairs
}

/// Column of a block parameter: `(W C R)_vector` times `sign X_scalar`.
struct BlockColumn {
    vector: usize,
    scalar: usize,
    sign: f64,
}

/// Vectors and scalars of a segment, and the Gram matrix built from them.
///
/// Order of the columns: the parameters, then tau, c1, c0, missing samples.
struct Gram<'a> {
    model: &'a BlockModel,
    lines: &'a SpectralLines,
    residual: &'a DMatrix<Complex<f64>>,
    /// `W C R`, outputs x (n lines): n columns for each line.
    resolvent: DMatrix<Complex<f64>>,
    /// Scalars of `B` and tau: `U` and 1; columns are lines.
    resolvent_scalars: DMatrix<Complex<f64>>,
    /// Scalars of `C`, `D`, c1 and c0: `X`, `U`, 1/(j omega) and 1; columns are lines.
    weight_scalars: DMatrix<Complex<f64>>,
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl<'a> Gram<'a> {
    fn new(lines: &'a SpectralLines, model: &'a BlockModel, part: &'a SegmentCost) -> Self {
        let order = model.order();
        let inputs = model.b.ncols();
        let outputs = model.c.nrows();
        let count = lines.omega.len();
        let mut resolvent = DMatrix::zeros(outputs, order * count);
        let mut resolvent_scalars = DMatrix::zeros(inputs + 1, count);
        let mut weight_scalars = DMatrix::zeros(order + inputs + 2, count);
        let mut cr = vec![Complex::default(); outputs * order];
        let inputs_completed = lines.completed_inputs(&part.hat_values);
        for (k, &omega) in lines.omega.iter().enumerate() {
            model.output_resolvent(omega, &mut cr);
            for (i, column) in cr.chunks_exact(outputs).enumerate() {
                let mut to = resolvent.column_mut(k * order + i);
                whiten(&lines.weights[k], column, |o, value| to[o] = value);
            }
            let input = inputs_completed.column(k);
            resolvent_scalars
                .view_mut((0, k), (inputs, 1))
                .copy_from(&input);
            resolvent_scalars[(inputs, k)] = Complex::from(1.0);
            let mut x = model.b.map(Complex::from) * input + part.transient.map(Complex::from);
            model.resolve(omega, x.as_mut_slice());
            weight_scalars.view_mut((0, k), (order, 1)).copy_from(&x);
            weight_scalars
                .view_mut((order, k), (inputs, 1))
                .copy_from(&input);
            weight_scalars[(order + inputs, k)] = Complex::new(0.0, -1.0 / omega);
            weight_scalars[(order + inputs + 1, k)] = Complex::from(1.0);
        }
        let size = model.parameters() + order + 2 * outputs + lines.hats.len();
        Self {
            model,
            lines,
            residual: &part.residual,
            resolvent,
            resolvent_scalars,
            weight_scalars,
            matrix: DMatrix::zeros(size, size),
            gradient: DVector::zeros(model.parameters()),
        }
    }

    /// Computes the system with the transient eliminated; `None` if an iteration does not converge.
    fn system(mut self) -> Option<NormalSystem> {
        self.add_resolvent();
        self.add_weight();
        self.add_resolvent_with_weight();
        self.add_blocks();
        self.add_hats();
        self.add_gradient();
        let size = self.matrix.nrows();
        let parameters = self.model.parameters();
        let nuisance = size - parameters;
        let transient = self
            .matrix
            .view((parameters, parameters), (nuisance, nuisance))
            .into_owned();
        let root = pseudo_inverse_root(transient, DEPENDENT)?;
        let mut matrix = self
            .matrix
            .view((0, 0), (parameters, parameters))
            .into_owned();
        let explained = self.matrix.view((0, parameters), (parameters, nuisance)) * root;
        matrix.gemm(-1.0, &explained, &explained.transpose(), 1.0);
        Some(NormalSystem {
            matrix,
            gradient: self.gradient,
        })
    }

    /// Returns the index of the column `(W C R)_state` times a scalar of `B` and tau.
    fn resolvent_column(&self, state: usize, scalar: usize) -> usize {
        if scalar < self.model.b.ncols() {
            self.model.place_of_b(state, scalar)
        } else {
            self.model.parameters() + state
        }
    }

    /// Returns the index of the column `W e_output` times a scalar of `C`, `D`, c1 and c0.
    fn weight_column(&self, output: usize, scalar: usize) -> usize {
        let order = self.model.order();
        let inputs = self.model.b.ncols();
        let outputs = self.model.c.nrows();
        if scalar < order {
            self.model.place_of_c(output, scalar)
        } else if scalar < order + inputs {
            self.model.place_of_d(output, scalar - order)
        } else {
            self.model.parameters() + order + (scalar - order - inputs) * outputs + output
        }
    }

    /// Writes a product on both sides of the diagonal.
    fn put(&mut self, p: usize, q: usize, value: f64) {
        self.matrix[(p, q)] = value;
        self.matrix[(q, p)] = value;
    }

    /// Computes `(W C R)_i^H (W C R)_j` at line `k`.
    fn resolvent_product(&self, k: usize, i: usize, j: usize) -> Complex<f64> {
        let order = self.model.order();
        let left = self.resolvent.column(k * order + i);
        let right = self.resolvent.column(k * order + j);
        left.iter()
            .zip(right.iter())
            .map(|(a, b)| a.conj() * b)
            .sum()
    }

    /// Computes `(W e_o)^H (W C R)_i` at line `k`.
    fn weight_product(&self, k: usize, o: usize, i: usize) -> Complex<f64> {
        let column = self.resolvent.column(k * self.model.order() + i);
        let weight = &self.lines.weights[k];
        (o..column.len())
            .map(|below| column[below] * weight[(below, o)].conj())
            .sum()
    }

    /// Tabulates `product(k, row)` over rows and lines: real and imaginary part in two columns for
    /// each line `k`.
    fn line_products(
        &self,
        rows: usize,
        product: impl Fn(usize, usize) -> Complex<f64>,
    ) -> DMatrix<f64> {
        let mut products = DMatrix::zeros(rows, 2 * self.lines.omega.len());
        for k in 0..self.lines.omega.len() {
            for row in 0..rows {
                let product = product(k, row);
                products[(row, 2 * k)] = product.re;
                products[(row, 2 * k + 1)] = product.im;
            }
        }
        products
    }

    /// Adds the products of `B` and tau with themselves.
    fn add_resolvent(&mut self) {
        let scalars = self.resolvent_scalars.nrows();
        let states = ordered_pairs(self.model.order());
        let left = self.line_products(states.len(), |k, row| {
            self.resolvent_product(k, states[row].left, states[row].right)
        });
        let scalar_pairs = all_pairs(scalars, scalars);
        let right = scalar_products(
            &self.resolvent_scalars,
            &self.resolvent_scalars,
            &scalar_pairs,
        );
        let products = left * right;
        for (row, state) in states.iter().enumerate() {
            for (column, scalar) in scalar_pairs.iter().enumerate() {
                self.put(
                    self.resolvent_column(state.left, scalar.left),
                    self.resolvent_column(state.right, scalar.right),
                    products[(row, column)],
                );
            }
        }
    }

    /// Computes `(W e_left)^H W e_right` at line `k`, for `left <= right`.
    fn weight_square(&self, k: usize, outputs: IndexPair) -> Complex<f64> {
        let weight = &self.lines.weights[k];
        (outputs.right..weight.nrows())
            .map(|below| weight[(below, outputs.left)].conj() * weight[(below, outputs.right)])
            .sum()
    }

    /// Adds the products of `C`, `D`, c1 and c0 with themselves.
    fn add_weight(&mut self) {
        let outputs = ordered_pairs(self.model.c.nrows());
        let left = self.line_products(outputs.len(), |k, row| self.weight_square(k, outputs[row]));
        let scalars = self.weight_scalars.nrows();
        let scalar_pairs = all_pairs(scalars, scalars);
        let products =
            left * scalar_products(&self.weight_scalars, &self.weight_scalars, &scalar_pairs);
        for (row, output) in outputs.iter().enumerate() {
            for (column, scalar) in scalar_pairs.iter().enumerate() {
                self.put(
                    self.weight_column(output.left, scalar.left),
                    self.weight_column(output.right, scalar.right),
                    products[(row, column)],
                );
            }
        }
    }

    /// Adds the products of `B` and tau with `C`, `D`, c1 and c0.
    fn add_resolvent_with_weight(&mut self) {
        let outputs = self.model.c.nrows();
        let vectors = all_pairs(self.model.order(), outputs);
        let left = self.line_products(vectors.len(), |k, row| {
            self.weight_product(k, vectors[row].right, vectors[row].left)
                .conj()
        });
        let scalar_pairs = all_pairs(self.resolvent_scalars.nrows(), self.weight_scalars.nrows());
        let products =
            left * scalar_products(&self.resolvent_scalars, &self.weight_scalars, &scalar_pairs);
        for (row, vector) in vectors.iter().enumerate() {
            for (column, scalar) in scalar_pairs.iter().enumerate() {
                self.put(
                    self.resolvent_column(vector.left, scalar.left),
                    self.weight_column(vector.right, scalar.right),
                    products[(row, column)],
                );
            }
        }
    }

    /// Returns the columns of all block parameters.
    fn block_columns(&self) -> Vec<BlockColumn> {
        let mut columns = Vec::new();
        for (first, block) in self.model.rows() {
            match block {
                Block::Pair { .. } => {
                    for scalar in [first, first + 1] {
                        columns.push(BlockColumn {
                            vector: first + 1,
                            scalar,
                            sign: -1.0,
                        });
                    }
                }
                Block::Single(_) => columns.push(BlockColumn {
                    vector: first,
                    scalar: first,
                    sign: 1.0,
                }),
            }
        }
        columns
    }

    /// Adds the products of the blocks with all columns.
    fn add_blocks(&mut self) {
        let order = self.model.order();
        let outputs = self.model.c.nrows();
        let resolvent_parts = parts(&self.resolvent_scalars);
        let weight_parts = parts(&self.weight_scalars);
        let columns = self.block_columns();
        for (p, own) in columns.iter().enumerate() {
            // conj(s_p) goes into the left factor.
            let with_resolvent = self.line_products(order, |k, i| {
                let s = self.weight_scalars[(own.scalar, k)].conj() * own.sign;
                (self.resolvent_product(k, own.vector, i) * s).conj()
            });
            let with_weight = self.line_products(outputs, |k, o| {
                let s = self.weight_scalars[(own.scalar, k)].conj() * own.sign;
                (self.weight_product(k, o, own.vector).conj() * s).conj()
            });
            let by_resolvent = &with_resolvent * &resolvent_parts;
            let by_weight = with_weight * &weight_parts;
            for i in 0..order {
                for s in 0..self.resolvent_scalars.nrows() {
                    self.put(p, self.resolvent_column(i, s), by_resolvent[(i, s)]);
                }
            }
            for o in 0..outputs {
                for s in 0..self.weight_scalars.nrows() {
                    self.put(p, self.weight_column(o, s), by_weight[(o, s)]);
                }
            }
            let by_states = with_resolvent * weight_parts.columns(0, order);
            for (q, other) in columns.iter().enumerate() {
                let product = by_states[(other.vector, other.scalar)] * other.sign;
                self.put(p, q, product);
            }
        }
    }

    /// Returns the whitened column of a missing sample, outputs x lines.
    fn hat_column(&self, hat: &GapHat) -> DMatrix<Complex<f64>> {
        let order = self.model.order();
        let mut column = DMatrix::zeros(self.model.c.nrows(), hat.lines.len());
        for (k, line) in hat.lines.iter().enumerate() {
            let weight = &self.lines.weights[k];
            let mut to = column.column_mut(k);
            match hat.side {
                ChannelSide::Output => to.copy_from(&weight.column(hat.channel)),
                ChannelSide::Input => {
                    let d = self.model.d.column(hat.channel).map(Complex::from);
                    to.copy_from(&(weight * d));
                    let vectors = self.resolvent.columns(k * order, order);
                    to += vectors * self.model.b.column(hat.channel).map(Complex::from);
                }
            }
            to *= *line;
        }
        column
    }

    /// Adds the products of the missing samples with all columns.
    fn add_hats(&mut self) {
        let order = self.model.order();
        let outputs = self.model.c.nrows();
        let first = self.matrix.nrows() - self.lines.hats.len();
        let columns: Vec<_> = self
            .lines
            .hats
            .iter()
            .map(|hat| self.hat_column(hat))
            .collect();
        let resolvent_parts = parts(&self.resolvent_scalars);
        let weight_parts = parts(&self.weight_scalars);
        let blocks = self.block_columns();
        for (number, column) in columns.iter().enumerate() {
            let place = first + number;
            let vectors = self.line_products(order, |k, i| {
                self.resolvent.column(k * order + i).dotc(&column.column(k))
            });
            let weights = self.line_products(outputs, |k, o| {
                self.lines.weights[k].column(o).dotc(&column.column(k))
            });
            let by_resolvent = &vectors * &resolvent_parts;
            for i in 0..order {
                for s in 0..self.resolvent_scalars.nrows() {
                    self.put(place, self.resolvent_column(i, s), by_resolvent[(i, s)]);
                }
            }
            let by_weight = weights * &weight_parts;
            for o in 0..outputs {
                for s in 0..self.weight_scalars.nrows() {
                    self.put(place, self.weight_column(o, s), by_weight[(o, s)]);
                }
            }
            let by_states = &vectors * weight_parts.columns(0, order);
            for (p, block) in blocks.iter().enumerate() {
                let product = by_states[(block.vector, block.scalar)] * block.sign;
                self.put(place, p, product);
            }
            for (other, second) in columns.iter().enumerate() {
                self.put(place, first + other, column.dotc(second).re);
            }
        }
    }

    /// Adds the gradient `J'e`.
    fn add_gradient(&mut self) {
        let order = self.model.order();
        let inputs = self.model.b.ncols();
        let outputs = self.model.c.nrows();
        let columns = self.block_columns();
        for k in 0..self.lines.omega.len() {
            let e = self.residual.column(k);
            let weight = &self.lines.weights[k];
            let mut state_gradients: Vec<Complex<f64>> = Vec::with_capacity(order);
            for i in 0..order {
                let column = self.resolvent.column(k * order + i);
                state_gradients.push(column.iter().zip(e.iter()).map(|(v, e)| v.conj() * e).sum());
            }
            for (p, column) in columns.iter().enumerate() {
                let s = self.weight_scalars[(column.scalar, k)].conj();
                self.gradient[p] += column.sign * (s * state_gradients[column.vector]).re;
            }
            for (i, own) in state_gradients.iter().enumerate() {
                for j in 0..inputs {
                    self.gradient[self.model.place_of_b(i, j)] +=
                        (self.resolvent_scalars[(j, k)].conj() * own).re;
                }
            }
            for o in 0..outputs {
                let output_gradient: Complex<f64> = (o..outputs)
                    .map(|below| e[below] * weight[(below, o)].conj())
                    .sum();
                for s in 0..order + inputs {
                    let place = self.weight_column(o, s);
                    self.gradient[place] +=
                        (self.weight_scalars[(s, k)].conj() * output_gradient).re;
                }
            }
        }
    }
}

/// Returns `[Re z; -Im z]` of `z = conj(s) t`, two rows for each line, a column for each pair (s,
/// t): multiplied by `[Re h, Im h]` they give the summed `Re(h z)`.
fn scalar_products(
    left: &DMatrix<Complex<f64>>,
    right: &DMatrix<Complex<f64>>,
    pairs: &[IndexPair],
) -> DMatrix<f64> {
    let mut products = DMatrix::zeros(2 * left.ncols(), pairs.len());
    for (mut column, pair) in products.column_iter_mut().zip(pairs) {
        for k in 0..left.ncols() {
            let product = left[(pair.left, k)].conj() * right[(pair.right, k)];
            column[2 * k] = product.re;
            column[2 * k + 1] = -product.im;
        }
    }
    products
}

/// Returns `[Re s; Im s]`, two rows for each line, a column for each scalar.
fn parts(scalars: &DMatrix<Complex<f64>>) -> DMatrix<f64> {
    DMatrix::from_fn(2 * scalars.ncols(), scalars.nrows(), |row, s| {
        let scalar = scalars[(s, row / 2)];
        if row % 2 == 0 { scalar.re } else { scalar.im }
    })
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::identification::known_answers_tests::{
        answers, known_records, matrix, number, numbers,
    };
    use crate::spectra::spectrum::Spectrum;

    fn known_start(known: &Value) -> BlockModel {
        let start = &known["blocks_at_start"];
        let a = matrix(&start["A"]);
        let blocks = [0, 2].map(|first| Block::Pair {
            a0: -a[(first + 1, first)],
            a1: -a[(first + 1, first + 1)],
        });
        BlockModel {
            blocks: blocks.to_vec(),
            b: matrix(&start["B"]),
            c: matrix(&start["C"]),
            d: matrix(&known["start"]["D"]),
        }
    }

    fn total(likelihood: &Likelihood, model: &BlockModel) -> (f64, NormalSystem) {
        let parts = likelihood.parts(model).unwrap();
        let sum = NormalSystem::sum(
            model.parameters(),
            &normal_systems(likelihood, model, &parts).unwrap(),
        );
        (parts.iter().map(|part| part.cost).sum(), sum)
    }

    #[test]
    fn cost_gradient_and_diagonal_match_independent_code() {
        let known = &answers()["likelihood_noise_free"];
        let (cost, system) = total(&known_records(known), &known_start(known));
        // Reference results from independent numpy code; the file states the tolerance. The cost
        // agrees as well.
        assert!(
            (cost / number(&known["cost_at_start"]) - 1.0).abs() < 1e-8,
            "{cost}"
        );
        let gradient = numbers(&known["g_at_start"]);
        let diagonal = numbers(&known["G_diagonal_at_start"]);
        let largest = gradient
            .iter()
            .fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        for (k, expected) in gradient.iter().enumerate() {
            assert!(
                (system.gradient[k] - expected).abs() < 1e-8 * largest,
                "g {k}: {} {expected}",
                system.gradient[k]
            );
        }
        for (k, expected) in diagonal.iter().enumerate() {
            assert!(
                (system.matrix[(k, k)] / expected - 1.0).abs() < 1e-8,
                "G {k}"
            );
        }
    }

    /// A step in one parameter.
    fn single_step(model: &BlockModel, place: usize, size: f64) -> DVector<f64> {
        let mut step = DVector::zeros(model.parameters());
        step[place] = size;
        step
    }

    #[test]
    fn the_gradient_matches_finite_differences() {
        let known = &answers()["likelihood_noise_free"];
        let mut likelihood = known_records(known);
        for segment in &mut likelihood.segments {
            let weight = |k: usize| {
                let real = nalgebra::dmatrix![1.0 + 0.1 * (k as f64).sin(), 0.0; 0.4, 2.0 + (k as f64).cos()];
                let mut weight = real.map(Complex::from);
                weight[(1, 0)].im = 0.3;
                weight
            };
            let spectrum = Spectrum {
                record: segment.record,
                duration_s: 40.0,
                omega: segment.omega.clone(),
                inputs: segment.inputs.clone(),
                outputs: segment.outputs.clone(),
                hats: Vec::new(),
            };
            *segment =
                SpectralLines::weighted(&spectrum, (0..segment.omega.len()).map(weight).collect());
        }
        let mut model = known_start(known);
        // Add a single pole to the pairs.
        model.blocks.push(Block::Single(-0.9));
        model.b = model.b.insert_row(4, 0.3);
        model.c = model.c.insert_column(4, -0.4);
        let (_, system) = total(&likelihood, &model);
        let step = 1e-5;
        for place in 0..model.parameters() {
            let [above, below] = [step, -step].map(|size| {
                let stepped = model.stepped(&single_step(&model, place, size));
                likelihood.cost(&stepped).unwrap()
            });
            let slope = (above - below) / (2.0 * step);
            // Central differences: the error is the third derivative times 1e-10, plus the rounding
            // error of the cost over 1e-5.
            let scale = system.gradient.amax();
            assert!(
                (slope + 2.0 * system.gradient[place]).abs() < 1e-6 * scale,
                "{place}: {slope} {}",
                system.gradient[place]
            );
        }
    }

    #[test]
    fn the_gram_form_matches_the_dense_form() {
        let known = &answers()["likelihood_noise_free"];
        let likelihood = known_records(known);
        let model = known_start(known);
        let segment = &likelihood.segments[0];
        let part = segment
            .cost(&model, &likelihood.resolvents(&model))
            .unwrap();
        let system = Gram::new(segment, &model, &part).system().unwrap();
        // Columns of the dense Jacobian by differences of W (G U + C R tau), exact up to rounding
        // in B and D.
        let places = [
            model.place_of_b(1, 1),
            model.place_of_b(2, 0),
            model.place_of_d(1, 0),
            model.place_of_c(1, 2),
        ];
        let column = |place: usize| {
            let stepped = model.stepped(&single_step(&model, place, 1.0));
            let mut values = Vec::new();
            for (k, &omega) in segment.omega.iter().enumerate() {
                let input = segment.inputs.column(k).into_owned();
                let [after, before] = [&stepped, &model].map(|model| {
                    let mut x =
                        model.b.map(Complex::from) * &input + part.transient.map(Complex::from);
                    model.resolve(omega, x.as_mut_slice());
                    model.c.map(Complex::from) * x + model.d.map(Complex::from) * &input
                });
                values.extend((after - before).iter().flat_map(|y| [y.re, y.im]));
            }
            DVector::from_vec(values)
        };
        let mut nuisance = Vec::new();
        for i in 0..4 {
            let mut values = Vec::new();
            for &omega in &segment.omega {
                let mut cr = DMatrix::zeros(2, 4);
                model.output_resolvent(omega, cr.as_mut_slice());
                values.extend(cr.column(i).iter().flat_map(|y| [y.re, y.im]));
            }
            nuisance.push(DVector::from_vec(values));
        }
        for o in 0..2 {
            // Real and imaginary parts of both outputs at each line.
            let mut constant = DVector::zeros(4 * segment.omega.len());
            let mut drift = DVector::zeros(4 * segment.omega.len());
            for (k, omega) in segment.omega.iter().enumerate() {
                constant[4 * k + 2 * o] = 1.0;
                drift[4 * k + 2 * o + 1] = -1.0 / omega;
            }
            nuisance.push(constant);
            nuisance.push(drift);
        }
        let basis = DMatrix::from_columns(&nuisance).qr().q();
        let columns: Vec<_> = places
            .iter()
            .map(|&place| {
                let column = column(place);
                &column - &basis * (basis.transpose() * &column)
            })
            .collect();
        for (i, &p) in places.iter().enumerate() {
            for (j, &q) in places.iter().enumerate() {
                let expected = columns[i].dot(&columns[j]);
                // Products of columns of length 10: rounding errors of numbers up to 1e2.
                assert!((system.matrix[(p, q)] - expected).abs() < 1e-10, "{p} {q}");
            }
        }
    }
}
