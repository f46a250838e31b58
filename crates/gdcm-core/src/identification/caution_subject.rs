//! What a caution is about, for files and for marks: its code, record, channel, pair and band.

use super::*;

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
        let of = |code: &'static str| CautionNote { code, text: self.to_string(), ..CautionNote::default() };
        let record = |code, name: &str| CautionNote { records: vec![name.to_owned()], ..of(code) };
        let channel = |code, signal: &Signal| CautionNote { channel: Some(signal.name.clone()), ..of(code) };
        match self {
            Self::Records(caution) => CautionNote { text: self.to_string(), ..caution.note() },
            Self::Short { lowest, periods, .. } => {
                CautionNote { band_rad_s: Some([*lowest, lowest * (5.0 / periods).max(1.0)]), ..of("short") }
            }
            Self::NotSwept { signal, .. } => channel("not-swept", signal),
            Self::MovedTogether { .. } => of("collinear-inputs"),
            Self::BandNotShown { shown, .. } => CautionNote { band_rad_s: Some(*shown), ..of("band-narrowed") },
            Self::Vibration { signal, .. } => channel("vibration", signal),
            Self::Inadequate { record: name, signal, .. } => {
                CautionNote { records: vec![name.clone()], ..channel("inadequate", signal) }
            }
            Self::UnlikeRecord { name, .. } => record("record", name),
            Self::Contradiction { records, .. } => {
                let (code, channel) = common_fault(records);
                let names = records.iter().map(|of| of.name.clone()).collect();
                CautionNote { records: names, channel: channel.map(|signal| signal.name.clone()), ..of(code) }
            }
            Self::Feedback { level: FeedbackLevel::TooMuch, .. } => of("feedback"),
            Self::Feedback { .. } => of("feedback-some"),
            Self::LeavesPoints { output, input, band, .. } => CautionNote {
                pair: Some([output.name.clone(), input.name.clone()]),
                band_rad_s: Some(*band),
                ..of("points")
            },
            Self::OrderLimit { narrower, .. } => CautionNote { band_rad_s: Some(*narrower), ..of("order-limit") },
            Self::HeldOut { records, .. } => CautionNote { records: records.clone(), ..of("held-out") },
            Self::Reweighed { .. } => of("reweighed"),
            Self::NotValidated { .. } => of("not-validated"),
            Self::Unstable { .. } => of("unstable"),
            Self::PairsNotIdentified { pairs } => {
                let pair = pairs.first().filter(|_| pairs.len() == 1);
                CautionNote {
                    pair: pair.map(|[output, input]| [output.name.clone(), input.name.clone()]),
                    ..of("not-identified")
                }
            }
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
    let mut signals = records.iter().map(|record| record.fault.as_ref().and_then(RecordFault::signal));
    let code = records.first().map(of).filter(|code| records.iter().all(|record| of(record) == *code));
    let first = signals.next().flatten();
    (code.unwrap_or("record"), first.filter(|_| signals.all(|signal| signal == first)))
}

impl RecordCaution {
    /// The caution with what it is about.
    fn note(&self) -> CautionNote {
        let of = |code: &'static str| CautionNote { code, text: self.to_string(), ..CautionNote::default() };
        let record = |code, name: &str| CautionNote { records: vec![name.to_owned()], ..of(code) };
        let channel = |code, signal: &Signal| CautionNote { channel: Some(signal.name.clone()), ..of(code) };
        match self {
            Self::Resampled { record: name, .. } => record("resampled", name),
            Self::SegmentDropped { record: name, .. } | Self::RecordUnused { record: name } => record("gap", name),
            Self::SampleHold { signal, .. } => channel("held", signal),
            Self::UnlikelyUnit { signal, .. } => channel("unit", signal),
            Self::MovedTogether { signals, .. } => channel("collinear-inputs", &signals[1]),
            Self::Copy { copy, .. } => channel("copy", copy),
            Self::AtLimit { record: name, signal, .. } => {
                CautionNote { records: vec![name.clone()], ..channel("clipped", signal) }
            }
            Self::Stuck { record: name, signals, .. } => {
                CautionNote { channel: signals.first().map(|signal| signal.name.clone()), ..record("stuck", name) }
            }
            Self::Coarse { signal, .. } => channel("coarse", signal),
        }
    }
}
