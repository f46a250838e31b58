//! Writes archives for NumPy (".npz"); `header.rs` shows the layout of the files in them.

use std::collections::HashSet;
use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, ZipArchiveWriter};

use crate::formats::npy::header::MAGIC;
use crate::formats::variables::{Array, ElementKind, TextArray, Value, Variable};
use crate::reading_budget::VariableFault;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Alignment of the first element in the file \[bytes\], required by `numpy.lib.format`.
const ALIGNMENT: usize = 64;
/// Number of bytes before the header text: signature, version and header length.
const BEFORE_TEXT: usize = 10;
/// 2^53: all integers up to this value are exact as floats.
const LARGEST_EXACT_INTEGER: f64 = 9_007_199_254_740_992.0;

/// Writes arrays and strings as an `.npz` archive that `numpy.load` opens with
/// `allow_pickle=False`.
///
/// Arrays keep their shape and are stored in column-major order (`fortran_order`): floats as `<f8`,
/// complex numbers as `<c16`, integers as `<i8` (as `<f8` if one exceeds 2^53), logical values as
/// `|b1`, and strings as `<U`.
///
/// # Errors
///
/// [`VariableFault`] for a duplicate name, a name that is too long, a value that is neither an
/// array nor strings, and an archive that is too large.
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
            Value::Array(array) => encode_numbers(array),
            Value::Text(texts) => encode_texts(texts),
            other => {
                return Err(VariableFault::unsupported(
                    &variable.name,
                    UnsupportedContent::ValueNotWritten {
                        value: other.words(),
                    },
                ));
            }
        };
        write_entry(&mut archive, &variable.name, &array).map_err(|_| {
            VariableFault::unsupported(&variable.name, UnsupportedContent::LongNameNotWritten)
        })?;
    }
    archive
        .finish()
        .map_err(|_| VariableFault::unsupported("", UnsupportedContent::LargeArchiveNotWritten))?;
    Ok(bytes)
}

/// Adds an array to an archive as a compressed `.npy` file.
fn write_entry(
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

/// Encodes numbers as a `.npy` file. Integers beyond the exact range are written as floats.
fn encode_numbers(array: &Array) -> Vec<u8> {
    let re = &array.re;
    let shape = &array.shape;
    if let Some(im) = &array.im {
        let pairs = re.iter().zip(im).flat_map(|(&re, &im)| [re, im]);
        let data: Vec<u8> = pairs.flat_map(f64::to_le_bytes).collect();
        return encode_file("<c16", shape, &data);
    }
    match array.kind {
        ElementKind::Logical => {
            let data: Vec<u8> = re.iter().map(|&value| u8::from(value != 0.0)).collect();
            encode_file("|b1", shape, &data)
        }
        ElementKind::Integer if re.iter().copied().all(is_exact_integer) => {
            let data: Vec<u8> = re
                .iter()
                .flat_map(|&value| (value as i64).to_le_bytes())
                .collect();
            encode_file("<i8", shape, &data)
        }
        _ => {
            let data: Vec<u8> = re.iter().flat_map(|value| value.to_le_bytes()).collect();
            encode_file("<f8", shape, &data)
        }
    }
}

fn is_exact_integer(value: f64) -> bool {
    value.fract() == 0.0 && value.abs() <= LARGEST_EXACT_INTEGER
}

/// Encodes strings as a `.npy` file; shorter strings are padded with zeros.
fn encode_texts(texts: &TextArray) -> Vec<u8> {
    // Like NumPy, reserve at least one character, even if all strings are empty.
    let mut longest = 1;
    for text in &texts.texts {
        longest = longest.max(text.chars().count());
    }
    let mut data = Vec::with_capacity(4 * longest * texts.texts.len());
    for text in &texts.texts {
        let characters = text
            .chars()
            .map(u32::from)
            .chain(std::iter::repeat(0))
            .take(longest);
        data.extend(characters.flat_map(u32::to_le_bytes));
    }
    encode_file(&format!("<U{longest}"), &texts.shape, &data)
}

/// Returns a `.npy` file: header and data.
fn encode_file(descr: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let shape: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let text = format!("{{'descr': '{descr}', 'fortran_order': True, 'shape': ({shape}), }}");
    // The header is padded with blanks up to the alignment, and ends in a line feed.
    let length = (BEFORE_TEXT + text.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE_TEXT;
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
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::variables::CellArray;
    use crate::formats::zip_files::read_npz;
    use crate::reading_budget::ReadingBudget;

    fn read(bytes: &[u8]) -> Vec<Variable> {
        read_npz(bytes, &ReadingBudget::new(1 << 24)).unwrap()
    }

    #[test]
    fn the_file_that_numpy_loads_is_read_back() {
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
    fn other_values_and_duplicate_names_are_refused() {
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
                    im: if complex { Some(im) } else { None },
                })
            })
        })
    }

    proptest! {
        #[test]
        fn written_values_are_read_back(values in prop::collection::vec(value(), 0..4)) {
            let mut variables = Vec::new();
            for (index, value) in values.into_iter().enumerate() {
                variables.push(Variable { name: format!("x{index}"), value });
            }
            prop_assert_eq!(read(&write_npz(&variables).unwrap()), variables);
        }
    }
}
