//! Contents of arrays, which may contain further arrays.
//!
//! Each array is an element (`element.rs`) whose data are a header (`array_header.rs`) and, by
//! class, these elements:
//!
//! ```text
//! numbers           real parts; imaginary parts if complex
//! sparse matrix     row indices, column starts, real parts; imaginary parts if complex
//! characters        character codes
//! cell array        an array for each cell
//! struct array      length of a field name, field names, then an array for each field of the
//!                   first record, of the second, ...
//! old-style object  class name, then as a struct array
//! opaque array      class system, class name, then a reference to an object
//! ```
//!
//! An *opaque array* is usually a reference to an object; an *opaque value* ([`Value::Opaque`])
//! holds only the reason why a value of any class could not be read.
//!
//! Source: "MAT-File Format", The MathWorks, "miMATRIX Format". It does not describe opaque arrays:
//! for these, this reader follows the MatFileHandler, matio (Python) and MAT.jl projects.

use std::collections::HashSet;

use crate::formats::mat::array_end::ReadArray;
use crate::formats::mat::array_header::{ArrayClass, ArrayHeader};
use crate::formats::mat::characters::read_text;
use crate::formats::mat::cursor::Cursor;
use crate::formats::mat::element::{DataKind, Element, decode_name};
use crate::formats::mat::numbers::{read_numbers, read_sizes};
use crate::formats::mat::subsystem::{CLASS_SYSTEM, Reference, Subsystem};
use crate::formats::mat::unreadable::{unread_class, unreadable};
use crate::formats::mat::value_path::{Step, ValuePath};
use crate::formats::sparse_matrix::CompressedColumns;
use crate::formats::variables::{Array, CellArray, Object, RECORD_MEMORY, StructArray, Value};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unread::ObjectFault;
use crate::variable_fault::unread::Unread;

/// Estimated memory for a field name, which is kept twice while names are compared \[bytes\].
const FIELD_NAME_MEMORY: u64 = 128;

/// Reads arrays within a budget.
///
/// In the methods, `contents` is the position in an array's data, and `path` leads to the value
/// that is being read. Errors arise without a variable name; the innermost method that knows the
/// path adds it ([`ValuePath::locate`]), and the outer ones leave it.
#[derive(Clone, Copy)]
pub(super) struct ArrayReader<'a> {
    pub(super) budget: &'a ReadingBudget<'a>,
    pub(super) objects: &'a Objects,
}

/// Objects to which a file's opaque arrays refer.
pub(super) enum Objects {
    Read(Subsystem),
    /// The objects cannot be read, for this reason; references to them become opaque values.
    Unread(ObjectFault),
}

impl ArrayReader<'_> {
    /// Reads the next array within another array; errors contain `path`, or the path of a value
    /// inside it.
    pub(super) fn read_nested_value(
        &self,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<Value, VariableFault> {
        self.read_next_value(contents, path)
            .map_err(|fault| path.locate(fault))
    }

    /// Reads the next array and moves `contents` to the element after it. An array without data is
    /// a 0 x 0 array.
    fn read_next_value(
        &self,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<Value, VariableFault> {
        let start = *contents;
        let element = Element::read(contents)?;
        let mut data = element.array_contents()?;
        if data.is_empty() {
            return Ok(Value::empty());
        }
        let header = ArrayHeader::read(&mut data, self.budget)?;
        let value = self.read_value(&header, &mut data, path)?;
        // The length in the tag may be wrong (`array_end.rs`).
        *contents = ReadArray {
            start,
            element,
            unread: data,
            end: *contents,
        }
        .next_position()?;
        Ok(value)
    }

    /// Reads an array's value, after its header; errors contain `path`, or the path of a value
    /// inside it.
    pub(super) fn read_value(
        &self,
        header: &ArrayHeader,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<Value, VariableFault> {
        self.read_value_of_class(header, contents, path)
            .map_err(|fault| path.locate(fault))
    }

    /// Reads the value as its class requires; errors do not yet contain `path`.
    fn read_value_of_class(
        &self,
        header: &ArrayHeader,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<Value, VariableFault> {
        Ok(match header.class {
            ArrayClass::Float | ArrayClass::Integer => {
                Value::Array(self.read_array(header, contents)?)
            }
            ArrayClass::Sparse => Value::Array(self.read_sparse(header, contents)?),
            ArrayClass::Char => {
                let element = Element::read(contents)?;
                Value::Text(read_text(&element, &header.shape, self.budget)?)
            }
            ArrayClass::Cell => Value::Cell(self.read_cell(header, contents, path)?),
            ArrayClass::Struct => Value::Struct(self.read_records(header, contents, path)?),
            ArrayClass::Object => Value::Object(self.read_folder_object(header, contents, path)?),
            ArrayClass::FunctionHandle => {
                Element::pass_all(contents)?;
                unread_class("function_handle", path)
            }
            ArrayClass::Opaque => self.read_opaque(contents, path)?,
        })
    }

    fn read_array(
        &self,
        header: &ArrayHeader,
        contents: &mut Cursor<'_>,
    ) -> Result<Array, VariableFault> {
        let count = header.count;
        let re = read_numbers(&Element::read(contents)?, count, self.budget)?;
        let im = if header.is_complex {
            Some(read_numbers(&Element::read(contents)?, count, self.budget)?)
        } else {
            None
        };
        Ok(Array {
            shape: header.shape.clone(),
            kind: header.element_kind(),
            re,
            im,
        })
    }

    fn read_sparse(
        &self,
        header: &ArrayHeader,
        contents: &mut Cursor<'_>,
    ) -> Result<Array, VariableFault> {
        let start = *contents;
        let &[height, width] = header.shape.as_slice() else {
            return Err(start.damaged(Damage::SparseArrayNotMatrix));
        };
        let rows = read_sizes(&Element::read(contents)?, self.budget)?;
        let starts = read_sizes(&Element::read(contents)?, self.budget)?;
        // The starts end with the stored entry count.
        let stored = starts.last().copied().unwrap_or(0);
        let re = self.read_sparse_numbers(header, stored, contents)?;
        let im = if header.is_complex {
            Some(self.read_sparse_numbers(header, stored, contents)?)
        } else {
            None
        };
        // The entries' column indices.
        self.budget.take(stored as u64, 8, "")?;
        let columns = CompressedColumns {
            shape: [height, width],
            kind: header.element_kind(),
            rows,
            starts,
            re,
            im,
        };
        let Some(entries) = columns.into_entries() else {
            return Err(start.damaged(Damage::SparseColumns));
        };
        entries.full_matrix("", self.budget, || {
            start.damaged(Damage::ElementOutsideSparse)
        })
    }

    /// Reads the real or imaginary parts of the `stored` entries in a sparse matrix.
    fn read_sparse_numbers(
        &self,
        header: &ArrayHeader,
        stored: usize,
        contents: &mut Cursor<'_>,
    ) -> Result<Vec<f64>, VariableFault> {
        let mut element = Element::read(contents)?;
        // For logical values in a sparse matrix, MATLAB announces eight-byte numbers but writes a
        // single byte each.
        if header.is_logical
            && element.kind == DataKind::F64
            && element.data.len() < stored.saturating_mul(8)
        {
            element.kind = DataKind::U8;
        }
        read_numbers(&element, element.count()?, self.budget)
    }

    fn read_cell(
        &self,
        header: &ArrayHeader,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<CellArray, VariableFault> {
        self.take_values(header.count, contents)?;
        let mut values = Vec::new();
        for at in 0..header.count {
            values.push(self.read_nested_value(contents, &path.step(Step::Cell(at))?)?);
        }
        Ok(CellArray {
            shape: header.shape.clone(),
            values,
        })
    }

    /// Reads an object of an old-style class, defined in an `@` folder.
    fn read_folder_object(
        &self,
        header: &ArrayHeader,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<Object, VariableFault> {
        let class = Element::read(contents)?.name()?;
        Ok(Object {
            class,
            records: self.read_records(header, contents, path)?,
        })
    }

    fn read_records(
        &self,
        header: &ArrayHeader,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<StructArray, VariableFault> {
        let names = read_field_names(contents, self.budget)?;
        let count = header.count;
        self.take_values(count.saturating_mul(names.len()), contents)?;
        // A file of a few bytes can announce any number of records without fields.
        self.budget.take(count as u64, RECORD_MEMORY, "")?;
        let mut fields: Vec<(String, Vec<Value>)> = Vec::with_capacity(names.len());
        for name in names {
            fields.push((name, Vec::new()));
        }
        // Without fields, no bytes follow for the records.
        let records = if fields.is_empty() { 0 } else { count };
        for at in 0..records {
            let record = path.step(Step::Record(at))?;
            let path = if count == 1 { path } else { &record };
            for (name, values) in &mut fields {
                values.push(self.read_nested_value(contents, &path.step(Step::Field(name))?)?);
            }
        }
        Ok(StructArray {
            shape: header.shape.clone(),
            fields,
        })
    }

    /// Takes the memory for `count` values from the budget; rejects more values than the remaining
    /// bytes can hold at eight bytes each.
    fn take_values(&self, count: usize, contents: &Cursor<'_>) -> Result<(), VariableFault> {
        if count > contents.len() / 8 {
            return Err(contents.damaged(Damage::ValueCount {
                count,
                bytes: contents.len(),
            }));
        }
        // The factor 2: vectors grow by doubling.
        self.budget
            .take(count as u64, 2 * size_of::<Value>() as u64, "")
    }

    /// Reads an opaque array after its header: an object, whose contents are stored in the file's
    /// object part, an enumeration, or a value that cannot be read.
    fn read_opaque(
        &self,
        contents: &mut Cursor<'_>,
        path: &ValuePath<'_>,
    ) -> Result<Value, VariableFault> {
        let system = Element::read(contents)?.name()?;
        let class = Element::read(contents)?.name()?;
        if system != CLASS_SYSTEM {
            Element::pass_all(contents)?;
            return Ok(Value::opaque(
                format!("{class} ({system})"),
                Unread::ClassSystem,
            ));
        }
        let contents = self.read_nested_value(contents, path)?;
        let variable = path.text();
        let objects = match self.objects {
            Objects::Read(objects) => objects,
            Objects::Unread(why) => return Ok(unreadable(&class, why.clone(), &variable)),
        };
        if let Some(reference) = Reference::from_value(&contents) {
            return objects.resolve(&reference, path, self.budget);
        }
        match &contents {
            Value::Struct(records) => objects.enumeration(records, &class, path, self.budget),
            _ => Ok(unreadable(&class, ObjectFault::NoTarget, &variable)),
        }
    }
}

/// Reads the field names, which precede the records and are padded to a common length; rejects
/// duplicate names.
pub(super) fn read_field_names(
    contents: &mut Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<String>, VariableFault> {
    let lengths = Element::read(contents)?;
    let &[length] = read_sizes(&lengths, budget)?.as_slice() else {
        return Err(lengths.data.damaged(Damage::FieldNamesWithoutLength));
    };
    let names = Element::read(contents)?;
    let bytes = names.data.rest();
    let fits = if length == 0 {
        bytes.is_empty()
    } else {
        bytes.len().is_multiple_of(length)
    };
    if !fits {
        return Err(names.data.damaged(Damage::FieldNamesLength));
    }
    let length = length.max(1);
    budget.take((bytes.len() / length) as u64, FIELD_NAME_MEMORY, "")?;
    let mut seen = HashSet::new();
    let mut found = Vec::new();
    for name in bytes.chunks_exact(length).map(decode_name) {
        if !seen.insert(name.clone()) {
            return Err(VariableFault::Duplicate { name });
        }
        found.push(name);
    }
    Ok(found)
}

#[cfg(test)]
mod matrix_tests {
    use super::*;
    use crate::formats::mat::read;
    use crate::formats::mat::sample_tests::{big_file, doubles, element, file, matrix};

    fn first(bytes: &[u8]) -> Result<Value, VariableFault> {
        let mut variables = read(bytes, &ReadingBudget::new(1 << 16))?;
        Ok(variables.remove(0).value)
    }

    #[test]
    fn the_other_order_of_bytes_is_read() {
        let Ok(Value::Array(array)) = first(&big_file("x", &[1, 2], &[1.0, -2.0])) else {
            panic!()
        };
        assert_eq!((array.shape, array.re), (vec![1, 2], vec![1.0, -2.0]));
    }

    #[test]
    fn an_old_object_has_a_class_and_fields() {
        let fields = [
            element(5, &8_i32.to_le_bytes()),
            element(1, b"a\0\0\0\0\0\0\0b\0\0\0\0\0\0\0"),
        ]
        .concat();
        let values = [doubles("", &[1, 1], &[1.0]), doubles("", &[1, 1], &[2.0])].concat();
        let Ok(Value::Object(object)) = first(&file(&matrix(
            3,
            &[1, 1],
            "sys",
            &[element(1, b"ss"), fields, values],
        ))) else {
            panic!()
        };
        assert_eq!(object.class, "ss");
        assert_eq!(
            object.records.field("b").unwrap()[0],
            Value::Array(Array::matrix(1, 1, vec![2.0]))
        );
    }

    #[test]
    fn a_function_handle_comes_with_the_way_to_save_it() {
        let Ok(Value::Opaque { class, why }) = first(&file(&matrix(
            16,
            &[1, 1],
            "f",
            &[doubles("", &[1, 1], &[1.0])],
        ))) else {
            panic!()
        };
        assert_eq!(class, "function_handle");
        assert!(matches!(*why, Unread::Object { command, .. } if command.contains("func2str(f)")));
    }

    #[test]
    fn true_and_false_in_a_sparse_matrix_take_a_byte_each() {
        let rows = element(5, &[0, 1].map(i32::to_le_bytes).concat());
        let starts = element(5, &[0, 1, 2].map(i32::to_le_bytes).concat());
        let sparse = matrix(
            5 | 0x0200,
            &[2, 2],
            "x",
            &[rows, starts, element(9, &[1, 1])],
        );
        let Ok(Value::Array(array)) = first(&file(&sparse)) else {
            panic!()
        };
        assert_eq!(array.re, [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn sparse_matrices_that_contradict_themselves_are_damaged() {
        let places = |places: &[i32]| {
            element(
                5,
                &places
                    .iter()
                    .flat_map(|place| place.to_le_bytes())
                    .collect::<Vec<_>>(),
            )
        };
        let sparse = |rows: &[i32], starts: &[i32]| {
            let numbers = element(9, &[1.0_f64, 2.0].map(f64::to_le_bytes).concat());
            first(&file(&matrix(
                5,
                &[2, 2],
                "x",
                &[places(rows), places(starts), numbers],
            )))
        };
        assert!(sparse(&[0, 1], &[0, 1, 2]).is_ok());
        for (rows, starts) in [
            (&[0, 1][..], &[0, 1][..]),
            (&[0, 2], &[0, 1, 2]),
            (&[0, 1], &[0, 2, 1]),
            (&[0, 1], &[1, 1, 2]),
            (&[0, 1], &[0, 1, 3]),
            (&[0, -1], &[0, 1, 2]),
        ] {
            assert!(
                matches!(sparse(rows, starts), Err(VariableFault::Damaged { .. })),
                "{rows:?} {starts:?}"
            );
        }
    }

    #[test]
    fn sizes_without_contents_are_refused() {
        let large = [i32::MAX, i32::MAX];
        let none = element(5, &[]);
        let zeros = element(5, &0_i32.to_le_bytes());
        for class in [1, 2, 4, 5, 6, 12] {
            let name = [
                element(5, &8_i32.to_le_bytes()),
                element(1, b"a\0\0\0\0\0\0\0"),
            ]
            .concat();
            let contents = if class == 2 {
                vec![name]
            } else {
                vec![none.clone(), zeros.clone(), none.clone()]
            };
            assert!(
                first(&file(&matrix(class, &large, "x", &contents))).is_err(),
                "{class}"
            );
        }
        let overflow = first(&file(&matrix(
            2,
            &[i32::MAX, i32::MAX, i32::MAX, 0],
            "x",
            &[zeros, none],
        )));
        assert!(
            matches!(overflow, Err(VariableFault::TooLarge { .. })),
            "{overflow:?}"
        );
        let negative = first(&file(&doubles("x", &[-1, 1], &[])));
        assert!(
            matches!(negative, Err(VariableFault::Damaged { .. })),
            "{negative:?}"
        );
    }

    #[test]
    fn two_fields_with_the_same_name_are_refused() {
        let fields = [element(5, &2_i32.to_le_bytes()), element(1, b"a\0a\0")].concat();
        let twice = first(&file(&matrix(2, &[1, 1], "s", &[fields])));
        assert_eq!(
            twice,
            Err(VariableFault::Duplicate {
                name: "a".to_owned()
            })
        );
    }
}

#[cfg(test)]
mod opaque_tests {
    use crate::formats::mat::read;
    use crate::formats::mat::sample_tests::{element, file, opaque, reference};
    use crate::formats::variables::Value;
    use crate::reading_budget::ReadingBudget;
    use crate::variable_fault::VariableFault;
    use crate::variable_fault::damage::Damage;
    use crate::variable_fault::unread::{ObjectFault, Unread};

    fn first(bytes: &[u8]) -> (String, Box<Unread>) {
        match read(bytes, &ReadingBudget::new(1 << 16))
            .unwrap()
            .remove(0)
            .value
        {
            Value::Opaque { class, why } => (class, why),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_object_without_its_part_of_the_file_comes_with_the_way_to_save_it() {
        let (class, why) = first(&file(&opaque("sys", "tf", reference(&[1], 1))));
        assert_eq!(class, "tf");
        let Unread::Object {
            fault: ObjectFault::ObjectPart(fault),
            command,
        } = *why
        else {
            panic!("{why:?}")
        };
        assert!(matches!(
            *fault,
            VariableFault::Damaged {
                damage: Damage::NoObjectPart,
                ..
            }
        ));
        assert_eq!(
            command,
            "[num,den] = tfdata(sys); Ts = sys.Ts; InputDelay = sys.InputDelay; \
            OutputDelay = sys.OutputDelay; IODelay = sys.IODelay; TimeUnit = sys.TimeUnit; \
            save out.mat num den Ts InputDelay OutputDelay IODelay TimeUnit"
        );
    }

    #[test]
    fn objects_of_other_systems_are_named_and_not_read() {
        let flags = element(6, &[17, 0, 0, 0, 0, 0, 0, 0]);
        let names = ["x", "java", "java.util.Date"]
            .map(|name| element(1, name.as_bytes()))
            .concat();
        let (class, _) = first(&file(&element(14, &[flags, names].concat())));
        assert_eq!(class, "java.util.Date (java)");
    }
}
