//! Data elements: a tag with data type and length, followed by the data.
//!
//! ```text
//! element        type (32 bits), length [bytes] (32 bits), data, padding to a multiple of 8 bytes;
//!                compressed data are not padded
//! small element  one 32-bit word with the length (1 to 4) in its upper and the type in its lower
//!                half, then 4 bytes that hold the data
//! ```
//!
//! Source: "MAT-File Format", The MathWorks, "Data Element Format".

use crate::formats::mat::cursor::{ByteOrder, Cursor};
use crate::formats::stored_number::{NumberClass, StoredNumber};
use crate::reading_budget::VariableFault;
use crate::variable_fault::damage::Damage;

/// Tag length \[bytes\] for an element that is not small.
pub(super) const TAG_BYTES: usize = 8;

/// An element's data type; the values are the numbers in the tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DataKind {
    I8 = 1,
    U8 = 2,
    I16 = 3,
    U16 = 4,
    I32 = 5,
    U32 = 6,
    F32 = 7,
    F64 = 9,
    I64 = 12,
    U64 = 13,
    Matrix = 14,
    Packed = 15,
    Utf8 = 16,
    Utf16 = 17,
    Utf32 = 18,
}

impl DataKind {
    /// Returns the data type for the number in a tag; `None` for an unknown number.
    pub(super) fn from_number(number: u32) -> Option<Self> {
        Some(match number {
            1 => Self::I8,
            2 => Self::U8,
            3 => Self::I16,
            4 => Self::U16,
            5 => Self::I32,
            6 => Self::U32,
            7 => Self::F32,
            9 => Self::F64,
            12 => Self::I64,
            13 => Self::U64,
            14 => Self::Matrix,
            15 => Self::Packed,
            16 => Self::Utf8,
            17 => Self::Utf16,
            18 => Self::Utf32,
            _ => return None,
        })
    }

    /// Returns the type of the numbers; `None` for matrices and compressed data.
    fn number_type(self, order: ByteOrder) -> Option<StoredNumber> {
        let (class, size) = match self {
            Self::I8 => (NumberClass::Signed, 1),
            Self::I16 => (NumberClass::Signed, 2),
            Self::I32 => (NumberClass::Signed, 4),
            Self::I64 => (NumberClass::Signed, 8),
            Self::U8 | Self::Utf8 => (NumberClass::Unsigned, 1),
            Self::U16 | Self::Utf16 => (NumberClass::Unsigned, 2),
            Self::U32 | Self::Utf32 => (NumberClass::Unsigned, 4),
            Self::U64 => (NumberClass::Unsigned, 8),
            Self::F32 => (NumberClass::Float, 4),
            Self::F64 => (NumberClass::Float, 8),
            Self::Matrix | Self::Packed => return None,
        };
        StoredNumber::new(class, size, order == ByteOrder::Big)
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'b> {
    pub(super) kind: DataKind,
    /// Data without padding.
    pub(super) data: Cursor<'b>,
    /// Whether the data are as long as the tag announces; only arrays may be shorter.
    pub(super) is_whole: bool,
}

impl<'b> Element<'b> {
    /// Reads the next element and skips its padding.
    pub(super) fn read(cursor: &mut Cursor<'b>) -> Result<Self, VariableFault> {
        let tag = *cursor;
        let first = cursor.read_u32()?;
        let small_length = first >> 16;
        if small_length != 0 {
            let kind = known_kind(first & 0xffff, tag)?;
            let data = cursor.take(4)?.take(small_length as usize)?;
            return Ok(Self {
                kind,
                data,
                is_whole: true,
            });
        }
        let kind = known_kind(first, tag)?;
        let length = cursor.read_u32()? as usize;
        if kind == DataKind::Matrix && length > cursor.len() {
            // GNU Octave announces a few bytes too many for some arrays: take the bytes that are
            // present.
            return Ok(Self {
                kind,
                data: cursor.take_all()?,
                is_whole: false,
            });
        }
        let data = cursor.take(length)?;
        if kind != DataKind::Packed {
            // Bytes up to the next multiple of 8: -length modulo 8.
            cursor.pass(length.wrapping_neg() % 8)?;
        }
        Ok(Self {
            kind,
            data,
            is_whole: true,
        })
    }

    /// Skips all remaining elements.
    pub(super) fn pass_all(cursor: &mut Cursor<'_>) -> Result<(), VariableFault> {
        while !cursor.is_empty() {
            Element::read(cursor)?;
        }
        Ok(())
    }

    /// Returns the type of the numbers in the element.
    ///
    /// # Errors
    /// [`VariableFault`] for an array and for compressed data.
    pub(super) fn number_type(&self) -> Result<StoredNumber, VariableFault> {
        self.kind
            .number_type(self.data.order)
            .ok_or_else(|| self.data.damaged(Damage::ArrayForNumbers))
    }

    /// Returns how many numbers the element holds.
    ///
    /// # Errors
    /// [`VariableFault`] for an array, for compressed data, and if the data end within a number.
    pub(super) fn count(&self) -> Result<usize, VariableFault> {
        let width = self.number_type()?.size();
        let length = self.data.len();
        if !length.is_multiple_of(width) {
            return Err(self.data.damaged(Damage::NumberWidth { length, width }));
        }
        Ok(length / width)
    }

    /// Reads a name, in UTF-8 or Latin-1, from an element that holds bytes.
    pub(super) fn name(&self) -> Result<String, VariableFault> {
        match self.kind {
            DataKind::I8 | DataKind::U8 | DataKind::Utf8 => Ok(decode_name(self.data.rest())),
            _ => Err(self.data.damaged(Damage::NumbersForName)),
        }
    }

    /// Returns an array element's contents; rejects other elements.
    pub(super) fn array_contents(self) -> Result<Cursor<'b>, VariableFault> {
        match self.kind {
            DataKind::Matrix => Ok(self.data),
            _ => Err(self.data.damaged(Damage::ElementForArray)),
        }
    }
}

/// Returns the data type for the number in the tag at `tag`; rejects an unknown number.
fn known_kind(number: u32, tag: Cursor<'_>) -> Result<DataKind, VariableFault> {
    DataKind::from_number(number).ok_or_else(|| tag.damaged(Damage::UnknownDataType { number }))
}

/// Decodes a name up to the first zero byte; bytes that are not UTF-8 are read as Latin-1, the
/// encoding used by old programs.
pub(super) fn decode_name(bytes: &[u8]) -> String {
    let bytes = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
    match std::str::from_utf8(bytes) {
        Ok(name) => name.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::mat::cursor::ByteOrder;

    fn read(bytes: &[u8]) -> Result<Element<'_>, VariableFault> {
        Element::read(&mut Cursor::file(bytes, ByteOrder::Little))
    }

    #[test]
    fn small_data_is_within_the_tag() {
        let element = read(&[1, 0, 3, 0, b'a', b'b', b'c', 0]).unwrap();
        assert_eq!(
            (element.kind, element.name().unwrap().as_str()),
            (DataKind::I8, "abc")
        );
        assert!(matches!(
            read(&[1, 0, 5, 0, 0, 0, 0, 0]),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn the_next_element_begins_at_a_multiple_of_eight_bytes() {
        let bytes = [
            &[2, 0, 0, 0, 5, 0, 0, 0, 1, 2, 3, 4, 5, 0, 0, 0][..],
            &[2, 0, 1, 0, 7, 0, 0, 0],
        ]
        .concat();
        let mut cursor = Cursor::file(&bytes, ByteOrder::Little);
        assert_eq!(Element::read(&mut cursor).unwrap().count(), Ok(5));
        assert_eq!(Element::read(&mut cursor).unwrap().data.rest(), [7]);
    }

    #[test]
    fn an_unknown_kind_and_half_numbers_are_damage() {
        assert!(matches!(
            read(&[8, 0, 0, 0, 0, 0, 0, 0]),
            Err(VariableFault::Damaged { .. })
        ));
        assert!(read(&[4, 0, 3, 0, 0, 0, 0, 0]).unwrap().count().is_err());
    }

    #[test]
    fn names_that_are_not_utf_8_are_latin_1() {
        assert_eq!(decode_name(b"caf\xe9\0\0"), "caf\u{e9}");
    }
}
