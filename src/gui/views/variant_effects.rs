//! Table with the effects of the current decisions and of each variant.
//!
//! A *variant* is a set of decisions that the engineer has kept under a name.

use gdcm_model::dataset::Pair;
use gdcm_model::number_format::NO_VALUE;
use gdcm_model::units::signed;
use gdcm_study::Analysis;
use gdcm_words::Table;

use super::net_gain_pairs::net_gain_pairs;
use super::variant_analyses::variant_analysis;
use crate::gui::state::window_state::State;

/// Tabulates the effects: a row for each effect, a column for the current decisions and for each
/// variant. A cell is "…" until its analysis is available.
pub(super) fn effect_table(state: &State) -> Table {
    let condition = state.condition().id();
    let title = format!(
        "Variants: results in condition {condition}, and the schedule's over all conditions"
    );
    let mut columns = vec!["value".to_owned(), "now".to_owned()];
    let mut analyses = vec![state.analysis()];
    for variant in &state.study.variants {
        columns.push(variant.name.clone());
        analyses.push(variant_analysis(state, variant));
    }
    let mut table = Table::new(title, columns);
    for effect in effects(state) {
        let mut cells = vec![effect.name(state)];
        for analysis in &analyses {
            cells.push(match analysis {
                Some(analysis) => effect
                    .text(state, analysis)
                    .unwrap_or_else(|| NO_VALUE.to_owned()),
                None => "…".to_owned(),
            });
        }
        table.row(cells);
    }
    table
}

/// Effect compared between variants.
#[derive(Clone, Copy)]
enum Effect {
    /// Net gain in the displayed condition.
    NetGain(Pair),
    /// J in the displayed condition, before and after the correction.
    Cost(Pair),
    /// Gain objective in the displayed condition.
    Objective,
    /// Mean change in J with the schedule, over all assessed conditions and the responses in the
    /// objective: the on-axis responses, or all if none is on-axis.
    MeanChange,
}

fn effects(state: &State) -> Vec<Effect> {
    let mut effects = Vec::new();
    for pair in net_gain_pairs(state) {
        effects.push(Effect::NetGain(pair));
        effects.push(Effect::Cost(pair));
    }
    effects.push(Effect::Objective);
    effects.push(Effect::MeanChange);
    effects
}

impl Effect {
    fn name(self, state: &State) -> String {
        match self {
            Self::NetGain(pair) => format!("net gain {}", state.dataset().pair_name(pair)),
            Self::Cost(pair) => format!("J {}", state.dataset().pair_name(pair)),
            Self::Objective => "objective of the gains".to_owned(),
            Self::MeanChange => "mean ΔJ on-axis, scheduled".to_owned(),
        }
    }

    /// Formats the effect in an analysis; `None` where it is undefined.
    fn text(self, state: &State, analysis: &Analysis) -> Option<String> {
        let condition = state.condition().id();
        match self {
            Self::NetGain(pair) => {
                let correction = &analysis.condition(condition)?.correction;
                Some(format!("{:.4}", correction.net_gain(pair)))
            }
            Self::Cost(pair) => {
                let cost = analysis.condition(condition)?.cost[pair]?;
                Some(format!(
                    "{:.1} → {:.1}",
                    cost.uncorrected.total(),
                    cost.corrected.total()
                ))
            }
            Self::Objective => {
                let gains = &analysis.condition(condition)?.gains;
                Some(format!("{:.4}", gains.objective))
            }
            Self::MeanChange => mean_change(state, analysis),
        }
    }
}

/// Computes the nominal models' mean change in J with the schedule, over the responses in the
/// objective in all assessed conditions; `None` without an assessed response.
fn mean_change(state: &State, analysis: &Analysis) -> Option<String> {
    let measuring = state.dataset().measuring_pairs();
    let mut changes = Vec::new();
    for assessed in analysis.assessment.values().flatten() {
        for pair in measuring.marked() {
            if let Some(change) = assessed[pair] {
                changes.push(change.total());
            }
        }
    }
    let mean = changes.iter().sum::<f64>() / changes.len() as f64;
    if mean.is_finite() {
        Some(signed(mean, 2))
    } else {
        None
    }
}
