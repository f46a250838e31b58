//! The measured frequency response, with what speaks for it.

use super::*;
use crate::dataset::{MeasuredResponse, PairTable};
use nalgebra::{Complex, DMatrix, DVector};

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
    /// SpectralLines used, less the unknowns: the degrees of freedom of `noise`.
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
        (0..self.partial_coherence.len()).filter(|&i| self.partial_coherence[i] < LEAST_PARTIAL_COHERENCE)
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
        let greatest = self.partial_coherence.column(input).iter().fold(0.0, |a: f64, b| a.max(*b));
        (1.0 - (1.0 - greatest) * (freedom + columns) / freedom).max(0.0)
    }
}

impl ResponseEstimate {
    /// The part of a band \[rad/s\] that the records show, where its upper or its lower fifth (in logarithm) shows nothing: no input
    /// is coherent with any output there. It ends at the last frequencies where one is.
    #[must_use]
    pub fn shown_band(&self, band: [f64; 2]) -> Option<[f64; 2]> {
        let inside = self.points.iter().filter(|point| (band[0]..=band[1]).contains(&point.omega));
        let is_shown = |point: &&EstimatePoint| {
            (0..point.response.ncols()).any(|input| point.greatest_coherence(input) >= TRUSTED_COHERENCE)
        };
        let mut shown = inside.filter(is_shown).map(|point| point.omega);
        let first = shown.next()?;
        let last = shown.next_back()?;
        let fifth = (band[1] / band[0]).powf(END);
        let part = [
            if first > band[0] * fifth { first } else { band[0] },
            if last < band[1] / fifth { last } else { band[1] },
        ];
        (part != band && part[1] > part[0] * fifth).then_some(part)
    }

    /// The estimate as a measured response, weighed by its partial coherence: what each input explains of what the others leave.
    /// None where it has fewer than two points.
    pub fn measured(&self) -> Option<MeasuredResponse> {
        let (outputs, inputs) = self.points.first()?.response.shape();
        let table = |value: &dyn Fn(&EstimatePoint, (usize, usize)) -> f64| {
            let curve = |pair: Pair| self.points.iter().map(|point| value(point, (pair.output, pair.input))).collect();
            PairTable::<Vec<f64>>::from_fn(outputs, inputs, curve)
        };
        let (re, im) = (table(&|point, at| point.response[at].re), table(&|point, at| point.response[at].im));
        let coherence = table(&|point, at| point.partial_coherence[at].clamp(0.0, 1.0));
        MeasuredResponse::new(self.points.iter().map(|point| point.omega).collect(), &re, &im, Some(coherence)).ok()
    }

    /// How far the inputs were moved, each by itself.
    ///
    /// A coupled response may be weak though its input was moved well: for each input and frequency the output with the
    /// greatest partial coherence counts.
    #[must_use]
    pub fn excitation(&self) -> Excitation {
        let inputs = self.points.first().map_or(0, |point| point.response.ncols());
        let over = |of: &dyn Fn(&EstimatePoint) -> f64| median(&mut self.points.iter().map(of).collect::<Vec<f64>>());
        Excitation {
            partial_coherence: (0..inputs).map(|input| over(&|point| point.greatest_coherence(input))).collect(),
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
            variance: point.variance.zip_map(&of_response, |v, scale| v * scale * scale),
            noise: point.noise.component_mul(&(&outputs * outputs.transpose())),
            power: point.power.component_mul(&outputs).component_mul(&outputs),
            ..point.clone()
        };
        Self { points: self.points.iter().map(point).collect() }
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
            let (mut sum, mut weights) = (points[k].noise.scale(0.0), 0.0);
            for (weight, neighbour) in SMOOTHING.iter().zip(k..) {
                if let Some(point) = neighbour.checked_sub(reach).and_then(|neighbour| points.get(neighbour)) {
                    sum += point.noise.scale(*weight);
                    weights += weight;
                }
            }
            let mut covariance = sum / weights;
            for o in 0..covariance.nrows() {
                covariance[(o, o)] += ADDED * covariance[(o, o)] + FLOOR * points[k].power[o] + f64::MIN_POSITIVE;
            }
            covariance
        };
        let log_omega = points.iter().map(|point| point.omega.ln()).collect();
        let covariances = (0..points.len()).map(smoothed).collect();
        (!points.is_empty()).then_some(Self { log_omega, covariances })
    }

    /// `Cv` at `omega` \[rad/s\].
    #[must_use]
    pub fn at(&self, omega: f64) -> DMatrix<f64> {
        let x = omega.ln();
        let after = self.log_omega.partition_point(|&w| w <= x);
        if after == 0 {
            return self.covariances[0].clone();
        }
        let before = after - 1;
        let Some(next) = self.covariances.get(after) else {
            return self.covariances[before].clone();
        };
        let share = (x - self.log_omega[before]) / (self.log_omega[after] - self.log_omega[before]);
        self.covariances[before].scale(1.0 - share) + next.scale(share)
    }

    /// `W` at `omega`: the inverse of the lower Cholesky factor of `Cv / 2`, outputs x outputs, lower triangular.
    ///
    /// `W e` has real and imaginary parts of variance one each where `e` is noise (M14, 4). None where the covariance is not
    /// positive definite, which takes noise that is 1e8 times stronger in one combination of outputs than in another.
    #[must_use]
    pub fn weight(&self, omega: f64) -> Option<DMatrix<f64>> {
        let lower = self.at(omega).scale(0.5).cholesky()?.unpack();
        let inverse = lower.solve_lower_triangular(&DMatrix::identity(lower.nrows(), lower.nrows()))?;
        inverse.iter().all(|w| w.is_finite()).then_some(inverse)
    }

    /// `W e` for a vector of lines `e`, one an output; see [`Self::weight`].
    #[must_use]
    pub fn whitened(weight: &DMatrix<f64>, lines: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let row = |o: usize| (0..=o).map(|k| lines[k] * weight[(o, k)]).sum();
        (0..weight.nrows().min(lines.len())).map(row).collect()
    }
}
