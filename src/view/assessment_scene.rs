//! What the scheduled correction is worth, made of what was computed (M12, Figures 8 to 19).

use crate::dataset::{Condition, Pair};
use crate::study::{Analysis, Assessed};

use super::plot::{AssessmentBar, AssessmentPanel, BarValue};
use super::state::State;

/// One panel for each measuring response and the responses themselves: the change of J of the nominal model in each condition.
pub fn assessment_panels(state: &State) -> (Vec<Pair>, Vec<AssessmentPanel>) {
    let Some(analysis) = state.analysis() else {
        return (Vec::new(), Vec::new());
    };
    let pairs: Vec<Pair> = state.dataset().measuring_pairs().marked().collect();
    let panels = pairs
        .iter()
        .map(|&pair| AssessmentPanel {
            title: state.dataset().pair_name(pair),
            axis_label: "Condition".to_owned(),
            bars: state.dataset().conditions().iter().map(|condition| bar(state, analysis, pair, condition)).collect(),
        })
        .collect();
    (pairs, panels)
}

fn bar(state: &State, analysis: &Analysis, pair: Pair, condition: &Condition) -> AssessmentBar {
    let undefined = || BarValue::LeftOut { why: "the response is zero or not finite somewhere in the band".to_owned() };
    let (value, detail) = match analysis.assessment.get(&condition.id()) {
        None => (BarValue::LeftOut { why: state.results.absence().to_owned() }, String::new()),
        Some(Assessed::LeftOut { why }) => (BarValue::LeftOut { why: why.clone() }, String::new()),
        Some(Assessed::Nominal(changes)) => match changes[pair] {
            Some(change) => (
                BarValue::Change { magnitude: change.magnitude(), phase: change.phase() },
                format!("J {:.1} → {:.1}", change.uncorrected.total(), change.corrected.total()),
            ),
            None => (undefined(), String::new()),
        },
    };
    AssessmentBar {
        condition: condition.id(),
        label: condition.id().to_string(),
        value,
        selected: condition.id() == state.condition().id(),
        detail,
    }
}
