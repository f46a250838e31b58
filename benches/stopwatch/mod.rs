//! Timing of code that is not run by criterion.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Returns the minimum time of a few runs, which is least affected by other processes.
pub fn shortest<T>(runs: usize, mut run: impl FnMut() -> T) -> Duration {
    let time = |_| {
        let start = Instant::now();
        drop(black_box(run()));
        start.elapsed()
    };
    (0..runs).map(time).min().unwrap_or_default()
}
