//! One data element: a tag that says what kind of data follows and how much, and the data.
//!
//! Source: "MAT-File Format", The MathWorks, "Data Element Format".

use super::cursor::Cursor;
use crate::variables::VariableFault;

/// What kind of data an element holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DataKind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
    I64,
    U64,
    Matrix,
    Packed,
    Utf8,
    Utf16,
    Utf32,
}

/// A data element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'b> {
    /// What kind of data it holds.
    pub(super) kind: DataKind,
    /// The data, without what fills them up to eight bytes.
    pub(super) data: Cursor<'b>,
    /// Whether there are as many bytes as its tag says; of an array there may be fewer.
    pub(super) whole: bool,
}

impl DataKind {
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            1 => DataKind::I8,
            2 => DataKind::U8,
            3 => DataKind::I16,
            4 => DataKind::U16,
            5 => DataKind::I32,
            6 => DataKind::U32,
            7 => DataKind::F32,
            9 => DataKind::F64,
            12 => DataKind::I64,
            13 => DataKind::U64,
            14 => DataKind::Matrix,
            15 => DataKind::Packed,
            16 => DataKind::Utf8,
            17 => DataKind::Utf16,
            18 => DataKind::Utf32,
            _ => return None,
        })
    }

    /// Bytes of one number; of matrices and packed data there is none.
    pub(super) fn width(self) -> Option<usize> {
        match self {
            DataKind::I8 | DataKind::U8 | DataKind::Utf8 => Some(1),
            DataKind::I16 | DataKind::U16 | DataKind::Utf16 => Some(2),
            DataKind::I32 | DataKind::U32 | DataKind::F32 | DataKind::Utf32 => Some(4),
            DataKind::F64 | DataKind::I64 | DataKind::U64 => Some(8),
            DataKind::Matrix | DataKind::Packed => None,
        }
    }
}

impl<'b> Element<'b> {
    /// Reads the next element and what fills it up.
    pub(super) fn read(cursor: &mut Cursor<'b>) -> Result<Self, VariableFault> {
        let tag = *cursor;
        let unknown = |number: u32| tag.damaged(format!("an element of the unknown kind {number}"));
        let first = cursor.u32()?;
        // Up to four bytes of data stand in the tag itself, whose upper half is then their number.
        let small = first >> 16;
        if small != 0 {
            let number = first & 0xffff;
            let kind = DataKind::of(number).ok_or_else(|| unknown(number))?;
            let data = cursor.take(4)?.take(small as usize)?;
            return Ok(Self { kind, data, whole: true });
        }
        let kind = DataKind::of(first).ok_or_else(|| unknown(first))?;
        let length = cursor.u32()? as usize;
        if kind == DataKind::Matrix && length > cursor.len() {
            // GNU Octave takes some arrays for a few bytes longer than they are.
            return Ok(Self { kind, data: cursor.take_all()?, whole: false });
        }
        let data = cursor.take(length)?;
        if kind != DataKind::Packed {
            cursor.pass(length.wrapping_neg() % 8)?;
        }
        Ok(Self { kind, data, whole: true })
    }

    /// Whether an array begins here, or nothing follows.
    pub(super) fn begins_array(cursor: &Cursor<'_>) -> bool {
        let mut tag = *cursor;
        let (kind, length) = (tag.u32().map(DataKind::of), tag.u32());
        let fits = length.is_ok_and(|length| length as usize <= tag.len());
        cursor.is_empty() || (fits && matches!(kind, Ok(Some(DataKind::Matrix | DataKind::Packed))))
    }

    /// Passes over all elements that are left.
    pub(super) fn pass_all(cursor: &mut Cursor<'_>) -> Result<(), VariableFault> {
        while !cursor.is_empty() {
            Element::read(cursor)?;
        }
        Ok(())
    }

    /// Number of numbers in it.
    pub(super) fn count(&self) -> Result<usize, VariableFault> {
        let width = self.kind.width().ok_or_else(|| self.data.damaged("a matrix where numbers should stand"))?;
        if !self.data.len().is_multiple_of(width) {
            return Err(self.data.damaged(format!("{} bytes of numbers of {width} bytes each", self.data.len())));
        }
        Ok(self.data.len() / width)
    }

    /// Text of one byte each: a name.
    pub(super) fn name(&self) -> Result<String, VariableFault> {
        match self.kind {
            DataKind::I8 | DataKind::U8 | DataKind::Utf8 => Ok(name_of(self.data.rest())),
            _ => Err(self.data.damaged("numbers where a name should stand")),
        }
    }
}

/// A name up to the first zero. What is not UTF-8 is taken for Latin-1, in which old programs wrote.
pub(super) fn name_of(bytes: &[u8]) -> String {
    let bytes = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
    match std::str::from_utf8(bytes) {
        Ok(name) => name.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::cursor::ByteOrder;
    use super::*;

    fn read(bytes: &[u8]) -> Result<Element<'_>, VariableFault> {
        Element::read(&mut Cursor::file(bytes, ByteOrder::Little))
    }

    #[test]
    fn small_data_stand_in_the_tag() {
        let element = read(&[1, 0, 3, 0, b'a', b'b', b'c', 0]).unwrap();
        assert_eq!((element.kind, element.name().unwrap().as_str()), (DataKind::I8, "abc"));
        assert!(matches!(read(&[1, 0, 5, 0, 0, 0, 0, 0]), Err(VariableFault::Damaged { .. })));
    }

    #[test]
    fn the_next_element_begins_at_a_multiple_of_eight_bytes() {
        let bytes = [&[2, 0, 0, 0, 5, 0, 0, 0, 1, 2, 3, 4, 5, 0, 0, 0][..], &[2, 0, 1, 0, 7, 0, 0, 0]].concat();
        let mut cursor = Cursor::file(&bytes, ByteOrder::Little);
        assert_eq!(Element::read(&mut cursor).unwrap().count(), Ok(5));
        assert_eq!(Element::read(&mut cursor).unwrap().data.rest(), [7]);
    }

    #[test]
    fn an_array_begins_where_its_tag_fits_what_follows() {
        let begins = |bytes: &[u8]| Element::begins_array(&Cursor::file(bytes, ByteOrder::Little));
        assert!(begins(&[]) && begins(&[14, 0, 0, 0, 0, 0, 0, 0]));
        for bytes in [&[14, 0, 0, 0, 1, 0, 0, 0][..], &[9, 0, 0, 0, 0, 0, 0, 0], &[14, 0, 0, 0]] {
            assert!(!begins(bytes), "{bytes:?}");
        }
    }

    #[test]
    fn an_unknown_kind_and_half_numbers_are_damage() {
        assert!(matches!(read(&[8, 0, 0, 0, 0, 0, 0, 0]), Err(VariableFault::Damaged { .. })));
        assert!(read(&[4, 0, 3, 0, 0, 0, 0, 0]).unwrap().count().is_err());
    }

    #[test]
    fn names_that_are_not_utf_8_are_latin_1() {
        assert_eq!(name_of(b"caf\xe9\0\0"), "caf\u{e9}");
    }
}
