//! Normal equations for all entries of `[[A, B], [C, D]]`, in bins over frequency (M14.19).
//!
//! ```text
//! G = J'J,  g = J'e;   e: whitened residual, W: weights, U: inputs, tau: transient (`cost`)
//! The column of J for entry (v, s) of [[A, B], [C, D]] is v s at each line:
//!    v in the columns of V = [W C R, W],   s in the entries of S = [X; U],
//!    X = R (B U + tau),   R = (j omega - A)^-1
//! 1  bins over ln omega, each with V^H V at its middle                       (`frequency_bins`)
//! 2  G = sum over bins of Re(V^H V (x) sum conj(S) S'),   (x) the Kronecker product
//!                                                                            (`kronecker_sum`)
//! 3  G less the part that the nuisance columns explain                 (`nuisance_elimination`)
//! 4  g = Re sum (V^H e) S^H at every line: exact
//! ```
//!
//! With bins 0.04 wide in ln omega, the diagonal entries of `G` are in error by less than 1 %. Bins
//! narrower than the line spacing hold only equal frequencies, from records with equal length: then
//! `G` is exact. Coordinate changes, n^2 of the (n + l)(n + m) directions (n states, m inputs, l
//! outputs), are orthogonal to `g`.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Sequential, each};

use super::balancing::Gramians;
use super::cost::{Likelihood, SegmentCost};
use super::frequency_bins::FrequencyBins;
use super::frequency_table::{FrequencyTable, OutputResolvents};
use super::kronecker_sum::{ScalarSquares, kronecker_sum, subtract_squares};
use super::nuisance_elimination::NuisanceSums;
use super::schur_model::SchurModel;
use super::spectral_lines::SpectralLines;

/// Bin width in ln omega during the descent to the minimum.
pub(crate) const BIN_WIDTH: f64 = 0.04;
/// Bin width in ln omega for which only lines with the same frequency share a bin: `G` is exact.
pub(crate) const EXACT: f64 = 1e-9;

/// `G` and `g` in all entries of `[[A, B], [C, D]]`, column after column.
pub(crate) struct NormalEquations {
    /// `G`, with the nuisance columns eliminated.
    pub(crate) matrix: DMatrix<f64>,
    /// `g`.
    pub(crate) gradient: DVector<f64>,
    /// Diagonal of `J'J`, before the nuisance columns are eliminated.
    pub(crate) whole_diagonal: DVector<f64>,
    /// Gramians of the states, transients included.
    pub(crate) gramians: Gramians,
}

impl NormalEquations {
    /// Computes `G` and `g` at a model, with bins of this width in ln omega; `parts` are the
    /// segment costs at this model.
    ///
    /// `None` if the nuisance columns of a segment are not finite, or their eigenvalue iteration
    /// does not converge.
    pub(crate) fn new(
        likelihood: &Likelihood,
        model: &SchurModel,
        parts: &[SegmentCost],
        bin_width: f64,
    ) -> Option<Self> {
        // Step 1.
        let resolvents = likelihood.resolvents(model);
        let bins = FrequencyBins::new(likelihood, bin_width);
        let products = bins.vector_products(likelihood, model);
        // Steps 2 to 4: sums over the lines of each segment.
        let segments = likelihood.segments.iter().zip(parts).zip(&bins.of_lines);
        let sums = each(
            likelihood.executor,
            segments,
            |((lines, part), line_bins)| {
                let segment = SegmentAtModel {
                    lines,
                    model,
                    part,
                    resolvents: &resolvents,
                };
                segment.sums(line_bins, bins.count())
            },
        );
        // Steps 2 and 4: over all segments.
        let outputs = model.d().nrows();
        let order = model.order();
        let size = order + model.d().ncols();
        let mut squares = ScalarSquares::zeros(size, bins.count());
        let mut gradient = DMatrix::zeros(order + outputs, size);
        for segment in &sums {
            squares.add(&segment.squares);
            gradient += &segment.gradient;
        }
        let mut matrix = kronecker_sum(&products, &squares, likelihood.executor);
        let whole_diagonal = matrix.diagonal();
        // Step 3.
        let segments = likelihood.segments.iter().zip(&sums);
        let explained = each(likelihood.executor, segments, |(lines, sums)| {
            sums.nuisance.explained(&products, lines, model)
        });
        let mut roots = Vec::with_capacity(explained.len());
        for root in explained {
            roots.push(root?);
        }
        subtract_squares(&mut matrix, &roots, likelihood.executor);
        Some(Self {
            matrix,
            gradient: DVector::from_column_slice(gradient.as_slice()),
            whole_diagonal,
            gramians: Gramians {
                controllability: squares.controllability(order),
                observability: products.observability(order, &bins.squared_scales()),
            },
        })
    }
}

/// Computes the inner products of a segment's `J` with a further column, in all entries; `extra` is
/// the segment's cost with that column instead of its residual.
pub(super) fn products_with(
    lines: &SpectralLines,
    model: &SchurModel,
    extra: &SegmentCost,
) -> DVector<f64> {
    let table = FrequencyTable::new([lines.omega.as_slice()].into_iter());
    let resolvents = table.output_resolvents(model, &Sequential);
    let segment = SegmentAtModel {
        lines,
        model,
        part: extra,
        resolvents: &resolvents,
    };
    DVector::from_column_slice(segment.gradient(&segment.scalars()).as_slice())
}

/// A segment and its cost at a model.
struct SegmentAtModel<'s> {
    lines: &'s SpectralLines,
    model: &'s SchurModel,
    part: &'s SegmentCost,
    resolvents: &'s OutputResolvents<'s>,
}

/// A segment's contributions to steps 2 to 4.
struct SegmentSums {
    squares: ScalarSquares,
    nuisance: NuisanceSums,
    /// `g`, (n + outputs) x (n + inputs).
    gradient: DMatrix<f64>,
}

/// S at a segment's lines, n + inputs x lines.
struct Scalars {
    re: DMatrix<f64>,
    im: DMatrix<f64>,
}

impl SegmentAtModel<'_> {
    /// Computes S at each line, with the missing inputs completed.
    fn scalars(&self) -> Scalars {
        let lines = self.lines;
        let order = self.model.order();
        let inputs = self.model.d().ncols();
        let completed = lines.completed_inputs(&self.part.hat_values);
        let states = self
            .model
            .states(&lines.omega, &completed, &self.part.transient);
        let mut re = DMatrix::zeros(order + inputs, lines.omega.len());
        let mut im = re.clone();
        re.rows_mut(0, order).copy_from(&states.map(|x| x.re));
        im.rows_mut(0, order).copy_from(&states.map(|x| x.im));
        re.rows_mut(order, inputs)
            .copy_from(&completed.map(|u| u.re));
        im.rows_mut(order, inputs)
            .copy_from(&completed.map(|u| u.im));
        Scalars { re, im }
    }

    /// Computes `g = Re sum (V^H e) S^H` (step 4), (n + outputs) x (n + inputs).
    fn gradient(&self, scalars: &Scalars) -> DMatrix<f64> {
        let along = self.residuals_along_vectors();
        along.map(|v| v.re) * scalars.re.transpose() + along.map(|v| v.im) * scalars.im.transpose()
    }

    /// Sums over the lines, bin by bin.
    fn sums(&self, line_bins: &[usize], bin_count: usize) -> SegmentSums {
        let lines = self.lines;
        let scalars = self.scalars();
        let size = scalars.re.nrows();
        let mut squares = ScalarSquares::zeros(size, bin_count);
        let mut nuisance = NuisanceSums::new(size, bin_count, lines.hats.len());
        let squared_scale = lines.scale * lines.scale;
        let mut conjugate = vec![Complex::default(); size];
        for (k, &bin) in line_bins.iter().enumerate() {
            let re = &scalars.re.as_slice()[k * size..(k + 1) * size];
            let im = &scalars.im.as_slice()[k * size..(k + 1) * size];
            for (entry, (re, im)) in conjugate.iter_mut().zip(re.iter().zip(im)) {
                *entry = Complex::new(*re, -*im);
            }
            squares.add_line(bin, re, im, squared_scale);
            nuisance.add(lines, k, bin, &conjugate);
        }
        SegmentSums {
            squares,
            nuisance,
            gradient: self.gradient(&scalars),
        }
    }

    /// Computes `V^H e` at each line: `[(C R)^H W^H e; W^H e]`.
    fn residuals_along_vectors(&self) -> DMatrix<Complex<f64>> {
        let order = self.model.order();
        let (outputs, lines) = self.part.residual.shape();
        let mut along = DMatrix::zeros(order + outputs, lines);
        let resolvents = self.resolvents.at_lines(&self.lines.omega);
        let weights = self.lines.weights.iter().zip(resolvents).enumerate();
        for (k, (weight, cr)) in weights {
            let weighted = weight.ad_mul(&self.part.residual.column(k));
            for (state, column) in cr.chunks_exact(outputs).enumerate() {
                let products = column.iter().zip(weighted.iter());
                along[(state, k)] = products.map(|(c, w)| c.conj() * w).sum();
            }
            along
                .view_mut((order, k), (outputs, 1))
                .copy_from(&weighted);
        }
        along
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, dmatrix};
    use serde_json::Value;

    use gdcm_model::dataset::channel::ChannelSide;

    use super::*;
    use crate::identification::known_answers_tests::{
        answers, known_records, matrix, number, numbers,
    };
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

    fn start(known: &Value) -> SchurModel {
        let start = &known["blocks_at_start"];
        SchurModel::new(
            matrix(&start["A"]),
            matrix(&start["B"]),
            matrix(&start["C"]),
            matrix(&known["start"]["D"]),
        )
        .unwrap()
    }

    /// Returns row and column in `[[A, B], [C, D]]`, and the sign, of each parameter of a model in
    /// two companion blocks.
    fn companion_entries() -> Vec<(usize, usize, f64)> {
        let mut entries = vec![(1, 0, -1.0), (1, 1, -1.0), (3, 2, -1.0), (3, 3, -1.0)];
        for state in 0..4 {
            entries.extend((4..6).map(|input| (state, input, 1.0)));
        }
        for output in 4..6 {
            entries.extend((0..4).map(|state| (output, state, 1.0)));
        }
        for output in 4..6 {
            entries.extend((4..6).map(|input| (output, input, 1.0)));
        }
        entries
    }

    #[test]
    fn cost_gradient_and_diagonal_match_independent_code() {
        let known = &answers()["likelihood_noise_free"];
        let likelihood = known_records(known);
        let model = start(known);
        let parts = likelihood.parts(&model).unwrap();
        let cost: f64 = parts.iter().map(|part| part.cost).sum();
        // Reference results from independent numpy code; the file states the tolerance.
        assert!(
            (cost / number(&known["cost_at_start"]) - 1.0).abs() < 1e-8,
            "{cost}"
        );
        let system = NormalEquations::new(&likelihood, &model, &parts, EXACT).unwrap();
        let gradient = numbers(&known["g_at_start"]);
        let diagonal = numbers(&known["G_diagonal_at_start"]);
        let largest = DVector::from_vec(gradient.clone()).amax();
        let entries = companion_entries();
        assert_eq!(entries.len(), gradient.len());
        for (p, (row, column, sign)) in entries.into_iter().enumerate() {
            let at = column * 6 + row;
            let found = sign * system.gradient[at];
            assert!(
                (found - gradient[p]).abs() < 1e-8 * largest,
                "g {p}: {found} {}",
                gradient[p]
            );
            assert!(
                (system.matrix[(at, at)] / diagonal[p] - 1.0).abs() < 1e-8,
                "G {p}"
            );
        }
    }

    /// Returns the model after a step in one entry of `[[A, B], [C, D]]`.
    fn stepped(model: &SchurModel, place: usize, size: f64) -> SchurModel {
        let mut step = DMatrix::zeros(6, 6);
        step[place] = size;
        model.stepped(&step).unwrap()
    }

    #[test]
    fn the_gradient_matches_finite_differences() {
        let likelihood = records();
        let model = start(&answers()["likelihood_noise_free"]);
        let parts = likelihood.parts(&model).unwrap();
        let system = NormalEquations::new(&likelihood, &model, &parts, BIN_WIDTH).unwrap();
        let scale = system.gradient.amax();
        let step = 1e-5;
        for place in 0..36 {
            let [above, below] =
                [step, -step].map(|size| likelihood.cost(&stepped(&model, place, size)).unwrap());
            let slope = (above - below) / (2.0 * step);
            // Central differences: the error is about the third derivative times 1e-11, plus the
            // rounding error of the cost over 1e-5.
            assert!(
                (slope + 2.0 * system.gradient[place]).abs() < 1e-6 * scale,
                "{place}: {slope} {}",
                system.gradient[place]
            );
        }
    }

    /// Returns the real and imaginary parts of whitened values at all lines, outputs x lines.
    fn whitened(
        lines: &SpectralLines,
        value: impl Fn(usize) -> DVector<Complex<f64>>,
    ) -> DVector<f64> {
        let mut parts = Vec::new();
        for (k, weight) in lines.weights.iter().enumerate() {
            let whitened = weight * value(k);
            parts.extend(whitened.iter().flat_map(|y| [y.re, y.im]));
        }
        DVector::from_vec(parts)
    }

    /// Returns the nuisance columns of a segment, in real form.
    fn nuisance_columns(lines: &SpectralLines, model: &SchurModel) -> DMatrix<f64> {
        let unit = |o: usize| {
            DMatrix::<Complex<f64>>::identity(2, 2)
                .column(o)
                .into_owned()
        };
        let mut columns = Vec::new();
        for state in 0..4 {
            columns.push(whitened(lines, |k| {
                let mut cr = DMatrix::zeros(2, 4);
                model.output_resolvent(lines.omega[k], cr.as_mut_slice());
                cr.column(state).into_owned()
            }));
        }
        for o in 0..2 {
            columns.push(whitened(lines, |_| unit(o)));
            let integrator = |k: usize| Complex::new(0.0, -1.0 / lines.omega[k]);
            columns.push(whitened(lines, |k| unit(o) * integrator(k)));
        }
        for hat in &lines.hats {
            columns.push(whitened(lines, |k| match hat.side {
                ChannelSide::Output => unit(hat.channel) * hat.lines[k],
                ChannelSide::Input => {
                    let response = model.response(lines.omega[k]);
                    response.column(hat.channel) * hat.lines[k]
                }
            }));
        }
        DMatrix::from_columns(&columns)
    }

    #[test]
    fn the_sums_over_bins_match_columns_of_the_jacobian() {
        let likelihood = Likelihood::of_segment(records().segments[0].clone());
        let lines = &likelihood.segments[0];
        let model = start(&answers()["likelihood_noise_free"]);
        let parts = likelihood.parts(&model).unwrap();
        let system = NormalEquations::new(&likelihood, &model, &parts, EXACT).unwrap();
        let completed = lines.completed_inputs(&parts[0].hat_values);
        // W (G U + C R tau) is linear in the entries of B, C and D: differences are exact up to
        // rounding.
        let places = [4 * 6 + 1, 5 * 6 + 2, 4 * 6 + 5, 2 * 6 + 5, 4];
        let columns = places.map(|place| {
            let [after, before] = [stepped(&model, place, 1.0), model.clone()].map(|model| {
                let states = model.states(&lines.omega, &completed, &parts[0].transient);
                whitened(lines, |k| {
                    model.c().map(Complex::from) * states.column(k)
                        + model.d().map(Complex::from) * completed.column(k)
                })
            });
            after - before
        });
        let basis = nuisance_columns(lines, &model).qr().q();
        let left = columns.map(|column| &column - &basis * basis.tr_mul(&column));
        let largest = system.matrix.amax();
        for (i, &p) in places.iter().enumerate() {
            for (j, &q) in places.iter().enumerate() {
                let expected = left[i].dot(&left[j]);
                // The elimination has a condition number of 1e4.
                assert!(
                    (system.matrix[(p, q)] - expected).abs() < 1e-10 * largest,
                    "{p} {q}: {} {expected}",
                    system.matrix[(p, q)]
                );
            }
        }
    }
}
