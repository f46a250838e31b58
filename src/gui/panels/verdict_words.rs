//! Words of the verdict on gain and phase, short enough for the narrowest window.

use gdcm_method::correction::conflict::ConflictKind;
use gdcm_model::dataset::Pair;
use gdcm_model::statistics::median;
use gdcm_model::units::telling;
use gdcm_study::ConditionAnalysis;

use super::advice::joined;
use crate::gui::state::window_state::State;
use crate::message::Message;

/// Returns the verdict on the gains: "matched", "LAT → P stops at a bound", "2 share PED", "3
/// disagree".
pub(super) fn gain_message(state: &State, shown: &ConditionAnalysis) -> Message {
    let Some(miss) = shown.gains.unmatched.first() else {
        return Message::new("matched", "matched");
    };
    match miss.why.kind {
        ConflictKind::AboveUpper { .. }
        | ConflictKind::BelowLower { .. }
        | ConflictKind::TooFarApart { .. } => {
            let pair = joined(&state.dataset().pair_name(miss.pair));
            Message::new("stops-at-bound", format!("{pair} stops at a bound"))
        }
        ConflictKind::Loop { .. } | ConflictKind::Unclear => {
            let missed: Vec<Pair> = shown.gains.unmatched.iter().map(|miss| miss.pair).collect();
            let count = miss.why.entries.len().max(2);
            match shared_channel(state, &missed) {
                Some(channel) => Message::new(
                    "shared-channel",
                    format!("{} share {channel}", missed.len()),
                ),
                None => Message::new("disagree", format!("{count} disagree")),
            }
        }
    }
}

/// Returns the name of the input or output that several conflicting responses have in common.
pub(super) fn shared_channel<'a>(state: &'a State, pairs: &[Pair]) -> Option<&'a str> {
    let [first, rest @ ..] = pairs else {
        return None;
    };
    if rest.is_empty() {
        return None;
    }
    let channel = if rest.iter().all(|pair| pair.input == first.input) {
        &state.dataset().inputs()[first.input]
    } else if rest.iter().all(|pair| pair.output == first.output) {
        &state.dataset().outputs()[first.output]
    } else {
        return None;
    };
    Some(&channel.name)
}

/// Lags that the correction leaves \[ms\]; negative values are leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RemainingLag {
    /// All lags are displayed as the same number.
    Equal(f64),
    /// The lags are about equal (by the criterion for a common lead); their median.
    AboutEqual(f64),
    /// The lowest and the highest lag.
    Range([f64; 2]),
}

impl RemainingLag {
    /// Summarises the lags of all responses, of which there is at least one.
    pub(super) fn new(left_ms: &mut [f64]) -> Self {
        let least = left_ms.iter().copied().fold(f64::INFINITY, f64::min);
        let most = left_ms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let middle = median(left_ms);
        if telling(least, 0) == telling(most, 0) {
            Self::Equal(middle)
        } else if most - least <= 0.5 * middle.abs() {
            Self::AboutEqual(middle)
        } else if middle >= 0.0 {
            Self::Range([least, most])
        } else {
            Self::Range([most, least])
        }
    }

    /// Returns "lags by ≈ 66 ms", "lags 20–110 ms"; short enough for the narrowest window.
    pub(super) fn words(self) -> String {
        match self {
            Self::Equal(lag) => format!("{} by {} ms", verb(lag), lag_text(lag.abs())),
            Self::AboutEqual(lag) => format!("{} by ≈ {} ms", verb(lag), lag_text(lag.abs())),
            Self::Range([first, last]) => {
                // The range of leads begins with its lag nearest to zero.
                let leads = first > last;
                let verb = if leads { "leads" } else { "lags" };
                let sign = if leads { -1.0 } else { 1.0 };
                // "-5–60" would look like two minus signs.
                let to = if first * last < 0.0 { " to " } else { "–" };
                format!(
                    "{verb} {}{to}{} ms",
                    lag_text(sign * first),
                    lag_text(sign * last)
                )
            }
        }
    }
}

fn verb(lag_ms: f64) -> &'static str {
    if lag_ms >= 0.0 { "lags" } else { "leads" }
}

/// Formats a lag in whole milliseconds, with a minus sign.
fn lag_text(lag_ms: f64) -> String {
    telling(lag_ms, 0).replace('-', "\u{2212}")
}
