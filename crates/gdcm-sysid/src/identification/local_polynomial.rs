//! The local polynomial method: the frequency response straight from the lines, without a model.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::executor::{Executor, each};
use gdcm_model::response::median;

use super::prepared_data::Scales;
use super::spectrum::Spectrum;

/// Terms of a local polynomial: 1, x, x^2.
pub(super) const TERMS: usize = 3;
/// Terms where all lines together are too few for these: 1, x.
const FEWER_TERMS: usize = 2;
/// The least half width of a window of lines \[rad/s\], and over its centre (M14, 2).
const HALF_WIDTH: (f64, f64) = (0.45, 0.2);
/// A window with too few lines is widened by the first factor, then by the second until they are enough (M14.12).
const WIDER: (f64, f64) = (1.2, 1.05);
/// Spectral lines beyond the unknowns and the outputs that a window has at least, with three terms and with two (M14.12).
const SPARE_LINES: (usize, usize) = (6, 4);
/// Height of the ridge over the length of a column; it bounds the estimate where inputs are copies of each other.
const RIDGE: f64 = 1e-9;

/// Why there is no measured response.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LocalPolynomialError {
    /// There are no lines, inputs or outputs.
    #[error("there is nothing to estimate a frequency response from")]
    Nothing,
    /// Spectra of differing channels; the record, counted from 0.
    #[error("record {} has another number of channels than the first", .0 + 1)]
    ChannelsDiffer(usize),
    /// A line or a frequency is not finite, or a frequency is not greater than 0.
    #[error("the spectra hold values that are not finite")]
    NotFinite,
    /// Fewer lines in all than a polynomial of the first degree takes.
    #[error(
        "the records have {lines} spectral lines in the band where {needed} are needed: log longer, or leave out channels"
    )]
    TooFewLines {
        /// Spectral lines over all records.
        lines: usize,
        /// Spectral lines it takes.
        needed: usize,
    },
}

/// The response at each of `omegas` \[rad/s\] from the lines of all segments together (M14, 2; after Pintelon, Schoukens,
/// Vandersteen & Barbe, Mech. Syst. Signal Process. 24, 2010, with the records' transients apart).
///
/// Around each frequency, with `x = (omega_k - omega) / h`, the lines of record `r` obey
///
/// ```text
/// Y = (G0 + G1 x + G2 x^2) U + (t0 + t1 x + t2 x^2)_r + V
///
///   h = max(0.45, 0.2 omega), times 1.2 once and then times 1.05 until there are 3 inputs + 3 records + outputs + 6 lines;
///   a record with fewer than four lines there does not count; where all lines are too few, the terms in x^2 are left out
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
    let fits = local_fits(spectra, omegas, HALF_WIDTH.1, executor)?;
    let mut points: Vec<EstimatePoint> = each(executor, &fits, LocalFit::estimate);
    points.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    Ok(ResponseEstimate { points })
}

/// The local polynomials around each of `omegas`, `share` the half width of a window over its centre; see [`local_polynomial`].
pub(super) fn local_fits(
    spectra: &[Spectrum],
    omegas: &[f64],
    share: f64,
    executor: &dyn Executor,
) -> Result<Vec<LocalFit>, LocalPolynomialError> {
    let first = spectra.first().ok_or(LocalPolynomialError::Nothing)?;
    let channels = |s: &Spectrum| (s.inputs.nrows(), s.outputs.nrows());
    if omegas.is_empty() || first.inputs.nrows() == 0 || first.outputs.nrows() == 0 {
        return Err(LocalPolynomialError::Nothing);
    }
    if let Some(other) = spectra.iter().find(|s| channels(s) != channels(first)) {
        return Err(LocalPolynomialError::ChannelsDiffer(other.record));
    }
    let finite = |lines: &DMatrix<Complex<f64>>| lines.norm_squared().is_finite();
    let finite = spectra
        .iter()
        .all(|s| finite(&s.inputs) && finite(&s.outputs));
    if !finite || !omegas.iter().all(|w| w.is_finite() && *w > 0.0) {
        return Err(LocalPolynomialError::NotFinite);
    }
    let fit = |&omega: &f64| {
        Ok(LocalFit::of(
            spectra,
            Window::around(spectra, omega, share)?,
        ))
    };
    each(executor, omegas, fit).into_iter().collect()
}

/// The lines around a frequency.
pub(super) struct Window {
    /// Its centre \[rad/s\].
    pub(super) omega: f64,
    /// \[rad/s\].
    pub(super) half_width: f64,
    /// Terms of the polynomials.
    terms: usize,
    /// Of each spectrum the first line inside and the first one beyond; as one where the spectrum has too few.
    lines: Vec<(usize, usize)>,
    /// Spectral lines inside, over all spectra that count.
    count: usize,
    /// Columns that the records' transients take.
    transients: usize,
}

impl Window {
    /// The window around `omega`, as wide as it must be: the response is never refused for its width (M14.12).
    fn around(spectra: &[Spectrum], omega: f64, share: f64) -> Result<Self, LocalPolynomialError> {
        let with = |terms| Self::with_terms(spectra, omega, share, terms);
        with(TERMS).or_else(|_| with(FEWER_TERMS))
    }

    fn with_terms(
        spectra: &[Spectrum],
        omega: f64,
        share: f64,
        terms: usize,
    ) -> Result<Self, LocalPolynomialError> {
        let first = &spectra[0];
        let inputs = first.inputs.nrows();
        let outputs = first.outputs.nrows();
        let spare = if terms == TERMS {
            SPARE_LINES.0
        } else {
            SPARE_LINES.1
        };
        let all: Vec<f64> = spectra
            .iter()
            .flat_map(|s| s.omega.first().into_iter().chain(s.omega.last()).copied())
            .collect();
        let farthest = all
            .iter()
            .map(|line| (line - omega).abs())
            .fold(0.0, f64::max);
        let mut half_width = HALF_WIDTH.0.max(share * omega);
        let mut wider = WIDER.0;
        loop {
            let window = Self::of_width(spectra, omega, half_width, terms);
            let needed = terms * inputs + window.transients + outputs + spare;
            // A window without a record that counts needs one.
            if window.transients > 0 && window.count >= needed {
                return Ok(window);
            }
            if half_width >= farthest {
                return Err(LocalPolynomialError::TooFewLines {
                    lines: window.count,
                    needed,
                });
            }
            half_width *= wider;
            wider = WIDER.1;
        }
    }

    fn of_width(spectra: &[Spectrum], omega: f64, half_width: f64, terms: usize) -> Self {
        let inside = |s: &Spectrum| {
            let from = s.omega.partition_point(|&w| w < omega - half_width);
            let to = s
                .omega
                .partition_point(|&w| w <= omega + half_width)
                .max(from);
            if to - from > terms {
                (from, to)
            } else {
                (from, from)
            }
        };
        let lines: Vec<_> = spectra.iter().map(inside).collect();
        let count = lines.iter().map(|(from, to)| to - from).sum();
        let transients = terms * lines.iter().filter(|(from, to)| to > from).count();
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

/// Local polynomials fitted to the lines of one window.
pub(super) struct LocalFit {
    /// The window.
    pub(super) window: Window,
    /// The triangular factor of `[A B]`.
    r: DMatrix<Complex<f64>>,
    inputs: usize,
    outputs: usize,
    /// Sum of the power of the lines of each output.
    power: DVector<f64>,
    /// Lines less unknowns.
    pub(super) freedom: usize,
}

impl LocalFit {
    fn of(spectra: &[Spectrum], window: Window) -> Self {
        let inputs = spectra[0].inputs.nrows();
        let outputs = spectra[0].outputs.nrows();
        let freedom = window.count - window.transients - window.terms * inputs;
        let (rows, power) = regression(spectra, &window);
        Self {
            r: rows.qr().unpack_r(),
            inputs,
            outputs,
            power,
            freedom,
            window,
        }
    }

    fn unknowns(&self) -> usize {
        self.window.terms * self.inputs
    }

    /// Mean power of the lines of each output.
    pub(super) fn power(&self) -> DVector<f64> {
        &self.power / self.window.count as f64
    }

    /// `Cov V` of a line, outputs x outputs.
    pub(super) fn covariance(&self) -> DMatrix<Complex<f64>> {
        let residual = self.r.view(
            (self.unknowns(), self.unknowns()),
            (self.outputs, self.outputs),
        );
        (residual.adjoint() * residual).map(|value| value.conj() / self.freedom as f64)
    }

    /// `R11^-1` times something; zero, not missing, where it has none: the ridge keeps the diagonal away from 0.
    fn solve(&self, right: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
        let r11 = self.r.view((0, 0), (self.unknowns(), self.unknowns()));
        r11.solve_upper_triangular(right)
            .unwrap_or_else(|| right.map(|_| Complex::default()))
    }

    /// `G0`, outputs x inputs.
    pub(super) fn response(&self) -> DMatrix<Complex<f64>> {
        let unknowns = self.unknowns();
        let theta = self.solve(
            &self
                .r
                .view((0, unknowns), (unknowns, self.outputs))
                .clone_owned(),
        );
        theta.rows(0, self.inputs).transpose()
    }

    /// The block of `(A'A)^-1` that belongs to `G0`, inputs x inputs.
    pub(super) fn spread(&self) -> DMatrix<Complex<f64>> {
        let unknowns = self.unknowns();
        let inverse = self.solve(&DMatrix::identity(unknowns, unknowns));
        inverse.rows(0, self.inputs) * inverse.rows(0, self.inputs).adjoint()
    }

    /// `|B|^2` of each output from row `from` of the factor on.
    fn squares(&self, from: usize) -> Vec<f64> {
        let column = |o: usize| {
            self.r
                .column(self.unknowns() + o)
                .rows_range(from..)
                .norm_squared()
        };
        (0..self.outputs).map(column).collect()
    }

    /// Multiple coherence of each output.
    pub(super) fn coherence(&self) -> Vec<f64> {
        let left = self.squares(self.unknowns());
        let all = self.squares(0);
        left.into_iter()
            .zip(all)
            .map(|(left, all)| explained(left, all))
            .collect()
    }

    /// `|V|^2` of each output when input `i` is left out: the triangular factor without its columns, made triangular again.
    fn left_without(&self, i: usize) -> Vec<f64> {
        let unknowns = self.unknowns();
        let from = self.unknowns() - self.window.terms;
        let is_kept = |column: &usize| *column >= unknowns || column % self.inputs != i;
        let kept: Vec<usize> = (0..unknowns + self.outputs).filter(is_kept).collect();
        let smaller = self.r.select_columns(&kept).qr().unpack_r();
        (0..self.outputs)
            .map(|o| smaller.column(from + o).rows_range(from..).norm_squared())
            .collect()
    }

    /// The estimate; see [`local_polynomial`].
    fn estimate(&self) -> EstimatePoint {
        let inputs = self.inputs;
        let outputs = self.outputs;
        let noise = self.covariance().map(|value| value.re);
        let spread = self.spread();
        let left = self.squares(self.unknowns());
        let mut partial_coherence = DMatrix::zeros(outputs, inputs);
        for i in 0..inputs {
            let without = self.left_without(i);
            (0..outputs).for_each(|o| partial_coherence[(o, i)] = explained(left[o], without[o]));
        }
        EstimatePoint {
            omega: self.window.omega,
            response: self.response(),
            variance: DMatrix::from_fn(outputs, inputs, |o, i| noise[(o, o)] * spread[(i, i)].re),
            noise,
            power: self.power(),
            coherence: DVector::from_vec(self.coherence()),
            partial_coherence,
            condition: condition(self.r.view((0, 0), (inputs, inputs)).clone_owned()),
            half_width: self.window.half_width,
            freedom: self.freedom,
        }
    }
}

/// `1 - left / all`, between 0 and 1; 0 where there is nothing to explain.
fn explained(left: f64, all: f64) -> f64 {
    if all > 0.0 {
        (1.0 - left / all).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// The rows `[A B]` of all records with the ridge below them, and the sum of `|Y|^2` of each output.
fn regression(spectra: &[Spectrum], window: &Window) -> (DMatrix<Complex<f64>>, DVector<f64>) {
    let inputs = spectra[0].inputs.nrows();
    let outputs = spectra[0].outputs.nrows();
    let terms = window.terms;
    let unknowns = window.terms * inputs;
    let mut rows = DMatrix::zeros(window.count + unknowns, unknowns + outputs);
    let mut power = DVector::zeros(outputs);
    let mut top = 0;
    for (spectrum, &(from, to)) in spectra.iter().zip(&window.lines) {
        let x: Vec<f64> = spectrum.omega[from..to]
            .iter()
            .map(|w| (w - window.omega) / window.half_width)
            .collect();
        for (k, x) in x.iter().enumerate() {
            let input = spectrum.inputs.column(from + k);
            let output = spectrum.outputs.column(from + k);
            for (i, u) in input.iter().enumerate() {
                let mut term = *u;
                for power in 0..terms {
                    rows[(top + k, power * inputs + i)] = term;
                    term *= *x;
                }
            }
            for (o, y) in output.iter().enumerate() {
                rows[(top + k, unknowns + o)] = *y;
                power[o] += y.norm_sqr();
            }
        }
        if x.is_empty() {
            continue;
        }
        let powers = DMatrix::from_fn(x.len(), terms, |line, power| x[line].powi(power as i32));
        let transient = powers.qr().q().map(Complex::from);
        let mut of_record = rows.rows_mut(top, x.len());
        let explained = &transient * transient.ad_mul(&of_record);
        of_record -= explained;
        top += x.len();
    }
    for column in 0..unknowns {
        let length = rows.column(column).norm();
        rows[(top + column, column)] =
            Complex::from(if length > 0.0 { RIDGE * length } else { 1.0 });
    }
    (rows, power)
}

/// Square of the greatest singular value over the least.
pub(super) fn condition(matrix: DMatrix<Complex<f64>>) -> f64 {
    let singular = matrix.singular_values();
    (singular.max()
        / singular
            .min()
            .max(f64::MIN_POSITIVE.sqrt() * singular.max()))
    .powi(2)
}

/// The places before and after `x` among numbers that ascend, and how far it lies from the one to the other; beyond the ends the end.
pub(super) fn between(ascending: &[f64], x: f64) -> (usize, usize, f64) {
    let after = ascending
        .partition_point(|at| *at <= x)
        .min(ascending.len() - 1);
    let before = after.saturating_sub(1);
    let from = ascending[before];
    let to = ascending[after];
    (
        before,
        after,
        if to > from {
            ((x - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            0.0
        },
    )
}

// The measured frequency response, with what speaks for it.

/// Below this median partial coherence an input was not moved, or only together with another (M14, 2).
const LEAST_PARTIAL_COHERENCE: f64 = 0.3;
/// Above this condition number of the inputs' spectral matrix the inputs were moved together (M14, 2).
const GREATEST_CONDITION: f64 = 1e3;

/// Partial coherence from which a point is trusted (M14, 2).
pub const TRUSTED_COHERENCE: f64 = 0.6;
/// A band of which this share, in logarithm, shows nothing at an end, is too wide there (M14, 10).
const END: f64 = 0.2;

/// The measured response at one frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatePoint {
    /// \[rad/s\].
    pub omega: f64,
    /// `G0`, outputs x inputs.
    pub response: DMatrix<Complex<f64>>,
    /// `E |error of G0|^2` of each entry, outputs x inputs. Half of it is of the real part, half of the imaginary part, so that
    /// the standard deviation is `sqrt(variance / 2) / |G0|` of the log modulus, and of the phase \[rad\].
    pub variance: DMatrix<f64>,
    /// `Cv`, covariance of the noise of a line, real part, outputs x outputs.
    pub noise: DMatrix<f64>,
    /// Mean power of the lines of each output around this frequency.
    pub power: DVector<f64>,
    /// Multiple coherence of each output: the share of its power that all inputs explain, 0 to 1.
    pub coherence: DVector<f64>,
    /// Partial coherence, outputs x inputs: the share, 0 to 1, that this input explains of what the others leave.
    pub partial_coherence: DMatrix<f64>,
    /// Condition number of the inputs' spectral matrix `S_uu`, in scaled units.
    pub condition: f64,
    /// `h`, half width of the window of lines \[rad/s\].
    pub half_width: f64,
    /// Spectral lines used, less the unknowns: the degrees of freedom of `noise`.
    pub freedom: usize,
}

/// The measured response `G[output, input]` over frequency, by the local polynomial method (M14, 2).
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseEstimate {
    /// By ascending frequency, at least one.
    pub points: Vec<EstimatePoint>,
}

/// How far the inputs were moved, each by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// Of each input the median over frequency of its partial coherence with the output that it moves most, 0 to 1.
    pub partial_coherence: Vec<f64>,
    /// Median over frequency of the condition number of the inputs' spectral matrix.
    pub condition: f64,
}

impl Excitation {
    /// Inputs, counted from 0, whose column is not identified: median partial coherence below 0.3.
    pub fn not_identified(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.partial_coherence.len())
            .filter(|&i| self.partial_coherence[i] < LEAST_PARTIAL_COHERENCE)
    }

    /// Whether some inputs were moved only together: median condition number over 1000.
    #[must_use]
    pub fn moved_together(&self) -> bool {
        self.condition > GREATEST_CONDITION
    }
}

impl EstimatePoint {
    /// Standard deviation of `ln G0` of an entry: of its real part, the log modulus \[Np\], and of its imaginary part, the phase
    /// \[rad\].
    pub fn sd(&self, pair: (usize, usize)) -> f64 {
        (0.5 * self.variance[pair]).sqrt() / self.response[pair].norm()
    }

    /// The partial coherence of an input with the output that it moves most, free of the share that as many columns of mere noise
    /// would explain, `1 - (1 - c) (freedom + 3) / freedom`: the greatest of many outputs is never small by chance.
    fn greatest_coherence(&self, input: usize) -> f64 {
        let columns = super::local_polynomial::TERMS as f64;
        let freedom = self.freedom.max(1) as f64;
        let greatest = self
            .partial_coherence
            .column(input)
            .iter()
            .fold(0.0, |a: f64, b| a.max(*b));
        (1.0 - (1.0 - greatest) * (freedom + columns) / freedom).max(0.0)
    }
}

impl ResponseEstimate {
    /// The part of a band \[rad/s\] that the records show, where its upper or its lower fifth (in logarithm) shows nothing: no input
    /// is coherent with any output there. It ends at the last frequencies where one is.
    #[must_use]
    pub fn shown_band(&self, band: [f64; 2]) -> Option<[f64; 2]> {
        let inside = self
            .points
            .iter()
            .filter(|point| (band[0]..=band[1]).contains(&point.omega));
        let is_shown = |point: &&EstimatePoint| {
            (0..point.response.ncols())
                .any(|input| point.greatest_coherence(input) >= TRUSTED_COHERENCE)
        };
        let mut shown = inside.filter(is_shown).map(|point| point.omega);
        let first = shown.next()?;
        let last = shown.next_back()?;
        let fifth = (band[1] / band[0]).powf(END);
        let part = [
            if first > band[0] * fifth {
                first
            } else {
                band[0]
            },
            if last < band[1] / fifth {
                last
            } else {
                band[1]
            },
        ];
        (part != band && part[1] > part[0] * fifth).then_some(part)
    }

    /// The estimate as a measured response, weighed by its partial coherence: what each input explains of what the others leave.
    /// None where it has fewer than two points.
    pub fn measured(&self) -> Option<MeasuredResponse> {
        let (outputs, inputs) = self.points.first()?.response.shape();
        let table = |value: &dyn Fn(&EstimatePoint, (usize, usize)) -> f64| {
            let curve = |pair: Pair| {
                self.points
                    .iter()
                    .map(|point| value(point, (pair.output, pair.input)))
                    .collect()
            };
            PairTable::<Vec<f64>>::from_fn(outputs, inputs, curve)
        };
        let re = table(&|point, at| point.response[at].re);
        let im = table(&|point, at| point.response[at].im);
        let coherence = table(&|point, at| point.partial_coherence[at].clamp(0.0, 1.0));
        MeasuredResponse::new(
            self.points.iter().map(|point| point.omega).collect(),
            &re,
            &im,
            Some(coherence),
        )
        .ok()
    }

    /// How far the inputs were moved, each by itself.
    ///
    /// A coupled response may be weak though its input was moved well: for each input and frequency the output with the
    /// greatest partial coherence counts.
    #[must_use]
    pub fn excitation(&self) -> Excitation {
        let inputs = self
            .points
            .first()
            .map_or(0, |point| point.response.ncols());
        let over = |of: &dyn Fn(&EstimatePoint) -> f64| {
            median(&mut self.points.iter().map(of).collect::<Vec<f64>>())
        };
        Excitation {
            partial_coherence: (0..inputs)
                .map(|input| over(&|point| point.greatest_coherence(input)))
                .collect(),
            condition: over(&|point| point.condition),
        }
    }

    /// The same in the units of the file, where this is in the scaled units of `scales`.
    #[must_use]
    pub fn in_units(&self, scales: &Scales) -> Self {
        let of_response = scales.of_response();
        let outputs = DVector::from_column_slice(&scales.outputs);
        let point = |point: &EstimatePoint| EstimatePoint {
            response: point.response.zip_map(&of_response, |g, scale| g * scale),
            variance: point
                .variance
                .zip_map(&of_response, |v, scale| v * scale * scale),
            noise: point.noise.component_mul(&(&outputs * outputs.transpose())),
            power: point.power.component_mul(&outputs).component_mul(&outputs),
            ..point.clone()
        };
        Self {
            points: self.points.iter().map(point).collect(),
        }
    }
}

// The covariance of the noise over frequency, and the weight that comes of it.

/// Weights of a point and its neighbours in the smoothed covariance (M14, 2).
const SMOOTHING: [f64; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
/// Share of the diagonal added to it, so that outputs that depend on each other do not make the covariance singular (M14, 2).
const ADDED: f64 = 1e-4;
/// The least variance of the noise over the power of the output: exact data have noise of rounding alone.
const FLOOR: f64 = 1e-16;

/// `Cv(omega)`, covariance of the noise of a line, outputs x outputs: the covariances of a measured response smoothed over
/// five neighbours, linear in log frequency between them and constant beyond them (M14, 2).
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseCovariance {
    log_omega: Vec<f64>,
    covariances: Vec<DMatrix<f64>>,
}

impl NoiseCovariance {
    /// The covariance of the noise of `measured`; none where it has no points.
    #[must_use]
    pub fn of(measured: &ResponseEstimate) -> Option<Self> {
        let points = &measured.points;
        let smoothed = |k: usize| {
            let reach = SMOOTHING.len() / 2;
            let mut sum = points[k].noise.scale(0.0);
            let mut weights = 0.0;
            for (weight, neighbour) in SMOOTHING.iter().zip(k..) {
                if let Some(point) = neighbour
                    .checked_sub(reach)
                    .and_then(|neighbour| points.get(neighbour))
                {
                    sum += point.noise.scale(*weight);
                    weights += weight;
                }
            }
            let mut covariance = sum / weights;
            for o in 0..covariance.nrows() {
                covariance[(o, o)] +=
                    ADDED * covariance[(o, o)] + FLOOR * points[k].power[o] + f64::MIN_POSITIVE;
            }
            covariance
        };
        let log_omega = points.iter().map(|point| point.omega.ln()).collect();
        let covariances = (0..points.len()).map(smoothed).collect();
        (!points.is_empty()).then_some(Self {
            log_omega,
            covariances,
        })
    }

    /// `Cv` at `omega` \[rad/s\].
    #[must_use]
    pub fn at(&self, omega: f64) -> DMatrix<f64> {
        let (before, after, share) = between(&self.log_omega, omega.ln());
        self.covariances[before].scale(1.0 - share) + self.covariances[after].scale(share)
    }

    /// `W` at `omega`: the inverse of the lower Cholesky factor of `Cv / 2`, outputs x outputs, lower triangular.
    ///
    /// `W e` has real and imaginary parts of variance one each where `e` is noise (M14, 4). None where the covariance is not
    /// positive definite, which takes noise that is 1e8 times stronger in one combination of outputs than in another.
    #[must_use]
    pub fn weight(&self, omega: f64) -> Option<DMatrix<f64>> {
        let lower = self.at(omega).scale(0.5).cholesky()?.unpack();
        let inverse =
            lower.solve_lower_triangular(&DMatrix::identity(lower.nrows(), lower.nrows()))?;
        inverse.iter().all(|w| w.is_finite()).then_some(inverse)
    }
}
