//! What one model is to be in the dataset.

use std::collections::BTreeMap;

use crate::units::number;

/// The role of a model in its condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RowRole {
    /// The physics model at the condition's own trim.
    Nominal,
    /// A physics model at a perturbed trim.
    Perturbed,
    /// Identified from flight, or measured.
    Identified,
}

impl RowRole {
    /// Every role.
    pub const ALL: [Self; 3] = [Self::Nominal, Self::Perturbed, Self::Identified];

    /// Its word in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Perturbed => "perturbed",
            Self::Identified => "identified",
        }
    }

    /// The role of a word.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.word() == word)
    }
}

/// What one model is to be in the dataset, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Whether it is left out.
    pub left_out: bool,
    /// Number of its condition.
    pub condition: Option<i64>,
    /// Its role.
    pub role: Option<RowRole>,
    /// Its name in its bundle.
    pub name: String,
    /// True airspeed of the condition \[kt\].
    pub airspeed_kt: Option<f64>,
    /// Altitude class.
    pub altitude: Option<String>,
    /// Altitude \[ft\].
    pub altitude_ft: Option<f64>,
    /// Weight class.
    pub weight: Option<String>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
    /// Identification method.
    pub method: Option<String>,
    /// Offsets of the trim, by coordinate ("roll_deg").
    pub perturbation: BTreeMap<String, f64>,
}

impl Row {
    /// "45 kt"; none where it is not said.
    pub fn airspeed_words(&self) -> Option<String> {
        self.airspeed_kt.map(|airspeed| format!("{} kt", number(airspeed)))
    }

    /// "high", or else "2000 ft"; nothing where neither is said.
    pub fn altitude_words(&self) -> String {
        self.altitude.clone().or(self.altitude_ft.map(|feet| format!("{} ft", number(feet)))).unwrap_or_default()
    }

    /// "low", or else "6600 kg"; nothing where neither is said.
    pub fn weight_words(&self) -> String {
        self.weight.clone().or(self.mass_kg.map(|mass| format!("{} kg", number(mass)))).unwrap_or_default()
    }
}
