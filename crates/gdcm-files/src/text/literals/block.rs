//! Arrays put side by side and one above the other.

use super::trouble::Trouble;
use crate::variables::{Array, CellArray, ElementKind, TextArray, Value};

/// Elements in rows and columns, column by column.
struct Block<T> {
    rows: usize,
    columns: usize,
    values: Vec<T>,
}

/// Values that stand side by side in a row of brackets; `strings` says that one of them is a text in double quotes.
pub(super) fn beside(values: Vec<Value>, strings: bool) -> Result<Value, Trouble> {
    if !strings && values.len() > 1 && values.iter().all(|value| matches!(value, Value::Text(_))) {
        return joined(values);
    }
    together(values, beside_blocks)
}

/// Rows of brackets, one above the other.
pub(super) fn above(values: Vec<Value>, strings: bool) -> Result<Value, Trouble> {
    let width = |value: &Value| match value {
        Value::Text(text) => text.texts.first().map(|text| text.chars().count()),
        _ => None,
    };
    if !strings && values.iter().any(|value| width(value) != width(&values[0])) {
        return Err(Trouble::new("texts below one another have different lengths; write them as {'A';'BC'}"));
    }
    together(values, above_blocks)
}

/// Texts in single quotes side by side are one text.
fn joined(values: Vec<Value>) -> Result<Value, Trouble> {
    let mut whole = String::new();
    for value in values {
        match value {
            Value::Text(TextArray { texts, .. }) if texts.len() == 1 => whole.push_str(&texts[0]),
            _ => return Err(Trouble::new("texts of several rows cannot be joined; write them as {'A','B'}")),
        }
    }
    Ok(text(whole))
}

/// One text.
pub(super) fn text(text: String) -> Value {
    Value::Text(TextArray { shape: vec![1, 1], texts: vec![text] })
}

/// Puts values of one kind together.
fn together(
    mut values: Vec<Value>,
    join: impl Fn(Vec<Block<usize>>) -> Result<Block<(usize, usize)>, Trouble>,
) -> Result<Value, Trouble> {
    if values.len() == 1
        && let Some(value) = values.pop()
    {
        return Ok(value);
    }
    // [] is neutral.
    values.retain(|value| !matches!(value, Value::Array(array) if array.shape == [0, 0]));
    let mut blocks = Vec::with_capacity(values.len());
    for value in &values {
        let (shape, count) = match value {
            Value::Array(array) => (&array.shape, array.re.len()),
            Value::Text(text) => (&text.shape, text.texts.len()),
            Value::Cell(cell) => (&cell.shape, cell.values.len()),
            other => return Err(Trouble::new(format!("{} cannot be put into brackets", other.words()))),
        };
        blocks.push(Block { rows: shape[0], columns: shape[1], values: (0..count).collect() });
    }
    let Block { rows, columns, values: order } = join(blocks)?;
    collect(values, rows, columns, &order)
}

/// Takes the elements in their new order: which value, which of its elements.
fn collect(values: Vec<Value>, rows: usize, columns: usize, order: &[(usize, usize)]) -> Result<Value, Trouble> {
    let shape = vec![rows, columns];
    if values.iter().all(|value| matches!(value, Value::Array(_))) {
        let arrays: Vec<Array> =
            values.into_iter().filter_map(|v| if let Value::Array(a) = v { Some(a) } else { None }).collect();
        let re = order.iter().map(|&(which, index)| arrays[which].re[index]).collect();
        let im = |&(which, index): &(usize, usize)| arrays[which].im.as_ref().map_or(0.0, |im| im[index]);
        let complex = arrays.iter().any(|array| array.im.is_some());
        let im = complex.then(|| order.iter().map(im).collect());
        return Ok(Value::Array(Array { shape, kind: ElementKind::Float, re, im }));
    }
    if values.iter().all(|value| matches!(value, Value::Text(_))) {
        let texts: Vec<TextArray> =
            values.into_iter().filter_map(|v| if let Value::Text(t) = v { Some(t) } else { None }).collect();
        let texts = order.iter().map(|&(which, index)| texts[which].texts[index].clone()).collect();
        return Ok(Value::Text(TextArray { shape, texts }));
    }
    if values.iter().all(|value| matches!(value, Value::Cell(_))) {
        let cells: Vec<CellArray> =
            values.into_iter().filter_map(|v| if let Value::Cell(c) = v { Some(c) } else { None }).collect();
        let values = order.iter().map(|&(which, index)| cells[which].values[index].clone()).collect();
        return Ok(Value::Cell(CellArray { shape, values }));
    }
    Err(Trouble::new("numbers and texts cannot stand in the same brackets; write {…} instead of […]"))
}

fn beside_blocks(blocks: Vec<Block<usize>>) -> Result<Block<(usize, usize)>, Trouble> {
    let rows = blocks.first().map_or(0, |block| block.rows);
    if let Some(other) = blocks.iter().find(|block| block.rows != rows) {
        let found = other.rows;
        return Err(Trouble::new(format!("parts side by side have {rows} and {found} rows; give them as many")));
    }
    let columns = blocks.iter().map(|block| block.columns).sum();
    let place = |(which, block): (usize, Block<usize>)| block.values.into_iter().map(move |index| (which, index));
    let values = blocks.into_iter().enumerate().flat_map(place).collect();
    Ok(Block { rows, columns, values })
}

fn above_blocks(blocks: Vec<Block<usize>>) -> Result<Block<(usize, usize)>, Trouble> {
    let columns = blocks.first().map_or(0, |block| block.columns);
    if let Some(other) = blocks.iter().find(|block| block.columns != columns) {
        let found = other.columns;
        return Err(Trouble::new(format!("rows have {columns} and {found} columns; complete the shorter")));
    }
    let rows = blocks.iter().map(|block| block.rows).sum();
    let mut values = Vec::with_capacity(rows * columns);
    for column in 0..columns {
        for (which, block) in blocks.iter().enumerate() {
            let part = block.values.iter().skip(column * block.rows).take(block.rows);
            values.extend(part.map(|&index| (which, index)));
        }
    }
    Ok(Block { rows, columns, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: usize, columns: usize, values: &[f64]) -> Value {
        Value::Array(Array::matrix(rows, columns, values.to_vec()))
    }

    #[test]
    fn matrices_are_put_beside_and_above_one_another() {
        let (a, b) = (matrix(2, 1, &[1.0, 2.0]), matrix(2, 2, &[3.0, 4.0, 5.0, 6.0]));
        let wide = beside(vec![a, matrix(0, 0, &[]), b.clone()], false).unwrap();
        assert_eq!(wide, matrix(2, 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        let tall = above(vec![b, matrix(1, 2, &[7.0, 8.0])], false).unwrap();
        assert_eq!(tall, matrix(3, 2, &[3.0, 4.0, 7.0, 5.0, 6.0, 8.0]));
        assert!(above(vec![matrix(1, 2, &[1.0, 2.0]), matrix(1, 1, &[1.0])], false).is_err());
    }

    #[test]
    fn texts_are_joined_or_stand_in_an_array() {
        let (a, b) = (text("LA".to_owned()), text("T".to_owned()));
        assert_eq!(beside(vec![a.clone(), b.clone()], false).unwrap(), text("LAT".to_owned()));
        let strings = TextArray { shape: vec![1, 2], texts: vec!["LA".to_owned(), "T".to_owned()] };
        assert_eq!(beside(vec![a.clone(), b.clone()], true).unwrap(), Value::Text(strings));
        assert!(above(vec![a.clone(), b], false).is_err());
        assert!(beside(vec![a, matrix(1, 1, &[1.0])], false).is_err());
    }
}
