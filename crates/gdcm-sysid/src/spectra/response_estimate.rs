//! The frequency response measured without a model, and its reliability (M14.2).
//!
//! A *point* is an estimate at a frequency, from the spectral lines in a window around it, by a
//! local polynomial with the constant term `G0` (`local_polynomial`).

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::statistics::median;

use super::scales::Scales;

/// Number of terms in a local polynomial: 1, x, x^2.
pub(crate) const TERMS: usize = 3;
/// Median partial coherence from which an input counts as swept by itself (M14.2).
const LEAST_PARTIAL_COHERENCE: f64 = 0.3;
/// Condition number of the inputs' spectral matrix up to which they count as moved independently:
/// above it, some combination of inputs has less than 1/30 of the largest combination's amplitude.
const GREATEST_CONDITION: f64 = 1e3;
/// Minimum partial coherence at which a point is trusted (M14.2).
pub const TRUSTED_COHERENCE: f64 = 0.6;
/// The band is too wide at an end if at least this share of it shows no response there, in
/// logarithmic frequency (M14.10).
const EMPTY_END: f64 = 0.2;

/// The measured response at a frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatePoint {
    /// Frequency \[rad/s\].
    pub omega: f64,
    /// `G0`, outputs x inputs.
    pub response: DMatrix<Complex<f64>>,
    /// `E |error of G0|^2`, outputs x inputs. Real and imaginary part have one half each, so
    /// `sqrt(variance / 2) / |G0|` is the standard deviation of log modulus \[Np\] and phase
    /// \[rad\].
    pub variance: DMatrix<f64>,
    /// Real part of `Cv`, the noise covariance at a spectral line; outputs x outputs.
    pub noise: DMatrix<f64>,
    /// Each output's mean line power around this frequency.
    pub power: DVector<f64>,
    /// Each output's multiple coherence: the share of its power that all inputs explain, 0 to 1.
    pub coherence: DVector<f64>,
    /// Partial coherence, outputs x inputs: the share, 0 to 1, that an input explains of the output
    /// power which the other inputs leave unexplained.
    pub partial_coherence: DMatrix<f64>,
    /// Condition number of the inputs' spectral matrix `S_uu`, in scaled units.
    pub condition: f64,
    /// `h`, window half-width \[rad/s\].
    pub half_width: f64,
    /// Degrees of freedom in `noise`: spectral lines less unknowns.
    pub freedom: usize,
}

impl EstimatePoint {
    /// Returns the standard deviation of `ln G0`, which applies to the log modulus \[Np\] and to
    /// the phase \[rad\].
    pub fn sd(&self, pair: (usize, usize)) -> f64 {
        (0.5 * self.variance[pair]).sqrt() / self.response[pair].norm()
    }

    /// Returns an input's largest partial coherence `c` over the outputs, adjusted for the share
    /// that noise would explain with the input's 3 regressors: `1 - (1 - c) (freedom + 3) /
    /// freedom`, at least 0, as in an adjusted coefficient of determination.
    ///
    /// Without the adjustment, the maximum over many outputs would hardly ever be small.
    fn adjusted_coherence(&self, input: usize) -> f64 {
        let regressors = TERMS as f64;
        let freedom = self.freedom.max(1) as f64;
        let greatest = self
            .partial_coherence
            .column(input)
            .iter()
            .fold(0.0, |a: f64, b| a.max(*b));
        (1.0 - (1.0 - greatest) * (freedom + regressors) / freedom).max(0.0)
    }

    /// Returns whether at least one input is coherent with an output.
    fn shows_response(&self) -> bool {
        (0..self.response.ncols()).any(|input| self.adjusted_coherence(input) >= TRUSTED_COHERENCE)
    }

    /// Converts a point in scaled units to record units.
    fn in_units(&self, response_factors: &DMatrix<f64>, outputs: &DVector<f64>) -> Self {
        Self {
            response: self
                .response
                .zip_map(response_factors, |g, scale| g * scale),
            variance: self
                .variance
                .zip_map(response_factors, |v, scale| v * scale * scale),
            noise: self.noise.component_mul(&(outputs * outputs.transpose())),
            power: self.power.component_mul(outputs).component_mul(outputs),
            ..self.clone()
        }
    }
}

/// How far each input was excited independently.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    /// For each input: largest partial coherence with any output, adjusted for chance; median over
    /// frequency, 0 to 1.
    pub partial_coherence: Vec<f64>,
    /// Condition number of the inputs' spectral matrix, as a median over frequency.
    pub condition: f64,
}

impl Excitation {
    /// Returns the inputs, by index from 0, whose median partial coherence is below 0.3: the
    /// responses to them are not identified.
    pub fn not_identified(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.partial_coherence.len())
            .filter(|&i| self.partial_coherence[i] < LEAST_PARTIAL_COHERENCE)
    }

    /// Returns the most coherent input's median partial coherence; 0 without inputs.
    #[must_use]
    pub fn greatest_coherence(&self) -> f64 {
        self.partial_coherence.iter().copied().fold(0.0, f64::max)
    }

    /// Returns whether the median condition number exceeds 1000: some inputs were moved only
    /// together.
    #[must_use]
    pub fn moved_together(&self) -> bool {
        self.condition > GREATEST_CONDITION
    }
}

/// The measured response `G[output, input]` over frequency, by the local polynomial method (M14.2).
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseEstimate {
    /// Points, by ascending frequency; not empty.
    pub points: Vec<EstimatePoint>,
}

impl ResponseEstimate {
    /// Returns the narrower band \[rad/s\] in which the records show a response: without the lower
    /// end, the upper end or both, where at least a fifth (in logarithm) shows none, because no
    /// input is coherent with any output there.
    ///
    /// `None` if fewer than two points show a response, if both ends show one, or if the remaining
    /// band is narrower than a fifth of the given one (in logarithm).
    #[must_use]
    pub fn shown_band(&self, band: [f64; 2]) -> Option<[f64; 2]> {
        let mut shown = self
            .points
            .iter()
            .filter(|point| (band[0]..=band[1]).contains(&point.omega) && point.shows_response())
            .map(|point| point.omega);
        let first = shown.next()?;
        let last = shown.next_back()?;
        let fifth = (band[1] / band[0]).powf(EMPTY_END);
        let lower = if first > band[0] * fifth {
            first
        } else {
            band[0]
        };
        let upper = if last < band[1] / fifth {
            last
        } else {
            band[1]
        };
        let narrower = [lower, upper];
        if narrower != band && narrower[1] > narrower[0] * fifth {
            Some(narrower)
        } else {
            None
        }
    }

    /// Converts the estimate to a measured response whose weights are the partial coherences.
    ///
    /// Returns `None` for fewer than two points.
    pub fn measured(&self) -> Option<MeasuredResponse> {
        self.points.first()?;
        let re = self.table(|point, pair| point.response[pair].re);
        let im = self.table(|point, pair| point.response[pair].im);
        let coherence = self.table(|point, pair| point.partial_coherence[pair].clamp(0.0, 1.0));
        MeasuredResponse::new(
            self.points.iter().map(|point| point.omega).collect(),
            &re,
            &im,
            Some(coherence),
        )
        .ok()
    }

    /// Tabulates a value for every response over frequency. `points` must not be empty.
    fn table(&self, value: fn(&EstimatePoint, (usize, usize)) -> f64) -> PairTable<Vec<f64>> {
        let (outputs, inputs) = self.points[0].response.shape();
        PairTable::from_fn(outputs, inputs, |pair: Pair| {
            self.points
                .iter()
                .map(|point| value(point, (pair.output, pair.input)))
                .collect()
        })
    }

    /// Computes how far each input was excited independently.
    ///
    /// A coupled response may be weak although its input was moved enough: the maximum partial
    /// coherence over the outputs counts at each frequency.
    #[must_use]
    pub fn excitation(&self) -> Excitation {
        let inputs = self
            .points
            .first()
            .map_or(0, |point| point.response.ncols());
        let mut partial_coherence = Vec::with_capacity(inputs);
        for input in 0..inputs {
            let mut coherences: Vec<f64> = self
                .points
                .iter()
                .map(|point| point.adjusted_coherence(input))
                .collect();
            partial_coherence.push(median(&mut coherences));
        }
        let mut conditions: Vec<f64> = self.points.iter().map(|point| point.condition).collect();
        Excitation {
            partial_coherence,
            condition: median(&mut conditions),
        }
    }

    /// Converts an estimate from the units in `scales` to record units.
    #[must_use]
    pub fn in_units(&self, scales: &Scales) -> Self {
        let response_factors = scales.response_factors();
        let outputs = DVector::from_column_slice(&scales.outputs);
        Self {
            points: self
                .points
                .iter()
                .map(|point| point.in_units(&response_factors, &outputs))
                .collect(),
        }
    }
}
