//! Normal equations for all entries of `[[A, B], [C, D]]`, in bins over frequency (M14.19).
//!
//! ```text
//! The column of entry (v, s) of [[A, B], [C, D]] at a line is v s:
//!    v in the columns of V = [W C R, W],   s in the entries of S = [X; U],   X = R (B U + tau)
//!    nuisance columns are V times a vector, times a scalar: 1, 1/(j omega), b_q
//! 1  bins of 0.04 in ln omega, each with V^H V at its middle
//! 2  G = sum over bins of Re(V^H V (x) sum conj(S) S')
//! 3  J'T, T'T likewise for each segment; G less J'T (T'T)^+ T'J
//! 4  g = Re sum (V^H e) S^H at every line: exact
//! ```
//!
//! The error of `G` is about 1e-4; it changes the path to the minimum, not the minimum. The changes
//! of coordinates, n^2 of the (n + l)(n + m) directions, are orthogonal to `g`.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::each;

use super::cost::{DEPENDENT, Likelihood, SegmentCost, SpectralLines, multiply, whiten};
use super::dense_model::DenseModel;
use super::gram_matrix::pseudo_inverse_root;
use super::linear_model::LinearModel;

/// Width of a bin in ln omega.
const BIN_WIDTH: f64 = 1e-9;

/// Lines of all segments with nearly the same frequency.
struct Bin {
    /// Mean frequency \[rad/s\].
    omega: f64,
    /// `V^H V`, (n + outputs) x (n + outputs), for weights of scale 1.
    products: DMatrix<Complex<f64>>,
}

/// Scalars of a segment, summed over the lines of each bin.
struct SegmentSums {
    /// `sum conj(S) S'` in each bin, by the index of the bin.
    squares: Vec<DMatrix<Complex<f64>>>,
    /// `sum conj(S) sigma` in each bin, (n + inputs) x scalars of the nuisance columns.
    with_nuisance: Vec<DMatrix<Complex<f64>>>,
    /// `sum conj(sigma) sigma'` in each bin.
    nuisance: Vec<DMatrix<Complex<f64>>>,
    /// `g` of the segment.
    gradient: DMatrix<f64>,
}

/// A nuisance column: `V vector` times a scalar.
struct NuisanceColumn {
    /// Entries of the vector that are not zero, with their index in `V`.
    vector: Vec<(usize, f64)>,
    /// Index of the scalar: 0 for 1, 1 for 1/(j omega), then the hats.
    scalar: usize,
}

/// `G` and `g` in all entries of `[[A, B], [C, D]]`, column after column.
pub(crate) struct DenseSystem {
    /// `G`, with the nuisance columns eliminated.
    pub(crate) matrix: DMatrix<f64>,
    /// `g`.
    pub(crate) gradient: DVector<f64>,
    /// Diagonal of `J'J`, before the nuisance columns are eliminated.
    pub(crate) whole_diagonal: DVector<f64>,
}

/// Computes `G` and `g` at a model; `parts` are the segment costs there.
///
/// `None` if an iteration does not converge.
pub(crate) fn dense_system(
    likelihood: &Likelihood,
    model: &DenseModel,
    parts: &[SegmentCost],
) -> Option<DenseSystem> {
    let binning = Binning::new(likelihood);
    let bins = binning.bins(likelihood, model);
    let segments = likelihood.segments.iter().zip(parts).zip(&binning.places);
    let sums = each(likelihood.executor, segments, |((lines, part), places)| {
        SegmentSums::new(lines, model, part, places, bins.len())
    });
    let size = model.order() + model.d().ncols();
    let vectors = model.order() + model.d().nrows();
    let mut squares = vec![DMatrix::<Complex<f64>>::zeros(size, size); bins.len()];
    let mut gradient = DMatrix::zeros(vectors, size);
    for segment in &sums {
        for (sum, own) in squares.iter_mut().zip(&segment.squares) {
            *sum += own;
        }
        gradient += &segment.gradient;
    }
    let mut matrix = kronecker_sum(&bins, &squares);
    let whole_diagonal = matrix.diagonal();
    let segments = likelihood.segments.iter().zip(&sums);
    let explained = each(likelihood.executor, segments, |(lines, sums)| {
        explained_by_nuisance(&bins, sums, &nuisance_columns(lines, model))
    });
    for root in explained {
        let root = root?;
        matrix.gemm(-1.0, &root, &root.transpose(), 1.0);
    }
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
    fn new(likelihood: &Likelihood) -> Self {
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
                first + lines[first..].partition_point(|line| line.0 < lines[first].0 + BIN_WIDTH);
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
    fn bins(&self, likelihood: &Likelihood, model: &DenseModel) -> Vec<Bin> {
        let middles = self.omega.iter().zip(&self.representatives);
        each(likelihood.executor, middles, |(&omega, &(segment, k))| {
            let lines = &likelihood.segments[segment];
            let weight = lines.weights[k].unscale(lines.scale);
            let vectors = vectors_at(model, omega, &weight);
            Bin {
                omega,
                products: vectors.adjoint() * &vectors,
            }
        })
    }
}

/// Computes `V = [W C R, W]` at a frequency, outputs x (n + outputs).
fn vectors_at(
    model: &DenseModel,
    omega: f64,
    weight: &DMatrix<Complex<f64>>,
) -> DMatrix<Complex<f64>> {
    let outputs = model.c().nrows();
    let order = model.order();
    let mut cr = vec![Complex::default(); outputs * order];
    model.output_resolvent(omega, &mut cr);
    let mut vectors = DMatrix::zeros(outputs, order + outputs);
    for (state, column) in cr.chunks_exact(outputs).enumerate() {
        let mut to = vectors.column_mut(state);
        whiten(weight, column, |o, value| to[o] = value);
    }
    vectors.columns_mut(order, outputs).copy_from(weight);
    vectors
}

impl SegmentSums {
    fn new(
        lines: &SpectralLines,
        model: &DenseModel,
        part: &SegmentCost,
        places: &[usize],
        bins: usize,
    ) -> Self {
        let order = model.order();
        let inputs = model.d().ncols();
        let size = order + inputs;
        let scalars = 2 + lines.hats.len();
        let mut sums = Self {
            squares: vec![DMatrix::zeros(size, size); bins],
            with_nuisance: vec![DMatrix::zeros(size, scalars); bins],
            nuisance: vec![DMatrix::zeros(scalars, scalars); bins],
            gradient: DMatrix::zeros(order + model.c().nrows(), size),
        };
        let completed = lines.completed_inputs(&part.hat_values);
        let power = Complex::from(lines.scale * lines.scale);
        let mut x = vec![Complex::default(); order];
        for (k, (&omega, &place)) in lines.omega.iter().zip(places).enumerate() {
            multiply(model.b(), completed.column(k).as_slice(), &mut x);
            for (value, tau) in x.iter_mut().zip(part.transient.iter()) {
                *value += tau;
            }
            model.resolve(omega, &mut x);
            let mut s = DVector::<Complex<f64>>::zeros(size);
            s.rows_mut(0, order).copy_from_slice(&x);
            s.rows_mut(order, inputs).copy_from(&completed.column(k));
            let conjugate = s.conjugate();
            let mut sigma = DVector::<Complex<f64>>::zeros(scalars);
            sigma[0] = Complex::from(1.0);
            sigma[1] = Complex::new(0.0, -1.0 / omega);
            for (hat, to) in lines
                .hats
                .iter()
                .zip(sigma.rows_mut(2, scalars - 2).iter_mut())
            {
                *to = hat.lines[k];
            }
            sums.squares[place].ger(power, &conjugate, &s, Complex::from(1.0));
            sums.with_nuisance[place].ger(power, &conjugate, &sigma, Complex::from(1.0));
            sums.nuisance[place].ger(power, &sigma.conjugate(), &sigma, Complex::from(1.0));
            let vectors = vectors_at(model, omega, &lines.weights[k]);
            let along = vectors.ad_mul(&part.residual.column(k));
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
fn kronecker_sum(bins: &[Bin], squares: &[DMatrix<Complex<f64>>]) -> DMatrix<f64> {
    let vectors = bins.first().map_or(0, |bin| bin.products.nrows());
    let scalars = squares.first().map_or(0, DMatrix::nrows);
    let vector_pairs = ordered_pairs(vectors);
    let scalar_pairs = ordered_pairs(scalars);
    let mut left_re = DMatrix::zeros(vector_pairs.len(), bins.len());
    let mut left_im = left_re.clone();
    let mut right_re = DMatrix::zeros(bins.len(), scalar_pairs.len());
    let mut right_im = right_re.clone();
    for (bin, own) in bins.iter().enumerate() {
        for (row, &(v, w)) in vector_pairs.iter().enumerate() {
            let product = own.products[(v, w)];
            left_re[(row, bin)] = product.re;
            left_im[(row, bin)] = product.im;
        }
        for (column, &(s, t)) in scalar_pairs.iter().enumerate() {
            let product = squares[bin][(s, t)];
            right_re[(bin, column)] = product.re;
            right_im[(bin, column)] = product.im;
        }
    }
    let re = left_re * right_re;
    let im = left_im * right_im;
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

/// Returns the nuisance columns of a segment: tau, c0, c1, hats.
fn nuisance_columns(lines: &SpectralLines, model: &DenseModel) -> Vec<NuisanceColumn> {
    let order = model.order();
    let outputs = model.c().nrows();
    let mut columns = Vec::with_capacity(order + 2 * outputs + lines.hats.len());
    for vector in 0..order + outputs {
        columns.push(NuisanceColumn {
            vector: vec![(vector, 1.0)],
            scalar: 0,
        });
    }
    for output in 0..outputs {
        columns.push(NuisanceColumn {
            vector: vec![(order + output, 1.0)],
            scalar: 1,
        });
    }
    for (number, hat) in lines.hats.iter().enumerate() {
        let vector = match hat.side {
            ChannelSide::Output => vec![(order + hat.channel, 1.0)],
            ChannelSide::Input => {
                let b = model.b().column(hat.channel);
                let d = model.d().column(hat.channel);
                b.iter().chain(d.iter()).copied().enumerate().collect()
            }
        };
        columns.push(NuisanceColumn {
            vector,
            scalar: 2 + number,
        });
    }
    columns
}

/// Computes `J'T F` with `F F' = (T'T)^+` for the nuisance columns of a segment; `None` if an
/// iteration does not converge.
fn explained_by_nuisance(
    bins: &[Bin],
    sums: &SegmentSums,
    columns: &[NuisanceColumn],
) -> Option<DMatrix<f64>> {
    let vectors = bins.first()?.products.nrows();
    let scalars = sums.with_nuisance.first()?.nrows();
    let count = columns.len();
    let mut with_parameters = DMatrix::<f64>::zeros(vectors * scalars, count);
    let mut with_nuisance = DMatrix::<f64>::zeros(count, count);
    for (place, bin) in bins.iter().enumerate() {
        if sums.nuisance[place][(0, 0)].re == 0.0 {
            continue;
        }
        // V^H V vector of each column.
        let mut images = DMatrix::<Complex<f64>>::zeros(vectors, count);
        for (number, column) in columns.iter().enumerate() {
            let mut image = images.column_mut(number);
            for &(vector, factor) in &column.vector {
                image.axpy(
                    Complex::from(factor),
                    &bin.products.column(vector),
                    Complex::from(1.0),
                );
            }
        }
        for (number, column) in columns.iter().enumerate() {
            let image = images.column(number);
            let products = sums.with_nuisance[place].column(column.scalar);
            let mut to = with_parameters.column_mut(number);
            for (s, product) in products.iter().enumerate() {
                for (v, value) in image.iter().enumerate() {
                    to[s * vectors + v] += (value * product).re;
                }
            }
            for (other, second) in columns.iter().enumerate().take(number + 1) {
                let mut product = Complex::<f64>::default();
                for &(vector, factor) in &second.vector {
                    product += image[vector] * factor;
                }
                let scalar = sums.nuisance[place][(second.scalar, column.scalar)];
                with_nuisance[(other, number)] += (product * scalar).re;
            }
        }
    }
    with_nuisance.fill_lower_triangle_with_upper_triangle();
    let root = pseudo_inverse_root(with_nuisance, DEPENDENT)?;
    Some(with_parameters * root)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, dmatrix};

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
                let lines = segment.omega.iter().map(|w| Complex::from_polar(0.1, -3.0 * w));
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
        let found = dense_system(&likelihood, &dense, &dense_parts).unwrap();
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
