//! A gap in a flight record, with its cause and its treatment (M14.1). `gap_search` finds the gaps.

use std::fmt;

use gdcm_model::simulation::Signal;

use super::signal_names::names;

/// Why there is a gap.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// Rows have no time stamp.
    StampsMissing,
    /// Time jumps between rows.
    RowsMissing,
    /// Channels have no value.
    SamplesMissing(Vec<Signal>),
    /// Outputs stood still while another channel moved.
    Frozen(Vec<Signal>),
    /// A part without gaps is shorter than the minimum segment; its length \[s\].
    SegmentTooShort(f64),
}

/// How a gap is treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Treatment {
    /// Replaced by straight lines.
    Bridged,
    /// The missing samples are unknowns in the fit, and the other channels are used (M14.21).
    Estimated,
    CutOut,
}

impl Treatment {
    /// Returns the treatment: short gaps are bridged, others cut out.
    pub(crate) fn for_gap(is_short: bool) -> Self {
        if is_short {
            Self::Bridged
        } else {
            Self::CutOut
        }
    }
}

/// A gap in a record, between the last valid sample before it and the next after it; or a part that
/// is too short to be used.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// Start \[s\], on the record's time axis.
    pub start_s: f64,
    /// End \[s\], on the record's time axis.
    pub end_s: f64,
    pub cause: Cause,
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
        f.write_str(match self.treatment {
            Treatment::Bridged => ", bridged",
            Treatment::Estimated => ", estimated",
            Treatment::CutOut => ", left out",
        })
    }
}
