//! State-space models for a channel's delay or lead filter.

use nalgebra::{DMatrix, DVector, RowDVector};

use gdcm_model::response::{LeadFilter, LeadOrder};

/// A channel's delay or lead filter as a state-space model with a single input and output.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelModel {
    /// System matrix, n x n.
    pub a: DMatrix<f64>,
    /// Input column, n values.
    pub b: DVector<f64>,
    /// Output row, n values.
    pub c: RowDVector<f64>,
    pub d: f64,
}

impl ChannelModel {
    /// Creates an exact delay by `count` samples, `z^-count`: a chain with `count` states, each
    /// equal to the previous state one sample earlier. With `count = 0` it is `y = u`.
    pub fn samples(count: usize) -> Self {
        Self {
            a: DMatrix::from_fn(count, count, |row, column| f64::from(row == column + 1)),
            b: DVector::from_fn(count, |row, _| f64::from(row == 0)),
            c: RowDVector::from_fn(count, |_, column| f64::from(column + 1 == count)),
            d: f64::from(count == 0),
        }
    }

    /// Creates a lead filter in continuous time, which is exact (M15.3). `w1` and `w2` are the
    /// reciprocals \[rad/s\] of the numerator's and the denominator's time constant, and `R` is the
    /// gain at infinite frequency, `(w2 / w1)^2` or `w2 / w1`:
    ///
    /// ```text
    /// second order   A = [0 1; -w2^2 -sqrt(2) w2],  B = [0; 1],
    ///                C = [R (w1^2 - w2^2)  R sqrt(2) (w1 - w2)],  D = R
    /// first order    A = -w2,  B = 1,  C = R (w1 - w2),  D = R
    /// ```
    pub fn lead(filter: LeadFilter) -> Self {
        const ROOT: f64 = std::f64::consts::SQRT_2;
        let w1 = filter.zero_rad_s();
        let w2 = filter.lag_rad_s();
        let r = filter.gain_at_infinity();
        match filter.order {
            LeadOrder::First => Self {
                a: DMatrix::from_element(1, 1, -w2),
                b: DVector::from_element(1, 1.0),
                c: RowDVector::from_element(1, r * (w1 - w2)),
                d: r,
            },
            LeadOrder::Second => Self {
                a: DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -w2 * w2, -ROOT * w2]),
                b: DVector::from_column_slice(&[0.0, 1.0]),
                c: RowDVector::from_row_slice(&[r * (w1 * w1 - w2 * w2), r * ROOT * (w1 - w2)]),
                d: r,
            },
        }
    }

    /// Creates a lead filter in discrete time, for the sample time `T` \[s\], by Tustin's rule
    /// `s = 2 (z - 1) / (T (z + 1))`. With `M = (I - A T/2)^-1` the matrices are `M (I + A T/2)`,
    /// `T M B`, `C M`, `D + C M B T/2`. Returns `None` if `I - A T/2` is singular.
    pub fn sampled_lead(filter: LeadFilter, sample_time_s: f64) -> Option<Self> {
        let Self { a, b, c, d } = Self::lead(filter);
        let one = DMatrix::identity(a.nrows(), a.nrows());
        let half = 0.5 * sample_time_s * &a;
        let inverse = (&one - &half).try_inverse()?;
        let direct = (&c * &inverse * &b).sum() * 0.5 * sample_time_s;
        Some(Self {
            a: &inverse * (&one + &half),
            b: sample_time_s * &inverse * b,
            c: &c * inverse,
            d: d + direct,
        })
    }

    /// Returns the state count `n`.
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
            let model = ChannelModel::samples(count);
            assert_eq!(model.order(), count);
            let mut x = DVector::zeros(count);
            let mut out = Vec::new();
            for u in [1.0, 2.0, 3.0, 4.0, 5.0] {
                out.push((&model.c * &x).sum() + model.d * u);
                x = &model.a * &x + &model.b * u;
            }
            let padded = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
            let delayed = &padded[3 - count..8 - count];
            assert_eq!(out, delayed, "{count} samples");
        }
    }
}
