//! Doubts about the flight records themselves, channel by channel (M14.1, M14.18, M14.24).

use std::collections::BTreeSet;

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::number_format::counted;
use gdcm_model::simulation::{FlightRecord, Segment, Signal, centred};

use super::caution_note::CautionNote;
use super::clipping::Clipping;
use super::coarse_steps::{COARSE, coarseness, is_coarse};
use super::finite_samples::{Sample, finite_samples, finite_values};
use super::gap::{Cause, Gap};
use super::preparation_settings::{ChannelPreparation, Hold, Preparation};
use super::rate_limit::RateLimit;
use super::signal_names::{listed, names};
use super::spikes::Spikes;
use super::stairs::Stairs;

/// Correlation above which two inputs count as always moved together.
const TOGETHER: f64 = 0.99;
/// Correlation above which an output counts as a copy of another channel.
const COPY: f64 = 0.9999;

/// A doubt about the flight records, or a change made to them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordCaution {
    /// A record with uneven sample times was interpolated, as allowed.
    #[error(
        "{record}: the sample time varies by {percent:.0} %; it was interpolated to even steps"
    )]
    Resampled {
        record: String,
        /// The steps' deviation from multiples of the sample time, 95th percentile \[%\].
        percent: f64,
    },
    /// A part without gaps was left out because it is shorter than the minimum segment.
    #[error(
        "{record}: the part without gaps that begins at {start_s:.2} s was left out, because it lasts \
        only {length_s:.1} s"
    )]
    SegmentDropped {
        record: String,
        start_s: f64,
        length_s: f64,
    },
    #[error("{0}: the record was not used, because no part without gaps is long enough")]
    RecordUnused(String),
    /// More than half the consecutive samples are equal while the channel moves.
    #[error(
        "{signal}: {percent:.0} % of consecutive samples are equal; it changes every {:.0} ms. \
        State the cause: {}or a signal that really moves in steps (used as logged, as now)",
        1e3 * hold_s, hold_choices(signal.role, 1e3 * hold_s)
    )]
    SampleHold {
        signal: Signal,
        /// Share of samples equal to the preceding sample, while the channel moves \[%\].
        percent: f64,
        /// Median time between changes \[s\].
        hold_s: f64,
    },
    /// A value that is implausible in the channel's unit.
    #[error(
        "{signal} reaches {greatest:.3}, above the plausible maximum {limit}: check the unit of its column"
    )]
    UnlikelyUnit {
        signal: Signal,
        /// Largest modulus among the samples that are used and are in no spike.
        greatest: f64,
        /// Largest plausible modulus.
        limit: f64,
    },
    #[error(
        "{} always moved together (correlation {correlation:.3}): their effects cannot be separated. Move them independently, or leave one out",
        names(signals)
    )]
    MovedTogether {
        signals: [Signal; 2],
        correlation: f64,
    },
    #[error(
        "{signal} is at its limit for {percent:.1} % of {record}{}; the lost values cannot be \
        recovered. Leave out the output, or {}",
        if *records > 1 { format!(", and in {}", counted(records - 1, "other record")) } else { String::new() },
        if *records > 1 { "these records" } else { "the record" }
    )]
    AtLimit {
        /// The record with the largest share of samples at the limit, by name.
        record: String,
        signal: Signal,
        /// Share of samples at the limit in this record \[%\].
        percent: f64,
        /// Number of affected records.
        records: usize,
    },
    /// At most three consecutive samples in a channel are far off their neighbours (M14.24).
    #[error("{}", spike_text(record, signal, times_s, *deviations))]
    Spike {
        record: String,
        signal: Signal,
        /// Each spike's first stamp \[s\], ascending.
        times_s: Vec<f64>,
        /// The largest spike's distance from its neighbours, in standard deviations of the other
        /// samples.
        deviations: f64,
    },
    /// An input often moves at one rate and never faster (M14.24).
    #[error(
        "{signal} moves at {rate:.4} per second, and never faster, for {percent:.0} % of the time that it moves in {record}{}: \
        a rate limit. The response then depends on the amplitude, and if the limiter acts after the \
        log, the record does not show the input. Sweep with a smaller amplitude at high frequency, or \
        lower the upper end of the band",
        if *records > 1 { format!(", and in {}", counted(records - 1, "other record")) } else { String::new() },
    )]
    RateLimited {
        /// The record with the largest share of slopes at the limit, by name.
        record: String,
        signal: Signal,
        /// In the channel's unit per second.
        rate: f64,
        /// Share of the moving samples at the limit in this record \[%\].
        percent: f64,
        /// Number of affected records.
        records: usize,
    },
    /// Outputs stood still while another channel moved.
    #[error(
        "{record}: {} stood still for {seconds:.1} s while other channels moved; these samples are not used",
        names(signals)
    )]
    Stuck {
        record: String,
        signals: Vec<Signal>,
        /// Total duration \[s\].
        seconds: f64,
    },
    #[error(
        "{signal} is logged in coarse steps of {steps:.1} standard deviations; such steps had no \
        effect in tests of the identification"
    )]
    Coarse {
        signal: Signal,
        /// Step size in the channel's standard deviations.
        steps: f64,
    },
    /// An output copies another channel.
    #[error(
        "{copy} is a copy of the {} {of}, apart from a factor: leave {copy} out", of.role
    )]
    Copy {
        copy: Signal,
        /// The channel that is copied.
        of: Signal,
    },
}

/// Returns the causes that stairs may have, as text for the caution.
fn hold_choices(role: ChannelSide, hold_ms: f64) -> String {
    let half = 0.5 * hold_ms;
    let command = match role {
        ChannelSide::Input => {
            format!("a command that is held and logged once per hold (moved {half:.0} ms later), ")
        }
        ChannelSide::Output => String::new(),
    };
    format!("{command}a slow sensor (only fresh samples kept, or moved {half:.0} ms earlier), ")
}

/// Maximum number of spikes that are listed by time.
const LISTED_SPIKES: usize = 5;

/// Describes a channel's spikes in a record, and the remedy.
fn spike_text(record: &str, signal: &Signal, times_s: &[f64], deviations: f64) -> String {
    let mut times: Vec<String> = times_s
        .iter()
        .take(LISTED_SPIKES)
        .map(|time_s| format!("{time_s:.2} s"))
        .collect();
    if times_s.len() > LISTED_SPIKES {
        times.push(format!("{} more", times_s.len() - LISTED_SPIKES));
    }
    let spikes = match times_s.len() {
        1 => "a spike".to_owned(),
        count => format!("{count} spikes"),
    };
    format!(
        "{record}: {signal} has {spikes} of up to {deviations:.1} standard deviations, at {}: single \
        samples far off their neighbours, used as logged. If the samples are wrong, delete them in \
        the file (an empty cell or null): up to 3 missing samples are bridged by a straight line",
        listed(&times)
    )
}

/// A channel's spikes in a record.
struct RecordSpikes<'r> {
    record: &'r FlightRecord,
    spikes: Option<Spikes>,
}

impl<'r> RecordSpikes<'r> {
    /// Searches a channel's spikes in each record.
    fn of_channel(records: &'r [FlightRecord], signal: &Signal) -> Vec<Self> {
        let mut found = Vec::with_capacity(records.len());
        for record in records {
            found.push(Self {
                record,
                spikes: Spikes::find(finite_samples(record, signal)),
            });
        }
        found
    }

    /// Returns the channel's samples that are in no spike.
    fn other_samples(&self, signal: &Signal) -> Vec<Sample> {
        let mut samples = finite_samples(self.record, signal);
        if let Some(spikes) = &self.spikes {
            samples.retain(|sample| !spikes.contain(sample.time_s));
        }
        samples
    }

    /// Returns the channel's values that are in no spike.
    fn other_values(&self, signal: &Signal) -> Vec<f64> {
        self.other_samples(signal)
            .into_iter()
            .map(|sample| sample.value)
            .collect()
    }

    fn caution(&self, signal: &Signal) -> Option<RecordCaution> {
        let spikes = self.spikes.as_ref()?;
        Some(RecordCaution::Spike {
            record: self.record.name.clone(),
            signal: signal.clone(),
            times_s: spikes.times_s.clone(),
            deviations: spikes.deviations,
        })
    }
}

/// Returns cautions about the channels in the records as logged and in the segments made from them.
///
/// ```text
/// for each channel
/// 1  spikes, record by record; steps 2, 4 and 5 do not count their samples
/// 2  a value above the channel's plausible limit: wrong unit?
/// 3  stairs, if no hold is declared
/// 4  input: rate limit
/// 5  output: at its limit; coarse steps
/// over all segments
/// 6  inputs that move together, outputs that copy another channel
/// ```
pub(crate) fn channel_cautions(
    records: &[FlightRecord],
    segments: &[Segment],
    preparation: &Preparation,
) -> Vec<RecordCaution> {
    let mut cautions = Vec::new();
    for (signal, channel) in preparation.channels() {
        // Step 1.
        let spikes = RecordSpikes::of_channel(records, &signal);
        for record in &spikes {
            cautions.extend(record.caution(&signal));
        }
        // Steps 2 and 3.
        cautions.extend(unit_caution(&signal, channel, segments, &spikes));
        cautions.extend(stairs_caution(&signal, channel, records));
        // Steps 4 and 5.
        match signal.role {
            ChannelSide::Input => cautions.extend(rate_caution(&signal, &spikes)),
            ChannelSide::Output => {
                cautions.extend(limit_caution(&signal, &spikes));
                cautions.extend(coarse_caution(&signal, &spikes));
            }
        }
    }
    // Step 6.
    cautions.extend(correlation_cautions(segments, preparation));
    cautions
}

/// Returns a caution if a channel exceeds its plausible limit, apart from spikes, which suggests a
/// wrong unit.
fn unit_caution(
    signal: &Signal,
    channel: &ChannelPreparation,
    segments: &[Segment],
    spikes: &[RecordSpikes<'_>],
) -> Option<RecordCaution> {
    let limit = channel.limit?;
    let greatest_used = segments
        .iter()
        .map(|segment| segment.channel(signal).amax())
        .fold(0.0, f64::max);
    let greatest_logged = spikes
        .iter()
        .flat_map(|record| record.other_values(signal))
        .fold(0.0, |most: f64, value| most.max(value.abs()));
    // Neither a spike nor a sample that is not used is a reason to doubt the unit.
    let greatest = greatest_used.min(greatest_logged);
    if greatest > limit {
        Some(RecordCaution::UnlikelyUnit {
            signal: signal.clone(),
            greatest,
            limit,
        })
    } else {
        None
    }
}

/// Returns a caution about stairs in a channel whose hold is not declared.
fn stairs_caution(
    signal: &Signal,
    channel: &ChannelPreparation,
    records: &[FlightRecord],
) -> Option<RecordCaution> {
    if channel.hold != Hold::None {
        return None;
    }
    // A coarse output's stairs are its coarse steps, for which there is another caution.
    if signal.role == ChannelSide::Output && is_coarse(&values_of_all(records, signal)) {
        return None;
    }
    let stairs = Stairs::find(records.iter().map(|record| finite_samples(record, signal)))?;
    Some(RecordCaution::SampleHold {
        signal: signal.clone(),
        percent: 100.0 * stairs.share,
        hold_s: stairs.hold_s,
    })
}

/// Returns a caution about an output at its limit; it names the record with the largest share of
/// samples at the limit.
fn limit_caution(signal: &Signal, spikes: &[RecordSpikes<'_>]) -> Option<RecordCaution> {
    let mut clipped = Vec::new();
    for record in spikes {
        let clipping = Clipping::measure(&record.other_values(signal));
        if clipping.is_excessive() {
            clipped.push((record.record, clipping.share));
        }
    }
    let (record, share) = clipped.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(RecordCaution::AtLimit {
        record: record.name.clone(),
        signal: signal.clone(),
        percent: 100.0 * share,
        records: clipped.len(),
    })
}

/// Returns a caution about an input at a rate limit; it names the record with the largest share.
fn rate_caution(signal: &Signal, spikes: &[RecordSpikes<'_>]) -> Option<RecordCaution> {
    let mut limited = Vec::new();
    for record in spikes {
        if let Some(limit) = RateLimit::find(record.other_samples(signal)) {
            limited.push((record.record, limit));
        }
    }
    let (record, limit) = limited
        .iter()
        .max_by(|a, b| a.1.share.total_cmp(&b.1.share))?;
    Some(RecordCaution::RateLimited {
        record: record.name.clone(),
        signal: signal.clone(),
        rate: limit.rate,
        percent: 100.0 * limit.share,
        records: limited.len(),
    })
}

/// Returns a caution about an output that is logged in coarse steps.
fn coarse_caution(signal: &Signal, spikes: &[RecordSpikes<'_>]) -> Option<RecordCaution> {
    let values: Vec<f64> = spikes
        .iter()
        .flat_map(|record| record.other_values(signal))
        .collect();
    let steps = coarseness(&values)?;
    if steps > COARSE {
        Some(RecordCaution::Coarse {
            signal: signal.clone(),
            steps,
        })
    } else {
        None
    }
}

/// Returns a channel's finite values in all records.
fn values_of_all(records: &[FlightRecord], signal: &Signal) -> Vec<f64> {
    records
        .iter()
        .flat_map(|record| finite_values(record, signal))
        .collect()
}

/// Returns cautions about channels that move together, from their correlation over all segments.
fn correlation_cautions(segments: &[Segment], preparation: &Preparation) -> Vec<RecordCaution> {
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
            // Inputs come first: if b is an input, so is a.
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

/// Returns a caution about the outputs that were frozen in a record, from its gaps.
pub(crate) fn stuck_caution(record: &str, gaps: &[Gap]) -> Option<RecordCaution> {
    let mut stuck = BTreeSet::new();
    let mut seconds = 0.0;
    for gap in gaps {
        if let Cause::Frozen(signals) = &gap.cause {
            stuck.extend(signals.iter().cloned());
            seconds += gap.end_s - gap.start_s;
        }
    }
    if stuck.is_empty() {
        return None;
    }
    Some(RecordCaution::Stuck {
        record: record.to_owned(),
        signals: stuck.into_iter().collect(),
        seconds,
    })
}

/// Returns the inputs with an excessive share of samples at an end of their range
/// ([`Clipping::is_excessive`]), each with this share \[%\].
pub(crate) fn inputs_at_limit(
    record: &FlightRecord,
    preparation: &Preparation,
) -> Vec<(Signal, f64)> {
    let mut clipped = Vec::new();
    for (signal, _) in preparation.channels_of(ChannelSide::Input) {
        let clipping = Clipping::measure(&finite_values(record, &signal));
        if clipping.is_excessive() {
            clipped.push((signal, 100.0 * clipping.share));
        }
    }
    clipped
}

impl RecordCaution {
    /// Returns the note with code and subject, but without the text. It names only the second of
    /// two inputs that moved together, and only the first of several outputs that stood still.
    pub(crate) fn note(&self) -> CautionNote {
        match self {
            Self::Resampled { record, .. } => CautionNote::new("resampled").with_record(record),
            Self::SegmentDropped { record, .. } | Self::RecordUnused(record) => {
                CautionNote::new("gap").with_record(record)
            }
            Self::SampleHold { signal, .. } => CautionNote::new("held").with_channel(signal),
            Self::UnlikelyUnit { signal, .. } => CautionNote::new("unit").with_channel(signal),
            Self::MovedTogether {
                signals: [_, second],
                ..
            } => CautionNote::new("collinear-inputs").with_channel(second),
            Self::Copy { copy, .. } => CautionNote::new("copy").with_channel(copy),
            Self::AtLimit { record, signal, .. } => CautionNote::new("clipped")
                .with_record(record)
                .with_channel(signal),
            Self::Spike { record, signal, .. } => CautionNote::new("spike")
                .with_record(record)
                .with_channel(signal),
            Self::RateLimited { record, signal, .. } => CautionNote::new("rate-limited")
                .with_record(record)
                .with_channel(signal),
            Self::Stuck {
                record, signals, ..
            } => CautionNote::new("stuck")
                .with_record(record)
                .with_channel(signals.first()),
            Self::Coarse { signal, .. } => CautionNote::new("coarse").with_channel(signal),
        }
    }
}
