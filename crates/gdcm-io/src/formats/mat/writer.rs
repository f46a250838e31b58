//! Level-5 files for MATLAB, GNU Octave and SciPy.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 5 MAT-File Format".

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::formats::mat::level5::DataKind as Kind;
use crate::formats::variables::{
    Array, CellArray, ElementKind, StructArray, TextArray, Value, Variable,
};
use crate::reading_budget::VariableFault;

/// Header text, padded with blanks: MATLAB checks the first words.
const HEADER_TEXT: &str = "MATLAB 5.0 MAT-file, written by gdcm";
/// Length of the header text.
const HEADER_TEXT_BYTES: usize = 116;
/// Largest variable \[bytes\].
const MOST_BYTES: u64 = u32::MAX as u64;

/// Writes a file with these variables.
///
/// Number types are kept: floating-point numbers are written as `double`, integers as `int32` or,
/// if a value does not fit, as `int64`, and logical values as `logical`. Texts become a character
/// array if all rows have the same length, otherwise cells. Objects become structs, and unreadable
/// values an empty array.
pub fn write(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    file(variables, |element| element)
}

/// Writes a packed file, which is smaller and requires MATLAB 7 or later.
pub fn write_packed(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    file(variables, packed)
}

fn file(
    variables: &[Variable],
    packing: impl Fn(Vec<u8>) -> Vec<u8>,
) -> Result<Vec<u8>, VariableFault> {
    let mut bytes = HEADER_TEXT.as_bytes().to_vec();
    bytes.resize(HEADER_TEXT_BYTES, b' ');
    // No objects, version 1.0, and the byte-order mark.
    bytes.extend([0; 8]);
    bytes.extend([0, 1, b'I', b'M']);
    for variable in variables {
        let contents = contents(&variable.value, &variable.name);
        if contents.len() as u64 > MOST_BYTES {
            return Err(VariableFault::TooLarge {
                variable: variable.name.clone(),
                most_mib: MOST_BYTES >> 20,
            });
        }
        let mut plain = Vec::new();
        element(&mut plain, Kind::Matrix, &contents);
        bytes.extend(packing(plain));
    }
    Ok(bytes)
}

fn packed(plain: Vec<u8>) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Writing to memory does not fail; the plain bytes would be equivalent.
    if encoder.write_all(&plain).is_err() {
        return plain;
    }
    let Ok(packed) = encoder.finish() else {
        return plain;
    };
    let mut bytes = Vec::with_capacity(packed.len() + 8);
    element(&mut bytes, Kind::Packed, &packed);
    bytes
}

// Elements of a file: data type, length and data.

/// Appends an element, padded to eight bytes. Up to four bytes go into the tag itself, which MATLAB
/// requires for some names.
pub(super) fn element(bytes: &mut Vec<u8>, kind: Kind, data: &[u8]) {
    // The writer refuses a variable whose length does not fit; its elements are shorter.
    let length = data.len() as u32;
    if (1..=4).contains(&length) && kind != Kind::Packed {
        bytes.extend((length << 16 | kind as u32).to_le_bytes());
        bytes.extend(data);
        bytes.resize(bytes.len() + 4 - data.len(), 0);
        return;
    }
    bytes.extend((kind as u32).to_le_bytes());
    bytes.extend(length.to_le_bytes());
    bytes.extend(data);
    if kind != Kind::Packed {
        bytes.resize(bytes.len().next_multiple_of(8), 0);
    }
}

// Contents of an array element.

/// Array classes that are written.
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
/// Lengths of field names in MATLAB, including the zero at the end.
const NAME_LENGTHS: [usize; 2] = [32, 64];

/// Returns the contents of an array element; the name is empty within another array.
pub(super) fn contents(value: &Value, name: &str) -> Vec<u8> {
    match value {
        Value::Array(numbers) => array(numbers, name),
        Value::Text(texts) => text(texts, name),
        Value::Cell(values) => cell(values, name),
        Value::Struct(fields) => records(fields, name),
        Value::Object(object) => records(&object.records, name),
        Value::Opaque { .. } => contents(&Value::empty(), name),
    }
}

fn begun(class: Class, flags: u32, shape: &[usize], name: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let words = [(class as u32 | flags).to_le_bytes(), [0; 4]];
    element(&mut bytes, Kind::U32, words.as_flattened());
    // A length that does not fit belongs to an array that is refused for its size, or to an empty
    // array.
    let sides: Vec<u8> = shape
        .iter()
        .flat_map(|&side| i32::try_from(side).unwrap_or(i32::MAX).to_le_bytes())
        .collect();
    element(&mut bytes, Kind::I32, &sides);
    element(&mut bytes, Kind::I8, name.as_bytes());
    bytes
}

fn array(array: &Array, name: &str) -> Vec<u8> {
    let within =
        |most: f64| move |&number: &f64| number.fract() == 0.0 && (-most..most).contains(&number);
    let all =
        |fits: &dyn Fn(&f64) -> bool| array.re.iter().chain(array.im.iter().flatten()).all(fits);
    let (class, flags, kind) = match array.kind {
        ElementKind::Logical if all(&|&number| number == 0.0 || number == 1.0) => {
            (Class::U8, LOGICAL, Kind::U8)
        }
        ElementKind::Integer if all(&within(2_147_483_648.0)) => (Class::I32, 0, Kind::I32),
        ElementKind::Integer if all(&within(9_223_372_036_854_775_808.0)) => {
            (Class::I64, 0, Kind::I64)
        }
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
        Kind::I32 => numbers
            .iter()
            .flat_map(|&number| (number as i32).to_le_bytes())
            .collect(),
        Kind::I64 => numbers
            .iter()
            .flat_map(|&number| (number as i64).to_le_bytes())
            .collect(),
        _ => numbers
            .iter()
            .flat_map(|&number| number.to_le_bytes())
            .collect(),
    }
}

fn text(text: &TextArray, name: &str) -> Vec<u8> {
    let units: Vec<Vec<u16>> = text
        .texts
        .iter()
        .map(|text| text.encode_utf16().collect())
        .collect();
    let length = units.first().map_or(0, Vec::len);
    let even = units.iter().all(|row| row.len() == length);
    let &[height, 1, ref pages @ ..] = text.shape.as_slice() else {
        return texts(text, name);
    };
    if !even || units.is_empty() || units.len() != height.saturating_mul(pages.iter().product()) {
        return texts(text, name);
    }
    // `''` has no rows.
    let empty = units.len() == 1 && length == 0;
    let shape: Vec<usize> = [if empty { 0 } else { height }, length]
        .iter()
        .chain(pages)
        .copied()
        .collect();
    let columns = |page: &[Vec<u16>]| -> Vec<u16> {
        (0..length)
            .flat_map(|column| page.iter().filter_map(move |row| row.get(column).copied()))
            .collect()
    };
    let characters: Vec<u16> = units.chunks(height.max(1)).flat_map(columns).collect();
    let mut bytes = begun(Class::Char, 0, &shape, name);
    // SciPy and Octave read UTF-8 most reliably. Rows with surrogate pairs could not be separated
    // again.
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

/// Returns texts of different lengths, each in a cell.
fn texts(texts: &TextArray, name: &str) -> Vec<u8> {
    cell(
        &CellArray {
            shape: texts.shape.clone(),
            values: texts.texts.iter().map(Value::text).collect(),
        },
        name,
    )
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
    let longest = records
        .fields
        .iter()
        .map(|(field, _)| field.len() + 1)
        .max()
        .unwrap_or(1);
    let length = NAME_LENGTHS
        .into_iter()
        .find(|&length| longest <= length)
        .unwrap_or(longest);
    element(&mut bytes, Kind::I32, &(length as u32).to_le_bytes());
    let mut names = Vec::with_capacity(length * records.fields.len());
    for (at, (field, _)) in records.fields.iter().enumerate() {
        names.extend(field.as_bytes());
        names.resize(length * (at + 1), 0);
    }
    element(&mut bytes, Kind::I8, &names);
    let count = records
        .fields
        .iter()
        .map(|(_, values)| values.len())
        .max()
        .unwrap_or(0);
    for at in 0..count {
        for (_, values) in &records.fields {
            // An element without bytes is an empty array.
            let value = values
                .get(at)
                .map(|value| contents(value, ""))
                .unwrap_or_default();
            element(&mut bytes, Kind::Matrix, &value);
        }
    }
    bytes
}

#[cfg(test)]
mod writer_tests {
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
        // As many numbers as the largest shape holds.
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
        fn what_is_written_is_read_again(value in value()) {
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
    fn numbers_that_are_not_what_they_are_said_to_be_become_floating_point() {
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
    fn objects_become_structs_and_what_was_not_read_is_empty() {
        let fields = vec![(
            "a".to_owned(),
            vec![Value::Opaque {
                class: "x".to_owned(),
                why: "y".to_owned(),
            }],
        )];
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
    fn short_data_stand_in_the_tag_and_long_ones_are_filled_up() {
        let mut bytes = Vec::new();
        element(&mut bytes, Kind::I8, b"abc");
        assert_eq!(bytes, [1, 0, 3, 0, b'a', b'b', b'c', 0]);
        element(&mut bytes, Kind::U8, &[7; 5]);
        assert_eq!(bytes[8..], [2, 0, 0, 0, 5, 0, 0, 0, 7, 7, 7, 7, 7, 0, 0, 0]);
    }
}
