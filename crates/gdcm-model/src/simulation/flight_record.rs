//! Flight records as logged, and segments of them on a uniform grid of time.

use std::fmt;

use nalgebra::{DMatrix, DVectorView};

use crate::dataset::channel::ChannelSide;

/// A flight record: samples of every input and output at stamped times, in the units of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightRecord {
    /// Its name, for people.
    pub name: String,
    /// Time of each sample \[s\]; not a number where the stamp is missing.
    pub time_s: Vec<f64>,
    /// Inputs, one row a sample, one column a channel; not a number where the sample is missing.
    pub inputs: DMatrix<f64>,
    /// Outputs, one row a sample, one column a channel; not a number where the sample is missing.
    pub outputs: DMatrix<f64>,
}

/// A segment of a flight record without gaps, on a uniform grid of time, all samples finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Which of the records it is of, counted from 0.
    pub record: usize,
    /// Time of its first sample \[s\], on the record's clock.
    pub start_s: f64,
    /// Sample time \[s\].
    pub sample_time_s: f64,
    /// Inputs, one row a sample.
    pub inputs: DMatrix<f64>,
    /// Outputs, one row a sample.
    pub outputs: DMatrix<f64>,
}

impl FlightRecord {
    /// Samples of one channel.
    #[must_use]
    pub fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal
            .role
            .of(&self.inputs, &self.outputs)
            .column(signal.index)
    }
}

impl Segment {
    /// Samples of one channel.
    #[must_use]
    pub fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal
            .role
            .of(&self.inputs, &self.outputs)
            .column(signal.index)
    }
}

/// Subtracts from each column its mean.
#[must_use]
pub fn centred(mut samples: DMatrix<f64>) -> DMatrix<f64> {
    for mut column in samples.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    samples
}

/// A channel of the flight records, by place and by name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Signal {
    /// Input or output.
    pub role: ChannelSide,
    /// Which of them, counted from 0.
    pub index: usize,
    /// Its name, for people.
    pub name: String,
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}
