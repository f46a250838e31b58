//! Thread pool for the window's background work. Each kind of job has its own queue (lane); a free
//! thread runs the next job in the most urgent lane that has a waiting job and that the thread may
//! serve. One thread is reserved for the live analysis and one for short jobs, so that long jobs
//! never make them wait for a thread.

use std::num::NonZero;
use std::sync::Arc;
use std::{io, thread};

use super::mailbox::Mailbox;

/// Queue whose jobs run one after the other.
pub(super) trait Lane: Send + Sync {
    /// Starts the next job; returns `false` if no job waits, or if a job from this lane is running.
    fn begin(&self) -> bool;

    /// Runs the started job to its end.
    fn run(&self);
}

/// Lane class by job duration; decides which threads serve it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LaneClass {
    /// The live analysis.
    Live,
    /// Jobs that usually end within a second.
    Short,
    /// Jobs that may take minutes.
    Long,
}

/// Kinds of pool threads, by the lanes that they serve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Server {
    /// Reserved for the live analysis.
    Live,
    /// Reserved for short jobs.
    Short,
    /// Serves every lane except the live analysis.
    Shared,
}

impl Server {
    fn serves(self, class: LaneClass) -> bool {
        match self {
            Self::Live => class == LaneClass::Live,
            Self::Short => class == LaneClass::Short,
            Self::Shared => class != LaneClass::Live,
        }
    }
}

struct PooledLane {
    class: LaneClass,
    lane: Arc<dyn Lane>,
}

/// Lanes in a pool, the most urgent first.
#[derive(Default)]
struct Schedule {
    lanes: Vec<PooledLane>,
    closed: bool,
}

impl Schedule {
    /// Starts the next job in the most urgent waiting lane that `server` serves; returns the lane.
    fn begin_next(&self, server: Server) -> Option<Arc<dyn Lane>> {
        for pooled in &self.lanes {
            if server.serves(pooled.class) && pooled.lane.begin() {
                return Some(Arc::clone(&pooled.lane));
            }
        }
        None
    }
}

/// Wakes the pool's threads.
#[derive(Clone)]
pub(super) struct Waker {
    schedule: Arc<Mailbox<Schedule>>,
}

impl Waker {
    /// Lets the free threads look for waiting jobs. The caller must not hold a lane's lock: a
    /// thread locks the schedule first and then a lane, so there would be a deadlock.
    pub(super) fn wake(&self) {
        self.schedule.change(|_| ());
    }
}

/// Threads for background work. Dropping the pool ends each thread after its running job, without
/// waiting for it.
pub(super) struct JobPool {
    schedule: Arc<Mailbox<Schedule>>,
}

impl JobPool {
    /// Starts a thread for the live analysis, a thread for short jobs, and a thread per processor
    /// core for short and long jobs.
    ///
    /// # Errors
    /// The operating system's reason, if a thread cannot be started.
    pub(super) fn start() -> io::Result<Self> {
        let cores = thread::available_parallelism().map_or(1, NonZero::get);
        Self::with_shared_threads(cores)
    }

    /// Starts a pool with `shared` threads in addition to the two reserved ones: for the live
    /// analysis, and for short jobs.
    pub(super) fn with_shared_threads(shared: usize) -> io::Result<Self> {
        let pool = Self {
            schedule: Arc::default(),
        };
        pool.spawn("live analysis", Server::Live)?;
        pool.spawn("short jobs", Server::Short)?;
        for number in 1..=shared {
            pool.spawn(&format!("jobs {number}"), Server::Shared)?;
        }
        Ok(pool)
    }

    fn spawn(&self, name: &str, server: Server) -> io::Result<()> {
        let schedule = Arc::clone(&self.schedule);
        thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || serve(&schedule, server))?;
        Ok(())
    }

    /// Adds a lane that is less urgent than all lanes before it. Returns the waker, to be called
    /// when a job waits in the lane.
    pub(super) fn add_lane(&self, class: LaneClass, lane: Arc<dyn Lane>) -> Waker {
        let pooled = PooledLane { class, lane };
        self.schedule.change(|schedule| schedule.lanes.push(pooled));
        Waker {
            schedule: Arc::clone(&self.schedule),
        }
    }
}

impl Drop for JobPool {
    fn drop(&mut self) {
        self.schedule.change(|schedule| {
            schedule.closed = true;
            schedule.lanes.clear();
        });
    }
}

/// Runs jobs until the pool is dropped.
fn serve(schedule: &Mailbox<Schedule>, server: Server) {
    while let Some(lane) = next_lane(schedule, server) {
        lane.run();
        // Wake the other threads: the lane may have another job.
        schedule.change(|_| ());
    }
}

/// Waits for a job to start; returns its lane, or `None` once the pool is dropped.
fn next_lane(schedule: &Mailbox<Schedule>, server: Server) -> Option<Arc<dyn Lane>> {
    schedule.wait(|schedule| {
        if schedule.closed {
            return Some(None);
        }
        let lane = schedule.begin_next(server)?;
        Some(Some(lane))
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
    use std::time::Duration;

    use super::*;

    /// Timeout in tests, far longer than the slowest machine needs: only a hang exceeds it.
    const LIMIT: Duration = Duration::from_secs(60);

    /// Lane whose jobs report their start and end when the test releases them.
    struct TestLane {
        name: &'static str,
        waiting: Mutex<usize>,
        is_running: Mutex<bool>,
        started: Sender<&'static str>,
        release: Mutex<Receiver<()>>,
    }

    impl Lane for TestLane {
        fn begin(&self) -> bool {
            let mut waiting = self.waiting.lock().unwrap();
            let mut is_running = self.is_running.lock().unwrap();
            if *waiting == 0 || *is_running {
                return false;
            }
            *waiting -= 1;
            *is_running = true;
            true
        }

        fn run(&self) {
            self.started.send(self.name).unwrap();
            self.release.lock().unwrap().recv_timeout(LIMIT).unwrap();
            *self.is_running.lock().unwrap() = false;
        }
    }

    /// Lane in a pool, with the channel that ends its running job.
    struct Handle {
        lane: Arc<TestLane>,
        waker: Waker,
        release: Sender<()>,
    }

    impl Handle {
        fn add_jobs(&self, count: usize) {
            *self.lane.waiting.lock().unwrap() += count;
            self.waker.wake();
        }

        fn end_job(&self) {
            self.release.send(()).unwrap();
        }
    }

    struct TestPool {
        pool: JobPool,
        sender: Sender<&'static str>,
        started: Receiver<&'static str>,
    }

    impl TestPool {
        fn with_shared_threads(shared: usize) -> Self {
            let (sender, started) = channel();
            Self {
                pool: JobPool::with_shared_threads(shared).unwrap(),
                sender,
                started,
            }
        }

        fn add_lane(&self, name: &'static str, class: LaneClass) -> Handle {
            let (release, released) = channel();
            let lane = Arc::new(TestLane {
                name,
                waiting: Mutex::new(0),
                is_running: Mutex::new(false),
                started: self.sender.clone(),
                release: Mutex::new(released),
            });
            let waker = self
                .pool
                .add_lane(class, Arc::clone(&lane) as Arc<dyn Lane>);
            Handle {
                lane,
                waker,
                release,
            }
        }

        fn next_start(&self) -> &'static str {
            self.started.recv_timeout(LIMIT).unwrap()
        }
    }

    #[test]
    fn a_free_thread_takes_the_most_urgent_waiting_lane() {
        let pool = TestPool::with_shared_threads(1);
        let running = pool.add_lane("running", LaneClass::Long);
        let urgent = pool.add_lane("urgent", LaneClass::Long);
        let later = pool.add_lane("later", LaneClass::Long);
        running.add_jobs(1);
        assert_eq!(pool.next_start(), "running");
        later.add_jobs(1);
        urgent.add_jobs(1);
        running.end_job();
        assert_eq!(pool.next_start(), "urgent");
        urgent.end_job();
        assert_eq!(pool.next_start(), "later");
        later.end_job();
    }

    #[test]
    fn long_jobs_leave_the_threads_of_the_live_answer_and_of_short_jobs_free() {
        let pool = TestPool::with_shared_threads(2);
        let answer = pool.add_lane("answer", LaneClass::Live);
        let curves = pool.add_lane("curves", LaneClass::Short);
        let lanes = ["report", "error bars", "identification"]
            .map(|name| pool.add_lane(name, LaneClass::Long));
        for lane in &lanes {
            lane.add_jobs(1);
        }
        let mut started = [pool.next_start(), pool.next_start()];
        started.sort_unstable();
        assert_eq!(started, ["error bars", "report"]);
        answer.add_jobs(1);
        assert_eq!(pool.next_start(), "answer");
        curves.add_jobs(1);
        assert_eq!(pool.next_start(), "curves");
        // The reserved threads, free again, do not take the third long job.
        answer.end_job();
        curves.end_job();
        answer.add_jobs(1);
        curves.add_jobs(1);
        let mut started = [pool.next_start(), pool.next_start()];
        started.sort_unstable();
        assert_eq!(started, ["answer", "curves"]);
        lanes[0].end_job();
        assert_eq!(pool.next_start(), "identification");
        for handle in [&answer, &curves, &lanes[1], &lanes[2]] {
            handle.end_job();
        }
    }

    #[test]
    fn shared_threads_serve_short_lanes_and_never_the_live_answer() {
        let pool = TestPool::with_shared_threads(1);
        let curves = pool.add_lane("curves", LaneClass::Short);
        let modes = pool.add_lane("modes", LaneClass::Short);
        let answer = pool.add_lane("answer", LaneClass::Live);
        let other_answer = pool.add_lane("other answer", LaneClass::Live);
        curves.add_jobs(1);
        assert_eq!(pool.next_start(), "curves");
        modes.add_jobs(1);
        assert_eq!(pool.next_start(), "modes");
        answer.add_jobs(1);
        assert_eq!(pool.next_start(), "answer");
        other_answer.add_jobs(1);
        let schedule = pool.pool.schedule.lock();
        assert!(schedule.begin_next(Server::Short).is_none());
        assert!(schedule.begin_next(Server::Shared).is_none());
        drop(schedule);
        answer.end_job();
        assert_eq!(pool.next_start(), "other answer");
        for handle in [curves, modes, other_answer] {
            handle.end_job();
        }
    }

    #[test]
    fn the_jobs_of_a_lane_run_one_after_the_other() {
        let pool = TestPool::with_shared_threads(2);
        let first = pool.add_lane("first", LaneClass::Long);
        let second = pool.add_lane("second", LaneClass::Long);
        first.add_jobs(2);
        assert_eq!(pool.next_start(), "first");
        // The other thread skips the lane in which a job is running.
        second.add_jobs(1);
        assert_eq!(pool.next_start(), "second");
        assert_eq!(*first.lane.waiting.lock().unwrap(), 1);
        first.end_job();
        assert_eq!(pool.next_start(), "first");
        first.end_job();
        second.end_job();
    }

    #[test]
    fn a_dropped_pool_starts_no_job_and_its_threads_end() {
        let pool = TestPool::with_shared_threads(1);
        let Handle { lane, release, .. } = pool.add_lane("lane", LaneClass::Long);
        *lane.waiting.lock().unwrap() = 2;
        pool.pool.schedule.change(|_| ());
        assert_eq!(pool.next_start(), "lane");
        let TestPool {
            pool,
            sender,
            started,
        } = pool;
        drop((pool, lane, sender));
        release.send(()).unwrap();
        // The channel is closed when the thread drops the lane.
        assert_eq!(
            started.recv_timeout(LIMIT),
            Err(RecvTimeoutError::Disconnected)
        );
    }
}
