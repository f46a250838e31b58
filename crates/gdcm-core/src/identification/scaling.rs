//! The scale of every channel: its rms about the mean.

use super::Piece;
use nalgebra::DMatrix;

/// A channel whose rms about the mean is below this share of its greatest modulus is constant: what is left is rounding.
const CONSTANT: f64 = 1e-12;

/// The scale of every channel, in the units of the file: its rms about the mean of each piece, over all pieces (M14, 1.6).
///
/// ```text
/// s_c = sqrt( sum_r sum_n (x_c[n] - mean_r x_c)^2 / sum_r N_r )
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// Scale of each input, greater than 0.
    pub inputs: Vec<f64>,
    /// Scale of each output, greater than 0.
    pub outputs: Vec<f64>,
}

/// Why the pieces have no scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScalingError {
    /// There is nothing to scale.
    #[error("there are no flight records")]
    NoPieces,
    /// A piece has other channels than the first.
    #[error("piece {} of the flight records has another number of channels than the first", piece + 1)]
    ChannelsDiffer {
        /// Which, counted from 0.
        piece: usize,
    },
    /// A piece holds a sample that is not finite, or one whose square is not.
    #[error("piece {} of the flight records holds values that are not finite or absurdly large", piece + 1)]
    NotFinite {
        /// Which, counted from 0.
        piece: usize,
    },
    /// An input is constant in every piece.
    #[error("input {} does not move in any record: leave it out", input + 1)]
    InputConstant {
        /// Which, counted from 0.
        input: usize,
    },
    /// An output is constant in every piece.
    #[error("output {} does not move in any record: leave it out", output + 1)]
    OutputConstant {
        /// Which, counted from 0.
        output: usize,
    },
}

impl Scales {
    /// The scales of the channels of `pieces`.
    ///
    /// # Errors
    /// No pieces, differing numbers of channels, values that are not finite, a constant channel.
    pub fn of(pieces: &[Piece]) -> Result<Self, ScalingError> {
        let first = pieces.first().ok_or(ScalingError::NoPieces)?;
        let channels = |piece: &Piece| (piece.inputs.ncols(), piece.outputs.ncols());
        if let Some(piece) = pieces.iter().position(|p| channels(p) != channels(first)) {
            return Err(ScalingError::ChannelsDiffer { piece });
        }
        let (inputs, outputs) = (rms(pieces, |piece| &piece.inputs)?, rms(pieces, |piece| &piece.outputs)?);
        let of_all = |channels: Vec<Option<f64>>, constant: fn(usize) -> ScalingError| {
            channels.into_iter().enumerate().map(|(k, s)| s.ok_or_else(|| constant(k))).collect::<Result<Vec<f64>, _>>()
        };
        Ok(Self {
            inputs: of_all(inputs, |input| ScalingError::InputConstant { input })?,
            outputs: of_all(outputs, |output| ScalingError::OutputConstant { output })?,
        })
    }

    /// `piece` in scaled units: every channel divided by its scale. Channels beyond those of the scales are not touched.
    #[must_use]
    pub fn scaled(&self, piece: &Piece) -> Piece {
        let mut scaled = piece.clone();
        for (samples, scales) in [(&mut scaled.inputs, &self.inputs), (&mut scaled.outputs, &self.outputs)] {
            for (mut column, scale) in samples.column_iter_mut().zip(scales) {
                column /= *scale;
            }
        }
        scaled
    }

    /// What a response `[output, input]` in scaled units is multiplied with to be in the units of the file.
    #[must_use]
    pub fn of_response(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.outputs.len(), self.inputs.len(), |o, i| self.outputs[o] / self.inputs[i])
    }
}

/// The rms of each channel about its mean in each piece, over all pieces; none for a constant channel.
fn rms(pieces: &[Piece], side: fn(&Piece) -> &DMatrix<f64>) -> Result<Vec<Option<f64>>, ScalingError> {
    let channels = pieces.first().map_or(0, |piece| side(piece).ncols());
    let (mut squares, mut greatest, mut samples) = (vec![0.0; channels], vec![0.0_f64; channels], 0);
    for (index, piece) in pieces.iter().enumerate() {
        let rows = side(piece).nrows();
        samples += rows;
        for (c, column) in side(piece).column_iter().enumerate() {
            let mean = if rows == 0 { 0.0 } else { column.sum() / rows as f64 };
            squares[c] += column.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            if !squares[c].is_finite() {
                return Err(ScalingError::NotFinite { piece: index });
            }
            greatest[c] = greatest[c].max(column.amax());
        }
    }
    let scale = |(square, greatest): (&f64, &f64)| {
        let rms = if samples == 0 { 0.0 } else { (square / samples as f64).sqrt() };
        (rms > 0.0 && rms > CONSTANT * greatest).then_some(rms)
    };
    Ok(squares.iter().zip(&greatest).map(scale).collect())
}
