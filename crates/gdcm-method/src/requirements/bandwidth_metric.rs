//! A frequency or delay read from a response, such as the bandwidth or the phase delay
//! (`bandwidth`), and the reasons for its absence (M17.1).

use gdcm_model::units::number;

/// How values read above the identified band are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AboveBand {
    /// Returned, and marked as dependent on the model above the band.
    #[default]
    Marked,
    /// Refused: lead filters do not represent the aircraft there (M15).
    Refused,
}

/// A value read from a response, with its uncertainty and the frequency range that determines it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    /// The value: \[rad/s\] or \[s\].
    pub value: f64,
    /// Standard deviation to first order, from the response's own over frequency (M14); `None` if
    /// these do not cover the frequencies needed, or are unavailable.
    pub deviation: Option<f64>,
    /// Lowest and highest frequency \[rad/s\] at which the response determines the value.
    pub read_at: [f64; 2],
    /// Whether the value depends on the model above the identified band.
    pub rests_above_band: bool,
    /// Whether the value depends on the model below the identified band.
    pub rests_below_band: bool,
}

/// Reasons for a missing value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoMetric {
    /// The phase never falls through the level.
    #[error("the phase does not fall through {} deg up to {} rad/s", number(*level_deg), number(*up_to))]
    NoCrossing {
        level_deg: f64,
        /// Highest frequency searched \[rad/s\].
        up_to: f64,
    },
    /// The phase is at or below the level at the lowest band frequency, and does not fall through
    /// the level at any searched frequency.
    #[error("the phase does not fall through {} deg: it is already below this level at {from:.3} \
        rad/s", number(*level_deg))]
    BelowFromStart {
        level_deg: f64,
        /// Lowest band frequency \[rad/s\].
        from: f64,
    },
    /// At no frequency below `omega_180` does the magnitude exceed its value at `omega_180` by 6
    /// dB.
    #[error("the magnitude does not exceed its value at {omega_180:.3} rad/s by 6 dB at any lower \
        frequency, down to {} rad/s", number(*down_to))]
    NoGainCrossing {
        /// Frequency at -180 deg \[rad/s\].
        omega_180: f64,
        /// Lowest frequency searched \[rad/s\].
        down_to: f64,
    },
    /// The response ends before a frequency that the value needs.
    #[error(
        "the response ends below {needed:.3} rad/s, twice the frequency at which the phase is \
        -180 deg"
    )]
    ResponseEnds {
        /// `2 omega_180` \[rad/s\].
        needed: f64,
    },
    /// The value depends on lead filters above the band.
    #[error("the value depends on lead filters above the band: the response is needed up to {needed:.3} rad/s, \
        and the band ends at {} rad/s", number(*top))]
    AboveBand {
        /// Highest frequency that the value needs \[rad/s\].
        needed: f64,
        /// Upper band end, `omega_B` \[rad/s\].
        top: f64,
    },
}

impl NoMetric {
    /// Returns the stable code by which scripts and tests distinguish the reasons.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoCrossing { .. } => "no-phase-crossing",
            Self::BelowFromStart { .. } => "below-from-start",
            Self::NoGainCrossing { .. } => "no-gain-crossing",
            Self::ResponseEnds { .. } => "response-ends",
            Self::AboveBand { .. } => "above-band",
        }
    }
}
