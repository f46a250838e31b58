//! A gain or a delay over airspeed: its value, the same as an expression of a programming language, and what stands in programs besides:
//! numbers, names and comments.

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
    WithSecond {
        /// The curve, of the logarithm of the value where `of_logarithm` says so.
        curve: Box<Curve>,
        /// Whether the sum is the natural logarithm of the value.
        of_logarithm: bool,
        /// What the scaled second variable is multiplied by.
        slope: f64,
    },
    /// The same at every airspeed.
    Constant(f64),
    /// Another curve, clamped to its bounds.
    Clamped {
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
    pub fn at(&self, airspeed: AirspeedPoint) -> f64 {
        let value = |of_logarithm: bool, figure: f64| if of_logarithm { figure.exp() } else { figure };
        match self {
            Curve::Polynomial { of_logarithm, coefficients } => {
                let sum = coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * airspeed.scaled + coefficient);
                value(*of_logarithm, sum)
            }
            Curve::Table { of_logarithm, table } => value(*of_logarithm, table.at(airspeed.kt)),
            Curve::WithSecond { curve, of_logarithm, slope } => {
                value(*of_logarithm, curve.at(airspeed) + slope * airspeed.second_scaled)
            }
            Curve::Constant(value) => *value,
            Curve::Clamped { curve, least, most } => curve.at(airspeed).min(most.at(airspeed.kt)).max(*least),
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
            Curve::WithSecond { slope, .. } if !slope.is_finite() => Some(NOT_FINITE),
            Curve::WithSecond { curve, .. } => curve.flaw(),
            Curve::Constant(value) => (!value.is_finite()).then_some(NOT_FINITE),
            Curve::Clamped { least, .. } if !least.is_finite() => Some(NOT_FINITE),
            Curve::Clamped { curve, least, most } => {
                let crossed =
                    || most.values.iter().any(|most| most < least).then_some("a least value above the greatest");
                curve.flaw().or_else(|| most.flaw()).or_else(crossed)
            }
        }
    }
}

/// An airspeed, clamped to the range of a correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirspeedPoint {
    /// The airspeed \[kt\].
    pub kt: f64,
    /// The same as polynomials take it: (airspeed - mean) / half range.
    pub scaled: f64,
    /// The second variable on its scale from -1 to 1; 0, its middle, where there is none.
    pub second_scaled: f64,
}

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

/// What a language calls the functions of an expression.
pub(super) struct Language {
    pub(super) exp: &'static str,
    pub(super) min: &'static str,
    pub(super) max: &'static str,
    /// Of coefficients and the scaled airspeed `v`.
    pub(super) polynomial: &'static str,
    /// Of airspeeds, values and the airspeed `a`.
    pub(super) table: &'static str,
}

impl Language {
    /// The value of a curve at the airspeed `a`, the scaled airspeed `v` and the scaled second variable `z`; `array` says how numbers
    /// are given to a function.
    pub(super) fn expression(&self, curve: &Curve, array: &mut dyn FnMut(&[f64]) -> String) -> String {
        match curve {
            Curve::Polynomial { of_logarithm, coefficients } => {
                self.value(*of_logarithm, format!("{}({}, v)", self.polynomial, array(coefficients)))
            }
            Curve::Table { of_logarithm, table } => self.value(*of_logarithm, self.table(table, array)),
            Curve::WithSecond { curve, of_logarithm, slope } => {
                let sum = format!("{} + ({}) * z", self.expression(curve, array), number(*slope));
                self.value(*of_logarithm, sum)
            }
            Curve::Constant(value) => number(*value),
            Curve::Clamped { curve, least, most } => {
                let (value, most) = (self.expression(curve, array), self.table(most, array));
                format!("{}({}({value}, {most}), {})", self.max, self.min, number(*least))
            }
        }
    }

    /// The same in a language in which lists stand in square brackets.
    pub(super) fn in_brackets(&self, curve: &Curve) -> String {
        self.expression(curve, &mut |numbers| format!("[{}]", list(numbers)))
    }

    fn value(&self, of_logarithm: bool, content: String) -> String {
        if of_logarithm { format!("{}({content})", self.exp) } else { content }
    }

    fn table(&self, table: &LookupTable, array: &mut dyn FnMut(&[f64]) -> String) -> String {
        format!("{}({}, {}, a)", self.table, array(&table.airspeed_kt), array(&table.values))
    }
}

/// A finite number with 17 significant digits: it comes back to the last one in every language.
pub(super) fn number(value: f64) -> String {
    format!("{value:.16e}")
}

/// Numbers with commas between them.
pub(super) fn list(values: &[f64]) -> String {
    values.iter().map(|&value| number(value)).collect::<Vec<_>>().join(", ")
}

/// A text for a comment of any language: visible characters of ASCII, all others by their numbers in Unicode, and nothing that
/// ends or begins a comment.
pub(super) fn comment(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            // Two characters that begin or end comments, continue lines or are written otherwise never stand together.
            '*' | '/' | '\\' | '?' | '%' | '{' | '}' | '"' | '\''
                if plain.ends_with(['*', '/', '?', '%', '"', '\'']) =>
            {
                plain.push(' ');
                plain.push(character);
            }
            ' '..='~' => plain.push(character),
            _ => plain.push_str(&format!("<U+{:04X}>", u32::from(character))),
        }
    }
    // A line of a comment that ends in a backslash goes on in the next.
    if plain.ends_with('\\') {
        plain.push('.');
    }
    plain
}

/// A text between double quotes for C: bytes that are no plain characters as three octal digits.
pub(super) fn c_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for byte in text.bytes() {
        match byte {
            // A question mark could begin a trigraph.
            b'"' | b'\\' | b'?' | 0..0x20 | 0x7f.. => quoted.push_str(&format!("\\{byte:03o}")),
            _ => quoted.push(char::from(byte)),
        }
    }
    quoted.push('"');
    quoted
}

/// A text between double quotes for Python.
pub(super) fn python_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => quoted.extend(['\\', character]),
            ' '..='~' => quoted.push(character),
            _ => quoted.push_str(&format!("\\U{:08x}", u32::from(character))),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(curve: &Curve, kt: f64) -> f64 {
        curve.at(AirspeedPoint { kt, scaled: (kt - 50.0) / 50.0, second_scaled: 0.0 })
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
    fn a_curve_is_clamped_to_its_bounds() {
        let clamped = |least: f64, most: [f64; 2]| Curve::Clamped {
            curve: Box::new(polynomial(false)),
            least,
            most: LookupTable { airspeed_kt: vec![0.0, 100.0], values: most.to_vec() },
        };
        assert_eq!(at(&clamped(0.0, [1.0, 5.0]), 100.0), 5.0);
        assert_eq!(at(&clamped(0.0, [1.0, 5.0]), 0.0), 1.0);
        assert_eq!(at(&clamped(3.0, [9.0, 9.0]), 50.0), 3.0);
        assert_eq!(clamped(3.0, [9.0, 2.0]).flaw(), Some("a least value above the greatest"));
        assert_eq!(clamped(f64::NAN, [9.0, 2.0]).flaw(), Some("a number that is not finite"));
    }

    #[test]
    fn a_table_is_linear_between_its_points_and_constant_outside() {
        let table = LookupTable { airspeed_kt: vec![0.0, 10.0, 30.0], values: vec![1.0, 2.0, 0.0] };
        let values = [-5.0, 0.0, 5.0, 10.0, 20.0, 30.0, 40.0].map(|kt| table.at(kt));
        assert_eq!(values, [1.0, 1.0, 1.5, 2.0, 1.0, 0.0, 0.0]);
        let twice = LookupTable { airspeed_kt: vec![1.0, 1.0], values: vec![1.0, 2.0] };
        assert_eq!(twice.flaw(), Some("airspeeds that do not increase"));
    }

    proptest! {
        #[test]
        fn a_number_comes_back_to_the_last_digit(value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL) {
            prop_assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
    }

    #[test]
    fn a_comment_stays_one_line_and_is_not_ended() {
        assert_eq!(comment("a\n*/b"), "a<U+000A>* /b");
        assert_eq!(comment("δ\\"), "<U+03B4>\\.");
    }

    #[test]
    fn texts_are_escaped_for_their_language() {
        assert_eq!(c_text("a\"?\u{e9}1"), "\"a\\042\\077\\303\\2511\"");
        assert_eq!(python_text("a\"\\\u{e9}"), "\"a\\\"\\\\\\U000000e9\"");
    }

    proptest! {
        #[test]
        fn no_comment_is_ended(text in "[*/\\\\?%{}\"'a\\n]{0,20}") {
            let plain = comment(&text);
            for mark in ["*/", "/*", "//", "??", "%{", "%}", "\n", "\"\"", "'''"] {
                prop_assert!(!plain.contains(mark), "{}", plain);
            }
        }
    }
}
