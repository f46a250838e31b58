//! Messages with their stable codes, as the commands print and the window shows them.
//!
//! Scripts and tests compare the codes; the texts may change.

/// A text for the engineer, with the code that identifies what it is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Stable code, for programs and tests.
    pub code: &'static str,
    pub text: String,
}

impl Message {
    pub fn new(code: &'static str, text: impl Into<String>) -> Self {
        Self {
            code,
            text: text.into(),
        }
    }
}
