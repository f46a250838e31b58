//! A delay of one channel as states.

use nalgebra::{DMatrix, DVector, RowDVector};

/// A delay of one channel as a state-space model of one input and one output.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayModel {
    /// System matrix, n x n.
    pub a: DMatrix<f64>,
    /// Input column, n values.
    pub b: DVector<f64>,
    /// Output row, n values.
    pub c: RowDVector<f64>,
    /// Feed-through.
    pub d: f64,
}

impl DelayModel {
    /// No delay: `y = u`, without states.
    pub fn none() -> Self {
        Self { a: DMatrix::zeros(0, 0), b: DVector::zeros(0), c: RowDVector::zeros(0), d: 1.0 }
    }

    /// `z^-count`, exactly: `count` states, each of which holds the one before it for one sample.
    pub fn samples(count: usize) -> Self {
        if count == 0 {
            return Self::none();
        }
        let one_at = |at: usize| move |index: usize| if index == at { 1.0 } else { 0.0 };
        Self {
            a: DMatrix::from_fn(count, count, |row, column| if row == column + 1 { 1.0 } else { 0.0 }),
            b: DVector::from_fn(count, |row, _| one_at(0)(row)),
            c: RowDVector::from_fn(count, |_, column| one_at(count - 1)(column)),
            d: 0.0,
        }
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.b.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_come_out_as_many_steps_later() {
        for count in 0..4 {
            let model = DelayModel::samples(count);
            assert_eq!(model.order(), count);
            let mut x = DVector::zeros(count);
            let mut out = Vec::new();
            for u in [1.0, 2.0, 3.0, 4.0, 5.0] {
                out.push((&model.c * &x).sum() + model.d * u);
                x = &model.a * &x + &model.b * u;
            }
            let delayed: Vec<f64> = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0][3 - count..][..5].to_vec();
            assert_eq!(out, delayed, "{count} samples");
        }
    }
}
