//! From flight records as they were logged to segments without gaps on a uniform grid (M14, 1).

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::{FlightRecord, Segment, Signal};

use super::gaps::{Cause, Gap, Treatment, names};
use super::record_cautions::{RecordCaution, channel_cautions, inputs_at_limit, stuck_caution};
use super::sampling::{Clock, Track};

/// The longest shift of a channel that is a delay and not an error \[s\].
const LONGEST_SHIFT_S: f64 = 10.0;
/// The longest gap that may be bridged, in samples.
const LONGEST_BRIDGE: usize = 1000;

/// What the stairs in a channel are, where it is logged more often than it changes (M14, 1.3).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Hold {
    /// Samples of a continuous signal; stairs raise a caution.
    #[default]
    None,
    /// The stairs really act on the aircraft, or are the sensor's resolution: the samples are right as they are.
    Acts,
    /// A command held for `hold_s` \[s\] and logged when it begins: it acts `hold_s / 2` later.
    Command {
        /// Time for which it is held \[s\].
        hold_s: f64,
    },
    /// A sensor with the sample time `hold_s` \[s\], repeated by a faster logger: it was measured `hold_s / 2` earlier.
    SlowSensor {
        /// The sensor's sample time \[s\].
        hold_s: f64,
    },
    /// A sensor slower than the logger: only the samples that are new count, with straight lines between them.
    FreshSamples,
}

/// How one channel is prepared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelPreparation {
    /// Its name, for people.
    pub name: String,
    /// How late it is logged \[s\]: a known delay of sensor or bus, taken out.
    pub delay_s: f64,
    /// What its stairs are.
    pub hold: Hold,
    /// The greatest modulus that is right in its unit; above it the unit is in doubt.
    pub limit: Option<f64>,
}

impl ChannelPreparation {
    /// A channel to be taken as it is.
    #[must_use]
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }

    /// How much later than its own time a sample is logged \[s\].
    pub(super) fn shift_s(&self) -> f64 {
        match self.hold {
            Hold::Command { hold_s } => self.delay_s - 0.5 * hold_s,
            Hold::SlowSensor { hold_s } => self.delay_s + 0.5 * hold_s,
            Hold::None | Hold::Acts | Hold::FreshSamples => self.delay_s,
        }
    }
}

/// How flight records are prepared.
#[derive(Clone, Debug, PartialEq)]
pub struct Preparation {
    /// The inputs, in the order of the columns.
    pub inputs: Vec<ChannelPreparation>,
    /// The outputs, in the order of the columns.
    pub outputs: Vec<ChannelPreparation>,
    /// Whether a record with uneven sample times may be interpolated.
    pub resample: bool,
    /// Whether an output that stands still while others move is right, and no gap.
    pub keep_frozen: bool,
    /// The longest gap, in samples, that is bridged by a straight line; a longer one splits the record.
    pub longest_bridge: usize,
    /// The least length of a segment \[s\].
    pub least_segment_s: f64,
}

impl Preparation {
    /// Every channel as it is, gaps of 3 samples bridged, segments of 10 s.
    #[must_use]
    pub fn of(inputs: &[&str], outputs: &[&str]) -> Self {
        let channels = |names: &[&str]| {
            names
                .iter()
                .map(|name| ChannelPreparation::named(*name))
                .collect()
        };
        Self {
            inputs: channels(inputs),
            outputs: channels(outputs),
            resample: false,
            keep_frozen: false,
            longest_bridge: 3,
            least_segment_s: 10.0,
        }
    }

    /// Inputs, then outputs.
    pub(super) fn channels(&self) -> impl Iterator<Item = (Signal, &ChannelPreparation)> {
        let of_role = |role: ChannelSide| {
            let channels = role.of(&self.inputs, &self.outputs).iter().enumerate();
            channels.map(move |(index, channel)| {
                (
                    Signal {
                        role,
                        index,
                        name: channel.name.clone(),
                    },
                    channel,
                )
            })
        };
        of_role(ChannelSide::Input).chain(of_role(ChannelSide::Output))
    }

    /// How a channel is prepared.
    pub fn channel(&self, signal: &Signal) -> Option<&ChannelPreparation> {
        signal
            .role
            .of(&self.inputs, &self.outputs)
            .get(signal.index)
    }

    /// How a channel is prepared, to change.
    pub fn channel_mut(&mut self, signal: &Signal) -> Option<&mut ChannelPreparation> {
        signal
            .role
            .of(&mut self.inputs, &mut self.outputs)
            .get_mut(signal.index)
    }

    fn checked(&self) -> Result<(), PreparationError> {
        let is_missing = |role: &ChannelSide| role.of(&self.inputs, &self.outputs).is_empty();
        if let Some(role) = [ChannelSide::Input, ChannelSide::Output]
            .into_iter()
            .find(is_missing)
        {
            return Err(PreparationError::NoChannels(role));
        }
        for (signal, channel) in self.channels() {
            let hold_s = match channel.hold {
                Hold::Command { hold_s } | Hold::SlowSensor { hold_s } => hold_s,
                Hold::None | Hold::Acts | Hold::FreshSamples => 0.0,
            };
            for seconds in [channel.delay_s, hold_s] {
                if !seconds.is_finite() || seconds.abs() > LONGEST_SHIFT_S {
                    return Err(PreparationError::Shift { signal, seconds });
                }
            }
        }
        if !(self.least_segment_s.is_finite() && self.least_segment_s > 0.0) {
            return Err(PreparationError::LeastSegment(self.least_segment_s));
        }
        if self.longest_bridge > LONGEST_BRIDGE {
            return Err(PreparationError::Bridge(self.longest_bridge));
        }
        Ok(())
    }
}

/// What was used of a record, and what was not.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordUse {
    /// The record's name.
    pub record: String,
    /// Median sample time \[s\], 0 where there are not two stamps.
    pub sample_time_s: f64,
    /// From the first stamp to the last \[s\].
    pub logged_s: f64,
    /// Sum of the lengths of its segments \[s\].
    pub used_s: f64,
    /// Gaps, by the time at which they begin.
    pub gaps: Vec<Gap>,
    /// Inputs that stand at their limit, and for which share of the record \[%\]: a fact, for a saturated actuator is the signal.
    pub inputs_at_limit: Vec<(Signal, f64)>,
}

impl RecordUse {
    /// What is no fault of it, in words.
    pub fn facts(&self) -> impl Iterator<Item = String> {
        self.inputs_at_limit.iter().map(|(signal, percent)| {
            format!(
                "{}: {signal} is at its limit for {percent:.1} % of it, and used as it is",
                self.record
            )
        })
    }

    /// First and last time \[s\] of each part of the record between what was cut out of it.
    pub fn spans(&self, record: &FlightRecord) -> Vec<[f64; 2]> {
        let cut = || {
            self.gaps
                .iter()
                .filter(|gap| gap.treatment == Treatment::CutOut)
        };
        let finite = || {
            record
                .time_s
                .iter()
                .copied()
                .filter(|time| time.is_finite())
        };
        let (Some(first), Some(last)) = (finite().next(), finite().next_back()) else {
            return Vec::new();
        };
        let starts = std::iter::once(first).chain(cut().map(|gap| gap.end_s));
        let ends = cut().map(|gap| gap.start_s).chain([last]);
        starts
            .zip(ends)
            .filter(|(start, end)| start < end)
            .map(|(start, end)| [start, end])
            .collect()
    }
}

/// Flight records, prepared.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// The segments, by record and time; at least one.
    pub segments: Vec<Segment>,
    /// What was used of each record, in the order of the records.
    pub records: Vec<RecordUse>,
    /// What the engineer should know.
    pub cautions: Vec<RecordCaution>,
}

/// Why flight records cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PreparationError {
    /// There are no records.
    #[error("there are no flight records")]
    NoRecords,
    /// No inputs or no outputs.
    #[error("no {0} is named: identification needs at least one input and one output")]
    NoChannels(ChannelSide),
    /// A record has other channels than the ones named.
    #[error("record {record} has {found} {role}s where {named} are named")]
    ChannelsDiffer {
        /// The record's name.
        record: String,
        /// Inputs or outputs.
        role: ChannelSide,
        /// How many it has.
        found: usize,
        /// How many are named.
        named: usize,
    },
    /// The columns of a record are not of the same length.
    #[error(
        "record {record} has {stamps} time stamps, {inputs} samples of the inputs and {outputs} of the outputs"
    )]
    LengthsDiffer {
        /// The record's name.
        record: String,
        /// Its time stamps.
        stamps: usize,
        /// Samples of its inputs.
        inputs: usize,
        /// Samples of its outputs.
        outputs: usize,
    },
    /// A delay or a hold that is not finite or too long.
    #[error(
        "a delay or hold of {seconds} s for {signal}: it must be a number of at most {LONGEST_SHIFT_S} s"
    )]
    Shift {
        /// The channel.
        signal: Signal,
        /// The delay or hold \[s\].
        seconds: f64,
    },
    /// The least length of a segment is no length.
    #[error("a least piece of {0} s: it must be greater than 0")]
    LeastSegment(f64),
    /// The longest gap to bridge is too long.
    #[error("gaps of {0} samples are too long to be bridged: at most {LONGEST_BRIDGE}")]
    Bridge(usize),
    /// Time does not go on.
    #[error(
        "record {record}: time goes from {previous_s} s to {time_s} s in row {}. Sort the rows, or delete the repeated ones",
        row + 1
    )]
    TimeNotIncreasing {
        /// The record's name.
        record: String,
        /// Row of the later stamp, counted from 0.
        row: usize,
        /// The stamp before it \[s\].
        previous_s: f64,
        /// Its stamp \[s\].
        time_s: f64,
    },
    /// Sample times vary too much.
    #[error(
        "record {record}: the sample time varies by {percent:.0} %, more than 20 %. Where the stamps can be trusted, say a rate to interpolate to (--resample)"
    )]
    UnevenSampling {
        /// The record's name.
        record: String,
        /// 95th percentile of the deviation from whole multiples of the median sample time \[%\].
        percent: f64,
    },
    /// No segment is long enough.
    #[error(
        "nothing is left: the longest piece without a gap lasts {longest_s:.1} s, and {least_s:.1} s are the least. \
         Log longer records, mend the gaps, or leave out the channel that has them"
    )]
    NothingLeft {
        /// Length of the longest segment \[s\].
        longest_s: f64,
        /// Least length \[s\].
        least_s: f64,
    },
    /// Channels that never move.
    #[error("{} never moved in any record: leave {} out", names(.0), if .0.len() == 1 { "it" } else { "them" })]
    Constant(Vec<Signal>),
}

/// The segments of `records` that can be used, what was used of each record, and what speaks against it (M14, 1).
///
/// ```text
/// of each record
///   dt = median difference of the stamps; refuse stamps more than 20 % off the multiples of dt, unless allowed
///   of each channel the samples that count: a finite value, not frozen; of a slow sensor the fresh ones
///   its value at t: the straight line at t + shift between two of them no further apart than (bridge + 1.5) dt
///   segments = runs of the grid t_0 + k dt where every channel has a value, of at least 10 s
/// ```
///
/// No mean or trend is taken off, and nothing is filtered.
///
/// # Errors
/// Settings out of range, records that do not fit them, time that does not increase or is uneven, no segment left, a constant
/// channel.
pub fn prepare(
    records: &[FlightRecord],
    preparation: &Preparation,
    executor: &dyn Executor,
) -> Result<Prepared, PreparationError> {
    preparation.checked()?;
    if records.is_empty() {
        return Err(PreparationError::NoRecords);
    }
    let prepared = each(executor, records.iter().enumerate(), |(k, record)| {
        prepare_record(k, record, preparation)
    });
    let prepared = prepared.into_iter().collect::<Result<Vec<_>, _>>()?;
    let longest_s = prepared.iter().map(|one| one.longest_s).fold(0.0, f64::max);
    let mut segments = Vec::new();
    let mut uses = Vec::new();
    let mut cautions = Vec::new();
    for one in prepared {
        segments.extend(one.segments);
        uses.push(one.used);
        cautions.extend(one.cautions);
    }
    if segments.is_empty() {
        return Err(PreparationError::NothingLeft {
            longest_s,
            least_s: preparation.least_segment_s,
        });
    }
    let signals: Vec<Signal> = preparation.channels().map(|(signal, _)| signal).collect();
    let constant: Vec<Signal> = signals
        .into_iter()
        .filter(|signal| is_constant(&segments, signal))
        .collect();
    if !constant.is_empty() {
        return Err(PreparationError::Constant(constant));
    }
    cautions.extend(uses.iter().filter_map(stuck_caution));
    cautions.extend(channel_cautions(records, &segments, preparation));
    Ok(Prepared {
        segments,
        records: uses,
        cautions,
    })
}

/// The segments of one record that a model is compared with in time, as [`prepare`] makes them; a channel that never moved is no
/// hindrance to that.
///
/// # Errors
/// Settings out of range, a record that does not fit them, time that does not increase or is uneven, no segment left.
pub fn segments_of(
    record: &FlightRecord,
    preparation: &Preparation,
) -> Result<Vec<Segment>, PreparationError> {
    preparation.checked()?;
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

/// Whether a channel has one value within each segment, but for rounding.
fn is_constant(segments: &[Segment], signal: &Signal) -> bool {
    segments.iter().all(|segment| {
        let samples = segment.channel(signal);
        // Interpolation between equal samples may differ in the last digits.
        samples.max() - samples.min() <= 1e-12 * samples.amax()
    })
}

/// A record, prepared.
struct PreparedRecord {
    segments: Vec<Segment>,
    used: RecordUse,
    cautions: Vec<RecordCaution>,
    /// Length of its longest run without a gap \[s\], long enough or not.
    longest_s: f64,
}

fn prepare_record(
    index: usize,
    record: &FlightRecord,
    preparation: &Preparation,
) -> Result<PreparedRecord, PreparationError> {
    check_shape(record, preparation)?;
    let clock = Clock::of(record, preparation.longest_bridge)?;
    let mut cautions = Vec::new();
    if clock.is_uneven() {
        let name = record.name.clone();
        let percent = clock.jitter_percent;
        if !preparation.resample {
            return Err(PreparationError::UnevenSampling {
                record: name,
                percent,
            });
        }
        cautions.push(RecordCaution::Resampled {
            record: name,
            percent,
        });
    }
    let (tracks, mut gaps) = Track::all(record, &clock, preparation);
    gaps.extend(clock.gaps());
    let runs = runs(&clock, &tracks);

    let mut segments = Vec::new();
    let mut longest_s = 0.0_f64;
    for run in runs {
        let start_s = clock.start_s + clock.sample_time_s * run.first;
        let samples = run.rows.len() / tracks.len();
        let length_s = clock.sample_time_s * samples as f64;
        longest_s = longest_s.max(length_s);
        // A hair of tolerance, so that 500 samples of 0.02 s are 10 s.
        if length_s >= preparation.least_segment_s * (1.0 - 1e-9) {
            segments.push(run.segment(index, start_s, clock.sample_time_s, preparation));
        } else {
            let cause = Cause::SegmentTooShort(length_s);
            let treatment = Treatment::CutOut;
            gaps.push(Gap {
                start_s,
                end_s: start_s + length_s,
                cause,
                treatment,
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
    let inputs_at_limit = inputs_at_limit(record, preparation);
    let used_s = segments
        .iter()
        .map(|segment| segment.sample_time_s * segment.inputs.nrows() as f64)
        .sum();
    let record = record.name.clone();
    let sample_time_s = clock.sample_time_s;
    let logged_s = clock.logged_s();
    Ok(PreparedRecord {
        segments,
        used: RecordUse {
            record,
            sample_time_s,
            logged_s,
            used_s,
            gaps,
            inputs_at_limit,
        },
        cautions,
        longest_s,
    })
}

fn check_shape(record: &FlightRecord, preparation: &Preparation) -> Result<(), PreparationError> {
    for role in [ChannelSide::Input, ChannelSide::Output] {
        let found = role.of(&record.inputs, &record.outputs).ncols();
        let named = role.of(&preparation.inputs, &preparation.outputs).len();
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

/// Consecutive points of the grid at which every channel has a value.
struct Run {
    /// Index of its first point of the grid; whole.
    first: f64,
    /// Samples, row after row: inputs, then outputs.
    rows: Vec<f64>,
}

impl Run {
    fn segment(
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

/// The runs of the record's grid `k dt`, counted from its first stamp.
fn runs(clock: &Clock, tracks: &[Track]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut readers: Vec<_> = tracks.iter().map(Track::reader).collect();
    let mut row = vec![0.0; tracks.len()];
    for (first, points) in clock.grid() {
        let mut open = false;
        for k in (0..points).map(|point| first + point as f64) {
            let t = k * clock.sample_time_s;
            let complete =
                readers
                    .iter_mut()
                    .zip(&mut row)
                    .fold(true, |complete, (reader, value)| {
                        let read = reader.at(t);
                        *value = read.unwrap_or(0.0);
                        complete && read.is_some()
                    });
            if complete && !open {
                runs.push(Run {
                    first: k,
                    rows: Vec::new(),
                });
            }
            if let (true, Some(run)) = (complete, runs.last_mut()) {
                run.rows.extend_from_slice(&row);
            }
            open = complete;
        }
    }
    runs
}
