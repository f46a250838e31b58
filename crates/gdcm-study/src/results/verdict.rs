//! Verdict on the constrained responses: how many are matched in gain and in phase, and what
//! remains.
//!
//! In names, *held* responses are the constrained ones. J is the mismatch cost (M4).

use gdcm_method::correction::Channel;
use gdcm_method::correction::conflict::ConflictKind;
use gdcm_method::correction::solution::Solution;
use gdcm_model::dataset::Pair;
use gdcm_model::statistics::median;
use gdcm_model::units::{s_to_ms, telling};

use crate::decisions::settings::PhaseCorrection;
use crate::decisions::study::Study;
use crate::results::analysis::{Analysis, ConditionAnalysis};

/// Number of constrained responses, and how many of them are matched, in gain or in phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MatchCount {
    pub matched: usize,
    pub held: usize,
}

impl MatchCount {
    /// Counts the constrained responses whose gain is matched.
    pub fn of_gains(result: &ConditionAnalysis) -> Self {
        Self::of_solution(result, &result.gains)
    }

    /// Counts the constrained responses whose delay or lead is matched.
    pub fn of_phases(result: &ConditionAnalysis) -> Self {
        Self::of_solution(result, &result.delays)
    }

    fn of_solution(result: &ConditionAnalysis, solution: &Solution) -> Self {
        let held = result.held().marked().count();
        Self {
            matched: held.saturating_sub(solution.unmatched.len()),
            held,
        }
    }

    /// Sums the counts over all conditions with a result.
    pub fn over_conditions(analysis: &Analysis, count: fn(&ConditionAnalysis) -> Self) -> Self {
        let mut total = Self::default();
        for result in analysis.conditions.values().flatten() {
            let added = count(result);
            total.matched += added.matched;
            total.held += added.held;
        }
        total
    }
}

/// Verdict on the constrained responses' gains in a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GainVerdict {
    /// No response is constrained.
    NoneHeld,
    Matched,
    /// A gain bound keeps a response from being matched.
    StopsAtBound {
        pair: Pair,
    },
    /// All unmatched responses have a channel in common.
    SharedChannel {
        unmatched: usize,
        channel: Channel,
    },
    /// Constrained responses contradict one another.
    Disagree {
        entries: usize,
    },
}

impl GainVerdict {
    /// Judges a condition's gains: no response constrained; else all matched; else by the conflict
    /// of the first unmatched response: a bound; or a contradiction, for which the channel that all
    /// unmatched responses share is named if there is one.
    pub fn new(result: &ConditionAnalysis) -> Self {
        if result.held().marked().next().is_none() {
            return Self::NoneHeld;
        }
        let Some(miss) = result.gains.unmatched.first() else {
            return Self::Matched;
        };
        match miss.why.kind {
            ConflictKind::AboveUpper { .. }
            | ConflictKind::BelowLower { .. }
            | ConflictKind::TooFarApart { .. } => Self::StopsAtBound { pair: miss.pair },
            ConflictKind::Loop { .. } | ConflictKind::Unclear => {
                let mut missed = Vec::with_capacity(result.gains.unmatched.len());
                for miss in &result.gains.unmatched {
                    missed.push(miss.pair);
                }
                match shared_channel(&missed) {
                    Some(channel) => Self::SharedChannel {
                        unmatched: missed.len(),
                        channel,
                    },
                    // A single entry cannot disagree.
                    None => Self::Disagree {
                        entries: miss.why.entries.len().max(2),
                    },
                }
            }
        }
    }

    /// Returns the stable code for scripts and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoneHeld => "none-held",
            Self::Matched => "matched",
            Self::StopsAtBound { .. } => "stops-at-bound",
            Self::SharedChannel { .. } => "shared-channel",
            Self::Disagree { .. } => "disagree",
        }
    }
}

/// Returns the input, or else the output, that all responses have in common; `None` also for fewer
/// than two responses.
pub fn shared_channel(pairs: &[Pair]) -> Option<Channel> {
    let [first, rest @ ..] = pairs else {
        return None;
    };
    if rest.is_empty() {
        return None;
    }
    if rest.iter().all(|pair| pair.input == first.input) {
        Some(Channel::Input(first.input))
    } else if rest.iter().all(|pair| pair.output == first.output) {
        Some(Channel::Output(first.output))
    } else {
        None
    }
}

/// Verdict on the constrained responses' phases in a condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PhaseVerdict {
    /// The study requests no phase correction.
    NotCorrected,
    /// No response is constrained.
    NoneHeld,
    Matched,
    /// The correction leaves a lag or a lead.
    LagRemains(RemainingLag),
}

impl PhaseVerdict {
    /// Judges a condition's phases: no phase correction; else no response constrained; else all
    /// matched; else the lags that remain.
    pub fn new(study: &Study, result: &ConditionAnalysis) -> Self {
        if study.settings.phase == PhaseCorrection::None {
            return Self::NotCorrected;
        }
        if result.held().marked().next().is_none() {
            return Self::NoneHeld;
        }
        if result.delays.matched {
            return Self::Matched;
        }
        let mut remaining_ms = Vec::with_capacity(result.delays.unmatched.len());
        for miss in &result.delays.unmatched {
            remaining_ms.push(s_to_ms(miss.excess));
        }
        Self::LagRemains(RemainingLag::new(&mut remaining_ms))
    }

    /// Returns the stable code for scripts and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NotCorrected => "not-corrected",
            Self::NoneHeld => "none-held",
            Self::Matched => "matched",
            Self::LagRemains(_) => "lag-remains",
        }
    }
}

/// Maximum range of lags that are about equal, relative to their median: as for a common lead
/// (`lead_remarks`).
const ABOUT_EQUAL: f64 = 0.5;

/// Lags that the correction leaves \[ms\]; negative values are leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RemainingLag {
    /// All lags are displayed as the same number.
    Equal(f64),
    /// The lags are about equal (by the criterion for a common lead); their median.
    AboutEqual(f64),
    /// Smallest and largest lag; in reverse order if the median is a lead.
    Range([f64; 2]),
}

impl RemainingLag {
    /// Summarises the lags of all responses \[ms\] (at least one), and sorts them: equal as
    /// displayed; else about equal, in a range of at most half the median; else the range.
    pub fn new(remaining_ms: &mut [f64]) -> Self {
        let least = remaining_ms.iter().copied().fold(f64::INFINITY, f64::min);
        let most = remaining_ms
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let middle = median(remaining_ms);
        // `telling` formats a number as it is displayed.
        if telling(least, 0) == telling(most, 0) {
            Self::Equal(middle)
        } else if most - least <= ABOUT_EQUAL * middle.abs() {
            Self::AboutEqual(middle)
        } else if middle >= 0.0 {
            Self::Range([least, most])
        } else {
            Self::Range([most, least])
        }
    }
}

/// Mean J over a condition's constrained responses that have a J; if none is constrained, over the
/// on-axis responses, or over all if none is on-axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanCost {
    pub before: f64,
    pub after: f64,
}

impl MeanCost {
    /// Averages the representative's costs; `None` if no response has one.
    pub fn new(study: &Study, result: &ConditionAnalysis) -> Option<Self> {
        let mut pairs: Vec<Pair> = result.held().marked().collect();
        if pairs.is_empty() {
            pairs = study.dataset.measuring_pairs().marked().collect();
        }
        let mut total = Self {
            before: 0.0,
            after: 0.0,
        };
        let mut count = 0.0;
        for pair in pairs {
            if let Some(cost) = result.cost[pair] {
                total.before += cost.uncorrected.total();
                total.after += cost.corrected.total();
                count += 1.0;
            }
        }
        if count == 0.0 {
            return None;
        }
        Some(Self {
            before: total.before / count,
            after: total.after / count,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn responses_with_a_common_channel_share_it() {
        let channel = |pairs: &[(usize, usize)]| {
            let mut responses = Vec::new();
            for (output, input) in pairs {
                responses.push(Pair::new(*output, *input));
            }
            shared_channel(&responses)
        };
        assert_eq!(channel(&[(2, 2), (4, 2)]), Some(Channel::Input(2)));
        assert_eq!(channel(&[(1, 0), (1, 3), (1, 2)]), Some(Channel::Output(1)));
        assert_eq!(channel(&[(2, 2), (5, 3)]), None);
        assert_eq!(channel(&[(2, 2)]), None);
        assert_eq!(channel(&[]), None);
    }

    #[test]
    fn a_common_lag_is_one_number_and_unequal_lags_are_a_range() {
        let cases: [(&[f64], RemainingLag); 5] = [
            (&[60.0], RemainingLag::Equal(60.0)),
            (&[60.0, 70.0, 64.0], RemainingLag::AboutEqual(64.0)),
            (&[40.0, 106.0, 62.0], RemainingLag::Range([40.0, 106.0])),
            (&[-5.0, 106.0, 62.0], RemainingLag::Range([-5.0, 106.0])),
            (&[-90.0, -10.0, -30.0], RemainingLag::Range([-10.0, -90.0])),
        ];
        for (remaining_ms, expected) in cases {
            assert_eq!(
                RemainingLag::new(&mut remaining_ms.to_vec()),
                expected,
                "{remaining_ms:?}"
            );
        }
    }
}
