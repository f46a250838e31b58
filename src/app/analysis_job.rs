//! The live answer: what the study and the condition shown need, as a job.

use std::sync::Arc;
use std::time::Instant;

use gdcm_core::correction::{Problem, Solution};
use gdcm_core::dataset::ConditionId;
use gdcm_core::study::{
    Analysis, Cancelled, ConditionAnalysis, ConditionFailure, Engine, Job, Progress, Study, WantedFirst,
};

use super::ReplySender;
use crate::view::FirstResult;

/// A problem and the gains that another job has proven to be its best.
pub(super) type Proof = (Arc<Problem>, Arc<Solution>);

/// What is to be computed. All of it is shared, so that a request costs next to nothing.
#[derive(Clone)]
pub(super) struct AnalysisJob {
    /// Counts the jobs: a proof that comes later makes another one of the same request.
    pub(super) number: u64,
    /// Number of the request; the newest has the greatest.
    pub(super) generation: u64,
    /// The study to analyse.
    pub(super) study: Study,
    /// The condition shown, whose result and curves are wanted first.
    pub(super) condition: ConditionId,
    /// What was proven since the last answer.
    pub(super) proofs: Vec<Proof>,
    /// Where the result of the condition shown goes, ahead of the others.
    pub(super) replies: ReplySender,
}

impl PartialEq for AnalysisJob {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Job for AnalysisJob {
    type Tools = Engine;
    /// The analysis, and the time that it took \[ms\].
    type Output = (Arc<Analysis>, f64);

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let started = Instant::now();
        self.proofs.iter().for_each(|(problem, solution)| engine.take_gains(problem, solution));
        let tell = |outcome: &Result<ConditionAnalysis, ConditionFailure>| {
            let (dataset, condition) = (Arc::clone(&self.study.dataset), self.condition);
            let first = FirstResult { generation: self.generation, dataset, condition, outcome: outcome.clone() };
            self.replies.send(move |app| app.state.results.first = Some(first));
        };
        let first = WantedFirst { condition: self.condition, tell: &tell };
        let analysis = engine.analyze_first(&self.study, Some(first), progress)?;
        Ok((Arc::new(analysis), 1e3 * started.elapsed().as_secs_f64()))
    }

    /// During a steady drag every answer is worth having: without that only the condition shown would keep up with the hand. So is one
    /// whose responses and distances are being computed, where the newer job needs the same.
    fn serves(&self, newer: &Self, done: usize, total: usize) -> bool {
        // The last step of each condition is its optimum, which depends on more.
        let is_compared = total > 0 && done + self.study.dataset.conditions().len() >= total;
        let compared = |job: &Self| (job.condition, job.study.settings.band, job.study.settings.points);
        let same_models = Arc::ptr_eq(&self.study.dataset, &newer.study.dataset);
        self.generation == newer.generation || !is_compared && same_models && compared(self) == compared(newer)
    }
}
