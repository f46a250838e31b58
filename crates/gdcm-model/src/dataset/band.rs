//! The frequency band in which models are compared.

use serde::{Deserialize, Serialize};

use crate::number_format::number;

/// Minimum lower end of a band \[rad/s\]: a period of 17 hours.
pub const LEAST_OMEGA: f64 = 1e-4;
/// Maximum upper end of a band \[rad/s\]: 16 kHz.
pub const GREATEST_OMEGA: f64 = 1e5;

/// A frequency band \[rad/s\], `LEAST_OMEGA <= min < max <= GREATEST_OMEGA` unless created by
/// [`Band::beyond`]. A band beyond these limits is written but not read back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[f64; 2]", into = "[f64; 2]")]
pub struct Band {
    min: f64,
    max: f64,
}

/// Error for a band that is empty, reversed or outside the frequency limits.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the frequency band must be {} <= min < max <= {} (rad/s), found min {}, max {}",
    number(LEAST_OMEGA), number(GREATEST_OMEGA), number(*min), number(*max)
)]
pub struct BandError {
    /// Lower end \[rad/s\], as given.
    pub min: f64,
    /// Upper end \[rad/s\], as given.
    pub max: f64,
}

impl BandError {
    /// Returns the stable code by which scripts and tests distinguish the error.
    pub fn code(&self) -> &'static str {
        "wrong-band"
    }
}

impl TryFrom<[f64; 2]> for Band {
    type Error = BandError;

    fn try_from([min, max]: [f64; 2]) -> Result<Self, BandError> {
        Self::new(min, max)
    }
}

impl From<Band> for [f64; 2] {
    fn from(band: Band) -> Self {
        [band.min, band.max]
    }
}

impl Band {
    /// Creates the band from `min` to `max` \[rad/s\].
    ///
    /// # Errors
    /// [`BandError`] unless `LEAST_OMEGA <= min < max <= GREATEST_OMEGA`.
    pub fn new(min: f64, max: f64) -> Result<Self, BandError> {
        if LEAST_OMEGA <= min && min < max && max <= GREATEST_OMEGA {
            Ok(Self { min, max })
        } else {
            Err(BandError { min, max })
        }
    }

    /// Creates a band that may exceed the frequency limits, such as a plotted range.
    ///
    /// # Errors
    /// [`BandError`] unless `0 < min < max` and `max` is finite; its text states the limits of
    /// [`Band::new`].
    pub fn beyond(min: f64, max: f64) -> Result<Self, BandError> {
        if 0.0 < min && min < max && max.is_finite() {
            Ok(Self { min, max })
        } else {
            Err(BandError { min, max })
        }
    }

    /// Returns the lower end \[rad/s\].
    pub fn min(self) -> f64 {
        self.min
    }

    /// Returns the upper end \[rad/s\].
    pub fn max(self) -> f64 {
        self.max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversed_empty_or_non_positive_band_is_refused() {
        let nan = f64::NAN;
        for (min, max) in [
            (12.0, 0.5),
            (1.0, 1.0),
            (0.0, 1.0),
            (-1.0, 1.0),
            (nan, 1.0),
            (1.0, nan),
            (1.0, 1.1e5),
        ] {
            assert!(Band::new(min, max).is_err(), "{min} .. {max}");
        }
        assert!(Band::new(0.5, 12.0).is_ok() && Band::new(LEAST_OMEGA, GREATEST_OMEGA).is_ok());
        assert!(Band::beyond(1e-300, 1e300).is_ok() && Band::beyond(0.0, 1.0).is_err());
    }
}
