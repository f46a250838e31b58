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

/// `of` each of `things`, in their order, carried out by `executor`: what comes of it does not depend on by whom. What an
/// executor leaves undone the caller's thread does.
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

    /// The last first.
    struct Backwards;

    impl Executor for Backwards {
        fn carry_out(&self, tasks: Vec<Task<'_>>) {
            tasks.into_iter().rev().for_each(|task| task());
        }
    }

    /// Does every other piece of work.
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
