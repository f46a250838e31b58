//! Values at some airspeeds, linear between them.

/// Values at some airspeeds, linear between them, the end values outside.
#[derive(Clone, Debug, PartialEq)]
pub struct LookupTable {
    /// Airspeeds \[kt\], strictly increasing.
    pub airspeed_kt: Vec<f64>,
    /// The values.
    pub values: Vec<f64>,
}

impl LookupTable {
    /// The value at an airspeed \[kt\].
    pub fn at(&self, airspeed_kt: f64) -> f64 {
        let (points, values) = (&self.airspeed_kt, &self.values);
        let above = points.partition_point(|&point| point <= airspeed_kt);
        match (above.checked_sub(1), points.get(above)) {
            (None, _) => values.first().copied().unwrap_or(f64::NAN),
            (Some(below), None) => values[below],
            (Some(below), Some(&end)) => {
                let part = (airspeed_kt - points[below]) / (end - points[below]);
                values[below] + part * (values[above] - values[below])
            }
        }
    }

    /// What is wrong with its numbers.
    pub(super) fn flaw(&self) -> Option<&'static str> {
        let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        if self.airspeed_kt.is_empty() || self.airspeed_kt.len() != self.values.len() {
            Some("a table without values, or with another number of values than of airspeeds")
        } else if !finite(&self.airspeed_kt) || !finite(&self.values) {
            Some("a number that is not finite")
        } else if self.airspeed_kt.windows(2).any(|pair| pair[0] >= pair[1]) {
            Some("airspeeds that do not increase")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_linear_between_its_points_and_constant_outside() {
        let table = LookupTable { airspeed_kt: vec![0.0, 10.0, 30.0], values: vec![1.0, 2.0, 0.0] };
        let values = [-5.0, 0.0, 5.0, 10.0, 20.0, 30.0, 40.0].map(|kt| table.at(kt));
        assert_eq!(values, [1.0, 1.0, 1.5, 2.0, 1.0, 0.0, 0.0]);
        let twice = LookupTable { airspeed_kt: vec![1.0, 1.0], values: vec![1.0, 2.0] };
        assert_eq!(twice.flaw(), Some("airspeeds that do not increase"));
    }
}
