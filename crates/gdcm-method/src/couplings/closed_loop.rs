//! Closes the output-to-input loop around a response, frequency by frequency (M16.3).
//!
//! ```text
//! F = (I - H K)^-1 H = H (I - K H)^-1      H p x m, K m x p; the m x m inverse is used
//!
//! 1  T <- I - K H
//! 2  for each row j of T:
//!        pivot: swap column j with the column k >= j that has the largest |T_jk|
//!        from the columns k > j subtract the multiple of column j that makes T_jk zero
//!        swap and reduce the columns of H in the same way
//! 3  for each column j of H, from the last:
//!        divide it by T_jj; from the columns k < j of H subtract T_jk times column j
//! ```
//!
//! `H` is the physics model's response, `K` the feedback from its outputs to its inputs; at the end
//! `F` has replaced `H`. Both matrices are stored column by column: `T_jk` is at `k m + j`, `H_ok`
//! at `k p + o`.
//!
//! Gaussian elimination with partial pivoting, by columns: Golub & Van Loan, "Matrix Computations",
//! 4th ed. 2013, 3.4.

use nalgebra::{Complex, DMatrix};

/// Closes the loop `u = u' + K y` around p x m responses; its work memory is reused.
pub(super) struct ClosedLoop<'a> {
    /// Feedback `K`, m x p.
    feedback: &'a DMatrix<f64>,
    /// Whether `K` is zero, so that `F = H`.
    is_open: bool,
    /// Return difference `T`, m x m, column by column.
    difference: Vec<Complex<f64>>,
}

impl<'a> ClosedLoop<'a> {
    /// Creates the loop for a feedback `K`, m x p.
    pub(super) fn new(feedback: &'a DMatrix<f64>) -> Self {
        let inputs = feedback.nrows();
        let is_open = feedback.iter().all(|entry| *entry == 0.0);
        Self {
            feedback,
            is_open,
            difference: vec![Complex::new(0.0, 0.0); inputs * inputs],
        }
    }

    /// Replaces `H` (p x m, column by column) by `F = (I - H K)^-1 H`; returns `false`, with
    /// meaningless values in `response`, if the result is not finite.
    pub(super) fn close(&mut self, response: &mut [Complex<f64>]) -> bool {
        if self.is_open {
            return response.iter().all(|value| value.is_finite());
        }
        self.set_return_difference(response);
        let inputs = self.feedback.nrows();
        for column in 0..inputs {
            if !self.eliminate(column, response) {
                return false;
            }
        }
        self.substitute_back(response)
    }

    /// Sets `T = I - K H` (step 1).
    fn set_return_difference(&mut self, response: &[Complex<f64>]) {
        let (inputs, outputs) = self.feedback.shape();
        for (column, values) in response.chunks_exact(outputs).enumerate() {
            for row in 0..inputs {
                let sum: Complex<f64> = values
                    .iter()
                    .enumerate()
                    .map(|(output, value)| value * self.feedback[(row, output)])
                    .sum();
                let unit = if row == column { 1.0 } else { 0.0 };
                self.difference[column * inputs + row] = Complex::from(unit) - sum;
            }
        }
    }

    /// Eliminates row `at` from the columns after column `at` (step 2); returns `false` if there is
    /// no usable pivot.
    fn eliminate(&mut self, at: usize, response: &mut [Complex<f64>]) -> bool {
        let (inputs, outputs) = self.feedback.shape();
        let pivot = self.pivot(at);
        let size = self.difference[pivot * inputs + at].norm_sqr();
        if !size.is_finite() || size <= 0.0 {
            return false;
        }
        for row in 0..inputs {
            self.difference
                .swap(at * inputs + row, pivot * inputs + row);
        }
        for output in 0..outputs {
            response.swap(at * outputs + output, pivot * outputs + output);
        }
        let divisor = self.difference[at * inputs + at].inv();
        for column in at + 1..inputs {
            let step = ColumnStep {
                from: column,
                subtracted: at,
                factor: self.difference[column * inputs + at] * divisor,
            };
            step.apply(&mut self.difference, inputs);
            step.apply(response, outputs);
        }
        true
    }

    /// Returns the column, from `at` on, whose entry in row `at` has the maximum modulus; the last
    /// one if several are equal.
    fn pivot(&self, at: usize) -> usize {
        let inputs = self.feedback.nrows();
        let mut pivot = at;
        let mut largest = self.difference[at * inputs + at].norm_sqr();
        for column in at + 1..inputs {
            let size = self.difference[column * inputs + at].norm_sqr();
            if size.total_cmp(&largest).is_ge() {
                pivot = column;
                largest = size;
            }
        }
        pivot
    }

    /// Reduces the triangular `T` to the identity (step 3); returns `false` if a value is not
    /// finite.
    fn substitute_back(&mut self, response: &mut [Complex<f64>]) -> bool {
        let (inputs, outputs) = self.feedback.shape();
        for column in (0..inputs).rev() {
            let divisor = self.difference[column * inputs + column].inv();
            for value in &mut response[column * outputs..][..outputs] {
                *value *= divisor;
            }
            for before in 0..column {
                let step = ColumnStep {
                    from: before,
                    subtracted: column,
                    factor: self.difference[before * inputs + column],
                };
                step.apply(response, outputs);
            }
        }
        response.iter().all(|value| value.is_finite())
    }
}

/// A step that subtracts `factor` times column `subtracted` from column `from`.
struct ColumnStep {
    from: usize,
    subtracted: usize,
    factor: Complex<f64>,
}

impl ColumnStep {
    /// Applies the step to a matrix stored column by column, with `rows` entries each.
    fn apply(&self, columns: &mut [Complex<f64>], rows: usize) {
        for row in 0..rows {
            let part = columns[self.subtracted * rows + row] * self.factor;
            columns[self.from * rows + row] -= part;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_loop_agrees_with_its_formula() {
        let h = DMatrix::from_fn(3, 2, |row, column| {
            let k = (3 * column + row) as f64;
            Complex::new((1.0 + k).sin(), (2.0 + 3.0 * k).cos())
        });
        let k = nalgebra::dmatrix![0.4, -1.1, 0.3; 2.0, 0.7, -0.6];
        let mut f: Vec<Complex<f64>> = h.iter().copied().collect();
        assert!(ClosedLoop::new(&k).close(&mut f));
        let loop_gain = &h * k.map(Complex::from);
        let expected = (DMatrix::identity(3, 3) - loop_gain).try_inverse().unwrap() * &h;
        // Tolerance: two eliminations with condition numbers below ten.
        assert!(
            f.iter()
                .zip(&expected)
                .all(|(found, expected)| (found - expected).norm() < 1e-13)
        );
    }

    #[test]
    fn a_loop_with_unit_gain_cannot_be_closed() {
        let k = nalgebra::dmatrix![0.5];
        assert!(!ClosedLoop::new(&k).close(&mut [Complex::new(2.0, 0.0)]));
        assert!(ClosedLoop::new(&nalgebra::dmatrix![0.0]).close(&mut [Complex::new(2.0, 0.0)]));
    }
}
