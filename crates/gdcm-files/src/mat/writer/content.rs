//! The contents of the element of one array.

use super::block::{Kind, element};
use crate::variables::{Array, CellArray, ElementKind, StructArray, TextArray, Value};

/// The classes of arrays that are written.
#[derive(Clone, Copy)]
enum Class {
    Cell = 1,
    Struct = 2,
    Char = 4,
    Double = 6,
    U8 = 9,
    I32 = 12,
    I64 = 14,
}

const COMPLEX: u32 = 0x0800;
const LOGICAL: u32 = 0x0200;
/// The lengths of names of fields that MATLAB writes, with the zero behind them.
const NAME_LENGTHS: [usize; 2] = [32, 64];

/// The contents of an array's element; within another array the name is empty.
pub(super) fn contents(value: &Value, name: &str) -> Vec<u8> {
    match value {
        Value::Array(numbers) => array(numbers, name),
        Value::Text(texts) => text(texts, name),
        Value::Cell(values) => cell(values, name),
        Value::Struct(fields) => records(fields, name),
        Value::Object(object) => records(&object.records, name),
        Value::Opaque { .. } => array(&Array::matrix(0, 0, Vec::new()), name),
    }
}

fn begun(class: Class, flags: u32, shape: &[usize], name: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let words = [(class as u32 | flags).to_le_bytes(), [0; 4]];
    element(&mut bytes, Kind::U32, words.as_flattened());
    // A length that does not fit belongs to an array that is refused for its size, or to one without elements.
    let sides: Vec<u8> = shape.iter().flat_map(|&side| i32::try_from(side).unwrap_or(i32::MAX).to_le_bytes()).collect();
    element(&mut bytes, Kind::I32, &sides);
    element(&mut bytes, Kind::I8, name.as_bytes());
    bytes
}

fn array(array: &Array, name: &str) -> Vec<u8> {
    let within = |most: f64| move |&number: &f64| number.fract() == 0.0 && (-most..most).contains(&number);
    let all = |fits: &dyn Fn(&f64) -> bool| array.re.iter().chain(array.im.iter().flatten()).all(fits);
    let (class, flags, kind) = match array.kind {
        ElementKind::Logical if all(&|&number| number == 0.0 || number == 1.0) => (Class::U8, LOGICAL, Kind::U8),
        ElementKind::Integer if all(&within(2_147_483_648.0)) => (Class::I32, 0, Kind::I32),
        ElementKind::Integer if all(&within(9_223_372_036_854_775_808.0)) => (Class::I64, 0, Kind::I64),
        _ => (Class::Double, 0, Kind::F64),
    };
    let complex = if array.im.is_some() { COMPLEX } else { 0 };
    let mut bytes = begun(class, flags | complex, &array.shape, name);
    for part in std::iter::once(&array.re).chain(&array.im) {
        element(&mut bytes, kind, &stored(kind, part));
    }
    bytes
}

fn stored(kind: Kind, numbers: &[f64]) -> Vec<u8> {
    match kind {
        Kind::U8 => numbers.iter().map(|&number| number as u8).collect(),
        Kind::I32 => numbers.iter().flat_map(|&number| (number as i32).to_le_bytes()).collect(),
        Kind::I64 => numbers.iter().flat_map(|&number| (number as i64).to_le_bytes()).collect(),
        _ => numbers.iter().flat_map(|&number| number.to_le_bytes()).collect(),
    }
}

fn text(text: &TextArray, name: &str) -> Vec<u8> {
    let units: Vec<Vec<u16>> = text.texts.iter().map(|text| text.encode_utf16().collect()).collect();
    let length = units.first().map_or(0, Vec::len);
    let even = units.iter().all(|row| row.len() == length);
    let &[height, 1, ref pages @ ..] = text.shape.as_slice() else { return texts(text, name) };
    if !even || units.is_empty() || units.len() != height.saturating_mul(pages.iter().product()) {
        return texts(text, name);
    }
    // `''` has no rows.
    let empty = units.len() == 1 && length == 0;
    let shape: Vec<usize> = [if empty { 0 } else { height }, length].iter().chain(pages).copied().collect();
    let columns = |page: &[Vec<u16>]| -> Vec<u16> {
        (0..length).flat_map(|column| page.iter().filter_map(move |row| row.get(column).copied())).collect()
    };
    let characters: Vec<u16> = units.chunks(height.max(1)).flat_map(columns).collect();
    let mut bytes = begun(Class::Char, 0, &shape, name);
    // SciPy and Octave read UTF-8 best. Rows with letters of two units could not be taken apart again.
    match char::decode_utf16(characters.iter().copied()).collect::<Result<String, _>>() {
        Ok(letters) if letters.chars().count() == characters.len() => {
            element(&mut bytes, Kind::Utf8, letters.as_bytes());
        }
        _ => {
            let units = characters.into_iter().flat_map(u16::to_le_bytes);
            element(&mut bytes, Kind::U16, &units.collect::<Vec<u8>>());
        }
    }
    bytes
}

/// Texts of different lengths, each in a cell.
fn texts(texts: &TextArray, name: &str) -> Vec<u8> {
    let single = |text: &String| Value::Text(TextArray { shape: vec![1, 1], texts: vec![text.clone()] });
    cell(&CellArray { shape: texts.shape.clone(), values: texts.texts.iter().map(single).collect() }, name)
}

fn cell(cell: &CellArray, name: &str) -> Vec<u8> {
    let mut bytes = begun(Class::Cell, 0, &cell.shape, name);
    for value in &cell.values {
        element(&mut bytes, Kind::Matrix, &contents(value, ""));
    }
    bytes
}

fn records(records: &StructArray, name: &str) -> Vec<u8> {
    let mut bytes = begun(Class::Struct, 0, &records.shape, name);
    let longest = records.fields.iter().map(|(field, _)| field.len() + 1).max().unwrap_or(1);
    let length = NAME_LENGTHS.into_iter().find(|&length| longest <= length).unwrap_or(longest);
    element(&mut bytes, Kind::I32, &(length as u32).to_le_bytes());
    let mut names = Vec::with_capacity(length * records.fields.len());
    for (at, (field, _)) in records.fields.iter().enumerate() {
        names.extend(field.as_bytes());
        names.resize(length * (at + 1), 0);
    }
    element(&mut bytes, Kind::I8, &names);
    let count = records.fields.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    for at in 0..count {
        for (_, values) in &records.fields {
            // An element of no bytes is an empty array.
            let value = values.get(at).map(|value| contents(value, "")).unwrap_or_default();
            element(&mut bytes, Kind::Matrix, &value);
        }
    }
    bytes
}
