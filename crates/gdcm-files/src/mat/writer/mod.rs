//! Files of level 5 to be read by MATLAB, GNU Octave and SciPy.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 5 MAT-File Format".

mod block;
mod content;

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use self::block::{Kind, element};
use self::content::contents;
use crate::variables::{Variable, VariableFault};

/// What the file begins with, filled up with blanks: MATLAB looks at the first words.
const HEADER_TEXT: &str = "MATLAB 5.0 MAT-file, written by gdcm";
/// Length of that text.
const HEADER_TEXT_BYTES: usize = 116;
/// The most bytes of one variable.
const MOST_BYTES: u64 = u32::MAX as u64;

/// A file of these variables.
///
/// Numbers stay what they are: floating-point ones are written as `double`, whole ones as `int32` or, if one of them does not fit, as
/// `int64`, and true and false as `logical`. Texts become arrays of characters if they are rows of the same length, otherwise cells.
/// Objects become structs, and what could not be read an empty array.
pub fn write(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    file(variables, |element| element)
}

/// The same, packed: smaller, and read by MATLAB from version 7 on.
pub fn write_packed(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    file(variables, packed)
}

fn file(variables: &[Variable], packing: impl Fn(Vec<u8>) -> Vec<u8>) -> Result<Vec<u8>, VariableFault> {
    let mut bytes = HEADER_TEXT.as_bytes().to_vec();
    bytes.resize(HEADER_TEXT_BYTES, b' ');
    // No objects, version 1.0, and the mark by which the order of bytes is known.
    bytes.extend([0; 8]);
    bytes.extend([0, 1, b'I', b'M']);
    for variable in variables {
        let contents = contents(&variable.value, &variable.name);
        if contents.len() as u64 > MOST_BYTES {
            return Err(VariableFault::TooLarge { variable: variable.name.clone(), most_mib: MOST_BYTES >> 20 });
        }
        let mut plain = Vec::new();
        element(&mut plain, Kind::Matrix, &contents);
        bytes.extend(packing(plain));
    }
    Ok(bytes)
}

fn packed(plain: Vec<u8>) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Writing to memory does not fail; were it to, the plain bytes would say the same.
    if encoder.write_all(&plain).is_err() {
        return plain;
    }
    let Ok(packed) = encoder.finish() else { return plain };
    let mut bytes = Vec::with_capacity(packed.len() + 8);
    element(&mut bytes, Kind::Packed, &packed);
    bytes
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::*;
    use crate::variables::{Array, CellArray, ElementKind, MemoryBudget, Object, StructArray, TextArray, Value};
    use proptest::prelude::*;

    fn back(bytes: &[u8]) -> Vec<Variable> {
        read(bytes, &MemoryBudget::new(1 << 24, &|_| false)).unwrap()
    }

    fn named(name: &str, value: Value) -> Variable {
        Variable { name: name.to_owned(), value }
    }

    fn text(texts: &[&str], shape: &[usize]) -> Value {
        Value::Text(TextArray { shape: shape.to_vec(), texts: texts.iter().map(|&text| text.to_owned()).collect() })
    }

    fn shape() -> impl Strategy<Value = Vec<usize>> {
        prop::collection::vec(0..4_usize, 2..4)
    }

    fn numbers() -> impl Strategy<Value = Value> {
        let whole = (-9_000_000_000_000_000_i64..9_000_000_000_000_000).prop_map(|number| number as f64);
        // As many as the largest shape has room for.
        let both = |kind: ElementKind, number: BoxedStrategy<f64>| {
            let part = prop::collection::vec(number, 27);
            (Just(kind), part.clone(), part)
        };
        let parts = prop_oneof![
            both(ElementKind::Float, prop::num::f64::NORMAL.boxed()),
            both(ElementKind::Integer, whole.boxed()),
            both(ElementKind::Integer, (-9..9_i32).prop_map(f64::from).boxed()),
            both(ElementKind::Logical, (0..2_i32).prop_map(f64::from).boxed()),
        ];
        (shape(), parts, any::<bool>()).prop_map(|(shape, (kind, mut re, mut im), complex)| {
            let count = shape.iter().product();
            re.truncate(count);
            im.truncate(count);
            let im = if complex && kind != ElementKind::Logical { Some(im) } else { None };
            Value::Array(Array { shape, kind, re, im })
        })
    }

    fn value() -> impl Strategy<Value = Value> {
        let text = "\\PC{0,9}".prop_map(|text| super::tests::text(&[&text], &[1, 1]));
        prop_oneof![numbers(), text].prop_recursive(3, 24, 9, |inner| {
            let cell = (shape(), prop::collection::vec(inner.clone(), 27)).prop_map(|(shape, mut values)| {
                values.truncate(shape.iter().product());
                Value::Cell(CellArray { shape, values })
            });
            let fields = prop::collection::btree_map("[a-z][A-Za-z0-9_]{0,40}", inner, 0..4);
            let record = fields.prop_map(|fields| {
                let fields = fields.into_iter().map(|(name, value)| (name, vec![value])).collect();
                Value::Struct(StructArray { shape: vec![1, 1], fields })
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
        assert_eq!(uneven[0].value, Value::Cell(CellArray { shape: vec![1, 2], values }));
    }

    #[test]
    fn several_records_are_read_again() {
        let values = |numbers: [f64; 2]| numbers.map(|number| Value::Array(Array::matrix(1, 1, vec![number]))).to_vec();
        let fields = vec![("a".to_owned(), values([1.0, 2.0])), ("b".to_owned(), values([3.0, 4.0]))];
        let variables = [named("s", Value::Struct(StructArray { shape: vec![1, 2], fields }))];
        assert_eq!(back(&write(&variables).unwrap()), variables);
    }

    #[test]
    fn numbers_that_are_not_what_they_are_said_to_be_become_floating_point() {
        for kind in [ElementKind::Integer, ElementKind::Logical] {
            let array = Array { kind, ..Array::matrix(1, 2, vec![1.5, 1e300]) };
            let found = back(&write(&[named("x", Value::Array(array.clone()))]).unwrap());
            assert_eq!(found[0].value, Value::Array(Array { kind: ElementKind::Float, ..array }));
        }
    }

    #[test]
    fn objects_become_structs_and_what_was_not_read_is_empty() {
        let fields = vec![("a".to_owned(), vec![Value::Opaque { class: "x".to_owned(), why: "y".to_owned() }])];
        let records = StructArray { shape: vec![1, 1], fields };
        let object = Value::Object(Object { class: "ss".to_owned(), records });
        let found = back(&write(&[named("sys", object)]).unwrap());
        let Value::Struct(records) = &found[0].value else { panic!("{found:?}") };
        assert_eq!(records.field("a").unwrap()[0], Value::Array(Array::matrix(0, 0, Vec::new())));
    }
}
