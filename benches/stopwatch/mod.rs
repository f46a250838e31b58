//! Times of what is run outside criterion.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// The shortest of a few runs: what the machine does when nothing disturbs it.
pub fn shortest<T>(runs: usize, mut run: impl FnMut() -> T) -> Duration {
    let time = |_| {
        let start = Instant::now();
        drop(black_box(run()));
        start.elapsed()
    };
    (0..runs).map(time).min().unwrap_or_default()
}
