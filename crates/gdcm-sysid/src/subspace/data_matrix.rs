//! Computes the data matrix for CT-PBSID, from Laguerre projections of inputs and outputs, and its
//! triangular factor (M14.3).
//!
//! A *projection* of a signal is the integral of its future from an instant on, weighted with a
//! Laguerre function, whose time scale is the *Laguerre pole* (`laguerre`). CT-PBSID (`ct_pbsid`)
//! predicts the last projections from those before.

use nalgebra::{DMatrix, DVector};

use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::Segment;

use super::laguerre::LaguerreBank;
use super::triangular_factor::TriangularFactor;

/// Delay of an all-pass filter at low frequency, times the Laguerre pole (`laguerre`).
const ALL_PASS_DELAY: f64 = 2.0;
/// Time after which the first filter's impulse response has decayed to 2 %, times the Laguerre
/// pole.
const FIRST_FILTER_DECAY: f64 = 4.0;
/// Largest share of a segment that may be lost to the incomplete projections at its end.
const LARGEST_INCOMPLETE_SHARE: f64 = 0.3;
/// Number of parts whose rows are factored in parallel. Two parts keep two cores busy with three
/// poles; merging a further part costs as much as a 6 s segment.
const PARTS: usize = 2;

/// Settings for the data matrix in CT-PBSID (M14.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Projections {
    /// Laguerre pole `a` \[rad/s\].
    pub(crate) pole: f64,
    /// `p`: every channel has the projections 0 to `past`.
    pub(crate) past: usize,
    /// Time between the instants at which rows are taken \[s\].
    pub(crate) spacing_s: f64,
}

impl Projections {
    /// Computes a segment's rows, including its trim and drift, from the signals less their last
    /// samples (`laguerre`).
    ///
    /// ```text
    /// row t_i = [z_0(t_i) | z_1(t_i) | ... | z_p(t_i)]
    /// z_k = [u~_k; y~_k] the projected inputs and outputs
    /// instants t_i every `spacing_s`, except for the last min((2p + 4)/a, 0.3 T) s, where the
    /// projections lack the future; T the segment's length
    /// ```
    pub(crate) fn rows(&self, segment: &Segment) -> DMatrix<f64> {
        let instants = self.instants(segment);
        let channels = segment.inputs.ncols() + segment.outputs.ncols();
        let mut rows = DMatrix::zeros(instants.len(), (self.past + 1) * channels);
        let bank = LaguerreBank::new(self.pole, segment.sample_time_s);
        let signals = segment
            .inputs
            .column_iter()
            .chain(segment.outputs.column_iter());
        for (channel, signal) in signals.enumerate() {
            let last = signal.iter().next_back().copied().unwrap_or_default();
            let ending_at_zero: Vec<f64> = signal.iter().map(|sample| sample - last).collect();
            let projections = bank.projections(&ending_at_zero, self.past);
            for (k, projection) in projections.column_iter().enumerate() {
                // Block k holds all channels' projections z_k.
                let mut column = rows.column_mut(k * channels + channel);
                for (to, &instant) in column.iter_mut().zip(&instants) {
                    *to = projection[instant];
                }
            }
        }
        rows
    }

    /// Returns the sample indices at which a segment's rows are taken.
    fn instants(&self, segment: &Segment) -> Vec<usize> {
        let samples = segment.inputs.nrows();
        let duration = samples as f64 * segment.sample_time_s;
        let incomplete_s = ((ALL_PASS_DELAY * self.past as f64 + FIRST_FILTER_DECAY) / self.pole)
            .min(LARGEST_INCOMPLETE_SHARE * duration);
        let step = ((self.spacing_s / segment.sample_time_s).round() as usize).max(1);
        let complete =
            samples.saturating_sub((incomplete_s / segment.sample_time_s).ceil() as usize);
        (0..complete).step_by(step).collect()
    }

    /// Computes the triangular factor of the data matrix over all segments.
    ///
    /// Trim and drift are projected out of each segment first. The result is bit for bit the same
    /// with any number of threads: they do not decide which segments are factored together.
    pub(crate) fn factor(&self, segments: &[Segment], executor: &dyn Executor) -> TriangularFactor {
        let parts = segments.chunks(segments.len().div_ceil(PARTS).max(1));
        let factors = each(executor, parts, |part| self.factor_part(part));
        let mut factors = factors.into_iter();
        let Some(mut factor) = factors.next() else {
            return TriangularFactor::empty(0);
        };
        for other in factors {
            factor.append(other.matrix());
        }
        factor
    }

    /// Computes the triangular factor of the data matrix over some segments.
    fn factor_part(&self, segments: &[Segment]) -> TriangularFactor {
        let channels = segments.first().map_or(0, |segment| {
            segment.inputs.ncols() + segment.outputs.ncols()
        });
        let mut factor = TriangularFactor::empty((self.past + 1) * channels);
        for segment in segments {
            let mut rows = self.rows(segment);
            remove_trend(&mut rows);
            factor.append(&rows);
        }
        factor
    }
}

/// Subtracts the projection on `[1, i]` from every column: trim and drift vanish exactly.
fn remove_trend(rows: &mut DMatrix<f64>) {
    let count = rows.nrows();
    let middle = (count.max(1) - 1) as f64 / 2.0;
    let ramp = DVector::from_fn(count, |row, _| row as f64 - middle);
    let squared = ramp.norm_squared();
    for mut column in rows.column_iter_mut() {
        let mean = column.sum() / count as f64;
        column.add_scalar_mut(-mean);
        if squared > 0.0 {
            let slope = ramp.dot(&column) / squared;
            column.axpy(-slope, &ramp, 1.0);
        }
    }
}
