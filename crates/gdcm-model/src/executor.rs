//! Independent tasks and their execution: the numerical crates know nothing of threads, but their
//! callers may.

/// A task that depends on no other.
pub type Task<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Runs independent tasks, in any order and on any number of threads; returns when all are done.
pub trait Executor: Send + Sync {
    /// Runs all `tasks`.
    fn carry_out(&self, tasks: Vec<Task<'_>>);
}

/// Runs tasks on the caller's thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequential;

impl Executor for Sequential {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        tasks.into_iter().for_each(|task| task());
    }
}

/// Applies `of` to each of `things` on `executor` and returns the results in order; they do not
/// depend on the executor. Tasks that the executor leaves undone run on the caller's thread.
pub fn each<S: Send, T: Send>(
    executor: &dyn Executor,
    things: impl IntoIterator<Item = S>,
    of: impl Fn(S) -> T + Sync,
) -> Vec<T> {
    let mut pieces: Vec<(Option<S>, Option<T>)> = things
        .into_iter()
        .map(|thing| (Some(thing), None))
        .collect();
    let of = &of;
    let task = |(thing, result): &'_ mut (Option<S>, Option<T>)| *result = thing.take().map(of);
    executor.carry_out(
        pieces
            .iter_mut()
            .map(|piece| Box::new(move || task(piece)) as Task<'_>)
            .collect(),
    );
    pieces
        .into_iter()
        .filter_map(|(thing, result)| result.or_else(|| thing.map(of)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs the tasks in reverse order.
    struct Backwards;

    impl Executor for Backwards {
        fn carry_out(&self, tasks: Vec<Task<'_>>) {
            tasks.into_iter().rev().for_each(|task| task());
        }
    }

    /// Runs every other task only.
    struct Careless;

    impl Executor for Careless {
        fn carry_out(&self, tasks: Vec<Task<'_>>) {
            tasks.into_iter().step_by(2).for_each(|task| task());
        }
    }

    #[test]
    fn results_come_in_the_order_of_the_things_whoever_works_on_them() {
        for executor in [&Sequential as &dyn Executor, &Backwards, &Careless] {
            assert_eq!(each(executor, 0..4, |index| 10 * index), [0, 10, 20, 30]);
        }
    }
}
