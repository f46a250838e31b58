//! Gaps of a flight record, and words for its channels.

use std::fmt;

use gdcm_model::simulation::Signal;

/// The names of `signals` in a row: `P, Q and R`.
pub(super) fn names(signals: &[Signal]) -> String {
    listed(
        &signals
            .iter()
            .map(|signal| signal.name.as_str())
            .collect::<Vec<_>>(),
    )
}

/// Words in a row: `P, Q and R`.
pub(super) fn listed<S: AsRef<str> + std::borrow::Borrow<str>>(words: &[S]) -> String {
    match words {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [most @ .., last] => format!("{} and {}", most.join(", "), last.as_ref()),
    }
}

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
        f.write_str(if self.treatment == Treatment::Bridged {
            ", bridged"
        } else {
            ", left out"
        })
    }
}
