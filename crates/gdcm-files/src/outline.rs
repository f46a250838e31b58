//! What a file calls itself, its conditions and its models, as far as it can be read at all.

use std::collections::BTreeMap;

use json_event_parser::{JsonEvent, SliceJsonParser};

use super::place::Step;
use gdcm_core::message_text::{quoted, sanitized, shortened};

/// Most conditions and models that are labelled, so that an outline takes no more memory than a dataset.
const MOST_LABELS: usize = 50_000;
/// Most lists and objects inside one another; labels stand far above that.
const DEEPEST: usize = 100;

/// The labels of a file, for naming places in it; whatever stands behind an error in the text is missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline {
    /// What stands at "format": text, or the kind of thing that is not text.
    pub(super) format: Option<String>,
    /// What stands at "version".
    pub(super) version: Option<String>,
    /// Ids of conditions.
    ids: BTreeMap<usize, i64>,
    /// Names of models: by the index of their condition, the key of their bundle, and their index in it.
    names: BTreeMap<(usize, String, usize), String>,
}

impl Outline {
    /// Every label that can be read before the text ends or breaks.
    pub(super) fn of(text: &[u8]) -> Self {
        Self::read(text, |outline| outline.ids.len() + outline.names.len() >= MOST_LABELS)
    }

    /// The outline of a file whose format and version are known, and nothing else.
    pub(super) fn named(format: &str, version: u64) -> Self {
        Self { format: Some(quoted(format)), version: Some(version.to_string()), ..Self::default() }
    }

    /// What the file calls its format; reads no further than that.
    pub(super) fn format_of(text: &[u8]) -> Option<String> {
        Self::read(text, |outline| outline.format.is_some()).format
    }

    /// The id of a condition, by index.
    pub(super) fn id(&self, condition: usize) -> Option<i64> {
        self.ids.get(&condition).copied()
    }

    /// The name of a model, by the index of its condition, the key of its bundle, and its index in it.
    pub(super) fn name(&self, condition: usize, bundle: &str, model: usize) -> Option<String> {
        self.names.get(&(condition, bundle.to_owned(), model)).cloned()
    }

    /// An error ends the outline; it is found again, and told, by the reader proper.
    fn read(text: &[u8], enough: impl Fn(&Self) -> bool) -> Self {
        let mut outline = Self::default();
        let mut parser = SliceJsonParser::new(text);
        let mut steps: Vec<Step> = Vec::new();
        while let Ok(event) = parser.parse_next()
            && steps.len() < DEEPEST
            && !enough(&outline)
        {
            match event {
                JsonEvent::Eof => break,
                JsonEvent::ObjectKey(key) => {
                    steps.pop();
                    steps.push(Step::Key(key.into_owned()));
                    continue;
                }
                JsonEvent::EndArray | JsonEvent::EndObject => drop(steps.pop()),
                _ => outline.note(&steps, &event),
            }
            match event {
                JsonEvent::StartArray => steps.push(Step::Entry(0)),
                JsonEvent::StartObject => steps.push(Step::Key(String::new())),
                _ => {
                    if let Some(Step::Entry(index)) = steps.last_mut() {
                        *index += 1;
                    }
                }
            }
        }
        outline
    }

    /// Takes a value for a label, if that is what it is.
    fn note(&mut self, steps: &[Step], value: &JsonEvent<'_>) {
        match (steps, value) {
            ([Step::Key(key)], _) if key == "format" => self.format = Some(words(value)),
            ([Step::Key(key)], _) if key == "version" => self.version = Some(words(value)),
            ([Step::Key(list), Step::Entry(condition), Step::Key(key)], JsonEvent::Number(id))
                if list == "conditions" && key == "id" =>
            {
                self.ids.extend(id.parse().ok().map(|id| (*condition, id)));
            }
            (
                [Step::Key(list), Step::Entry(condition), Step::Key(bundle), Step::Entry(model), Step::Key(key)],
                JsonEvent::String(name),
            ) if list == "conditions" && key == "name" => {
                self.names.insert((*condition, bundle.clone(), *model), name.to_string());
            }
            _ => {}
        }
    }
}

/// A value in words: a text in quotation marks, a number as it stands, of a list or an object only that it is one.
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
    fn labels_before_a_break_in_the_text_are_kept() {
        let text = br#"{"format": "gdcm-dataset", "version": 1, "conditions": [{}, {"deep": [[[], {}], 1], "id": 7,
            "physics_models": [{"name": "nominal", "A": [[1]]}, {"A": [], "name": "V+5kt", "A": [[NaN"#;
        let outline = Outline::of(text);
        let name = |model| outline.name(1, "physics_models", model);
        assert_eq!((outline.id(0), outline.id(1)), (None, Some(7)));
        assert_eq!((name(0).as_deref(), name(1).as_deref(), name(2)), (Some("nominal"), Some("V+5kt"), None));
        assert_eq!((outline.format.as_deref(), outline.version.as_deref()), (Some("\"gdcm-dataset\""), Some("1")));
    }

    #[test]
    fn the_format_is_read_without_reading_on() {
        assert_eq!(Outline::format_of(br#"{"name": [1], "format": "x", broken"#).as_deref(), Some("\"x\""));
        assert_eq!(Outline::format_of(br#"{"format": [1, 2], broken"#).as_deref(), Some("a list"));
        assert_eq!(Outline::format_of(b"[1, 2]"), None);
    }
}
