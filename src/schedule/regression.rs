//! A channel's figure as a function of airspeed.

use nalgebra::{DMatrix, DVector};

/// The airspeeds of the scheduled conditions, centred and scaled: `v = (V - mean V) / (half the range of V)` (M11).
#[derive(Clone, Debug, PartialEq)]
pub struct Airspeeds {
    /// Airspeed of each condition \[kt\].
    pub values_kt: Vec<f64>,
    /// Mean \[kt\].
    pub mean_kt: f64,
    /// Half the range \[kt\]; zero where all conditions share one airspeed.
    pub half_range_kt: f64,
    /// Least airspeed \[kt\].
    pub min_kt: f64,
    /// Largest airspeed \[kt\].
    pub max_kt: f64,
}

impl Airspeeds {
    /// The airspeeds \[kt\] of at least one condition.
    pub fn new(values_kt: Vec<f64>) -> Option<Self> {
        if values_kt.is_empty() {
            return None;
        }
        let min_kt = values_kt.iter().copied().fold(f64::INFINITY, f64::min);
        let max_kt = values_kt.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mean_kt = values_kt.iter().sum::<f64>() / values_kt.len() as f64;
        Some(Self { values_kt, mean_kt, half_range_kt: 0.5 * (max_kt - min_kt), min_kt, max_kt })
    }

    /// The scaled airspeed `v`; outside the conditions' range, that of the nearer end. Zero where there is no range.
    pub fn scaled(&self, airspeed_kt: f64) -> f64 {
        if self.half_range_kt == 0.0 {
            return 0.0;
        }
        (airspeed_kt.clamp(self.min_kt, self.max_kt) - self.mean_kt) / self.half_range_kt
    }

    /// The distinct airspeeds \[kt\], rising.
    pub fn distinct_kt(&self) -> Vec<f64> {
        let mut distinct = self.values_kt.clone();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        distinct
    }
}

/// A function of airspeed fitted to one figure of each condition.
#[derive(Clone, Debug, PartialEq)]
pub enum Regression {
    /// `c_0 + c_1 v + c_2 v^2 + ...` in the scaled airspeed, lowest power first.
    Polynomial {
        /// Coefficients, lowest power first.
        coefficients: Vec<f64>,
    },
    /// Linear between the means at each distinct airspeed, constant outside.
    Table {
        /// Distinct airspeeds \[kt\], rising.
        airspeeds_kt: Vec<f64>,
        /// Mean figure at each.
        values: Vec<f64>,
    },
}

impl Regression {
    /// The polynomial of least squares; its degree is at most the number of distinct airspeeds less one.
    pub fn polynomial(airspeeds: &Airspeeds, figures: &[f64], degree: usize) -> Self {
        let degree = degree.min(airspeeds.distinct_kt().len().saturating_sub(1));
        let v: Vec<f64> = airspeeds.values_kt.iter().map(|&airspeed| airspeeds.scaled(airspeed)).collect();
        let design = DMatrix::from_fn(v.len(), degree + 1, |row, power| v[row].powi(power as i32));
        let qr = design.qr();
        // Full column rank: as many distinct v in [-1, 1] as there are columns, so R has no zero on its diagonal.
        let projected = qr.q().transpose() * DVector::from_column_slice(figures);
        let coefficients = qr.r().solve_upper_triangular(&projected).unwrap_or(projected);
        Self::Polynomial { coefficients: coefficients.iter().copied().collect() }
    }

    /// The mean figure at each distinct airspeed.
    pub fn table(airspeeds: &Airspeeds, figures: &[f64]) -> Self {
        let airspeeds_kt = airspeeds.distinct_kt();
        let mean_at = |airspeed: &f64| {
            let at = airspeeds.values_kt.iter().zip(figures).filter(|(value, _)| *value == airspeed);
            let (sum, count) = at.fold((0.0, 0.0), |(sum, count), (_, figure)| (sum + figure, count + 1.0));
            sum / count
        };
        let values = airspeeds_kt.iter().map(mean_at).collect();
        Self::Table { airspeeds_kt, values }
    }

    /// The figure at an airspeed \[kt\]; outside the conditions' range the end value holds.
    pub fn at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> f64 {
        match self {
            Regression::Polynomial { coefficients } => {
                let v = airspeeds.scaled(airspeed_kt);
                coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * v + coefficient)
            }
            Regression::Table { airspeeds_kt, values } => {
                let after = airspeeds_kt.partition_point(|&at| at < airspeed_kt);
                if after == 0 {
                    return values[0];
                }
                if after == values.len() {
                    return values[after - 1];
                }
                let fraction =
                    (airspeed_kt - airspeeds_kt[after - 1]) / (airspeeds_kt[after] - airspeeds_kt[after - 1]);
                values[after - 1] + fraction * (values[after] - values[after - 1])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn airspeeds() -> Airspeeds {
        Airspeeds::new(vec![45.0, 60.0, 60.0, 90.0, 140.0]).unwrap()
    }

    #[test]
    fn a_parabola_is_found_exactly() {
        let airspeeds = airspeeds();
        let figure = |airspeed: f64| 1.0 + 0.02 * airspeed - 1e-4 * airspeed * airspeed;
        let figures: Vec<f64> = airspeeds.values_kt.iter().map(|&airspeed| figure(airspeed)).collect();
        let regression = Regression::polynomial(&airspeeds, &figures, 2);
        // Least squares with a condition number of about 5.
        assert!((regression.at(&airspeeds, 120.0) - figure(120.0)).abs() < 1e-13);
        assert!((regression.at(&airspeeds, 200.0) - figure(140.0)).abs() < 1e-13, "the end value holds");
        assert!((regression.at(&airspeeds, 0.0) - figure(45.0)).abs() < 1e-13, "the end value holds");
    }

    #[test]
    fn one_airspeed_leaves_the_mean() {
        let airspeeds = Airspeeds::new(vec![80.0, 80.0]).unwrap();
        let regression = Regression::polynomial(&airspeeds, &[1.0, 3.0], 2);
        assert!((regression.at(&airspeeds, 100.0) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_table_takes_means_and_is_linear_between_them() {
        let airspeeds = airspeeds();
        let regression = Regression::table(&airspeeds, &[1.0, 2.0, 4.0, 6.0, 5.0]);
        for (airspeed, expected) in [(30.0, 1.0), (45.0, 1.0), (52.5, 2.0), (60.0, 3.0), (115.0, 5.5), (150.0, 5.0)] {
            assert_eq!(regression.at(&airspeeds, airspeed), expected, "{airspeed} kt");
        }
    }

    proptest! {
        #[test]
        fn the_residual_of_least_squares_is_orthogonal_to_every_power(
            figures in prop::collection::vec(-1.0_f64..1.0, 5), degree in 0_usize..=3,
        ) {
            let airspeeds = airspeeds();
            let regression = Regression::polynomial(&airspeeds, &figures, degree);
            for power in 0..=degree {
                let product: f64 = airspeeds.values_kt.iter().zip(&figures)
                    .map(|(&kt, figure)| (figure - regression.at(&airspeeds, kt)) * airspeeds.scaled(kt).powi(power as i32))
                    .sum();
                prop_assert!(product.abs() < 1e-12);
            }
        }
    }
}
