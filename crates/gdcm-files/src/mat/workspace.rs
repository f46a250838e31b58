//! The part of a file in which its objects lie: bytes that are a small file of their own.
//!
//! The format is not published by The MathWorks; it is known from the descriptions of the MatFileHandler, matio (Python) and
//! MAT.jl projects.

use super::cursor::{ByteOrder, Cursor};
use super::element::{DataKind, Element};
use super::header::{ArrayClass, Header};
use super::inflate::unpacked;
use super::level5::matrix;
use super::matrix::{Arrays, field_names};
use super::numbers::long_words;
use super::subsystem::Subsystem;
use super::trail::{FieldPath, Step};
use crate::variables::{MemoryBudget, Value, VariableFault};

/// What the system of classes is called.
const SYSTEM: &str = "MCOS";
/// The class of the object that holds all others.
const WRAPPER: &str = "FileWrapper__";

/// Reads the objects that begin at byte `at` of the file.
pub(super) fn objects(
    bytes: &[u8],
    at: Option<usize>,
    order: ByteOrder,
    meter: &MemoryBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let mut file = Cursor::file(bytes, order);
    let none = || file.damaged("they lie nowhere in it");
    let at = at.filter(|&at| at < bytes.len()).ok_or_else(none)?;
    file.pass(at)?;
    let element = Element::read(&mut file)?;
    if element.kind != DataKind::Packed {
        return within(matrix(element)?, meter);
    }
    let bytes = unpacked(element.data, meter)?;
    let mut inner = Cursor::unpacked(&bytes, order, element.data.offset);
    within(matrix(Element::read(&mut inner)?)?, meter)
}

/// The objects within an array of bytes.
fn within(array: Cursor<'_>, meter: &MemoryBudget<'_>) -> Result<Subsystem, VariableFault> {
    let mut array = array;
    Header::read(&mut array, meter)?;
    let data = Element::read(&mut array)?.data;
    let order = match data.rest().get(2..4) {
        Some(b"IM") => ByteOrder::Little,
        Some(b"MI") => ByteOrder::Big,
        _ => return Err(data.damaged("their part of the file has no header")),
    };
    let mut small = Cursor::unpacked(data.rest(), order, data.offset);
    small.pass(8)?;
    let mut systems = matrix(Element::read(&mut small)?)?;
    if Header::read(&mut systems, meter)?.class != ArrayClass::Struct {
        return Err(systems.damaged("they do not lie in a record"));
    }
    for name in field_names(&mut systems, meter)? {
        let system = matrix(Element::read(&mut systems)?)?;
        if name == SYSTEM {
            return wrapped(system, meter);
        }
    }
    Err(systems.damaged("there are none of MATLAB's own classes"))
}

/// The objects within a `FileWrapper__`.
fn wrapped(wrapper: Cursor<'_>, meter: &MemoryBudget<'_>) -> Result<Subsystem, VariableFault> {
    let mut wrapper = wrapper;
    let opaque = Header::read(&mut wrapper, meter)?.class == ArrayClass::Opaque;
    let (system, class) = (Element::read(&mut wrapper)?.name()?, Element::read(&mut wrapper)?.name()?);
    if !opaque || system != SYSTEM || class != WRAPPER {
        return Err(wrapper.damaged("they do not lie in a FileWrapper__"));
    }
    let mut contents = matrix(Element::read(&mut wrapper)?)?;
    let header = Header::read(&mut contents, meter)?;
    if header.class != ArrayClass::Cell {
        return Err(contents.damaged("they do not lie in cells"));
    }
    let trail = FieldPath::start(WRAPPER);
    let arrays = Arrays { meter, objects: Err("it lies in the objects of the file") };
    let (mut cells, mut words) = (Vec::new(), Vec::new());
    for at in 0..header.count {
        let cell = contents;
        let value = arrays.inner(&mut contents, &trail.step(Step::Cell(at))?)?;
        words.extend(exact(cell, &value, meter)?.map(|words| (at, words)));
        meter.take(1, 2 * size_of::<Value>() as u64, "")?;
        cells.push(value);
    }
    Ok(Subsystem::new(cells)?.with_long_words(words))
}

/// The numbers of a cell to the last digit, if they are whole numbers of 64 bits.
fn exact(cell: Cursor<'_>, value: &Value, meter: &MemoryBudget<'_>) -> Result<Option<Vec<u64>>, VariableFault> {
    if !matches!(value, Value::Array(array) if !array.is_empty()) {
        return Ok(None);
    }
    let mut cell = cell;
    let mut contents = Element::read(&mut cell)?.data;
    let header = Header::read(&mut contents, meter)?;
    if header.long_words { long_words(&Element::read(&mut contents)?, meter) } else { Ok(None) }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::super::sample::{Directory, doubles, file_with_objects};
    use super::*;

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
        objects(bytes, Some(at), ByteOrder::Little, &MemoryBudget::new(1 << 16, &|_| false))
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
    fn objects_that_lie_elsewhere_are_not_found() {
        let plain = file();
        for at in [0, 8, 136, plain.len(), usize::MAX] {
            assert!(read(&plain, at).is_err(), "{at}");
        }
    }
}
