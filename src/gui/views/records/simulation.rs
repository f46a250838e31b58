//! Models compared with a record over time: the jobs that simulate them in the background, and
//! their responses, found again by comparing jobs. The record is divided into windows, and each is
//! simulated from its own initial state.

use std::sync::Arc;

use egui::Ui;

use gdcm_method::correction::Pade;
use gdcm_model::dataset::{BundleKind, StateSpace};
use gdcm_model::simulation::Validation;
use gdcm_study::jobs::identification_jobs::{SimulationFailure, SimulationJob};
use gdcm_words::missing_results::simulation_failure_text;

use super::frame_cache::cached;
use crate::gui::state::records::{ConditionRecords, TimeRole};
use crate::gui::state::window_state::State;

/// Points on a curve over time, as a line for each window.
type Lines = Vec<Arc<[[f64; 2]]>>;

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
    pub(super) fn lines(&self, ui: &Ui, output: usize) -> Arc<Lines> {
        let Some(validation) = self.validation() else {
            return Arc::default();
        };
        let name = format!("{} {output}", self.role.name());
        let source = Arc::clone(validation) as _;
        cached(ui, &name, &[source], (), || {
            simulated_points(validation, output)
        })
    }
}

/// Returns a curve's value at a time \[s\], interpolated linearly; `None` outside its lines.
pub(super) fn value_at(lines: &[Arc<[[f64; 2]]>], time_s: f64) -> Option<f64> {
    for line in lines {
        let after = line.partition_point(|point| point[0] < time_s);
        let Some(next) = line.get(after) else {
            continue;
        };
        if next[0] == time_s {
            return Some(next[1]);
        }
        let Some(before) = after.checked_sub(1).and_then(|before| line.get(before)) else {
            continue;
        };
        let share = (time_s - before[0]) / (next[0] - before[0]);
        return Some(before[1] + share * (next[1] - before[1]));
    }
    None
}

/// Returns time \[s\] and simulated output, as a line for each window.
fn simulated_points(validation: &Validation, output: usize) -> Lines {
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

/// Returns a job for each model that is available as a continuous-time state space without delays;
/// none until the displayed record's columns are assigned.
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

/// Returns the models compared with the displayed record.
pub(super) fn simulated(state: &State) -> Vec<Simulated<'_>> {
    let mut models = Vec::new();
    for ModelJob { role, job } in model_jobs(state) {
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

/// Returns the state space of the identified model, the physics representative, or that with the
/// correction (delays as Padé approximants); `None` if it is unavailable, or a physics model is in
/// discrete time or has delays.
fn state_space(state: &State, records: &ConditionRecords, role: TimeRole) -> Option<StateSpace> {
    if role == TimeRole::Identified {
        return records.identification()?.refined.state_space().cloned();
    }
    let analysis = state.shown()?;
    let name = analysis.representative_name(BundleKind::Physics);
    // These models are changed by the physics parameters, if any, as in comparison and correction.
    let physics = analysis
        .condition
        .model(BundleKind::Physics, name)?
        .state_space()?;
    let correction = match role {
        TimeRole::Corrected => Some(analysis.correction.clone()),
        TimeRole::Scheduled => {
            let schedule = state.analysis()?.schedule.as_ref().ok()?;
            Some(schedule.at_state(state.condition().flight_state()))
        }
        TimeRole::Physics | TimeRole::Identified | TimeRole::Measured => None,
    };
    let space = match correction {
        Some(correction) => {
            analysis
                .corrected_model(physics, &correction, Pade::default())
                .ok()?
                .model
        }
        None => physics.clone(),
    };
    if space.timing().is_plain() {
        Some(space)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_interpolated_within_a_line_and_absent_between_lines() {
        let lines: Lines = vec![
            Arc::from([[0.0, 1.0], [1.0, 3.0]]),
            Arc::from([[4.0, 5.0], [5.0, 7.0]]),
        ];
        let values = [-0.1, 0.0, 0.25, 1.0, 2.0, 4.5, 5.1].map(|time_s| value_at(&lines, time_s));
        assert_eq!(
            values,
            [None, Some(1.0), Some(1.5), Some(3.0), None, Some(6.0), None]
        );
    }
}
