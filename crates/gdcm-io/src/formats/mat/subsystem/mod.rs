//! Objects of MATLAB classes, stored in a separate part of the file, which MATLAB calls subsystem
//! data: the cells of a `FileWrapper__`.
//!
//! ```text
//! cell 0        directory: names, classes, objects, and the cell of each property  (directory.rs)
//! cell 1        not read
//! cells 2 ...   values of the properties
//! last cells    1, 2 or 3 depending on the version of the directory; the very last holds the
//!               defaults of the properties, a record for each class; the others are not used
//! ```
//!
//! A variable holds only a reference: the class number and the object numbers (`reference.rs`).
//! `object_assembly.rs` puts together these objects' properties; a property may in turn be a
//! reference.
//!
//! The format is not published by The MathWorks; this reader follows the descriptions by the
//! MatFileHandler, matio (Python) and MAT.jl projects. Files up to version 7 and files of version
//! 7.3 (HDF5) use the same format.

mod directory;
mod enumeration;
mod object_assembly;
mod packed_text;
mod reference;

use std::collections::HashMap;

use crate::formats::mat::subsystem::directory::Directory;
use crate::formats::mat::subsystem::enumeration::EnumerationMembers;
use crate::formats::mat::subsystem::object_assembly::Assembly;
use crate::formats::mat::unreadable::unreadable;
use crate::formats::mat::value_path::ValuePath;
use crate::formats::variables::{StructArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unread::ObjectFault;

pub(in crate::formats::mat) use crate::formats::mat::subsystem::reference::Reference;

/// Name of the class system for objects of MATLAB's `classdef` classes.
pub(super) const CLASS_SYSTEM: &str = "MCOS";
/// Number of cells before the property values.
const CELLS_BEFORE_VALUES: usize = 2;

/// Exact values for cells that hold unsigned 64-bit integers, by cell index from 0.
pub type LongWords = HashMap<usize, Vec<u64>>;

/// Properties of all objects in a MATLAB file.
#[derive(Clone, Debug)]
pub struct Subsystem {
    directory: Directory,
    /// Property values, by the index used in the directory.
    values: Vec<Value>,
    /// Property defaults, one record per class number.
    defaults: Vec<Value>,
    /// Exact 64-bit integer values, by index in `values`.
    long_words: LongWords,
}

impl Subsystem {
    /// Reads the cells from a `FileWrapper__`; the first cell is the directory.
    ///
    /// # Errors
    /// [`VariableFault`] if the directory is missing or damaged, or if the budget is exhausted.
    pub fn new(cells: Vec<Value>, budget: &ReadingBudget<'_>) -> Result<Self, VariableFault> {
        let bytes = directory_bytes(cells.first())?;
        // An empty name needs one byte in the file but a whole `String` in memory.
        budget.take(bytes.len() as u64, 2 * size_of::<String>() as u64, "")?;
        let directory = Directory::read(&bytes)?;
        let mut values = cells;
        let defaults = match values.pop() {
            Some(Value::Cell(defaults)) => defaults.values,
            _ => Vec::new(),
        };
        // `cells_after_values` includes the cell with the defaults, which was removed above.
        let unused = directory.cells_after_values.saturating_sub(1);
        values.truncate(values.len().saturating_sub(unused));
        Ok(Self {
            directory,
            values: values.split_off(CELLS_BEFORE_VALUES.min(values.len())),
            defaults,
            long_words: LongWords::new(),
        })
    }

    /// Adds exact values by cell index, because `string` objects are packed into 64-bit integers,
    /// and a [`Value`] would keep only 53 bits.
    pub fn with_long_words(mut self, cells: LongWords) -> Self {
        for (cell, words) in cells {
            if let Some(value) = cell.checked_sub(CELLS_BEFORE_VALUES) {
                self.long_words.insert(value, words);
            }
        }
        self
    }

    /// Returns the object, or the object array, to which a reference's words point.
    ///
    /// Parts that cannot be decoded become [`Value::Opaque`]; the only errors are an exhausted
    /// budget and a cancellation.
    pub fn object(
        &self,
        reference: &[u32],
        variable: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        match Reference::parse(reference) {
            Some(reference) => self.resolve(&reference, &ValuePath::start(variable), budget),
            None => Ok(unreadable(
                "object",
                ObjectFault::DamagedReference,
                variable,
            )),
        }
    }

    /// Returns the value that an object reference points to.
    pub(super) fn resolve(
        &self,
        reference: &Reference,
        path: &ValuePath<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        Assembly::new(self, budget).resolve(reference, path)
    }

    /// Converts enumeration members to objects whose only property is the member name; `class` is
    /// used if the records do not name a class.
    pub(super) fn enumeration(
        &self,
        records: &StructArray,
        class: &str,
        path: &ValuePath<'_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<Value, VariableFault> {
        match EnumerationMembers::read(&self.directory, records, class) {
            Ok(members) => {
                budget
                    .take(1, members.memory(), "")
                    .map_err(|fault| path.locate(fault))?;
                Ok(members.into_value())
            }
            Err(class) => Ok(unreadable(class, ObjectFault::Enumeration, &path.text())),
        }
    }
}

/// Returns the directory bytes, stored as numbers in a cell.
fn directory_bytes(cell: Option<&Value>) -> Result<Vec<u8>, VariableFault> {
    let Some(Value::Array(array)) = cell else {
        return Err(damaged(Damage::DirectoryMissing));
    };
    let mut bytes = Vec::new();
    for &number in &array.re {
        if !(0.0..256.0).contains(&number) {
            return Err(damaged(Damage::DirectoryBytes));
        }
        bytes.push(number as u8);
    }
    Ok(bytes)
}

/// Returns the error for damaged objects, without a position in the file.
fn damaged(damage: Damage) -> VariableFault {
    VariableFault::damaged("", damage, 0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::mat::read;
    use crate::formats::mat::sample_tests::{
        Directory, chars, column, doubles, file_with_objects, long_words_of, opaque, record,
        reference, words_of,
    };
    use crate::formats::variables::{Array, TextArray};
    use crate::variable_fault::unread::Unread;

    const NAMES: [&str; 12] = [
        "ss", "ssdata", "ltipack", "string", "node", "Data_", "Name_", "any", "a", "self", "Mode_",
        "Flag_",
    ];

    /// Returns a directory with a model that has data and a name, a string, and an object that
    /// contains itself.
    fn directory(version: u32) -> Directory<'static> {
        Directory {
            version,
            names: &NAMES,
            classes: &[[0, 1], [3, 2], [0, 4], [0, 5]],
            made: &[&[[8, 1, 1]]],
            objects: &[[1, 0, 1], [2, 0, 2], [3, 1, 0], [4, 0, 3]],
            plain: &[
                &[[6, 1, 0], [7, 1, 4], [11, 0, 9], [12, 2, 1]],
                &[[9, 1, 2]],
                &[[10, 1, 3]],
            ],
        }
    }

    fn cells(version: u32) -> Vec<Vec<u8>> {
        let text = [1, 2, 1, 1, 5, 0x006f_0074_006f_0072, 0x72];
        let defaults = record(
            "",
            &[
                ("Version_", doubles("", &[1, 1], &[17.0])),
                ("Name_", chars("", "none")),
            ],
        );
        let empty = doubles("", &[0, 0], &[]);
        let mut cells = vec![
            directory(version).cell(),
            empty.clone(),
            column(&[reference(&[2], 2)]),
            long_words_of(&text),
            doubles("", &[1, 2], &[1.0, 2.0]),
            reference(&[4], 4),
            reference(&[3], 3),
        ];
        cells.extend((2..version).map(|_| empty.clone()));
        cells.push(column(&[
            empty.clone(),
            defaults,
            empty.clone(),
            empty.clone(),
            empty,
        ]));
        cells
    }

    fn file(version: u32) -> Vec<u8> {
        let variables = [
            opaque("sys", "ss", reference(&[1], 1)),
            opaque("two", "ss", reference(&[1, 0], 1)),
            opaque("ring", "node", reference(&[4], 4)),
            opaque("lost", "node", reference(&[9], 4)),
            doubles("x", &[1, 1], &[3.0]),
        ];
        file_with_objects(&variables.concat(), Some(&cells(version)))
    }

    fn values(bytes: &[u8]) -> HashMap<String, Value> {
        let variables = read(bytes, &ReadingBudget::new(1 << 20)).unwrap();
        variables
            .into_iter()
            .map(|variable| (variable.name, variable.value))
            .collect()
    }

    fn records(value: &Value) -> &StructArray {
        match value {
            Value::Object(object) => &object.records,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_object_has_its_own_properties_and_those_of_its_class() {
        for version in 2..=4 {
            let values = values(&file(version));
            let model = records(&values["sys"]);
            let names: Vec<&str> = model.fields.iter().map(|(name, _)| name.as_str()).collect();
            assert_eq!(names, ["Data_", "Name_", "Mode_", "Flag_", "Version_"]);
            assert_eq!(
                model.field("Version_").unwrap()[0],
                Value::Array(Array::matrix(1, 1, vec![17.0]))
            );
            let text = |text: &str| {
                Value::Text(TextArray {
                    shape: vec![1, 1],
                    texts: vec![text.to_owned()],
                })
            };
            assert_eq!(model.field("Name_").unwrap()[0], text("rotor"));
            assert_eq!(model.field("Mode_").unwrap()[0], text("a"));
            let Value::Array(flag) = &model.field("Flag_").unwrap()[0] else {
                panic!()
            };
            assert_eq!(flag.re, [1.0]);
        }
    }

    #[test]
    fn nested_objects_are_resolved() {
        let values = values(&file(4));
        let Value::Cell(data) = &records(&values["sys"]).field("Data_").unwrap()[0] else {
            panic!()
        };
        let Value::Object(data) = &data.values[0] else {
            panic!()
        };
        assert_eq!(data.class, "ltipack.ssdata");
        assert_eq!(
            data.records.field("a").unwrap()[0],
            Value::Array(Array::matrix(1, 2, vec![1.0, 2.0]))
        );
    }

    #[test]
    fn a_deleted_object_of_an_array_has_empty_properties() {
        let values = values(&file(4));
        let two = records(&values["two"]);
        assert_eq!(two.shape, [1, 2]);
        assert_eq!(
            two.field("Name_").unwrap()[1],
            Value::Array(Array::matrix(0, 0, Vec::new()))
        );
    }

    #[test]
    fn an_object_that_contains_itself_is_cut() {
        let values = values(&file(4));
        let Value::Opaque { class, why } = &records(&values["ring"]).field("self").unwrap()[0]
        else {
            panic!()
        };
        assert_eq!(class, "node");
        let command = "data = struct(ring.self); save out.mat data".to_owned();
        let fault = ObjectFault::Cycle;
        assert_eq!(**why, Unread::Object { fault, command });
    }

    #[test]
    fn undecodable_objects_leave_the_other_variables_alone() {
        let values = values(&file(4));
        assert!(matches!(&values["lost"], Value::Opaque { .. }));
        assert_eq!(values["x"], Value::Array(Array::matrix(1, 1, vec![3.0])));
        let unknown = self::values(&file(9));
        let Value::Opaque { class, why } = &unknown["sys"] else {
            panic!()
        };
        assert_eq!(class, "ss");
        let Unread::Object {
            fault: ObjectFault::ObjectPart(fault),
            ..
        } = why.as_ref()
        else {
            panic!("{why:?}")
        };
        assert!(matches!(
            **fault,
            VariableFault::Damaged {
                damage: Damage::DirectoryVersion { version: 9 },
                ..
            }
        ));
        assert!(unknown.contains_key("x"));
    }

    #[test]
    fn members_of_an_enumeration_are_known_by_name() {
        let fields = [
            ("EnumerationInstanceTag", words_of(&[0xdd00_0000])),
            ("ClassName", words_of(&[4])),
            ("ValueNames", words_of(&[9, 10])),
            ("ValueIndices", words_of(&[1, 0, 1])),
        ];
        let variable = opaque("mode", "node", record("", &fields));
        let values = values(&file_with_objects(&variable, Some(&cells(4))));
        let texts =
            records(&values["mode"])
                .field("Name")
                .unwrap()
                .iter()
                .map(|value| match value {
                    Value::Text(text) => text.texts[0].as_str(),
                    other => panic!("{other:?}"),
                });
        assert_eq!(texts.collect::<Vec<_>>(), ["self", "a", "self"]);
    }

    #[test]
    fn strings_without_lost_digits_are_read_without_the_long_words() {
        let words = [1.0, 2.0, 1.0, 1.0, 2.0, f64::from(0x62_u32 << 16 | 0x61)];
        let bytes = directory(2).cell();
        let directory = values(&file_with_objects(
            &crate::formats::mat::sample_tests::record("d", &[("d", bytes)]),
            None,
        ));
        let Value::Struct(record) = &directory["d"] else {
            panic!()
        };
        let directory = record.field("d").unwrap()[0].clone();
        let empty = || Value::Array(Array::matrix(0, 0, Vec::new()));
        let text = Value::Array(Array::matrix(1, 6, words.to_vec()));
        let cells = vec![directory, empty(), empty(), text, empty()];
        let subsystem = Subsystem::new(cells, &ReadingBudget::new(1 << 20)).unwrap();
        let budget = ReadingBudget::new(1 << 16);
        let found = subsystem.object(&[0xdd00_0000, 2, 1, 1, 3, 3], "t", &budget);
        assert_eq!(
            found,
            Ok(Value::Text(TextArray {
                shape: vec![1, 1],
                texts: vec!["ab".to_owned()]
            }))
        );
        assert!(matches!(
            subsystem.object(&[1, 2, 3], "t", &budget),
            Ok(Value::Opaque { .. })
        ));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn changed_bytes_never_panic(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        ) {
            let mut bytes = file(4);
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] ^= byte;
            }
            let _ = read(&bytes, &ReadingBudget::new(1 << 20));
        }
    }

    #[test]
    fn a_file_cut_off_anywhere_never_panics() {
        let bytes = file(4);
        for length in 0..bytes.len() {
            let _ = read(&bytes[..length], &ReadingBudget::new(1 << 20));
        }
    }
}
