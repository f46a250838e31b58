//! Converts JSON with any structure to variables: objects become structs, rectangular lists of
//! numbers and lists of strings become arrays, other lists cell arrays.

use crate::formats::element_order::Places;
use crate::formats::json_tree::Tree;
use crate::formats::variables::{
    Array, CellArray, ElementKind, StructArray, TextArray, Value, Variable,
};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Estimated memory per value \[bytes\]: the value, and the three allocations for shape, name and
/// number.
const VALUE_MEMORY: u64 = size_of::<Value>() as u64 + 3 * 64;
/// Maximum number of array dimensions; more deeply nested lists become cell arrays.
const MOST_DIMENSIONS: usize = 3;

/// Reads the members of a JSON object as variables; any other JSON value becomes a variable
/// "models".
pub(super) fn read_variables(
    text: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let members = match Tree::read(text, budget)? {
        Tree::Object(members) => members,
        other => vec![("models".to_owned(), other)],
    };
    let mut variables = Vec::new();
    for (name, value) in members {
        variables.push(Variable {
            value: value_from(value, budget)?,
            name,
        });
    }
    Ok(variables)
}

fn value_from(json: Tree, budget: &ReadingBudget<'_>) -> Result<Value, VariableFault> {
    budget.take(1, VALUE_MEMORY, "")?;
    Ok(match json {
        Tree::Null => Value::empty(),
        Tree::Bool(flag) => Value::truth(flag),
        Tree::Number(number) => Value::number(number),
        Tree::Text(text) => Value::text(text),
        Tree::List(list) => list_value(list, budget)?,
        Tree::Object(members) => {
            budget.take(
                members.len() as u64,
                size_of::<(String, Vec<Value>)>() as u64,
                "",
            )?;
            let mut fields = Vec::with_capacity(members.len());
            for (name, value) in members {
                fields.push((name, vec![value_from(value, budget)?]));
            }
            Value::Struct(StructArray::one(fields))
        }
    })
}

/// Converts a list: strings become a string array; numbers, or rectangular nested lists of numbers
/// (row by row) with at most `MOST_DIMENSIONS` levels, become a numeric array, as does an empty
/// list; anything else becomes a cell array.
fn list_value(list: Vec<Tree>, budget: &ReadingBudget<'_>) -> Result<Value, VariableFault> {
    let shape = vec![1, list.len()];
    if !list.is_empty() && list.iter().all(|item| matches!(item, Tree::Text(_))) {
        budget.take(list.len() as u64, size_of::<String>() as u64, "")?;
        let mut texts = Vec::with_capacity(list.len());
        for item in list {
            if let Tree::Text(text) = item {
                texts.push(text);
            }
        }
        return Ok(Value::Text(TextArray { shape, texts }));
    }
    if let Some(array) = number_array(&list, budget)? {
        return Ok(Value::Array(array));
    }
    budget.take(list.len() as u64, size_of::<Value>() as u64, "")?;
    let mut values = Vec::with_capacity(list.len());
    for item in list {
        values.push(value_from(item, budget)?);
    }
    Ok(Value::Cell(CellArray { shape, values }))
}

/// Converts a list of numbers to a row, and nested lists to an array with a dimension for each
/// level. Returns `None` if an item is not a number, or if the lists are not rectangular or have
/// more than `MOST_DIMENSIONS` levels.
fn number_array(list: &[Tree], budget: &ReadingBudget<'_>) -> Result<Option<Array>, VariableFault> {
    let shape = shape_of(list);
    if shape.len() > MOST_DIMENSIONS {
        return Ok(None);
    }
    let mut values = Vec::new();
    if !append_numbers(list, &shape, &mut values, budget)? {
        return Ok(None);
    }
    if let [count] = *shape {
        return Ok(Some(Array::matrix(1, count, values)));
    }
    budget.take(values.len() as u64, 8, "")?;
    // Reorder the numbers from row-major order, as in the text, to column-major order.
    let re = Places::row_major(&shape)
        .into_iter()
        .flatten()
        .map(|place| values[place])
        .collect();
    Ok(Some(Array {
        shape,
        kind: ElementKind::Float,
        re,
        im: None,
    }))
}

/// Returns the length along each dimension, taken from the list, its first item, that item's first
/// item, and so on; other items may have other lengths.
fn shape_of(list: &[Tree]) -> Vec<usize> {
    let mut shape = vec![list.len()];
    let mut inner = list;
    while let Some(Tree::List(next)) = inner.first() {
        shape.push(next.len());
        inner = next;
    }
    shape
}

/// Appends the numbers in nested lists row by row; stops and returns false if the lists do not have
/// the shape `shape` or hold anything but numbers.
fn append_numbers(
    list: &[Tree],
    shape: &[usize],
    values: &mut Vec<f64>,
    budget: &ReadingBudget<'_>,
) -> Result<bool, VariableFault> {
    let Some((&length, inner_shape)) = shape.split_first() else {
        return Ok(false);
    };
    if list.len() != length {
        return Ok(false);
    }
    // Take 16 bytes per 8-byte number: lists grow by doubling.
    budget.take(length as u64, 16, "")?;
    for item in list {
        match item {
            Tree::Number(number) if inner_shape.is_empty() => values.push(*number),
            Tree::List(inner) if !inner_shape.is_empty() => {
                if !append_numbers(inner, inner_shape, values, budget)? {
                    return Ok(false);
                }
            }
            _ => return Ok(false),
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_lists_of_numbers_are_arrays_and_ragged_ones_are_not() {
        let budget = ReadingBudget::new(1 << 20);
        let value = |text: &str| {
            let text = format!("{{\"x\": {text}}}");
            read_variables(text.as_bytes(), &budget)
                .unwrap()
                .remove(0)
                .value
        };
        assert_eq!(
            value("[[1, 2, 3], [4, 5, 6]]"),
            Value::Array(Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]))
        );
        assert!(matches!(value("[[1, 2], [3]]"), Value::Cell(_)));
        let Value::Array(cube) = value("[[[1, 2], [3, 4]]]") else {
            panic!("an array")
        };
        assert_eq!(
            (cube.shape, cube.re),
            (vec![1, 2, 2], vec![1.0, 3.0, 2.0, 4.0])
        );
        assert!(matches!(value("[\"LON\", \"LAT\"]"), Value::Text(_)));
    }

    #[test]
    fn members_are_sorted_by_name_and_the_last_duplicate_counts() {
        let read = read_variables(
            b"{\"b\": 1, \"a\": 2, \"b\": 3}",
            &ReadingBudget::new(1 << 20),
        )
        .unwrap();
        let number = |name: &str, number| Variable {
            name: name.to_owned(),
            value: Value::Array(Array::matrix(1, 1, vec![number])),
        };
        assert_eq!(read, [number("a", 2.0), number("b", 3.0)]);
    }

    #[test]
    fn syntax_errors_give_the_line() {
        let fault = read_variables(b"{\"A\":\n [1,,2]}", &ReadingBudget::new(1 << 20)).unwrap_err();
        assert!(
            matches!(fault, VariableFault::Line { line: 2, .. }),
            "{fault:?}"
        );
        assert_eq!(fault.code(), "invalid-json");
    }
}
