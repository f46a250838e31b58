//! Words of the verdict on gain and phase, short enough for the narrowest window.

use gdcm_method::correction::conflict::ConflictKind;
use gdcm_model::dataset::Pair;
use gdcm_model::statistics::median;
use gdcm_model::units::telling;
use gdcm_study::ConditionAnalysis;

use super::advice::joined;
use crate::gui::state::window_state::State;

/// Formats the verdict on the gains: "matched", "LAT → P stops at a bound", "2 share PED", "3
/// disagree".
pub(super) fn gain_words(state: &State, shown: &ConditionAnalysis) -> String {
    let Some(miss) = shown.gains.unmatched.first() else {
        return "matched".to_owned();
    };
    match miss.why.kind {
        ConflictKind::AboveUpper { .. }
        | ConflictKind::BelowLower { .. }
        | ConflictKind::TooFarApart { .. } => {
            format!(
                "{} stops at a bound",
                joined(&state.dataset().pair_name(miss.pair))
            )
        }
        ConflictKind::Loop { .. } | ConflictKind::Unclear => {
            let missed: Vec<Pair> = shown.gains.unmatched.iter().map(|miss| miss.pair).collect();
            shared_words(state, &missed)
                .unwrap_or_else(|| format!("{} disagree", miss.why.entries.len().max(2)))
        }
    }
}

/// Returns "2 share PED" for conflicting responses with a common input or output; otherwise `None`.
pub(super) fn shared_words(state: &State, pairs: &[Pair]) -> Option<String> {
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
    Some(format!("{} share {}", pairs.len(), channel.name))
}

/// Returns "lags by ≈ 66 ms" if the lags of all responses are about equal (by the criterion for a
/// common lead), otherwise "lags 20–110 ms"; short enough for the narrowest window.
pub(super) fn lag_words(left_ms: &mut [f64]) -> String {
    let least = left_ms.iter().copied().fold(f64::INFINITY, f64::min);
    let most = left_ms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let middle = median(left_ms);
    let verb = if middle >= 0.0 { "lags" } else { "leads" };
    let ends = if middle >= 0.0 {
        [least, most]
    } else {
        [-most, -least]
    };
    let [low, high] = ends.map(|end| telling(end, 0).replace('-', "\u{2212}"));
    if low == high {
        format!("{verb} by {low} ms")
    } else if most - least <= 0.5 * middle.abs() {
        format!("{verb} by ≈ {} ms", telling(middle.abs(), 0))
    } else {
        // "-5–60" would look like two minus signs.
        let to = if least * most < 0.0 { " to " } else { "–" };
        format!("{verb} {low}{to}{high} ms")
    }
}
