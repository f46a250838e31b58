//! Measures the response through a recorded reference that drove the loop from outside, so that
//! feedback does not bias it (M14.15): the reference serves as instrumental variable.
//!
//! ```text
//! U, Y, R  spectral lines of inputs, outputs and references;   N noise in [Y; U]
//! 1  around each line of the longest record, a local polynomial in x, the distance from this line
//!    over the window half-width h = max(0.45 rad/s, 0.15 omega) (`local_polynomial`):
//!    [Y; U] = (Gamma0 + Gamma1 x + Gamma2 x^2) R + transient + N,   Gamma0 = [Gamma_y; Gamma_u]
//!    F = [R, x R, x^2 R] less the transient;   S = the block for Gamma0 in (F'F)^-1
//! 2  G = Gamma_y Gamma_u^+,   Cv = Re([I, -G] Cov N [I, -G]'), the noise in Y - G U
//! 3  lines for the cost (M14.4): U = Gamma_u R, Y = Gamma_y R, Gamma0 linear between points,
//!    without those with the leverage R S R' >= 0.5 (R as a row)
//! 4  standard deviations of a fitted model: from the lines as logged, divided by
//!    sqrt(coherence between input and R)
//! 5  the coherence between input and R takes the place of the partial coherence: points below 0.6,
//!    where R does not excite the input, are not trusted (`response_estimate`)
//! ```

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
const HALF_WIDTH_SHARE: f64 = 0.15;
/// Smallest singular value of `Gamma_u` that is inverted, relative to the largest.
const LEAST_SINGULAR_VALUE: f64 = 1e-3;
/// Lines with at least this leverage are left out: they determine half of their own estimate or
/// more. At the ends of a chirp, its smooth spectrum and the transient look alike.
const EXCESSIVE_LEVERAGE: f64 = 0.5;
/// Below this coherence, a standard deviation does not increase any further: at most tenfold.
const LEAST_COHERENCE: f64 = 0.01;

/// How inputs and outputs respond to the reference at a frequency.
struct ReferencePoint {
    /// `Gamma0`, (outputs, then inputs) x references.
    gamma: DMatrix<Complex<f64>>,
    /// `S`, references x references.
    unscaled_covariance: DMatrix<Complex<f64>>,
    estimate: EstimatePoint,
}

/// Spectral lines and frequency response as measured through the reference.
pub(crate) struct ReferenceResponse {
    /// `Gamma_u R` and `Gamma_y R`, on the lines with small leverage. They lack the noise `N`, so that
    /// a model's cost per degree of freedom is far below 1 and meaningless.
    pub(crate) spectra: Vec<Spectrum>,
    /// `G`, with the coherence between each input and the reference as partial coherence.
    pub(crate) measured: ResponseEstimate,
}

impl ReferenceResponse {
    /// Measures the response (steps 1 to 3) from `lines`, whose inputs are the references and whose
    /// outputs are the model's outputs, then its inputs; `outputs` counts the model's outputs.
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
        let fits = local_fits(lines, &omegas, HALF_WIDTH_SHARE, executor)?;
        // Step 2.
        let points: Vec<ReferencePoint> = fits
            .iter()
            .map(|fit| ReferencePoint::new(fit, outputs))
            .collect();
        // Step 3.
        let mut spectra = Vec::with_capacity(lines.len());
        for spectrum in lines {
            let used_lines = spectrum.between(used.lowest, used.highest);
            let explained = explained_by_reference(&used_lines, &points, outputs);
            if !explained.omega.is_empty() {
                spectra.push(explained);
            }
        }
        Ok(Self {
            spectra,
            measured: ResponseEstimate {
                points: points.into_iter().map(|point| point.estimate).collect(),
            },
        })
    }
}

impl ReferencePoint {
    /// Divides the outputs' responses to the reference by the inputs' responses (step 2).
    fn new(fit: &LocalFit, outputs: usize) -> Self {
        let gamma = fit.response();
        let inputs = gamma.nrows() - outputs;
        let gamma_y = gamma.rows(0, outputs).into_owned();
        let gamma_u = gamma.rows(outputs, inputs).into_owned();
        let inverse = pseudo_inverse(&gamma_u);
        let response = &gamma_y * &inverse;
        // [I, -G], which maps [Y; U] to the residual Y - G U.
        let mut residual_map = DMatrix::zeros(outputs, outputs + inputs);
        residual_map.columns_mut(0, outputs).fill_with_identity();
        residual_map
            .columns_mut(outputs, inputs)
            .copy_from(&(-&response));
        let noise =
            (&residual_map * fit.covariance() * residual_map.adjoint()).map(|value| value.re);
        let coherence = fit.coherence();
        let unscaled_covariance = fit.spread();
        // var G = Cv times S, transformed from the references to the inputs.
        let covariance_of_inputs = inverse.adjoint() * &unscaled_covariance * &inverse;
        let estimate = EstimatePoint {
            omega: fit.window.omega,
            variance: DMatrix::from_fn(outputs, inputs, |o, i| {
                noise[(o, o)] * covariance_of_inputs[(i, i)].re.max(0.0)
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
            unscaled_covariance,
            estimate,
        }
    }

    /// Returns a line's leverage `R S R'`.
    fn leverage(&self, reference: DVectorView<'_, Complex<f64>>) -> f64 {
        (reference.transpose() * &self.unscaled_covariance * reference.map(|r| r.conj()))[0].re
    }
}

impl ResponseEstimate {
    /// Divides a model's standard deviations, found from the lines as logged, by the square root of
    /// the coherence between each input and the reference (step 4). `None` if the results are not
    /// valid standard deviations.
    pub(crate) fn widened(&self, deviations: &ModelBands) -> Option<ModelBands> {
        let omegas: Vec<f64> = self.points.iter().map(|point| point.omega).collect();
        let neighbours: Vec<Neighbours> = deviations
            .omega()
            .iter()
            .map(|omega| Neighbours::find(&omegas, *omega))
            .collect();
        ModelBands::new(
            deviations.omega().to_vec(),
            self.divided_by_coherence(deviations.sd_db(), &neighbours),
            self.divided_by_coherence(deviations.sd_deg(), &neighbours),
        )
        .ok()
    }

    /// Divides standard deviations over frequency by the square root of the coherence; `neighbours`
    /// are the points next to each frequency, between which the coherence is interpolated.
    fn divided_by_coherence(
        &self,
        deviations: &PairTable<Vec<f64>>,
        neighbours: &[Neighbours],
    ) -> PairTable<Vec<f64>> {
        PairTable::from_fn(deviations.outputs(), deviations.inputs(), |pair: Pair| {
            let mut widened = Vec::with_capacity(neighbours.len());
            for (sd, near) in deviations[pair].iter().zip(neighbours) {
                let at = (pair.output, pair.input);
                let coherence = (1.0 - near.share) * self.points[near.before].partial_coherence[at]
                    + near.share * self.points[near.after].partial_coherence[at];
                widened.push(sd / coherence.clamp(LEAST_COHERENCE, 1.0).sqrt());
            }
            widened
        })
    }
}

/// Returns the parts of the lines that the reference explains, without lines with excessive
/// leverage (step 3).
fn explained_by_reference(lines: &Spectrum, points: &[ReferencePoint], outputs: usize) -> Spectrum {
    let omegas: Vec<f64> = points.iter().map(|point| point.estimate.omega).collect();
    let mut omega = Vec::new();
    let mut explained = Vec::new();
    for (k, &omega_k) in lines.omega.iter().enumerate() {
        let neighbours = Neighbours::find(&omegas, omega_k);
        let before = &points[neighbours.before];
        let after = &points[neighbours.after];
        let share = neighbours.share;
        let reference = lines.inputs.column(k);
        let leverage =
            (1.0 - share) * before.leverage(reference) + share * after.leverage(reference);
        if leverage >= EXCESSIVE_LEVERAGE {
            continue;
        }
        let gamma =
            &before.gamma * Complex::from(1.0 - share) + &after.gamma * Complex::from(share);
        omega.push(omega_k);
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

/// Computes the pseudo-inverse without singular values below [`LEAST_SINGULAR_VALUE`] times the
/// largest; zero if the decomposition fails.
fn pseudo_inverse(matrix: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let zero = DMatrix::zeros(matrix.ncols(), matrix.nrows());
    let Some(svd) = matrix.clone().try_svd(true, true, f64::EPSILON, 10_000) else {
        return zero;
    };
    let least = LEAST_SINGULAR_VALUE * svd.singular_values.max();
    svd.pseudo_inverse(least.max(f64::MIN_POSITIVE))
        .unwrap_or(zero)
}
