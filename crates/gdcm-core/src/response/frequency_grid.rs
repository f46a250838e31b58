//! The frequencies at which models are compared or drawn.

use crate::dataset::Band;

/// `N` frequencies \[rad/s\], rising, logarithmically spaced over a band, both ends included (M2).
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyGrid {
    omega: Vec<f64>,
}

impl FrequencyGrid {
    /// `omega_k = exp(ln min + (k / (N - 1)) (ln max - ln min))`, k = 0 ... N - 1, for `N = max(points, 2)`.
    pub fn logarithmic(band: Band, points: usize) -> Self {
        let last = points.max(2) - 1;
        let (low, high) = (band.min().ln(), band.max().ln());
        let mut omega: Vec<f64> = (0..=last).map(|k| (low + (high - low) * k as f64 / last as f64).exp()).collect();
        omega[0] = band.min();
        omega[last] = band.max();
        Self { omega }
    }

    /// The frequencies \[rad/s\].
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// Number of frequencies, `N`.
    pub fn len(&self) -> usize {
        self.omega.len()
    }

    /// Never: a grid has at least two frequencies.
    pub fn is_empty(&self) -> bool {
        self.omega.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_included_and_the_ratio_is_constant() {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 200);
        assert_eq!((grid.omega()[0], grid.omega()[199], grid.len()), (0.5, 12.0, 200));
        let ratio = (12.0_f64 / 0.5).powf(1.0 / 199.0);
        for pair in grid.omega().windows(2) {
            // exp and ln round to about 1 ulp each, of arguments up to 2.5.
            assert!((pair[1] / pair[0] / ratio - 1.0).abs() < 1e-14);
        }
    }
}
