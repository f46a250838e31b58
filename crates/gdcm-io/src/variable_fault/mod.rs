//! Reasons why the variables in a file could not be read or written. A reason that concerns only
//! one value, and leaves the others readable, is an [`unread::Unread`].

pub mod column_place;
pub mod damage;
pub mod found_content;
pub mod line_fault;
pub mod matlab_value_fault;
pub mod octave_fault;
pub mod unread;
pub mod unsupported_content;

use gdcm_model::message_text::shortened_name;

use crate::variable_fault::damage::Damage;
use crate::variable_fault::found_content::FoundContent;
use crate::variable_fault::line_fault::LineFault;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Reason why variables could not be read or written. Field `variable` is the affected variable's
/// path, such as "sys.A" or "models{3}.B"; it is empty if the fault concerns the whole file, or if
/// the variable is unknown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VariableFault {
    /// The file has another format, or contents other than those expected.
    #[error("expected {expected}, found {found}")]
    Format {
        expected: &'static str,
        found: FoundContent,
    },
    /// The file ends prematurely.
    #[error("{}the file is cut off (byte {offset}); copy it again", at(variable))]
    CutOff {
        variable: String,
        /// Position in the file \[bytes\].
        offset: u64,
    },
    /// The bytes contradict the format.
    #[error("{}{damage}{}", at(variable), damage.remedy(*offset))]
    Damaged {
        variable: String,
        damage: Damage,
        /// Position in the file \[bytes\].
        offset: u64,
    },
    #[error("{}line {line}: {fault}", at(variable))]
    Line {
        variable: String,
        /// Line number, from 1.
        line: usize,
        fault: LineFault,
    },
    /// The format permits the content, but this program does not read it; or the content cannot be
    /// written.
    #[error("{}{content} cannot be {}; {}", at(variable), content.action(), content.remedy())]
    Unsupported {
        variable: String,
        content: UnsupportedContent,
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
    /// Reading the file would take more work steps than the limit.
    #[error(
        "{}reading would take more than {most_millions} million steps of computation, the limit for a \
        file; split the file",
        at(variable)
    )]
    TooMuchWork {
        variable: String,
        /// The limit \[million steps\].
        most_millions: u64,
    },
    /// The file contains more records than the limit.
    #[error("expected at most {most} records, found {found}; split the file")]
    TooManyRecords { found: usize, most: usize },
    /// Values are nested more deeply than the limit, or in a cycle.
    #[error(
        "{}values are nested too deeply, or contain themselves; save the inner values as separate \
        variables",
        at(variable)
    )]
    TooDeep { variable: String },
    /// A name that must be unique occurs more than once.
    #[error("duplicate name \"{name}\"; rename one")]
    Duplicate { name: String },
    /// The reader was cancelled.
    #[error("stopped")]
    Stopped,
}

impl VariableFault {
    /// Returns the stable code by which scripts and tests distinguish the reasons.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Format { .. } => "unexpected-format",
            Self::CutOff { .. } => "cut-off",
            Self::Damaged { .. } => "damaged-file",
            Self::Line { fault, .. } => fault.code(),
            Self::Unsupported { .. } => "unsupported-content",
            Self::TooLarge { .. } => "too-much-memory",
            Self::TooMuchWork { .. } => "too-much-work",
            Self::TooManyRecords { .. } => "too-many-records",
            Self::TooDeep { .. } => "values-too-deep",
            Self::Duplicate { .. } => "duplicate-name",
            Self::Stopped => "stopped",
        }
    }

    /// Returns the message about a file named `file`; `stem` is the name without its extension.
    /// Both occur only in remedies for unsupported content, such as a command that converts the
    /// file.
    pub(crate) fn words_for_file(&self, file: &str, stem: &str) -> String {
        match self {
            Self::Unsupported { variable, content } => {
                let remedy = content
                    .remedy()
                    .replace("{file}", file)
                    .replace("{stem}", stem);
                let action = content.action();
                format!("{}{content} cannot be {action}; {remedy}", at(variable))
            }
            _ => self.to_string(),
        }
    }

    /// Creates the error for a file with another format, or with contents other than those
    /// expected.
    pub(crate) fn format(expected: &'static str, found: FoundContent) -> Self {
        Self::Format { expected, found }
    }

    /// Creates the error for bytes in another format, or for no bytes.
    pub(crate) fn other_bytes(expected: &'static str, bytes: &[u8]) -> Self {
        let found = if bytes.is_empty() {
            FoundContent::Nothing
        } else {
            FoundContent::OtherBytes
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
    pub(crate) fn damaged(variable: &str, damage: impl Into<Damage>, offset: u64) -> Self {
        Self::Damaged {
            variable: variable.to_owned(),
            damage: damage.into(),
            offset,
        }
    }

    /// Creates the error for an invalid line.
    pub(crate) fn line(variable: &str, line: usize, fault: impl Into<LineFault>) -> Self {
        Self::Line {
            variable: variable.to_owned(),
            line,
            fault: fault.into(),
        }
    }

    /// Creates the error for content that the format permits but this program does not read, or for
    /// content that cannot be written.
    pub(crate) fn unsupported(variable: &str, content: UnsupportedContent) -> Self {
        Self::Unsupported {
            variable: variable.to_owned(),
            content,
        }
    }

    /// Creates the error for values nested more deeply than the limit.
    pub(crate) fn too_deep(variable: &str) -> Self {
        Self::TooDeep {
            variable: variable.to_owned(),
        }
    }

    /// Adds the affected variable's name, unless the error already has one or has no field for it.
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
            Self::Format { .. }
            | Self::TooManyRecords { .. }
            | Self::Duplicate { .. }
            | Self::Stopped => {}
        }
        self
    }

    /// Returns whether the error is an exceeded limit on memory, work or records, or a
    /// cancellation; trying another format is then pointless.
    pub fn is_of_the_budget(&self) -> bool {
        matches!(
            self,
            Self::TooLarge { .. }
                | Self::TooMuchWork { .. }
                | Self::TooManyRecords { .. }
                | Self::Stopped
        )
    }
}

/// Returns the beginning of a message, which names the variable; empty without a variable.
fn at(variable: &str) -> String {
    if variable.is_empty() {
        String::new()
    } else {
        format!("variable {}: ", shortened_name(variable))
    }
}
