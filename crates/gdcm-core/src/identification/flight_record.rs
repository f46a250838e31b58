//! A flight record as it was logged, and the pieces of it that identification uses.

use nalgebra::DMatrix;

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

/// A piece of a flight record without gaps, on a uniform grid of time, all samples finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
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
