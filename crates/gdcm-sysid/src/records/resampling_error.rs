//! Reasons why channels with separate clocks cannot be resampled to a common clock (M14.11).

/// Why channels cannot be resampled to a common clock.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResamplingError {
    #[error("{topic} has {samples} samples with a time stamp, but at least 3 are needed")]
    TooFew { topic: String, samples: usize },
    /// A channel, or the requested rate, has fewer than 2.5 samples in a period of the highest
    /// line.
    #[error(
        "{topic} is sampled at {rate_hz:.1} Hz, but a band up to {band_end:.3} rad/s needs {needed_hz:.1} Hz: log it faster, or end \
         the band at {possible:.2} rad/s"
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
        "{first} ends at {first_end_s:.1} s, before {second} begins at {second_start_s:.1} s: they come from different flights, or their \
         clocks differ"
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
        "the joined record would have {0:.0} samples: a time stamp is wrong, or the requested rate is too high"
    )]
    TooMany(f64),
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
