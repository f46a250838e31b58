//! All processor cores as an executor: what the window and the commands compute with.

use std::sync::OnceLock;

use gdcm_model::executor::{Executor, Task};

/// The threads of the global pool: one for each core.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Executor for Pool {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        // First come, first served: what was asked for first is done first.
        rayon::scope_fifo(|scope| {
            tasks
                .into_iter()
                .for_each(|task| scope.spawn_fifo(move |_| task()))
        });
    }
}

/// Starts the threads of the pool, once a process; where none is to be had, says why.
pub fn start_threads() -> Result<(), String> {
    static STARTED: OnceLock<Result<(), String>> = OnceLock::new();
    let start = || {
        rayon::ThreadPoolBuilder::new()
            .build_global()
            .map_err(|error| error.to_string())
    };
    STARTED.get_or_init(start).clone()
}
