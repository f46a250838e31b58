//! Computes a single response's transmission zeros.
//!
//! ```text
//! 1  keep the states on a chain of nonzero entries from the input to the output; balance A
//! 2  keep the controllable and observable states (staircase), so that no pole cancels a zero
//! 3  A Hessenberg, b = beta e_1. While d is negligible, the input acts on the first state only,
//!    and can set it to any value: this state becomes the input,
//!       A <- A_22, b <- A_21, c <- c_2, d <- c_1       (a zero at infinity each time)
//! 4  zeros: where [A - sI  b; c  d] loses rank, i.e. the eigenvalues of A - b c / d
//! 5  Newton: s <- s - H(s) / H'(s) on the model of step 2, while |H| decreases
//! ```
//!
//! Emami-Naeini & Van Dooren, "Computation of zeros of linear multivariable systems", Automatica
//! 18(4), 1982, for the single-input, single-output case. Steps 1 and 2 are in
//! `single_response.rs`; `e_1` is the first unit vector. In discrete time, A - I takes the place of
//! A in all steps, so that `s` is `z - 1`; the zeros found are converted at the end (`s_plane.rs`).

use nalgebra::{Complex, DMatrix, DVector};

use super::large_entry::LargeEntry;
use super::s_plane::SPlane;
use super::schur_form::SchurForm;
use super::single_response::SingleResponse;
use crate::dataset::{Dynamics, Pair, StateSpace};

/// A response's transmission zeros.
#[derive(Clone, Debug, PartialEq)]
pub struct TransmissionZeros {
    /// Finite zeros \[rad/s\] in ascending modulus; conjugate pairs are exact, with the zero above
    /// the real axis first.
    pub finite: Vec<Complex<f64>>,
    /// Number of zeros at infinity: poles minus finite zeros. In discrete time it includes zeros at
    /// `z = 0`, which have no `s`.
    pub infinite: usize,
}

/// Reason why a response's zeros are unavailable.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ZerosError {
    #[error("{0}")]
    TooLarge(LargeEntry),
    #[error("the input does not act on this output: the response is zero everywhere")]
    NoResponse,
    #[error("the zeros were not found: the eigenvalue iteration does not converge")]
    NotConverged,
    #[error("the model has no output {} or no input {}", pair.output + 1, pair.input + 1)]
    OutsideModel { pair: Pair },
}

impl ZerosError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TooLarge(..) => "too-large",
            Self::NoResponse => "no-response",
            Self::NotConverged => "not-converged",
            Self::OutsideModel { .. } => "outside-model",
        }
    }
}

/// Returns the finite transmission zeros \[rad/s\] of a model's response. Empty for a measured
/// response, which has no states, and if the zeros are unavailable.
pub fn finite_zeros(dynamics: &Dynamics, pair: Pair) -> Vec<Complex<f64>> {
    match dynamics {
        Dynamics::StateSpace(model) => match transmission_zeros(model, pair) {
            Ok(zeros) => zeros.finite,
            Err(_) => Vec::new(),
        },
        Dynamics::Measured(_) => Vec::new(),
    }
}

/// Computes the zeros of `H(s) = C (sI - A)^-1 B + D` for a single output and input. Uncontrollable
/// and unobservable poles, which cancel, do not appear as zeros. Discrete-time zeros are given as
/// `s = ln z / T` (M2a).
///
/// # Errors
/// [`ZerosError`] if the model has too large an entry, or lacks the output or the input; if the
/// response is zero; or if the eigenvalue iteration does not converge.
pub fn transmission_zeros(model: &StateSpace, pair: Pair) -> Result<TransmissionZeros, ZerosError> {
    if let Some(entry) = LargeEntry::find(model) {
        return Err(ZerosError::TooLarge(entry));
    }
    if pair.output >= model.outputs() || pair.input >= model.inputs() {
        return Err(ZerosError::OutsideModel { pair });
    }
    let plane = SPlane::new(model);
    // Steps 1 and 2. The last `controllable` makes A Hessenberg again, as step 3 requires.
    let minimal = SingleResponse::new(model, plane, pair)
        .controllable()
        .transposed()
        .controllable()
        .transposed()
        .controllable();
    // Step 3.
    let ReducedResponse {
        model: reduced,
        mut infinite,
    } = without_infinite_zeros(minimal.clone()).ok_or(ZerosError::NoResponse)?;
    // Step 4: output feedback that keeps the output at zero.
    let closed = &reduced.a - &reduced.b * reduced.c.transpose() / reduced.d;
    let form = SchurForm::new(&closed).ok_or(ZerosError::NotConverged)?;
    let mut finite = Vec::with_capacity(closed.nrows());
    for zero in form.eigenvalues().into_iter().filter(|zero| zero.im >= 0.0) {
        // Step 5.
        let zero = polished(&minimal, zero);
        let has_conjugate = zero.im > 0.0;
        match plane.value(zero) {
            Some(zero) => {
                finite.push(zero);
                if has_conjugate {
                    finite.push(zero.conj());
                }
            }
            None => infinite += 1 + usize::from(has_conjugate),
        }
    }
    finite.sort_by(|a, b| {
        a.norm()
            .total_cmp(&b.norm())
            .then(a.re.total_cmp(&b.re))
            .then(b.im.total_cmp(&a.im))
    });
    Ok(TransmissionZeros { finite, infinite })
}

/// A response without zeros at infinity, and how many zeros at infinity were removed.
struct ReducedResponse {
    model: SingleResponse,
    infinite: usize,
}

/// Removes the zeros at infinity from a Hessenberg model (step 3); `None` if nothing remains.
///
/// A feed-through is treated as zero if a zero would otherwise be farther out than 1e10 times
/// `|A|`, or, once a zero has been removed, if it is below 1e-12 times `|c|`, its rounding error.
fn without_infinite_zeros(mut model: SingleResponse) -> Option<ReducedResponse> {
    /// Maximum zero magnitude, relative to `|A|`; a zero farther out counts as infinite.
    const FARTHEST: f64 = 1e10;
    /// Rounding error in a feed-through that was an entry of c, relative to `|c|`.
    const ROUNDING: f64 = 1e-12;
    let size = model.a.norm().max(f64::MIN_POSITIVE);
    let mut infinite = 0;
    loop {
        let states = model.a.nrows();
        // The farthest zero is about |b| |c| / |d| out.
        let through_states = model.b.norm() * model.c.norm() / size;
        let rounding = if infinite == 0 {
            0.0
        } else {
            ROUNDING * model.c.norm()
        };
        if model.d != 0.0 && model.d.abs() > rounding.max(through_states / FARTHEST) {
            return Some(ReducedResponse { model, infinite });
        }
        if states == 0 {
            return None;
        }
        let remaining = states - 1;
        // Omit the first entry of b: it is b's only nonzero entry, and scales the response without
        // moving any zero.
        model = SingleResponse {
            a: model.a.view((1, 1), (remaining, remaining)).into_owned(),
            b: model.a.view((1, 0), (remaining, 1)).column(0).into_owned(),
            c: model.c.rows(1, remaining).into_owned(),
            d: model.c[0],
        };
        infinite += 1;
    }
}

/// A response's value and slope at a point in the s-plane.
struct PointValue {
    /// `H(s)`.
    value: Complex<f64>,
    /// `dH/ds = -c (sI - A)^-2 b`.
    slope: Complex<f64>,
}

/// Computes a response's value and slope at `s`; `None` at a pole.
fn response_and_slope(model: &SingleResponse, s: Complex<f64>) -> Option<PointValue> {
    let resolvent = DMatrix::from_fn(model.a.nrows(), model.a.nrows(), |row, column| {
        let diagonal = if row == column { s } else { Complex::from(0.0) };
        diagonal - model.a[(row, column)]
    });
    let factors = resolvent.lu();
    let states = factors.solve(&model.b.map(Complex::from))?;
    let state_slopes = factors.solve(&states)?;
    Some(PointValue {
        value: output(model, &states) + model.d,
        slope: -output(model, &state_slopes),
    })
}

/// Returns the output `c x` for states x.
fn output(model: &SingleResponse, states: &DVector<Complex<f64>>) -> Complex<f64> {
    model.c.iter().zip(states.iter()).map(|(c, x)| x * *c).sum()
}

/// Refines a zero by Newton's method (step 5), by a relative distance up to 1e-3; returns it
/// unchanged if the response does not decrease.
fn polished(model: &SingleResponse, zero: Complex<f64>) -> Complex<f64> {
    /// Maximum Newton step count; each step about doubles the number of correct digits.
    const MOST_STEPS: usize = 4;
    /// Maximum relative distance between a zero and its refined value, so that a refinement does
    /// not end at a neighbouring zero.
    const CLOSE: f64 = 1e-3;
    let mut best = zero;
    let Some(mut last) = response_and_slope(model, zero) else {
        return zero;
    };
    for _ in 0..MOST_STEPS {
        let mut next = best - last.value / last.slope;
        if zero.im == 0.0 {
            next.im = 0.0;
        }
        // `!(...).le(...)` is also true for NaN, which results from a zero slope.
        if !(next - zero).norm().le(&(CLOSE * zero.norm())) || next.im < 0.0 {
            break;
        }
        match response_and_slope(model, next) {
            Some(there) if there.value.norm() < last.value.norm() => {
                best = next;
                last = there;
            }
            _ => break,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use nalgebra::{dmatrix, dvector};
    use proptest::prelude::*;

    use super::*;
    use crate::dataset::state_space::Timing;

    const ONLY: Pair = Pair {
        output: 0,
        input: 0,
    };

    /// Returns the coefficients of the polynomial with these real roots, highest power first.
    fn polynomial(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |of, root| {
            let shifted = of.iter().copied().chain([0.0]);
            let scaled =
                std::iter::once(0.0).chain(of.iter().map(|coefficient| -root * coefficient));
            shifted.zip(scaled).map(|(a, b)| a + b).collect()
        })
    }

    /// Returns `gain (s - z1) ... / ((s - p1) ...)` in controllable canonical form.
    fn canonical(gain: f64, zeros: &[f64], poles: &[f64]) -> StateSpace {
        let n = poles.len();
        let mut numerator = polynomial(zeros);
        let denominator = polynomial(poles);
        while numerator.len() <= n {
            numerator.insert(0, 0.0);
        }
        let a = DMatrix::from_fn(n, n, |row, column| {
            match (row + 1 == n, column == row + 1) {
                (true, _) => -denominator[n - column],
                (false, next) => f64::from(u8::from(next)),
            }
        });
        let b = DMatrix::from_fn(n, 1, |row, _| f64::from(u8::from(row + 1 == n)));
        let through = numerator[0];
        let c = DMatrix::from_fn(1, n, |_, column| {
            gain * (numerator[n - column] - through * denominator[n - column])
        });
        StateSpace::new(a, b, c, dmatrix![gain * through]).unwrap()
    }

    /// Returns the model in other state coordinates.
    fn transformed(model: &StateSpace, by: &DMatrix<f64>) -> StateSpace {
        let inverse = by.clone().try_inverse().unwrap();
        StateSpace::new(
            by * model.a() * &inverse,
            by * model.b(),
            model.c() * inverse,
            model.d().clone(),
        )
        .unwrap()
    }

    fn assert_zeros(model: &StateSpace, expected: &[f64], infinite: usize, tolerance: f64) {
        let found = transmission_zeros(model, ONLY).unwrap();
        assert_eq!(
            (found.finite.len(), found.infinite),
            (expected.len(), infinite),
            "{found:?}"
        );
        for zero in expected {
            let nearest = found
                .finite
                .iter()
                .map(|found| (found - zero).norm())
                .fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= tolerance * (1.0 + zero.abs()),
                "{zero}: {found:?}"
            );
        }
    }

    #[test]
    fn the_zeros_of_a_ratio_of_polynomials_are_found() {
        // Tolerance: the condition of polynomials of degree 2 to 5 with roots this far apart.
        assert_zeros(
            &canonical(2.0, &[-1.0, -2.0], &[-3.0, -4.0, -5.0]),
            &[-1.0, -2.0],
            1,
            1e-12,
        );
        assert_zeros(
            &canonical(-0.1, &[-1.0, 2.0, -8.0], &[-3.0, -4.0, -5.0]),
            &[-1.0, 2.0, -8.0],
            0,
            1e-12,
        );
        assert_zeros(
            &canonical(1e-6, &[0.0, -30.0], &[-1.0, -2.0, -7.0, -9.0, -20.0]),
            &[0.0, -30.0],
            3,
            1e-10,
        );
        assert_zeros(&canonical(5.0, &[], &[-1.0, -2.0, -3.0]), &[], 3, 1e-12);
    }

    #[test]
    fn a_conjugate_pair_of_zeros_is_one_to_the_last_digit() {
        // (s^2 + 0.2 s + 4) / (s + 1)^3.
        let model = StateSpace::new(
            dmatrix![0.0, 1.0, 0.0; 0.0, 0.0, 1.0; -1.0, -3.0, -3.0],
            dmatrix![0.0; 0.0; 1.0],
            dmatrix![4.0, 0.2, 1.0],
            dmatrix![0.0],
        );
        let found = transmission_zeros(&model.unwrap(), ONLY).unwrap();
        assert_eq!(
            (found.finite.len(), found.infinite, found.finite[0]),
            (2, 1, found.finite[1].conj())
        );
        assert!((found.finite[0] - Complex::new(-0.1, 3.99_f64.sqrt())).norm() < 1e-13);
    }

    #[test]
    fn a_pole_that_the_response_does_not_have_is_no_zero() {
        // A lag and its integral, which is unobservable; and an uncontrollable mode.
        let model = StateSpace::new(
            dmatrix![-1.0, 0.0, 0.5; 1.0, 0.0, 0.0; 0.0, 0.0, -4.0],
            dmatrix![1.0; 0.0; 0.0],
            dmatrix![2.0, 0.0, 1.0],
            dmatrix![1.0],
        );
        // 1 + 2 / (s + 1).
        assert_zeros(&model.unwrap(), &[-3.0], 0, 1e-14);
        let hidden = SingleResponse {
            a: dmatrix![-1.5, 0.5; 0.5, -1.5],
            b: dvector![1.0, 1.0],
            c: dvector![1.0, 0.0],
            d: 1.0,
        };
        let model = StateSpace::new(
            hidden.a.clone(),
            DMatrix::from_column_slice(2, 1, hidden.b.as_slice()),
            DMatrix::from_row_slice(1, 2, hidden.c.as_slice()),
            dmatrix![1.0],
        );
        // 1 + 1 / (s + 1); the pole at -2 is uncontrollable.
        assert_zeros(&model.unwrap(), &[-2.0], 0, 1e-14);
    }

    #[test]
    fn zeros_of_discrete_time_are_those_of_the_recursion() {
        // (z - 0.9) z / ((z - 0.5) (z - 0.8) (z + 0.3)), T = 0.1 s: s = ln 0.9 / T; z = 0 has no s.
        let timing = Timing {
            sample_time_s: Some(0.1),
            ..Timing::default()
        };
        let model = canonical(2.0, &[0.9, 0.0], &[0.5, 0.8, -0.3])
            .timed(timing)
            .unwrap();
        assert_zeros(&model, &[0.9_f64.ln() / 0.1], 2, 1e-12);
    }

    #[test]
    fn a_response_that_is_nowhere_is_refused() {
        let apart = StateSpace::new(
            dmatrix![-1.0, 0.0; 0.0, -2.0],
            dmatrix![1.0; 0.0],
            dmatrix![0.0, 1.0],
            dmatrix![0.0],
        );
        assert_eq!(
            transmission_zeros(&apart.unwrap(), ONLY),
            Err(ZerosError::NoResponse)
        );
        let gain = StateSpace::new(
            DMatrix::zeros(0, 0),
            DMatrix::zeros(0, 1),
            DMatrix::zeros(1, 0),
            dmatrix![3.0],
        );
        let gain = gain.unwrap();
        assert_eq!(
            transmission_zeros(&gain, ONLY),
            Ok(TransmissionZeros {
                finite: Vec::new(),
                infinite: 0
            })
        );
        let pair = Pair::new(1, 0);
        assert_eq!(
            transmission_zeros(&gain, pair),
            Err(ZerosError::OutsideModel { pair })
        );
    }

    proptest! {
        #[test]
        fn zeros_are_the_same_in_any_coordinates_and_the_response_is_zero_there(
            zeros in prop::collection::vec(-9.0_f64..9.0, 0..4), extra in 0_usize..3,
            turns in prop::collection::vec(-1.0_f64..1.0, 49),
        ) {
            let apart = |values: &[f64]| values.iter().enumerate()
                .all(|(i, a)| values[..i].iter().all(|b| (a - b).abs() > 0.3));
            let poles: Vec<f64> = (0..zeros.len() + extra + 1).map(|k| -0.55 - 1.1 * k as f64).collect();
            let mut all = zeros.clone();
            all.extend(&poles);
            prop_assume!(apart(&all));
            let n = poles.len();
            let by = DMatrix::from_fn(n, n, |row, column| turns[7 * row + column] + if row == column { 3.0 } else { 0.0 });
            let model = transformed(&canonical(1.7, &zeros, &poles), &by);
            let found = transmission_zeros(&model, ONLY).unwrap();
            prop_assert_eq!((found.finite.len(), found.infinite), (zeros.len(), extra + 1));
            for zero in &zeros {
                let nearest = found.finite.iter().map(|found| (found - zero).norm()).fold(f64::INFINITY, f64::min);
                // Tolerance: the canonical form of seven poles has entries up to 1e4, and zeros
                // that are 0.3 apart have a condition number of about 1e3.
                prop_assert!(nearest < 1e-6, "{zero}: {found:?}");
            }
            let minimal = SingleResponse::new(&model, SPlane::new(&model), ONLY);
            let peak = (0..200).filter_map(|k| response_and_slope(&minimal, Complex::new(0.0, 0.1 * f64::from(k))))
                .map(|there| there.value.norm()).fold(0.0, f64::max);
            for zero in &found.finite {
                let value = response_and_slope(&minimal, *zero).unwrap().value;
                // Tolerance: of sixteen digits, the coordinates cost three and the canonical form
                // four, as above; and far to the left the response is steeper than on the axis
                // where the peak is evaluated.
                prop_assert!(value.norm() < 1e-6 * peak, "{zero}: {} of {peak}", value.norm());
            }
        }
    }
}
