//! Labels in a dataset or a study (format, version, condition ids, model names), read without the
//! rest of the text and even if the text has an error. Messages use them to name places.
//!
//! The parser emits an event for each key, value and bracket; the steps (keys and list indices) to
//! the present value tell whether it is a label.

use std::collections::BTreeMap;

use json_event_parser::{JsonEvent, SliceJsonParser};

use gdcm_model::message_text::{quoted, sanitized, shortened};

use crate::json_path::{CONDITIONS, Step};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget};

/// Maximum number of labelled conditions and models, so that an outline takes no more memory than a
/// dataset.
const MOST_LABELS: usize = 50_000;
/// Nesting depth of lists and objects at which reading ends; labels are nested far less deeply.
const DEEPEST: usize = 100;

/// Labels in a file, with which messages name places in it. If the text has an error, the labels
/// after it are missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline {
    /// Value for "format", as messages state it: a string in quotation marks, a number, or only the
    /// type.
    pub(super) format: Option<String>,
    /// Value for "version", in the same form.
    pub(super) version: Option<String>,
    /// Condition ids, by condition index.
    ids: BTreeMap<usize, i64>,
    names: BTreeMap<ModelIndex, String>,
}

/// A model's position in a file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ModelIndex {
    condition: usize,
    /// Bundle key in the condition.
    bundle: String,
    /// Model index in the bundle.
    model: usize,
}

impl Outline {
    /// Collects all labels up to the first error in the text.
    pub(super) fn read(text: &[u8]) -> Self {
        Self::read_until(text, |outline| {
            outline.ids.len() + outline.names.len() >= MOST_LABELS
        })
    }

    /// Returns a file's "format". Reads no further than that, and stops when the budget is
    /// exhausted.
    pub(super) fn format_of(text: &[u8], budget: &ReadingBudget<'_>) -> Option<String> {
        let outline = Self::read_until(text, |outline| {
            outline.format.is_some() || budget.work(0, NO_VARIABLE).is_err()
        });
        outline.format
    }

    /// Returns a file's "format" and "version". Reads no further than these, and stops when the
    /// budget is exhausted.
    pub(super) fn format_and_version(
        text: &[u8],
        budget: &ReadingBudget<'_>,
    ) -> (Option<String>, Option<String>) {
        let outline = Self::read_until(text, |outline| {
            let is_complete = outline.format.is_some() && outline.version.is_some();
            is_complete || budget.work(0, NO_VARIABLE).is_err()
        });
        (outline.format, outline.version)
    }

    /// Returns a condition's id, given its index.
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
        // Path to the next value. A list pushes its entry 0, an object an empty key, which each of
        // its keys replaces.
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

/// Describes a value: a string in quotation marks, a number's digits, only the type for a list or
/// an object.
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

#[cfg(test)]
mod tests {
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
