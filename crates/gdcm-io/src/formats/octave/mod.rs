//! Files written by GNU Octave's `save` with `-text` (the default), `-binary` or `-hdf5`,
//! compressed (`-zip`) or not.
//!
//! The formats are documented only in Octave's source code (version 7: `ls-oct-text.cc`,
//! `ls-oct-binary.cc`, `ls-hdf5.cc` and the `ov-*.cc` files). Each value is preceded by its name
//! and type, on which its storage form depends. The text and binary encodings store a value's parts
//! in the same order, so both use the same assembly code.

mod assembly;
mod binary;
mod form;
mod hdf5;
mod range;
mod text;

pub(crate) use binary::OCTAVE_BINARY;
pub(crate) use hdf5::convert_hdf5_groups;
pub(crate) use text::OCTAVE_TEXT;

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::file_error::FileError;
    use crate::formats::variables::{Array, Value, Variable};
    use crate::formats::{Contents, import_bytes};
    use crate::reading_budget::ReadingBudget;
    use crate::variable_fault::VariableFault;
    use crate::variable_fault::line_fault::LineFault;
    use crate::variable_fault::octave_fault::OctaveFault;

    fn bytes(name: &str) -> Vec<u8> {
        std::fs::read(format!(
            "{}/../../tests/data/foreign/octave/{name}",
            env!("CARGO_MANIFEST_DIR")
        ))
        .unwrap()
    }

    /// Returns the variables in a file; none if its bytes are recognised as another format.
    fn variables(bytes: &[u8], name: &str) -> Result<Vec<Variable>, FileError> {
        let budget = ReadingBudget::new(1 << 24);
        match import_bytes(bytes, Path::new(name), name, &budget)?.contents {
            Contents::Variables { variables, .. } => Ok(variables),
            _ => Ok(Vec::new()),
        }
    }

    /// The same variables, saved by Octave 7.3 in each format.
    const FORMS: [&str; 3] = ["kinds.txt", "kinds.bin", "kinds.h5.gz"];

    fn each_form(check: impl Fn(&dyn Fn(&str) -> Value, &str)) {
        for form in FORMS {
            let variables = variables(&bytes(form), form).unwrap();
            let value = |name: &str| {
                let found = variables.iter().find(|variable| variable.name == name);
                found
                    .unwrap_or_else(|| panic!("{form}: no {name}"))
                    .value
                    .clone()
            };
            check(&value, form);
        }
    }

    fn array(value: Value) -> Array {
        let Value::Array(array) = value else {
            panic!("{value:?} is no array")
        };
        array
    }

    #[test]
    fn numbers_of_every_kind_are_the_same_in_every_form() {
        each_form(|value, form| {
            let array = |name: &str| array(value(name));
            assert_eq!(array("x").re, [2.5], "{form}");
            assert_eq!(
                (array("z").re, array("z").im),
                (vec![1.0], Some(vec![2.0])),
                "{form}"
            );
            assert_eq!(
                array("M"),
                Array::matrix(2, 3, vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]),
                "{form}"
            );
            assert_eq!(
                (array("Z").re, array("Z").im),
                (vec![1.0, 5.0, 3.0, 0.0], Some(vec![2.0, 0.0, -4.0, 6.0])),
                "{form}"
            );
            let cube = array("N3");
            assert_eq!(
                (cube.shape, cube.re[1], cube.re[6]),
                (vec![2, 3, 4], 2.0, 7.0),
                "{form}"
            );
            assert_eq!(
                (array("e").shape, array("e2").shape),
                (vec![0, 0], vec![0, 3]),
                "{form}"
            );
            assert_eq!(
                (array("b").re, array("bm").re, array("i8").re),
                (vec![1.0], vec![1.0, 0.0], vec![-3.0, 100.0])
            );
            assert_eq!(
                (array("u16").re, array("f").re, array("fs").re),
                (vec![7.0], vec![0.5, -0.25], vec![1.5])
            );
            assert_eq!(
                (array("r").re, array("r2").re),
                (vec![0.0, 0.5, 1.0, 1.5, 2.0], vec![5.0, 4.0, 3.0, 2.0, 1.0])
            );
            let sparse = vec![0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -2.0];
            assert_eq!(
                (array("S").shape, array("S").re),
                (vec![3, 4], [&[0.0; 3][..], &sparse[3..]].concat()),
                "{form}"
            );
            assert_eq!(
                (array("col").shape, array("col").re),
                (vec![2, 1], vec![0.0, 5.0]),
                "{form}"
            );
            let odd = array("nanm").re;
            assert!(
                odd[0].is_nan()
                    && odd[1] == f64::INFINITY
                    && odd[2] == f64::NEG_INFINITY
                    && odd[3].is_nan(),
                "{form}"
            );
        });
    }

    #[test]
    fn texts_cells_structs_and_objects_are_the_same_in_every_form() {
        each_form(|value, form| {
            let texts = |value: Value| match value {
                Value::Text(text) => text.texts,
                other => panic!("{form}: {other:?} is no text"),
            };
            assert_eq!(texts(value("s")), ["hover"]);
            assert_eq!(texts(value("s2")), ["ab ", "cde"]);
            assert_eq!(
                (texts(value("sq")), texts(value("es"))),
                (vec!["it's".to_owned()], vec![String::new()]),
                "{form}"
            );
            let Value::Cell(cell) = value("c") else {
                panic!("{form}: no cell")
            };
            assert_eq!(
                (cell.shape, array(cell.values[1].clone()).re),
                (vec![2, 2], vec![3.0, 4.0]),
                "{form}"
            );
            assert_eq!(texts(cell.values[2].clone()), ["two"], "{form}");
            assert!(
                matches!(value("c0"), Value::Cell(cell) if cell.values.is_empty()),
                "{form}"
            );
            let Value::Struct(one) = value("st") else {
                panic!("{form}: no struct")
            };
            assert_eq!(texts(one.field("b").unwrap()[0].clone()), ["x"], "{form}");
            let Value::Struct(several) = value("sa") else {
                panic!("{form}: no structs")
            };
            assert_eq!(
                (several.shape.clone(), several.field("g").unwrap().len()),
                (vec![1, 3], 3),
                "{form}"
            );
            assert_eq!(
                texts(several.field("n").unwrap()[2].clone()),
                ["w"],
                "{form}"
            );
            assert!(
                matches!(value("t"), Value::Object(object) if object.class == "tf" && object.records.field("num").is_some())
            );
        });
    }

    #[test]
    fn a_diagonal_matrix_is_expanded_and_an_unread_value_is_named() {
        for form in ["kinds.txt", "kinds.bin"] {
            let variables = variables(&bytes(form), form).unwrap();
            let value = |name: &str| {
                variables
                    .iter()
                    .find(|variable| variable.name == name)
                    .unwrap()
                    .value
                    .clone()
            };
            assert_eq!(
                array(value("D2")),
                Array::matrix(2, 3, vec![2.0, 0.0, 0.0, 2.0, 0.0, 0.0])
            );
            assert!(
                matches!(value("p"), Value::Opaque { class, .. } if class.contains("permutation"))
            );
        }
    }

    #[test]
    fn a_file_that_is_cut_off_or_damaged_is_an_error_or_fewer_values_and_never_a_panic() {
        for form in FORMS {
            let whole = bytes(form);
            for cut in (0..whole.len()).step_by(17) {
                let _ = variables(&whole[..cut], form);
                let mut damaged = whole.clone();
                damaged[cut] = damaged[cut].wrapping_add(1 + (cut % 200) as u8);
                let _ = variables(&damaged, form);
            }
        }
        assert!(matches!(
            variables(&bytes("m_bin.bin")[..200], "m_bin.bin"),
            Err(FileError::Variables {
                fault: VariableFault::CutOff { .. },
                ..
            })
        ));
        let text = "# name: A\n# type: matrix\n# rows: 1\n# columns: 2\n 1 x\n";
        assert!(matches!(
            variables(text.as_bytes(), "a.txt"),
            Err(FileError::Variables {
                fault: VariableFault::Line {
                    variable,
                    line: 5,
                    fault: LineFault::Octave(OctaveFault::NotANumber { .. }),
                },
                ..
            }) if variable == "A"
        ));
    }
}
