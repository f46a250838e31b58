//! JSON lists and objects with limits on their lengths. Content that exceeds a limit is rejected
//! before the excess occupies memory.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// Reads a list with at most `MOST` entries.
pub(super) fn list<'de, const MOST: usize, T, D>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    list_while(deserializer, MOST, |_| Ok(()))
}

/// A list with at most `MOST` entries.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub(super) struct Limited<T, const MOST: usize>(pub(super) Vec<T>);

impl<'de, T: Deserialize<'de>, const MOST: usize> Deserialize<'de> for Limited<T, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        list::<MOST, T, D>(deserializer).map(Self)
    }
}

impl<T, const MOST: usize> Limited<T, MOST> {
    /// Wraps a list; `None` if it is empty, so that its key is omitted from the file.
    pub(super) fn some(list: Vec<T>) -> Option<Self> {
        if list.is_empty() {
            None
        } else {
            Some(Self(list))
        }
    }

    /// Returns the entries of a list; empty if there is no list.
    pub(super) fn entries(list: Option<Self>) -> Vec<T> {
        list.map(|list| list.0).unwrap_or_default()
    }
}

/// Reads a list with at most `most` entries, while `check` accepts each; ends with an error at the
/// first entry that it rejects.
pub(super) fn list_while<'de, T, D>(
    deserializer: D,
    most: usize,
    check: impl FnMut(&T) -> Result<(), String>,
) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    deserializer.deserialize_seq(LimitedList {
        most,
        check,
        entry: PhantomData,
    })
}

/// Creates the error that a list or an object exceeds its limit.
pub(super) fn too_long<E: Error>(most: usize) -> E {
    E::custom(format_args!("expected at most {most} entries, found more"))
}

struct LimitedList<T, C> {
    most: usize,
    check: C,
    entry: PhantomData<T>,
}

impl<'de, T, C> Visitor<'de> for LimitedList<T, C>
where
    T: Deserialize<'de>,
    C: FnMut(&T) -> Result<(), String>,
{
    type Value = Vec<T>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut entries: A) -> Result<Vec<T>, A::Error> {
        let mut list = Vec::new();
        while list.len() < self.most {
            let Some(entry) = entries.next_element()? else {
                return Ok(list);
            };
            (self.check)(&entry).map_err(A::Error::custom)?;
            list.push(entry);
        }
        match entries.next_element::<IgnoredAny>()? {
            None => Ok(list),
            Some(_) => Err(too_long(self.most)),
        }
    }
}

/// Numbers by name, at most `MOST`; for a repeated name, the last is kept.
pub(super) struct Numbers<const MOST: usize>(pub(super) BTreeMap<String, f64>);

impl<'de, const MOST: usize> Deserialize<'de> for Numbers<MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Object::<MOST>)
    }
}

struct Object<const MOST: usize>;

impl<'de, const MOST: usize> Visitor<'de> for Object<MOST> {
    type Value = Numbers<MOST>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Numbers<MOST>, A::Error> {
        let mut numbers = BTreeMap::new();
        while let Some((name, number)) = entries.next_entry()? {
            if numbers.len() == MOST {
                return Err(too_long(MOST));
            }
            numbers.insert(name, number);
        }
        Ok(Numbers(numbers))
    }
}
