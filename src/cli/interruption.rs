//! Interruption by Ctrl+C (SIGINT).
//!
//! While an [`Interruptible`] exists, the first Ctrl+C only sets a flag, which the work queries.
//! Without one, and from the second Ctrl+C on, the process ends at once.
//!
//! On systems without SIGINT, Ctrl+C always ends the process at once, which leaves no partial file
//! either.

#[cfg(unix)]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(unix)]
use std::sync::{Arc, LazyLock};

/// Marks work that queries [`Interruptible::is_requested`]; dropping the value removes the mark.
pub(super) struct Interruptible {
    /// Prevents construction without [`Interruptible::begin`].
    _private: (),
}

#[cfg(unix)]
impl Interruptible {
    /// Begins interruptible work: the next Ctrl+C only sets a flag.
    pub(super) fn begin() -> Self {
        INTERRUPTION.ends_process.store(false, Ordering::SeqCst);
        Self { _private: () }
    }

    /// Returns whether the work shall end because of Ctrl+C.
    pub(super) fn is_requested(&self) -> bool {
        INTERRUPTION.is_requested.load(Ordering::SeqCst)
    }
}

#[cfg(unix)]
impl Drop for Interruptible {
    fn drop(&mut self) {
        INTERRUPTION.ends_process.store(true, Ordering::SeqCst);
    }
}

#[cfg(not(unix))]
impl Interruptible {
    /// Has no effect without SIGINT.
    pub(super) fn begin() -> Self {
        Self { _private: () }
    }

    /// Returns false: without SIGINT, Ctrl+C never leads to a request.
    pub(super) fn is_requested(&self) -> bool {
        false
    }
}

/// Interruption state, for the whole process.
#[cfg(unix)]
struct Interruption {
    /// Whether an interruption occurred.
    is_requested: Arc<AtomicBool>,
    /// Whether the next interruption ends the process.
    ends_process: Arc<AtomicBool>,
}

/// The signal handlers are registered at the first use.
#[cfg(unix)]
static INTERRUPTION: LazyLock<Interruption> = LazyLock::new(|| {
    use signal_hook::consts::SIGINT;
    use signal_hook::flag;
    let interruption = Interruption {
        is_requested: Arc::default(),
        ends_process: Arc::new(AtomicBool::new(true)),
    };
    // The order matters: at the first interruption during work, the first handler still finds
    // `ends_process` unset, so that only the second interruption ends the process. If a
    // registration fails, Ctrl+C ends the process.
    let _ = flag::register_conditional_default(SIGINT, Arc::clone(&interruption.ends_process));
    let _ = flag::register(SIGINT, Arc::clone(&interruption.ends_process));
    let _ = flag::register(SIGINT, Arc::clone(&interruption.is_requested));
    interruption
});

#[cfg(test)]
mod tests {
    #[cfg(unix)]
    #[test]
    fn an_interruption_is_requested_during_work_and_does_not_end_the_process() {
        use super::{INTERRUPTION, Interruptible, Ordering};
        let work = Interruptible::begin();
        assert!(!work.is_requested());
        signal_hook::low_level::raise(signal_hook::consts::SIGINT).unwrap();
        assert!(work.is_requested());
        assert!(
            INTERRUPTION.ends_process.load(Ordering::SeqCst),
            "the next one ends the process"
        );
    }
}
