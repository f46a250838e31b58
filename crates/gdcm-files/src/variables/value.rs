//! One value of a file of variables.

use super::array::Array;

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
