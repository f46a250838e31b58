//! Named variables from other programs' files.
//!
//! The readers of formats with named values (such as MATLAB, NumPy and JSON) return these; `import`
//! determines which of them are models or flight records. In this file, a *record* is an element of
//! a struct array.

use crate::variable_fault::unread::Unread;

/// Memory charged for a record in addition to its fields \[bytes\], so that records without fields
/// also count.
pub(crate) const RECORD_MEMORY: u64 = 64;
/// Memory charged for a field in addition to its name and values \[bytes\].
const FIELD_MEMORY: usize = 48;

/// Kind of the elements in an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// Floating-point numbers with 16, 32 or 64 bits.
    Float,
    Integer,
    /// Logical values, as 1 and 0.
    Logical,
}

/// Array of numbers in column-major order (first index fastest).
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Length along each dimension; there are at least two dimensions (a scalar is 1 x 1).
    pub shape: Vec<usize>,
    pub kind: ElementKind,
    /// Numbers, or real parts for complex numbers. NaN and infinities are kept; code that uses the
    /// numbers reports their positions.
    pub re: Vec<f64>,
    /// Imaginary parts, as many as real parts; `None` for real numbers.
    pub im: Option<Vec<f64>>,
}

impl Array {
    /// Creates a real matrix from its numbers in column-major order.
    pub fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> Self {
        debug_assert_eq!(rows * columns, values.len());
        Self {
            shape: vec![rows, columns],
            kind: ElementKind::Float,
            re: values,
            im: None,
        }
    }

    /// Returns the element count.
    pub fn len(&self) -> usize {
        self.re.len()
    }

    /// Returns whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.re.is_empty()
    }
}

/// Index that selects a matrix, called *page*, in an array with three dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PageIndex {
    /// `A[k,:,:]`, as in NumPy and JSON.
    First,
    /// `A(:,:,k)`, as in MATLAB.
    Last,
}

/// Value with its name; readers name a value that has no name in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub name: String,
    pub value: Value,
}

/// Value of a variable, or inside another value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Numbers; a sparse matrix is expanded to a full matrix.
    Array(Array),
    Text(TextArray),
    Cell(CellArray),
    Struct(StructArray),
    /// Object of a class, as far as it could be decoded.
    Object(Object),
    /// Value that could not be read.
    Opaque {
        /// Class name, or a description.
        class: String,
        /// Reason why the value could not be read.
        why: Box<Unread>,
    },
}

/// Array of strings, for example the rows of a character array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextArray {
    /// Length along each dimension; there are at least two dimensions.
    pub shape: Vec<usize>,
    /// Strings in column-major order. Rows of a character array keep blanks at their ends.
    pub texts: Vec<String>,
}

/// Array of values of any kind, in column-major order.
#[derive(Clone, Debug, PartialEq)]
pub struct CellArray {
    /// Length along each dimension; there are at least two dimensions.
    pub shape: Vec<usize>,
    pub values: Vec<Value>,
}

/// Array of records with the same fields, in column-major order.
#[derive(Clone, Debug, PartialEq)]
pub struct StructArray {
    /// Length along each dimension; there are at least two dimensions.
    pub shape: Vec<usize>,
    /// Fields in file order: name, and a value for each record.
    pub fields: Vec<(String, Vec<Value>)>,
}

/// Object of a class, or an array of such objects.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Class name, such as "ss", "idss" or "string".
    pub class: String,
    pub records: StructArray,
}

impl TextArray {
    /// Creates a 1 x 1 array from a string.
    pub fn one(text: impl Into<String>) -> Self {
        Self {
            shape: vec![1, 1],
            texts: vec![text.into()],
        }
    }
}

impl Value {
    /// Creates a value with a single string.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(TextArray::one(text))
    }

    /// Creates a 1 x 1 array from a real number.
    pub fn number(number: f64) -> Self {
        Self::Array(Array::matrix(1, 1, vec![number]))
    }

    /// Creates a 1 x 1 logical array.
    pub fn truth(truth: bool) -> Self {
        let number = f64::from(u8::from(truth));
        Self::Array(Array {
            kind: ElementKind::Logical,
            ..Array::matrix(1, 1, vec![number])
        })
    }

    /// Creates a 0 x 0 array.
    pub fn empty() -> Self {
        Self::Array(Array::matrix(0, 0, Vec::new()))
    }

    /// Creates an opaque value; `why` is the reason why it could not be read.
    pub fn opaque(class: impl Into<String>, why: Unread) -> Self {
        Self::Opaque {
            class: class.into(),
            why: Box::new(why),
        }
    }

    /// Iterates over the values that this value directly contains.
    pub(crate) fn inner(&self) -> impl Iterator<Item = &Self> {
        let cells: &[Self] = match self {
            Self::Cell(cell) => &cell.values,
            _ => &[],
        };
        let fields: &[(String, Vec<Self>)] = match self {
            Self::Struct(records) | Self::Object(Object { records, .. }) => &records.fields,
            _ => &[],
        };
        cells
            .iter()
            .chain(fields.iter().flat_map(|(_, values)| values))
    }

    /// Estimates this value's memory \[bytes\], without the values that it contains.
    pub(crate) fn own_memory(&self) -> u64 {
        let bytes = match self {
            Self::Array(array) => {
                let number = if array.im.is_some() { 16 } else { 8 };
                size_of_val(array.shape.as_slice()) + array.len() * number
            }
            Self::Text(texts) => {
                let letters: usize = texts.texts.iter().map(|text| text_memory(text)).sum();
                size_of_val(texts.shape.as_slice()) + letters
            }
            Self::Cell(cell) => size_of_val(cell.shape.as_slice()),
            Self::Struct(records) => {
                let names: usize = records
                    .fields
                    .iter()
                    .map(|(name, _)| FIELD_MEMORY + text_memory(name))
                    .sum();
                size_of_val(records.shape.as_slice()) + names
            }
            Self::Object(object) => {
                size_of_val(object.records.shape.as_slice()) + text_memory(&object.class)
            }
            Self::Opaque { class, why } => {
                text_memory(class) + size_of::<Unread>() + why.to_string().len()
            }
        };
        (size_of::<Self>() + bytes) as u64
    }

    /// Describes the value for a message: "a 3 x 4 array of numbers".
    pub fn words(&self) -> String {
        match self {
            Value::Array(array) if array.im.is_some() => {
                format!("a {} array of complex numbers", dimensions(&array.shape))
            }
            Value::Array(array) => format!("a {} array of numbers", dimensions(&array.shape)),
            Value::Text(text) if text.texts.len() == 1 => "a string".to_owned(),
            Value::Text(text) => format!("{} strings", text.texts.len()),
            Value::Cell(cell) => format!("a {} cell array", dimensions(&cell.shape)),
            Value::Struct(records) => format!("a {} struct array", dimensions(&records.shape)),
            Value::Object(object) => format!(
                "a {} array of {} objects",
                dimensions(&object.records.shape),
                object.class
            ),
            Value::Opaque { class, .. } => format!("{class}, which cannot be read"),
        }
    }
}

/// Returns a string's memory \[bytes\].
fn text_memory(text: &str) -> usize {
    size_of::<String>() + text.len()
}

/// Formats array dimensions: "3 x 4".
fn dimensions(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    sides.join(" x ")
}

impl StructArray {
    /// Creates a 1 x 1 array from a record's fields.
    pub fn one(fields: Vec<(String, Vec<Value>)>) -> Self {
        Self {
            shape: vec![1, 1],
            fields,
        }
    }

    /// Returns a field's values, in record order; `None` if there is no such field.
    pub fn field(&self, name: &str) -> Option<&[Value]> {
        self.fields
            .iter()
            .find(|(field, _)| field == name)
            .map(|(_, values)| values.as_slice())
    }
}
