//! Independent tasks and their execution. The numerical crates create no threads themselves; their
//! callers may distribute the tasks over several threads.

/// A task that does not depend on other tasks.
pub type Task<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Runs independent tasks, in any order and on any number of threads; returns when all are done.
pub trait Executor: Send + Sync {
    /// Runs all `tasks`, and returns when they are done.
    fn carry_out(&self, tasks: Vec<Task<'_>>);
}

/// Executor that runs all tasks on the caller's thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequential;

impl Executor for Sequential {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        for task in tasks {
            task();
        }
    }
}

/// An argument, and the result that its task computes from it.
struct TaskSlot<S, T> {
    /// Taken by the task when it begins.
    argument: Option<S>,
    /// `None` until the task is done.
    result: Option<T>,
}

/// Applies a function to each argument on `executor`, and returns the results in argument order,
/// whatever the order of execution.
///
/// As a safeguard, tasks that the executor drops without running are completed on the caller's
/// thread. If an executor catches the panic of a task, the result of this task is missing.
pub fn each<S: Send, T: Send>(
    executor: &dyn Executor,
    arguments: impl IntoIterator<Item = S>,
    function: impl Fn(S) -> T + Sync,
) -> Vec<T> {
    let mut slots: Vec<TaskSlot<S, T>> = arguments
        .into_iter()
        .map(|argument| TaskSlot {
            argument: Some(argument),
            result: None,
        })
        .collect();
    let function = &function;
    let mut tasks: Vec<Task<'_>> = Vec::with_capacity(slots.len());
    for slot in &mut slots {
        tasks.push(Box::new(move || {
            slot.result = slot.argument.take().map(function);
        }));
    }
    executor.carry_out(tasks);
    let mut results = Vec::with_capacity(slots.len());
    for slot in slots {
        results.extend(slot.result.or_else(|| slot.argument.map(function)));
    }
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Executor that runs the tasks in reverse order.
    struct Backwards;

    impl Executor for Backwards {
        fn carry_out(&self, tasks: Vec<Task<'_>>) {
            for task in tasks.into_iter().rev() {
                task();
            }
        }
    }

    /// Executor that runs only every other task.
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
