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
    /// Conditions (by place) whose airspeeds lie within the tolerance of the next one, rising in airspeed (M11b).
    pub clusters: Vec<Vec<usize>>,
}

impl Airspeeds {
    /// The airspeeds \[kt\] of at least one condition, those within `tolerance_kt` of the next one taken together.
    pub fn new(values_kt: Vec<f64>, tolerance_kt: f64) -> Option<Self> {
        let mut rising: Vec<usize> = (0..values_kt.len()).collect();
        rising.sort_by(|&a, &b| values_kt[a].total_cmp(&values_kt[b]));
        let (min_kt, max_kt) = (values_kt[*rising.first()?], values_kt[*rising.last()?]);
        let near = |a: &usize, b: &usize| values_kt[*b] - values_kt[*a] <= tolerance_kt;
        let mut clusters: Vec<Vec<usize>> = rising.chunk_by(near).map(<[usize]>::to_vec).collect();
        clusters.iter_mut().for_each(|cluster| cluster.sort_unstable());
        let mean_kt = values_kt.iter().sum::<f64>() / values_kt.len() as f64;
        Some(Self { values_kt, mean_kt, half_range_kt: 0.5 * (max_kt - min_kt), min_kt, max_kt, clusters })
    }

    /// The scaled airspeed `v`; outside the conditions' range, that of the nearer end. Zero where there is no range.
    pub fn scaled(&self, airspeed_kt: f64) -> f64 {
        if self.half_range_kt == 0.0 {
            return 0.0;
        }
        (airspeed_kt.clamp(self.min_kt, self.max_kt) - self.mean_kt) / self.half_range_kt
    }

    /// The mean airspeed of each cluster \[kt\], rising.
    pub fn clusters_kt(&self) -> Vec<f64> {
        self.cluster_means(&self.values_kt)
    }

    /// The mean of the conditions' figures in each cluster.
    fn cluster_means(&self, figures: &[f64]) -> Vec<f64> {
        let mean = |cluster: &Vec<usize>| {
            let first = figures[cluster[0]];
            let same = cluster.iter().all(|&place| figures[place] == first);
            // A sum would round it.
            if same { first } else { cluster.iter().map(|&place| figures[place]).sum::<f64>() / cluster.len() as f64 }
        };
        self.clusters.iter().map(mean).collect()
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
    /// Linear between the means of each cluster of airspeeds, constant outside.
    Table {
        /// Mean airspeed of each cluster \[kt\], rising.
        airspeeds_kt: Vec<f64>,
        /// Mean figure of each.
        values: Vec<f64>,
    },
}

impl Regression {
    /// The polynomial of least squares; its degree is at most the number of clusters less one.
    pub fn polynomial(airspeeds: &Airspeeds, figures: &[f64], degree: usize) -> Self {
        let degree = degree.min(airspeeds.clusters.len().saturating_sub(1));
        let v: Vec<f64> = airspeeds.values_kt.iter().map(|&airspeed| airspeeds.scaled(airspeed)).collect();
        let design = DMatrix::from_fn(v.len(), degree + 1, |row, power| v[row].powi(power as i32));
        let qr = design.qr();
        // Full column rank: at least as many distinct v in [-1, 1] as there are columns, so R has no zero on its diagonal.
        let projected = qr.q().transpose() * DVector::from_column_slice(figures);
        let coefficients = qr.r().solve_upper_triangular(&projected).unwrap_or(projected);
        Self::Polynomial { coefficients: coefficients.iter().copied().collect() }
    }

    /// The mean figure of each cluster of airspeeds.
    pub fn table(airspeeds: &Airspeeds, figures: &[f64]) -> Self {
        Self::Table { airspeeds_kt: airspeeds.clusters_kt(), values: airspeeds.cluster_means(figures) }
    }

    /// Its coefficients, lowest power first, or the figures of its table.
    pub fn figures(&self) -> &[f64] {
        match self {
            Regression::Polynomial { coefficients } => coefficients,
            Regression::Table { values, .. } => values,
        }
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
        Airspeeds::new(vec![45.0, 60.0, 60.0, 90.0, 140.0], 2.0).unwrap()
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
        let airspeeds = Airspeeds::new(vec![80.0, 80.0], 2.0).unwrap();
        let regression = Regression::polynomial(&airspeeds, &[1.0, 3.0], 2);
        assert!((regression.at(&airspeeds, 100.0) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn airspeeds_within_the_tolerance_of_the_next_are_one_cluster() {
        let airspeeds = Airspeeds::new(vec![60.0, 90.1, 63.9, 62.0, 90.0], 2.0).unwrap();
        assert_eq!(airspeeds.clusters, [vec![0, 2, 3], vec![1, 4]], "62 is within 2 kt of 60, and 63.9 of 62");
        assert_eq!(airspeeds.clusters_kt(), [(60.0 + 63.9 + 62.0) / 3.0, (90.1 + 90.0) / 2.0]);
        let Regression::Polynomial { coefficients } = Regression::polynomial(&airspeeds, &[1.0; 5], 3) else {
            panic!("a polynomial was asked for");
        };
        assert_eq!(coefficients.len(), 2, "two clusters bear a straight line");
        assert_eq!(Airspeeds::new(vec![60.0, 60.0 + 1e-9], 0.0).unwrap().clusters.len(), 2);
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
