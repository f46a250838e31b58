//! Files of levels 5 to 7: a header, followed by an element for each variable.
//!
//! ```text
//! 116 bytes  description as text
//!   8 bytes  offset of the object part in the file; blank or zero without objects
//!   2 bytes  version; its high byte is 1
//!   2 bytes  "MI" as a 16-bit integer: the bytes "IM" in a little-endian file, "MI" in a
//!            big-endian file
//! elements   an array for each variable, compressed or not; one without a name holds the objects
//! ```
//!
//! `element.rs` describes elements, `object_part.rs` the object part, which holds the objects of
//! MATLAB's `classdef` classes.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 5 MAT-File Format".

use std::collections::HashSet;

use crate::formats::mat::array_contents::{ArrayReader, Objects};
use crate::formats::mat::array_end::ReadArray;
use crate::formats::mat::array_header::ArrayHeader;
use crate::formats::mat::cursor::{ByteOrder, Cursor};
use crate::formats::mat::element::{DataKind, Element};
use crate::formats::mat::inflate::inflate;
use crate::formats::mat::object_part::read_objects;
use crate::formats::mat::value_path::ValuePath;
use crate::formats::variables::Variable;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::unread::ObjectFault;

/// File header length \[bytes\].
const HEADER_BYTES: usize = 128;
/// Version offset in the header \[bytes\].
const VERSION_AT: usize = 124;
/// Offset of the header field that holds the objects' position \[bytes\].
const OBJECTS_AT: usize = 116;

/// Byte order and version, from the end of the file header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FileVersion {
    pub(super) order: ByteOrder,
    /// Major version, 1 for levels 5 to 7.
    pub(super) major: u8,
}

impl FileVersion {
    /// Reads the version; `None` if the bytes do not begin with such a header.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        match *bytes.get(VERSION_AT..HEADER_BYTES)? {
            [_, major, b'I', b'M'] => Some(Self {
                order: ByteOrder::Little,
                major,
            }),
            [major, _, b'M', b'I'] => Some(Self {
                order: ByteOrder::Big,
                major,
            }),
            _ => None,
        }
    }
}

/// Reads a file's variables, in file order; the file has the byte order `order`.
pub(super) fn read(
    bytes: &[u8],
    order: ByteOrder,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    let objects = objects_or_reason(bytes, order, budget)?;
    let reader = ArrayReader {
        budget,
        objects: &objects,
    };
    let mut file = Cursor::file(bytes, order);
    file.pass(HEADER_BYTES)?;
    let mut variables = Vec::new();
    let mut names = HashSet::new();
    while !file.is_empty() {
        budget.take(1, 2 * size_of::<Variable>() as u64, "")?;
        // Skip arrays without a name, which are internal to MATLAB, mainly object storage.
        let Some(variable) = read_variable(&mut file, &reader)? else {
            continue;
        };
        if !names.insert(variable.name.clone()) {
            return Err(VariableFault::Duplicate {
                name: variable.name,
            });
        }
        variables.push(variable);
    }
    Ok(variables)
}

/// Reads the objects. If there are none or they cannot be read, returns the reason, because the
/// other variables remain readable; the only errors are an exhausted budget and a cancellation.
fn objects_or_reason(
    bytes: &[u8],
    order: ByteOrder,
    budget: &ReadingBudget<'_>,
) -> Result<Objects, VariableFault> {
    match read_objects(bytes, objects_at(bytes, order), order, budget) {
        Ok(objects) => Ok(Objects::Read(objects)),
        Err(fault) if fault.is_of_the_budget() => Err(fault),
        Err(fault) => Ok(Objects::Unread(ObjectFault::ObjectPart(Box::new(fault)))),
    }
}

/// Reads the objects' offset in the file; `None` if the field is blank or zero, because the file
/// has no objects.
fn objects_at(bytes: &[u8], order: ByteOrder) -> Option<usize> {
    let place: [u8; 8] = bytes.get(OBJECTS_AT..VERSION_AT)?.try_into().ok()?;
    if place == [b' '; 8] || place == [0; 8] {
        None
    } else {
        usize::try_from(order.u64(place)).ok()
    }
}

/// Reads the next variable, compressed or not; `None` for an array without a name.
fn read_variable(
    file: &mut Cursor<'_>,
    reader: &ArrayReader<'_>,
) -> Result<Option<Variable>, VariableFault> {
    let start = *file;
    let element = Element::read(file)?;
    if element.kind != DataKind::Packed {
        let mut contents = element.array_contents()?;
        let variable = read_named_array(&mut contents, reader)?;
        // The length in the tag may be wrong (`array_end.rs`).
        *file = ReadArray {
            start,
            element,
            unread: contents,
            end: *file,
        }
        .next_position()?;
        return Ok(variable);
    }
    let bytes = inflate(element.data, reader.budget)?;
    let mut inner = Cursor::unpacked(&bytes, element.data.order, element.data.offset);
    let mut contents = Element::read(&mut inner)?.array_contents()?;
    read_named_array(&mut contents, reader)
}

/// Reads a variable; skips an array without a name and returns `None`.
fn read_named_array(
    contents: &mut Cursor<'_>,
    reader: &ArrayReader<'_>,
) -> Result<Option<Variable>, VariableFault> {
    let header = ArrayHeader::read(contents, reader.budget)?;
    if header.name.is_empty() {
        Element::pass_all(contents)?;
        return Ok(None);
    }
    let value = reader.read_value(&header, contents, &ValuePath::start(&header.name))?;
    Ok(Some(Variable {
        name: header.name,
        value,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::mat::sample_tests::{chars, doubles, element, file, matrix, record};
    use crate::formats::variables::Value;

    /// Returns the array with a tag that counts four bytes too many.
    fn too_long(array: Vec<u8>) -> Vec<u8> {
        let length = array.len() as u32 - 8 + 4;
        [&array[..4], &length.to_le_bytes(), &array[8..]].concat()
    }

    fn variables(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        read(bytes, ByteOrder::Little, &ReadingBudget::new(1 << 16))
    }

    #[test]
    fn the_header_gives_byte_order_and_version() {
        let little = FileVersion {
            order: ByteOrder::Little,
            major: 1,
        };
        assert_eq!(FileVersion::read(&file(&[])), Some(little));
        let header = [&[b' '; 124][..], b"\x01\0MI"].concat();
        let big = FileVersion {
            order: ByteOrder::Big,
            major: 1,
        };
        assert_eq!(FileVersion::read(&header), Some(big));
        assert_eq!(FileVersion::read(&[b' '; 128]), None);
    }

    #[test]
    fn arrays_that_octave_counts_too_long_are_read_with_the_arrays_after_them() {
        let text = too_long(chars("ch", "acbd"));
        let last = too_long(doubles("last", &[1, 1], &[2.0]));
        let found =
            variables(&file(&[text, doubles("x", &[1, 1], &[1.0]), last].concat())).unwrap();
        assert_eq!(
            found
                .iter()
                .map(|variable| variable.name.as_str())
                .collect::<Vec<_>>(),
            ["ch", "x", "last"]
        );
    }

    #[test]
    fn arrays_within_others_that_octave_counts_too_long_are_read_too() {
        let fields = [
            ("a", too_long(chars("", "acbd"))),
            ("b", too_long(doubles("", &[1, 1], &[1.0]))),
        ];
        let found = variables(&file(&too_long(record("s", &fields)))).unwrap();
        let Value::Struct(records) = &found[0].value else {
            panic!()
        };
        assert_eq!(
            records.field("b").unwrap(),
            [Value::Array(crate::formats::variables::Array::matrix(
                1,
                1,
                vec![1.0]
            ))]
        );
    }

    #[test]
    fn arrays_without_a_name_are_passed_over_if_they_are_whole() {
        let nameless = doubles("", &[1, 2], &[1.0, 2.0]);
        assert_eq!(variables(&file(&nameless)), Ok(Vec::new()));
        let cut = file(&nameless[..nameless.len() - 8]);
        assert!(matches!(variables(&cut), Err(VariableFault::CutOff { .. })));
    }

    #[test]
    fn numbers_instead_of_a_variable_are_damage() {
        assert!(matches!(
            variables(&file(&element(9, &[0; 8]))),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            variables(&file(&matrix(99, &[1, 1], "x", &[]))),
            Err(VariableFault::Damaged { .. })
        ));
    }
}
