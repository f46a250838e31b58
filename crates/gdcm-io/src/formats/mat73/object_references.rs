//! References to objects of MATLAB classes.

use crate::formats::mat::Subsystem;
use crate::formats::variables::{Array, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::unread::Unread;

/// Treatment of references to objects while a file is read.
pub(super) enum Objects {
    /// References remain integers: the object part itself is being read.
    References,
    /// Objects become opaque values, for this reason.
    Unread(Unread),
    /// References are replaced by the objects.
    Read(Subsystem),
}

impl Objects {
    /// Returns the value for a reference; `class` is the objects' class.
    pub(super) fn value(
        &self,
        class: &str,
        reference: Array,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        match self {
            Self::References => Ok(Value::Array(reference)),
            Self::Unread(why) => Ok(Value::opaque(class, why.clone())),
            Self::Read(subsystem) => match reference_words(&reference) {
                Some(words) => subsystem.object(&words, path, budget),
                None => Ok(Value::opaque(class, Unread::DamagedReference)),
            },
        }
    }
}

/// Returns the words of a reference; `None` if a number is not an unsigned 32-bit integer.
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
