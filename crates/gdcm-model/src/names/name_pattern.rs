//! Patterns for folder, file and variable names. The patterns used by default are in
//! `standard_patterns.rs`.

use std::ops::Range;

use regex::{Captures, Regex, RegexBuilder};

use super::name_facts::NameFacts;
use super::row_role::RowRole;
use crate::dataset::physics_parameter::ParameterChange;
use crate::message_text::{quoted, sanitized, shortened};

/// Maximum pattern length \[bytes\].
const LONGEST_PATTERN: usize = 1000;
/// Maximum memory for a compiled pattern \[bytes\].
const MOST_MEMORY: usize = 1 << 20;

/// Permitted group names, apart from trim offsets.
const GROUPS: [&str; 14] = [
    "condition",
    "airspeed_kt",
    "altitude",
    "altitude_ft",
    "weight",
    "mass_kg",
    "method",
    "name",
    "nominal",
    "perturbed",
    "identified",
    PARAMETER,
    DELTA,
    DELTA_UNIT,
];
/// Group name for a moved parameter.
const PARAMETER: &str = "parameter";
/// Group name for a moved parameter's signed change.
const DELTA: &str = "delta";
/// Group name for the unit of a moved parameter's change.
const DELTA_UNIT: &str = "delta_unit";
/// Prefix for the group names of trim offsets.
const OFFSET: &str = "by_";

/// A pattern for names: a regular expression whose named groups identify values.
///
/// | group | holds |
/// |---|---|
/// | `condition`, `airspeed_kt`, `altitude`, `altitude_ft` | the value of the field with the same name |
/// | `weight`, `mass_kg`, `method`, `name` | the value of the field with the same name |
/// | `by_roll_deg`, `by_...` | trim offset in `roll_deg`, ... (`+5`, `-5`, `p5`, `m5`) |
/// | `nominal`, `perturbed`, `identified` | any text; the model has the role after which the group is named |
/// | `parameter`, `delta`, `delta_unit` | name, change and unit of a parameter moved in a run (`Ixx`, `+5`, `%`); without a unit, "1" |
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
        /// Message from the regular-expression parser.
        reason: String,
    },
    #[error(
        "{}: unknown group {}; known groups are {}, and by_ followed by a coordinate, as in \
        by_roll_deg",
        quoted(pattern),
        quoted(group),
        GROUPS.join(", ")
    )]
    Group { pattern: String, group: String },
}

impl PatternError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Syntax { .. } => "pattern-syntax",
            Self::Group { .. } => "pattern-group",
        }
    }
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
                reason: format!("longer than {LONGEST_PATTERN} bytes"),
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

    /// Returns the pattern as text.
    pub fn as_str(&self) -> &str {
        self.regex.as_str()
    }

    /// Fills the empty fields in `facts` with the values in a name; if several parts match, the
    /// first applies.
    pub fn read(&self, name: &str, facts: &mut NameFacts) {
        for found in self.regex.captures_iter(name) {
            for group in self.regex.capture_names().flatten() {
                if let Some(text) = found.name(group) {
                    put_if_empty(group, text.as_str(), facts);
                }
            }
            if facts.parameter.is_none() {
                facts.parameter = parameter_change(&found);
            }
        }
    }
}

impl PartialEq for NamePattern {
    fn eq(&self, other: &Self) -> bool {
        self.as_str() == other.as_str()
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

/// Returns a parser message's last line, which states the reason; the lines before it quote the
/// pattern.
fn last_line(message: &str) -> String {
    message.lines().last().unwrap_or_default().trim().to_owned()
}

fn is_known_group(name: &str) -> bool {
    name.starts_with(OFFSET) || GROUPS.contains(&name)
}

/// Returns those parts of a name that look like a trim offset ("dPHI+5") but match no pattern.
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

/// Sets the field named by a group to the group's text, unless the field already has a value. The
/// groups `nominal`, `perturbed` and `identified` set the role, whatever their text.
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

/// Returns the parameter change in a match: a name and a signed number; `None` if either is
/// missing, or the number is zero.
fn parameter_change(found: &Captures<'_>) -> Option<ParameterChange> {
    let name = found.name(PARAMETER)?.as_str();
    let delta = parse_offset(found.name(DELTA)?.as_str())?;
    if delta == 0.0 {
        return None;
    }
    let unit = match found.name(DELTA_UNIT).map(|unit| unit.as_str()) {
        Some("pct" | "percent") => "%",
        Some(unit) => unit,
        None => "1",
    };
    Some(ParameterChange {
        name: name.to_owned(),
        delta,
        unit: unit.to_owned(),
    })
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
