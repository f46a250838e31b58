//! Files of levels 5 to 7: a header, and one element for each variable.
//!
//! Source: "MAT-File Format", The MathWorks, "Level 5 MAT-File Format".

use std::collections::HashSet;

use super::cursor::{ByteOrder, Cursor};
use super::element::{DataKind, Element};
use super::header::Header;
use super::inflate::unpacked;
use super::matrix::Arrays;
use super::trail::FieldPath;
use super::workspace;
use crate::variables::{MemoryBudget, Variable, VariableFault};

/// Length of the text and the numbers that a file begins with.
pub(super) const HEADER_BYTES: usize = 128;
/// Where the header says how the file is written.
const VERSION_AT: usize = 124;
/// Where the header says where the objects lie.
const OBJECTS_AT: usize = 116;

/// The order of bytes of a file, and the first number of its version; `None` if its header is that of no such file.
pub(super) fn version(bytes: &[u8]) -> Option<(ByteOrder, u8)> {
    match *bytes.get(VERSION_AT..HEADER_BYTES)? {
        [_, version, b'I', b'M'] => Some((ByteOrder::Little, version)),
        [version, _, b'M', b'I'] => Some((ByteOrder::Big, version)),
        _ => None,
    }
}

/// All variables of a file.
pub(super) fn read(bytes: &[u8], order: ByteOrder, meter: &MemoryBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    let objects = match workspace::objects(bytes, objects_at(bytes, order), order, meter) {
        Ok(objects) => Ok(objects),
        Err(fault @ (VariableFault::TooLarge { .. } | VariableFault::Stopped)) => return Err(fault),
        Err(VariableFault::Damaged { what, .. }) => Err(format!("the objects of this file cannot be read: {what}")),
        Err(fault) => Err(format!("the objects of this file cannot be read: {fault}")),
    };
    let arrays = Arrays { meter, objects: objects.as_ref().map_err(String::as_str) };
    let mut file = Cursor::file(bytes, order);
    file.pass(HEADER_BYTES)?;
    let (mut variables, mut names) = (Vec::new(), HashSet::new());
    while !file.is_empty() {
        meter.take(1, 2 * size_of::<Variable>() as u64, "")?;
        // Arrays without a name are the machine's own notes, above all the objects.
        let Some(variable) = variable(&mut file, &arrays)? else { continue };
        if !names.insert(variable.name.clone()) {
            return Err(VariableFault::Duplicate { name: variable.name });
        }
        variables.push(variable);
    }
    Ok(variables)
}

/// Where the objects lie. Old versions leave blanks there.
fn objects_at(bytes: &[u8], order: ByteOrder) -> Option<usize> {
    let place: [u8; 8] = bytes.get(OBJECTS_AT..VERSION_AT)?.try_into().ok()?;
    if place == [b' '; 8] || place == [0; 8] { None } else { usize::try_from(order.u64(place)).ok() }
}

fn variable(file: &mut Cursor<'_>, arrays: &Arrays<'_>) -> Result<Option<Variable>, VariableFault> {
    let start = *file;
    let element = Element::read(file)?;
    if element.kind != DataKind::Packed {
        let mut contents = matrix(element)?;
        let variable = named(&mut contents, arrays)?;
        *file = behind(start, element, contents, *file)?;
        return Ok(variable);
    }
    let bytes = unpacked(element.data, arrays.meter)?;
    let mut inner = Cursor::unpacked(&bytes, element.data.order, element.data.offset);
    named(&mut matrix(Element::read(&mut inner)?)?, arrays)
}

fn named(contents: &mut Cursor<'_>, arrays: &Arrays<'_>) -> Result<Option<Variable>, VariableFault> {
    let header = Header::read(contents, arrays.meter)?;
    if header.name.is_empty() {
        Element::pass_all(contents)?;
        return Ok(None);
    }
    let value = arrays.contents(&header, contents, &FieldPath::start(&header.name))?;
    Ok(Some(Variable { name: header.name, value }))
}

/// Where the next array begins: behind the array that began at `start`, whose `unread` bytes are no part of it if nothing begins
/// where its tag says that it ends. GNU Octave counts too many bytes for some texts and objects.
pub(super) fn behind<'b>(
    start: Cursor<'b>,
    array: Element<'b>,
    unread: Cursor<'b>,
    end: Cursor<'b>,
) -> Result<Cursor<'b>, VariableFault> {
    if unread.is_empty() || (array.whole && Element::begins_array(&end)) {
        return Ok(end);
    }
    let mut behind = start;
    behind.pass(8 + array.data.len().saturating_sub(unread.len()))?;
    Ok(behind)
}

/// The contents of an element that must be an array.
pub(super) fn matrix(element: Element<'_>) -> Result<Cursor<'_>, VariableFault> {
    match element.kind {
        DataKind::Matrix => Ok(element.data),
        _ => Err(element.data.damaged("something else where an array should stand")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::{chars, doubles, element, file, matrix, record};
    use super::*;
    use crate::variables::Value;

    /// The same array, whose tag counts four bytes too many.
    fn too_long(array: Vec<u8>) -> Vec<u8> {
        let length = array.len() as u32 - 8 + 4;
        [&array[..4], &length.to_le_bytes(), &array[8..]].concat()
    }

    fn variables(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        read(bytes, ByteOrder::Little, &MemoryBudget::new(1 << 16, &|_| false))
    }

    #[test]
    fn the_header_says_how_the_file_is_written() {
        assert_eq!(version(&file(&[])), Some((ByteOrder::Little, 1)));
        assert_eq!(version(&[&[b' '; 124][..], b"\x01\0MI"].concat()), Some((ByteOrder::Big, 1)));
        assert_eq!(version(&[b' '; 128]), None);
    }

    #[test]
    fn arrays_that_octave_counts_too_long_are_read_with_what_follows_them() {
        let text = too_long(chars("ch", "acbd"));
        let last = too_long(doubles("last", &[1, 1], &[2.0]));
        let found = variables(&file(&[text, doubles("x", &[1, 1], &[1.0]), last].concat())).unwrap();
        assert_eq!(found.iter().map(|variable| variable.name.as_str()).collect::<Vec<_>>(), ["ch", "x", "last"]);
    }

    #[test]
    fn arrays_within_others_that_octave_counts_too_long_are_read_too() {
        let fields = [("a", too_long(chars("", "acbd"))), ("b", too_long(doubles("", &[1, 1], &[1.0])))];
        let found = variables(&file(&too_long(record("s", &fields)))).unwrap();
        let Value::Struct(records) = &found[0].value else { panic!() };
        assert_eq!(records.field("b").unwrap(), [Value::Array(crate::variables::Array::matrix(1, 1, vec![1.0]))]);
    }

    #[test]
    fn arrays_without_a_name_are_passed_over_if_they_are_whole() {
        let nameless = doubles("", &[1, 2], &[1.0, 2.0]);
        assert_eq!(variables(&file(&nameless)), Ok(Vec::new()));
        let cut = file(&nameless[..nameless.len() - 8]);
        assert!(matches!(variables(&cut), Err(VariableFault::CutOff { .. })));
    }

    #[test]
    fn numbers_where_a_variable_should_stand_are_damage() {
        assert!(matches!(variables(&file(&element(9, &[0; 8]))), Err(VariableFault::Damaged { .. })));
        assert!(matches!(variables(&file(&matrix(99, &[1, 1], "x", &[]))), Err(VariableFault::Damaged { .. })));
    }
}
