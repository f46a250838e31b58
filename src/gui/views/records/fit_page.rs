//! Page with the fit of the models: χ²/dof in the frequency domain, fit and Theil's coefficient in
//! the time domain; below, what further sweeps would bring.

use egui::{Grid, RichText, ScrollArea, Ui};

use gdcm_sysid::identification::Identification;

use super::next_flight::next_flight_ui;
use super::page::Page;
use super::record_list::cost_text;
use super::simulation::{simulated, time_models_ui};
use crate::gui::commands::command::Command;
use crate::gui::widgets::palette::Palette;

/// Limit of Theil's coefficient below which the fit of a model counts as good (M14, section 6).
const GOOD_THEIL: f64 = 0.25;

/// Shows the fit in tables: by record, by output, and in the time domain.
pub(super) fn fit_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    ScrollArea::vertical()
        .id_salt("fit")
        .auto_shrink(false)
        .show(ui, |ui| {
            if let Some(found) = page.identification_ui(ui) {
                frequency_fit_ui(ui, page, found);
            }
            ui.add_space(10.0);
            time_fit_ui(ui, page, commands);
            ui.add_space(10.0);
            next_flight_ui(ui, page);
        });
}

/// Shows χ²/dof by record and by output.
fn frequency_fit_ui(ui: &mut Ui, page: Page<'_>, found: &Identification) {
    let Page { state, palette, .. } = page;
    let heading = "Frequency domain: χ² per degree of freedom; 1 if only noise remains";
    ui.label(RichText::new(heading).strong());
    Grid::new("fit of records")
        .num_columns(3)
        .striped(true)
        .show(ui, |ui| {
            for fit in &found.record_fits {
                ui.label(match found.record_uses.get(fit.record) {
                    Some(record_use) => record_use.record.as_str(),
                    None => "",
                });
                ui.label(cost_text(fit.cost, palette));
                ui.label(if fit.held_out { "held out" } else { "" });
                ui.end_row();
            }
        });
    ui.add_space(6.0);
    Grid::new("fit of outputs")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            let outputs = state.dataset().outputs();
            for (output, cost) in outputs.iter().zip(&found.output_costs) {
                ui.label(&output.name);
                ui.label(cost_text(*cost, palette));
                ui.end_row();
            }
        });
}

/// Shows fit and Theil's coefficient of each output and selected model, for the displayed record.
fn time_fit_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let name = match records.rows.get(records.chosen) {
        Some(row) => row.table.name.as_str(),
        None => "",
    };
    ui.label(
        RichText::new(format!(
            "Time domain: {name}, fit in % and Theil's coefficient"
        ))
        .strong(),
    );
    time_models_ui(ui, state, palette, commands);
    let models = simulated(state, palette);
    Grid::new("fit in time")
        .num_columns(1 + 2 * models.len())
        .striped(true)
        .show(ui, |ui| {
            ui.label("");
            for model in &models {
                ui.label(RichText::new(model.model.name()).color(model.color));
                ui.label("");
            }
            ui.end_row();
            for (index, output) in state.dataset().outputs().iter().enumerate() {
                ui.label(&output.name);
                for model in &models {
                    ui.label(model.fit_words(index).unwrap_or_else(|| "–".to_owned()));
                    ui.label(theil_text(model.theil(index), palette));
                }
                ui.end_row();
            }
        });
    for model in &models {
        model.absence_ui(ui, state, palette);
    }
    ui.label(palette.small(
        "The fit in the time domain hardly distinguishes models: rank them by the cost of \
        held-out records",
    ));
}

/// Formats Theil's coefficient, in the warning colour unless it is below [`GOOD_THEIL`].
fn theil_text(theil: Option<f64>, palette: &Palette) -> RichText {
    let Some(theil) = theil else {
        return RichText::new("–").color(palette.dim_text);
    };
    let color = if theil < GOOD_THEIL {
        palette.text
    } else {
        palette.warning
    };
    RichText::new(format!("{theil:.3}")).color(color)
}
