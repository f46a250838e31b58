//! Poles and zeros in the s-plane, for continuous and discrete time (M2a).

use nalgebra::{Complex, DMatrix};

use crate::dataset::StateSpace;

/// Map from matrix eigenvalues to poles and zeros `s` \[rad/s\]: identity in continuous time, `s =
/// ln z / T` in discrete time.
#[derive(Clone, Copy, Debug)]
pub(super) struct SPlane {
    sample_time_s: Option<f64>,
}

/// `|z|` below which a mode vanishes within one sample; it is treated as `z = 0`, which has no `s`.
const GONE: f64 = 1e-6;

impl SPlane {
    pub(super) fn new(model: &StateSpace) -> Self {
        Self {
            sample_time_s: model.timing().sample_time_s,
        }
    }

    /// Returns the matrix whose eigenvalues [`SPlane::value`] expects: `A`, or `A - I` in discrete
    /// time, which preserves more digits for fast sampling.
    pub(super) fn matrix(self, a: &DMatrix<f64>) -> DMatrix<f64> {
        match self.sample_time_s {
            None => a.clone(),
            Some(_) => a - DMatrix::identity(a.nrows(), a.ncols()),
        }
    }

    /// Returns the `s` for an eigenvalue of [`SPlane::matrix`]: `lambda`, or in discrete time the
    /// principal value of `ln(1 + lambda) / T`; `None` if `z = 1 + lambda` is practically zero.
    pub(super) fn value(self, eigenvalue: Complex<f64>) -> Option<Complex<f64>> {
        let Some(sample_time_s) = self.sample_time_s else {
            return Some(eigenvalue);
        };
        let Complex { re, im } = eigenvalue;
        if (eigenvalue + 1.0).norm() < GONE {
            return None;
        }
        // `ln |z|`, from `|z|^2 - 1`, so that no digits cancel near z = 1.
        let log_modulus = 0.5 * (re * (2.0 + re) + im * im).ln_1p();
        Some(Complex::new(log_modulus, im.atan2(1.0 + re)) / sample_time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLED: SPlane = SPlane {
        sample_time_s: Some(0.01),
    };

    #[test]
    fn a_sampled_pole_is_found_where_it_was() {
        for s in [
            Complex::new(-0.001, 0.0),
            Complex::new(-2.0, 30.0),
            Complex::new(0.3, -1e-3),
        ] {
            let found = SAMPLED.value((s * 0.01).exp() - 1.0).unwrap();
            // Tolerance: the difference from 1 has a rounding error of 1e-16, a hundred times as
            // much in s.
            assert!((found - s).norm() < 1e-13, "{found} {s}");
        }
    }

    #[test]
    fn a_mode_that_vanishes_within_a_sample_has_no_s() {
        assert_eq!(SAMPLED.value(Complex::from(-1.0)), None);
        assert_eq!(SAMPLED.value(Complex::from(0.0)), Some(Complex::from(0.0)));
        let alternating = SAMPLED.value(Complex::from(-2.0)).unwrap();
        assert_eq!(alternating, Complex::new(0.0, 100.0 * std::f64::consts::PI));
    }
}
