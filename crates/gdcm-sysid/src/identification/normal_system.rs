//! The normal equations of the cost, in Gram form (M14, sections 4 and 8).
//!
//! ```text
//! Each column of the Jacobian of W G U is a vector v of one entry an output times a scalar s, at each line:
//!    block      v = (W C R)_2      s = -X_1, -X_2 (a pair), X (a single pole)         R = (j omega - A)^-1
//!    B_ij       v = (W C R)_i      s = U_j                                            X = R (B U + tau)
//!    C_oi, D_oj v = W e_o          s = X_i, U_j
//!    tau_i, c1_o, c0_o: v = (W C R)_i, W e_o, W e_o, s = 1, 1/(j omega), 1
//! J'J[p, q] = sum_k Re(v_p^H v_q  s_p^* s_q): a product of two matrices, (pairs of v) x (lines) times (lines) x (pairs of s)
//! transient eliminated: G = J'J - J'T (T'T)^+ T'J,   g = J'e, as e is orthogonal to T
//! ```
//!
//! With tau in X the gradient is exact: variable projection in the form of Kaufman, BIT 15, 1975.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::each;

use super::blocks::{Block, BlockModel};
use super::gram_matrix::{pseudo_inverse_root, scale_columns};
use super::likelihood::{DEPENDENT, Likelihood, SegmentCost, SpectralLines, whiten};

/// `G`, `g` and the cost: a step `d` changes the cost by `-2 g'd + d'G d`.
#[derive(Clone, Debug)]
pub(super) struct NormalSystem {
    /// `G = J'J`, the transients eliminated.
    pub(super) matrix: DMatrix<f64>,
    /// `g = J'e`.
    pub(super) gradient: DVector<f64>,
}

impl NormalSystem {
    /// The sum of some; `parameters` says how large it is where there are none.
    pub(super) fn sum<'s>(parameters: usize, systems: impl IntoIterator<Item = &'s Self>) -> Self {
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

    /// Takes another one off.
    pub(super) fn without(&self, other: &Self) -> Self {
        Self {
            matrix: &self.matrix - &other.matrix,
            gradient: &self.gradient - &other.gradient,
        }
    }

    /// The step of Levenberg and Marquardt, `(G + lambda diag G) d = g`; none where it is not finite.
    pub(super) fn damped_step(&self, lambda: f64) -> Option<DVector<f64>> {
        let mut scaled = self.matrix.clone();
        let scales = scale_columns(&mut scaled);
        for (k, scale) in scales.iter().enumerate() {
            scaled[(k, k)] = if *scale > 0.0 { 1.0 + lambda } else { 1.0 };
        }
        let step = scaled
            .cholesky()?
            .solve(&self.gradient.component_mul(&scales))
            .component_mul(&scales);
        step.iter().all(|entry| entry.is_finite()).then_some(step)
    }
}

/// The systems of all segments at a model, in the order of the segments; `parts` are the segments' costs at it.
pub(super) fn normal_systems(
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

/// Sums the normal systems of the segments of one record; `systems` are those of all segments.
pub(super) fn system_of_record(
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

/// `J'd` of one segment for the column `d` that stands in the place of the residual of `part`, its transient taken off.
pub(super) fn gradient_along(
    lines: &SpectralLines,
    model: &BlockModel,
    part: &SegmentCost,
) -> DVector<f64> {
    let mut gram = Gram::new(lines, model, part);
    gram.add_gradient();
    gram.gradient
}

/// The vectors and scalars of one segment, and the Gram matrix that comes of them.
///
/// Columns are numbered: the parameters, then tau, c1, c0.
struct Gram<'a> {
    model: &'a BlockModel,
    lines: &'a SpectralLines,
    residual: &'a DMatrix<Complex<f64>>,
    /// `W C R`, outputs x (n lines): n columns a line.
    resolvent: DMatrix<Complex<f64>>,
    /// `U` and 1, one column a line: the scalars of `B` and tau.
    resolvent_scalars: DMatrix<Complex<f64>>,
    /// `X`, `U`, 1/(j omega) and 1, one column a line: the scalars of `C`, `D`, c1 and c0.
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
        for (k, &omega) in lines.omega.iter().enumerate() {
            model.output_resolvent(omega, &mut cr);
            for (i, column) in cr.chunks_exact(outputs).enumerate() {
                let mut to = resolvent.column_mut(k * order + i);
                whiten(&lines.weights[k], column, |o, value| to[o] = value);
            }
            let input = lines.inputs.column(k);
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
        let size = model.parameters() + order + 2 * outputs;
        let matrix = DMatrix::zeros(size, size);
        let gradient = DVector::zeros(model.parameters());
        Self {
            model,
            lines,
            residual: &part.residual,
            resolvent,
            resolvent_scalars,
            weight_scalars,
            matrix,
            gradient,
        }
    }

    /// The system with the transient eliminated; none where an iteration does not end.
    fn system(mut self) -> Option<NormalSystem> {
        self.add_resolvent();
        self.add_weight();
        self.add_resolvent_with_weight();
        self.add_blocks();
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

    /// Column of the vector `(W C R)_state` times the scalar of this number.
    fn resolvent_column(&self, state: usize, scalar: usize) -> usize {
        if scalar < self.model.b.ncols() {
            self.model.place_of_b(state, scalar)
        } else {
            self.model.parameters() + state
        }
    }

    /// Column of the vector `W e_output` times the scalar of this number.
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

    fn put(&mut self, p: usize, q: usize, value: f64) {
        self.matrix[(p, q)] = value;
        self.matrix[(q, p)] = value;
    }

    /// `(W C R)_i^H (W C R)_i'` at line `k`.
    fn resolvent_product(&self, k: usize, i: usize, other: usize) -> Complex<f64> {
        let order = self.model.order();
        let left = self.resolvent.column(k * order + i);
        let right = self.resolvent.column(k * order + other);
        left.iter()
            .zip(right.iter())
            .map(|(a, b)| a.conj() * b)
            .sum()
    }

    /// Real and imaginary part of a product of each row at each line: two columns a line.
    fn line_products(
        &self,
        rows: usize,
        product: impl Fn(usize, usize) -> Complex<f64>,
    ) -> DMatrix<f64> {
        let mut products = DMatrix::zeros(rows, 2 * self.lines.omega.len());
        for k in 0..self.lines.omega.len() {
            let (mut real, mut imaginary) = products.columns_range_pair_mut(2 * k, 2 * k + 1);
            for row in 0..rows {
                let product = product(k, row);
                (real[row], imaginary[row]) = (product.re, product.im);
            }
        }
        products
    }

    /// `B` and tau with themselves.
    fn add_resolvent(&mut self) {
        let order = self.model.order();
        let scalars = self.resolvent_scalars.nrows();
        let pairs: Vec<_> = (0..order)
            .flat_map(|i| (i..order).map(move |other| (i, other)))
            .collect();
        let left = self.line_products(pairs.len(), |k, row| {
            self.resolvent_product(k, pairs[row].0, pairs[row].1)
        });
        let scalar_pairs: Vec<_> = (0..scalars)
            .flat_map(|s| (0..scalars).map(move |t| (s, t)))
            .collect();
        let products = left
            * scalar_products(
                &self.resolvent_scalars,
                &self.resolvent_scalars,
                &scalar_pairs,
            );
        for (row, &(i, other)) in pairs.iter().enumerate() {
            for (column, &(s, t)) in scalar_pairs.iter().enumerate() {
                self.put(
                    self.resolvent_column(i, s),
                    self.resolvent_column(other, t),
                    products[(row, column)],
                );
            }
        }
    }

    /// `C`, `D`, c1 and c0 with themselves: `W'W` is real.
    fn add_weight(&mut self) {
        let outputs = self.model.c.nrows();
        let scalars = self.weight_scalars.nrows();
        let count = self.lines.omega.len();
        let pairs: Vec<_> = (0..outputs)
            .flat_map(|o| (o..outputs).map(move |other| (o, other)))
            .collect();
        let mut left = DMatrix::<f64>::zeros(pairs.len(), count);
        for (k, weight) in self.lines.weights.iter().enumerate() {
            for (row, &(o, other)) in pairs.iter().enumerate() {
                left[(row, k)] = (other..outputs)
                    .map(|below| weight[(below, o)] * weight[(below, other)])
                    .sum();
            }
        }
        let scalar_pairs: Vec<_> = (0..scalars)
            .flat_map(|s| (s..scalars).map(move |t| (s, t)))
            .collect();
        let mut right = DMatrix::<f64>::zeros(scalar_pairs.len(), count);
        for (k, weight_scalars) in self.weight_scalars.column_iter().enumerate() {
            for (to, &(s, t)) in right.column_mut(k).iter_mut().zip(&scalar_pairs) {
                *to = weight_scalars[s].re * weight_scalars[t].re
                    + weight_scalars[s].im * weight_scalars[t].im;
            }
        }
        let products = left * right.transpose();
        for (row, &(o, other)) in pairs.iter().enumerate() {
            for (column, &(s, t)) in scalar_pairs.iter().enumerate() {
                self.put(
                    self.weight_column(o, s),
                    self.weight_column(other, t),
                    products[(row, column)],
                );
                self.put(
                    self.weight_column(o, t),
                    self.weight_column(other, s),
                    products[(row, column)],
                );
            }
        }
    }

    /// `(W e_o)^H (W C R)_i` at line `k`.
    fn weight_product(&self, k: usize, o: usize, i: usize) -> Complex<f64> {
        let column = self.resolvent.column(k * self.model.order() + i);
        let weight = &self.lines.weights[k];
        (o..column.len())
            .map(|below| column[below] * weight[(below, o)])
            .sum()
    }

    /// `B` and tau with `C`, `D`, c1 and c0.
    fn add_resolvent_with_weight(&mut self) {
        let order = self.model.order();
        let outputs = self.model.c.nrows();
        let product =
            |k: usize, row: usize| self.weight_product(k, row % outputs, row / outputs).conj();
        let left = self.line_products(order * outputs, product);
        let resolvent_count = self.resolvent_scalars.nrows();
        let weight_count = self.weight_scalars.nrows();
        let scalar_pairs: Vec<_> = (0..resolvent_count)
            .flat_map(|s| (0..weight_count).map(move |t| (s, t)))
            .collect();
        let products =
            left * scalar_products(&self.resolvent_scalars, &self.weight_scalars, &scalar_pairs);
        for row in 0..order * outputs {
            for (column, &(s, t)) in scalar_pairs.iter().enumerate() {
                let p = self.resolvent_column(row / outputs, s);
                let q = self.weight_column(row % outputs, t);
                self.put(p, q, products[(row, column)]);
            }
        }
    }

    /// Of every parameter of the blocks: state of its vector, state of its scalar, sign.
    fn block_columns(&self) -> Vec<(usize, usize, f64)> {
        let columns = self.model.rows().flat_map(|(first, block)| match block {
            Block::Pair { .. } => vec![(first + 1, first, -1.0), (first + 1, first + 1, -1.0)],
            Block::Single(_) => vec![(first, first, 1.0)],
        });
        columns.collect()
    }

    /// The blocks with everything.
    fn add_blocks(&mut self) {
        let order = self.model.order();
        let outputs = self.model.c.nrows();
        let resolvent_count = self.resolvent_scalars.nrows();
        let weight_count = self.weight_scalars.nrows();
        let columns = self.block_columns();
        let [resolvent_parts, weight_parts] =
            [&self.resolvent_scalars, &self.weight_scalars].map(parts);
        for (p, &(vector, scalar, sign)) in columns.iter().enumerate() {
            // conj(s_p) goes into the left factor.
            let s = |k: usize| self.weight_scalars[(scalar, k)].conj() * sign;
            let product = |k: usize, i: usize| (self.resolvent_product(k, vector, i) * s(k)).conj();
            let with_resolvent = self.line_products(order, product);
            let with_weight = self.line_products(outputs, |k, o| {
                (self.weight_product(k, o, vector).conj() * s(k)).conj()
            });
            let by_resolvent = &with_resolvent * &resolvent_parts;
            let by_weight = with_weight * &weight_parts;
            for i in 0..order {
                (0..resolvent_count)
                    .for_each(|s| self.put(p, self.resolvent_column(i, s), by_resolvent[(i, s)]));
            }
            for o in 0..outputs {
                (0..weight_count)
                    .for_each(|s| self.put(p, self.weight_column(o, s), by_weight[(o, s)]));
            }
            let by_states = with_resolvent * weight_parts.columns(0, order);
            for (q, &(other, other_scalar, other_sign)) in columns.iter().enumerate() {
                self.put(p, q, by_states[(other, other_scalar)] * other_sign);
            }
        }
    }

    /// `J'e`.
    fn add_gradient(&mut self) {
        let order = self.model.order();
        let inputs = self.model.b.ncols();
        let outputs = self.model.c.nrows();
        let columns = self.block_columns();
        for k in 0..self.lines.omega.len() {
            let e = self.residual.column(k);
            let weight = &self.lines.weights[k];
            let of_state = |i: usize| -> Complex<f64> {
                let column = self.resolvent.column(k * order + i);
                column.iter().zip(e.iter()).map(|(v, e)| v.conj() * e).sum()
            };
            let state_gradients: Vec<_> = (0..order).map(of_state).collect();
            for (p, &(vector, scalar, sign)) in columns.iter().enumerate() {
                self.gradient[p] +=
                    sign * (self.weight_scalars[(scalar, k)].conj() * state_gradients[vector]).re;
            }
            for (i, own) in state_gradients.iter().enumerate() {
                for j in 0..inputs {
                    self.gradient[self.model.place_of_b(i, j)] +=
                        (self.resolvent_scalars[(j, k)].conj() * own).re;
                }
            }
            for o in 0..outputs {
                let output_gradient: Complex<f64> = (o..outputs)
                    .map(|below| e[below] * weight[(below, o)])
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

/// `[Re z; -Im z]` of `z = conj(s) t`, two rows a line, one column a pair (s, t): times `[Re h, Im h]` the sum of `Re(h z)`.
fn scalar_products(
    left: &DMatrix<Complex<f64>>,
    right: &DMatrix<Complex<f64>>,
    pairs: &[(usize, usize)],
) -> DMatrix<f64> {
    let mut products = DMatrix::zeros(2 * left.ncols(), pairs.len());
    for (mut column, &(s, t)) in products.column_iter_mut().zip(pairs) {
        for (k, (left, right)) in left.row(s).iter().zip(right.row(t).iter()).enumerate() {
            let product = left.conj() * right;
            (column[2 * k], column[2 * k + 1]) = (product.re, -product.im);
        }
    }
    products
}

/// `[Re s; Im s]`, two rows a line, one column a scalar.
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
    use crate::identification::spectrum::Spectrum;

    fn known_start(known: &Value) -> BlockModel {
        let start = &known["blocks_at_start"];
        let a = matrix(&start["A"]);
        let pair = |first: usize| Block::Pair {
            a0: -a[(first + 1, first)],
            a1: -a[(first + 1, first + 1)],
        };
        BlockModel {
            blocks: vec![pair(0), pair(2)],
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
    fn cost_gradient_and_diagonal_are_those_of_independent_code() {
        let known = &answers()["likelihood_noise_free"];
        let (cost, system) = total(&known_records(known), &known_start(known));
        // Independent numpy code; the tolerance stands in its file, the cost is as good.
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

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        let known = &answers()["likelihood_noise_free"];
        let mut likelihood = known_records(known);
        for segment in &mut likelihood.segments {
            let weight = |k: usize| nalgebra::dmatrix![1.0 + 0.1 * (k as f64).sin(), 0.0; 0.4, 2.0 + (k as f64).cos()];
            let spectrum = Spectrum {
                record: segment.record,
                duration_s: 40.0,
                omega: segment.omega.clone(),
                inputs: segment.inputs.clone(),
                outputs: segment.outputs.clone(),
            };
            *segment =
                SpectralLines::weighted(&spectrum, (0..segment.omega.len()).map(weight).collect());
        }
        let mut model = known_start(known);
        // A single pole beside the pairs.
        model.blocks.push(Block::Single(-0.9));
        model.b = model.b.insert_row(4, 0.3);
        model.c = model.c.insert_column(4, -0.4);
        let (_, system) = total(&likelihood, &model);
        let step = 1e-5;
        for place in 0..model.parameters() {
            let at = |size: f64| {
                let step =
                    DVector::from_fn(
                        model.parameters(),
                        |k, _| if k == place { size } else { 0.0 },
                    );
                likelihood.cost(&model.stepped(&step)).unwrap()
            };
            let slope = (at(step) - at(-step)) / (2.0 * step);
            // Central differences: the third derivative times 1e-10, and rounding of the cost over 1e-5.
            let scale = system.gradient.amax();
            assert!(
                (slope + 2.0 * system.gradient[place]).abs() < 1e-6 * scale,
                "{place}: {slope} {}",
                system.gradient[place]
            );
        }
    }

    #[test]
    fn the_gram_form_is_the_dense_form() {
        let known = &answers()["likelihood_noise_free"];
        let likelihood = known_records(known);
        let model = known_start(known);
        let segment = &likelihood.segments[0];
        let part = segment.cost(&model).unwrap();
        let system = Gram::new(segment, &model, &part).system().unwrap();
        // Columns of the dense Jacobian by differences of W (G U + C R tau), exact up to rounding in B and D.
        let places = [
            model.place_of_b(1, 1),
            model.place_of_b(2, 0),
            model.place_of_d(1, 0),
            model.place_of_c(1, 2),
        ];
        let column = |place: usize| {
            let step = DVector::from_fn(
                model.parameters(),
                |k, _| if k == place { 1.0 } else { 0.0 },
            );
            let stepped = model.stepped(&step);
            let mut values = Vec::new();
            for (k, &omega) in segment.omega.iter().enumerate() {
                let output = |model: &BlockModel| {
                    let mut x = model.b.map(Complex::from) * segment.inputs.column(k)
                        + part.transient.map(Complex::from);
                    model.resolve(omega, x.as_mut_slice());
                    model.c.map(Complex::from) * x
                        + model.d.map(Complex::from) * segment.inputs.column(k)
                };
                values.extend(
                    (output(&stepped) - output(&model))
                        .iter()
                        .flat_map(|y| [y.re, y.im]),
                );
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
            let of = |line: &dyn Fn(f64) -> [f64; 2]| {
                let values = segment.omega.iter().flat_map(|&w| {
                    (0..2).flat_map(move |other| {
                        let [re, im] = [if other == o { 1.0 } else { 0.0 }; 2];
                        [(re, w), (im, w)]
                    })
                });
                let values = values
                    .enumerate()
                    .map(|(k, (unit, w))| unit * line(w)[k % 2]);
                DVector::from_iterator(4 * segment.omega.len(), values)
            };
            nuisance.push(of(&|_| [1.0, 0.0]));
            nuisance.push(of(&|w| [0.0, -1.0 / w]));
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
                // Normal equations of columns of length 10: rounding of 1e2.
                assert!((system.matrix[(p, q)] - expected).abs() < 1e-10, "{p} {q}");
            }
        }
    }
}
