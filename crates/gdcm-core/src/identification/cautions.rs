//! What the engineer should know of an identified model, and what can be done about it (M14, section 10).

use super::*;
use nalgebra::DMatrix;

/// Something that speaks against the model or a part of it, with what an action against it needs.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentificationCaution {
    /// Something in the records themselves.
    #[error(transparent)]
    Records(#[from] RecordCaution),
    /// The records are shorter than the lower end of the band deserves.
    #[error(
        "the longest record lasts {longest_s:.0} s, {periods:.1} periods of {lowest:.2} rad/s: {better_s:.0} s would be better, the \
         lower end of the band is known less well"
    )]
    Short {
        /// Length of the longest \[s\].
        longest_s: f64,
        /// Lower end of the band \[rad/s\].
        lowest: f64,
        /// How many periods of it they last.
        periods: f64,
        /// Length that would be better \[s\].
        better_s: f64,
    },
    /// An input was not moved, or only together with others.
    #[error(
        "{signal} was not swept, or only with another input (partial coherence {partial_coherence:.2}): its column is not \
                 identified"
    )]
    NotSwept {
        /// The input.
        signal: Signal,
        /// Median partial coherence with the output that it moves most.
        partial_coherence: f64,
    },
    /// Inputs were moved together.
    #[error("the inputs were not moved independently (condition number {condition:.0}): sweep them one after another")]
    MovedTogether {
        /// Median condition number of their spectral matrix.
        condition: f64,
    },
    /// An end of the band shows nothing: no input moves any output there.
    #[error(
        "{} no input moves any output enough to be seen (partial coherence below {TRUSTED_COHERENCE}): the models are guesses \
                 there. Narrow the band",
        hidden_ends(*band, *shown)
    )]
    BandNotShown {
        /// The band asked for \[rad/s\].
        band: [f64; 2],
        /// The part of it that is shown \[rad/s\].
        shown: [f64; 2],
    },
    /// An output vibrates above the band, so that the projections were filtered lower.
    #[error("{percent:.0} % of {signal} is vibration above the band: CT-PBSID was run below {cut_off:.0} rad/s")]
    Vibration {
        /// The output.
        signal: Signal,
        /// Share of its variance above the cut-off \[%\].
        percent: f64,
        /// Cut-off \[rad/s\].
        cut_off: f64,
    },
    /// The model leaves much of all records.
    #[error(
        "the model leaves {cost:.1} times what noise explains, most of it in {record} and in {signal}: non-linear, wrongly \
                 aligned in time, or a missing input"
    )]
    Inadequate {
        /// Cost per degree of freedom; 1 is adequate.
        cost: f64,
        /// Name of the record with most of it.
        record: String,
        /// The output with most of it.
        signal: Signal,
    },
    /// The model leaves much of one record.
    #[error(
        "{name} is unlike the others: the model leaves {cost:.1} times what noise explains. Another trim, a large amplitude or \
                 a gust: it can be left out"
    )]
    UnlikeRecord {
        /// Which record, counted from 0.
        record: usize,
        /// Its name.
        name: String,
        /// Its cost per degree of freedom; 1 is adequate.
        cost: f64,
    },
    /// A record wants another model than the others, or two records each another.
    #[error("{}", contradiction(records, *contrast))]
    Contradiction {
        /// The record, or the two.
        records: Vec<ContradictingRecord>,
        /// `F` of the worse; 1 is agreement.
        contrast: f64,
    },
    /// Gusts and noise went into the inputs by way of the feedback.
    #[error("{}", fed_back(*level, *share))]
    Feedback {
        /// How much of it.
        level: FeedbackLevel,
        /// Median share of the response.
        share: f64,
        /// Median square over the variance.
        significance: f64,
    },
    /// The model is not what was measured.
    #[error(
        "the model leaves the measured points of {output}/{input} between {:.1} and {:.1} rad/s: believe the points there, and try another \
         order or band",
        band[0],
        band[1]
    )]
    LeavesPoints {
        /// The output.
        output: Signal,
        /// The input.
        input: Signal,
        /// Where \[rad/s\].
        band: [f64; 2],
        /// Mean square distance over the variance of the points; 12 is the limit.
        strength: f64,
    },
    /// The criterion still falls at the highest order tried.
    #[error(
        "a higher order than {order} would fit still better: there is more in the band than that many states. Narrow the band, \
                 say to {:.1} rad/s",
        narrower[1]
    )]
    OrderLimit {
        /// The highest order.
        order: usize,
        /// The band that is offered in place of this one \[rad/s\].
        narrower: [f64; 2],
    },
    /// The model does not predict what was held out.
    #[error(
        "what was held out is not predicted: {normalised:.1} times what noise explains though the model may move within its uncertainty \
         ({raw:.1} as it is). The aircraft was flown differently, or the records do not show enough"
    )]
    HeldOut {
        /// Names of the held-out records.
        records: Vec<String>,
        /// Cost per degree of freedom on them.
        raw: f64,
        /// The same where the model may move within its own uncertainty.
        normalised: f64,
    },
    /// The records weigh differently because their turbulence does.
    #[error("the records are unlike in noise (by {ratio:.1}): they were weighed accordingly")]
    Reweighed {
        /// Greatest over least cost per degree of freedom before.
        ratio: f64,
    },
    /// The held-out records cannot be compared with the model in time.
    #[error("the model was not compared with the held-out records in time: {why}")]
    NotValidated {
        /// Why.
        why: ValidationError,
    },
    /// An unstable pole that no line shows.
    #[error(
        "the model has an unstable pole of {:.0} rad/s, above the lines used (to {highest:.0} rad/s): it is no finding, and the model \
         was not simulated in time",
        pole.norm()
    )]
    Unstable {
        /// The pole \[rad/s\].
        pole: nalgebra::Complex<f64>,
        /// Highest line used \[rad/s\].
        highest: f64,
    },
    /// Responses that are not identified.
    #[error("{} not identified: one standard deviation is over 3 dB", responses_are(pairs))]
    PairsNotIdentified {
        /// Output and input of each.
        pairs: Vec<[Signal; 2]>,
    },
}

impl IdentificationCaution {
    /// Whether it says that the effects of inputs cannot be told apart.
    pub(super) fn is_of_collinear_inputs(&self) -> bool {
        matches!(self, Self::MovedTogether { .. } | Self::Records(RecordCaution::MovedTogether { .. }))
    }

    /// Whether another caution says no more than what comes of this one: a record that contradicts the others is unlike them, for
    /// another reason than its noise; and where signs cancel in the mean of the records no input seems to be swept.
    pub(super) fn explains(&self, other: &Self) -> bool {
        let Self::Contradiction { records, .. } = self else { return false };
        let is_turned =
            |of: &ContradictingRecord| matches!(of.fault, Some(RecordFault::Gain(_, factor)) if factor < 0.0);
        match other {
            Self::UnlikeRecord { record, .. } => records.iter().any(|of| of.record == *record),
            Self::Reweighed { .. } => true,
            Self::NotSwept { .. } => records.iter().any(is_turned),
            _ => false,
        }
    }
}

/// `below 0.80 rad/s and above 8.0 rad/s`: the ends of a band that are not shown.
fn hidden_ends(band: [f64; 2], shown: [f64; 2]) -> String {
    let below = (shown[0] > band[0]).then(|| format!("below {:.2} rad/s", shown[0]));
    let above = (shown[1] < band[1]).then(|| format!("above {:.1} rad/s", shown[1]));
    below.into_iter().chain(above).collect::<Vec<String>>().join(" and ")
}

/// `LON to P, LAT to P and LON to Q are`.
fn responses_are(pairs: &[[Signal; 2]]) -> String {
    let names: Vec<String> = pairs.iter().map(|[output, input]| format!("{input} to {output}")).collect();
    format!("{} {}", listed(&names), if names.len() == 1 { "is" } else { "are" })
}

/// Which records contradict which, and what would mend it.
fn contradiction(records: &[ContradictingRecord], contrast: f64) -> String {
    let names: Vec<&str> = records.iter().map(|of| of.name.as_str()).collect();
    let faults: Vec<(&str, &RecordFault)> =
        records.iter().filter_map(|of| Some((of.name.as_str(), of.fault.as_ref()?))).collect();
    let agreement = format!("(F {contrast:.0}; 1 is agreement)");
    if names.len() > 1 {
        let words = faults.iter().map(|(name, fault)| format!(" If it is {name}, it looks as if there {fault}."));
        let (names, words) = (listed(&names), words.collect::<String>());
        return format!("{names} contradict one another {agreement}; a third record would tell which is wrong.{words}");
    }
    let words = faults.first().map_or_else(String::new, |(_, fault)| format!(" It looks as if in it {fault}."));
    let name = names.first().copied().unwrap_or_default();
    format!("{name} contradicts the other records {agreement}.{words} Correct it, or leave the record out")
}

/// What the feedback does to the models.
fn fed_back(level: FeedbackLevel, share: f64) -> String {
    let percent = 100.0 * share;
    let remedy = "Sweep more strongly, or give the recorded reference that drove the loop (--reference)";
    match level {
        FeedbackLevel::TooMuch => format!(
            "do not use this model: about {percent:.0} % of the measured response is what the feedback makes of gusts and noise, not the \
             aircraft, however well the model fits. {remedy}"
        ),
        _ => format!(
            "about {percent:.0} % of the measured response is what the feedback makes of gusts and noise: the models are off by some tenths \
             of a dB. {remedy}"
        ),
    }
}

/// `late` or `early`.
pub(crate) fn late_or_early(delay_s: f64) -> &'static str {
    if delay_s < 0.0 { "early" } else { "late" }
}

// What the engineer should know of the flight records.

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
    #[error("{record}: the sample time varies by {percent:.0} %; it was interpolated to even steps")]
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
    #[error("{record}: nothing of it could be used")]
    RecordUnused {
        /// The record's name.
        record: String,
    },
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
    let command = if role == ChannelSide::Input { command } else { String::new() };
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
        let greatest = segments.iter().map(|segment| segment.channel(&signal).amax()).fold(0.0, f64::max);
        if let Some(limit) = channel.limit.filter(|limit| greatest > *limit) {
            cautions.push(RecordCaution::UnlikelyUnit { signal: signal.clone(), greatest, limit });
        }
        // Stairs of an output in coarse steps are those steps.
        let all = || records.iter().flat_map(|record| finite(record, &signal)).collect::<Vec<f64>>();
        if channel.hold == Hold::None
            && (signal.role == ChannelSide::Input || !is_coarse(&all()))
            && let Some((share, hold_s)) = sample_hold(records.iter().map(of_record))
        {
            cautions.push(RecordCaution::SampleHold { signal, percent: 100.0 * share, hold_s });
        }
    }
    cautions.extend(output_cautions(records, preparation));
    cautions.extend(correlated(segments, preparation));
    cautions
}

/// The outputs that were stuck in a record, by its gaps.
pub(super) fn stuck_caution(used: &RecordUse) -> Option<RecordCaution> {
    let frozen = used.gaps.iter().filter_map(|gap| match &gap.cause {
        Cause::Frozen { signals } => Some((signals, gap.end_s - gap.start_s)),
        _ => None,
    });
    let (mut all, mut seconds) = (std::collections::BTreeSet::new(), 0.0);
    for (signals, length_s) in frozen {
        all.extend(signals.iter().cloned());
        seconds += length_s;
    }
    let signals: Vec<Signal> = all.into_iter().collect();
    (!signals.is_empty()).then(|| RecordCaution::Stuck { record: used.record.clone(), signals, seconds })
}

/// Stamps and values of a channel in `record` where both are there.
fn samples(record: &FlightRecord, signal: &Signal) -> Vec<(f64, f64)> {
    let column = record.channel(signal);
    let stamped = record.time_s.iter().copied().zip(column.iter().copied());
    stamped.filter(|(time, value)| time.is_finite() && value.is_finite()).collect()
}

/// Share of equal consecutive samples in a channel while it moves, and the median time between changes \[s\]; none where
/// the share is a half or less.
fn sample_hold(records: impl Iterator<Item = Vec<(f64, f64)>>) -> Option<(f64, f64)> {
    let (mut samples, mut steps) = (0, Vec::new());
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
        let samples: Vec<_> = signals.iter().map(|signal| segment.channel(signal)).collect();
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
                    cautions.push(RecordCaution::MovedTogether { signals: [a.clone(), b.clone()], correlation });
                }
                ChannelSide::Output if correlation.abs() > COPY => {
                    cautions.push(RecordCaution::Copy { copy: b.clone(), of: a.clone() })
                }
                ChannelSide::Input | ChannelSide::Output => {}
            }
        }
    }
    cautions
}
