//! Padé approximants for a delay.

use nalgebra::{Complex, DMatrix, DVector, RowDVector};

use super::channel_model::ChannelModel;

/// Maximum order for a Padé approximant.
pub const HIGHEST_PADE_ORDER: usize = 8;

/// Padé approximant `[N/N]` of `e^(-tau s)`: among all rational functions of this order it agrees
/// in the most derivatives at `s = 0`. Its magnitude is 1 at every frequency, so that only its
/// phase has an error.
///
/// With `z = tau s / 2` it is `(1 - t) / (1 + t)`, where `t` is the N-th convergent in Lambert's
/// continued fraction `tanh z = z / (1 + z^2 / (3 + z^2 / (5 + ...)))`. The fraction is realised as
/// an integrator ladder, a state-space model whose controllability and observability Gramians are
/// both the identity for any order and delay. Its matrix entries are therefore similar in
/// magnitude.
///
/// Source: NIST Digital Library of Mathematical Functions, 4.39.1 (Lambert's fraction).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pade {
    order: usize,
}

impl Default for Pade {
    /// Returns the second order, whose phase error at `omega tau = 1` is below 0.1 degrees.
    fn default() -> Self {
        Self { order: 2 }
    }
}

impl Pade {
    /// Returns the approximant for an order from 1 to [`HIGHEST_PADE_ORDER`]; `None` for any other
    /// order.
    pub fn new(order: usize) -> Option<Self> {
        if (1..=HIGHEST_PADE_ORDER).contains(&order) {
            Some(Self { order })
        } else {
            None
        }
    }

    /// Returns the order `N`, which is also the state count.
    pub fn order(self) -> usize {
        self.order
    }

    /// Creates the approximant's state-space model for a positive delay \[s\].
    ///
    /// ```text
    /// L = diag(1, 3, 5, ...), N x N;   e_1: first unit vector;   z = tau s / 2
    /// S: 1 directly above the diagonal, -1 directly below it, otherwise 0
    ///
    /// 1  t = e_1' (L/z + S)^-1 e_1                              the continued fraction as a ladder
    /// 2  (1 - t) / (1 + t) = 1 - 2 e_1' (L/z + R)^-1 e_1,       R = S + e_1 e_1'
    /// 3  with K = L^(-1/2) R L^(-1/2), this is the state-space model
    ///    A = -(2/tau) K^-1,  B = 2/sqrt(tau) K^-1 e_1,  C = 2/sqrt(tau) e_1' K^-1,  D = (-1)^N
    /// ```
    pub fn model(self, delay_s: f64) -> ChannelModel {
        let gain = 2.0 / delay_s.sqrt();
        ChannelModel {
            a: DMatrix::from_fn(self.order, self.order, |row, column| {
                -2.0 / delay_s * self.scaled_inverse(row, column)
            }),
            b: DVector::from_fn(self.order, |row, _| gain * self.scaled_inverse(row, 0)),
            c: RowDVector::from_fn(self.order, |_, column| {
                gain * self.scaled_inverse(0, column)
            }),
            d: if self.order.is_multiple_of(2) {
                1.0
            } else {
                -1.0
            },
        }
    }

    /// Returns an entry in `K^-1 = L^(1/2) R^-1 L^(1/2)`.
    fn scaled_inverse(self, row: usize, column: usize) -> f64 {
        ladder_root(row) * ladder_root(column) * self.ladder_inverse(row, column)
    }

    /// Returns an entry in `R^-1`, which is 1, 0 or -1.
    ///
    /// Column `j` of `R^-1` is the solution `x` of `R x = b` for the unit vector `b = e_j`. With
    /// indices counted from 1, and `k` of the same parity as N:
    ///
    /// ```text
    /// rows of R x = b   x_1 + x_2 = b_1;  x_(i+1) - x_(i-1) = b_i;  -x_(N-1) = b_N
    ///                   (x_1 = b_1 for N = 1)
    /// from the last row upwards     x_(k-1) = -(b_k + b_(k+2) + ... + b_N)
    /// from the first row downwards  x_k = sum of b_j over all j with the parity of N
    ///                                   + sum of b_j over all j < k with the other parity
    /// ```
    fn ladder_inverse(self, row: usize, column: usize) -> f64 {
        match (
            self.has_parity_of_order(row),
            self.has_parity_of_order(column),
        ) {
            (true, true) => 1.0,
            (true, false) if column < row => 1.0,
            (false, true) if column > row => -1.0,
            _ => 0.0,
        }
    }

    /// Returns whether `index + 1`, the index counted from 1, has the same parity as the order.
    fn has_parity_of_order(self, index: usize) -> bool {
        (index + 1) % 2 == self.order % 2
    }

    /// Computes the lag missing from the approximant \[rad\] at `angle = omega tau`:
    /// `angle - 2 arg theta_N(j angle / 2)`.
    ///
    /// The approximant is `theta_N(-z) / theta_N(z)` with the reverse Bessel polynomials `theta_n =
    /// (2n - 1) theta_(n-1) + z^2 theta_(n-2)`. The ratio `theta_n / theta_(n-1)` lies above the
    /// real axis, so that the ratios' angles add up to `arg theta_N`, continuous without extra
    /// turns.
    pub fn phase_error(self, angle: f64) -> f64 {
        let z = Complex::new(0.0, 0.5 * angle);
        let mut ratio = 1.0 + z;
        let mut lag = ratio.arg();
        for n in 2..=self.order {
            ratio = (2 * n - 1) as f64 + z * z / ratio;
            lag += ratio.arg();
        }
        angle - 2.0 * lag
    }
}

/// Returns the square root of a diagonal entry in `L = diag(1, 3, 5, ...)`, counted from 0.
fn ladder_root(index: usize) -> f64 {
    ((2 * index + 1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: usize) -> f64 {
        (1..=n).map(|k| k as f64).product()
    }

    /// Evaluates `P(x) = sum (2N - k)! / (k! (N - k)!) x^k`.
    fn polynomial(order: usize, x: Complex<f64>) -> Complex<f64> {
        let mut sum = Complex::from(0.0);
        for k in (0..=order).rev() {
            let coefficient = factorial(2 * order - k) / (factorial(k) * factorial(order - k));
            sum = sum * x + coefficient;
        }
        sum
    }

    /// Evaluates the approximant as a quotient of polynomials, `P(-x) / P(x)`.
    fn by_polynomials(order: usize, x: Complex<f64>) -> Complex<f64> {
        polynomial(order, -x) / polynomial(order, x)
    }

    fn response(model: &ChannelModel, s: Complex<f64>) -> Complex<f64> {
        let n = model.order();
        let pencil = DMatrix::from_fn(n, n, |row, column| {
            let a = Complex::from(model.a[(row, column)]);
            if row == column { s - a } else { -a }
        });
        let state = pencil.lu().solve(&model.b.map(Complex::from)).unwrap();
        (model.c.map(Complex::from) * state)[0] + model.d
    }

    #[test]
    fn the_states_are_the_polynomials() {
        for order in 1..=HIGHEST_PADE_ORDER {
            for delay_s in [1e-4, 0.02, 3.0, 60.0] {
                let model = Pade::new(order).unwrap().model(delay_s);
                for angle in [1e-3, 0.3, 1.0, 4.0, 15.0, 80.0] {
                    let s = Complex::new(0.0, angle / delay_s);
                    let found = response(&model, s);
                    let expected = by_polynomials(order, s * delay_s);
                    assert!(
                        (found - expected).norm() < 1e-12,
                        "{order}, {delay_s} s, {angle}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn both_gramians_are_the_identity() {
        for order in 1..=HIGHEST_PADE_ORDER {
            let model = Pade::new(order).unwrap().model(0.07);
            let scale = model.a.amax();
            let left = &model.a + model.a.transpose();
            assert!(
                (&left + &model.b * model.b.transpose()).amax() < 1e-14 * scale,
                "{order}"
            );
            assert!(
                (&left + model.c.transpose() * &model.c).amax() < 1e-14 * scale,
                "{order}"
            );
        }
    }

    #[test]
    fn the_phase_error_is_that_of_the_response_followed_over_frequency() {
        for order in 1..=HIGHEST_PADE_ORDER {
            let pade = Pade::new(order).unwrap();
            let mut followed = 0.0;
            let mut before = Complex::from(1.0);
            // Steps far below half a turn, up to angles at which the lag of the approximant has
            // stopped growing.
            for step in 1..=4000 {
                let angle = f64::from(step) * 0.01;
                let error = by_polynomials(order, Complex::new(0.0, angle))
                    * Complex::new(0.0, angle).exp();
                followed += (error / before).arg();
                before = error;
                assert!(
                    (pade.phase_error(angle) - followed).abs() < 1e-10,
                    "{order}, {angle}"
                );
            }
        }
        assert_eq!((Pade::new(0), Pade::new(9)), (None, None));
    }
}
