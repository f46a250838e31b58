//! The columns that a schedule is a sum of, as rows of numbers: what its uncertainty takes from it (M13.5, M13.6).

use super::regression::Airspeeds;
use super::schedule::{Schedule, ScheduleKind};

impl Schedule {
    /// The design matrix `X` of its regression: a row for each of its conditions, in their order. A table's columns are
    /// indicators of its clusters.
    pub fn design(&self) -> Vec<Vec<f64>> {
        let mut rows = self.airspeed_design();
        if let Some(term) = &self.second {
            rows.iter_mut().zip(&term.scaled).for_each(|(row, scaled)| row.push(*scaled));
        }
        rows
    }

    /// The columns of that which are functions of airspeed.
    pub fn airspeed_design(&self) -> Vec<Vec<f64>> {
        design(&self.airspeeds, self.settings.kind)
    }

    /// The row of an airspeed \[kt\] that need not be a condition's; outside the conditions' range that of the nearer end. A second
    /// variable is in the middle of its range.
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

/// The columns of a form of the schedule, a row for each condition.
pub(super) fn design(airspeeds: &Airspeeds, kind: ScheduleKind) -> Vec<Vec<f64>> {
    match kind {
        ScheduleKind::Polynomial { degree } => {
            let degree = degree.min(airspeeds.clusters.len().saturating_sub(1));
            airspeeds.values_kt.iter().map(|&kt| powers(airspeeds.scaled(kt), degree)).collect()
        }
        ScheduleKind::Table => indicators(airspeeds),
    }
}

fn powers(v: f64, degree: usize) -> Vec<f64> {
    (0..=degree).map(|power| v.powi(power as i32)).collect()
}

/// One column for each cluster of airspeeds: 1 in the rows of its conditions, else 0.
fn indicators(airspeeds: &Airspeeds) -> Vec<Vec<f64>> {
    let is_in = |place: usize, cluster: &Vec<usize>| if cluster.contains(&place) { 1.0 } else { 0.0 };
    let row = |place| airspeeds.clusters.iter().map(|cluster| is_in(place, cluster)).collect();
    (0..airspeeds.values_kt.len()).map(row).collect()
}

/// The share of each of these rising places in the linear interpolation at `x`.
fn between(places: &[f64], x: f64) -> Vec<f64> {
    let mut row = vec![0.0; places.len()];
    let after = places.partition_point(|&place| place < x);
    if after == 0 {
        row[0] = 1.0;
    } else if after == places.len() {
        row[after - 1] = 1.0;
    } else {
        let fraction = (x - places[after - 1]) / (places[after] - places[after - 1]);
        row[after - 1] = 1.0 - fraction;
        row[after] = fraction;
    }
    row
}

/// Conditions (by place) whose airspeeds \[kt\] lie within `tolerance_kt` of the next one: a row of indicators for each condition.
pub fn airspeed_indicators(airspeeds_kt: Vec<f64>, tolerance_kt: f64) -> Vec<Vec<f64>> {
    Airspeeds::new(airspeeds_kt, tolerance_kt).map(|airspeeds| indicators(&airspeeds)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
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
