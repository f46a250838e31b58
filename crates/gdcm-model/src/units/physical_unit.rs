//! Units of measurement and the factors between them.

use std::f64::consts::{PI, TAU};

/// The physical dimension of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    Angle,
    AngularRate,
    AngularAcceleration,
    Length,
    Speed,
    Acceleration,
    /// A fraction, such as a fraction of stick travel.
    Part,
    Force,
    Time,
    /// Cycles over time.
    Frequency,
    /// Logarithm of a ratio.
    Level,
}

/// A unit: its dimension and its size in the dimension's base unit (rad, m, N, s, Hz, dB, 1 and
/// their combinations).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhysicalUnit {
    pub dimension: Dimension,
    /// Its size in rad, rad/s, rad/s^2, m, m/s, m/s^2, 1, N, s, Hz or dB.
    pub size: f64,
    /// Its usual spelling.
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

/// All known units (without `rps`, which means radians to some and revolutions to others):
/// dimension, size, and spellings as returned by [`folded_unit`], the usual one first.
const UNITS: &[(Dimension, f64, &[&str])] = {
    use Dimension::*;
    &[
        (Angle, 1.0, &["rad", "radian"]),
        (Angle, 1e-3, &["mrad"]),
        (Angle, PI / 180.0, &["deg", "degree"]),
        (AngularRate, 1.0, &["rad/s", "rad/s1"]),
        (AngularRate, 1e3, &["rad/ms", "rad/millis"]),
        (AngularRate, 1.0 / 60.0, &["rad/min"]),
        (AngularRate, PI / 180.0, &["deg/s", "dps"]),
        (AngularRate, TAU / 60.0, &["rpm", "rev/min"]),
        (AngularAcceleration, 1.0, &["rad/s2"]),
        (AngularAcceleration, PI / 180.0, &["deg/s2"]),
        (Length, 1.0, &["m"]),
        (Length, 0.01, &["cm"]),
        (Length, 0.001, &["mm"]),
        (Length, FOOT / 12.0, &["in", "inch"]),
        (Length, FOOT, &["ft", "foot", "feet"]),
        (Speed, 1.0, &["m/s", "mps"]),
        (Speed, FOOT, &["ft/s", "fps"]),
        (Speed, FOOT / 60.0, &["ft/min", "fpm"]),
        (Speed, KNOT, &["kt", "kts", "knot"]),
        (Speed, 1.0 / 3.6, &["km/h"]),
        (Acceleration, 1.0, &["m/s2", "mps2"]),
        (Acceleration, FOOT, &["ft/s2", "fps2"]),
        (Acceleration, GRAVITY, &["g", "gs", "g's", "gee"]),
        (Part, 0.01, &["%", "pct", "percent"]),
        (
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
        (Force, 1.0, &["N", "n", "newton"]),
        (Force, POUND_FORCE, &["lb", "lbf", "lbs"]),
        (Time, 1.0, &["s"]),
        (Time, 1e-3, &["ms", "millis"]),
        (Time, 1e-6, &["µs", "μs", "us", "micros"]),
        (Time, 1e-9, &["ns", "nanos"]),
        (Time, 60.0, &["min"]),
        (Time, 3600.0, &["h", "hr", "hour", "hours"]),
        (Time, 86_400.0, &["days", "day", "d"]),
        (
            Frequency,
            1.0,
            &["Hz", "hz", "hertz", "cps", "cycle/s", "cycles/s"],
        ),
        (Frequency, 1e3, &["kHz", "khz"]),
        (Level, 1.0, &["dB", "db", "decibel"]),
    ]
};

impl PhysicalUnit {
    /// Parses a unit in any common spelling: "deg/s", "°/sec", "dps", "ft/s^2", "g", "% of stick",
    /// "msec".
    pub fn of(text: &str) -> Option<Self> {
        let spelled = |text: &str| UNITS.iter().find(|(_, _, names)| names.contains(&text));
        // Most units have the usual spelling; this runs for many units on each column of each
        // record.
        let (dimension, size, names) = spelled(text).or_else(|| spelled(&folded_unit(text)))?;
        Some(Self {
            dimension: *dimension,
            size: *size,
            name: names[0],
        })
    }
}

/// Folds a unit: no case, blanks, brackets or alternative spellings.
fn folded_unit(text: &str) -> String {
    let text = text
        .trim()
        .trim_matches(['[', ']', '(', ')'])
        .trim_end_matches('.')
        .to_lowercase();
    let text = ["of stick", "of travel", "of full travel", "stick"]
        .iter()
        .fold(text, |text, word| text.replace(word, ""));
    let text: String = text
        .chars()
        .filter(|letter| !letter.is_whitespace())
        .collect();
    let same = [
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
    // "percent" is a separate word.
    if matches!(text.as_str(), "percent" | "percentage") {
        return "percent".to_owned();
    }
    same.iter()
        .fold(text, |text, (from, to)| text.replace(from, to))
}

/// Returns the number of `to` units per `from` unit; `None` where either is unknown or their
/// dimensions differ. Exactly 1 for the same unit.
pub fn conversion_factor(from: &str, to: &str) -> Option<f64> {
    if from.trim() == to.trim() {
        return Some(1.0);
    }
    let from = PhysicalUnit::of(from)?;
    let to = PhysicalUnit::of(to)?;
    let same = from.dimension == to.dimension;
    same.then(|| {
        if from.size == to.size {
            1.0
        } else {
            from.size / to.size
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_known_however_they_are_written() {
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
    fn every_spelling_is_folded_and_stands_once() {
        let names: Vec<&str> = UNITS
            .iter()
            .flat_map(|(_, _, names)| names.iter().copied())
            .collect();
        for (place, name) in names.iter().enumerate() {
            assert!(!names[..place].contains(name), "{name} stands twice");
            assert!(PhysicalUnit::of(name).is_some(), "{name}");
        }
        for (text, name) in [
            ("secs", "s"),
            ("msecs", "ms"),
            ("Milliseconds", "ms"),
            ("usec", "µs"),
            ("Hertz", "Hz"),
        ] {
            assert_eq!(
                PhysicalUnit::of(text).map(|unit| unit.name),
                Some(name),
                "{text}"
            );
        }
    }

    #[test]
    fn factors_are_those_of_the_definitions() {
        let near = |from, to, expected: f64| {
            let factor = conversion_factor(from, to).unwrap();
            // One division of two rounded sizes.
            assert!(
                (factor / expected - 1.0).abs() < 4e-16,
                "{from} {to} {factor}"
            );
        };
        near("rad/s", "deg/s", 180.0 / PI);
        near("g", "m/s^2", 9.806_65);
        near("ft/s2", "m/s2", 0.3048);
        near("in", "mm", 25.4);
        near("kt", "m/s", 0.514_444_444_444_444_4);
    }

    #[test]
    fn what_measures_different_things_has_no_factor() {
        assert_eq!(
            conversion_factor("in", "%"),
            None,
            "travel of a stick is no property of the units"
        );
        assert_eq!(conversion_factor("deg", "deg/s"), None);
        assert_eq!(conversion_factor("furlong", "m"), None);
        assert_eq!(
            conversion_factor("furlong", "furlong"),
            Some(1.0),
            "what is not known is not converted"
        );
    }
}
