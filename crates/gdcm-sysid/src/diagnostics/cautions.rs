//! Doubts about an identified model, with the data for a remedy (M14.10).
//!
//! The cost per degree of freedom (χ²/dof) is 1 if only noise remains. A *held-out* record is not
//! fitted, but reserved for validation. The *partial coherence* of an input is the share that it
//! explains of the output left by the other inputs, from 0 to 1.

use nalgebra::Complex;

use gdcm_model::simulation::{Signal, ValidationError};

use super::feedback::{FeedbackLevel, is_swept};
use super::record_fault::{ContradictingRecord, RecordFault};
use crate::spectra::caution_note::CautionNote;
use crate::spectra::record_cautions::RecordCaution;
use crate::spectra::response_estimate::TRUSTED_COHERENCE;
use crate::spectra::signal_names::listed;

/// Recommended record length, in periods at the lower end of the band (M14.12).
const BETTER_PERIODS: f64 = 5.0;

/// A doubt about the identified model, with its code and a text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentificationCaution {
    /// A doubt about the records themselves.
    #[error(transparent)]
    Records(#[from] RecordCaution),
    /// The longest usable segment has fewer than five periods at the lower end of the band.
    #[error(
        "the longest record lasts {longest_s:.0} s, {periods:.1} periods at {lowest:.2} rad/s: \
        the models are less certain at the lower end of the band; at least {better_s:.0} s are \
        recommended"
    )]
    Short {
        longest_s: f64,
        /// Lower band end \[rad/s\].
        lowest: f64,
        /// Periods at the lower band end in the longest segment.
        periods: f64,
        better_s: f64,
    },
    /// An input was not moved, or was moved only together with others.
    #[error(
        "{signal} was not swept, or only together with another input (partial coherence \
        {partial_coherence:.2}): the responses to this input are not identified. \
        Sweep each input in a record of its own"
    )]
    NotSwept {
        signal: Signal,
        /// Largest partial coherence with any output, less the share that chance explains; median
        /// over frequency.
        partial_coherence: f64,
    },
    /// Several inputs were moved only together.
    #[error(
        "the inputs were not moved independently (condition number {condition:.0}): sweep them one after another"
    )]
    MovedTogether {
        /// Median condition number of the inputs' spectral matrix.
        condition: f64,
    },
    /// No output responds measurably to any input at one or both ends of the band.
    #[error(
        "{} no output responds measurably to any input (partial coherence below \
        {TRUSTED_COHERENCE}): the models are unreliable there. Narrow the band",
        hidden_ends(*band, *shown)
    )]
    BandNotShown {
        /// The requested band \[rad/s\].
        band: [f64; 2],
        /// The narrower band in which the records show a response \[rad/s\].
        shown: [f64; 2],
    },
    /// An output vibrates above the band; the low-pass before the projections has a lower cut-off
    /// than usual.
    #[error(
        "{percent:.0} % of the variance of {signal} is vibration above the band: the subspace \
        identification (CT-PBSID) used only frequencies below {cut_off:.0} rad/s"
    )]
    Vibration {
        signal: Signal,
        /// Share of the output's variance above the cut-off \[%\].
        percent: f64,
        /// Cut-off frequency \[rad/s\].
        cut_off: f64,
    },
    /// The cost per degree of freedom over the fitted records exceeds 1.5.
    #[error(
        "the residual is larger than the noise (χ²/dof {cost:.1}; 1: only noise remains), most in \
        {record} and in {signal}. Possible causes: a non-linear response, wrong time alignment, a missing input"
    )]
    Inadequate {
        /// Cost per degree of freedom; 1 is adequate.
        cost: f64,
        /// The record with the largest residual, by name.
        record: String,
        /// The output with the largest residual.
        signal: Signal,
    },
    /// A record's cost per degree of freedom exceeds 1.5, and 1.5 times that over all fitted
    /// records.
    #[error(
        "{name} is unlike the other records: its residual is larger than the noise (χ²/dof {cost:.1}; \
        1: only noise remains). Possible causes: another trim, a large amplitude, a gust. Consider leaving the record out"
    )]
    UnlikeRecord {
        /// Record index, from 0.
        record: usize,
        name: String,
        /// Cost per degree of freedom; 1 is adequate.
        cost: f64,
    },
    /// A record contradicts the others, or two records contradict each other.
    #[error("{}", contradiction_text(records, *contrast))]
    Contradiction {
        /// The contradicting record, or both records.
        records: Vec<ContradictingRecord>,
        /// `F` (M14.16), the larger one if two records are named; 1 is agreement.
        contrast: f64,
    },
    /// The feedback carried gusts and noise into the inputs (M14.14).
    #[error("{}", feedback_text(*level, *share, *coherence))]
    Feedback {
        level: FeedbackLevel,
        /// Median `|G_b / G|`, the fed-back share of the measured response.
        share: f64,
        /// Median `|G_b|^2` over its variance.
        significance: f64,
        /// Median partial coherence of the most coherent input; below 0.6, no input was swept.
        coherence: f64,
    },
    /// The model departs from the measured points.
    #[error(
        "the model departs from the measured points of {input} → {output} between {:.1} and {:.1} rad/s: trust the points there, and \
         try another order or band",
        band[0],
        band[1]
    )]
    LeavesPoints {
        output: Signal,
        input: Signal,
        /// Lower and upper frequency \[rad/s\].
        band: [f64; 2],
        /// Mean of squared distance over variance in five neighbouring points, where it is largest;
        /// 12 is the limit (M14.17).
        strength: f64,
    },
    /// The criterion (BIC) still falls at the highest order tried.
    #[error(
        "the fit still improves at {order}, the highest order tried: the dynamics in the band have \
        more states. Try higher orders, or narrow the band, for example to {:.1} rad/s",
        narrower[1]
    )]
    OrderLimit {
        /// The highest order tried.
        order: usize,
        /// A suggested narrower band \[rad/s\].
        narrower: [f64; 2],
    },
    /// The model does not predict the held-out records.
    #[error(
        "the held-out records are not predicted: χ²/dof is {raw:.1} for the model as it is, and \
        {normalised:.1} if the model may vary within its uncertainty (1: only noise remains). \
        Possible causes: the aircraft was flown differently, or the records contain too little \
        excitation"
    )]
    HeldOut {
        records: Vec<String>,
        /// Cost per degree of freedom, with the model as fitted.
        raw: f64,
        /// Cost per degree of freedom, with the model free to move within its uncertainty.
        normalised: f64,
    },
    /// The records were weighted by their own noise; the value is the ratio between the largest and
    /// the smallest cost per degree of freedom before this weighting.
    #[error(
        "the noise variance of the records differs by a factor of up to {0:.1}: each record was \
        weighted by its own noise"
    )]
    Reweighed(f64),
    /// The held-out records cannot be compared with the model in time.
    #[error("the model was not compared with the time histories of the held-out records: {0}")]
    NotValidated(ValidationError),
    /// The model has an unstable pole above the highest spectral line used.
    #[error(
        "the model has an unstable pole of {:.0} rad/s, above the highest spectral line used \
        ({highest:.0} rad/s): the pole is an artefact, and no time histories were simulated. \
        Try another order",
        pole.norm()
    )]
    Unstable {
        /// The unstable pole \[rad/s\].
        pole: Complex<f64>,
        /// Highest spectral line used \[rad/s\].
        highest: f64,
    },
    /// Responses that are not identified, each as output and input.
    #[error("{} not identified: the standard deviation exceeds 3 dB", responses_are(.0))]
    PairsNotIdentified(Vec<[Signal; 2]>),
}

impl IdentificationCaution {
    /// Returns whether some inputs were moved only together, so that their effects cannot be
    /// separated.
    pub(crate) fn is_of_collinear_inputs(&self) -> bool {
        matches!(
            self,
            Self::MovedTogether { .. } | Self::Records(RecordCaution::MovedTogether { .. })
        )
    }

    /// Returns whether `other` is a mere consequence of this caution.
    ///
    /// - A contradiction explains the residuals of its records, unequal noise levels, and points
    ///   that no model follows, because they are means over contradicting records. If a channel's
    ///   sign is reversed, it also explains inputs that cancel in this mean and so do not seem to
    ///   be swept.
    /// - Spikes explain the residual of their record, unequal noise levels, vibration of their
    ///   channel, and a contradiction that involves their record, unless its cause is a delay or a
    ///   sign.
    fn explains(&self, other: &Self) -> bool {
        match self {
            Self::Contradiction { records, .. } => match other {
                Self::UnlikeRecord { record, .. } => {
                    records.iter().any(|wrong| wrong.record == *record)
                }
                Self::Reweighed(_) | Self::LeavesPoints { .. } => true,
                Self::NotSwept { .. } => records.iter().any(has_reversed_sign),
                _ => false,
            },
            Self::Records(RecordCaution::Spike { record, signal, .. }) => match other {
                Self::UnlikeRecord { name, .. } => name == record,
                Self::Inadequate { record: worst, .. } => worst == record,
                Self::Contradiction { records, .. } => {
                    common_code(records) == UNSPECIFIC_FAULT
                        && records.iter().any(|wrong| wrong.name == *record)
                }
                Self::Vibration {
                    signal: vibrating, ..
                } => vibrating == signal,
                Self::Reweighed(_) => true,
                _ => false,
            },
            _ => false,
        }
    }

    /// Removes the cautions that others explain, even if the others are explained themselves.
    pub(crate) fn without_consequences(cautions: Vec<Self>) -> Vec<Self> {
        let mut kept = Vec::with_capacity(cautions.len());
        for caution in &cautions {
            if !cautions.iter().any(|cause| cause.explains(caution)) {
                kept.push(caution.clone());
            }
        }
        kept
    }

    /// Returns the caution's text, with its code and the records, channels and band that it
    /// concerns.
    #[must_use]
    pub fn note(&self) -> CautionNote {
        CautionNote {
            text: self.to_string(),
            ..self.note_without_text()
        }
    }

    fn note_without_text(&self) -> CautionNote {
        match self {
            Self::Records(caution) => caution.note(),
            Self::Short {
                lowest, periods, ..
            } => {
                let better_lowest = lowest * (BETTER_PERIODS / periods).max(1.0);
                CautionNote::new("short").with_band([*lowest, better_lowest])
            }
            Self::NotSwept { signal, .. } => CautionNote::new("not-swept").with_channel(signal),
            Self::MovedTogether { .. } => CautionNote::new("collinear-inputs"),
            Self::BandNotShown { shown, .. } => CautionNote::new("band-narrowed").with_band(*shown),
            Self::Vibration { signal, .. } => CautionNote::new("vibration").with_channel(signal),
            Self::Inadequate { record, signal, .. } => CautionNote::new("inadequate")
                .with_record(record)
                .with_channel(signal),
            Self::UnlikeRecord { name, .. } => CautionNote::new("record").with_record(name),
            Self::Contradiction { records, .. } => CautionNote {
                records: records.iter().map(|record| record.name.clone()).collect(),
                ..CautionNote::new(common_code(records)).with_channel(common_channel(records))
            },
            Self::Feedback {
                level: FeedbackLevel::TooMuch,
                ..
            } => CautionNote::new("feedback"),
            Self::Feedback { .. } => CautionNote::new("feedback-some"),
            Self::LeavesPoints {
                output,
                input,
                band,
                ..
            } => CautionNote::new("points")
                .with_pair([output, input])
                .with_band(*band),
            Self::OrderLimit { narrower, .. } => {
                CautionNote::new("order-limit").with_band(*narrower)
            }
            Self::HeldOut { records, .. } => CautionNote {
                records: records.clone(),
                ..CautionNote::new("held-out")
            },
            Self::Reweighed(_) => CautionNote::new("reweighed"),
            Self::NotValidated(_) => CautionNote::new("not-validated"),
            Self::Unstable { .. } => CautionNote::new("unstable"),
            Self::PairsNotIdentified(pairs) => match pairs.as_slice() {
                [[output, input]] => CautionNote::new("not-identified").with_pair([output, input]),
                _ => CautionNote::new("not-identified"),
            },
        }
    }
}

/// Returns whether a record's most likely fault is a reversed sign.
fn has_reversed_sign(record: &ContradictingRecord) -> bool {
    matches!(record.fault, Some(RecordFault::Gain(_, factor)) if factor < 0.0)
}

/// Caution code for a contradicting record whose fault is a wrong scale, or unknown.
const UNSPECIFIC_FAULT: &str = "record";

/// Returns the caution code for a record's fault.
fn fault_code(record: &ContradictingRecord) -> &'static str {
    match &record.fault {
        Some(RecordFault::OutputsLate(_) | RecordFault::Late(..)) => "time-skew",
        Some(RecordFault::Gain(_, factor)) if *factor < 0.0 => "sign",
        _ => UNSPECIFIC_FAULT,
    }
}

/// Returns the caution code that the faults of all `records` share, else [`UNSPECIFIC_FAULT`].
fn common_code(records: &[ContradictingRecord]) -> &'static str {
    let Some(code) = records.first().map(fault_code) else {
        return UNSPECIFIC_FAULT;
    };
    if records.iter().all(|record| fault_code(record) == code) {
        code
    } else {
        UNSPECIFIC_FAULT
    }
}

/// Returns the faulty channel that all `records` share, if there is one.
fn common_channel(records: &[ContradictingRecord]) -> Option<&Signal> {
    let channels: Vec<Option<&Signal>> = records
        .iter()
        .map(|record| record.fault.as_ref().and_then(RecordFault::signal))
        .collect();
    let first = *channels.first()?;
    if channels.iter().all(|channel| *channel == first) {
        first
    } else {
        None
    }
}

/// Lists the band ends without a visible response: `below 0.80 rad/s and above 8.0 rad/s`.
fn hidden_ends(band: [f64; 2], shown: [f64; 2]) -> String {
    let mut ends = Vec::new();
    if shown[0] > band[0] {
        ends.push(format!("below {:.2} rad/s", shown[0]));
    }
    if shown[1] < band[1] {
        ends.push(format!("above {:.1} rad/s", shown[1]));
    }
    ends.join(" and ")
}

/// Lists responses with their verb: `LON → P, LAT → P and LON → Q are`.
fn responses_are(pairs: &[[Signal; 2]]) -> String {
    let names: Vec<String> = pairs
        .iter()
        .map(|[output, input]| format!("{input} → {output}"))
        .collect();
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", listed(&names))
}

/// Describes which records contradict each other, and their possible faults.
fn contradiction_text(records: &[ContradictingRecord], contrast: f64) -> String {
    let agreement = format!("(F = {contrast:.0}; 1 means agreement)");
    match records {
        [] => String::new(),
        [record] => {
            let name = &record.name;
            let fault = match &record.fault {
                Some(fault) => format!(" Likely cause: {fault}."),
                None => String::new(),
            };
            format!(
                "{name} contradicts the other records {agreement}.{fault} Correct the record, or \
                leave it out"
            )
        }
        records => {
            let names: Vec<&str> = records.iter().map(|record| record.name.as_str()).collect();
            let names = listed(&names);
            let mut text = format!(
                "{names} contradict one another {agreement}; a third record would show which is wrong."
            );
            for record in records {
                if let Some(fault) = &record.fault {
                    text += &format!(" Likely cause in {}: {fault}.", record.name);
                }
            }
            text
        }
    }
}

/// Describes what the feedback does to the model, and the remedy.
fn feedback_text(level: FeedbackLevel, share: f64, coherence: f64) -> String {
    let percent = 100.0 * share;
    let remedy = "Sweep with a larger amplitude, or specify the recorded reference that drove the loop \
        (--reference)";
    match level {
        FeedbackLevel::TooMuch if !is_swept(coherence) => format!(
            "do not use this model: no input was swept (median partial coherence at most \
            {coherence:.2}), and gusts and noise are fed back into the inputs. {remedy}"
        ),
        FeedbackLevel::TooMuch => format!(
            "do not use this model: about {percent:.0} % of the measured response is due to gusts \
            and noise fed back into the inputs, not to the aircraft, however well the model \
            fits. {remedy}"
        ),
        FeedbackLevel::Some | FeedbackLevel::None => format!(
            "about {percent:.0} % of the measured response is due to gusts and noise fed back \
            into the inputs: the models are wrong by tenths of a decibel to 2 dB. {remedy}"
        ),
    }
}
