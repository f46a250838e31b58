//! The local polynomial method: the frequency response from the spectral lines, without a model.

use std::ops::Range;

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::executor::{Executor, each};

use super::response_estimate::{EstimatePoint, ResponseEstimate, TERMS};
use super::spectrum::Spectrum;

/// Number of polynomial terms (1, x) if there are too few lines for three.
const FEWER_TERMS: usize = 2;
/// Minimum half-width of a window \[rad/s\] (M14.2).
const LEAST_HALF_WIDTH: f64 = 0.45;
/// Half-width of a window, relative to its centre frequency (M14.2).
const HALF_WIDTH_SHARE: f64 = 0.2;
/// First factor by which a window with too few lines is widened (M14.12).
const FIRST_WIDENING: f64 = 1.2;
/// Factor for each further widening (M14.12).
const FURTHER_WIDENING: f64 = 1.05;
/// Number of lines that a window with three terms needs in addition to the number of unknowns and
/// outputs (M14.12).
const SPARE_LINES: usize = 6;
/// Number of lines that a window with two terms needs in addition to the number of unknowns and
/// outputs.
const SPARE_LINES_FEWER_TERMS: usize = 4;
/// Ridge relative to the column length; it bounds the estimate if one input is a copy of another.
const RIDGE: f64 = 1e-9;

/// Why the frequency response cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LocalPolynomialError {
    /// No lines, inputs or outputs.
    #[error("there are no spectral lines for a frequency response")]
    Nothing,
    /// A segment has other channel counts than the first; index of its record, counted from 0.
    #[error("record {} differs from the first in its number of channels", .0 + 1)]
    ChannelsDiffer(usize),
    /// A line or a frequency is not finite, or a frequency is not greater than 0.
    #[error("the spectra contain values that are not finite")]
    NotFinite,
    /// Fewer lines than first-degree polynomials need.
    #[error(
        "the records have {lines} spectral lines in the band, but {needed} are needed: log \
        longer, or leave out channels"
    )]
    TooFewLines {
        /// Number of lines in all records.
        lines: usize,
        needed: usize,
    },
}

/// Estimates the response at each of `omegas` \[rad/s\] from all segments' lines (M14.2).
///
/// After R. Pintelon, J. Schoukens, G. Vandersteen & K. Barbé, "Estimation of nonparametric noise
/// and FRF models for multivariable systems", Mech. Syst. Signal Process. 24, 2010, with separate
/// transients for the records. Around each frequency, with `x = (omega_k - omega) / h`, the lines
/// of record `r` obey
///
/// ```text
/// Y = (G0 + G1 x + G2 x^2) U + (t0 + t1 x + t2 x^2)_r + V
///
/// 1  h = max(0.45, 0.2 omega), times 1.2 once and then times 1.05 until the window holds
///    3 inputs + 3 records + outputs + 6 lines; records with fewer than four lines there are
///    omitted; if all lines together are too few, the terms in x^2 are omitted too
/// 2  for each record A = [U, x U, x^2 U] and B = Y, less their projection on [1, x, x^2]
/// 3  [A B] = Q R, all records stacked;    R = [R11 R12; 0 R22]
/// 4  G0 = first columns of R11^-1 R12,    Cv = Re(R22^H R22) / freedom
///    var G0 = Cv (R11^H R11)^-1
/// 5  coherence = 1 - |V|^2 / |B|^2,   partial coherence = 1 - |V|^2 / |V without the input|^2
/// ```
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

/// Fits local polynomials around each of `omegas` \[rad/s\]; `share` is the half-width of a window
/// relative to its centre. See [`local_polynomial`].
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
    let first = spectra.first().ok_or(LocalPolynomialError::Nothing)?;
    let inputs = first.inputs.nrows();
    let outputs = first.outputs.nrows();
    if omegas.is_empty() || inputs == 0 || outputs == 0 {
        return Err(LocalPolynomialError::Nothing);
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

/// The lines around a frequency.
pub(crate) struct Window {
    /// Centre \[rad/s\].
    pub(crate) omega: f64,
    /// Half-width \[rad/s\].
    pub(crate) half_width: f64,
    /// Number of polynomial terms.
    terms: usize,
    /// Range of the lines of each spectrum in the window; empty if these are too few.
    lines: Vec<Range<usize>>,
    /// Number of spectral lines in the window, over all spectra with enough lines.
    count: usize,
    /// Number of transient columns, over all records.
    transients: usize,
}

impl Window {
    /// Returns the window around `omega`, widened until it holds enough lines (M14.12).
    fn around(spectra: &[Spectrum], omega: f64, share: f64) -> Result<Self, LocalPolynomialError> {
        match Self::with_terms(spectra, omega, share, TERMS) {
            Ok(window) => Ok(window),
            Err(_) => Self::with_terms(spectra, omega, share, FEWER_TERMS),
        }
    }

    fn with_terms(
        spectra: &[Spectrum],
        omega: f64,
        share: f64,
        terms: usize,
    ) -> Result<Self, LocalPolynomialError> {
        let inputs = spectra[0].inputs.nrows();
        let outputs = spectra[0].outputs.nrows();
        let spare = if terms == TERMS {
            SPARE_LINES
        } else {
            SPARE_LINES_FEWER_TERMS
        };
        let farthest = farthest_line(spectra, omega);
        let mut half_width = LEAST_HALF_WIDTH.max(share * omega);
        let mut widening = FIRST_WIDENING;
        loop {
            let window = Self::with_half_width(spectra, omega, half_width, terms);
            let needed = terms * inputs + window.transients + outputs + spare;
            // At least one record must have enough lines.
            if window.transients > 0 && window.count >= needed {
                return Ok(window);
            }
            if half_width >= farthest {
                return Err(LocalPolynomialError::TooFewLines {
                    lines: window.count,
                    needed,
                });
            }
            half_width *= widening;
            widening = FURTHER_WIDENING;
        }
    }

    fn with_half_width(spectra: &[Spectrum], omega: f64, half_width: f64, terms: usize) -> Self {
        let lines: Vec<Range<usize>> = spectra
            .iter()
            .map(|spectrum| lines_inside(spectrum, omega, half_width, terms))
            .collect();
        let count = lines.iter().map(ExactSizeIterator::len).sum();
        let transients = terms * lines.iter().filter(|range| !range.is_empty()).count();
        Self {
            omega,
            half_width,
            terms,
            lines,
            count,
            transients,
        }
    }
}

/// Returns the distance \[rad/s\] from `omega` to the farthest line.
fn farthest_line(spectra: &[Spectrum], omega: f64) -> f64 {
    let mut farthest = 0.0_f64;
    for spectrum in spectra {
        for line in spectrum
            .omega
            .first()
            .into_iter()
            .chain(spectrum.omega.last())
        {
            farthest = farthest.max((line - omega).abs());
        }
    }
    farthest
}

/// Returns the range of a spectrum's lines within `half_width` of `omega`; empty if there are no
/// more lines than terms.
fn lines_inside(spectrum: &Spectrum, omega: f64, half_width: f64, terms: usize) -> Range<usize> {
    let from = spectrum.omega.partition_point(|&w| w < omega - half_width);
    let to = spectrum
        .omega
        .partition_point(|&w| w <= omega + half_width)
        .max(from);
    if to - from > terms {
        from..to
    } else {
        from..from
    }
}

/// Local polynomials fitted in a window.
pub(crate) struct LocalFit {
    pub(crate) window: Window,
    /// The triangular factor of `[A B]`.
    r: DMatrix<Complex<f64>>,
    inputs: usize,
    outputs: usize,
    /// Summed line power of each output.
    power: DVector<f64>,
    /// Number of lines less the number of unknowns.
    pub(crate) freedom: usize,
}

impl LocalFit {
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

    fn unknowns(&self) -> usize {
        self.window.terms * self.inputs
    }

    /// Returns the mean line power of each output.
    pub(crate) fn power(&self) -> DVector<f64> {
        &self.power / self.window.count as f64
    }

    /// Returns `Cov V` of a line, outputs x outputs.
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

    /// Returns `G0`, outputs x inputs.
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

    /// Returns the block of `(A'A)^-1` that belongs to `G0`, inputs x inputs.
    pub(crate) fn spread(&self) -> DMatrix<Complex<f64>> {
        let unknowns = self.unknowns();
        let inverse = self.solve(&DMatrix::identity(unknowns, unknowns));
        inverse.rows(0, self.inputs) * inverse.rows(0, self.inputs).adjoint()
    }

    /// Returns the squared norms of the output columns of the factor, from row `from` on.
    fn squares(&self, from: usize) -> Vec<f64> {
        squares_below(&self.r, self.unknowns(), self.outputs, from)
    }

    /// Returns the multiple coherence of each output.
    pub(crate) fn coherence(&self) -> Vec<f64> {
        let residual = self.squares(self.unknowns());
        let total = self.squares(0);
        residual
            .into_iter()
            .zip(total)
            .map(|(residual, total)| explained(residual, total))
            .collect()
    }

    /// Returns `|V|^2` of each output with input `i` left out, from the triangular factor without
    /// the columns of this input, made triangular again.
    fn residual_without(&self, i: usize) -> Vec<f64> {
        let unknowns = self.unknowns();
        let kept: Vec<usize> = (0..unknowns + self.outputs)
            .filter(|&column| column >= unknowns || column % self.inputs != i)
            .collect();
        let smaller = self.r.select_columns(&kept).qr().unpack_r();
        let remaining = unknowns - self.window.terms;
        squares_below(&smaller, remaining, self.outputs, remaining)
    }

    /// Returns the partial coherence, outputs x inputs.
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

    /// Returns the estimate at the centre of the window; see [`local_polynomial`].
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

/// The linear regression in a window.
struct Regression {
    /// Rows `[A B]` of all records with the transients removed, followed by the rows of the ridge.
    rows: DMatrix<Complex<f64>>,
    /// Sum of `|Y|^2` of each output.
    power: DVector<f64>,
}

impl Regression {
    fn new(spectra: &[Spectrum], window: &Window) -> Self {
        let inputs = spectra[0].inputs.nrows();
        let outputs = spectra[0].outputs.nrows();
        let unknowns = window.terms * inputs;
        let mut regression = Self {
            rows: DMatrix::zeros(window.count + unknowns, unknowns + outputs),
            power: DVector::zeros(outputs),
        };
        let mut top = 0;
        for (spectrum, lines) in spectra.iter().zip(&window.lines) {
            if lines.is_empty() {
                continue;
            }
            let x: Vec<f64> = spectrum.omega[lines.clone()]
                .iter()
                .map(|w| (w - window.omega) / window.half_width)
                .collect();
            for (k, (line, x)) in lines.clone().zip(&x).enumerate() {
                regression.fill_row(top + k, spectrum, line, *x, window.terms);
            }
            regression.remove_transient(top, &x, window.terms);
            top += x.len();
        }
        regression.add_ridge(top, unknowns);
        regression
    }

    /// Writes `[U, x U, x^2 U | Y]` for a line.
    fn fill_row(&mut self, row: usize, spectrum: &Spectrum, line: usize, x: f64, terms: usize) {
        let inputs = spectrum.inputs.nrows();
        for (i, u) in spectrum.inputs.column(line).iter().enumerate() {
            let mut term = *u;
            for power in 0..terms {
                self.rows[(row, power * inputs + i)] = term;
                term *= x;
            }
        }
        for (o, y) in spectrum.outputs.column(line).iter().enumerate() {
            self.rows[(row, terms * inputs + o)] = *y;
            self.power[o] += y.norm_sqr();
        }
    }

    /// Subtracts from the rows of a record their projection on its polynomial transient.
    fn remove_transient(&mut self, top: usize, x: &[f64], terms: usize) {
        let powers = DMatrix::from_fn(x.len(), terms, |line, power| x[line].powi(power as i32));
        let transient = powers.qr().q().map(Complex::from);
        let mut record_rows = self.rows.rows_mut(top, x.len());
        let explained = &transient * transient.ad_mul(&record_rows);
        record_rows -= explained;
    }

    /// Adds a ridge proportional to the lengths of the columns of `A`.
    fn add_ridge(&mut self, top: usize, unknowns: usize) {
        for column in 0..unknowns {
            let length = self.rows.column(column).norm();
            let ridge = if length > 0.0 { RIDGE * length } else { 1.0 };
            self.rows[(top + column, column)] = Complex::from(ridge);
        }
    }
}

/// Returns the square of the ratio of the largest to the smallest singular value.
pub(crate) fn condition(matrix: DMatrix<Complex<f64>>) -> f64 {
    let singular = matrix.singular_values();
    let greatest = singular.max();
    let least = singular.min().max(f64::MIN_POSITIVE.sqrt() * greatest);
    (greatest / least).powi(2)
}
