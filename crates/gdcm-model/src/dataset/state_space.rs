//! A linear time-invariant model in state-space form.

use nalgebra::DMatrix;

pub use super::timing::{GREATEST_CHANNEL_DELAY_S, Timing, TimingError};

/// A linear model `x' = A x + B u`, `y = C x + D u`, with `n` states, `m` inputs and `p` outputs;
/// discrete-time, or with delayed channels, according to its [`Timing`] (M2a).
///
/// Shapes are checked at construction: `A` n x n, `B` n x m, `C` p x n, `D` p x m, all entries
/// finite. Without states (`n = 0`), the model is the static gain `D`.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    timing: Timing,
}

/// Error for matrices that do not form a state-space model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateSpaceError {
    /// A matrix whose shape contradicts the other matrices' shapes.
    #[error("matrix {matrix}: expected {} x {}, found {} x {}", expected.0, expected.1, found.0, found.1)]
    Shape {
        /// `A`, `B`, `C` or `D`.
        matrix: char,
        /// Required rows and columns.
        expected: (usize, usize),
        /// Row count and column count.
        found: (usize, usize),
    },
    #[error("matrix {matrix}, row {row}, column {column}: expected a finite number, found {value}")]
    NotFinite {
        /// `A`, `B`, `C` or `D`.
        matrix: char,
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        column: usize,
        value: f64,
    },
    #[error(transparent)]
    Timing(#[from] TimingError),
}

impl StateSpaceError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Shape { .. } => "matrix-shape",
            Self::NotFinite { .. } => "matrix-not-finite",
            Self::Timing(error) => error.code(),
        }
    }
}

impl StateSpace {
    /// Creates the continuous-time model (A, B, C, D). `A` determines the state count; `D`
    /// determines the output and input counts.
    ///
    /// # Errors
    /// [`StateSpaceError`] for a matrix with a wrong shape, or an entry that is not finite.
    pub fn new(
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        c: DMatrix<f64>,
        d: DMatrix<f64>,
    ) -> Result<Self, StateSpaceError> {
        let n = a.nrows();
        let p = d.nrows();
        let m = d.ncols();
        check_shape('A', &a, (n, n))?;
        check_shape('B', &b, (n, m))?;
        check_shape('C', &c, (p, n))?;
        check_finite('A', &a)?;
        check_finite('B', &b)?;
        check_finite('C', &c)?;
        check_finite('D', &d)?;
        Ok(Self {
            a,
            b,
            c,
            d,
            timing: Timing::default(),
        })
    }

    /// Returns the model with a sample time or delays (M2a).
    ///
    /// # Errors
    /// [`StateSpaceError::Timing`] if they are out of range, or if the delay count differs from the
    /// channel count.
    pub fn timed(mut self, timing: Timing) -> Result<Self, StateSpaceError> {
        self.timing = timing.checked(self.outputs(), self.inputs())?;
        Ok(self)
    }

    /// Returns the sample time and delays; delays that are all zero are represented by `None`.
    pub fn timing(&self) -> &Timing {
        &self.timing
    }

    /// Returns the system matrix, n x n.
    pub fn a(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// Returns the input matrix, n x m.
    pub fn b(&self) -> &DMatrix<f64> {
        &self.b
    }

    /// Returns the output matrix, p x n.
    pub fn c(&self) -> &DMatrix<f64> {
        &self.c
    }

    /// Returns the feed-through matrix, p x m.
    pub fn d(&self) -> &DMatrix<f64> {
        &self.d
    }

    /// Returns the state count, `n`.
    pub fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Returns the input count, `m`.
    pub fn inputs(&self) -> usize {
        self.d.ncols()
    }

    /// Returns the output count, `p`.
    pub fn outputs(&self) -> usize {
        self.d.nrows()
    }
}

fn check_shape(
    name: char,
    matrix: &DMatrix<f64>,
    expected: (usize, usize),
) -> Result<(), StateSpaceError> {
    if matrix.shape() == expected {
        return Ok(());
    }
    Err(StateSpaceError::Shape {
        matrix: name,
        expected,
        found: matrix.shape(),
    })
}

fn check_finite(name: char, matrix: &DMatrix<f64>) -> Result<(), StateSpaceError> {
    let Some(index) = matrix.iter().position(|value| !value.is_finite()) else {
        return Ok(());
    };
    let (row, column) = matrix.vector_to_matrix_index(index);
    Err(StateSpaceError::NotFinite {
        matrix: name,
        row: row + 1,
        column: column + 1,
        value: matrix[index],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_of_the_wrong_shape_is_named() {
        let error = StateSpace::new(
            DMatrix::zeros(2, 2),
            DMatrix::zeros(3, 1),
            DMatrix::zeros(1, 2),
            DMatrix::zeros(1, 1),
        )
        .unwrap_err();
        assert_eq!(
            error,
            StateSpaceError::Shape {
                matrix: 'B',
                expected: (2, 1),
                found: (3, 1)
            }
        );
    }

    #[test]
    fn a_number_that_is_not_finite_is_named_with_its_row_and_column() {
        let mut c = DMatrix::zeros(3, 2);
        c[(2, 1)] = f64::NAN;
        let error = StateSpace::new(
            DMatrix::zeros(2, 2),
            DMatrix::zeros(2, 1),
            c,
            DMatrix::zeros(3, 1),
        )
        .unwrap_err();
        assert!(matches!(
            error,
            StateSpaceError::NotFinite {
                matrix: 'C',
                row: 3,
                column: 2,
                value,
            } if value.is_nan()
        ));
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
