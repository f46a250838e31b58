//! Table with a row for each condition that has records.
//!
//! χ²/dof is the cost of the fit for each degree of freedom, 1 if the model leaves only noise
//! (M14.4: docs/identification.md).

use gdcm_model::number_format::decimals;
use gdcm_words::Table;

use crate::gui::state::condition_fit::{FitCosts, FitStatus};
use crate::gui::state::condition_records::EndedIdentification;
use crate::gui::state::records::ConditionRecords;
use crate::gui::state::window_state::State;

/// Tabulates the conditions with records: record counts, fit state, model order, χ²/dof for fitted
/// and held-out records, model and caution counts, and computing time. Without a successful
/// identification, the cells from the order on are empty.
pub fn condition_table(state: &State) -> Table {
    let columns = [
        "condition",
        "airspeed [kt]",
        "records",
        "held-out records",
        "fit",
        "order",
        "χ²/dof",
        "χ²/dof, held out",
        "models",
        "cautions",
        "computing time [s]",
    ];
    let mut table = Table::new("Identified conditions", columns);
    for id in state.records.conditions_in_use() {
        let airspeed_kt = match state.dataset().condition(id) {
            Some(condition) => decimals(condition.flight_state().airspeed_kt, 0),
            None => String::new(),
        };
        let fit = state.condition_fit(id);
        let mut cells = vec![
            id.to_string(),
            airspeed_kt,
            fit.counts.fitted.to_string(),
            fit.counts.held_out.to_string(),
            status_word(fit.status).to_owned(),
        ];
        if let Some(records) = state.records.conditions.get(&id) {
            cells.extend(outcome_cells(records));
        }
        table.row(cells);
    }
    table
}

fn status_word(status: FitStatus) -> &'static str {
    match status {
        FitStatus::None => "",
        FitStatus::Queued => "queued",
        FitStatus::Running { .. } => "running",
        FitStatus::Failed => "failed",
        FitStatus::Outdated => "outdated",
        FitStatus::Finished { .. } => "finished",
    }
}

/// Returns the cells from the model order on; none without a successful identification.
fn outcome_cells(records: &ConditionRecords) -> Vec<String> {
    let Some(EndedIdentification {
        job,
        outcome: Ok(identification),
    }) = &records.latest
    else {
        return Vec::new();
    };
    let costs = FitCosts::new(identification);
    let order = match identification.refined.order() {
        Some(order) => order.to_string(),
        None => String::new(),
    };
    vec![
        order,
        decimals(costs.fitted, 2),
        decimals_or_empty(costs.held_out, 2),
        (identification.bundle.len() + 1).to_string(),
        identification.cautions.len().to_string(),
        decimals_or_empty(job.news().duration_s, 1),
    ]
}

fn decimals_or_empty(value: Option<f64>, count: usize) -> String {
    match value {
        Some(value) => decimals(value, count),
        None => String::new(),
    }
}
