//! Measures the frequency response from spectral lines without a model, by the local polynomial
//! method (M14.2): [`local_polynomial`] has the steps.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};

use super::local_polynomial_error::LocalPolynomialError;
use super::polynomial_regression::Regression;
use super::polynomial_window::Window;
use super::response_estimate::{EstimatePoint, ResponseEstimate};
use super::spectrum::Spectrum;

/// First window half-width, relative to the centre frequency (M14.2).
const HALF_WIDTH_SHARE: f64 = 0.2;

/// Estimates the response at `omegas` \[rad/s\] from all segments' lines (M14.2).
///
/// After R. Pintelon, J. Schoukens, G. Vandersteen & K. Barbé, "Estimation of nonparametric noise
/// and FRF models for multivariable systems", Mech. Syst. Signal Process. 24, 2010, with separate
/// transients for the records. Around each frequency, with `x = (omega_k - omega) / h`, the lines
/// in record `r` obey
///
/// ```text
/// Y = (G0 + G1 x + G2 x^2) U + (t0 + t1 x + t2 x^2)_r + V
///
/// 1  h = max(0.45, 0.2 omega), times 1.2 once and then times 1.05 until the window holds
///    3 inputs + 3 records + outputs + 6 lines; records with fewer than four lines in the window
///    are omitted; if all lines together are too few, the terms in x^2 are omitted too
/// 2  for each record A = [U, x U, x^2 U] and B = Y, less their projection on [1, x, x^2],
///    which removes the transient
/// 3  [A B] = Q R, all records stacked;    R = [R11 R12; 0 R22]
/// 4  G0 = first columns of R11^-1 R12,    Cv = Re(R22^H R22) / freedom
///    var G0 = Cv (R11^H R11)^-1
/// 5  coherence = 1 - |V|^2 / |B|^2,   partial coherence = 1 - |V|^2 / |V without the input|^2
/// ```
///
/// `U` and `Y` are the input and output lines, `V` the noise with the covariance `Cv`, `t0` to `t2`
/// a record's transient; `freedom` is the line count less the unknowns. Step 1 is in
/// `polynomial_window`, step 2 in `polynomial_regression`.
///
/// # Errors
/// No lines, channels that differ, values that are not finite, records too short for a window.
pub fn local_polynomial(
    spectra: &[Spectrum],
    omegas: &[f64],
    executor: &dyn Executor,
) -> Result<ResponseEstimate, LocalPolynomialError> {
    let fits = local_fits(spectra, omegas, HALF_WIDTH_SHARE, executor)?;
    let mut points: Vec<EstimatePoint> = each(executor, &fits, LocalFit::estimate);
    points.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    Ok(ResponseEstimate { points })
}

/// Fits local polynomials around each frequency in `omegas` \[rad/s\]; `share` is the first window
/// half-width over the centre frequency. See [`local_polynomial`].
pub(crate) fn local_fits(
    spectra: &[Spectrum],
    omegas: &[f64],
    share: f64,
    executor: &dyn Executor,
) -> Result<Vec<LocalFit>, LocalPolynomialError> {
    check_lines(spectra, omegas)?;
    each(executor, omegas, |&omega| {
        let window = Window::around(spectra, omega, share)?;
        Ok(LocalFit::new(spectra, window))
    })
    .into_iter()
    .collect()
}

/// Returns an error for lines and frequencies that do not permit an estimate.
fn check_lines(spectra: &[Spectrum], omegas: &[f64]) -> Result<(), LocalPolynomialError> {
    let first = spectra.first().ok_or(LocalPolynomialError::Nothing {
        missing: "spectral lines",
    })?;
    let inputs = first.inputs.nrows();
    let outputs = first.outputs.nrows();
    for (count, missing) in [
        (inputs, "inputs"),
        (outputs, "outputs"),
        (omegas.len(), "frequencies in the band"),
    ] {
        if count == 0 {
            return Err(LocalPolynomialError::Nothing { missing });
        }
    }
    for spectrum in spectra {
        if spectrum.inputs.nrows() != inputs || spectrum.outputs.nrows() != outputs {
            return Err(LocalPolynomialError::ChannelsDiffer(spectrum.record));
        }
    }
    for spectrum in spectra {
        let power = [&spectrum.inputs, &spectrum.outputs].map(|lines| lines.norm_squared());
        if !power.iter().all(|power| power.is_finite()) {
            return Err(LocalPolynomialError::NotFinite);
        }
    }
    if !omegas.iter().all(|w| w.is_finite() && *w > 0.0) {
        return Err(LocalPolynomialError::NotFinite);
    }
    Ok(())
}

/// Local polynomials fitted in a window.
pub(crate) struct LocalFit {
    pub(crate) window: Window,
    /// The triangular factor of `[A B]`.
    r: DMatrix<Complex<f64>>,
    inputs: usize,
    outputs: usize,
    /// Summed line power for each output.
    power: DVector<f64>,
    /// Number of lines less number of unknowns.
    pub(crate) freedom: usize,
}

impl LocalFit {
    /// Fits the polynomials (steps 2 and 3).
    fn new(spectra: &[Spectrum], window: Window) -> Self {
        let inputs = spectra[0].inputs.nrows();
        let outputs = spectra[0].outputs.nrows();
        let freedom = window.count - window.transients - window.terms * inputs;
        let regression = Regression::new(spectra, &window);
        Self {
            r: regression.rows.qr().unpack_r(),
            inputs,
            outputs,
            power: regression.power,
            freedom,
            window,
        }
    }

    /// Returns the number of columns in `A`.
    fn unknowns(&self) -> usize {
        self.window.terms * self.inputs
    }

    /// Returns each output's mean line power.
    pub(crate) fn power(&self) -> DVector<f64> {
        &self.power / self.window.count as f64
    }

    /// Returns `Cv` at a line (step 4), outputs x outputs; complex, before the real part is taken.
    pub(crate) fn covariance(&self) -> DMatrix<Complex<f64>> {
        let residual = self.r.view(
            (self.unknowns(), self.unknowns()),
            (self.outputs, self.outputs),
        );
        (residual.adjoint() * residual).map(|value| value.conj() / self.freedom as f64)
    }

    /// Computes `R11^-1 right`; zero if `R11` is singular, which the ridge excludes.
    fn solve(&self, right: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
        let r11 = self.r.view((0, 0), (self.unknowns(), self.unknowns()));
        r11.solve_upper_triangular(right)
            .unwrap_or_else(|| right.map(|_| Complex::default()))
    }

    /// Returns `G0` (step 4), outputs x inputs, from its transpose in the first rows of
    /// `R11^-1 R12`.
    pub(crate) fn response(&self) -> DMatrix<Complex<f64>> {
        let unknowns = self.unknowns();
        let theta = self.solve(
            &self
                .r
                .view((0, unknowns), (unknowns, self.outputs))
                .clone_owned(),
        );
        theta.rows(0, self.inputs).transpose()
    }

    /// Returns the block of `(A'A)^-1` that belongs to `G0` (step 4), inputs x inputs.
    pub(crate) fn spread(&self) -> DMatrix<Complex<f64>> {
        let unknowns = self.unknowns();
        let inverse = self.solve(&DMatrix::identity(unknowns, unknowns));
        inverse.rows(0, self.inputs) * inverse.rows(0, self.inputs).adjoint()
    }

    /// Returns the squared norms of the factor's output columns, from row `from` on.
    fn squares(&self, from: usize) -> Vec<f64> {
        squares_below(&self.r, self.unknowns(), self.outputs, from)
    }

    /// Returns each output's multiple coherence (step 5).
    pub(crate) fn coherence(&self) -> Vec<f64> {
        let residual = self.squares(self.unknowns());
        let total = self.squares(0);
        residual
            .into_iter()
            .zip(total)
            .map(|(residual, total)| explained(residual, total))
            .collect()
    }

    /// Returns each output's `|V|^2` with input `i` left out: the triangular factor loses this
    /// input's columns and is made triangular again. Column `power inputs + i` in `A` belongs to
    /// input `i`.
    fn residual_without(&self, i: usize) -> Vec<f64> {
        let unknowns = self.unknowns();
        let kept: Vec<usize> = (0..unknowns + self.outputs)
            .filter(|&column| column >= unknowns || column % self.inputs != i)
            .collect();
        let smaller = self.r.select_columns(&kept).qr().unpack_r();
        let remaining = unknowns - self.window.terms;
        squares_below(&smaller, remaining, self.outputs, remaining)
    }

    /// Returns the partial coherence (step 5), outputs x inputs.
    fn partial_coherence(&self) -> DMatrix<f64> {
        let residual = self.squares(self.unknowns());
        let mut coherence = DMatrix::zeros(self.outputs, self.inputs);
        for i in 0..self.inputs {
            let without = self.residual_without(i);
            for o in 0..self.outputs {
                coherence[(o, i)] = explained(residual[o], without[o]);
            }
        }
        coherence
    }

    /// Returns the estimate at the window centre; see [`local_polynomial`].
    fn estimate(&self) -> EstimatePoint {
        let inputs = self.inputs;
        let outputs = self.outputs;
        let noise = self.covariance().map(|value| value.re);
        let spread = self.spread();
        EstimatePoint {
            omega: self.window.omega,
            response: self.response(),
            variance: DMatrix::from_fn(outputs, inputs, |o, i| noise[(o, o)] * spread[(i, i)].re),
            noise,
            power: self.power(),
            coherence: DVector::from_vec(self.coherence()),
            partial_coherence: self.partial_coherence(),
            condition: condition(self.r.view((0, 0), (inputs, inputs)).clone_owned()),
            half_width: self.window.half_width,
            freedom: self.freedom,
        }
    }
}

/// Returns the squared norms of `count` columns from `first` on, from row `from` down.
fn squares_below(
    factor: &DMatrix<Complex<f64>>,
    first: usize,
    count: usize,
    from: usize,
) -> Vec<f64> {
    (first..first + count)
        .map(|column| factor.column(column).rows_range(from..).norm_squared())
        .collect()
}

/// Returns `1 - residual / total`, between 0 and 1; 0 if there is nothing to explain.
fn explained(residual: f64, total: f64) -> f64 {
    if total > 0.0 {
        (1.0 - residual / total).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Returns the squared ratio between the largest and the smallest singular value.
pub(crate) fn condition(matrix: DMatrix<Complex<f64>>) -> f64 {
    let singular = matrix.singular_values();
    let greatest = singular.max();
    let least = singular.min().max(f64::MIN_POSITIVE.sqrt() * greatest);
    (greatest / least).powi(2)
}
