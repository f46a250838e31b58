//! Responses in the net-gain plots and tables, as chosen in the view's header.

use gdcm_model::dataset::Pair;

use crate::gui::state::pair_set::PairSet;
use crate::gui::state::window_state::State;

/// Returns the responses in the net-gain plots, in matrix order.
pub fn net_gain_pairs(state: &State) -> Vec<Pair> {
    let display = &state.display;
    let constrained = &state.study.settings.constrained;
    let mut pairs = Vec::new();
    for pair in constrained.pairs() {
        let is_shown = match display.gains.net_gain_pairs {
            // Releasing a response keeps its plot.
            PairSet::Held => constrained[pair] || display.gains.once_held.contains(&pair),
            PairSet::Focused => display.selection.pair == pair,
            PairSet::OnAxis => state.dataset().measuring_pairs()[pair],
            PairSet::All => true,
            PairSet::Picked => display.gains.picked_pairs.contains(&pair),
        };
        if is_shown {
            pairs.push(pair);
        }
    }
    pairs
}
