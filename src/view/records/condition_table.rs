//! What was identified in every condition, as a table.

use egui::Ui;
use gdcm_core::study::Table;
use gdcm_files::figure::decimals;

use super::{ConditionRecords, Page};
use crate::view::Command;
use crate::view::state::State;
use crate::view::tables::{Sorting, TableLook, table_ui};

/// The conditions that have records, one below the other; a heading sorts them, a click on one shows it.
pub(super) fn condition_table_ui(ui: &mut Ui, page: Page<'_>, sorting: &mut Sorting, commands: &mut Vec<Command>) {
    let table = condition_table(page.state);
    let ids: Vec<_> = with_records(page.state).map(|(id, _)| *id).collect();
    if ids.is_empty() {
        ui.label(page.palette.dim("No condition has records yet."));
        return;
    }
    let shown = page.state.condition().id();
    let color = |row: usize, column: usize| (column == 6 && table.rows[row][6] != "0").then_some(page.palette.warning);
    let look = TableLook { color: &color, selected: &|row| ids.get(row) == Some(&shown) };
    if let Some(click) = table_ui(ui, &table, sorting, &look, page.palette, commands)
        && let Some(id) = ids.get(click.row)
    {
        commands.push(Command::SelectCondition(*id));
    }
}

fn with_records(state: &State) -> impl Iterator<Item = (&gdcm_core::dataset::ConditionId, &ConditionRecords)> {
    state.records.conditions.iter().filter(|(_, of)| of.used_rows().next().is_some())
}

/// A row for each condition that has records: its order, χ²/dof of the fit and of what was held out, how many models and cautions there
/// are, and how long it took. Where nothing was identified yet, the cells are empty, or say why.
pub fn condition_table(state: &State) -> Table {
    let columns = ["condition", "airspeed [kt]", "order", "χ²/dof", "held out", "models", "cautions", "time [s]"];
    let mut table = Table::new("Identified conditions", columns);
    for (id, records) in with_records(state) {
        let airspeed_kt = state.dataset().condition(*id).map(|of| decimals(of.flight_state().airspeed_kt, 0));
        let named = [id.to_string(), airspeed_kt.unwrap_or_default()];
        let told = match (&records.found, state.records.running(*id)) {
            (_, Some(job)) if job.told().step.is_empty() => vec!["waits".to_owned()],
            (_, Some(_)) => vec!["under way".to_owned()],
            (None, None) => Vec::new(),
            (Some((_, Err(_))), None) => vec!["not identified".to_owned()],
            (Some((job, Ok(found))), None) => vec![
                found.refined.order().map_or(String::new(), |order| order.to_string()),
                decimals(found.cost, 2),
                found.held_out_cost.map_or(String::new(), |cost| decimals(cost, 2)),
                (found.bundle.len() + 1).to_string(),
                found.cautions.len().to_string(),
                job.told().duration_s.map_or(String::new(), |time_s| decimals(time_s, 1)),
            ],
        };
        table.row(named.into_iter().chain(told));
    }
    table
}
