//! The frequency response of a model of discrete time (M2a).
//!
//! ```text
//! 1  balance A - I; A - I = Q F Q', F Hessenberg; G = Q' B, L = C Q
//! 2  at each frequency s = z - 1 = 2j sin(omega T / 2) e^(j omega T / 2): fast sampling rounds nothing away
//! 3  (sI - F) X = G by elimination with interchanges of neighbouring rows;  H = L X + D
//! ```

use nalgebra::{Complex, DMatrix, Hessenberg};

use crate::dataset::{PairTable, StateSpace};

use super::elimination::balance;
use super::frequency_response::FrequencyResponse;

/// A model of discrete time made ready for its response on any grid: `O(n^3)` operations to make, `O(n^2 m)` for each frequency.
#[derive(Clone, Debug)]
pub(super) struct DiscreteForm {
    hessenberg: DMatrix<f64>,
    b: DMatrix<Complex<f64>>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    sample_time_s: f64,
}

impl DiscreteForm {
    /// The form of a model whose matrices act once in each `sample_time_s`.
    pub(super) fn of(model: &StateSpace, sample_time_s: f64) -> Self {
        let order = model.order();
        let mut a = model.a() - DMatrix::identity(order, order);
        let (mut b, mut c) = (model.b().clone(), model.c().clone());
        balance(&mut a, &mut b, &mut c);
        // The decomposition is not defined for a matrix without rows.
        let (q, hessenberg) = if order > 0 { Hessenberg::new(a).unpack() } else { (a.clone(), a) };
        let (b, c) = (q.tr_mul(&b).map(Complex::from), c * q);
        Self { hessenberg, b, c, d: model.d().clone(), sample_time_s }
    }

    /// `H(z) = C (zI - A)^-1 B + D` at `z = e^(j omega T)`; not a number from `omega = pi / T` on.
    pub(super) fn response(&self, omega: &[f64]) -> FrequencyResponse {
        let (outputs, inputs) = self.d.shape();
        let not_a_number = vec![Complex::new(f64::NAN, f64::NAN); omega.len()];
        let mut curves = PairTable::filled(outputs, inputs, not_a_number);
        let mut work = Work { matrix: DMatrix::zeros(0, 0), states: DMatrix::zeros(0, 0) };
        for (k, omega) in omega.iter().enumerate() {
            let angle = omega * self.sample_time_s;
            if angle >= std::f64::consts::PI {
                break;
            }
            let s = Complex::from_polar(2.0 * (0.5 * angle).sin(), 0.5 * angle) * Complex::i();
            work.solve(&self.hessenberg, &self.b, s);
            for (pair, curve) in curves.iter_mut() {
                let (row, column) = (self.c.row(pair.output), work.states.column(pair.input));
                let through: Complex<f64> = row.iter().zip(column.iter()).map(|(c, x)| x * *c).sum();
                curve[k] = through + self.d[(pair.output, pair.input)];
            }
        }
        FrequencyResponse::from_curves(omega.len(), &curves)
    }
}

/// The matrix that is eliminated and the states that are left, of one frequency.
struct Work {
    matrix: DMatrix<Complex<f64>>,
    states: DMatrix<Complex<f64>>,
}

impl Work {
    /// `X` of `(sI - F) X = G`; not finite where `s` is a pole.
    fn solve(&mut self, hessenberg: &DMatrix<f64>, b: &DMatrix<Complex<f64>>, s: Complex<f64>) {
        let order = hessenberg.nrows();
        self.matrix = hessenberg.map(|entry| Complex::from(-entry));
        (0..order).for_each(|state| self.matrix[(state, state)] += s);
        self.states.clone_from(b);
        for state in 1..order {
            self.eliminate(state);
        }
        for mut column in self.states.column_iter_mut() {
            for state in (0..order).rev() {
                let solved = column[state] / self.matrix[(state, state)];
                column[state] = solved;
                (0..state).for_each(|above| column[above] -= self.matrix[(above, state)] * solved);
            }
        }
    }

    /// Makes the entry of this row below the diagonal zero, with the larger of the two as pivot.
    fn eliminate(&mut self, row: usize) {
        let (above, order) = (row - 1, self.matrix.nrows());
        if self.matrix[(row, above)].norm_sqr() > self.matrix[(above, above)].norm_sqr() {
            self.matrix.swap_rows(above, row);
            self.states.swap_rows(above, row);
        }
        let below = self.matrix[(row, above)];
        if below == Complex::from(0.0) {
            return;
        }
        let factor = below / self.matrix[(above, above)];
        for column in row..order {
            let subtracted = factor * self.matrix[(above, column)];
            self.matrix[(row, column)] -= subtracted;
        }
        for column in 0..self.states.ncols() {
            let subtracted = factor * self.states[(above, column)];
            self.states[(row, column)] -= subtracted;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Pair;
    use nalgebra::dmatrix;

    fn noise(seed: f64) -> impl Fn(usize, usize) -> f64 {
        move |row, column| (seed + 7.3 * row as f64 + 2.9 * column as f64 * (1.0 + row as f64)).sin()
    }

    #[test]
    fn a_first_order_recursion_has_its_known_response() {
        // y_k+1 = 0.5 y_k + u_k, T = 0.1 s: 1 / (z - 0.5) at z = e^(0.2j).
        let model = StateSpace::new(dmatrix![0.5], dmatrix![1.0], dmatrix![1.0], dmatrix![0.0]).unwrap();
        let response = DiscreteForm::of(&model, 0.1).response(&[2.0, 31.4, 31.5]);
        let values = response.curve(Pair::new(0, 0));
        let expected: Complex<f64> = (Complex::from_polar(1.0, 0.2) - 0.5).inv();
        let error: Complex<f64> = values[0] - expected;
        assert!(error.norm() < 1e-15 * expected.norm());
        assert!(values[1].is_finite() && !values[2].is_finite(), "there is no response from pi / T = 31.42 rad/s on");
    }

    #[test]
    fn a_dense_solution_gives_the_same_to_1e_minus_9_of_the_largest() {
        for order in [1, 2, 7, 30] {
            let a = DMatrix::from_fn(order, order, noise(1.0)) * (0.9 / (order as f64).sqrt());
            let (b, c) = (DMatrix::from_fn(order, 3, noise(2.0)), DMatrix::from_fn(2, order, noise(3.0)));
            let d = DMatrix::from_fn(2, 3, noise(4.0));
            let model = StateSpace::new(a.clone(), b.clone(), c.clone(), d.clone()).unwrap();
            let omega: Vec<f64> = (0..50).map(|k| 0.01 * 1.15_f64.powi(k)).collect();
            let response = DiscreteForm::of(&model, 0.02).response(&omega);
            let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
            let (mut largest, mut error) = (0.0_f64, 0.0_f64);
            for (k, omega) in omega.iter().enumerate() {
                let z = Complex::from_polar(1.0, 0.02 * omega);
                let resolvent = DMatrix::from_diagonal_element(order, order, z) - complex(&a);
                let expected = complex(&c) * resolvent.lu().solve(&complex(&b)).unwrap() + complex(&d);
                for (pair, curve) in response.curves().iter() {
                    let value = expected[(pair.output, pair.input)];
                    largest = largest.max(value.norm());
                    error = error.max((curve[k] - value).norm());
                }
            }
            assert!(error <= 1e-11 * largest, "order {order}: {error:e} of {largest:e}");
        }
    }

    #[test]
    fn a_model_without_states_is_its_feed_through() {
        let gain =
            StateSpace::new(DMatrix::zeros(0, 0), DMatrix::zeros(0, 2), DMatrix::zeros(1, 0), dmatrix![3.0, 4.0]);
        let response = DiscreteForm::of(&gain.unwrap(), 0.1).response(&[1.0]);
        assert_eq!(response.curve(Pair::new(0, 1)), [Complex::from(4.0)]);
    }

    #[test]
    fn a_pole_on_the_unit_circle_is_not_finite_there_only() {
        // z^2 + 1: poles at +-j, that is omega T = pi / 2.
        let model =
            StateSpace::new(dmatrix![0.0, 1.0; -1.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0]);
        let form = DiscreteForm::of(&model.unwrap(), 1.0);
        let values = form.response(&[1.0, std::f64::consts::FRAC_PI_2, 2.0]).curve(Pair::new(0, 0));
        // The machine's pi is not pi: what is left of the pole is of the order of 1 / rounding.
        assert!(!values[1].is_finite() || values[1].norm() > 1e15);
        for (omega, value) in [(1.0, values[0]), (2.0, values[2])] {
            let expected: Complex<f64> = (Complex::from_polar(1.0, 2.0 * omega) + 1.0).inv();
            let error: Complex<f64> = value - expected;
            assert!(error.norm() < 1e-14 * expected.norm(), "{omega}");
        }
    }
}
