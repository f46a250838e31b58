//! ULog, the logs of PX4 (<https://docs.px4.io/main/en/dev_log/ulog_file_format.html>).
//!
//! ```text
//! 16 bytes of header
//! messages: length (16 bits), type (a letter), content
//!   B  flags, and where data were appended     F  layout of a topic      A  topic and instance of a number
//!   D  number, then the data of that topic     O  a dropout [ms]         others: parameters, texts, marks
//! ```
//!
//! Stamps are microseconds since the start of the autopilot. A log cut off by a crash is read up to
//! its end.

use std::collections::BTreeMap;

use gdcm_sysid::records::ModeSpan;

use crate::file_error::FileError;
use crate::formats::logs::{PX4, TopicSamples, array, give_meanings, mode_spans, modes_note};
use crate::formats::recorded_columns::Columns;
use crate::formats::strides::{NumberClass, StoredNumber};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

const MAGIC: &[u8] = b"ULog\x01\x12\x35";
const HEADER: usize = 16;
/// Flag for appended data, the only flag that a reader must know.
const APPENDED: u8 = 1;

/// Logs of PX4.
pub(crate) const ULOG: Importer = Importer {
    name: "a ULog of PX4",
    endings: &["ulg", "ulog"],
    recognises: |bytes, _| bytes.starts_with(MAGIC),
    read: |bytes, path, budget| {
        let columns =
            read_ulog(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Logs(vec![columns]))
    },
};

/// A subscribed topic and the positions of its data in a message.
struct Subscription {
    samples: TopicSamples,
    stamp: Place,
    places: Vec<Place>,
    /// Shortest possible data of the topic \[bytes\].
    least: usize,
}

#[derive(Default)]
struct Messages<'b> {
    formats: Formats<'b>,
    subscriptions: BTreeMap<u16, Subscription>,
    dropouts: usize,
    lost_ms: u64,
    unread: usize,
}

fn read_ulog(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    if bytes.len() < HEADER {
        return Err(VariableFault::cut_off("", bytes.len()));
    }
    let mut messages = Messages::default();
    let mut at = HEADER;
    let mut appended = Vec::new();
    let mut is_cut = false;
    while let Some([low, high, kind]) = array::<3>(bytes, at) {
        budget.work(1, "")?;
        let from = at + 3;
        let to = from + usize::from(u16::from_le_bytes([low, high]));
        // A message cut off by a crash ends where data were appended.
        let next = appended.iter().copied().filter(|offset| *offset > at).min();
        if next.is_some_and(|next| to > next) {
            at = next.unwrap_or(to);
            continue;
        }
        let Some(content) = bytes.get(from..to) else {
            is_cut = true;
            break;
        };
        if kind == b'B' {
            appended = offsets_of(content)?;
        } else {
            messages.take(kind, content, budget)?;
        }
        at = to;
    }
    messages.columns(is_cut)
}

/// Reads the offsets of appended data.
fn offsets_of(flags: &[u8]) -> Result<Vec<usize>, VariableFault> {
    let unknown = flags.get(8..16).unwrap_or_default().iter().enumerate();
    if unknown
        .into_iter()
        .any(|(index, byte)| *byte & !(if index == 0 { APPENDED } else { 0 }) != 0)
    {
        let remedy = "save its topics as CSV: ulog2csv \"{file}\"";
        return Err(VariableFault::unsupported(
            "",
            "a ULog with parts of a later version",
            remedy,
        ));
    }
    let offsets = (0..3).filter_map(|index| array(flags, 16 + 8 * index).map(u64::from_le_bytes));
    Ok(offsets
        .filter(|offset| *offset > 0)
        .filter_map(|offset| usize::try_from(offset).ok())
        .collect())
}

impl<'b> Messages<'b> {
    fn take(
        &mut self,
        kind: u8,
        content: &'b [u8],
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        match kind {
            b'F' => {
                let text = std::str::from_utf8(content).unwrap_or_default();
                if let Some((name, fields)) = text.split_once(':') {
                    budget.take(1, 64, name)?;
                    self.formats.entry(name).or_insert(fields);
                }
            }
            b'A' => self.subscribe(content, budget)?,
            b'D' => {
                let number = array(content, 0).map(u16::from_le_bytes);
                let data = content.get(2..).unwrap_or_default();
                let Some(topic) = number.and_then(|number| self.subscriptions.get_mut(&number))
                else {
                    self.unread += 1;
                    return Ok(());
                };
                let time_us = topic.stamp.number.at(data, topic.stamp.offset);
                let Some(time_us) = time_us.filter(|_| data.len() >= topic.least) else {
                    self.unread += 1;
                    return Ok(());
                };
                let values = topic
                    .places
                    .iter()
                    .map(|place| place.number.at(data, place.offset).unwrap_or(f64::NAN));
                topic.samples.push(time_us * 1e-6, values, budget)?;
            }
            b'O' => {
                self.dropouts += 1;
                self.lost_ms += array(content, 0)
                    .map(u16::from_le_bytes)
                    .map_or(0, u64::from);
            }
            _ => {}
        }
        Ok(())
    }

    /// Registers a topic and its instance under a number; skips a layout that is damaged or lacks a
    /// time stamp.
    fn subscribe(
        &mut self,
        content: &'b [u8],
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        let (Some([instance]), Some(number)) = (
            array::<1>(content, 0),
            array(content, 1).map(u16::from_le_bytes),
        ) else {
            return Ok(());
        };
        let name = std::str::from_utf8(content.get(3..).unwrap_or_default()).unwrap_or_default();
        let (places, _) = match places_of(name, &self.formats, budget) {
            Err(fault) if fault.is_of_the_budget() => return Err(fault),
            Err(_) => return Ok(()),
            Ok(places) => places,
        };
        let is_stamp = |place: &Place| {
            place.name == "timestamp" && Some(place.number) == number_of("uint64_t")
        };
        let Some(stamp) = places.iter().find(|place| is_stamp(place)).cloned() else {
            return Ok(());
        };
        let places: Vec<Place> = places
            .into_iter()
            .filter(|place| !is_stamp(place))
            .collect();
        let least = places
            .iter()
            .chain([&stamp])
            .map(|place| place.offset + place.number.size())
            .max()
            .unwrap_or(0);
        let name = if instance == 0 {
            name.to_owned()
        } else {
            format!("{name}[{instance}]")
        };
        let samples =
            TopicSamples::new(name, places.iter().map(|place| (place.name.clone(), None)));
        self.subscriptions.entry(number).or_insert(Subscription {
            samples,
            stamp,
            places,
            least,
        });
        Ok(())
    }

    fn columns(self, is_cut: bool) -> Result<Columns, VariableFault> {
        let topics: Vec<TopicSamples> = self
            .subscriptions
            .into_values()
            .map(|topic| topic.samples)
            .collect();
        let modes = modes_of(&topics);
        let mut columns = Columns::new(
            String::new(),
            topics.into_iter().flat_map(TopicSamples::columns).collect(),
        );
        if columns.columns.is_empty() {
            return Err(VariableFault::cut_off("", HEADER));
        }
        columns
            .notes
            .push("a log of PX4; time in seconds since the autopilot was started".to_owned());
        columns
            .notes
            .extend(give_meanings(&mut columns.columns, &PX4));
        if self.dropouts > 0 {
            let lost_s = self.lost_ms as f64 * 1e-3;
            columns.notes.push(format!(
                "{} dropouts of the logger, {lost_s:.2} s together: gaps",
                self.dropouts
            ));
        }
        if self.unread > 0 {
            columns.notes.push(format!(
                "{} messages that are of no topic, or too short: left out",
                self.unread
            ));
        }
        if is_cut {
            columns
                .notes
                .push("the file is cut off: read as far as it goes".to_owned());
        }
        columns.notes.extend(modes_note(&modes));
        columns.modes = modes;
        Ok(columns)
    }
}

/// Finds the armed spans and the flight modes (`vehicle_status`: `arming_state` 2 is armed,
/// `nav_state` follows PX4's message).
fn modes_of(topics: &[TopicSamples]) -> Vec<ModeSpan> {
    let Some(status) = topics.iter().find(|topic| topic.name == "vehicle_status") else {
        return Vec::new();
    };
    let values = |name: &str| {
        status
            .fields
            .iter()
            .find(|field| field.name == name)
            .map(|field| field.values.clone())
    };
    let mut modes = Vec::new();
    if let Some(values) = values("arming_state") {
        modes.extend(mode_spans(&status.time_s, values, |state| {
            (state == 2.0).then(|| "armed".to_owned())
        }));
    }
    if let Some(values) = values("nav_state") {
        let name = |state| {
            NAVIGATION
                .iter()
                .find(|(number, _)| f64::from(*number) == state)
        };
        modes.extend(mode_spans(&status.time_s, values, |state| {
            name(state).map(|(_, name)| (*name).to_owned())
        }));
    }
    modes
}

/// `VehicleStatus.msg` of PX4 1.14 to 1.16: `NAVIGATION_STATE_…`.
const NAVIGATION: [(u8, &str); 13] = [
    (0, "manual"),
    (1, "altitude"),
    (2, "position"),
    (3, "mission"),
    (4, "loiter"),
    (5, "return"),
    (10, "acro"),
    (12, "descend"),
    (14, "offboard"),
    (15, "stabilized"),
    (17, "take-off"),
    (18, "land"),
    (21, "orbit"),
];

// Message layouts: fields that are numbers, arrays or other layouts, flattened to a list of
// numbers.

/// Largest message, limited by its 16-bit length \[bytes\].
const LARGEST: usize = 65_535;
/// Deepest nesting of layouts.
const DEEPEST: usize = 8;

/// A number in the data of a message.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// For example `xyz[0]`, `esc[1].esc_rpm`.
    pub(super) name: String,
    pub(super) number: StoredNumber,
    pub(super) offset: usize,
}

/// Layouts by message name, as written in the file: `uint64_t timestamp;float[3] xyz`.
pub(super) type Formats<'b> = BTreeMap<&'b str, &'b str>;

/// Returns the numbers in a message of this name and its length in bytes.
///
/// # Errors
/// A layout that is missing, recursive, or longer than the largest message.
pub(super) fn places_of(
    name: &str,
    formats: &Formats<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<(Vec<Place>, usize), VariableFault> {
    let mut flat = Flat {
        formats,
        budget,
        message: name,
        places: Vec::new(),
    };
    let size = flat.add(name, "", 0, DEEPEST)?;
    Ok((flat.places, size))
}

struct Flat<'a> {
    formats: &'a Formats<'a>,
    budget: &'a ReadingBudget<'a>,
    message: &'a str,
    places: Vec<Place>,
}

impl Flat<'_> {
    fn damaged(&self, what: String) -> VariableFault {
        VariableFault::damaged(self.message, what, 0)
    }

    /// Adds the numbers of a layout from an offset on; returns the end offset.
    fn add(
        &mut self,
        name: &str,
        prefix: &str,
        mut offset: usize,
        deeper: usize,
    ) -> Result<usize, VariableFault> {
        if deeper == 0 {
            return Err(VariableFault::too_deep(self.message));
        }
        let Some(fields) = self.formats.get(name) else {
            return Err(self.damaged(format!("the layout of \"{}\" is missing", short(name))));
        };
        for field in fields
            .split(';')
            .map(str::trim)
            .filter(|field| !field.is_empty())
        {
            let Some((kind, field)) = field.split_once(' ') else {
                return Err(self.damaged(format!("\"{}\" is no field", short(field))));
            };
            let is_array = kind.ends_with(']');
            let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
                Some((kind, count)) => (
                    kind,
                    count
                        .parse::<usize>()
                        .ok()
                        .filter(|count| *count <= LARGEST),
                ),
                None => (kind, Some(1)),
            };
            let Some(count) = count else {
                return Err(self.damaged(format!("\"{}\" has no length", short(field))));
            };
            for index in 0..count {
                let label = if is_array {
                    format!("{prefix}{field}[{index}]")
                } else {
                    format!("{prefix}{field}")
                };
                let begin = offset;
                self.budget.work(1, self.message)?;
                offset = match number_of(kind) {
                    Some(number) => {
                        if !field.starts_with("_padding") {
                            self.budget.take(
                                1,
                                (size_of::<Place>() + label.len()) as u64,
                                self.message,
                            )?;
                            self.places.push(Place {
                                name: label,
                                number,
                                offset,
                            });
                        }
                        offset + number.size()
                    }
                    None if kind == "char" => offset + 1,
                    None => self.add(kind, &format!("{label}."), offset, deeper - 1)?,
                };
                // Fields without bytes could be repeated without limit.
                if offset == begin || offset > LARGEST {
                    return Err(self.damaged(format!(
                        "the field \"{}\" has no length, or too much",
                        short(field)
                    )));
                }
            }
        }
        Ok(offset)
    }
}

/// Returns the number type of a C type name, or nothing if it is unknown.
fn number_of(kind: &str) -> Option<StoredNumber> {
    use NumberClass::{Float, Signed, Unsigned};
    let (class, size) = match kind {
        "int8_t" => (Signed, 1),
        "uint8_t" | "bool" => (Unsigned, 1),
        "int16_t" => (Signed, 2),
        "uint16_t" => (Unsigned, 2),
        "int32_t" => (Signed, 4),
        "uint32_t" => (Unsigned, 4),
        "int64_t" => (Signed, 8),
        "uint64_t" => (Unsigned, 8),
        "float" => (Float, 4),
        "double" => (Float, 8),
        _ => return None,
    };
    Some(StoredNumber::little_endian(class, size))
}

/// Shortens a name for a message.
fn short(name: &str) -> String {
    name.chars()
        .take(60)
        .filter(|letter| !letter.is_control())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A message of a ULog.
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
        assert!(
            columns
                .notes
                .iter()
                .any(|note| note == "1 dropouts of the logger, 0.25 s together: gaps")
        );
        let modes: Vec<&str> = columns
            .modes
            .iter()
            .map(|span| span.name.as_str())
            .collect();
        assert_eq!(modes, ["armed", "stabilized"]);
    }

    #[test]
    fn a_log_that_is_cut_off_is_read_as_far_as_it_goes() {
        let bytes = log(40);
        let columns = read(&bytes[..bytes.len() - 20]).unwrap();
        assert!(columns.notes.iter().any(|note| note.contains("cut off")));
        assert!(read(&bytes[..16]).is_err() && read(&bytes[..8]).is_err());
    }

    #[test]
    fn a_flag_of_a_later_version_is_refused() {
        let mut bytes = log(3);
        bytes[16 + 3 + 8] = 2;
        assert!(read(&bytes).err().unwrap().to_string().contains("ulog2csv"));
    }
}

#[cfg(test)]
mod layout_tests {
    use super::*;

    #[test]
    fn layouts_inside_layouts_become_a_flat_list() {
        let formats = Formats::from([
            ("esc", "uint64_t timestamp;one[2] esc;uint8_t[3] _padding0;"),
            ("one", "int16_t rpm;char[4] name;float v"),
        ]);
        let (places, size) = places_of("esc", &formats, &ReadingBudget::new(1 << 20)).unwrap();
        let found: Vec<(&str, usize)> = places
            .iter()
            .map(|place| (place.name.as_str(), place.offset))
            .collect();
        let expected = [
            ("timestamp", 0),
            ("esc[0].rpm", 8),
            ("esc[0].v", 14),
            ("esc[1].rpm", 18),
            ("esc[1].v", 24),
        ];
        assert_eq!((found, size), (expected.to_vec(), 31));
    }

    #[test]
    fn circles_and_layouts_without_bytes_are_refused() {
        let formats = Formats::from([
            ("a", "a x"),
            ("b", "none[60000] x"),
            ("none", ""),
            ("c", "float[99999999] x"),
        ]);
        for name in ["a", "b", "c", "d"] {
            assert!(
                places_of(name, &formats, &ReadingBudget::new(1 << 20)).is_err(),
                "{name}"
            );
        }
    }
}
