//! Which part of a model an input reaches and an output sees, by orthogonal reflections.

use nalgebra::{DMatrix, DVector};

/// A model of one input and one output.
#[derive(Clone, Debug)]
pub(super) struct SingleResponse {
    pub(super) a: DMatrix<f64>,
    pub(super) b: DVector<f64>,
    pub(super) c: DVector<f64>,
    pub(super) d: f64,
}

/// A coupling below this share of |A| is the rounding of the reflections.
const NEGLIGIBLE: f64 = 1e-12;

impl SingleResponse {
    /// The same response without the states that the input does not reach: A is Hessenberg then, and b is zero but for its
    /// first entry.
    ///
    /// Reflections put b on the first state, then column after column of A on its subdiagonal; at the first subdiagonal entry that is
    /// negligible the chain from the input ends (the staircase of Van Dooren, IEEE Trans. Automatic Control 26(1), 1981, for one
    /// input).
    pub(super) fn reached(mut self) -> Self {
        let size = self.a.nrows();
        let negligible = NEGLIGIBLE * self.a.norm();
        for column in 0..size {
            let below = if column == 0 {
                self.b.clone()
            } else {
                let mut below = self.a.column(column - 1).into_owned();
                below.rows_mut(0, column).fill(0.0);
                below
            };
            let coupling = below.norm();
            if coupling == 0.0 || (column > 0 && coupling <= negligible) {
                return self.first_states(column);
            }
            self.reflect(below, column);
        }
        self
    }

    /// The model with inputs and outputs interchanged: what the input reaches is what the output saw.
    pub(super) fn transposed(self) -> Self {
        Self { a: self.a.transpose(), b: self.c, c: self.b, d: self.d }
    }

    /// Reflects the states so that `axis`, which is zero before `at`, has its only entry there.
    fn reflect(&mut self, axis: DVector<f64>, at: usize) {
        let mut normal = axis.clone();
        normal[at] += axis.norm().copysign(axis[at]);
        normal.normalize_mut();
        let rows = normal.transpose() * &self.a;
        self.a -= 2.0 * &normal * rows;
        let columns = &self.a * &normal;
        self.a -= 2.0 * columns * normal.transpose();
        for vector in [&mut self.b, &mut self.c] {
            *vector -= 2.0 * normal.dot(vector) * &normal;
        }
        // What the reflection makes zero, up to rounding.
        if at == 0 {
            self.b.rows_mut(1, self.b.nrows() - 1).fill(0.0);
        } else {
            self.a.view_mut((at + 1, at - 1), (self.a.nrows() - at - 1, 1)).fill(0.0);
        }
    }

    fn first_states(&self, count: usize) -> Self {
        Self {
            a: self.a.view((0, 0), (count, count)).into_owned(),
            b: self.b.rows(0, count).into_owned(),
            c: self.c.rows(0, count).into_owned(),
            d: self.d,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn states_that_the_input_does_not_reach_are_left_out() {
        // Two lags of which the input drives the sum only: seen in other coordinates, one state.
        let a = dmatrix![-1.5, 0.5; 0.5, -1.5];
        let model = SingleResponse { a, b: dvector![1.0, 1.0], c: dvector![1.0, 0.0], d: 0.25 };
        let reached = model.clone().reached();
        assert_eq!(reached.a.nrows(), 1);
        // 0.25 + 1 / (s + 1): the rounding of one reflection.
        assert!((reached.a[(0, 0)] + 1.0).abs() < 1e-14 && (reached.b[0] * reached.c[0] - 1.0).abs() < 1e-14);
        assert_eq!(model.transposed().reached().a.nrows(), 2, "the first state alone sees both");
    }

    #[test]
    fn what_an_input_reaches_is_a_chain() {
        let a = DMatrix::from_fn(6, 6, |row, column| ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin());
        let b = DVector::from_fn(6, |row, _| 1.0 / (1.0 + row as f64));
        let reached = SingleResponse { a: a.clone(), b: b.clone(), c: b.clone(), d: 0.0 }.reached();
        assert_eq!(reached.a.nrows(), 6);
        assert_eq!(reached.b.iter().filter(|entry| **entry != 0.0).count(), 1);
        let below = (0..6).flat_map(|column| (column + 2..6).map(move |row| (row, column)));
        assert!(below.into_iter().all(|at| reached.a[at] == 0.0));
        // c A b is the same in any coordinates.
        let (before, after) = (b.dot(&(&a * &b)), reached.c.dot(&(&reached.a * &reached.b)));
        assert!((before - after).abs() < 1e-13 * before.abs());
    }
}
