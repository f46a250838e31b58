//! JSON, packed or not: datasets and models of this program, and JSON of any shape as variables. What else gzip packs is given to
//! its own format.

use std::path::Path;

use serde_json::Value as Tree;

use crate::dataset_file::{DatasetOrigin, load_dataset_bytes};
use crate::file_error::FileError;
use crate::importer::{Contents, Importer, importer_of};
use crate::location::Outline;
use crate::models_file::found_models;
use crate::source::{GZIP_MAGIC, Source};
use crate::variables::{
    Array, CellArray, ElementKind, MemoryBudget, StructArray, TextArray, Value, Variable, VariableFault,
};

/// Memory that a byte of JSON of any shape takes at most as a tree: numbers of one digit \[bytes\].
const TREE: u64 = 32;
/// Memory that a byte of a file of this program takes at most \[bytes\].
const TYPED: u64 = 8;

/// JSON, and whatever is packed by gzip.
pub(crate) struct Json;

impl Importer for Json {
    fn name(&self) -> &'static str {
        "JSON"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["json", "gz"]
    }

    fn recognises(&self, bytes: &[u8], ending: &str) -> bool {
        bytes.starts_with(&GZIP_MAGIC) || ending == "json" || bytes.trim_ascii_start().first() == Some(&b'{')
    }

    fn read(&self, bytes: &[u8], path: &Path, budget: &MemoryBudget<'_>) -> Result<Contents, FileError> {
        let wrong = |fault| FileError::variables(path, fault);
        let source = Source::within(bytes, path, budget)?;
        let text = source.text();
        if bytes.starts_with(&GZIP_MAGIC) && !matches!(text.trim_ascii_start().first(), Some(b'{' | b'[')) {
            let packed = path.with_extension("");
            return match importer_of(text, &packed) {
                importer if importer.name() == Self.name() => Contents::row_major(variables_of(text, budget), path),
                importer => importer.read(text, path, budget),
            };
        }
        match Outline::format_of(text).as_deref() {
            Some("\"gdcm-dataset\"") => {
                budget.take(text.len() as u64, TYPED, "").map_err(wrong)?;
                let loaded = load_dataset_bytes(bytes, DatasetOrigin::File(path.to_owned()))?;
                return Ok(Contents::Dataset(Box::new(loaded.dataset.as_ref().clone())));
            }
            Some("\"gdcm-models\"" | "\"gdcm-identified\"") => {
                budget.take(text.len() as u64, TYPED, "").map_err(wrong)?;
                if let Some(models) = found_models(text, path) {
                    return Ok(Contents::Models(models));
                }
            }
            _ => {}
        }
        Contents::row_major(variables_of(text, budget), path)
    }
}

/// The members of a JSON object, or a list under the name "models".
fn variables_of(text: &[u8], budget: &MemoryBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    budget.take(text.len() as u64, TREE, "")?;
    let json: Tree = serde_json::from_slice(text).map_err(|error| VariableFault::Line {
        variable: String::new(),
        line: error.line(),
        what: format!("this is not JSON: {error}"),
    })?;
    Ok(match json {
        Tree::Object(members) => {
            members.iter().map(|(name, value)| Variable { name: name.clone(), value: value_of(value) }).collect()
        }
        other => vec![Variable { name: "models".to_owned(), value: value_of(&other) }],
    })
}

fn value_of(json: &Tree) -> Value {
    match json {
        Tree::Null => Value::Array(Array::matrix(0, 0, Vec::new())),
        Tree::Bool(flag) => {
            Value::Array(Array { kind: ElementKind::Logical, ..Array::matrix(1, 1, vec![f64::from(u8::from(*flag))]) })
        }
        Tree::Number(number) => Value::Array(Array::matrix(1, 1, vec![number.as_f64().unwrap_or(f64::NAN)])),
        Tree::String(text) => Value::Text(TextArray { shape: vec![1, 1], texts: vec![text.clone()] }),
        Tree::Array(list) => list_of(list),
        Tree::Object(members) => {
            let fields = members.iter().map(|(name, value)| (name.clone(), vec![value_of(value)])).collect();
            Value::Struct(StructArray { shape: vec![1, 1], fields })
        }
    }
}

/// Numbers in lists are an array (row by row), texts in a list an array of texts; anything else is a cell array.
fn list_of(list: &[Tree]) -> Value {
    if let Some(texts) = list.iter().map(|item| item.as_str().map(str::to_owned)).collect::<Option<Vec<String>>>()
        && !texts.is_empty()
    {
        return Value::Text(TextArray { shape: vec![1, texts.len()], texts });
    }
    if let Some(array) = numbers_of(list) {
        return Value::Array(array);
    }
    Value::Cell(CellArray { shape: vec![1, list.len()], values: list.iter().map(value_of).collect() })
}

fn numbers_of(list: &[Tree]) -> Option<Array> {
    let mut shape = vec![list.len()];
    let mut inner = list;
    while let Some(Tree::Array(next)) = inner.first() {
        shape.push(next.len());
        inner = next;
    }
    if shape.len() > 3 {
        return None;
    }
    let mut values = Vec::new();
    flatten(list, &shape, &mut values)?;
    Some(match shape.as_slice() {
        [count] => Array::matrix(1, *count, values),
        _ => Array { shape: shape.clone(), kind: ElementKind::Float, re: column_major(&values, &shape), im: None },
    })
}

/// Appends the numbers of a rectangular list; nothing where it is not one.
fn flatten(list: &[Tree], shape: &[usize], values: &mut Vec<f64>) -> Option<()> {
    let (count, rest) = shape.split_first()?;
    if list.len() != *count {
        return None;
    }
    for item in list {
        match (item, rest) {
            (Tree::Array(inner), [_, ..]) => flatten(inner, rest, values)?,
            (Tree::Number(number), []) => values.push(number.as_f64()?),
            _ => return None,
        }
    }
    Some(())
}

/// From the last index running fastest to the first one running fastest.
fn column_major(values: &[f64], shape: &[usize]) -> Vec<f64> {
    let (rows, columns, pages) = (shape[0], shape[1], shape.get(2).copied().unwrap_or(1));
    let mut turned = Vec::with_capacity(values.len());
    for page in 0..pages {
        for column in 0..columns {
            turned.extend((0..rows).map(|row| values[(row * columns + column) * pages + page]));
        }
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_lists_of_numbers_are_arrays_and_ragged_ones_are_not() {
        let of = |text: &str| value_of(&serde_json::from_str(text).unwrap());
        assert_eq!(of("[[1, 2, 3], [4, 5, 6]]"), Value::Array(Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0])));
        assert!(matches!(of("[[1, 2], [3]]"), Value::Cell(_)));
        let Value::Array(cube) = of("[[[1, 2], [3, 4]]]") else { panic!("an array") };
        assert_eq!((cube.shape, cube.re), (vec![1, 2, 2], vec![1.0, 3.0, 2.0, 4.0]));
        assert!(matches!(of("[\"LON\", \"LAT\"]"), Value::Text(_)));
    }

    #[test]
    fn the_line_of_what_is_no_json_is_named() {
        let error = variables_of(b"{\"A\":\n [1,,2]}", &MemoryBudget::new(1 << 20, &|_| false)).unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error}");
    }
}
