//! Kind of job: its trigger, its output's destination, and its queue.
//!
//! Most kinds run whenever the display needs their output. A kind with its own *trigger* runs only
//! for a request: the live analysis for a changed study, report and identification for a command.

use gdcm_study::jobs::job::Job;

use super::GdcmApp;
use super::job_pool::{JobPool, LaneClass};
use super::job_queue::{Ending, JobQueue};
use super::threads::ReplySender;
use crate::gui::state::background::Background;

/// Kind of job, described by functions.
pub(super) struct JobKind<J: Job> {
    /// Returns the jobs that the current display needs, the most urgent first. Other jobs of this
    /// kind are cancelled.
    pub(super) wanted: fn(&mut GdcmApp) -> Vec<J>,
    pub(super) store: fn(&mut GdcmApp, J, J::Output),
    /// Adds the unfinished work to the displayed progress.
    pub(super) report: fn(&JobQueue<J>, &mut Background),
    /// For a kind with its own trigger: withdraws the request, or marks it as stopped, after a stop
    /// or a fault. Only the trigger starts such a job again, and it does not count as stopped
    /// background work ([`Background::stopped`]).
    pub(super) withdraw: Option<fn(&mut GdcmApp)>,
    /// Returns whether a view in front has its own *Stop* for this kind; the *Stop* in the status
    /// bar then leaves it running.
    pub(super) has_own_stop: fn(&GdcmApp) -> bool,
}

impl<J: Job> JobKind<J> {
    /// Creates a kind that "Compute" restarts after a stop, and whose jobs count as work for which
    /// views wait.
    pub(super) fn new(
        wanted: fn(&mut GdcmApp) -> Vec<J>,
        store: fn(&mut GdcmApp, J, J::Output),
    ) -> Self {
        Self {
            wanted,
            store,
            report: |queue, background| background.views += queue.unfinished().len(),
            withdraw: None,
            has_own_stop: |_| false,
        }
    }

    /// Replaces the function that reports running work.
    pub(super) fn with_report(mut self, report: fn(&JobQueue<J>, &mut Background)) -> Self {
        self.report = report;
        self
    }

    /// Leaves the kind's work out of the displayed progress.
    pub(super) fn without_report(self) -> Self {
        self.with_report(|_, _| {})
    }

    /// Gives the kind its own trigger, which `withdraw` resets.
    pub(super) fn with_withdrawal(mut self, withdraw: fn(&mut GdcmApp)) -> Self {
        self.withdraw = Some(withdraw);
        self
    }

    /// Gives the kind its own *Stop*, beside its progress in a view.
    pub(super) fn with_own_stop(mut self, has_own_stop: fn(&GdcmApp) -> bool) -> Self {
        self.has_own_stop = has_own_stop;
        self
    }
}

/// Interface common to all kinds of jobs.
pub(super) trait AnyJobKind {
    /// Requests exactly the jobs that the display needs.
    fn want(&self, app: &mut GdcmApp);
    /// Cancels the running job and the waiting ones, and withdraws their request, unless a view in
    /// front has its own *Stop*.
    fn stop(&self, app: &mut GdcmApp);
    /// Allows stopped jobs to start again.
    fn resume(&self);
    /// Adds the unfinished work to `background`, and whether work was stopped.
    fn report(&self, background: &mut Background);
}

struct QueuedKind<J: Job> {
    kind: JobKind<J>,
    queue: JobQueue<J>,
}

impl<J: Job> AnyJobKind for QueuedKind<J> {
    fn want(&self, app: &mut GdcmApp) {
        self.queue.want((self.kind.wanted)(app));
    }

    fn stop(&self, app: &mut GdcmApp) {
        if (self.kind.has_own_stop)(app) {
            return;
        }
        self.queue.stop();
        if let Some(withdraw) = self.kind.withdraw {
            withdraw(app);
        }
    }

    fn resume(&self) {
        self.queue.resume();
    }

    fn report(&self, background: &mut Background) {
        (self.kind.report)(&self.queue, background);
        background.stopped |= self.kind.withdraw.is_none() && self.queue.is_stopped();
    }
}

/// Kinds of jobs in a pool, added in order of urgency.
pub(super) struct JobKinds<'a> {
    pool: &'a JobPool,
    replies: &'a ReplySender,
    kinds: Vec<Box<dyn AnyJobKind>>,
}

impl<'a> JobKinds<'a> {
    pub(super) fn new(pool: &'a JobPool, replies: &'a ReplySender) -> Self {
        Self {
            pool,
            replies,
            kinds: Vec::new(),
        }
    }

    /// Adds a kind that is less urgent than all kinds before it. `make_tools` creates the tools for
    /// its jobs.
    pub(super) fn add<J: Job>(
        &mut self,
        class: LaneClass,
        make_tools: impl Fn() -> J::Tools + Send + Sync + 'static,
        kind: JobKind<J>,
    ) where
        J::Tools: Send,
    {
        let replies = self.replies.clone();
        let JobKind {
            store, withdraw, ..
        } = kind;
        let deliver = move |job: J, ending: Ending<J>| {
            replies.send(move |app| match ending {
                Ok(output) => store(app, job, output),
                Err(fault) => {
                    if let Some(withdraw) = withdraw {
                        withdraw(app);
                    }
                    app.report_fault("the computation", &fault);
                }
            });
        };
        let queue = JobQueue::open(self.pool, class, make_tools, deliver);
        self.kinds.push(Box::new(QueuedKind { kind, queue }));
    }

    pub(super) fn into_kinds(self) -> Vec<Box<dyn AnyJobKind>> {
        self.kinds
    }
}
