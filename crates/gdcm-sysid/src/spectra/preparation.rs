//! From flight records as logged to segments without gaps on a uniform grid (M14.1).

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::{FlightRecord, Segment, Signal};

use super::gap::{Cause, Gap, Treatment};
use super::gap_search::record_gaps;
use super::preparation_settings::{Preparation, PreparationError};
use super::record_cautions::{RecordCaution, channel_cautions, inputs_at_limit, stuck_caution};
use super::record_clock::Clock;
use super::record_use::RecordUse;
use super::valid_samples::{ValidSamples, read_row, valid_samples};

/// Maximum range of a constant channel, relative to its maximum modulus: interpolation between equal
/// samples may differ in the last digits.
const CONSTANT: f64 = 1e-12;
/// Relative tolerance of the minimum segment length, so that 500 times 0.02 s count as 10 s.
const LENGTH_ROUNDING: f64 = 1e-9;

/// Flight records cut into gap-free segments on a uniform time grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// Segments, by record and time; not empty.
    pub segments: Vec<Segment>,
    /// Use of each record, in record order.
    pub records: Vec<RecordUse>,
    pub cautions: Vec<RecordCaution>,
}

/// Cuts flight records into segments, and returns their use and the cautions about them (M14.1).
///
/// ```text
/// for each record
/// 1  dt = median stamp difference; stamps more than 20 % off the multiples of dt are
///    an error unless allowed
/// 2  for each channel the samples that count: finite, not frozen; fresh if the sensor is slow
///    (valid_samples, frozen_outputs); between them, the gaps (gap_search)
/// 3  value of a channel at t: the straight line at t + shift between two samples that are at most
///    (bridge + 1.5) dt apart, for fresh samples (bridge + 1.5) times the sensor's sample time
/// 4  segments = runs of the grid t_0 + k dt where every channel has a value, for at least 10 s
/// ```
///
/// No mean or trend is removed, and nothing is filtered.
///
/// # Errors
/// Invalid settings, records that do not fit them, time that does not increase or is uneven,
/// no segment left, a constant channel.
pub fn prepare(
    records: &[FlightRecord],
    preparation: &Preparation,
    executor: &dyn Executor,
) -> Result<Prepared, PreparationError> {
    preparation.check()?;
    if records.is_empty() {
        return Err(PreparationError::NoRecords);
    }
    let prepared = each(executor, records.iter().enumerate(), |(number, record)| {
        prepare_record(number, record, preparation)
    });
    let mut segments = Vec::new();
    let mut uses = Vec::new();
    let mut cautions = Vec::new();
    let mut longest_s = 0.0_f64;
    for record in prepared {
        let record = record?;
        segments.extend(record.segments);
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
        records: uses,
        cautions,
    })
}

/// Cuts a record into segments for a comparison with a model in the time domain, as [`prepare`]
/// does.
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
    } = prepare_record(0, record, preparation)?;
    if segments.is_empty() {
        return Err(PreparationError::NothingLeft {
            longest_s,
            least_s: preparation.least_segment_s,
        });
    }
    Ok(segments)
}

/// Whether a channel is constant within each segment, apart from rounding.
fn is_constant(segments: &[Segment], signal: &Signal) -> bool {
    segments.iter().all(|segment| {
        let samples = segment.channel(signal);
        samples.max() - samples.min() <= CONSTANT * samples.amax()
    })
}

struct PreparedRecord {
    segments: Vec<Segment>,
    used: RecordUse,
    cautions: Vec<RecordCaution>,
    /// Longest run without a gap \[s\], even if it is too short for a segment.
    longest_s: f64,
}

/// Cuts a record into segments (steps 1 to 4); `number` is its index among the records.
fn prepare_record(
    number: usize,
    record: &FlightRecord,
    preparation: &Preparation,
) -> Result<PreparedRecord, PreparationError> {
    check_shape(record, preparation)?;
    let clock = Clock::new(record, preparation.longest_bridge)?;
    let mut cautions = Vec::new();
    cautions.extend(check_jitter(record, &clock, preparation.resample)?);
    let channels = valid_samples(record, &clock, preparation);
    let mut gaps = record_gaps(&clock, &channels);

    let mut segments = Vec::new();
    let mut longest_s = 0.0_f64;
    for run in runs(&clock, &channels) {
        let start_s = clock.start_s + clock.sample_time_s * run.first;
        let samples = run.rows.len() / channels.len();
        let length_s = clock.sample_time_s * samples as f64;
        longest_s = longest_s.max(length_s);
        if length_s >= preparation.least_segment_s * (1.0 - LENGTH_ROUNDING) {
            segments.push(run.into_segment(number, start_s, clock.sample_time_s, preparation));
        } else {
            gaps.push(Gap {
                start_s,
                end_s: start_s + length_s,
                cause: Cause::SegmentTooShort(length_s),
                treatment: Treatment::CutOut,
            });
            cautions.push(RecordCaution::SegmentDropped {
                record: record.name.clone(),
                start_s,
                length_s,
            });
        }
    }
    if segments.is_empty() {
        cautions.push(RecordCaution::RecordUnused(record.name.clone()));
    }
    gaps.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    let used_s = segments
        .iter()
        .map(|segment| segment.sample_time_s * segment.inputs.nrows() as f64)
        .sum();
    Ok(PreparedRecord {
        segments,
        used: RecordUse {
            record: record.name.clone(),
            sample_time_s: clock.sample_time_s,
            logged_s: clock.logged_s(),
            used_s,
            gaps,
            inputs_at_limit: inputs_at_limit(record, preparation),
        },
        cautions,
        longest_s,
    })
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

/// Consecutive grid points at which every channel has a value.
struct Run {
    /// First grid index, an integer value.
    first: f64,
    /// Samples row by row: sample `n` of channel `c` at `n channels + c`, inputs first.
    rows: Vec<f64>,
}

impl Run {
    fn into_segment(
        self,
        record: usize,
        start_s: f64,
        sample_time_s: f64,
        preparation: &Preparation,
    ) -> Segment {
        let inputs = preparation.inputs.len();
        let outputs = preparation.outputs.len();
        let width = inputs + outputs;
        let samples = self.rows.len() / width;
        Segment {
            record,
            start_s,
            sample_time_s,
            inputs: DMatrix::from_fn(samples, inputs, |n, i| self.rows[n * width + i]),
            outputs: DMatrix::from_fn(samples, outputs, |n, o| self.rows[n * width + inputs + o]),
        }
    }
}

/// Finds the runs of a record on the grid `k dt`, relative to its first stamp.
fn runs(clock: &Clock, channels: &[ValidSamples]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut readers: Vec<_> = channels.iter().map(ValidSamples::reader).collect();
    let mut row = vec![0.0; channels.len()];
    for stretch in clock.grid() {
        let mut is_open = false;
        for k in (0..stretch.points).map(|point| stretch.first + point as f64) {
            let is_complete = read_row(&mut readers, k * clock.sample_time_s, &mut row);
            if is_complete && !is_open {
                runs.push(Run {
                    first: k,
                    rows: Vec::new(),
                });
            }
            if is_complete && let Some(run) = runs.last_mut() {
                run.rows.extend_from_slice(&row);
            }
            is_open = is_complete;
        }
    }
    runs
}
