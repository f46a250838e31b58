//! Live analysis: the results follow every change to the study or the displayed condition.
//!
//! 1. After each frame, `request_results` compares the study and the condition with the newest
//!    request. If they differ, it gives the new request a number (`Results::requested`).
//! 2. `start_live_analysis` makes an [`AnalysisJob`] for the request. `want_jobs`
//!    (`background_jobs.rs`) passes it to its queue, also after each frame.
//! 3. The job sends the displayed condition's result (`Results::first`) before the others.
//! 4. `show_analysis` stores the whole analysis and its request number (`Results::received`), and
//!    requests the jobs that complete it: curves, error bars, proofs.
//! 5. `take_proof` receives a proof that a condition's gains are optimal, and starts the job again,
//!    with the same request number but a new job number.
//!
//! A *settings session* lasts while the settings panel is open; it keeps the settings from its
//! beginning with their analysis, to which changed values are compared.

use std::sync::Arc;

use gdcm_method::correction::Solution;
use gdcm_method::correction::problem::ProblemError;
use gdcm_study::Study;
use gdcm_study::jobs::analysis_jobs::ProofJob;
use gdcm_study::jobs::curve_jobs::CurvesJob;
use gdcm_study::stages::condition_curves::ConditionCurves;

use super::GdcmApp;
use super::analysis_job::{AnalysisJob, Proof, TimedAnalysis};

impl GdcmApp {
    /// Requests the results for the current study and condition, unless they have been requested
    /// already.
    pub(super) fn request_results(&mut self) {
        self.follow_settings_panel();
        let now = self.now();
        let study = &self.state.study;
        let condition = self.state.condition().id();
        if let Some((requested, shown)) = &self.work.newest_request
            && *shown == condition
            && needs_same_results(requested, study)
        {
            return;
        }
        self.work.newest_request = Some((study.clone(), condition));
        let results = &mut self.state.results;
        results.requested += 1;
        results.stopped = false;
        results.waiting_since.get_or_insert(now);
        self.start_live_analysis();
    }

    /// Begins and ends the settings session when the settings panel is opened and closed, by
    /// whichever command.
    fn follow_settings_panel(&mut self) {
        let is_open = self.state.display.layout.settings_open;
        match (is_open, self.state.settings_session.is_some()) {
            (true, false) => self.state.begin_settings_session(),
            (false, true) => self.state.end_settings_session(),
            _ => {}
        }
    }

    /// Starts the live analysis for the latest request, with all available proofs.
    pub(super) fn start_live_analysis(&mut self) {
        let Some((study, condition)) = self.work.newest_request.clone() else {
            return;
        };
        let job_number = match &self.work.live_job {
            Some(job) => job.number + 1,
            None => 0,
        };
        self.work.live_job = Some(AnalysisJob {
            number: job_number,
            request: self.state.results.requested,
            study,
            condition,
            proofs: self.work.new_proofs.clone(),
            replies: self.work.replies.clone(),
        });
    }

    /// Records that the live analysis was stopped, by the user or by a fault; the displayed results
    /// remain, and new proofs are dropped.
    pub(super) fn live_analysis_stopped(&mut self) {
        self.work.new_proofs.clear();
        let results = &mut self.state.results;
        results.stopped = results.is_behind();
        results.waiting_since = None;
    }

    /// Shows an analysis and requests the jobs needed to complete it.
    pub(super) fn show_analysis(&mut self, job: AnalysisJob, timed: TimedAnalysis) {
        let now = self.now();
        let results = &mut self.state.results;
        // A rerun after an optimality proof has the original job's request number; its short
        // computing time must not replace the original one.
        if results.received != job.request {
            results.elapsed_ms = timed.elapsed_ms;
        }
        results.received = job.request;
        results.analysis = Some(Arc::clone(&timed.analysis));
        // The whole analysis includes the result that was shown ahead of it.
        results.first = None;
        if let Some(session) = &mut self.state.settings_session
            && session.analysis.is_none()
            && session.settings == timed.analysis.study.settings
        {
            session.analysis = Some(timed.analysis);
        }
        let results = &mut self.state.results;
        if !results.is_behind() {
            results.stopped = false;
        }
        // A still newer request waits from now on.
        results.waiting_since = if results.is_waiting() {
            Some(now)
        } else {
            None
        };
        self.work
            .new_proofs
            .retain(|proof| !job.has_proof_of(&proof.problem));
        self.want_jobs();
    }

    /// Requests the analysis again with a proof. A problem without a solution needs no new request,
    /// because the live analysis has already reported it.
    pub(super) fn take_proof(&mut self, job: ProofJob, proof: Result<Arc<Solution>, ProblemError>) {
        if let Ok(solution) = proof {
            self.work.new_proofs.push(Proof {
                problem: job.problem,
                solution,
            });
            self.start_live_analysis();
        }
    }

    /// Stores curves if they belong to the displayed condition and dataset.
    pub(super) fn take_curves(&mut self, job: CurvesJob, curves: Option<Arc<ConditionCurves>>) {
        let Some(curves) = curves else { return };
        let study = &self.state.study;
        if Arc::ptr_eq(&job.dataset, &study.dataset) && job.condition == self.state.condition().id()
        {
            self.state.results.curves = Some((job, curves));
        }
    }
}

/// Returns whether two studies need the same results. Datasets are compared by pointer: comparing
/// values would take time in every frame, and results belong to a single dataset even if another is
/// equal.
fn needs_same_results(a: &Study, b: &Study) -> bool {
    Arc::ptr_eq(&a.dataset, &b.dataset) && a.settings == b.settings && a.choices == b.choices
}
