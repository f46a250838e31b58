//! A curve as an expression of a language in which lists stand in square brackets.

use super::curve::Curve;
use super::lookup_table::LookupTable;
use super::number::{list, number};

/// What a language calls the functions of an expression.
pub(super) struct Functions {
    pub(super) exp: &'static str,
    /// Of coefficients and the scaled airspeed `v`.
    pub(super) polynomial: &'static str,
    /// Of airspeeds, values and the airspeed `a`.
    pub(super) table: &'static str,
}

impl Functions {
    /// The value of a curve at the airspeed `a`, the scaled airspeed `v` and the scaled second variable `z`.
    pub(super) fn expression(&self, curve: &Curve) -> String {
        let value = |of_logarithm: bool, figure: String| {
            if of_logarithm { format!("{}({figure})", self.exp) } else { figure }
        };
        match curve {
            Curve::Polynomial { of_logarithm, coefficients } => {
                value(*of_logarithm, format!("{}([{}], v)", self.polynomial, list(coefficients)))
            }
            Curve::Table { of_logarithm, table } => value(*of_logarithm, self.table(table)),
            Curve::Beside { curve, of_logarithm, slope } => {
                value(*of_logarithm, format!("{} + ({}) * z", self.expression(curve), number(*slope)))
            }
            Curve::Constant(value) => number(*value),
            Curve::Cut { curve, least, most } => {
                format!("max(min({}, {}), {})", self.expression(curve), self.table(most), number(*least))
            }
        }
    }

    fn table(&self, table: &LookupTable) -> String {
        format!("{}([{}], [{}], a)", self.table, list(&table.airspeed_kt), list(&table.values))
    }
}
