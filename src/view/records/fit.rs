//! How well models fit the records: in frequency, by record and output, and in time.

use egui::{Grid, RichText, ScrollArea, Ui};

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::state::State;

use super::bench::ConditionRecords;
use super::record_list::{BAD, GOOD};
use super::simulation::{simulated, time_models_ui};

/// Theil's coefficient below which a model is a good one (M14, section 6).
const GOOD_THEIL: f64 = 0.25;

/// Tables of the fit: by record, by output, and in time.
pub(super) fn fit_ui(
    ui: &mut Ui,
    state: &State,
    records: &ConditionRecords,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ScrollArea::vertical().id_salt("fit").auto_shrink(false).show(ui, |ui| {
        if let Some(found) = records.identification() {
            ui.label(RichText::new("In frequency: J per degree of freedom; 1 is what noise explains").strong());
            Grid::new("fit of records").num_columns(3).striped(true).show(ui, |ui| {
                for fit in &found.record_fits {
                    let name = found.record_uses.get(fit.record).map_or("", |of| of.record.as_str());
                    ui.label(name);
                    ui.label(cost_text(fit.cost, palette));
                    ui.label(if fit.held_out { "held out" } else { "" });
                    ui.end_row();
                }
            });
            ui.add_space(6.0);
            Grid::new("fit of outputs").num_columns(2).striped(true).show(ui, |ui| {
                for (output, cost) in state.dataset().outputs().iter().zip(&found.output_costs) {
                    ui.label(&output.name);
                    ui.label(cost_text(*cost, palette));
                    ui.end_row();
                }
            });
        } else {
            ui.label(RichText::new("Nothing was identified yet: choose Identify above.").color(palette.dim_text));
        }
        ui.add_space(10.0);
        time_ui(ui, state, records, palette, commands);
    });
}

fn cost_text(cost: f64, palette: &Palette) -> RichText {
    let color = match cost {
        cost if cost <= GOOD => palette.good,
        cost if cost <= BAD => palette.text,
        _ => palette.warning,
    };
    RichText::new(format!("{cost:.2}")).color(color)
}

/// Fit and Theil's coefficient of each model asked for, of the record shown.
fn time_ui(ui: &mut Ui, state: &State, records: &ConditionRecords, palette: &Palette, commands: &mut Vec<Command>) {
    let name = records.rows.get(records.chosen).map_or("", |row| row.table.name.as_str());
    ui.label(RichText::new(format!("In time: {name}, fit in % and Theil's coefficient")).strong());
    time_models_ui(ui, state, palette, commands);
    let models = simulated(state, palette);
    Grid::new("fit in time").num_columns(1 + 2 * models.len()).striped(true).show(ui, |ui| {
        ui.label("");
        for model in &models {
            ui.label(RichText::new(model.model.name()).color(model.color));
            ui.label("");
        }
        ui.end_row();
        for (index, output) in state.dataset().outputs().iter().enumerate() {
            ui.label(&output.name);
            for model in &models {
                let theil = model.validation().and_then(|of| of.theil.get(index).copied().flatten());
                ui.label(model.fit_words(index).unwrap_or_else(|| "–".to_owned()));
                let color =
                    theil.map_or(palette.dim_text, |of| if of < GOOD_THEIL { palette.good } else { palette.warning });
                ui.label(RichText::new(theil.map_or("–".to_owned(), |of| format!("{of:.3}"))).color(color));
            }
            ui.end_row();
        }
    });
    for model in &models {
        model.absence_ui(ui, state, palette);
    }
    let text = "A fit in time hardly tells models apart: rank them by the cost of what was held out.";
    ui.label(RichText::new(text).size(SMALL_SIZE).color(palette.dim_text));
}
