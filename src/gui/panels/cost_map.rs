//! Values of the cost map: magnitude and phase part of J for every constrained response (if there
//! are many, for every input) in every condition. With couplings, another column has the mean over
//! the unconstrained responses. `condition_rows.rs` paints the values as shades.
//!
//! J is the cost of a response's mismatch (M4: docs/method.md). Couplings mix the inputs and feed
//! outputs back to them (M16: docs/couplings.md).
//!
//! The mapped costs ([`MappedCost`]) are those before the correction, those with each condition's
//! own correction, or those under the schedule, as the engineer has chosen.

use gdcm_method::fidelity::Cost;
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_study::CouplingCorrection;

use crate::gui::state::mapped_cost::MappedCost;
use crate::gui::state::window_state::State;

/// Maximum count of constrained responses with a column each; more responses are merged into a
/// column for each input.
const MOST_COLUMNS: usize = 8;

/// Column in the map: a constrained response, an input's constrained responses, or all
/// unconstrained responses.
#[derive(Clone, Debug, PartialEq)]
pub struct CostColumn {
    /// Short heading, completed by the cells' tooltips: the response's output, the input, or "off"
    /// for the unconstrained responses, most of which are off-axis.
    pub head: String,
    pub pairs: Vec<Pair>,
    /// Whether the column shows the mean over its responses instead of the maximum. Every
    /// constrained response is to be matched, so the worst counts; the unconstrained responses are
    /// judged as a whole.
    pub is_mean: bool,
}

/// Returns the columns for constrained responses; if the study requests couplings, also the column
/// for unconstrained responses, which couplings are meant to improve.
pub fn columns(state: &State) -> Vec<CostColumn> {
    let mut columns = constrained_columns(state);
    if state.study.settings.couplings != CouplingCorrection::None {
        let unconstrained = state
            .study
            .settings
            .constrained
            .iter()
            .filter(|(_, is_constrained)| !**is_constrained);
        columns.push(CostColumn {
            head: "off".to_owned(),
            pairs: unconstrained.map(|(pair, _)| pair).collect(),
            is_mean: true,
        });
    }
    columns
}

/// Returns a column for each constrained response or, if there are too many, for each input.
fn constrained_columns(state: &State) -> Vec<CostColumn> {
    let dataset = state.dataset();
    let constrained: Vec<Pair> = state.study.settings.constrained.marked().collect();
    let mut columns = Vec::new();
    if constrained.len() <= MOST_COLUMNS {
        for pair in constrained {
            columns.push(CostColumn {
                head: dataset.outputs()[pair.output].name.clone(),
                pairs: vec![pair],
                is_mean: false,
            });
        }
        return columns;
    }
    for (input, channel) in dataset.inputs().iter().enumerate() {
        let pairs: Vec<Pair> = constrained
            .iter()
            .copied()
            .filter(|pair| pair.input == input)
            .collect();
        if !pairs.is_empty() {
            columns.push(CostColumn {
                head: channel.name.clone(),
                pairs,
                is_mean: false,
            });
        }
    }
    columns
}

/// Returns a response's J in a condition, for the mapped correction; `None` without a result, or if
/// this J is undefined.
pub fn cost_of(state: &State, condition: ConditionId, pair: Pair) -> Option<Cost> {
    let analysis = state.analysis()?;
    match state.display.judging.mapped_cost {
        MappedCost::Before => {
            let result = analysis.condition(condition)?;
            result.before_couplings().representative.cost[pair]
        }
        MappedCost::Own => {
            let result = analysis.condition(condition)?;
            result.cost[pair].map(|change| change.corrected)
        }
        MappedCost::Scheduled => {
            let costs = analysis.assessment.get(&condition)?.as_ref().ok()?;
            costs[pair].map(|change| change.corrected)
        }
    }
}

pub struct ColumnCost {
    /// Response with the greatest J (magnitude and phase part together).
    pub pair: Pair,
    /// Mean or maximum over the responses, taken separately for the magnitude and the phase part.
    pub cost: Cost,
}

/// Returns a column's cost in a condition; responses without J are omitted, `None` if all are.
pub fn cost_of_column(
    state: &State,
    condition: ConditionId,
    column: &CostColumn,
) -> Option<ColumnCost> {
    let costs: Vec<(Pair, Cost)> = column
        .pairs
        .iter()
        .filter_map(|pair| Some((*pair, cost_of(state, condition, *pair)?)))
        .collect();
    let (worst, _) = *costs
        .iter()
        .max_by(|(_, a), (_, b)| a.total().total_cmp(&b.total()))?;
    let magnitudes = costs.iter().map(|(_, cost)| cost.magnitude);
    let phases = costs.iter().map(|(_, cost)| cost.phase);
    let cost = if column.is_mean {
        let count = costs.len() as f64;
        Cost {
            magnitude: magnitudes.sum::<f64>() / count,
            phase: phases.sum::<f64>() / count,
        }
    } else {
        Cost {
            magnitude: magnitudes.fold(0.0, f64::max),
            phase: phases.fold(0.0, f64::max),
        }
    };
    Some(ColumnCost { pair: worst, cost })
}
