//! Facts about a model or a record, read from its file name.

use std::collections::BTreeMap;

use super::row_role::RowRole;
use crate::dataset::physics_parameter::ParameterChange;

/// Values read from folder, file and variable names; `None` or empty if the names give none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NameFacts {
    pub condition: Option<i64>,
    pub role: Option<RowRole>,
    pub name: String,
    /// True airspeed \[kt\].
    pub airspeed_kt: Option<f64>,
    /// Altitude class: "low", "high".
    pub altitude: Option<String>,
    pub altitude_ft: Option<f64>,
    /// Weight class: "low", "high", "light", "heavy".
    pub weight: Option<String>,
    pub mass_kg: Option<f64>,
    pub method: Option<String>,
    /// Trim offsets by coordinate ("roll_deg").
    pub perturbation: BTreeMap<String, f64>,
    /// Named parameter moved in a physics run ("Ixx+5%").
    pub parameter: Option<ParameterChange>,
}
