//! Reasons why a flight condition cannot be identified.

use gdcm_model::progress::Cancelled;
use gdcm_model::simulation::Signal;

use crate::spectra::local_polynomial_error::LocalPolynomialError;
use crate::spectra::preparation_settings::PreparationError;
use crate::spectra::scales::ScalingError;
use crate::spectra::signal_names::names;

/// Maximum model order that may be requested.
pub const HIGHEST_ORDER: usize = 60;
/// Maximum past window that may be requested.
pub const LONGEST_PAST: usize = 60;

/// Reason why a flight condition cannot be identified.
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
    /// The longest segment without a long gap is too short for the lower end of the band.
    #[error(
        "the longest record lasts {longest_s:.0} s: a lower band end of {lowest:.2} rad/s needs \
        at least {needed_s:.1} s, preferably {better_s:.0} s. Raise the lower band end to \
        {enough:.2} rad/s, or log longer"
    )]
    TooShort {
        longest_s: f64,
        /// Lower band end \[rad/s\].
        lowest: f64,
        /// Required length: 1.5 periods at the lower end of the band \[s\].
        needed_s: f64,
        /// Recommended length: 5 periods; in a single segment, at least 3 for each input \[s\].
        better_s: f64,
        /// Lowest lower band end for which the longest segment is long enough \[rad/s\].
        enough: f64,
    },
    /// The spectral lines to fit hold fewer real values than a first-order model needs.
    #[error(
        "the spectral lines in the band contain {figures} real values, but {needed} are needed: 5 \
        for each of the {unknowns} unknowns in a first-order model. Log longer or more records, \
        widen the band, or leave out channels"
    )]
    TooFewFigures {
        /// Number of real values in the lines, less two for each output and segment, which are
        /// lost to the segment's unknown step and drift.
        figures: usize,
        needed: usize,
        /// Number of unknowns in a first-order model.
        unknowns: usize,
    },
    /// The band ends are invalid or interchanged.
    #[error(
        "the band from {lowest} to {highest} rad/s is invalid: its lower end must be greater than \
        0, and its upper end greater than its lower end"
    )]
    Band { lowest: f64, highest: f64 },
    /// The records are sampled too slowly for the band.
    #[error(
        "the band ends at {highest} rad/s, but the sample time of {sample_time_s:.4} s is too \
        long for it: end the band below {limit:.1} rad/s, or log faster"
    )]
    SampledTooSlowly {
        /// Upper band end \[rad/s\].
        highest: f64,
        /// Longest sample time among the segments \[s\].
        sample_time_s: f64,
        /// Maximum possible upper end of the band \[rad/s\].
        limit: f64,
    },
    /// Orders, past windows or poles are missing or invalid.
    #[error(
        "the lists of orders, past windows and Laguerre poles must not be empty; orders must be \
        from 1 to {HIGHEST_ORDER}, past windows from 1 to {LONGEST_PAST}, and Laguerre poles \
        greater than 0"
    )]
    Settings,
    /// No input of the model remains: a reference is a recorded signal that drove the loop from
    /// outside.
    #[error(
        "every input is given as a reference, but the model needs at least one input: remove a reference"
    )]
    OnlyReferences,
    #[error("record {} is to be held out, but the number of records is {records}", record + 1)]
    HeldOutMissing {
        /// Record index, from 0.
        record: usize,
        records: usize,
    },
    /// All records are held out or unusable.
    #[error(
        "no record remains for fitting a model: all are held out, or have no usable part; hold out fewer records, or add others"
    )]
    NothingToFit,
    /// Some inputs depend linearly on each other.
    #[error("{} move together in every record: leave out all but one, or move them independently", names(.0))]
    InputsDepend(Vec<Signal>),
    /// The noise covariance of the outputs is singular.
    #[error(
        "the outputs depend on each other so closely that their noise covariance is singular: \
        leave out redundant outputs"
    )]
    OutputsDepend,
    #[error(
        "no model was found from {lines} spectral lines in {seconds:.0} s of records: log longer or more records, \
         widen the band, or leave out channels"
    )]
    NoModel {
        /// Number of spectral lines to fit, over all fitted records.
        lines: usize,
        /// Total length of the fitted records without gaps \[s\].
        seconds: f64,
    },
    #[error("the identification was stopped")]
    Stopped(#[from] Cancelled),
}
