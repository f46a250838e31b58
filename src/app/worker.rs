//! The one thread that computes, with a mailbox that keeps only the newest request.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::pool::Pool;
use crate::dataset::ConditionId;
use crate::study::{
    Analysis, ConditionAnalysis, ConditionCurves, ConditionFailure, Engine, Study, Toggles, Watch, display_band,
};
use crate::view::state::FirstResult;

/// Frequencies of the curves that are drawn.
const CURVE_POINTS: usize = 500;

/// What is to be computed. All of it is shared, so that a request costs next to nothing.
#[derive(Clone, Debug)]
pub struct Request {
    /// Its number; the newest has the greatest.
    pub generation: u64,
    /// The study to analyse.
    pub study: Study,
    /// The condition shown, whose curves are wanted.
    pub condition: ConditionId,
}

/// What was computed.
#[derive(Debug)]
pub enum Reply {
    /// How far the analysis is.
    Progress {
        /// Number of the request.
        generation: u64,
        /// Steps done.
        done: usize,
        /// Of how many.
        total: usize,
    },
    /// The result of the condition shown, ahead of the others'.
    First(FirstResult),
    /// The analysis of a request.
    Analysis {
        /// Number of the request.
        generation: u64,
        /// The result.
        analysis: Arc<Analysis>,
        /// Time it took \[ms\].
        elapsed_ms: f64,
    },
    /// What holding or freeing each response of the condition shown would cost.
    Toggles {
        /// Number of the request.
        generation: u64,
        /// The costs.
        toggles: Arc<Toggles>,
    },
    /// Responses of one condition for drawing.
    Curves(Arc<ConditionCurves>),
}

/// In place of the newest request's number where nothing is wanted any more.
const NOTHING: u64 = u64::MAX;

/// Called after each reply: wakes the window.
type Wake = Box<dyn Fn() + Send + Sync>;

#[derive(Default)]
struct Mailbox {
    request: Option<Request>,
    closed: bool,
}

#[derive(Default)]
struct Shared {
    mailbox: Mutex<Mailbox>,
    filled: Condvar,
    /// Number of the newest request: work for an older one is given up.
    newest: AtomicU64,
}

impl Shared {
    fn mailbox(&self) -> MutexGuard<'_, Mailbox> {
        // A panic while the lock was held leaves a mailbox that is still whole.
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the next request; none once the worker is dropped.
    fn take(&self) -> Option<Request> {
        let mut mailbox = self.mailbox();
        loop {
            if mailbox.closed {
                return None;
            }
            if let Some(request) = mailbox.request.take() {
                return Some(request);
            }
            mailbox = self.filled.wait(mailbox).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// The thread that computes. Dropping it ends the thread.
pub struct Worker {
    shared: Arc<Shared>,
    replies: Receiver<Reply>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread; `wake` is called after each reply.
    pub fn start(wake: Wake) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, replies) = channel();
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("analysis".to_owned())
            .spawn(move || Desk { shared: &of_thread, sender: &sender, wake: &wake }.work())?;
        Ok(Self { shared, replies, thread: Some(thread) })
    }

    /// Asks for a computation in place of any that is not done yet.
    pub fn request(&self, request: Request) {
        self.shared.newest.store(request.generation, Ordering::Release);
        self.shared.mailbox().request = Some(request);
        self.shared.filled.notify_one();
    }

    /// Gives up the request under way, and the one that waits.
    pub fn stop(&self) {
        self.shared.newest.store(NOTHING, Ordering::Release);
        self.shared.mailbox().request = None;
    }

    /// The next reply, if one is there.
    pub fn reply(&self) -> Option<Reply> {
        self.replies.try_recv().ok()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.shared.newest.store(NOTHING, Ordering::Release);
        self.shared.mailbox().closed = true;
        self.shared.filled.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been reported by then; there is nothing left to do about it.
            let _ = thread.join();
        }
    }
}

/// What the thread works with.
struct Desk<'a> {
    shared: &'a Shared,
    sender: &'a Sender<Reply>,
    wake: &'a (dyn Fn() + Send + Sync),
}

impl Desk<'_> {
    fn work(&self) {
        let mut engine = Engine::with_crew(Box::new(Pool));
        let mut drawn: Option<Arc<ConditionCurves>> = None;
        while let Some(request) = self.shared.take() {
            self.answer_curves(&request, &mut engine, &mut drawn);
            if let Some(analysis) = self.answer_analysis(&request, &mut engine) {
                self.answer_toggles(&request, &analysis);
            }
        }
    }

    fn answer_curves(&self, request: &Request, engine: &mut Engine, drawn: &mut Option<Arc<ConditionCurves>>) {
        let (dataset, condition) = (&request.study.dataset, request.condition);
        let grid = (display_band(request.study.settings.band), CURVE_POINTS);
        let watch = RequestWatch::new(self, request);
        let Ok(Some(curves)) = engine.curves(dataset, condition, grid, &watch) else {
            return;
        };
        if !drawn.as_ref().is_some_and(|drawn| Arc::ptr_eq(drawn, &curves)) {
            *drawn = Some(Arc::clone(&curves));
            self.send(Reply::Curves(curves));
        }
    }

    /// The analysis, unless a newer request came first: that one waits in the mailbox.
    fn answer_analysis(&self, request: &Request, engine: &mut Engine) -> Option<Arc<Analysis>> {
        let start = Instant::now();
        let watch = RequestWatch::new(self, request);
        let analysis = Arc::new(engine.analyze(&request.study, &watch).ok()?);
        let elapsed_ms = 1e3 * start.elapsed().as_secs_f64();
        let generation = request.generation;
        self.send(Reply::Analysis { generation, analysis: Arc::clone(&analysis), elapsed_ms });
        Some(analysis)
    }

    /// The costs of all single toggles: in the background, given up as soon as a newer request comes.
    fn answer_toggles(&self, request: &Request, analysis: &Analysis) {
        let generation = request.generation;
        let stop = || self.shared.newest.load(Ordering::Acquire) != generation;
        let toggles = analysis.condition(request.condition).and_then(|condition| Toggles::of(condition, &stop));
        if let Some(toggles) = toggles {
            self.send(Reply::Toggles { generation, toggles: Arc::new(toggles) });
        }
    }

    fn send(&self, reply: Reply) {
        // The window is gone when nobody listens; the thread ends with the next take.
        let _ = self.sender.send(reply);
        (self.wake)();
    }
}

/// How long an answer to an older question is still worth having. During a steady drag every answer is: without it only the
/// condition shown would keep up with the hand.
const PATIENCE: Duration = Duration::from_millis(60);

struct RequestWatch<'a, 'd> {
    desk: &'a Desk<'d>,
    request: &'a Request,
    started: Instant,
}

impl<'a, 'd> RequestWatch<'a, 'd> {
    fn new(desk: &'a Desk<'d>, request: &'a Request) -> Self {
        Self { desk, request, started: Instant::now() }
    }
}

impl Watch for RequestWatch<'_, '_> {
    fn stopped(&self) -> bool {
        let newest = self.desk.shared.newest.load(Ordering::Acquire);
        newest == NOTHING || (newest != self.request.generation && self.started.elapsed() > PATIENCE)
    }

    fn progress(&self, done: usize, total: usize) {
        if self.started.elapsed() > PATIENCE {
            self.desk.send(Reply::Progress { generation: self.request.generation, done, total });
        }
    }

    fn wanted_first(&self) -> Option<ConditionId> {
        Some(self.request.condition)
    }

    fn first_result(&self, outcome: &Result<ConditionAnalysis, ConditionFailure>) {
        let (dataset, condition) = (Arc::clone(&self.request.study.dataset), self.request.condition);
        let first = FirstResult { dataset, condition, outcome: outcome.clone() };
        self.desk.send(Reply::First(first));
    }
}
