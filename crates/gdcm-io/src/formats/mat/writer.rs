//! Writes level-5 files for MATLAB, GNU Octave and SciPy, in little-endian byte order.
//!
//! The reading modules show the layouts: the file in `level5.rs`, elements in `element.rs`, array
//! headers in `array_header.rs`, and array contents in `array_contents.rs`. Functions called
//! `…_contents` return an array element's data: header and contents.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 5 MAT-File Format".

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::formats::mat::array_header::{COMPLEX, LOGICAL};
use crate::formats::mat::element::DataKind;
use crate::formats::variables::{
    Array, CellArray, ElementKind, StructArray, TextArray, Value, Variable,
};
use crate::reading_budget::VariableFault;

/// Header text, padded with blanks; MATLAB checks its first words.
const HEADER_TEXT: &str = "MATLAB 5.0 MAT-file, written by gdcm";
/// Length to which the header text is padded \[bytes\].
const HEADER_TEXT_BYTES: usize = 116;
/// Maximum variable size \[bytes\].
const MOST_BYTES: u64 = u32::MAX as u64;
/// Lengths to which MATLAB pads field names, including the terminating zero \[bytes\].
const FIELD_NAME_LENGTHS: [usize; 2] = [32, 64];

/// Array classes that this program writes; the values are their numbers in the flags.
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

/// Writes a file with these variables.
///
/// Number types are kept: floating-point numbers are written as `double`, integers as `int32` or,
/// if a value does not fit, as `int64`, and logical values as `logical`; an array with a number
/// that is not valid for its type is written as `double`. A column of strings with equal lengths
/// becomes a character array, other strings a cell array. Objects become structs, and opaque values
/// empty arrays.
///
/// # Errors
///
/// [`VariableFault::TooLarge`] for a variable beyond 4 GiB.
pub fn write(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    let mut bytes = file_header();
    for variable in variables {
        bytes.extend(variable_element(variable)?);
    }
    Ok(bytes)
}

/// Writes a compressed file, which requires MATLAB 7 or later.
///
/// # Errors
///
/// As for [`write()`].
pub fn write_packed(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    let mut bytes = file_header();
    for variable in variables {
        bytes.extend(pack(variable_element(variable)?));
    }
    Ok(bytes)
}

fn file_header() -> Vec<u8> {
    let mut bytes = HEADER_TEXT.as_bytes().to_vec();
    bytes.resize(HEADER_TEXT_BYTES, b' ');
    // Object position (none), version 1.0, and the byte-order mark.
    bytes.extend([0; 8]);
    bytes.extend([0, 1, b'I', b'M']);
    bytes
}

/// Encodes a variable as an element.
///
/// # Errors
/// [`VariableFault::TooLarge`] for an element beyond 4 GiB.
fn variable_element(variable: &Variable) -> Result<Vec<u8>, VariableFault> {
    let contents = array_contents(&variable.value, &variable.name);
    if contents.len() as u64 > MOST_BYTES {
        return Err(VariableFault::TooLarge {
            variable: variable.name.clone(),
            most_mib: MOST_BYTES >> 20,
        });
    }
    let mut element = Vec::new();
    append_element(&mut element, DataKind::Matrix, &contents);
    Ok(element)
}

/// Compresses an element.
fn pack(plain: Vec<u8>) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Writing to memory cannot fail; if it did, the uncompressed element would be equally valid.
    if encoder.write_all(&plain).is_err() {
        return plain;
    }
    let Ok(packed) = encoder.finish() else {
        return plain;
    };
    let mut bytes = Vec::with_capacity(packed.len() + 8);
    append_element(&mut bytes, DataKind::Packed, &packed);
    bytes
}

/// Appends an element, padded to a multiple of eight bytes. Up to four bytes are written within the
/// tag, which MATLAB requires for some names. Compressed data are neither padded nor written within
/// the tag.
fn append_element(bytes: &mut Vec<u8>, kind: DataKind, data: &[u8]) {
    // The cast is exact: the elements of an accepted variable are shorter than 4 GiB.
    let length = data.len() as u32;
    if (1..=4).contains(&length) && kind != DataKind::Packed {
        // The length is in the upper half of a small element's first word.
        bytes.extend((length << 16 | kind as u32).to_le_bytes());
        bytes.extend(data);
        bytes.resize(bytes.len() + 4 - data.len(), 0);
        return;
    }
    bytes.extend((kind as u32).to_le_bytes());
    bytes.extend(length.to_le_bytes());
    bytes.extend(data);
    if kind != DataKind::Packed {
        bytes.resize(bytes.len().next_multiple_of(8), 0);
    }
}

/// Returns an array element's contents; `name` is empty within another array.
fn array_contents(value: &Value, name: &str) -> Vec<u8> {
    match value {
        Value::Array(array) => number_contents(array, name),
        Value::Text(texts) => text_contents(texts, name),
        Value::Cell(cell) => cell_contents(cell, name),
        Value::Struct(records) => record_contents(records, name),
        Value::Object(object) => record_contents(&object.records, name),
        Value::Opaque { .. } => array_contents(&Value::empty(), name),
    }
}

/// Returns an array's header: flags, shape and name.
fn header_bytes(class: Class, flags: u32, shape: &[usize], name: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let words = [(class as u32 | flags).to_le_bytes(), [0; 4]];
    append_element(&mut bytes, DataKind::U32, words.as_flattened());
    // A dimension beyond 32 bits occurs only in an empty array, or in an array that is rejected for
    // its size.
    let sides: Vec<u8> = shape
        .iter()
        .flat_map(|&side| i32::try_from(side).unwrap_or(i32::MAX).to_le_bytes())
        .collect();
    append_element(&mut bytes, DataKind::I32, &sides);
    append_element(&mut bytes, DataKind::I8, name.as_bytes());
    bytes
}

/// Class, flags and data type with which numbers are written.
#[derive(Clone, Copy)]
struct NumberForm {
    class: Class,
    flags: u32,
    kind: DataKind,
}

impl NumberForm {
    /// Returns the form for the array's kind; `double` if a number cannot be written as that kind.
    fn for_array(array: &Array) -> Self {
        match array.kind {
            ElementKind::Logical if all_numbers(array, is_truth_value) => Self {
                class: Class::U8,
                flags: LOGICAL,
                kind: DataKind::U8,
            },
            ElementKind::Integer if all_numbers(array, fits_i32) => Self {
                class: Class::I32,
                flags: 0,
                kind: DataKind::I32,
            },
            ElementKind::Integer if all_numbers(array, fits_i64) => Self {
                class: Class::I64,
                flags: 0,
                kind: DataKind::I64,
            },
            _ => Self {
                class: Class::Double,
                flags: 0,
                kind: DataKind::F64,
            },
        }
    }
}

/// Returns whether `fits` is true for the real and imaginary parts of all numbers.
fn all_numbers(array: &Array, fits: impl Fn(f64) -> bool) -> bool {
    let numbers = array.re.iter().chain(array.im.iter().flatten());
    numbers.copied().all(fits)
}

fn is_truth_value(number: f64) -> bool {
    number == 0.0 || number == 1.0
}

fn fits_i32(number: f64) -> bool {
    is_integer_below(number, 2_147_483_648.0)
}

fn fits_i64(number: f64) -> bool {
    is_integer_below(number, 9_223_372_036_854_775_808.0)
}

/// Returns whether a number is an integer from `-most` up to, but excluding, `most`.
fn is_integer_below(number: f64, most: f64) -> bool {
    number.fract() == 0.0 && (-most..most).contains(&number)
}

fn number_contents(array: &Array, name: &str) -> Vec<u8> {
    let form = NumberForm::for_array(array);
    let complex = if array.im.is_some() { COMPLEX } else { 0 };
    let mut bytes = header_bytes(form.class, form.flags | complex, &array.shape, name);
    for part in std::iter::once(&array.re).chain(&array.im) {
        append_element(&mut bytes, form.kind, &encode_numbers(form.kind, part));
    }
    bytes
}

fn encode_numbers(kind: DataKind, numbers: &[f64]) -> Vec<u8> {
    match kind {
        DataKind::U8 => numbers.iter().map(|&number| number as u8).collect(),
        DataKind::I32 => numbers
            .iter()
            .flat_map(|&number| (number as i32).to_le_bytes())
            .collect(),
        DataKind::I64 => numbers
            .iter()
            .flat_map(|&number| (number as i64).to_le_bytes())
            .collect(),
        _ => numbers
            .iter()
            .flat_map(|&number| number.to_le_bytes())
            .collect(),
    }
}

/// Returns the contents for strings: a character array if they form a column, also in several
/// pages, and have equal lengths; otherwise a cell array.
fn text_contents(texts: &TextArray, name: &str) -> Vec<u8> {
    let rows: Vec<Vec<u16>> = texts
        .texts
        .iter()
        .map(|text| text.encode_utf16().collect())
        .collect();
    let length = rows.first().map_or(0, Vec::len);
    let &[height, 1, ref pages @ ..] = texts.shape.as_slice() else {
        return text_cell_contents(texts, name);
    };
    let have_same_length = rows.iter().all(|row| row.len() == length);
    let count = height.saturating_mul(pages.iter().product());
    if !have_same_length || rows.is_empty() || rows.len() != count {
        return text_cell_contents(texts, name);
    }
    // A single empty string has no rows, like `''`.
    let is_single_empty = rows.len() == 1 && length == 0;
    let mut shape = vec![if is_single_empty { 0 } else { height }, length];
    shape.extend(pages);
    let mut characters: Vec<u16> = Vec::new();
    // Column-major order: the first characters of all rows of a page, then the second, ...
    for page in rows.chunks(height.max(1)) {
        for column in 0..length {
            characters.extend(page.iter().filter_map(|row| row.get(column)));
        }
    }
    let mut bytes = header_bytes(Class::Char, 0, &shape, name);
    append_characters(&mut bytes, &characters);
    bytes
}

/// Appends an element with characters, given as UTF-16.
///
/// Characters are written as UTF-8, which SciPy and Octave read most reliably. Arrays with
/// surrogate pairs are written as UTF-16: as UTF-8, their rows could not be separated.
fn append_characters(bytes: &mut Vec<u8>, characters: &[u16]) {
    match String::from_utf16(characters) {
        Ok(letters) if letters.chars().count() == characters.len() => {
            append_element(bytes, DataKind::Utf8, letters.as_bytes());
        }
        _ => {
            let units: Vec<u8> = characters
                .iter()
                .flat_map(|unit| unit.to_le_bytes())
                .collect();
            append_element(bytes, DataKind::U16, &units);
        }
    }
}

/// Returns a cell array's contents, with a string in each cell.
fn text_cell_contents(texts: &TextArray, name: &str) -> Vec<u8> {
    let cell = CellArray {
        shape: texts.shape.clone(),
        values: texts.texts.iter().map(Value::text).collect(),
    };
    cell_contents(&cell, name)
}

fn cell_contents(cell: &CellArray, name: &str) -> Vec<u8> {
    let mut bytes = header_bytes(Class::Cell, 0, &cell.shape, name);
    for value in &cell.values {
        append_element(&mut bytes, DataKind::Matrix, &array_contents(value, ""));
    }
    bytes
}

fn record_contents(records: &StructArray, name: &str) -> Vec<u8> {
    let mut bytes = header_bytes(Class::Struct, 0, &records.shape, name);
    append_field_names(&mut bytes, records);
    let count = records
        .fields
        .iter()
        .map(|(_, values)| values.len())
        .max()
        .unwrap_or(0);
    for at in 0..count {
        for (_, values) in &records.fields {
            // A missing value is written as an element without bytes, which is an empty array.
            let value = match values.get(at) {
                Some(value) => array_contents(value, ""),
                None => Vec::new(),
            };
            append_element(&mut bytes, DataKind::Matrix, &value);
        }
    }
    bytes
}

/// Appends the field names: an element with their common length, then the names, padded with zeros.
fn append_field_names(bytes: &mut Vec<u8>, records: &StructArray) {
    let longest = records
        .fields
        .iter()
        .map(|(field, _)| field.len() + 1)
        .max()
        .unwrap_or(1);
    let length = FIELD_NAME_LENGTHS
        .into_iter()
        .find(|&length| longest <= length)
        .unwrap_or(longest);
    append_element(bytes, DataKind::I32, &(length as u32).to_le_bytes());
    let mut names = Vec::with_capacity(length * records.fields.len());
    for (at, (field, _)) in records.fields.iter().enumerate() {
        names.extend(field.as_bytes());
        names.resize(length * (at + 1), 0);
    }
    append_element(bytes, DataKind::I8, &names);
}

#[cfg(test)]
mod writer_tests {
    use crate::variable_fault::unread::Unread;
    use proptest::prelude::*;

    use super::*;
    use crate::formats::mat::read;
    use crate::formats::variables::{
        Array, CellArray, ElementKind, Object, StructArray, TextArray, Value,
    };
    use crate::reading_budget::ReadingBudget;

    fn back(bytes: &[u8]) -> Vec<Variable> {
        read(bytes, &ReadingBudget::new(1 << 24)).unwrap()
    }

    fn named(name: &str, value: Value) -> Variable {
        Variable {
            name: name.to_owned(),
            value,
        }
    }

    fn text(texts: &[&str], shape: &[usize]) -> Value {
        Value::Text(TextArray {
            shape: shape.to_vec(),
            texts: texts.iter().map(|&text| text.to_owned()).collect(),
        })
    }

    fn shape() -> impl Strategy<Value = Vec<usize>> {
        prop::collection::vec(0..4_usize, 2..4)
    }

    fn numbers() -> impl Strategy<Value = Value> {
        let whole =
            (-9_000_000_000_000_000_i64..9_000_000_000_000_000).prop_map(|number| number as f64);
        // The largest shape has 27 elements.
        let both = |kind: ElementKind, number: BoxedStrategy<f64>| {
            let part = prop::collection::vec(number, 27);
            (Just(kind), part.clone(), part)
        };
        let parts = prop_oneof![
            both(ElementKind::Float, prop::num::f64::NORMAL.boxed()),
            both(ElementKind::Integer, whole.boxed()),
            both(
                ElementKind::Integer,
                (-9..9_i32).prop_map(f64::from).boxed()
            ),
            both(ElementKind::Logical, (0..2_i32).prop_map(f64::from).boxed()),
        ];
        (shape(), parts, any::<bool>()).prop_map(|(shape, (kind, mut re, mut im), complex)| {
            let count = shape.iter().product();
            re.truncate(count);
            im.truncate(count);
            let im = if complex && kind != ElementKind::Logical {
                Some(im)
            } else {
                None
            };
            Value::Array(Array {
                shape,
                kind,
                re,
                im,
            })
        })
    }

    fn value() -> impl Strategy<Value = Value> {
        let text = "\\PC{0,9}".prop_map(|text| super::writer_tests::text(&[&text], &[1, 1]));
        prop_oneof![numbers(), text].prop_recursive(3, 24, 9, |inner| {
            let cell = (shape(), prop::collection::vec(inner.clone(), 27)).prop_map(
                |(shape, mut values)| {
                    values.truncate(shape.iter().product());
                    Value::Cell(CellArray { shape, values })
                },
            );
            let fields = prop::collection::btree_map("[a-z][A-Za-z0-9_]{0,40}", inner, 0..4);
            let record = fields.prop_map(|fields| {
                let fields = fields
                    .into_iter()
                    .map(|(name, value)| (name, vec![value]))
                    .collect();
                Value::Struct(StructArray {
                    shape: vec![1, 1],
                    fields,
                })
            });
            prop_oneof![cell, record]
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn written_values_are_read_again(value in value()) {
            let variables = [named("first", value.clone()), named("x", value)];
            prop_assert_eq!(back(&write(&variables).unwrap()), &variables);
            prop_assert_eq!(back(&write_packed(&variables).unwrap()), &variables);
        }
    }

    #[test]
    fn rows_of_the_same_length_are_characters_and_other_texts_are_cells() {
        let rows = named("rows", text(&["ab\u{1f681}", "cdef"], &[2, 1]));
        let paged = named("paged", text(&["ab", "cd"], &[1, 1, 2]));
        let none = named("none", text(&["", "", ""], &[3, 1]));
        let variables = [rows, paged, none];
        assert_eq!(back(&write(&variables).unwrap()), variables);
        let uneven = back(&write(&[named("uneven", text(&["a", "bc"], &[1, 2]))]).unwrap());
        let values = vec![text(&["a"], &[1, 1]), text(&["bc"], &[1, 1])];
        assert_eq!(
            uneven[0].value,
            Value::Cell(CellArray {
                shape: vec![1, 2],
                values
            })
        );
    }

    #[test]
    fn several_records_are_read_again() {
        let values = |numbers: [f64; 2]| {
            numbers
                .map(|number| Value::Array(Array::matrix(1, 1, vec![number])))
                .to_vec()
        };
        let fields = vec![
            ("a".to_owned(), values([1.0, 2.0])),
            ("b".to_owned(), values([3.0, 4.0])),
        ];
        let variables = [named(
            "s",
            Value::Struct(StructArray {
                shape: vec![1, 2],
                fields,
            }),
        )];
        assert_eq!(back(&write(&variables).unwrap()), variables);
    }

    #[test]
    fn numbers_that_contradict_their_kind_become_floating_point() {
        for kind in [ElementKind::Integer, ElementKind::Logical] {
            let array = Array {
                kind,
                ..Array::matrix(1, 2, vec![1.5, 1e300])
            };
            let found = back(&write(&[named("x", Value::Array(array.clone()))]).unwrap());
            assert_eq!(
                found[0].value,
                Value::Array(Array {
                    kind: ElementKind::Float,
                    ..array
                })
            );
        }
    }

    #[test]
    fn objects_become_structs_and_unread_values_are_empty() {
        let fields = vec![("a".to_owned(), vec![Value::opaque("x", Unread::Empty)])];
        let records = StructArray {
            shape: vec![1, 1],
            fields,
        };
        let object = Value::Object(Object {
            class: "ss".to_owned(),
            records,
        });
        let found = back(&write(&[named("sys", object)]).unwrap());
        let Value::Struct(records) = &found[0].value else {
            panic!("{found:?}")
        };
        assert_eq!(
            records.field("a").unwrap()[0],
            Value::Array(Array::matrix(0, 0, Vec::new()))
        );
    }
}

#[cfg(test)]
mod block_tests {
    use super::*;

    #[test]
    fn short_data_is_within_the_tag_and_longer_data_is_padded() {
        let mut bytes = Vec::new();
        append_element(&mut bytes, DataKind::I8, b"abc");
        assert_eq!(bytes, [1, 0, 3, 0, b'a', b'b', b'c', 0]);
        append_element(&mut bytes, DataKind::U8, &[7; 5]);
        assert_eq!(bytes[8..], [2, 0, 0, 0, 5, 0, 0, 0, 7, 7, 7, 7, 7, 0, 0, 0]);
    }
}
