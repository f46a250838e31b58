//! All processor cores as a crew.

use crate::study::{Crew, Job};

/// The threads of the global pool: one for each core.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Crew for Pool {
    fn carry_out(&self, jobs: Vec<Job<'_>>) {
        // First come, first served: what was asked for first is done first.
        rayon::scope_fifo(|scope| jobs.into_iter().for_each(|job| scope.spawn_fifo(move |_| job())));
    }
}
