//! Reasons why the variables in a file could not be read.

use gdcm_model::message_text::shortened_name;

/// Reason why variables could not be read. Field `variable` is the path of the affected variable,
/// such as "sys.A" or "models{3}.B"; it is empty if none was begun.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VariableFault {
    /// The file has another format.
    #[error("expected {expected}, found {found}")]
    Format {
        expected: &'static str,
        /// Description of the bytes with which the file begins.
        found: String,
    },
    /// The file ends prematurely.
    #[error("{}the file is cut off (byte {offset}); copy it again", at(variable))]
    CutOff {
        variable: String,
        /// Position in the file \[bytes\].
        offset: u64,
    },
    /// The bytes contradict the format.
    #[error(
        "{}{what} (byte {offset}): the file is damaged; write it again",
        at(variable)
    )]
    Damaged {
        variable: String,
        what: String,
        /// Position in the file \[bytes\].
        offset: u64,
    },
    /// A line is invalid.
    #[error("{}line {line}: {what}", at(variable))]
    Line {
        variable: String,
        /// Line number, from 1.
        line: usize,
        /// Description of the fault and of its remedy.
        what: String,
    },
    /// The format permits the content, but this program does not read it.
    #[error("{}{what} cannot be read; {remedy}", at(variable))]
    Unsupported {
        variable: String,
        what: String,
        /// How to export the data in another format; `{file}` and `{stem}` represent the file name
        /// with and without its extension.
        remedy: String,
    },
    /// The file contains, or claims to contain, more data than the memory limit permits.
    #[error(
        "{}reading would take more than {most_mib} MiB of memory, the limit for a file; split the \
        file",
        at(variable)
    )]
    TooLarge {
        variable: String,
        /// The limit \[MiB\].
        most_mib: u64,
    },
    /// Reading the file would take more steps of work than the limit.
    #[error(
        "{}reading would take more than {most_millions} million steps of work, the limit for a \
        file; split the file",
        at(variable)
    )]
    TooMuchWork {
        variable: String,
        /// The limit \[million steps\].
        most_millions: u64,
    },
    /// Values are nested more deeply than the limit, or in a cycle.
    #[error("{}values are nested too deeply, or contain themselves", at(variable))]
    TooDeep { variable: String },
    /// A name that must be unique occurs more than once.
    #[error("duplicate name \"{name}\"; rename one")]
    Duplicate { name: String },
    /// The reader was cancelled.
    #[error("stopped")]
    Stopped,
}

impl VariableFault {
    /// Creates the error for a file with another format.
    pub(crate) fn format(expected: &'static str, found: impl Into<String>) -> Self {
        Self::Format {
            expected,
            found: found.into(),
        }
    }

    /// Creates the error for a file with another format, with a description of its first bytes.
    pub(crate) fn other_bytes(expected: &'static str, bytes: &[u8]) -> Self {
        let found = if bytes.is_empty() {
            "nothing"
        } else {
            "other bytes"
        };
        Self::format(expected, found)
    }

    /// Creates the error for a file that ends prematurely.
    pub(crate) fn cut_off(variable: &str, offset: usize) -> Self {
        Self::CutOff {
            variable: variable.to_owned(),
            offset: offset as u64,
        }
    }

    /// Creates the error for bytes that contradict the format.
    pub(crate) fn damaged(variable: &str, what: impl Into<String>, offset: u64) -> Self {
        Self::Damaged {
            variable: variable.to_owned(),
            what: what.into(),
            offset,
        }
    }

    /// Creates the error for an invalid line.
    pub(crate) fn line(variable: &str, line: usize, what: impl Into<String>) -> Self {
        Self::Line {
            variable: variable.to_owned(),
            line,
            what: what.into(),
        }
    }

    /// Creates the error for content that the format permits but this program does not read.
    pub(crate) fn unsupported(
        variable: &str,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Unsupported {
            variable: variable.to_owned(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    /// Creates the error for values nested more deeply than the limit.
    pub(crate) fn too_deep(variable: &str) -> Self {
        Self::TooDeep {
            variable: variable.to_owned(),
        }
    }

    /// Adds the name of the affected variable, unless the error already has one.
    #[must_use]
    pub(crate) fn in_variable(mut self, name: impl FnOnce() -> String) -> Self {
        match &mut self {
            Self::CutOff { variable, .. }
            | Self::Damaged { variable, .. }
            | Self::Unsupported { variable, .. }
            | Self::TooLarge { variable, .. }
            | Self::TooMuchWork { variable, .. }
            | Self::Line { variable, .. }
            | Self::TooDeep { variable } => {
                if variable.is_empty() {
                    *variable = name();
                }
            }
            Self::Format { .. } | Self::Duplicate { .. } | Self::Stopped => {}
        }
        self
    }

    /// Returns whether the error is an exceeded limit or a cancellation; trying another format is
    /// then pointless.
    pub fn is_of_the_budget(&self) -> bool {
        matches!(
            self,
            Self::TooLarge { .. } | Self::TooMuchWork { .. } | Self::Stopped
        )
    }
}

/// Returns the prefix of a message that names the variable; empty without a variable.
fn at(variable: &str) -> String {
    if variable.is_empty() {
        String::new()
    } else {
        format!("variable {}: ", shortened_name(variable))
    }
}
