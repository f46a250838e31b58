//! All processor cores as an executor for the window and the commands.

use std::sync::OnceLock;

use gdcm_model::executor::{Executor, Task};

/// Threads of the global pool, one for each core.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Executor for Pool {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        // First in, first out: earlier requests are computed first.
        rayon::scope_fifo(|scope| {
            tasks
                .into_iter()
                .for_each(|task| scope.spawn_fifo(move |_| task()))
        });
    }
}

/// Starts the threads of the pool, once per process.
///
/// # Errors
/// The reason, if no thread can be started.
pub fn start_threads() -> Result<(), String> {
    static STARTED: OnceLock<Result<(), String>> = OnceLock::new();
    let start = || {
        rayon::ThreadPoolBuilder::new()
            .build_global()
            .map_err(|error| error.to_string())
    };
    STARTED.get_or_init(start).clone()
}
