//! `NumPy` files: `.npy` files of one array, `.npz` archives of several.
//!
//! The format follows NEP 1 and `numpy.lib.format`, versions 1.0 to 3.0. `NumPy` has arrays with
//! zero and one dimension, this program does not: a scalar becomes 1 x 1, an array of n elements
//! the row 1 x n. Any other shape is kept; rows stay rows in either storage order. Pickled Python
//! objects are programs and are refused.

mod element;

use std::collections::HashSet;
use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, ZipArchiveWriter};

use super::strides::{Places, StoredNumber, count, matrix_shape};
use super::variables::{Array, ElementKind, RECORD, StructArray, TextArray, Value, Variable};
use crate::formats::npy::element::{Element, Field, Header, MAGIC};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// A NumPy array.
pub(crate) const NPY: Importer = Importer {
    name: "an array of NumPy",
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

// Files with one array.

/// Reads a `.npy` file (`numpy.lib.format`, versions 1.0 to 3.0) as one variable called `name`.
///
/// A scalar becomes 1 x 1, an array of n elements the row 1 x n. Booleans, integers, floats and
/// complex numbers become an [`Array`], texts a [`TextArray`], records a [`StructArray`].
pub fn read_npy(
    bytes: &[u8],
    name: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let header = Header::parse(bytes, name, budget)?;
    let length = count(&header.shape).and_then(|count| count.checked_mul(header.element.size()));
    let length = length.ok_or_else(|| too_many(name))?;
    let data = &bytes[header.length..];
    if data.len() < length {
        return Err(VariableFault::cut_off(name, bytes.len()));
    }
    if data.len() > length {
        let remedy = "save one array in each .npy file, several with numpy.savez";
        return Err(VariableFault::unsupported(
            name,
            "something behind the array",
            remedy,
        ));
    }
    let stored = StoredArray {
        element: &header.element,
        shape: &header.shape,
        column_major: header.column_major,
        data,
    };
    Ok(vec![Variable {
        name: name.to_owned(),
        value: stored.value(name, budget)?,
    }])
}

fn too_many(name: &str) -> VariableFault {
    VariableFault::damaged(name, "the shape has more elements than can be counted", 8)
}

/// Array elements as stored in a file.
struct StoredArray<'a> {
    element: &'a Element,
    shape: &'a [usize],
    column_major: bool,
    data: &'a [u8],
}

impl StoredArray<'_> {
    fn value(&self, name: &str, budget: &ReadingBudget<'_>) -> Result<Value, VariableFault> {
        let elements = self.places(name)?.len() as u64;
        match self.element {
            Element::Number(number) => {
                budget.take(elements, 8, name)?;
                let re = self.numbers(*number, 0, name, budget)?;
                Ok(Value::Array(Array {
                    shape: matrix_shape(self.shape),
                    kind: number.kind(),
                    re,
                    im: None,
                }))
            }
            Element::Complex(part) => {
                budget.take(elements, 16, name)?;
                let numbers = |offset| self.numbers(*part, offset, name, budget);
                let re = numbers(0)?;
                let im = Some(numbers(part.size())?);
                Ok(Value::Array(Array {
                    shape: matrix_shape(self.shape),
                    kind: ElementKind::Float,
                    re,
                    im,
                }))
            }
            Element::Unicode { .. } | Element::Bytes { .. } => {
                budget.take(
                    elements,
                    (size_of::<String>() + self.element.size()) as u64,
                    name,
                )?;
                let text = |(at, place)| budget.go_on(at).map(|()| self.text(place));
                let texts = self
                    .places(name)?
                    .enumerate()
                    .map(text)
                    .collect::<Result<_, _>>()?;
                Ok(Value::Text(TextArray {
                    shape: matrix_shape(self.shape),
                    texts,
                }))
            }
            Element::Record { fields, .. } => {
                // Records without fields, or fields without elements, can be announced in any
                // number without bytes.
                budget.take(elements, RECORD, name)?;
                let fields = fields
                    .iter()
                    .map(|field| self.field(field, name, budget))
                    .collect::<Result<_, _>>()?;
                Ok(Value::Struct(StructArray {
                    shape: matrix_shape(self.shape),
                    fields,
                }))
            }
        }
    }

    fn places(&self, name: &str) -> Result<Places, VariableFault> {
        let places = if self.column_major {
            Places::column_major(self.shape)
        } else {
            Places::row_major(self.shape)
        };
        places.ok_or_else(|| too_many(name))
    }

    /// Returns the bytes of one element.
    fn at(&self, place: usize) -> &[u8] {
        let size = self.element.size();
        self.data
            .get(place * size..(place + 1) * size)
            .unwrap_or_default()
    }

    fn numbers(
        &self,
        number: StoredNumber,
        offset: usize,
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Vec<f64>, VariableFault> {
        let decode = |(at, place)| {
            budget.go_on(at)?;
            Ok(number.decode(self.at(place).get(offset..).unwrap_or_default()))
        };
        self.places(name)?.enumerate().map(decode).collect()
    }

    fn text(&self, place: usize) -> String {
        let bytes = self.at(place);
        match self.element {
            Element::Unicode { big_endian, .. } => {
                let character = |four: &[u8]| {
                    let bits = four
                        .iter()
                        .rev()
                        .fold(0, |bits, &byte| bits << 8 | u32::from(byte));
                    let bits = if *big_endian { bits.swap_bytes() } else { bits };
                    char::from_u32(bits).unwrap_or(char::REPLACEMENT_CHARACTER)
                };
                let text: String = bytes.chunks_exact(4).map(character).collect();
                text.trim_end_matches('\0').to_owned()
            }
            _ => String::from_utf8_lossy(bytes)
                .trim_end_matches('\0')
                .to_owned(),
        }
    }

    fn field(
        &self,
        field: &Field,
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<(String, Vec<Value>), VariableFault> {
        let places = self.places(name)?;
        budget.take(
            places.len() as u64,
            size_of::<Value>() as u64 + RECORD,
            name,
        )?;
        let values = places.map(|place| {
            let record = self.at(place).get(field.offset..).unwrap_or_default();
            StoredArray {
                element: &field.element,
                shape: &field.shape,
                column_major: false,
                data: record,
            }
            .value(name, budget)
        });
        Ok((field.name.clone(), values.collect::<Result<_, _>>()?))
    }
}

// Writing of archives for `NumPy`.

/// Alignment of the elements, required by `numpy.lib.format` \[bytes\].
const ALIGNMENT: usize = 64;
/// Largest integer up to which all integers are exact floats.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Writes arrays and texts as an `.npz` archive that `numpy.load` opens without pickles; refuses
/// values of other kinds.
///
/// Arrays keep their shape and are stored by columns (`fortran_order`): floats as `<f8`, complex
/// numbers as `<c16`, integers as `<i8`, logical values as `|b1`, texts as `<U`.
pub fn write_npz(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    let mut bytes = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut bytes);
    let mut names = HashSet::new();
    for variable in variables {
        if !names.insert(variable.name.as_str()) {
            return Err(VariableFault::Duplicate {
                name: variable.name.clone(),
            });
        }
        let array = match &variable.value {
            Value::Array(array) => numbers(array),
            Value::Text(texts) => characters(texts),
            other => return Err(refused(&variable.name, other.words())),
        };
        entry(&mut archive, &variable.name, &array)
            .map_err(|_| refused(&variable.name, "a name this long".to_owned()))?;
    }
    archive
        .finish()
        .map_err(|_| refused("", "an archive this large".to_owned()))?;
    Ok(bytes)
}

fn refused(name: &str, what: String) -> VariableFault {
    let remedy = "write arrays and texts under short names";
    VariableFault::unsupported(name, format!("{what} cannot be written, so it"), remedy)
}

fn entry(
    archive: &mut ZipArchiveWriter<&mut Vec<u8>>,
    name: &str,
    array: &[u8],
) -> Result<(), rawzip::Error> {
    let path = format!("{name}.npy");
    let (mut entry, config) = archive
        .new_file(path.as_str())
        .compression_method(CompressionMethod::DEFLATE)
        .start()?;
    let mut packer = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
    packer.write_all(array)?;
    let (encoder, descriptor) = packer.finish()?;
    encoder.finish()?;
    entry.finish(descriptor)?;
    Ok(())
}

fn numbers(array: &Array) -> Vec<u8> {
    let whole = |value: &f64| value.fract() == 0.0 && value.abs() <= LARGEST_WHOLE;
    let pairs = |im: &Vec<f64>| {
        array
            .re
            .iter()
            .zip(im)
            .flat_map(|(re, im)| [*re, *im])
            .flat_map(f64::to_le_bytes)
            .collect()
    };
    let (descr, data): (_, Vec<u8>) = match (&array.im, array.kind) {
        (Some(im), _) => ("<c16", pairs(im)),
        (None, ElementKind::Logical) => (
            "|b1",
            array
                .re
                .iter()
                .map(|&value| u8::from(value != 0.0))
                .collect(),
        ),
        (None, ElementKind::Integer) if array.re.iter().all(whole) => (
            "<i8",
            array
                .re
                .iter()
                .flat_map(|&value| (value as i64).to_le_bytes())
                .collect(),
        ),
        (None, _) => (
            "<f8",
            array
                .re
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
        ),
    };
    file(descr, &array.shape, &data)
}

fn characters(texts: &TextArray) -> Vec<u8> {
    // NumPy also writes empty texts with space for one character.
    let longest = texts
        .texts
        .iter()
        .map(|text| text.chars().count())
        .max()
        .unwrap_or(0)
        .max(1);
    let mut data = Vec::with_capacity(4 * longest * texts.texts.len());
    for text in &texts.texts {
        let characters = text
            .chars()
            .map(u32::from)
            .chain(std::iter::repeat(0))
            .take(longest);
        data.extend(characters.flat_map(u32::to_le_bytes));
    }
    file(&format!("<U{longest}"), &texts.shape, &data)
}

fn file(descr: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let shape: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let text = format!("{{'descr': '{descr}', 'fortran_order': True, 'shape': ({shape}), }}");
    // Magic, version and length before the text, a line break after it.
    let length = (10 + text.len() + 1).next_multiple_of(ALIGNMENT) - 10;
    let header = format!("{text:<width$}\n", width = length - 1);
    [
        MAGIC.as_slice(),
        &[1, 0],
        &(length as u16).to_le_bytes(),
        header.as_bytes(),
        data,
    ]
    .concat()
}

#[cfg(test)]
mod archive_tests {
    use super::*;
    use crate::formats::variables::Array;
    use crate::formats::zip_files::{read_archive, read_npz};

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
    fn a_name_that_stands_twice_is_refused() {
        assert_eq!(
            read(&file("duplicate")),
            Err(VariableFault::Duplicate {
                name: "a".to_owned()
            })
        );
    }

    #[test]
    fn an_archive_that_unpacks_to_more_than_is_allowed_is_refused_before_it_is_unpacked() {
        // 8 MB of zeros in 8 kB.
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
        assert!(
            read(&encrypted)
                .unwrap_err()
                .to_string()
                .contains("an encrypted entry cannot be read")
        );
        let mut other = file("stored");
        flags(&mut other, 8, 10, 12);
        assert!(
            read(&other)
                .unwrap_err()
                .to_string()
                .contains("an entry packed by method 12 cannot be read")
        );
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
    fn what_is_no_archive_is_named() {
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
        // [[1, 2, 3], [4, 5, 6]], by rows and by columns, in all three header versions.
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
    fn texts_come_without_the_zeros_behind_them() {
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
    fn python_objects_are_refused_with_the_way_out() {
        let fault = read("objects").unwrap_err();
        let words = "variable x: an array of Python objects cannot be read; save plain arrays, one for each name";
        assert_eq!(fault.to_string(), words);
    }

    #[test]
    fn what_does_not_fit_its_shape_is_refused() {
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
    fn elements_of_no_bytes_do_not_take_more_memory_than_is_allowed() {
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

#[cfg(test)]
mod archive_writer_tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::variables::CellArray;
    use crate::formats::zip_files::read_npz;
    use crate::reading_budget::ReadingBudget;

    fn read(bytes: &[u8]) -> Vec<Variable> {
        read_npz(bytes, &ReadingBudget::new(1 << 24)).unwrap()
    }

    #[test]
    fn the_bytes_are_those_that_numpy_was_seen_to_load() {
        // tests/data/make_files.py loads this file with numpy.load and compares every element.
        let complex = Array {
            im: Some(vec![0.5, -0.5]),
            ..Array::matrix(1, 2, vec![1.0, 2.0])
        };
        let whole = Array {
            kind: ElementKind::Integer,
            ..Array::matrix(1, 2, vec![-3.0, 4.0])
        };
        let truths = Array {
            kind: ElementKind::Logical,
            ..Array::matrix(2, 1, vec![1.0, 0.0])
        };
        let texts = TextArray {
            shape: vec![1, 2],
            texts: vec!["u".to_owned(), "\u{3b8}_dot".to_owned()],
        };
        let variables = [
            (
                "A",
                Value::Array(Array::matrix(
                    2,
                    3,
                    vec![1.0, 4.0, 2.0, 5.0, 3.0, f64::INFINITY],
                )),
            ),
            ("c", Value::Array(complex)),
            ("i", Value::Array(whole)),
            ("t", Value::Array(truths)),
            ("names", Value::Text(texts)),
        ];
        let variables = variables.map(|(name, value)| Variable {
            name: name.to_owned(),
            value,
        });
        let written = write_npz(&variables).unwrap();
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../tests/data/npy/written.npz"
        );
        if std::env::var_os("GDCM_WRITE_FILES").is_some() {
            std::fs::write(path, &written).unwrap();
        }
        assert_eq!(read(&std::fs::read(path).unwrap()), variables);
        assert_eq!(read(&written), variables);
    }

    #[test]
    fn other_values_and_names_that_stand_twice_are_refused() {
        let cell = Value::Cell(CellArray {
            shape: vec![0, 0],
            values: Vec::new(),
        });
        let refused = write_npz(&[Variable {
            name: "c".to_owned(),
            value: cell,
        }]);
        assert!(
            matches!(refused, Err(VariableFault::Unsupported { variable, .. }) if variable == "c")
        );
        let one = Variable {
            name: "a".to_owned(),
            value: Value::Array(Array::matrix(1, 1, vec![1.0])),
        };
        assert_eq!(
            write_npz(&[one.clone(), one]),
            Err(VariableFault::Duplicate {
                name: "a".to_owned()
            })
        );
    }

    fn value() -> impl Strategy<Value = Value> {
        let shape = prop::collection::vec(0..4usize, 2..4);
        (shape, any::<bool>(), any::<bool>()).prop_flat_map(|(shape, complex, text)| {
            let count = shape.iter().product::<usize>();
            let floats = || prop::collection::vec(-1e300..1e300, count);
            let texts = prop::collection::vec("[a-z\u{3b1}-\u{3c9}]{0,5}", count);
            (Just(shape), floats(), floats(), texts).prop_map(move |(shape, re, im, texts)| {
                if text {
                    return Value::Text(TextArray { shape, texts });
                }
                Value::Array(Array {
                    shape,
                    kind: ElementKind::Float,
                    re,
                    im: complex.then_some(im),
                })
            })
        })
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back(values in prop::collection::vec(value(), 0..4)) {
            let name = |(index, value)| Variable { name: format!("x{index}"), value };
            let variables: Vec<_> = values.into_iter().enumerate().map(name).collect();
            prop_assert_eq!(read(&write_npz(&variables).unwrap()), variables);
        }
    }
}
