//! Flight records as logged, and their segments on a uniform time grid.

use std::fmt;

use nalgebra::{DMatrix, DVectorView};

use crate::dataset::channel::ChannelSide;

/// A flight record: samples of every input and output with time stamps, in the units of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightRecord {
    /// Display name.
    pub name: String,
    /// Time of each sample \[s\]; NaN where the stamp is missing.
    pub time_s: Vec<f64>,
    /// Inputs, one row per sample, one column per channel; NaN where the sample is missing.
    pub inputs: DMatrix<f64>,
    /// Outputs, one row per sample, one column per channel; NaN where the sample is missing.
    pub outputs: DMatrix<f64>,
}

/// A gap-free segment of a flight record on a uniform time grid, with all samples finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Index of its record, counted from 0.
    pub record: usize,
    /// Time of its first sample \[s\], on the record's clock.
    pub start_s: f64,
    /// Sample time \[s\].
    pub sample_time_s: f64,
    /// Inputs, one row per sample.
    pub inputs: DMatrix<f64>,
    /// Outputs, one row per sample.
    pub outputs: DMatrix<f64>,
}

impl FlightRecord {
    /// Returns the samples of one channel.
    #[must_use]
    pub fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal
            .role
            .of(&self.inputs, &self.outputs)
            .column(signal.index)
    }
}

impl Segment {
    /// Returns the samples of one channel.
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

/// A channel of the flight records, by index and name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Signal {
    /// Input or output.
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
