//! Named variables in files from other programs; their meaning is determined elsewhere.
//!
//! All readers of such files (MATLAB, NumPy, text) return these values and know nothing about
//! models.

/// Number type in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// IEEE 754 numbers with 32 or 64 bits.
    Float,
    /// Signed or unsigned integers.
    Integer,
    /// True and false, as 1 and 0.
    Logical,
}

/// Numbers in an array, the first index running fastest (column by column).
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Length of each dimension; there are at least two dimensions (a scalar is 1 x 1).
    pub shape: Vec<usize>,
    pub kind: ElementKind,
    /// The numbers, or their real parts. NaN and infinities are kept: code that uses the numbers
    /// rejects them with their place.
    pub re: Vec<f64>,
    /// Imaginary parts if the numbers are complex; as many as real parts.
    pub im: Option<Vec<f64>>,
}

impl Array {
    /// Creates a real matrix from its values by columns.
    pub fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> Self {
        debug_assert_eq!(rows * columns, values.len());
        Self {
            shape: vec![rows, columns],
            kind: ElementKind::Float,
            re: values,
            im: None,
        }
    }

    /// Counts the elements.
    pub fn len(&self) -> usize {
        self.re.len()
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.re.is_empty()
    }
}

/// A value with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub name: String,
    pub value: Value,
}

/// Content of a variable, by kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Numbers; sparse arrays are expanded with zeros.
    Array(Array),
    Text(TextArray),
    /// Values of any kind.
    Cell(CellArray),
    Struct(StructArray),
    /// An object of a class, as far as it could be decoded.
    Object(Object),
    /// An unreadable value.
    Opaque {
        /// Its class, or a description.
        class: String,
        /// The reason why it cannot be read.
        why: String,
    },
}

/// Texts: the rows of a character array, or an array of strings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextArray {
    /// Length of each dimension.
    pub shape: Vec<usize>,
    /// The texts, the first index running fastest. Rows of characters keep their padding blanks.
    pub texts: Vec<String>,
}

/// Values of any kind, the first index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct CellArray {
    /// Length of each dimension.
    pub shape: Vec<usize>,
    pub values: Vec<Value>,
}

/// Records with the same fields, the first index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct StructArray {
    /// Length of each dimension.
    pub shape: Vec<usize>,
    /// The fields in order: name, and a value for each record.
    pub fields: Vec<(String, Vec<Value>)>,
}

/// Memory charged for a record besides its fields while files are read, even without fields
/// \[bytes\].
pub(crate) const RECORD: u64 = 64;

/// Memory charged for a field besides its name and values \[bytes\].
const FIELD: usize = 48;

/// An object of a class, or an array of such objects.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Class name: "ss", "idss", "string".
    pub class: String,
    pub records: StructArray,
}

impl TextArray {
    /// Creates an array with a single text.
    pub fn one(text: impl Into<String>) -> Self {
        Self {
            shape: vec![1, 1],
            texts: vec![text.into()],
        }
    }
}

impl Value {
    /// Creates a text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(TextArray::one(text))
    }

    /// Creates a real number.
    pub fn number(number: f64) -> Self {
        Self::Array(Array::matrix(1, 1, vec![number]))
    }

    /// Creates a logical value.
    pub fn truth(truth: bool) -> Self {
        let number = f64::from(u8::from(truth));
        Self::Array(Array {
            kind: ElementKind::Logical,
            ..Array::matrix(1, 1, vec![number])
        })
    }

    /// Creates an array without elements.
    pub fn empty() -> Self {
        Self::Array(Array::matrix(0, 0, Vec::new()))
    }

    /// Creates an unreadable value with the reason.
    pub fn opaque(class: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Opaque {
            class: class.into(),
            why: why.into(),
        }
    }

    /// Iterates over the values inside this value.
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

    /// Returns its memory, excluding inner values, rounded up \[bytes\].
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
                    .map(|(name, _)| FIELD + text_memory(name))
                    .sum();
                size_of_val(records.shape.as_slice()) + names
            }
            Self::Object(object) => {
                size_of_val(object.records.shape.as_slice()) + text_memory(&object.class)
            }
            Self::Opaque { class, why } => text_memory(class) + text_memory(why),
        };
        (size_of::<Self>() + bytes) as u64
    }

    /// Describes the value in a message: "a 3 x 4 array of numbers".
    pub fn words(&self) -> String {
        match self {
            Value::Array(array) if array.im.is_some() => {
                format!("a {} array of complex numbers", dimensions(&array.shape))
            }
            Value::Array(array) => format!("a {} array of numbers", dimensions(&array.shape)),
            Value::Text(text) if text.texts.len() == 1 => "a text".to_owned(),
            Value::Text(text) => format!("{} texts", text.texts.len()),
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

/// Returns the memory of a text \[bytes\].
fn text_memory(text: &str) -> usize {
    size_of::<String>() + text.len()
}

/// Formats dimensions: "3 x 4".
fn dimensions(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
    sides.join(" x ")
}

impl StructArray {
    /// Creates a single record.
    pub fn one(fields: Vec<(String, Vec<Value>)>) -> Self {
        Self {
            shape: vec![1, 1],
            fields,
        }
    }

    /// Returns the values of a field, in the order of the records.
    pub fn field(&self, name: &str) -> Option<&[Value]> {
        self.fields
            .iter()
            .find(|(field, _)| field == name)
            .map(|(_, values)| values.as_slice())
    }
}
