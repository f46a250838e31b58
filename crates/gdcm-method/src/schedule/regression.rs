//! Regression of a channel's value on airspeed: its columns, and its coefficients for each channel.

use nalgebra::{DMatrix, DVector};

use super::{LeadSchedule, Schedule, ScheduleKind, ScheduledQuantity};
use crate::correction::Channel;

/// The airspeeds of the scheduled conditions, centred and scaled: `v = (V - mean V) / (half the
/// range of V)` (M11).
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
    /// Conditions (by index) whose airspeeds lie within the tolerance of the next one, rising in
    /// airspeed (M11b).
    pub clusters: Vec<Vec<usize>>,
}

impl Airspeeds {
    /// Groups the airspeeds \[kt\] of at least one condition into clusters, each within
    /// `tolerance_kt` of the next; `None` without conditions.
    pub fn new(values_kt: Vec<f64>, tolerance_kt: f64) -> Option<Self> {
        let mut rising: Vec<usize> = (0..values_kt.len()).collect();
        rising.sort_by(|&a, &b| values_kt[a].total_cmp(&values_kt[b]));
        let min_kt = values_kt[*rising.first()?];
        let max_kt = values_kt[*rising.last()?];
        let near = |a: &usize, b: &usize| values_kt[*b] - values_kt[*a] <= tolerance_kt;
        let mut clusters: Vec<Vec<usize>> = rising.chunk_by(near).map(<[usize]>::to_vec).collect();
        clusters
            .iter_mut()
            .for_each(|cluster| cluster.sort_unstable());
        let mean_kt = values_kt.iter().sum::<f64>() / values_kt.len() as f64;
        Some(Self {
            values_kt,
            mean_kt,
            half_range_kt: 0.5 * (max_kt - min_kt),
            min_kt,
            max_kt,
            clusters,
        })
    }

    /// The scaled airspeed `v`, limited to the conditions' range; zero where there is no range.
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

    /// Mean of the conditions' values in each cluster.
    fn cluster_means(&self, figures: &[f64]) -> Vec<f64> {
        let mean = |cluster: &Vec<usize>| {
            let first = figures[cluster[0]];
            let same = cluster.iter().all(|&place| figures[place] == first);
            // A sum would round it.
            if same {
                first
            } else {
                cluster.iter().map(|&place| figures[place]).sum::<f64>() / cluster.len() as f64
            }
        };
        self.clusters.iter().map(mean).collect()
    }
}

/// A function of airspeed fitted to one value of each condition.
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
        /// Mean value of each cluster.
        values: Vec<f64>,
    },
}

impl Regression {
    /// Fits a polynomial by least squares; its degree is at most the number of clusters less one.
    pub fn polynomial(airspeeds: &Airspeeds, figures: &[f64], degree: usize) -> Self {
        let degree = degree.min(airspeeds.clusters.len().saturating_sub(1));
        let rows = design(airspeeds, ScheduleKind::Polynomial { degree });
        let qr = DMatrix::from_fn(rows.len(), degree + 1, |row, power| rows[row][power]).qr();
        // Full column rank: at least as many distinct v in [-1, 1] as there are columns, so R has
        // no zero on its diagonal.
        let projected = qr.q().transpose() * DVector::from_column_slice(figures);
        let coefficients = qr
            .r()
            .solve_upper_triangular(&projected)
            .unwrap_or(projected);
        Self::Polynomial {
            coefficients: coefficients.iter().copied().collect(),
        }
    }

    /// Computes the mean value of each cluster of airspeeds.
    pub fn table(airspeeds: &Airspeeds, figures: &[f64]) -> Self {
        Self::Table {
            airspeeds_kt: airspeeds.clusters_kt(),
            values: airspeeds.cluster_means(figures),
        }
    }

    /// The coefficients, lowest power first, or the values of the table.
    pub fn figures(&self) -> &[f64] {
        match self {
            Regression::Polynomial { coefficients } => coefficients,
            Regression::Table { values, .. } => values,
        }
    }

    /// Value at an airspeed \[kt\]; outside the conditions' range the end value applies.
    pub fn at(&self, airspeeds: &Airspeeds, airspeed_kt: f64) -> f64 {
        match self {
            Regression::Polynomial { coefficients } => {
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
                let (before, after, fraction) = bracket(airspeeds_kt, airspeed_kt);
                values[before] + fraction * (values[after] - values[before])
            }
        }
    }
}

impl Schedule {
    /// Design matrix `X` of the regression: a row for each condition, in their order. A table's
    /// columns are indicators of its clusters.
    pub fn design(&self) -> Vec<Vec<f64>> {
        let mut rows = self.airspeed_design();
        if let Some(term) = &self.second {
            rows.iter_mut()
                .zip(&term.scaled)
                .for_each(|(row, scaled)| row.push(*scaled));
        }
        rows
    }

    /// The columns of the design matrix that are functions of airspeed.
    pub fn airspeed_design(&self) -> Vec<Vec<f64>> {
        design(&self.airspeeds, self.settings.kind)
    }

    /// Row of the design matrix for any airspeed \[kt\]; outside the conditions' range the row of
    /// the nearer end. A second variable is in the middle of its range.
    pub fn design_row(&self, airspeed_kt: f64) -> Vec<f64> {
        let mut row = match self.degree() {
            Some(degree) => powers(self.airspeeds.scaled(airspeed_kt), degree),
            None => between(&self.airspeeds.clusters_kt(), airspeed_kt),
        };
        if self.second.is_some() {
            row.push(0.0);
        }
        row
    }
}

/// The columns for a form of the schedule, a row for each condition.
pub(super) fn design(airspeeds: &Airspeeds, kind: ScheduleKind) -> Vec<Vec<f64>> {
    match kind {
        ScheduleKind::Polynomial { degree } => {
            let degree = degree.min(airspeeds.clusters.len().saturating_sub(1));
            airspeeds
                .values_kt
                .iter()
                .map(|&kt| powers(airspeeds.scaled(kt), degree))
                .collect()
        }
        ScheduleKind::Table => indicators(airspeeds),
    }
}

fn powers(v: f64, degree: usize) -> Vec<f64> {
    (0..=degree).map(|power| v.powi(power as i32)).collect()
}

/// One column for each cluster of airspeeds: 1 in the rows of its conditions, else 0.
fn indicators(airspeeds: &Airspeeds) -> Vec<Vec<f64>> {
    let is_in =
        |place: usize, cluster: &Vec<usize>| if cluster.contains(&place) { 1.0 } else { 0.0 };
    let row = |place| {
        airspeeds
            .clusters
            .iter()
            .map(|cluster| is_in(place, cluster))
            .collect()
    };
    (0..airspeeds.values_kt.len()).map(row).collect()
}

/// Indices of the rising places on either side of `x` and the fraction of the way between them; the
/// end index and 0 beyond the ends.
fn bracket(places: &[f64], x: f64) -> (usize, usize, f64) {
    let after = places.partition_point(|&place| place < x);
    let end = places.len() - 1;
    if after == 0 || after > end {
        return (after.min(end), after.min(end), 0.0);
    }
    (
        after - 1,
        after,
        (x - places[after - 1]) / (places[after] - places[after - 1]),
    )
}

/// Weight of each of these rising places in the linear interpolation at `x`.
fn between(places: &[f64], x: f64) -> Vec<f64> {
    let mut row = vec![0.0; places.len()];
    let (before, after, fraction) = bracket(places, x);
    row[after] = fraction;
    row[before] = 1.0 - fraction;
    row
}

/// Clusters of conditions whose airspeeds \[kt\] lie within `tolerance_kt` of the next one: a row
/// of indicators for each condition.
pub fn airspeed_indicators(airspeeds_kt: Vec<f64>, tolerance_kt: f64) -> Vec<Vec<f64>> {
    Airspeeds::new(airspeeds_kt, tolerance_kt)
        .map(|airspeeds| indicators(&airspeeds))
        .unwrap_or_default()
}

/// The coefficients or values of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientRow {
    pub channel: Channel,
    /// Name of the scheduled value with its channel: "ln k_LON", "k_Q", "τ_PED \[s\]".
    pub name: String,
    /// One value for each column of the table.
    pub figures: Vec<f64>,
}

/// The coefficients of a polynomial schedule in the scaled airspeed, or the values of a table
/// (M11).
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientTable {
    /// Factor of each coefficient ("1", "v", "v²", "v³"), or airspeed of each value ("60.0 kt").
    pub columns: Vec<String>,
    /// Inputs, then outputs; gains, then delays where they are scheduled.
    pub rows: Vec<CoefficientRow>,
    /// Definition of `v`: "v = (V − 92.3 kt) / 47.5 kt"; empty for a table.
    pub scale: String,
}

impl Schedule {
    /// Tabulates the coefficients or values of the schedule with these channel names.
    pub fn coefficients(&self, inputs: &[String], outputs: &[String]) -> CoefficientTable {
        const POWERS: [&str; 4] = ["1", "v", "v²", "v³"];
        let (columns, scale): (Vec<String>, String) = match self.degree() {
            Some(degree) => {
                let degree = degree.max(self.leads.as_ref().map_or(0, LeadSchedule::degree));
                let columns = POWERS[..=degree]
                    .iter()
                    .map(|&power| power.to_owned())
                    .collect();
                let mean_kt = self.airspeeds.mean_kt;
                let half_kt = self.airspeeds.half_range_kt;
                (
                    columns,
                    format!("v = (V − {mean_kt:.2} kt) / {half_kt:.2} kt"),
                )
            }
            None => {
                let airspeeds_kt = self.airspeeds.clusters_kt();
                (
                    airspeeds_kt
                        .into_iter()
                        .map(|airspeed_kt| format!("{airspeed_kt:.1} kt"))
                        .collect(),
                    String::new(),
                )
            }
        };
        let symbol = match self.settings.quantity {
            ScheduledQuantity::LnGain => "ln k",
            ScheduledQuantity::Gain => "k",
        };
        let count = columns.len();
        let row = |(channel, regression): (Channel, &Regression), symbol: &str, unit: &str| {
            CoefficientRow {
                channel,
                name: format!("{symbol}_{}{unit}", channel.name(inputs, outputs)),
                figures: match (self.degree(), regression) {
                    // Signed delays are a polynomial besides a table of gains.
                    (None, Regression::Polynomial { .. }) => self
                        .airspeeds
                        .clusters_kt()
                        .iter()
                        .map(|&kt| regression.at(&self.airspeeds, kt))
                        .collect(),
                    // A missing power has the coefficient 0.
                    _ => {
                        let none = std::iter::repeat(0.0);
                        let figures = regression.figures().iter().copied().chain(none);
                        figures.take(count).collect()
                    }
                },
            }
        };
        let gains = self.gains.iter().map(|of| row(of, symbol, ""));
        let delays = self.delays.iter().flat_map(|delays| delays.taus_s.iter());
        let leads = self.leads.iter().flat_map(|leads| leads.taus_s.iter());
        let delays = delays.chain(leads).map(|of| row(of, "τ", " [s]"));
        let rows = gains.chain(delays).collect();
        CoefficientTable {
            columns,
            rows,
            scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn airspeeds() -> Airspeeds {
        Airspeeds::new(vec![45.0, 60.0, 60.0, 90.0, 140.0], 2.0).unwrap()
    }

    #[test]
    fn a_parabola_is_found_exactly() {
        let airspeeds = airspeeds();
        let figure = |airspeed: f64| 1.0 + 0.02 * airspeed - 1e-4 * airspeed * airspeed;
        let figures: Vec<f64> = airspeeds
            .values_kt
            .iter()
            .map(|&airspeed| figure(airspeed))
            .collect();
        let regression = Regression::polynomial(&airspeeds, &figures, 2);
        // Least squares with a condition number of about 5.
        assert!((regression.at(&airspeeds, 120.0) - figure(120.0)).abs() < 1e-13);
        assert!(
            (regression.at(&airspeeds, 200.0) - figure(140.0)).abs() < 1e-13,
            "the end value holds"
        );
        assert!(
            (regression.at(&airspeeds, 0.0) - figure(45.0)).abs() < 1e-13,
            "the end value holds"
        );
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
        assert_eq!(
            airspeeds.clusters,
            [vec![0, 2, 3], vec![1, 4]],
            "62 is within 2 kt of 60, and 63.9 of 62"
        );
        assert_eq!(
            airspeeds.clusters_kt(),
            [(60.0 + 63.9 + 62.0) / 3.0, (90.1 + 90.0) / 2.0]
        );
        let Regression::Polynomial { coefficients } =
            Regression::polynomial(&airspeeds, &[1.0; 5], 3)
        else {
            panic!("a polynomial was asked for");
        };
        assert_eq!(coefficients.len(), 2, "two clusters bear a straight line");
        assert_eq!(
            Airspeeds::new(vec![60.0, 60.0 + 1e-9], 0.0)
                .unwrap()
                .clusters
                .len(),
            2
        );
    }

    #[test]
    fn a_table_takes_means_and_is_linear_between_them() {
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

#[cfg(test)]
mod basis_tests {
    use super::*;

    #[test]
    fn a_place_between_two_has_a_share_of_both() {
        assert_eq!(between(&[40.0, 60.0, 100.0], 70.0), [0.0, 0.75, 0.25]);
        assert_eq!(between(&[40.0, 60.0, 100.0], 60.0), [0.0, 1.0, 0.0]);
        assert_eq!(between(&[40.0, 60.0, 100.0], 30.0), [1.0, 0.0, 0.0]);
        assert_eq!(between(&[40.0, 60.0, 100.0], 101.0), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn conditions_of_one_airspeed_share_a_column() {
        let rows = airspeed_indicators(vec![60.0, 45.0, 60.5], 1.0);
        assert_eq!(rows, [[0.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    }
}

#[cfg(test)]
mod coefficients_tests {
    use super::super::tests::points;
    use super::*;
    use crate::correction::ChannelCorrection;
    use crate::schedule::{ScheduleKind, ScheduleSettings};

    #[test]
    fn every_channel_has_a_row_of_named_coefficients() {
        let corrections = [1.0, 1.1, 1.3].map(|gain| ChannelCorrection {
            input_gains: vec![gain],
            output_gains: vec![1.0],
            input_delays_s: vec![0.02],
            output_delays_s: vec![0.0],
            leads: None,
        });
        let points = points(&[60.0, 90.0, 120.0], &corrections, 0.1);
        let names = (["LON".to_owned()], ["Q".to_owned()]);
        let of = |settings| {
            Schedule::of(&points, settings)
                .unwrap()
                .coefficients(&names.0, &names.1)
        };
        let table = of(ScheduleSettings {
            delays: true,
            ..ScheduleSettings::default()
        });
        let rows: Vec<&str> = table.rows.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(rows, ["ln k_LON", "ln k_Q", "τ_LON [s]", "τ_Q [s]"]);
        assert_eq!(
            (table.columns.join(" ").as_str(), table.scale.as_str()),
            ("1 v v²", "v = (V − 90.00 kt) / 30.00 kt")
        );
        // The parabola goes through its three points: at v = 0 it is the middle one.
        assert!((table.rows[0].figures[0] - 1.1_f64.ln()).abs() < 1e-15);
        let table = of(ScheduleSettings {
            kind: ScheduleKind::Table,
            quantity: ScheduledQuantity::Gain,
            ..ScheduleSettings::default()
        });
        assert_eq!(
            (table.columns.join(" ").as_str(), table.scale.as_str()),
            ("60.0 kt 90.0 kt 120.0 kt", "")
        );
        assert_eq!(
            (
                table.rows[0].name.as_str(),
                table.rows[0].figures.as_slice()
            ),
            ("k_LON", &[1.0, 1.1, 1.3][..])
        );
    }
}
