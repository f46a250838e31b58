//! What a file calls itself, its conditions and its models, as far as it can be read at all.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::plain::quoted;

/// A label of one condition: its id, and the names of its models.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ConditionOutline {
    pub(super) id: Option<i64>,
    pub(super) physics: Vec<Option<String>>,
    pub(super) identified: Vec<Option<String>>,
}

/// The labels of a file, for naming places in it; whatever stands behind an error in the text is missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outline {
    /// What stands at "format": text, or the kind of thing that is not text.
    pub(super) format: Option<String>,
    /// What stands at "version".
    pub(super) version: Option<String>,
    pub(super) conditions: Vec<ConditionOutline>,
    /// How many conditions and models have been labelled.
    labels: usize,
}

/// Most conditions and models that are labelled, so that an outline takes no more memory than a dataset.
const MOST_LABELS: usize = 50_000;

impl Outline {
    /// Every label that can be read before the text ends or breaks.
    pub(super) fn of(text: &[u8]) -> Self {
        Self::read(text, Spot::Root { only_format: false })
    }

    /// The outline of a file whose format and version are known, and nothing else.
    pub(super) fn named(format: &str, version: u64) -> Self {
        Self { format: Some(quoted(format)), version: Some(version.to_string()), ..Self::default() }
    }

    /// What the file calls its format; reads no further than that.
    pub(super) fn format_of(text: &[u8]) -> Option<String> {
        Self::read(text, Spot::Root { only_format: true }).format
    }

    fn read(text: &[u8], spot: Spot) -> Self {
        let mut outline = Self::default();
        // An error ends the outline; it is found again, and told, by the reader proper.
        let _ = Sketch { outline: &mut outline, spot }.deserialize(&mut serde_json::Deserializer::from_slice(text));
        outline
    }

    fn last_name(&mut self, list: List) -> Option<&mut Option<String>> {
        let condition = self.conditions.last_mut()?;
        match list {
            List::Physics => condition.physics.last_mut(),
            List::Identified => condition.identified.last_mut(),
            List::Conditions => None,
        }
    }

    fn open_entry(&mut self, list: List) {
        match (list, self.conditions.last_mut()) {
            (List::Conditions, _) => self.conditions.push(ConditionOutline::default()),
            (List::Physics, Some(condition)) => condition.physics.push(None),
            (List::Identified, Some(condition)) => condition.identified.push(None),
            (_, None) => {}
        }
    }

    fn drop_entry(&mut self, list: List) {
        match (list, self.conditions.last_mut()) {
            (List::Conditions, _) => drop(self.conditions.pop()),
            (List::Physics, Some(condition)) => drop(condition.physics.pop()),
            (List::Identified, Some(condition)) => drop(condition.identified.pop()),
            (_, None) => {}
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum List {
    Conditions,
    Physics,
    Identified,
}

/// What is being read.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spot {
    Root { only_format: bool },
    Format,
    Version,
    List(List),
    Entry(List),
    Id,
    Name(List),
    Other,
}

impl Spot {
    fn under(self, key: &str) -> Spot {
        match (self, key) {
            (Spot::Root { .. }, "format") => Spot::Format,
            (Spot::Root { .. }, "version") => Spot::Version,
            (Spot::Root { .. }, "conditions") => Spot::List(List::Conditions),
            (Spot::Entry(List::Conditions), "id") => Spot::Id,
            (Spot::Entry(List::Conditions), "physics_models") => Spot::List(List::Physics),
            (Spot::Entry(List::Conditions), "identified_models") => Spot::List(List::Identified),
            (Spot::Entry(list @ (List::Physics | List::Identified)), "name") => Spot::Name(list),
            _ => Spot::Other,
        }
    }
}

struct Sketch<'o> {
    outline: &'o mut Outline,
    spot: Spot,
}

impl Sketch<'_> {
    fn note(self, words: String) {
        match self.spot {
            Spot::Format => self.outline.format = Some(words),
            Spot::Version => self.outline.version = Some(words),
            _ => {}
        }
    }
}

impl<'de> DeserializeSeed<'de> for Sketch<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        match self.spot {
            Spot::Other => deserializer.deserialize_ignored_any(IgnoredAny).map(drop),
            _ => deserializer.deserialize_any(self),
        }
    }
}

impl<'de> Visitor<'de> for Sketch<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("anything")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<(), E> {
        match self.spot {
            Spot::Name(list) => {
                if let Some(name) = self.outline.last_name(list) {
                    *name = Some(text.to_owned());
                }
            }
            _ => self.note(quoted(text)),
        }
        Ok(())
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<(), E> {
        match (self.spot, self.outline.conditions.last_mut()) {
            (Spot::Id, Some(condition)) => condition.id = Some(number),
            _ => self.note(number.to_string()),
        }
        Ok(())
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<(), E> {
        match i64::try_from(number) {
            Ok(number) => self.visit_i64(number),
            Err(_) => {
                self.note(number.to_string());
                Ok(())
            }
        }
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<(), E> {
        self.note(number.to_string());
        Ok(())
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<(), E> {
        self.note(value.to_string());
        Ok(())
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.note("null".to_owned());
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        let Spot::List(list) = self.spot else {
            self.note("a list".to_owned());
            while entries.next_element::<IgnoredAny>()?.is_some() {}
            return Ok(());
        };
        loop {
            self.outline.labels += 1;
            if self.outline.labels > MOST_LABELS {
                return Err(A::Error::custom("the rest is named by its number"));
            }
            self.outline.open_entry(list);
            let entry = Sketch { outline: &mut *self.outline, spot: Spot::Entry(list) };
            if entries.next_element_seed(entry)?.is_none() {
                self.outline.drop_entry(list);
                return Ok(());
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        while let Some(key) = entries.next_key::<String>()? {
            let spot = self.spot.under(&key);
            entries.next_value_seed(Sketch { outline: &mut *self.outline, spot })?;
            if spot == Spot::Format && self.spot == (Spot::Root { only_format: true }) {
                return Err(A::Error::custom("the rest is not needed"));
            }
        }
        self.note("an object".to_owned());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_before_a_break_in_the_text_are_kept() {
        let text = br#"{"format": "gdcm-dataset", "version": 1, "conditions": [{"id": 7, "physics_models":
            [{"name": "nominal", "A": [[1]]}, {"name": "V+5kt", "A": [[NaN"#;
        let outline = Outline::of(text);
        let physics = vec![Some("nominal".to_owned()), Some("V+5kt".to_owned())];
        assert_eq!(outline.conditions, [ConditionOutline { id: Some(7), physics, identified: vec![] }]);
        assert_eq!((outline.format.as_deref(), outline.version.as_deref()), (Some("\"gdcm-dataset\""), Some("1")));
    }

    #[test]
    fn the_format_is_read_without_reading_on() {
        assert_eq!(Outline::format_of(br#"{"name": [1], "format": "x", broken"#).as_deref(), Some("\"x\""));
        assert_eq!(Outline::format_of(b"[1, 2]"), None);
    }
}
