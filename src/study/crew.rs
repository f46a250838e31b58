//! Who carries out independent pieces of work.

/// One piece of work that depends on no other.
pub type Job<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Carries out independent pieces of work, in any order and on as many threads as it has; returns when all are done.
pub trait Crew: Send + Sync {
    /// Carries out `jobs`.
    fn carry_out(&self, jobs: Vec<Job<'_>>);
}

/// One thread: the caller's.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Crew for Alone {
    fn carry_out(&self, jobs: Vec<Job<'_>>) {
        jobs.into_iter().for_each(|job| job());
    }
}
