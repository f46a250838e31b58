//! Normal equations for all entries of `[[A, B], [C, D]]`, in bins over frequency (M14.19).
//!
//! ```text
//! The column of entry (v, s) of [[A, B], [C, D]] at a line is v s:
//!    v in the columns of V = [W C R, W],   s in the entries of S = [X; U],   X = R (B U + tau)
//! 1  bins over ln omega, each with V^H V at its middle
//! 2  G = sum over bins of Re(V^H V (x) sum conj(S) S')
//! 3  G less the part that the nuisance columns explain (nuisance_elimination)
//! 4  g = Re sum (V^H e) S^H at every line: exact
//! ```
//!
//! With bins of width 0.04, the largest error of a diagonal entry of `G` is below 1 %. Bins narrower
//! than the spacing of the lines hold equal frequencies of records of equal length: then `G` is
//! exact. The changes of coordinates, n^2 of the (n + l)(n + m) directions, are orthogonal to `g`.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};

use super::cost::{Likelihood, SegmentCost, SpectralLines, multiply, whiten};
use super::dense_model::DenseModel;
use super::linear_model::{LinearModel, OutputResolvents};
use super::nuisance_elimination::{NuisanceSums, VectorProducts};

/// Width of a bin in ln omega for the steps of a descent.
pub(crate) const BIN_WIDTH: f64 = 0.04;
/// Width of a bin in ln omega that only lines of the same frequency share: `G` is exact.
pub(crate) const EXACT: f64 = 1e-9;

/// `G` and `g` in all entries of `[[A, B], [C, D]]`, column after column.
pub(crate) struct DenseSystem {
    /// `G`, with the nuisance columns eliminated.
    pub(crate) matrix: DMatrix<f64>,
    /// `g`.
    pub(crate) gradient: DVector<f64>,
    /// Diagonal of `J'J`, before the nuisance columns are eliminated.
    pub(crate) whole_diagonal: DVector<f64>,
}

/// Computes `G` and `g` at a model, with bins of this width in ln omega; `parts` are the segment
/// costs there.
///
/// `None` if an iteration does not converge.
pub(crate) fn dense_system(
    likelihood: &Likelihood,
    model: &DenseModel,
    parts: &[SegmentCost],
    bin_width: f64,
) -> Option<DenseSystem> {
    let resolvents = likelihood.resolvents(model);
    let binning = Binning::new(likelihood, bin_width);
    let products = binning.vector_products(likelihood, model);
    let bins = binning.omega.len();
    let segments = likelihood.segments.iter().zip(parts).zip(&binning.places);
    let sums = each(likelihood.executor, segments, |((lines, part), places)| {
        let segment = SegmentAtModel {
            lines,
            model,
            part,
            resolvents: &resolvents,
        };
        segment.sums(places, bins)
    });
    let inputs = model.d().ncols();
    let outputs = model.d().nrows();
    let size = model.order() + inputs;
    let mut squares = vec![DMatrix::<Complex<f64>>::zeros(size, size); bins];
    let mut gradient = DMatrix::zeros(model.order() + outputs, size);
    for segment in &sums {
        for (place, own) in &segment.squares {
            squares[*place] += own;
        }
        gradient += &segment.gradient;
    }
    let mut matrix = kronecker_sum(&products, &squares, likelihood.executor);
    let whole_diagonal = matrix.diagonal();
    let segments = likelihood.segments.iter().zip(&sums);
    let explained = each(likelihood.executor, segments, |(lines, sums)| {
        sums.nuisance.explained(&products, lines, model)
    });
    let mut roots = Vec::with_capacity(explained.len());
    for root in explained {
        roots.push(root?);
    }
    subtract_squares(&mut matrix, &roots, likelihood.executor);
    Some(DenseSystem {
        matrix,
        gradient: DVector::from_column_slice(gradient.as_slice()),
        whole_diagonal,
    })
}

/// The bin of every line.
struct Binning {
    /// Mean frequency of each bin \[rad/s\].
    omega: Vec<f64>,
    /// Segment and line whose weight represents each bin.
    representatives: Vec<(usize, usize)>,
    /// Bin of each line of each segment.
    places: Vec<Vec<usize>>,
}

impl Binning {
    fn new(likelihood: &Likelihood, width: f64) -> Self {
        let mut lines: Vec<(f64, usize, usize)> = Vec::new();
        for (segment, own) in likelihood.segments.iter().enumerate() {
            for (k, omega) in own.omega.iter().enumerate() {
                lines.push((omega.ln(), segment, k));
            }
        }
        lines.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut binning = Self {
            omega: Vec::new(),
            representatives: Vec::new(),
            places: likelihood
                .segments
                .iter()
                .map(|segment| vec![0; segment.omega.len()])
                .collect(),
        };
        let mut first = 0;
        while first < lines.len() {
            let end =
                first + lines[first..].partition_point(|line| line.0 < lines[first].0 + width);
            let members = &lines[first..end];
            let mean = members.iter().map(|line| line.0).sum::<f64>() / members.len() as f64;
            let nearest = members
                .partition_point(|line| line.0 < mean)
                .min(members.len() - 1);
            for &(_, segment, k) in members {
                binning.places[segment][k] = binning.omega.len();
            }
            binning
                .representatives
                .push((members[nearest].1, members[nearest].2));
            binning.omega.push(mean.exp());
            first = end;
        }
        binning
    }

    /// Computes `V^H V` of every bin.
    fn vector_products(&self, likelihood: &Likelihood, model: &DenseModel) -> VectorProducts {
        let middles = self.omega.iter().zip(&self.representatives);
        let products = each(likelihood.executor, middles, |(&omega, &(segment, k))| {
            let lines = &likelihood.segments[segment];
            let weight = lines.weights[k].unscale(lines.scale);
            let mut cr = vec![Complex::default(); model.c().nrows() * model.order()];
            model.output_resolvent(omega, &mut cr);
            let vectors = vectors(&cr, &weight);
            vectors.adjoint() * &vectors
        });
        VectorProducts::new(products)
    }
}

/// Returns `V = [W C R, W]`, outputs x (n + outputs), from `C R`, column after column.
fn vectors(cr: &[Complex<f64>], weight: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let outputs = weight.nrows();
    let order = cr.len() / outputs;
    let mut vectors = DMatrix::zeros(outputs, order + outputs);
    for (state, column) in cr.chunks_exact(outputs).enumerate() {
        let mut to = vectors.column_mut(state);
        whiten(weight, column, |o, value| to[o] = value);
    }
    vectors.columns_mut(order, outputs).copy_from(weight);
    vectors
}

/// A segment and its cost at a model.
struct SegmentAtModel<'s> {
    lines: &'s SpectralLines,
    model: &'s DenseModel,
    part: &'s SegmentCost,
    resolvents: &'s OutputResolvents<'s>,
}

/// Sums over the lines of a segment.
struct SegmentSums {
    /// `sum conj(S) S'` in each bin with lines, with the index of the bin.
    squares: Vec<(usize, DMatrix<Complex<f64>>)>,
    nuisance: NuisanceSums,
    /// `g`, (n + outputs) x (n + inputs).
    gradient: DMatrix<f64>,
}

impl SegmentAtModel<'_> {
    /// Sums over the lines; `places` holds the bin of each line.
    fn sums(&self, places: &[usize], bins: usize) -> SegmentSums {
        let lines = self.lines;
        let order = self.model.order();
        let (outputs, inputs) = self.model.d().shape();
        let size = order + inputs;
        let completed = lines.completed_inputs(&self.part.hat_values);
        let power = Complex::from(lines.scale * lines.scale);
        let mut sums = SegmentSums {
            squares: Vec::new(),
            nuisance: NuisanceSums::new(size, bins, lines.hats.len()),
            gradient: DMatrix::zeros(order + outputs, size),
        };
        let mut x = vec![Complex::default(); order];
        for (k, cr) in self
            .resolvents
            .at_lines(&lines.omega)
            .into_iter()
            .enumerate()
        {
            let input = completed.column(k);
            multiply(self.model.b(), input.as_slice(), &mut x);
            for (value, tau) in x.iter_mut().zip(self.part.transient.iter()) {
                *value += tau;
            }
            self.model.resolve(lines.omega[k], &mut x);
            let mut s = DVector::<Complex<f64>>::zeros(size);
            s.rows_mut(0, order).copy_from_slice(&x);
            s.rows_mut(order, inputs).copy_from(&input);
            let conjugate = s.conjugate();
            if sums
                .squares
                .last()
                .is_none_or(|(place, _)| *place != places[k])
            {
                sums.squares.push((places[k], DMatrix::zeros(size, size)));
            }
            if let Some((_, square)) = sums.squares.last_mut() {
                square.ger(power, &conjugate, &s, Complex::from(1.0));
            }
            sums.nuisance.add(lines, k, places[k], &conjugate);
            let along = vectors(cr, &lines.weights[k]).ad_mul(&self.part.residual.column(k));
            for (column, scalar) in conjugate.iter().enumerate() {
                let mut to = sums.gradient.column_mut(column);
                for (entry, value) in to.iter_mut().zip(along.iter()) {
                    *entry += (value * scalar).re;
                }
            }
        }
        sums
    }
}

/// Computes `sum over bins of Re(P (x) Q)` for Hermitian `P` and `Q`: entry ((v, s), (v', s')) is
/// `Re(P[v, v'] Q[s, s'])`, with v running fastest.
fn kronecker_sum(
    products: &VectorProducts,
    squares: &[DMatrix<Complex<f64>>],
    executor: &dyn Executor,
) -> DMatrix<f64> {
    let vectors = products.vectors;
    let bins = squares.len();
    let scalars = squares.first().map_or(0, DMatrix::nrows);
    let vector_pairs = ordered_pairs(vectors);
    let scalar_pairs = ordered_pairs(scalars);
    let mut left_re = DMatrix::zeros(vector_pairs.len(), bins);
    let mut left_im = left_re.clone();
    let mut right_re = DMatrix::zeros(bins, scalar_pairs.len());
    let mut right_im = right_re.clone();
    for bin in 0..bins {
        for (row, &(v, w)) in vector_pairs.iter().enumerate() {
            let product = products.entry(bin, v, w);
            left_re[(row, bin)] = product.re;
            left_im[(row, bin)] = product.im;
        }
        for (column, &(s, t)) in scalar_pairs.iter().enumerate() {
            let product = squares[bin][(s, t)];
            right_re[(bin, column)] = product.re;
            right_im[(bin, column)] = product.im;
        }
    }
    let pairs_of_parts = [(&left_re, &right_re), (&left_im, &right_im)];
    let mut parts = each(executor, pairs_of_parts, |(left, right)| left * right).into_iter();
    let re = parts.next().unwrap_or_default();
    let im = parts.next().unwrap_or_default();
    let mut matrix = DMatrix::zeros(vectors * scalars, vectors * scalars);
    for (column, &(s, t)) in scalar_pairs.iter().enumerate() {
        for (row, &(v, w)) in vector_pairs.iter().enumerate() {
            let direct = re[(row, column)] - im[(row, column)];
            let crossed = re[(row, column)] + im[(row, column)];
            let [vs, wt, vt, ws] = [
                s * vectors + v,
                t * vectors + w,
                t * vectors + v,
                s * vectors + w,
            ];
            matrix[(vs, wt)] = direct;
            matrix[(wt, vs)] = direct;
            matrix[(vt, ws)] = crossed;
            matrix[(ws, vt)] = crossed;
        }
    }
    matrix
}

/// Columns that are updated at a time.
const PANEL: usize = 64;

/// Subtracts `sum F F'` over the matrices F from a symmetric matrix.
fn subtract_squares(matrix: &mut DMatrix<f64>, roots: &[DMatrix<f64>], executor: &dyn Executor) {
    let size = matrix.nrows();
    let panels = each(executor, (0..size).step_by(PANEL), |first| {
        let width = PANEL.min(size - first);
        let mut panel = matrix
            .view((first, first), (size - first, width))
            .into_owned();
        for root in roots {
            let turned = root.rows(first, width).transpose();
            panel.gemm(-1.0, &root.rows(first, size - first), &turned, 1.0);
        }
        panel
    });
    for (number, panel) in panels.iter().enumerate() {
        let first = number * PANEL;
        let width = panel.ncols();
        matrix
            .view_mut((first, first), panel.shape())
            .copy_from(panel);
        let below = panel.rows(width, size - first - width).transpose();
        matrix
            .view_mut((first, first + width), below.shape())
            .copy_from(&below);
    }
}

/// Returns all pairs of indices below `count` whose second is not smaller than the first.
fn ordered_pairs(count: usize) -> Vec<(usize, usize)> {
    let mut pairs = Vec::with_capacity(count * (count + 1) / 2);
    for first in 0..count {
        for second in first..count {
            pairs.push((first, second));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, dmatrix};

    use gdcm_model::dataset::channel::ChannelSide;

    use super::*;
    use crate::identification::known_answers_tests::{answers, known_records, matrix};
    use crate::likelihood::blocks::{Block, BlockModel};
    use crate::likelihood::normal_system::{NormalSystem, normal_systems};
    use crate::spectra::gap_hat::GapHat;

    /// Returns records with complex weights and a missing sample in an input and an output.
    fn records() -> Likelihood<'static> {
        let known = &answers()["likelihood_noise_free"];
        let mut likelihood = known_records(known);
        for segment in &mut likelihood.segments {
            for (omega, weight) in segment.omega.iter().zip(&mut segment.weights) {
                let real = dmatrix![1.0 + 0.1 * omega.sin(), 0.0; 0.4, 2.0 + omega.cos()];
                *weight = real.map(Complex::from);
                weight[(1, 0)].im = 0.3;
            }
            for side in [ChannelSide::Input, ChannelSide::Output] {
                let lines = segment
                    .omega
                    .iter()
                    .map(|w| Complex::from_polar(0.1, -3.0 * w));
                segment.hats.push(GapHat {
                    side,
                    channel: 1,
                    lines: lines.collect(),
                });
            }
        }
        likelihood
    }

    #[test]
    fn the_system_matches_that_of_the_block_form() {
        let likelihood = records();
        let known = &answers()["likelihood_noise_free"];
        let start = &known["blocks_at_start"];
        let a = matrix(&start["A"]);
        let blocks = [0, 2].map(|first| Block::Pair {
            a0: -a[(first + 1, first)],
            a1: -a[(first + 1, first + 1)],
        });
        let blocks = BlockModel {
            blocks: blocks.to_vec(),
            b: matrix(&start["B"]),
            c: matrix(&start["C"]),
            d: matrix(&known["start"]["D"]),
        };
        let dense = DenseModel::from_state_space(&blocks.state_space().unwrap()).unwrap();
        let parts = likelihood.parts(&blocks).unwrap();
        let dense_parts = likelihood.parts(&dense).unwrap();
        let expected = NormalSystem::sum(
            blocks.parameters(),
            &normal_systems(&likelihood, &blocks, &parts).unwrap(),
        );
        let found = dense_system(&likelihood, &dense, &dense_parts, EXACT).unwrap();
        // Entry of [[A, B], [C, D]] and sign of each block parameter.
        let mut entries = vec![(1, 0, -1.0), (1, 1, -1.0), (3, 2, -1.0), (3, 3, -1.0)];
        for state in 0..4 {
            entries.extend((0..2).map(|input| (state, 4 + input, 1.0)));
        }
        for output in 0..2 {
            entries.extend((0..4).map(|state| (4 + output, state, 1.0)));
        }
        for output in 0..2 {
            entries.extend((0..2).map(|input| (4 + output, 4 + input, 1.0)));
        }
        assert_eq!(entries.len(), blocks.parameters());
        let largest = expected.matrix.amax();
        for (p, &(row, column, sign)) in entries.iter().enumerate() {
            let at = column * 6 + row;
            let gradient = found.gradient[at] * sign;
            assert!(
                (gradient - expected.gradient[p]).abs() < 1e-9 * expected.gradient.amax(),
                "g {p}: {gradient} {}",
                expected.gradient[p]
            );
            for (q, &(row, column, other)) in entries.iter().enumerate() {
                let entry = found.matrix[(at, column * 6 + row)] * sign * other;
                let difference = (entry - expected.matrix[(p, q)]).abs();
                // Rounding errors of a condition number of 1e4 behind the elimination.
                assert!(
                    difference < 1e-10 * largest,
                    "G {p} {q}: {entry} {}",
                    expected.matrix[(p, q)]
                );
            }
        }
    }
}
