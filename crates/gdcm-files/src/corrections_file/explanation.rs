//! Why held responses could not be matched, what would help, and what holding costs, as data.

use serde::{Deserialize, Serialize};

use gdcm_core::correction::{ActiveConstraint, Conflict, ConflictKind, Problem, Sensitivity, Solution, sensitivities};

use super::names::ChannelNames;

/// What explains one optimum.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// Each smallest set of held responses and bounds that cannot hold together.
    pub conflicts: Vec<ConflictEntry>,
    /// Each loop of held responses that disagrees by no more than the tolerance, and counts as agreeing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub agreeing: Vec<ConflictEntry>,
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

impl Explanation {
    /// The explanation of the gains or of the delays.
    pub(super) fn of(problem: &Problem, solution: &Solution, names: &ChannelNames) -> Self {
        let sensitivities = sensitivities(problem, solution);
        Self {
            conflicts: solution.conflicts.iter().map(|conflict| ConflictEntry::of(conflict, names)).collect(),
            agreeing: solution.agreeing.iter().map(|agreement| ConflictEntry::of_agreement(agreement, names)).collect(),
            remedy: solution.remedy.as_ref().map(|remedy| RemedyEntry {
                upper: remedy.upper,
                lower: remedy.lower,
                free: remedy.free.iter().map(|&pair| names.pair(pair)).collect(),
            }),
            sensitivities: sensitivities.iter().map(|sensitivity| SensitivityEntry::of(sensitivity, names)).collect(),
        }
    }
}

impl ConflictEntry {
    fn of(conflict: &Conflict, names: &ChannelNames) -> Self {
        let (kind, figure, upper, lower) = match conflict.kind {
            ConflictKind::AboveUpper { asked, upper, .. } => ("upper_bound", Some(asked), Some(upper), None),
            ConflictKind::BelowLower { asked, lower: None, .. } => ("lead", Some(-asked), None, None),
            ConflictKind::BelowLower { asked, lower, .. } => ("lower_bound", Some(asked), None, lower),
            ConflictKind::TooFarApart { asked, upper, lower, .. } => ("both_bounds", Some(asked), Some(upper), lower),
            ConflictKind::Loop { mismatch } => ("loop", Some(mismatch), None, None),
            ConflictKind::Unclear => ("unclear", None, None, None),
        };
        Self {
            kind: kind.to_owned(),
            entries: conflict.entries.iter().map(|&pair| names.pair(pair)).collect(),
            channels: conflict.channels().into_iter().map(|channel| names.channel(channel)).collect(),
            figure,
            upper,
            lower,
            words: conflict.words(&names.inputs, &names.outputs),
        }
    }

    fn of_agreement(agreement: &Conflict, names: &ChannelNames) -> Self {
        Self { words: agreement.agreement_words(&names.inputs, &names.outputs), ..Self::of(agreement, names) }
    }
}

impl SensitivityEntry {
    fn of(sensitivity: &Sensitivity, names: &ChannelNames) -> Self {
        let (restraint, entry, channel) = match sensitivity.restraint {
            ActiveConstraint::Held(pair) => ("held", Some(names.pair(pair)), None),
            ActiveConstraint::LowerBound(channel) => ("lower_bound", None, Some(names.channel(channel))),
            ActiveConstraint::UpperBound(channel) => ("upper_bound", None, Some(names.channel(channel))),
        };
        Self {
            restraint: restraint.to_owned(),
            entry,
            channel,
            per_unit: sensitivity.per_unit,
            share_per_unit: sensitivity.share_per_unit,
        }
    }
}
