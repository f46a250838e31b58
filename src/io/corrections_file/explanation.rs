//! Why held responses could not be matched, what would help, and what holding costs, as data.

use serde::{Deserialize, Serialize};

use crate::correction::{
    Channel, DelayConflict, DelayRestraint, DelaySensitivity, DelaySolution, GainConflict, GainRestraint,
    GainSensitivity, GainSolution,
};

use super::names::ChannelNames;

/// What explains one optimum.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// Each smallest set of held responses and bounds that cannot hold together.
    pub conflicts: Vec<ConflictEntry>,
    /// Single changes after which everything held can be held; absent where nothing is in the way.
    pub remedy: Option<RemedyEntry>,
    /// What each held response and each active bound costs, the most expensive first.
    pub sensitivities: Vec<SensitivityEntry>,
}

/// A smallest set of held responses and bounds that cannot hold together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConflictEntry {
    /// What is in the way: `upper_bound`, `lower_bound`, `both_bounds`, `lead`, `loop` or `unclear`.
    pub kind: String,
    /// The held responses, `[output, input]`, of which one must be freed.
    pub entries: Vec<(String, String)>,
    /// The channels whose bounds are in the way.
    pub channels: Vec<String>,
    /// By how much: a product or ratio of gains, a sum or difference of delays \[s\], or the mismatch of a loop \[dB or s\].
    pub figure: Option<f64>,
    /// Upper bound that would resolve it.
    pub upper: Option<f64>,
    /// Lower bound that would resolve it.
    pub lower: Option<f64>,
    /// The same in words.
    pub words: String,
}

/// Single changes after which everything held can be held.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RemedyEntry {
    /// This upper bound.
    pub upper: Option<f64>,
    /// This lower bound.
    pub lower: Option<f64>,
    /// Freeing any one of these, `[output, input]`.
    pub free: Vec<(String, String)>,
}

/// The multiplier of a held response or an active bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensitivityEntry {
    /// `held`, `lower_bound` or `upper_bound`.
    pub restraint: String,
    /// The held response, `[output, input]`.
    pub entry: Option<(String, String)>,
    /// The channel on its bound.
    pub channel: Option<String>,
    /// Change of the objective for each dB (gains) or ms (delays) by which it is raised.
    pub per_unit: f64,
    /// The same as a share of the objective.
    pub share_per_unit: f64,
}

/// The explanation of the gains.
pub(super) fn of_gains(gains: &GainSolution, sensitivities: &[GainSensitivity], names: &ChannelNames) -> Explanation {
    Explanation {
        conflicts: gains.conflicts.iter().map(|conflict| gain_conflict(conflict, names)).collect(),
        remedy: gains.remedy.as_ref().map(|remedy| RemedyEntry {
            upper: remedy.upper,
            lower: remedy.lower,
            free: remedy.free.iter().map(|&pair| names.pair(pair)).collect(),
        }),
        sensitivities: sensitivities.iter().map(|sensitivity| gain_sensitivity(sensitivity, names)).collect(),
    }
}

/// The explanation of the delays.
pub(super) fn of_delays(
    delays: &DelaySolution,
    sensitivities: &[DelaySensitivity],
    names: &ChannelNames,
) -> Explanation {
    Explanation {
        conflicts: delays.conflicts.iter().map(|conflict| delay_conflict(conflict, names)).collect(),
        remedy: delays.remedy.as_ref().map(|remedy| RemedyEntry {
            upper: remedy.upper_s,
            lower: None,
            free: remedy.free.iter().map(|&pair| names.pair(pair)).collect(),
        }),
        sensitivities: sensitivities.iter().map(|sensitivity| delay_sensitivity(sensitivity, names)).collect(),
    }
}

fn gain_conflict(conflict: &GainConflict, names: &ChannelNames) -> ConflictEntry {
    let (kind, figure, upper, lower) = match *conflict {
        GainConflict::ProductTooGreat { product, upper, .. } => ("upper_bound", Some(product), Some(upper), None),
        GainConflict::ProductTooSmall { product, lower, .. } => ("lower_bound", Some(product), None, Some(lower)),
        GainConflict::RatioTooGreat { ratio, upper, lower, .. } => {
            ("both_bounds", Some(ratio), Some(upper), Some(lower))
        }
        GainConflict::Loop { mismatch_db, .. } => ("loop", Some(mismatch_db), None, None),
        GainConflict::Unclear { .. } => ("unclear", None, None, None),
    };
    ConflictEntry {
        kind: kind.to_owned(),
        entries: conflict.entries().iter().map(|&pair| names.pair(pair)).collect(),
        channels: conflict.channels().into_iter().map(|channel| names.channel(channel)).collect(),
        figure,
        upper,
        lower,
        words: conflict.words(&names.inputs, &names.outputs),
    }
}

fn delay_conflict(conflict: &DelayConflict, names: &ChannelNames) -> ConflictEntry {
    let (kind, figure, upper) = match *conflict {
        DelayConflict::NeedsLead { lead_s, .. } => ("lead", Some(lead_s), None),
        DelayConflict::SumTooGreat { sum_s, upper_s, .. } => ("upper_bound", Some(sum_s), Some(upper_s)),
        DelayConflict::DifferenceTooGreat { difference_s, upper_s, .. } => {
            ("both_bounds", Some(difference_s), Some(upper_s))
        }
        DelayConflict::Loop { mismatch_s, .. } => ("loop", Some(mismatch_s), None),
        DelayConflict::Unclear { .. } => ("unclear", None, None),
    };
    ConflictEntry {
        kind: kind.to_owned(),
        entries: conflict.entries().iter().map(|&pair| names.pair(pair)).collect(),
        channels: conflict.channels().into_iter().map(|channel| names.channel(channel)).collect(),
        figure,
        upper,
        lower: None,
        words: conflict.words(&names.inputs, &names.outputs),
    }
}

fn gain_sensitivity(sensitivity: &GainSensitivity, names: &ChannelNames) -> SensitivityEntry {
    let (restraint, entry, channel) = match sensitivity.restraint {
        GainRestraint::Held(pair) => ("held", Some(names.pair(pair)), None),
        GainRestraint::LowerBound(channel) => ("lower_bound", None, Some(channel)),
        GainRestraint::UpperBound(channel) => ("upper_bound", None, Some(channel)),
    };
    sensitivity_entry(restraint, entry, channel, (sensitivity.per_db, sensitivity.share_per_db), names)
}

fn delay_sensitivity(sensitivity: &DelaySensitivity, names: &ChannelNames) -> SensitivityEntry {
    let (restraint, entry, channel) = match sensitivity.restraint {
        DelayRestraint::Held(pair) => ("held", Some(names.pair(pair)), None),
        DelayRestraint::Zero(channel) => ("lower_bound", None, Some(channel)),
        DelayRestraint::UpperBound(channel) => ("upper_bound", None, Some(channel)),
    };
    sensitivity_entry(restraint, entry, channel, (sensitivity.per_ms, sensitivity.share_per_ms), names)
}

fn sensitivity_entry(
    restraint: &str,
    entry: Option<(String, String)>,
    channel: Option<Channel>,
    (per_unit, share_per_unit): (f64, f64),
    names: &ChannelNames,
) -> SensitivityEntry {
    SensitivityEntry {
        restraint: restraint.to_owned(),
        entry,
        channel: channel.map(|channel| names.channel(channel)),
        per_unit,
        share_per_unit,
    }
}
