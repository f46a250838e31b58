//! Panics as faults: a panic's message and source location in one line, reported to the engineer
//! instead of a raw trace.
//!
//! Only the panic hook knows the location, and only the code that catches the panic can report it:
//! the hook records each panic ([`record_panic`]), and `caught` looks it up by its message.

use std::any::Any;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// Message and source location of a panic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Message on a single line.
    pub message: String,
    /// "src/study/engine.rs:49"; `None` if the location was not recorded.
    pub place: Option<String>,
}

impl Fault {
    /// Formats "index out of bounds at src/study/engine.rs:49".
    pub fn words(&self) -> String {
        match &self.place {
            Some(place) => format!("{} at {place}", self.message),
            None => self.message.clone(),
        }
    }
}

/// Returns the result of `work`, or the panic that ended it.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Fault> {
    // `AssertUnwindSafe`: callers discard values that a panic left inconsistent.
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let message = message_of(payload.as_ref());
        let mut recorded = RECORDED.lock().unwrap_or_else(PoisonError::into_inner);
        match recorded.iter().rposition(|fault| fault.message == message) {
            Some(index) => recorded.remove(index),
            None => Fault {
                message,
                place: None,
            },
        }
    })
}

/// Recorded panics that have not been caught yet. Another thread may catch a panic, so the list is
/// not thread-local.
static RECORDED: Mutex<Vec<Fault>> = Mutex::new(Vec::new());
/// Maximum count of recorded panics; beyond it, the oldest is dropped.
const MOST_RECORDED: usize = 50;

/// Records a panic's message and location; called by the process's panic hook.
pub fn record_panic(panic: &PanicHookInfo<'_>) {
    let place = panic
        .location()
        .map(|location| format!("{}:{}", location.file(), location.line()));
    let mut recorded = RECORDED.lock().unwrap_or_else(PoisonError::into_inner);
    if recorded.len() == MOST_RECORDED {
        recorded.remove(0);
    }
    recorded.push(Fault {
        message: message_of(panic.payload()),
        place,
    });
}

/// Returns a panic's message, on a single line.
fn message_of(payload: &(dyn Any + Send)) -> String {
    let text = if let Some(text) = payload.downcast_ref::<String>() {
        text
    } else if let Some(text) = payload.downcast_ref::<&str>() {
        text
    } else {
        "a panic without a message"
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caught_panic_keeps_its_message_on_one_line() {
        let fault = caught(|| panic!("index {}\n  out of bounds", 3)).unwrap_err();
        assert_eq!(fault.message, "index 3 out of bounds");
        assert_eq!(caught(|| 7), Ok(7));
    }

    #[test]
    fn the_place_is_named_if_known() {
        let fault = Fault {
            message: "no".to_owned(),
            place: Some("src/a.rs:3".to_owned()),
        };
        assert_eq!(fault.words(), "no at src/a.rs:3");
    }
}
