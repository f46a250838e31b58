//! A study file, key by key.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::dataset_file::{ModelText, RecordText};
use crate::json_text::Format;
use crate::json_text::list;
use crate::settings_entry::SettingsEntry;
use gdcm_core::dataset::limits::{MOST_CONDITIONS, MOST_MODELS, MOST_RECORDS};

/// Most variants that a study file may hold.
const MOST_VARIANTS: usize = 1000;

/// What a study file calls itself.
pub(super) const FORMAT: Format = Format { name: "gdcm-study", version: 1 };

#[derive(Deserialize, Serialize)]
pub(super) struct StudyText {
    pub(super) format: String,
    pub(super) version: u64,
    pub(super) software: String,
    pub(super) dataset: DatasetReference,
    pub(super) settings: SettingsEntry,
    #[serde(deserialize_with = "list::<MOST_CONDITIONS, _, _>")]
    pub(super) conditions: Vec<ConditionText>,
    /// Identified models taken in place of the dataset's own; absent where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "list::<MOST_CONDITIONS, _, _>")]
    pub(super) taken: Vec<TakenText>,
    /// Decisions kept under names; absent in studies of older programs.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "list::<MOST_VARIANTS, _, _>")]
    pub(super) variants: Vec<VariantText>,
}

/// Identified models taken into a condition, and the flight records that they are of.
#[derive(Deserialize, Serialize)]
pub(super) struct TakenText {
    pub(super) condition: i64,
    #[serde(deserialize_with = "list::<MOST_MODELS, _, _>")]
    pub(super) identified_models: Vec<ModelText>,
    #[serde(default, deserialize_with = "list::<MOST_RECORDS, _, _>")]
    pub(super) records: Vec<RecordText>,
}

/// Decisions kept under a name.
#[derive(Deserialize, Serialize)]
pub(super) struct VariantText {
    pub(super) name: String,
    pub(super) settings: SettingsEntry,
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

/// The choices in one condition.
#[derive(Deserialize, Serialize)]
pub(super) struct ConditionText {
    pub(super) id: i64,
    pub(super) physics: BundleText,
    pub(super) identified: BundleText,
    pub(super) scheduled: bool,
    /// Whether it is held out; absent in studies of older programs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) held_out: bool,
}

/// The choices in one bundle, by model name.
#[derive(Deserialize, Serialize)]
pub(super) struct BundleText {
    #[serde(deserialize_with = "list::<MOST_MODELS, _, _>")]
    pub(super) rejected: Vec<String>,
    /// Why, by model name; absent in studies of older programs.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) reasons: BTreeMap<String, String>,
    pub(super) pinned: Option<String>,
}
