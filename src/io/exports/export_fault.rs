//! Why a correction cannot be exported.

/// Why a correction cannot be exported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportFault {
    /// A curve cannot be computed.
    #[error("the {curve} of {channel} has {flaw}; correct it before it is exported")]
    Curve {
        /// The channel.
        channel: String,
        /// "gain" or "delay".
        curve: &'static str,
        /// What is wrong with it.
        flaw: &'static str,
    },
    /// The range of airspeeds is none.
    #[error(
        "the correction has no range of airspeeds: its ends, mean and half range must be finite, and the range positive"
    )]
    Range,
    /// The airspeeds asked for make no table.
    #[error("the airspeeds of the table must be finite, increase, and be at least two")]
    Breakpoints,
}
