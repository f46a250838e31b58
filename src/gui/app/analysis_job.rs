//! Live-analysis job, which starts again after every change to the study or the displayed
//! condition, and after a proof.
//!
//! A *proof* is the solution of a condition's gain problem (M8: docs/method.md), proven optimal by
//! a job of its own. The live analysis has a limited effort for each proof, so it may first show
//! gains that are not yet proven. The *distances* compare the models of a condition with each
//! other.
//!
//! A *request* is a study with a displayed condition. A *job* computes it; when a proof arrives,
//! another job computes the same request again, with this proof.

use std::sync::Arc;
use std::time::Instant;

use gdcm_method::correction::{Problem, Solution};
use gdcm_model::dataset::ConditionId;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::jobs::job::Job;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::stages::engine::WantedFirst;
use gdcm_study::{Analysis, ConditionAnalysis, Engine, Study};

use super::threads::ReplySender;
use crate::gui::state::computed_results::FirstResult;

/// A problem, and its solution proven optimal by another job.
#[derive(Clone)]
pub(super) struct Proof {
    pub(super) problem: Arc<Problem>,
    pub(super) solution: Arc<Solution>,
}

pub(super) struct TimedAnalysis {
    pub(super) analysis: Arc<Analysis>,
    pub(super) elapsed_ms: f64,
}

/// Request for the live analysis of a study. The large parts are shared, so a copy is cheap.
#[derive(Clone)]
pub(super) struct AnalysisJob {
    /// Job number, which increases with each job.
    pub(super) number: u64,
    /// Request number, which increases with each request.
    pub(super) request: u64,
    pub(super) study: Study,
    /// The displayed condition, whose result is computed first.
    pub(super) condition: ConditionId,
    /// Optimality proofs that the displayed analysis does not contain yet.
    pub(super) proofs: Vec<Proof>,
    /// Channel to the window, which receives the displayed condition's result before the others.
    pub(super) replies: ReplySender,
}

impl AnalysisJob {
    /// Returns whether the job has a proof for `problem`, compared by pointer.
    pub(super) fn has_proof_of(&self, problem: &Arc<Problem>) -> bool {
        self.proofs
            .iter()
            .any(|proof| Arc::ptr_eq(problem, &proof.problem))
    }

    /// Sends the displayed condition's result before the whole analysis is complete.
    fn send_first(&self, outcome: &Result<ConditionAnalysis, ConditionFailure>) {
        let first = FirstResult {
            request: self.request,
            dataset: Arc::clone(&self.study.dataset),
            condition: self.condition,
            outcome: outcome.clone(),
        };
        self.replies
            .send(move |app| app.state.results.first = Some(first));
    }

    /// Returns whether both jobs compute the same responses (same dataset, band and frequencies)
    /// and begin with the same condition. Their distances agree too, unless the coherence threshold
    /// differs.
    fn needs_same_responses(&self, other: &Self) -> bool {
        let settings = &self.study.settings;
        let other_settings = &other.study.settings;
        Arc::ptr_eq(&self.study.dataset, &other.study.dataset)
            && self.condition == other.condition
            && settings.band == other_settings.band
            && settings.points == other_settings.points
    }
}

impl PartialEq for AnalysisJob {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Job for AnalysisJob {
    type Tools = Engine;
    type Output = TimedAnalysis;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let started = Instant::now();
        for proof in &self.proofs {
            engine.take_gains(&proof.problem, &proof.solution);
        }
        let first = WantedFirst {
            condition: self.condition,
            tell: &|outcome| self.send_first(outcome),
        };
        let analysis = engine.analyze_first(&self.study, Some(first), progress)?;
        Ok(TimedAnalysis {
            analysis: Arc::new(analysis),
            elapsed_ms: 1e3 * started.elapsed().as_secs_f64(),
        })
    }

    /// Returns whether this job should continue although a newer job waits:
    ///
    /// - always, if both have the same request: only a proof is new
    /// - otherwise, only while it computes responses and distances that the newer job needs too,
    ///   and then finds in the engine's caches
    ///
    /// Without this rule, only the displayed condition would be updated during a steady drag.
    fn serves(&self, newer: &Self, done: usize, total: usize) -> bool {
        if self.request == newer.request {
            return true;
        }
        // The last step in each condition is the optimum, which depends on all settings: once no
        // more steps are left than conditions, responses and distances count as complete.
        let optima = self.study.dataset.conditions().len();
        let has_all_distances = total > 0 && done + optima >= total;
        !has_all_distances && self.needs_same_responses(newer)
    }
}
