//! The thread that answers what the study and the condition shown need, with a mailbox that keeps only the newest request.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use super::background_jobs::EngineMaker;
use super::job_queue::CANCEL_GRACE;
use super::threads::{Mailbox, ReplySender, caught};
use crate::view::results::FirstResult;
use gdcm_core::correction::{Problem, Solution};
use gdcm_core::dataset::ConditionId;
use gdcm_core::study::{ConditionAnalysis, ConditionFailure, Engine, Progress, Study, WantedFirst};

/// What is to be computed. All of it is shared, so that a request costs next to nothing.
#[derive(Clone, Debug)]
pub(super) struct Request {
    /// Its number; the newest has the greatest.
    pub(super) generation: u64,
    /// The study to analyse.
    pub(super) study: Study,
    /// The condition shown, whose result and curves are wanted first.
    pub(super) condition: ConditionId,
}

impl Request {
    /// Whether it needs the same responses and distances, and the same first.
    fn compares_the_same(&self, other: &Request) -> bool {
        let settings = |request: &Request| (request.study.settings.band, request.study.settings.points);
        let same_models = Arc::ptr_eq(&self.study.dataset, &other.study.dataset);
        same_models && self.condition == other.condition && settings(self) == settings(other)
    }
}

/// What is told with an analysis.
pub(super) struct Answer {
    /// Number of the request.
    pub(super) generation: u64,
    /// Time it took \[ms\].
    pub(super) elapsed_ms: f64,
    /// The problems whose proofs are new in it.
    pub(super) proven: Vec<Arc<Problem>>,
}

/// In place of the newest request's number where nothing is wanted any more.
const NOTHING: u64 = u64::MAX;

/// A proof that a job has completed.
type Proof = (Arc<Problem>, Arc<Solution>);

#[derive(Default)]
struct Orders {
    request: Option<Request>,
    proofs: Vec<Proof>,
    closed: bool,
}

#[derive(Default)]
struct Shared {
    orders: Mailbox<Orders>,
    /// Number of the newest request: work for an older one is given up.
    newest: AtomicU64,
}

impl Shared {
    /// Waits for a request, for proofs or for both; none once the thread is to end.
    fn take(&self) -> Option<(Option<Request>, Vec<Proof>)> {
        self.orders.wait(|orders| {
            let is_empty = orders.request.is_none() && orders.proofs.is_empty();
            match (orders.closed, is_empty) {
                (true, _) => Some(None),
                (false, true) => None,
                (false, false) => Some(Some((orders.request.take(), std::mem::take(&mut orders.proofs)))),
            }
        })
    }
}

/// The thread that answers. Dropping it ends the thread, and waits for nothing.
pub(super) struct AnalysisThread {
    shared: Arc<Shared>,
}

impl AnalysisThread {
    /// Starts the thread.
    pub(super) fn start(make_engine: EngineMaker, replies: ReplySender) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let thread = Answering { shared: Arc::clone(&shared), replies, make_engine };
        std::thread::Builder::new().name("analysis".to_owned()).spawn(move || thread.work())?;
        Ok(Self { shared })
    }

    /// Asks for a computation in place of any that is not done yet.
    pub(super) fn request(&self, request: Request) {
        self.shared.newest.store(request.generation, Ordering::Release);
        self.shared.orders.change(|orders| orders.request = Some(request));
    }

    /// Has the newest request answered once more, with a proof that a job has completed.
    pub(super) fn take_proof(&self, problem: Arc<Problem>, solution: Arc<Solution>) {
        self.shared.orders.change(|orders| orders.proofs.push((problem, solution)));
    }

    /// Gives up the request under way and the one that waits.
    pub(super) fn stop(&self) {
        self.shared.newest.store(NOTHING, Ordering::Release);
        self.shared.orders.change(|orders| orders.request = None);
    }
}

impl Drop for AnalysisThread {
    fn drop(&mut self) {
        self.stop();
        self.shared.orders.change(|orders| orders.closed = true);
    }
}

/// What the thread works with.
struct Answering {
    shared: Arc<Shared>,
    replies: ReplySender,
    make_engine: EngineMaker,
}

impl Answering {
    fn work(&self) {
        let mut engine = None;
        let mut newest: Option<Request> = None;
        let mut proven = Vec::new();
        while let Some((request, proofs)) = self.shared.take() {
            newest = request.or(newest);
            let Some(request) = &newest else { continue };
            let answered = caught(|| {
                let engine = engine.get_or_insert_with(|| (self.make_engine)());
                for (problem, solution) in proofs {
                    engine.take_gains(&problem, &solution);
                    proven.push(problem);
                }
                self.answer(request, engine, &mut proven)
            });
            if let Err(fault) = answered {
                engine = None;
                proven.clear();
                let generation = request.generation;
                self.replies.send(move |app| app.answer_failed(generation, &fault));
            }
        }
    }

    /// Sends the analysis and which proofs it has; nothing where a newer request came first.
    fn answer(&self, request: &Request, engine: &mut Engine, proven: &mut Vec<Arc<Problem>>) {
        let started = Instant::now();
        let progress = RequestProgress { thread: self, request, started, compared: AtomicBool::new(false) };
        let tell = |outcome: &Result<ConditionAnalysis, ConditionFailure>| {
            let (dataset, condition) = (Arc::clone(&request.study.dataset), request.condition);
            let first = FirstResult { generation: request.generation, dataset, condition, outcome: outcome.clone() };
            self.replies.send(move |app| app.state.results.first = Some(first));
        };
        let first = WantedFirst { condition: request.condition, tell: &tell };
        let Ok(analysis) = engine.analyze_first(&request.study, Some(first), &progress) else {
            return;
        };
        let elapsed_ms = 1e3 * started.elapsed().as_secs_f64();
        let answer = Answer { generation: request.generation, elapsed_ms, proven: std::mem::take(proven) };
        self.replies.send(move |app| app.answered(answer, Arc::new(analysis)));
    }
}

struct RequestProgress<'a> {
    thread: &'a Answering,
    request: &'a Request,
    started: Instant,
    /// Whether all responses and distances are there: what is left depends on more than they do.
    compared: AtomicBool,
}

impl RequestProgress<'_> {
    /// Whether the request that waits needs the very responses and distances that are being computed.
    fn is_of_use(&self) -> bool {
        let orders = self.thread.shared.orders.lock();
        !self.compared.load(Ordering::Relaxed)
            && orders.request.as_ref().is_some_and(|newer| newer.compares_the_same(self.request))
    }
}

impl Progress for RequestProgress<'_> {
    /// During a steady drag every answer is worth having: without that only the condition shown would keep up with the hand.
    fn cancelled(&self) -> bool {
        match self.thread.shared.newest.load(Ordering::Acquire) {
            NOTHING => true,
            newest => newest != self.request.generation && self.started.elapsed() > CANCEL_GRACE && !self.is_of_use(),
        }
    }

    fn advanced(&self, done: usize, total: usize) {
        // The last step of each condition is its optimum.
        let compared = done + self.request.study.dataset.conditions().len() >= total;
        self.compared.fetch_or(compared, Ordering::Relaxed);
        if self.started.elapsed() > CANCEL_GRACE {
            let generation = self.request.generation;
            self.thread.replies.send(move |app| {
                let results = &mut app.state.results;
                if generation == results.requested {
                    results.progress = Some((done, total));
                }
            });
        }
    }
}
