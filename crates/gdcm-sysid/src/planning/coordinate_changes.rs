//! Computes the directions in `[[A, B], [C, D]]` that only change the state coordinates.
//!
//! ```text
//! dA = A X - X A,   dB = -X B,   dC = C X,   dD = 0     for each X = e_i e_j'
//! ```

use nalgebra::DMatrix;

use crate::likelihood::schur_model::SchurModel;

/// Returns `N`: a column for each of the n^2 coordinate changes, a row for each entry in `[[A, B],
/// [C, D]]`, column after column.
pub(super) fn coordinate_changes(model: &SchurModel) -> DMatrix<f64> {
    let order = model.order();
    let (outputs, inputs) = model.d().shape();
    let rows = order + outputs;
    let mut changes = DMatrix::zeros(rows * (order + inputs), order * order);
    for i in 0..order {
        for j in 0..order {
            let mut change = changes.column_mut(j * order + i);
            // A X and C X: column i in A and C becomes column j.
            for row in 0..order {
                change[j * rows + row] += model.a()[(row, i)];
            }
            for output in 0..outputs {
                change[j * rows + order + output] += model.c()[(output, i)];
            }
            // X A and X B: row j of A and B becomes row i.
            for column in 0..order {
                change[column * rows + i] -= model.a()[(j, column)];
            }
            for input in 0..inputs {
                change[(order + input) * rows + i] -= model.b()[(j, input)];
            }
        }
    }
    changes
}
