//! Models compared with a record over time: selection, simulation jobs, and responses.

use std::sync::Arc;

use egui::{Color32, Label, RichText, Ui};

use gdcm_method::correction::Pade;
use gdcm_model::dataset::{BundleKind, StateSpace};
use gdcm_model::simulation::Validation;
use gdcm_study::jobs::identification_jobs::{SimulationFailure, SimulationJob};
use gdcm_words::missing_results::simulation_failure_text;

use super::frame_cache::cached;
use crate::gui::commands::command::Command;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::plot::chart::ChartLine;
use crate::gui::state::records::{ConditionRecords, TimeModel};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// A model compared with the displayed record.
pub(super) struct Simulated<'a> {
    pub(super) model: TimeModel,
    pub(super) color: Color32,
    /// Response of the model, or the reason for its absence; `None` while it is being computed.
    pub(super) result: Option<&'a Result<Arc<Validation>, SimulationFailure>>,
}

impl Simulated<'_> {
    /// Returns the response once it is computed.
    fn validation(&self) -> Option<&Validation> {
        match self.result {
            Some(Ok(validation)) => Some(validation),
            _ => None,
        }
    }

    /// Formats the fit of an output \[%\]; `None` if it is not available.
    pub(super) fn fit_words(&self, output: usize) -> Option<String> {
        let fits = &self.validation()?.fit_percent;
        let fit = fits.get(output).copied().flatten()?;
        Some(format!("{fit:.1} %"))
    }

    /// Returns Theil's coefficient of an output; `None` if it is not available.
    pub(super) fn theil(&self, output: usize) -> Option<f64> {
        self.validation()?.theil.get(output).copied().flatten()
    }

    /// Shows why there is no response, or that it is being computed.
    pub(super) fn absence_ui(&self, ui: &mut Ui, state: &State, palette: &Palette) {
        let (words, color) = match self.result {
            Some(Ok(_)) => return,
            Some(Err(why)) => (simulation_failure_text(why), palette.warning),
            None => (state.results.absence().to_owned(), palette.dim_text),
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
        let source = Arc::clone(validation) as _;
        let lines = cached(ui, &name, &[source], (), || {
            simulated_points(validation, output)
        });
        lines
            .iter()
            .map(|points| ChartLine {
                points: Arc::clone(points),
                color: self.color,
                width: 1.3,
                dashed: self.model == TimeModel::Physics,
            })
            .collect()
    }
}

/// Returns time \[s\] and simulated output, as a line for each window.
fn simulated_points(validation: &Validation, output: usize) -> Vec<Arc<[[f64; 2]]>> {
    let mut lines = Vec::new();
    for window in &validation.windows {
        let mut points = Vec::new();
        for (sample, value) in window.simulated.column(output).iter().enumerate() {
            let time_s = window.start_s + sample as f64 * window.sample_time_s;
            points.push([time_s, *value]);
        }
        lines.push(points.into());
    }
    lines
}

/// A model selected for the displayed record, with the job that computes its response.
struct ModelJob {
    model: TimeModel,
    job: SimulationJob,
}

/// Returns the selected models that are available in continuous time.
fn model_jobs(state: &State) -> Vec<ModelJob> {
    let Some(records) = state.records.conditions.get(&state.condition().id()) else {
        return Vec::new();
    };
    let Some(row) = records.rows.get(records.chosen) else {
        return Vec::new();
    };
    let Some(flight) = &row.flight else {
        return Vec::new();
    };
    let preparation = records.preparation();
    let mut jobs = Vec::new();
    for &model in &state.records.time_models {
        if let Some(space) = state_space(state, records, model) {
            let job = SimulationJob {
                record: Arc::clone(flight).into(),
                preparation: preparation.clone(),
                model: space,
            };
            jobs.push(ModelJob { model, job });
        }
    }
    jobs
}

/// Returns the jobs that simulate the models selected for the displayed record.
pub fn simulation_jobs(state: &State) -> Vec<SimulationJob> {
    model_jobs(state)
        .into_iter()
        .map(|model_job| model_job.job)
        .collect()
}

/// Returns the models selected for the displayed record.
pub(super) fn simulated<'a>(state: &'a State, palette: &Palette) -> Vec<Simulated<'a>> {
    let mut models = Vec::new();
    for ModelJob { model, job } in model_jobs(state) {
        let known = state
            .results
            .simulations
            .iter()
            .find(|(known, _)| *known == job);
        models.push(Simulated {
            model,
            color: model.color(palette),
            result: known.map(|(_, result)| result),
        });
    }
    models
}

/// Returns the state space of a model; `None` if the model is unavailable or not in continuous time
/// without delays.
fn state_space(state: &State, records: &ConditionRecords, model: TimeModel) -> Option<StateSpace> {
    if model == TimeModel::Identified {
        return records.identification()?.refined.state_space().cloned();
    }
    let analysis = state.shown()?;
    let name = analysis.representative_name(BundleKind::Physics);
    // The models as compared and corrected: moved by the physics parameters, where there are any.
    let physics = analysis
        .condition
        .model(BundleKind::Physics, name)?
        .state_space()?;
    let space = if model == TimeModel::Corrected {
        analysis
            .corrected_model(physics, &analysis.correction, Pade::default())
            .ok()?
            .model
    } else {
        physics.clone()
    };
    if space.timing().is_plain() {
        Some(space)
    } else {
        None
    }
}

/// Draws the selector of the models that are compared with the record.
pub(super) fn time_models_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.label(palette.small("compare with the simulated response of:"));
    for model in TimeModel::ALL {
        let mut is_drawn = state.records.time_models.contains(&model);
        let text = RichText::new(format!("{} model", model.name()))
            .size(SMALL_SIZE)
            .color(model.color(palette));
        let hint = "Simulated in windows of 10 s (shorter for an unstable model), each with a \
            separate initial state and offsets";
        if ui
            .checkbox(&mut is_drawn, text)
            .on_hover_text(hint)
            .changed()
        {
            commands.push(RecordsCommand::ShowTimeModel(model, is_drawn).into());
        }
    }
}
