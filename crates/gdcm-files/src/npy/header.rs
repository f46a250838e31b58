//! What stands before the elements of an array.

use super::element::{Element, ElementFault, sides};
use super::literal::Literal;
use crate::variables::VariableFault;

/// What every `.npy` file begins with.
pub(super) const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The header of a `.npy` file (`numpy.lib.format`, versions 1.0 to 3.0).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) element: Element,
    pub(super) column_major: bool,
    /// As it stands in the file: of any number of dimensions, none included.
    pub(super) shape: Vec<usize>,
    /// Where the elements begin \[bytes\].
    pub(super) length: usize,
}

impl Header {
    /// Reads the header; `name` is what errors call the array.
    pub(super) fn parse(bytes: &[u8], name: &str) -> Result<Self, VariableFault> {
        let (text, length) = text(bytes, name)?;
        let damaged =
            |what: &str| VariableFault::Damaged { variable: name.to_owned(), what: what.to_owned(), offset: 8 };
        let Literal::Dictionary(mut entries) = Literal::parse(&text).map_err(damaged)? else {
            return Err(damaged("the header is no dictionary"));
        };
        let count = entries.len();
        let mut entry = |key: &str| {
            let at = entries.iter().position(|(name, _)| name == key)?;
            Some(entries.swap_remove(at).1)
        };
        let (Some(descr), Some(order), Some(shape), 3) =
            (entry("descr"), entry("fortran_order"), entry("shape"), count)
        else {
            return Err(damaged("the header has not the keys descr, fortran_order and shape"));
        };
        let Literal::Truth(column_major) = order else {
            return Err(damaged("fortran_order is neither True nor False"));
        };
        let shape = sides(&shape).ok_or_else(|| damaged("the shape is no tuple of whole numbers"))?;
        let element = Element::parse(&descr).map_err(|fault| match fault {
            ElementFault::Damaged(what) => damaged(&what),
            ElementFault::Unsupported { what, remedy } => {
                VariableFault::Unsupported { variable: name.to_owned(), what, remedy: remedy.to_owned() }
            }
        })?;
        Ok(Self { element, column_major, shape, length })
    }
}

/// The header's text, and where it ends.
fn text(bytes: &[u8], name: &str) -> Result<(String, usize), VariableFault> {
    if !bytes.starts_with(MAGIC) {
        let found = if bytes.is_empty() { "nothing" } else { "other bytes" };
        return Err(VariableFault::Format { expected: "an array of NumPy (.npy)", found: found.to_owned() });
    }
    let cut_off = || VariableFault::CutOff { variable: name.to_owned(), offset: bytes.len() as u64 };
    let &version = bytes.get(6).ok_or_else(cut_off)?;
    let from = match version {
        1 => 10,
        2 | 3 => 12,
        _ => {
            let what = format!("version {version} of the .npy format");
            let remedy = "save it with numpy.save of a plain array".to_owned();
            return Err(VariableFault::Unsupported { variable: name.to_owned(), what, remedy });
        }
    };
    let digits = bytes.get(8..from).ok_or_else(cut_off)?;
    let length = digits.iter().rev().fold(0, |length, &digit| length << 8 | usize::from(digit));
    let end = from.saturating_add(length);
    let text = bytes.get(from..end).ok_or_else(cut_off)?;
    // Versions 1 and 2 are in Latin-1, whose bytes are the first characters of Unicode; 3 is in UTF-8.
    let text = match version {
        3 => String::from_utf8(text.to_vec()).map_err(|_| VariableFault::Damaged {
            variable: name.to_owned(),
            what: "the header is not UTF-8".to_owned(),
            offset: from as u64,
        })?,
        _ => text.iter().copied().map(char::from).collect(),
    };
    Ok((text, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, text: &[u8]) -> Vec<u8> {
        let length = (text.len() as u32).to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length[..] };
        [MAGIC.as_slice(), &[version, 0], length, text].concat()
    }

    #[test]
    fn all_three_versions_are_read() {
        let text = b"{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }\n";
        for version in 1..=3 {
            let header = Header::parse(&file(version, text), "x").unwrap();
            assert_eq!((header.column_major, header.shape), (true, vec![2, 3]));
        }
        assert!(matches!(Header::parse(&file(4, text), "x"), Err(VariableFault::Unsupported { .. })));
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
                matches!(Header::parse(&file(1, text.as_bytes()), "x"), Err(VariableFault::Damaged { .. })),
                "{text}"
            );
        }
        assert!(matches!(Header::parse(&file(3, &[0xff]), "x"), Err(VariableFault::Damaged { .. })));
        assert!(matches!(Header::parse(b"PK", "x"), Err(VariableFault::Format { .. })));
    }
}
