//! Why variables could not be read from a file.

/// Why variables could not be read: what, and in which variable (a path such as "sys.A" or "models{3}.B"; empty where none was begun).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VariableFault {
    /// The file is of another kind.
    #[error("expected {expected}, found {found}")]
    Format {
        /// The kind of file asked for.
        expected: &'static str,
        /// What the file begins with, in words.
        found: String,
    },
    /// The file ends in the middle of something.
    #[error("{}the file is cut off (byte {offset}); copy it again", at(variable))]
    CutOff {
        /// The variable.
        variable: String,
        /// Where in the file, in bytes.
        offset: u64,
    },
    /// The bytes contradict the format.
    #[error("{}{what} (byte {offset}): the file is damaged; write it again", at(variable))]
    Damaged {
        /// The variable.
        variable: String,
        /// What is wrong.
        what: String,
        /// Where in the file, in bytes.
        offset: u64,
    },
    /// A line of a text says what cannot be taken.
    #[error("{}line {line}: {what}", at(variable))]
    Line {
        /// The variable.
        variable: String,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong, and what to write instead.
        what: String,
    },
    /// The format allows it, this program does not read it.
    #[error("{}{what} cannot be read; {remedy}", at(variable))]
    Unsupported {
        /// The variable.
        variable: String,
        /// What it is.
        what: String,
        /// How to come by the data all the same.
        remedy: String,
    },
    /// The file holds, or claims to hold, more than is read.
    #[error(
        "{}this would take more than {most_mib} MiB of memory, which is the most that is read; split the file",
        at(variable)
    )]
    TooLarge {
        /// The variable.
        variable: String,
        /// The limit \[MiB\].
        most_mib: u64,
    },
    /// Values lie in values, deeper than anything that is read, or in a circle.
    #[error("{}values are nested too deeply, or contain themselves", at(variable))]
    TooDeep {
        /// The variable.
        variable: String,
    },
    /// A name stands twice.
    #[error("the name \"{name}\" stands twice; rename one")]
    Duplicate {
        /// The name.
        name: String,
    },
    /// The reader was stopped.
    #[error("stopped")]
    Stopped,
}

fn at(variable: &str) -> String {
    if variable.is_empty() { String::new() } else { format!("variable {variable}: ") }
}
