//! Cuts flight records as logged into segments on a uniform grid (M14.1, M14.21).
//!
//! A *run* is consecutive grid points at which every channel has a value, and a *segment* is a run
//! that is long enough. A *hat* is an unknown for missing samples (`gap_hat`).

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::{FlightRecord, Segment, Signal};

use super::channel_cautions::{channel_cautions, inputs_at_limit, stuck_caution};
use super::filled_segment::FilledSegment;
use super::gap::{Cause, Gap, Treatment};
use super::gap_search::record_gaps;
use super::grid_stretches::{GridRows, RowRange, grid_rows};
use super::preparation_settings::{Preparation, PreparationError};
use super::record_cautions::RecordCaution;
use super::record_clock::Clock;
use super::record_use::RecordUse;
use super::spectrum::LineRange;
use super::valid_samples::valid_samples;

/// Largest range for which a channel is constant, relative to its largest modulus: interpolation
/// between equal samples may differ in the last digits.
const CONSTANT: f64 = 1e-12;
/// Relative tolerance on the minimum segment length, so that 500 times 0.02 s count as 10 s.
const LENGTH_ROUNDING: f64 = 1e-9;

/// Flight records cut into segments on a uniform time grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// Segments without gaps, by record and time; not empty.
    pub segments: Vec<Segment>,
    /// The same records with gaps filled where the missing samples can be estimated, by record and
    /// time.
    pub filled: Vec<FilledSegment>,
    /// The parts used from each record, in record order.
    pub records: Vec<RecordUse>,
    pub cautions: Vec<RecordCaution>,
}

/// Cuts flight records into segments, and returns them with the parts used and the cautions
/// (M14.1).
///
/// ```text
/// for each record, with the grid t_0 + k dt from its first stamp t_0
/// 1  dt = median stamp difference; if over 5 % of the differences are more than 20 % off the
///    multiples of dt, an error unless allowed
/// 2  for each channel the samples that count: finite, not frozen; fresh if the sensor is slow
///    (valid_samples, frozen_outputs); between them, the gaps (gap_search)
/// 3  value of a channel at t: the straight line at t + shift between two samples that are at most
///    (bridge + 1.5) dt apart, for fresh samples (bridge + 1.5) times the sensor's sample time;
///    shift: how late the channel is stamped; bridge: number of missing samples that is bridged
/// 4  segments = runs of the grid t_0 + k dt where every channel has a value, for at least the
///    minimum segment length (10 s by default)
/// then, over all records
///    no segment, or a channel that is constant in all of them: an error
///    cautions about channels (channel_cautions)
/// ```
///
/// No mean or trend is removed, and nothing is filtered. Every gap that is not bridged is cut out:
/// `filled` holds the same segments as `segments`.
///
/// # Errors
/// No records, invalid settings, records that do not fit them, time that does not increase or is
/// uneven, no segment left, a constant channel.
pub fn prepare(
    records: &[FlightRecord],
    preparation: &Preparation,
    executor: &dyn Executor,
) -> Result<Prepared, PreparationError> {
    prepare_records(records, preparation, None, executor)
}

/// Cuts flight records into segments as [`prepare`] does, and fills gaps whose samples can be
/// estimated from the spectral lines in the range `lines` (M14.21).
///
/// ```text
/// 5  filled segments = the longest parts of a record in which the hats of all gaps are less than a
///    tenth of the real values in the outputs' lines, with at least one segment without gaps
///    (grid_stretches)
/// 6  straight lines in the channels that miss samples, and in those alone
/// ```
///
/// # Errors
/// As [`prepare`].
pub(crate) fn prepare_filled(
    records: &[FlightRecord],
    preparation: &Preparation,
    lines: LineRange,
    executor: &dyn Executor,
) -> Result<Prepared, PreparationError> {
    prepare_records(records, preparation, Some(lines), executor)
}

/// Prepares all records; gaps are filled if there is a line range.
fn prepare_records(
    records: &[FlightRecord],
    preparation: &Preparation,
    lines: Option<LineRange>,
    executor: &dyn Executor,
) -> Result<Prepared, PreparationError> {
    preparation.check()?;
    if records.is_empty() {
        return Err(PreparationError::NoRecords);
    }
    let prepared = each(executor, records.iter().enumerate(), |(number, record)| {
        prepare_record(number, record, preparation, lines)
    });
    let mut segments = Vec::new();
    let mut filled = Vec::new();
    let mut uses = Vec::new();
    let mut cautions = Vec::new();
    let mut longest_s = 0.0_f64;
    for record in prepared {
        let record = record?;
        segments.extend(record.segments);
        filled.extend(record.filled);
        uses.push(record.used);
        cautions.extend(record.cautions);
        longest_s = longest_s.max(record.longest_s);
    }
    if segments.is_empty() {
        return Err(PreparationError::NothingLeft {
            longest_s,
            least_s: preparation.least_segment_s,
        });
    }
    let constant: Vec<Signal> = preparation
        .channels()
        .map(|(signal, _)| signal)
        .filter(|signal| is_constant(&segments, signal))
        .collect();
    if !constant.is_empty() {
        return Err(PreparationError::Constant(constant));
    }
    for used in &uses {
        cautions.extend(stuck_caution(&used.record, &used.gaps));
    }
    cautions.extend(channel_cautions(records, &segments, preparation));
    Ok(Prepared {
        segments,
        filled,
        records: uses,
        cautions,
    })
}

/// Cuts a record into segments as [`prepare`] does, for comparison with a model in the time domain.
///
/// Unlike in [`prepare`], a channel may be constant.
///
/// # Errors
/// Invalid settings, a record that does not fit them, time that does not increase or is uneven, no
/// segment left.
pub fn segments_of(
    record: &FlightRecord,
    preparation: &Preparation,
) -> Result<Vec<Segment>, PreparationError> {
    preparation.check()?;
    let PreparedRecord {
        segments,
        longest_s,
        ..
    } = prepare_record(0, record, preparation, None)?;
    if segments.is_empty() {
        return Err(PreparationError::NothingLeft {
            longest_s,
            least_s: preparation.least_segment_s,
        });
    }
    Ok(segments)
}

/// Returns whether a channel is constant within each segment, apart from rounding.
fn is_constant(segments: &[Segment], signal: &Signal) -> bool {
    segments.iter().all(|segment| {
        let samples = segment.channel(signal);
        samples.max() - samples.min() <= CONSTANT * samples.amax()
    })
}

struct PreparedRecord {
    segments: Vec<Segment>,
    filled: Vec<FilledSegment>,
    used: RecordUse,
    cautions: Vec<RecordCaution>,
    /// Longest run without a gap \[s\], even if it is too short for a segment.
    longest_s: f64,
}

/// Cuts a record into segments (steps 1 to 6); `number` is its index among the records.
fn prepare_record(
    number: usize,
    record: &FlightRecord,
    preparation: &Preparation,
    lines: Option<LineRange>,
) -> Result<PreparedRecord, PreparationError> {
    check_shape(record, preparation)?;
    // Step 1.
    let clock = Clock::new(record, preparation.longest_bridge)?;
    let mut cautions = Vec::new();
    cautions.extend(check_jitter(record, &clock, preparation.resample)?);
    // Step 2.
    let channels = valid_samples(record, &clock, preparation);
    let mut gaps = record_gaps(&clock, &channels);

    let mut parts = RecordParts {
        number,
        clock: &clock,
        preparation,
        lines,
        segments: Vec::new(),
        filled: Vec::new(),
        dropped: Vec::new(),
        longest_s: 0.0,
    };
    // Step 3, then steps 4 to 6.
    for rows in grid_rows(&clock, &channels, preparation.inputs.len()) {
        parts.add(&rows);
    }
    for gap in &mut gaps {
        if gap.treatment == Treatment::CutOut && parts.is_filled(gap) {
            gap.treatment = Treatment::Estimated;
        }
    }
    for dropped in parts.dropped {
        gaps.push(Gap {
            start_s: dropped.start_s,
            end_s: dropped.start_s + dropped.length_s,
            cause: Cause::SegmentTooShort(dropped.length_s),
            treatment: Treatment::CutOut,
        });
        cautions.push(RecordCaution::SegmentDropped {
            record: record.name.clone(),
            start_s: dropped.start_s,
            length_s: dropped.length_s,
        });
    }
    if parts.segments.is_empty() {
        cautions.push(RecordCaution::RecordUnused(record.name.clone()));
    }
    gaps.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    let used_s = parts.filled.iter().map(|part| part.segment.duration_s());
    Ok(PreparedRecord {
        used: RecordUse {
            record: record.name.clone(),
            sample_time_s: clock.sample_time_s,
            logged_s: clock.logged_s(),
            used_s: used_s.sum(),
            gaps,
            inputs_at_limit: inputs_at_limit(record, preparation),
        },
        segments: parts.segments,
        filled: parts.filled,
        cautions,
        longest_s: parts.longest_s,
    })
}

/// A run without gaps that is too short for a segment.
struct DroppedRun {
    /// Time at the first sample \[s\], on the record's time axis.
    start_s: f64,
    length_s: f64,
}

/// A record's parts that are used, and those that are dropped.
struct RecordParts<'a> {
    /// Record index, from 0.
    number: usize,
    clock: &'a Clock,
    preparation: &'a Preparation,
    /// Lines from which missing samples are estimated; `None` to cut at every gap.
    lines: Option<LineRange>,
    segments: Vec<Segment>,
    filled: Vec<FilledSegment>,
    dropped: Vec<DroppedRun>,
    /// Longest run without a gap \[s\].
    longest_s: f64,
}

impl RecordParts<'_> {
    /// Adds consecutive grid points (steps 4 to 6). A part is used if it has a run that is long
    /// enough for a segment; otherwise its runs are dropped.
    fn add(&mut self, rows: &GridRows) {
        for part in rows.parts(self.lines, self.clock.sample_time_s) {
            let runs = rows.runs(part.clone());
            let mut dropped = Vec::new();
            let mut has_segment = false;
            for run in runs {
                let start_s = self.start_s(rows, &run);
                let length_s = self.clock.sample_time_s * run.len() as f64;
                self.longest_s = self.longest_s.max(length_s);
                if length_s >= self.preparation.least_segment_s * (1.0 - LENGTH_ROUNDING) {
                    let segment = self.segment(rows, run);
                    self.segments.push(segment);
                    has_segment = true;
                } else {
                    dropped.push(DroppedRun { start_s, length_s });
                }
            }
            if has_segment {
                let segment = self.segment(rows, part.clone());
                self.filled
                    .push(FilledSegment::new(segment, rows.gaps(part)));
            } else {
                self.dropped.extend(dropped);
            }
        }
    }

    /// Returns the time at the first row in a range \[s\].
    fn start_s(&self, rows: &GridRows, range: &RowRange) -> f64 {
        self.clock.start_s + self.clock.sample_time_s * (rows.first + range.start as f64)
    }

    /// Returns the rows in a range, with 0 for missing samples.
    fn segment(&self, rows: &GridRows, range: RowRange) -> Segment {
        Segment {
            record: self.number,
            start_s: self.start_s(rows, &range),
            sample_time_s: self.clock.sample_time_s,
            inputs: rows.inputs(range.clone()),
            outputs: rows.outputs(range),
        }
    }

    /// Returns whether a gap's middle lies in a filled segment.
    fn is_filled(&self, gap: &Gap) -> bool {
        let middle = 0.5 * (gap.start_s + gap.end_s);
        self.filled.iter().any(|part| {
            let after_start_s = middle - part.segment.start_s;
            0.0 < after_start_s && after_start_s < part.segment.duration_s()
        })
    }
}

/// Returns an error for uneven sample times, or a caution if they may be interpolated.
fn check_jitter(
    record: &FlightRecord,
    clock: &Clock,
    may_resample: bool,
) -> Result<Option<RecordCaution>, PreparationError> {
    if !clock.is_uneven() {
        return Ok(None);
    }
    let name = record.name.clone();
    let percent = clock.jitter_percent;
    if may_resample {
        Ok(Some(RecordCaution::Resampled {
            record: name,
            percent,
        }))
    } else {
        Err(PreparationError::UnevenSampling {
            record: name,
            percent,
        })
    }
}

/// Returns an error for a record whose channels or lengths do not match.
fn check_shape(record: &FlightRecord, preparation: &Preparation) -> Result<(), PreparationError> {
    for role in [ChannelSide::Input, ChannelSide::Output] {
        let found = role.pick(&record.inputs, &record.outputs).ncols();
        let named = role.pick(&preparation.inputs, &preparation.outputs).len();
        if found != named {
            return Err(PreparationError::ChannelsDiffer {
                record: record.name.clone(),
                role,
                found,
                named,
            });
        }
    }
    let stamps = record.time_s.len();
    let inputs = record.inputs.nrows();
    let outputs = record.outputs.nrows();
    if stamps != inputs || stamps != outputs {
        return Err(PreparationError::LengthsDiffer {
            record: record.name.clone(),
            stamps,
            inputs,
            outputs,
        });
    }
    Ok(())
}
