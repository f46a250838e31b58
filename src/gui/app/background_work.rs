//! The window's background work: requests, and replies from threads. The live analysis is in
//! `live_analysis.rs`, the list of all kinds of jobs in `background_jobs.rs`.

use std::sync::Arc;
use std::sync::mpsc::Receiver;

use gdcm_model::dataset::ConditionId;
use gdcm_study::Study;

use super::GdcmApp;
use super::analysis_job::{AnalysisJob, Proof};
use super::background_jobs::BackgroundJobs;
use super::report_job::ReportJob;
use super::threads::{Reply, ReplySender};
use crate::gui::state::notices::MessageBar;
use crate::gui::views::need::Need;

/// The window's background work, and the requests from which it follows.
pub(super) struct BackgroundWork {
    /// Latest live-analysis job: waiting, running, complete or stopped.
    pub(super) live_job: Option<AnalysisJob>,
    pub(super) jobs: BackgroundJobs,
    /// Proofs that are not yet part of the results; each live analysis receives all of them.
    pub(super) new_proofs: Vec<Proof>,
    /// Jobs needed by the visible views in addition to the live analysis.
    pub(super) needs: Vec<Need>,
    pub(super) newest_request: Option<(Study, ConditionId)>,
    /// Report that waits to be written, or is being written.
    pub(super) report_job: Option<ReportJob>,
    /// Number of reports started so far.
    pub(super) report_number: u64,
    pub(super) replies: ReplySender,
    pub(super) reply_receiver: Receiver<Reply>,
}

impl GdcmApp {
    /// Applies the replies from the threads, and updates the displayed background work.
    pub(super) fn receive_replies(&mut self) {
        while let Ok(reply) = self.work.reply_receiver.try_recv() {
            reply(self);
        }
        let now = self.now();
        let results = &mut self.state.results;
        results.background = self.work.jobs.running_work();
        // The job queue learns only after the next frame that a report is no longer requested.
        if self.work.report_job.is_none() {
            results.background.report = None;
        }
        for proof in &self.work.new_proofs {
            results.background.proofs.push(Arc::clone(&proof.problem));
        }
        if results.background.is_busy() {
            results.background_since.get_or_insert(now);
        } else {
            results.background_since = None;
        }
    }

    /// Requests the analysis again, lets stopped jobs start again, and closes fault messages.
    pub(super) fn compute_again(&mut self) {
        self.work.newest_request = None;
        self.state
            .notices
            .close_bars(|bar| matches!(bar, MessageBar::Fault(_)));
        self.work.jobs.resume();
    }
}
