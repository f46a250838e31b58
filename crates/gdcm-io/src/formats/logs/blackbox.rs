//! The blackbox format, used by Betaflight and relatives: several flights in one file, each with
//! header lines followed by frames (<https://betaflight.com/docs/development/Blackbox-Internals>).
//!
//! ```text
//! H Product:Blackbox …        begins a flight
//! H Field I name:time,…       fields in intra frames; Field P: their predictors and encodings in
//!                             predicted frames
//! I, P, S, G, H, E            frames: intra, predicted, slow, GPS, GPS home, event
//! ```
//!
//! Intra and predicted frames are main frames, each a sample of all fields. An intra frame is
//! decoded by itself, a predicted frame from up to two main frames before it. A slow frame gives
//! the flight mode.
//!
//! A frame is accepted if another frame, or the end of the file, follows it, and if a main frame's
//! time continues that of its predecessor. After a damaged frame, predicted frames are omitted up
//! to the next intra frame, which leaves a gap.

use gdcm_sysid::records::{ModeSpan, RecordColumn};

use crate::file_error::FileError;
use crate::formats::logs::blackbox_fields::Predecessors;
use crate::formats::logs::blackbox_frames::{FRAME_LETTERS, Frame, parse_frame};
use crate::formats::logs::blackbox_header::Header;
use crate::formats::logs::blackbox_integers::PackedBytes;
use crate::formats::logs::documented_channels::{BETAFLIGHT, assign_documented_meanings};
use crate::formats::logs::mode_spans::{mode_spans, modes_note};
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::{Columns, MOST_RECORDS};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Text with which the header of a flight begins.
const FLIGHT_MARK: &[u8] = b"H Product:Blackbox";
/// Maximum time step between main frames \[µs\]; a longer step marks damaged data. A compromise: a
/// smaller value would reject the data after a pause, a larger value would accept damaged times.
const LONGEST_STEP_US: i64 = 10_000_000;
/// Minimum number of main frames in a flight; shorter flights are omitted with a note. A
/// compromise: a larger number would omit short flights, a smaller number would keep fragments.
const FEWEST_FRAMES: usize = 50;
/// The number 1.0 in the header, as an IEEE 754 bit pattern.
const ONE: &str = "0x3f800000";

/// Column names for the controller terms; an axis index follows in square brackets.
const TERMS: [&str; 4] = ["axisP", "axisI", "axisD", "axisF"];

pub(crate) const BLACKBOX: Importer = Importer {
    name: "a blackbox log",
    endings: &["bbl", "bfl"],
    recognises: |bytes, _| bytes.starts_with(FLIGHT_MARK),
    read: |bytes, path, budget| {
        read_blackbox(bytes, budget)
            .map(Contents::Logs)
            .map_err(|fault| FileError::variables(path, fault))
    },
};

/// Reads all flights; flights with too few frames are omitted with a note.
///
/// # Errors
/// [`VariableFault`] if there are too many flights, if one cannot be decoded, if none has enough
/// frames, or if the budget is exhausted.
fn read_blackbox(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Columns>, VariableFault> {
    budget.work(bytes.len() as u64, "")?;
    let begins = flight_offsets(bytes);
    let count = begins.len();
    if count > MOST_RECORDS {
        return Err(VariableFault::TooManyRecords {
            found: count,
            most: MOST_RECORDS,
        });
    }
    let mut flights = Vec::new();
    let mut ignored = 0;
    for (index, &begin) in begins.iter().enumerate() {
        let end = begins.get(index + 1).copied().unwrap_or(bytes.len());
        let name = if count == 1 {
            String::new()
        } else {
            format!("flight {}", index + 1)
        };
        match Flight::read(&bytes[begin..end], &name, budget)? {
            Some(flight) => flights.push(flight.into_columns(name, budget)?),
            None => ignored += 1,
        }
    }
    if flights.is_empty() {
        return Err(VariableFault::damaged(
            "",
            Damage::NoFlight {
                fewest: FEWEST_FRAMES,
            },
            0,
        ));
    }
    if ignored > 0 {
        flights[0].notes.push(ReadingNote::FlightsOmitted {
            omitted: ignored,
            count,
            fewest: FEWEST_FRAMES,
        });
    }
    Ok(flights)
}

/// Returns the offsets \[bytes\] at which flights begin.
fn flight_offsets(bytes: &[u8]) -> Vec<usize> {
    let mut offsets = Vec::new();
    for offset in 0..bytes.len().saturating_sub(FLIGHT_MARK.len()) {
        // The first letter is compared first, because most bytes differ from it.
        if bytes[offset] == b'H' && bytes[offset..].starts_with(FLIGHT_MARK) {
            offsets.push(offset);
        }
    }
    offsets
}

/// A flight with its decoded frames.
struct Flight {
    header: Header,
    /// Index of the field "time"; `None` if the frames have none.
    time_field: Option<usize>,
    /// Values from the main frames, one list for each field.
    values: Vec<Vec<f64>>,
    modes: Vec<ModeSample>,
    /// Number of damaged frames that follow a valid main frame; those up to the next intra frame
    /// are not counted.
    damaged: usize,
}

/// Mode flags from a slow frame, with the time of the preceding main frame.
struct ModeSample {
    time_us: f64,
    flags: f64,
}

impl Flight {
    /// Reads a flight with its frames; returns `None` if there are fewer than `FEWEST_FRAMES` main
    /// frames.
    fn read(
        bytes: &[u8],
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Option<Self>, VariableFault> {
        let header = Header::read(bytes);
        budget.take(header.length as u64, 2, name)?;
        let mut flight = Self::begin(header, name)?;
        flight.read_frames(bytes, name, budget)?;
        let frames = flight.values.first().map_or(0, Vec::len);
        if frames < FEWEST_FRAMES {
            return Ok(None);
        }
        Ok(Some(flight))
    }

    /// Creates a flight without frames.
    ///
    /// # Errors
    /// [`VariableFault`] if the data version or an encoding in the intra frames is not supported,
    /// or if their fields are not described completely.
    fn begin(header: Header, name: &str) -> Result<Self, VariableFault> {
        let version = header.value("Data version");
        match header.frame_fields(b'I') {
            Some(fields) if version == "2" => Ok(Self {
                time_field: fields.names.iter().position(|field| field == "time"),
                values: vec![Vec::new(); fields.names.len()],
                modes: Vec::new(),
                damaged: 0,
                header,
            }),
            None if version == "2" => Err(VariableFault::unsupported(
                name,
                UnsupportedContent::BlackboxFields,
            )),
            _ => {
                let version: String = version.chars().take(9).collect();
                Err(VariableFault::unsupported(
                    name,
                    UnsupportedContent::BlackboxVersion { version },
                ))
            }
        }
    }

    /// Reads the frames in `bytes`, which begin with the header.
    ///
    /// 1. Decode a frame at the current byte; a main frame is predicted from its predecessors. It
    ///    is damaged if it cannot be decoded, if a byte other than a frame letter follows it, or if
    ///    a main frame's time does not continue that of its predecessor.
    /// 2. By its kind: the end event ends the reading; a main frame is a sample, and the next
    ///    predecessor; a slow frame is a mode sample; other frames are skipped.
    /// 3. After a damaged frame there is no predecessor, and reading continues at the byte after
    ///    its letter.
    fn read_frames(
        &mut self,
        bytes: &[u8],
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        let field_count = self.values.len();
        let mut before = Predecessors::default();
        // Offset of the current frame's letter.
        let mut offset = self.header.length;
        while offset < bytes.len() {
            budget.work(field_count as u64, name)?;
            // Step 1
            let mut packed = PackedBytes::new(bytes, offset + 1);
            let mut frame = parse_frame(&self.header, bytes[offset], &mut packed, &before);
            // A frame is damaged if a byte other than a frame letter follows it; but a zero follows
            // the end of the log.
            let is_end = matches!(frame, Some(Frame::End));
            let next = bytes.get(packed.at);
            if !is_end && next.is_some_and(|next| !FRAME_LETTERS.contains(next)) {
                frame = None;
            }
            // Steps 2 and 3
            match frame {
                Some(Frame::End) => break,
                Some(Frame::Main(values)) if self.continues(&values, &before) => {
                    budget.take(field_count as u64, 8, name)?;
                    for (column, value) in self.values.iter_mut().zip(&values) {
                        column.push(*value as f64);
                    }
                    let is_intra = bytes[offset] == b'I';
                    before = Predecessors {
                        earlier: if is_intra { None } else { before.last },
                        last: Some(values),
                    };
                    offset = packed.at;
                }
                Some(Frame::Slow(values)) => {
                    self.add_mode_sample(&values, &before, name, budget)?;
                    offset = packed.at;
                }
                Some(Frame::Other) => offset = packed.at,
                Some(Frame::Main(_)) | None => {
                    // Count a damaged frame once, not at each byte up to the next intra frame.
                    if before.last.is_some() {
                        self.damaged += 1;
                    }
                    before = Predecessors::default();
                    offset += 1;
                }
            }
        }
        Ok(())
    }

    /// Returns whether a main frame is no earlier than its predecessor and at most
    /// `LONGEST_STEP_US` later; true for frames without a time or a predecessor.
    fn continues(&self, frame: &[i64], before: &Predecessors) -> bool {
        if let Some(time) = self.time_field
            && let Some(last) = &before.last
        {
            return (0..=LONGEST_STEP_US).contains(&(frame[time] - last[time]));
        }
        true
    }

    /// Stores a slow frame's mode flags with the time of the preceding main frame; without such a
    /// time, ignores them.
    fn add_mode_sample(
        &mut self,
        slow: &[i64],
        before: &Predecessors,
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        if let Some(time) = self.time_field
            && let Some(flags) = slow.first()
            && let Some(last) = &before.last
        {
            budget.take(2, 8, name)?;
            self.modes.push(ModeSample {
                time_us: last[time] as f64,
                flags: *flags as f64,
            });
        }
        Ok(())
    }

    /// Returns a column for each field except the loop counter, and for each axis a column with the
    /// sum of the controller terms, if there are any. Documented channels and units are assigned,
    /// unless the gyro scale leaves the unit of the rates unknown.
    fn into_columns(
        self,
        name: String,
        budget: &ReadingBudget<'_>,
    ) -> Result<Columns, VariableFault> {
        let mut notes = vec![ReadingNote::BetaflightLog];
        let names = self.header.main_fields();
        let mut columns = Vec::new();
        for (field, values) in names.iter().zip(self.values) {
            if field == "loopIteration" {
                continue;
            }
            let mut column = RecordColumn::new(field.clone(), values);
            if field == "time" {
                column.unit = Some("µs".to_owned());
            }
            columns.push(column);
        }
        // Axes 0, 1 and 2 are roll, pitch and yaw.
        for axis in 0..3 {
            let sum = controller_sum(&columns, axis, &name, budget)?;
            columns.extend(sum);
        }
        // The documented rate unit, deg/s, requires scale 1.
        if self.header.value("gyro_scale") == ONE {
            notes.extend(assign_documented_meanings(&mut columns, &BETAFLIGHT));
        } else {
            notes.push(ReadingNote::GyroScale);
        }
        if self.damaged > 0 {
            notes.push(ReadingNote::DamagedFrames {
                count: self.damaged,
            });
        }
        let modes = flight_modes(&self.modes);
        notes.extend(modes_note(&modes));
        Ok(Columns {
            notes,
            modes,
            ..Columns::new(name, columns)
        })
    }
}

/// Returns a column with the sum of an axis's controller terms; `None` if there are none.
fn controller_sum(
    columns: &[RecordColumn],
    axis: usize,
    flight: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<RecordColumn>, VariableFault> {
    let names = TERMS.map(|term| format!("{term}[{axis}]"));
    let terms: Vec<&RecordColumn> = columns
        .iter()
        .filter(|column| names.contains(&column.name))
        .collect();
    let Some(first) = terms.first() else {
        return Ok(None);
    };
    let rows = first.values.len();
    budget.take(rows as u64, 8, flight)?;
    let sum = (0..rows)
        .map(|row| terms.iter().map(|term| term.values[row]).sum())
        .collect();
    Ok(Some(RecordColumn::new(format!("axisSum[{axis}]"), sum)))
}

/// Returns the time spans of the flight modes.
fn flight_modes(samples: &[ModeSample]) -> Vec<ModeSpan> {
    let time_s: Vec<f64> = samples.iter().map(|sample| sample.time_us * 1e-6).collect();
    let flags = samples.iter().map(|sample| sample.flags);
    mode_spans(&time_s, flags, |flags| Some(mode_name(flags).to_owned()))
}

/// Returns the flight mode for `flightModeFlags`, the first field in slow frames.
fn mode_name(flags: f64) -> &'static str {
    /// Bit of the angle mode, in which the stick sets the attitude.
    const ANGLE: u32 = 1 << 1;
    /// Bit of the horizon mode, between angle and acro mode.
    const HORIZON: u32 = 1 << 2;
    let flags = flags as u32;
    if flags & ANGLE != 0 {
        "angle"
    } else if flags & HORIZON != 0 {
        "horizon"
    } else {
        "acro"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a flight of `frames` frames at intervals of one millisecond; every tenth is an intra
    /// frame.
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
        // The roll rate is 0, 1, 2, …: it exceeds its prediction, the mean of the two preceding
        // frames, by 1 or 2.
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
                // The time is extrapolated from the two preceding frames; after an intra frame, the
                // prediction is the time of that frame.
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
        let omitted = ReadingNote::FlightsOmitted {
            omitted: 1,
            count: 3,
            fewest: FEWEST_FRAMES,
        };
        assert!(flights[0].notes.contains(&omitted));
        for flight in &flights {
            let is_damaged = |note: &ReadingNote| matches!(note, ReadingNote::DamagedFrames { .. });
            assert!(!flight.notes.iter().any(is_damaged), "{:?}", flight.notes);
        }
    }

    #[test]
    fn a_damaged_frame_is_a_gap_up_to_the_next_intra_frame() {
        let mut bytes = flight(100);
        let at = bytes.len() / 2 + 100;
        bytes[at] = 0xff;
        let flights = read(&bytes).unwrap();
        let stamps = &flights[0].columns[0].values;
        assert!((70..100).contains(&stamps.len()), "{}", stamps.len());
        assert!(stamps.windows(2).all(|pair| pair[1] > pair[0]));
        let damaged = ReadingNote::DamagedFrames { count: 1 };
        assert!(
            flights[0].notes.contains(&damaged),
            "{:?}",
            flights[0].notes
        );
    }

    #[test]
    fn another_version_is_refused_with_the_conversion_command() {
        let text = String::from_utf8_lossy(b"H Product:Blackbox\nH Data version:1\nI").into_owned();
        let fault = read(text.as_bytes()).err().unwrap();
        let version = "1".to_owned();
        assert!(
            matches!(
                &fault,
                VariableFault::Unsupported { content, .. }
                    if *content == UnsupportedContent::BlackboxVersion { version }
            ),
            "{fault:?}"
        );
    }
}
