//! A flight condition with its two bundles of models (physics models, identified models) and its
//! flight records, checked at construction.

use std::collections::BTreeSet;

pub use super::channel_remedy::ChannelRemedy;
pub use super::condition_record::{ConditionRecord, RecordKind};
pub use super::flight_state::{FlightState, FlightStateError};

use super::model::Model;
use super::model_id::{BundleKind, ConditionId};
use super::physics_parameter::{MovedModel, ParameterError};
use crate::number_format::number;

/// A flight condition: physics models, exactly one of them nominal; identified models; and flight
/// records.
///
/// A condition without identified models is valid, but gives no results: it has no reference for
/// its physics models ([`Condition::has_reference`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    flight_state: FlightState,
    /// Physics models, then identified models: indexed by [`BundleKind`].
    bundles: [Vec<Model>; 2],
    /// The nominal model's index among the physics models.
    nominal: usize,
    records: Vec<ConditionRecord>,
    /// Physics models with moved parameters, which do not belong to the bundle.
    moved: Vec<MovedModel>,
    /// For each bundle, its model indices, sorted by name for binary search: linear look-ups would
    /// be slow for thousands of models.
    by_name: [Vec<usize>; 2],
}

/// Error for data that do not form a flight condition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionError {
    #[error(transparent)]
    FlightState(#[from] FlightStateError),
    #[error("the {0} bundle: expected at least one model, found none")]
    EmptyBundle(BundleKind),
    #[error(
        "the {bundle} bundle: duplicate name \"{name}\" (models {first} and {second}); names must differ"
    )]
    DuplicateName {
        bundle: BundleKind,
        name: String,
        /// First model, counted from 1.
        first: usize,
        /// Second model, counted from 1.
        second: usize,
    },
    #[error("the physics bundle: expected exactly one nominal model, found {found}{names}")]
    Nominal {
        found: usize,
        /// Nominal model names in parentheses; empty if there is none.
        names: String,
    },
    #[error("records: duplicate name \"{name}\" (records {first} and {second}); names must differ")]
    DuplicateRecord {
        name: String,
        /// First record, counted from 1.
        first: usize,
        /// Second record, counted from 1.
        second: usize,
    },
    /// A record with an invalid sample time or time interval.
    #[error("record \"{name}\" (number {position}), {field}: expected {expected}, found {}", number(*value))]
    Record {
        name: String,
        position: usize,
        /// Key in the dataset file: "sample_time_s", "used_s" or "part_s".
        field: &'static str,
        expected: &'static str,
        value: f64,
    },
    #[error("physics models with changed parameters: duplicate name \"{name}\"; names must differ")]
    DuplicateMovedModel { name: String },
    #[error("physics model \"{name}\" with changed parameters: {error}")]
    MovedModel { name: String, error: ParameterError },
}

impl ConditionError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::FlightState(..) => "flight-state",
            Self::EmptyBundle(..) => "empty-bundle",
            Self::DuplicateName { .. } => "duplicate-name",
            Self::Nominal { .. } => "no-nominal",
            Self::DuplicateRecord { .. } => "duplicate-record",
            Self::Record { .. } => "record-of-model",
            Self::DuplicateMovedModel { .. } => "duplicate-moved-model",
            Self::MovedModel { error, .. } => error.code(),
        }
    }
}

impl Condition {
    /// Creates a condition without flight records from its models in file order.
    ///
    /// # Errors
    /// [`ConditionError`] for an invalid value in the flight state, an empty physics bundle, a
    /// duplicate name, or if there is not exactly one nominal model.
    pub fn new(
        flight_state: FlightState,
        physics: Vec<Model>,
        identified: Vec<Model>,
    ) -> Result<Self, ConditionError> {
        flight_state.check()?;
        let bundles = [physics, identified];
        for (bundle, models) in BundleKind::BOTH.into_iter().zip(&bundles) {
            check_bundle(bundle, models)?;
        }
        let physics = &bundles[0];
        let nominal: Vec<usize> = (0..physics.len())
            .filter(|&index| physics[index].is_nominal())
            .collect();
        match nominal[..] {
            [nominal] => {
                let by_name = bundles.each_ref().map(|models| indices_by_name(models));
                Ok(Self {
                    flight_state,
                    bundles,
                    nominal,
                    records: Vec::new(),
                    moved: Vec::new(),
                    by_name,
                })
            }
            _ => Err(ConditionError::Nominal {
                found: nominal.len(),
                names: list_names(physics, &nominal),
            }),
        }
    }

    /// Returns the condition with its flight records replaced, in file order.
    ///
    /// # Errors
    /// [`ConditionError::DuplicateRecord`] and [`ConditionError::Record`].
    pub fn with_records(mut self, records: Vec<ConditionRecord>) -> Result<Self, ConditionError> {
        check_records(&records)?;
        self.records = records;
        Ok(self)
    }

    /// Returns the condition with its models with moved parameters replaced, in file order (M18.1).
    ///
    /// # Errors
    /// [`ConditionError::DuplicateMovedModel`] for a name that is not unique among these models and
    /// the physics bundle, [`ConditionError::MovedModel`] for an invalid change.
    pub fn with_moved_models(mut self, moved: Vec<MovedModel>) -> Result<Self, ConditionError> {
        let mut names: BTreeSet<&str> = BTreeSet::new();
        for model in self.bundle(BundleKind::Physics) {
            names.insert(&model.name);
        }
        for model in &moved {
            let name = &model.model.name;
            if !names.insert(name) {
                return Err(ConditionError::DuplicateMovedModel { name: name.clone() });
            }
            model
                .moved
                .check()
                .map_err(|error| ConditionError::MovedModel {
                    name: name.clone(),
                    error,
                })?;
        }
        self.moved = moved;
        Ok(self)
    }

    /// Returns the physics models with moved parameters, in file order; they are in no bundle.
    pub fn moved_models(&self) -> &[MovedModel] {
        &self.moved
    }

    /// Returns the condition with its identified models replaced and with additional flight
    /// records.
    ///
    /// A record replaces the existing record with the same name, or else the one with the same
    /// samples from the same file; otherwise it is appended. If a part of a record is added, the
    /// whole record is marked unused, so that no sample counts twice.
    ///
    /// # Errors
    /// As for [`Condition::new`] and [`Condition::with_records`].
    pub fn with_identified(
        &self,
        models: Vec<Model>,
        records: Vec<ConditionRecord>,
    ) -> Result<Self, ConditionError> {
        let mut all_records = self.records.clone();
        for whole in &mut all_records {
            if records.iter().any(|part| part.is_part_of(whole)) {
                whole.used = false;
            }
        }
        for record in records {
            let same_name = all_records
                .iter()
                .position(|other| other.name == record.name);
            let replaced = same_name.or_else(|| {
                all_records
                    .iter()
                    .position(|other| other.is_same_as(&record))
            });
            match replaced {
                Some(index) => all_records[index] = record,
                None => all_records.push(record),
            }
        }
        Self::new(self.flight_state.clone(), self.bundles[0].clone(), models)?
            .with_records(all_records)?
            .with_moved_models(self.moved.clone())
    }

    /// Returns the condition with other physics models.
    ///
    /// # Errors
    /// As for [`Condition::new`] and [`Condition::with_moved_models`].
    pub fn with_physics(&self, models: Vec<Model>) -> Result<Self, ConditionError> {
        Self::new(self.flight_state.clone(), models, self.bundles[1].clone())?
            .with_records(self.records.clone())?
            .with_moved_models(self.moved.clone())
    }

    /// Returns the flight records in file order; empty where the dataset lists none.
    pub fn records(&self) -> &[ConditionRecord] {
        &self.records
    }

    /// Returns the identifier, name and flight state, without the models.
    pub fn flight_state(&self) -> &FlightState {
        &self.flight_state
    }

    /// Returns the identifier in the dataset.
    pub fn id(&self) -> ConditionId {
        self.flight_state.id
    }

    /// Returns the models in a bundle, in file order.
    pub fn bundle(&self, kind: BundleKind) -> &[Model] {
        &self.bundles[kind as usize]
    }

    /// Returns whether the condition has identified models as a reference for its physics models.
    pub fn has_reference(&self) -> bool {
        !self.bundle(BundleKind::Identified).is_empty()
    }

    /// Returns the named model's index in its bundle; `None` if there is no such model.
    pub fn position(&self, kind: BundleKind, name: &str) -> Option<usize> {
        let models = self.bundle(kind);
        let order = &self.by_name[kind as usize];
        let place = order
            .binary_search_by(|index| models[*index].name.as_str().cmp(name))
            .ok()?;
        Some(order[place])
    }

    /// Returns the named model in a bundle; `None` if there is no such model.
    pub fn model(&self, kind: BundleKind, name: &str) -> Option<&Model> {
        Some(&self.bundle(kind)[self.position(kind, name)?])
    }

    /// Returns the memory taken by all models' dynamics \[bytes\]
    /// ([`Dynamics::bytes`](super::Dynamics::bytes)).
    pub fn model_bytes(&self) -> usize {
        let mut bytes = 0;
        for kind in BundleKind::BOTH {
            for model in self.bundle(kind) {
                bytes += model.dynamics.bytes();
            }
        }
        for moved in &self.moved {
            bytes += moved.model.dynamics.bytes();
        }
        bytes
    }

    /// Returns the nominal model's index in the physics bundle.
    pub fn nominal(&self) -> usize {
        self.nominal
    }
}

/// Returns the model indices, sorted by name.
fn indices_by_name(models: &[Model]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..models.len()).collect();
    order.sort_by(|a, b| models[*a].name.cmp(&models[*b].name));
    order
}

/// Checks a bundle: unique names, and at least one physics model. An identified bundle may be
/// empty, because models can be identified later from flight records.
fn check_bundle(bundle: BundleKind, models: &[Model]) -> Result<(), ConditionError> {
    if models.is_empty() && bundle == BundleKind::Physics {
        return Err(ConditionError::EmptyBundle(bundle));
    }
    for (second, model) in models.iter().enumerate() {
        if let Some(first) = models[..second]
            .iter()
            .position(|earlier| earlier.name == model.name)
        {
            let name = model.name.clone();
            return Err(ConditionError::DuplicateName {
                bundle,
                name,
                first: first + 1,
                second: second + 1,
            });
        }
    }
    Ok(())
}

fn check_records(records: &[ConditionRecord]) -> Result<(), ConditionError> {
    for (index, record) in records.iter().enumerate() {
        let earlier = records[..index]
            .iter()
            .position(|earlier| earlier.name == record.name);
        if let Some(first) = earlier {
            return Err(ConditionError::DuplicateRecord {
                name: record.name.clone(),
                first: first + 1,
                second: index + 1,
            });
        }
        record
            .check_times()
            .map_err(|fault| ConditionError::Record {
                name: record.name.clone(),
                position: index + 1,
                field: fault.field,
                expected: fault.expected,
                value: fault.value,
            })?;
    }
    Ok(())
}

/// Lists up to five names in parentheses; empty for no models.
fn list_names(models: &[Model], indices: &[usize]) -> String {
    const SHOWN: usize = 5;
    if indices.is_empty() {
        return String::new();
    }
    let names: Vec<&str> = indices
        .iter()
        .take(SHOWN)
        .map(|&index| models[index].name.as_str())
        .collect();
    let rest = indices.len() - names.len();
    let more = if rest == 0 {
        String::new()
    } else {
        format!(" and {rest} more")
    };
    format!(" ({}{more})", names.join(", "))
}
