//! Reasons why a value in MATLAB or Octave statements cannot be read. The value becomes opaque
//! ([`Value::Opaque`](crate::formats::variables::Value::Opaque)); the other statements are read.

use gdcm_model::number_format::counted;

/// Remedy in messages about unsupported statements.
const REMEDY: &str = "write the numbers, or save the workspace in MATLAB: save -v7 workspace.mat";

/// Reason why a value in MATLAB or Octave statements cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MatlabFault {
    #[error("the string that begins here is not closed; close it with {quote}")]
    OpenString { quote: char },
    #[error("the bracket is never closed; close it")]
    OpenBracket,
    #[error("\"{text}\" is not a number; correct it")]
    NotANumber { text: String },
    #[error("a value is missing here; write it")]
    MissingValue,
    #[error("this is not a number, string or matrix; {REMEDY}")]
    NotAValue,
    #[error("expressions are not evaluated; {REMEDY}")]
    Expression,
    /// An anonymous function or a function handle.
    #[error("functions are not supported; {REMEDY}")]
    FunctionHandle,
    #[error("{function}(…) is not evaluated; {REMEDY}")]
    FunctionCall { function: String },
    #[error("{function}(…) is supported only with numbers of rows and columns; {REMEDY}")]
    FunctionDimensions { function: String },
    #[error("{function}(…) needs numbers for {}; write them as numbers", names.join(", "))]
    FunctionArguments {
        function: String,
        /// Names of the required arguments.
        names: Vec<&'static str>,
    },
    #[error("names and values must alternate: {function}(…,'InputName',{{'LAT'}})")]
    NamesAndValues { function: String },
    #[error(
        "struct(…) with cells creates a struct array, which is not supported; write s.name = {{…}} \
        instead"
    )]
    StructArray,
    #[error(
        "row {row} has {}, but the first row has {expected}; complete the shorter row",
        counted(*found, "column")
    )]
    RowLength {
        /// Row number, from 1.
        row: usize,
        /// Number of columns in this row.
        found: usize,
        /// Number of columns in the first row.
        expected: usize,
    },
    #[error("numbers and strings cannot be mixed in brackets; write {{…}} instead of […]")]
    MixedBrackets,
    #[error("strings in brackets are not joined; write {{'A', 'B'}}")]
    StringsInBrackets,
    #[error("only numbers are supported in brackets; {REMEDY}")]
    NotANumberInBrackets,
    #[error("the name of a variable is missing; write it")]
    MissingName,
    #[error("{name} has not been assigned; write its value")]
    NotAssigned { name: String },
    #[error("{path} has no field {field}; assign the field first")]
    NoField { path: String, field: String },
    /// The value is a copy of a variable or field that could not be read itself.
    #[error("{path} itself could not be read; write the value here")]
    CopyOfUnread { path: String },
    #[error(
        "the variable is set inside an if, switch or loop, which is not executed; set it outside"
    )]
    InBlock,
    #[error("only a part of the variable is set here; write the whole value in one statement")]
    PartSet,
    #[error("the value is the result of a function, which is not executed; write the value")]
    FunctionResult,
}

impl MatlabFault {
    /// Returns the stable code by which scripts and tests distinguish the reasons.
    pub fn code(&self) -> &'static str {
        match self {
            Self::OpenString { .. } => "open-string",
            Self::OpenBracket => "open-bracket",
            Self::NotANumber { .. } => "not-a-number",
            Self::MissingValue => "missing-value",
            Self::NotAValue => "not-a-value",
            Self::Expression => "expression",
            Self::FunctionHandle => "function-handle",
            Self::FunctionCall { .. } => "function-call",
            Self::FunctionDimensions { .. } => "function-dimensions",
            Self::FunctionArguments { .. } => "function-arguments",
            Self::NamesAndValues { .. } => "names-and-values",
            Self::StructArray => "struct-array",
            Self::RowLength { .. } => "row-length",
            Self::MixedBrackets => "mixed-brackets",
            Self::StringsInBrackets => "strings-in-brackets",
            Self::NotANumberInBrackets => "not-a-number-in-brackets",
            Self::MissingName => "missing-name",
            Self::NotAssigned { .. } => "not-assigned",
            Self::NoField { .. } => "no-field",
            Self::CopyOfUnread { .. } => "copy-of-unread",
            Self::InBlock => "in-block",
            Self::PartSet => "part-set",
            Self::FunctionResult => "function-result",
        }
    }
}
