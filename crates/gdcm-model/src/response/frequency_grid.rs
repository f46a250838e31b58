//! Frequency grids, usually logarithmically spaced.

use crate::dataset::Band;

/// `N` rising frequencies \[rad/s\]: logarithmically spaced over a band, both ends included (M2),
/// unless created by [`FrequencyGrid::at`].
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyGrid {
    omega: Vec<f64>,
}

impl FrequencyGrid {
    /// Creates a grid of [`log_spaced`] frequencies over a band, `N = max(points, 2)`.
    pub fn logarithmic(band: Band, points: usize) -> Self {
        Self {
            omega: log_spaced(band.min(), band.max(), points),
        }
    }

    /// Creates a grid from rising frequencies \[rad/s\], at least two.
    pub fn at(omega: Vec<f64>) -> Self {
        Self { omega }
    }

    /// Returns the frequencies \[rad/s\].
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Returns the frequency count, `N`.
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// Returns whether there are no frequencies: always `false`, because a grid has at least two.
    pub fn is_empty(&self) -> bool {
        self.omega.is_empty()
    }
}

/// Returns `omega_k = lowest (highest / lowest)^(k / (N - 1))` \[rad/s\], k = 0 ... N - 1, for `N =
/// max(count, 2)`; the ends are exact.
#[must_use]
pub fn log_spaced(lowest: f64, highest: f64, count: usize) -> Vec<f64> {
    let low = lowest.ln();
    let high = highest.ln();
    let last = count.max(2) - 1;
    let mut omega: Vec<f64> = (0..=last)
        .map(|k| (low + (high - low) * k as f64 / last as f64).exp())
        .collect();
    omega[0] = lowest;
    omega[last] = highest;
    omega
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_included_and_the_ratio_is_constant() {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
        assert_eq!(
            (grid.omega()[0], grid.omega()[199], grid.len()),
            (0.5, 12.0, 200)
        );
        let ratio = (12.0_f64 / 0.5).powf(1.0 / 199.0);
        for pair in grid.omega().windows(2) {
            // Tolerance: exp and ln each round by about 1 ulp, for arguments up to 2.5.
            assert!((pair[1] / pair[0] / ratio - 1.0).abs() < 1e-14);
        }
    }
}
