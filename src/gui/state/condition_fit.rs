//! Progress of every condition's identification, as the condition list, the page bar and the status
//! bar show it.
//!
//! χ²/dof is the cost of a fit per degree of freedom; it is near 1 if the residual is noise.
//! M-numbers are sections of docs/identification.md.

use gdcm_model::dataset::{ConditionId, Dynamics};
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_sysid::diagnostics::model_cautions::NOT_PREDICTED;
use gdcm_sysid::identification::Identification;

use super::condition_records::ConditionRecords;
use super::records::has_started;
use super::window_state::State;

/// χ²/dof above which a fit is bad (docs/identification.md, M14.4).
pub const BAD_FIT: f64 = 1.5;

/// Numbers of used records in a condition, fitted and held out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordCounts {
    pub fitted: usize,
    /// Records that are not fitted, but test the model.
    pub held_out: usize,
}

/// Stage that a condition's identification has reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitStatus {
    /// Nothing has been identified.
    None,
    Queued,
    /// Running, with the completed share \[%\].
    Running {
        percent: usize,
    },
    Failed,
    /// Records or settings have changed since.
    Outdated,
    /// Finished, with the number of cautions.
    Finished {
        cautions: usize,
    },
}

/// Costs per degree of freedom of the recommended model (the refined one, "CT-PBSID, refined").
/// Every place in the window shows these numbers, so that they agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitCosts {
    pub fitted: f64,
    /// The unchanged model's cost on the held-out records; `None` without such records.
    pub held_out: Option<f64>,
    /// Whether the model does not predict the held-out records (M14.17).
    pub is_held_out_bad: bool,
}

impl FitCosts {
    pub fn new(identification: &Identification) -> Self {
        Self {
            fitted: identification.cost,
            held_out: identification.held_out_cost,
            is_held_out_bad: identification
                .held_out_normalised
                .is_some_and(|cost| cost > NOT_PREDICTED),
        }
    }
}

/// A condition's records and fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConditionFit {
    pub counts: RecordCounts,
    /// Costs in the latest fit, which may be outdated.
    pub costs: Option<FitCosts>,
    pub status: FitStatus,
}

/// Progress while several conditions are identified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatchProgress {
    pub finished: usize,
    pub requested: usize,
    /// Completed share, 0 to 1.
    pub share: f32,
    /// Estimated time until the end \[s\]; `None` until the first condition is finished.
    pub remaining_s: Option<f64>,
}

impl ConditionRecords {
    pub fn counts(&self) -> RecordCounts {
        let mut counts = RecordCounts::default();
        for (_, row) in self.used_rows() {
            if row.guess.held_out {
                counts.held_out += 1;
            } else {
                counts.fitted += 1;
            }
        }
        counts
    }
}

impl State {
    /// Returns a condition's identification band \[rad/s\]: its own band if one is set, otherwise
    /// the study's.
    pub fn identified_band(&self, condition: ConditionId) -> [f64; 2] {
        let records = self.records.conditions.get(&condition);
        if let Some(own) = records.and_then(|records| records.band) {
            return own;
        }
        let band = self.study.settings.band;
        [band.min(), band.max()]
    }

    /// Returns whether a condition's records or settings have changed since its latest
    /// identification; false without one.
    pub fn is_fit_outdated(&self, condition: ConditionId) -> bool {
        let Some(records) = self.records.conditions.get(&condition) else {
            return false;
        };
        let Some(latest) = &records.latest else {
            return false;
        };
        records.changed_since_fit
            || latest.job.request.options.band != self.identified_band(condition)
    }

    /// Returns a condition's records and fit; without loaded records, there are none.
    pub fn condition_fit(&self, condition: ConditionId) -> ConditionFit {
        let mut fit = ConditionFit {
            counts: RecordCounts::default(),
            costs: None,
            status: FitStatus::None,
        };
        let Some(records) = self.records.conditions.get(&condition) else {
            return fit;
        };
        fit.counts = records.counts();
        if let Some(identification) = records.identification() {
            fit.costs = Some(FitCosts::new(identification));
        }
        fit.status = self.fit_status(condition, records);
        fit
    }

    /// Returns the status of a condition's identification: first that of a waiting or running job,
    /// then that of the latest identification, where changed settings come before its outcome.
    fn fit_status(&self, condition: ConditionId, records: &ConditionRecords) -> FitStatus {
        if let Some(job) = self.records.job_of(condition) {
            if !has_started(job) {
                return FitStatus::Queued;
            }
            // One identification runs at a time, so this progress is that of the started job.
            let steps = self.results.background.identification.unwrap_or_default();
            return FitStatus::Running {
                percent: steps.percent(),
            };
        }
        let Some(latest) = &records.latest else {
            return FitStatus::None;
        };
        if self.is_fit_outdated(condition) {
            return FitStatus::Outdated;
        }
        match &latest.outcome {
            Err(_) => FitStatus::Failed,
            Ok(identification) => FitStatus::Finished {
                cautions: identification.cautions.len(),
            },
        }
    }

    /// Returns the conditions that `RecordsCommand::IdentifyAll` identifies, the displayed one
    /// first: those with used records, except where the fit is current or an identification waits
    /// or runs; if none remain, all with used records.
    pub fn conditions_to_identify(&self) -> Vec<ConditionId> {
        let mut in_use = self.records.conditions_in_use();
        let shown = self.condition().id();
        in_use.sort_by_key(|id| *id != shown);
        let mut without_current_fit = in_use.clone();
        without_current_fit.retain(|id| {
            !matches!(
                self.condition_fit(*id).status,
                FitStatus::Finished { .. } | FitStatus::Queued | FitStatus::Running { .. }
            )
        });
        if without_current_fit.is_empty() {
            in_use
        } else {
            without_current_fit
        }
    }

    /// Returns the conditions whose current fit is not in the study; conditions whose
    /// identification waits or runs are omitted.
    pub fn unused_fits(&self) -> Vec<ConditionId> {
        let mut unused = Vec::new();
        for (id, records) in &self.records.conditions {
            let Some(identification) = records.identification() else {
                continue;
            };
            if self.is_fit_outdated(*id) || self.records.job_of(*id).is_some() {
                continue;
            }
            let is_used = self
                .study
                .adopted_models()
                .any(|(adopting, models)| adopting == *id && are_models_of(models, identification));
            if !is_used {
                unused.push(*id);
            }
        }
        unused
    }

    /// Returns how far the requested identifications have come; `None` if none is running.
    ///
    /// ```text
    /// p      completed share of the running identification, 0 to 1
    /// share = (finished + p) / requested
    /// remaining time = mean duration of the conditions' latest identifications · (unfinished − p)
    /// ```
    pub fn batch_progress(&self) -> Option<BatchProgress> {
        let unfinished = self.records.jobs.len();
        if unfinished == 0 {
            return None;
        }
        let requested = self.records.requested_count.max(unfinished);
        let finished = requested - unfinished;
        let steps = self.results.background.identification.unwrap_or_default();
        let running_share = steps.done as f32 / steps.total.max(1) as f32;
        let mut durations_s = Vec::new();
        for records in self.records.conditions.values() {
            if let Some(latest) = &records.latest {
                durations_s.extend(latest.job.news().duration_s);
            }
        }
        let remaining_s = if finished == 0 || durations_s.is_empty() {
            None
        } else {
            let mean_s = durations_s.iter().sum::<f64>() / durations_s.len() as f64;
            Some(mean_s * (unfinished as f64 - f64::from(running_share)))
        };
        Some(BatchProgress {
            finished,
            requested,
            share: (finished as f32 + running_share) / requested as f32,
            remaining_s,
        })
    }
}

/// Returns whether adopted models come from this identification: one of them is its refined or its
/// unrefined model, or its measured response, which the engineer may adopt instead of a model.
fn are_models_of(adopted: &AdoptedModels, identification: &Identification) -> bool {
    for model in &adopted.models {
        if *model == identification.refined || *model == identification.unrefined {
            return true;
        }
        if let Dynamics::Measured(response) = &model.dynamics
            && identification.measured.measured().as_ref() == Some(response)
        {
            return true;
        }
    }
    false
}
