//! A dataset file, key by key, and its conversion to drafts and from checked datasets.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use serde::de::Deserializer;
use serde::{Deserialize, Serialize};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ChannelRemedy, ConditionRecord, FlightState, RecordKind};
use gdcm_model::dataset::limits::{
    MOST_CHANNELS, MOST_CONDITIONS, MOST_COORDINATES, MOST_FREQUENCIES, MOST_MODELS,
    MOST_MODELS_IN_ALL, MOST_PAIRS, MOST_PIECES, MOST_RECORDS, MOST_STATES,
};
use gdcm_model::dataset::location::Location;
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::unchecked_dataset::{
    BandsDraft, ConditionDraft, DatasetDraft, ModelDraft, ResponseArray, ResponseDraft,
};
use gdcm_model::dataset::{BundleKind, Channel, Condition, ConditionId, Dataset, Model};
use gdcm_model::whole_number::{whole, whole_or_none};

use crate::file_error::{ContentError, ContentFault};
use crate::json_text::{Format, Limited, Nested, Numbers, list, list_while};

/// Format and version of a dataset file.
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
    pub(super) frequency_band: BandText,
    #[serde(deserialize_with = "conditions")]
    pub(super) conditions: Vec<ConditionText>,
}

/// Reads conditions up to the limits on their number and on their models.
fn conditions<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<ConditionText>, D::Error> {
    let mut models = 0;
    list_while(
        deserializer,
        MOST_CONDITIONS,
        |condition: &ConditionText| {
            models += condition.physics_models.len() + condition.identified_models.len();
            let few = models <= MOST_MODELS_IN_ALL;
            if few {
                Ok(())
            } else {
                Err(format!(
                    "expected at most {MOST_MODELS_IN_ALL} models in all, found more"
                ))
            }
        },
    )
}

/// Reads the coordinates of a perturbation, or null.
fn coordinates<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<BTreeMap<String, f64>>, D::Error> {
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

/// A flight record.
#[derive(Deserialize, Serialize)]
pub(crate) struct RecordText {
    pub(super) name: String,
    pub(super) file: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) variable: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sha256: Option<String>,
    /// "other" if absent.
    pub(super) kind: Option<String>,
    #[serde(default)]
    pub(super) held_out: bool,
    /// True if absent.
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

/// A model of a dataset, of any model file (`gdcm-models`) or of identified models
/// (`gdcm-identified`).
#[derive(Default, Deserialize, Serialize)]
pub(crate) struct ModelText {
    pub(crate) name: String,
    /// Physics models only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) role: Option<String>,
    #[serde(
        default,
        deserialize_with = "coordinates",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) perturbation: Option<BTreeMap<String, f64>>,
    /// Identified models only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) method: Option<String>,
    #[serde(
        default,
        deserialize_with = "whole_or_none",
        skip_serializing_if = "Option::is_none"
    )]
    pub(crate) order: Option<usize>,
    /// Flight condition of a model outside a dataset, according to its file.
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
    /// Names of the channels of a model outside a dataset; empty if its file has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) inputs: Option<Limited<LabelText, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) outputs: Option<Limited<LabelText, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) input_units: Option<Limited<String, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) output_units: Option<Limited<String, MOST_CHANNELS>>,
    /// Names of the states, for people.
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
    /// Sample time of a discrete-time model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sample_time_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) input_delays_s: Option<Limited<f64, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) output_delays_s: Option<Limited<f64, MOST_CHANNELS>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) frequency_response: Option<ResponseText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) bands: Option<BandsText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<SourceText>,
    /// Notes from reading a model outside a dataset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) notes: Option<Limited<String, MOST_PIECES>>,
    /// Whether identification recommends the model, if it produced it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) recommended: Option<bool>,
}

/// A channel of a model outside a dataset: its name, or an object like a channel of a dataset.
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
    /// Returns the name and the unit.
    pub(crate) fn into_parts(self) -> (String, Option<String>) {
        match self {
            Self::Name(name) => (name, None),
            Self::Channel { name, unit } => (name, unit),
        }
    }
}

/// Source file of a model.
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
    /// Flight records of the condition.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) records: Option<Limited<String, MOST_PIECES>>,
    /// Unused variables of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) unused: Option<Limited<String, MOST_PIECES>>,
    /// The sides with channels assigned by position: "inputs", "outputs".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) by_position: Option<Limited<SideText, 2>>,
}

/// One side of a model.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SideText {
    Inputs,
    Outputs,
}

impl SideText {
    fn side(self) -> ChannelSide {
        match self {
            Self::Inputs => ChannelSide::Input,
            Self::Outputs => ChannelSide::Output,
        }
    }

    fn of(side: ChannelSide) -> Self {
        side.of(Self::Inputs, Self::Outputs)
    }
}

/// Standard deviations of a model's response.
#[derive(Deserialize, Serialize)]
pub(crate) struct BandsText {
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

impl DatasetText {
    /// Converts the text to a draft, with a caution for each key of a model without meaning there.
    /// Checks only content that JSON alone spells: words, not numbers.
    pub(super) fn into_draft(self) -> Result<(DatasetDraft, Vec<String>), ContentError> {
        let band = self.frequency_band;
        if band.unit != "rad/s" {
            let fault = ContentFault::Word {
                expected: "\"rad/s\"".to_owned(),
                found: band.unit,
            };
            return Err(ContentError::new(
                Location::entry("frequency_band, unit"),
                fault,
            ));
        }
        let mut cautions = Vec::new();
        let conditions = self.conditions.into_iter().enumerate();
        let conditions = conditions.map(|(index, text)| text.into_draft(index + 1, &mut cautions));
        let draft = DatasetDraft {
            name: self.name,
            description: self.description.unwrap_or_default(),
            inputs: self
                .inputs
                .into_iter()
                .map(ChannelText::into_channel)
                .collect(),
            outputs: self
                .outputs
                .into_iter()
                .map(ChannelText::into_channel)
                .collect(),
            on_axis: Limited::entries(self.on_axis),
            band: (band.min, band.max),
            conditions: conditions.collect::<Result<_, _>>()?,
        };
        Ok((draft, cautions))
    }

    /// Creates the text of a dataset, entry by entry.
    pub(super) fn of(dataset: &Dataset) -> Self {
        let names = |pair: gdcm_model::dataset::Pair| {
            (
                dataset.outputs()[pair.output].name.clone(),
                dataset.inputs()[pair.input].name.clone(),
            )
        };
        Self {
            format: FORMAT.name.to_owned(),
            version: FORMAT.version,
            name: dataset.name().to_owned(),
            description: written(dataset.description()),
            inputs: dataset.inputs().iter().map(ChannelText::of).collect(),
            outputs: dataset.outputs().iter().map(ChannelText::of).collect(),
            on_axis: Some(Limited(dataset.on_axis().marked().map(names).collect())),
            frequency_band: BandText {
                min: dataset.band().min(),
                max: dataset.band().max(),
                unit: "rad/s".to_owned(),
            },
            conditions: dataset
                .conditions()
                .iter()
                .map(|condition| ConditionText::of(condition))
                .collect(),
        }
    }
}

fn written(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

impl ChannelText {
    fn into_channel(self) -> Channel {
        Channel {
            name: self.name,
            unit: self.unit,
            description: self.description.unwrap_or_default(),
        }
    }

    fn of(channel: &Channel) -> Self {
        Self {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            description: written(&channel.description),
        }
    }
}

impl ConditionText {
    fn into_draft(
        self,
        position: usize,
        cautions: &mut Vec<String>,
    ) -> Result<ConditionDraft, ContentError> {
        let place = Location::condition(position, self.id);
        let flight_state = FlightState {
            id: ConditionId(self.id),
            name: self.name,
            airspeed_kt: self.airspeed_kt,
            altitude: self.altitude,
            altitude_ft: self.altitude_ft,
            weight: self.weight,
            mass_kg: self.mass_kg,
        };
        let mut models = |kind, texts: Vec<ModelText>| -> Result<Vec<ModelDraft>, ContentError> {
            let draft = |(index, model): (usize, ModelText)| {
                let place = place.model(kind, index + 1, &model.name);
                cautions.extend(model.misplaced(kind).map(|key| {
                    format!(
                        "{}the key \"{key}\" is not known and not used",
                        place.before()
                    )
                }));
                let origin = match kind {
                    BundleKind::Physics => model.physics_origin(&place)?,
                    BundleKind::Identified => model.identified_origin(),
                };
                Ok(model.into_draft(origin))
            };
            texts.into_iter().enumerate().map(draft).collect()
        };
        let physics = models(BundleKind::Physics, self.physics_models)?;
        let identified = models(BundleKind::Identified, self.identified_models)?;
        let records = Limited::entries(self.records).into_iter().enumerate();
        let records = records.map(|(index, record)| record.into_record(&place, index + 1));
        Ok(ConditionDraft {
            flight_state,
            physics,
            identified,
            records: records.collect::<Result<_, _>>()?,
        })
    }

    fn of(condition: &Condition) -> Self {
        let state = condition.flight_state().clone();
        let models = |kind| {
            condition
                .bundle(kind)
                .iter()
                .map(ModelText::of_model)
                .collect()
        };
        Self {
            id: state.id.0,
            name: state.name,
            airspeed_kt: state.airspeed_kt,
            altitude: state.altitude,
            altitude_ft: state.altitude_ft,
            weight: state.weight,
            mass_kg: state.mass_kg,
            physics_models: models(BundleKind::Physics),
            identified_models: models(BundleKind::Identified),
            records: Limited::some(condition.records().iter().map(RecordText::of).collect()),
        }
    }
}

impl RecordText {
    /// Converts to a record; `condition` is its place.
    pub(crate) fn into_record(
        self,
        condition: &Location,
        position: usize,
    ) -> Result<ConditionRecord, ContentError> {
        let kind = match self.kind {
            None => RecordKind::Other,
            Some(word) => RecordKind::from_word(&word).ok_or_else(|| {
                let words = RecordKind::ALL.map(|kind| format!("\"{}\"", kind.word()));
                let fault = ContentFault::Word {
                    expected: format!("one of {}", words.join(", ")),
                    found: word,
                };
                ContentError::new(
                    condition.at(format!("records, entry {position}, kind")),
                    fault,
                )
            })?,
        };
        Ok(ConditionRecord {
            name: self.name,
            file: self.file,
            variable: self.variable,
            sha256: self.sha256,
            kind,
            held_out: self.held_out,
            used: self.used.unwrap_or(true),
            sample_time_s: self.sample_time_s,
            used_s: Limited::entries(self.used_s),
            part_s: self.part_s,
            remedies: self.remedies,
        })
    }

    /// Creates the text of a record.
    pub(crate) fn of(record: &ConditionRecord) -> Self {
        let record = record.clone();
        Self {
            name: record.name,
            file: record.file,
            variable: record.variable,
            sha256: record.sha256,
            kind: Some(record.kind.word().to_owned()),
            held_out: record.held_out,
            used: Some(record.used),
            sample_time_s: record.sample_time_s,
            used_s: Limited::some(record.used_s),
            part_s: record.part_s,
            remedies: record.remedies,
        }
    }
}

impl ModelText {
    /// Returns the present keys that have no meaning in a bundle of this kind in a dataset.
    fn misplaced(&self, kind: BundleKind) -> impl Iterator<Item = &'static str> + use<> {
        let is_physics = kind == BundleKind::Physics;
        let keys = [
            ("role", !is_physics && self.role.is_some()),
            ("perturbation", !is_physics && self.perturbation.is_some()),
            ("method", is_physics && self.method.is_some()),
            ("order", is_physics && self.order.is_some()),
            ("bands", is_physics && self.bands.is_some()),
            ("condition", self.condition.is_some()),
            ("airspeed_kt", self.airspeed_kt.is_some()),
            ("altitude_ft", self.altitude_ft.is_some()),
            ("mass_kg", self.mass_kg.is_some()),
            ("inputs", self.inputs.is_some()),
            ("outputs", self.outputs.is_some()),
            ("input_units", self.input_units.is_some()),
            ("output_units", self.output_units.is_some()),
            ("notes", self.notes.is_some()),
            ("recommended", self.recommended.is_some()),
        ];
        keys.into_iter()
            .filter(|(_, is_there)| *is_there)
            .map(|(key, _)| key)
    }

    fn physics_origin(&self, place: &Location) -> Result<Origin, ContentError> {
        let role = self.role.clone();
        let role = role.ok_or_else(|| {
            ContentError::new(
                place.clone(),
                ContentFault::MissingKey { key: "role".into() },
            )
        })?;
        self.origin()
            .filter(|origin| !matches!(origin, Origin::Identified { .. }))
            .ok_or_else(|| {
                let fault = ContentFault::Word {
                    expected: "\"nominal\" or \"perturbed\"".to_owned(),
                    found: role,
                };
                ContentError::new(place.at("role"), fault)
            })
    }

    pub(crate) fn identified_origin(&self) -> Origin {
        Origin::Identified {
            method: self.method.clone(),
            order: self.order,
        }
    }

    /// Returns the origin that the role implies; `None` for an unknown role.
    pub(crate) fn origin(&self) -> Option<Origin> {
        let perturbation = self.perturbation.clone();
        match self.role.as_deref() {
            Some("nominal") => Some(Origin::Nominal { perturbation }),
            Some("perturbed") => Some(Origin::Perturbed { perturbation }),
            Some("identified") => Some(self.identified_origin()),
            _ => None,
        }
    }

    /// Converts to the draft of an identified model of a dataset or a study.
    pub(crate) fn into_identified(self) -> ModelDraft {
        let origin = self.identified_origin();
        self.into_draft(origin)
    }

    pub(crate) fn into_draft(self, origin: Origin) -> ModelDraft {
        let is_identified = matches!(origin, Origin::Identified { .. });
        ModelDraft {
            name: self.name,
            origin,
            timing: Timing {
                sample_time_s: self.sample_time_s,
                input_delays_s: self.input_delays_s.map(|list| list.0),
                output_delays_s: self.output_delays_s.map(|list| list.0),
            },
            matrices: [self.a, self.b, self.c, self.d].map(|array| array.map(matrix)),
            response: self.frequency_response.map(ResponseText::into_draft),
            states: Limited::entries(self.states),
            source: self.source.map(SourceText::into_provenance),
            bands: self
                .bands
                .filter(|_| is_identified)
                .map(BandsText::into_draft),
        }
    }

    /// Creates the text of a model of a dataset.
    pub(crate) fn of_model(model: &Model) -> Self {
        Self::of(ModelDraft::from_model(model))
    }

    /// Creates the text of a model.
    pub(crate) fn of(draft: ModelDraft) -> Self {
        let [a, b, c, d] = draft
            .matrices
            .map(|matrix| matrix.as_ref().map(Nested::of_matrix));
        let Timing {
            sample_time_s,
            input_delays_s,
            output_delays_s,
        } = draft.timing;
        let (role, perturbation, method, order) = match draft.origin {
            Origin::Nominal { perturbation } => (Some("nominal"), perturbation, None, None),
            Origin::Perturbed { perturbation } => (Some("perturbed"), perturbation, None, None),
            Origin::Identified { method, order } => (None, None, method, order),
        };
        Self {
            name: draft.name,
            role: role.map(str::to_owned),
            perturbation,
            method,
            order,
            states: Limited::some(draft.states),
            a,
            b,
            c,
            d,
            sample_time_s,
            input_delays_s: input_delays_s.map(Limited),
            output_delays_s: output_delays_s.map(Limited),
            frequency_response: draft.response.map(ResponseText::of),
            bands: draft.bands.map(BandsText::of),
            source: draft.source.map(SourceText::of),
            ..Self::default()
        }
    }
}

fn matrix(array: Nested<2>) -> DMatrix<f64> {
    DMatrix::from_row_slice(array.shape[0], array.shape[1], &array.values)
}

fn array(Nested { shape, values }: Nested<3>) -> ResponseArray {
    ResponseArray { shape, values }
}

fn nested(ResponseArray { shape, values }: ResponseArray) -> Nested<3> {
    Nested { shape, values }
}

impl BandsText {
    fn into_draft(self) -> BandsDraft {
        BandsDraft {
            omega: self.omega_rad_s,
            sd_db: array(self.sd_db),
            sd_deg: array(self.sd_deg),
        }
    }

    fn of(bands: BandsDraft) -> Self {
        Self {
            omega_rad_s: bands.omega,
            sd_db: nested(bands.sd_db),
            sd_deg: nested(bands.sd_deg),
        }
    }
}

impl ResponseText {
    fn into_draft(self) -> ResponseDraft {
        ResponseDraft {
            omega: self.omega_rad_s,
            re: array(self.re),
            im: array(self.im),
            coherence: self.coherence.map(array),
            valid_bands: self.valid_band_rad_s.map(array),
            estimate: Estimate {
                averages: self.averages,
                window_s: self.window_s,
            },
        }
    }

    fn of(response: ResponseDraft) -> Self {
        let Estimate { averages, window_s } = response.estimate;
        Self {
            omega_rad_s: response.omega,
            re: nested(response.re),
            im: nested(response.im),
            coherence: response.coherence.map(nested),
            valid_band_rad_s: response.valid_bands.map(nested),
            averages,
            window_s,
        }
    }
}

impl SourceText {
    fn into_provenance(self) -> Provenance {
        let Self {
            file,
            sha256,
            variable,
            made,
            note,
            records,
            unused,
            by_position,
        } = self;
        Provenance {
            file,
            sha256,
            variable,
            made,
            note,
            records: Limited::entries(records),
            unused: Limited::entries(unused),
            by_position: Limited::entries(by_position)
                .into_iter()
                .map(SideText::side)
                .collect(),
        }
    }

    fn of(source: Provenance) -> Self {
        let Provenance {
            file,
            sha256,
            variable,
            made,
            note,
            records,
            unused,
            by_position,
        } = source;
        Self {
            file,
            sha256,
            variable,
            made,
            note,
            records: Limited::some(records),
            unused: Limited::some(unused),
            by_position: Limited::some(by_position.into_iter().map(SideText::of).collect()),
        }
    }
}
