//! Gaps of a record.

use super::Signal;
use super::signal::names;
use std::fmt;

/// Why something is missing.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// Rows have no time stamp.
    StampsMissing,
    /// Time jumps from one row to the next.
    RowsMissing,
    /// Channels have no value.
    SamplesMissing {
        /// Which.
        signals: Vec<Signal>,
    },
    /// Outputs stood still while others moved.
    Frozen {
        /// Which.
        signals: Vec<Signal>,
    },
    /// What is left between two gaps is shorter than the least piece.
    PieceTooShort {
        /// Its length \[s\].
        length_s: f64,
    },
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
            Cause::SamplesMissing { signals } => write!(f, "{} missing", names(signals))?,
            Cause::Frozen { signals } => write!(f, "{} frozen", names(signals))?,
            Cause::PieceTooShort { length_s } => write!(f, "only {length_s:.1} s between gaps")?,
        }
        f.write_str(if self.treatment == Treatment::Bridged { ", bridged" } else { ", left out" })
    }
}
