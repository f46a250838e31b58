//! Physical units and the factors between them.

use std::f64::consts::{PI, TAU};

/// Physical dimension of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    Angle,
    AngularRate,
    AngularAcceleration,
    Length,
    Speed,
    Acceleration,
    /// Dimensionless fraction, such as stick travel over full travel.
    Part,
    Force,
    Time,
    /// Cycles per time.
    Frequency,
    /// Logarithm of a ratio.
    Level,
}

/// A physical unit, recognised by its spelling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhysicalUnit {
    pub dimension: Dimension,
    /// Size, in the base unit of its dimension: rad, rad/s, rad/s^2, m, m/s, m/s^2, 1, N, s, Hz or
    /// dB.
    pub size: f64,
    /// Usual spelling.
    pub name: &'static str,
}

/// Metres per foot (international yard and pound agreement, 1959).
const FOOT: f64 = 0.3048;
/// Standard gravity \[m/s^2\] (CGPM 1901).
const GRAVITY: f64 = 9.806_65;
/// Metres per second per knot.
const KNOT: f64 = 1852.0 / 3600.0;
/// Newtons per pound-force.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

struct UnitRow {
    dimension: Dimension,
    /// Size, in the base unit of the dimension.
    size: f64,
    /// Spellings as returned by [`folded_unit`], the usual spelling first.
    spellings: &'static [&'static str],
}

const fn unit(dimension: Dimension, size: f64, spellings: &'static [&'static str]) -> UnitRow {
    UnitRow {
        dimension,
        size,
        spellings,
    }
}

/// All supported units. `rps` is not supported: it may mean radians or revolutions per second.
const UNITS: &[UnitRow] = {
    use Dimension::{
        Acceleration, Angle, AngularAcceleration, AngularRate, Force, Frequency, Length, Level,
        Part, Speed, Time,
    };
    &[
        unit(Angle, 1.0, &["rad", "radian"]),
        unit(Angle, 1e-3, &["mrad"]),
        unit(Angle, PI / 180.0, &["deg", "degree"]),
        unit(AngularRate, 1.0, &["rad/s", "rad/s1"]),
        unit(AngularRate, 1e3, &["rad/ms", "rad/millis"]),
        unit(AngularRate, 1.0 / 60.0, &["rad/min"]),
        unit(AngularRate, PI / 180.0, &["deg/s", "dps"]),
        unit(AngularRate, TAU / 60.0, &["rpm", "rev/min"]),
        unit(AngularAcceleration, 1.0, &["rad/s2"]),
        unit(AngularAcceleration, PI / 180.0, &["deg/s2"]),
        unit(Length, 1.0, &["m"]),
        unit(Length, 0.01, &["cm"]),
        unit(Length, 0.001, &["mm"]),
        unit(Length, FOOT / 12.0, &["in", "inch"]),
        unit(Length, FOOT, &["ft", "foot", "feet"]),
        unit(Speed, 1.0, &["m/s", "mps"]),
        unit(Speed, FOOT, &["ft/s", "fps"]),
        unit(Speed, FOOT / 60.0, &["ft/min", "fpm"]),
        unit(Speed, KNOT, &["kt", "kts", "knot"]),
        unit(Speed, 1.0 / 3.6, &["km/h"]),
        unit(Acceleration, 1.0, &["m/s2", "mps2"]),
        unit(Acceleration, FOOT, &["ft/s2", "fps2"]),
        unit(Acceleration, GRAVITY, &["g", "gs", "g's", "gee"]),
        unit(Part, 0.01, &["%", "pct", "percent"]),
        unit(
            Part,
            1.0,
            &[
                "1",
                "-",
                "part",
                "fraction",
                "frac",
                "normalized",
                "normalised",
            ],
        ),
        unit(Force, 1.0, &["N", "n", "newton"]),
        unit(Force, POUND_FORCE, &["lb", "lbf", "lbs"]),
        unit(Time, 1.0, &["s"]),
        unit(Time, 1e-3, &["ms", "millis"]),
        unit(Time, 1e-6, &["µs", "μs", "us", "micros"]),
        unit(Time, 1e-9, &["ns", "nanos"]),
        unit(Time, 60.0, &["min"]),
        unit(Time, 3600.0, &["h", "hr", "hour", "hours"]),
        unit(Time, 86_400.0, &["days", "day", "d"]),
        unit(
            Frequency,
            1.0,
            &["Hz", "hz", "hertz", "cps", "cycle/s", "cycles/s"],
        ),
        unit(Frequency, 1e3, &["kHz", "khz"]),
        unit(Level, 1.0, &["dB", "db", "decibel"]),
    ]
};

impl PhysicalUnit {
    /// Parses a unit in any common spelling: "deg/s", "°/sec", "dps", "ft/s^2", "g", "% of stick",
    /// "msec"; `None` for an unknown unit.
    pub fn parse(text: &str) -> Option<Self> {
        // Try the text as it is first: most units are spelt as in the table, and many are parsed
        // for each column of each record, so that it pays to avoid the folding.
        let row = find_unit(text).or_else(|| find_unit(&folded_unit(text)))?;
        Some(Self {
            dimension: row.dimension,
            size: row.size,
            name: row.spellings[0],
        })
    }
}

/// Returns the row with this spelling; `None` if there is none.
fn find_unit(spelling: &str) -> Option<&'static UnitRow> {
    UNITS.iter().find(|row| row.spellings.contains(&spelling))
}

/// Words that name the whole to which a percentage refers.
const WHOLES: [&str; 4] = ["of stick", "of travel", "of full travel", "stick"];

/// Alternative spellings and their replacements, in the order in which they are applied.
const REPLACEMENTS: [(&str, &str); 18] = [
    ("°", "deg"),
    ("degrees", "deg"),
    ("radians", "rad"),
    ("**2", "2"),
    ("^2", "2"),
    ("²", "2"),
    ("./", "/"),
    ("/s/s", "/s2"),
    ("/sec/sec", "/s2"),
    ("seconds", "s"),
    ("second", "s"),
    ("secs", "s"),
    ("sec", "s"),
    ("minutes", "min"),
    ("minute", "min"),
    ("per", "/"),
    ("inches", "inch"),
    ("knots", "knot"),
];

/// Folds a unit: lower case, without blanks and brackets, in the standard spelling.
fn folded_unit(text: &str) -> String {
    let mut unit = text
        .trim()
        .trim_matches(['[', ']', '(', ')'])
        .trim_end_matches('.')
        .to_lowercase();
    for words in WHOLES {
        unit = unit.replace(words, "");
    }
    unit.retain(|letter| !letter.is_whitespace());
    // Return "percent" before "per" is replaced by "/".
    if matches!(unit.as_str(), "percent" | "percentage") {
        return "percent".to_owned();
    }
    for (spelling, replacement) in REPLACEMENTS {
        unit = unit.replace(spelling, replacement);
    }
    unit
}

/// Returns the factor from unit `from` to unit `to`: exactly 1 for the same unit, even an unknown
/// one; otherwise `None` if either is unknown or their dimensions differ.
pub fn conversion_factor(from: &str, to: &str) -> Option<f64> {
    if from.trim() == to.trim() {
        return Some(1.0);
    }
    let from = PhysicalUnit::parse(from)?;
    let to = PhysicalUnit::parse(to)?;
    if from.dimension != to.dimension {
        return None;
    }
    if from.size == to.size {
        return Some(1.0);
    }
    Some(from.size / to.size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_known_in_many_spellings() {
        for (a, b) in [
            ("deg/s", "°/sec"),
            ("dps", "degrees / second"),
            ("m/s^2", "m/s²"),
            ("[ft/sec^2]", "ft/s/s"),
            ("%", "percent"),
        ] {
            assert_eq!(conversion_factor(a, b), Some(1.0), "{a} {b}");
        }
        assert_eq!(
            conversion_factor("% of stick", "fraction of stick"),
            Some(0.01)
        );
    }

    #[test]
    fn each_spelling_is_folded_and_unique() {
        let names: Vec<&str> = UNITS
            .iter()
            .flat_map(|row| row.spellings.iter().copied())
            .collect();
        for (place, name) in names.iter().enumerate() {
            assert!(!names[..place].contains(name), "duplicate {name}");
            assert!(PhysicalUnit::parse(name).is_some(), "{name}");
        }
        for (text, name) in [
            ("secs", "s"),
            ("msecs", "ms"),
            ("Milliseconds", "ms"),
            ("usec", "µs"),
            ("Hertz", "Hz"),
        ] {
            assert_eq!(
                PhysicalUnit::parse(text).map(|unit| unit.name),
                Some(name),
                "{text}"
            );
        }
    }

    #[test]
    fn factors_are_those_of_the_definitions() {
        for (from, to, expected) in [
            ("rad/s", "deg/s", 180.0 / PI),
            ("g", "m/s^2", 9.806_65),
            ("ft/s2", "m/s2", 0.3048),
            ("in", "mm", 25.4),
            ("kt", "m/s", 0.514_444_444_444_444_4),
        ] {
            let factor = conversion_factor(from, to).unwrap();
            // Tolerance: the quotient of two rounded sizes.
            assert!(
                (factor / expected - 1.0).abs() < 4e-16,
                "{from} {to} {factor}"
            );
        }
    }

    #[test]
    fn different_dimensions_have_no_factor() {
        assert_eq!(
            conversion_factor("in", "%"),
            None,
            "stick travel is not a property of units"
        );
        assert_eq!(conversion_factor("deg", "deg/s"), None);
        assert_eq!(conversion_factor("furlong", "m"), None);
        assert_eq!(
            conversion_factor("furlong", "furlong"),
            Some(1.0),
            "the same text needs no conversion"
        );
    }
}
