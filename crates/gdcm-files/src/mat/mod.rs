//! Files of MATLAB (".mat"), of level 4 and of levels 5 to 7, as GNU Octave and SciPy write them too.
//!
//! Source: "MAT-File Format", The MathWorks. Files of version 7.3 are HDF5 files, which are read elsewhere; the objects in them are
//! laid out as in [`Subsystem`].

mod cursor;
mod element;
mod export_line;
mod header;
mod inflate;
mod level4;
mod level5;
mod matrix;
mod numbers;
mod opaque;
#[cfg(test)]
mod sample;
mod sparse;
mod subsystem;
mod text;
mod trail;
mod workspace;
mod writer;

pub use subsystem::Subsystem;
pub use writer::{write, write_packed};

use super::variables::{MemoryBudget, Variable, VariableFault};

/// What every HDF5 file, or what follows MATLAB's header in one, begins with.
const HDF5_SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";
/// The first number of the version of files of levels 5 to 7.
const LEVEL_5: u8 = 1;
/// What [`read`] reads.
const EXPECTED: &str = "a .mat file of MATLAB up to version 7";

/// The variables of a file, in their order.
///
/// What lies in a variable and cannot be decoded is [`super::variables::Value::Opaque`]; bytes that contradict the format are a
/// fault of the whole file.
pub fn read(bytes: &[u8], meter: &MemoryBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    if is_hdf5(bytes) {
        return Err(format("an HDF5 file, as MATLAB writes with -v7.3"));
    }
    // The text that a file of level 5 begins with is what tells it from one of level 4: four bytes that are not zero.
    let text = bytes.get(..4).is_some_and(|start| !start.contains(&0));
    match level5::version(bytes) {
        Some((order, LEVEL_5)) if text || !level4::begins(bytes) => level5::read(bytes, order, meter),
        _ if level4::begins(bytes) => level4::read(bytes, meter),
        Some((_, version)) if text => Err(format(format!("a .mat file of the unknown version {version}"))),
        _ => Err(format(beginning(bytes))),
    }
}

/// Whether this is an HDF5 file, as MATLAB writes with `-v7.3`.
pub fn is_hdf5(bytes: &[u8]) -> bool {
    // The signature stands at the beginning, or at byte 512, 1024, 2048 and so on ("HDF5 File Format Specification", II.A).
    let doubled = std::iter::successors(Some(512_usize), |at| at.checked_mul(2)).take_while(|&at| at < bytes.len());
    let signed = |at: usize| bytes.get(at..).is_some_and(|rest| rest.starts_with(&HDF5_SIGNATURE));
    std::iter::once(0).chain(doubled).any(signed)
}

fn format(found: impl Into<String>) -> VariableFault {
    VariableFault::Format { expected: EXPECTED, found: found.into() }
}

fn beginning(bytes: &[u8]) -> String {
    let start = bytes.get(..bytes.len().min(8)).unwrap_or_default();
    if start.is_empty() {
        return "an empty file".to_owned();
    }
    if start.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace()) {
        return format!("a text that begins with {:?}", String::from_utf8_lossy(start));
    }
    let bytes: Vec<String> = start.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("a file that begins with the bytes {}", bytes.join(" "))
}

#[cfg(test)]
mod tests {
    use super::sample::{chars, doubles, element, file, matrix};
    use super::*;
    use crate::variables::{Array, ElementKind, Value};
    use proptest::prelude::*;

    const PLAIN: &[u8] = include_bytes!("../../../../tests/data/mat/scipy-5.mat");
    const PACKED: &[u8] = include_bytes!("../../../../tests/data/mat/scipy-5-packed.mat");
    const OLD: &[u8] = include_bytes!("../../../../tests/data/mat/scipy-4.mat");
    /// `ss([1 2; 3 4], [1; 0], [1 0], 0)` of the control package, whose tags count too many bytes.
    const OCTAVE: &[u8] = include_bytes!("../../../../tests/data/mat/octave-ss.mat");
    const MOST: u64 = 1 << 20;

    fn read(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        super::read(bytes, &MemoryBudget::new(MOST, &|_| false))
    }

    fn value(bytes: &[u8], name: &str) -> Value {
        read(bytes).unwrap().into_iter().find(|variable| variable.name == name).unwrap().value
    }

    fn numbers(shape: &[usize], kind: ElementKind, re: &[f64]) -> Value {
        Value::Array(Array { shape: shape.to_vec(), kind, re: re.to_vec(), im: None })
    }

    #[test]
    fn a_compressed_file_is_the_same_as_a_plain_one() {
        let plain = read(PLAIN).unwrap();
        assert_eq!(plain.len(), 17);
        assert_eq!(read(PACKED).unwrap(), plain);
    }

    #[test]
    fn numbers_of_scipy_are_read_in_both_levels() {
        let matrix = numbers(&[2, 3], ElementKind::Float, &[1.0, 4.0, 2.0, 5.5, 3.0, -6.0]);
        let sparse = numbers(&[3, 2], ElementKind::Float, &[0.0, 3.0, 0.0, 2.0, 0.0, 4.0]);
        for file in [PLAIN, OLD] {
            assert_eq!(value(file, "matrix"), matrix);
            assert_eq!(value(file, "sparse"), sparse);
            assert_eq!(value(file, "whole"), numbers(&[1, 2], ElementKind::Integer, &[-3.0, 300.0]));
            let Value::Array(complex) = value(file, "sparse_complex") else { panic!() };
            assert_eq!(complex.im, Some(vec![0.0, 0.0, 2.0, 0.0]));
        }
        assert_eq!(value(PLAIN, "flags"), numbers(&[1, 2], ElementKind::Logical, &[1.0, 0.0]));
        assert_eq!(value(PLAIN, "long"), numbers(&[1, 1], ElementKind::Integer, &[9_007_199_254_740_992.0]));
        assert_eq!(value(PLAIN, "empty"), numbers(&[0, 3], ElementKind::Float, &[]));
    }

    #[test]
    fn texts_of_scipy_are_read_in_both_levels() {
        for file in [PLAIN, OLD] {
            let Value::Text(rows) = value(file, "rows") else { panic!() };
            assert_eq!((rows.shape, rows.texts), (vec![2, 1], vec!["ab".to_owned(), "cd".to_owned()]));
        }
        let Value::Text(letters) = value(PLAIN, "letters") else { panic!() };
        assert_eq!(letters.texts, ["\u{e4}\u{3a9}\u{1f681}"]);
    }

    #[test]
    fn records_and_cells_of_scipy_keep_their_shape() {
        let Value::Struct(records) = value(PLAIN, "records") else { panic!() };
        assert_eq!(records.shape, [1, 2]);
        assert_eq!(records.field("a").unwrap()[1], numbers(&[1, 1], ElementKind::Float, &[2.0]));
        let Value::Cell(cells) = value(PLAIN, "cells") else { panic!() };
        assert_eq!((cells.shape, cells.values.len()), (vec![1, 2], 2));
    }

    #[test]
    fn a_model_of_octave_is_an_old_object() {
        let Value::Object(model) = value(OCTAVE, "sys") else { panic!() };
        assert_eq!(model.class, "ss");
        let a = numbers(&[2, 2], ElementKind::Float, &[1.0, 3.0, 2.0, 4.0]);
        assert_eq!(model.records.field("a").unwrap(), [a]);
        let Value::Object(common) = &model.records.field("lti").unwrap()[0] else { panic!() };
        assert!(common.class == "lti" && common.records.field("tsam").is_some());
    }

    #[test]
    fn other_files_are_told_apart_by_what_they_begin_with() {
        let hdf5 = [&[b' '; 512][..], &HDF5_SIGNATURE, &[0; 40]].concat();
        assert!(is_hdf5(&hdf5) && is_hdf5(&hdf5[512..]) && !is_hdf5(PLAIN));
        let found = |bytes: &[u8]| match read(bytes) {
            Err(VariableFault::Format { found, .. }) => found,
            other => panic!("{other:?}"),
        };
        assert!(found(&hdf5).contains("HDF5"));
        assert_eq!(found(b""), "an empty file");
        assert!(found(b"t, u, y\n1, 2, 3\n").starts_with("a text that begins with"));
        assert!(found(&[0; 300]).contains("00 00 00"));
    }

    #[test]
    fn two_variables_of_one_name_are_refused() {
        let twice = [doubles("x", &[1, 1], &[1.0]), doubles("x", &[1, 1], &[1.0])].concat();
        assert_eq!(read(&file(&twice)), Err(VariableFault::Duplicate { name: "x".to_owned() }));
    }

    #[test]
    fn a_fault_names_the_value_and_the_byte() {
        let wrong = matrix(6, &[2, 2], "", &[element(9, &[0; 8])]);
        let names = [element(5, &8_i32.to_le_bytes()), element(1, b"A\0\0\0\0\0\0\0")].concat();
        let record = matrix(2, &[1, 1], "", &[names, wrong]);
        let cells = matrix(1, &[1, 2], "models", &[chars("", "a"), record]);
        let Err(VariableFault::Damaged { variable, offset, .. }) = read(&file(&cells)) else { panic!() };
        assert_eq!(variable, "models{2}.A");
        assert!((128..file(&cells).len() as u64).contains(&offset));
    }

    #[test]
    fn cut_off_files_say_so() {
        let Err(fault) = read(&PLAIN[..PLAIN.len() - 9]) else { panic!() };
        assert!(matches!(fault, VariableFault::CutOff { .. }), "{fault:?}");
        assert!(matches!(read(&OLD[..OLD.len() - 9]), Err(VariableFault::CutOff { .. })));
    }

    #[test]
    fn values_nested_too_deeply_are_refused() {
        let nested = (0..80).fold(doubles("", &[1, 1], &[1.0]), |inner, _| matrix(1, &[1, 1], "", &[inner]));
        let nested = matrix(1, &[1, 1], "deep", &[nested]);
        let Err(VariableFault::TooDeep { variable }) = read(&file(&nested)) else { panic!() };
        assert!(variable.starts_with("deep{1}{1}"));
    }

    #[test]
    fn a_reader_that_shall_stop_stops() {
        assert_eq!(super::read(PLAIN, &MemoryBudget::new(MOST, &|_| true)), Err(VariableFault::Stopped));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn changed_bytes_never_panic(
            seed in prop::sample::select(vec![PLAIN, PACKED, OLD, OCTAVE]),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        ) {
            let mut bytes = seed.to_vec();
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] ^= byte;
            }
            let _ = read(&bytes);
        }
    }

    #[test]
    fn a_file_cut_off_anywhere_never_panics() {
        for seed in [PLAIN, PACKED, OLD, OCTAVE] {
            for length in 0..seed.len() {
                let _ = read(&seed[..length]);
            }
        }
    }
}
