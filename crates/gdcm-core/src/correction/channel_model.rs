//! A delay or a lead filter of one channel as states.

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::response::{LeadFilter, LeadOrder};

/// A delay or a lead filter of one channel as a state-space model of one input and one output.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelModel {
    /// System matrix, n x n.
    pub a: DMatrix<f64>,
    /// Input column, n values.
    pub b: DVector<f64>,
    /// Output row, n values.
    pub c: RowDVector<f64>,
    /// Feed-through.
    pub d: f64,
}

impl ChannelModel {
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

    /// A lead filter in continuous time, exactly (M15.3): with `w1 = 1 / a`, `w2 = 1 / b` of second order `A = [0 1; -w2^2 -sqrt(2)
    /// w2]`, `B = [0; 1]`, `C = [R (w1^2 - w2^2)  R sqrt(2) (w1 - w2)]`, `D = R`, of first order `A = -w2`, `B = 1`, `C = R (w1 -
    /// w2)`, `D = R`.
    pub fn lead(filter: LeadFilter) -> Self {
        const ROOT: f64 = std::f64::consts::SQRT_2;
        let (w1, w2, r) = (filter.zero_rad_s(), filter.lag_rad_s(), filter.gain_at_infinity());
        match filter.order() {
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

    /// The lead filter in discrete time of this sample time \[s\], by Tustin's rule `s = 2 (z - 1) / (T (z + 1))`: with `M = (I - A
    /// T/2)^-1` it is `M (I + A T/2)`, `T M B`, `C M`, `D + C M B T/2`. None where `T` puts a pole of the filter on that of the rule.
    pub fn sampled_lead(filter: LeadFilter, sample_time_s: f64) -> Option<Self> {
        let Self { a, b, c, d } = Self::lead(filter);
        let (one, half) = (DMatrix::identity(a.nrows(), a.nrows()), 0.5 * sample_time_s * &a);
        let inverse = (&one - &half).try_inverse()?;
        let direct = (&c * &inverse * &b).sum() * 0.5 * sample_time_s;
        Some(Self { a: &inverse * (&one + &half), b: sample_time_s * &inverse * b, c: &c * inverse, d: d + direct })
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
            let model = ChannelModel::samples(count);
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
