//! Finds a root between two frequencies by Chandrupatla's method.

/// Relative bracket width at which the search ends.
const ROOT_TOLERANCE: f64 = 1e-12;

/// Finds the root of `value` between two frequencies; `value` is positive at the upper frequency
/// and not positive at the lower frequency.
///
/// ```text
/// 1  [a, b] brackets the root, a the newest point; c is the point dropped last
/// 2  inverse quadratic interpolation through a, b, c where it is monotonic, else the middle
/// 3  no step closer to an end than the tolerance, so that both ends close in
/// ```
///
/// T. R. Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a
/// nonlinear function without using derivatives", *Advances in Engineering Software* 28, 1997.
pub(super) fn root_between([low, high]: [f64; 2], value: impl Fn(f64) -> Option<f64>) -> f64 {
    let mut a = Sample::new(high, &value);
    let mut b = Sample::new(low, &value);
    // Where the next point lies: 0 at a, 1 at b.
    let mut fraction = 0.5;
    loop {
        let new = Sample::new(a.omega + fraction * (b.omega - a.omega), &value);
        // Step 1: the bracket keeps the end with the other sign, which becomes or remains b; c is
        // dropped.
        let c = if new.is_positive() == a.is_positive() {
            a
        } else {
            std::mem::replace(&mut b, a)
        };
        a = new;
        let best = if a.value.abs() < b.value.abs() { a } else { b };
        // The tolerance relative to the bracket width; above 1/2 the bracket is narrower than twice
        // the tolerance.
        let least_fraction = ROOT_TOLERANCE * best.omega / (b.omega - a.omega).abs();
        if least_fraction > 0.5 || best.value == 0.0 || !least_fraction.is_finite() {
            return best.omega;
        }
        // Steps 2 and 3
        fraction = if is_monotonic(a, b, c) {
            quadratic_fraction(a, b, c).clamp(least_fraction, 1.0 - least_fraction)
        } else {
            0.5
        };
    }
}

/// A frequency and the function value there.
#[derive(Clone, Copy)]
struct Sample {
    omega: f64,
    value: f64,
}

impl Sample {
    /// Evaluates `value` at `omega`; a missing value or NaN counts as negative, so that the root
    /// lies above `omega`.
    fn new(omega: f64, value: &impl Fn(f64) -> Option<f64>) -> Self {
        let value = value(omega).filter(|value| !value.is_nan()).unwrap_or(-1.0);
        Self { omega, value }
    }

    fn is_positive(self) -> bool {
        self.value > 0.0
    }
}

/// Returns whether the inverse quadratic through three points is monotonic over the bracket
/// (Chandrupatla's criterion): `xi` and `phi` say where `a` lies between `b` (0) and `c` (1) in
/// frequency and in value.
fn is_monotonic(a: Sample, b: Sample, c: Sample) -> bool {
    let xi = (a.omega - b.omega) / (c.omega - b.omega);
    let phi = (a.value - b.value) / (c.value - b.value);
    phi.powi(2) < xi && (1.0 - phi).powi(2) < 1.0 - xi
}

/// Returns where the inverse quadratic through three points is zero, between `a` (0) and `b` (1).
fn quadratic_fraction(a: Sample, b: Sample, c: Sample) -> f64 {
    a.value / (b.value - a.value) * c.value / (b.value - c.value)
        + (c.omega - a.omega) / (b.omega - a.omega) * a.value / (c.value - a.value) * b.value
            / (c.value - b.value)
}
