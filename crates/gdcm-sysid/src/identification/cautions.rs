//! What the engineer should know of an identified model, and what can be done about it (M14, section 10).

use gdcm_model::simulation::{Signal, ValidationError};

use super::feedback::FeedbackLevel;
use super::gaps::listed;
use super::local_polynomial::TRUSTED_COHERENCE;
use super::record_cautions::RecordCaution;
use super::record_contrast::{ContradictingRecord, RecordFault};

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
    #[error(
        "the inputs were not moved independently (condition number {condition:.0}): sweep them one after another"
    )]
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
    #[error(
        "{percent:.0} % of {signal} is vibration above the band: CT-PBSID was run below {cut_off:.0} rad/s"
    )]
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
    /// The records weigh differently because their turbulence does: the greatest over the least cost per degree of freedom before.
    #[error("the records are unlike in noise (by {0:.1}): they were weighed accordingly")]
    Reweighed(f64),
    /// The held-out records cannot be compared with the model in time.
    #[error("the model was not compared with the held-out records in time: {0}")]
    NotValidated(ValidationError),
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
    #[error("{} not identified: one standard deviation is over 3 dB", responses_are(.0))]
    PairsNotIdentified(Vec<[Signal; 2]>),
}

impl IdentificationCaution {
    /// Whether it says that the effects of inputs cannot be told apart.
    pub(super) fn is_of_collinear_inputs(&self) -> bool {
        matches!(
            self,
            Self::MovedTogether { .. } | Self::Records(RecordCaution::MovedTogether { .. })
        )
    }

    /// Whether another caution says no more than what comes of this one: a record that contradicts the others is unlike them, for
    /// another reason than its noise; and where signs cancel in the mean of the records no input seems to be swept.
    pub(super) fn explains(&self, other: &Self) -> bool {
        let Self::Contradiction { records, .. } = self else {
            return false;
        };
        let is_turned = |of: &ContradictingRecord| matches!(of.fault, Some(RecordFault::Gain(_, factor)) if factor < 0.0);
        match other {
            Self::UnlikeRecord { record, .. } => records.iter().any(|of| of.record == *record),
            Self::Reweighed(_) => true,
            Self::NotSwept { .. } => records.iter().any(is_turned),
            _ => false,
        }
    }
}

/// `below 0.80 rad/s and above 8.0 rad/s`: the ends of a band that are not shown.
fn hidden_ends(band: [f64; 2], shown: [f64; 2]) -> String {
    let below = (shown[0] > band[0]).then(|| format!("below {:.2} rad/s", shown[0]));
    let above = (shown[1] < band[1]).then(|| format!("above {:.1} rad/s", shown[1]));
    below
        .into_iter()
        .chain(above)
        .collect::<Vec<String>>()
        .join(" and ")
}

/// `LON to P, LAT to P and LON to Q are`.
fn responses_are(pairs: &[[Signal; 2]]) -> String {
    let names: Vec<String> = pairs
        .iter()
        .map(|[output, input]| format!("{input} to {output}"))
        .collect();
    format!(
        "{} {}",
        listed(&names),
        if names.len() == 1 { "is" } else { "are" }
    )
}

/// Which records contradict which, and what would mend it.
fn contradiction(records: &[ContradictingRecord], contrast: f64) -> String {
    let names: Vec<&str> = records.iter().map(|of| of.name.as_str()).collect();
    let faults: Vec<(&str, &RecordFault)> = records
        .iter()
        .filter_map(|of| Some((of.name.as_str(), of.fault.as_ref()?)))
        .collect();
    let agreement = format!("(F {contrast:.0}; 1 is agreement)");
    if names.len() > 1 {
        let words = faults
            .iter()
            .map(|(name, fault)| format!(" If it is {name}, it looks as if there {fault}."));
        let names = listed(&names);
        let words = words.collect::<String>();
        return format!(
            "{names} contradict one another {agreement}; a third record would tell which is wrong.{words}"
        );
    }
    let words = faults.first().map_or_else(String::new, |(_, fault)| {
        format!(" It looks as if in it {fault}.")
    });
    let name = names.first().copied().unwrap_or_default();
    format!(
        "{name} contradicts the other records {agreement}.{words} Correct it, or leave the record out"
    )
}

/// What the feedback does to the models.
fn fed_back(level: FeedbackLevel, share: f64) -> String {
    let percent = 100.0 * share;
    let remedy =
        "Sweep more strongly, or give the recorded reference that drove the loop (--reference)";
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
pub fn late_or_early(delay_s: f64) -> &'static str {
    if delay_s < 0.0 { "early" } else { "late" }
}

// What a caution is about, for files and for marks: its code, record, channel, pair and band.

/// A caution as it stands in files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CautionNote {
    /// What kind it is, in one word for programs.
    pub code: &'static str,
    /// The names of the records that it is about; none where it is about all.
    pub records: Vec<String>,
    /// The channel's name, where it is about one.
    pub channel: Option<String>,
    /// Output and input, where it is about a response.
    pub pair: Option<[String; 2]>,
    /// Where in frequency it holds \[rad/s\].
    pub band_rad_s: Option<[f64; 2]>,
    /// In words.
    pub text: String,
}

impl CautionNote {
    pub(super) fn of(code: &'static str) -> Self {
        Self {
            code,
            ..Self::default()
        }
    }

    pub(super) fn record(self, name: &str) -> Self {
        Self {
            records: vec![name.to_owned()],
            ..self
        }
    }

    pub(super) fn channel<'s>(self, signal: impl Into<Option<&'s Signal>>) -> Self {
        Self {
            channel: signal.into().map(|signal| signal.name.clone()),
            ..self
        }
    }

    fn pair(self, channels: [&Signal; 2]) -> Self {
        Self {
            pair: Some(channels.map(|signal| signal.name.clone())),
            ..self
        }
    }

    fn band(self, ends: [f64; 2]) -> Self {
        Self {
            band_rad_s: Some(ends),
            ..self
        }
    }

    /// What it says in three words or fewer, for a mark.
    #[must_use]
    pub fn mark(&self) -> &'static str {
        match self.code {
            "clipped" => "at its limit",
            "stuck" => "stood still",
            "coarse" => "coarse steps",
            "held" => "steps",
            "copy" => "a copy",
            "sign" => "other sign",
            "time-skew" => "time skew",
            "vibration" => "vibrates",
            "unit" => "unit in doubt",
            "inadequate" => "poorly fitted",
            "not-swept" => "not swept",
            "collinear-inputs" => "not moved alone",
            "points" => "leaves the points",
            "not-identified" => "not identified",
            "feedback" | "feedback-some" => "gusts fed back",
            "record" => "contradicts",
            "gap" => "gaps",
            "duplicate" => "a duplicate",
            "resampled" => "resampled",
            "held-out" => "not predicted",
            "unstable" => "unstable, above the lines",
            "order-limit" => "order too low",
            "band-narrowed" => "shows nothing",
            "short" => "short records",
            _ => "see the caution",
        }
    }
}

impl IdentificationCaution {
    /// The caution with what it is about.
    #[must_use]
    pub fn note(&self) -> CautionNote {
        let of = CautionNote::of;
        let note = match self {
            Self::Records(caution) => caution.note(),
            Self::Short {
                lowest, periods, ..
            } => of("short").band([*lowest, lowest * (5.0 / periods).max(1.0)]),
            Self::NotSwept { signal, .. } => of("not-swept").channel(signal),
            Self::MovedTogether { .. } => of("collinear-inputs"),
            Self::BandNotShown { shown, .. } => of("band-narrowed").band(*shown),
            Self::Vibration { signal, .. } => of("vibration").channel(signal),
            Self::Inadequate { record, signal, .. } => {
                of("inadequate").record(record).channel(signal)
            }
            Self::UnlikeRecord { name, .. } => of("record").record(name),
            Self::Contradiction { records, .. } => {
                let (code, channel) = common_fault(records);
                let records = records.iter().map(|of| of.name.clone()).collect();
                CautionNote {
                    records,
                    ..of(code).channel(channel)
                }
            }
            Self::Feedback {
                level: FeedbackLevel::TooMuch,
                ..
            } => of("feedback"),
            Self::Feedback { .. } => of("feedback-some"),
            Self::LeavesPoints {
                output,
                input,
                band,
                ..
            } => of("points").pair([output, input]).band(*band),
            Self::OrderLimit { narrower, .. } => of("order-limit").band(*narrower),
            Self::HeldOut { records, .. } => CautionNote {
                records: records.clone(),
                ..of("held-out")
            },
            Self::Reweighed(_) => of("reweighed"),
            Self::NotValidated(_) => of("not-validated"),
            Self::Unstable { .. } => of("unstable"),
            Self::PairsNotIdentified(pairs) => match pairs.as_slice() {
                [[output, input]] => of("not-identified").pair([output, input]),
                _ => of("not-identified"),
            },
        };
        CautionNote {
            text: self.to_string(),
            ..note
        }
    }
}

/// What is wrong in one word, and with which channel, as far as that is the same whichever of the records is the wrong one.
fn common_fault(records: &[ContradictingRecord]) -> (&'static str, Option<&Signal>) {
    let of = |record: &ContradictingRecord| match &record.fault {
        Some(RecordFault::OutputsLate(_) | RecordFault::Late(..)) => "time-skew",
        Some(RecordFault::Gain(_, factor)) if *factor < 0.0 => "sign",
        _ => "record",
    };
    let mut signals = records
        .iter()
        .map(|record| record.fault.as_ref().and_then(RecordFault::signal));
    let code = records
        .first()
        .map(of)
        .filter(|code| records.iter().all(|record| of(record) == *code));
    let first = signals.next().flatten();
    (
        code.unwrap_or("record"),
        first.filter(|_| signals.all(|signal| signal == first)),
    )
}
