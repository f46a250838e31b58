//! Files of one array.

use super::element::{Element, Field};
use super::header::Header;
use crate::places::{Places, count};
use crate::stored_number::StoredNumber;
use crate::variables::{Array, ElementKind, MemoryBudget, StructArray, TextArray, Value, Variable, VariableFault};

/// Reads a `.npy` file (`numpy.lib.format`, versions 1.0 to 3.0) as one variable, which is given the name `name`.
///
/// A number alone becomes 1 x 1, an array of n elements the row 1 x n. Booleans, whole numbers, floats and complex numbers become an
/// [`Array`], texts a [`TextArray`], records a [`StructArray`].
pub fn read_npy(bytes: &[u8], name: &str, meter: &MemoryBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    let header = Header::parse(bytes, name)?;
    let damaged = |what: &str| VariableFault::Damaged { variable: name.to_owned(), what: what.to_owned(), offset: 8 };
    let too_many = || damaged("the shape has more elements than can be counted");
    let length =
        count(&header.shape).and_then(|count| count.checked_mul(header.element.size())).ok_or_else(too_many)?;
    let data = &bytes[header.length..];
    if data.len() < length {
        return Err(VariableFault::CutOff { variable: name.to_owned(), offset: bytes.len() as u64 });
    }
    if data.len() > length {
        let what = "something behind the array".to_owned();
        let remedy = "save one array in each .npy file, several with numpy.savez".to_owned();
        return Err(VariableFault::Unsupported { variable: name.to_owned(), what, remedy });
    }
    let stored =
        StoredArray { element: &header.element, shape: &header.shape, column_major: header.column_major, data };
    Ok(vec![Variable { name: name.to_owned(), value: stored.value(name, meter)? }])
}

/// The elements of an array as they stand in a file.
struct StoredArray<'a> {
    element: &'a Element,
    shape: &'a [usize],
    column_major: bool,
    data: &'a [u8],
}

impl StoredArray<'_> {
    fn value(&self, name: &str, meter: &MemoryBudget<'_>) -> Result<Value, VariableFault> {
        let elements = self.places(name)?.len() as u64;
        match self.element {
            Element::Number(number) => {
                meter.take(elements, 8, name)?;
                let re = self.numbers(*number, 0, name)?;
                Ok(Value::Array(Array { shape: matrix_shape(self.shape), kind: number.kind(), re, im: None }))
            }
            Element::Complex(part) => {
                meter.take(elements, 16, name)?;
                let (re, im) = (self.numbers(*part, 0, name)?, Some(self.numbers(*part, part.size(), name)?));
                Ok(Value::Array(Array { shape: matrix_shape(self.shape), kind: ElementKind::Float, re, im }))
            }
            Element::Unicode { .. } | Element::Bytes { .. } => {
                meter.take(elements, (size_of::<String>() + self.element.size()) as u64, name)?;
                let texts = self.places(name)?.map(|place| self.text(place)).collect();
                Ok(Value::Text(TextArray { shape: matrix_shape(self.shape), texts }))
            }
            Element::Record { fields, .. } => {
                let fields = fields.iter().map(|field| self.field(field, name, meter)).collect::<Result<_, _>>()?;
                Ok(Value::Struct(StructArray { shape: matrix_shape(self.shape), fields }))
            }
        }
    }

    fn places(&self, name: &str) -> Result<Places, VariableFault> {
        let places = if self.column_major { Places::column_major(self.shape) } else { Places::row_major(self.shape) };
        let what = "the shape has more elements than can be counted";
        places.ok_or_else(|| VariableFault::Damaged { variable: name.to_owned(), what: what.to_owned(), offset: 8 })
    }

    /// The bytes of one element.
    fn at(&self, place: usize) -> &[u8] {
        let size = self.element.size();
        self.data.get(place * size..(place + 1) * size).unwrap_or_default()
    }

    fn numbers(&self, number: StoredNumber, offset: usize, name: &str) -> Result<Vec<f64>, VariableFault> {
        let decode = |place| number.decode(self.at(place).get(offset..).unwrap_or_default());
        Ok(self.places(name)?.map(decode).collect())
    }

    fn text(&self, place: usize) -> String {
        let bytes = self.at(place);
        match self.element {
            Element::Unicode { big_endian, .. } => {
                let character = |four: &[u8]| {
                    let bits = four.iter().rev().fold(0, |bits, &byte| bits << 8 | u32::from(byte));
                    let bits = if *big_endian { bits.swap_bytes() } else { bits };
                    char::from_u32(bits).unwrap_or(char::REPLACEMENT_CHARACTER)
                };
                let text: String = bytes.chunks_exact(4).map(character).collect();
                text.trim_end_matches('\0').to_owned()
            }
            _ => String::from_utf8_lossy(bytes).trim_end_matches('\0').to_owned(),
        }
    }

    fn field(
        &self,
        field: &Field,
        name: &str,
        meter: &MemoryBudget<'_>,
    ) -> Result<(String, Vec<Value>), VariableFault> {
        let places = self.places(name)?;
        meter.take(places.len() as u64, size_of::<Value>() as u64, name)?;
        let values = places.map(|place| {
            let record = self.at(place).get(field.offset..).unwrap_or_default();
            StoredArray { element: &field.element, shape: &field.shape, column_major: false, data: record }
                .value(name, meter)
        });
        Ok((field.name.clone(), values.collect::<Result<_, _>>()?))
    }
}

/// The shape with at least two dimensions: numbers alone are 1 x 1, lists are rows.
fn matrix_shape(shape: &[usize]) -> Vec<usize> {
    match *shape {
        [] => vec![1, 1],
        [columns] => vec![1, columns],
        _ => shape.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &str) -> Result<Value, VariableFault> {
        let bytes = std::fs::read(format!("{}/../../tests/data/npy/{file}.npy", env!("CARGO_MANIFEST_DIR"))).unwrap();
        read_npy(&bytes, "x", &MemoryBudget::new(1 << 20, &|_| false)).map(|mut variables| variables.remove(0).value)
    }

    fn array(file: &str) -> Array {
        let Value::Array(array) = read(file).unwrap() else { panic!("{file} is no array") };
        array
    }

    #[test]
    fn a_matrix_keeps_its_rows_and_columns() {
        // [[1, 2, 3], [4, 5, 6]], row by row and column by column, in all three versions of the header.
        for file in ["matrix_c", "matrix_fortran", "matrix_big_endian", "matrix_version_2", "matrix_version_3"] {
            assert_eq!(array(file), Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]), "{file}");
        }
    }

    #[test]
    fn a_number_alone_is_a_matrix_of_one_and_a_list_is_a_row() {
        assert_eq!(array("scalar"), Array::matrix(1, 1, vec![2.5]));
        assert_eq!(array("list"), Array::matrix(1, 3, vec![1.0, 2.0, 3.0]));
        assert_eq!(array("empty").shape, [0, 4]);
    }

    #[test]
    fn every_kind_of_number_is_read() {
        for file in ["i1", "i2", "i4", "i8", "i2_big_endian"] {
            assert_eq!(array(file).re, [-3.0, 0.0, 100.0], "{file}");
            assert_eq!(array(file).kind, ElementKind::Integer);
        }
        for file in ["u1", "u2", "u4", "u8"] {
            assert_eq!(array(file).re, [0.0, 7.0, 200.0], "{file}");
        }
        for file in ["f2", "f4"] {
            assert_eq!(array(file).re, [-0.5, 1.25, f64::INFINITY], "{file}");
        }
        let truths = array("bool");
        assert_eq!((truths.re.as_slice(), truths.kind), ([1.0, 0.0, 1.0].as_slice(), ElementKind::Logical));
        for file in ["c8", "c16"] {
            assert_eq!((array(file).re, array(file).im), (vec![1.0, -3.0], Some(vec![2.0, 0.5])), "{file}");
        }
    }

    #[test]
    fn three_dimensions_run_with_the_first_fastest() {
        // numpy.arange(24).reshape(2, 3, 4): element (i, j, k) is 12 i + 4 j + k.
        let cube = array("cube");
        assert_eq!(cube.shape, [2, 3, 4]);
        assert_eq!(cube.re[..4], [0.0, 12.0, 4.0, 16.0]);
        assert_eq!(cube.re[6], 1.0);
    }

    #[test]
    fn texts_come_without_the_zeros_behind_them() {
        let texts = |shape: &[usize], texts: &[&str]| {
            Value::Text(TextArray { shape: shape.to_vec(), texts: texts.iter().map(|&text| text.to_owned()).collect() })
        };
        assert_eq!(read("unicode").unwrap(), texts(&[2, 2], &["u", "", "\u{3b8}_dot", "phi"]));
        assert_eq!(read("unicode_big_endian").unwrap(), texts(&[1, 2], &["u", "\u{3b8}_dot"]));
        assert_eq!(read("bytes").unwrap(), texts(&[1, 2], &["u", "theta"]));
    }

    #[test]
    fn records_become_structs() {
        let Value::Struct(records) = read("records").unwrap() else { panic!("no struct") };
        assert_eq!(records.shape, [1, 2]);
        assert_eq!(records.field("gain").unwrap()[1], Value::Array(Array::matrix(1, 1, vec![-2.0])));
        let place = Array { kind: ElementKind::Integer, ..Array::matrix(1, 3, vec![1.0, 2.0, 3.0]) };
        assert_eq!(records.field("place").unwrap()[0], Value::Array(place));
        assert_eq!(
            records.field("name").unwrap()[0],
            Value::Text(TextArray { shape: vec![1, 1], texts: vec!["q".to_owned()] })
        );
    }

    #[test]
    fn python_objects_are_refused_with_the_way_out() {
        let fault = read("objects").unwrap_err();
        let words = "variable x: an array of Python objects cannot be read; save plain arrays, one for each name";
        assert_eq!(fault.to_string(), words);
    }

    #[test]
    fn what_does_not_fit_its_shape_is_refused() {
        let file = |shape: &str, data: &[u8]| {
            let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}");
            let bytes =
                [b"\x93NUMPY\x01\x00".as_slice(), &(text.len() as u16).to_le_bytes(), text.as_bytes(), data].concat();
            read_npy(&bytes, "x", &MemoryBudget::new(1 << 20, &|_| false)).unwrap_err()
        };
        assert!(matches!(file("(2,)", &[0; 15]), VariableFault::CutOff { .. }));
        assert!(matches!(file("(2,)", &[0; 17]), VariableFault::Unsupported { .. }));
        assert!(matches!(file("(4294967296, 4294967296)", &[0; 16]), VariableFault::Damaged { .. }));
        assert!(matches!(file("(1000000000,)", &[0; 16]), VariableFault::CutOff { .. }));
    }

    #[test]
    fn elements_of_no_bytes_do_not_take_more_memory_than_is_allowed() {
        let text = "{'descr': '<U0', 'fortran_order': False, 'shape': (1000000000000,)}";
        let bytes = [b"\x93NUMPY\x01\x00".as_slice(), &(text.len() as u16).to_le_bytes(), text.as_bytes()].concat();
        let fault = read_npy(&bytes, "x", &MemoryBudget::new(1 << 20, &|_| false)).unwrap_err();
        assert!(matches!(fault, VariableFault::TooLarge { .. }));
    }
}
