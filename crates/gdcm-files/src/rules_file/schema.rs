//! A rules file, key by key.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::json_text::Format;
use crate::list::list;
use gdcm_core::assembly::standard_patterns;
use gdcm_core::dataset::limits::{MOST_CHANNELS, MOST_PAIRS};

/// What a rules file calls itself.
pub(super) const FORMAT: Format = Format { name: "gdcm-rules", version: 1 };

/// Most patterns, and conversions, of a rules file.
const MOST_PATTERNS: usize = 200;

#[derive(Deserialize, Serialize)]
pub(super) struct RulesText {
    pub(super) format: String,
    pub(super) version: u64,
    pub(super) name: String,
    #[serde(default)]
    pub(super) description: String,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) inputs: Vec<ChannelText>,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) outputs: Vec<ChannelText>,
    #[serde(default, deserialize_with = "list::<MOST_PAIRS, _, _>")]
    pub(super) on_axis: Vec<(String, String)>,
    pub(super) band_rad_s: [f64; 2],
    #[serde(default, deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(super) conversions: Vec<UnitText>,
    #[serde(default = "standard", deserialize_with = "list::<MOST_PATTERNS, _, _>")]
    pub(super) patterns: Vec<String>,
    /// What the columns of tables hold, by file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) headings: BTreeMap<String, Vec<String>>,
    /// What is said of single models, by file and variable.
    #[serde(default)]
    pub(super) models: BTreeMap<String, RowText>,
}

/// The patterns of a file that names none.
fn standard() -> Vec<String> {
    standard_patterns().iter().map(|pattern| pattern.as_str().to_owned()).collect()
}

#[derive(Deserialize, Serialize)]
pub(super) struct ChannelText {
    pub(super) name: String,
    #[serde(default)]
    pub(super) unit: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) aliases: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) unit_in_files: Option<String>,
}

#[derive(Deserialize, Serialize)]
pub(super) struct UnitText {
    pub(super) channel: String,
    pub(super) from: String,
    pub(super) factor: f64,
}

#[derive(Default, Deserialize, Serialize)]
#[serde(default)]
pub(super) struct RowText {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) left_out: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) condition: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) role: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) airspeed_kt: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) altitude: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) altitude_ft: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) weight: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mass_kg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) method: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) perturbation: Option<BTreeMap<String, f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) inputs: Option<Vec<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) outputs: Option<Vec<String>>,
}
