//! The blackbox format of Betaflight and relatives: several flights in one file, each with header
//! lines followed by frames (<https://betaflight.com/docs/development/Blackbox-Internals>).
//!
//! ```text
//! H Product:Blackbox …        a flight begins
//! H Field I name:time,…       what a frame holds; P: the same told from the frames before
//! I, P, S, G, H, E            frames: whole, told from others, slow, of GPS, of home; an event
//! ```
//!
//! A frame counts if another frame begins where it ends. After a damaged frame, all frames
//! predicted from it are left out up to the next intra frame, which leaves a gap.

use std::collections::BTreeMap;

use gdcm_sysid::records::RecordColumn;

use crate::file_error::FileError;
use crate::formats::logs::{BETAFLIGHT, give_meanings, mode_spans, modes_note};
use crate::formats::recorded_columns::{Columns, MOST_RECORDS};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

const MARK: &[u8] = b"H Product:Blackbox";
/// A larger time step is damage \[µs\].
const LONGEST_STEP: i64 = 10_000_000;
/// A flight with fewer frames is ignored.
const FEWEST: usize = 50;

/// Logs of Betaflight.
pub(crate) const BLACKBOX: Importer = Importer {
    name: "a blackbox log",
    endings: &["bbl", "bfl"],
    recognises: |bytes, _| bytes.starts_with(MARK),
    read: |bytes, path, budget| {
        read_blackbox(bytes, budget)
            .map(Contents::Logs)
            .map_err(|fault| FileError::variables(path, fault))
    },
};

fn read_blackbox(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Columns>, VariableFault> {
    let mut begins: Vec<usize> = Vec::new();
    budget.work(bytes.len() as u64, "")?;
    for at in 0..bytes.len().saturating_sub(MARK.len()) {
        if bytes[at] == b'H' && bytes[at..].starts_with(MARK) {
            begins.push(at);
        }
    }
    let count = begins.len();
    if count > MOST_RECORDS {
        return Err(VariableFault::TooMuchWork {
            variable: String::new(),
            most_millions: 0,
        });
    }
    let mut flights = Vec::new();
    let mut without = 0;
    let ends = begins.iter().skip(1).copied().chain([bytes.len()]);
    for (index, (&begin, end)) in begins.iter().zip(ends).enumerate() {
        let name = if count == 1 {
            String::new()
        } else {
            format!("flight {}", index + 1)
        };
        match Flight::read(&bytes[begin..end], &name, budget)? {
            Some(flight) => flights.push(flight.columns(name, budget)?),
            None => without += 1,
        }
    }
    if flights.is_empty() {
        return Err(VariableFault::damaged(
            "",
            "a blackbox without a flight of 50 frames",
            0,
        ));
    }
    if without > 0 {
        flights[0].notes.push(format!(
            "{without} of {count} flights in the file have hardly any frames: left out"
        ));
    }
    Ok(flights)
}

/// Contents of the header lines before the frames.
#[derive(Default)]
struct Heading {
    lines: BTreeMap<String, String>,
    frames: BTreeMap<u8, FrameFields>,
    known: Known,
}

impl Heading {
    /// Reads the header; also returns where it ends.
    fn read(bytes: &[u8]) -> (Self, usize) {
        let mut heading = Self::default();
        let mut at = 0;
        while bytes[at..].starts_with(b"H ") {
            let Some(length) = bytes[at..].iter().position(|byte| *byte == b'\n') else {
                break;
            };
            let line = String::from_utf8_lossy(&bytes[at + 2..at + length]);
            if let Some((key, value)) = line.split_once(':') {
                heading
                    .lines
                    .insert(key.to_owned(), value.trim().to_owned());
            }
            at += length + 1;
        }
        for kind in *b"IPSGH" {
            heading
                .frames
                .insert(kind, heading.fields(char::from(kind)));
        }
        // Predicted frames have the names and signs of intra frames.
        let whole = heading.frames[&b'I'].clone();
        if let Some(told) = heading.frames.get_mut(&b'P') {
            (told.names, told.signed) = (whole.names, whole.signed);
        }
        let number = |key: &str| {
            let first = heading.lines.get(key)?.split(',').next()?;
            first.parse::<i64>().ok()
        };
        heading.known = Known {
            least_throttle: number("minthrottle").unwrap_or(0),
            least_motor: number("motorOutput").unwrap_or(0),
            battery: number("vbatref").unwrap_or(0),
        };
        (heading, at)
    }

    fn fields(&self, kind: char) -> FrameFields {
        let list = |what: &str| {
            let line = self
                .lines
                .get(&format!("Field {kind} {what}"))
                .map_or("", String::as_str);
            line.split(',')
                .filter(|cell| !cell.is_empty())
                .map(str::to_owned)
                .collect::<Vec<String>>()
        };
        let numbers = |what: &str| {
            list(what)
                .iter()
                .map(|cell| cell.parse().unwrap_or(u8::MAX))
                .collect::<Vec<u8>>()
        };
        FrameFields {
            names: list("name"),
            signed: numbers("signed")
                .into_iter()
                .map(|signed| signed == 1)
                .collect(),
            predictors: numbers("predictor"),
            encodings: numbers("encoding"),
        }
    }

    /// The fields of a kind of frame, if they are known.
    fn frame(&self, kind: u8) -> Option<&FrameFields> {
        self.frames.get(&kind).filter(|fields| fields.is_whole())
    }
}

/// Frames of a flight.
struct Flight {
    heading: Heading,
    /// Numbers of the fields of intra frames.
    values: Vec<Vec<f64>>,
    /// Times \[µs\] and mode flags.
    modes: (Vec<f64>, Vec<f64>),
    damaged: usize,
}

/// A decoded frame.
enum Frame {
    Main(Vec<i64>),
    Slow(Vec<i64>),
    Other,
    End,
}

impl Flight {
    /// Reads the frames of a flight; returns nothing if there are too few.
    fn read(
        bytes: &[u8],
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Option<Self>, VariableFault> {
        let (heading, mut at) = Heading::read(bytes);
        budget.take(at as u64, 2, name)?;
        let version = heading.lines.get("Data version").map_or("", String::as_str);
        let Some(fields) = heading.frame(b'I').filter(|_| version == "2") else {
            let what = format!(
                "a blackbox of data version \"{}\", or of fields of a later one",
                &version.chars().take(9).collect::<String>()
            );
            return Err(VariableFault::unsupported(
                name,
                what,
                "save it as CSV: blackbox_decode \"{file}\"",
            ));
        };
        let time = fields.names.iter().position(|field| field == "time");
        let count = fields.names.len();
        let mut flight = Self {
            values: vec![Vec::new(); count],
            modes: Default::default(),
            damaged: 0,
            heading,
        };
        let mut before: [Option<Vec<i64>>; 2] = [None, None];
        while at < bytes.len() {
            budget.work(count as u64, name)?;
            let mut bits = Bits::new(bytes, at + 1);
            let frame = flight.heading.parse(bytes[at], &mut bits, &before);
            // The next frame begins where this frame ends.
            let follows = bytes
                .get(bits.at)
                .is_none_or(|next| b"IPSGHE".contains(next));
            let is_next = |frame: &Vec<i64>| {
                let (Some(time), Some(last)) = (time, &before[0]) else {
                    return true;
                };
                (0..=LONGEST_STEP).contains(&(frame[time] - last[time]))
            };
            match frame.filter(|_| follows) {
                Some(Frame::End) => break,
                Some(Frame::Main(values)) if is_next(&values) => {
                    budget.take(count as u64, 8, name)?;
                    flight
                        .values
                        .iter_mut()
                        .zip(&values)
                        .for_each(|(column, value)| column.push(*value as f64));
                    let earlier = if bytes[at] == b'I' {
                        None
                    } else {
                        before[0].take()
                    };
                    before = [Some(values), earlier];
                    at = bits.at;
                }
                Some(Frame::Slow(values)) => {
                    if let (Some(time), Some(flags), Some(last)) =
                        (time, values.first(), &before[0])
                    {
                        budget.take(2, 8, name)?;
                        flight.modes.0.push(last[time] as f64);
                        flight.modes.1.push(*flags as f64);
                    }
                    at = bits.at;
                }
                Some(Frame::Other) => at = bits.at,
                _ => {
                    flight.damaged += usize::from(before[0].is_some());
                    before = [None, None];
                    at += 1;
                }
            }
        }
        let frames = flight.values.first().map_or(0, Vec::len);
        Ok((frames >= FEWEST).then_some(flight))
    }

    /// Returns the columns of the flight, with the sums of the controller's terms.
    fn columns(self, name: String, budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
        let names = self
            .heading
            .frames
            .get(&b'I')
            .map_or_else(Vec::new, |fields| fields.names.clone());
        let mut columns: Vec<RecordColumn> = Vec::new();
        for (field, values) in names.iter().zip(self.values) {
            let unit = (field == "time").then(|| "µs".to_owned());
            if field != "loopIteration" {
                columns.push(RecordColumn {
                    unit,
                    ..RecordColumn::new(field.clone(), values)
                });
            }
        }
        for axis in 0..3 {
            let is_term = |column: &&RecordColumn| {
                ["axisP", "axisI", "axisD", "axisF"]
                    .iter()
                    .any(|term| column.name == format!("{term}[{axis}]"))
            };
            let terms: Vec<&RecordColumn> = columns.iter().filter(is_term).collect();
            if let Some(first) = terms.first() {
                let rows = first.values.len();
                budget.take(rows as u64, 8, &name)?;
                let sum = (0..rows)
                    .map(|row| terms.iter().map(|term| term.values[row]).sum())
                    .collect();
                columns.push(RecordColumn::new(format!("axisSum[{axis}]"), sum));
            }
        }
        let mut notes = vec![
            "a log of Betaflight; axisSum is the sum of the terms of the controller".to_owned(),
        ];
        // 1.0 as an IEEE 754 bit pattern: rates are in deg/s.
        let is_degrees = self
            .heading
            .lines
            .get("gyro_scale")
            .is_some_and(|scale| scale == "0x3f800000");
        if is_degrees {
            notes.extend(give_meanings(&mut columns, &BETAFLIGHT));
        } else {
            notes.push(
                "gyro_scale is not 1: the unit of gyroADC is not known, no channels are proposed"
                    .to_owned(),
            );
        }
        if self.damaged > 0 {
            notes.push(format!(
                "{} frames are damaged: left out, up to the next whole one",
                self.damaged
            ));
        }
        let seconds: Vec<f64> = self.modes.0.iter().map(|time| time * 1e-6).collect();
        // `flightModeFlags`: 1 is angle, 2 is horizon, neither is acro.
        let named = |flags: f64| match flags as u32 {
            flags if flags & 2 != 0 => Some("angle".to_owned()),
            flags if flags & 4 != 0 => Some("horizon".to_owned()),
            _ => Some("acro".to_owned()),
        };
        let modes = mode_spans(&seconds, self.modes.1, named);
        notes.extend(modes_note(&modes));
        Ok(Columns {
            notes,
            modes,
            ..Columns::new(name, columns)
        })
    }
}

impl Heading {
    /// Parses the frame of a letter; returns nothing for an unknown letter or a damaged frame.
    fn parse(
        &self,
        kind: u8,
        bits: &mut Bits<'_>,
        before: &[Option<Vec<i64>>; 2],
    ) -> Option<Frame> {
        if kind == b'E' {
            return event(bits);
        }
        let fields = self.frame(kind)?;
        let before = if kind == b'P' {
            [Some(before[0].as_ref()?), before[1].as_ref()]
        } else {
            [None, None]
        };
        let differences = fields.differences(bits)?;
        Some(match kind {
            b'G' | b'H' => Frame::Other,
            b'S' => Frame::Slow(fields.values(differences, before, self.known)),
            _ => Frame::Main(fields.values(differences, before, self.known)),
        })
    }
}

/// Parses an event, whose number decides its length.
fn event(bits: &mut Bits<'_>) -> Option<Frame> {
    match bits.byte()? {
        // Beep, disarming, failure of the inertial unit.
        0 | 15 | 40 => drop(bits.unsigned()?),
        // Logging resumes; change of the flight mode.
        14 | 30 => drop((bits.unsigned()?, bits.unsigned()?)),
        // In-flight adjustment: a four-byte number, or a packed number.
        13 => match bits.byte()? & 0x80 {
            0 => drop(bits.signed()?),
            _ => drop((bits.byte()?, bits.byte()?, bits.byte()?, bits.byte()?)),
        },
        255 => {
            let is_end = b"End of log"
                .iter()
                .all(|letter| bits.byte() == Some(*letter));
            return is_end.then_some(Frame::End);
        }
        _ => return None,
    }
    Some(Frame::Other)
}

// Frame fields: encoding and prediction.
//
// Each field has a numbered encoding and a numbered predictor
// (<https://betaflight.com/docs/development/Blackbox-Internals>). The file holds the difference
// from the prediction.

/// Largest number of fields of a frame.
pub(super) const MOST_FIELDS: usize = 256;

/// Fields of one kind of frame.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameFields {
    pub(super) names: Vec<String>,
    pub(super) signed: Vec<bool>,
    pub(super) predictors: Vec<u8>,
    pub(super) encodings: Vec<u8>,
}

/// Header numbers used by the predictors.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    pub(super) least_throttle: i64,
    pub(super) least_motor: i64,
    pub(super) battery: i64,
}

/// Cursor over bytes.
pub(super) struct Bits<'b> {
    bytes: &'b [u8],
    pub(super) at: usize,
}

impl<'b> Bits<'b> {
    pub(super) fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        let byte = self.bytes.get(self.at).copied()?;
        self.at += 1;
        Some(byte)
    }

    /// Reads a variable-length number: seven bits a byte, lowest first; the eighth bit announces
    /// another byte.
    pub(super) fn unsigned(&mut self) -> Option<u32> {
        let mut value = 0_u32;
        for shift in (0..32).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// Reads a variable-length number with the sign in the lowest bit.
    pub(super) fn signed(&mut self) -> Option<i32> {
        let value = self.unsigned()?;
        Some((value >> 1).cast_signed() ^ -((value & 1).cast_signed()))
    }

    /// Reads the negative of a signed 14-bit number.
    fn negative_14(&mut self) -> Option<i32> {
        Some(-extended(self.unsigned()? & 0x3fff, 14))
    }

    /// Reads three numbers of 2, 4 or 6 bits, or of 1 to 4 bytes each.
    fn three(&mut self) -> Option<[i32; 3]> {
        let lead = self.byte()?;
        Some(match lead >> 6 {
            0 => [lead >> 4, lead >> 2, lead].map(|bits| extended(u32::from(bits & 3), 2)),
            1 => {
                let next = self.byte()?;
                [lead & 15, next >> 4, next & 15].map(|bits| extended(u32::from(bits), 4))
            }
            2 => [lead, self.byte()?, self.byte()?].map(|bits| extended(u32::from(bits & 63), 6)),
            _ => {
                let mut values = [0; 3];
                for (index, value) in values.iter_mut().enumerate() {
                    let bytes = 1 + u32::from((lead >> (2 * index)) & 3);
                    let mut bits = 0_u32;
                    for byte in 0..bytes {
                        bits |= u32::from(self.byte()?) << (8 * byte);
                    }
                    *value = extended(bits, 8 * bytes);
                }
                values
            }
        })
    }

    /// Reads four numbers of 0, 4, 8 or 16 bits, in half-byte steps, highest first.
    fn four(&mut self) -> Option<[i32; 4]> {
        let tags = self.byte()?;
        let mut half = None;
        let mut values = [0; 4];
        for (index, value) in values.iter_mut().enumerate() {
            let halves = [0, 1, 2, 4][usize::from((tags >> (2 * index)) & 3)];
            let mut bits = 0_u32;
            for _ in 0..halves {
                let next = match half.take() {
                    Some(next) => next,
                    None => {
                        let byte = self.byte()?;
                        half = Some(byte & 15);
                        byte >> 4
                    }
                };
                bits = bits << 4 | u32::from(next);
            }
            *value = if halves == 0 {
                0
            } else {
                extended(bits, 4 * halves)
            };
        }
        Some(values)
    }
}

/// Sign-extends a number of `count` bits.
fn extended(bits: u32, count: u32) -> i32 {
    let unused = 32 - count;
    (bits << unused).cast_signed() >> unused
}

impl FrameFields {
    /// Whether every name has a known encoding and predictor.
    pub(super) fn is_whole(&self) -> bool {
        let count = self.names.len();
        let known = |encoding: &u8| matches!(encoding, 0 | 1 | 3 | 6 | 7 | 8 | 9);
        (1..=MOST_FIELDS).contains(&count)
            && [
                self.signed.len(),
                self.predictors.len(),
                self.encodings.len(),
            ] == [count; 3]
            && self.encodings.iter().all(known)
    }

    /// Reads the differences of a frame as stored; returns nothing if they are damaged.
    pub(super) fn differences(&self, bits: &mut Bits<'_>) -> Option<Vec<i64>> {
        let mut values: Vec<i64> = Vec::with_capacity(self.names.len());
        while values.len() < self.names.len() {
            let from = values.len();
            let encoding = self.encodings[from];
            match encoding {
                0 => values.push(i64::from(bits.signed()?)),
                1 => values.push(i64::from(bits.unsigned()?)),
                3 => values.push(i64::from(bits.negative_14()?)),
                6 => {
                    // Up to eight consecutive fields share a byte; each bit marks a nonzero field.
                    let count = self.encodings[from..]
                        .iter()
                        .take(8)
                        .take_while(|other| **other == encoding)
                        .count();
                    let tags = if count == 1 { 1 } else { bits.byte()? };
                    for index in 0..count {
                        values.push(if tags >> index & 1 == 1 {
                            i64::from(bits.signed()?)
                        } else {
                            0
                        });
                    }
                }
                7 => values.extend(bits.three()?.map(i64::from)),
                8 => values.extend(bits.four()?.map(i64::from)),
                _ => values.push(0),
            }
        }
        values.truncate(self.names.len());
        Some(values)
    }

    /// Computes the numbers of a frame from its differences and the two frames before.
    pub(super) fn values(
        &self,
        mut values: Vec<i64>,
        before: [Option<&Vec<i64>>; 2],
        known: Known,
    ) -> Vec<i64> {
        let motor = self.names.iter().position(|name| name == "motor[0]");
        for at in 0..values.len() {
            let last = before[0]
                .and_then(|frame| frame.get(at))
                .copied()
                .unwrap_or(0);
            let earlier = before[1]
                .and_then(|frame| frame.get(at))
                .copied()
                .unwrap_or(last);
            let predicted = match self.predictors[at] {
                1 => last,
                2 => 2 * last - earlier,
                3 => (last + earlier) / 2,
                4 => known.least_throttle,
                5 => motor
                    .and_then(|motor| values.get(motor))
                    .copied()
                    .unwrap_or(0),
                6 => last + 1,
                8 => 1500,
                9 => known.battery,
                11 => known.least_motor,
                _ => 0,
            };
            // 32-bit arithmetic, as in the logger.
            let low = values[at].wrapping_add(predicted) as u32;
            values[at] = if self.signed[at] {
                i64::from(low.cast_signed())
            } else {
                i64::from(low)
            };
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flight of `frames` frames, every tenth of them an intra frame; each frame adds a
    /// millisecond.
    fn flight(frames: u32) -> Vec<u8> {
        let mut bytes = b"H Product:Blackbox flight data recorder by Nicholas Sherlock\nH Data version:2\n\
            H Field I name:loopIteration,time,axisP[0],axisI[0],gyroADC[0]\nH Field I signed:0,0,1,1,1\n\
            H Field I predictor:0,0,0,0,0\nH Field I encoding:1,1,0,0,0\nH Field P predictor:6,2,1,1,3\n\
            H Field P encoding:9,0,6,6,0\nH gyro_scale:0x3f800000\n"
            .to_vec();
        let packed = |value: u32| {
            let mut rest = value;
            let mut bytes = Vec::new();
            while rest > 0x7f {
                bytes.push((rest & 0x7f) as u8 | 0x80);
                rest >>= 7;
            }
            bytes.push(rest as u8);
            bytes
        };
        let signed = |value: i32| packed((value << 1 ^ value >> 31).cast_unsigned());
        // The roll rate is 0, 1, 2, …; the predicted mean of the two frames before is 1 or 2
        // behind.
        for frame in 0..frames {
            if frame % 10 == 0 {
                bytes.push(b'I');
                bytes.extend(
                    [
                        packed(frame),
                        packed(5000 + 1000 * frame),
                        signed(3),
                        signed(4),
                    ]
                    .concat(),
                );
                bytes.extend(signed(frame as i32));
            } else {
                let first = frame % 10 == 1;
                let last = frame as i32 - 1;
                let earlier = if first {
                    frame as i32 - 1
                } else {
                    frame as i32 - 2
                };
                bytes.push(b'P');
                // After an intra frame the predicted time does not change.
                bytes.extend([signed(if first { 1000 } else { 0 }), vec![0]].concat());
                bytes.extend(signed(frame as i32 - (last + earlier) / 2));
            }
        }
        bytes.extend(b"E\xffEnd of log\0");
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Vec<Columns>, VariableFault> {
        read_blackbox(bytes, &ReadingBudget::new(1 << 20))
    }

    #[test]
    fn every_flight_of_a_file_is_a_record() {
        let flights = read(&[flight(100), flight(70), flight(3)].concat()).unwrap();
        let names: Vec<&str> = flights
            .iter()
            .map(|flight| flight.variable.as_str())
            .collect();
        assert_eq!(names, ["flight 1", "flight 2"]);
        let columns = &flights[1].columns;
        let named: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(
            named,
            ["time", "axisP[0]", "axisI[0]", "gyroADC[0]", "axisSum[0]"]
        );
        let stamps: Vec<f64> = (0..70)
            .map(|frame| 5000.0 + 1000.0 * f64::from(frame))
            .collect();
        assert_eq!(
            (&columns[0].values, columns[0].unit.as_deref()),
            (&stamps, Some("µs"))
        );
        assert_eq!(
            columns[3].values,
            (0..70).map(f64::from).collect::<Vec<_>>()
        );
        assert_eq!(
            (columns[3].meaning, columns[3].unit.as_deref()),
            (Some("P"), Some("deg/s"))
        );
        assert!(columns[4].values.iter().all(|sum| *sum == 7.0));
        assert!(
            flights[0]
                .notes
                .iter()
                .any(|note| note.starts_with("1 of 3 flights"))
        );
    }

    #[test]
    fn a_damaged_frame_is_a_gap_up_to_the_next_whole_one() {
        let mut bytes = flight(100);
        let at = bytes.len() / 2 + 100;
        bytes[at] = 0xff;
        let flights = read(&bytes).unwrap();
        let stamps = &flights[0].columns[0].values;
        assert!((70..100).contains(&stamps.len()), "{}", stamps.len());
        assert!(stamps.windows(2).all(|pair| pair[1] > pair[0]));
        assert!(flights[0].notes.iter().any(|note| note.contains("damaged")));
    }

    #[test]
    fn another_version_is_refused_with_the_line_that_converts() {
        let text = String::from_utf8_lossy(b"H Product:Blackbox\nH Data version:1\nI").into_owned();
        let words = read(text.as_bytes()).err().unwrap().to_string();
        assert!(words.contains("blackbox_decode"), "{words}");
    }
}

#[cfg(test)]
mod frame_tests {
    use super::*;

    #[test]
    fn packed_numbers_are_those_of_the_format_s_description() {
        assert_eq!(Bits::new(&[0xff, 0x01], 0).unsigned(), Some(255));
        assert_eq!(Bits::new(&[0x80; 6], 0).unsigned(), None, "it does not end");
        assert_eq!(
            [0, 1, 2, 3].map(|byte| Bits::new(&[byte], 0).signed()),
            [0, -1, 1, -2].map(Some)
        );
        assert_eq!(Bits::new(&[0xff, 0x3f], 0).negative_14(), Some(-0x1fff));
        assert_eq!(Bits::new(&[0b0001_1011], 0).three(), Some([1, -2, -1]));
        assert_eq!(
            Bits::new(&[0b0100_0111, 0x9f], 0).three(),
            Some([7, -7, -1])
        );
        assert_eq!(
            Bits::new(&[0b1100_0001, 0x34, 0x12, 0xff, 0x05], 0).three(),
            Some([0x1234, -1, 5])
        );
        // 4 bits, 8 bits, 0 bits, 16 bits: 1, -2, 0, 0x1234.
        assert_eq!(
            Bits::new(&[0b1100_1001, 0x1f, 0xe1, 0x23, 0x40], 0).four(),
            Some([1, -2, 0, 0x1234])
        );
        assert_eq!(Bits::new(&[0b1100_1001, 0x1f], 0).four(), None);
    }

    #[test]
    fn predictions_take_the_frames_before() {
        let fields = FrameFields {
            names: ["time", "a", "b", "motor[0]", "motor[1]"]
                .map(str::to_owned)
                .to_vec(),
            signed: vec![false, true, true, false, false],
            predictors: vec![2, 1, 3, 11, 5],
            encodings: vec![0; 5],
        };
        assert!(fields.is_whole());
        let known = Known {
            least_motor: 158,
            ..Known::default()
        };
        let last = vec![200, -5, 8, 0, 0];
        let earlier = vec![100, 0, 4, 0, 0];
        let values = fields.values(vec![1, 1, 1, 2, 3], [Some(&last), Some(&earlier)], known);
        assert_eq!(values, [301, -4, 7, 160, 163]);
    }
}
