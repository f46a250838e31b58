//! Texts about the assessment bars: accessible names, status text with the reason for a missing
//! change in J, and derivations.
//!
//! J is the cost of the difference between a model's response and the identified one (M4:
//! docs/method.md). A condition or a response that the assessment could not compare is *left out*.

use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::marks::MarkId;
use gdcm_study::AssessmentTable;
use gdcm_words::assessment::{missing_cost_text, not_assessed_text};
use gdcm_words::derivation::ExplainTarget;

use super::assessment_plots::AssessmentPlots;
use crate::gui::plot::FigureWords;
use crate::gui::plot::derivation_menu::Question;

impl FigureWords for AssessmentPlots<'_> {
    fn plot_name(&self, plot: usize) -> String {
        let pair = self.pairs[plot];
        let mut words = Vec::new();
        for condition in self.state.dataset().conditions() {
            let id = condition.id();
            words.push(match self.change(id, pair) {
                Some(change) => format!("{id} {}", decimals(change.total(), 1)),
                None => format!("{id} left out"),
            });
        }
        format!(
            "Change of J by condition, {}: {}",
            self.state.dataset().pair_name(pair),
            words.join(", ")
        )
    }

    fn status_text(&self, plot: usize, id: &MarkId, _: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let pair = self.pairs[plot];
        let subject = format!("{}, condition {id}", self.state.dataset().pair_name(pair));
        let Some(change) = self.change(*id, pair) else {
            return Some(format!(
                "{subject} · left out: {}",
                absence_reason(self.table, self.state.dataset(), *id, pair)
            ));
        };
        Some(format!(
            "{subject} · ΔJ {}: magnitude {}, phase {} · J {} → {}",
            decimals(change.total(), 1),
            decimals(change.magnitude(), 1),
            decimals(change.phase(), 1),
            decimals(change.uncorrected.total(), 1),
            decimals(change.corrected.total(), 1)
        ))
    }

    fn questions(&self, plot: usize, id: &MarkId) -> Vec<Question> {
        let MarkId::Condition(id) = *id else {
            return Vec::new();
        };
        let pair = self.pairs[plot];
        if self.change(id, pair).is_none() {
            return Vec::new();
        }
        let target = ExplainTarget::CostChange(id, pair, self.table.choice);
        vec![Question::new("Change of J", target)]
    }
}

/// Returns why the change in J is missing.
fn absence_reason(
    table: &AssessmentTable,
    dataset: &Dataset,
    condition: ConditionId,
    pair: Pair,
) -> String {
    for left_out in &table.left_out {
        if left_out.condition == condition {
            return not_assessed_text(&left_out.why, dataset);
        }
    }
    for assessed in &table.conditions {
        if assessed.condition != condition {
            continue;
        }
        for (missing, why) in &assessed.missing {
            if *missing == pair {
                return missing_cost_text(*why);
            }
        }
    }
    "not computed".to_owned()
}
