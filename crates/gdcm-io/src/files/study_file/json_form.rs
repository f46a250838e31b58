//! JSON objects in a study file.
//!
//! Types named `…Text` have the file's keys; `conversion` turns them into decisions. Lists have
//! limits, beyond which reading ends.

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::limits::{MOST_CHANNELS, MOST_CONDITIONS, MOST_MODELS, MOST_RECORDS};
use gdcm_model::whole_number::whole;
use gdcm_study::decisions::choices::BundleChoice;
use gdcm_study::decisions::dataset_differences::Inventory;
use gdcm_study::decisions::requirement_settings::RequirementSettings;
use gdcm_study::decisions::settings::{ResponseNames, Settings};
use gdcm_study::decisions::signs::ReversedChannel;

use crate::files::dataset_file::{ModelText, RecordText};
use crate::json_reading::{Format, list};

/// Maximum number of export format names in a study file.
const MOST_FORMATS: usize = 100;
/// Maximum number of airspeeds for an exported table in a study file.
const MOST_BREAKPOINTS: usize = 1000;
/// Maximum number of variants in a study file.
pub(crate) const MOST_VARIANTS: usize = 1000;

pub(super) const FORMAT: Format = Format {
    name: "gdcm-study",
    version: 1,
};

#[derive(Deserialize, Serialize)]
pub(super) struct StudyText {
    pub(super) format: String,
    #[serde(deserialize_with = "whole")]
    pub(super) version: u64,
    pub(super) software: String,
    pub(super) dataset: DatasetReference,
    pub(super) settings: Settings<ResponseNames>,
    #[serde(deserialize_with = "list::<MOST_CONDITIONS, _, _>")]
    pub(super) conditions: Vec<ConditionText>,
    /// Identified models that replace the dataset's.
    #[serde(
        rename = "taken",
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_CONDITIONS, _, _>"
    )]
    pub(super) adopted: Vec<AdoptedText>,
    /// Channels whose sign is reversed (*turned*) in some models.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_CHANNELS, _, _>"
    )]
    pub(super) signs: Vec<ReversedChannel>,
    /// Decisions about the requirements; omitted if they are the defaults.
    #[serde(default, skip_serializing_if = "is_default")]
    pub(super) requirements: RequirementSettings,
    /// Choices for the last export; absent in older studies, and omitted if they are the defaults.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) export: Option<ExportText>,
    /// Named alternatives to the decisions; absent in older studies.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_VARIANTS, _, _>"
    )]
    pub(super) variants: Vec<VariantText>,
}

/// Identified models adopted in a condition, and their flight records.
#[derive(Deserialize, Serialize)]
pub(super) struct AdoptedText {
    #[serde(deserialize_with = "whole")]
    pub(super) condition: i64,
    #[serde(deserialize_with = "list::<MOST_MODELS, _, _>")]
    pub(super) identified_models: Vec<ModelText>,
    #[serde(default, deserialize_with = "list::<MOST_RECORDS, _, _>")]
    pub(super) records: Vec<RecordText>,
}

/// Choices for the last export.
#[derive(Deserialize, Serialize)]
pub(super) struct ExportText {
    /// Format names; unknown names are ignored.
    #[serde(deserialize_with = "list::<MOST_FORMATS, _, _>")]
    pub(super) formats: Vec<String>,
    /// Exported conditions; omitted if all are.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_CONDITIONS, _, _>"
    )]
    pub(super) conditions: Vec<ConditionId>,
    /// Whether corrected models get their condition's own correction, not the schedule.
    pub(super) per_condition: bool,
    /// Physics model for each condition: "nominal", "representative", or a model name.
    pub(super) model: String,
    /// Airspeeds \[kt\] for lookup tables; omitted if they are the conditions' airspeeds.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "list::<MOST_BREAKPOINTS, _, _>"
    )]
    pub(super) breakpoints_kt: Vec<f64>,
    #[serde(deserialize_with = "whole")]
    pub(super) pade_order: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) folder: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) prefix: Option<String>,
    /// Whether existing files are replaced; otherwise the new files get a number.
    pub(super) replaces: bool,
}

/// A named alternative to the decisions.
#[derive(Deserialize, Serialize)]
pub(super) struct VariantText {
    pub(super) name: String,
    pub(super) settings: Settings<ResponseNames>,
    #[serde(deserialize_with = "list::<MOST_CONDITIONS, _, _>")]
    pub(super) conditions: Vec<ConditionText>,
}

/// A study's reference to its dataset.
#[derive(Clone, Deserialize, Serialize)]
pub(super) struct DatasetReference {
    /// Path relative to the study's directory, with `/` between its parts; `None` for an embedded
    /// example.
    pub(super) path: Option<String>,
    /// Dataset name, for display; without a path, the embedded example's name.
    pub(super) name: String,
    pub(super) sha256: String,
    /// Summary of the dataset's contents, used to find changes; absent in older studies.
    #[serde(rename = "holds", default, skip_serializing_if = "Option::is_none")]
    pub(super) inventory: Option<Inventory>,
}

/// Decisions about a condition.
#[derive(Deserialize, Serialize)]
pub(super) struct ConditionText {
    #[serde(deserialize_with = "whole")]
    pub(super) id: i64,
    pub(super) physics: BundleChoice,
    pub(super) identified: BundleChoice,
    pub(super) scheduled: bool,
    /// Whether the condition is held out for validation; absent in older studies.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) held_out: bool,
}

fn is_default(settings: &RequirementSettings) -> bool {
    *settings == RequirementSettings::default()
}
