//! Locations in a JSON text, described in terms familiar to engineers. A *step* is a key or a list
//! index on the path from the top level to a value.

use std::collections::BTreeMap;

use serde_json::value::RawValue;

use gdcm_model::dataset::BundleKind;
use gdcm_model::dataset::location::{ConditionPlace, Location, ModelPlace};
use gdcm_model::message_text::{sanitized, shortened};

use crate::json_outline::Outline;
use crate::json_path::{CONDITIONS, IDENTIFIED_MODELS, PHYSICS_MODELS, Step};

/// Returns the location to which `steps` lead, with the labels in `outline`.
pub(super) fn location_of(steps: &[Step], outline: &Outline) -> Location {
    let mut location = Location::default();
    let mut rest = steps;
    if let [Step::Key(key), Step::Entry(condition), after @ ..] = rest
        && key == CONDITIONS
    {
        location.condition = Some(ConditionPlace {
            position: condition + 1,
            id: outline.id(*condition),
        });
        rest = after;
        if let [Step::Key(key), Step::Entry(model), after @ ..] = rest
            && let Some(bundle) = bundle_with_key(key)
        {
            location.model = Some(ModelPlace {
                bundle,
                position: model + 1,
                name: outline.name(*condition, key, *model),
            });
            rest = after;
        }
    }
    location.entry = entry_words(rest);
    location
}

/// Returns the bundle kind that a condition stores under a key; `None` for other keys.
fn bundle_with_key(key: &str) -> Option<BundleKind> {
    match key {
        PHYSICS_MODELS => Some(BundleKind::Physics),
        IDENTIFIED_MODELS => Some(BundleKind::Identified),
        _ => None,
    }
}

/// Returns the key under which a condition stores a bundle.
fn bundle_key(bundle: BundleKind) -> &'static str {
    match bundle {
        BundleKind::Physics => PHYSICS_MODELS,
        BundleKind::Identified => IDENTIFIED_MODELS,
    }
}

/// Describes steps: `A[2][0]` is "matrix A, row 3, column 1", `re[0][1][4]` is "re, output 1, input
/// 2, entry 5".
fn entry_words(steps: &[Step]) -> String {
    let mut words: Vec<String> = Vec::new();
    // Names for the indices that follow.
    let mut index_names: &[&str] = &[];
    for step in steps {
        match step {
            Step::Key(key) => {
                let name = shortened(&sanitized(key));
                if is_matrix(key) {
                    words.push(format!("matrix {name}"));
                    index_names = &["row", "column"];
                } else {
                    words.push(name);
                    index_names = if is_response_table(key) {
                        &["output", "input"]
                    } else {
                        &[]
                    };
                }
            }
            Step::Entry(index) => {
                let name = index_names.first().unwrap_or(&"entry");
                words.push(format!("{name} {}", index + 1));
                index_names = index_names.get(1..).unwrap_or_default();
            }
        }
    }
    words.join(", ")
}

/// Returns whether a key holds a state-space matrix.
fn is_matrix(key: &str) -> bool {
    matches!(key, "A" | "B" | "C" | "D")
}

/// Returns whether a key holds values for each output and input.
fn is_response_table(key: &str) -> bool {
    matches!(
        key,
        "re" | "im" | "coherence" | "valid_band_rad_s" | "sd_db" | "sd_deg"
    )
}

/// Returns the line at which the condition or the model named by `place` begins, counted from 1;
/// `None` if `place` names no condition, or if it cannot be found.
pub(super) fn line_of(text: &[u8], place: &Location) -> Option<usize> {
    let condition = place.condition.as_ref()?;
    let mut value = entry(
        serde_json::from_slice(text).ok()?,
        CONDITIONS,
        condition.position,
    )?;
    if let Some(model) = &place.model {
        value = entry(value, bundle_key(model.bundle), model.position)?;
    }
    // The raw value is a slice of the text.
    let offset = value.get().as_ptr() as usize - text.as_ptr() as usize;
    Some(1 + text[..offset].iter().filter(|byte| **byte == b'\n').count())
}

/// Returns an entry from the list under `key`; `position` is counted from 1.
fn entry<'t>(object: &'t RawValue, key: &str, position: usize) -> Option<&'t RawValue> {
    let object: BTreeMap<String, &RawValue> = serde_json::from_str(object.get()).ok()?;
    let list: Vec<&RawValue> = serde_json::from_str(object.get(key)?.get()).ok()?;
    list.get(position.checked_sub(1)?).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(path: &[&str]) -> Vec<Step> {
        path.iter()
            .map(|step| {
                step.parse()
                    .map_or(Step::Key((*step).to_owned()), Step::Entry)
            })
            .collect()
    }

    #[test]
    fn a_place_is_named_by_id_name_matrix_row_and_column() {
        let outline = Outline::read(
            br#"{"conditions": [{"id": 10, "physics_models": [{"name": "nominal"}]}]}"#,
        );
        let place = location_of(
            &steps(&["conditions", "0", "physics_models", "0", "A", "2", "4"]),
            &outline,
        );
        let expected = "condition 10 (number 1 in the file), physics model \"nominal\" (number 1), matrix A, row 3, column 5";
        assert_eq!(place.to_string(), expected);
    }

    #[test]
    fn places_without_labels_are_numbered() {
        let path = steps(&[
            "conditions",
            "2",
            "identified_models",
            "1",
            "frequency_response",
            "re",
            "0",
            "1",
            "4",
        ]);
        let place = location_of(&path, &Outline::default());
        let expected = "condition at position 3 in the file, identified model number 2, frequency_response, re, output 1, input 2, entry 5";
        assert_eq!(place.to_string(), expected);
    }
}
