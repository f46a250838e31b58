//! Flight records as logged, and their segments without gaps on a uniform time grid.

use std::fmt;

use nalgebra::{DMatrix, DVectorView};

use crate::dataset::channel::ChannelSide;

/// A flight record: time stamps and samples for all inputs and outputs, in the file's units.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightRecord {
    pub name: String,
    /// Time stamps \[s\]; NaN if missing.
    pub time_s: Vec<f64>,
    /// Inputs: one row per sample, one column per channel; NaN if missing.
    pub inputs: DMatrix<f64>,
    /// Outputs: one row per sample, one column per channel; NaN if missing.
    pub outputs: DMatrix<f64>,
}

/// A gap-free record segment on a uniform time grid, with all samples finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Record index, counted from 0.
    pub record: usize,
    /// First sample's time \[s\], on the record's time axis.
    pub start_s: f64,
    pub sample_time_s: f64,
    /// Inputs: one row per sample, one column per channel.
    pub inputs: DMatrix<f64>,
    /// Outputs: one row per sample, one column per channel.
    pub outputs: DMatrix<f64>,
}

impl FlightRecord {
    /// Returns a channel's samples; panics if the record does not have the channel.
    #[must_use]
    pub fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal
            .role
            .pick(&self.inputs, &self.outputs)
            .column(signal.index)
    }
}

impl Segment {
    /// Returns the duration \[s\]: sample count times sample time.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.sample_time_s * self.inputs.nrows() as f64
    }

    /// Returns a channel's samples; panics if the segment does not have the channel.
    #[must_use]
    pub fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal
            .role
            .pick(&self.inputs, &self.outputs)
            .column(signal.index)
    }
}

/// A channel in flight records, by index and name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Signal {
    pub role: ChannelSide,
    /// Index among the inputs or outputs, counted from 0.
    pub index: usize,
    pub name: String,
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// Subtracts its mean from each column.
#[must_use]
pub fn centred(mut samples: DMatrix<f64>) -> DMatrix<f64> {
    for mut column in samples.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    samples
}
