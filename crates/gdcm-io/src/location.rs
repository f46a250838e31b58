//! Locations in a file, in the engineer's words.

use std::collections::BTreeMap;

use json_event_parser::{JsonEvent, SliceJsonParser};
use serde_json::value::RawValue;

use gdcm_model::dataset::BundleKind;
use gdcm_model::dataset::location::{ConditionPlace, Location, ModelPlace};
use gdcm_model::message_text::{quoted, sanitized, shortened};

use crate::reading_budget::ReadingBudget;

/// A step on the path from the top of a JSON text to a value in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Into an object, to this key.
    Key(String),
    /// Into a list, to this entry, counted from 0.
    Entry(usize),
}

/// Returns the location at the end of these steps.
pub(super) fn location_of(steps: &[Step], outline: &Outline) -> Location {
    let mut place = Location::default();
    let mut rest = steps;
    if let [Step::Key(key), Step::Entry(index), after @ ..] = rest
        && key == "conditions"
    {
        place.condition = Some(ConditionPlace {
            position: index + 1,
            id: outline.id(*index),
        });
        rest = after;
        if let [Step::Key(key), Step::Entry(model), after @ ..] = rest
            && let Some(bundle) = bundle_of(key)
        {
            let name = outline.name(*index, key, *model);
            place.model = Some(ModelPlace {
                bundle,
                position: model + 1,
                name,
            });
            rest = after;
        }
    }
    place.entry = entry_words(rest);
    place
}

fn bundle_of(key: &str) -> Option<BundleKind> {
    match key {
        "physics_models" => Some(BundleKind::Physics),
        "identified_models" => Some(BundleKind::Identified),
        _ => None,
    }
}

/// Describes steps: `A[2][0]` is "matrix A, row 3, column 1", `re[0][1][4]` is "re, output 1, input
/// 2, entry 5".
pub(super) fn entry_words(steps: &[Step]) -> String {
    let mut words: Vec<String> = Vec::new();
    let mut indices: &[&str] = &[];
    for step in steps {
        match step {
            Step::Key(key) => {
                indices = match key.as_str() {
                    "A" | "B" | "C" | "D" => &["row", "column"],
                    "re" | "im" | "coherence" | "valid_band_rad_s" | "sd_db" | "sd_deg" => {
                        &["output", "input"]
                    }
                    _ => &[],
                };
                let matrix = if indices == ["row", "column"] {
                    "matrix "
                } else {
                    ""
                };
                words.push(format!("{matrix}{}", shortened(&sanitized(key))));
            }
            Step::Entry(index) => {
                let (name, after) = indices
                    .split_first()
                    .map_or(("entry", indices), |(name, after)| (*name, after));
                words.push(format!("{name} {}", index + 1));
                indices = after;
            }
        }
    }
    words.join(", ")
}

/// Maximum number of labelled conditions and models, so that an outline takes no more memory than a
/// dataset.
const MOST_LABELS: usize = 50_000;
/// Maximum nesting of lists and objects; labels lie far above that.
const DEEPEST: usize = 100;

/// The labels of a file, for naming places in it; those after an error in the text are missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline {
    /// Value of "format": a text, or the type of another value.
    pub(super) format: Option<String>,
    /// Value of "version".
    pub(super) version: Option<String>,
    /// Ids of conditions.
    ids: BTreeMap<usize, i64>,
    /// Names of models, by the index of their condition, the key of their bundle, and their index
    /// in it.
    names: BTreeMap<(usize, String, usize), String>,
}

impl Outline {
    /// Collects all labels that can be read before the text ends or breaks.
    pub(super) fn of(text: &[u8]) -> Self {
        Self::read(text, |outline| {
            outline.ids.len() + outline.names.len() >= MOST_LABELS
        })
    }

    /// Returns the format in the file; reads no further than that, and stops when the budget does.
    pub(super) fn format_of(text: &[u8], budget: &ReadingBudget<'_>) -> Option<String> {
        Self::read(text, |outline| {
            outline.format.is_some() || budget.work(0, "").is_err()
        })
        .format
    }

    /// Returns format and version in the file; reads no further than those.
    pub(super) fn format_and_version(
        text: &[u8],
        budget: &ReadingBudget<'_>,
    ) -> (Option<String>, Option<String>) {
        let is_read = |outline: &Self| outline.format.is_some() && outline.version.is_some();
        let outline = Self::read(text, |outline| {
            is_read(outline) || budget.work(0, "").is_err()
        });
        (outline.format, outline.version)
    }

    /// Returns the id of a condition, by index.
    pub(super) fn id(&self, condition: usize) -> Option<i64> {
        self.ids.get(&condition).copied()
    }

    /// Returns the name of a model, by the index of its condition, the key of its bundle, and its
    /// index in it.
    pub(super) fn name(&self, condition: usize, bundle: &str, model: usize) -> Option<String> {
        self.names
            .get(&(condition, bundle.to_owned(), model))
            .cloned()
    }

    /// Reads until `enough`; an error ends the outline, and the reader proper finds and reports it
    /// again.
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

    /// Stores a value if it is a label.
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
                [
                    Step::Key(list),
                    Step::Entry(condition),
                    Step::Key(bundle),
                    Step::Entry(model),
                    Step::Key(key),
                ],
                JsonEvent::String(name),
            ) if list == "conditions" && key == "name" => {
                self.names
                    .insert((*condition, bundle.clone(), *model), name.to_string());
            }
            _ => {}
        }
    }
}

/// Describes a value: a text in quotation marks, a number unchanged, a list or an object only by
/// its type.
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

/// Maximum number of keys reported individually; a file with more is not one of ours, or made to
/// fill the memory.
const MOST_KEYS: usize = 50;

/// Keys unknown to the program, counted once for the same key in the same kind of place.
#[derive(Debug, Default)]
pub(super) struct UnknownKeys {
    /// By the steps without their indices: the first such place, and their number.
    found: BTreeMap<Vec<String>, (Vec<Step>, usize)>,
    /// Number of those not kept, because there are too many others.
    beyond: usize,
}

impl UnknownKeys {
    /// Adds a key or an entry that was skipped.
    pub(super) fn add(&mut self, path: &serde_ignored::Path<'_>) {
        let mut steps = Vec::new();
        collect_steps(path, &mut steps);
        let keys = steps.iter().filter_map(|step| match step {
            Step::Key(key) => Some(key.clone()),
            Step::Entry(_) => None,
        });
        let keys: Vec<String> = keys.collect();
        let is_full = self.found.len() == MOST_KEYS;
        match self.found.get_mut(&keys) {
            Some((_, count)) => *count += 1,
            None if is_full => self.beyond += 1,
            None => drop(self.found.insert(keys, (steps, 1))),
        }
    }

    /// Returns a caution for each, with its place in the text.
    pub(super) fn cautions(&self, text: &[u8]) -> Vec<String> {
        if self.found.is_empty() {
            return Vec::new();
        }
        let outline = Outline::of(text);
        let caution = |(steps, count): &(Vec<Step>, usize)| {
            let more = if *count > 1 {
                format!(", and {} more like it", count - 1)
            } else {
                String::new()
            };
            match steps.split_last() {
                Some((Step::Key(key), place)) => {
                    let place = location_of(place, &outline).before();
                    format!(
                        "{place}the key {} is not known and not used{more}",
                        quoted(key)
                    )
                }
                _ => format!(
                    "{}this entry is not known and not used{more}",
                    location_of(steps, &outline).before()
                ),
            }
        };
        let beyond = (self.beyond > 0)
            .then(|| format!("{} other keys are not known and not used", self.beyond));
        self.found.values().map(caution).chain(beyond).collect()
    }
}

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

/// Returns the line at which the condition or the model of a place begins, counted from 1.
pub(super) fn line_of(text: &[u8], place: &Location) -> Option<usize> {
    let mut value = entry(
        serde_json::from_slice(text).ok()?,
        "conditions",
        place.condition.as_ref()?.position,
    )?;
    if let Some(model) = &place.model {
        let key = match model.bundle {
            BundleKind::Physics => "physics_models",
            BundleKind::Identified => "identified_models",
        };
        value = entry(value, key, model.position)?;
    }
    let offset = value.get().as_ptr() as usize - text.as_ptr() as usize;
    Some(1 + text[..offset].iter().filter(|byte| **byte == b'\n').count())
}

/// Returns an entry of a list in an object, counted from 1: a part of the text, not a copy.
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
        let outline = Outline::of(
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
    fn what_cannot_be_named_is_counted() {
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
    fn labels_before_a_break_in_the_text_are_kept() {
        let text = br#"{"format": "gdcm-dataset", "version": 1, "conditions": [{}, {"deep": [[[], {}], 1], "id": 7,
            "physics_models": [{"name": "nominal", "A": [[1]]}, {"A": [], "name": "V+5kt", "A": [[NaN"#;
        let outline = Outline::of(text);
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
    fn the_format_is_read_without_reading_on() {
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
