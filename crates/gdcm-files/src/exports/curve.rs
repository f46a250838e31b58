//! A gain or a delay over airspeed.

use super::airspeed::CutAirspeed;
use super::lookup_table::LookupTable;

/// A gain, or a delay \[s\], over airspeed.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// A polynomial in the scaled airspeed.
    Polynomial {
        /// Whether it is the natural logarithm of the value.
        of_logarithm: bool,
        /// Coefficients, lowest power first.
        coefficients: Vec<f64>,
    },
    /// A table over airspeed.
    Table {
        /// Whether it holds the natural logarithm of the value: that is then what is linear between its airspeeds.
        of_logarithm: bool,
        /// The table.
        table: LookupTable,
    },
    /// Another curve with what a second variable adds to it.
    Beside {
        /// The curve, of the logarithm of the value where `of_logarithm` says so.
        curve: Box<Curve>,
        /// Whether the sum is the natural logarithm of the value.
        of_logarithm: bool,
        /// What the scaled second variable is multiplied by.
        slope: f64,
    },
    /// The same at every airspeed.
    Constant(f64),
    /// Another curve, cut to its bounds.
    Cut {
        /// The curve.
        curve: Box<Curve>,
        /// The value is not below this.
        least: f64,
        /// The value is not above this.
        most: LookupTable,
    },
}

impl Curve {
    /// The value at an airspeed: what every exported program computes.
    pub fn at(&self, airspeed: CutAirspeed) -> f64 {
        let value = |of_logarithm: bool, figure: f64| if of_logarithm { figure.exp() } else { figure };
        match self {
            Curve::Polynomial { of_logarithm, coefficients } => {
                let sum = coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * airspeed.scaled + coefficient);
                value(*of_logarithm, sum)
            }
            Curve::Table { of_logarithm, table } => value(*of_logarithm, table.at(airspeed.kt)),
            Curve::Beside { curve, of_logarithm, slope } => {
                value(*of_logarithm, curve.at(airspeed) + slope * airspeed.second_scaled)
            }
            Curve::Constant(value) => *value,
            Curve::Cut { curve, least, most } => curve.at(airspeed).min(most.at(airspeed.kt)).max(*least),
        }
    }

    /// What is wrong with the numbers of the curve.
    pub(super) fn flaw(&self) -> Option<&'static str> {
        const NOT_FINITE: &str = "a number that is not finite";
        match self {
            Curve::Polynomial { coefficients, .. } if coefficients.is_empty() => {
                Some("a polynomial without coefficients")
            }
            Curve::Polynomial { coefficients, .. } => {
                (!coefficients.iter().all(|coefficient| coefficient.is_finite())).then_some(NOT_FINITE)
            }
            Curve::Table { table, .. } => table.flaw(),
            Curve::Beside { slope, .. } if !slope.is_finite() => Some(NOT_FINITE),
            Curve::Beside { curve, .. } => curve.flaw(),
            Curve::Constant(value) => (!value.is_finite()).then_some(NOT_FINITE),
            Curve::Cut { least, .. } if !least.is_finite() => Some(NOT_FINITE),
            Curve::Cut { curve, least, most } => {
                let crossed =
                    || most.values.iter().any(|most| most < least).then_some("a least value above the greatest");
                curve.flaw().or_else(|| most.flaw()).or_else(crossed)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(curve: &Curve, kt: f64) -> f64 {
        curve.at(CutAirspeed { kt, scaled: (kt - 50.0) / 50.0, second_scaled: 0.0 })
    }

    fn polynomial(of_logarithm: bool) -> Curve {
        Curve::Polynomial { of_logarithm, coefficients: vec![1.0, 2.0, 3.0] }
    }

    #[test]
    fn a_polynomial_may_be_of_the_logarithm() {
        assert_eq!(at(&polynomial(false), 100.0), 6.0);
        assert_eq!(at(&polynomial(false), 0.0), 2.0);
        assert_eq!(at(&polynomial(true), 50.0), std::f64::consts::E);
    }

    #[test]
    fn a_table_may_be_of_the_logarithm() {
        let table = LookupTable { airspeed_kt: vec![0.0, 10.0], values: vec![0.0, 4_f64.ln()] };
        let curve = Curve::Table { of_logarithm: true, table };
        assert!((at(&curve, 5.0) - 2.0).abs() < 1e-15, "half way in the logarithm");
    }

    #[test]
    fn a_curve_is_cut_to_its_bounds() {
        let cut = |least: f64, most: [f64; 2]| Curve::Cut {
            curve: Box::new(polynomial(false)),
            least,
            most: LookupTable { airspeed_kt: vec![0.0, 100.0], values: most.to_vec() },
        };
        assert_eq!(at(&cut(0.0, [1.0, 5.0]), 100.0), 5.0);
        assert_eq!(at(&cut(0.0, [1.0, 5.0]), 0.0), 1.0);
        assert_eq!(at(&cut(3.0, [9.0, 9.0]), 50.0), 3.0);
        assert_eq!(cut(3.0, [9.0, 2.0]).flaw(), Some("a least value above the greatest"));
        assert_eq!(cut(f64::NAN, [9.0, 2.0]).flaw(), Some("a number that is not finite"));
    }
}
