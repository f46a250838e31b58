//! JSON of any shape as variables.

use serde_json::Value as Json;

use crate::variables::{Array, CellArray, ElementKind, StructArray, TextArray, Value, Variable, VariableFault};

/// Longest text that is taken as JSON of any shape \[bytes\]: as a tree it takes many times that.
const LONGEST: usize = 32 << 20;

/// The members of a JSON object, or a list under the name "models".
pub(crate) fn variables_of(text: &[u8]) -> Result<Vec<Variable>, VariableFault> {
    if text.len() > LONGEST {
        return Err(VariableFault::TooLarge { variable: String::new(), most_mib: (LONGEST >> 20) as u64 });
    }
    let json: Json = serde_json::from_slice(text).map_err(|error| VariableFault::Line {
        variable: String::new(),
        line: error.line(),
        what: format!("this is not JSON: {error}"),
    })?;
    Ok(match json {
        Json::Object(members) => {
            members.iter().map(|(name, value)| Variable { name: name.clone(), value: value_of(value) }).collect()
        }
        other => vec![Variable { name: "models".to_owned(), value: value_of(&other) }],
    })
}

fn value_of(json: &Json) -> Value {
    match json {
        Json::Null => Value::Array(Array::matrix(0, 0, Vec::new())),
        Json::Bool(flag) => {
            Value::Array(Array { kind: ElementKind::Logical, ..Array::matrix(1, 1, vec![f64::from(u8::from(*flag))]) })
        }
        Json::Number(number) => Value::Array(Array::matrix(1, 1, vec![number.as_f64().unwrap_or(f64::NAN)])),
        Json::String(text) => Value::Text(TextArray { shape: vec![1, 1], texts: vec![text.clone()] }),
        Json::Array(list) => list_of(list),
        Json::Object(members) => {
            let fields = members.iter().map(|(name, value)| (name.clone(), vec![value_of(value)])).collect();
            Value::Struct(StructArray { shape: vec![1, 1], fields })
        }
    }
}

/// Numbers in lists are an array (row by row), texts in a list an array of texts; anything else is a cell array.
fn list_of(list: &[Json]) -> Value {
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

fn numbers_of(list: &[Json]) -> Option<Array> {
    let mut shape = vec![list.len()];
    let mut inner = list;
    while let Some(Json::Array(next)) = inner.first() {
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
fn flatten(list: &[Json], shape: &[usize], values: &mut Vec<f64>) -> Option<()> {
    let (count, rest) = shape.split_first()?;
    if list.len() != *count {
        return None;
    }
    for item in list {
        match (item, rest) {
            (Json::Array(inner), [_, ..]) => flatten(inner, rest, values)?,
            (Json::Number(number), []) => values.push(number.as_f64()?),
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
        let error = variables_of(b"{\"A\":\n [1,,2]}").unwrap_err();
        assert!(error.to_string().contains("line 2"), "{error}");
    }
}
