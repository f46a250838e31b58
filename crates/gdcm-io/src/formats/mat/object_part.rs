//! Object part of a level-5 file: all objects of MATLAB's `classdef` classes. The file's variables
//! contain only references to them.
//!
//! The part is a byte array, which forms a small embedded file. From the outside inwards, with the
//! function that reads each layer:
//!
//! ```text
//! array of bytes, compressed or not                                  read_objects
//!   array header, not needed
//!   bytes of the embedded file                                       read_byte_array
//!     2 bytes version, 2 bytes byte order ("IM" or "MI"), 4 unused   read_embedded_file
//!     array: struct with a field for each class system               read_class_systems
//!       field "MCOS": opaque array of the class "FileWrapper__"      read_wrapper
//!         array: cell array, whose cells describe all objects        read_cells
//! ```
//!
//! `MCOS` is the class system of `classdef` classes. `subsystem/mod.rs` explains the cells. The
//! format is not published by The MathWorks; this reader follows the descriptions by the
//! MatFileHandler, matio (Python) and MAT.jl projects.

use std::ops::Range;

use crate::formats::mat::array_contents::{ArrayReader, Objects, read_field_names};
use crate::formats::mat::array_header::{ArrayClass, ArrayHeader};
use crate::formats::mat::cursor::{ByteOrder, Cursor};
use crate::formats::mat::element::{DataKind, Element};
use crate::formats::mat::inflate::inflate;
use crate::formats::mat::numbers::read_long_words;
use crate::formats::mat::subsystem::{CLASS_SYSTEM, LongWords, Subsystem};
use crate::formats::mat::value_path::{Step, ValuePath};
use crate::formats::variables::Value;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unread::ObjectFault;

/// Embedded file header length \[bytes\].
const EMBEDDED_HEADER_BYTES: usize = 8;
/// Byte-order mark position in this header \[bytes\].
const BYTE_ORDER_MARK: Range<usize> = 2..4;
/// Class whose single object holds all other objects in its cells.
const WRAPPER: &str = "FileWrapper__";

/// Reads the objects at byte `at` in a file; a file without an object part is an error.
pub(super) fn read_objects(
    bytes: &[u8],
    at: Option<usize>,
    order: ByteOrder,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let mut file = Cursor::file(bytes, order);
    let Some(at) = at.filter(|&at| at < bytes.len()) else {
        return Err(file.damaged(Damage::NoObjectPart));
    };
    file.pass(at)?;
    let element = Element::read(&mut file)?;
    if element.kind != DataKind::Packed {
        return read_byte_array(element.array_contents()?, budget);
    }
    let inflated = inflate(element.data, budget)?;
    let mut inner = Cursor::unpacked(&inflated, order, element.data.offset);
    read_byte_array(Element::read(&mut inner)?.array_contents()?, budget)
}

/// Reads the objects from the byte array's contents.
fn read_byte_array(
    mut contents: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    pass_header(&mut contents, budget)?;
    let embedded_file = Element::read(&mut contents)?.data;
    read_embedded_file(embedded_file, budget)
}

/// Moves past the header of an array whose class, shape and name are not needed.
fn pass_header(contents: &mut Cursor<'_>, budget: &ReadingBudget<'_>) -> Result<(), VariableFault> {
    ArrayHeader::read(contents, budget)?;
    Ok(())
}

/// Reads the objects from the embedded file, whose byte order may differ from the outer file's.
fn read_embedded_file(
    file: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let order = match file.rest().get(BYTE_ORDER_MARK) {
        Some(b"IM") => ByteOrder::Little,
        Some(b"MI") => ByteOrder::Big,
        _ => return Err(file.damaged(Damage::ObjectPartHeader)),
    };
    let mut contents = Cursor::unpacked(file.rest(), order, file.offset);
    contents.pass(EMBEDDED_HEADER_BYTES)?;
    read_class_systems(Element::read(&mut contents)?.array_contents()?, budget)
}

/// Reads the objects from a struct with a field for each class system; all systems other than
/// `MCOS` are skipped.
fn read_class_systems(
    mut contents: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    if ArrayHeader::read(&mut contents, budget)?.class != ArrayClass::Struct {
        return Err(contents.damaged(Damage::ClassSystemsRecord));
    }
    // The names come first, then the values in the same order.
    for name in read_field_names(&mut contents, budget)? {
        let value = Element::read(&mut contents)?.array_contents()?;
        if name == CLASS_SYSTEM {
            return read_wrapper(value, budget);
        }
    }
    Err(contents.damaged(Damage::ClassSystemMissing))
}

/// Reads the objects from a `FileWrapper__`: its class system and class names, then its cells.
fn read_wrapper(
    mut contents: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let is_opaque = ArrayHeader::read(&mut contents, budget)?.class == ArrayClass::Opaque;
    let system = Element::read(&mut contents)?.name()?;
    let class = Element::read(&mut contents)?.name()?;
    if !is_opaque || system != CLASS_SYSTEM || class != WRAPPER {
        return Err(contents.damaged(Damage::FileWrapperMissing));
    }
    read_cells(Element::read(&mut contents)?.array_contents()?, budget)
}

/// Reads a `FileWrapper__` object's cells.
///
/// Cells with unsigned 64-bit integers are also read without rounding: `string` objects are packed
/// into such integers, and a [`Value`] would keep only 53 bits.
fn read_cells(
    mut contents: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let header = ArrayHeader::read(&mut contents, budget)?;
    if header.class != ArrayClass::Cell {
        return Err(contents.damaged(Damage::FileWrapperCells));
    }
    let path = ValuePath::start(WRAPPER);
    let objects = nested_objects();
    let reader = ArrayReader {
        budget,
        objects: &objects,
    };
    let mut cells = Vec::new();
    let mut long_words = LongWords::new();
    for index in 0..header.count {
        let cell_start = contents;
        let value = reader.read_nested_value(&mut contents, &path.step(Step::Cell(index))?)?;
        if let Some(words) = read_exact_words(cell_start, &value, budget)? {
            long_words.insert(index, words);
        }
        budget.take(1, 2 * size_of::<Value>() as u64, "")?;
        cells.push(value);
    }
    Ok(Subsystem::new(cells, budget)?.with_long_words(long_words))
}

/// Returns the objects available to the cells themselves: none, because the cells are read before
/// the objects are known. An object in a cell therefore becomes opaque.
fn nested_objects() -> Objects {
    Objects::Unread(ObjectFault::Nested)
}

/// Reads the cell that begins at `cell_start` without rounding if it holds unsigned 64-bit
/// integers; `None` for any other cell. `value` is the same cell as already read, with numbers
/// rounded to 53 bits.
fn read_exact_words(
    mut cell_start: Cursor<'_>,
    value: &Value,
    budget: &ReadingBudget<'_>,
) -> Result<Option<Vec<u64>>, VariableFault> {
    if !matches!(value, Value::Array(array) if !array.is_empty()) {
        return Ok(None);
    }
    let mut contents = Element::read(&mut cell_start)?.data;
    let header = ArrayHeader::read(&mut contents, budget)?;
    if !header.has_long_words {
        return Ok(None);
    }
    read_long_words(&Element::read(&mut contents)?, budget)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::formats::mat::sample_tests::{Directory, doubles, file_with_objects};

    fn file() -> Vec<u8> {
        let directory = Directory {
            version: 2,
            names: &["a"],
            classes: &[[0, 1]],
            made: &[],
            objects: &[[1, 0, 1]],
            plain: &[&[]],
        };
        let empty = doubles("", &[0, 0], &[]);
        file_with_objects(&[], Some(&[directory.cell(), empty.clone(), empty]))
    }

    fn read(bytes: &[u8], at: usize) -> Result<Subsystem, VariableFault> {
        read_objects(
            bytes,
            Some(at),
            ByteOrder::Little,
            &ReadingBudget::new(1 << 16),
        )
    }

    #[test]
    fn objects_are_read_packed_and_plain() {
        let plain = file();
        assert!(read(&plain, 128).is_ok());
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(&plain[128..]).unwrap();
        let data = encoder.finish().unwrap();
        let tag = [15_u32, data.len() as u32].map(u32::to_le_bytes).concat();
        assert!(read(&[&plain[..128], &tag, &data].concat(), 128).is_ok());
    }

    #[test]
    fn objects_at_another_position_are_not_found() {
        let plain = file();
        for at in [0, 8, 136, plain.len(), usize::MAX] {
            assert!(read(&plain, at).is_err(), "{at}");
        }
    }
}
