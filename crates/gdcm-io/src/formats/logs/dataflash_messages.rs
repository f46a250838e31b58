//! Messages in binary and text DataFlash logs: layouts, and samples grouped by topic.
//!
//! The steps, in this order: [`MessageLayout::parse`] for each message type, then
//! [`Layouts::set_units`]; with all layouts known, [`SampleFields::find`] for each type; then
//! [`Topics::add`] for each message, and at the end [`Topics::into_columns`].

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use gdcm_sysid::records::ModeSpan;

use crate::formats::logs::meanings::{ARDUPILOT, assign_documented_meanings};
use crate::formats::logs::mode_spans::{mode_spans, modes_note};
use crate::formats::logs::topics::{TopicField, TopicSamples};
use crate::formats::recorded_columns::Columns;
use crate::formats::stored_number::{NumberClass, StoredNumber};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Names of messages that describe the log and hold no samples.
const DESCRIPTIONS: [&str; 5] = ["FMT", "FMTU", "UNIT", "MULT", "PARM"];
/// Unit letter of the field that identifies the instance of a sensor.
const INSTANCE: char = '#';

/// Data type of a message field, given by a format letter
/// (<https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html>).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FieldKind {
    /// Number that is stored divided by `factor`.
    Number { stored: StoredNumber, factor: f64 },
    /// Field that is not a number, with its length \[bytes\].
    Other(usize),
}

impl FieldKind {
    /// Returns the kind for a format letter; `None` for an unknown letter.
    fn from_letter(letter: char) -> Option<Self> {
        use NumberClass::{Float, Signed, Unsigned};
        let (class, size, factor) = match letter {
            'b' => (Signed, 1, 1.0),
            'B' | 'M' => (Unsigned, 1, 1.0),
            'h' => (Signed, 2, 1.0),
            'H' => (Unsigned, 2, 1.0),
            'i' => (Signed, 4, 1.0),
            'I' => (Unsigned, 4, 1.0),
            'q' => (Signed, 8, 1.0),
            'Q' => (Unsigned, 8, 1.0),
            'f' => (Float, 4, 1.0),
            'd' => (Float, 8, 1.0),
            'c' => (Signed, 2, 0.01),
            'C' => (Unsigned, 2, 0.01),
            'e' => (Signed, 4, 0.01),
            'E' => (Unsigned, 4, 0.01),
            'L' => (Signed, 4, 1e-7),
            'n' => return Some(Self::Other(4)),
            'N' => return Some(Self::Other(16)),
            'Z' | 'a' => return Some(Self::Other(64)),
            _ => return None,
        };
        Some(Self::Number {
            stored: StoredNumber::little_endian(class, size),
            factor,
        })
    }

    /// Length of the field \[bytes\].
    pub(super) fn size(self) -> usize {
        match self {
            Self::Number { stored, .. } => stored.size(),
            Self::Other(size) => size,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct MessageField {
    pub(super) name: String,
    pub(super) kind: FieldKind,
    /// Offset in the message content \[bytes\].
    pub(super) offset: usize,
}

impl MessageField {
    /// Returns the offset of the byte after the field \[bytes\].
    pub(super) fn end(&self) -> usize {
        self.offset + self.kind.size()
    }
}

/// Layout of all messages of one type.
#[derive(Clone, Debug)]
pub(super) struct MessageLayout {
    pub(super) name: String,
    pub(super) fields: Vec<MessageField>,
    /// Unit letters by field.
    units: Vec<char>,
    /// Multiplier letters by field.
    multipliers: Vec<char>,
}

impl MessageLayout {
    /// Builds a layout from format letters and comma-separated field names; returns `None` for an
    /// unknown letter, an empty message name, or more names than letters.
    pub(super) fn parse(name: &str, letters: &str, names: &str) -> Option<Self> {
        let mut offset = 0;
        let mut fields = Vec::new();
        for (letter, field) in letters.chars().zip(names.split(',')) {
            let kind = FieldKind::from_letter(letter)?;
            fields.push(MessageField {
                name: field.trim().to_owned(),
                kind,
                offset,
            });
            offset += kind.size();
        }
        if name.is_empty() || names.split(',').count() > letters.chars().count() {
            return None;
        }
        Some(Self {
            name: name.to_owned(),
            fields,
            units: Vec::new(),
            multipliers: Vec::new(),
        })
    }

    pub(super) fn field(&self, name: &str) -> Option<&MessageField> {
        self.fields.iter().find(|field| field.name == name)
    }

    fn index_of(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.name == name)
    }
}

/// Message layouts by type, with the meanings of the unit and multiplier letters.
#[derive(Default)]
pub(super) struct Layouts {
    pub(super) by_type: BTreeMap<u8, MessageLayout>,
    pub(super) units: BTreeMap<char, String>,
    pub(super) multipliers: BTreeMap<char, f64>,
}

impl Layouts {
    /// Sets the unit and multiplier letters of a message type.
    pub(super) fn set_units(&mut self, kind: u8, units: &str, multipliers: &str) {
        if let Some(layout) = self.by_type.get_mut(&kind) {
            layout.units = units.chars().collect();
            layout.multipliers = multipliers.chars().collect();
        }
    }

    /// Returns the unit of a field as this program writes it; `None` if the field has no unit.
    fn unit(&self, layout: &MessageLayout, field: usize) -> Option<String> {
        let unit = self.units.get(layout.units.get(field)?)?;
        match unit.as_str() {
            "m/s/s" => Some("m/s^2".to_owned()),
            "degheading" => Some("deg".to_owned()),
            "" | "UNKNOWN" | "instance" | "-" => None,
            other => Some(other.to_owned()),
        }
    }

    /// Returns the multiplier of a field; 1 if it is missing, not finite, or 0.
    fn multiplier(&self, layout: &MessageLayout, field: usize) -> f64 {
        let letter = layout.multipliers.get(field);
        match letter.and_then(|letter| self.multipliers.get(letter)) {
            Some(multiplier) if *multiplier != 0.0 && multiplier.is_finite() => *multiplier,
            _ => 1.0,
        }
    }
}

/// Message fields from which samples are read.
pub(super) struct SampleFields<'l> {
    pub(super) layout: &'l MessageLayout,
    stamp: Stamp,
    /// Index of the field that identifies the instance.
    instance: Option<usize>,
    numbers: Vec<SampleNumber>,
}

/// Time stamp field of a message.
#[derive(Clone, Copy)]
struct Stamp {
    field: usize,
    /// Unit of the time stamp \[s\].
    unit_s: f64,
}

/// Numeric field of a message.
struct SampleNumber {
    field: usize,
    multiplier: f64,
    unit: Option<String>,
}

impl<'l> SampleFields<'l> {
    /// Finds the time stamp, the instance and the numeric fields of a layout; returns `None` for a
    /// layout without a time stamp or without numeric fields, and for messages that describe the
    /// log.
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
    /// Adds a sample from a message, whose fields have the values that `value` returns for their
    /// indices; ignores a message without a time stamp.
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
                budget.take(fields.numbers.len() as u64 + 1, 128, name)?;
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
    /// time.
    pub(super) fn into_columns(self, notes: Vec<String>) -> Result<Columns, VariableFault> {
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
            return Err(VariableFault::damaged(
                "",
                "a log without a message that has time stamps and numbers",
                0,
            ));
        }
        columns
            .notes
            .extend(assign_documented_meanings(&mut columns.columns, &ARDUPILOT));
        columns.notes.extend(modes_note(&modes));
        columns.modes = modes;
        Ok(columns)
    }

    /// Returns the spans in which the vehicle was armed, and those of the flight modes.
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

    /// Returns a field over time, from instance 0 of a message.
    fn states(&self, name: &str, field: &str) -> Option<States<'_>> {
        let topic = self.by_name.get(&(name.to_owned(), 0))?;
        Some(States {
            time_s: &topic.time_s,
            field: topic.field(field)?,
        })
    }
}

/// Values of a field over time.
struct States<'t> {
    time_s: &'t [f64],
    field: &'t TopicField,
}

impl States<'_> {
    fn values(&self) -> impl Iterator<Item = f64> {
        self.field.values.iter().copied()
    }
}

/// Creates a topic without samples for an instance of a message.
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
