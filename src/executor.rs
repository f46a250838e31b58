//! Executor that uses all processor cores, for the window and the commands.

use std::sync::OnceLock;

use gdcm_model::executor::{Executor, Task};

/// Threads in the global pool, one for each core.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Executor for Pool {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        // First in, first out, so that earlier requests are computed first.
        rayon::scope_fifo(|scope| {
            for task in tasks {
                scope.spawn_fifo(move |_| task());
            }
        });
    }
}

/// Starts the pool's threads, once per process.
///
/// # Errors
/// Returns the reason if no thread can be started.
pub fn start_threads() -> Result<(), String> {
    static STARTED: OnceLock<Result<(), String>> = OnceLock::new();
    STARTED.get_or_init(build_pool).clone()
}

fn build_pool() -> Result<(), String> {
    rayon::ThreadPoolBuilder::new()
        .build_global()
        .map_err(|error| error.to_string())
}
