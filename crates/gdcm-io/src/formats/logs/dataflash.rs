//! DataFlash, the ArduPilot log format, in binary form
//! (<https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html>).
//!
//! ```text
//! message     A3 95, type (1 byte), content; the FMT messages give the length and the fields of
//!             each type
//! FMT         type (1 byte), length including the header (1 byte), name (4), a letter for each
//!             field (16), field names separated by commas (64)
//! FMTU        type, a unit letter and a multiplier letter for each field
//! UNIT, MULT  meanings of these letters
//! ```
//!
//! These messages give each type's *layout*: its fields with their positions
//! (`dataflash_layouts.rs`). Other messages with a time stamp and numbers are samples, grouped into
//! topics (`dataflash_topics.rs`).

use std::collections::BTreeMap;
use std::ops::Range;

use crate::file_error::FileError;
use crate::formats::logs::array;
use crate::formats::logs::dataflash_layouts::{FieldKind, Layouts, MessageLayout};
use crate::formats::logs::dataflash_topics::{SampleFields, Topics};
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::formats::stored_number::{NumberClass, StoredNumber};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// First bytes of each message.
const MARK: [u8; 2] = [0xa3, 0x95];
/// Message header length \[bytes\]: two mark bytes and the type.
const HEADER: usize = 3;
/// Message type of FMT messages, which describe the other messages.
const FORMAT: u8 = 128;
/// FMT message length \[bytes\].
const FORMAT_LENGTH: usize = 89;
// Positions of the texts in the content of an FMT message [bytes].
const NAME: Range<usize> = 2..6;
const LETTERS: Range<usize> = 6..22;
const FIELD_NAMES: Range<usize> = 22..86;

/// Importer for ArduPilot logs in binary form.
pub(crate) const DATAFLASH: Importer = Importer {
    name: "an ArduPilot DataFlash log",
    endings: &["bin"],
    recognises: |bytes, _| bytes.starts_with(&[MARK[0], MARK[1], FORMAT]),
    read: |bytes, path, budget| {
        let columns =
            read_dataflash(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Logs(vec![columns]))
    },
};

/// Reads a log in two passes: first all message descriptions, then the samples.
fn read_dataflash(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    // First pass
    let mut descriptions = Descriptions::new();
    let mut messages = Messages::new(bytes, budget);
    while let Some(message) = messages.next(&descriptions.lengths)? {
        descriptions.add(message);
    }
    let skipped = messages.skipped;

    let Descriptions { layouts, lengths } = descriptions;
    let mut fields_by_type: BTreeMap<u8, SampleFields<'_>> = BTreeMap::new();
    for (kind, layout) in &layouts.by_type {
        if let Some(fields) = SampleFields::find(layout, &layouts) {
            fields_by_type.insert(*kind, fields);
        }
    }
    // Second pass
    let mut topics = Topics::default();
    let mut messages = Messages::new(bytes, budget);
    while let Some(message) = messages.next(&lengths)? {
        if let Some(fields) = fields_by_type.get(&message.kind) {
            let value = |index| message.number(fields.layout, index);
            topics.add(fields, value, budget)?;
        }
    }

    let mut notes = vec![ReadingNote::ArduPilotLog];
    if skipped > 0 {
        notes.push(ReadingNote::BytesSkipped { count: skipped });
    }
    topics.into_columns(notes)
}

/// Message lengths including the header \[bytes\], by message type; 0 if unknown.
type Lengths = [usize; 256];

#[derive(Clone, Copy)]
struct Message<'b> {
    kind: u8,
    /// Bytes after the header.
    content: &'b [u8],
}

impl Message<'_> {
    /// Returns the number in the field at `index`, multiplied by the factor of its format letter;
    /// `None` if the field is missing or not numeric.
    fn number(self, layout: &MessageLayout, index: usize) -> Option<f64> {
        let field = layout.fields.get(index)?;
        match field.kind {
            FieldKind::Number { stored, factor } => {
                Some(stored.decode_at(self.content, field.offset)? * factor)
            }
            FieldKind::Other(_) => None,
        }
    }

    /// Returns the first byte in the field with this name.
    fn byte(self, layout: &MessageLayout, name: &str) -> Option<u8> {
        self.content.get(layout.field(name)?.offset).copied()
    }

    /// Returns the printable text with which the field with this name begins.
    fn text(self, layout: &MessageLayout, name: &str) -> Option<String> {
        let field = layout.field(name)?;
        self.content
            .get(field.offset..field.end())
            .map(printable_text)
    }
}

/// Position in a log, from which its messages are read one after the other.
struct Messages<'b, 'm> {
    bytes: &'b [u8],
    budget: &'m ReadingBudget<'m>,
    /// Offset of the next byte.
    at: usize,
    /// Number of skipped bytes: outside messages, or in messages that are cut or have no
    /// description.
    skipped: usize,
}

impl<'b, 'm> Messages<'b, 'm> {
    fn new(bytes: &'b [u8], budget: &'m ReadingBudget<'m>) -> Self {
        Self {
            bytes,
            budget,
            at: 0,
            skipped: 0,
        }
    }

    /// Returns the next message whose type has a length in `lengths`, or `None` at the end; counts
    /// the bytes passed over as skipped.
    fn next(&mut self, lengths: &Lengths) -> Result<Option<Message<'b>>, VariableFault> {
        while let Some([first, second, kind]) = array::<HEADER>(self.bytes, self.at) {
            self.budget.work(1, "")?;
            let length = lengths[usize::from(kind)];
            let content = self
                .bytes
                .get(self.at + HEADER..self.at + length.max(HEADER));
            if let Some(content) = content
                && [first, second] == MARK
                && length > HEADER
            {
                self.at += length;
                return Ok(Some(Message { kind, content }));
            }
            self.skipped += 1;
            self.at += 1;
        }
        Ok(None)
    }
}

/// Message descriptions read so far.
struct Descriptions {
    layouts: Layouts,
    lengths: Lengths,
}

impl Descriptions {
    fn new() -> Self {
        let mut lengths = [0; 256];
        lengths[usize::from(FORMAT)] = FORMAT_LENGTH;
        Self {
            layouts: Layouts::default(),
            lengths,
        }
    }

    /// Stores the content of a message that describes other messages; ignores any other message.
    fn add(&mut self, message: Message<'_>) {
        if message.kind == FORMAT {
            self.add_format(message.content);
            return;
        }
        let layouts = &mut self.layouts;
        let Some(layout) = layouts.by_type.get(&message.kind) else {
            return;
        };
        match layout.name.as_str() {
            "FMTU" => {
                if let Some(kind) = message.byte(layout, "FmtType")
                    && let Some(units) = message.text(layout, "UnitIds")
                    && let Some(multipliers) = message.text(layout, "MultIds")
                {
                    layouts.set_units(kind, &units, &multipliers);
                }
            }
            "UNIT" => {
                if let Some(letter) = message.byte(layout, "Id")
                    && let Some(label) = message.text(layout, "Label")
                {
                    layouts.units.insert(char::from(letter), label);
                }
            }
            "MULT" => {
                let stored = StoredNumber::little_endian(NumberClass::Float, 8);
                if let Some(letter) = message.byte(layout, "Id")
                    && let Some(field) = layout.field("Mult")
                    && let Some(multiplier) = stored.decode_at(message.content, field.offset)
                {
                    layouts.multipliers.insert(char::from(letter), multiplier);
                }
            }
            _ => {}
        }
    }

    /// Stores a message type's layout and length; ignores an invalid description.
    fn add_format(&mut self, content: &[u8]) {
        let Some([kind, length]) = array::<2>(content, 0) else {
            return;
        };
        let Some(layout) = MessageLayout::parse(
            &text_in(content, NAME),
            &text_in(content, LETTERS),
            &text_in(content, FIELD_NAMES),
        ) else {
            return;
        };
        let ends = layout.fields.iter().map(|field| field.end());
        let content_length = ends.max().unwrap_or(0);
        // A description for FMT itself is ignored: its length is fixed.
        if kind != FORMAT && usize::from(length) >= content_length + HEADER {
            self.lengths[usize::from(kind)] = usize::from(length);
            self.layouts.by_type.insert(kind, layout);
        }
    }
}

/// Returns the text in part of a message; empty if the message is shorter.
fn text_in(content: &[u8], part: Range<usize>) -> String {
    printable_text(content.get(part).unwrap_or_default())
}

/// Returns the printable ASCII characters up to the first other byte.
fn printable_text(bytes: &[u8]) -> String {
    let end = bytes
        .iter()
        .position(|byte| !(32..127).contains(byte))
        .unwrap_or(bytes.len());
    bytes[..end].iter().map(|byte| char::from(*byte)).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn padded(text: &str, length: usize) -> Vec<u8> {
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize(length, 0);
        bytes
    }

    fn message(kind: u8, content: &[u8]) -> Vec<u8> {
        [&MARK[..], &[kind], content].concat()
    }

    fn format(kind: u8, length: u8, name: &str, letters: &str, names: &str) -> Vec<u8> {
        message(
            FORMAT,
            &[
                vec![kind, length],
                padded(name, 4),
                padded(letters, 16),
                padded(names, 64),
            ]
            .concat(),
        )
    }

    /// Returns a log with `samples` samples of the rates and of two instances of an inertial unit.
    pub(in crate::formats::logs) fn log(samples: u64) -> Vec<u8> {
        let mut bytes = format(
            FORMAT,
            89,
            "FMT",
            "BBnNZ",
            "Type,Length,Name,Format,Columns",
        );
        bytes.extend(format(
            130,
            44,
            "FMTU",
            "QBNN",
            "TimeUS,FmtType,UnitIds,MultIds",
        ));
        bytes.extend(format(131, 76, "UNIT", "QbZ", "TimeUS,Id,Label"));
        bytes.extend(format(132, 20, "MULT", "Qbd", "TimeUS,Id,Mult"));
        bytes.extend(format(140, 19, "RATE", "Qff", "TimeUS,R,ROut"));
        bytes.extend(format(141, 14, "IMU", "QBh", "TimeUS,I,GyrX"));
        bytes.extend(format(142, 12, "ARM", "QB", "TimeUS,ArmState"));
        for (letter, label) in [(b'k', "deg/s"), (b'E', "rad/s"), (b's', "s")] {
            bytes.extend(message(
                131,
                &[
                    0_u64.to_le_bytes().to_vec(),
                    vec![letter],
                    padded(label, 64),
                ]
                .concat(),
            ));
        }
        for (letter, by) in [(b'C', 0.01_f64), (b'F', 1e-6)] {
            bytes.extend(message(
                132,
                &[&0_u64.to_le_bytes()[..], &[letter], &by.to_le_bytes()].concat(),
            ));
        }
        for (kind, units, by) in [(140, "sk-", "F--"), (141, "s#E", "F-C")] {
            bytes.extend(message(
                130,
                &[
                    0_u64.to_le_bytes().to_vec(),
                    vec![kind],
                    padded(units, 16),
                    padded(by, 16),
                ]
                .concat(),
            ));
        }
        for k in 0..samples {
            let stamp = (2_000_000 + 2500 * k).to_le_bytes();
            let rate: Vec<u8> = [k as f32, 0.5 * k as f32]
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect();
            bytes.extend(message(140, &[&stamp[..], &rate].concat()));
            for instance in [0, 1] {
                bytes.extend(message(
                    141,
                    &[&stamp[..], &[instance], &(100 * k as i16).to_le_bytes()].concat(),
                ));
            }
            if k % 20 == 0 {
                bytes.extend(message(142, &[&stamp[..], &[1]].concat()));
            }
        }
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Columns, VariableFault> {
        read_dataflash(bytes, &ReadingBudget::new(1 << 20))
    }

    #[test]
    fn units_instances_and_modes_are_read() {
        let columns = read(&log(40)).unwrap();
        let names: Vec<&str> = columns
            .columns
            .iter()
            .map(|column| column.name.as_str())
            .collect();
        assert_eq!(
            names,
            ["IMU.GyrX", "IMU[1].GyrX", "RATE.R", "RATE.ROut"],
            "two states are no signal"
        );
        let imu = &columns.columns[0];
        let rate = &columns.columns[2];
        assert_eq!(
            (imu.values[3], imu.unit.as_deref(), imu.meaning),
            (3.0, Some("rad/s"), None)
        );
        assert_eq!(
            (rate.values[3], rate.unit.as_deref(), rate.meaning),
            (3.0, Some("deg/s"), Some("P"))
        );
        assert!((rate.topic.as_ref().unwrap().time_s[1] - 2.0025).abs() < 1e-12);
        assert_eq!(columns.modes[0].name, "armed");
    }

    #[test]
    fn bytes_between_messages_are_skipped_and_a_cut_ends_the_log() {
        let mut bytes = log(40);
        let at = bytes.len() - 100;
        bytes.splice(at..at, [0xa3, 0x95, 7, 0]);
        // The last message, of 14 bytes, loses 5; at 7 of the others a header could begin.
        for (cut, count) in [(0, 4), (5, 4 + 7)] {
            let columns = read(&bytes[..bytes.len() - cut]).unwrap();
            let skipped = ReadingNote::BytesSkipped { count };
            assert!(columns.notes.contains(&skipped), "{:?}", columns.notes);
        }
        assert!(read(&bytes[..200]).is_err() && read(&[]).is_err());
    }
}
