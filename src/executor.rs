//! All processor cores as an executor: what the window and the commands compute with.

use gdcm_core::executor::{Executor, Task};

/// The threads of the global pool: one for each core.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Executor for Pool {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        // First come, first served: what was asked for first is done first.
        rayon::scope_fifo(|scope| tasks.into_iter().for_each(|task| scope.spawn_fifo(move |_| task())));
    }
}
