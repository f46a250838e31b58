//! Archives written for `NumPy`.

use std::collections::HashSet;
use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, ZipArchiveWriter};

use super::header::MAGIC;
use crate::variables::{Array, ElementKind, TextArray, Value, Variable, VariableFault};

/// The elements begin at a multiple of this, as `numpy.lib.format` asks for.
const ALIGNMENT: usize = 64;
/// Whole numbers up to here are floats without rounding.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Writes arrays and texts as an `.npz` archive that `numpy.load` opens without pickles; values of other kinds are refused.
///
/// Arrays keep their shape and run column by column (`fortran_order`): floats as `<f8`, complex numbers as `<c16`, whole numbers as
/// `<i8`, truths as `|b1`, texts as `<U`.
pub fn write_npz(variables: &[Variable]) -> Result<Vec<u8>, VariableFault> {
    let mut bytes = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut bytes);
    let mut names = HashSet::new();
    for variable in variables {
        if !names.insert(variable.name.as_str()) {
            return Err(VariableFault::Duplicate { name: variable.name.clone() });
        }
        let array = match &variable.value {
            Value::Array(array) => numbers(array),
            Value::Text(texts) => characters(texts),
            other => return Err(refused(&variable.name, other.words())),
        };
        entry(&mut archive, &variable.name, &array)
            .map_err(|_| refused(&variable.name, "a name this long".to_owned()))?;
    }
    archive.finish().map_err(|_| refused("", "an archive this large".to_owned()))?;
    Ok(bytes)
}

fn refused(name: &str, what: String) -> VariableFault {
    let remedy = "write arrays and texts under short names".to_owned();
    VariableFault::Unsupported { variable: name.to_owned(), what: format!("{what} cannot be written, so it"), remedy }
}

fn entry(archive: &mut ZipArchiveWriter<&mut Vec<u8>>, name: &str, array: &[u8]) -> Result<(), rawzip::Error> {
    let path = format!("{name}.npy");
    let (mut entry, config) = archive.new_file(path.as_str()).compression_method(CompressionMethod::DEFLATE).start()?;
    let mut packer = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
    packer.write_all(array)?;
    let (encoder, descriptor) = packer.finish()?;
    encoder.finish()?;
    entry.finish(descriptor)?;
    Ok(())
}

fn numbers(array: &Array) -> Vec<u8> {
    let whole = |value: &f64| value.fract() == 0.0 && value.abs() <= LARGEST_WHOLE;
    let pairs =
        |im: &Vec<f64>| array.re.iter().zip(im).flat_map(|(re, im)| [*re, *im]).flat_map(f64::to_le_bytes).collect();
    let (descr, data): (_, Vec<u8>) = match (&array.im, array.kind) {
        (Some(im), _) => ("<c16", pairs(im)),
        (None, ElementKind::Logical) => ("|b1", array.re.iter().map(|&value| u8::from(value != 0.0)).collect()),
        (None, ElementKind::Integer) if array.re.iter().all(whole) => {
            ("<i8", array.re.iter().flat_map(|&value| (value as i64).to_le_bytes()).collect())
        }
        (None, _) => ("<f8", array.re.iter().flat_map(|value| value.to_le_bytes()).collect()),
    };
    file(descr, &array.shape, &data)
}

fn characters(texts: &TextArray) -> Vec<u8> {
    // NumPy itself writes empty texts with room for one character.
    let longest = texts.texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    let mut data = Vec::with_capacity(4 * longest * texts.texts.len());
    for text in &texts.texts {
        let characters = text.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest);
        data.extend(characters.flat_map(u32::to_le_bytes));
    }
    file(&format!("<U{longest}"), &texts.shape, &data)
}

fn file(descr: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let shape: String = shape.iter().map(|side| format!("{side}, ")).collect();
    let text = format!("{{'descr': '{descr}', 'fortran_order': True, 'shape': ({shape}), }}");
    // Magic, version and length before the text, a line break behind it.
    let length = (10 + text.len() + 1).next_multiple_of(ALIGNMENT) - 10;
    let header = format!("{text:<width$}\n", width = length - 1);
    [MAGIC.as_slice(), &[1, 0], &(length as u16).to_le_bytes(), header.as_bytes(), data].concat()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::npy::read_npz;
    use crate::variables::{CellArray, MemoryBudget};

    fn read(bytes: &[u8]) -> Vec<Variable> {
        read_npz(bytes, &MemoryBudget::new(1 << 24, &|_| false)).unwrap()
    }

    #[test]
    fn the_bytes_are_those_that_numpy_was_seen_to_load() {
        // tests/data/make_files.py loads this file with numpy.load and compares every element.
        let complex = Array { im: Some(vec![0.5, -0.5]), ..Array::matrix(1, 2, vec![1.0, 2.0]) };
        let whole = Array { kind: ElementKind::Integer, ..Array::matrix(1, 2, vec![-3.0, 4.0]) };
        let truths = Array { kind: ElementKind::Logical, ..Array::matrix(2, 1, vec![1.0, 0.0]) };
        let texts = TextArray { shape: vec![1, 2], texts: vec!["u".to_owned(), "\u{3b8}_dot".to_owned()] };
        let variables = [
            ("A", Value::Array(Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, f64::INFINITY]))),
            ("c", Value::Array(complex)),
            ("i", Value::Array(whole)),
            ("t", Value::Array(truths)),
            ("names", Value::Text(texts)),
        ];
        let variables = variables.map(|(name, value)| Variable { name: name.to_owned(), value });
        let written = write_npz(&variables).unwrap();
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/npy/written.npz");
        if std::env::var_os("GDCM_WRITE_FILES").is_some() {
            std::fs::write(path, &written).unwrap();
        }
        assert_eq!(read(&std::fs::read(path).unwrap()), variables);
        assert_eq!(read(&written), variables);
    }

    #[test]
    fn other_values_and_names_that_stand_twice_are_refused() {
        let cell = Value::Cell(CellArray { shape: vec![0, 0], values: Vec::new() });
        let refused = write_npz(&[Variable { name: "c".to_owned(), value: cell }]);
        assert!(matches!(refused, Err(VariableFault::Unsupported { variable, .. }) if variable == "c"));
        let one = Variable { name: "a".to_owned(), value: Value::Array(Array::matrix(1, 1, vec![1.0])) };
        assert_eq!(write_npz(&[one.clone(), one]), Err(VariableFault::Duplicate { name: "a".to_owned() }));
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
                Value::Array(Array { shape, kind: ElementKind::Float, re, im: complex.then_some(im) })
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
