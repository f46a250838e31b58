//! Table with a row for each condition that has records.

use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::decimals;
use gdcm_words::Table;

use crate::gui::state::records::ConditionRecords;
use crate::gui::state::window_state::State;

/// Returns the conditions with at least one used record.
pub(super) fn conditions_with_records(
    state: &State,
) -> impl Iterator<Item = (&ConditionId, &ConditionRecords)> {
    state
        .records
        .conditions
        .iter()
        .filter(|(_, records)| records.used_rows().next().is_some())
}

/// Builds a table of the conditions with records: model order, χ²/dof of fitted and held-out
/// records, numbers of models and cautions, and computing time. Before an identification, cells are
/// empty or give the reason.
pub fn condition_table(state: &State) -> Table {
    let columns = [
        "condition",
        "airspeed [kt]",
        "order",
        "χ²/dof",
        "held out",
        "models",
        "cautions",
        "time [s]",
    ];
    let mut table = Table::new("Identified conditions", columns);
    for (id, records) in conditions_with_records(state) {
        let airspeed_kt = match state.dataset().condition(*id) {
            Some(condition) => decimals(condition.flight_state().airspeed_kt, 0),
            None => String::new(),
        };
        let mut cells = vec![id.to_string(), airspeed_kt];
        cells.extend(outcome_cells(state, *id, records));
        table.row(cells);
    }
    table
}

/// Returns the cells from the model order on; fewer cells before an identification.
fn outcome_cells(state: &State, id: ConditionId, records: &ConditionRecords) -> Vec<String> {
    if let Some(job) = state.records.job_of(id) {
        let text = if job.news().step.is_empty() {
            "waiting"
        } else {
            "running"
        };
        return vec![text.to_owned()];
    }
    match &records.found {
        None => Vec::new(),
        Some((_, Err(_))) => vec!["not identified".to_owned()],
        Some((job, Ok(found))) => {
            let order = match found.refined.order() {
                Some(order) => order.to_string(),
                None => String::new(),
            };
            vec![
                order,
                decimals(found.cost, 2),
                decimals_or_empty(found.held_out_cost, 2),
                (found.bundle.len() + 1).to_string(),
                found.cautions.len().to_string(),
                decimals_or_empty(job.news().duration_s, 1),
            ]
        }
    }
}

fn decimals_or_empty(value: Option<f64>, count: usize) -> String {
    match value {
        Some(value) => decimals(value, count),
        None => String::new(),
    }
}
