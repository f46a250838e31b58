//! Quantiles and probabilities for Student's, Fisher's and the chi-squared distribution.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Degrees of freedom above which the normal distribution replaces Student's: the two differ by
/// 2e-8 at this value.
const NORMAL_FROM: f64 = 1e8;

/// Degrees of freedom above which Student's quantile is expanded about the normal quantile. Four
/// terms have an error around 1e-12 at this value, and the inverse incomplete beta function does
/// not converge for some larger values.
const EXPANDED_FROM: f64 = 1e3;

/// Computes Student's quantile `t(nu)` at `(1 + level) / 2` for any real `nu = degrees`, which
/// counts as 1 if smaller; the normal quantile for infinite `nu`.
///
/// Above a thousand degrees of freedom the expansion 26.7.5 in M. Abramowitz, I. A. Stegun,
/// *Handbook of Mathematical Functions*, 1964, is used.
pub fn student_quantile(level: f64, degrees: f64) -> f64 {
    let p = 0.5 * (1.0 + level);
    match StudentsT::new(0.0, 1.0, degrees.max(1.0)) {
        Ok(student) if degrees < EXPANDED_FROM => student.inverse_cdf(p),
        _ => expanded_quantile(Normal::standard().inverse_cdf(p), degrees),
    }
}

/// Expands Student's quantile in powers of `1 / nu` about the normal quantile `z`.
fn expanded_quantile(z: f64, degrees: f64) -> f64 {
    let square = z * z;
    let terms = [
        (square + 1.0) / 4.0,
        ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
        ((((79.0 * square + 776.0) * square + 1482.0) * square - 1920.0) * square - 945.0)
            / 92160.0,
    ];
    let relative = terms
        .iter()
        .rev()
        .fold(0.0, |sum, term| (sum + term) / degrees);
    z * relative + z
}

/// Computes the two-sided probability `2 (1 - T_nu(|ratio|))`, where `T_nu` is Student's
/// distribution function with `nu = degrees` degrees of freedom, at least 1.
pub fn student_two_sided(ratio: f64, degrees: f64) -> f64 {
    match StudentsT::new(0.0, 1.0, degrees.max(1.0)) {
        Ok(student) if degrees < NORMAL_FROM => 2.0 * student.sf(ratio.abs()),
        _ => 2.0 * Normal::standard().sf(ratio.abs()),
    }
}

/// Computes the upper tail of Fisher's distribution, `1 - F_(above, below)(ratio)`: the probability
/// that two estimates of one variance have this ratio or a larger one, with `above` and `below`
/// degrees of freedom. `None` if the degrees of freedom are not positive.
pub fn fisher_upper(ratio: f64, above: f64, below: f64) -> Option<f64> {
    Some(FisherSnedecor::new(above, below).ok()?.sf(ratio))
}

/// Computes the chi-squared quantile at `p`; `None` if the degrees of freedom are not positive.
pub fn chi_squared_quantile(p: f64, degrees: f64) -> Option<f64> {
    Some(ChiSquared::new(degrees).ok()?.inverse_cdf(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference quantiles from SciPy, computed independently.
    #[test]
    fn quantiles_and_probabilities_are_known() {
        let t_95 = [
            (1.0, 6.31375151468),
            (1.7, 3.30361514324),
            (2.0, 2.91998558035),
            (3.4, 2.24467111039),
            (6.0, 1.94318028052),
            (12.3, 1.77867254624),
            (24.0, 1.71088207991),
            (48.6, 1.67681682504),
            (999.0, 1.64638034543),
            (1000.0, 1.64637881729),
            (2.5e5, 1.64485972205),
            (1.8e7, 1.64485371161),
            (f64::INFINITY, 1.64485362695),
            (1e12, 1.64485362695),
        ];
        for (degrees, expected) in t_95 {
            // The reference values have twelve digits.
            assert!(
                (student_quantile(0.9, degrees) - expected).abs() < 1e-9,
                "t of {degrees}"
            );
        }
        assert_eq!(
            student_quantile(0.9, 0.3),
            student_quantile(0.9, 1.0),
            "never fewer than one degree"
        );
        for (ratio, degrees, expected) in [
            (2.1, 6.0, 0.0804776876047),
            (5.4, 26.3, 1.13128376312e-05),
            (-0.4, 3.2, 0.714374785591),
        ] {
            assert!(
                (student_two_sided(ratio, degrees) / expected - 1.0).abs() < 1e-9,
                "p of {ratio}"
            );
        }
        for (ratio, above, below, expected) in [
            (2.31, 6.0, 72.5, 0.0426460967923),
            (0.9, 8.0, 100.0, 0.51965499353),
            (7.4, 6.0, 40.2, 2.2368214366e-05),
        ] {
            assert!(
                (fisher_upper(ratio, above, below).unwrap() / expected - 1.0).abs() < 1e-8,
                "F of {ratio}"
            );
        }
        for (p, degrees, expected) in [
            (0.05, 1.0, 0.00393214000002),
            (0.05, 2.0, 0.102586588775),
            (0.05, 6.0, 1.63538289433),
            (0.05, 8.0, 2.7326367935),
            (0.95, 1.0, 3.84145882069),
            (0.95, 2.0, 5.99146454711),
            (0.95, 6.0, 12.5915872437),
            (0.95, 8.0, 15.5073130559),
        ] {
            assert!(
                (chi_squared_quantile(p, degrees).unwrap() / expected - 1.0).abs() < 1e-8,
                "chi of {p}, {degrees}"
            );
        }
    }
}
