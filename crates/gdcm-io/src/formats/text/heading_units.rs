//! Recognises units in column headings.

use gdcm_model::names::signed_name::parse_direction;

/// Words that occur in units, in lower case.
const WORDS: [&str; 68] = [
    "rad", "radian", "radians", "mrad", "deg", "degree", "degrees", "°", "s", "sec", "secs",
    "second", "seconds", "ms", "us", "µs", "min", "h", "hr", "hz", "khz", "cps", "rps", "rpm",
    "db", "m", "mm", "cm", "km", "ft", "in", "inch", "inches", "nm", "kt", "kts", "knot", "knots",
    "kias", "ktas", "kcas", "keas", "ktgs", "mph", "fpm", "g", "n", "kn", "lb", "lbf", "lbs",
    "slug", "kg", "pa", "hpa", "kpa", "psi", "bar", "v", "a", "w", "%", "pct", "percent", "ratio",
    "norm", "abs", "unitless",
];

/// Returns whether a text consists of unit words, numbers and operators, with at least one unit
/// word: "deg/s", "rad/s^2", "%", "1/s". Marks for a dimensionless column ("-", "--", "1", "none")
/// count as units.
pub(super) fn is_unit(text: &str) -> bool {
    let text = text.trim().to_lowercase();
    if matches!(text.as_str(), "-" | "1" | "--" | "none") {
        return true;
    }
    let mut has_word = false;
    for word in text.split(['/', '*', '^', '·', ' ', '.', '-', '(', ')', '²', '³']) {
        // Skip numbers, and empty words between two operators.
        if word.bytes().all(|byte| byte.is_ascii_digit()) {
            continue;
        }
        // An exponent may follow a unit word directly: "m2".
        if !WORDS.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit())) {
            return false;
        }
        has_word = true;
    }
    has_word
}

/// Splits a heading into name and unit: "omega \[rad/s\]", "P (deg/s)", "_Vind,_kias".
///
/// Text in square brackets is a unit unless it is an integer or a direction such as "+down". Text
/// in other brackets or after a comma is a unit only if it consists of unit words: "re(LAT->P)"
/// names a response.
pub(super) fn name_and_unit(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim().trim_matches(['"', '\'']).trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        let inner = heading
            .strip_suffix(close)
            .and_then(|rest| rest.rsplit_once(open));
        let Some((name, unit)) = inner else {
            continue;
        };
        let holds_unit = (open == '[' && !is_index(unit)) || is_unit(unit);
        // Text such as "+down" in "az [+down]" is a sign convention, not a unit.
        if holds_unit && parse_direction(unit).is_none() {
            let unit = unit.trim();
            let unit = if unit.is_empty() {
                None
            } else {
                Some(unit.to_owned())
            };
            return (clean(name), unit);
        }
    }
    if let Some((name, unit)) = heading.rsplit_once(',') {
        let unit = clean(unit);
        if is_unit(&unit) {
            return (clean(name), Some(unit));
        }
    }
    (clean(heading), None)
}

/// Returns whether the text in brackets is an index, as in `xyz[0]`.
fn is_index(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Removes blanks and underscores at both ends of a text.
fn clean(text: &str) -> String {
    text.trim_matches(|c: char| c.is_whitespace() || c == '_')
        .to_owned()
}

#[cfg(test)]
mod unit_word_tests {
    use super::*;

    #[test]
    fn units_are_told_from_names() {
        for unit in [
            "rad/s",
            "deg",
            "[1/s]".trim_matches(['[', ']']),
            "%",
            "°",
            "deg/s^2",
            "m/s²",
            "-",
        ] {
            assert!(is_unit(unit), "{unit}");
        }
        for name in ["LAT->P", "P/LAT", "omega", "", "12"] {
            assert!(!is_unit(name), "{name}");
        }
    }

    #[test]
    fn a_heading_is_cut_into_name_and_unit() {
        let cut = |heading| name_and_unit(heading);
        assert_eq!(
            cut("omega [rad/s]"),
            ("omega".to_owned(), Some("rad/s".to_owned()))
        );
        assert_eq!(
            cut("\"P (deg/s)\""),
            ("P".to_owned(), Some("deg/s".to_owned()))
        );
        assert_eq!(
            cut("_Vind,_kias"),
            ("Vind".to_owned(), Some("kias".to_owned()))
        );
        assert_eq!(cut("re(LAT->P)"), ("re(LAT->P)".to_owned(), None));
        assert_eq!(
            cut("mag(P/LAT) [dB]"),
            ("mag(P/LAT)".to_owned(), Some("dB".to_owned()))
        );
        assert_eq!(cut("az [+down]"), ("az [+down]".to_owned(), None));
        assert_eq!(cut("x []"), ("x".to_owned(), None));
    }
}
