//! Flight records as logged, and their segments on a uniform time grid.

use std::fmt;

use nalgebra::{DMatrix, DVectorView};

use crate::dataset::channel::ChannelSide;

/// A flight record: time stamps and samples for all inputs and outputs, in file units.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightRecord {
    /// Display name.
    pub name: String,
    /// Time stamps \[s\]; NaN where missing.
    pub time_s: Vec<f64>,
    /// Inputs: a row per sample, a column per channel; NaN where missing.
    pub inputs: DMatrix<f64>,
    /// Outputs: a row per sample, a column per channel; NaN where missing.
    pub outputs: DMatrix<f64>,
}

/// A gap-free segment of a flight record on a uniform time grid, with all samples finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Record index, counted from 0.
    pub record: usize,
    /// Time of the first sample \[s\], on the record's time axis.
    pub start_s: f64,
    /// Sample time \[s\].
    pub sample_time_s: f64,
    /// Inputs: a row per sample, a column per channel.
    pub inputs: DMatrix<f64>,
    /// Outputs: a row per sample, a column per channel.
    pub outputs: DMatrix<f64>,
}

impl FlightRecord {
    /// Returns a channel's samples.
    #[must_use]
    pub fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal
            .role
            .of(&self.inputs, &self.outputs)
            .column(signal.index)
    }
}

impl Segment {
    /// Returns a channel's samples.
    #[must_use]
    pub fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal
            .role
            .of(&self.inputs, &self.outputs)
            .column(signal.index)
    }
}

/// Subtracts the mean of each column.
#[must_use]
pub fn centred(mut samples: DMatrix<f64>) -> DMatrix<f64> {
    for mut column in samples.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    samples
}

/// A channel in flight records, by index and name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Signal {
    pub role: ChannelSide,
    /// Index among the inputs or outputs, counted from 0.
    pub index: usize,
    /// Display name.
    pub name: String,
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}
