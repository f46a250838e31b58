//! One flight condition with its two bundles of models, and the flight records that it comes from.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::channel::{BundleKind, ConditionId};
use super::model::Model;
use crate::units::number;

/// What describes a flight condition, besides its models.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightState {
    /// Identity in the dataset ("condition 10").
    pub id: ConditionId,
    /// Name for people.
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
    /// A condition of which no more is said than its airspeed \[kt\], named by its id.
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

/// One flight condition: a bundle of physics models, exactly one of them nominal, a bundle of identified models, and the flight
/// records that these come from, where the dataset says so. Without identified models the condition has no reference yet: it is
/// valid, and has no result ([`Condition::has_reference`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    flight_state: FlightState,
    /// Physics models, identified models.
    bundles: [Vec<Model>; 2],
    nominal: usize,
    records: Vec<ConditionRecord>,
    /// Indices of the physics and of the identified models in the order of their names: a list of a thousand models asks for each by name.
    by_name: [Vec<usize>; 2],
}

/// Why two bundles are not a condition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionError {
    /// A figure of the flight state is not finite, or an airspeed is negative.
    #[error("{field}: expected a finite number{bound}, found {}", number(*value))]
    FlightState {
        /// The figure with its unit.
        field: &'static str,
        /// " not below zero" where that is required.
        bound: &'static str,
        /// What stands there.
        value: f64,
    },
    /// The physics bundle holds no model, or no identified models are to stand in the place of others.
    #[error("the {0} bundle: expected at least one model, found none")]
    EmptyBundle(BundleKind),
    /// Two models of a bundle share a name.
    #[error(
        "the {bundle} bundle: the name \"{name}\" stands twice (models {first} and {second}); names must differ"
    )]
    DuplicateName {
        /// Which.
        bundle: BundleKind,
        /// The name.
        name: String,
        /// First model, counted from 1.
        first: usize,
        /// Second model, counted from 1.
        second: usize,
    },
    /// A bundle of physics models has no nominal model, or several.
    #[error("the physics bundle: expected exactly one nominal model, found {found}{names}")]
    Nominal {
        /// How many there are.
        found: usize,
        /// Their names, in parentheses, where there are several.
        names: String,
    },
    /// Two records share a name.
    #[error(
        "records: the name \"{name}\" stands twice (records {first} and {second}); names must differ"
    )]
    DuplicateRecord {
        /// The name.
        name: String,
        /// First record, counted from 1.
        first: usize,
        /// Second record, counted from 1.
        second: usize,
    },
    /// A sample time, or the time of a piece, cannot be that of a record.
    #[error("record \"{name}\" (number {position}), {field}: expected {expected}, found {}", number(*value))]
    Record {
        /// The record's name.
        name: String,
        /// Which record, counted from 1.
        position: usize,
        /// The figure.
        field: &'static str,
        /// What may stand there.
        expected: &'static str,
        /// What stands there.
        value: f64,
    },
}

impl Condition {
    /// The condition with these models, in file order.
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

    /// The same condition with these flight records, in file order.
    ///
    /// # Errors
    /// [`ConditionError::DuplicateRecord`] and [`ConditionError::Record`].
    pub fn with_records(mut self, records: Vec<ConditionRecord>) -> Result<Self, ConditionError> {
        check_records(&records)?;
        self.records = records;
        Ok(self)
    }

    /// The same condition with these models for its identified bundle, and these flight records, each in place of the one of its
    /// name, or else of the same samples of the same file, or behind the others. A record of which parts come is no longer used, for
    /// evidence counts once.
    ///
    /// # Errors
    /// Those of [`Condition::new`] and [`Condition::with_records`].
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

    /// The flight records, in file order; none where the dataset names none.
    pub fn records(&self) -> &[ConditionRecord] {
        &self.records
    }

    /// What describes the condition, besides its models.
    pub fn flight_state(&self) -> &FlightState {
        &self.flight_state
    }

    /// Identity in the dataset.
    pub fn id(&self) -> ConditionId {
        self.flight_state.id
    }

    /// The models of one bundle, in file order.
    pub fn bundle(&self, kind: BundleKind) -> &[Model] {
        &self.bundles[kind as usize]
    }

    /// Whether the condition has identified models for its physics models to be compared with.
    pub fn has_reference(&self) -> bool {
        !self.bundle(BundleKind::Identified).is_empty()
    }

    /// Position of the model of this name in its bundle, in file order.
    pub fn position(&self, kind: BundleKind, name: &str) -> Option<usize> {
        let models = self.bundle(kind);
        let order = &self.by_name[kind as usize];
        let place = order
            .binary_search_by(|index| models[*index].name.as_str().cmp(name))
            .ok()?;
        Some(order[place])
    }

    /// The model of a bundle of this name.
    pub fn model(&self, kind: BundleKind, name: &str) -> Option<&Model> {
        Some(&self.bundle(kind)[self.position(kind, name)?])
    }

    /// Index of the nominal model in the physics bundle.
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

/// An identified bundle may be empty: models are identified once there are flight records.
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
    /// Enough to see what went wrong.
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

/// The manoeuvre that a record is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RecordKind {
    /// A frequency sweep.
    Sweep,
    /// Several sines at once.
    Multisine,
    /// Steps of three, two, one and one units of time, or doublets.
    ThreeTwoOneOne,
    /// Anything else.
    #[default]
    Other,
}

impl RecordKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [
        Self::Sweep,
        Self::Multisine,
        Self::ThreeTwoOneOne,
        Self::Other,
    ];

    /// Its word in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sweep => "sweep",
            Self::Multisine => "multisine",
            Self::ThreeTwoOneOne => "3-2-1-1",
            Self::Other => "other",
        }
    }

    /// The kind of a word.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.word() == word)
    }
}

/// A flight record of a condition: not its samples, but which file holds them and what is done with them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConditionRecord {
    /// Name, unique in the condition.
    pub name: String,
    /// The file, relative to the dataset's.
    pub file: String,
    /// Which record of the file, or which variable; none where the file holds one.
    pub variable: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    /// The manoeuvre.
    pub kind: RecordKind,
    /// Whether it is kept from identification, to validate what comes of it.
    pub held_out: bool,
    /// Whether anything is done with it at all.
    pub used: bool,
    /// Sample time \[s\], once it is known.
    pub sample_time_s: Option<f64>,
    /// First and last time \[s\] of each piece that is used, on the record's clock; none for all of it.
    pub used_s: Vec<[f64; 2]>,
    /// First and last time \[s\] of the part of what the file holds that is this record, on its clock; none for all of it.
    pub part_s: Option<[f64; 2]>,
    /// What is put right in it alone, by channel.
    pub remedies: BTreeMap<String, ChannelRemedy>,
}

/// What is put right of a channel in one record alone, where that contradicts the others (M14.16).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChannelRemedy {
    /// How much later than in the other records it is logged \[s\]: taken out.
    pub delay_s: f64,
    /// What its samples are multiplied by besides the factor of its unit.
    pub factor: f64,
}

impl ChannelRemedy {
    /// The channel as it was logged.
    pub const NONE: Self = Self {
        delay_s: 0.0,
        factor: 1.0,
    };

    /// One after the other.
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
    /// Whether both are of the same record of the same file. The folders of their files may be said from different places.
    fn is_of_same_source(&self, other: &ConditionRecord) -> bool {
        let name = |record: &Self| record.file.rsplit('/').next().map(str::to_owned);
        let differ = self
            .sha256
            .as_ref()
            .zip(other.sha256.as_ref())
            .is_some_and(|(a, b)| a != b);
        name(self) == name(other) && self.variable == other.variable && !differ
    }

    /// Whether both are the same samples, under whatever names.
    fn is_same_as(&self, other: &ConditionRecord) -> bool {
        self.part_s == other.part_s && self.is_of_same_source(other)
    }

    /// Whether it is a part of what another record is all of.
    fn is_part_of(&self, whole: &ConditionRecord) -> bool {
        self.part_s.is_some() && whole.part_s.is_none() && self.is_of_same_source(whole)
    }

    /// A record that is used, of an unknown manoeuvre.
    pub fn new(name: impl Into<String>, file: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            file: file.into(),
            used: true,
            ..Self::default()
        }
    }
}
