//! NumPy files: `.npy` files with a single array, and `.npz` archives with several.
//!
//! The format follows NEP 1 and `numpy.lib.format`, versions 1.0 to 3.0. This program's arrays have
//! at least two dimensions: a scalar becomes 1 x 1, and a one-dimensional array with n elements
//! becomes 1 x n. Any other shape is kept, in either storage order. Pickled Python objects are
//! rejected, because unpickling executes code.

mod element;
mod header;
mod python_literal;
mod writer;

use crate::formats::element_order::{Places, element_count, matrix_shape};
use crate::formats::npy::element::{Element, Field};
use crate::formats::npy::header::{Header, MAGIC};
use crate::formats::stored_number::StoredNumber;
use crate::formats::variables::{
    Array, ElementKind, RECORD_MEMORY, StructArray, TextArray, Value, Variable,
};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unsupported_content::UnsupportedContent;

pub use crate::formats::npy::writer::write_npz;

/// Offset of the header text length in a file \[bytes\], given as the position for header errors.
const TEXT_LENGTH_AT: usize = 8;

pub(crate) const NPY: Importer = Importer {
    name: "a NumPy array",
    endings: &["npy"],
    recognises: |bytes, _| bytes.starts_with(MAGIC),
    read: |bytes, path, budget| {
        let name = path
            .file_stem()
            .and_then(|stem| stem.to_str())
            .unwrap_or_default();
        Contents::row_major(read_npy(bytes, name, budget), path)
    },
};

/// Reads a `.npy` file (`numpy.lib.format`, versions 1.0 to 3.0) as a single variable called
/// `name`.
///
/// A scalar becomes 1 x 1, and a one-dimensional array with n elements becomes 1 x n. Booleans,
/// integers, floats and complex numbers become an [`Array`], strings a [`TextArray`], and records a
/// [`StructArray`].
pub fn read_npy(
    bytes: &[u8],
    name: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let header = Header::parse(bytes, name, budget)?;
    let length =
        element_count(&header.shape).and_then(|count| count.checked_mul(header.element.size()));
    let Some(length) = length else {
        return Err(too_many_elements(name));
    };
    let data = &bytes[header.elements_at..];
    if data.len() < length {
        return Err(VariableFault::cut_off(name, bytes.len()));
    }
    if data.len() > length {
        return Err(VariableFault::unsupported(
            name,
            UnsupportedContent::DataAfterArray,
        ));
    }
    let stored = StoredArray {
        element: &header.element,
        shape: &header.shape,
        column_major: header.column_major,
        data,
    };
    let reader = ArrayReader { name, budget };
    Ok(vec![Variable {
        name: name.to_owned(),
        value: reader.value(&stored)?,
    }])
}

fn too_many_elements(name: &str) -> VariableFault {
    VariableFault::damaged(name, Damage::ShapeElementCount, TEXT_LENGTH_AT as u64)
}

/// Array elements as stored: those of the file, or those of a field within a record.
struct StoredArray<'a> {
    element: &'a Element,
    shape: &'a [usize],
    column_major: bool,
    data: &'a [u8],
}

impl<'a> StoredArray<'a> {
    /// Returns the bytes of the element at a place, counted in elements in stored order.
    fn bytes_at(&self, place: usize) -> &'a [u8] {
        let size = self.element.size();
        self.data
            .get(place * size..(place + 1) * size)
            .unwrap_or_default()
    }
}

/// Reads values within a budget; `name` is the variable name in errors.
struct ArrayReader<'r> {
    name: &'r str,
    budget: &'r ReadingBudget<'r>,
}

impl ArrayReader<'_> {
    /// Decodes an array, or the field of a record.
    fn value(&self, stored: &StoredArray<'_>) -> Result<Value, VariableFault> {
        let count = self.places(stored)?.len() as u64;
        let shape = matrix_shape(stored.shape);
        match stored.element {
            Element::Number(number) => {
                self.budget.take(count, 8, self.name)?;
                Ok(Value::Array(Array {
                    shape,
                    kind: number.kind(),
                    re: self.numbers(stored, *number, 0)?,
                    im: None,
                }))
            }
            Element::Complex(part) => {
                self.budget.take(count, 16, self.name)?;
                Ok(Value::Array(Array {
                    shape,
                    kind: ElementKind::Float,
                    re: self.numbers(stored, *part, 0)?,
                    im: Some(self.numbers(stored, *part, part.size())?),
                }))
            }
            Element::Unicode { big_endian, .. } => {
                let texts = self.texts(stored, |bytes| decode_unicode(bytes, *big_endian))?;
                Ok(Value::Text(TextArray { shape, texts }))
            }
            Element::Bytes { .. } => {
                let texts = self.texts(stored, decode_bytes)?;
                Ok(Value::Text(TextArray { shape, texts }))
            }
            Element::Record { fields, .. } => {
                // A header can announce any number of records without fields, or fields without
                // elements, which occupy no bytes in the file.
                self.budget.take(count, RECORD_MEMORY, self.name)?;
                let mut values = Vec::new();
                for field in fields {
                    values.push((field.name.clone(), self.field_values(stored, field)?));
                }
                Ok(Value::Struct(StructArray {
                    shape,
                    fields: values,
                }))
            }
        }
    }

    /// Returns the place of each element as stored, in column-major order.
    fn places(&self, stored: &StoredArray<'_>) -> Result<Places, VariableFault> {
        let places = if stored.column_major {
            Places::column_major(stored.shape)
        } else {
            Places::row_major(stored.shape)
        };
        places.ok_or_else(|| too_many_elements(self.name))
    }

    /// Decodes a number in each element; `offset` is its position within the element \[bytes\].
    fn numbers(
        &self,
        stored: &StoredArray<'_>,
        number: StoredNumber,
        offset: usize,
    ) -> Result<Vec<f64>, VariableFault> {
        let places = self.places(stored)?;
        let mut numbers = Vec::with_capacity(places.len());
        for (at, place) in places.enumerate() {
            self.budget.check_stop(at)?;
            let bytes = stored.bytes_at(place).get(offset..).unwrap_or_default();
            numbers.push(number.decode(bytes));
        }
        Ok(numbers)
    }

    /// Decodes each element as a string.
    fn texts(
        &self,
        stored: &StoredArray<'_>,
        decode: impl Fn(&[u8]) -> String,
    ) -> Result<Vec<String>, VariableFault> {
        let places = self.places(stored)?;
        let size = (size_of::<String>() + stored.element.size()) as u64;
        self.budget.take(places.len() as u64, size, self.name)?;
        let mut texts = Vec::new();
        for (at, place) in places.enumerate() {
            self.budget.check_stop(at)?;
            texts.push(decode(stored.bytes_at(place)));
        }
        Ok(texts)
    }

    /// Reads a field's values, in record order.
    fn field_values(
        &self,
        records: &StoredArray<'_>,
        field: &Field,
    ) -> Result<Vec<Value>, VariableFault> {
        let places = self.places(records)?;
        let size = size_of::<Value>() as u64 + RECORD_MEMORY;
        self.budget.take(places.len() as u64, size, self.name)?;
        let mut values = Vec::new();
        for place in places {
            values.push(
                self.value(&StoredArray {
                    element: &field.element,
                    shape: &field.shape,
                    column_major: false,
                    data: records
                        .bytes_at(place)
                        .get(field.offset..)
                        .unwrap_or_default(),
                })?,
            );
        }
        Ok(values)
    }
}

/// Decodes 32-bit characters and removes the zeros at the end.
fn decode_unicode(bytes: &[u8], big_endian: bool) -> String {
    let (characters, _) = bytes.as_chunks::<4>();
    let mut text = String::new();
    for &character in characters {
        let code = if big_endian {
            u32::from_be_bytes(character)
        } else {
            u32::from_le_bytes(character)
        };
        text.push(char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER));
    }
    text.trim_end_matches('\0').to_owned()
}

/// Decodes UTF-8 bytes and removes the zeros at the end.
fn decode_bytes(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes)
        .trim_end_matches('\0')
        .to_owned()
}

#[cfg(test)]
mod archive_tests {
    use super::*;
    use crate::formats::variables::Array;
    use crate::formats::zip_files::{read_archive, read_npz};
    use crate::variable_fault::unsupported_content::UnsupportedContent;

    fn file(name: &str) -> Vec<u8> {
        std::fs::read(format!(
            "{}/../../tests/data/npy/{name}.npz",
            env!("CARGO_MANIFEST_DIR")
        ))
        .unwrap()
    }

    fn read(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        read_npz(bytes, &ReadingBudget::new(1 << 20))
    }

    #[test]
    fn arrays_come_under_their_names_stored_or_packed() {
        for name in ["stored", "compressed"] {
            let variables = read(&file(name)).unwrap();
            let names: Vec<_> = variables
                .iter()
                .map(|variable| variable.name.as_str())
                .collect();
            assert_eq!(names, ["A", "b", "names"]);
            assert_eq!(
                variables[0].value,
                Value::Array(Array::matrix(2, 2, vec![1.0, 3.0, 2.0, 4.0]))
            );
        }
    }

    #[test]
    fn other_files_in_the_archive_are_named() {
        let budget = ReadingBudget::new(1 << 20);
        let Contents::Archive {
            variables, files, ..
        } = read_archive(&file("with_text"), &budget).unwrap()
        else {
            panic!("an archive")
        };
        assert_eq!(
            (variables.len(), files.len(), files[0].0.as_str()),
            (1, 1, "readme.txt")
        );
    }

    #[test]
    fn a_duplicate_name_is_refused() {
        assert_eq!(
            read(&file("duplicate")),
            Err(VariableFault::Duplicate {
                name: "a".to_owned()
            })
        );
    }

    #[test]
    fn an_archive_that_unpacks_to_more_than_is_allowed_is_refused_before_it_is_unpacked() {
        // This file expands from 8 kB to 8 MB of zeros.
        assert_eq!(
            read(&file("bomb")),
            Err(VariableFault::TooLarge {
                variable: "zeros".to_owned(),
                most_mib: 1
            })
        );
    }

    #[test]
    fn encrypted_entries_and_other_methods_are_refused_plainly() {
        let flags = |bytes: &mut Vec<u8>, local: usize, central: usize, value: u8| {
            let directory = bytes
                .windows(4)
                .position(|four| four == b"PK\x01\x02")
                .unwrap();
            bytes[local] = value;
            bytes[directory + central] = value;
        };
        let mut encrypted = file("stored");
        flags(&mut encrypted, 6, 8, 1);
        assert!(matches!(
            read(&encrypted),
            Err(VariableFault::Unsupported {
                content: UnsupportedContent::EncryptedEntry,
                ..
            })
        ));
        let mut other = file("stored");
        flags(&mut other, 8, 10, 12);
        assert!(matches!(
            read(&other),
            Err(VariableFault::Unsupported {
                content: UnsupportedContent::CompressionMethod { method: 12 },
                ..
            })
        ));
    }

    #[test]
    fn a_wrong_check_sum_is_damage() {
        let mut bytes = file("stored");
        let place = bytes
            .windows(8)
            .position(|eight| eight == 4f64.to_le_bytes())
            .unwrap();
        bytes[place + 5] ^= 1;
        assert!(
            matches!(read(&bytes), Err(VariableFault::Damaged { variable, .. }) if variable == "A")
        );
    }

    #[test]
    fn other_formats_and_cut_off_archives_are_refused() {
        assert!(matches!(read(b""), Err(VariableFault::Format { .. })));
        assert!(matches!(
            read(b"\x93NUMPY"),
            Err(VariableFault::Format { .. })
        ));
        assert!(matches!(
            read(&file("stored")[..200]),
            Err(VariableFault::CutOff { .. })
        ));
    }

    #[test]
    fn damage_anywhere_is_a_fault_and_never_a_panic() {
        for name in ["stored", "compressed"] {
            let whole = file(name);
            for length in 0..whole.len() {
                assert!(read(&whole[..length]).is_err(), "{name} cut to {length}");
            }
            for place in 0..whole.len() {
                for bit in 0..8 {
                    let mut bytes = whole.clone();
                    bytes[place] ^= 1 << bit;
                    let _ = read(&bytes);
                }
            }
        }
    }
}

#[cfg(test)]
mod array_file_tests {
    use super::*;

    fn read(file: &str) -> Result<Value, VariableFault> {
        let bytes = std::fs::read(format!(
            "{}/../../tests/data/npy/{file}.npy",
            env!("CARGO_MANIFEST_DIR")
        ))
        .unwrap();
        read_npy(&bytes, "x", &ReadingBudget::new(1 << 20))
            .map(|mut variables| variables.remove(0).value)
    }

    fn array(file: &str) -> Array {
        let Value::Array(array) = read(file).unwrap() else {
            panic!("{file} is no array")
        };
        array
    }

    #[test]
    fn a_matrix_keeps_its_rows_and_columns() {
        // [[1, 2, 3], [4, 5, 6]] in row-major and column-major order, in all three header versions.
        for file in [
            "matrix_c",
            "matrix_fortran",
            "matrix_big_endian",
            "matrix_version_2",
            "matrix_version_3",
        ] {
            assert_eq!(
                array(file),
                Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]),
                "{file}"
            );
        }
    }

    #[test]
    fn a_scalar_is_a_matrix_with_one_element_and_a_list_is_a_row() {
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
        assert_eq!(
            (truths.re.as_slice(), truths.kind),
            ([1.0, 0.0, 1.0].as_slice(), ElementKind::Logical)
        );
        for file in ["c8", "c16"] {
            assert_eq!(
                (array(file).re, array(file).im),
                (vec![1.0, -3.0], Some(vec![2.0, 0.5])),
                "{file}"
            );
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
    fn texts_come_without_their_padding() {
        let texts = |shape: &[usize], texts: &[&str]| {
            Value::Text(TextArray {
                shape: shape.to_vec(),
                texts: texts.iter().map(|&text| text.to_owned()).collect(),
            })
        };
        assert_eq!(
            read("unicode").unwrap(),
            texts(&[2, 2], &["u", "", "\u{3b8}_dot", "phi"])
        );
        assert_eq!(
            read("unicode_big_endian").unwrap(),
            texts(&[1, 2], &["u", "\u{3b8}_dot"])
        );
        assert_eq!(read("bytes").unwrap(), texts(&[1, 2], &["u", "theta"]));
    }

    #[test]
    fn records_become_structs() {
        let Value::Struct(records) = read("records").unwrap() else {
            panic!("no struct")
        };
        assert_eq!(records.shape, [1, 2]);
        assert_eq!(
            records.field("gain").unwrap()[1],
            Value::Array(Array::matrix(1, 1, vec![-2.0]))
        );
        let place = Array {
            kind: ElementKind::Integer,
            ..Array::matrix(1, 3, vec![1.0, 2.0, 3.0])
        };
        assert_eq!(records.field("place").unwrap()[0], Value::Array(place));
        assert_eq!(
            records.field("name").unwrap()[0],
            Value::Text(TextArray {
                shape: vec![1, 1],
                texts: vec!["q".to_owned()]
            })
        );
    }

    #[test]
    fn python_objects_are_refused_with_a_remedy() {
        assert_eq!(
            read("objects"),
            Err(VariableFault::unsupported(
                "x",
                UnsupportedContent::PythonObjects
            ))
        );
    }

    #[test]
    fn data_that_does_not_fit_its_shape_is_refused() {
        let file = |shape: &str, data: &[u8]| {
            let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}");
            let bytes = [
                b"\x93NUMPY\x01\x00".as_slice(),
                &(text.len() as u16).to_le_bytes(),
                text.as_bytes(),
                data,
            ]
            .concat();
            read_npy(&bytes, "x", &ReadingBudget::new(1 << 20)).unwrap_err()
        };
        assert!(matches!(
            file("(2,)", &[0; 15]),
            VariableFault::CutOff { .. }
        ));
        assert!(matches!(
            file("(2,)", &[0; 17]),
            VariableFault::Unsupported { .. }
        ));
        assert!(matches!(
            file("(4294967296, 4294967296)", &[0; 16]),
            VariableFault::Damaged { .. }
        ));
        assert!(matches!(
            file("(1000000000,)", &[0; 16]),
            VariableFault::CutOff { .. }
        ));
    }

    #[test]
    fn elements_without_bytes_do_not_exceed_the_memory_limit() {
        let text = "{'descr': '<U0', 'fortran_order': False, 'shape': (1000000000000,)}";
        let bytes = [
            b"\x93NUMPY\x01\x00".as_slice(),
            &(text.len() as u16).to_le_bytes(),
            text.as_bytes(),
        ]
        .concat();
        let fault = read_npy(&bytes, "x", &ReadingBudget::new(1 << 20)).unwrap_err();
        assert!(matches!(fault, VariableFault::TooLarge { .. }));
    }
}
