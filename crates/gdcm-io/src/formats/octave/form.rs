//! Storage forms of values, which follow from the type names that GNU Octave writes: a "complex
//! matrix" has a matrix's parts, and two numbers for each element.

use crate::formats::stored_number::NumberClass;
use crate::formats::variables::{Array, ElementKind};

/// Number type in the binary encoding; the size is in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StorageType {
    pub(super) class: NumberClass,
    pub(super) size: usize,
}

/// Type of the elements in an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Element {
    /// Storage type in the binary encoding. `None` for floats: a byte before the numbers gives
    /// their storage type.
    pub(super) storage: Option<StorageType>,
    /// Whether each number has an imaginary part.
    pub(super) is_complex: bool,
}

/// Real parts, and imaginary parts for complex numbers.
pub(super) struct NumberParts {
    pub(super) re: Vec<f64>,
    pub(super) im: Option<Vec<f64>>,
}

impl Element {
    pub(super) const FLOAT: Self = Self {
        storage: None,
        is_complex: false,
    };

    pub(super) fn kind(self) -> ElementKind {
        match self.storage {
            None => ElementKind::Float,
            Some(storage) if storage.class == NumberClass::Logical => ElementKind::Logical,
            Some(_) => ElementKind::Integer,
        }
    }

    /// Separates real and imaginary parts, which alternate in `numbers` if the elements are
    /// complex.
    pub(super) fn parts(self, numbers: Vec<f64>) -> NumberParts {
        if !self.is_complex {
            return NumberParts {
                re: numbers,
                im: None,
            };
        }
        NumberParts {
            re: numbers.iter().step_by(2).copied().collect(),
            im: Some(numbers.iter().skip(1).step_by(2).copied().collect()),
        }
    }

    /// Returns an array from numbers in column-major order.
    pub(super) fn array(self, shape: Vec<usize>, numbers: Vec<f64>) -> Array {
        let NumberParts { re, im } = self.parts(numbers);
        Array {
            shape,
            kind: self.kind(),
            re,
            im,
        }
    }
}

/// Storage form of a value, on which its parts depend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Scalar(Element),
    Matrix(Element),
    /// Diagonal matrix; text and binary files store only the diagonal, HDF5 files the full matrix.
    Diagonal(Element),
    /// Sparse matrix; only the nonzero numbers are stored.
    Sparse(Element),
    /// Equally spaced numbers, stored as first number, limit and step.
    Range,
    Text,
    Cell,
    ScalarStruct,
    StructArray,
    /// Object of an old-style (`@` folder) class.
    Class,
}

impl Form {
    /// Returns the form for a type name, such as "matrix", "float complex scalar", "uint8 matrix"
    /// or "sparse bool matrix"; `None` for an unknown name.
    pub(super) fn from_type_name(name: &str) -> Option<Self> {
        match name {
            "string" | "sq_string" | "null_string" | "null_sq_string" => Some(Self::Text),
            "cell" => Some(Self::Cell),
            "scalar struct" => Some(Self::ScalarStruct),
            "struct" => Some(Self::StructArray),
            "class" | "object" => Some(Self::Class),
            "range" | "double_range" => Some(Self::Range),
            _ => Self::from_number_words(name),
        }
    }

    /// Interprets the words in a numeric type name: some give the element type, others the form.
    /// Without a word for the form, only "bool" (a scalar) and "null_matrix" are known. Returns
    /// `None` if a word or the name is unknown.
    fn from_number_words(name: &str) -> Option<Self> {
        let mut element = Element::FLOAT;
        // Variant that the words require; its element is complete only after the last word.
        let mut form: Option<fn(Element) -> Self> = None;
        for word in name.split(' ') {
            match word {
                "float" | "null" | "null_matrix" => {}
                "complex" => element.is_complex = true,
                "bool" => {
                    element.storage = Some(StorageType {
                        class: NumberClass::Logical,
                        size: 1,
                    });
                }
                "diagonal" => form = Some(Self::Diagonal),
                "sparse" => form = Some(Self::Sparse),
                "scalar" => form = Some(Self::Scalar),
                // "diagonal matrix" and "sparse matrix" keep their first word's form.
                "matrix" => form = form.or(Some(Self::Matrix)),
                _ => element.storage = Some(integer_storage(word)?),
            }
        }
        match (form, name) {
            (Some(form), _) => Some(form(element)),
            (None, "bool") => Some(Self::Scalar(element)),
            (None, "null_matrix") => Some(Self::Matrix(element)),
            _ => None,
        }
    }
}

/// Returns the storage type for an integer type name, such as "int8" or "uint64".
fn integer_storage(name: &str) -> Option<StorageType> {
    let size = match name.trim_start_matches('u').strip_prefix("int")? {
        "8" => 1,
        "16" => 2,
        "32" => 4,
        "64" => 8,
        _ => return None,
    };
    let class = if name.starts_with('u') {
        NumberClass::Unsigned
    } else {
        NumberClass::Signed
    };
    Some(StorageType { class, size })
}
