//! Header of an array file.
//!
//! ```text
//! 6 bytes       signature
//! 2 bytes       version: major, minor
//! 2 or 4 bytes  length of the header text [bytes], little endian; 4 bytes from version 2 on
//! header text   a Python dictionary, such as
//!               {'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }
//! elements
//! ```

use serde_json::{Map, Value as Json};

use crate::formats::npy::TEXT_LENGTH_AT;
use crate::formats::npy::element::{Element, parse_sides};
use crate::formats::npy::python_literal::parse_literal;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Signature with which the file begins.
pub(super) const MAGIC: &[u8; 6] = b"\x93NUMPY";
/// Major version offset in the file \[bytes\].
const VERSION_AT: usize = 6;
/// Memory for the JSON text and the parsed tree, per byte of the header text \[bytes\].
const MEMORY_PER_BYTE: u64 = 40;

/// Header of a `.npy` file (`numpy.lib.format`, versions 1.0 to 3.0).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) element: Element,
    /// Whether the elements are in column-major order (`fortran_order`), otherwise row-major.
    pub(super) column_major: bool,
    /// Shape as stored, with any number of dimensions, including none.
    pub(super) shape: Vec<usize>,
    /// Offset of the first element \[bytes\].
    pub(super) elements_at: usize,
}

/// Header text, which is a Python dictionary.
struct HeaderText {
    text: String,
    /// Offset just after the text, where the elements begin \[bytes\].
    end: usize,
}

impl Header {
    /// Parses a file's header; `name` is the array name in errors.
    pub(super) fn parse(
        bytes: &[u8],
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Self, VariableFault> {
        let HeaderText { text, end } = HeaderText::read(bytes, name)?;
        budget.take(text.len() as u64, MEMORY_PER_BYTE, name)?;
        let header = parse_literal(&text).map_err(|damage| damaged(name, damage))?;
        let entries = match header.as_object() {
            Some(entries) if entries.len() == 3 => entries,
            _ => return Err(damaged(name, Damage::HeaderKeys)),
        };
        let descr = required_entry(entries, "descr", name)?;
        let order = required_entry(entries, "fortran_order", name)?;
        let shape = required_entry(entries, "shape", name)?;
        let Some(column_major) = order.as_bool() else {
            return Err(damaged(name, Damage::FortranOrder));
        };
        let Some(shape) = parse_sides(shape) else {
            return Err(damaged(name, Damage::ShapeTuple));
        };
        let element =
            Element::parse(descr).map_err(|fault| fault.in_variable(|| name.to_owned()))?;
        Ok(Self {
            element,
            column_major,
            shape,
            elements_at: end,
        })
    }
}

impl HeaderText {
    /// Reads a header's text; `name` is the array name in errors.
    fn read(bytes: &[u8], name: &str) -> Result<Self, VariableFault> {
        if !bytes.starts_with(MAGIC) {
            return Err(VariableFault::other_bytes("a NumPy array (.npy)", bytes));
        }
        let Some(&version) = bytes.get(VERSION_AT) else {
            return Err(VariableFault::cut_off(name, bytes.len()));
        };
        let begin = match version {
            1 => TEXT_LENGTH_AT + 2,
            2 | 3 => TEXT_LENGTH_AT + 4,
            _ => {
                return Err(VariableFault::unsupported(
                    name,
                    UnsupportedContent::NpyVersion { version },
                ));
            }
        };
        let Some(length_bytes) = bytes.get(TEXT_LENGTH_AT..begin) else {
            return Err(VariableFault::cut_off(name, bytes.len()));
        };
        let mut length = 0;
        for &byte in length_bytes.iter().rev() {
            length = length << 8 | usize::from(byte);
        }
        let end = begin.saturating_add(length);
        let Some(text) = bytes.get(begin..end) else {
            return Err(VariableFault::cut_off(name, bytes.len()));
        };
        // Versions 1 and 2 use Latin-1, whose codes are those of the first Unicode characters;
        // version 3 uses UTF-8.
        let text = match version {
            3 => String::from_utf8(text.to_vec())
                .map_err(|_| VariableFault::damaged(name, Damage::HeaderNotUtf8, begin as u64))?,
            _ => text.iter().copied().map(char::from).collect(),
        };
        Ok(Self { text, end })
    }
}

fn required_entry<'h>(
    entries: &'h Map<String, Json>,
    key: &str,
    name: &str,
) -> Result<&'h Json, VariableFault> {
    entries
        .get(key)
        .ok_or_else(|| damaged(name, Damage::HeaderKeys))
}

fn damaged(name: &str, damage: Damage) -> VariableFault {
    VariableFault::damaged(name, damage, TEXT_LENGTH_AT as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header_of(bytes: &[u8]) -> Result<Header, VariableFault> {
        Header::parse(bytes, "x", &ReadingBudget::new(1 << 20))
    }

    fn file(version: u8, text: &[u8]) -> Vec<u8> {
        let length = (text.len() as u32).to_le_bytes();
        let length = if version == 1 {
            &length[..2]
        } else {
            &length[..]
        };
        [MAGIC.as_slice(), &[version, 0], length, text].concat()
    }

    #[test]
    fn all_three_versions_are_read() {
        let text = b"{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }\n";
        for version in 1..=3 {
            let header = header_of(&file(version, text)).unwrap();
            assert_eq!((header.column_major, header.shape), (true, vec![2, 3]));
        }
        assert!(matches!(
            header_of(&file(4, text)),
            Err(VariableFault::Unsupported { .. })
        ));
    }

    #[test]
    fn a_header_needs_its_three_keys_and_no_other() {
        for text in [
            "{'descr': '<f8', 'fortran_order': True}",
            "{'descr': '<f8', 'fortran_order': True, 'shape': (), 'more': 1}",
            "{'descr': '<f8', 'descr': '<f8', 'shape': ()}",
            "{'descr': '<f8', 'fortran_order': 1, 'shape': ()}",
            "{'descr': '<f8', 'fortran_order': True, 'shape': 3}",
            "[]",
        ] {
            assert!(
                matches!(
                    header_of(&file(1, text.as_bytes())),
                    Err(VariableFault::Damaged { .. })
                ),
                "{text}"
            );
        }
        assert!(matches!(
            header_of(&file(3, &[0xff])),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(matches!(
            header_of(b"PK"),
            Err(VariableFault::Format { .. })
        ));
    }
}
