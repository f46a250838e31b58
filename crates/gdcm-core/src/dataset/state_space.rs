//! A linear time-invariant model in state-space form.

use nalgebra::DMatrix;

use super::timing::{Timing, TimingError};

/// A linear model `x' = A x + B u`, `y = C x + D u`, with `n` states, `m` inputs and `p` outputs; of discrete time, and with
/// delayed channels, where its [`Timing`] says so (M2a).
///
/// Shapes are checked at construction: `A` n x n, `B` n x m, `C` p x n, `D` p x m, all entries finite.
/// A model of order zero (`n = 0`) is the static gain `D`.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    timing: Timing,
}

/// Why four matrices are not a state-space model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateSpaceError {
    /// A matrix has another shape than the others require.
    #[error("matrix {matrix}: expected {expected_rows} x {expected_columns}, found {rows} x {columns}")]
    Shape {
        /// `A`, `B`, `C` or `D`.
        matrix: char,
        /// Rows required.
        expected_rows: usize,
        /// Columns required.
        expected_columns: usize,
        /// Rows found.
        rows: usize,
        /// Columns found.
        columns: usize,
    },
    /// An entry is NaN or infinite.
    #[error("matrix {matrix}, row {row}, column {column}: expected a finite number, found {value}")]
    NotFinite {
        /// `A`, `B`, `C` or `D`.
        matrix: char,
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        column: usize,
        /// What stands there.
        value: f64,
    },
    /// The sample time or the delays are wrong.
    #[error(transparent)]
    Timing(#[from] TimingError),
}

impl StateSpace {
    /// The model (A, B, C, D) of continuous time; the order is the rows of `A`, the inputs and outputs are the columns and rows
    /// of `D`.
    pub fn new(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>, d: DMatrix<f64>) -> Result<Self, StateSpaceError> {
        let (n, p, m) = (a.nrows(), d.nrows(), d.ncols());
        for (matrix, of, rows, columns) in [('A', &a, n, n), ('B', &b, n, m), ('C', &c, p, n)] {
            if of.shape() != (rows, columns) {
                return Err(StateSpaceError::Shape {
                    matrix,
                    expected_rows: rows,
                    expected_columns: columns,
                    rows: of.nrows(),
                    columns: of.ncols(),
                });
            }
        }
        for (matrix, of) in [('A', &a), ('B', &b), ('C', &c), ('D', &d)] {
            if let Some(at) = of.iter().position(|value| !value.is_finite()) {
                let (row, column) = of.vector_to_matrix_index(at);
                return Err(StateSpaceError::NotFinite { matrix, row: row + 1, column: column + 1, value: of[at] });
            }
        }
        Ok(Self { a, b, c, d, timing: Timing::default() })
    }

    /// The same matrices with a sample time or delays (M2a).
    ///
    /// # Errors
    /// [`TimingError`] where they are out of range or not one for each channel.
    pub fn timed(mut self, timing: Timing) -> Result<Self, StateSpaceError> {
        self.timing = timing.checked(self.outputs(), self.inputs())?;
        Ok(self)
    }

    /// Sample time and delays; delays that are all zero are none.
    pub fn timing(&self) -> &Timing {
        &self.timing
    }

    /// System matrix, n x n.
    pub fn a(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// Input matrix, n x m.
    pub fn b(&self) -> &DMatrix<f64> {
        &self.b
    }

    /// Output matrix, p x n.
    pub fn c(&self) -> &DMatrix<f64> {
        &self.c
    }

    /// Feed-through matrix, p x m.
    pub fn d(&self) -> &DMatrix<f64> {
        &self.d
    }

    /// Number of states, `n`.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Number of inputs, `m`.
    pub fn inputs(&self) -> usize {
        self.d.ncols()
    }

    /// Number of outputs, `p`.
    pub fn outputs(&self) -> usize {
        self.d.nrows()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_of_the_wrong_shape_is_named() {
        let error =
            StateSpace::new(DMatrix::zeros(2, 2), DMatrix::zeros(3, 1), DMatrix::zeros(1, 2), DMatrix::zeros(1, 1))
                .unwrap_err();
        assert_eq!(error.to_string(), "matrix B: expected 2 x 1, found 3 x 1");
    }

    #[test]
    fn a_number_that_is_not_finite_is_named_with_its_row_and_column() {
        let mut c = DMatrix::zeros(3, 2);
        c[(2, 1)] = f64::NAN;
        let error = StateSpace::new(DMatrix::zeros(2, 2), DMatrix::zeros(2, 1), c, DMatrix::zeros(3, 1)).unwrap_err();
        assert_eq!(error.to_string(), "matrix C, row 3, column 2: expected a finite number, found NaN");
    }

    #[test]
    fn a_model_of_order_zero_is_a_static_gain() {
        let model = StateSpace::new(
            DMatrix::zeros(0, 0),
            DMatrix::zeros(0, 2),
            DMatrix::zeros(1, 0),
            DMatrix::from_row_slice(1, 2, &[3.0, 4.0]),
        )
        .unwrap();
        assert_eq!((model.order(), model.inputs(), model.outputs()), (0, 2, 1));
    }
}
