//! Independent pieces of work, and who carries them out: the numeric half knows of no thread, its callers may have some.

/// One piece of work that depends on no other.
pub type Task<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Carries out independent pieces of work, in any order and on as many threads as it has; returns when all are done.
pub trait Executor: Send + Sync {
    /// Carries out `tasks`, every one of them.
    fn carry_out(&self, tasks: Vec<Task<'_>>);
}

/// One thread: the caller's.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequential;

impl Executor for Sequential {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        tasks.into_iter().for_each(|task| task());
    }
}

/// `of` each of `things`, in their order, carried out by `executor`: what comes of it does not depend on by whom.
pub fn each<S: Send, T: Send>(
    executor: &dyn Executor,
    things: impl IntoIterator<Item = S>,
    of: impl Fn(S) -> T + Sync,
) -> Vec<T> {
    let things: Vec<S> = things.into_iter().collect();
    let mut results: Vec<Option<T>> = Vec::new();
    results.resize_with(things.len(), || None);
    let of = &of;
    let mut tasks: Vec<Task<'_>> = Vec::with_capacity(things.len());
    for (thing, result) in things.into_iter().zip(&mut results) {
        tasks.push(Box::new(move || *result = Some(of(thing))));
    }
    executor.carry_out(tasks);
    results.into_iter().map(|result| result.expect("an executor carries out every task")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The last first.
    struct Backwards;

    impl Executor for Backwards {
        fn carry_out(&self, tasks: Vec<Task<'_>>) {
            tasks.into_iter().rev().for_each(|task| task());
        }
    }

    #[test]
    fn results_come_in_the_order_of_the_things_whoever_works_on_them() {
        for executor in [&Sequential as &dyn Executor, &Backwards] {
            assert_eq!(each(executor, 0..4, |index| 10 * index), [0, 10, 20, 30]);
        }
    }
}
