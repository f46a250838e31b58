//! Carries out work that may take long: in a thread of its own, without the interpreter's lock,
//! with progress and interruption.
//!
//! The calling thread waits. At every tick it takes the lock, lets Python handle its signals
//! (Ctrl+C raises `KeyboardInterrupt`), and hands the progress, if it has changed, to the callback.
//! If either raises an exception, the work is asked to stop, and the exception is raised once it
//! has.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::scope;
use std::time::Duration;

use gdcm::cli::calls::CallError;
use gdcm_model::progress::Progress;
use pyo3::prelude::*;

use crate::error::exception;

/// Time between two checks for signals and progress.
const TICK: Duration = Duration::from_millis(50);

/// The work's progress, written by its threads and read by the calling thread.
#[derive(Default)]
struct Monitor {
    is_stopped: AtomicBool,
    state: Mutex<State>,
}

/// Progress to be reported.
#[derive(Clone, Default, PartialEq)]
struct State {
    /// Completed share of the present step, 0 to 1.
    fraction: f64,
    step: String,
}

impl Monitor {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Monitor {
    fn cancelled(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    fn advanced(&self, done: usize, total: usize) {
        self.state().fraction = done as f64 / total.max(1) as f64;
    }

    fn step(&self, name: &str) {
        let mut state = self.state();
        if state.step != name {
            name.clone_into(&mut state.step);
        }
    }
}

/// Carries out work without the interpreter's lock. `callback(fraction, step)` is called in the
/// calling thread when the progress has changed, and with the fraction 1 once the work has a
/// result.
///
/// # Errors
/// The work's error, the callback's exception, or `KeyboardInterrupt`.
pub(crate) fn carry_out<T: Send>(
    py: Python<'_>,
    callback: Option<Py<PyAny>>,
    work: impl FnOnce(&dyn Progress) -> Result<T, CallError> + Send,
) -> PyResult<T> {
    let monitor = Monitor::default();
    let mut listener = Listener {
        callback,
        last: None,
    };
    let result = py.detach(|| {
        scope(|threads| {
            let (sender, receiver) = channel::<()>();
            let working = threads.spawn(|| {
                // Dropped when the work ends, also by a panic: the wait below then ends.
                let _sender = sender;
                work(&monitor)
            });
            let mut raised = None;
            while receiver.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                if raised.is_none()
                    && let Err(error) = Python::attach(|py| listener.report(py, &monitor))
                {
                    monitor.is_stopped.store(true, Ordering::Relaxed);
                    raised = Some(error);
                }
            }
            let result = working.join().unwrap_or_else(|panic| resume_unwind(panic));
            match raised {
                None => Ok(result),
                Some(error) => Err(error),
            }
        })
    })?;
    match result {
        Ok(value) => {
            monitor.state().fraction = 1.0;
            listener.report(py, &monitor)?;
            Ok(value)
        }
        Err(error) => Err(exception(py, &error)),
    }
}

/// The callback, and the progress that it last received.
struct Listener {
    callback: Option<Py<PyAny>>,
    last: Option<State>,
}

impl Listener {
    /// Handles signals, and reports the progress if it has changed.
    fn report(&mut self, py: Python<'_>, monitor: &Monitor) -> PyResult<()> {
        py.check_signals()?;
        let Some(callback) = &self.callback else {
            return Ok(());
        };
        let state = monitor.state().clone();
        if self.last.as_ref() != Some(&state) {
            callback.call1(py, (state.fraction, state.step.as_str()))?;
            self.last = Some(state);
        }
        Ok(())
    }
}
