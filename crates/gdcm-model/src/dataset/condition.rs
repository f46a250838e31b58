//! One flight condition with its two bundles of models and its flight records.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::channel::{BundleKind, ConditionId};
use super::model::Model;
use crate::units::number;

/// Description of a flight condition, without its models.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightState {
    pub id: ConditionId,
    /// Display name.
    pub name: String,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Altitude class ("low", "high").
    pub altitude: Option<String>,
    /// Altitude \[ft\].
    pub altitude_ft: Option<f64>,
    /// Weight class ("low", "high").
    pub weight: Option<String>,
    /// Mass \[kg\].
    pub mass_kg: Option<f64>,
}

impl FlightState {
    /// Creates a condition with only an airspeed \[kt\], named after its id.
    pub fn at(id: ConditionId, airspeed_kt: f64) -> Self {
        let name = format!("condition {id}");
        Self {
            id,
            name,
            airspeed_kt,
            altitude: None,
            altitude_ft: None,
            weight: None,
            mass_kg: None,
        }
    }
}

/// One flight condition: a bundle of physics models, exactly one of them nominal, a bundle of
/// identified models, and their flight records, where the dataset lists them. A condition without
/// identified models has no reference yet: it is valid, but gives no result
/// ([`Condition::has_reference`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    flight_state: FlightState,
    /// Physics models, identified models.
    bundles: [Vec<Model>; 2],
    nominal: usize,
    records: Vec<ConditionRecord>,
    /// Indices of the physics and identified models, sorted by name, because a list of a thousand
    /// models looks up each one by name.
    by_name: [Vec<usize>; 2],
}

/// Why two bundles do not form a condition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionError {
    /// A value of the flight state is not finite, or an airspeed is negative.
    #[error("{field}: expected a finite number{bound}, found {}", number(*value))]
    FlightState {
        /// The quantity with its unit.
        field: &'static str,
        /// " not below zero" where required.
        bound: &'static str,
        value: f64,
    },
    /// The physics bundle is empty, or the replacement for the identified bundle is.
    #[error("the {0} bundle: expected at least one model, found none")]
    EmptyBundle(BundleKind),
    /// Two models of a bundle share a name.
    #[error(
        "the {bundle} bundle: the name \"{name}\" stands twice (models {first} and {second}); names must differ"
    )]
    DuplicateName {
        bundle: BundleKind,
        name: String,
        /// First model, counted from 1.
        first: usize,
        /// Second model, counted from 1.
        second: usize,
    },
    /// The physics bundle has no nominal model, or several.
    #[error("the physics bundle: expected exactly one nominal model, found {found}{names}")]
    Nominal {
        /// Number of nominal models.
        found: usize,
        /// Their names in parentheses, where there are several.
        names: String,
    },
    /// Two records share a name.
    #[error(
        "records: the name \"{name}\" stands twice (records {first} and {second}); names must differ"
    )]
    DuplicateRecord {
        name: String,
        /// First record, counted from 1.
        first: usize,
        /// Second record, counted from 1.
        second: usize,
    },
    /// A sample time or the time of a piece is out of range.
    #[error("record \"{name}\" (number {position}), {field}: expected {expected}, found {}", number(*value))]
    Record {
        name: String,
        /// Position of the record, counted from 1.
        position: usize,
        /// The quantity.
        field: &'static str,
        /// The permitted values.
        expected: &'static str,
        value: f64,
    },
}

impl Condition {
    /// Creates a condition with these models, in file order.
    pub fn new(
        flight_state: FlightState,
        physics: Vec<Model>,
        identified: Vec<Model>,
    ) -> Result<Self, ConditionError> {
        check_flight_state(&flight_state)?;
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
                let by_name = bundles.each_ref().map(|models| by_name(models));
                Ok(Self {
                    flight_state,
                    bundles,
                    nominal,
                    records: Vec::new(),
                    by_name,
                })
            }
            _ => Err(ConditionError::Nominal {
                found: nominal.len(),
                names: names_of(physics, &nominal),
            }),
        }
    }

    /// Returns the same condition with these flight records, in file order.
    ///
    /// # Errors
    /// [`ConditionError::DuplicateRecord`] and [`ConditionError::Record`].
    pub fn with_records(mut self, records: Vec<ConditionRecord>) -> Result<Self, ConditionError> {
        check_records(&records)?;
        self.records = records;
        Ok(self)
    }

    /// Returns the same condition with these models as its identified bundle, and these flight
    /// records. A record replaces the one with the same name, or else the one with the same samples
    /// of the same file, or is appended. A record whose parts are added is no longer used, since
    /// evidence counts once.
    ///
    /// # Errors
    /// The errors of [`Condition::new`] and [`Condition::with_records`].
    pub fn with_identified(
        &self,
        models: Vec<Model>,
        records: Vec<ConditionRecord>,
    ) -> Result<Self, ConditionError> {
        let mut kept = self.records.clone();
        for whole in kept
            .iter_mut()
            .filter(|whole| records.iter().any(|part| part.is_part_of(whole)))
        {
            whole.used = false;
        }
        for record in records {
            let of_name = kept.iter().position(|other| other.name == record.name);
            match of_name.or_else(|| kept.iter().position(|other| other.is_same_as(&record))) {
                Some(index) => kept[index] = record,
                None => kept.push(record),
            }
        }
        Self::new(self.flight_state.clone(), self.bundles[0].clone(), models)?.with_records(kept)
    }

    /// Returns the flight records in file order; empty where the dataset lists none.
    pub fn records(&self) -> &[ConditionRecord] {
        &self.records
    }

    /// Returns the description of the condition, without its models.
    pub fn flight_state(&self) -> &FlightState {
        &self.flight_state
    }

    /// Returns the identity in the dataset.
    pub fn id(&self) -> ConditionId {
        self.flight_state.id
    }

    /// Returns the models of one bundle, in file order.
    pub fn bundle(&self, kind: BundleKind) -> &[Model] {
        &self.bundles[kind as usize]
    }

    /// Returns whether the condition has identified models as a reference for its physics models.
    pub fn has_reference(&self) -> bool {
        !self.bundle(BundleKind::Identified).is_empty()
    }

    /// Returns the position of the named model in its bundle, in file order.
    pub fn position(&self, kind: BundleKind, name: &str) -> Option<usize> {
        let models = self.bundle(kind);
        let order = &self.by_name[kind as usize];
        let place = order
            .binary_search_by(|index| models[*index].name.as_str().cmp(name))
            .ok()?;
        Some(order[place])
    }

    /// Returns the named model of a bundle.
    pub fn model(&self, kind: BundleKind, name: &str) -> Option<&Model> {
        Some(&self.bundle(kind)[self.position(kind, name)?])
    }

    /// Returns the index of the nominal model in the physics bundle.
    pub fn nominal(&self) -> usize {
        self.nominal
    }
}

fn by_name(models: &[Model]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..models.len()).collect();
    order.sort_by(|a, b| models[*a].name.cmp(&models[*b].name));
    order
}

fn check_flight_state(state: &FlightState) -> Result<(), ConditionError> {
    let figures = [
        ("airspeed [kt]", Some(state.airspeed_kt), true),
        ("altitude [ft]", state.altitude_ft, false),
        ("mass [kg]", state.mass_kg, true),
    ];
    for (field, value, not_negative) in figures {
        let Some(value) = value else { continue };
        if !value.is_finite() || (not_negative && value < 0.0) {
            let bound = if not_negative { " not below zero" } else { "" };
            return Err(ConditionError::FlightState {
                field,
                bound,
                value,
            });
        }
    }
    Ok(())
}

/// Checks a bundle. An identified bundle may be empty: models can be identified later from flight
/// records.
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
    for (second, record) in records.iter().enumerate() {
        if let Some(first) = records[..second]
            .iter()
            .position(|earlier| earlier.name == record.name)
        {
            let name = record.name.clone();
            return Err(ConditionError::DuplicateRecord {
                name,
                first: first + 1,
                second: second + 1,
            });
        }
        let wrong = |field, expected, value| {
            let name = record.name.clone();
            let position = second + 1;
            Err(ConditionError::Record {
                name,
                position,
                field,
                expected,
                value,
            })
        };
        if let Some(value) = record
            .sample_time_s
            .filter(|value| !value.is_finite() || *value <= 0.0)
        {
            return wrong("sample_time_s", "a positive number of seconds", value);
        }
        let parts = record.part_s.iter().map(|part| ("part_s", part));
        for (field, &[first, last]) in record
            .used_s
            .iter()
            .map(|piece| ("used_s", piece))
            .chain(parts)
        {
            if !first.is_finite() {
                return wrong(field, "finite times", first);
            }
            if !last.is_finite() || last < first {
                return wrong(field, "a finite last time, not before the first", last);
            }
        }
    }
    Ok(())
}

fn names_of(models: &[Model], indices: &[usize]) -> String {
    if indices.is_empty() {
        return String::new();
    }
    /// Enough names to find the mistake.
    const SHOWN: usize = 5;
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

/// The manoeuvre of a record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RecordKind {
    /// A frequency sweep.
    Sweep,
    /// A sum of sines.
    Multisine,
    /// A 3-2-1-1 input (steps of three, two, one and one time units), or doublets.
    ThreeTwoOneOne,
    #[default]
    Other,
}

impl RecordKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [
        Self::Sweep,
        Self::Multisine,
        Self::ThreeTwoOneOne,
        Self::Other,
    ];

    /// Returns its keyword in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sweep => "sweep",
            Self::Multisine => "multisine",
            Self::ThreeTwoOneOne => "3-2-1-1",
            Self::Other => "other",
        }
    }

    /// Parses a keyword.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.word() == word)
    }
}

/// Reference to a flight record of a condition: the file that holds its samples, and how they are
/// used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConditionRecord {
    /// Name, unique in the condition.
    pub name: String,
    /// Path relative to the dataset's file.
    pub file: String,
    /// Name of the record or variable in the file; `None` where the file holds a single record.
    pub variable: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    pub kind: RecordKind,
    /// Whether it is withheld from identification for validation.
    pub held_out: bool,
    /// Whether it is used for anything.
    pub used: bool,
    /// Sample time \[s\], once known.
    pub sample_time_s: Option<f64>,
    /// First and last time \[s\] of each piece in use, on the record's clock; empty for the whole
    /// record.
    pub used_s: Vec<[f64; 2]>,
    /// First and last time \[s\] of this record within the file's samples, on the file's clock;
    /// `None` for the whole file.
    pub part_s: Option<[f64; 2]>,
    /// Corrections specific to this record, by channel.
    pub remedies: BTreeMap<String, ChannelRemedy>,
}

/// Correction of a channel in a single record that contradicts the others (M14.16).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChannelRemedy {
    /// Extra logging delay relative to the other records \[s\], to be removed.
    pub delay_s: f64,
    /// Factor on its samples, in addition to the unit conversion.
    pub factor: f64,
}

impl ChannelRemedy {
    /// No correction.
    pub const NONE: Self = Self {
        delay_s: 0.0,
        factor: 1.0,
    };

    /// Combines two corrections, `next` applied after `self`.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self {
            delay_s: self.delay_s + next.delay_s,
            factor: self.factor * next.factor,
        }
    }
}

impl Default for ChannelRemedy {
    fn default() -> Self {
        Self::NONE
    }
}

impl ConditionRecord {
    /// Returns whether both refer to the same record of the same file. Folders are ignored, because
    /// the paths may be relative to different places.
    fn is_of_same_source(&self, other: &ConditionRecord) -> bool {
        let name = |record: &Self| record.file.rsplit('/').next().map(str::to_owned);
        let differ = self
            .sha256
            .as_ref()
            .zip(other.sha256.as_ref())
            .is_some_and(|(a, b)| a != b);
        name(self) == name(other) && self.variable == other.variable && !differ
    }

    /// Returns whether both refer to the same samples, under any name.
    fn is_same_as(&self, other: &ConditionRecord) -> bool {
        self.part_s == other.part_s && self.is_of_same_source(other)
    }

    /// Returns whether it is a part of the full record `whole`.
    fn is_part_of(&self, whole: &ConditionRecord) -> bool {
        self.part_s.is_some() && whole.part_s.is_none() && self.is_of_same_source(whole)
    }

    /// Creates a record in use, with an unknown manoeuvre.
    pub fn new(name: impl Into<String>, file: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            file: file.into(),
            used: true,
            ..Self::default()
        }
    }
}
