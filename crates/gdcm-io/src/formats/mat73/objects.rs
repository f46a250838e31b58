//! References to objects of MATLAB's classes.

use crate::formats::mat::Subsystem;
use crate::formats::variables::{Array, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Treatment of references to objects.
pub(super) enum Objects {
    /// References remain integers, within the object part itself.
    References,
    /// Objects cannot be read, with the reason.
    Unread(String),
    /// References are resolved.
    Read(Subsystem),
}

impl Objects {
    /// Returns the value of a reference; `class` is the class of its objects.
    pub(super) fn value(
        &self,
        class: &str,
        reference: Array,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        match self {
            Self::References => Ok(Value::Array(reference)),
            Self::Unread(why) => Ok(Value::opaque(class, why)),
            Self::Read(subsystem) => match reference_words(&reference) {
                Some(words) => subsystem.object(&words, path, budget),
                None => Ok(Value::opaque(class, "its reference is damaged")),
            },
        }
    }
}

/// Returns the words of a reference; `None` if a number is no unsigned 32-bit integer.
fn reference_words(reference: &Array) -> Option<Vec<u32>> {
    let mut words = Vec::new();
    for &number in &reference.re {
        if !(0.0..=f64::from(u32::MAX)).contains(&number) {
            return None;
        }
        words.push(number as u32);
    }
    Some(words)
}
