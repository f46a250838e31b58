//! The map of costs: J of magnitude and of phase of every held response in every condition, as shades of one hue.

use gdcm_core::dataset::{ConditionId, Pair};
use gdcm_core::fidelity::Cost;
use gdcm_core::study::Assessed;

use super::State;

/// Which correction the map shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MappedCost {
    /// None: the physics representative as it is.
    Before,
    /// Each condition's own optimum.
    #[default]
    Own,
    /// The schedule, on the nominal model.
    Scheduled,
}

impl MappedCost {
    /// Every choice, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Before, Self::Own, Self::Scheduled];

    /// What its menu entry says.
    pub fn name(self) -> &'static str {
        match self {
            Self::Before => "before any correction",
            Self::Own => "each optimum",
            Self::Scheduled => "the schedule",
        }
    }
}

/// More held responses than this are merged to the worst of each input.
const MOST_COLUMNS: usize = 8;

/// One column of the map: a held response, or those of one input.
#[derive(Clone, Debug, PartialEq)]
pub struct CostColumn {
    /// What stands above it.
    pub head: String,
    /// Its responses.
    pub pairs: Vec<Pair>,
}

/// The columns of the held responses, in the order of the outputs.
pub fn columns(state: &State) -> Vec<CostColumn> {
    let dataset = state.dataset();
    let held: Vec<Pair> = state.study.settings.constrained.marked().collect();
    if held.len() > MOST_COLUMNS {
        let of_input = |input: usize| held.iter().copied().filter(|pair| pair.input == input).collect::<Vec<_>>();
        let columns =
            dataset.inputs().iter().enumerate().map(|(input, channel)| (channel.name.clone(), of_input(input)));
        let columns = columns.map(|(head, pairs)| CostColumn { head, pairs });
        return columns.filter(|column| !column.pairs.is_empty()).collect();
    }
    let column = |pair: &Pair| CostColumn { head: dataset.outputs()[pair.output].name.clone(), pairs: vec![*pair] };
    held.iter().map(column).collect()
}

/// J of one response in one condition, magnitude and phase; none where it has none.
pub fn cost_of(state: &State, condition: ConditionId, pair: Pair) -> Option<Cost> {
    let analysis = state.analysis()?;
    if state.display.mapped_cost == MappedCost::Scheduled {
        let Assessed::Nominal(costs) = analysis.assessment.get(&condition)? else { return None };
        return costs[pair].map(|change| change.corrected);
    }
    let result = analysis.condition(condition)?;
    let change = result.cost[pair]?;
    Some(if state.display.mapped_cost == MappedCost::Before { change.uncorrected } else { change.corrected })
}

/// The worst of a column, magnitude and phase each for itself, with the response that has the greater sum.
pub fn worst_of(state: &State, condition: ConditionId, pairs: &[Pair]) -> Option<(Pair, Cost)> {
    let costs = pairs.iter().filter_map(|pair| Some((*pair, cost_of(state, condition, *pair)?)));
    costs.reduce(|(worst, a), (pair, b)| {
        let both = Cost { magnitude: a.magnitude.max(b.magnitude), phase: a.phase.max(b.phase) };
        (if b.total() > a.total() { pair } else { worst }, both)
    })
}
