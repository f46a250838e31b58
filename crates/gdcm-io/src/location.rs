//! Locations in a JSON text, described in terms familiar to engineers.

use std::collections::BTreeMap;

use json_event_parser::{JsonEvent, SliceJsonParser};
use serde_json::value::RawValue;

use gdcm_model::dataset::BundleKind;
use gdcm_model::dataset::location::{ConditionPlace, Location, ModelPlace};
use gdcm_model::message_text::{quoted, sanitized, shortened};

use crate::reading_budget::ReadingBudget;

/// A step on the path from the top level of a JSON text to a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// To the value under this key of an object.
    Key(String),
    /// To the entry of a list with this index, counted from 0.
    Entry(usize),
}

const CONDITIONS: &str = "conditions";
const PHYSICS_MODELS: &str = "physics_models";
const IDENTIFIED_MODELS: &str = "identified_models";

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

/// Returns the kind of bundle that a condition stores under a key; `None` for other keys.
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
pub(super) fn entry_words(steps: &[Step]) -> String {
    let mut words: Vec<String> = Vec::new();
    // Names of the indices that follow.
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

/// Whether a key holds a state-space matrix.
fn is_matrix(key: &str) -> bool {
    matches!(key, "A" | "B" | "C" | "D")
}

/// Whether a key holds values for each output and input.
fn is_response_table(key: &str) -> bool {
    matches!(
        key,
        "re" | "im" | "coherence" | "valid_band_rad_s" | "sd_db" | "sd_deg"
    )
}

/// Maximum number of labelled conditions and models, so that an outline takes no more memory than a
/// dataset.
const MOST_LABELS: usize = 50_000;
/// Maximum nesting depth of lists and objects; labels are nested far less deeply.
const DEEPEST: usize = 100;

/// Labels in a file, with which messages name places in it. If the text has an error, the labels
/// after it are missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline {
    /// Value of "format" as stated in messages: a string in quotation marks, a number, or only the
    /// type.
    pub(super) format: Option<String>,
    /// Value of "version", in the same form.
    pub(super) version: Option<String>,
    /// Condition ids, by condition index.
    ids: BTreeMap<usize, i64>,
    names: BTreeMap<ModelIndex, String>,
}

/// Position of a model in a file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ModelIndex {
    condition: usize,
    /// Key of the bundle in the condition.
    bundle: String,
    /// Index of the model in the bundle.
    model: usize,
}

impl Outline {
    /// Collects all labels up to the first error in the text.
    pub(super) fn read(text: &[u8]) -> Self {
        Self::read_until(text, |outline| {
            outline.ids.len() + outline.names.len() >= MOST_LABELS
        })
    }

    /// Returns the value of "format" in a file. Reads no further than that, and stops when the
    /// budget is exhausted.
    pub(super) fn format_of(text: &[u8], budget: &ReadingBudget<'_>) -> Option<String> {
        let outline = Self::read_until(text, |outline| {
            outline.format.is_some() || budget.work(0, "").is_err()
        });
        outline.format
    }

    /// Returns the values of "format" and "version" in a file. Reads no further than these, and
    /// stops when the budget is exhausted.
    pub(super) fn format_and_version(
        text: &[u8],
        budget: &ReadingBudget<'_>,
    ) -> (Option<String>, Option<String>) {
        let outline = Self::read_until(text, |outline| {
            let is_complete = outline.format.is_some() && outline.version.is_some();
            is_complete || budget.work(0, "").is_err()
        });
        (outline.format, outline.version)
    }

    /// Returns the id of a condition, given its index.
    pub(super) fn id(&self, condition: usize) -> Option<i64> {
        self.ids.get(&condition).copied()
    }

    /// Returns a model name, by condition index, bundle key, and index in the bundle.
    pub(super) fn name(&self, condition: usize, bundle: &str, model: usize) -> Option<String> {
        let index = ModelIndex {
            condition,
            bundle: bundle.to_owned(),
            model,
        };
        self.names.get(&index).cloned()
    }

    /// Reads until `is_enough`; an error ends the outline, and is reported when the content is
    /// read.
    fn read_until(text: &[u8], is_enough: impl Fn(&Self) -> bool) -> Self {
        let mut outline = Self::default();
        let mut parser = SliceJsonParser::new(text);
        let mut steps: Vec<Step> = Vec::new();
        while let Ok(event) = parser.parse_next()
            && steps.len() < DEEPEST
            && !is_enough(&outline)
        {
            match event {
                JsonEvent::Eof => break,
                JsonEvent::ObjectKey(key) => {
                    steps.pop();
                    steps.push(Step::Key(key.into_owned()));
                }
                JsonEvent::StartArray => {
                    outline.note(&steps, &event);
                    steps.push(Step::Entry(0));
                }
                JsonEvent::StartObject => {
                    outline.note(&steps, &event);
                    steps.push(Step::Key(String::new()));
                }
                JsonEvent::EndArray | JsonEvent::EndObject => {
                    steps.pop();
                    end_value(&mut steps);
                }
                _ => {
                    outline.note(&steps, &event);
                    end_value(&mut steps);
                }
            }
        }
        outline
    }

    /// Stores a value if it is a label: an id, a name, the format or the version.
    fn note(&mut self, steps: &[Step], value: &JsonEvent<'_>) {
        match steps {
            [Step::Key(key)] => match key.as_str() {
                "format" => self.format = Some(words(value)),
                "version" => self.version = Some(words(value)),
                _ => {}
            },
            [Step::Key(list), Step::Entry(condition), Step::Key(key)] => {
                if list == CONDITIONS
                    && key == "id"
                    && let JsonEvent::Number(id) = value
                    && let Ok(id) = id.parse()
                {
                    self.ids.insert(*condition, id);
                }
            }
            [
                Step::Key(list),
                Step::Entry(condition),
                Step::Key(bundle),
                Step::Entry(model),
                Step::Key(key),
            ] => {
                if list == CONDITIONS
                    && key == "name"
                    && let JsonEvent::String(name) = value
                {
                    let index = ModelIndex {
                        condition: *condition,
                        bundle: bundle.clone(),
                        model: *model,
                    };
                    self.names.insert(index, name.to_string());
                }
            }
            _ => {}
        }
    }
}

/// Moves to the next entry if the value that has just ended is in a list.
fn end_value(steps: &mut [Step]) {
    if let Some(Step::Entry(index)) = steps.last_mut() {
        *index += 1;
    }
}

/// Describes a value: a string in quotation marks, the digits of a number, only the type of a list
/// or an object.
fn words(value: &JsonEvent<'_>) -> String {
    match value {
        JsonEvent::String(text) => quoted(text),
        JsonEvent::Number(digits) => shortened(&sanitized(digits)),
        JsonEvent::Boolean(value) => value.to_string(),
        JsonEvent::StartArray => "a list".to_owned(),
        JsonEvent::StartObject => "an object".to_owned(),
        _ => "null".to_owned(),
    }
}

/// Maximum number of keys reported individually: a file with more was written by another program,
/// or was made to fill the memory.
const MOST_KEYS: usize = 50;

/// Keys unknown to the program; keys whose paths differ only in indices are counted together.
#[derive(Debug, Default)]
pub(super) struct UnknownKeys {
    /// First occurrence and count, for each path of keys without the indices.
    found: BTreeMap<Vec<String>, UnknownKey>,
    /// Number of further keys, which are only counted because there are too many.
    beyond: usize,
}

/// A key that the program does not know, or an entry that it does not use.
#[derive(Debug)]
struct UnknownKey {
    /// Path to the first such key.
    steps: Vec<Step>,
    count: usize,
}

impl UnknownKeys {
    /// Adds the path of a key or an entry that serde has skipped.
    pub(super) fn add(&mut self, path: &serde_ignored::Path<'_>) {
        let mut steps = Vec::new();
        collect_steps(path, &mut steps);
        let mut keys = Vec::new();
        for step in &steps {
            if let Step::Key(key) = step {
                keys.push(key.clone());
            }
        }
        if let Some(known) = self.found.get_mut(&keys) {
            known.count += 1;
        } else if self.found.len() == MOST_KEYS {
            self.beyond += 1;
        } else {
            self.found.insert(keys, UnknownKey { steps, count: 1 });
        }
    }

    /// Returns a caution for each unknown key, with its place in the text.
    pub(super) fn cautions(&self, text: &[u8]) -> Vec<String> {
        if self.found.is_empty() {
            return Vec::new();
        }
        let outline = Outline::read(text);
        let mut cautions: Vec<String> = self
            .found
            .values()
            .map(|unknown| unknown.caution(&outline))
            .collect();
        if self.beyond > 0 {
            cautions.push(format!(
                "{} other keys are not known and not used",
                self.beyond
            ));
        }
        cautions
    }
}

impl UnknownKey {
    fn caution(&self, outline: &Outline) -> String {
        let more = if self.count > 1 {
            format!(", and {} more like it", self.count - 1)
        } else {
            String::new()
        };
        match self.steps.split_last() {
            Some((Step::Key(key), parent)) => format!(
                "{}the key {} is not known and not used{more}",
                location_of(parent, outline).before(),
                quoted(key)
            ),
            _ => format!(
                "{}this entry is not known and not used{more}",
                location_of(&self.steps, outline).before()
            ),
        }
    }
}

/// Appends the steps of a path, from the top level on.
fn collect_steps(path: &serde_ignored::Path<'_>, steps: &mut Vec<Step>) {
    use serde_ignored::Path as Ignored;
    let (parent, step) = match path {
        Ignored::Root => return,
        Ignored::Seq { parent, index } => (parent, Some(Step::Entry(*index))),
        Ignored::Map { parent, key } => (parent, Some(Step::Key(key.clone()))),
        Ignored::Some { parent }
        | Ignored::NewtypeStruct { parent }
        | Ignored::NewtypeVariant { parent } => (parent, None),
    };
    collect_steps(parent, steps);
    steps.extend(step);
}

/// Returns the line at which the condition or the model in a place begins, counted from 1.
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
    let offset = value.get().as_ptr() as usize - text.as_ptr() as usize;
    Some(1 + text[..offset].iter().filter(|byte| **byte == b'\n').count())
}

/// Returns an entry of the list under `key` in an object; `position` is counted from 1.
pub(super) fn entry<'t>(object: &'t RawValue, key: &str, position: usize) -> Option<&'t RawValue> {
    let object: BTreeMap<String, &RawValue> = serde_json::from_str(object.get()).ok()?;
    let list: Vec<&RawValue> = serde_json::from_str(object.get(key)?.get()).ok()?;
    list.get(position.checked_sub(1)?).copied()
}

#[cfg(test)]
mod place_tests {
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
        let expected = "condition number 3 in the file, identified model number 2, frequency_response, re, output 1, input 2, entry 5";
        assert_eq!(place.to_string(), expected);
    }
}

#[cfg(test)]
mod outline_tests {
    use super::*;

    #[test]
    fn labels_before_an_error_in_the_text_are_kept() {
        let text = br#"{"format": "gdcm-dataset", "version": 1, "conditions": [{}, {"deep": [[[], {}], 1], "id": 7,
            "physics_models": [{"name": "nominal", "A": [[1]]}, {"A": [], "name": "V+5kt", "A": [[NaN"#;
        let outline = Outline::read(text);
        let name = |model| outline.name(1, "physics_models", model);
        assert_eq!((outline.id(0), outline.id(1)), (None, Some(7)));
        assert_eq!(
            (name(0).as_deref(), name(1).as_deref(), name(2)),
            (Some("nominal"), Some("V+5kt"), None)
        );
        assert_eq!(
            (outline.format.as_deref(), outline.version.as_deref()),
            (Some("\"gdcm-dataset\""), Some("1"))
        );
    }

    #[test]
    fn the_format_is_read_without_the_rest() {
        let format_of = |text: &[u8]| Outline::format_of(text, &ReadingBudget::new(0));
        assert_eq!(
            format_of(br#"{"name": [1], "format": "x", broken"#).as_deref(),
            Some("\"x\"")
        );
        assert_eq!(
            format_of(br#"{"format": [1, 2], broken"#).as_deref(),
            Some("a list")
        );
        assert_eq!(format_of(b"[1, 2]"), None);
    }
}
