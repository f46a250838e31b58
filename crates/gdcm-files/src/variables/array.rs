//! Numbers in an array of any number of dimensions.

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
