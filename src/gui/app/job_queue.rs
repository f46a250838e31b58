//! Queue for a kind of job: a lane in the job pool, whose jobs run in sequence. Jobs that compare
//! equal are treated as the same job; this is how running, finished and stopped jobs are
//! recognised.
//!
//! The window requests the jobs that it needs now after each frame ([`JobQueue::want`]). A free
//! pool thread takes the first unfinished job ([`Lane::begin`]), runs it and delivers its ending
//! ([`Lane::run`]). A running job that is no longer requested is cancelled, unless it serves a
//! requested one ([`Job::serves`]).

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::jobs::job::Job;

use super::faults::{Fault, caught};
use super::job_pool::{JobPool, Lane, LaneClass, Waker};
use crate::gui::state::background::Steps;

/// A job's output, or the fault that ended it; a cancelled job has no ending.
pub(super) type Ending<J> = Result<<J as Job>::Output, Fault>;

/// Age up to which a job continues although it is no longer requested: during a drag, every output
/// is worth showing.
const CANCEL_GRACE: Duration = Duration::from_millis(60);

/// Progress of a running job, and whether it should continue.
#[derive(Debug)]
struct Run {
    started: Instant,
    /// Whether the job is no longer requested, and serves no requested job.
    outdated: AtomicBool,
    /// Whether the job was stopped by hand, or its queue was dropped.
    stopped: AtomicBool,
    /// Completed steps.
    done: AtomicUsize,
    /// All steps; 0 until the job reports them.
    total: AtomicUsize,
}

impl Run {
    fn start() -> Self {
        Self {
            started: Instant::now(),
            outdated: AtomicBool::new(false),
            stopped: AtomicBool::new(false),
            done: AtomicUsize::new(0),
            total: AtomicUsize::new(0),
        }
    }

    fn steps(&self) -> Steps {
        Steps {
            done: self.done.load(Ordering::Relaxed),
            total: self.total.load(Ordering::Relaxed),
        }
    }
}

impl Progress for Run {
    fn cancelled(&self) -> bool {
        let outdated =
            self.outdated.load(Ordering::Acquire) && self.started.elapsed() > CANCEL_GRACE;
        outdated || self.stopped.load(Ordering::Acquire)
    }

    fn advanced(&self, done: usize, total: usize) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }
}

#[derive(Clone)]
struct Running<J> {
    job: J,
    run: Arc<Run>,
}

/// Requested jobs and their states:
///
/// ```text
/// waiting → running → done         until it is no longer requested
///                   → stopped      by hand or by a fault; `resume` makes it wait again
///                   → cancelled    no longer requested; nothing is kept
/// ```
struct Orders<J> {
    /// Requested jobs, the most urgent first.
    wanted: Vec<J>,
    running: Option<Running<J>>,
    /// Whether a thread is running a job or delivering its ending.
    is_served: bool,
    /// Requested jobs that are complete.
    done: Vec<J>,
    /// Requested jobs that were stopped, by hand or by a fault.
    stopped: Vec<J>,
    /// Whether the queue was dropped: no further job starts.
    closed: bool,
}

impl<J: Job> Orders<J> {
    fn new() -> Self {
        Self {
            wanted: Vec::new(),
            running: None,
            is_served: false,
            done: Vec::new(),
            stopped: Vec::new(),
            closed: false,
        }
    }

    fn unfinished(&self) -> impl Iterator<Item = &J> {
        self.wanted
            .iter()
            .filter(|job| !self.done.contains(job) && !self.stopped.contains(job))
    }

    /// Returns the job to start next; `None` until the previous job's ending is delivered.
    fn next_job(&self) -> Option<&J> {
        if self.closed || self.is_served {
            return None;
        }
        self.unfinished().next()
    }

    fn stop_running(&self) {
        if let Some(running) = &self.running {
            running.run.stopped.store(true, Ordering::Release);
        }
    }
}

/// Requests, tools and delivery function for a kind of job.
struct JobLane<J: Job> {
    orders: Mutex<Orders<J>>,
    /// Tools kept between jobs; `None` before the first job, while a job runs, and after a fault.
    tools: Mutex<Option<J::Tools>>,
    make_tools: Box<dyn Fn() -> J::Tools + Send + Sync>,
    deliver: Box<dyn Fn(J, Ending<J>) + Send + Sync>,
}

impl<J: Job> JobLane<J> {
    fn orders(&self) -> MutexGuard<'_, Orders<J>> {
        // Ignore a poisoned lock: the orders are consistent even after a panic.
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn kept_tools(&self) -> MutexGuard<'_, Option<J::Tools>> {
        // Ignore a poisoned lock: the tools are only taken out and put back as a whole.
        self.tools.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs a started job with the kept tools, or with new ones. After a fault, which may leave
    /// them inconsistent, the tools are dropped.
    fn run_job(&self, running: &Running<J>) -> Result<Result<J::Output, Cancelled>, Fault> {
        let mut tools = self.kept_tools().take();
        let outcome = caught(|| {
            let tools = tools.get_or_insert_with(&self.make_tools);
            running.job.run(tools, running.run.as_ref())
        })?;
        *self.kept_tools() = tools;
        Ok(outcome)
    }

    /// Records that the running job has ended; if it is still requested, it is complete, stopped by
    /// a fault, or, after a cancellation, waiting again or stopped.
    fn finish(&self, job: &J, ending: Option<&Ending<J>>) {
        let mut orders = self.orders();
        orders.running = None;
        if !orders.wanted.contains(job) {
            return;
        }
        match ending {
            Some(Ok(_)) => orders.done.push(job.clone()),
            Some(Err(_)) => orders.stopped.push(job.clone()),
            None => {}
        }
    }
}

impl<J: Job> Lane for JobLane<J>
where
    J::Tools: Send,
{
    fn begin(&self) -> bool {
        let mut orders = self.orders();
        let Some(job) = orders.next_job().cloned() else {
            return false;
        };
        let run = Arc::new(Run::start());
        orders.running = Some(Running { job, run });
        orders.is_served = true;
        true
    }

    fn run(&self) {
        let Some(running) = self.orders().running.clone() else {
            return;
        };
        let ending = match self.run_job(&running) {
            Ok(Ok(output)) => Some(Ok(output)),
            Ok(Err(Cancelled)) => None,
            Err(fault) => Some(Err(fault)),
        };
        self.finish(&running.job, ending.as_ref());
        if let Some(ending) = ending {
            (self.deliver)(running.job, ending);
        }
        self.orders().is_served = false;
    }
}

/// Queue for a kind of job. Dropping it cancels the running job without waiting.
pub(super) struct JobQueue<J: Job> {
    lane: Arc<JobLane<J>>,
    waker: Waker,
}

impl<J: Job> JobQueue<J> {
    /// Adds a lane to the pool, less urgent than the lanes before it. Each job's ending is passed
    /// to `deliver`. `make_tools` is called again after a fault.
    pub(super) fn open(
        pool: &JobPool,
        class: LaneClass,
        make_tools: impl Fn() -> J::Tools + Send + Sync + 'static,
        deliver: impl Fn(J, Ending<J>) + Send + Sync + 'static,
    ) -> Self
    where
        J::Tools: Send,
    {
        let lane = Arc::new(JobLane {
            orders: Mutex::new(Orders::new()),
            tools: Mutex::new(None),
            make_tools: Box::new(make_tools),
            deliver: Box::new(deliver),
        });
        let pooled: Arc<dyn Lane> = Arc::clone(&lane) as Arc<dyn Lane>;
        let waker = pool.add_lane(class, pooled);
        Self { lane, waker }
    }

    /// Changes the orders, and wakes the pool if a job is waiting afterwards.
    fn change_orders(&self, change: impl FnOnce(&mut Orders<J>)) {
        let mut orders = self.lane.orders();
        change(&mut orders);
        let is_waiting = orders.next_job().is_some();
        drop(orders);
        if is_waiting {
            self.waker.wake();
        }
    }

    /// Requests exactly these jobs, the most urgent first. A running job continues if it is among
    /// them, or serves one of them. A completed or stopped job does not start again as long as it
    /// remains requested.
    pub(super) fn want(&self, jobs: Vec<J>) {
        self.change_orders(|orders| {
            orders.done.retain(|job| jobs.contains(job));
            orders.stopped.retain(|job| jobs.contains(job));
            if let Some(Running { job, run }) = &orders.running {
                let steps = run.steps();
                let is_wanted = jobs
                    .iter()
                    .any(|wanted| wanted == job || job.serves(wanted, steps.done, steps.total));
                run.outdated.store(!is_wanted, Ordering::Release);
            }
            orders.wanted = jobs;
        });
    }

    /// Returns the requested jobs that are neither complete nor stopped.
    pub(super) fn unfinished(&self) -> Vec<J> {
        self.lane.orders().unfinished().cloned().collect()
    }

    /// Cancels the running job and the waiting ones.
    pub(super) fn stop(&self) {
        self.change_orders(|orders| {
            let unfinished: Vec<J> = orders.unfinished().cloned().collect();
            orders.stop_running();
            orders.stopped.extend(unfinished);
        });
    }

    /// Allows stopped jobs to start again.
    pub(super) fn resume(&self) {
        self.change_orders(|orders| orders.stopped.clear());
    }

    /// Returns whether a requested job was stopped, by hand or by a fault.
    pub(super) fn is_stopped(&self) -> bool {
        !self.lane.orders().stopped.is_empty()
    }

    /// Returns the running job's steps, or none so far if jobs only wait; `None` if no requested
    /// job is unfinished.
    pub(super) fn progress(&self) -> Option<Steps> {
        let orders = self.lane.orders();
        orders.unfinished().next()?;
        let steps = match &orders.running {
            Some(running) => running.run.steps(),
            None => Steps::default(),
        };
        Some(steps)
    }
}

impl<J: Job> Drop for JobQueue<J> {
    fn drop(&mut self) {
        self.change_orders(|orders| {
            orders.closed = true;
            orders.stop_running();
        });
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};

    use super::*;

    /// Timeout in tests, far longer than the slowest machine needs: only a hang exceeds it.
    const LIMIT: Duration = Duration::from_secs(60);

    #[derive(Clone, Copy, PartialEq, Eq)]
    enum Course {
        /// Ends at once.
        Short,
        /// Ends when the test releases it, or when cancelled.
        Long,
        Panic,
    }

    /// Test job that reports its start.
    #[derive(Clone)]
    struct TestJob {
        name: &'static str,
        course: Course,
        events: Sender<String>,
        release: Arc<Mutex<Receiver<()>>>,
    }

    impl PartialEq for TestJob {
        fn eq(&self, other: &Self) -> bool {
            self.name == other.name
        }
    }

    impl TestJob {
        fn report(&self, event: &str) {
            // Ignore a failure: a job may outlive its test.
            let _ = self.events.send(format!("{event} {}", self.name));
        }

        fn wait_for_release(&self, progress: &dyn Progress) -> Result<(), Cancelled> {
            let release = self.release.lock().unwrap();
            while !progress.cancelled() {
                match release.recv_timeout(Duration::from_millis(1)) {
                    Ok(()) => return Ok(()),
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => std::thread::yield_now(),
                }
            }
            self.report("cancelled");
            Err(Cancelled)
        }
    }

    impl Job for TestJob {
        type Tools = usize;
        /// Number of jobs that these tools have run.
        type Output = usize;

        fn run(&self, tools: &mut usize, progress: &dyn Progress) -> Result<usize, Cancelled> {
            *tools += 1;
            self.report("begun");
            match self.course {
                Course::Short => {}
                Course::Long => self.wait_for_release(progress)?,
                Course::Panic => panic!("{} job", self.name),
            }
            Ok(*tools)
        }
    }

    /// Queue in a test, with the events of its jobs.
    struct TestQueue {
        queue: JobQueue<TestJob>,
        events: Receiver<String>,
        sender: Sender<String>,
        release: Sender<()>,
        released: Arc<Mutex<Receiver<()>>>,
    }

    impl TestQueue {
        fn open(pool: &JobPool) -> Self {
            let (sender, events) = channel();
            let (release, released) = channel();
            let endings = sender.clone();
            let deliver = move |job: TestJob, ending: Ending<TestJob>| {
                let event = match ending {
                    Ok(tools) => format!("ended {} ({tools})", job.name),
                    Err(fault) => format!("fault {}", fault.message),
                };
                let _ = endings.send(event);
            };
            Self {
                queue: JobQueue::open(pool, LaneClass::Long, || 0, deliver),
                events,
                sender,
                release,
                released: Arc::new(Mutex::new(released)),
            }
        }

        fn job(&self, name: &'static str, course: Course) -> TestJob {
            TestJob {
                name,
                course,
                events: self.sender.clone(),
                release: Arc::clone(&self.released),
            }
        }

        fn short(&self) -> TestJob {
            self.job("short", Course::Short)
        }

        fn long(&self) -> TestJob {
            self.job("long", Course::Long)
        }

        fn next_event(&self) -> String {
            self.events.recv_timeout(LIMIT).unwrap()
        }

        fn assert_events(&self, expected: &[&str]) {
            for event in expected {
                assert_eq!(self.next_event(), *event);
            }
        }

        /// Waits until the last job's ending is delivered.
        fn wait_until_idle(&self) {
            while self.queue.lane.orders().is_served {
                std::thread::yield_now();
            }
        }
    }

    /// Starts a pool with a single thread for long jobs: a fault that ends this thread makes the
    /// test fail.
    fn pool() -> JobPool {
        JobPool::with_shared_threads(1).unwrap()
    }

    #[test]
    fn a_running_job_continues_while_it_is_requested() {
        let pool = pool();
        let test = TestQueue::open(&pool);
        test.queue.want(vec![test.long()]);
        test.assert_events(&["begun long"]);
        test.queue.want(vec![test.short(), test.long()]);
        let running = test.queue.lane.orders().running.clone().unwrap();
        assert!(!running.run.outdated.load(Ordering::Acquire));
        test.release.send(()).unwrap();
        test.assert_events(&["ended long (1)", "begun short", "ended short (2)"]);
    }

    #[test]
    fn a_running_job_that_is_no_longer_requested_is_cancelled() {
        let pool = pool();
        let test = TestQueue::open(&pool);
        test.queue.want(vec![test.long()]);
        test.assert_events(&["begun long"]);
        test.queue.want(vec![test.short()]);
        test.assert_events(&["cancelled long", "begun short", "ended short (2)"]);
    }

    #[test]
    fn a_complete_job_starts_again_only_after_a_request_without_it() {
        let pool = pool();
        let test = TestQueue::open(&pool);
        test.queue.want(vec![test.short()]);
        test.assert_events(&["begun short", "ended short (1)"]);
        let other = test.job("other", Course::Short);
        test.queue.want(vec![test.short(), other]);
        test.assert_events(&["begun other", "ended other (2)"]);
        assert!(test.queue.unfinished().is_empty());
        test.queue.want(Vec::new());
        test.queue.want(vec![test.short()]);
        test.assert_events(&["begun short"]);
    }

    #[test]
    fn a_stopped_job_starts_again_only_when_it_is_resumed() {
        let pool = pool();
        let test = TestQueue::open(&pool);
        test.queue.want(vec![test.long(), test.short()]);
        test.assert_events(&["begun long"]);
        test.queue.stop();
        assert!(test.queue.is_stopped());
        test.assert_events(&["cancelled long"]);
        test.queue.want(vec![test.long(), test.short()]);
        test.wait_until_idle();
        assert!(test.queue.lane.orders().next_job().is_none());
        test.queue.resume();
        test.assert_events(&["begun long"]);
    }

    #[test]
    fn a_request_without_a_stopped_job_forgets_the_stop_in_this_queue_alone() {
        let pool = pool();
        let test = TestQueue::open(&pool);
        let other = TestQueue::open(&pool);
        for stopped in [&test, &other] {
            stopped.queue.want(vec![stopped.long()]);
            stopped.assert_events(&["begun long"]);
            stopped.queue.stop();
            stopped.assert_events(&["cancelled long"]);
        }
        test.queue.want(Vec::new());
        test.queue.want(vec![test.long()]);
        other.queue.want(vec![other.long()]);
        test.assert_events(&["begun long"]);
        assert!(test.queue.progress().is_some());
        assert!(other.queue.is_stopped());
        assert!(other.queue.progress().is_none());
    }

    #[test]
    fn after_a_panic_the_next_job_runs_with_new_tools() {
        let pool = pool();
        let test = TestQueue::open(&pool);
        let broken = test.job("broken", Course::Panic);
        let other = test.job("other", Course::Short);
        test.queue.want(vec![test.short(), broken, other]);
        test.assert_events(&[
            "begun short",
            "ended short (1)",
            "begun broken",
            "fault broken job",
            "begun other",
            "ended other (1)",
        ]);
        assert!(test.queue.is_stopped());
    }

    #[test]
    fn dropping_the_queue_cancels_its_job_without_waiting() {
        let pool = pool();
        let test = TestQueue::open(&pool);
        test.queue.want(vec![test.long()]);
        test.assert_events(&["begun long"]);
        drop(test.queue);
        let event = test.events.recv_timeout(LIMIT).unwrap();
        assert_eq!(event, "cancelled long");
    }
}
