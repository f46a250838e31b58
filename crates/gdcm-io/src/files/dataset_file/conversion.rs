//! Conversion between dataset files and datasets: JSON text becomes a draft, and a checked dataset
//! becomes text. A [`DatasetDraft`] is a dataset before its checks.

use gdcm_model::dataset::condition::{ConditionRecord, FlightState, RecordKind};
use gdcm_model::dataset::dataset_draft::{ConditionDraft, DatasetDraft, ModelDraft};
use gdcm_model::dataset::draft_fault::DraftFault;
use gdcm_model::dataset::location::Location;
use gdcm_model::dataset::{BundleKind, Channel, Condition, ConditionId, Dataset, PhysicsParameter};

use super::json_form::{
    ChannelText, ConditionText, DatasetText, FORMAT, FrequencyBandText, ModelText, ParameterText,
    RecordText,
};
use crate::content_fault::{ContentError, ContentFault};
use crate::file_caution::FileCaution;
use crate::json_reading::Limited;

/// A dataset draft, with cautions about the text from which it was read.
pub(super) struct CautionedDraft {
    pub(super) draft: DatasetDraft,
    /// Cautions about model keys that have no meaning in a dataset.
    pub(super) cautions: Vec<FileCaution>,
}

impl DatasetText {
    /// Converts the file's entries to a draft. Only entries spelled as words (the band's unit,
    /// roles, kinds) are checked here; numbers are checked with the draft.
    pub(super) fn into_draft(self) -> Result<CautionedDraft, ContentError> {
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
        let mut conditions = Vec::with_capacity(self.conditions.len());
        for (index, text) in self.conditions.into_iter().enumerate() {
            conditions.push(text.into_draft(index + 1, &mut cautions)?);
        }
        let inputs = self.inputs.into_iter().map(ChannelText::into_channel);
        let outputs = self.outputs.into_iter().map(ChannelText::into_channel);
        let parameters = Limited::entries(self.parameters)
            .into_iter()
            .map(ParameterText::into_parameter);
        let draft = DatasetDraft {
            name: self.name,
            description: self.description.unwrap_or_default(),
            inputs: inputs.collect(),
            outputs: outputs.collect(),
            on_axis: Limited::entries(self.on_axis),
            band: (band.min, band.max),
            parameters: parameters.collect(),
            conditions,
        };
        Ok(CautionedDraft { draft, cautions })
    }

    pub(super) fn from_dataset(dataset: &Dataset) -> Self {
        let mut on_axis = Vec::new();
        for pair in dataset.on_axis().marked() {
            on_axis.push((
                dataset.outputs()[pair.output].name.clone(),
                dataset.inputs()[pair.input].name.clone(),
            ));
        }
        let inputs = dataset.inputs().iter().map(ChannelText::from_channel);
        let outputs = dataset.outputs().iter().map(ChannelText::from_channel);
        let parameters = dataset
            .parameters()
            .iter()
            .map(ParameterText::from_parameter);
        let conditions = dataset
            .conditions()
            .iter()
            .map(|condition| ConditionText::from_condition(condition));
        Self {
            format: FORMAT.name.to_owned(),
            version: FORMAT.version,
            name: dataset.name().to_owned(),
            description: unless_empty(dataset.description()),
            inputs: inputs.collect(),
            outputs: outputs.collect(),
            on_axis: Some(Limited(on_axis)),
            frequency_band: FrequencyBandText {
                min: dataset.band().min(),
                max: dataset.band().max(),
                unit: "rad/s".to_owned(),
            },
            parameters: Limited::some(parameters.collect()),
            conditions: conditions.collect(),
        }
    }
}

fn unless_empty(text: &str) -> Option<String> {
    if text.is_empty() {
        None
    } else {
        Some(text.to_owned())
    }
}

impl ChannelText {
    fn into_channel(self) -> Channel {
        Channel {
            name: self.name,
            unit: self.unit,
            description: self.description.unwrap_or_default(),
        }
    }

    fn from_channel(channel: &Channel) -> Self {
        Self {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            description: unless_empty(&channel.description),
        }
    }
}

impl ParameterText {
    fn into_parameter(self) -> PhysicsParameter {
        PhysicsParameter {
            name: self.name,
            unit: self.unit,
            plausible_sd: self.plausible_sd,
            description: self.description.unwrap_or_default(),
        }
    }

    fn from_parameter(parameter: &PhysicsParameter) -> Self {
        Self {
            name: parameter.name.clone(),
            unit: parameter.unit.clone(),
            plausible_sd: parameter.plausible_sd,
            description: unless_empty(&parameter.description),
        }
    }
}

impl ConditionText {
    /// Converts the condition at this position (from 1) in the list.
    fn into_draft(
        self,
        position: usize,
        cautions: &mut Vec<FileCaution>,
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
        let physics = model_drafts(self.physics_models, BundleKind::Physics, &place, cautions)?;
        let identified = model_drafts(
            self.identified_models,
            BundleKind::Identified,
            &place,
            cautions,
        )?;
        let mut records = Vec::new();
        for (index, record) in Limited::entries(self.records).into_iter().enumerate() {
            records.push(record.into_record(&place, index + 1)?);
        }
        Ok(ConditionDraft {
            flight_state,
            physics,
            identified,
            records,
        })
    }

    fn from_condition(condition: &Condition) -> Self {
        let state = condition.flight_state().clone();
        let physics = condition
            .bundle(BundleKind::Physics)
            .iter()
            .map(ModelText::of_model);
        let moved = condition.moved_models().iter().map(ModelText::of_moved);
        let identified = condition.bundle(BundleKind::Identified).iter();
        let records = condition.records().iter().map(RecordText::from_record);
        Self {
            id: state.id.0,
            name: state.name,
            airspeed_kt: state.airspeed_kt,
            altitude: state.altitude,
            altitude_ft: state.altitude_ft,
            weight: state.weight,
            mass_kg: state.mass_kg,
            physics_models: physics.chain(moved).collect(),
            identified_models: identified.map(ModelText::of_model).collect(),
            records: Limited::some(records.collect()),
        }
    }
}

/// Converts a bundle's models, with a caution for each key that has no meaning in a dataset.
fn model_drafts(
    texts: Vec<ModelText>,
    kind: BundleKind,
    condition: &Location,
    cautions: &mut Vec<FileCaution>,
) -> Result<Vec<ModelDraft>, ContentError> {
    let mut drafts = Vec::with_capacity(texts.len());
    for (index, model) in texts.into_iter().enumerate() {
        let place = condition.model(kind, index + 1, &model.name);
        for key in model.misplaced_keys(kind) {
            cautions.push(FileCaution::MisplacedKey {
                place: place.before(),
                key: key.to_owned(),
            });
        }
        let origin = match kind {
            BundleKind::Physics => model.physics_origin(&place)?,
            BundleKind::Identified => model.identified_origin(),
        };
        let moved = match kind {
            BundleKind::Physics => model
                .moved_parameters()
                .map_err(|error| ContentError::new(place.clone(), DraftFault::from(error)))?,
            BundleKind::Identified => None,
        };
        drafts.push(ModelDraft {
            moved,
            ..model.into_draft(origin)
        });
    }
    Ok(drafts)
}

impl RecordText {
    /// Converts a record in the condition at `condition`; `position` is its place in the record
    /// list, counted from 1.
    pub(crate) fn into_record(
        self,
        condition: &Location,
        position: usize,
    ) -> Result<ConditionRecord, ContentError> {
        let kind = match self.kind {
            None => RecordKind::Other,
            Some(word) => match RecordKind::from_word(&word) {
                Some(kind) => kind,
                None => {
                    let words = RecordKind::ALL.map(|kind| format!("\"{}\"", kind.word()));
                    let fault = ContentFault::Word {
                        expected: format!("one of {}", words.join(", ")),
                        found: word,
                    };
                    return Err(ContentError::new(
                        condition.at(format!("records, entry {position}, kind")),
                        fault,
                    ));
                }
            },
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

    pub(crate) fn from_record(record: &ConditionRecord) -> Self {
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
