//! Typed rules: names, signs, units and factors by channel.

use std::collections::BTreeMap;

use gdcm_model::assembly::declarations::Signs;
use gdcm_model::units::number;

use crate::gui::widgets::number_entry::typed_number;

/// Returns the trimmed text; `None` if it is empty.
pub(super) fn typed_text(text: &str) -> Option<String> {
    let text = text.trim();
    if text.is_empty() {
        None
    } else {
        Some(text.to_owned())
    }
}

/// Parses "LON, LAT, PED, COL"; `None` for an empty text.
pub(super) fn typed_names(text: &str) -> Option<Vec<String>> {
    let names = typed_text(text)?;
    Some(
        names
            .split(',')
            .map(|name| name.trim().to_owned())
            .collect(),
    )
}

/// Parses "NZ -1, R 1": channels and their signs.
pub(super) fn typed_signs(text: &str) -> Result<Signs, String> {
    let signs = numbers_by_name(text, "a channel and 1 or -1 as in \"NZ -1\"")?;
    for (channel, sign) in &signs {
        if sign.abs() != 1.0 {
            return Err(format!(
                "expected 1 or -1 as the sign of {channel}, found {}",
                number(*sign)
            ));
        }
    }
    Ok(signs)
}

/// Parses "LON 8, NZ -9.81": channels and their factors.
pub(super) fn typed_factors(text: &str) -> Result<BTreeMap<String, f64>, String> {
    let factors = numbers_by_name(text, "a channel and a number other than 0 as in \"LON 8\"")?;
    for (channel, factor) in &factors {
        if *factor == 0.0 {
            return Err(format!(
                "expected a number other than 0 as the factor of {channel}, found 0"
            ));
        }
    }
    Ok(factors)
}

/// Parses "LON in, Q rad/s": channels and their units in the files.
pub(super) fn typed_units(text: &str) -> Result<BTreeMap<String, String>, String> {
    let mut units = BTreeMap::new();
    for part in comma_separated(text) {
        let Some((channel, unit)) = part.rsplit_once(' ') else {
            return Err(format!(
                "expected a channel and its unit as in \"LON in\", found \"{part}\""
            ));
        };
        units.insert(channel.trim().to_owned(), unit.to_owned());
    }
    Ok(units)
}

/// Parses "roll_deg 5, airspeed_kt -10": coordinates and their offsets from trim.
pub(super) fn typed_trim(text: &str) -> Result<BTreeMap<String, f64>, String> {
    numbers_by_name(text, "a coordinate and a number as in \"roll_deg 5\"")
}

/// Parses pairs such as "LON 8"; `expected` describes such a pair in the error message.
fn numbers_by_name(text: &str, expected: &str) -> Result<BTreeMap<String, f64>, String> {
    let mut numbers = BTreeMap::new();
    for part in comma_separated(text) {
        let wrong = || format!("expected {expected}, found \"{part}\"");
        let (name, value) = part.rsplit_once(' ').ok_or_else(wrong)?;
        let value = typed_number(value)
            .map_err(|refusal| refusal.text)?
            .ok_or_else(wrong)?;
        numbers.insert(name.trim().to_owned(), value);
    }
    Ok(numbers)
}

/// Returns the trimmed parts between commas, without empty parts.
fn comma_separated(text: &str) -> impl Iterator<Item = &str> {
    text.split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
}

/// Writes numbers as [`typed_trim`], [`typed_signs`] and [`typed_factors`] parse them.
pub(super) fn number_text(numbers: &BTreeMap<String, f64>) -> String {
    numbers
        .iter()
        .map(|(name, value)| format!("{name} {}", number(*value)))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Writes units as [`typed_units`] parses them.
pub(super) fn unit_text(units: &BTreeMap<String, String>) -> String {
    units
        .iter()
        .map(|(channel, unit)| format!("{channel} {unit}"))
        .collect::<Vec<_>>()
        .join(", ")
}
