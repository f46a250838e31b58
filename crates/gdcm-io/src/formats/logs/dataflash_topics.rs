//! Samples in binary and text DataFlash logs, grouped by message name and instance.
//!
//! A *topic* holds the messages with the same name and instance, which is the number of the sensor;
//! its columns share a time axis. A message type's *layout* lists its fields
//! (`dataflash_layouts.rs`).
//!
//! Once all layouts are known, the steps in this order are: [`SampleFields::find`] for each message
//! type, [`Topics::add`] for each message, and [`Topics::into_columns`] at the end.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use gdcm_sysid::records::ModeSpan;

use crate::formats::logs::dataflash_layouts::{FieldKind, Layouts, MessageLayout};
use crate::formats::logs::documented_channels::{ARDUPILOT, assign_documented_meanings};
use crate::formats::logs::mode_spans::{mode_spans, modes_note};
use crate::formats::logs::topic_samples::{TopicField, TopicSamples};
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Messages with descriptions or parameters, which hold no samples.
const DESCRIPTIONS: [&str; 5] = ["FMT", "FMTU", "UNIT", "MULT", "PARM"];
/// Estimated memory for a topic, and for each of its fields, without samples \[bytes\].
const FIELD_MEMORY: u64 = 128;
/// Unit letter that marks the field with the sensor instance.
const INSTANCE: char = '#';

/// Message fields from which samples are read.
pub(super) struct SampleFields<'l> {
    pub(super) layout: &'l MessageLayout,
    stamp: Stamp,
    /// Index of the field with the instance; `None` if the message has no instances.
    instance: Option<usize>,
    numbers: Vec<SampleNumber>,
}

/// A message's time stamp field.
#[derive(Clone, Copy)]
struct Stamp {
    field: usize,
    /// Time stamp unit \[s\].
    unit_s: f64,
}

/// A message's numeric field.
struct SampleNumber {
    field: usize,
    multiplier: f64,
    unit: Option<String>,
}

impl<'l> SampleFields<'l> {
    /// Finds the time stamp, the instance and the numeric fields in a layout; returns `None` for a
    /// layout without a time stamp or without numeric fields, and for the messages in
    /// `DESCRIPTIONS`.
    pub(super) fn find(layout: &'l MessageLayout, layouts: &Layouts) -> Option<Self> {
        if DESCRIPTIONS.contains(&layout.name.as_str()) {
            return None;
        }
        let stamp = match layout.index_of("TimeUS") {
            Some(field) => Stamp {
                field,
                unit_s: 1e-6,
            },
            None => Stamp {
                field: layout.index_of("TimeMS")?,
                unit_s: 1e-3,
            },
        };
        let instance = layout
            .units
            .iter()
            .take(layout.fields.len())
            .position(|unit| *unit == INSTANCE);
        let mut numbers = Vec::new();
        for (index, field) in layout.fields.iter().enumerate() {
            let FieldKind::Number { factor, .. } = field.kind else {
                continue;
            };
            if index == stamp.field || Some(index) == instance {
                continue;
            }
            // Some format letters already include a factor, which the multiplier repeats.
            let multiplier = if factor == 1.0 {
                layouts.multiplier(layout, index)
            } else {
                1.0
            };
            numbers.push(SampleNumber {
                field: index,
                multiplier,
                unit: layouts.unit(layout, index),
            });
        }
        if numbers.is_empty() {
            return None;
        }
        Some(Self {
            layout,
            stamp,
            instance,
            numbers,
        })
    }
}

/// Samples read so far, by message name and instance.
#[derive(Default)]
pub(super) struct Topics {
    by_name: BTreeMap<(String, u64), TopicSamples>,
}

impl Topics {
    /// Adds a sample from a message; `value` returns the number in the field with an index. A
    /// missing number becomes NaN, a missing or invalid instance 0; a message without a time stamp
    /// is ignored.
    pub(super) fn add(
        &mut self,
        fields: &SampleFields<'_>,
        value: impl Fn(usize) -> Option<f64>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        let Some(time) = value(fields.stamp.field) else {
            return Ok(());
        };
        let instance = match fields.instance.and_then(&value) {
            Some(instance) if (0.0..=255.0).contains(&instance) => instance as u64,
            _ => 0,
        };
        let name = &fields.layout.name;
        let topic = match self.by_name.entry((name.clone(), instance)) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => {
                budget.take(fields.numbers.len() as u64 + 1, FIELD_MEMORY, name)?;
                place.insert(new_topic(fields, instance))
            }
        };
        let values = fields
            .numbers
            .iter()
            .map(|number| match value(number.field) {
                Some(value) => value * number.multiplier,
                None => f64::NAN,
            });
        topic.push(time * fields.stamp.unit_s, values, budget)
    }

    /// Returns the columns, with their documented channels and units, and the flight modes over
    /// time; their notes follow `notes`.
    ///
    /// # Errors
    /// [`VariableFault`] if no topic has enough samples.
    pub(super) fn into_columns(self, notes: Vec<ReadingNote>) -> Result<Columns, VariableFault> {
        let modes = self.flight_modes();
        let columns = self
            .by_name
            .into_values()
            .flat_map(TopicSamples::into_columns)
            .collect();
        let mut columns = Columns {
            notes,
            ..Columns::new(String::new(), columns)
        };
        if columns.columns.is_empty() {
            return Err(VariableFault::damaged("", Damage::NoTimedMessage, 0));
        }
        columns
            .notes
            .extend(assign_documented_meanings(&mut columns.columns, &ARDUPILOT));
        columns.notes.extend(modes_note(&modes));
        columns.modes = modes;
        Ok(columns)
    }

    /// Returns the spans in which the vehicle was armed, and the flight mode spans.
    fn flight_modes(&self) -> Vec<ModeSpan> {
        let mut modes = Vec::new();
        if let Some(armed) = self.states("ARM", "ArmState") {
            modes.extend(mode_spans(armed.time_s, armed.values(), |state| {
                if state == 0.0 {
                    None
                } else {
                    Some("armed".to_owned())
                }
            }));
        }
        let mode = self
            .states("MODE", "ModeNum")
            .or_else(|| self.states("MODE", "Mode"));
        if let Some(mode) = mode {
            modes.extend(mode_spans(mode.time_s, mode.values(), |mode| {
                Some(format!("mode {mode}"))
            }));
        }
        modes
    }

    /// Returns a field over time, from a message's instance 0.
    fn states(&self, name: &str, field: &str) -> Option<States<'_>> {
        let topic = self.by_name.get(&(name.to_owned(), 0))?;
        Some(States {
            time_s: &topic.time_s,
            field: topic.field(field)?,
        })
    }
}

/// A field's values over time.
struct States<'t> {
    time_s: &'t [f64],
    field: &'t TopicField,
}

impl States<'_> {
    fn values(&self) -> impl Iterator<Item = f64> {
        self.field.values.iter().copied()
    }
}

/// Creates a topic without samples for a message instance.
fn new_topic(fields: &SampleFields<'_>, instance: u64) -> TopicSamples {
    let name = &fields.layout.name;
    let name = if instance == 0 {
        name.clone()
    } else {
        format!("{name}[{instance}]")
    };
    let columns = fields.numbers.iter().map(|number| TopicField {
        name: fields.layout.fields[number.field].name.clone(),
        unit: number.unit.clone(),
        values: Vec::new(),
    });
    TopicSamples::new(name, columns.collect())
}
