//! A condition's name and flight state.

use super::model_id::ConditionId;
use crate::number_format::number;

/// A condition's identifier, name, airspeed, altitude and weight.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightState {
    pub id: ConditionId,
    pub name: String,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Altitude class ("low", "high").
    pub altitude: Option<String>,
    pub altitude_ft: Option<f64>,
    /// Weight class ("low", "high").
    pub weight: Option<String>,
    pub mass_kg: Option<f64>,
}

impl FlightState {
    /// Creates a condition's flight state with only an airspeed \[kt\], named after its identifier.
    pub fn at(id: ConditionId, airspeed_kt: f64) -> Self {
        let name = format!("condition {id}");
        Self {
            id,
            name,
            airspeed_kt,
            altitude: None,
            altitude_ft: None,
            weight: None,
            mass_kg: None,
        }
    }

    /// Checks that all values are finite, and that airspeed and mass are not negative.
    pub(super) fn check(&self) -> Result<(), FlightStateError> {
        check_not_negative("airspeed [kt]", Some(self.airspeed_kt))?;
        check_finite("altitude [ft]", self.altitude_ft)?;
        check_not_negative("mass [kg]", self.mass_kg)
    }
}

/// Error for a value that is not finite, or for a negative airspeed or mass.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{field}: expected a finite number{bound}, found {}", number(*value))]
pub struct FlightStateError {
    /// Quantity and unit.
    pub field: &'static str,
    /// " not below zero" if negative values are not permitted, otherwise empty.
    pub bound: &'static str,
    pub value: f64,
}

fn check_finite(field: &'static str, value: Option<f64>) -> Result<(), FlightStateError> {
    match value {
        Some(value) if !value.is_finite() => Err(FlightStateError {
            field,
            bound: "",
            value,
        }),
        _ => Ok(()),
    }
}

fn check_not_negative(field: &'static str, value: Option<f64>) -> Result<(), FlightStateError> {
    match value {
        Some(value) if !value.is_finite() || value < 0.0 => Err(FlightStateError {
            field,
            bound: " not below zero",
            value,
        }),
        _ => Ok(()),
    }
}
