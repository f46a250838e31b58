//! JSON, gzip-packed or not: datasets and models of this program, and JSON of any shape as
//! variables. Other gzip-packed contents go to their own format.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};

use super::strides::Places;
use super::variables::{Array, CellArray, ElementKind, StructArray, TextArray, Value, Variable};
use crate::file_error::FileError;
use crate::files::dataset_file::{DatasetOrigin, dataset_from};
use crate::files::model_collection::found_models;
use crate::formats::{Contents, Importer, importer_of};
use crate::location::Outline;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::source::{GZIP_MAGIC, Source, text_of, without_mark};

/// JSON, and any gzip-packed file.
pub(crate) const JSON: Importer = Importer {
    name: "JSON",
    endings: &["json", "gz"],
    recognises: |bytes, ending| {
        bytes.starts_with(&GZIP_MAGIC)
            || ending == "json"
            || bytes.trim_ascii_start().first() == Some(&b'{')
    },
    read: |bytes, path, budget| {
        let wrong = |fault| FileError::variables(path, fault);
        let text = text_of(bytes, path, budget)?;
        let text = without_mark(&text);
        if bytes.starts_with(&GZIP_MAGIC)
            && !matches!(text.trim_ascii_start().first(), Some(b'{' | b'['))
        {
            let packed = path.with_extension("");
            return match importer_of(text, &packed) {
                importer if importer.name == JSON.name => {
                    Contents::row_major(variables_of(text, budget), path)
                }
                importer => (importer.read)(text, path, budget),
            };
        }
        let format = Outline::format_of(text, budget);
        budget.work(text.len() as u64, "").map_err(wrong)?;
        match format.as_deref() {
            Some("\"gdcm-dataset\"") => {
                // The text was packed and is unpacked again here.
                let source = Source::of(bytes, path, budget)?;
                let loaded = dataset_from(&source, DatasetOrigin::File(path.to_owned()), budget)?;
                return Ok(Contents::Dataset(
                    Box::new(loaded.dataset.as_ref().clone()),
                    loaded.cautions,
                ));
            }
            Some("\"gdcm-models\"" | "\"gdcm-identified\"") => {
                if let Some((models, unknown)) = found_models(text, path, budget) {
                    return Ok(Contents::Models(models, unknown));
                }
            }
            _ => {}
        }
        Contents::row_major(variables_of(text, budget), path)
    },
};

/// The members of a JSON object, or a list under the name "models".
fn variables_of(text: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    let refused = RefCell::new(None);
    let mut json = serde_json::Deserializer::from_slice(text);
    let read = TreeReader {
        budget,
        refused: &refused,
    }
    .deserialize(&mut json);
    let tree = read
        .and_then(|tree| json.end().map(|()| tree))
        .map_err(|error| {
            let wrong =
                || VariableFault::line("", error.line(), format!("this is not JSON: {error}"));
            refused.take().unwrap_or_else(wrong)
        })?;
    match tree {
        Tree::Object(members) => {
            let variable = |(name, value)| {
                Ok(Variable {
                    value: value_of(value, budget)?,
                    name,
                })
            };
            members.into_iter().map(variable).collect()
        }
        other => Ok(vec![Variable {
            name: "models".to_owned(),
            value: value_of(other, budget)?,
        }]),
    }
}

/// JSON of any shape.
#[derive(Debug)]
enum Tree {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Tree>),
    /// Sorted by name; the last of several members with the same name.
    Object(Vec<(String, Tree)>),
}

/// Reads JSON of any shape within a budget: a few bytes of text can become a list, an object or a
/// name, each with its own memory.
#[derive(Clone, Copy)]
struct TreeReader<'r> {
    budget: &'r ReadingBudget<'r>,
    /// Set if the budget ended the reading.
    refused: &'r RefCell<Option<VariableFault>>,
}

impl TreeReader<'_> {
    fn take<E: Error>(self, size: usize) -> Result<(), E> {
        // Lists grow by doubling; a step of work is a value.
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
        members.reverse();
        members.sort_by(|(one, _), (other, _)| one.cmp(other));
        members.dedup_by(|(later, _), (earlier, _)| later == earlier);
        Ok(Tree::Object(members))
    }
}

/// Overhead of an allocation, and the initial capacity of a list \[bytes\].
const ALLOCATION: usize = 64;
/// Memory of a value with its shape and one number, and of null \[bytes\].
const VALUE: u64 = size_of::<Value>() as u64 + 3 * ALLOCATION as u64;

fn value_of(json: Tree, budget: &ReadingBudget<'_>) -> Result<Value, VariableFault> {
    budget.take(1, VALUE, "")?;
    Ok(match json {
        Tree::Null => Value::empty(),
        Tree::Bool(flag) => Value::truth(flag),
        Tree::Number(number) => Value::number(number),
        Tree::Text(text) => Value::text(text),
        Tree::List(list) => list_of(list, budget)?,
        Tree::Object(members) => {
            budget.take(
                members.len() as u64,
                size_of::<(String, Vec<Value>)>() as u64,
                "",
            )?;
            let field = |(name, value)| Ok((name, vec![value_of(value, budget)?]));
            let fields = members.into_iter().map(field).collect::<Result<_, _>>()?;
            Value::Struct(StructArray::one(fields))
        }
    })
}

/// Converts a list: numbers become an array (row by row), texts an array of texts, anything else a
/// cell array.
fn list_of(list: Vec<Tree>, budget: &ReadingBudget<'_>) -> Result<Value, VariableFault> {
    if !list.is_empty() && list.iter().all(|item| matches!(item, Tree::Text(_))) {
        budget.take(list.len() as u64, size_of::<String>() as u64, "")?;
        let text = |item| {
            if let Tree::Text(text) = item {
                Some(text)
            } else {
                None
            }
        };
        let texts: Vec<String> = list.into_iter().filter_map(text).collect();
        return Ok(Value::Text(TextArray {
            shape: vec![1, texts.len()],
            texts,
        }));
    }
    if let Some(array) = numbers_of(&list, budget)? {
        return Ok(Value::Array(array));
    }
    budget.take(list.len() as u64, size_of::<Value>() as u64, "")?;
    let shape = vec![1, list.len()];
    let values = list
        .into_iter()
        .map(|item| value_of(item, budget))
        .collect::<Result<_, _>>()?;
    Ok(Value::Cell(CellArray { shape, values }))
}

fn numbers_of(list: &[Tree], budget: &ReadingBudget<'_>) -> Result<Option<Array>, VariableFault> {
    let mut shape = vec![list.len()];
    let mut inner = list;
    while let Some(Tree::List(next)) = inner.first() {
        shape.push(next.len());
        inner = next;
    }
    if shape.len() > 3 {
        return Ok(None);
    }
    let mut values = Vec::new();
    if flatten(list, &shape, &mut values, budget)?.is_none() {
        return Ok(None);
    }
    Ok(Some(match shape.as_slice() {
        [count] => Array::matrix(1, *count, values),
        _ => {
            budget.take(values.len() as u64, 8, "")?;
            let re = Places::row_major(&shape)
                .into_iter()
                .flatten()
                .map(|place| values[place])
                .collect();
            Array {
                shape,
                kind: ElementKind::Float,
                re,
                im: None,
            }
        }
    }))
}

/// Appends the numbers of a rectangular list; returns nothing if the list is not rectangular.
fn flatten(
    list: &[Tree],
    shape: &[usize],
    values: &mut Vec<f64>,
    budget: &ReadingBudget<'_>,
) -> Result<Option<()>, VariableFault> {
    let Some((count, rest)) = shape
        .split_first()
        .filter(|(count, _)| list.len() == **count)
    else {
        return Ok(None);
    };
    // Lists grow by doubling.
    budget.take(*count as u64, 16, "")?;
    for item in list {
        match (item, rest) {
            (Tree::List(inner), [_, ..]) if flatten(inner, rest, values, budget)?.is_some() => {}
            (Tree::Number(number), []) => values.push(*number),
            _ => return Ok(None),
        }
    }
    Ok(Some(()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_lists_of_numbers_are_arrays_and_ragged_ones_are_not() {
        let budget = ReadingBudget::new(1 << 20);
        let of = |text: &str| {
            let text = format!("{{\"x\": {text}}}");
            variables_of(text.as_bytes(), &budget)
                .unwrap()
                .remove(0)
                .value
        };
        assert_eq!(
            of("[[1, 2, 3], [4, 5, 6]]"),
            Value::Array(Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]))
        );
        assert!(matches!(of("[[1, 2], [3]]"), Value::Cell(_)));
        let Value::Array(cube) = of("[[[1, 2], [3, 4]]]") else {
            panic!("an array")
        };
        assert_eq!(
            (cube.shape, cube.re),
            (vec![1, 2, 2], vec![1.0, 3.0, 2.0, 4.0])
        );
        assert!(matches!(of("[\"LON\", \"LAT\"]"), Value::Text(_)));
    }

    #[test]
    fn members_come_in_the_order_of_their_names_and_the_last_of_one_name_counts() {
        let read = variables_of(
            b"{\"b\": 1, \"a\": 2, \"b\": 3}",
            &ReadingBudget::new(1 << 20),
        )
        .unwrap();
        let number = |name: &str, value| Variable {
            name: name.to_owned(),
            value: Value::Array(Array::matrix(1, 1, vec![value])),
        };
        assert_eq!(read, [number("a", 2.0), number("b", 3.0)]);
    }

    #[test]
    fn the_line_of_what_is_no_json_is_named() {
        let error = variables_of(b"{\"A\":\n [1,,2]}", &ReadingBudget::new(1 << 20)).unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error}");
    }
}
