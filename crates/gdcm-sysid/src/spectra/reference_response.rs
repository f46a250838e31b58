//! Measures the response through a recorded reference that drove the loop from outside, so that
//! feedback does not bias it (M14.15).
//!
//! ```text
//! 1  [Y; U] = (Gamma0 + Gamma1 x + Gamma2 x^2) R + transient + N: local polynomials at every line
//!    of the longest record, h = max(0.45, 0.15 omega);  S = the block for R in (F'F)^-1
//! 2  G = Gamma_y Gamma_u^+ (relative tolerance 1e-3),   Cv = Re([I, -G] Cov N [I, -G]')
//! 3  U = Gamma_u R, Y = Gamma_y R, Gamma linear between points, on the lines with leverage
//!    R S R' < 0.5: the spectra for the cost (M14.4)
//! 4  bands: standard deviations of the fitted model from the lines as logged,
//!    divided by sqrt(coherence between input and R)
//! 5  valid where the coherence between an input and R, which takes the place of the partial
//!    coherence, is at least 0.6: elsewhere R does not excite this input
//! ```
//!
//! `U`, `Y` and `R` are the spectral lines of inputs, outputs and references, `Gamma_y` and
//! `Gamma_u` the output and input rows in `Gamma0`, `F` the regressors `[R, x R, x^2 R]` without
//! the transient, `N` the noise in `[Y; U]`. In instrumental-variable identification, such a
//! reference is called the instrument.
//!
//! The leverage excludes the ends of a chirp's band, where its smooth spectrum and the transient
//! look alike. A model's cost per degree of freedom over the spectra from step 3 is far below 1 and
//! meaningless.

use nalgebra::{Complex, DMatrix, DVector, DVectorView};

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::executor::Executor;

use super::interpolation::Neighbours;
use super::local_polynomial::{LocalFit, condition, local_fits};
use super::local_polynomial_error::LocalPolynomialError;
use super::response_estimate::{EstimatePoint, ResponseEstimate};
use super::spectrum::{LineRange, Spectrum};

/// First window half-width, relative to the centre frequency.
const HALF_WIDTH: f64 = 0.15;
/// Smallest singular value of `Gamma_u` that is inverted, relative to the largest.
const TOLERANCE: f64 = 1e-3;
/// Lines with at least this leverage are left out.
const LEVERAGE: f64 = 0.5;
/// Minimum coherence for widening a band: below it, the widening does not increase any further.
const LEAST_COHERENCE: f64 = 0.01;

/// How inputs and outputs respond to the reference at a frequency.
struct InstrumentPoint {
    /// `Gamma0`, (outputs, then inputs) x references.
    gamma: DMatrix<Complex<f64>>,
    /// `S`, references x references.
    spread: DMatrix<Complex<f64>>,
    estimate: EstimatePoint,
}

/// Spectral lines and frequency response as measured through the reference.
pub(crate) struct Instrument {
    /// `Gamma_u R` and `Gamma_y R`, on the lines with small leverage.
    pub(crate) spectra: Vec<Spectrum>,
    /// `G`, with the coherence between each input and the reference as partial coherence.
    pub(crate) measured: ResponseEstimate,
}

impl Instrument {
    /// Measures the response (steps 1 to 3) from lines whose inputs are the references and whose
    /// outputs are the model's outputs, then its inputs; `outputs` counts the former.
    ///
    /// # Errors
    /// As [`local_fits`].
    pub(crate) fn new(
        lines: &[Spectrum],
        used: LineRange,
        outputs: usize,
        executor: &dyn Executor,
    ) -> Result<Self, LocalPolynomialError> {
        let longest = lines
            .iter()
            .max_by(|a, b| a.duration_s.total_cmp(&b.duration_s))
            .ok_or(LocalPolynomialError::Nothing {
                missing: "spectral lines",
            })?;
        let omegas: Vec<f64> = longest
            .omega
            .iter()
            .copied()
            .filter(|omega| (used.lowest..=used.highest).contains(omega))
            .collect();
        // Step 1.
        let fits = local_fits(lines, &omegas, HALF_WIDTH, executor)?;
        // Step 2.
        let points: Vec<InstrumentPoint> = fits
            .iter()
            .map(|fit| InstrumentPoint::new(fit, outputs))
            .collect();
        // Step 3.
        let spectra = lines
            .iter()
            .map(|lines| {
                through_reference(&lines.between(used.lowest, used.highest), &points, outputs)
            })
            .filter(|lines| !lines.omega.is_empty())
            .collect();
        Ok(Self {
            spectra,
            measured: ResponseEstimate {
                points: points.into_iter().map(|point| point.estimate).collect(),
            },
        })
    }
}

impl InstrumentPoint {
    /// Divides the outputs' responses to the reference by the inputs' responses (step 2).
    fn new(fit: &LocalFit, outputs: usize) -> Self {
        let gamma = fit.response();
        let inputs = gamma.nrows() - outputs;
        let gamma_y = gamma.rows(0, outputs).into_owned();
        let gamma_u = gamma.rows(outputs, inputs).into_owned();
        let inverse = pseudo_inverse(&gamma_u);
        let response = &gamma_y * &inverse;
        // `left` is [I, -G] in Cv = Re([I, -G] Cov N [I, -G]').
        let mut left = DMatrix::zeros(outputs, outputs + inputs);
        left.columns_mut(0, outputs).fill_with_identity();
        left.columns_mut(outputs, inputs).copy_from(&(-&response));
        let noise = (&left * fit.covariance() * left.adjoint()).map(|value| value.re);
        let spread = fit.spread();
        let coherence = fit.coherence();
        // var G = Cv times the spread transformed from R to the inputs.
        let input_spread = inverse.adjoint() * &spread * &inverse;
        let estimate = EstimatePoint {
            omega: fit.window.omega,
            variance: DMatrix::from_fn(outputs, inputs, |o, i| {
                noise[(o, o)] * input_spread[(i, i)].re.max(0.0)
            }),
            noise,
            power: fit.power().rows(0, outputs).into_owned(),
            coherence: DVector::from_column_slice(&coherence[..outputs]),
            partial_coherence: DMatrix::from_fn(outputs, inputs, |_, i| coherence[outputs + i]),
            condition: condition(gamma_u),
            half_width: fit.window.half_width,
            freedom: fit.freedom,
            response,
        };
        Self {
            gamma,
            spread,
            estimate,
        }
    }

    /// Returns a line's leverage `R S R'`.
    fn leverage(&self, reference: DVectorView<'_, Complex<f64>>) -> f64 {
        (reference.transpose() * &self.spread * reference.map(|r| r.conj()))[0].re
    }
}

impl ResponseEstimate {
    /// Widens bands from the lines as logged where the reference excites little: the standard
    /// deviations are divided by the square root of the coherence between each input and the
    /// reference (step 4). `None` if the bands are not valid.
    pub(crate) fn widened(&self, bands: &ModelBands) -> Option<ModelBands> {
        let omegas: Vec<f64> = self.points.iter().map(|point| point.omega).collect();
        let neighbours: Vec<Neighbours> = bands
            .omega()
            .iter()
            .map(|omega| Neighbours::find(&omegas, *omega))
            .collect();
        ModelBands::new(
            bands.omega().to_vec(),
            self.divided_by_coherence(bands.sd_db(), &neighbours),
            self.divided_by_coherence(bands.sd_deg(), &neighbours),
        )
        .ok()
    }

    /// Divides standard deviations by the square root of the coherence, interpolated at
    /// `neighbours`.
    fn divided_by_coherence(
        &self,
        table: &PairTable<Vec<f64>>,
        neighbours: &[Neighbours],
    ) -> PairTable<Vec<f64>> {
        PairTable::from_fn(table.outputs(), table.inputs(), |pair: Pair| {
            let mut widened = Vec::with_capacity(neighbours.len());
            for (sd, near) in table[pair].iter().zip(neighbours) {
                let at = (pair.output, pair.input);
                let coherence = (1.0 - near.share) * self.points[near.before].partial_coherence[at]
                    + near.share * self.points[near.after].partial_coherence[at];
                widened.push(sd / coherence.clamp(LEAST_COHERENCE, 1.0).sqrt());
            }
            widened
        })
    }
}

/// Returns the lines as measured through the reference, without those with high leverage, which
/// determine their own estimate (step 3).
fn through_reference(lines: &Spectrum, points: &[InstrumentPoint], outputs: usize) -> Spectrum {
    let omegas: Vec<f64> = points.iter().map(|point| point.estimate.omega).collect();
    let mut omega = Vec::new();
    let mut explained = Vec::new();
    for (k, &at) in lines.omega.iter().enumerate() {
        let Neighbours {
            before,
            after,
            share,
        } = Neighbours::find(&omegas, at);
        let before = &points[before];
        let after = &points[after];
        let reference = lines.inputs.column(k);
        let leverage =
            (1.0 - share) * before.leverage(reference) + share * after.leverage(reference);
        if leverage >= LEVERAGE {
            continue;
        }
        let gamma =
            &before.gamma * Complex::from(1.0 - share) + &after.gamma * Complex::from(share);
        omega.push(at);
        explained.push(gamma * reference);
    }
    let inputs = points
        .first()
        .map_or(0, |point| point.gamma.nrows() - outputs);
    Spectrum {
        inputs: DMatrix::from_fn(inputs, explained.len(), |i, k| explained[k][outputs + i]),
        outputs: DMatrix::from_fn(outputs, explained.len(), |o, k| explained[k][o]),
        omega,
        ..lines.clone()
    }
}

/// Computes the pseudo-inverse without singular values below [`TOLERANCE`] times the largest; zero
/// if the decomposition fails.
fn pseudo_inverse(matrix: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let zero = DMatrix::zeros(matrix.ncols(), matrix.nrows());
    let Some(svd) = matrix.clone().try_svd(true, true, f64::EPSILON, 10_000) else {
        return zero;
    };
    let least = TOLERANCE * svd.singular_values.max();
    svd.pseudo_inverse(least.max(f64::MIN_POSITIVE))
        .unwrap_or(zero)
}
