//! Object part of a level-5 file: an array of bytes that form a small embedded file, whose cells
//! describe all objects.
//!
//! The format is not published by The MathWorks; this reader follows the descriptions by the
//! MatFileHandler, matio (Python) and MAT.jl projects.

use crate::formats::mat::array_header::{ArrayClass, ArrayHeader};
use crate::formats::mat::cursor::{ByteOrder, Cursor};
use crate::formats::mat::element::{DataKind, Element};
use crate::formats::mat::inflate::inflate;
use crate::formats::mat::matrix::{ArrayReader, read_field_names};
use crate::formats::mat::numbers::read_long_words;
use crate::formats::mat::subsystem::{CLASS_SYSTEM, LongWords, Subsystem};
use crate::formats::mat::value_path::{Step, ValuePath};
use crate::formats::variables::Value;
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Class of the single object whose cells hold all other objects.
const WRAPPER: &str = "FileWrapper__";

/// Reads the objects at byte `at` of a file.
pub(super) fn read_objects(
    bytes: &[u8],
    at: Option<usize>,
    order: ByteOrder,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let mut file = Cursor::file(bytes, order);
    let Some(at) = at.filter(|&at| at < bytes.len()) else {
        return Err(file.damaged("the file has no object part"));
    };
    file.pass(at)?;
    let element = Element::read(&mut file)?;
    if element.kind != DataKind::Packed {
        return read_embedded_file(element.array_contents()?, budget);
    }
    let bytes = inflate(element.data, budget)?;
    let mut inner = Cursor::unpacked(&bytes, order, element.data.offset);
    read_embedded_file(Element::read(&mut inner)?.array_contents()?, budget)
}

/// Reads the objects from an embedded file, which is the content of a byte array. It holds a record
/// whose field `MCOS` contains the objects of MATLAB's `classdef` classes.
fn read_embedded_file(
    mut array: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    ArrayHeader::read(&mut array, budget)?;
    let data = Element::read(&mut array)?.data;
    let order = match data.rest().get(2..4) {
        Some(b"IM") => ByteOrder::Little,
        Some(b"MI") => ByteOrder::Big,
        _ => return Err(data.damaged("the object part has no header")),
    };
    let mut embedded = Cursor::unpacked(data.rest(), order, data.offset);
    embedded.pass(8)?;
    let mut systems = Element::read(&mut embedded)?.array_contents()?;
    if ArrayHeader::read(&mut systems, budget)?.class != ArrayClass::Struct {
        return Err(systems.damaged("the class systems are not in a record"));
    }
    for name in read_field_names(&mut systems, budget)? {
        let system = Element::read(&mut systems)?.array_contents()?;
        if name == CLASS_SYSTEM {
            return read_wrapper(system, budget);
        }
    }
    Err(systems.damaged("the class systems do not include MCOS"))
}

/// Reads the objects from the cells of a `FileWrapper__`.
fn read_wrapper(
    mut wrapper: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let is_opaque = ArrayHeader::read(&mut wrapper, budget)?.class == ArrayClass::Opaque;
    let system = Element::read(&mut wrapper)?.name()?;
    let class = Element::read(&mut wrapper)?.name()?;
    if !is_opaque || system != CLASS_SYSTEM || class != WRAPPER {
        return Err(wrapper.damaged("the class system MCOS has no FileWrapper__"));
    }
    let mut contents = Element::read(&mut wrapper)?.array_contents()?;
    let header = ArrayHeader::read(&mut contents, budget)?;
    if header.class != ArrayClass::Cell {
        return Err(contents.damaged("the FileWrapper__ has no cells"));
    }
    let path = ValuePath::start(WRAPPER);
    let reader = ArrayReader {
        budget,
        objects: Err("it is nested inside another object, which is not supported"),
    };
    let mut cells = Vec::new();
    let mut long_words = LongWords::new();
    for at in 0..header.count {
        let cell = contents;
        let value = reader.nested_value(&mut contents, &path.step(Step::Cell(at))?)?;
        if let Some(words) = read_exact_words(cell, &value, budget)? {
            long_words.insert(at, words);
        }
        budget.take(1, 2 * size_of::<Value>() as u64, "")?;
        cells.push(value);
    }
    Ok(Subsystem::new(cells, budget)?.with_long_words(long_words))
}

/// Reads a cell without rounding if it holds unsigned 64-bit integers; `None` for any other cell.
/// `value` is the cell as already read, with numbers rounded to 53 bits.
fn read_exact_words(
    mut cell: Cursor<'_>,
    value: &Value,
    budget: &ReadingBudget<'_>,
) -> Result<Option<Vec<u64>>, VariableFault> {
    if !matches!(value, Value::Array(array) if !array.is_empty()) {
        return Ok(None);
    }
    let mut contents = Element::read(&mut cell)?.data;
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
