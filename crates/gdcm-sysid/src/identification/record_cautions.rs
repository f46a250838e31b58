//! What the engineer should know of the flight records, and how it is found in their channels.

use std::collections::BTreeSet;

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::response::curve_values::quantile;
use gdcm_model::response::median;
use gdcm_model::simulation::{FlightRecord, Segment, Signal, centred};

use super::cautions::CautionNote;
use super::gaps::{Cause, names};
use super::preparation::{Hold, Preparation, RecordUse};

/// A channel with more equal consecutive samples than this while it moves is a stair (M14, 1.3).
const HELD: f64 = 0.5;
/// Equal samples for longer than this are a channel that does not move, and no stair \[s\].
const STANDING_S: f64 = 1.0;
/// With fewer samples than this in motion nothing is said about stairs.
const SAMPLES_IN_MOTION: usize = 50;
/// Two inputs with a correlation beyond this are moved together.
const TOGETHER: f64 = 0.99;
/// An output with a correlation to an input beyond this is a copy of it, and so is an output of another output.
const COPY: f64 = 0.9999;

/// Something in the flight records that may spoil the identification, or that was done to them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordCaution {
    /// A record with uneven sample times was interpolated, as allowed.
    #[error(
        "{record}: the sample time varies by {percent:.0} %; it was interpolated to even steps"
    )]
    Resampled {
        /// The record's name.
        record: String,
        /// 95th percentile of the deviation from multiples of the sample time \[%\].
        percent: f64,
    },
    /// What is left between two gaps is too short.
    #[error("{record}: {length_s:.1} s from {start_s:.2} s were left out, too short between gaps")]
    SegmentDropped {
        /// The record's name.
        record: String,
        /// Where it begins \[s\].
        start_s: f64,
        /// Its length \[s\].
        length_s: f64,
    },
    /// Nothing of a record is used.
    #[error("{0}: nothing of it could be used")]
    RecordUnused(String),
    /// Most consecutive samples of a channel in motion are equal.
    #[error(
        "{signal}: {percent:.0} % of consecutive samples are equal, it changes every {:.0} ms. Say which it is: {}or stairs that \
                 are right as they are (nothing done, as now)",
        1e3 * hold_s, hold_choices(signal.role, 1e3 * hold_s)
    )]
    SampleHold {
        /// The channel.
        signal: Signal,
        /// Share of equal samples \[%\].
        percent: f64,
        /// Median time from one change to the next \[s\].
        hold_s: f64,
    },
    /// A value that cannot be right in the channel's unit.
    #[error("{signal} reaches {greatest:.3}, beyond {limit}: check its unit")]
    UnlikelyUnit {
        /// The channel.
        signal: Signal,
        /// Its greatest modulus.
        greatest: f64,
        /// The greatest that is right.
        limit: f64,
    },
    /// Two inputs always move together.
    #[error(
        "{} always moved together (correlation {correlation:.3}): their effects cannot be told apart",
        names(signals)
    )]
    MovedTogether {
        /// The inputs.
        signals: [Signal; 2],
        /// Their correlation.
        correlation: f64,
    },
    /// An output stands at its limit.
    #[error(
        "{signal} is at its limit for {percent:.1} % of {record}{}: nothing repairs that. Leave the output out, or {}",
        if *records > 1 { format!(", and in {} other records", records - 1) } else { String::new() },
        if *records > 1 { "these records" } else { "the record" }
    )]
    AtLimit {
        /// Name of the record in which it is most.
        record: String,
        /// The output.
        signal: Signal,
        /// Share of the samples \[%\].
        percent: f64,
        /// Records in which it is too much.
        records: usize,
    },
    /// Outputs stood still while others moved.
    #[error(
        "{record}: {} stood still for {seconds:.1} s while other channels moved; that was left out",
        names(signals)
    )]
    Stuck {
        /// The record's name.
        record: String,
        /// The outputs.
        signals: Vec<Signal>,
        /// For how long in all \[s\].
        seconds: f64,
    },
    /// An output is logged in coarse steps.
    #[error(
        "{signal} is logged in steps of {steps:.1} standard deviations: coarse, though no harm was ever measured of that"
    )]
    Coarse {
        /// The output.
        signal: Signal,
        /// Step over the standard deviation.
        steps: f64,
    },
    /// An output is a copy of another channel.
    #[error(
        "{copy} is a copy of the {} {of}: leave it out", of.role
    )]
    Copy {
        /// The output.
        copy: Signal,
        /// The channel that it copies.
        of: Signal,
    },
}

/// What the steps in a channel may be, by whether it is an input.
fn hold_choices(role: ChannelSide, hold_ms: f64) -> String {
    let half = 0.5 * hold_ms;
    let command = format!("a command held and logged once a hold (moved {half:.0} ms later), ");
    let command = if role == ChannelSide::Input {
        command
    } else {
        String::new()
    };
    format!("{command}a slow sensor (only fresh samples kept, or moved {half:.0} ms earlier), ")
}

/// The cautions about channels, from the records as logged and the segments made of them.
pub(super) fn channel_cautions(
    records: &[FlightRecord],
    segments: &[Segment],
    preparation: &Preparation,
) -> Vec<RecordCaution> {
    let mut cautions = Vec::new();
    for (signal, channel) in preparation.channels() {
        let of_record = |record| samples(record, &signal);
        let greatest = segments
            .iter()
            .map(|segment| segment.channel(&signal).amax())
            .fold(0.0, f64::max);
        if let Some(limit) = channel.limit.filter(|limit| greatest > *limit) {
            cautions.push(RecordCaution::UnlikelyUnit {
                signal: signal.clone(),
                greatest,
                limit,
            });
        }
        // Stairs of an output in coarse steps are those steps.
        let all = || {
            records
                .iter()
                .flat_map(|record| finite(record, &signal))
                .collect::<Vec<f64>>()
        };
        if channel.hold == Hold::None
            && (signal.role == ChannelSide::Input || !is_coarse(&all()))
            && let Some((share, hold_s)) = sample_hold(records.iter().map(of_record))
        {
            cautions.push(RecordCaution::SampleHold {
                signal,
                percent: 100.0 * share,
                hold_s,
            });
        }
    }
    cautions.extend(output_cautions(records, preparation));
    cautions.extend(correlated(segments, preparation));
    cautions
}

/// The outputs that were stuck in a record, by its gaps.
pub(super) fn stuck_caution(used: &RecordUse) -> Option<RecordCaution> {
    let frozen = used.gaps.iter().filter_map(|gap| match &gap.cause {
        Cause::Frozen(signals) => Some((signals, gap.end_s - gap.start_s)),
        _ => None,
    });
    let mut all = BTreeSet::new();
    let mut seconds = 0.0;
    for (signals, length_s) in frozen {
        all.extend(signals.iter().cloned());
        seconds += length_s;
    }
    let signals: Vec<Signal> = all.into_iter().collect();
    (!signals.is_empty()).then(|| RecordCaution::Stuck {
        record: used.record.clone(),
        signals,
        seconds,
    })
}

/// Stamps and values of a channel in `record` where both are there.
fn samples(record: &FlightRecord, signal: &Signal) -> Vec<(f64, f64)> {
    let column = record.channel(signal);
    let stamped = record.time_s.iter().copied().zip(column.iter().copied());
    stamped
        .filter(|(time, value)| time.is_finite() && value.is_finite())
        .collect()
}

/// Share of equal consecutive samples in a channel while it moves, and the median time between changes \[s\]; none where
/// the share is a half or less.
fn sample_hold(records: impl Iterator<Item = Vec<(f64, f64)>>) -> Option<(f64, f64)> {
    let mut samples = 0;
    let mut steps = Vec::new();
    for record in records {
        let runs: Vec<_> = record.chunk_by(|a, b| a.1 == b.1).collect();
        for pair in runs.windows(2) {
            let held_s = pair[1][0].0 - pair[0][0].0;
            if held_s <= STANDING_S {
                samples += pair[0].len();
                steps.push(held_s);
            }
        }
    }
    let share = 1.0 - steps.len() as f64 / samples.max(1) as f64;
    (samples >= SAMPLES_IN_MOTION && share > HELD).then(|| (share, median(&mut steps)))
}

/// Channels that move together, by their correlation over all segments.
fn correlated(segments: &[Segment], preparation: &Preparation) -> Vec<RecordCaution> {
    let signals: Vec<Signal> = preparation.channels().map(|(signal, _)| signal).collect();
    let mut covariance = DMatrix::zeros(signals.len(), signals.len());
    for segment in segments {
        let samples: Vec<_> = signals
            .iter()
            .map(|signal| segment.channel(signal))
            .collect();
        let centred = centred(DMatrix::from_columns(&samples));
        covariance += centred.tr_mul(&centred);
    }
    let mut cautions = Vec::new();
    for (second, b) in signals.iter().enumerate() {
        for (first, a) in signals.iter().enumerate().take(second) {
            let power = (covariance[(first, first)] * covariance[(second, second)]).sqrt();
            let correlation: f64 = covariance[(first, second)] / power;
            match b.role {
                ChannelSide::Input if correlation.abs() > TOGETHER => {
                    cautions.push(RecordCaution::MovedTogether {
                        signals: [a.clone(), b.clone()],
                        correlation,
                    });
                }
                ChannelSide::Output if correlation.abs() > COPY => {
                    cautions.push(RecordCaution::Copy {
                        copy: b.clone(),
                        of: a.clone(),
                    })
                }
                ChannelSide::Input | ChannelSide::Output => {}
            }
        }
    }
    cautions
}

// Channels at their limit, stuck or coarse (M14.18).
//
// ```text
// flat: consecutive |dx| <= 1e-3 mean |dx|;  a run is a stretch of flat samples, or one sample
// at its limit: the share of samples in runs of at least max(5, 3 q) whose mean lies in the outer 5 % of the range,
//               q the 90 % quantile of the flat runs elsewhere;  caution above 0.5 %, or 10 % where flat runs elsewhere hold 20 % of the samples
// coarse: the least step between two values is over half the standard deviation
// ```

/// Step over the mean step up to which two samples are flat.
const FLAT: f64 = 1e-3;
/// The shortest run at a limit, and the same over the quantile of the runs elsewhere.
const SHORTEST: f64 = 5.0;
const OVER_USUAL: f64 = 3.0;
const USUAL: f64 = 0.9;
/// Share of the range at each end in which a limit lies.
const OUTER: f64 = 0.05;
/// Share of the samples at a limit that is too much, of a smooth channel and of a coarse or held one, and what tells these apart.
const TOO_MANY: (f64, f64) = (0.005, 0.1);
const HELD_SHARE: f64 = 0.2;
/// Least step between values over the standard deviation above which a channel is coarse.
const COARSE: f64 = 0.5;

/// How often a channel is at its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clipping {
    /// Share of the samples.
    pub(super) share: f64,
    /// The share that is too much.
    pub(super) most: f64,
}

/// How often the samples of a channel are at its limit.
pub(super) fn clipping(samples: &[f64]) -> Clipping {
    let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let flat = FLAT * steps.sum::<f64>() / samples.len().saturating_sub(1).max(1) as f64;
    let (least, greatest) = samples
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(*x), b.max(*x))
        });
    let outer = OUTER * (greatest - least);
    let runs: Vec<&[f64]> = samples.chunk_by(|a, b| (b - a).abs() <= flat).collect();
    let is_outer = |run: &[f64]| {
        let mean = run.iter().sum::<f64>() / run.len() as f64;
        mean >= greatest - outer || mean <= least + outer
    };
    let (at_ends, elsewhere): (Vec<&[f64]>, Vec<&[f64]>) =
        runs.into_iter().partition(|run| is_outer(run));
    let mut lengths: Vec<f64> = elsewhere
        .iter()
        .filter(|run| run.len() > 1)
        .map(|run| run.len() as f64)
        .collect();
    let usual = if lengths.is_empty() {
        1.0
    } else {
        quantile(&mut lengths, USUAL)
    };
    let shortest = SHORTEST.max(OVER_USUAL * usual);
    let share = |count: usize| count as f64 / samples.len().max(1) as f64;
    let at_limit = at_ends
        .iter()
        .filter(|run| run.len() as f64 >= shortest)
        .map(|run| run.len())
        .sum();
    let held = share(
        elsewhere
            .iter()
            .filter(|run| run.len() > 1)
            .map(|run| run.len())
            .sum(),
    );
    Clipping {
        share: share(at_limit),
        most: if held > HELD_SHARE {
            TOO_MANY.1
        } else {
            TOO_MANY.0
        },
    }
}

/// Whether a channel has so few values that to stand still is nothing unusual.
pub(super) fn is_coarse(samples: &[f64]) -> bool {
    coarseness(samples).is_some_and(|steps| steps > COARSE)
}

/// The least step between two values over the standard deviation; none where nothing moves.
fn coarseness(samples: &[f64]) -> Option<f64> {
    let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    let deviation = (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
        / samples.len().max(1) as f64)
        .sqrt();
    let mut values = samples.to_vec();
    values.sort_by(f64::total_cmp);
    let steps = values
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > FLAT * deviation);
    let least = steps.fold(f64::INFINITY, f64::min);
    (deviation > 0.0 && least.is_finite()).then_some(least / deviation)
}

/// The samples of a channel that are numbers.
pub(super) fn finite(record: &FlightRecord, signal: &Signal) -> Vec<f64> {
    record
        .channel(signal)
        .iter()
        .copied()
        .filter(|x| x.is_finite())
        .collect()
}

/// The inputs of a record that stand at their limit, and for which share of it \[%\].
pub(super) fn inputs_at_limit(
    record: &FlightRecord,
    preparation: &Preparation,
) -> Vec<(Signal, f64)> {
    let inputs = preparation
        .channels()
        .filter(|(signal, _)| signal.role == ChannelSide::Input);
    let clipped = inputs.map(|(signal, _)| {
        let found = clipping(&finite(record, &signal));
        (signal, found)
    });
    clipped
        .filter(|(_, found)| found.share > found.most)
        .map(|(signal, found)| (signal, 100.0 * found.share))
        .collect()
}

/// What is wrong with the outputs as they were logged, one caution a channel: of the record in which it is worst.
pub(super) fn output_cautions(
    records: &[FlightRecord],
    preparation: &Preparation,
) -> Vec<RecordCaution> {
    let mut cautions = Vec::new();
    for (signal, _) in preparation
        .channels()
        .filter(|(signal, _)| signal.role == ChannelSide::Output)
    {
        let of_records: Vec<(&FlightRecord, Vec<f64>)> = records
            .iter()
            .map(|record| (record, finite(record, &signal)))
            .collect();
        let clipped = of_records
            .iter()
            .map(|(record, samples)| (record, clipping(samples)));
        let clipped = clipped.filter(|(_, clipping)| clipping.share > clipping.most);
        let count = clipped.clone().count();
        if let Some((record, clipping)) = clipped.max_by(|a, b| a.1.share.total_cmp(&b.1.share)) {
            let record = record.name.clone();
            let percent = 100.0 * clipping.share;
            cautions.push(RecordCaution::AtLimit {
                record,
                signal: signal.clone(),
                percent,
                records: count,
            });
        }
        let all: Vec<f64> = of_records
            .into_iter()
            .flat_map(|(_, samples)| samples)
            .collect();
        if let Some(steps) = coarseness(&all).filter(|steps| *steps > COARSE) {
            cautions.push(RecordCaution::Coarse { signal, steps });
        }
    }
    cautions
}

impl RecordCaution {
    /// What it is about, but for its words.
    pub(super) fn note(&self) -> CautionNote {
        let of = CautionNote::of;
        match self {
            Self::Resampled { record, .. } => of("resampled").record(record),
            Self::SegmentDropped { record, .. } | Self::RecordUnused(record) => {
                of("gap").record(record)
            }
            Self::SampleHold { signal, .. } => of("held").channel(signal),
            Self::UnlikelyUnit { signal, .. } => of("unit").channel(signal),
            Self::MovedTogether {
                signals: [_, second],
                ..
            } => of("collinear-inputs").channel(second),
            Self::Copy { copy, .. } => of("copy").channel(copy),
            Self::AtLimit { record, signal, .. } => of("clipped").record(record).channel(signal),
            Self::Stuck {
                record, signals, ..
            } => of("stuck").record(record).channel(signals.first()),
            Self::Coarse { signal, .. } => of("coarse").channel(signal),
        }
    }
}
