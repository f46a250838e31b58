//! A model's place in the dataset, shown as a row in the model table.

use std::collections::BTreeMap;

use crate::dataset::physics_parameter::ParameterChange;
use crate::names::RowRole;
use crate::number_format::number;

/// A model's place in the dataset; `None` for an unknown value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    pub left_out: bool,
    pub condition: Option<i64>,
    pub role: Option<RowRole>,
    /// Model name, unique in its bundle except for measured responses that form a single model.
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
    /// Named parameter moved in a physics run (M18.1).
    pub parameter: Option<ParameterChange>,
    /// Parts of the file or variable name that look like a trim offset but match no pattern.
    pub unread: Vec<String>,
    pub contradictions: Vec<NameContradiction>,
}

/// A value in a file that contradicts the file and folder names.
#[derive(Clone, Debug, PartialEq)]
pub struct NameContradiction {
    /// The quantity's key in the rules: "airspeed_kt", or "perturbation, roll_deg" for a trim
    /// offset.
    pub field: String,
    pub of_file: f64,
    pub of_name: f64,
}

impl Row {
    /// Formats the airspeed: "45 kt"; `None` if unknown.
    pub fn airspeed_words(&self) -> Option<String> {
        let airspeed_kt = self.airspeed_kt?;
        Some(format!("{} kt", number(airspeed_kt)))
    }

    /// Formats the altitude: the class ("high"), or else the value ("2000 ft"); empty if unknown.
    pub fn altitude_words(&self) -> String {
        class_or_number(self.altitude.as_deref(), self.altitude_ft, "ft")
    }

    /// Formats the weight: the class ("low"), or else the mass ("6600 kg"); empty if unknown.
    pub fn weight_words(&self) -> String {
        class_or_number(self.weight.as_deref(), self.mass_kg, "kg")
    }
}

fn class_or_number(class: Option<&str>, value: Option<f64>, unit: &str) -> String {
    match (class, value) {
        (Some(class), _) => class.to_owned(),
        (None, Some(value)) => format!("{} {unit}", number(value)),
        (None, None) => String::new(),
    }
}
