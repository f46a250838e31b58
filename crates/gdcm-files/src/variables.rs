//! Variables by name, as files of other programs hold them; what they mean is decided elsewhere.
//!
//! Every reader of such files (MATLAB's, NumPy's, text) gives these values and knows nothing of models.

use gdcm_core::message_text::shortened_name;

pub use crate::reading_budget::ReadingBudget;

// Numbers in an array of any number of dimensions.

/// What the numbers were in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// IEEE 754 numbers of 32 or 64 bits.
    Float,
    /// Whole numbers, signed or not.
    Integer,
    /// True and false, as 1 and 0.
    Logical,
}

/// Numbers in an array, the first index running fastest (column by column).
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Number of elements along each dimension, at least two (a scalar is 1 x 1).
    pub shape: Vec<usize>,
    /// What the numbers were.
    pub kind: ElementKind,
    /// The numbers, or their real parts. NaN and infinities are kept: who uses the numbers refuses them with their place.
    pub re: Vec<f64>,
    /// Imaginary parts, as many, of complex numbers.
    pub im: Option<Vec<f64>>,
}

impl Array {
    /// A real matrix, given column by column.
    pub fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> Self {
        debug_assert_eq!(rows * columns, values.len());
        Self { shape: vec![rows, columns], kind: ElementKind::Float, re: values, im: None }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.re.len()
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.re.is_empty()
    }
}

// One value of a file of variables.

/// A value under its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The name, as it stands in the file.
    pub name: String,
    /// The value.
    pub value: Value,
}

/// One value, whatever file it comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Numbers; sparse ones are filled up with zeros.
    Array(Array),
    /// Characters.
    Text(TextArray),
    /// Values of any kind in an array.
    Cell(CellArray),
    /// Records with the same fields in an array.
    Struct(StructArray),
    /// An object of a class, as far as it could be decoded.
    Object(Object),
    /// What is there but cannot be read.
    Opaque {
        /// Its class, or what it is in words.
        class: String,
        /// Why it cannot be read.
        why: String,
    },
}

/// Texts: the rows of an array of characters, or an array of strings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextArray {
    /// Number of texts along each dimension.
    pub shape: Vec<usize>,
    /// The texts, the first index running fastest. Rows of characters keep the blanks that fill them up.
    pub texts: Vec<String>,
}

/// Values in an array, the first index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct CellArray {
    /// Number of values along each dimension.
    pub shape: Vec<usize>,
    /// The values.
    pub values: Vec<Value>,
}

/// Records in an array, the first index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct StructArray {
    /// Number of records along each dimension.
    pub shape: Vec<usize>,
    /// The fields in their order: name, and one value for each record.
    pub fields: Vec<(String, Vec<Value>)>,
}

/// What a record counts for beside its fields while files are read, also where it has none \[bytes\].
pub(crate) const RECORD: u64 = 64;

/// An object of a class, or several of the same class in an array.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Name of the class: "ss", "idss", "string".
    pub class: String,
    /// The objects and their properties.
    pub records: StructArray,
}

impl Value {
    /// What this is, in words fit for a message: "a 3 x 4 array of numbers".
    pub fn words(&self) -> String {
        let by = |shape: &[usize]| shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
        match self {
            Value::Array(array) if array.im.is_some() => format!("a {} array of complex numbers", by(&array.shape)),
            Value::Array(array) => format!("a {} array of numbers", by(&array.shape)),
            Value::Text(text) if text.texts.len() == 1 => "a text".to_owned(),
            Value::Text(text) => format!("{} texts", text.texts.len()),
            Value::Cell(cell) => format!("a {} cell array", by(&cell.shape)),
            Value::Struct(records) => format!("a {} struct array", by(&records.shape)),
            Value::Object(object) => format!("a {} array of {} objects", by(&object.records.shape), object.class),
            Value::Opaque { class, .. } => format!("{class}, which cannot be read"),
        }
    }
}

impl StructArray {
    /// The values of a field, one for each record.
    pub fn field(&self, name: &str) -> Option<&[Value]> {
        self.fields.iter().find(|(field, _)| field == name).map(|(_, values)| values.as_slice())
    }
}

// Why variables could not be read from a file.

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
        /// How to come by the data all the same, with `{file}` and `{stem}` in the place of the file's name with and without its ending.
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
    /// Reading the file would take longer than any file of data does.
    #[error(
        "{}this would take more than {most_millions} million steps of work, which is the most that is read; split the file",
        at(variable)
    )]
    TooMuchWork {
        /// The variable.
        variable: String,
        /// The limit \[million steps\].
        most_millions: u64,
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

impl VariableFault {
    /// Whether the budget ends the reading: nothing else of the file is to be tried.
    pub fn is_of_the_budget(&self) -> bool {
        matches!(self, Self::TooLarge { .. } | Self::TooMuchWork { .. } | Self::Stopped)
    }
}

fn at(variable: &str) -> String {
    if variable.is_empty() { String::new() } else { format!("variable {}: ", shortened_name(variable)) }
}
