//! Variables besides airspeed: altitude and mass (M13.7).

use std::fmt;

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::condition::FlightState;

/// A variable besides airspeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SecondVariable {
    /// Altitude \[ft\].
    Altitude,
    /// Mass \[kg\].
    Mass,
}

impl SecondVariable {
    /// Both variables, in display order.
    pub const BOTH: [Self; 2] = [Self::Altitude, Self::Mass];

    /// Returns "altitude" or "mass".
    pub fn name(self) -> &'static str {
        match self {
            Self::Altitude => "altitude",
            Self::Mass => "mass",
        }
    }

    /// Returns "ft" or "kg".
    pub fn unit(self) -> &'static str {
        match self {
            Self::Altitude => "ft",
            Self::Mass => "kg",
        }
    }

    /// Returns a condition's altitude \[ft\] or mass \[kg\].
    pub fn value(self, state: &FlightState) -> Option<f64> {
        match self {
            Self::Altitude => state.altitude_ft,
            Self::Mass => state.mass_kg,
        }
    }

    /// Returns a condition's altitude or weight class ("low", "high"), if it has one.
    fn label(self, state: &FlightState) -> Option<&str> {
        match self {
            Self::Altitude => state.altitude.as_deref(),
            Self::Mass => state.weight.as_deref(),
        }
    }

    /// Returns a value for each condition: its altitude or mass if all conditions give it,
    /// otherwise -1 or 1 by its label. `None` if a label is missing, or if there are not exactly
    /// two different labels.
    pub fn values(self, states: &[&FlightState]) -> Option<Vec<f64>> {
        let numbers: Option<Vec<f64>> = states.iter().map(|state| self.value(state)).collect();
        if numbers.is_some() {
            return numbers;
        }
        let labels: Option<Vec<&str>> = states.iter().map(|state| self.label(state)).collect();
        signs_of_labels(&labels?)
    }
}

/// Returns -1 for the first and 1 for the second label, in alphabetical order; `None` unless there
/// are exactly two different labels.
fn signs_of_labels(labels: &[&str]) -> Option<Vec<f64>> {
    let mut distinct = labels.to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    if distinct.len() != 2 {
        return None;
    }
    let signs = labels
        .iter()
        .map(|label| if *label == distinct[0] { -1.0 } else { 1.0 })
        .collect();
    Some(signs)
}

impl fmt::Display for SecondVariable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
