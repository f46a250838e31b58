//! A panic of the program, kept and put into words in place of a raw trace.

use std::any::Any;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::sync::{Mutex, PoisonError};

/// A panic: what it said, and where in the program's source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Its message, on one line.
    pub message: String,
    /// "src/study/engine.rs:49"; none where nobody noted it.
    pub place: Option<String>,
}

impl Fault {
    /// "index out of bounds at src/study/engine.rs:49".
    pub fn words(&self) -> String {
        match &self.place {
            Some(place) => format!("{} at {place}", self.message),
            None => self.message.clone(),
        }
    }
}

/// Faults noted and not told yet; a panic's place is known to the hook alone, and the thread that catches it may be another.
static NOTED: Mutex<Vec<Fault>> = Mutex::new(Vec::new());
/// Panics that nobody catches are few; more than this are not kept.
const MOST_NOTED: usize = 50;

/// To be called by the process's panic hook: keeps what was said, and where.
pub fn note(panic: &PanicHookInfo<'_>) {
    let place = panic.location().map(|location| format!("{}:{}", location.file(), location.line()));
    let mut noted = NOTED.lock().unwrap_or_else(PoisonError::into_inner);
    if noted.len() == MOST_NOTED {
        noted.remove(0);
    }
    noted.push(Fault { message: message_of(panic.payload()), place });
}

/// What `work` makes, or the fault that ended it.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Fault> {
    // What a panic leaves half made is thrown away by whoever calls this.
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let message = message_of(payload.as_ref());
        let mut noted = NOTED.lock().unwrap_or_else(PoisonError::into_inner);
        match noted.iter().rposition(|fault| fault.message == message) {
            Some(index) => noted.remove(index),
            None => Fault { message, place: None },
        }
    })
}

fn message_of(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().map(String::as_str).or_else(|| payload.downcast_ref::<&str>().copied());
    text.unwrap_or("a fault without a message").split_whitespace().collect::<Vec<_>>().join(" ")
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
    fn the_place_is_told_where_it_is_known() {
        let fault = Fault { message: "no".to_owned(), place: Some("src/a.rs:3".to_owned()) };
        assert_eq!(fault.words(), "no at src/a.rs:3");
    }
}
