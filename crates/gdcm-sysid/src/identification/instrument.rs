//! The response by way of a recorded reference that drove the loop from outside: feedback cannot bias it (M14.15).
//!
//! ```text
//! 1  [Y; U] = (Gamma0 + Gamma1 x + Gamma2 x^2) R + transient + N: local polynomials at every line of the longest record,
//!    h = max(0.45, 0.15 omega);  S = the block of (F'F)^-1 of R
//! 2  G = Gamma_y Gamma_u^+ (relative tolerance 1e-3),   Cv = Re([I, -G] Cov N [I, -G]')
//! 3  the cost of M14.4 with U = Gamma_u R, Y = Gamma_y R, Gamma straight between points, on the lines of leverage R S R' < 0.5
//! 4  bands: the standard deviations that the lines as logged give of this model, over sqrt(coherence of the input with R)
//! 5  only where the coherence of an input with R is 0.6: elsewhere the reference did not excite
//! ```
//!
//! The ends of a chirp's band, where its smooth spectrum and the transient look alike, are what the leverage leaves out. The cost per degree of freedom is
//! far below 1 and says nothing.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::PairTable;
use gdcm_model::dataset::model::ModelBands;
use gdcm_model::executor::Executor;

use super::local_polynomial::{
    EstimatePoint, LocalFit, LocalPolynomialError, ResponseEstimate, between, condition, local_fits,
};
use super::spectrum::Spectrum;

/// Half width of a window over its centre.
const HALF_WIDTH: f64 = 0.15;
/// Singular values of `Gamma_u` over the greatest that count.
const TOLERANCE: f64 = 1e-3;
/// Leverage of a line from which it is left out.
const LEVERAGE: f64 = 0.5;

/// Below this coherence a band is not widened any more: nothing is known there as it is.
const LEAST_COHERENCE: f64 = 0.01;

/// What the reference shows of inputs and outputs at one frequency.
struct InstrumentPoint {
    /// `Gamma0`, outputs then inputs x references.
    gamma: DMatrix<Complex<f64>>,
    /// `S`, references x references.
    spread: DMatrix<Complex<f64>>,
    estimate: EstimatePoint,
}

/// The records as the reference shows them.
pub(super) struct Instrument {
    /// `Gamma_u R` and `Gamma_y R`, on the lines that count.
    pub(super) spectra: Vec<Spectrum>,
    /// `G`, with the coherence of each input with the reference in the place of the partial coherence.
    pub(super) measured: ResponseEstimate,
}

impl Instrument {
    /// From lines whose inputs are the references and whose outputs are the outputs, then the inputs of the model.
    pub(super) fn of(
        lines: &[Spectrum],
        narrow: [f64; 2],
        outputs: usize,
        executor: &dyn Executor,
    ) -> Result<Self, LocalPolynomialError> {
        let longest = lines
            .iter()
            .max_by(|a, b| a.duration_s.total_cmp(&b.duration_s))
            .ok_or(LocalPolynomialError::Nothing)?;
        let within: Vec<f64> = longest
            .omega
            .iter()
            .copied()
            .filter(|omega| (narrow[0]..=narrow[1]).contains(omega))
            .collect();
        let fits = local_fits(lines, &within, HALF_WIDTH, executor)?;
        let points: Vec<InstrumentPoint> = fits
            .iter()
            .map(|fit| InstrumentPoint::of(fit, outputs))
            .collect();
        let shown = |lines: &Spectrum| seen(&lines.between(narrow[0], narrow[1]), &points, outputs);
        let spectra = lines
            .iter()
            .map(shown)
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
    fn of(fit: &LocalFit, outputs: usize) -> Self {
        let gamma = fit.response();
        let inputs = gamma.nrows() - outputs;
        let of_outputs = gamma.rows(0, outputs).into_owned();
        let of_inputs = gamma.rows(outputs, inputs).into_owned();
        let response = &of_outputs * pseudo_inverse(&of_inputs);
        // [I, -G] Cov N [I, -G]'.
        let mut left = DMatrix::zeros(outputs, outputs + inputs);
        left.columns_mut(0, outputs).fill_with_identity();
        left.columns_mut(outputs, inputs).copy_from(&(-&response));
        let noise = (&left * fit.covariance() * left.adjoint()).map(|value| value.re);
        let spread = fit.spread();
        let coherence = fit.coherence();
        // Of G: Cv times the spread of R as the inputs have it.
        let inverse = pseudo_inverse(&of_inputs);
        let through = inverse.adjoint() * &spread * &inverse;
        let estimate = EstimatePoint {
            omega: fit.window.omega,
            variance: DMatrix::from_fn(outputs, inputs, |o, i| {
                noise[(o, o)] * through[(i, i)].re.max(0.0)
            }),
            noise,
            power: DVector::from_fn(outputs, |o, _| fit.power()[o]),
            coherence: DVector::from_fn(outputs, |o, _| coherence[o]),
            partial_coherence: DMatrix::from_fn(outputs, inputs, |_, i| coherence[outputs + i]),
            condition: condition(of_inputs),
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
}

impl ResponseEstimate {
    /// Bands of what was logged, over the root of the coherence of each input with the reference: what the reference does not show
    /// is known the less (M14.15).
    pub(super) fn widened(&self, bands: &ModelBands) -> Option<ModelBands> {
        let omegas: Vec<f64> = self.points.iter().map(|point| point.omega).collect();
        let widened = |table: &PairTable<Vec<f64>>| {
            PairTable::from_fn(table.outputs(), table.inputs(), |pair| {
                let coherence = |omega: f64| {
                    let (before, after, share) = between(&omegas, omega);
                    let at = |index: usize| {
                        self.points[index].partial_coherence[(pair.output, pair.input)]
                    };
                    (1.0 - share) * at(before) + share * at(after)
                };
                let sds = table[pair].iter().zip(bands.omega());
                sds.map(|(sd, omega)| sd / coherence(*omega).clamp(LEAST_COHERENCE, 1.0).sqrt())
                    .collect()
            })
        };
        ModelBands::new(
            bands.omega().to_vec(),
            widened(bands.sd_db()),
            widened(bands.sd_deg()),
        )
        .ok()
    }
}

/// The lines as the reference shows them, less those that it determines by themselves.
fn seen(lines: &Spectrum, points: &[InstrumentPoint], outputs: usize) -> Spectrum {
    let mut omega = Vec::new();
    let mut all = Vec::new();
    let omegas: Vec<f64> = points.iter().map(|point| point.estimate.omega).collect();
    for (k, &at) in lines.omega.iter().enumerate() {
        let (before, after, share) = between(&omegas, at);
        let one = &points[before];
        let other = &points[after];
        let reference = lines.inputs.column(k);
        let leverage = |point: &InstrumentPoint| {
            (reference.transpose() * &point.spread * reference.map(|r| r.conj()))[0].re
        };
        if (1.0 - share) * leverage(one) + share * leverage(other) >= LEVERAGE {
            continue;
        }
        let gamma = &one.gamma * Complex::from(1.0 - share) + &other.gamma * Complex::from(share);
        omega.push(at);
        all.push(gamma * reference);
    }
    let inputs = points
        .first()
        .map_or(0, |point| point.gamma.nrows() - outputs);
    let rows = |first: usize, count: usize| {
        DMatrix::from_fn(count, all.len(), |row, k| all[k][first + row])
    };
    Spectrum {
        inputs: rows(outputs, inputs),
        outputs: rows(0, outputs),
        omega,
        ..lines.clone()
    }
}

/// The pseudo-inverse, singular values below a share of the greatest left out; zero where it cannot be found.
fn pseudo_inverse(matrix: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let none = || DMatrix::zeros(matrix.ncols(), matrix.nrows());
    let Some(svd) = matrix.clone().try_svd(true, true, f64::EPSILON, 10_000) else {
        return none();
    };
    let least = TOLERANCE * svd.singular_values.max();
    svd.pseudo_inverse(least.max(f64::MIN_POSITIVE))
        .unwrap_or_else(|_| none())
}
