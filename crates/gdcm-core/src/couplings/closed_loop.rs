//! A loop of outputs to inputs closed around a response, frequency by frequency.
//!
//! ```text
//! F = (I - H K)^-1 H = H (I - K H)^-1: of the two inverses the one of m x m
//! 1  T <- I - K H
//! 2  for each row j of T: the column of the largest |T_jk|, k >= j, comes to place j, and the columns k > j lose that multiple of it
//!       which makes their T_jk zero; the columns of H with those of T
//! 3  for each column j from the last: divided by T_jj; the columns k < j lose T_jk times it
//! ```
//!
//! Gaussian elimination with partial pivoting, on columns: Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 3.4.

use nalgebra::{Complex, DMatrix};

/// Closes `u = u' + K y` around responses of p outputs and m inputs; keeps the room that it takes.
pub(super) struct ClosedLoop<'a> {
    /// `K`, m x p.
    feedback: &'a DMatrix<f64>,
    is_open: bool,
    /// `T`, m x m, column by column.
    difference: Vec<Complex<f64>>,
}

impl<'a> ClosedLoop<'a> {
    /// The loop of a feedback `K`, m x p.
    pub(super) fn new(feedback: &'a DMatrix<f64>) -> Self {
        let inputs = feedback.nrows();
        let is_open = feedback.iter().all(|entry| *entry == 0.0);
        Self { feedback, is_open, difference: vec![Complex::new(0.0, 0.0); inputs * inputs] }
    }

    /// Makes `H` (p x m, column by column) into `F = (I - H K)^-1 H`; false where that is not finite.
    pub(super) fn close(&mut self, response: &mut [Complex<f64>]) -> bool {
        if self.is_open {
            return response.iter().all(|value| value.is_finite());
        }
        self.return_difference(response);
        let inputs = self.feedback.nrows();
        (0..inputs).all(|column| self.eliminate(column, response)) && self.substitute_back(response)
    }

    /// `T = I - K H`.
    fn return_difference(&mut self, response: &[Complex<f64>]) {
        let (inputs, outputs) = self.feedback.shape();
        for (column, of_input) in response.chunks_exact(outputs).enumerate() {
            for row in 0..inputs {
                let sum: Complex<f64> =
                    of_input.iter().enumerate().map(|(output, value)| value * self.feedback[(row, output)]).sum();
                let unit = if row == column { 1.0 } else { 0.0 };
                self.difference[column * inputs + row] = Complex::from(unit) - sum;
            }
        }
    }

    /// Takes row `at` out of the columns after column `at`; false where there is no pivot.
    fn eliminate(&mut self, at: usize, response: &mut [Complex<f64>]) -> bool {
        let (inputs, outputs) = self.feedback.shape();
        let size = |column: &usize| self.difference[column * inputs + at].norm_sqr();
        let Some(pivot) = (at..inputs).max_by(|a, b| size(a).total_cmp(&size(b))) else { return false };
        let is_usable = size(&pivot).is_finite() && size(&pivot) > 0.0;
        for row in 0..inputs {
            self.difference.swap(at * inputs + row, pivot * inputs + row);
        }
        for output in 0..outputs {
            response.swap(at * outputs + output, pivot * outputs + output);
        }
        let divisor = self.difference[at * inputs + at].inv();
        for column in at + 1..inputs {
            let factor = self.difference[column * inputs + at] * divisor;
            subtract(&mut self.difference, inputs, (column, at), factor);
            subtract(response, outputs, (column, at), factor);
        }
        is_usable
    }

    /// Makes the triangular `T` the identity; false where a value is not finite.
    fn substitute_back(&mut self, response: &mut [Complex<f64>]) -> bool {
        let (inputs, outputs) = self.feedback.shape();
        for column in (0..inputs).rev() {
            let divisor = self.difference[column * inputs + column].inv();
            response[column * outputs..][..outputs].iter_mut().for_each(|value| *value *= divisor);
            for before in 0..column {
                let factor = self.difference[before * inputs + column];
                subtract(response, outputs, (before, column), factor);
            }
        }
        response.iter().all(|value| value.is_finite())
    }
}

/// Takes `factor` times column `of` from column `from`; columns of `rows` entries.
fn subtract(columns: &mut [Complex<f64>], rows: usize, (from, of): (usize, usize), factor: Complex<f64>) {
    for row in 0..rows {
        let part = columns[of * rows + row] * factor;
        columns[from * rows + row] -= part;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_loop_is_the_inverse_of_the_textbook() {
        let value = |k: usize| Complex::new((1.0 + k as f64).sin(), (2.0 + 3.0 * k as f64).cos());
        let h = DMatrix::from_fn(3, 2, |row, column| value(3 * column + row));
        let k = nalgebra::dmatrix![0.4, -1.1, 0.3; 2.0, 0.7, -0.6];
        let mut f: Vec<Complex<f64>> = h.iter().copied().collect();
        assert!(ClosedLoop::new(&k).close(&mut f));
        let loop_gain = &h * k.map(Complex::from);
        let expected = (DMatrix::identity(3, 3) - loop_gain).try_inverse().unwrap() * &h;
        // Two eliminations of matrices of a condition number below ten.
        assert!(f.iter().zip(&expected).all(|(found, expected)| (found - expected).norm() < 1e-13));
    }

    #[test]
    fn a_loop_of_gain_one_cannot_be_closed() {
        let k = nalgebra::dmatrix![0.5];
        assert!(!ClosedLoop::new(&k).close(&mut [Complex::new(2.0, 0.0)]));
        assert!(ClosedLoop::new(&nalgebra::dmatrix![0.0]).close(&mut [Complex::new(2.0, 0.0)]));
    }
}
