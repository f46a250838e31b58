//! Comparison of models with a record in the time domain: model selection, responses and fit.

use std::sync::Arc;

use egui::{Color32, Grid, Label, RichText, ScrollArea, Ui};

use gdcm_method::correction::Pade;
use gdcm_model::dataset::{BundleKind, StateSpace};
use gdcm_model::simulation::Validation;
use gdcm_study::jobs::identification_jobs::SimulationJob;

use super::frame_cache::kept;
use super::page::Page;
use super::record_list::cost_text;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chart::ChartLine;
use crate::gui::state::records::{ConditionRecords, TimeModel};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// A model compared with the displayed record.
pub(super) struct Simulated<'a> {
    pub(super) model: TimeModel,
    /// Colour of its lines.
    pub(super) color: Color32,
    /// Its response, or the reason why there is none; `None` during the computation.
    pub(super) result: Option<&'a Result<Arc<Validation>, String>>,
}

impl Simulated<'_> {
    /// Returns the response once it is computed.
    pub(super) fn validation(&self) -> Option<&Validation> {
        Some(self.result?.as_ref().ok()?.as_ref())
    }

    /// Describes the fit of an output; `None` if unknown.
    pub(super) fn fit_words(&self, output: usize) -> Option<String> {
        let fit = self
            .validation()?
            .fit_percent
            .get(output)
            .copied()
            .flatten()?;
        Some(format!("{fit:.1} %"))
    }

    /// Shows why there is no response, or that it is being computed.
    pub(super) fn absence_ui(&self, ui: &mut Ui, state: &State, palette: &Palette) {
        let (words, color) = match self.result {
            Some(Ok(_)) => return,
            Some(Err(why)) => (why.as_str(), palette.warning),
            None => (state.results.absence(), palette.dim_text),
        };
        let words = format!("{} model: {words}", self.model.name());
        ui.add(Label::new(RichText::new(words).size(SMALL_SIZE).color(color)).wrap());
    }

    /// Returns the lines of an output, one per window, each from its own initial state.
    pub(super) fn lines(&self, ui: &Ui, output: usize) -> Vec<ChartLine> {
        let Some(Ok(validation)) = self.result else {
            return Vec::new();
        };
        let name = format!("{} {output}", self.model.name());
        let points = kept(ui, &name, &[Arc::clone(validation) as _], (), || {
            simulated_points(validation, output)
        });
        let dashed = self.model == TimeModel::Physics;
        let line = |points: &Arc<[[f64; 2]]>| ChartLine {
            points: Arc::clone(points),
            color: self.color,
            width: 1.3,
            dashed,
        };
        points.iter().map(line).collect()
    }
}

fn simulated_points(validation: &Validation, output: usize) -> Vec<Arc<[[f64; 2]]>> {
    let windows = validation.windows.iter().map(|window| {
        let at = |sample: usize| window.start_s + sample as f64 * window.sample_time_s;
        let values = window.simulated.column(output);
        values
            .iter()
            .enumerate()
            .map(|(sample, value)| [at(sample), *value])
            .collect()
    });
    windows.collect()
}

/// Returns the models selected for the displayed record, with the jobs that compute their
/// responses.
fn jobs(state: &State) -> Vec<(TimeModel, SimulationJob)> {
    let Some(records) = state.records.conditions.get(&state.condition().id()) else {
        return Vec::new();
    };
    let Some(record) = records
        .rows
        .get(records.chosen)
        .and_then(|row| row.flight.as_ref())
    else {
        return Vec::new();
    };
    let preparation = records.preparation();
    let of = |model: &TimeModel| {
        let record = Arc::clone(record);
        let preparation = preparation.clone();
        Some((
            *model,
            SimulationJob {
                record: record.into(),
                preparation,
                model: state_space(state, records, *model)?,
            },
        ))
    };
    state.records.time_models.iter().filter_map(of).collect()
}

/// Returns the jobs of the models selected for the displayed record.
pub fn simulation_jobs(state: &State) -> Vec<SimulationJob> {
    jobs(state).into_iter().map(|(_, job)| job).collect()
}

/// Returns the models selected for the displayed record.
pub(super) fn simulated<'a>(state: &'a State, palette: &Palette) -> Vec<Simulated<'a>> {
    let of = |(model, job): (TimeModel, SimulationJob)| {
        let known = state
            .results
            .simulations
            .iter()
            .find(|(known, _)| *known == job);
        Simulated {
            model,
            color: model.color(palette),
            result: known.map(|(_, result)| result),
        }
    };
    jobs(state).into_iter().map(of).collect()
}

/// Returns a model's state space; `None` if the model is unavailable or not continuous-time.
fn state_space(state: &State, records: &ConditionRecords, model: TimeModel) -> Option<StateSpace> {
    let plain = |of: &StateSpace| of.timing().is_plain().then(|| of.clone());
    if model == TimeModel::Identified {
        return records.identification()?.refined.state_space().cloned();
    }
    let shown = state.shown()?;
    let name = shown.representative_name(BundleKind::Physics);
    let physics = state
        .condition()
        .model(BundleKind::Physics, name)?
        .state_space()?;
    match model {
        TimeModel::Corrected => plain(
            &shown
                .corrected_model(physics, &shown.correction, Pade::default())
                .ok()?
                .model,
        ),
        TimeModel::Identified | TimeModel::Physics => plain(physics),
    }
}

/// Selects the models drawn beside the record.
pub(super) fn time_models_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.label(palette.small("response to the same inputs, and fit, of:"));
    for model in TimeModel::ALL {
        let mut shown = state.records.time_models.contains(&model);
        let text = RichText::new(format!("{} model", model.name()))
            .size(SMALL_SIZE)
            .color(model.color(palette));
        let hint = "In windows of 10 s, or shorter where the model is unstable, each from an initial state and offsets of its own";
        if ui.checkbox(&mut shown, text).on_hover_text(hint).changed() {
            commands.push(RecordsCommand::ShowTimeModel(model, shown).into());
        }
    }
}

/// Theil's coefficient below which a model is good (M14, section 6).
const GOOD_THEIL: f64 = 0.25;

/// Shows tables of the fit: by record, by output, and in time.
pub(super) fn fit_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page { state, palette, .. } = page;
    ScrollArea::vertical()
        .id_salt("fit")
        .auto_shrink(false)
        .show(ui, |ui| {
            if let Some(found) = page.identification_ui(ui) {
                ui.label(
                    RichText::new(
                        "In frequency: χ² per degree of freedom; 1 is what noise explains",
                    )
                    .strong(),
                );
                Grid::new("fit of records")
                    .num_columns(3)
                    .striped(true)
                    .show(ui, |ui| {
                        for fit in &found.record_fits {
                            let name = found
                                .record_uses
                                .get(fit.record)
                                .map_or("", |of| of.record.as_str());
                            ui.label(name);
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
                        for (output, cost) in
                            state.dataset().outputs().iter().zip(&found.output_costs)
                        {
                            ui.label(&output.name);
                            ui.label(cost_text(*cost, palette));
                            ui.end_row();
                        }
                    });
            }
            ui.add_space(10.0);
            time_ui(ui, page, commands);
        });
}

/// Shows the fit and Theil's coefficient of each selected model for the displayed record.
fn time_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let Page {
        state,
        records,
        palette,
    } = page;
    let name = records
        .rows
        .get(records.chosen)
        .map_or("", |row| row.table.name.as_str());
    ui.label(RichText::new(format!("In time: {name}, fit in % and Theil's coefficient")).strong());
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
                    let theil = model
                        .validation()
                        .and_then(|of| of.theil.get(index).copied().flatten());
                    ui.label(model.fit_words(index).unwrap_or_else(|| "–".to_owned()));
                    let color = theil.map_or(palette.dim_text, |of| {
                        if of < GOOD_THEIL {
                            palette.text
                        } else {
                            palette.warning
                        }
                    });
                    ui.label(
                        RichText::new(theil.map_or("–".to_owned(), |of| format!("{of:.3}")))
                            .color(color),
                    );
                }
                ui.end_row();
            }
        });
    for model in &models {
        model.absence_ui(ui, state, palette);
    }
    let text =
        "A fit in time hardly tells models apart: rank them by the cost of what was held out.";
    ui.label(palette.small(text));
}
