//! A study file, key by key.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::dataset::limits::{MOST_CONDITIONS, MOST_MODELS, MOST_PAIRS};
use crate::io::json_text::Format;
use crate::io::list::list;
use crate::schedule::DEFAULT_TOLERANCE_KT;

/// What a study file calls itself.
pub(super) const FORMAT: Format = Format { name: "gdcm-study", version: 1 };

#[derive(Deserialize, Serialize)]
pub(super) struct StudyText {
    pub(super) format: String,
    pub(super) version: u64,
    pub(super) software: String,
    pub(super) dataset: DatasetReference,
    pub(super) settings: SettingsText,
    #[serde(deserialize_with = "list::<MOST_CONDITIONS, _, _>")]
    pub(super) conditions: Vec<ConditionText>,
}

/// Which dataset a study is about.
#[derive(Deserialize, Serialize)]
pub(super) struct DatasetReference {
    /// Path relative to the study's directory, with `/` between its parts; `None` for the embedded example.
    pub(super) path: Option<String>,
    /// The dataset's name, for people; "embedded example" for the embedded example.
    pub(super) name: String,
    pub(super) sha256: String,
    /// What it held; absent in studies of older programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) holds: Option<Vec<ConditionInventoryText>>,
}

/// What one condition held: each model's name and fingerprint.
#[derive(Deserialize, Serialize)]
pub(super) struct ConditionInventoryText {
    pub(super) id: i64,
    pub(super) airspeed_kt: f64,
    pub(super) physics: BTreeMap<String, String>,
    pub(super) identified: BTreeMap<String, String>,
}

#[derive(Deserialize, Serialize)]
pub(super) struct SettingsText {
    pub(super) band_rad_s: [f64; 2],
    pub(super) points: usize,
    pub(super) cost_average: AverageText,
    pub(super) alpha_gain: f64,
    pub(super) alpha_delay: f64,
    pub(super) gain_objective: ObjectiveText,
    /// Pairs `[output, input]` to be held.
    #[serde(deserialize_with = "list::<MOST_PAIRS, _, _>")]
    pub(super) constrained: Vec<(String, String)>,
    /// Pairs `[output, input]` that the objective ignores.
    #[serde(deserialize_with = "list::<MOST_PAIRS, _, _>")]
    pub(super) ignored: Vec<(String, String)>,
    pub(super) quantile: f64,
    pub(super) gain_bounds: Option<[f64; 2]>,
    pub(super) delay_upper_s: Option<f64>,
    pub(super) schedule: ScheduleText,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
pub(super) enum AverageText {
    #[serde(rename = "median")]
    Median,
    #[serde(rename = "mean")]
    Mean,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
pub(super) enum ObjectiveText {
    #[serde(rename = "ratio")]
    Ratio,
    #[serde(rename = "dB")]
    Decibel,
}

#[derive(Deserialize, Serialize)]
pub(super) struct ScheduleText {
    pub(super) kind: KindText,
    /// Degree of the polynomial; `None` for a table.
    pub(super) degree: Option<usize>,
    pub(super) of: QuantityText,
    pub(super) delays: bool,
    #[serde(default = "default_tolerance_kt")]
    pub(super) airspeed_tolerance_kt: f64,
}

fn default_tolerance_kt() -> f64 {
    DEFAULT_TOLERANCE_KT
}

#[derive(Clone, Copy, Deserialize, Serialize)]
pub(super) enum KindText {
    #[serde(rename = "polynomial")]
    Polynomial,
    #[serde(rename = "table")]
    Table,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
pub(super) enum QuantityText {
    #[serde(rename = "ln k")]
    LnGain,
    #[serde(rename = "k")]
    Gain,
}

/// The choices in one condition.
#[derive(Deserialize, Serialize)]
pub(super) struct ConditionText {
    pub(super) id: i64,
    pub(super) physics: BundleText,
    pub(super) identified: BundleText,
    pub(super) scheduled: bool,
}

/// The choices in one bundle, by model name.
#[derive(Deserialize, Serialize)]
pub(super) struct BundleText {
    #[serde(deserialize_with = "list::<MOST_MODELS, _, _>")]
    pub(super) rejected: Vec<String>,
    pub(super) pinned: Option<String>,
}
