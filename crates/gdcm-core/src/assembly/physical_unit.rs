//! Units of measurement, and the factor from one to another.

use std::f64::consts::{PI, TAU};

/// What a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Angle.
    Angle,
    /// Angle over time.
    AngularRate,
    /// Angle over time squared.
    AngularAcceleration,
    /// Length.
    Length,
    /// Length over time.
    Speed,
    /// Length over time squared.
    Acceleration,
    /// A part of a whole, such as of the travel of a stick.
    Part,
    /// Force.
    Force,
}

/// A unit: what it measures, and how many of the dimension's own units (rad, s, m, N, 1) it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhysicalUnit {
    /// What it measures.
    pub dimension: Dimension,
    /// Its size in rad, rad/s, rad/s^2, m, m/s, m/s^2, 1 or N.
    pub size: f64,
}

/// Metres in a foot (international yard and pound agreement, 1959).
const FOOT: f64 = 0.3048;
/// Standard gravity \[m/s^2\] (CGPM 1901).
const GRAVITY: f64 = 9.806_65;
/// Metres per second in a knot.
const KNOT: f64 = 1852.0 / 3600.0;
/// Newtons in a pound-force.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

impl PhysicalUnit {
    /// The unit that a text spells, however engineers write it: "deg/s", "°/sec", "dps", "ft/s^2", "g", "% of stick".
    pub fn of(text: &str) -> Option<Self> {
        use Dimension::{Acceleration, Angle, AngularAcceleration, AngularRate, Force, Length, Part, Speed};
        let (dimension, size) = match plain(text).as_str() {
            "rad" | "radian" => (Angle, 1.0),
            "mrad" => (Angle, 1e-3),
            "deg" | "degree" => (Angle, PI / 180.0),
            "rad/s" | "rps" | "rad/s1" => (AngularRate, 1.0),
            "deg/s" | "dps" => (AngularRate, PI / 180.0),
            "rpm" | "rev/min" => (AngularRate, TAU / 60.0),
            "rad/s2" => (AngularAcceleration, 1.0),
            "deg/s2" => (AngularAcceleration, PI / 180.0),
            "m" => (Length, 1.0),
            "cm" => (Length, 0.01),
            "mm" => (Length, 0.001),
            "in" | "inch" => (Length, FOOT / 12.0),
            "ft" | "foot" | "feet" => (Length, FOOT),
            "m/s" | "mps" => (Speed, 1.0),
            "ft/s" | "fps" => (Speed, FOOT),
            "ft/min" | "fpm" => (Speed, FOOT / 60.0),
            "kt" | "kts" | "knot" => (Speed, KNOT),
            "km/h" => (Speed, 1.0 / 3.6),
            "m/s2" | "mps2" => (Acceleration, 1.0),
            "ft/s2" | "fps2" => (Acceleration, FOOT),
            "g" | "gs" | "g's" | "gee" => (Acceleration, GRAVITY),
            "%" | "pct" | "percent" => (Part, 0.01),
            "1" | "-" | "part" | "fraction" | "frac" | "normalized" | "normalised" => (Part, 1.0),
            "n" | "newton" => (Force, 1.0),
            "lb" | "lbf" | "lbs" => (Force, POUND_FORCE),
            _ => return None,
        };
        Some(Self { dimension, size })
    }
}

/// A unit without case, blanks, brackets and other ways of writing the same.
fn plain(text: &str) -> String {
    let text = text.trim().trim_matches(['[', ']', '(', ')']).to_lowercase();
    let text =
        ["of stick", "of travel", "of full travel", "stick"].iter().fold(text, |text, word| text.replace(word, ""));
    let text: String = text.chars().filter(|letter| !letter.is_whitespace()).collect();
    let same = [
        ("°", "deg"),
        ("degrees", "deg"),
        ("radians", "rad"),
        ("**2", "2"),
        ("^2", "2"),
        ("²", "2"),
        ("/s/s", "/s2"),
        ("/sec/sec", "/s2"),
        ("seconds", "s"),
        ("second", "s"),
        ("sec", "s"),
        ("per", "/"),
        ("inches", "inch"),
        ("knots", "knot"),
    ];
    // "percent" is a word of its own.
    if matches!(text.as_str(), "percent" | "percentage") {
        return "percent".to_owned();
    }
    same.iter().fold(text, |text, (from, to)| text.replace(from, to))
}

/// How many of `to` one of `from` is; none where either is unknown or they measure different things. 1 exactly for the same unit.
pub fn conversion_factor(from: &str, to: &str) -> Option<f64> {
    if from.trim() == to.trim() {
        return Some(1.0);
    }
    let (from, to) = (PhysicalUnit::of(from)?, PhysicalUnit::of(to)?);
    let same = from.dimension == to.dimension;
    same.then(|| if from.size == to.size { 1.0 } else { from.size / to.size })
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
        assert_eq!(conversion_factor("% of stick", "fraction of stick"), Some(0.01));
    }

    #[test]
    fn factors_are_those_of_the_definitions() {
        let near = |from, to, expected: f64| {
            let factor = conversion_factor(from, to).unwrap();
            // One division of two rounded sizes.
            assert!((factor / expected - 1.0).abs() < 4e-16, "{from} {to} {factor}");
        };
        near("rad/s", "deg/s", 180.0 / PI);
        near("g", "m/s^2", 9.806_65);
        near("ft/s2", "m/s2", 0.3048);
        near("in", "mm", 25.4);
        near("kt", "m/s", 0.514_444_444_444_444_4);
    }

    #[test]
    fn what_measures_different_things_has_no_factor() {
        assert_eq!(conversion_factor("in", "%"), None, "travel of a stick is no property of the units");
        assert_eq!(conversion_factor("deg", "deg/s"), None);
        assert_eq!(conversion_factor("furlong", "m"), None);
        assert_eq!(conversion_factor("furlong", "furlong"), Some(1.0), "what is not known is not converted");
    }
}
