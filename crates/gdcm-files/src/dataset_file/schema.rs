//! A dataset file, key by key.

use std::collections::BTreeMap;

use serde::de::Deserializer;
use serde::{Deserialize, Serialize};

use crate::json_text::Format;
use crate::json_text::Nested;
use crate::json_text::{Numbers, list, list_while, optional_list};
use gdcm_core::dataset::limits::{
    MOST_CHANNELS, MOST_CONDITIONS, MOST_COORDINATES, MOST_FREQUENCIES, MOST_MODELS, MOST_MODELS_IN_ALL, MOST_PAIRS,
    MOST_PIECES, MOST_RECORDS, MOST_STATES,
};

/// What a dataset file calls itself.
pub(super) const FORMAT: Format = Format { name: "gdcm-dataset", version: 1 };

#[derive(Deserialize, Serialize)]
pub(super) struct DatasetText {
    pub(super) format: String,
    pub(super) version: u64,
    pub(super) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) description: Option<String>,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) inputs: Vec<ChannelText>,
    #[serde(deserialize_with = "list::<MOST_CHANNELS, _, _>")]
    pub(super) outputs: Vec<ChannelText>,
    #[serde(default, deserialize_with = "optional_list::<MOST_PAIRS, _, _>", skip_serializing_if = "Option::is_none")]
    pub(super) on_axis: Option<Vec<(String, String)>>,
    pub(super) frequency_band: BandText,
    #[serde(deserialize_with = "conditions")]
    pub(super) conditions: Vec<ConditionText>,
}

/// Reads conditions as long as they and their models are not too many.
fn conditions<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<ConditionText>, D::Error> {
    let mut models = 0;
    list_while(deserializer, MOST_CONDITIONS, |condition: &ConditionText| {
        models += condition.physics_models.len() + condition.identified_models.len();
        let few = models <= MOST_MODELS_IN_ALL;
        if few { Ok(()) } else { Err(format!("expected at most {MOST_MODELS_IN_ALL} models in all, found more")) }
    })
}

/// Reads the coordinates of a perturbation, or null.
fn coordinates<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<BTreeMap<String, f64>>, D::Error> {
    Ok(Option::<Numbers<MOST_COORDINATES>>::deserialize(deserializer)?.map(|numbers| numbers.0))
}

#[derive(Deserialize, Serialize)]
pub(super) struct ChannelText {
    pub(super) name: String,
    pub(super) unit: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) description: Option<String>,
}

#[derive(Deserialize, Serialize)]
pub(super) struct BandText {
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) unit: String,
}

#[derive(Deserialize, Serialize)]
pub(super) struct ConditionText {
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
    pub(super) physics_models: Vec<PhysicsText>,
    #[serde(deserialize_with = "list::<MOST_MODELS, _, _>")]
    pub(super) identified_models: Vec<IdentifiedText>,
    #[serde(
        default,
        deserialize_with = "optional_list::<MOST_RECORDS, _, _>",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) records: Option<Vec<RecordText>>,
}

/// A flight record.
#[derive(Deserialize, Serialize)]
pub(crate) struct RecordText {
    pub(super) name: String,
    pub(super) file: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) variable: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sha256: Option<String>,
    /// "other" where it is not given.
    pub(super) kind: Option<String>,
    #[serde(default)]
    pub(super) held_out: bool,
    /// True where it is not given.
    pub(super) used: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sample_time_s: Option<f64>,
    #[serde(default, deserialize_with = "optional_list::<MOST_PIECES, _, _>", skip_serializing_if = "Option::is_none")]
    pub(super) used_s: Option<Vec<[f64; 2]>>,
}

/// A physics model. Frequency data are read only to be refused in words.
#[derive(Deserialize, Serialize)]
pub(super) struct PhysicsText {
    pub(super) name: String,
    pub(super) role: String,
    #[serde(default, deserialize_with = "coordinates", skip_serializing_if = "Option::is_none")]
    pub(super) perturbation: Option<BTreeMap<String, f64>>,
    /// Names of the states, for people.
    #[serde(default, deserialize_with = "optional_list::<MOST_STATES, _, _>", skip_serializing_if = "Option::is_none")]
    pub(super) states: Option<Vec<String>>,
    #[serde(rename = "A", skip_serializing_if = "Option::is_none")]
    pub(super) a: Option<Nested<2>>,
    #[serde(rename = "B", skip_serializing_if = "Option::is_none")]
    pub(super) b: Option<Nested<2>>,
    #[serde(rename = "C", skip_serializing_if = "Option::is_none")]
    pub(super) c: Option<Nested<2>>,
    #[serde(rename = "D", skip_serializing_if = "Option::is_none")]
    pub(super) d: Option<Nested<2>>,
    /// Sample time of a model of discrete time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sample_time_s: Option<f64>,
    #[serde(
        default,
        deserialize_with = "optional_list::<MOST_CHANNELS, _, _>",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) input_delays_s: Option<Vec<f64>>,
    #[serde(
        default,
        deserialize_with = "optional_list::<MOST_CHANNELS, _, _>",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) output_delays_s: Option<Vec<f64>>,
    #[serde(default, skip_serializing)]
    pub(super) frequency_response: Option<ResponseText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) source: Option<SourceText>,
}

/// An identified model.
#[derive(Deserialize, Serialize)]
pub(crate) struct IdentifiedText {
    pub(super) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) method: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) order: Option<usize>,
    /// Names of the states, for people.
    #[serde(default, deserialize_with = "optional_list::<MOST_STATES, _, _>", skip_serializing_if = "Option::is_none")]
    pub(super) states: Option<Vec<String>>,
    #[serde(rename = "A", skip_serializing_if = "Option::is_none")]
    pub(super) a: Option<Nested<2>>,
    #[serde(rename = "B", skip_serializing_if = "Option::is_none")]
    pub(super) b: Option<Nested<2>>,
    #[serde(rename = "C", skip_serializing_if = "Option::is_none")]
    pub(super) c: Option<Nested<2>>,
    #[serde(rename = "D", skip_serializing_if = "Option::is_none")]
    pub(super) d: Option<Nested<2>>,
    /// Sample time of a model of discrete time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sample_time_s: Option<f64>,
    #[serde(
        default,
        deserialize_with = "optional_list::<MOST_CHANNELS, _, _>",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) input_delays_s: Option<Vec<f64>>,
    #[serde(
        default,
        deserialize_with = "optional_list::<MOST_CHANNELS, _, _>",
        skip_serializing_if = "Option::is_none"
    )]
    pub(super) output_delays_s: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) frequency_response: Option<ResponseText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) bands: Option<BandsText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) source: Option<SourceText>,
}

/// Which file a model was made from.
#[derive(Deserialize, Serialize)]
pub(super) struct SourceText {
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
    /// Flight records of the condition.
    #[serde(default, deserialize_with = "optional_list::<MOST_PIECES, _, _>", skip_serializing_if = "Option::is_none")]
    pub(super) records: Option<Vec<String>>,
}

/// Standard deviations of a model's response.
#[derive(Deserialize, Serialize)]
pub(super) struct BandsText {
    #[serde(deserialize_with = "list::<MOST_FREQUENCIES, _, _>")]
    pub(super) omega_rad_s: Vec<f64>,
    pub(super) sd_db: Nested<3>,
    pub(super) sd_deg: Nested<3>,
}

/// A measured frequency response.
#[derive(Deserialize, Serialize)]
pub(super) struct ResponseText {
    #[serde(deserialize_with = "list::<MOST_FREQUENCIES, _, _>")]
    pub(super) omega_rad_s: Vec<f64>,
    pub(super) re: Nested<3>,
    pub(super) im: Nested<3>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) coherence: Option<Nested<3>>,
    /// First and last trusted frequency of each response.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) valid_band_rad_s: Option<Nested<3>>,
    /// Number of independent averages of the estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) averages: Option<f64>,
    /// Length of the windows of the estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) window_s: Option<f64>,
}
