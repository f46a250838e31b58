//! The frequency response of a state-space model: its states are eliminated from the system matrix.
//!
//! ```text
//! 1  balance A; scale A and B to order 1; Householder reflections make A Hessenberg and B's first column b e_1; transpose
//!    and reverse the states. What is left, the same for every frequency s = j omega / alpha, is
//!        [ G - s I  K  ]      G: zero below its first subdiagonal h_k, real
//!        [ L        D' ]      H' = D' - L (G - s I)^-1 K
//! 2  u <- first row of [G - s I, K], the active row; w <- each row of [L D'] but the first
//! 3  for k = 1 ... n - 1, with the next row r = [G - s I, K]_(k+1) / h_k, which is real but for -s / h_k:
//! 4     if |u_k| > tau |h_k| in any of eight neighbouring frequencies, then in those with |u_k| > |h_k| interchange:
//!          w <- w - (w_k / u_k) u;   u <- h_k r - (h_k / u_k) u
//! 5     else: w <- w - w_k r;   u <- u - u_k r
//! 6  the last column: w <- w - (w_n / u_n) u, and the first row of [L D'] in the same way; what is left is H'
//! ```
//!
//! A frequency is a lane of a vector register. Hessenberg form: Laub, IEEE Trans. Automatic Control 26(2), 1981; tau is the
//! pivot threshold of Duff, Erisman & Reid, "Direct Methods for Sparse Matrices", 2nd ed. 2017, 5.2.

mod eliminated_rows;
mod hessenberg_form;
mod householder_reduction;
mod lanes;

use nalgebra::Complex;
use pulp::Arch;

use crate::dataset::StateSpace;

use super::frequency_response::FrequencyResponse;

pub(super) use eliminated_rows::Elimination;
use eliminated_rows::Subdiagonal;
pub(super) use hessenberg_form::HessenbergForm;
use householder_reduction::HouseholderReduction;
pub(super) use householder_reduction::balance;
use lanes::*;

/// `H(j omega) = C (j omega I - A)^-1 B + D` at each `omega` \[rad/s\]: a p x m table of `N` values.
///
/// The model is balanced and reduced to Hessenberg form once; at each frequency its states are then eliminated from the
/// system matrix, with pivoting, in O(n (n + 2 max(m, p)) min(m, p)) operations. As many frequencies are solved at once as a
/// vector of the processor holds: eight with AVX-512, four with AVX2, two with NEON, else one.
///
/// Eight neighbouring frequencies choose their pivots together: a value depends on those of its eight, by rounding
/// only. It has the same bits wherever fused multiply-adds are (AVX2, AVX-512, NEON). Its error is that of a model whose
/// entries are changed by less than 1e-10 of the largest of the balanced A, in practice by some 1e-13, so the relative error
/// grows as `j omega` comes close to a pole; at a pole, where elimination meets a zero, the values are not finite. Entries
/// beyond [`super::LargeEntry`]'s limit may overflow.
///
/// The matrices alone count, as those of continuous time: for a model with [`crate::dataset::Timing`] see
/// [`super::PreparedModel`].
pub fn evaluate(model: &StateSpace, omega: &[f64]) -> FrequencyResponse {
    evaluate_on(Arch::new(), model, omega)
}

/// [`evaluate`] on a given instruction set: for tests and benchmarks.
pub fn evaluate_on(arch: Arch, model: &StateSpace, omega: &[f64]) -> FrequencyResponse {
    let at: Vec<_> = omega.iter().map(|omega| Complex::new(0.0, *omega)).collect();
    arch.dispatch(Elimination { form: &HessenbergForm::of(arch, model.a().clone(), model), at: &at })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Pair;
    use nalgebra::{DMatrix, dmatrix};

    fn siso(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>, d: f64) -> StateSpace {
        StateSpace::new(a, b, c, dmatrix![d]).unwrap()
    }

    fn oscillator() -> StateSpace {
        siso(dmatrix![0.0, 1.0; -4.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], 0.0)
    }

    fn only(response: FrequencyResponse) -> Complex<f64> {
        response.curve(Pair::new(0, 0))[0]
    }

    #[test]
    fn a_first_order_lag_has_its_known_response() {
        // 1 / (j omega + 2) at omega = 3: (2 - 3j) / 13.
        let value = only(evaluate(&siso(dmatrix![-2.0], dmatrix![1.0], dmatrix![1.0], 0.0), &[3.0]));
        assert!((value - Complex::new(2.0 / 13.0, -3.0 / 13.0)).norm() < 1e-16);
    }

    #[test]
    fn a_model_of_order_zero_is_its_feed_through() {
        let empty = siso(DMatrix::zeros(0, 0), DMatrix::zeros(0, 1), DMatrix::zeros(1, 0), 2.5);
        assert_eq!(only(evaluate(&empty, &[1.0])), Complex::new(2.5, 0.0));
    }

    #[test]
    fn an_undamped_oscillator_at_its_own_frequency_is_not_finite() {
        assert!(!only(evaluate(&oscillator(), &[2.0])).is_finite());
    }

    #[test]
    fn a_pole_on_the_grid_leaves_the_other_frequencies_alone() {
        let omega: Vec<f64> = (0..19).map(|k| f64::from(k) * 0.25).collect();
        let response = evaluate(&oscillator(), &omega);
        for (omega, value) in omega.iter().zip(response.curve(Pair::new(0, 0))) {
            // 1 / (4 - omega^2); a handful of operations, of which the difference amplifies rounding up to 8 times.
            let expected = 1.0 / (4.0 - omega * omega);
            assert_eq!(value.is_finite(), *omega != 2.0, "{omega}");
            assert!(*omega == 2.0 || (value - expected).norm() < 1e-14 * expected.abs(), "{omega}");
        }
    }

    #[test]
    fn units_of_inputs_and_outputs_do_not_matter() {
        let a = dmatrix![-1.0, 2.0; -3.0, -0.5];
        let plain = only(evaluate(&siso(a.clone(), dmatrix![1.0; 0.5], dmatrix![1.0, -2.0], 0.0), &[1.3]));
        for exponent in [-800, 800] {
            let unit = 2.0_f64.powi(exponent);
            let scaled = only(evaluate(&siso(a.clone(), dmatrix![unit; 0.5 * unit], dmatrix![1.0, -2.0], 0.0), &[1.3]));
            // A power of two: nothing is rounded.
            assert_eq!(scaled, plain * unit);
        }
    }

    #[test]
    fn units_of_the_states_do_not_matter() {
        let (a, b, c) = (dmatrix![-1.0, 2.0; -3.0, -0.5], dmatrix![1.0; 0.5], dmatrix![1.0, -2.0]);
        let scale = DMatrix::from_diagonal(&nalgebra::dvector![1e-9, 1e9]);
        let inverse = DMatrix::from_diagonal(&nalgebra::dvector![1e9, 1e-9]);
        let plain = only(evaluate(&siso(a.clone(), b.clone(), c.clone(), 0.1), &[1.3]));
        let scaled = only(evaluate(&siso(&scale * a * &inverse, scale * b, c * inverse, 0.1), &[1.3]));
        // The scaling itself rounds each entry once.
        assert!((plain - scaled).norm() < 1e-14 * plain.norm());
    }
}
