//! Model entries that are too large for computations.

use nalgebra::DMatrix;

use crate::dataset::StateSpace;

/// Maximum entry magnitude accepted in computations. Products of three matrices, even in state
/// units that differ by factors up to 2^100, then remain far below the largest `f64`. Entries in
/// helicopter models are far smaller.
pub const LARGEST_ENTRY: f64 = 1e75;

/// An entry in a model's matrices beyond [`LARGEST_ENTRY`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "matrix {matrix} of the model has {value:e} in row {row}, column {column}; the limit for \
    computations is {LARGEST_ENTRY:e}"
)]
pub struct LargeEntry {
    /// `A`, `B`, `C` or `D`.
    pub matrix: char,
    /// Row, counted from 1.
    pub row: usize,
    /// Column, counted from 1.
    pub column: usize,
    pub value: f64,
}

impl LargeEntry {
    /// Returns the first entry that is too large; `None` if there is none.
    pub fn find(model: &StateSpace) -> Option<Self> {
        let matrices = [
            ('A', model.a()),
            ('B', model.b()),
            ('C', model.c()),
            ('D', model.d()),
        ];
        matrices
            .into_iter()
            .find_map(|(name, matrix)| Self::find_in(name, matrix))
    }

    fn find_in(name: char, matrix: &DMatrix<f64>) -> Option<Self> {
        let index = matrix
            .iter()
            .position(|value| value.abs() > LARGEST_ENTRY)?;
        let (row, column) = matrix.vector_to_matrix_index(index);
        Some(Self {
            matrix: name,
            row: row + 1,
            column: column + 1,
            value: matrix[index],
        })
    }
}
