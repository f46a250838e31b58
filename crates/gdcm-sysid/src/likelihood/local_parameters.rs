//! Independent parameters near a model: as many entries of `[[A, B], [C, D]]` as the response has
//! degrees of freedom.
//!
//! ```text
//! n states, m inputs, l outputs; G information matrix in all entries
//! Of the (n + l)(n + m) entries, k = n (m + l) + m l are determined; the other n^2 directions are
//! changes of coordinates, for which G is singular.
//! 1  G with columns of unit length
//! 2  for j = 1 ... k: the entry with the largest remaining diagonal; subtract its column of the
//!    Cholesky factor
//! ```
//!
//! With the other entries fixed, the selected entries move the response in all directions. The
//! statistics of responses, poles and cost do not depend on which entries are selected.
//!
//! Pivoted Cholesky factorisation: Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 4.2.8.

use nalgebra::{DMatrix, DVector};

use super::schur_model::SchurModel;

/// Remaining diagonal, with columns scaled to unit length, below which an entry only adds rounding
/// errors.
const LEAST_PIVOT: f64 = 1e-13;

/// An entry of `[[A, B], [C, D]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    /// States, then outputs.
    pub(crate) row: usize,
    /// States, then inputs.
    pub(crate) column: usize,
}

/// The selected entries of `[[A, B], [C, D]]`.
#[derive(Clone, Debug)]
pub(crate) struct LocalParameters {
    pub(crate) entries: Vec<Entry>,
    /// n + outputs.
    rows: usize,
    /// n + inputs.
    columns: usize,
}

impl LocalParameters {
    /// Selects the entries for a model (steps 1 and 2) with the information matrix `G` in all
    /// entries, column after column.
    pub(crate) fn select(model: &SchurModel, matrix: &DMatrix<f64>) -> Self {
        let (outputs, inputs) = model.d().shape();
        let rows = model.order() + outputs;
        let entries = pivots(matrix, model.parameters())
            .into_iter()
            .map(|place| Entry {
                row: place % rows,
                column: place / rows,
            });
        Self {
            entries: entries.collect(),
            rows,
            columns: model.order() + inputs,
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.entries.len()
    }

    /// Returns each entry's place in `[[A, B], [C, D]]`, column after column.
    pub(crate) fn places(&self) -> Vec<usize> {
        let places = self.entries.iter();
        places
            .map(|entry| entry.column * self.rows + entry.row)
            .collect()
    }

    /// Returns the step in `[[A, B], [C, D]]` for a step in the parameters.
    pub(crate) fn step(&self, parameters: &DVector<f64>) -> DMatrix<f64> {
        let mut step = DMatrix::zeros(self.rows, self.columns);
        for (entry, value) in self.entries.iter().zip(parameters.iter()) {
            step[(entry.row, entry.column)] = *value;
        }
        step
    }
}

/// Returns at most `count` pivots from the Cholesky factorisation of a positive semidefinite matrix
/// whose diagonal is scaled to 1.
fn pivots(matrix: &DMatrix<f64>, count: usize) -> Vec<usize> {
    let size = matrix.nrows();
    let diagonal = matrix.diagonal();
    // The scaled diagonal less what the chosen entries explain.
    let mut remaining = diagonal.map(|square| if square > 0.0 { 1.0 } else { 0.0 });
    let mut factor = DMatrix::<f64>::zeros(size, count);
    let mut chosen = Vec::with_capacity(count);
    for k in 0..count.min(size) {
        let pivot = remaining.imax();
        if remaining[pivot] <= LEAST_PIVOT {
            break;
        }
        // Column k of the Cholesky factor.
        let mut column = matrix.column(pivot).into_owned();
        for (row, entry) in column.iter_mut().enumerate() {
            *entry /= (diagonal[row] * diagonal[pivot])
                .sqrt()
                .max(f64::MIN_POSITIVE);
        }
        let earlier_columns = factor.columns(0, k);
        let pivot_row = factor.row(pivot).columns(0, k).transpose();
        column.gemv(-1.0, &earlier_columns, &pivot_row, 1.0);
        column.unscale_mut(remaining[pivot].sqrt());
        for (remaining, entry) in remaining.iter_mut().zip(column.iter()) {
            *remaining -= entry * entry;
        }
        // Exactly zero, whatever rounding has left: no entry is chosen twice.
        for chosen_before in chosen.iter().chain([&pivot]) {
            remaining[*chosen_before] = 0.0;
        }
        factor.set_column(k, &column);
        chosen.push(pivot);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};

    use super::*;

    #[test]
    fn entries_that_depend_on_others_are_left_out() {
        // The third column is the sum of the first two, the fourth is zero.
        let factor = dmatrix![3.0, 0.0, 3.0, 0.0; 0.0, 2.0, 2.0, 0.0; 0.0, 0.0, 0.0, 0.0];
        let gram: DMatrix<f64> = factor.transpose() * factor;
        let chosen = pivots(&gram, 4);
        assert_eq!(chosen.len(), 2);
        assert!(!chosen.contains(&3));
    }
}
