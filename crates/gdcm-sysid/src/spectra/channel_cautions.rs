//! Finds doubts about the channels in flight records (M14.1, M14.18, M14.24): [`channel_cautions`]
//! has the steps.

use std::collections::BTreeSet;

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::{FlightRecord, Segment, Signal, centred};

use super::clipping::Clipping;
use super::coarse_steps::{COARSE, coarseness, is_coarse};
use super::finite_samples::{Sample, finite_samples, finite_values};
use super::gap::{Cause, Gap};
use super::preparation_settings::{ChannelPreparation, Hold, Preparation};
use super::rate_limit::RateLimit;
use super::record_cautions::RecordCaution;
use super::spikes::Spikes;
use super::stairs::Stairs;

/// Correlation above which two inputs count as always moved together.
const TOGETHER: f64 = 0.99;
/// Correlation above which an output counts as a copy of another channel.
const COPY: f64 = 0.9999;

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
        let spikes_by_record = RecordSpikes::of_channel(records, &signal);
        for spikes in &spikes_by_record {
            cautions.extend(spikes.caution(&signal));
        }
        // Steps 2 and 3.
        cautions.extend(unit_caution(&signal, channel, segments, &spikes_by_record));
        cautions.extend(stairs_caution(&signal, channel, records));
        // Steps 4 and 5.
        match signal.role {
            ChannelSide::Input => cautions.extend(rate_caution(&signal, &spikes_by_record)),
            ChannelSide::Output => {
                cautions.extend(limit_caution(&signal, &spikes_by_record));
                cautions.extend(coarse_caution(&signal, &spikes_by_record));
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
    spikes_by_record: &[RecordSpikes<'_>],
) -> Option<RecordCaution> {
    let limit = channel.limit?;
    // Neither a spike nor an unused sample is a reason to doubt the unit. The segments lack the
    // unused samples, the records are read without spikes: the smaller maximum is due to neither.
    let greatest_used = segments
        .iter()
        .map(|segment| segment.channel(signal).amax())
        .fold(0.0, f64::max);
    let greatest_without_spikes = spikes_by_record
        .iter()
        .flat_map(|spikes| spikes.other_values(signal))
        .fold(0.0, |most: f64, value| most.max(value.abs()));
    let greatest = greatest_used.min(greatest_without_spikes);
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
fn limit_caution(signal: &Signal, spikes_by_record: &[RecordSpikes<'_>]) -> Option<RecordCaution> {
    let mut clipped = Vec::new();
    for spikes in spikes_by_record {
        let clipping = Clipping::measure(&spikes.other_values(signal));
        if clipping.is_excessive() {
            clipped.push((spikes.record, clipping.share));
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
fn rate_caution(signal: &Signal, spikes_by_record: &[RecordSpikes<'_>]) -> Option<RecordCaution> {
    let mut limited = Vec::new();
    for spikes in spikes_by_record {
        if let Some(limit) = RateLimit::find(spikes.other_samples(signal)) {
            limited.push((spikes.record, limit));
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
fn coarse_caution(signal: &Signal, spikes_by_record: &[RecordSpikes<'_>]) -> Option<RecordCaution> {
    let values: Vec<f64> = spikes_by_record
        .iter()
        .flat_map(|spikes| spikes.other_values(signal))
        .collect();
    let step_sd = coarseness(&values)?;
    if step_sd > COARSE {
        Some(RecordCaution::Coarse {
            signal: signal.clone(),
            step_sd,
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
