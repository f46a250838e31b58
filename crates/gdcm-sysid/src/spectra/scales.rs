//! Channel scales: the rms about the mean (M14.1).

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::Segment;

/// Minimum rms relative to the largest modulus; below it, a channel is constant apart from
/// rounding.
const CONSTANT: f64 = 1e-12;

/// Scale for every channel, in record units: its rms about each segment's mean, over all segments
/// (M14.1).
///
/// ```text
/// s_c = sqrt( sum_r sum_n (x_c[n] - mean_r x_c)^2 / sum_r N_r )
///       channel c, segment r with N_r samples
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// Input scales, greater than 0.
    pub inputs: Vec<f64>,
    /// Output scales, greater than 0.
    pub outputs: Vec<f64>,
}

/// Why channels cannot be scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScalingError {
    #[error("there are no flight records")]
    NoSegments,
    /// A segment, by index from 0, has other channel counts than the first.
    #[error("segment {} of the flight records differs from the first in its number of channels", .0 + 1)]
    ChannelsDiffer(usize),
    /// A sample or its square is not finite in the segment with this index, from 0.
    #[error("segment {} of the flight records has samples that are infinite, NaN or too large; check them", .0 + 1)]
    NotFinite(usize),
    /// The channel is constant in every segment.
    #[error("{role} {} does not move in any record: leave the channel out", index + 1)]
    Constant { role: ChannelSide, index: usize },
}

impl ScalingError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoSegments => "no-segments",
            Self::ChannelsDiffer(..) => "channels-differ",
            Self::NotFinite(..) => "not-finite",
            Self::Constant { .. } => "constant-channels",
        }
    }
}

impl Scales {
    /// Computes the channel scales for `segments`.
    ///
    /// # Errors
    /// No segments, channel counts that differ, values that are not finite, or a constant channel.
    pub fn from_segments(segments: &[Segment]) -> Result<Self, ScalingError> {
        let first = segments.first().ok_or(ScalingError::NoSegments)?;
        for (number, segment) in segments.iter().enumerate() {
            let differs = segment.inputs.ncols() != first.inputs.ncols()
                || segment.outputs.ncols() != first.outputs.ncols();
            if differs {
                return Err(ScalingError::ChannelsDiffer(number));
            }
        }
        Ok(Self {
            inputs: rms_of_side(segments, ChannelSide::Input)?,
            outputs: rms_of_side(segments, ChannelSide::Output)?,
        })
    }

    /// Divides every channel by its scale. Channels without a scale are unchanged.
    #[must_use]
    pub fn scaled(&self, segment: &Segment) -> Segment {
        let mut scaled = segment.clone();
        divide_columns(&mut scaled.inputs, &self.inputs);
        divide_columns(&mut scaled.outputs, &self.outputs);
        scaled
    }

    /// Returns the factors, outputs x inputs, that convert a scaled response to record units.
    #[must_use]
    pub fn response_factors(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.outputs.len(), self.inputs.len(), |o, i| {
            self.outputs[o] / self.inputs[i]
        })
    }
}

fn divide_columns(samples: &mut DMatrix<f64>, scales: &[f64]) {
    for (mut column, scale) in samples.column_iter_mut().zip(scales) {
        column /= *scale;
    }
}

/// Returns a segment's inputs or outputs.
fn samples_of_side(segment: &Segment, role: ChannelSide) -> &DMatrix<f64> {
    role.pick(&segment.inputs, &segment.outputs)
}

/// Computes each channel's rms about its segment means, over all segments.
fn rms_of_side(segments: &[Segment], role: ChannelSide) -> Result<Vec<f64>, ScalingError> {
    let channels = segments
        .first()
        .map_or(0, |segment| samples_of_side(segment, role).ncols());
    let mut squares = vec![0.0; channels];
    let mut greatest = vec![0.0_f64; channels];
    let mut count = 0;
    for (number, segment) in segments.iter().enumerate() {
        let samples = samples_of_side(segment, role);
        let rows = samples.nrows();
        count += rows;
        for (c, column) in samples.column_iter().enumerate() {
            let mean = if rows == 0 {
                0.0
            } else {
                column.sum() / rows as f64
            };
            squares[c] += column.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            if !squares[c].is_finite() {
                return Err(ScalingError::NotFinite(number));
            }
            greatest[c] = greatest[c].max(column.amax());
        }
    }
    let mut scales = Vec::with_capacity(channels);
    for (index, (square, greatest)) in squares.iter().zip(&greatest).enumerate() {
        let rms = if count == 0 {
            0.0
        } else {
            (square / count as f64).sqrt()
        };
        let moves = rms > 0.0 && rms > CONSTANT * greatest;
        if !moves {
            return Err(ScalingError::Constant { role, index });
        }
        scales.push(rms);
    }
    Ok(scales)
}
