//! JSON with any structure, read within a memory budget.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};

use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::line_fault::LineFault;

/// Memory charged for an allocation: its overhead and a list's initial capacity \[bytes\].
const ALLOCATION: usize = 64;

#[derive(Debug)]
pub(super) enum Tree {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Tree>),
    /// Members sorted by name; among members with equal names, only the last is kept.
    Object(Vec<(String, Tree)>),
}

impl Tree {
    /// Parses JSON.
    ///
    /// # Errors
    /// [`VariableFault`] if the text is not JSON, or the budget is exhausted.
    pub(super) fn read(text: &[u8], budget: &ReadingBudget<'_>) -> Result<Self, VariableFault> {
        let refused = RefCell::new(None);
        let mut json = serde_json::Deserializer::from_slice(text);
        let reader = TreeReader {
            budget,
            refused: &refused,
        };
        let read = reader
            .deserialize(&mut json)
            .and_then(|tree| json.end().map(|()| tree));
        read.map_err(|error| match refused.take() {
            Some(fault) => fault,
            None => VariableFault::line(
                "",
                error.line(),
                LineFault::Json {
                    message: error.to_string(),
                },
            ),
        })
    }
}

/// Reads any JSON value and takes its memory from the budget, because each list, object or name
/// needs an allocation, however few bytes it has in the text.
#[derive(Clone, Copy)]
struct TreeReader<'r> {
    budget: &'r ReadingBudget<'r>,
    /// Budget error that ended the reading, if any; serde passes on only its own error.
    refused: &'r RefCell<Option<VariableFault>>,
}

impl TreeReader<'_> {
    /// Takes the memory for `size` bytes from the budget; keeps the budget's error in `refused`.
    fn take<E: Error>(self, size: usize) -> Result<(), E> {
        // Lists grow by doubling, hence the factor 2. Each call counts as one work step.
        self.budget.take(1, 2 * size as u64, "").map_err(|fault| {
            *self.refused.borrow_mut() = Some(fault);
            E::custom("refused")
        })
    }
}

impl<'de> DeserializeSeed<'de> for TreeReader<'_> {
    type Value = Tree;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Tree, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for TreeReader<'_> {
    type Value = Tree;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("any value")
    }

    fn visit_unit<E>(self) -> Result<Tree, E> {
        Ok(Tree::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Tree, E> {
        Ok(Tree::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Tree, E> {
        Ok(Tree::Number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Tree, E> {
        Ok(Tree::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Tree, E> {
        Ok(Tree::Number(value))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Tree, E> {
        self.take(ALLOCATION + text.len())?;
        Ok(Tree::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Tree, A::Error> {
        self.take(ALLOCATION)?;
        let mut list = Vec::new();
        while let Some(entry) = entries.next_element_seed(self)? {
            self.take(size_of::<Tree>())?;
            list.push(entry);
        }
        Ok(Tree::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Tree, A::Error> {
        self.take(ALLOCATION)?;
        let mut members: Vec<(String, Tree)> = Vec::new();
        while let Some(name) = entries.next_key::<String>()? {
            self.take(size_of::<(String, Tree)>() + ALLOCATION + name.len())?;
            members.push((name, entries.next_value_seed(self)?));
        }
        // Sorting the reversed members with a stable sort puts the last of equal names first, which
        // `dedup_by` keeps.
        members.reverse();
        members.sort_by(|(name, _), (other_name, _)| name.cmp(other_name));
        members.dedup_by(|(later, _), (earlier, _)| later == earlier);
        Ok(Tree::Object(members))
    }
}
