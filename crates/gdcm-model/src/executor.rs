//! Independent tasks and their execution. The numerical crates use no threads themselves; their
//! callers may run the tasks on several.

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
        for task in tasks {
            task();
        }
    }
}

/// An argument and its result.
struct Piece<S, T> {
    /// `None` once its task has begun.
    argument: Option<S>,
    /// `None` until its task is done.
    result: Option<T>,
}

/// Applies a function to each argument on `executor`, and returns the results in order; they do not
/// depend on the executor. Tasks that the executor leaves undone run on the caller's thread.
pub fn each<S: Send, T: Send>(
    executor: &dyn Executor,
    arguments: impl IntoIterator<Item = S>,
    function: impl Fn(S) -> T + Sync,
) -> Vec<T> {
    let mut pieces: Vec<Piece<S, T>> = arguments
        .into_iter()
        .map(|argument| Piece {
            argument: Some(argument),
            result: None,
        })
        .collect();
    let function = &function;
    let mut tasks: Vec<Task<'_>> = Vec::with_capacity(pieces.len());
    for piece in &mut pieces {
        tasks.push(Box::new(move || {
            piece.result = piece.argument.take().map(function);
        }));
    }
    executor.carry_out(tasks);
    let mut results = Vec::with_capacity(pieces.len());
    for piece in pieces {
        results.extend(piece.result.or_else(|| piece.argument.map(function)));
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs the tasks in reverse order.
    struct Backwards;

    impl Executor for Backwards {
        fn carry_out(&self, tasks: Vec<Task<'_>>) {
            for task in tasks.into_iter().rev() {
                task();
            }
        }
    }

    /// Runs every other task only.
    struct Careless;

    impl Executor for Careless {
        fn carry_out(&self, tasks: Vec<Task<'_>>) {
            for task in tasks.into_iter().step_by(2) {
                task();
            }
        }
    }

    #[test]
    fn results_are_in_the_order_of_the_arguments() {
        for executor in [&Sequential as &dyn Executor, &Backwards, &Careless] {
            assert_eq!(each(executor, 0..4, |index| 10 * index), [0, 10, 20, 30]);
        }
    }
}
