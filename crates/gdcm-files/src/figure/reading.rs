//! In which units responses are read, and how their phases are drawn.

use serde::{Deserialize, Serialize};

use gdcm_core::units::rad_s_to_hz;

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
