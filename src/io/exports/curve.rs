//! A gain or a delay over airspeed.

use super::airspeed::CutAirspeed;

/// A gain, or a delay \[s\], over airspeed.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// A polynomial in the scaled airspeed.
    Polynomial {
        /// Whether it is the natural logarithm of the value.
        of_logarithm: bool,
        /// Coefficients, lowest power first.
        coefficients: Vec<f64>,
        /// The value is not below this.
        least: Option<f64>,
        /// The value is not above this.
        most: Option<f64>,
    },
    /// Values at airspeeds, linear between them, the end values outside.
    Table {
        /// Airspeeds \[kt\], strictly increasing.
        airspeed_kt: Vec<f64>,
        /// The values.
        values: Vec<f64>,
    },
    /// The same at every airspeed.
    Constant(f64),
}

impl Curve {
    /// The value at an airspeed: what every exported program computes.
    pub fn at(&self, airspeed: CutAirspeed) -> f64 {
        match self {
            Curve::Polynomial { of_logarithm, coefficients, least, most } => {
                let sum = coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * airspeed.scaled + coefficient);
                let value = if *of_logarithm { sum.exp() } else { sum };
                let value = least.map_or(value, |least| value.max(least));
                most.map_or(value, |most| value.min(most))
            }
            Curve::Table { airspeed_kt, values } => interpolated(airspeed_kt, values, airspeed.kt),
            Curve::Constant(value) => *value,
        }
    }

    /// What is wrong with the numbers of the curve.
    pub(super) fn flaw(&self) -> Option<&'static str> {
        let finite = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        match self {
            Curve::Polynomial { coefficients, least, most, .. } => {
                let cuts: Vec<f64> = least.iter().chain(most).copied().collect();
                if coefficients.is_empty() {
                    Some("a polynomial without coefficients")
                } else if !finite(coefficients) || !finite(&cuts) {
                    Some("a number that is not finite")
                } else if cuts.windows(2).any(|pair| pair[0] > pair[1]) {
                    Some("a least value above the greatest")
                } else {
                    None
                }
            }
            Curve::Table { airspeed_kt, values } => {
                if airspeed_kt.is_empty() || airspeed_kt.len() != values.len() {
                    Some("a table without values, or with another number of values than of airspeeds")
                } else if !finite(airspeed_kt) || !finite(values) {
                    Some("a number that is not finite")
                } else if airspeed_kt.windows(2).any(|pair| pair[0] >= pair[1]) {
                    Some("airspeeds that do not increase")
                } else {
                    None
                }
            }
            Curve::Constant(value) => (!value.is_finite()).then_some("a number that is not finite"),
        }
    }
}

/// The value of a table at `x`: linear between its points, the end value outside.
pub(super) fn interpolated(points: &[f64], values: &[f64], x: f64) -> f64 {
    let above = points.partition_point(|&point| point <= x);
    match (above.checked_sub(1), points.get(above)) {
        (None, _) => values.first().copied().unwrap_or(f64::NAN),
        (Some(below), None) => values[below],
        (Some(below), Some(&end)) => {
            let part = (x - points[below]) / (end - points[below]);
            values[below] + part * (values[above] - values[below])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(curve: &Curve, kt: f64) -> f64 {
        curve.at(CutAirspeed { kt, scaled: (kt - 50.0) / 50.0 })
    }

    #[test]
    fn a_polynomial_is_cut_and_may_be_of_the_logarithm() {
        let curve = |of_logarithm, least, most| Curve::Polynomial {
            of_logarithm,
            coefficients: vec![1.0, 2.0, 3.0],
            least,
            most,
        };
        assert_eq!(at(&curve(false, None, None), 100.0), 6.0);
        assert_eq!(at(&curve(false, None, None), 0.0), 2.0);
        assert_eq!(at(&curve(true, None, None), 50.0), std::f64::consts::E);
        assert_eq!(at(&curve(false, Some(3.0), Some(5.0)), 100.0), 5.0);
        assert_eq!(at(&curve(false, Some(3.0), Some(5.0)), 0.0), 3.0);
        assert_eq!(curve(false, Some(3.0), Some(2.0)).flaw(), Some("a least value above the greatest"));
    }

    #[test]
    fn a_table_is_linear_between_its_points_and_constant_outside() {
        let table = Curve::Table { airspeed_kt: vec![0.0, 10.0, 30.0], values: vec![1.0, 2.0, 0.0] };
        let values: Vec<f64> = [-5.0, 0.0, 5.0, 10.0, 20.0, 30.0, 40.0].map(|kt| at(&table, kt)).to_vec();
        assert_eq!(values, [1.0, 1.0, 1.5, 2.0, 1.0, 0.0, 0.0]);
        let twice = Curve::Table { airspeed_kt: vec![1.0, 1.0], values: vec![1.0, 2.0] };
        assert_eq!(twice.flaw(), Some("airspeeds that do not increase"));
    }
}
