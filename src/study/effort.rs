//! The carrying out of an analysis: by whom, how far, whether still wanted.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::crew::{Alone, Crew, Job};
use super::watch::{Stopped, Unwatched, Watch};

/// Carries out the pieces of one analysis, stops between two of them, and tells how far it is.
pub struct Effort<'a> {
    crew: &'a dyn Crew,
    watch: &'a dyn Watch,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Effort<'a> {
    /// An effort of `total` steps.
    pub fn new(crew: &'a dyn Crew, watch: &'a dyn Watch, total: usize) -> Self {
        Self { crew, watch, done: AtomicUsize::new(0), total }
    }

    /// An effort of one thread that nobody watches.
    pub fn alone() -> Effort<'static> {
        Effort::new(&Alone, &Unwatched, 0)
    }

    /// Who watches.
    pub(super) fn watch(&self) -> &'a dyn Watch {
        self.watch
    }

    /// `count` steps more are done. The watch hears of every hundredth of the total.
    pub(super) fn step(&self, count: usize) {
        let before = self.done.fetch_add(count, Ordering::Relaxed);
        let hundredth = |done: usize| 100 * done / self.total.max(1);
        if hundredth(before + count) > hundredth(before) {
            self.watch.progress(before + count, self.total);
        }
    }

    /// `of(0), of(1), ...`, in any order; each is `steps` steps.
    pub(super) fn each<T: Send>(
        &self,
        count: usize,
        steps: usize,
        of: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let mut results: Vec<Option<T>> = Vec::new();
        results.resize_with(count, || None);
        let of = &of;
        let job = |(index, result)| self.job(steps, move || of(index), result);
        self.crew.carry_out(results.iter_mut().enumerate().map(job).collect());
        results.into_iter().collect::<Option<Vec<_>>>().ok_or(Stopped)
    }

    /// One piece of work, given up if it is not wanted any more.
    fn job<'b, T: Send>(
        &'b self,
        steps: usize,
        work: impl FnOnce() -> T + Send + 'b,
        result: &'b mut Option<T>,
    ) -> Job<'b> {
        Box::new(move || {
            if !self.watch.stopped() {
                *result = Some(work());
                self.step(steps);
            }
        })
    }

    /// As [`Effort::each`] for work on things that change, which may itself be stopped.
    pub(super) fn each_mut<S: Send, T: Send>(
        &self,
        things: Vec<S>,
        of: impl Fn(S) -> Result<T, Stopped> + Sync,
    ) -> Result<Vec<T>, Stopped> {
        let mut results: Vec<Option<Result<T, Stopped>>> = Vec::new();
        results.resize_with(things.len(), || None);
        let of = &of;
        let jobs = things.into_iter().zip(&mut results).map(|(thing, result)| self.job(0, move || of(thing), result));
        self.crew.carry_out(jobs.collect());
        results.into_iter().map(|result| result.unwrap_or(Err(Stopped))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// Stops after so many pieces of work, and keeps what it hears.
    struct Impatient {
        left: AtomicUsize,
        heard: Mutex<Vec<(usize, usize)>>,
    }

    impl Watch for Impatient {
        fn stopped(&self) -> bool {
            self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
        }

        fn progress(&self, done: usize, total: usize) {
            self.heard.lock().unwrap().push((done, total));
        }
    }

    fn impatient(left: usize) -> Impatient {
        Impatient { left: AtomicUsize::new(left), heard: Mutex::default() }
    }

    #[test]
    fn results_come_in_order() {
        assert_eq!(Effort::alone().each(4, 1, |index| 10 * index), Ok(vec![0, 10, 20, 30]));
    }

    #[test]
    fn work_that_is_not_wanted_any_more_is_given_up() {
        let watch = impatient(3);
        let begun = AtomicUsize::new(0);
        let result = Effort::new(&Alone, &watch, 100).each(50, 1, |_| begun.fetch_add(1, Ordering::Relaxed));
        assert_eq!((result, begun.into_inner()), (Err(Stopped), 3));
    }

    #[test]
    fn the_watch_hears_of_hundredths_only() {
        let watch = impatient(usize::MAX);
        Effort::new(&Alone, &watch, 1000).each(1000, 1, |_| ()).unwrap();
        let heard = watch.heard.into_inner().unwrap();
        assert_eq!((heard.len(), heard[0], heard[99]), (100, (10, 1000), (1000, 1000)));
    }
}
