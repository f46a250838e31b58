//! Execution of an analysis: executor, progress and cancellation. An executor runs pieces of work
//! one after another or on several threads; progress counts steps, of which an analysis has a fixed
//! total.

use std::sync::atomic::{AtomicUsize, Ordering};

use gdcm_model::executor::{Executor, Sequential, each};
use gdcm_model::progress::{Cancelled, Progress, Unobserved};

/// Runs an analysis's pieces of work, checks for cancellation between them, and reports progress.
pub struct Execution<'a> {
    executor: &'a dyn Executor,
    progress: &'a dyn Progress,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Execution<'a> {
    /// Creates the execution for an analysis with `total` steps.
    pub fn new(executor: &'a dyn Executor, progress: &'a dyn Progress, total: usize) -> Self {
        Self {
            executor,
            progress,
            done: AtomicUsize::new(0),
            total,
        }
    }

    /// Creates an execution on one thread without an observer.
    pub fn sequential() -> Execution<'static> {
        Execution::new(&Sequential, &Unobserved, 0)
    }

    pub(crate) fn progress(&self) -> &'a dyn Progress {
        self.progress
    }

    pub(crate) fn executor(&self) -> &'a dyn Executor {
        self.executor
    }

    /// Counts `count` more steps as done; progress is reported about every hundredth of the total.
    pub(crate) fn step(&self, count: usize) {
        let before = self.done.fetch_add(count, Ordering::Relaxed);
        let hundredth = |done: usize| 100 * done / self.total.max(1);
        if hundredth(before + count) > hundredth(before) {
            self.progress.advanced(before + count, self.total);
        }
    }

    /// Evaluates `work(0), work(1), ...`, in any order; each counts as `steps` steps. The results
    /// are in the order of the indices.
    pub(crate) fn each<T: Send>(
        &self,
        count: usize,
        steps: usize,
        work: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        each(self.executor, 0..count, |index| {
            self.piece(steps, || work(index))
        })
        .into_iter()
        .collect::<Option<_>>()
        .ok_or(Cancelled)
    }

    /// Runs a piece of work; `None` after cancellation.
    fn piece<T>(&self, steps: usize, work: impl FnOnce() -> T) -> Option<T> {
        if self.progress.cancelled() {
            return None;
        }
        let result = work();
        self.step(steps);
        Some(result)
    }

    /// Works as [`Execution::each`] on items passed by value, with work that may itself be
    /// cancelled and counts its own steps.
    pub(crate) fn each_owned<S: Send, T: Send>(
        &self,
        items: Vec<S>,
        work: impl Fn(S) -> Result<T, Cancelled> + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let pieces = each(self.executor, items, |item| {
            self.piece(0, || work(item)).unwrap_or(Err(Cancelled))
        });
        pieces.into_iter().collect()
    }
}

/// Applies `work` to each item, in order.
///
/// # Errors
/// [`Cancelled`] between two items, where `progress` requests it.
pub(crate) fn in_turn<T, U>(
    items: &[T],
    progress: &dyn Progress,
    mut work: impl FnMut(&T) -> U,
) -> Result<Vec<U>, Cancelled> {
    let mut results = Vec::with_capacity(items.len());
    for item in items {
        if progress.cancelled() {
            return Err(Cancelled);
        }
        results.push(work(item));
        progress.advanced(results.len(), items.len());
    }
    Ok(results)
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Observer that cancels after a number of pieces of work, and records the reported progress.
    struct Impatient {
        left: AtomicUsize,
        heard: Mutex<Vec<(usize, usize)>>,
    }

    impl Progress for Impatient {
        fn cancelled(&self) -> bool {
            self.left
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                    left.checked_sub(1)
                })
                .is_err()
        }

        fn advanced(&self, done: usize, total: usize) {
            self.heard.lock().unwrap().push((done, total));
        }
    }

    fn impatient(left: usize) -> Impatient {
        Impatient {
            left: AtomicUsize::new(left),
            heard: Mutex::default(),
        }
    }

    #[test]
    fn results_come_in_order() {
        assert_eq!(
            Execution::sequential().each(4, 1, |index| 10 * index),
            Ok(vec![0, 10, 20, 30])
        );
    }

    #[test]
    fn work_that_is_not_wanted_any_more_is_given_up() {
        let progress = impatient(3);
        let begun = AtomicUsize::new(0);
        let result = Execution::new(&Sequential, &progress, 100)
            .each(50, 1, |_| begun.fetch_add(1, Ordering::Relaxed));
        assert_eq!((result, begun.into_inner()), (Err(Cancelled), 3));
    }

    #[test]
    fn hundredths_only_are_told() {
        let progress = impatient(usize::MAX);
        Execution::new(&Sequential, &progress, 1000)
            .each(1000, 1, |_| ())
            .unwrap();
        let heard = progress.heard.into_inner().unwrap();
        assert_eq!(
            (heard.len(), heard[0], heard[99]),
            (100, (10, 1000), (1000, 1000))
        );
    }
}
