//! Map of costs: J of magnitude and phase of every constrained response in every condition, as
//! shades of a single hue; with couplings, the mean of the other responses beside them.

use gdcm_method::fidelity::Cost;
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_study::CouplingCorrection;

use crate::gui::state::mapped_cost::MappedCost;
use crate::gui::state::window_state::State;

/// More constrained responses than this are merged into the worst of each input.
const MOST_COLUMNS: usize = 8;

/// Column of the map: a constrained response, the constrained responses of an input, or all
/// unconstrained responses.
#[derive(Clone, Debug, PartialEq)]
pub struct CostColumn {
    pub head: String,
    pub pairs: Vec<Pair>,
    /// Whether the cost is the mean of the responses; otherwise the cost of the worst.
    pub is_mean: bool,
}

/// Returns the columns of the constrained responses, in the order of the outputs; with couplings
/// also a column of the responses that these improve.
pub fn columns(state: &State) -> Vec<CostColumn> {
    let mut columns = held_columns(state);
    if state.study.settings.couplings != CouplingCorrection::None {
        let others = state
            .study
            .settings
            .constrained
            .iter()
            .filter(|(_, is_held)| !**is_held);
        columns.push(CostColumn {
            head: "off".to_owned(),
            pairs: others.map(|(pair, _)| pair).collect(),
            is_mean: true,
        });
    }
    columns
}

fn held_columns(state: &State) -> Vec<CostColumn> {
    let dataset = state.dataset();
    let held: Vec<Pair> = state.study.settings.constrained.marked().collect();
    if held.len() > MOST_COLUMNS {
        let of_input = |input: usize| {
            held.iter()
                .copied()
                .filter(|pair| pair.input == input)
                .collect::<Vec<_>>()
        };
        let columns = dataset
            .inputs()
            .iter()
            .enumerate()
            .map(|(input, channel)| (channel.name.clone(), of_input(input)));
        let columns = columns.map(|(head, pairs)| CostColumn {
            head,
            pairs,
            is_mean: false,
        });
        return columns.filter(|column| !column.pairs.is_empty()).collect();
    }
    let head = |pair: &Pair| dataset.outputs()[pair.output].name.clone();
    let column = |pair: &Pair| CostColumn {
        head: head(pair),
        pairs: vec![*pair],
        is_mean: false,
    };
    held.iter().map(column).collect()
}

/// Returns J of magnitude and phase of a response in a condition; `None` without a result.
pub fn cost_of(state: &State, condition: ConditionId, pair: Pair) -> Option<Cost> {
    let analysis = state.analysis()?;
    if state.display.judging.mapped_cost == MappedCost::Scheduled {
        let Ok(costs) = analysis.assessment.get(&condition)? else {
            return None;
        };
        return costs[pair].map(|change| change.corrected);
    }
    let result = analysis.condition(condition)?;
    match state.display.judging.mapped_cost {
        MappedCost::Before => result.before_couplings().representative.cost[pair],
        _ => result.cost[pair].map(|change| change.corrected),
    }
}

/// Returns the cost of a column, magnitude and phase separately, with the response whose sum is the
/// greatest.
pub fn cost_of_column(
    state: &State,
    condition: ConditionId,
    column: &CostColumn,
) -> Option<(Pair, Cost)> {
    let costs: Vec<(Pair, Cost)> = column
        .pairs
        .iter()
        .filter_map(|pair| Some((*pair, cost_of(state, condition, *pair)?)))
        .collect();
    let (worst, _) = *costs
        .iter()
        .max_by(|(_, a), (_, b)| a.total().total_cmp(&b.total()))?;
    let of = |part: fn(&Cost) -> f64| {
        let parts = costs.iter().map(|(_, cost)| part(cost));
        if column.is_mean {
            parts.sum::<f64>() / costs.len() as f64
        } else {
            parts.fold(0.0, f64::max)
        }
    };
    Some((
        worst,
        Cost {
            magnitude: of(|cost| cost.magnitude),
            phase: of(|cost| cost.phase),
        },
    ))
}
