//! Significance of differences between two conditions (M13.4).
//!
//! ```text
//! ratio <- |delta| / u_delta,   delta = q_c - q_c',   u_delta = sqrt(u_c^2 + u_c'^2)
//! p     <- two-sided probability of this ratio in Student's distribution
//! ```
//!
//! `q_c` and `u_c` are the value and the standard deviation in a condition's error bar. Over
//! several differences, the probabilities p are corrected by Holm's method.

use super::bar::Bar;
use super::distributions::student_two_sided;
use super::variance_component::satterthwaite;

/// Difference in a value between two conditions, with the standard deviation expected from both
/// bars.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// `delta = q_c - q_c'`.
    pub delta: f64,
    /// Expected standard deviation, `u_delta`.
    pub deviation: f64,
    /// Degrees of freedom of `deviation`; `None` if neither condition has a spread.
    pub degrees_of_freedom: Option<f64>,
}

impl Difference {
    /// Computes `first - second`.
    pub fn between(first: &Bar, second: &Bar) -> Self {
        let deviation = (first.variance() + second.variance()).sqrt();
        Self {
            delta: first.value - second.value,
            deviation,
            degrees_of_freedom: satterthwaite(first.parts().chain(second.parts())),
        }
    }

    /// Returns `|delta| / u_delta`, the difference over its expected standard deviation; `None`
    /// without a spread.
    pub fn ratio(&self) -> Option<f64> {
        self.degrees_of_freedom?;
        Some(self.delta.abs() / self.deviation)
    }

    /// Returns the probability that a ratio this large arises without a true difference, before
    /// Holm's correction; `None` without a spread.
    pub fn p(&self) -> Option<f64> {
        Some(student_two_sided(self.ratio()?, self.degrees_of_freedom?))
    }
}

/// Returns the probabilities after Holm's correction for multiple tests, in the given order.
///
/// S. Holm, "A simple sequentially rejective multiple test procedure", *Scandinavian Journal of
/// Statistics* 6, 1979.
pub fn holm(probabilities: &[f64]) -> Vec<f64> {
    let mut rising: Vec<usize> = (0..probabilities.len()).collect();
    rising.sort_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]));
    let mut corrected = vec![0.0; probabilities.len()];
    let mut greatest = 0.0_f64;
    for (rank, index) in rising.into_iter().enumerate() {
        let remaining = (probabilities.len() - rank) as f64;
        greatest = greatest.max(remaining * probabilities[index]).min(1.0);
        corrected[index] = greatest;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holm_multiplies_the_least_probability_by_the_count_and_never_falls() {
        assert_eq!(holm(&[0.03, 0.01, 0.04, 0.5]), [0.09, 0.04, 0.09, 0.5]);
        assert_eq!(holm(&[0.6, 0.7]), [1.0, 1.0]);
        assert_eq!(holm(&[]), Vec::<f64>::new());
    }
}
