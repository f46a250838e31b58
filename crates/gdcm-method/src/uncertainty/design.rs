//! Least squares over the conditions: design matrix, fit, hat values and leave-one-out errors.
//!
//! ```text
//! X = Q R,   coefficients R^-1 Q' y,   residuals e = y - Q Q' y
//! hat value h_c = |q_c|^2, q_c the row of Q;   leverage of any row x: x' (X'X)^-1 x = |R'^-1 x|^2
//! leave-one-out error e_c / (1 - h_c)
//! ```
//!
//! `X` has a row for each condition c and a column for each coefficient, `y` a value for each
//! condition.

use nalgebra::{DMatrix, DVector};

/// A column is linearly dependent if its part orthogonal to the columns before it is smaller than
/// this, relative to its norm.
const DEPENDENT: f64 = 1e-9;

/// Maximum column count in a design; a lookup table over more airspeeds has neither a variance
/// split nor bands.
pub const MOST_COLUMNS: usize = 200;

/// Design matrix `X` with full column rank, n conditions by r columns, stored as `Q R`.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Orthonormal columns, n x r.
    q: DMatrix<f64>,
    /// Upper triangular, r x r.
    r: DMatrix<f64>,
}

impl Design {
    /// Factorises the design, with a row for each condition. `None` if there are no columns, more
    /// columns than rows or than `MOST_COLUMNS`, or linearly dependent columns.
    pub fn new(rows: &[Vec<f64>]) -> Option<Self> {
        let columns = rows.first()?.len();
        if rows.len() < columns || columns == 0 || columns > MOST_COLUMNS {
            return None;
        }
        let matrix = DMatrix::from_fn(rows.len(), columns, |row, column| rows[row][column]);
        let lengths: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
        let qr = matrix.qr();
        let q = qr.q();
        let r = qr.r();
        for (column, length) in lengths.iter().enumerate() {
            if r[(column, column)].abs() <= DEPENDENT * length {
                return None;
            }
        }
        Some(Self { q, r })
    }

    /// Returns the condition count, n.
    pub fn conditions(&self) -> usize {
        self.q.nrows()
    }

    /// Returns the column count, r.
    pub fn rank(&self) -> usize {
        self.q.ncols()
    }

    /// Returns the residuals' degrees of freedom, `f = n - r`.
    pub fn freedom(&self) -> usize {
        self.conditions() - self.rank()
    }

    /// Returns the hat values by condition, `h_c`: derivatives of the fitted values with respect to
    /// each condition's own value.
    pub fn hat_values(&self) -> Vec<f64> {
        (0..self.conditions())
            .map(|row| self.q.row(row).norm_squared().min(1.0))
            .collect()
    }

    /// Computes `x' (X'X)^-1 x` for any row `x`; NaN if the row's length is not the column count.
    pub fn leverage(&self, row: &[f64]) -> f64 {
        if row.len() != self.rank() {
            return f64::NAN;
        }
        let row = DVector::from_column_slice(row);
        // X'X = R'R, so that the leverage is |R'^-1 x|^2.
        self.r
            .transpose()
            .solve_lower_triangular(&row)
            .map_or(f64::NAN, |solved| solved.norm_squared())
    }

    /// Returns the last diagonal entry of `(X'X)^-1`: the last coefficient's variance, relative to
    /// the residual variance.
    pub fn last_variance(&self) -> f64 {
        let mut last = vec![0.0; self.rank()];
        last[self.rank() - 1] = 1.0;
        self.leverage(&last)
    }

    /// Fits the columns to one value for each condition.
    pub fn fit(&self, values: &[f64]) -> Fit {
        let values = DVector::from_column_slice(values);
        let projected = self.q.transpose() * &values;
        let residuals = &values - &self.q * &projected;
        // The fallback is never used: the rank is full, so that R has no zero on its diagonal.
        let coefficients = self
            .r
            .solve_upper_triangular(&projected)
            .unwrap_or(projected);
        Fit {
            coefficients: coefficients.iter().copied().collect(),
            residuals: residuals.iter().copied().collect(),
        }
    }

    /// Computes the leave-one-out errors by condition, `e_c / (1 - h_c)`; `None` if the fit
    /// interpolates the condition, `h_c = 1`.
    pub fn left_out_errors(&self, values: &[f64]) -> Vec<Option<f64>> {
        let residuals = self.fit(values).residuals;
        let mut errors = Vec::with_capacity(residuals.len());
        for (residual, hat) in residuals.into_iter().zip(self.hat_values()) {
            errors.push(if 1.0 - hat > DEPENDENT {
                Some(residual / (1.0 - hat))
            } else {
                None
            });
        }
        errors
    }
}

/// Least-squares fit to one value for each condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// One coefficient per column.
    pub coefficients: Vec<f64>,
    /// One residual per condition.
    pub residuals: Vec<f64>,
}

pub(super) fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(places: &[f64]) -> Vec<Vec<f64>> {
        places.iter().map(|&place| vec![1.0, place]).collect()
    }

    #[test]
    fn hat_values_sum_to_the_column_count_and_predict_a_left_out_condition() {
        let places = [0.0, 1.0, 2.0, 4.0];
        let figures = [1.0, 1.5, 3.0, 3.5];
        let design = Design::new(&line(&places)).unwrap();
        assert!((design.hat_values().iter().sum::<f64>() - 2.0).abs() < 1e-14);
        let without_last = Design::new(&line(&places[..3]))
            .unwrap()
            .fit(&figures[..3])
            .coefficients;
        let predicted = without_last[0] + 4.0 * without_last[1];
        // The same small problem, solved in two ways: a few rounding errors.
        assert!((design.left_out_errors(&figures)[3].unwrap() - (3.5 - predicted)).abs() < 1e-13);
    }

    #[test]
    fn a_row_with_another_number_of_columns_has_no_leverage() {
        let design = Design::new(&line(&[0.0, 1.0, 2.0])).unwrap();
        assert!(design.leverage(&[1.0, 0.5]).is_finite());
        assert!(design.leverage(&[1.0, 0.5, 0.25]).is_nan());
    }

    #[test]
    fn linearly_dependent_columns_are_no_design() {
        let rows: Vec<Vec<f64>> = [0.0, 1.0, 2.0, 3.0]
            .map(|x| vec![1.0, x, 2.0 - 3.0 * x])
            .to_vec();
        assert_eq!(Design::new(&rows), None);
        assert_eq!(Design::new(&line(&[1.0])), None);
        assert_eq!(Design::new(&[]), None);
    }

    #[test]
    fn an_interpolated_condition_has_no_leave_one_out_error() {
        let design = Design::new(&[vec![1.0, 0.0], vec![1.0, 0.0], vec![0.0, 1.0]]).unwrap();
        assert_eq!(design.left_out_errors(&[1.0, 2.0, 5.0])[2], None);
        assert!((design.left_out_errors(&[1.0, 2.0, 5.0])[1].unwrap() - 1.0).abs() < 1e-14);
    }
}
