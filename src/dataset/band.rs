//! The frequency band over which models are compared.

/// A frequency band \[rad/s\], `0 < min < max`, both finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    min: f64,
    max: f64,
}

/// A band that is not `0 < min < max` with finite ends.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the frequency band must be 0 < min < max (rad/s), found min {min}, max {max}")]
pub struct BandError {
    /// The lower end given \[rad/s\].
    pub min: f64,
    /// The upper end given \[rad/s\].
    pub max: f64,
}

impl Band {
    /// The band from `min` to `max` \[rad/s\].
    pub fn new(min: f64, max: f64) -> Result<Self, BandError> {
        if min.is_finite() && max.is_finite() && 0.0 < min && min < max {
            Ok(Self { min, max })
        } else {
            Err(BandError { min, max })
        }
    }

    /// Lower end \[rad/s\].
    pub fn min(self) -> f64 {
        self.min
    }

    /// Upper end \[rad/s\].
    pub fn max(self) -> f64 {
        self.max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversed_empty_or_non_positive_band_is_refused() {
        for (min, max) in [(12.0, 0.5), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
            assert!(Band::new(min, max).is_err(), "{min} .. {max}");
        }
        assert!(Band::new(0.5, 12.0).is_ok());
    }
}
