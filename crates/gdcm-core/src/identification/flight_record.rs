//! A flight record as it was logged, and the segments of it that identification uses.

use super::*;

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
    /// The samples of a channel.
    pub(super) fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal.role.of(&self.inputs, &self.outputs).column(signal.index)
    }
}

impl Segment {
    /// The samples of a channel.
    pub(super) fn channel(&self, signal: &Signal) -> DVectorView<'_, f64> {
        signal.role.of(&self.inputs, &self.outputs).column(signal.index)
    }
}

/// Samples less the mean of their channel, one column a channel.
pub(super) fn centred(mut samples: DMatrix<f64>) -> DMatrix<f64> {
    for mut column in samples.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    samples
}

// What a column of a flight record is.

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

/// The names of `signals` in a row: `P, Q and R`.
pub(super) fn names(signals: &[Signal]) -> String {
    listed(&signals.iter().map(|signal| signal.name.as_str()).collect::<Vec<_>>())
}

/// Words in a row: `P, Q and R`.
pub(super) fn listed<S: AsRef<str> + std::borrow::Borrow<str>>(words: &[S]) -> String {
    match words {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [most @ .., last] => format!("{} and {}", most.join(", "), last.as_ref()),
    }
}

// Gaps of a record.

/// Why something is missing.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// Rows have no time stamp.
    StampsMissing,
    /// Time jumps from one row to the next.
    RowsMissing,
    /// Channels have no value.
    SamplesMissing(Vec<Signal>),
    /// Outputs stood still while others moved.
    Frozen(Vec<Signal>),
    /// What is left between two gaps is shorter than the least segment; its length \[s\].
    SegmentTooShort(f64),
}

/// What was done about a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Treatment {
    /// Straight lines were drawn across it.
    Bridged,
    /// It was left out.
    CutOut,
}

impl Treatment {
    /// What is done about a gap that is short enough, or not.
    pub(super) fn of(short: bool) -> Self {
        if short { Self::Bridged } else { Self::CutOut }
    }
}

/// A gap of a record: from the last good sample to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// On the record's clock \[s\].
    pub start_s: f64,
    /// On the record's clock \[s\].
    pub end_s: f64,
    /// Why.
    pub cause: Cause,
    /// What was done.
    pub treatment: Treatment,
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.2} to {:.2} s: ", self.start_s, self.end_s)?;
        match &self.cause {
            Cause::StampsMissing => f.write_str("time stamps missing")?,
            Cause::RowsMissing => f.write_str("rows missing")?,
            Cause::SamplesMissing(signals) => write!(f, "{} missing", names(signals))?,
            Cause::Frozen(signals) => write!(f, "{} frozen", names(signals))?,
            Cause::SegmentTooShort(length_s) => write!(f, "only {length_s:.1} s between gaps")?,
        }
        f.write_str(if self.treatment == Treatment::Bridged { ", bridged" } else { ", left out" })
    }
}
