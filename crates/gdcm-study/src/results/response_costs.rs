//! A response's J in each condition: before the correction, at the condition's optimum, and under
//! the schedule (M12).

use gdcm_method::fidelity::Cost;
use gdcm_method::schedule::assessment::corrected_cost_on;
use gdcm_model::dataset::{ConditionId, Pair};

use super::analysis::Analysis;

/// The physics representative's J in a condition's response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResponseCosts {
    pub condition: ConditionId,
    pub airspeed_kt: f64,
    /// Without a correction.
    pub before: Cost,
    /// With the condition's own correction.
    pub optimum: Cost,
    /// With the schedule at the condition's airspeed; `None` without a schedule, and where its net
    /// gain is not positive.
    pub scheduled: Option<Cost>,
}

impl Analysis {
    /// Returns a response's J in each condition in which it can be compared, in dataset order.
    pub fn response_costs(&self, pair: Pair) -> Vec<ResponseCosts> {
        let mut costs = Vec::new();
        for id in self.study.dataset.ids() {
            costs.extend(self.response_costs_in(id, pair));
        }
        costs
    }

    /// Returns a response's J in a condition; `None` without a result, and where the response
    /// cannot be compared.
    fn response_costs_in(&self, id: ConditionId, pair: Pair) -> Option<ResponseCosts> {
        let result = self.condition(id)?;
        let own = result.cost[pair]?;
        let state = result.condition.flight_state();
        let mut scheduled = None;
        if let Ok(schedule) = &self.schedule
            && let Some(mismatch) = &result.comparison.representative.mismatch[pair]
        {
            let correction = schedule.at_state(state);
            let average = self.study.settings.cost_average;
            scheduled = corrected_cost_on(mismatch, &correction, pair, &self.omega, average);
        }
        Some(ResponseCosts {
            condition: id,
            airspeed_kt: state.airspeed_kt,
            before: own.uncorrected,
            optimum: own.corrected,
            scheduled,
        })
    }
}
