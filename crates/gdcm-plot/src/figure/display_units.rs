//! Units in which responses and their deviations are displayed.

use serde::{Deserialize, Serialize};

use gdcm_model::number_format::three_digits;
use gdcm_model::units::{hz_to_rad_s, rad_s_to_hz};

/// Display unit for frequencies; internally they are always in rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FrequencyUnit {
    #[default]
    RadPerSecond,
    Hertz,
}

impl FrequencyUnit {
    /// Returns `rad/s` or `Hz`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::RadPerSecond => "rad/s",
            Self::Hertz => "Hz",
        }
    }

    /// Converts the angular frequency `omega` \[rad/s\] to this unit.
    pub fn of_omega(self, omega: f64) -> f64 {
        match self {
            Self::RadPerSecond => omega,
            Self::Hertz => rad_s_to_hz(omega),
        }
    }

    /// Rounds the angular frequency `omega` \[rad/s\] to three significant digits in this unit. The
    /// number displayed for a dragged limit is then exactly its value.
    pub fn rounded_omega(self, omega: f64) -> f64 {
        let value = self.of_omega(omega);
        let rounded = format!("{value:.2e}").parse().unwrap_or(value);
        match self {
            Self::RadPerSecond => rounded,
            Self::Hertz => hz_to_rad_s(rounded),
        }
    }

    /// Formats the angular frequency `omega` \[rad/s\] with symbol and unit, such as `ω 2.05 rad/s`
    /// and `f 0.326 Hz`.
    pub fn readout(self, omega: f64) -> String {
        let quantity = match self {
            Self::RadPerSecond => "ω",
            Self::Hertz => "f",
        };
        format!(
            "{quantity} {} {}",
            three_digits(self.of_omega(omega)),
            self.symbol()
        )
    }

    /// Returns the axis label `Frequency [rad/s]` or `Frequency [Hz]`.
    pub fn axis_label(self) -> String {
        format!("Frequency [{}]", self.symbol())
    }
}

/// Display unit for response magnitudes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum MagnitudeUnit {
    #[default]
    Decibel,
    /// Output over input, in their own units.
    Ratio,
}

/// Representation of phases \[deg\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseUnit {
    /// Continuous over frequency, without jumps by 360°.
    #[default]
    Unwrapped,
    /// Between −180° and 180°.
    Wrapped,
}

/// Display unit for phase errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseErrorUnit {
    /// Δφ \[deg\].
    #[default]
    Degree,
    /// Δφ/ω \[ms\], the equivalent delay.
    Millisecond,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_reads_in_its_unit() {
        assert_eq!(FrequencyUnit::RadPerSecond.readout(2.0494), "ω 2.05 rad/s");
        assert_eq!(FrequencyUnit::Hertz.readout(2.0494), "f 0.326 Hz");
    }

    #[test]
    fn a_dragged_frequency_has_the_value_that_it_displays() {
        let radians = FrequencyUnit::RadPerSecond.rounded_omega(6.821_857_910_961_336);
        assert_eq!(radians, 6.82);
        let hertz = FrequencyUnit::Hertz.rounded_omega(2.0494);
        assert!((rad_s_to_hz(hertz) - 0.326).abs() < 1e-15);
        assert_eq!(FrequencyUnit::Hertz.readout(hertz), "f 0.326 Hz");
    }
}
