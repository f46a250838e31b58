//! The data matrix of CT-PBSID, and its triangular factor for one Laguerre pole (M14, section 3, steps 1 and 2).
//!
//! ```text
//! row t_i = [z_0(t_i) | z_1(t_i) | ... | z_p(t_i)],   z_k = [u~_k; y~_k] the projections of inputs and outputs
//!
//! 1  instants t_i every `spacing` s, but for the last min((2p + 4)/a, 0.3 T) s of a piece
//! 2  from each column of a piece what [1, t_i] explains is taken off: trim and drift vanish exactly
//! 3  R of the rows of each piece, merged in the order of the pieces
//! ```

use super::Piece;
use super::laguerre_bank::LaguerreBank;
use super::triangular_factor::TriangularFactor;
use crate::executor::{Executor, each};
use nalgebra::{DMatrix, DVector};

/// Share of a piece that the projections' unfinished ends may cost at most.
const LARGEST_END: f64 = 0.3;

/// Which projections, and how far apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Projections {
    /// Laguerre pole `a` \[rad/s\].
    pub(super) pole: f64,
    /// `p`: projections 0 to `past` of every channel.
    pub(super) past: usize,
    /// Time between two instants \[s\].
    pub(super) spacing_s: f64,
}

impl Projections {
    /// The rows of one piece, with its trim and drift.
    pub(super) fn rows(&self, piece: &Piece) -> DMatrix<f64> {
        let samples = piece.inputs.nrows();
        let duration = samples as f64 * piece.sample_time_s;
        let end = ((2.0 * self.past as f64 + 4.0) / self.pole).min(LARGEST_END * duration);
        let step = ((self.spacing_s / piece.sample_time_s).round() as usize).max(1);
        let last = samples.saturating_sub((end / piece.sample_time_s).ceil() as usize);
        let instants: Vec<usize> = (0..last).step_by(step).collect();
        let (inputs, outputs) = (piece.inputs.ncols(), piece.outputs.ncols());
        let channels = inputs + outputs;
        let mut rows = DMatrix::zeros(instants.len(), (self.past + 1) * channels);
        let bank = LaguerreBank::new(self.pole, piece.sample_time_s);
        for (channel, signal) in piece.inputs.column_iter().chain(piece.outputs.column_iter()).enumerate() {
            let end = signal.iter().next_back().copied().unwrap_or_default();
            let signal: Vec<f64> = signal.iter().map(|sample| sample - end).collect();
            let projections = bank.projections(&signal, self.past);
            for (k, projection) in projections.column_iter().enumerate() {
                let mut column = rows.column_mut(k * channels + channel);
                column.iter_mut().zip(&instants).for_each(|(to, &instant)| *to = projection[instant]);
            }
        }
        rows
    }

    /// The triangular factor of the data matrix of all pieces.
    ///
    /// The same to the last bit on any number of threads: which pieces are factored together does not depend on it.
    pub(super) fn factor(&self, pieces: &[Piece], executor: &dyn Executor) -> TriangularFactor {
        /// Two parts keep two cores busy with three poles; merging a further one costs as much as a piece of 6 s.
        const PARTS: usize = 2;
        let part = |pieces: &[Piece]| {
            let channels = pieces.first().map_or(0, |piece| piece.inputs.ncols() + piece.outputs.ncols());
            let mut factor = TriangularFactor::empty((self.past + 1) * channels);
            for piece in pieces {
                let mut rows = self.rows(piece);
                take_off_trend(&mut rows);
                factor.append(&rows);
            }
            factor
        };
        let mut parts = each(executor, pieces.chunks(pieces.len().div_ceil(PARTS).max(1)), part).into_iter();
        let Some(mut factor) = parts.next() else { return TriangularFactor::empty(0) };
        for other in parts {
            factor.merge(&other);
        }
        factor
    }

    /// Rows that the pieces give.
    pub(super) fn count(&self, pieces: &[Piece]) -> usize {
        let of_piece = |piece: &Piece| {
            let duration = piece.inputs.nrows() as f64 * piece.sample_time_s;
            let end = ((2.0 * self.past as f64 + 4.0) / self.pole).min(LARGEST_END * duration);
            ((duration - end) / self.spacing_s.max(piece.sample_time_s)) as usize
        };
        pieces.iter().map(of_piece).sum()
    }
}

/// Takes what `[1, i]` explains off every column.
fn take_off_trend(rows: &mut DMatrix<f64>) {
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
