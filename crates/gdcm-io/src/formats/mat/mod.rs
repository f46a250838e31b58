//! MATLAB files (".mat") at level 4 and levels 5 to 7, including those from GNU Octave and SciPy.
//!
//! Source: "MAT-File Format", The MathWorks. Files at version 7.3 are HDF5 files, which `mat73`
//! reads; their objects are laid out as in `Subsystem`.

mod array_contents;
mod array_end;
mod array_header;
mod characters;
mod cursor;
mod element;
mod inflate;
mod level4;
mod level5;
mod numbers;
mod object_part;
mod subsystem;
mod unreadable;
mod value_path;
mod writer;

use super::variables::Variable;
use crate::formats::mat::level5::FileVersion;
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::found_content::FoundContent;

pub(crate) use crate::formats::mat::characters::text_rows;
pub(crate) use crate::formats::mat::subsystem::{LongWords, Subsystem};
pub use crate::formats::mat::writer::{write, write_packed};

/// HDF5 signature, at the beginning of a file or after MATLAB's header.
const HDF5_SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";
/// Major version in files of levels 5 to 7.
const LEVEL_5: u8 = 1;
/// Expected format, as named in error messages from [`read`].
const EXPECTED: &str = "a MATLAB .mat file up to version 7";

pub(crate) const MAT: Importer = Importer {
    name: "a MATLAB .mat file up to version 7",
    endings: &["mat"],
    recognises: |bytes, ending| {
        ending == "mat" || FileVersion::read(bytes).is_some_and(|version| version.major == LEVEL_5)
    },
    read: |bytes, path, budget| Contents::variables(read(bytes, budget), path),
};

/// Reads the variables in file order. The first case that applies decides the level:
///
/// 1. HDF5 signature: error, because `mat73` reads version 7.3.
/// 2. Header of levels 5 to 7, unless the file does not begin with text and has a valid header of
///    level 4.
/// 3. Header of level 4.
/// 4. Header of another version, or anything else: error.
///
/// Parts of variables that cannot be decoded become [`super::variables::Value::Opaque`]; bytes that
/// contradict the format are an error for the whole file.
pub fn read(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    // Case 1
    if is_hdf5(bytes) {
        return Err(VariableFault::format(EXPECTED, FoundContent::Hdf5));
    }
    // A level-5 file begins with text: its first four bytes are nonzero, unlike in a level-4 file.
    let begins_with_text = bytes.get(..4).is_some_and(|start| !start.contains(&0));
    match FileVersion::read(bytes) {
        // Case 2
        Some(FileVersion {
            order,
            major: LEVEL_5,
        }) if begins_with_text || !level4::begins(bytes) => level5::read(bytes, order, budget),
        // Case 3
        _ if level4::begins(bytes) => level4::read(bytes, budget),
        // Case 4
        Some(FileVersion { major, .. }) if begins_with_text => Err(VariableFault::format(
            EXPECTED,
            FoundContent::MatVersion { major },
        )),
        _ => Err(VariableFault::format(EXPECTED, describe_start(bytes))),
    }
}

/// Returns whether this is an HDF5 file, the format that MATLAB writes with `-v7.3`.
pub fn is_hdf5(bytes: &[u8]) -> bool {
    // The signature is at byte 0, 512, 1024, 2048 and so on ("HDF5 File Format Specification",
    // II.A).
    if bytes.starts_with(&HDF5_SIGNATURE) {
        return true;
    }
    let mut at: usize = 512;
    while let Some(rest) = bytes.get(at..) {
        if rest.starts_with(&HDF5_SIGNATURE) {
            return true;
        }
        let Some(next) = at.checked_mul(2) else {
            break;
        };
        at = next;
    }
    false
}

/// Describes the first bytes of a file with an unknown format.
fn describe_start(bytes: &[u8]) -> FoundContent {
    let start = bytes.get(..bytes.len().min(8)).unwrap_or_default();
    if start.is_empty() {
        return FoundContent::EmptyFile;
    }
    let is_text = start
        .iter()
        .all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace());
    if is_text {
        return FoundContent::Text {
            start: String::from_utf8_lossy(start).into_owned(),
        };
    }
    FoundContent::Bytes {
        bytes: start.to_vec(),
    }
}

#[cfg(test)]
mod sample_tests;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::mat::sample_tests::{chars, doubles, element, file, matrix};
    use crate::formats::variables::{Array, ElementKind, Value};

    const PLAIN: &[u8] = include_bytes!("../../../../../tests/data/mat/scipy-5.mat");
    const PACKED: &[u8] = include_bytes!("../../../../../tests/data/mat/scipy-5-packed.mat");
    const OLD: &[u8] = include_bytes!("../../../../../tests/data/mat/scipy-4.mat");
    /// `ss([1 2; 3 4], [1; 0], [1 0], 0)`, saved by the control package of GNU Octave; its tags
    /// announce too many bytes.
    const OCTAVE: &[u8] = include_bytes!("../../../../../tests/data/mat/octave-ss.mat");
    const MOST: u64 = 1 << 20;

    fn read(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        super::read(bytes, &ReadingBudget::new(MOST))
    }

    fn value(bytes: &[u8], name: &str) -> Value {
        read(bytes)
            .unwrap()
            .into_iter()
            .find(|variable| variable.name == name)
            .unwrap()
            .value
    }

    fn numbers(shape: &[usize], kind: ElementKind, re: &[f64]) -> Value {
        Value::Array(Array {
            shape: shape.to_vec(),
            kind,
            re: re.to_vec(),
            im: None,
        })
    }

    #[test]
    fn a_compressed_file_gives_the_same_values_as_a_plain_file() {
        let plain = read(PLAIN).unwrap();
        assert_eq!(plain.len(), 17);
        assert_eq!(read(PACKED).unwrap(), plain);
    }

    #[test]
    fn numbers_of_scipy_are_read_in_both_levels() {
        let matrix = numbers(
            &[2, 3],
            ElementKind::Float,
            &[1.0, 4.0, 2.0, 5.5, 3.0, -6.0],
        );
        let sparse = numbers(&[3, 2], ElementKind::Float, &[0.0, 3.0, 0.0, 2.0, 0.0, 4.0]);
        for file in [PLAIN, OLD] {
            assert_eq!(value(file, "matrix"), matrix);
            assert_eq!(value(file, "sparse"), sparse);
            assert_eq!(
                value(file, "whole"),
                numbers(&[1, 2], ElementKind::Integer, &[-3.0, 300.0])
            );
            let Value::Array(complex) = value(file, "sparse_complex") else {
                panic!()
            };
            assert_eq!(complex.im, Some(vec![0.0, 0.0, 2.0, 0.0]));
        }
        assert_eq!(
            value(PLAIN, "flags"),
            numbers(&[1, 2], ElementKind::Logical, &[1.0, 0.0])
        );
        assert_eq!(
            value(PLAIN, "long"),
            numbers(&[1, 1], ElementKind::Integer, &[9_007_199_254_740_992.0])
        );
        assert_eq!(
            value(PLAIN, "empty"),
            numbers(&[0, 3], ElementKind::Float, &[])
        );
    }

    #[test]
    fn texts_of_scipy_are_read_in_both_levels() {
        for file in [PLAIN, OLD] {
            let Value::Text(rows) = value(file, "rows") else {
                panic!()
            };
            assert_eq!(
                (rows.shape, rows.texts),
                (vec![2, 1], vec!["ab".to_owned(), "cd".to_owned()])
            );
        }
        let Value::Text(letters) = value(PLAIN, "letters") else {
            panic!()
        };
        assert_eq!(letters.texts, ["\u{e4}\u{3a9}\u{1f681}"]);
    }

    #[test]
    fn records_and_cells_of_scipy_keep_their_shape() {
        let Value::Struct(records) = value(PLAIN, "records") else {
            panic!()
        };
        assert_eq!(records.shape, [1, 2]);
        assert_eq!(
            records.field("a").unwrap()[1],
            numbers(&[1, 1], ElementKind::Float, &[2.0])
        );
        let Value::Cell(cells) = value(PLAIN, "cells") else {
            panic!()
        };
        assert_eq!((cells.shape, cells.values.len()), (vec![1, 2], 2));
    }

    #[test]
    fn a_model_of_octave_is_an_old_object() {
        let Value::Object(model) = value(OCTAVE, "sys") else {
            panic!()
        };
        assert_eq!(model.class, "ss");
        let a = numbers(&[2, 2], ElementKind::Float, &[1.0, 3.0, 2.0, 4.0]);
        assert_eq!(model.records.field("a").unwrap(), [a]);
        let Value::Object(common) = &model.records.field("lti").unwrap()[0] else {
            panic!()
        };
        assert!(common.class == "lti" && common.records.field("tsam").is_some());
    }

    #[test]
    fn other_files_are_recognised_by_their_first_bytes() {
        let hdf5 = [&[b' '; 512][..], &HDF5_SIGNATURE, &[0; 40]].concat();
        assert!(is_hdf5(&hdf5) && is_hdf5(&hdf5[512..]) && !is_hdf5(PLAIN));
        let found = |bytes: &[u8]| match read(bytes) {
            Err(VariableFault::Format { found, .. }) => found,
            other => panic!("{other:?}"),
        };
        assert_eq!(found(&hdf5), FoundContent::Hdf5);
        assert_eq!(found(b""), FoundContent::EmptyFile);
        let start = "t, u, y\n".to_owned();
        assert_eq!(found(b"t, u, y\n1, 2, 3\n"), FoundContent::Text { start });
        let bytes = vec![0; 8];
        assert_eq!(found(&[0; 300]), FoundContent::Bytes { bytes });
    }

    #[test]
    fn two_variables_with_the_same_name_are_refused() {
        let twice = [doubles("x", &[1, 1], &[1.0]), doubles("x", &[1, 1], &[1.0])].concat();
        assert_eq!(
            read(&file(&twice)),
            Err(VariableFault::Duplicate {
                name: "x".to_owned()
            })
        );
    }

    #[test]
    fn a_fault_names_the_value_and_the_byte() {
        let wrong = matrix(6, &[2, 2], "", &[element(9, &[0; 8])]);
        let names = [
            element(5, &8_i32.to_le_bytes()),
            element(1, b"A\0\0\0\0\0\0\0"),
        ]
        .concat();
        let record = matrix(2, &[1, 1], "", &[names, wrong]);
        let cells = matrix(1, &[1, 2], "models", &[chars("", "a"), record]);
        let Err(VariableFault::Damaged {
            variable, offset, ..
        }) = read(&file(&cells))
        else {
            panic!()
        };
        assert_eq!(variable, "models{2}.A");
        assert!((128..file(&cells).len() as u64).contains(&offset));
    }

    #[test]
    fn cut_off_files_are_reported() {
        let Err(fault) = read(&PLAIN[..PLAIN.len() - 9]) else {
            panic!()
        };
        assert!(matches!(fault, VariableFault::CutOff { .. }), "{fault:?}");
        assert!(matches!(
            read(&OLD[..OLD.len() - 9]),
            Err(VariableFault::CutOff { .. })
        ));
    }

    #[test]
    fn values_nested_too_deeply_are_refused() {
        let nested = (0..80).fold(doubles("", &[1, 1], &[1.0]), |inner, _| {
            matrix(1, &[1, 1], "", &[inner])
        });
        let nested = matrix(1, &[1, 1], "deep", &[nested]);
        let Err(VariableFault::TooDeep { variable }) = read(&file(&nested)) else {
            panic!()
        };
        assert!(variable.starts_with("deep{1}{1}"));
    }

    #[test]
    fn a_stopped_reader_ends() {
        assert_eq!(
            super::read(
                PLAIN,
                &ReadingBudget::new(MOST).stopped_by(std::sync::Arc::new(true.into()))
            ),
            Err(VariableFault::Stopped)
        );
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
