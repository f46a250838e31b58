//! Checks a dataset draft and collects all faults. Models are checked in `model_draft_checks.rs`.
//!
//! 1. List lengths, the band, parameters, and the names of on-axis responses.
//! 2. Each condition: its models one by one; if all are valid, the condition as a whole.
//! 3. If there is no fault so far: the dataset as a whole.
//!
//! A draft with very many faults is not checked to its end.

use super::band::Band;
use super::channel::Channel;
use super::condition::Condition;
use super::dataset::{Dataset, DatasetHeader};
use super::dataset_draft::{ConditionDraft, DatasetDraft, ModelDraft};
use super::draft_fault::{DraftError, DraftFault, Warning};
use super::limits::{MOST_CHANNELS, MOST_CONDITIONS, MOST_MODELS, MOST_PARAMETERS, MOST_RECORDS};
use super::location::Location;
use super::model::Model;
use super::model_draft_checks::ModelBuilder;
use super::model_id::BundleKind;
use super::pair_table::{Pair, PairTable};
use super::physics_parameter::{MovedModel, check_parameters};

/// Number of faults from which no further condition is checked; a wrong kind of file has a fault in
/// every model.
const MOST_FAULTS: usize = 1000;

impl DatasetDraft {
    /// Checks the draft, and returns the dataset with any warnings.
    ///
    /// # Errors
    /// The first fault.
    pub fn checked(self) -> Result<(Dataset, Vec<Warning>), DraftError> {
        self.check_all().map_err(|mut faults| faults.swap_remove(0))
    }

    /// Returns every fault with its location, in draft order; empty for a valid dataset. A fault
    /// can hide another: duplicate names, for example, are found only once all models are valid.
    pub fn faults(self) -> Vec<DraftError> {
        self.check_all().err().unwrap_or_default()
    }

    /// Runs checks 1 to 3. The fault list is never empty.
    fn check_all(self) -> Result<(Dataset, Vec<Warning>), Vec<DraftError>> {
        // Check 1.
        let mut checker = Checker::new(self.outputs.len(), self.inputs.len());
        let lists = [
            ("inputs", self.inputs.len(), MOST_CHANNELS),
            ("outputs", self.outputs.len(), MOST_CHANNELS),
            ("parameters", self.parameters.len(), MOST_PARAMETERS),
            ("conditions", self.conditions.len(), MOST_CONDITIONS),
        ];
        for (list, found, most) in lists {
            checker.check_count(Location::entry(list), found, most);
        }
        let band = Band::new(self.band.0, self.band.1)
            .map_err(|error| DraftError::new(Location::default(), error));
        let band = checker.keep_fault(band);
        let parameters = check_parameters(&self.parameters)
            .map_err(|error| DraftError::new(Location::entry("parameters"), error));
        checker.keep_fault(parameters);
        let on_axis = on_axis_table(&self.outputs, &self.inputs, &self.on_axis);
        let on_axis = checker.keep_fault(on_axis);
        // Check 2.
        let mut conditions = Vec::with_capacity(self.conditions.len());
        let drafts = self.conditions.into_iter().take(MOST_CONDITIONS);
        for (index, draft) in drafts.enumerate() {
            if checker.faults.len() >= MOST_FAULTS {
                break;
            }
            conditions.extend(checker.condition(index + 1, draft));
        }
        // If only a condition has a fault, `band` and `on_axis` are `Some`; therefore the faults
        // are tested too.
        let (Some(band), Some(on_axis), true) = (band, on_axis, checker.faults.is_empty()) else {
            return Err(checker.faults);
        };
        let header = DatasetHeader {
            name: self.name,
            description: self.description,
            inputs: self.inputs,
            outputs: self.outputs,
            on_axis,
            band,
            parameters: self.parameters,
        };
        // Check 3.
        match Dataset::new(header, conditions) {
            Ok(dataset) => Ok((dataset, checker.models.warnings)),
            // `Location::default()`: the error itself names the list or the condition.
            Err(error) => Err(vec![DraftError::new(Location::default(), error)]),
        }
    }
}

impl Dataset {
    /// Checks a draft as an identified model with this dataset's channels, and returns it with any
    /// warnings.
    ///
    /// # Errors
    /// The first fault, with its location in the model.
    pub fn identified_model(&self, draft: ModelDraft) -> Result<(Model, Vec<Warning>), DraftError> {
        let mut builder = ModelBuilder::new(self.outputs().len(), self.inputs().len());
        let model = builder.build(Location::default(), BundleKind::Identified, draft)?;
        Ok((model, builder.warnings))
    }
}

/// Returns the on-axis table for responses given by output and input names; fails for an unknown
/// channel or a duplicate response.
fn on_axis_table(
    outputs: &[Channel],
    inputs: &[Channel],
    pairs: &[(String, String)],
) -> Result<PairTable<bool>, DraftError> {
    let mut table = PairTable::filled(outputs.len(), inputs.len(), false);
    for (index, (output, input)) in pairs.iter().enumerate() {
        mark_on_axis(&mut table, outputs, inputs, output, input).map_err(|fault| {
            let place = Location::entry(format!("on-axis pair {}", index + 1));
            DraftError::new(place, fault)
        })?;
    }
    Ok(table)
}

/// Marks a response given by its channel names; fails if a channel is unknown, or the response is
/// marked already.
fn mark_on_axis(
    table: &mut PairTable<bool>,
    outputs: &[Channel],
    inputs: &[Channel],
    output: &str,
    input: &str,
) -> Result<(), DraftFault> {
    let pair = Pair::new(
        find_channel("output", outputs, output)?,
        find_channel("input", inputs, input)?,
    );
    if table[pair] {
        return Err(DraftFault::DuplicatePair {
            output: output.to_owned(),
            input: input.to_owned(),
        });
    }
    table[pair] = true;
    Ok(())
}

fn find_channel(kind: &'static str, channels: &[Channel], name: &str) -> Result<usize, DraftFault> {
    channels
        .iter()
        .position(|channel| channel.name == name)
        .ok_or_else(|| DraftFault::UnknownChannel {
            kind,
            name: name.to_owned(),
        })
}

/// Model builder, which also collects the warnings, and the faults found so far.
struct Checker {
    models: ModelBuilder,
    faults: Vec<DraftError>,
}

impl Checker {
    fn new(outputs: usize, inputs: usize) -> Self {
        Self {
            models: ModelBuilder::new(outputs, inputs),
            faults: Vec::new(),
        }
    }

    /// Returns the checked value; otherwise stores the fault and returns `None`.
    fn keep_fault<T>(&mut self, checked: Result<T, DraftError>) -> Option<T> {
        match checked {
            Ok(value) => Some(value),
            Err(fault) => {
                self.faults.push(fault);
                None
            }
        }
    }

    /// Returns whether a count is within its limit; adds a fault if not.
    fn check_count(&mut self, place: Location, found: usize, most: usize) -> bool {
        if found > most {
            self.faults
                .push(DraftError::new(place, DraftFault::TooMany { most, found }));
        }
        found <= most
    }

    /// Checks a condition; `position` counts from 1. Returns `None` if it has faults.
    fn condition(&mut self, position: usize, draft: ConditionDraft) -> Option<Condition> {
        let place = Location::condition(position, draft.flight_state.id.0);
        let before = self.faults.len();
        let physics = self.bundle(&place, BundleKind::Physics, draft.physics);
        let identified = self.bundle(&place, BundleKind::Identified, draft.identified);
        self.check_count(place.at("records"), draft.records.len(), MOST_RECORDS);
        if self.faults.len() > before {
            return None;
        }
        let condition = Condition::new(draft.flight_state, physics.members, identified.members)
            .and_then(|condition| condition.with_records(draft.records))
            .and_then(|condition| condition.with_moved_models(physics.moved))
            .map_err(|error| DraftError::new(place, error));
        self.keep_fault(condition)
    }

    /// Checks a bundle's models, and returns the valid ones, those with moved parameters
    /// separately; none if there are too many.
    fn bundle(
        &mut self,
        condition: &Location,
        kind: BundleKind,
        drafts: Vec<ModelDraft>,
    ) -> BuiltModels {
        let list = condition.at(format!("{kind} models"));
        if !self.check_count(list, drafts.len(), MOST_MODELS) {
            return BuiltModels::default();
        }
        let mut built = BuiltModels::default();
        for (index, mut draft) in drafts.into_iter().enumerate() {
            let place = condition.model(kind, index + 1, &draft.name);
            let moved = draft.moved.take();
            if let Some(moved) = &moved {
                let checked = moved
                    .check()
                    .map_err(|error| DraftError::new(place.clone(), error));
                self.keep_fault(checked);
            }
            let model = self.models.build(place, kind, draft);
            let Some(model) = self.keep_fault(model) else {
                continue;
            };
            match moved {
                Some(moved) => built.moved.push(MovedModel { model, moved }),
                None => built.members.push(model),
            }
        }
        built
    }
}

/// The valid models from a list in the draft.
#[derive(Default)]
struct BuiltModels {
    /// Models in the bundle.
    members: Vec<Model>,
    /// Models with moved parameters.
    moved: Vec<MovedModel>,
}
