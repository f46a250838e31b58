//! Patterns for the names of folders, files and variables.

use std::ops::Range;
use std::sync::LazyLock;

use regex::{Regex, RegexBuilder};

use super::name_facts::{NameFacts, RowRole};
use crate::message_text::{quoted, sanitized, shortened};

const LONGEST_PATTERN: usize = 1000;
/// Maximum memory of a compiled pattern \[bytes\].
const MOST_MEMORY: usize = 1 << 20;

/// Permitted group names, apart from trim offsets.
const GROUPS: &str = "condition airspeed_kt altitude altitude_ft weight mass_kg method name nominal perturbed identified";
/// Prefix of group names for trim offsets.
const OFFSET: &str = "by_";

/// A pattern for names: a regular expression whose named groups identify values.
///
/// | group | holds |
/// |---|---|
/// | `condition`, `airspeed_kt`, `altitude`, `altitude_ft` | the value of the field with the same name |
/// | `weight`, `mass_kg`, `method`, `name` | the value of the field with the same name |
/// | `by_roll_deg`, `by_...` | trim offset in `roll_deg`, ... (`+5`, `-5`, `p5`, `m5`) |
/// | `nominal`, `perturbed`, `identified` | any text; sets the role of this name |
#[derive(Clone, Debug)]
pub struct NamePattern {
    regex: Regex,
}

/// Error for a text that is not a valid name pattern.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    #[error("{} is not a valid regular expression: {}", quoted(pattern), shortened(&sanitized(reason)))]
    Syntax {
        pattern: String,
        /// Message of the regular-expression parser.
        reason: String,
    },
    #[error(
        "{}: unknown group {}; known groups are condition, airspeed_kt, altitude, altitude_ft, weight, mass_kg, method, name, nominal, \
         perturbed, identified, or by_ and a coordinate such as roll_deg",
        quoted(pattern),
        quoted(group)
    )]
    Group { pattern: String, group: String },
}

impl NamePattern {
    /// Compiles a pattern; case is ignored.
    ///
    /// # Errors
    /// [`PatternError`] if the text is too long, is not a regular expression, or has an unknown
    /// group.
    pub fn new(pattern: &str) -> Result<Self, PatternError> {
        if pattern.len() > LONGEST_PATTERN {
            return Err(PatternError::Syntax {
                pattern: pattern.to_owned(),
                reason: format!("it is longer than {LONGEST_PATTERN} bytes"),
            });
        }
        let regex = RegexBuilder::new(pattern)
            .case_insensitive(true)
            .size_limit(MOST_MEMORY)
            .build()
            .map_err(|error| PatternError::Syntax {
                pattern: pattern.to_owned(),
                reason: last_line(&error.to_string()),
            })?;
        for group in regex.capture_names().flatten() {
            if !is_known_group(group) {
                return Err(PatternError::Group {
                    pattern: pattern.to_owned(),
                    group: group.to_owned(),
                });
            }
        }
        Ok(Self { regex })
    }

    /// Returns the text of the pattern.
    pub fn as_str(&self) -> &str {
        self.regex.as_str()
    }

    /// Fills the empty fields of `facts` with the values in a name; the first of several matches
    /// applies.
    pub fn read(&self, name: &str, facts: &mut NameFacts) {
        for found in self.regex.captures_iter(name) {
            for group in self.regex.capture_names().flatten() {
                if let Some(text) = found.name(group) {
                    put_if_empty(group, text.as_str(), facts);
                }
            }
        }
    }
}

/// Reads a name with several patterns; earlier patterns take precedence.
pub fn read_name(name: &str, patterns: &[NamePattern]) -> NameFacts {
    let mut facts = NameFacts::default();
    for pattern in patterns {
        pattern.read(name, &mut facts);
    }
    facts
}

/// Returns the last line of a parser message, which states the reason; the lines before it quote
/// the pattern.
fn last_line(message: &str) -> String {
    message.lines().last().unwrap_or_default().trim().to_owned()
}

fn is_known_group(name: &str) -> bool {
    name.starts_with(OFFSET) || GROUPS.split(' ').any(|group| group == name)
}

/// Returns the parts of a name that look like a trim offset ("dPHI+5") but are matched by no
/// pattern.
pub fn unread_offsets(name: &str, patterns: &[NamePattern]) -> Vec<String> {
    // A word, a sign and a number.
    let Ok(offset) = Regex::new(r"[A-Za-z]+[_ ]?[+-]\d+(?:\.\d+)?") else {
        return Vec::new();
    };
    let mut read: Vec<Range<usize>> = Vec::new();
    for pattern in patterns {
        read.extend(
            pattern
                .regex
                .captures_iter(name)
                .map(|found| found.get_match().range()),
        );
    }
    let mut unread = Vec::new();
    for part in offset.find_iter(name) {
        let is_read = read
            .iter()
            .any(|range| range.start < part.end() && part.start() < range.end);
        if !is_read {
            unread.push(part.as_str().to_owned());
        }
    }
    unread
}

/// Sets the field named by a group to its text, unless the field already has a value.
fn put_if_empty(group: &str, text: &str, facts: &mut NameFacts) {
    match group {
        "condition" => facts.condition = facts.condition.or_else(|| text.parse().ok()),
        "airspeed_kt" => facts.airspeed_kt = facts.airspeed_kt.or_else(|| parse_number(text)),
        "altitude_ft" => facts.altitude_ft = facts.altitude_ft.or_else(|| parse_number(text)),
        "mass_kg" => facts.mass_kg = facts.mass_kg.or_else(|| parse_number(text)),
        "altitude" if facts.altitude.is_none() => facts.altitude = Some(text.to_lowercase()),
        "weight" if facts.weight.is_none() => facts.weight = Some(text.to_lowercase()),
        "method" if facts.method.is_none() => facts.method = Some(text.to_owned()),
        "name" if facts.name.is_empty() => text.clone_into(&mut facts.name),
        "nominal" | "perturbed" | "identified" => {
            facts.role = facts.role.or(RowRole::from_word(group));
        }
        _ => {
            if let Some(coordinate) = group.strip_prefix(OFFSET)
                && let Some(offset) = parse_offset(text)
            {
                facts
                    .perturbation
                    .entry(coordinate.to_owned())
                    .or_insert(offset);
            }
        }
    }
}

/// Parses a finite number with a decimal point or comma.
fn parse_number(text: &str) -> Option<f64> {
    let value: f64 = text.replace(',', ".").parse().ok()?;
    if value.is_finite() { Some(value) } else { None }
}

/// Parses a signed offset: `+5`, `-5`, `p5`, `m5`, `plus5`, `minus2.5`.
fn parse_offset(text: &str) -> Option<f64> {
    const SIGNS: [(&str, f64); 6] = [
        ("minus", -1.0),
        ("plus", 1.0),
        ("-", -1.0),
        ("+", 1.0),
        ("m", -1.0),
        ("p", 1.0),
    ];
    let text = text.to_lowercase();
    let mut digits = text.as_str();
    let mut sign = 1.0;
    for (mark, mark_sign) in SIGNS {
        if let Some(rest) = text.strip_prefix(mark) {
            digits = rest;
            sign = mark_sign;
            break;
        }
    }
    let value: f64 = digits.trim_start_matches(['_', ' ']).parse().ok()?;
    if value.is_finite() {
        Some(sign * value)
    } else {
        None
    }
}

impl PartialEq for NamePattern {
    fn eq(&self, other: &Self) -> bool {
        self.as_str() == other.as_str()
    }
}

/// Returns the patterns for common names: `c03_045kt_high/roll+5`, `cond 3/V-10kt`,
/// `120kt_low_heavy/flight`.
pub fn standard_patterns() -> &'static [NamePattern] {
    &STANDARD
}

/// Standard patterns, compiled once because every record needs them.
static STANDARD: LazyLock<Vec<NamePattern>> = LazyLock::new(|| {
    let texts = [
        r"(?:^|[/_ #.-])(?:c|cond|condition|fc|case|point)[_ -]?0*(?<condition>\d+)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ ])v?0*(?<airspeed_kt>\d+(?:\.\d+)?)[_ ]?(?:kt|kts|ktas|kcas|kias|knots)(?:[/_ .#-]|$)".to_owned(),
        r"-(?<airspeed_kt>\d{3})[_ ]?(?:kt|kts|ktas|kcas|kias|knots)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude_ft>\d{3,5})[_ ]?ft(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<mass_kg>\d{3,6})[_ ]?kg(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<weight>light|heavy)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<weight>low|high)[_ ]?(?:w|weight|gw|mass)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude>low|high)[_ ]?(?:alt|altitude)?[/_ -](?<weight>low|high)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude>low|high)[_ ]?(?:alt|altitude)?(?:[/_ .#-]|$)".to_owned(),
        offset_pattern("roll|phi|bank", "roll_deg"),
        offset_pattern("v|speed|airspeed|tas|ias", "airspeed_kt"),
        offset_pattern("roc|climb|rateofclimb|hdot", "rate_of_climb_fpm"),
        offset_pattern("pitch|theta", "pitch_deg"),
        offset_pattern("beta|slip|sideslip", "sideslip_deg"),
        r"(?:^|[/_ #.-])(?<nominal>nominal|nom|trim|baseline)(?:[/_ .#(-]|$)".to_owned(),
        r"(?:^|[/_ #.-])(?<identified>identified|ident|id|sysid|sid|(?:ct-?)?pbsid|n4sid|cifer|flight|flt|measured|frf)\d*(?:[/_ .#(-]|$)"
            .to_owned(),
        r"(?:^|[/_ #.-])(?<perturbed>perturbed|pert)\d*(?:[/_ .#(-]|$)".to_owned(),
    ];
    // `.ok()`: a test counts the compiled patterns, so that an invalid pattern is not dropped
    // unnoticed.
    texts
        .iter()
        .filter_map(|text| NamePattern::new(text).ok())
        .collect()
});

/// Returns the pattern for a trim offset: one of `words`, a sign and a number.
fn offset_pattern(words: &str, coordinate: &str) -> String {
    const SIGNED: &str = r"(?:[+-]|p|m|plus|minus)[_ ]?\d+(?:\.\d+)?";
    format!(r"(?:^|[/_#, -])(?:d|delta_?)?(?:{words})[_ ]?(?<by_{coordinate}>{SIGNED})")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str) -> NameFacts {
        read_name(name, standard_patterns())
    }

    #[test]
    fn names_give_condition_airspeed_altitude_and_perturbation() {
        assert_eq!(standard_patterns().len(), 17);
        let facts = read("c03_045kt_high/roll+5");
        assert_eq!(
            (
                facts.condition,
                facts.airspeed_kt,
                facts.altitude.as_deref()
            ),
            (Some(3), Some(45.0), Some("high"))
        );
        assert_eq!(
            facts.perturbation.into_iter().collect::<Vec<_>>(),
            [("roll_deg".to_owned(), 5.0)]
        );
        let offsets: Vec<f64> = read("dV+5_dROC+150_dPHI-5")
            .perturbation
            .into_values()
            .collect();
        assert_eq!(
            offsets,
            [5.0, 150.0, -5.0],
            "airspeed_kt, rate_of_climb_fpm, roll_deg"
        );
        let facts = read("fc-12/120kt_low_heavy/V-10kt roc+150fpm");
        assert_eq!(
            (facts.condition, facts.airspeed_kt, facts.weight.as_deref()),
            (Some(12), Some(120.0), Some("heavy"))
        );
        let offsets: Vec<f64> = facts.perturbation.values().copied().collect();
        assert_eq!(offsets, [-10.0, 150.0], "airspeed_kt, rate_of_climb_fpm");
    }

    #[test]
    fn unread_trim_offsets_are_reported() {
        let unread = |name: &str| unread_offsets(name, standard_patterns());
        let facts = read("c3/dV+5_dROC+150_dPHI+5");
        assert_eq!(
            facts.perturbation.into_values().collect::<Vec<_>>(),
            [5.0, 150.0, 5.0]
        );
        assert!(
            unread("dV+5_dROC+150_dPHI+5").is_empty() && unread("V-10kt roc+150fpm").is_empty()
        );
        assert_eq!(unread("dV+5_flap-10"), ["flap-10"]);
    }

    #[test]
    fn the_first_low_or_high_is_the_altitude_and_the_second_the_weight() {
        let facts = read("60kt_low_high/nominal");
        assert_eq!(
            (
                facts.altitude.as_deref(),
                facts.weight.as_deref(),
                facts.role
            ),
            (Some("low"), Some("high"), Some(RowRole::Nominal))
        );
        let facts = read("V090kt_2000ft_6600kg/CT-PBSID 2");
        assert_eq!(
            (facts.airspeed_kt, facts.altitude_ft, facts.mass_kg),
            (Some(90.0), Some(2000.0), Some(6600.0))
        );
        assert_eq!(read("x/flight_1").role, Some(RowRole::Identified));
        let facts = read("study#study.c3.identified(2)");
        assert_eq!(
            (facts.condition, facts.role),
            (Some(3), Some(RowRole::Identified)),
            "fields of a struct"
        );
    }

    #[test]
    fn an_airspeed_offset_is_not_an_airspeed() {
        for name in ["V+10kt", "a/V-10kt", "c1/v_m10kt"] {
            let facts = read(name);
            assert_eq!(facts.airspeed_kt, None, "{name}");
            assert_eq!(
                facts.perturbation.get("airspeed_kt").map(|by| by.abs()),
                Some(10.0),
                "{name}"
            );
        }
    }

    #[test]
    fn earlier_patterns_take_precedence() {
        let mut patterns = vec![NamePattern::new("case(?<condition>\\d)").unwrap()];
        patterns.extend_from_slice(standard_patterns());
        assert_eq!(read_name("case7/c03", &patterns).condition, Some(7));
        let unknown = NamePattern::new("(?<speed>\\d+)").unwrap_err();
        let group = "speed".to_owned();
        let pattern = "(?<speed>\\d+)".to_owned();
        assert_eq!(unknown, PatternError::Group { pattern, group });
        // The message must be a single line, whatever the text contains.
        for wrong in [
            "(".to_owned(),
            "(?<cond\u{7f}ition>a)".to_owned(),
            "(th".repeat(40_000),
            format!("(?<{}>a)", "g".repeat(900)),
        ] {
            let message = NamePattern::new(&wrong).unwrap_err().to_string();
            assert!(
                message.len() < 500 && !message.contains(char::is_control),
                "{message:?}"
            );
        }
    }
}
