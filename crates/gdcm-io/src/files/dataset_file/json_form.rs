//! JSON objects in a dataset file.
//!
//! Types named `…Text` have the file's keys; `conversion` and `model_conversion` turn them into
//! drafts, which are then checked. Lists have limits (`MOST_…`), beyond which reading ends. A *run*
//! is a physics model with a single named parameter moved, a *rerun* one with several moved
//! together (M18).

use std::collections::BTreeMap;

use serde::de::Deserializer;
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::dataset::limits::{
    MOST_CHANNELS, MOST_CONDITIONS, MOST_COORDINATES, MOST_FREQUENCIES, MOST_MODELS,
    MOST_MODELS_IN_ALL, MOST_PAIRS, MOST_PARAMETERS, MOST_PIECES, MOST_RECORDS, MOST_STATES,
};
use gdcm_model::whole_number::{whole, whole_or_none};

use crate::json_reading::{Format, Limited, Nested, Numbers, list, list_while};

pub(super) const FORMAT: Format = Format {
    name: "gdcm-dataset",
    version: 1,
};

#[derive(Deserialize, Serialize)]
pub(super) struct DatasetText {
    pub(super) format: String,
    #[serde(deserialize_with = "whole")]
    pub(super) version: u64,
    pub(super) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) description: Option<String>,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) inputs: Vec<ChannelText>,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) outputs: Vec<ChannelText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) on_axis: Option<Limited<(String, String), MOST_PAIRS>>,
    pub(super) frequency_band: FrequencyBandText,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) parameters: Option<Limited<ParameterText, MOST_PARAMETERS>>,
    #[serde(deserialize_with = "conditions")]
    pub(super) conditions: Vec<ConditionText>,
}

/// Reads the conditions; their number and the total number of models are limited.
fn conditions<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<ConditionText>, D::Error> {
    let mut models = 0;
    list_while(
        deserializer,
        MOST_CONDITIONS,
        |condition: &ConditionText| {
            models += condition.physics_models.len() + condition.identified_models.len();
            if models > MOST_MODELS_IN_ALL {
                return Err(format!(
                    "expected at most {MOST_MODELS_IN_ALL} models in total, found more"
                ));
            }
            Ok(())
        },
    )
}

/// Reads a perturbation's coordinates, or null.
fn coordinates<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<BTreeMap<String, f64>>, D::Error> {
    let numbers = Option::<Numbers<MOST_COORDINATES>>::deserialize(deserializer)?;
    Ok(numbers.map(|numbers| numbers.0))
}

#[derive(Deserialize, Serialize)]
pub(super) struct ChannelText {
    pub(super) name: String,
    pub(super) unit: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) description: Option<String>,
}

#[derive(Deserialize, Serialize)]
pub(super) struct FrequencyBandText {
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) unit: String,
}

/// A named parameter of the physics models.
#[derive(Deserialize, Serialize)]
pub(super) struct ParameterText {
    pub(super) name: String,
    pub(super) unit: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) plausible_sd: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) description: Option<String>,
}

/// Change to a named parameter in a physics model.
#[derive(Clone, Deserialize, Serialize)]
pub(crate) struct ParameterChangeText {
    pub(super) name: String,
    pub(super) delta: f64,
    pub(super) unit: String,
}

#[derive(Deserialize, Serialize)]
pub(super) struct ConditionText {
    #[serde(deserialize_with = "whole")]
    pub(super) id: i64,
    pub(super) name: String,
    pub(super) airspeed_kt: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) altitude: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) altitude_ft: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) weight: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mass_kg: Option<f64>,
    #[serde(deserialize_with = "list::<MOST_MODELS, _, _>")]
    pub(super) physics_models: Vec<ModelText>,
    #[serde(default, deserialize_with = "list::<MOST_MODELS, _, _>")]
    pub(super) identified_models: Vec<ModelText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) records: Option<Limited<RecordText, MOST_RECORDS>>,
}

#[derive(Deserialize, Serialize)]
pub(crate) struct RecordText {
    pub(super) name: String,
    pub(super) file: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) variable: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sha256: Option<String>,
    /// "other" if the key is missing.
    pub(super) kind: Option<String>,
    #[serde(default)]
    pub(super) held_out: bool,
    /// True if the key is missing.
    pub(super) used: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sample_time_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) used_s: Option<Limited<[f64; 2], MOST_PIECES>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) part_s: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) remedies: BTreeMap<String, ChannelRemedy>,
}

/// A model in a dataset, in a model file (`gdcm-models`) or in a file with identified models
/// (`gdcm-identified`).
#[derive(Default, Deserialize, Serialize)]
pub(crate) struct ModelText {
    pub(crate) name: String,
    /// Only for physics models and, outside a dataset, for identified models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) role: Option<String>,
    #[serde(
        default,
        deserialize_with = "coordinates",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) perturbation: Option<BTreeMap<String, f64>>,
    /// The parameter moved in a run; only for physics models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) parameter: Option<ParameterChangeText>,
    /// The parameters moved in a rerun; only for physics models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) parameters: Option<Limited<ParameterChangeText, MOST_PARAMETERS>>,
    /// Only for identified models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) method: Option<String>,
    #[serde(
        default,
        deserialize_with = "whole_or_none",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) order: Option<usize>,
    /// Flight condition id; only outside a dataset.
    #[serde(
        default,
        deserialize_with = "whole_or_none",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) condition: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) airspeed_kt: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) altitude_ft: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) mass_kg: Option<f64>,
    /// Channel names; only outside a dataset. Unknown names are empty strings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) inputs: Option<Limited<LabelText, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) outputs: Option<Limited<LabelText, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) input_units: Option<Limited<String, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) output_units: Option<Limited<String, MOST_CHANNELS>>,
    /// State names; they affect no result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) states: Option<Limited<String, MOST_STATES>>,
    #[serde(rename = "A", skip_serializing_if = "Option::is_none")]
    pub(crate) a: Option<Nested<2>>,
    #[serde(rename = "B", skip_serializing_if = "Option::is_none")]
    pub(crate) b: Option<Nested<2>>,
    #[serde(rename = "C", skip_serializing_if = "Option::is_none")]
    pub(crate) c: Option<Nested<2>>,
    #[serde(rename = "D", skip_serializing_if = "Option::is_none")]
    pub(crate) d: Option<Nested<2>>,
    /// Sample time \[s\]; only in discrete time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sample_time_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) input_delays_s: Option<Limited<f64, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) output_delays_s: Option<Limited<f64, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) frequency_response: Option<ResponseText>,
    /// Standard deviations of the response; only for identified models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) bands: Option<DeviationsText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<SourceText>,
    /// Notes on how the model was read; only outside a dataset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) notes: Option<Limited<String, MOST_PIECES>>,
    /// Whether the identification that produced the model recommends it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) recommended: Option<bool>,
}

/// A channel outside a dataset: its name, or an object as in a dataset.
#[derive(Clone, Deserialize, Serialize)]
#[serde(untagged)]
pub(crate) enum LabelText {
    Name(String),
    Channel {
        name: String,
        #[serde(default)]
        unit: Option<String>,
    },
}

impl LabelText {
    /// Returns the name, and the unit if it is given.
    pub(crate) fn into_parts(self) -> (String, Option<String>) {
        match self {
            Self::Name(name) => (name, None),
            Self::Channel { name, unit } => (name, unit),
        }
    }
}

/// A model's provenance: file, variable, date and notes.
#[derive(Default, Deserialize, Serialize)]
pub(crate) struct SourceText {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sha256: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) variable: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) made: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) note: Option<String>,
    /// Names of the flight records from which an identified model was estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) records: Option<Limited<String, MOST_PIECES>>,
    /// Variables in the file that were not used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) unused: Option<Limited<String, MOST_PIECES>>,
    /// Channel lists (inputs, outputs) that were assigned to the dataset's channels by position
    /// instead of by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) by_position: Option<Limited<SideText, 2>>,
}

/// One of a model's two channel lists.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SideText {
    Inputs,
    Outputs,
}

/// Standard deviations of a model's response, outputs x inputs x frequencies.
#[derive(Deserialize, Serialize)]
pub(crate) struct DeviationsText {
    #[serde(deserialize_with = "list::<MOST_FREQUENCIES, _, _>")]
    pub(super) omega_rad_s: Vec<f64>,
    pub(super) sd_db: Nested<3>,
    pub(super) sd_deg: Nested<3>,
}

/// A measured frequency response.
#[derive(Deserialize, Serialize)]
pub(crate) struct ResponseText {
    #[serde(deserialize_with = "list::<MOST_FREQUENCIES, _, _>")]
    pub(super) omega_rad_s: Vec<f64>,
    pub(crate) re: Nested<3>,
    pub(super) im: Nested<3>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) coherence: Option<Nested<3>>,
    /// First and last trusted frequency \[rad/s\] for each response; both 0 if none is trusted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) valid_band_rad_s: Option<Nested<3>>,
    /// Number of independent averages in the estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) averages: Option<f64>,
    /// Window length used for the estimate \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) window_s: Option<f64>,
}
