//! Runs the jobs of one kind one after the other, in a thread beside the live answer. Equal jobs
//! are identical: running, finished and stopped jobs are recognised by equality.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::jobs::job::Job;

use super::threads::{Fault, Mailbox, caught};

/// Output of a job, or the fault that ended it; a cancelled job has no ending.
pub(super) type Ending<J> = Result<<J as Job>::Output, Fault>;

/// How long an unwanted job may continue: during a drag, every output is worth showing.
const CANCEL_GRACE: Duration = Duration::from_millis(60);

/// Progress of a job, and whether it is still wanted.
#[derive(Debug)]
struct Run {
    started: Instant,
    outdated: AtomicBool,
    stopped: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
}

impl Run {
    fn start() -> Arc<Self> {
        let (outdated, stopped, done, total) = Default::default();
        Arc::new(Self {
            started: Instant::now(),
            outdated,
            stopped,
            done,
            total,
        })
    }

    /// Returns the number of completed steps and the total.
    fn steps(&self) -> (usize, usize) {
        (
            self.done.load(Ordering::Relaxed),
            self.total.load(Ordering::Relaxed),
        )
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

struct Orders<J> {
    /// Requested jobs, the most urgent first.
    wanted: Vec<J>,
    running: Option<(J, Arc<Run>)>,
    /// Requested jobs that are complete.
    done: Vec<J>,
    /// Requested jobs that were stopped, by hand or by a fault.
    stopped: Vec<J>,
    closed: bool,
}

impl<J: Job> Orders<J> {
    fn unfinished(&self) -> impl Iterator<Item = &J> {
        self.wanted
            .iter()
            .filter(|job| !self.done.contains(job) && !self.stopped.contains(job))
    }

    fn stop_running(&self) {
        if let Some((_, run)) = &self.running {
            run.stopped.store(true, Ordering::Release);
        }
    }
}

/// Waits for a job to start; returns `None` once the queue is dropped.
fn take<J: Job>(orders: &Mailbox<Orders<J>>) -> Option<(J, Arc<Run>)> {
    orders.wait(|orders| {
        if orders.closed {
            return Some(None);
        }
        let job = orders.unfinished().next()?.clone();
        let run = Run::start();
        orders.running = Some((job.clone(), Arc::clone(&run)));
        Some(Some((job, run)))
    })
}

/// Queue for the jobs of one kind. Dropping it cancels the running job without waiting.
pub(super) struct JobQueue<J: Job> {
    orders: Arc<Mailbox<Orders<J>>>,
}

impl<J: Job> JobQueue<J> {
    /// Starts the thread; each job's ending goes to `deliver`. The tools are made anew after a
    /// fault, which may leave them in an inconsistent state.
    pub(super) fn start(
        name: &str,
        tools: impl Fn() -> J::Tools + Send + 'static,
        deliver: impl Fn(J, Ending<J>) + Send + 'static,
    ) -> std::io::Result<Self> {
        let none = Orders {
            wanted: Vec::new(),
            running: None,
            done: Vec::new(),
            stopped: Vec::new(),
            closed: false,
        };
        let orders = Arc::new(Mailbox::new(none));
        let of_thread = Arc::clone(&orders);
        std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || work(&of_thread, &tools, &deliver))?;
        Ok(Self { orders })
    }

    /// Requests exactly these jobs, the most urgent first. A running job continues if it is among
    /// them; a job that is complete or stopped does not start again while it stays requested.
    pub(super) fn want(&self, jobs: Vec<J>) {
        self.orders.change(|orders| {
            orders.done.retain(|job| jobs.contains(job));
            orders.stopped.retain(|job| jobs.contains(job));
            if let Some((job, run)) = &orders.running {
                let (done, total) = run.steps();
                let is_wanted = jobs
                    .iter()
                    .any(|wanted| wanted == job || job.serves(wanted, done, total));
                run.outdated.store(!is_wanted, Ordering::Release);
            }
            orders.wanted = jobs;
        });
    }

    /// Returns the requested jobs that are neither complete nor stopped.
    pub(super) fn unfinished(&self) -> Vec<J> {
        self.orders.lock().unfinished().cloned().collect()
    }

    /// Cancels the running job and the waiting ones.
    pub(super) fn stop(&self) {
        self.orders.change(|orders| {
            let left: Vec<J> = orders.unfinished().cloned().collect();
            orders.stop_running();
            orders.stopped.extend(left);
        });
    }

    /// Allows stopped jobs to start again.
    pub(super) fn resume(&self) {
        self.orders.change(|orders| orders.stopped.clear());
    }

    /// Returns whether a requested job was stopped, by hand or by a fault.
    pub(super) fn is_stopped(&self) -> bool {
        !self.orders.lock().stopped.is_empty()
    }

    /// Returns completed and total steps while a requested job is incomplete.
    pub(super) fn progress(&self) -> Option<(usize, usize)> {
        let orders = self.orders.lock();
        orders.unfinished().next()?;
        Some(
            orders
                .running
                .as_ref()
                .map_or((0, 0), |(_, run)| run.steps()),
        )
    }
}

impl<J: Job> Drop for JobQueue<J> {
    fn drop(&mut self) {
        self.orders.change(|orders| {
            orders.closed = true;
            orders.stop_running();
        });
    }
}

fn work<J: Job>(
    orders: &Mailbox<Orders<J>>,
    make_tools: &dyn Fn() -> J::Tools,
    deliver: &dyn Fn(J, Ending<J>),
) {
    let mut tools = None;
    while let Some((job, run)) = take(orders) {
        let outcome = caught(|| job.run(tools.get_or_insert_with(make_tools), run.as_ref()));
        let ending = match outcome {
            Ok(Err(Cancelled)) => None,
            Ok(Ok(output)) => Some(Ok(output)),
            Err(fault) => {
                tools = None;
                Some(Err(fault))
            }
        };
        let mut orders = orders.lock();
        orders.running = None;
        let Some(ending) = ending else { continue };
        if orders.wanted.contains(&job) {
            let over = if ending.is_ok() {
                &mut orders.done
            } else {
                &mut orders.stopped
            };
            over.push(job.clone());
        }
        drop(orders);
        deliver(job, ending);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;

    /// Far above the time that the slowest machine needs: only a hang reaches it.
    const LIMIT: Duration = Duration::from_secs(60);

    /// Test job that reports its start, then ends at once, ends only when cancelled, or panics.
    #[derive(Clone)]
    struct Spoken(&'static str, Sender<String>);

    impl PartialEq for Spoken {
        fn eq(&self, other: &Self) -> bool {
            self.0 == other.0
        }
    }

    impl Job for Spoken {
        type Tools = usize;
        type Output = usize;

        fn run(&self, tools: &mut usize, progress: &dyn Progress) -> Result<usize, Cancelled> {
            *tools += 1;
            self.1.send(format!("begun {}", self.0)).unwrap();
            assert!(!self.0.starts_with("broken"), "{} job", self.0);
            while self.0.starts_with("long") {
                if progress.cancelled() {
                    self.1.send(format!("cancelled {}", self.0)).unwrap();
                    return Err(Cancelled);
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(*tools)
        }
    }

    fn queue() -> (
        JobQueue<Spoken>,
        impl Fn(&'static str) -> Spoken,
        Receiver<String>,
    ) {
        let (sender, said) = channel();
        let ended = sender.clone();
        let deliver = move |job: Spoken, ending: Ending<Spoken>| {
            let words = match ending {
                Ok(tools) => format!("ended {} ({tools})", job.0),
                Err(fault) => format!("fault {}", fault.message),
            };
            ended.send(words).unwrap();
        };
        (
            JobQueue::start("test", || 0, deliver).unwrap(),
            move |name| Spoken(name, sender.clone()),
            said,
        )
    }

    fn next(said: &Receiver<String>) -> String {
        said.recv_timeout(LIMIT).unwrap()
    }

    #[test]
    fn a_job_that_is_still_asked_for_goes_on_and_one_that_is_not_is_given_up() {
        let (queue, job, said) = queue();
        queue.want(vec![job("long")]);
        assert_eq!(next(&said), "begun long");
        queue.want(vec![job("short"), job("long")]);
        assert!(
            said.recv_timeout(Duration::from_millis(30)).is_err(),
            "the long one goes on, the short one waits"
        );
        queue.want(vec![job("short")]);
        assert_eq!(
            [next(&said), next(&said), next(&said)],
            ["cancelled long", "begun short", "ended short (2)"]
        );
    }

    #[test]
    fn a_job_is_done_once_as_long_as_it_is_asked_for() {
        let (queue, job, said) = queue();
        queue.want(vec![job("short")]);
        assert_eq!(
            [next(&said), next(&said)],
            ["begun short", "ended short (1)"]
        );
        queue.want(vec![job("short"), job("other")]);
        assert_eq!(
            [next(&said), next(&said)],
            ["begun other", "ended other (2)"]
        );
        assert!(queue.unfinished().is_empty());
        queue.want(Vec::new());
        queue.want(vec![job("short")]);
        assert_eq!(next(&said), "begun short", "nobody asked for it in between");
    }

    #[test]
    fn what_was_stopped_is_begun_again_only_when_that_is_said() {
        let (queue, job, said) = queue();
        queue.want(vec![job("long"), job("short")]);
        assert_eq!(next(&said), "begun long");
        queue.stop();
        assert!(queue.is_stopped());
        assert_eq!(next(&said), "cancelled long");
        queue.want(vec![job("long"), job("short")]);
        assert!(said.recv_timeout(Duration::from_millis(30)).is_err());
        queue.resume();
        assert_eq!(next(&said), "begun long");
    }

    #[test]
    fn what_was_stopped_and_asked_for_no_more_is_begun_again_once_it_is_asked_for_and_nothing_else_is()
     {
        let ((queue, job, said), (other, other_job, other_said)) = (queue(), queue());
        queue.want(vec![job("long")]);
        other.want(vec![other_job("long")]);
        assert_eq!(
            [next(&said), next(&other_said)],
            ["begun long", "begun long"]
        );
        [&queue, &other].into_iter().for_each(JobQueue::stop);
        assert_eq!(
            [next(&said), next(&other_said)],
            ["cancelled long", "cancelled long"]
        );
        queue.want(Vec::new());
        queue.want(vec![job("long")]);
        other.want(vec![other_job("long")]);
        assert_eq!(next(&said), "begun long");
        assert!(other.is_stopped() && other.progress().is_none() && queue.progress().is_some());
    }

    #[test]
    fn a_job_that_panics_is_told_its_tools_are_made_anew_and_the_next_is_done() {
        let (queue, job, said) = queue();
        queue.want(vec![job("short"), job("broken"), job("other")]);
        let all: Vec<String> = (0..6).map(|_| next(&said)).collect();
        assert_eq!(
            all,
            [
                "begun short",
                "ended short (1)",
                "begun broken",
                "fault broken job",
                "begun other",
                "ended other (1)"
            ]
        );
    }

    #[test]
    fn dropping_it_gives_up_the_job_and_waits_for_nothing() {
        let (queue, job, said) = queue();
        queue.want(vec![job("long")]);
        assert_eq!(next(&said), "begun long");
        drop(queue);
        assert_eq!(next(&said), "cancelled long");
    }
}
