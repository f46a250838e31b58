//! MATLAB 7.3 files, and other HDF5 files such as those written by h5py.
//!
//! The container follows the HDF5 File Format Specification 3.0. MATLAB's conventions are not
//! published by The MathWorks; this reader follows MATLAB's files and the descriptions by the
//! matio, hdf5storage and MAT.jl projects: attributes give the classes, arrays are stored in
//! column-major order with their dimensions reversed, and cell and struct array elements are
//! references into a group `#refs#`.
//!
//! Arrays without MATLAB's attributes are stored in row-major order, as in C and Python: a dataset
//! with r x c elements becomes an r x c array, a scalar a 1 x 1 array, and a dataset with n
//! elements in one dimension a 1 x n array. (MATLAB's own `h5write` writes such datasets in
//! column-major order; they are read transposed.) Groups become structs, with the exceptions in
//! `reader.rs`. Group members are sorted by name, unless MATLAB gives an order. Symbolic links,
//! including links to other files, are skipped.

mod attributes;
mod chunks;
mod compound_records;
mod dataset;
mod empty_value;
mod library_fault;
mod limited_source;
mod member;
mod number_type;
mod object_part;
mod object_references;
mod reader;
mod sparse_group;
mod strings;

use std::sync::Arc;

use hdf5_pure::{File, FileAccessProperties, MetadataCacheConfig, is_hdf5_bytes};

use crate::formats::mat::is_hdf5;
use crate::formats::mat73::library_fault::library_fault;
use crate::formats::mat73::limited_source::LimitedSource;
use crate::formats::mat73::object_part::read_objects;
use crate::formats::mat73::reader::Reader;
use crate::formats::octave::convert_hdf5_groups;
use crate::formats::variables::Variable;
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Importer for MATLAB 7.3 and HDF5 files.
pub(crate) const HDF5: Importer = Importer {
    name: "an HDF5 file, as written by MATLAB with -v7.3",
    endings: &["mat", "h5", "hdf5"],
    recognises: |bytes, _| is_hdf5(bytes),
    read: |bytes, path, budget| Contents::variables(read(bytes, budget), path),
};

/// Reads all variables, and converts the groups that GNU Octave writes.
fn read(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    let variables = read_variables(bytes, budget);
    // A stop makes the library report an unreadable file: check for the stop first.
    budget.work(0, "")?;
    convert_hdf5_groups(variables?, budget)
}

/// Reads all variables; groups that GNU Octave wrote become structs like any others.
fn read_variables(
    bytes: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let file = open(bytes, budget)?;
    let reader = Reader {
        budget,
        objects: &read_objects(&file, budget)?,
    };
    reader.variables(&file.root())
}

/// Opens a copy of the file and checks that the file is complete. A user block, such as MATLAB's
/// header, may precede the HDF5 contents.
fn open(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<File, VariableFault> {
    if !is_hdf5_bytes(bytes) {
        return Err(VariableFault::other_bytes(
            "a MATLAB 7.3 or HDF5 file",
            bytes,
        ));
    }
    budget.take(bytes.len() as u64, 1, "")?;
    // `LimitedSource` would not count reads from a cache.
    let properties =
        FileAccessProperties::new().with_metadata_cache(MetadataCacheConfig::disabled());
    let source = LimitedSource::new(bytes.to_vec(), Arc::clone(budget.stop()));
    let file = File::from_source_with_options(source, properties)
        .map_err(|error| library_fault(&error, ""))?;
    // The size in the superblock reveals a truncated file even if only chunks are missing.
    if file.superblock().eof_address > bytes.len() as u64 {
        return Err(VariableFault::cut_off("", bytes.len()));
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::formats::mat::LongWords;
    use crate::formats::mat73::object_part::{ObjectCells, read_cells};
    use crate::formats::mat73::object_references::Objects;
    use crate::formats::variables::{Array, CellArray, ElementKind, TextArray, Value};
    use crate::variable_fault::damage::Damage;
    use crate::variable_fault::unread::Unread;
    use crate::variable_fault::unsupported_content::UnsupportedContent;

    /// Reads all variables without resolving references to objects, which become
    /// [`Value::Opaque`](crate::formats::variables::Value::Opaque).
    fn read(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
        let objects = Objects::Unread(Unread::NoObjectPart);
        Reader {
            budget,
            objects: &objects,
        }
        .variables(&open(bytes, budget)?.root())
    }

    fn file(name: &str) -> Vec<u8> {
        std::fs::read(format!(
            "{}/../../tests/data/mat73/{name}",
            env!("CARGO_MANIFEST_DIR")
        ))
        .unwrap()
    }

    fn read_file(name: &str) -> Result<Vec<Variable>, VariableFault> {
        read(&file(name), &ReadingBudget::new(1 << 24))
    }

    fn value(variables: &[Variable], name: &str) -> Value {
        variables
            .iter()
            .find(|variable| variable.name == name)
            .unwrap_or_else(|| panic!("no {name}"))
            .value
            .clone()
    }

    fn array(variables: &[Variable], name: &str) -> Array {
        let Value::Array(array) = value(variables, name) else {
            panic!("{name} is no array")
        };
        array
    }

    fn texts(shape: &[usize], texts: &[&str]) -> Value {
        Value::Text(TextArray {
            shape: shape.to_vec(),
            texts: texts.iter().map(|&text| text.to_owned()).collect(),
        })
    }

    fn number(value: f64) -> Value {
        Value::Array(Array::matrix(1, 1, vec![value]))
    }

    #[test]
    fn a_matrix_keeps_its_rows_and_columns() {
        for name in ["numbers.mat", "plain.h5", "plain_latest.h5"] {
            let variables = read_file(name).unwrap();
            assert_eq!(
                array(&variables, "A"),
                Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]),
                "{name}"
            );
            // numpy.arange(24).reshape(2, 3, 4): element (i, j, k) is 12 i + 4 j + k.
            let cube = array(&variables, "cube");
            assert_eq!(
                (cube.shape.as_slice(), &cube.re[..3], cube.re[6]),
                ([2, 3, 4].as_slice(), [0.0, 12.0, 4.0].as_slice(), 1.0)
            );
            // numpy.arange(600).reshape(20, 30), stored in chunks whose dimensions do not divide
            // those of the array.
            let packed = array(&variables, "packed");
            assert_eq!(
                (packed.shape.as_slice(), packed.re[1], packed.re[20]),
                ([20, 30].as_slice(), 30.0, 1.0)
            );
        }
    }

    #[test]
    fn every_class_of_numbers_of_matlab_is_read() {
        let variables = read_file("numbers.mat").unwrap();
        for name in ["int8", "int16", "int32", "int64"] {
            let expected = Array {
                kind: ElementKind::Integer,
                ..Array::matrix(2, 1, vec![-3.0, 100.0])
            };
            assert_eq!(array(&variables, name), expected, "{name}");
        }
        for name in ["uint8", "uint16", "uint32", "uint64"] {
            assert_eq!(array(&variables, name).re, [3.0, 200.0], "{name}");
        }
        assert_eq!(array(&variables, "single").re, [0.5, -0.25]);
        let flags = array(&variables, "flags");
        assert_eq!(
            (flags.kind, flags.shape, flags.re),
            (ElementKind::Logical, vec![1, 3], vec![1.0, 0.0, 1.0])
        );
        let complex = array(&variables, "z");
        assert_eq!(
            (complex.shape, complex.re, complex.im),
            (vec![1, 2], vec![1.0, -3.0], Some(vec![2.0, 0.5]))
        );
        assert_eq!(array(&variables, "none"), Array::matrix(0, 3, Vec::new()));
    }

    #[test]
    fn sparse_matrices_are_filled_up() {
        let variables = read_file("numbers.mat").unwrap();
        let expected = vec![0.0, 0.0, 1.5, 0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(array(&variables, "S"), Array::matrix(3, 4, expected));
        let nothing = array(&variables, "S0");
        assert_eq!(
            (nothing.kind, nothing.shape, nothing.re),
            (ElementKind::Logical, vec![2, 2], vec![0.0; 4])
        );
    }

    #[test]
    fn texts_are_the_rows_of_characters() {
        let variables = read_file("nested.mat").unwrap();
        assert_eq!(value(&variables, "name"), texts(&[1, 1], &["theta_dot"]));
        assert_eq!(
            value(&variables, "greek"),
            texts(&[1, 1], &["\u{3b8}\u{1d6fc}"])
        );
        assert_eq!(value(&variables, "rows"), texts(&[2, 1], &["ab ", "cde"]));
        assert_eq!(value(&variables, "nothing"), texts(&[1, 1], &[""]));
    }

    #[test]
    fn structs_keep_the_order_of_their_fields() {
        let variables = read_file("nested.mat").unwrap();
        let Value::Struct(system) = value(&variables, "sys") else {
            panic!("no struct")
        };
        let names: Vec<_> = system
            .fields
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        assert_eq!(
            (system.shape.as_slice(), names),
            ([1, 1].as_slice(), vec!["B", "A", "name", "inner"])
        );
        assert_eq!(
            system.field("A").unwrap(),
            [Value::Array(Array::matrix(2, 2, vec![1.0, 3.0, 2.0, 4.0]))]
        );
        let Value::Struct(inner) = &system.field("inner").unwrap()[0] else {
            panic!("no struct")
        };
        assert_eq!(inner.field("x").unwrap(), [number(7.0)]);
    }

    #[test]
    fn struct_arrays_and_cells_are_read_through_their_references() {
        let variables = read_file("nested.mat").unwrap();
        let Value::Struct(models) = value(&variables, "models") else {
            panic!("no struct")
        };
        assert_eq!(models.shape, [1, 3]);
        assert_eq!(
            models.field("gain").unwrap(),
            [number(0.0), number(1.0), number(2.0)]
        );
        assert_eq!(models.field("name").unwrap()[2], texts(&[1, 1], &["w"]));
        let deep = Value::Cell(CellArray {
            shape: vec![1, 1],
            values: vec![texts(&[1, 1], &["deep"])],
        });
        let values = vec![
            number(0.0),
            number(1.0),
            number(2.0),
            number(3.0),
            number(4.0),
            deep,
        ];
        assert_eq!(
            value(&variables, "C"),
            Value::Cell(CellArray {
                shape: vec![2, 3],
                values
            })
        );
        assert_eq!(
            value(&variables, "C0"),
            Value::Cell(CellArray {
                shape: vec![0, 1],
                values: Vec::new()
            })
        );
        assert!(
            matches!(value(&variables, "T0"), Value::Struct(records) if records.shape == [0, 0])
        );
        assert!(
            matches!(value(&variables, "f"), Value::Opaque { class, .. } if class == "function_handle")
        );
    }

    #[test]
    fn the_object_part_is_read_with_exact_integers() {
        let budget = ReadingBudget::new(1 << 24);
        let opened = open(&file("objects.mat"), &budget).unwrap();
        let dataset = opened
            .root()
            .group("#subsystem#")
            .and_then(|group| group.dataset("MCOS"))
            .unwrap();
        let ObjectCells { cells, long_words } = read_cells(&dataset, &budget).unwrap();
        assert_eq!(cells.len(), 3);
        assert!(matches!(&cells[0], Value::Array(bytes) if bytes.re == [4.0, 0.0, 0.0, 0.0]));
        assert_eq!(long_words, LongWords::from([(2, vec![u64::MAX])]));
        let variables = Reader {
            budget: &budget,
            objects: &Objects::References,
        }
        .variables(&opened.root())
        .unwrap();
        assert_eq!(
            array(&variables, "sys").re,
            [f64::from(0xdd00_0000_u32), 2.0, 1.0, 1.0, 1.0, 1.0]
        );
        let opaque = value(&read_file("objects.mat").unwrap(), "sys");
        assert!(matches!(opaque, Value::Opaque { class, .. } if class == "ss"));
    }

    #[test]
    fn other_variables_are_read_if_the_objects_are_damaged() {
        // The directory of the objects in this file ends after its version.
        let read = (HDF5.read)(
            &file("objects.mat"),
            Path::new("objects.mat"),
            &ReadingBudget::new(1 << 24),
        )
        .unwrap();
        let Contents::Variables { variables, .. } = read else {
            panic!("variables")
        };
        assert_eq!(
            (variables.len(), value(&variables, "before")),
            (2, number(1.0))
        );
        let sys = value(&variables, "sys");
        assert!(
            matches!(
                &sys,
                Value::Opaque { why, .. } if matches!(
                    why.as_ref(),
                    Unread::ObjectPart(VariableFault::Damaged {
                        damage: Damage::DirectoryCutOff,
                        ..
                    })
                )
            ),
            "{sys:?}"
        );
    }

    #[test]
    fn files_of_h5py_are_read() {
        for name in ["plain.h5", "plain_latest.h5"] {
            let variables = read_file(name).unwrap();
            let whole = Array {
                kind: ElementKind::Integer,
                ..Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0])
            };
            assert_eq!(array(&variables, "big_endian"), whole);
            assert_eq!(
                array(&variables, "half"),
                Array::matrix(1, 2, vec![0.5, 1.25])
            );
            assert_eq!(value(&variables, "scalar"), number(2.5));
            assert_eq!(
                (
                    array(&variables, "flags").kind,
                    array(&variables, "flags").re
                ),
                (ElementKind::Logical, vec![1.0, 0.0])
            );
            assert_eq!(array(&variables, "z").im, Some(vec![2.0, 0.5]));
            assert_eq!(
                value(&variables, "text"),
                texts(&[1, 1], &["hover \u{3b8}"])
            );
            assert_eq!(
                value(&variables, "names"),
                texts(&[1, 3], &["u", "theta", ""])
            );
            assert_eq!(value(&variables, "fixed"), texts(&[1, 2], &["u", "theta"]));
            assert_eq!(
                array(&variables, "nothing"),
                Array::matrix(0, 0, Vec::new())
            );
            assert_eq!(
                array(&variables, "no_rows"),
                Array::matrix(0, 3, Vec::new())
            );
            assert_eq!(array(&variables, "summed").re[..2], [0.0, 3.0]);
            assert_eq!(array(&variables, "unwritten").re, [7.0; 4]);
            assert!(matches!(value(&variables, "ragged"), Value::Opaque { .. }));
        }
    }

    #[test]
    fn groups_and_records_are_structs() {
        for name in ["plain.h5", "plain_latest.h5"] {
            let variables = read_file(name).unwrap();
            let Value::Struct(group) = value(&variables, "group") else {
                panic!("no struct")
            };
            let Value::Struct(inner) = &group.field("inner").unwrap()[0] else {
                panic!("no struct")
            };
            assert_eq!(inner.field("x").unwrap(), [number(1.0)]);
            assert!(
                matches!(value(&variables, "empty"), Value::Struct(records) if records.fields.is_empty())
            );
            let Value::Struct(records) = value(&variables, "records") else {
                panic!("no struct")
            };
            assert_eq!(records.field("gain").unwrap(), [number(1.5), number(-2.0)]);
            assert_eq!(records.field("name").unwrap()[1], texts(&[1, 1], &["phi"]));
        }
    }

    #[test]
    fn other_variables_are_read_beside_a_variable_in_a_newer_format() {
        let variables = read_file("hdf5_2.h5").unwrap();
        assert!(matches!(
            value(&variables, "packed"),
            Value::Opaque { why, .. } if matches!(
                *why,
                Unread::Unsupported(UnsupportedContent::HdfDataset { .. })
            )
        ));
        assert_eq!(value(&variables, "x"), number(1.0));
    }

    #[test]
    fn links_to_other_files_are_skipped_and_names_that_are_not_utf8_refused() {
        let variables = read_file("links.h5").unwrap();
        assert_eq!((variables.len(), value(&variables, "x")), (1, number(1.0)));
        assert!(matches!(
            read_file("name.h5"),
            Err(VariableFault::Damaged {
                damage: Damage::Library { .. },
                ..
            })
        ));
    }

    #[test]
    fn values_that_contain_themselves_or_are_too_deep_are_refused() {
        for name in ["circle.mat", "circle.h5", "deep.h5"] {
            assert!(
                matches!(read_file(name), Err(VariableFault::TooDeep { .. })),
                "{name}"
            );
        }
    }

    #[test]
    fn values_that_take_too_much_memory_are_refused() {
        for name in ["laughs.mat", "huge.mat", "huge_sparse.mat"] {
            assert!(
                matches!(read_file(name), Err(VariableFault::TooLarge { .. })),
                "{name}"
            );
        }
        assert!(matches!(
            read_file("huge_empty.mat"),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn other_formats_and_cut_off_files_are_refused() {
        let read = |bytes: &[u8]| read(bytes, &ReadingBudget::new(1 << 24));
        assert!(matches!(read(b""), Err(VariableFault::Format { .. })));
        assert!(matches!(
            read(b"MATLAB 5.0 MAT-file"),
            Err(VariableFault::Format { .. })
        ));
        for name in ["numbers.mat", "plain_latest.h5"] {
            let whole = file(name);
            assert!(
                matches!(
                    read(&whole[..whole.len() - 1]),
                    Err(VariableFault::CutOff { .. })
                ),
                "{name}"
            );
        }
    }

    #[test]
    fn damage_anywhere_is_a_fault_and_never_a_panic() {
        let read = |bytes: &[u8]| read(bytes, &ReadingBudget::new(1 << 24));
        for name in ["objects.mat", "plain_latest.h5"] {
            let whole = file(name);
            for length in (0..whole.len()).step_by(97) {
                assert!(read(&whole[..length]).is_err(), "{name} cut to {length}");
            }
            for place in (0..whole.len()).step_by(5) {
                let mut bytes = whole.clone();
                bytes[place] ^= 1 << (place % 8);
                let _ = read(&bytes);
            }
        }
    }
}
