//! Regression on airspeed: polynomial or lookup table (M11).
//!
//! ```text
//! polynomial:  f(V) = c_0 + c_1 v + c_2 v^2 + ...,  c by least squares
//! table:       the mean in each cluster, linear between the clusters, constant beyond them
//! ```
//!
//! `v` is the airspeed `V`, scaled and limited to the conditions' range. A *cluster* holds
//! conditions at nearly equal airspeeds, which count as one airspeed (`airspeeds`).

use nalgebra::{DMatrix, DVector};

use super::airspeeds::Airspeeds;
use super::settings::ScheduleKind;

/// A function of airspeed, fitted to one value for each condition.
#[derive(Clone, Debug, PartialEq)]
pub enum Regression {
    /// `c_0 + c_1 v + c_2 v^2 + ...` in the scaled airspeed, lowest power first.
    Polynomial { coefficients: Vec<f64> },
    /// Linear between the cluster means, constant outside.
    Table {
        /// Mean airspeed by cluster \[kt\], rising.
        airspeeds_kt: Vec<f64>,
        /// Mean value by cluster.
        values: Vec<f64>,
    },
}

impl Regression {
    /// Fits a function with this form to one value for each condition.
    pub(super) fn fit(airspeeds: &Airspeeds, values: &[f64], kind: ScheduleKind) -> Self {
        match kind {
            ScheduleKind::Polynomial { degree } => Self::polynomial(airspeeds, values, degree),
            ScheduleKind::Table => Self::table(airspeeds, values),
        }
    }

    /// Fits a polynomial to one value for each condition by least squares; its degree is `degree`,
    /// or one less than the cluster count if that is lower.
    pub fn polynomial(airspeeds: &Airspeeds, values: &[f64], degree: usize) -> Self {
        let rows = design(airspeeds, ScheduleKind::Polynomial { degree });
        let powers = rows[0].len();
        let qr = DMatrix::from_fn(rows.len(), powers, |row, power| rows[row][power]).qr();
        let projected = qr.q().transpose() * DVector::from_column_slice(values);
        // The fallback is never used: there are at least as many distinct v as powers, so that R
        // has no zero on its diagonal.
        let coefficients = qr
            .r()
            .solve_upper_triangular(&projected)
            .unwrap_or(projected);
        Self::Polynomial {
            coefficients: coefficients.iter().copied().collect(),
        }
    }

    /// Computes the means by cluster from one value for each condition.
    pub fn table(airspeeds: &Airspeeds, values: &[f64]) -> Self {
        Self::Table {
            airspeeds_kt: airspeeds.clusters_kt(),
            values: airspeeds.cluster_means(values),
        }
    }

    /// Returns the fitted parameters: the coefficients, lowest power first, or the table's values.
    pub fn parameters(&self) -> &[f64] {
        match self {
            Regression::Polynomial { coefficients } => coefficients,
            Regression::Table { values, .. } => values,
        }
    }

    /// Evaluates the regression at an airspeed \[kt\]; outside the conditions' range the end value
    /// applies.
    pub fn at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> f64 {
        match self {
            Regression::Polynomial { coefficients } => {
                // Limited to the conditions' range by `scaled`.
                let v = airspeeds.scaled(airspeed_kt);
                coefficients
                    .iter()
                    .rev()
                    .fold(0.0, |sum, coefficient| sum * v + coefficient)
            }
            Regression::Table {
                airspeeds_kt,
                values,
            } => {
                let Bracket {
                    before,
                    after,
                    fraction,
                } = Bracket::new(airspeeds_kt, airspeed_kt);
                values[before] + fraction * (values[after] - values[before])
            }
        }
    }
}

/// Returns the design matrix: a row for each condition, with powers of `v` for a polynomial, up to
/// the degree that the clusters allow, and cluster indicators for a table.
pub(super) fn design(airspeeds: &Airspeeds, kind: ScheduleKind) -> Vec<Vec<f64>> {
    match kind {
        ScheduleKind::Polynomial { degree } => {
            let degree = airspeeds.attainable_degree(degree);
            airspeeds
                .values_kt
                .iter()
                .map(|&kt| powers(airspeeds.scaled(kt), degree))
                .collect()
        }
        ScheduleKind::Table => airspeeds.indicators(),
    }
}

/// Returns `1, v, ... v^degree`.
pub(super) fn powers(v: f64, degree: usize) -> Vec<f64> {
    (0..=degree).map(|power| v.powi(power as i32)).collect()
}

/// Neighbouring points in an ascending list; beyond its ends both are the end point.
struct Bracket {
    /// Lower neighbour's index.
    before: usize,
    /// Upper neighbour's index.
    after: usize,
    /// Position between the neighbours, 0 to 1.
    fraction: f64,
}

impl Bracket {
    /// Finds the neighbours of `x` in the ascending `places`.
    fn new(places: &[f64], x: f64) -> Self {
        let after = places.partition_point(|&place| place < x);
        let last = places.len() - 1;
        if after == 0 || after > last {
            let end = after.min(last);
            return Self {
                before: end,
                after: end,
                fraction: 0.0,
            };
        }
        let before = after - 1;
        Self {
            before,
            after,
            fraction: (x - places[before]) / (places[after] - places[before]),
        }
    }
}

/// Returns the weights that the ascending `places` have in the linear interpolation at `x`.
pub(super) fn interpolation_weights(places: &[f64], x: f64) -> Vec<f64> {
    let mut weights = vec![0.0; places.len()];
    let Bracket {
        before,
        after,
        fraction,
    } = Bracket::new(places, x);
    // At an end both are the same point, which the second assignment gives the weight 1.
    weights[after] = fraction;
    weights[before] = 1.0 - fraction;
    weights
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn airspeeds() -> Airspeeds {
        Airspeeds::new(vec![45.0, 60.0, 60.0, 90.0, 140.0], 2.0).unwrap()
    }

    fn parabola(airspeed_kt: f64) -> f64 {
        1.0 + 0.02 * airspeed_kt - 1e-4 * airspeed_kt * airspeed_kt
    }

    #[test]
    fn a_parabola_is_found_exactly() {
        let airspeeds = airspeeds();
        let values: Vec<f64> = airspeeds
            .values_kt
            .iter()
            .map(|&airspeed_kt| parabola(airspeed_kt))
            .collect();
        let regression = Regression::polynomial(&airspeeds, &values, 2);
        // Least squares with a condition number of about 5.
        assert!((regression.at(&airspeeds, 120.0) - parabola(120.0)).abs() < 1e-13);
        assert!(
            (regression.at(&airspeeds, 200.0) - parabola(140.0)).abs() < 1e-13,
            "the end value applies"
        );
        assert!(
            (regression.at(&airspeeds, 0.0) - parabola(45.0)).abs() < 1e-13,
            "the end value applies"
        );
    }

    #[test]
    fn a_single_airspeed_leaves_the_mean() {
        let airspeeds = Airspeeds::new(vec![80.0, 80.0], 2.0).unwrap();
        let regression = Regression::polynomial(&airspeeds, &[1.0, 3.0], 2);
        assert!((regression.at(&airspeeds, 100.0) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn the_degree_is_less_than_the_cluster_count() {
        let airspeeds = Airspeeds::new(vec![60.0, 90.1, 63.9, 62.0, 90.0], 2.0).unwrap();
        let line = Regression::polynomial(&airspeeds, &[1.0; 5], 3);
        assert_eq!(
            line.parameters().len(),
            2,
            "two clusters allow a straight line"
        );
    }

    #[test]
    fn a_table_is_linear_between_cluster_means() {
        let airspeeds = airspeeds();
        let regression = Regression::table(&airspeeds, &[1.0, 2.0, 4.0, 6.0, 5.0]);
        for (airspeed, expected) in [
            (30.0, 1.0),
            (45.0, 1.0),
            (52.5, 2.0),
            (60.0, 3.0),
            (115.0, 5.5),
            (150.0, 5.0),
        ] {
            assert_eq!(
                regression.at(&airspeeds, airspeed),
                expected,
                "{airspeed} kt"
            );
        }
    }

    #[test]
    fn a_place_between_two_has_a_share_of_both() {
        assert_eq!(
            interpolation_weights(&[40.0, 60.0, 100.0], 70.0),
            [0.0, 0.75, 0.25]
        );
        assert_eq!(
            interpolation_weights(&[40.0, 60.0, 100.0], 60.0),
            [0.0, 1.0, 0.0]
        );
        assert_eq!(
            interpolation_weights(&[40.0, 60.0, 100.0], 30.0),
            [1.0, 0.0, 0.0]
        );
        assert_eq!(
            interpolation_weights(&[40.0, 60.0, 100.0], 101.0),
            [0.0, 0.0, 1.0]
        );
    }

    proptest! {
        #[test]
        fn the_residual_of_least_squares_is_orthogonal_to_every_power(
            values in prop::collection::vec(-1.0_f64..1.0, 5), degree in 0_usize..=3,
        ) {
            let airspeeds = airspeeds();
            let regression = Regression::polynomial(&airspeeds, &values, degree);
            for power in 0..=degree {
                let product: f64 = airspeeds.values_kt.iter().zip(&values)
                    .map(|(&kt, value)| (value - regression.at(&airspeeds, kt)) * airspeeds.scaled(kt).powi(power as i32))
                    .sum();
                prop_assert!(product.abs() < 1e-12);
            }
        }
    }
}
