//! The units that frequencies, magnitudes and phases are shown in.

use gdcm_core::units::rad_s_to_hz;
use serde::{Deserialize, Serialize};

/// The unit frequencies are shown in; inside they are always rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FrequencyUnit {
    /// Angular frequency.
    #[default]
    RadPerSecond,
    /// Cycles per second.
    Hertz,
}

impl FrequencyUnit {
    /// The symbol of the unit.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::RadPerSecond => "rad/s",
            Self::Hertz => "Hz",
        }
    }

    /// The angular frequency `omega` \[rad/s\] in this unit.
    pub fn of_omega(self, omega: f64) -> f64 {
        match self {
            Self::RadPerSecond => omega,
            Self::Hertz => rad_s_to_hz(omega),
        }
    }

    /// An angular frequency as a reader wants it: "ω 2.05 rad/s" or "f 0.326 Hz".
    pub fn readout(self, omega: f64) -> String {
        let quantity = match self {
            Self::RadPerSecond => "ω",
            Self::Hertz => "f",
        };
        format!("{quantity} {} {}", three_digits(self.of_omega(omega)), self.symbol())
    }

    /// What stands beside the axis.
    pub fn axis_label(self) -> String {
        format!("Frequency [{}]", self.symbol())
    }
}

/// How the magnitude of a response is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum MagnitudeUnit {
    /// Decibels.
    #[default]
    Decibel,
    /// The ratio of output to input, in their units.
    Ratio,
}

/// How the phase of a response is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseUnit {
    /// Continuous over frequency (M2).
    #[default]
    Unwrapped,
    /// Between −180° and 180°.
    Wrapped,
}

/// How a difference of phases is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PhaseErrorUnit {
    /// Δφ.
    #[default]
    Degree,
    /// Δφ/ω: the delay that would make up for it.
    Millisecond,
}

/// Three significant digits.
fn three_digits(value: f64) -> String {
    let decimals = if value.abs() >= 100.0 {
        0
    } else if value.abs() >= 10.0 {
        1
    } else if value.abs() >= 1.0 {
        2
    } else {
        3
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_reads_in_its_unit() {
        assert_eq!(FrequencyUnit::RadPerSecond.readout(2.0494), "ω 2.05 rad/s");
        assert_eq!(FrequencyUnit::Hertz.readout(2.0494), "f 0.326 Hz");
    }
}
