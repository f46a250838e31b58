//! The local polynomial method: the frequency response straight from the lines, without a model.

use super::*;
use crate::executor::{Executor, each};
use nalgebra::{Complex, DMatrix, DVector};

/// Terms of a local polynomial: 1, x, x^2.
pub(super) const TERMS: usize = 3;
/// The least half width of a window of lines \[rad/s\], and over its centre (M14, 2).
const HALF_WIDTH: (f64, f64) = (0.45, 0.2);
/// A window with too few lines is widened by this factor.
const WIDER: f64 = 1.2;
/// SpectralLines beyond the unknowns and the outputs that a window has at least.
const SPARE_LINES: usize = 6;
/// A window of this half width \[rad/s\] must hold the lines that a single record needs, or the records are too short (M14, 10).
const FAIR_HALF_WIDTH: f64 = 1.0;
/// Height of the ridge over the length of a column; it bounds the estimate where inputs are copies of each other.
const RIDGE: f64 = 1e-9;

/// Why there is no measured response.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LocalPolynomialError {
    /// There are no lines, inputs or outputs.
    #[error("there is nothing to estimate a frequency response from")]
    Nothing,
    /// Spectra of differing channels.
    #[error("record {} has another number of channels than the first", record + 1)]
    ChannelsDiffer {
        /// Which record, counted from 0.
        record: usize,
    },
    /// A line or a frequency is not finite, or a frequency is not greater than 0.
    #[error("the spectra hold values that are not finite")]
    NotFinite,
    /// Too few lines around a frequency.
    #[error(
        "the records are too short: {lines} spectral lines around {omega:.2} rad/s where {needed} are needed. \
         A record should last at least {shortest_s:.0} s, better {better_s:.0} s, or the band should begin higher",
        shortest_s = shortest_s(*omega),
        better_s = 2.5 * shortest_s(*omega)
    )]
    TooFewLines {
        /// Centre of the window \[rad/s\].
        omega: f64,
        /// SpectralLines in it, over all records.
        lines: usize,
        /// SpectralLines it takes.
        needed: usize,
    },
}

/// The shortest record \[s\] for which a response at `omega` \[rad/s\], half the lower end of the band, can be estimated: two
/// periods of the lower end of the band (M14, 10).
fn shortest_s(omega: f64) -> f64 {
    std::f64::consts::TAU / omega
}

/// The response at each of `omegas` \[rad/s\] from the lines of all segments together (M14, 2; after Pintelon, Schoukens,
/// Vandersteen & Barbe, Mech. Syst. Signal Process. 24, 2010, with the records' transients apart).
///
/// Around each frequency, with `x = (omega_k - omega) / h`, the lines of record `r` obey
///
/// ```text
/// Y = (G0 + G1 x + G2 x^2) U + (t0 + t1 x + t2 x^2)_r + V
///
///   h = max(0.45, 0.2 omega), times 1.2 until there are lines enough
///   of each record   A = [U, x U, x^2 U] and B = Y, less their projection on [1, x, x^2]
///   [A B] = Q R, all records stacked;    R = [R11 R12; 0 R22]
///   G0 = first columns of R11^-1 R12,    Cv = Re(R22^H R22) / freedom,    var G0 = Cv (R11^H R11)^-1
///   coherence = 1 - |V|^2 / |B|^2,       partial coherence = 1 - |V|^2 / |V without the input|^2
/// ```
///
/// # Errors
/// No lines, differing channels, values that are not finite, records too short for a window.
pub fn local_polynomial(
    spectra: &[Spectrum],
    omegas: &[f64],
    executor: &dyn Executor,
) -> Result<ResponseEstimate, LocalPolynomialError> {
    let first = spectra.first().ok_or(LocalPolynomialError::Nothing)?;
    let channels = |s: &Spectrum| (s.inputs.nrows(), s.outputs.nrows());
    if omegas.is_empty() || first.inputs.nrows() == 0 || first.outputs.nrows() == 0 {
        return Err(LocalPolynomialError::Nothing);
    }
    if let Some(other) = spectra.iter().find(|s| channels(s) != channels(first)) {
        return Err(LocalPolynomialError::ChannelsDiffer { record: other.record });
    }
    let finite = |lines: &DMatrix<Complex<f64>>| lines.norm_squared().is_finite();
    let finite = spectra.iter().all(|s| finite(&s.inputs) && finite(&s.outputs));
    if !finite || !omegas.iter().all(|w| w.is_finite() && *w > 0.0) {
        return Err(LocalPolynomialError::NotFinite);
    }
    let point = |&omega: &f64| Ok(estimate(spectra, &Window::around(spectra, omega)?));
    let mut points = each(executor, omegas, point).into_iter().collect::<Result<Vec<_>, LocalPolynomialError>>()?;
    points.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    Ok(ResponseEstimate { points })
}

/// Whether the lines around `omega` \[rad/s\] are enough; false where there are no spectra.
pub(super) fn is_measurable(spectra: &[Spectrum], omega: f64) -> bool {
    !spectra.is_empty() && Window::around(spectra, omega).is_ok()
}

/// The lines around a frequency.
struct Window {
    omega: f64,
    half_width: f64,
    /// Of each spectrum the first line inside and the first one beyond.
    lines: Vec<(usize, usize)>,
    /// SpectralLines inside, over all spectra.
    count: usize,
    /// Columns that the records' transients take: three each, or as many as the record has lines.
    transients: usize,
}

impl Window {
    /// The window around `omega`, as wide as it must be.
    fn around(spectra: &[Spectrum], omega: f64) -> Result<Self, LocalPolynomialError> {
        let first = &spectra[0];
        let (inputs, outputs) = (first.inputs.nrows(), first.outputs.nrows());
        let all: usize = spectra.iter().map(|s| s.omega.len()).sum();
        let beside_transients = TERMS * inputs + outputs + SPARE_LINES;
        let mut window = Self::of_width(spectra, omega, HALF_WIDTH.0.max(HALF_WIDTH.1 * omega));
        loop {
            let needed = beside_transients + window.transients;
            if window.count >= needed {
                return Ok(window);
            }
            let short = window.half_width >= FAIR_HALF_WIDTH && window.count < beside_transients + TERMS;
            if short || window.count == all {
                return Err(LocalPolynomialError::TooFewLines { omega, lines: window.count, needed });
            }
            window = Self::of_width(spectra, omega, WIDER * window.half_width);
        }
    }

    fn of_width(spectra: &[Spectrum], omega: f64, half_width: f64) -> Self {
        let inside = |s: &Spectrum| {
            let from = s.omega.partition_point(|&w| w < omega - half_width);
            (from, s.omega.partition_point(|&w| w <= omega + half_width).max(from))
        };
        let lines: Vec<_> = spectra.iter().map(inside).collect();
        let count = lines.iter().map(|(from, to)| to - from).sum();
        let transients = lines.iter().map(|(from, to)| (to - from).min(TERMS)).sum();
        Self { omega, half_width, lines, count, transients }
    }
}

/// The estimate from the lines in `window`; see [`local_polynomial`].
fn estimate(spectra: &[Spectrum], window: &Window) -> EstimatePoint {
    let (inputs, outputs) = (spectra[0].inputs.nrows(), spectra[0].outputs.nrows());
    let unknowns = TERMS * inputs;
    let freedom = window.count - window.transients - unknowns;
    let (rows, power) = regression(spectra, window);
    let r = rows.qr().unpack_r();

    let residual = r.view((unknowns, unknowns), (outputs, outputs)).clone_owned();
    let noise = (residual.adjoint() * &residual).map(|c| c.re / freedom as f64);
    let square = |column: usize, from: usize| r.column(column).rows_range(from..).norm_squared();
    let left: Vec<f64> = (0..outputs).map(|o| square(unknowns + o, unknowns)).collect();
    let coherence = DVector::from_fn(outputs, |o, _| explained(left[o], square(unknowns + o, 0)));

    let r11 = r.view((0, 0), (unknowns, unknowns));
    // The ridge keeps the diagonal away from 0; the solutions are zero, not missing, if ever it did not.
    let solve = |right: DMatrix<Complex<f64>>| r11.solve_upper_triangular(&right);
    let theta = solve(r.view((0, unknowns), (unknowns, outputs)).clone_owned());
    let response = theta.map_or_else(|| DMatrix::zeros(outputs, inputs), |theta| theta.rows(0, inputs).transpose());
    let inverse = solve(DMatrix::identity(unknowns, unknowns));
    let spread = |i: usize| inverse.as_ref().map_or(0.0, |inverse| inverse.row(i).norm_squared());
    let variance = DMatrix::from_fn(outputs, inputs, |o, i| noise[(o, o)] * spread(i));

    let mut partial_coherence = DMatrix::zeros(outputs, inputs);
    for i in 0..inputs {
        let without = left_without(&r, i, inputs, outputs);
        (0..outputs).for_each(|o| partial_coherence[(o, i)] = explained(left[o], without[o]));
    }
    let singular = r.view((0, 0), (inputs, inputs)).clone_owned().singular_values();
    let condition = (singular.max() / singular.min().max(f64::MIN_POSITIVE.sqrt() * singular.max())).powi(2);
    EstimatePoint {
        omega: window.omega,
        response,
        variance,
        noise,
        power: power / window.count as f64,
        coherence,
        partial_coherence,
        condition,
        half_width: window.half_width,
        freedom,
    }
}

/// `1 - left / all`, between 0 and 1; 0 where there is nothing to explain.
fn explained(left: f64, all: f64) -> f64 {
    if all > 0.0 { (1.0 - left / all).clamp(0.0, 1.0) } else { 0.0 }
}

/// The rows `[A B]` of all records with the ridge below them, and the sum of `|Y|^2` of each output.
fn regression(spectra: &[Spectrum], window: &Window) -> (DMatrix<Complex<f64>>, DVector<f64>) {
    let (inputs, outputs) = (spectra[0].inputs.nrows(), spectra[0].outputs.nrows());
    let unknowns = TERMS * inputs;
    let mut rows = DMatrix::zeros(window.count + unknowns, unknowns + outputs);
    let mut power = DVector::zeros(outputs);
    let mut top = 0;
    for (spectrum, &(from, to)) in spectra.iter().zip(&window.lines) {
        let x: Vec<f64> = spectrum.omega[from..to].iter().map(|w| (w - window.omega) / window.half_width).collect();
        for (k, x) in x.iter().enumerate() {
            let (input, output) = (spectrum.inputs.column(from + k), spectrum.outputs.column(from + k));
            for (i, u) in input.iter().enumerate() {
                (rows[(top + k, i)], rows[(top + k, inputs + i)], rows[(top + k, 2 * inputs + i)]) =
                    (*u, u * *x, u * (x * x));
            }
            for (o, y) in output.iter().enumerate() {
                rows[(top + k, unknowns + o)] = *y;
                power[o] += y.norm_sqr();
            }
        }
        // An orthonormal basis of 1, x, x^2; a record with fewer than three lines has as many vectors as lines.
        let powers = DMatrix::from_fn(x.len(), TERMS.min(x.len()), |line, power| x[line].powi(power as i32));
        let transient = powers.qr().q().map(Complex::from);
        let mut of_record = rows.rows_mut(top, x.len());
        let explained = &transient * transient.ad_mul(&of_record);
        of_record -= explained;
        top += x.len();
    }
    for column in 0..unknowns {
        let length = rows.column(column).norm();
        rows[(top + column, column)] = Complex::from(if length > 0.0 { RIDGE * length } else { 1.0 });
    }
    (rows, power)
}

/// `|V|^2` of each output when input `i` is left out: the triangular factor `r` without its three columns, made triangular
/// again.
fn left_without(r: &DMatrix<Complex<f64>>, i: usize, inputs: usize, outputs: usize) -> Vec<f64> {
    let unknowns = TERMS * inputs;
    let kept: Vec<usize> = (0..unknowns + outputs).filter(|&c| c >= unknowns || c % inputs != i).collect();
    let smaller = r.select_columns(&kept).qr().unpack_r();
    let from = unknowns - TERMS;
    (0..outputs).map(|o| smaller.column(from + o).rows_range(from..).norm_squared()).collect()
}
