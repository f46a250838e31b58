//! Units in the headings of columns.

/// Words that units are made of, in lower case.
const WORDS: [&str; 68] = [
    "rad", "radian", "radians", "mrad", "deg", "degree", "degrees", "°", "s", "sec", "secs", "second", "seconds", "ms",
    "us", "µs", "min", "h", "hr", "hz", "khz", "cps", "rps", "rpm", "db", "m", "mm", "cm", "km", "ft", "in", "inch",
    "inches", "nm", "kt", "kts", "knot", "knots", "kias", "ktas", "kcas", "keas", "ktgs", "mph", "fpm", "g", "n", "kn",
    "lb", "lbf", "lbs", "slug", "kg", "pa", "hpa", "kpa", "psi", "bar", "v", "a", "w", "%", "pct", "percent", "ratio",
    "norm", "abs", "unitless",
];

/// Whether a text is made of words of units, numbers and signs only: "deg/s", "rad/s^2", "%", "1/s".
pub(super) fn is_unit(text: &str) -> bool {
    let text = text.trim().to_lowercase();
    if matches!(text.as_str(), "-" | "1" | "--" | "none") {
        return true;
    }
    let mut words = 0;
    for word in text.split(['/', '*', '^', '·', ' ', '.', '-', '(', ')', '²', '³']).filter(|word| !word.is_empty()) {
        if word.bytes().all(|byte| byte.is_ascii_digit()) {
            continue;
        }
        if !WORDS.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit())) {
            return false;
        }
        words += 1;
    }
    words > 0
}

/// Cuts a heading into a name and a unit: "omega \[rad/s\]", "P (deg/s)", "_Vind,_kias".
///
/// Square brackets hold a unit whatever they say; round ones and what follows a comma only if it is made of known words, as
/// "re(LAT->P)" names a response.
pub(super) fn name_and_unit(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim().trim_matches(['"', '\'']).trim();
    let clean = |text: &str| text.trim_matches(|c: char| c.is_whitespace() || c == '_').to_owned();
    for (open, close, always) in [('[', ']', true), ('(', ')', false), ('{', '}', false)] {
        let inner = heading.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        if let Some((name, unit)) = inner
            && (always || is_unit(unit))
        {
            return (clean(name), Some(unit.trim().to_owned()).filter(|unit| !unit.is_empty()));
        }
    }
    if let Some((name, unit)) = heading.rsplit_once(',')
        && is_unit(&clean(unit))
    {
        return (clean(name), Some(clean(unit)));
    }
    (clean(heading), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_told_from_names() {
        for unit in ["rad/s", "deg", "[1/s]".trim_matches(['[', ']']), "%", "°", "deg/s^2", "m/s²", "-"] {
            assert!(is_unit(unit), "{unit}");
        }
        for name in ["LAT->P", "P/LAT", "omega", "", "12"] {
            assert!(!is_unit(name), "{name}");
        }
    }

    #[test]
    fn a_heading_is_cut_into_name_and_unit() {
        let cut = |heading| name_and_unit(heading);
        assert_eq!(cut("omega [rad/s]"), ("omega".to_owned(), Some("rad/s".to_owned())));
        assert_eq!(cut("\"P (deg/s)\""), ("P".to_owned(), Some("deg/s".to_owned())));
        assert_eq!(cut("_Vind,_kias"), ("Vind".to_owned(), Some("kias".to_owned())));
        assert_eq!(cut("re(LAT->P)"), ("re(LAT->P)".to_owned(), None));
        assert_eq!(cut("mag(P/LAT) [dB]"), ("mag(P/LAT)".to_owned(), Some("dB".to_owned())));
        assert_eq!(cut("x []"), ("x".to_owned(), None));
    }
}
