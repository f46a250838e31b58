//! Doubts about the flight records themselves, with texts and codes (M14.1, M14.18, M14.24). The
//! doubts about channels are found by `channel_cautions`, the others by `preparation`.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::number_format::counted;
use gdcm_model::simulation::Signal;

use super::caution_note::CautionNote;
use super::signal_names::{listed, names};

/// A doubt about the flight records, or a change made to them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordCaution {
    /// A record with uneven sample times was interpolated, as allowed.
    #[error(
        "{record}: the sample time varies by {percent:.0} %; the samples were interpolated to even steps"
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
        "{signal} reaches {greatest:.3}, above {limit:.3}, the plausible maximum in its unit: check the unit of its column"
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
        "{signal} moves at {rate:.4} of its units per second, and never faster, for {percent:.0} % of the time that it moves in {record}{}: \
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
        "{signal} is logged in coarse steps of {step_sd:.1} standard deviations; such steps had no \
        effect in tests of the identification"
    )]
    Coarse {
        signal: Signal,
        /// Step size in the channel's standard deviations.
        step_sd: f64,
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
        1 => "a spike of".to_owned(),
        count => format!("{count} spikes of up to"),
    };
    format!(
        "{record}: {signal} has {spikes} {deviations:.1} standard deviations, at {}: single \
        samples far off their neighbours, used as logged. If the samples are wrong, delete them in \
        the file (an empty cell or null): up to 3 missing samples are bridged by a straight line",
        listed(&times)
    )
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
