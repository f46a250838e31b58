//! Conversion between dataset files and datasets: JSON text becomes a draft, and a checked dataset
//! becomes text.

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ConditionRecord, FlightState, RecordKind};
use gdcm_model::dataset::location::Location;
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::unchecked_dataset::{
    BandsDraft, ConditionDraft, DatasetDraft, ModelDraft, ResponseArray, ResponseDraft,
};
use gdcm_model::dataset::{BundleKind, Channel, Condition, ConditionId, Dataset, Model};

use super::text::{
    BandText, BandsText, ChannelText, ConditionText, DatasetText, FORMAT, ModelText, RecordText,
    ResponseText, SideText, SourceText,
};
use crate::file_error::{ContentError, ContentFault};
use crate::json_text::{Limited, Nested};

/// Draft of a dataset, with cautions about the text from which it was read.
pub(super) struct CautionedDraft {
    pub(super) draft: DatasetDraft,
    /// Cautions about model keys that have no meaning in a dataset.
    pub(super) cautions: Vec<String>,
}

impl DatasetText {
    /// Converts the file's entries to a draft. Only entries spelled as words (units, roles, kinds)
    /// are checked here; numbers are checked with the draft.
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
        let draft = DatasetDraft {
            name: self.name,
            description: self.description.unwrap_or_default(),
            inputs: inputs.collect(),
            outputs: outputs.collect(),
            on_axis: Limited::entries(self.on_axis),
            band: (band.min, band.max),
            conditions,
        };
        Ok(CautionedDraft { draft, cautions })
    }

    /// Converts a dataset to its form in the file.
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
            frequency_band: BandText {
                min: dataset.band().min(),
                max: dataset.band().max(),
                unit: "rad/s".to_owned(),
            },
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

impl ConditionText {
    /// Converts the condition at this position (from 1) in the list.
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
        let physics = condition.bundle(BundleKind::Physics).iter();
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
            physics_models: physics.map(ModelText::of_model).collect(),
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
    cautions: &mut Vec<String>,
) -> Result<Vec<ModelDraft>, ContentError> {
    let mut drafts = Vec::with_capacity(texts.len());
    for (index, model) in texts.into_iter().enumerate() {
        let place = condition.model(kind, index + 1, &model.name);
        for key in model.misplaced_keys(kind) {
            cautions.push(format!(
                "{}the key \"{key}\" is not known and not used",
                place.before()
            ));
        }
        let origin = match kind {
            BundleKind::Physics => model.physics_origin(&place)?,
            BundleKind::Identified => model.identified_origin(),
        };
        drafts.push(model.into_draft(origin));
    }
    Ok(drafts)
}

impl RecordText {
    /// Converts a record of the condition at `condition`; `position` is its place in the list of
    /// records, counted from 1.
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

    /// Converts a record to its form in the file.
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

impl ModelText {
    /// Returns the keys that are present but have no meaning for models in a bundle of this kind.
    fn misplaced_keys(&self, kind: BundleKind) -> Vec<&'static str> {
        let is_physics = kind == BundleKind::Physics;
        let mut misplaced = Vec::new();
        for (key, is_misplaced) in [
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
        ] {
            if is_misplaced {
                misplaced.push(key);
            }
        }
        misplaced
    }

    /// Returns the origin of a physics model.
    ///
    /// # Errors
    /// Fails if the role is missing, or is neither nominal nor perturbed.
    fn physics_origin(&self, place: &Location) -> Result<Origin, ContentError> {
        let Some(role) = &self.role else {
            let fault = ContentFault::MissingKey { key: "role".into() };
            return Err(ContentError::new(place.clone(), fault));
        };
        match self.origin() {
            Some(origin @ (Origin::Nominal { .. } | Origin::Perturbed { .. })) => Ok(origin),
            Some(Origin::Identified { .. }) | None => {
                let fault = ContentFault::Word {
                    expected: "\"nominal\" or \"perturbed\"".to_owned(),
                    found: role.clone(),
                };
                Err(ContentError::new(place.at("role"), fault))
            }
        }
    }

    pub(crate) fn identified_origin(&self) -> Origin {
        Origin::Identified {
            method: self.method.clone(),
            order: self.order,
        }
    }

    /// Returns the origin given by the role; `None` for an unknown role.
    pub(crate) fn origin(&self) -> Option<Origin> {
        let perturbation = self.perturbation.clone();
        match self.role.as_deref() {
            Some("nominal") => Some(Origin::Nominal { perturbation }),
            Some("perturbed") => Some(Origin::Perturbed { perturbation }),
            Some("identified") => Some(self.identified_origin()),
            _ => None,
        }
    }

    /// Converts the file's entry to the draft of an identified model in a dataset or a study.
    pub(crate) fn into_identified(self) -> ModelDraft {
        let origin = self.identified_origin();
        self.into_draft(origin)
    }

    pub(crate) fn into_draft(self, origin: Origin) -> ModelDraft {
        let bands = match origin {
            Origin::Identified { .. } => self.bands.map(BandsText::into_draft),
            Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
        };
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
            bands,
        }
    }

    /// Converts a model of a dataset to its form in the file.
    pub(crate) fn of_model(model: &Model) -> Self {
        Self::from_draft(ModelDraft::from_model(model))
    }

    /// Converts a model draft to its form in the file.
    pub(crate) fn from_draft(draft: ModelDraft) -> Self {
        let [a, b, c, d] = draft
            .matrices
            .map(|matrix| matrix.as_ref().map(Nested::of_matrix));
        let Timing {
            sample_time_s,
            input_delays_s,
            output_delays_s,
        } = draft.timing;
        let origin = match draft.origin {
            Origin::Nominal { perturbation } => Self {
                role: Some("nominal".to_owned()),
                perturbation,
                ..Self::default()
            },
            Origin::Perturbed { perturbation } => Self {
                role: Some("perturbed".to_owned()),
                perturbation,
                ..Self::default()
            },
            Origin::Identified { method, order } => Self {
                method,
                order,
                ..Self::default()
            },
        };
        Self {
            name: draft.name,
            states: Limited::some(draft.states),
            a,
            b,
            c,
            d,
            sample_time_s,
            input_delays_s: input_delays_s.map(Limited),
            output_delays_s: output_delays_s.map(Limited),
            frequency_response: draft.response.map(ResponseText::from_draft),
            bands: draft.bands.map(BandsText::from_draft),
            source: draft.source.map(SourceText::from_provenance),
            ..origin
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

    fn from_draft(bands: BandsDraft) -> Self {
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

    fn from_draft(response: ResponseDraft) -> Self {
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

    fn from_provenance(source: Provenance) -> Self {
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
            by_position: Limited::some(by_position.into_iter().map(SideText::from_side).collect()),
        }
    }
}

impl SideText {
    fn side(self) -> ChannelSide {
        match self {
            Self::Inputs => ChannelSide::Input,
            Self::Outputs => ChannelSide::Output,
        }
    }

    fn from_side(side: ChannelSide) -> Self {
        side.pick(Self::Inputs, Self::Outputs)
    }
}
