//! ULog, the PX4 log format (<https://docs.px4.io/main/en/dev_log/ulog_file_format.html>).
//!
//! ```text
//! header: 16 bytes
//! messages: length (16 bits), type (a letter), content
//!   B  flags, offsets of appended data   F  topic layout    A  topic, instance and message id
//!   D  message id, data of its topic     O  dropout [ms]    others: parameters, texts, marks
//! ```
//!
//! A *topic* is a layout's name with an instance, which numbers topics that have the same layout;
//! from the A message on, the D messages with its message id are this topic's samples.
//!
//! Time stamps count microseconds since the autopilot was started. A log truncated by a crash is
//! read up to its last complete message. *Appended data* are further messages, behind a log that a
//! crash cut off.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::file_error::FileError;
use crate::formats::logs::array;
use crate::formats::logs::documented_channels::{PX4, assign_documented_meanings};
use crate::formats::logs::mode_spans::modes_note;
use crate::formats::logs::topic_samples::{TopicField, TopicSamples};
use crate::formats::logs::ulog_layouts::{LayoutTexts, Place, places_in_message};
use crate::formats::logs::ulog_modes::flight_modes;
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// First bytes of a file.
const MAGIC: &[u8] = b"ULog\x01\x12\x35";
/// File header length \[bytes\].
const HEADER: usize = 16;
/// Message header length \[bytes\].
const MESSAGE_HEADER: usize = 3;
/// Incompatibility flag for appended data, the only supported one.
const APPENDED: u8 = 1;
/// Position of the incompatibility flags in the content of a flags message \[bytes\].
const INCOMPATIBILITY: Range<usize> = 8..16;
/// Position of the offsets of appended data in the content of a flags message \[bytes\].
const APPENDED_OFFSETS_AT: usize = 16;
/// Number of offsets of appended data, which have 8 bytes each; unused offsets are 0.
const APPENDED_OFFSETS: usize = 3;

/// Estimated memory for a layout without its text, which stays in the file's bytes \[bytes\].
const LAYOUT_MEMORY: u64 = 64;

/// Importer for PX4 logs.
pub(crate) const ULOG: Importer = Importer {
    name: "a PX4 ULog",
    endings: &["ulg", "ulog"],
    recognises: |bytes, _| bytes.starts_with(MAGIC),
    read: |bytes, path, budget| {
        let columns =
            read_ulog(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Logs(vec![columns]))
    },
};

/// Topic assigned to a message id, and its field positions in the messages.
struct Subscription {
    samples: TopicSamples,
    stamp: Place,
    /// Positions of all fields except the time stamp.
    places: Vec<Place>,
    /// Minimum length of a message's data \[bytes\].
    least_bytes: usize,
}

/// Content from the messages read so far.
#[derive(Default)]
struct Messages<'b> {
    layouts: LayoutTexts<'b>,
    /// Topics by message id.
    subscriptions: BTreeMap<u16, Subscription>,
    /// Number of logger dropouts.
    dropouts: usize,
    /// Total dropout duration \[ms\].
    lost_ms: u64,
    /// Number of data messages without a topic, or too short for it.
    unread: usize,
}

/// Reads a log, message by message:
///
/// 1. A message that reaches into appended data: continue there.
/// 2. A message that reaches beyond the file: the log is truncated, stop.
/// 3. The flags message gives the offsets of appended data; all others go to [`Messages::add`].
///
/// # Errors
/// [`VariableFault`] for a file shorter than its header, an unknown incompatibility flag, an
/// exceeded limit, and a log without any topic that can be read.
fn read_ulog(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    if bytes.len() < HEADER {
        return Err(VariableFault::cut_off("", bytes.len()));
    }
    let mut messages = Messages::default();
    let mut at = HEADER;
    let mut appended = Vec::new();
    let mut is_cut = false;
    while let Some([low, high, kind]) = array::<MESSAGE_HEADER>(bytes, at) {
        budget.work(1, "")?;
        let from = at + MESSAGE_HEADER;
        let to = from + usize::from(u16::from_le_bytes([low, high]));
        // Step 1: a message that reaches into appended data was cut off by a crash; continue with
        // the appended data.
        let next_part = appended.iter().copied().filter(|offset| *offset > at).min();
        if let Some(next_part) = next_part
            && to > next_part
        {
            at = next_part;
            continue;
        }
        // Step 2
        let Some(content) = bytes.get(from..to) else {
            is_cut = true;
            break;
        };
        // Step 3
        if kind == b'B' {
            appended = appended_offsets(content)?;
        } else {
            messages.add(kind, content, budget)?;
        }
        at = to;
    }
    messages.into_columns(is_cut)
}

/// Reads the offsets of appended data \[bytes\] from the content of the flags message.
///
/// # Errors
/// [`VariableFault`] if an unknown incompatibility flag is set.
fn appended_offsets(flags: &[u8]) -> Result<Vec<usize>, VariableFault> {
    let incompatible = flags.get(INCOMPATIBILITY).unwrap_or_default();
    for (index, flag) in incompatible.iter().enumerate() {
        let known = if index == 0 { APPENDED } else { 0 };
        if *flag & !known != 0 {
            return Err(VariableFault::unsupported(
                "",
                UnsupportedContent::UlogVersion,
            ));
        }
    }
    let mut offsets = Vec::new();
    for index in 0..APPENDED_OFFSETS {
        let offset = array(flags, APPENDED_OFFSETS_AT + 8 * index).map_or(0, u64::from_le_bytes);
        if offset > 0
            && let Ok(offset) = usize::try_from(offset)
        {
            offsets.push(offset);
        }
    }
    Ok(offsets)
}

impl<'b> Messages<'b> {
    /// Stores the content of a message with type `kind`; ignores unneeded types.
    fn add(
        &mut self,
        kind: u8,
        content: &'b [u8],
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        match kind {
            b'F' => self.add_layout(content, budget)?,
            b'A' => self.subscribe(content, budget)?,
            b'D' => self.add_sample(content, budget)?,
            b'O' => {
                self.dropouts += 1;
                self.lost_ms += u64::from(array(content, 0).map_or(0, u16::from_le_bytes));
            }
            _ => {}
        }
        Ok(())
    }

    /// Stores a message layout; ignores invalid text and a second layout with the same name.
    fn add_layout(
        &mut self,
        content: &'b [u8],
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        let text = std::str::from_utf8(content).unwrap_or_default();
        if let Some((name, fields)) = text.split_once(':') {
            budget.take(1, LAYOUT_MEMORY, name)?;
            self.layouts.entry(name).or_insert(fields);
        }
        Ok(())
    }

    /// Adds a data message to its topic's samples; counts it as unread if it has no topic or is too
    /// short.
    fn add_sample(
        &mut self,
        content: &[u8],
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        let message_id = array(content, 0).map(u16::from_le_bytes);
        let data = content.get(2..).unwrap_or_default();
        let topic = message_id.and_then(|id| self.subscriptions.get_mut(&id));
        if let Some(topic) = topic
            && data.len() >= topic.least_bytes
            && let Some(time_us) = topic.stamp.read(data)
        {
            let values = topic
                .places
                .iter()
                .map(|place| place.read(data).unwrap_or(f64::NAN));
            return topic.samples.push(time_us * 1e-6, values, budget);
        }
        self.unread += 1;
        Ok(())
    }

    /// Assigns a topic and its instance to a message id; ignores a second assignment, and a topic
    /// whose layout is missing, damaged or without a time stamp.
    fn subscribe(
        &mut self,
        content: &'b [u8],
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        let Some([instance, low, high]) = array::<3>(content, 0) else {
            return Ok(());
        };
        let message_id = u16::from_le_bytes([low, high]);
        let name = std::str::from_utf8(&content[3..]).unwrap_or_default();
        let mut places = match places_in_message(name, &self.layouts, budget) {
            Err(fault) if fault.is_of_the_budget() => return Err(fault),
            Err(_) => return Ok(()),
            Ok(places) => places,
        };
        let Some(stamp) = places.iter().find(|place| place.is_stamp()).cloned() else {
            return Ok(());
        };
        places.retain(|place| !place.is_stamp());
        let ends = places.iter().chain([&stamp]).map(Place::end);
        let least_bytes = ends.max().unwrap_or(0);
        let name = if instance == 0 {
            name.to_owned()
        } else {
            format!("{name}[{instance}]")
        };
        let fields = places.iter().map(|place| TopicField {
            name: place.name.clone(),
            unit: None,
            values: Vec::new(),
        });
        let samples = TopicSamples::new(name, fields.collect());
        self.subscriptions
            .entry(message_id)
            .or_insert(Subscription {
                samples,
                stamp,
                places,
                least_bytes,
            });
        Ok(())
    }

    /// Returns the columns, with their documented channels and units, the flight modes, and notes.
    /// `is_cut`: the log was truncated.
    ///
    /// # Errors
    /// [`VariableFault`] if no topic has enough samples.
    fn into_columns(self, is_cut: bool) -> Result<Columns, VariableFault> {
        let topics: Vec<TopicSamples> = self
            .subscriptions
            .into_values()
            .map(|topic| topic.samples)
            .collect();
        let modes = flight_modes(&topics);
        let mut columns = Columns::new(
            String::new(),
            topics
                .into_iter()
                .flat_map(TopicSamples::into_columns)
                .collect(),
        );
        if columns.columns.is_empty() {
            return Err(VariableFault::cut_off("", HEADER));
        }
        let notes = &mut columns.notes;
        notes.push(ReadingNote::Px4Log);
        notes.extend(assign_documented_meanings(&mut columns.columns, &PX4));
        if self.dropouts > 0 {
            notes.push(ReadingNote::Dropouts {
                count: self.dropouts,
                lost_s: self.lost_ms as f64 * 1e-3,
            });
        }
        if self.unread > 0 {
            notes.push(ReadingNote::MessagesOmitted { count: self.unread });
        }
        if is_cut {
            notes.push(ReadingNote::Truncated);
        }
        notes.extend(modes_note(&modes));
        columns.modes = modes;
        Ok(columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a ULog message of type `kind`.
    fn message(kind: u8, content: &[u8]) -> Vec<u8> {
        [&(content.len() as u16).to_le_bytes()[..], &[kind], content].concat()
    }

    fn log(samples: u64) -> Vec<u8> {
        let mut bytes = [MAGIC, &[1], &0_u64.to_le_bytes()].concat();
        bytes.extend(message(b'B', &[0; 40]));
        bytes.extend(message(
            b'F',
            b"vehicle_angular_velocity:uint64_t timestamp;float[3] xyz;uint8_t[4] _padding0;",
        ));
        bytes.extend(message(
            b'F',
            b"vehicle_status:uint64_t timestamp;uint8_t arming_state;uint8_t nav_state;",
        ));
        bytes.extend(message(
            b'A',
            &[&[0, 1, 0][..], b"vehicle_angular_velocity"].concat(),
        ));
        bytes.extend(message(
            b'A',
            &[&[1, 2, 0][..], b"vehicle_angular_velocity"].concat(),
        ));
        bytes.extend(message(b'A', &[&[0, 3, 0][..], b"vehicle_status"].concat()));
        for k in 0..samples {
            let stamp = (1_000_000 + 4000 * k).to_le_bytes();
            let xyz: Vec<u8> = [k as f32, 2.0, 3.0]
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect();
            for number in [1, 2] {
                bytes.extend(message(b'D', &[&[number, 0][..], &stamp, &xyz].concat()));
            }
            if k % 10 == 0 {
                bytes.extend(message(b'D', &[&[3, 0][..], &stamp, &[2, 15]].concat()));
            }
        }
        bytes.extend(message(b'O', &[250, 0]));
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Columns, VariableFault> {
        read_ulog(bytes, &ReadingBudget::new(1 << 20))
    }

    #[test]
    fn topics_instances_dropouts_and_modes_are_read() {
        let columns = read(&log(40)).unwrap();
        let names: Vec<&str> = columns
            .columns
            .iter()
            .map(|column| column.name.as_str())
            .collect();
        assert_eq!(names[0], "vehicle_angular_velocity.xyz[0]");
        assert_eq!(names[3], "vehicle_angular_velocity[1].xyz[0]");
        let rate = &columns.columns[0];
        assert_eq!(
            (rate.meaning, rate.unit.as_deref(), rate.values[7]),
            (Some("P"), Some("rad/s"), 7.0)
        );
        assert!((rate.topic.as_ref().unwrap().time_s[1] - 1.004).abs() < 1e-12);
        let dropouts = ReadingNote::Dropouts {
            count: 1,
            lost_s: 0.25,
        };
        assert!(columns.notes.contains(&dropouts), "{:?}", columns.notes);
        let modes: Vec<&str> = columns
            .modes
            .iter()
            .map(|span| span.name.as_str())
            .collect();
        assert_eq!(modes, ["armed", "stabilized"]);
    }

    #[test]
    fn a_log_that_is_cut_off_is_read_up_to_its_end() {
        let bytes = log(40);
        let columns = read(&bytes[..bytes.len() - 20]).unwrap();
        assert!(columns.notes.contains(&ReadingNote::Truncated));
        assert!(read(&bytes[..16]).is_err() && read(&bytes[..8]).is_err());
    }

    #[test]
    fn a_flag_of_a_later_version_is_refused() {
        let mut bytes = log(3);
        bytes[16 + 3 + 8] = 2;
        let fault = read(&bytes).err().unwrap();
        assert_eq!(
            fault,
            VariableFault::unsupported("", UnsupportedContent::UlogVersion)
        );
    }
}
