//! Why nothing could be identified.

use super::signal::names;
use super::{LocalPolynomialError, PreparationError, ScalingError, Signal};

/// The highest order that may be asked for.
pub(super) const HIGHEST_ORDER: usize = 60;
/// The longest past window that may be asked for.
pub(super) const LONGEST_PAST: usize = 60;

/// Why nothing could be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentificationError {
    /// The records cannot be prepared.
    #[error(transparent)]
    Preparation(#[from] PreparationError),
    /// The channels cannot be scaled.
    #[error(transparent)]
    Scaling(#[from] ScalingError),
    /// The response cannot be measured.
    #[error(transparent)]
    Measurement(#[from] LocalPolynomialError),
    /// The records are too short for the lower end of the band, and would do for a higher one.
    #[error("{why}. They are long enough for a band from {lowest:.2} rad/s on")]
    TooShort {
        /// Where there are too few lines.
        why: LocalPolynomialError,
        /// Lower end of the band for which there are enough \[rad/s\].
        lowest: f64,
    },
    /// The band is no band.
    #[error(
        "a band from {lowest} to {highest} rad/s: its lower end must be greater than 0, and its upper end above it"
    )]
    Band {
        /// Lower end \[rad/s\].
        lowest: f64,
        /// Upper end \[rad/s\].
        highest: f64,
    },
    /// The records are sampled too slowly for the band.
    #[error(
        "the band ends at {highest} rad/s, but a sample time of {sample_time_s:.4} s is too long for that: \
         end the band below {limit:.1} rad/s, or log faster"
    )]
    SampledTooSlowly {
        /// Upper end \[rad/s\].
        highest: f64,
        /// The longest sample time \[s\].
        sample_time_s: f64,
        /// Highest upper end that can be had \[rad/s\].
        limit: f64,
    },
    /// No orders, past windows or poles, or impossible ones.
    #[error(
        "orders and past windows must be given, from 1 to {HIGHEST_ORDER} and from 1 to {LONGEST_PAST}, \
         and Laguerre poles greater than 0"
    )]
    Settings,
    /// A held-out record is not there.
    #[error("record {} is to be held out, but there are only {records}", record + 1)]
    HeldOutMissing {
        /// Which, counted from 0.
        record: usize,
        /// Records there are.
        records: usize,
    },
    /// All records are held out, or cannot be used.
    #[error("no record is left to fit a model to: hold out fewer")]
    NothingToFit,
    /// Inputs that are copies of each other.
    #[error("{} move as one in every record: leave out all but one, or fly them apart", names(signals))]
    InputsDepend {
        /// The inputs.
        signals: Vec<Signal>,
    },
    /// Outputs whose noise cannot be told apart.
    #[error("the outputs depend on each other so closely that their noise cannot be weighed: leave out the copies")]
    OutputsDepend,
    /// No model could be made.
    #[error(
        "no model came of {lines} spectral lines in {seconds:.0} s of records: log longer or more records, \
         lower the least order, or leave out channels"
    )]
    NoModel {
        /// Lines of all records.
        lines: usize,
        /// Their length \[s\].
        seconds: f64,
    },
    /// It was stopped.
    #[error("the identification was stopped")]
    Stopped,
}
