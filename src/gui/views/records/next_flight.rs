//! Tables of the confidence intervals predicted after further sweeps of each input.

use egui::{Grid, RichText, Ui};

use gdcm_model::dataset::Dataset;
use gdcm_words::Table;
use gdcm_words::flight_plan::{PlannedChannels, PlannedInput, sweep_plan_table};

use super::page::Page;

/// Shows a table for each input, or why there is no prediction; nothing without a successful
/// identification.
pub(super) fn next_flight_ui(ui: &mut Ui, page: Page<'_>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let Some(latest) = &records.latest else {
        return;
    };
    if latest.outcome.is_err() {
        return;
    }
    let Some(plan) = latest.job.news().next_flight else {
        ui.label(palette.small(
            "Next flight: no prediction of the 95 % intervals, because the Fisher information of \
            the records cannot be computed",
        ));
        return;
    };
    ui.label(RichText::new("Next flight: predicted 95 % intervals").strong());
    let channels = planned_channels(state.dataset());
    for sweep in &plan.sweeps {
        let table = sweep_plan_table(sweep, &channels);
        ui.add_space(4.0);
        ui.label(palette.small(table.title.as_str()));
        table_ui(ui, &table);
    }
    ui.label(palette.small(
        "Assumes the noise of the flown records, with the other inputs at rest; gdcm plan \
        computes other sweeps",
    ));
}

fn table_ui(ui: &mut Ui, table: &Table) {
    Grid::new(("next flight", &table.title))
        .num_columns(table.columns.len())
        .striped(true)
        .show(ui, |ui| {
            for heading in &table.columns {
                ui.label(heading);
            }
            ui.end_row();
            for row in &table.rows {
                for cell in row {
                    ui.label(cell);
                }
                ui.end_row();
            }
        });
}

/// Returns the dataset's channel names and the inputs' units, in dataset order.
pub(super) fn planned_channels(dataset: &Dataset) -> PlannedChannels {
    let mut channels = PlannedChannels::default();
    for input in dataset.inputs() {
        channels.inputs.push(PlannedInput {
            name: input.name.clone(),
            unit: input.unit.clone(),
        });
    }
    for output in dataset.outputs() {
        channels.outputs.push(output.name.clone());
    }
    channels
}
