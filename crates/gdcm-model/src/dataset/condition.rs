//! A flight condition with its two bundles of models and its flight records.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::channel::{BundleKind, ConditionId};
use super::model::Model;
use crate::units::number;

/// Identification and flight state of a condition: name, airspeed, altitude, weight.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightState {
    pub id: ConditionId,
    pub name: String,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Altitude class ("low", "high").
    pub altitude: Option<String>,
    pub altitude_ft: Option<f64>,
    /// Weight class ("low", "high").
    pub weight: Option<String>,
    pub mass_kg: Option<f64>,
}

impl FlightState {
    /// Creates a condition with only an airspeed \[kt\], named after its identifier.
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

/// A flight condition: physics models, exactly one of them nominal; identified models; and flight
/// records.
///
/// A condition without identified models is valid, but gives no results: it has no reference for
/// its physics models ([`Condition::has_reference`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    flight_state: FlightState,
    /// Physics models, then identified models.
    bundles: [Vec<Model>; 2],
    nominal: usize,
    records: Vec<ConditionRecord>,
    /// Indices of the physics and the identified models, sorted by name for binary search: linear
    /// look-ups would be slow for thousands of models.
    by_name: [Vec<usize>; 2],
}

/// Error for data that do not form a flight condition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConditionError {
    /// A value that is not finite, or a negative airspeed or mass.
    #[error("{field}: expected a finite number{bound}, found {}", number(*value))]
    FlightState {
        /// Quantity and unit.
        field: &'static str,
        /// " not below zero" if negative values are not permitted, otherwise empty.
        bound: &'static str,
        value: f64,
    },
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
        /// Names of the nominal models in parentheses; empty if there is none.
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
    /// A record with an invalid sample time, or with an invalid interval of time.
    #[error("record \"{name}\" (number {position}), {field}: expected {expected}, found {}", number(*value))]
    Record {
        name: String,
        position: usize,
        /// Key in the dataset file: "sample_time_s", "used_s" or "part_s".
        field: &'static str,
        expected: &'static str,
        value: f64,
    },
}

impl Condition {
    /// Creates a condition without flight records from its models in file order.
    ///
    /// # Errors
    /// [`ConditionError`] for an invalid value, an empty physics bundle, a duplicate name, or a
    /// number of nominal models other than one.
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
                let by_name = bundles.each_ref().map(|models| indices_by_name(models));
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

    /// Returns the condition with its identified models replaced and with additional flight
    /// records.
    ///
    /// A record replaces the existing record with the same name, or else the one with the same
    /// samples of the same file; otherwise it is appended. If a part of a record is added, the
    /// whole record is marked unused, so that no sample counts twice.
    ///
    /// # Errors
    /// The errors of [`Condition::new`] and [`Condition::with_records`].
    pub fn with_identified(
        &self,
        models: Vec<Model>,
        records: Vec<ConditionRecord>,
    ) -> Result<Self, ConditionError> {
        let mut kept = self.records.clone();
        for whole in &mut kept {
            if records.iter().any(|part| part.is_part_of(whole)) {
                whole.used = false;
            }
        }
        for record in records {
            let same_name = kept.iter().position(|other| other.name == record.name);
            let replaced =
                same_name.or_else(|| kept.iter().position(|other| other.is_same_as(&record)));
            match replaced {
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

    /// Returns the identification and flight state, without the models.
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

    /// Returns the index of the named model in its bundle; `None` if there is no such model.
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

    /// Returns the index of the nominal model in the physics bundle.
    pub fn nominal(&self) -> usize {
        self.nominal
    }
}

/// Returns the model indices in ascending order of names.
fn indices_by_name(models: &[Model]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..models.len()).collect();
    order.sort_by(|a, b| models[*a].name.cmp(&models[*b].name));
    order
}

fn check_flight_state(state: &FlightState) -> Result<(), ConditionError> {
    check_not_negative("airspeed [kt]", Some(state.airspeed_kt))?;
    check_finite("altitude [ft]", state.altitude_ft)?;
    check_not_negative("mass [kg]", state.mass_kg)
}

fn check_finite(field: &'static str, value: Option<f64>) -> Result<(), ConditionError> {
    match value {
        Some(value) if !value.is_finite() => Err(ConditionError::FlightState {
            field,
            bound: "",
            value,
        }),
        _ => Ok(()),
    }
}

fn check_not_negative(field: &'static str, value: Option<f64>) -> Result<(), ConditionError> {
    match value {
        Some(value) if !value.is_finite() || value < 0.0 => Err(ConditionError::FlightState {
            field,
            bound: " not below zero",
            value,
        }),
        _ => Ok(()),
    }
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
        check_times(record).map_err(|fault| ConditionError::Record {
            name: record.name.clone(),
            position: index + 1,
            field: fault.field,
            expected: fault.expected,
            value: fault.value,
        })?;
    }
    Ok(())
}

/// A sample time or interval end out of range.
struct TimeFault {
    field: &'static str,
    expected: &'static str,
    value: f64,
}

/// Checks the sample time and the time intervals of a record.
fn check_times(record: &ConditionRecord) -> Result<(), TimeFault> {
    if let Some(value) = record.sample_time_s
        && (!value.is_finite() || value <= 0.0)
    {
        return Err(TimeFault {
            field: "sample_time_s",
            expected: "a positive number of seconds",
            value,
        });
    }
    for piece in &record.used_s {
        check_piece("used_s", *piece)?;
    }
    if let Some(part) = record.part_s {
        check_piece("part_s", part)?;
    }
    Ok(())
}

fn check_piece(field: &'static str, [first, last]: [f64; 2]) -> Result<(), TimeFault> {
    if !first.is_finite() {
        return Err(TimeFault {
            field,
            expected: "finite times",
            value: first,
        });
    }
    if !last.is_finite() || last < first {
        return Err(TimeFault {
            field,
            expected: "a finite last time, not before the first",
            value: last,
        });
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

/// The manoeuvre flown in a record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RecordKind {
    Sweep,
    /// Sum of sines.
    Multisine,
    /// 3-2-1-1 (steps of three, two, one and one time units), or doublets.
    ThreeTwoOneOne,
    #[default]
    Other,
}

impl RecordKind {
    pub const ALL: [Self; 4] = [
        Self::Sweep,
        Self::Multisine,
        Self::ThreeTwoOneOne,
        Self::Other,
    ];

    /// Returns the keyword of the manoeuvre in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Sweep => "sweep",
            Self::Multisine => "multisine",
            Self::ThreeTwoOneOne => "3-2-1-1",
            Self::Other => "other",
        }
    }

    /// Parses a keyword; `None` for an unknown word.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.word() == word)
    }
}

/// Reference to a flight record: the file with its samples, and how they are used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConditionRecord {
    /// Name, unique in the condition.
    pub name: String,
    /// Path relative to the dataset's file.
    pub file: String,
    /// Name of the record or variable in the file; `None` if the file holds a single record.
    pub variable: Option<String>,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: Option<String>,
    pub kind: RecordKind,
    /// Whether the record is reserved for validation and not used for identification.
    pub held_out: bool,
    /// Whether the record is used at all, for identification or validation.
    pub used: bool,
    /// Sample time \[s\]; `None` until the record has been read.
    pub sample_time_s: Option<f64>,
    /// Intervals in use: first and last time \[s\] on the record's time axis; empty if the whole
    /// record is used.
    pub used_s: Vec<[f64; 2]>,
    /// Interval of the file that forms this record: first and last time \[s\] on the file's time
    /// axis; `None` for the whole file.
    pub part_s: Option<[f64; 2]>,
    /// Channel corrections specific to this record, by channel name.
    pub remedies: BTreeMap<String, ChannelRemedy>,
}

/// Correction of a channel in a record that is inconsistent with the other records (M14.16).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChannelRemedy {
    /// Extra logging delay \[s\] relative to the other records; it is removed.
    pub delay_s: f64,
    /// Factor on the channel's samples, in addition to the unit conversion.
    pub factor: f64,
}

impl ChannelRemedy {
    /// No correction: no delay, factor 1.
    pub const NONE: Self = Self {
        delay_s: 0.0,
        factor: 1.0,
    };

    /// Returns the correction that applies `self`, then `next`.
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
    /// Returns whether both entries refer to the same record of the same file. Only file names are
    /// compared, because the paths may be relative to different folders.
    fn is_of_same_source(&self, other: &ConditionRecord) -> bool {
        let contents_differ = match (&self.sha256, &other.sha256) {
            (Some(a), Some(b)) => a != b,
            _ => false,
        };
        self.file_name() == other.file_name() && self.variable == other.variable && !contents_differ
    }

    /// Returns the file name without folders.
    fn file_name(&self) -> &str {
        self.file.rsplit('/').next().unwrap_or_default()
    }

    /// Returns whether both entries refer to the same samples, under any name.
    fn is_same_as(&self, other: &ConditionRecord) -> bool {
        self.part_s == other.part_s && self.is_of_same_source(other)
    }

    /// Returns whether this entry is a part of the full record `whole`.
    fn is_part_of(&self, whole: &ConditionRecord) -> bool {
        self.part_s.is_some() && whole.part_s.is_none() && self.is_of_same_source(whole)
    }

    /// Creates an entry for a whole record in use, with an unknown manoeuvre.
    pub fn new(name: impl Into<String>, file: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            file: file.into(),
            used: true,
            ..Self::default()
        }
    }
}
