//! Whether two conditions differ in earnest (M13.4).

use super::bar::Bar;
use super::part::satterthwaite;
use super::quantiles::student_two_sided;

/// The difference of one figure between two conditions, beside what their bundles explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// `delta = q_c - q_c'`.
    pub delta: f64,
    /// `u_delta`, from the parts of both.
    pub deviation: f64,
    /// Degrees of freedom; none where neither has a spread.
    pub degrees: Option<f64>,
}

impl Difference {
    /// The difference of two figures of two conditions.
    pub fn of(first: &Bar, second: &Bar) -> Self {
        let deviation = (first.variance() + second.variance()).sqrt();
        Self {
            delta: first.value - second.value,
            deviation,
            degrees: satterthwaite(first.parts().chain(second.parts())),
        }
    }

    /// `|delta| / u_delta`: times what the bundles explain; none where they have no spread.
    pub fn ratio(&self) -> Option<f64> {
        self.degrees.map(|_| self.delta.abs() / self.deviation)
    }

    /// How likely so great a ratio is where there is no difference.
    pub fn p(&self) -> Option<f64> {
        Some(student_two_sided(self.ratio()?, self.degrees?))
    }
}

/// Holm's correction of probabilities that are looked at together, in their order.
///
/// S. Holm, "A simple sequentially rejective multiple test procedure", Scandinavian Journal of Statistics 6 (1979).
pub fn holm(probabilities: &[f64]) -> Vec<f64> {
    let mut rising: Vec<usize> = (0..probabilities.len()).collect();
    rising.sort_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]));
    let mut corrected = vec![0.0; probabilities.len()];
    let mut most = 0.0_f64;
    for (rank, place) in rising.into_iter().enumerate() {
        most = most.max((probabilities.len() - rank) as f64 * probabilities[place]).min(1.0);
        corrected[place] = most;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holm_multiplies_the_least_by_all_and_never_falls() {
        assert_eq!(holm(&[0.03, 0.01, 0.04, 0.5]), [0.09, 0.04, 0.09, 0.5]);
        assert_eq!(holm(&[0.6, 0.7]), [1.0, 1.0]);
        assert_eq!(holm(&[]), Vec::<f64>::new());
    }
}
