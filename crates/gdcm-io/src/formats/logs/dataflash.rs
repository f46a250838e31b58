//! DataFlash, the log format of ArduPilot: binary form, text form and their common parts
//! (<https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html>).
//!
//! ```text
//! A3 95, type, content; how long the content of a type is, and what it holds, FMT messages say:
//! FMT  type, length with these three bytes, name, a letter for each field, names of the fields
//! FMTU type, a letter of a unit and one of a multiplier for each field
//! UNIT, MULT  what these letters mean
//! ```

use std::collections::BTreeMap;

use crate::file_error::FileError;
use crate::formats::logs::{ARDUPILOT, TopicSamples, array, give_meanings, mode_spans, modes_note};
use crate::formats::recorded_columns::Columns;
use crate::formats::strides::{NumberClass, StoredNumber};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

const MARK: [u8; 2] = [0xa3, 0x95];
/// Type and length of the messages that describe other messages.
const FORMAT: u8 = 128;
const FORMAT_LENGTH: usize = 89;

/// Binary logs of ArduPilot.
pub(crate) const DATAFLASH: Importer = Importer {
    name: "a DataFlash log of ArduPilot",
    endings: &["bin"],
    recognises: |bytes, _| bytes.starts_with(&[MARK[0], MARK[1], FORMAT]),
    read: |bytes, path, budget| {
        let columns =
            read_dataflash(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Logs(vec![columns]))
    },
};

// Message descriptions, shared by both forms.

/// Kind of a message field, given by its letter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FieldKind {
    /// A number and its multiplier.
    Number(StoredNumber, f64),
    /// Bytes that are not a number, with their length.
    Other(usize),
}

impl FieldKind {
    /// Returns the kind of a format letter, or nothing if the letter is unknown.
    fn of(letter: char) -> Option<Self> {
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
        Some(Self::Number(
            StoredNumber::little_endian(class, size),
            factor,
        ))
    }

    fn size(self) -> usize {
        match self {
            Self::Number(number, _) => number.size(),
            Self::Other(size) => size,
        }
    }
}

/// Layout of a message type.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) name: String,
    /// Kind, offset and name of each field.
    pub(super) fields: Vec<(FieldKind, usize, String)>,
    /// Letters of units and multipliers.
    units: Vec<char>,
    multipliers: Vec<char>,
}

impl Layout {
    /// Builds a layout from its letters and names; returns nothing for an unknown letter or too
    /// many names.
    pub(super) fn of(name: &str, letters: &str, names: &str) -> Option<Self> {
        let mut offset = 0;
        let mut fields = Vec::new();
        for (letter, field) in letters.chars().zip(names.split(',')) {
            let kind = FieldKind::of(letter)?;
            fields.push((kind, offset, field.trim().to_owned()));
            offset += kind.size();
        }
        let is_whole = !name.is_empty() && names.split(',').count() <= letters.chars().count();
        is_whole.then(|| Self {
            name: name.to_owned(),
            fields,
            units: Vec::new(),
            multipliers: Vec::new(),
        })
    }
}

/// Layouts of a log by type, with the meanings of the unit letters.
#[derive(Default)]
pub(super) struct Layouts {
    pub(super) by_type: BTreeMap<u8, Layout>,
    pub(super) units: BTreeMap<char, String>,
    pub(super) multipliers: BTreeMap<char, f64>,
}

impl Layouts {
    pub(super) fn describe(&mut self, kind: u8, units: &str, multipliers: &str) {
        if let Some(layout) = self.by_type.get_mut(&kind) {
            layout.units = units.chars().collect();
            layout.multipliers = multipliers.chars().collect();
        }
    }
}

/// Topics of a log during reading: one for each message and instance.
#[derive(Default)]
pub(super) struct Topics {
    by_name: BTreeMap<(String, u64), TopicSamples>,
}

/// The parts of a message that are used.
pub(super) struct Taken<'l> {
    layout: &'l Layout,
    /// Position of the time stamp, and the duration of its unit \[s\].
    stamp: (usize, f64),
    instance: Option<usize>,
    /// Positions of the numbers, their multipliers and their units.
    numbers: Vec<(usize, f64, Option<String>)>,
}

impl<'l> Taken<'l> {
    /// Finds the time stamp, the instance and the numbers of a layout; returns nothing without a
    /// stamp or numbers.
    pub(super) fn of(layout: &'l Layout, layouts: &Layouts) -> Option<Self> {
        if ["FMT", "FMTU", "UNIT", "MULT", "PARM"].contains(&layout.name.as_str()) {
            return None;
        }
        let place = |wanted: &str| layout.fields.iter().position(|(.., name)| name == wanted);
        let stamp = place("TimeUS")
            .map(|at| (at, 1e-6))
            .or_else(|| place("TimeMS").map(|at| (at, 1e-3)))?;
        let instance = layout
            .units
            .iter()
            .position(|unit| *unit == '#')
            .filter(|at| *at < layout.fields.len());
        let number = |(at, (kind, ..)): (usize, &(FieldKind, usize, String))| {
            let FieldKind::Number(_, factor) = *kind else {
                return None;
            };
            if at == stamp.0 || Some(at) == instance {
                return None;
            }
            let multiplier = layout
                .multipliers
                .get(at)
                .and_then(|letter| layouts.multipliers.get(letter));
            // Format letters for hundredths repeat the factor in the multiplier.
            let multiplier = multiplier
                .copied()
                .filter(|by| factor == 1.0 && *by != 0.0 && by.is_finite());
            let unit = layout
                .units
                .get(at)
                .and_then(|letter| layouts.units.get(letter));
            Some((
                at,
                multiplier.unwrap_or(1.0),
                unit.map(|unit| spelt(unit)).filter(|unit| !unit.is_empty()),
            ))
        };
        let numbers: Vec<_> = layout
            .fields
            .iter()
            .enumerate()
            .filter_map(number)
            .collect();
        (!numbers.is_empty()).then_some(Self {
            layout,
            stamp,
            instance,
            numbers,
        })
    }
}

/// Converts a unit of these logs to the spelling of this program.
fn spelt(unit: &str) -> String {
    match unit {
        "m/s/s" => "m/s^2".to_owned(),
        "degheading" => "deg".to_owned(),
        "UNKNOWN" | "instance" | "-" => String::new(),
        other => other.to_owned(),
    }
}

impl Topics {
    /// Takes a message; `value` returns the field at an index.
    pub(super) fn take(
        &mut self,
        taken: &Taken<'_>,
        value: impl Fn(usize) -> Option<f64>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        let Some(time) = value(taken.stamp.0) else {
            return Ok(());
        };
        let instance = taken
            .instance
            .and_then(&value)
            .filter(|of| (0.0..=255.0).contains(of))
            .unwrap_or(0.0) as u64;
        let name = &taken.layout.name;
        let topic = match self.by_name.entry((name.clone(), instance)) {
            std::collections::btree_map::Entry::Occupied(known) => known.into_mut(),
            std::collections::btree_map::Entry::Vacant(new) => {
                budget.take(taken.numbers.len() as u64 + 1, 128, name)?;
                let full = if instance == 0 {
                    name.clone()
                } else {
                    format!("{name}[{instance}]")
                };
                let field = |(at, _, unit): &(usize, f64, Option<String>)| {
                    (taken.layout.fields[*at].2.clone(), unit.clone())
                };
                new.insert(TopicSamples::new(full, taken.numbers.iter().map(field)))
            }
        };
        let values = taken
            .numbers
            .iter()
            .map(|(at, factor, _)| value(*at).map_or(f64::NAN, |value| value * factor));
        topic.push(time * taken.stamp.1, values, budget)
    }

    /// Returns the columns with their documented meanings and the flight modes over time.
    pub(super) fn columns(self, notes: Vec<String>) -> Result<Columns, VariableFault> {
        let states = |name: &str, field: &str| {
            let topic = self.by_name.get(&(name.to_owned(), 0))?;
            let field = topic.fields.iter().find(|of| of.name == field)?;
            Some((topic.time_s.clone(), field.values.clone()))
        };
        let mut modes = Vec::new();
        if let Some((times, values)) = states("ARM", "ArmState") {
            modes.extend(mode_spans(&times, values, |state| {
                (state != 0.0).then(|| "armed".to_owned())
            }));
        }
        if let Some((times, values)) = states("MODE", "ModeNum").or_else(|| states("MODE", "Mode"))
        {
            modes.extend(mode_spans(&times, values, |mode| {
                Some(format!("mode {mode}"))
            }));
        }
        let columns = self
            .by_name
            .into_values()
            .flat_map(TopicSamples::columns)
            .collect();
        let mut columns = Columns {
            notes,
            ..Columns::new(String::new(), columns)
        };
        if columns.columns.is_empty() {
            return Err(VariableFault::damaged(
                "",
                "a log without a message that has stamps and numbers",
                0,
            ));
        }
        columns
            .notes
            .extend(give_meanings(&mut columns.columns, &ARDUPILOT));
        columns.notes.extend(modes_note(&modes));
        columns.modes = modes;
        Ok(columns)
    }
}

// Binary form.

fn read_dataflash(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    let mut layouts = Layouts::default();
    let mut lengths = [0_usize; 256];
    lengths[usize::from(FORMAT)] = FORMAT_LENGTH;
    let skipped = each_message(bytes, &mut lengths, budget, |kind, content, lengths| {
        describe(kind, content, &mut layouts, lengths);
        Ok(())
    })?;
    let taken: BTreeMap<u8, Taken<'_>> = layouts
        .by_type
        .iter()
        .filter_map(|(kind, layout)| Some((*kind, Taken::of(layout, &layouts)?)))
        .collect();
    let mut topics = Topics::default();
    each_message(
        bytes,
        &mut lengths,
        budget,
        |kind, content, _| match taken.get(&kind) {
            None => Ok(()),
            Some(taken) => {
                let value = |at: usize| match taken.layout.fields.get(at)? {
                    (FieldKind::Number(number, factor), offset, _) => {
                        Some(number.at(content, *offset)? * factor)
                    }
                    _ => None,
                };
                topics.take(taken, value, budget)
            }
        },
    )?;
    let mut notes =
        vec!["a log of ArduPilot; time in seconds since the autopilot was started".to_owned()];
    if skipped > 0 {
        notes.push(format!(
            "{skipped} bytes between messages are none: left out"
        ));
    }
    topics.columns(notes)
}

/// Passes each message to `take`, which may learn the lengths of other messages from it; returns
/// the number of bytes outside messages.
fn each_message(
    bytes: &[u8],
    lengths: &mut [usize; 256],
    budget: &ReadingBudget<'_>,
    mut take: impl FnMut(u8, &[u8], &mut [usize; 256]) -> Result<(), VariableFault>,
) -> Result<usize, VariableFault> {
    let mut at = 0;
    let mut skipped = 0;
    while let Some([first, second, kind]) = array::<3>(bytes, at) {
        budget.work(1, "")?;
        let length = lengths[usize::from(kind)];
        let content = bytes.get(at + 3..at + length.max(3));
        match content.filter(|_| [first, second] == MARK && length > 3) {
            Some(content) => {
                take(kind, content, lengths)?;
                at += length;
            }
            None => {
                skipped += 1;
                at += 1;
            }
        }
    }
    Ok(skipped)
}

/// Learns the description of other messages from a message.
fn describe(kind: u8, content: &[u8], layouts: &mut Layouts, lengths: &mut [usize; 256]) {
    if kind == FORMAT {
        let Some([of, length]) = array::<2>(content, 0) else {
            return;
        };
        let text = |from: usize, to: usize| letters(content.get(from..to).unwrap_or_default());
        if let Some(layout) = Layout::of(&text(2, 6), &text(6, 22), &text(22, 86)) {
            let needed = layout
                .fields
                .iter()
                .map(|(kind, offset, _)| offset + kind.size())
                .max()
                .unwrap_or(0);
            // The length of a description is known; the lengths of other messages are read here.
            if of != FORMAT && usize::from(length) >= needed + 3 {
                lengths[usize::from(of)] = usize::from(length);
                layouts.by_type.insert(of, layout);
            }
        }
        return;
    }
    let Some(layout) = layouts.by_type.get(&kind).cloned() else {
        return;
    };
    let place = |wanted: &str| layout.fields.iter().find(|(.., name)| name == wanted);
    let byte = |name: &str| place(name).and_then(|(_, offset, _)| content.get(*offset).copied());
    let text = |name: &str| {
        let (kind, offset, _) = place(name)?;
        Some(letters(content.get(*offset..offset + kind.size())?))
    };
    match layout.name.as_str() {
        "FMTU" => {
            if let (Some(of), Some(units), Some(by)) =
                (byte("FmtType"), text("UnitIds"), text("MultIds"))
            {
                layouts.describe(of, &units, &by);
            }
        }
        "UNIT" => {
            if let (Some(letter), Some(label)) = (byte("Id"), text("Label")) {
                layouts.units.insert(char::from(letter), label);
            }
        }
        "MULT" => {
            let by = place("Mult").and_then(|(_, offset, _)| {
                StoredNumber::little_endian(NumberClass::Float, 8).at(content, *offset)
            });
            if let (Some(letter), Some(by)) = (byte("Id"), by) {
                layouts.multipliers.insert(char::from(letter), by);
            }
        }
        _ => {}
    }
}

/// Printable ASCII text up to the first other byte.
fn letters(bytes: &[u8]) -> String {
    bytes
        .iter()
        .take_while(|byte| (32..127).contains(*byte))
        .map(|byte| char::from(*byte))
        .collect()
}

// Text form: a line for each message, `NAME, value, value`; FMT, FMTU, UNIT and MULT lines describe
// the messages. Values are already multiplied.

/// Text logs of ArduPilot.
pub(crate) const DATAFLASH_TEXT: Importer = Importer {
    name: "a DataFlash log of ArduPilot as text",
    endings: &["log"],
    recognises: |bytes, _| {
        let start: Vec<u8> = bytes
            .iter()
            .take(40)
            .copied()
            .filter(|byte| *byte != b' ')
            .collect();
        start.starts_with(b"FMT,128,89,FMT,")
    },
    read: |bytes, path, budget| {
        let columns =
            read_text(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Logs(vec![columns]))
    },
};

fn read_text(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    budget.take(bytes.len() as u64, 1, "")?;
    let text = String::from_utf8_lossy(bytes);
    let layouts = layouts_of(&text);
    let by_name: BTreeMap<&str, Taken<'_>> = layouts
        .by_type
        .values()
        .filter_map(|layout| Some((layout.name.as_str(), Taken::of(layout, &layouts)?)))
        .collect();
    let mut topics = Topics::default();
    for line in text.lines() {
        budget.work(line.len() as u64, "")?;
        let mut cells = line.split(',').map(str::trim);
        let Some(taken) = cells.next().and_then(|name| by_name.get(name)) else {
            continue;
        };
        let cells: Vec<&str> = cells.collect();
        topics.take(taken, |at| cells.get(at)?.parse::<f64>().ok(), budget)?;
    }
    topics.columns(vec![
        "a log of ArduPilot as text; time in seconds since the autopilot was started".to_owned(),
    ])
}

/// Reads the layouts from the lines that describe messages.
fn layouts_of(text: &str) -> Layouts {
    let mut layouts = Layouts::default();
    for line in text.lines() {
        let (name, rest) = line.split_once(',').unwrap_or((line, ""));
        let cells: Vec<&str> = match name.trim() {
            "FMT" => rest.splitn(5, ',').map(str::trim).collect(),
            "FMTU" | "UNIT" | "MULT" => rest.split(',').map(str::trim).collect(),
            _ => continue,
        };
        let letter = |cell: &str| {
            cell.parse::<u8>()
                .map(char::from)
                .ok()
                .or_else(|| cell.chars().next())
        };
        match (name.trim(), cells.as_slice()) {
            ("FMT", [kind, _, name, letters, names]) => {
                if let (Ok(kind), Some(layout)) = (kind.parse(), Layout::of(name, letters, names)) {
                    layouts.by_type.insert(kind, layout);
                }
            }
            ("FMTU", [_, kind, units, by]) => {
                kind.parse()
                    .into_iter()
                    .for_each(|kind| layouts.describe(kind, units, by));
            }
            ("UNIT", [_, id, label]) => {
                letter(id)
                    .into_iter()
                    .for_each(|id| drop(layouts.units.insert(id, (*label).to_owned())));
            }
            // Values in text logs are already multiplied.
            _ => {}
        }
    }
    layouts
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

    /// A log of `samples` rates and two instances of an inertial unit.
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
    fn a_log_that_describes_itself_is_read_with_units_instances_and_modes() {
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
    fn what_is_no_message_is_skipped_and_a_cut_ends_the_log() {
        let mut bytes = log(40);
        let at = bytes.len() - 100;
        bytes.splice(at..at, [0xa3, 0x95, 7, 0]);
        let columns = read(&bytes[..bytes.len() - 5]).unwrap();
        assert!(
            columns
                .notes
                .iter()
                .any(|note| note.contains("bytes between messages")),
            "{:?}",
            columns.notes
        );
        assert!(read(&bytes[..200]).is_err() && read(&[]).is_err());
    }
}

#[cfg(test)]
mod text_tests {
    use super::*;

    #[test]
    fn a_line_for_each_message_is_read_with_units() {
        let mut text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 130, 44, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds\n\
                        FMT, 140, 19, RATE, Qff, TimeUS,R,ROut\nUNIT, 0, 107, deg/s\nFMTU, 0, 140, sk-, F--\n"
            .to_owned();
        for k in 0..30 {
            text += &format!(
                "RATE, {}, {k}, 0.{k}\nMSG, {k}, hello, there\n",
                1_000_000 + 2500 * k
            );
        }
        assert!((DATAFLASH_TEXT.recognises)(text.as_bytes(), "log"));
        let columns = read_text(text.as_bytes(), &ReadingBudget::new(1 << 20)).unwrap();
        let rate = &columns.columns[0];
        assert_eq!(
            (rate.name.as_str(), rate.unit.as_deref(), rate.meaning),
            ("RATE.R", Some("deg/s"), Some("P"))
        );
        assert_eq!((rate.values[4], columns.columns.len()), (4.0, 2));
        assert!(
            read_text(
                b"FMT, 128, 89, FMT, BBnNZ, Type\n",
                &ReadingBudget::new(1 << 20)
            )
            .is_err()
        );
    }
}
