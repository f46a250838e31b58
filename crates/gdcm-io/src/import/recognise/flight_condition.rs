//! A model's flight condition and origin, from the fields beside it and in the enclosing records.
//! The condition, with a name that the file gives to the model, is returned as [`Facts`].
//!
//! A quantity may be given as a field (`airspeed_kt`) or in a struct (`trim.airspeed_kt`), beside
//! the model or in a [`Record`] (a group of fields) that encloses it. A list beside an array of
//! models has an entry for each.

use std::collections::BTreeMap;

use gdcm_model::assembly::found_model::Facts;
use gdcm_model::dataset::model::Origin;
use gdcm_model::names::RowRole;

use super::recognition_fault::RecognitionFault;
use super::record::Record;
use super::values::{array_of, scalar_of, texts_of};
use crate::formats::variables::Value;

const CONDITIONS: &[&str] = &["condition", "condition_id", "fc"];
const AIRSPEEDS: &[&str] = &["airspeed_kt", "V_kt", "airspeed_knots", "speed_kt", "KTAS"];
const ALTITUDES: &[&str] = &["altitude_ft", "alt_ft", "h_ft"];
const MASSES: &[&str] = &["mass_kg", "m_kg"];
/// Names of the structs that may hold a flight condition.
const CONDITION_STRUCTS: [&[&str]; 4] = [
    &["trim"],
    &["flight_condition"],
    &["flight_state"],
    &["condition"],
];
/// Struct names for trim offsets by coordinate.
const OFFSETS: &[&str] = &["perturbation", "trim_offset", "trim_offsets"];
/// Prefix for a field with a single trim offset, such as `by_roll_deg`.
const OFFSET_PREFIX: &str = "by_";
/// Limit on the absolute value of a condition id.
const GREATEST_CONDITION: f64 = 1e9;

/// A model's position in an array of models.
#[derive(Clone, Copy, Debug)]
pub(super) struct Page {
    /// Index, counted from 0.
    pub(super) index: usize,
    pub(super) count: usize,
}

impl Page {
    /// Position of a model outside any array.
    pub(super) const ONLY: Self = Self { index: 0, count: 1 };
}

/// Returns the flight condition that is given beside a model and in enclosing records. A condition
/// id that is not a whole number, or too large, is left out.
///
/// # Errors
/// The reason if a list's length differs from the number of models, or a value contradicts an
/// enclosing record.
pub(super) fn facts_of(record: &Record<'_>, page: Page) -> Result<Facts, RecognitionFault> {
    let condition = match quantity(record, CONDITIONS, page)? {
        Some(id) if id.fract() == 0.0 && id.abs() < GREATEST_CONDITION => Some(id as i64),
        _ => None,
    };
    Ok(Facts {
        condition,
        airspeed_kt: quantity(record, AIRSPEEDS, page)?,
        altitude_ft: quantity(record, ALTITUDES, page)?,
        mass_kg: quantity(record, MASSES, page)?,
        name: name_beside(record, page),
        ..Facts::default()
    })
}

/// Returns a quantity of the flight condition, given as a field or inside a struct, beside a model
/// or in an enclosing record; `None` if it is not given. No place has precedence.
///
/// # Errors
/// The reason if different values are given, or a list's length differs from the number of models.
fn quantity(
    record: &Record<'_>,
    names: &[&'static str],
    page: Page,
) -> Result<Option<f64>, RecognitionFault> {
    let mut known: Option<f64> = None;
    for (level, record) in record.with_outer().enumerate() {
        let page = if level == 0 { page } else { Page::ONLY };
        let beside = number_beside(record, names, page)?;
        let inside = number_inside(record, names)?;
        for value in [beside, inside].into_iter().flatten() {
            match known {
                Some(known) if known != value => {
                    return Err(RecognitionFault::Contradiction {
                        name: names[0],
                        values: [known, value],
                    });
                }
                _ => known = Some(value),
            }
        }
    }
    Ok(known)
}

/// Returns the number in a field: a single number applies to all models, and a list has an entry
/// for each. `None` for an empty field, for a list beside a single model, and if the number is not
/// finite.
///
/// # Errors
/// The reason if a list beside several models has another length.
fn number_beside(
    record: &Record<'_>,
    names: &[&str],
    page: Page,
) -> Result<Option<f64>, RecognitionFault> {
    let Some(field) = record.find(names) else {
        return Ok(None);
    };
    let Some(array) = array_of(field.value) else {
        return Ok(None);
    };
    let value = match array.re.as_slice() {
        [value] => *value,
        values if page.count > 1 && values.len() == page.count => values[page.index],
        [] => return Ok(None),
        _ if page.count == 1 => return Ok(None),
        values => {
            return Err(RecognitionFault::NumberForEachModel {
                name: field.name.to_owned(),
                found: values.len(),
                models: page.count,
            });
        }
    };
    if !value.is_finite() {
        return Ok(None);
    }
    record.mark_used(field.name);
    Ok(Some(value))
}

/// Returns a quantity from the first struct in `CONDITION_STRUCTS` that holds it:
/// `trim.airspeed_kt`, `condition.id`. The other fields in that struct are listed as unused.
fn number_inside(record: &Record<'_>, names: &[&str]) -> Result<Option<f64>, RecognitionFault> {
    for keys in CONDITION_STRUCTS {
        let Some(field) = record.find(keys) else {
            continue;
        };
        let Value::Struct(records) = field.value else {
            continue;
        };
        let inner = Record::from_struct(records, 0);
        let mut value = number_beside(&inner, names, Page::ONLY)?;
        if value.is_none() && names == CONDITIONS && keys != ["trim"] {
            value = number_beside(&inner, &["id"], Page::ONLY)?;
        }
        if value.is_none() {
            continue;
        }
        if !record.is_used(field.name) {
            record.mark_used(field.name);
            for other in inner.fields() {
                if !is_fact_name(other.name) {
                    record.note_unused_inside(format!("{}.{}", field.name, other.name));
                }
            }
        }
        return Ok(value);
    }
    Ok(None)
}

/// Returns whether [`number_inside`] reads a field with this name.
fn is_fact_name(name: &str) -> bool {
    name == "id"
        || [AIRSPEEDS, ALTITUDES, MASSES, CONDITIONS]
            .iter()
            .any(|names| names.contains(&name))
}

/// Returns the name given beside a model, or its entry in a list of names. A single name beside
/// several models is ignored, and so are names in a record that several models share.
fn name_beside(record: &Record<'_>, page: Page) -> Option<String> {
    if record.is_shared {
        return None;
    }
    let field = record.find(&["name"])?;
    let texts = texts_of(field.value)?;
    let name = match texts.as_slice() {
        [name] if page.count == 1 => name,
        names if page.count > 1 && names.len() == page.count => &names[page.index],
        _ => return None,
    };
    if name.is_empty() {
        return None;
    }
    record.mark_used(field.name);
    Some(name.clone())
}

/// Returns the origin of a model (role, trim offsets, identification method) from its record and
/// the enclosing records. Without a role, objects of MATLAB's `id…` classes are identified models
/// and all others perturbed physics models.
pub(super) fn origin_of(record: &Record<'_>) -> Origin {
    let role = match text_beside(record, "role") {
        Some(word) => RowRole::from_word(&word.to_lowercase()),
        None => None,
    };
    let is_identified = record.class.is_some_and(|class| class.starts_with("id"));
    let offsets = offsets_of(record);
    let perturbation = if offsets.is_empty() {
        None
    } else {
        Some(offsets)
    };
    match role {
        Some(RowRole::Nominal) => Origin::Nominal { perturbation },
        Some(RowRole::Perturbed) => Origin::Perturbed { perturbation },
        None if !is_identified => Origin::Perturbed { perturbation },
        Some(RowRole::Identified) | None => Origin::Identified {
            method: text_beside(record, "method"),
            order: None,
        },
    }
}

/// Returns the string under `key` in the innermost record that has one.
fn text_beside(record: &Record<'_>, key: &str) -> Option<String> {
    for record in record.with_outer() {
        let Some(field) = record.find(&[key]) else {
            continue;
        };
        if let Some([text]) = texts_of(field.value).as_deref() {
            record.mark_used(field.name);
            return Some(text.clone());
        }
    }
    None
}

/// Returns the trim offsets by coordinate; an inner record takes precedence over an outer one.
fn offsets_of(record: &Record<'_>) -> BTreeMap<String, f64> {
    let mut offsets = BTreeMap::new();
    for record in record.with_outer() {
        for field in record.fields() {
            if let Some(coordinate) = field.name.strip_prefix(OFFSET_PREFIX)
                && let Some(offset) = scalar_of(field.value)
            {
                record.mark_used(field.name);
                offsets.entry(coordinate.to_owned()).or_insert(offset);
            }
        }
        let Some(field) = record.find(OFFSETS) else {
            continue;
        };
        let Value::Struct(records) = field.value else {
            continue;
        };
        record.mark_used(field.name);
        let inner = Record::from_struct(records, 0);
        for coordinate in inner.fields() {
            match scalar_of(coordinate.value) {
                Some(offset) => {
                    offsets.entry(coordinate.name.to_owned()).or_insert(offset);
                }
                None => record.note_unused_inside(format!("{}.{}", field.name, coordinate.name)),
            }
        }
    }
    offsets
}
