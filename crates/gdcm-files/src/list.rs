//! Lists and objects that are read no further than a limit, so that what is refused for its length is never held in memory.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

/// Reads a list of at most `MOST` entries.
pub(super) fn list<'de, const MOST: usize, T, D>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    list_while(deserializer, MOST, |_| Ok(()))
}

/// Reads a list of at most `MOST` entries, or null.
pub(super) fn optional_list<'de, const MOST: usize, T, D>(deserializer: D) -> Result<Option<Vec<T>>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    struct Limited<T, const MOST: usize>(Vec<T>);

    impl<'de, T: Deserialize<'de>, const MOST: usize> Deserialize<'de> for Limited<T, MOST> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            list::<MOST, T, D>(deserializer).map(Self)
        }
    }

    Ok(Option::<Limited<T, MOST>>::deserialize(deserializer)?.map(|list| list.0))
}

/// Reads a list of at most `most` entries, as long as `check` has nothing against the next.
pub(super) fn list_while<'de, T, D>(
    deserializer: D,
    most: usize,
    check: impl FnMut(&T) -> Result<(), String>,
) -> Result<Vec<T>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    deserializer.deserialize_seq(List { most, check, entry: PhantomData })
}

/// Says that a list or an object goes on beyond its limit.
pub(super) fn too_long<E: Error>(most: usize) -> E {
    E::custom(format_args!("expected at most {most} entries, found more"))
}

struct List<T, C> {
    most: usize,
    check: C,
    entry: PhantomData<T>,
}

impl<'de, T, C> Visitor<'de> for List<T, C>
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
            let Some(entry) = entries.next_element()? else { return Ok(list) };
            (self.check)(&entry).map_err(A::Error::custom)?;
            list.push(entry);
        }
        match entries.next_element::<IgnoredAny>()? {
            None => Ok(list),
            Some(_) => Err(too_long(self.most)),
        }
    }
}

/// Numbers by name, at most `MOST`, each name once.
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
