//! Scale and clusters for the scheduled airspeeds (M11, M11b). Conditions in the same cluster count
//! as one airspeed: a table has a value for each cluster, and a polynomial at most as many
//! coefficients.

/// The conditions' airspeeds, centred and scaled: `v = (V - mean V) / (half the range of V)` (M11).
#[derive(Clone, Debug, PartialEq)]
pub struct Airspeeds {
    /// Airspeed by condition \[kt\].
    pub values_kt: Vec<f64>,
    pub mean_kt: f64,
    /// Half the range \[kt\]; zero if all conditions have the same airspeed.
    pub half_range_kt: f64,
    pub min_kt: f64,
    pub max_kt: f64,
    /// Conditions, by index, grouped by airspeed in rising order: the airspeeds in a cluster lie
    /// within the tolerance from neighbour to neighbour (M11b).
    pub clusters: Vec<Vec<usize>>,
}

impl Airspeeds {
    /// Groups airspeeds \[kt\] into clusters, whose neighbours differ by at most `tolerance_kt`;
    /// `None` without conditions.
    pub fn new(values_kt: Vec<f64>, tolerance_kt: f64) -> Option<Self> {
        let mut rising: Vec<usize> = (0..values_kt.len()).collect();
        rising.sort_by(|&a, &b| values_kt[a].total_cmp(&values_kt[b]));
        let min_kt = values_kt[*rising.first()?];
        let max_kt = values_kt[*rising.last()?];
        let mut clusters = Vec::new();
        for cluster in rising.chunk_by(|&a, &b| values_kt[b] - values_kt[a] <= tolerance_kt) {
            let mut cluster = cluster.to_vec();
            cluster.sort_unstable();
            clusters.push(cluster);
        }
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

    /// Returns the scaled airspeed `v`, limited to the conditions' range; zero without a range.
    pub fn scaled(&self, airspeed_kt: f64) -> f64 {
        if self.half_range_kt == 0.0 {
            return 0.0;
        }
        (airspeed_kt.clamp(self.min_kt, self.max_kt) - self.mean_kt) / self.half_range_kt
    }

    /// Returns the mean airspeed by cluster \[kt\], rising.
    pub fn clusters_kt(&self) -> Vec<f64> {
        self.cluster_means(&self.values_kt)
    }

    /// Averages the conditions' values by cluster.
    pub(super) fn cluster_means(&self, values: &[f64]) -> Vec<f64> {
        self.clusters
            .iter()
            .map(|cluster| {
                let first = values[cluster[0]];
                if cluster.iter().all(|&condition| values[condition] == first) {
                    // Equal values are returned as they are: their computed mean would have a
                    // rounding error.
                    return first;
                }
                let sum = cluster
                    .iter()
                    .map(|&condition| values[condition])
                    .sum::<f64>();
                sum / cluster.len() as f64
            })
            .collect()
    }

    /// Returns the degree that the clusters allow, at most `degree`.
    pub(crate) fn attainable_degree(&self, degree: usize) -> usize {
        degree.min(self.clusters.len().saturating_sub(1))
    }

    /// Returns the cluster indicators, a row for each condition and a column for each cluster: 1 if
    /// the condition is in the cluster, otherwise 0.
    pub(super) fn indicators(&self) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; self.clusters.len()]; self.values_kt.len()];
        for (column, cluster) in self.clusters.iter().enumerate() {
            for &condition in cluster {
                rows[condition][column] = 1.0;
            }
        }
        rows
    }
}

/// Clusters airspeeds \[kt\] like [`Airspeeds::new`], and returns the cluster indicators, a row for
/// each condition; empty without conditions.
pub fn airspeed_indicators(airspeeds_kt: Vec<f64>, tolerance_kt: f64) -> Vec<Vec<f64>> {
    match Airspeeds::new(airspeeds_kt, tolerance_kt) {
        Some(airspeeds) => airspeeds.indicators(),
        None => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_airspeeds_form_a_cluster() {
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
        let separate = Airspeeds::new(vec![60.0, 60.0 + 1e-9], 0.0).unwrap();
        assert_eq!(separate.clusters.len(), 2);
    }

    #[test]
    fn conditions_with_the_same_airspeed_share_a_column() {
        let rows = airspeed_indicators(vec![60.0, 45.0, 60.5], 1.0);
        assert_eq!(rows, [[0.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    }
}
