//! Jobs that simulate the models with the displayed record, and their results.
//!
//! Each frame builds the jobs anew, with the corrected models; a job's result is found in
//! `state.results.simulations` by an equal job. The record is divided into windows, and each is
//! simulated from its own initial state.
//!
//! Fit and Theil's coefficient of the result are defined in M14.6 (docs/identification.md).

use std::sync::Arc;

use egui::Ui;

use gdcm_method::correction::{ChannelCorrection, Pade};
use gdcm_model::dataset::{BundleKind, StateSpace};
use gdcm_model::simulation::Validation;
use gdcm_study::ConditionAnalysis;
use gdcm_study::jobs::identification_jobs::{SimulationFailure, SimulationJob};
use gdcm_words::missing_results::simulation_failure_text;

use super::frame_cache::cached;
use super::time_lines::TimeLines;
use crate::gui::state::records::{ConditionRecords, TimeRole};
use crate::gui::state::window_state::State;

/// Model compared with the displayed record.
pub(super) struct Simulated<'a> {
    pub(super) role: TimeRole,
    /// Model response, or the reason for its absence; `None` while it is being computed.
    pub(super) result: Option<&'a Result<Arc<Validation>, SimulationFailure>>,
}

impl Simulated<'_> {
    /// Returns the response; `None` until it is computed, or if the simulation failed.
    fn validation(&self) -> Option<&Arc<Validation>> {
        match self.result {
            Some(Ok(validation)) => Some(validation),
            _ => None,
        }
    }

    /// Returns an output's fit \[%\]; `None` if it is not available.
    pub(super) fn fit_percent(&self, output: usize) -> Option<f64> {
        self.validation()?
            .fit_percent
            .get(output)
            .copied()
            .flatten()
    }

    /// Returns an output's Theil coefficient; `None` if it is not available.
    pub(super) fn theil(&self, output: usize) -> Option<f64> {
        self.validation()?.theil.get(output).copied().flatten()
    }

    /// Returns why the simulation failed; `None` if it has not.
    pub(super) fn failure(&self) -> Option<String> {
        match self.result {
            Some(Err(why)) => Some(format!(
                "{} model: {}",
                self.role.name(),
                simulation_failure_text(why)
            )),
            _ => None,
        }
    }

    /// Returns an output's response, a line per window, each from its own initial state; empty
    /// until it is computed.
    pub(super) fn lines(&self, ui: &Ui, output: usize) -> Arc<TimeLines> {
        let Some(validation) = self.validation() else {
            return Arc::default();
        };
        let name = format!("{} {output}", self.role.name());
        // Computed again only when `validation` is another one, compared by address.
        let source = Arc::clone(validation) as _;
        cached(ui, &name, &[source], (), || {
            simulated_points(validation, output)
        })
    }
}

/// Returns time \[s\] and simulated output, as a line for each window.
fn simulated_points(validation: &Validation, output: usize) -> TimeLines {
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

/// Model in the displayed condition, with the job that computes its response to the displayed
/// record.
struct ModelJob {
    role: TimeRole,
    job: SimulationJob,
}

/// Returns a job for each model that has a [`state_space`]; none until the displayed record's
/// columns are assigned.
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
    for role in TimeRole::MODELS {
        if let Some(space) = state_space(state, records, role) {
            let job = SimulationJob {
                record: Arc::clone(flight).into(),
                preparation: preparation.clone(),
                model: space,
            };
            jobs.push(ModelJob { role, job });
        }
    }
    jobs
}

/// Returns the jobs that simulate the models' responses to the displayed record.
pub fn simulation_jobs(state: &State) -> Vec<SimulationJob> {
    model_jobs(state)
        .into_iter()
        .map(|model_job| model_job.job)
        .collect()
}

/// Returns the models compared with the displayed record, with their responses as far as computed.
pub(super) fn simulated(state: &State) -> Vec<Simulated<'_>> {
    let mut models = Vec::new();
    for ModelJob { role, job } in model_jobs(state) {
        // Equal jobs have the same record, compared by address, and equal matrices.
        let known = state
            .results
            .simulations
            .iter()
            .find(|(known, _)| *known == job);
        models.push(Simulated {
            role,
            result: known.map(|(_, result)| result),
        });
    }
    models
}

/// Returns a role's model in the displayed condition, in continuous time and without delays:
///
/// | role | model |
/// |---|---|
/// | physics | physics representative, without couplings |
/// | corrected | physics representative with the condition's own correction |
/// | scheduled | physics representative with the schedule at the condition's flight state |
/// | identified | refined identified model |
///
/// Physics models include the physics parameters, if any, as in comparison and correction. Delays
/// in the corrected and scheduled models become Padé approximants.
///
/// Returns `None` if the model is unavailable, is in discrete time, or has delays.
fn state_space(state: &State, records: &ConditionRecords, role: TimeRole) -> Option<StateSpace> {
    let space = match role {
        TimeRole::Physics => physics_representative(state.shown()?)?.clone(),
        TimeRole::Corrected => {
            let shown = state.shown()?;
            corrected_representative(shown, &shown.correction)?
        }
        TimeRole::Scheduled => {
            let schedule = state.analysis()?.schedule.as_ref().ok()?;
            let correction = schedule.at_state(state.condition().flight_state());
            corrected_representative(state.shown()?, &correction)?
        }
        TimeRole::Identified => records.identification()?.refined.state_space()?.clone(),
        TimeRole::Measured => return None,
    };
    if space.timing().is_plain() {
        Some(space)
    } else {
        None
    }
}

/// Returns the physics representative's matrices; `None` if it is a measured response.
fn physics_representative(shown: &ConditionAnalysis) -> Option<&StateSpace> {
    shown
        .representative_model(BundleKind::Physics)
        .state_space()
}

/// Returns the physics representative with the couplings in use and a correction; `None` if it has
/// no matrices, or its delays cannot become states.
fn corrected_representative(
    shown: &ConditionAnalysis,
    correction: &ChannelCorrection,
) -> Option<StateSpace> {
    let physics = physics_representative(shown)?;
    let corrected = shown
        .corrected_model(physics, correction, Pade::default())
        .ok()?;
    Some(corrected.model)
}
