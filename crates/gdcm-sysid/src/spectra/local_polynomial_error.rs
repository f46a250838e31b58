//! Reasons why the frequency response cannot be measured.

/// Why the frequency response cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LocalPolynomialError {
    /// No lines, inputs, outputs or frequencies.
    #[error("the records have no {missing}")]
    Nothing {
        /// Missing item, such as "spectral lines".
        missing: &'static str,
    },
    /// A segment has other channel counts than the first; its record index, from 0.
    #[error("record {} differs from the first in its number of channels", .0 + 1)]
    ChannelsDiffer(usize),
    /// A line or a frequency is not finite, or a frequency is not greater than 0.
    #[error("the spectra contain values that are not finite; check the samples and the band")]
    NotFinite,
    /// Fewer lines than first-degree polynomials need.
    #[error(
        "the records have {lines} spectral lines in the band, but {needed} are needed: log \
        longer, or leave out channels"
    )]
    TooFewLines {
        /// Number of spectral lines, over all records with more than two.
        lines: usize,
        needed: usize,
    },
}

impl LocalPolynomialError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Nothing { .. } => "no-spectra",
            Self::ChannelsDiffer(..) => "channels-differ",
            Self::NotFinite => "not-finite",
            Self::TooFewLines { .. } => "too-few-lines",
        }
    }
}
