//! Reasons why channels with separate clocks cannot be resampled to a common clock (M14.11).

/// Why channels cannot be resampled to a common clock.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResamplingError {
    #[error(
        "samples of {topic} with a time stamp: expected at least 3, found {samples}; choose another column, or leave the record out"
    )]
    TooFew { topic: String, samples: usize },
    /// A channel, or the requested rate, has fewer than 2.5 samples in a period of the highest
    /// line.
    #[error(
        "{topic} is sampled at {rate_hz:.1} Hz, but a band up to {band_end:.3} rad/s needs {needed_hz:.1} Hz: {}, or end \
         the band at {possible:.2} rad/s",
        rate_remedy(topic)
    )]
    TooSlow {
        topic: String,
        rate_hz: f64,
        /// Lowest sample rate for the band \[Hz\].
        needed_hz: f64,
        /// Requested upper end of the band \[rad/s\].
        band_end: f64,
        /// Highest upper end of the band that the sample rate permits \[rad/s\].
        possible: f64,
    },
    #[error(
        "{first} ends at {first_end_s:.1} s, before {second} begins at {second_start_s:.1} s: the two come from different flights, or their \
         clocks differ; choose columns with a common time"
    )]
    NoCommonTime {
        /// The channel that ends first.
        first: String,
        first_end_s: f64,
        /// The channel that begins last.
        second: String,
        second_start_s: f64,
    },
    #[error(
        "the resampled record would have {0:.0} samples, more than 10 million: a time stamp is wrong, or the requested rate (--resample) is too high"
    )]
    TooMany(f64),
}

/// Name of the record on the common clock, if the requested rate is too low.
pub(super) const RESAMPLED_RECORD: &str = "the resampled record";

/// Returns the remedy for a rate that is too low.
fn rate_remedy(name: &str) -> &'static str {
    if name == RESAMPLED_RECORD {
        "raise the requested rate (--resample)"
    } else {
        "log it faster"
    }
}

impl ResamplingError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TooFew { .. } => "too-few-samples",
            Self::TooSlow { .. } => "sampled-too-slowly",
            Self::NoCommonTime { .. } => "no-common-time",
            Self::TooMany(..) => "too-many-samples",
        }
    }
}
