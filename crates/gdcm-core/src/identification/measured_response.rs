//! The measured frequency response, with what speaks for it.

use super::Scales;
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
pub struct MeasuredPoint {
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
    /// Lines used, less the unknowns: the degrees of freedom of `noise`.
    pub freedom: usize,
}

/// The measured response `G[output, input]` over frequency, by the local polynomial method (M14, 2).
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredResponse {
    /// By ascending frequency, at least one.
    pub points: Vec<MeasuredPoint>,
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

impl MeasuredPoint {
    /// The partial coherence of an input with the output that it moves most, free of the share that as many columns of mere noise
    /// would explain, `1 - (1 - c) (freedom + 3) / freedom`: the greatest of many outputs is never small by chance.
    fn greatest_coherence(&self, input: usize) -> f64 {
        let columns = super::local_polynomial::TERMS as f64;
        let freedom = self.freedom.max(1) as f64;
        let greatest = self.partial_coherence.column(input).iter().fold(0.0, |a: f64, b| a.max(*b));
        (1.0 - (1.0 - greatest) * (freedom + columns) / freedom).max(0.0)
    }
}

impl MeasuredResponse {
    /// The part of a band \[rad/s\] that the records show, where its upper or its lower fifth (in logarithm) shows nothing: no input
    /// is coherent with any output there. It ends at the last frequencies where one is.
    #[must_use]
    pub fn shown_band(&self, band: [f64; 2]) -> Option<[f64; 2]> {
        let inside = self.points.iter().filter(|point| (band[0]..=band[1]).contains(&point.omega));
        let is_shown = |point: &&MeasuredPoint| {
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

    /// How far the inputs were moved, each by itself.
    ///
    /// A coupled response may be weak though its input was moved well: for each input and frequency the output with the
    /// greatest partial coherence counts.
    #[must_use]
    pub fn excitation(&self) -> Excitation {
        let inputs = self.points.first().map_or(0, |point| point.response.ncols());
        let of_input = |i: usize| median(self.points.iter().map(|point| point.greatest_coherence(i)).collect());
        Excitation {
            partial_coherence: (0..inputs).map(of_input).collect(),
            condition: median(self.points.iter().map(|point| point.condition).collect()),
        }
    }

    /// The same in the units of the file, where this is in the scaled units of `scales`.
    #[must_use]
    pub fn in_units(&self, scales: &Scales) -> Self {
        let of_response = scales.of_response();
        let outputs = DVector::from_column_slice(&scales.outputs);
        let point = |point: &MeasuredPoint| MeasuredPoint {
            response: point.response.zip_map(&of_response, |g, scale| g * scale),
            variance: point.variance.zip_map(&of_response, |v, scale| v * scale * scale),
            noise: point.noise.component_mul(&(&outputs * outputs.transpose())),
            power: point.power.component_mul(&outputs).component_mul(&outputs),
            ..point.clone()
        };
        Self { points: self.points.iter().map(point).collect() }
    }
}

/// The middle value, of an even number the mean of the middle two; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    match n {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}
