//! Cursor for sequential reading in a file's byte order.
//!
//! A cursor is `Copy`: `let start = cursor;` keeps a position, to which reading can return.

use crate::reading_budget::VariableFault;
use crate::variable_fault::damage::Damage;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    pub(super) fn u32(self, bytes: [u8; 4]) -> u32 {
        match self {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        }
    }

    pub(super) fn u64(self, bytes: [u8; 8]) -> u64 {
        match self {
            ByteOrder::Little => u64::from_le_bytes(bytes),
            ByteOrder::Big => u64::from_be_bytes(bytes),
        }
    }
}

/// A position within a section of bytes; reading cannot leave the section.
///
/// Its errors do not contain a variable name, which [`super::value_path::ValuePath::locate`] adds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'b> {
    /// Remaining bytes in the section.
    bytes: &'b [u8],
    pub(super) order: ByteOrder,
    /// Position in the file \[bytes\]; for decompressed or embedded bytes, the position of the data
    /// that contain them.
    pub(super) offset: u64,
    section: Section,
}

/// A section's origin, which determines the error if the section ends too early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    /// The whole file. If it ends too early, the file is truncated.
    File,
    /// An element in the file. If it ends too early, its size is wrong.
    Element,
    /// Decompressed or embedded bytes. Errors give the position of the data that contain them.
    Unpacked,
}

impl<'b> Cursor<'b> {
    /// Creates a cursor at the beginning of a file.
    pub(super) fn file(bytes: &'b [u8], order: ByteOrder) -> Self {
        Self {
            bytes,
            order,
            offset: 0,
            section: Section::File,
        }
    }

    /// Creates a cursor over bytes that were decompressed from, or embedded at, `offset` in the
    /// file.
    pub(super) fn unpacked(bytes: &'b [u8], order: ByteOrder, offset: u64) -> Self {
        Self {
            bytes,
            order,
            offset,
            section: Section::Unpacked,
        }
    }

    pub(super) fn rest(&self) -> &'b [u8] {
        self.bytes
    }

    /// Returns the remaining byte count.
    pub(super) fn len(&self) -> usize {
        self.bytes.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Takes the next `length` bytes as a section.
    ///
    /// # Errors
    /// [`VariableFault`] if fewer bytes remain.
    pub(super) fn take(&mut self, length: usize) -> Result<Cursor<'b>, VariableFault> {
        let Some((bytes, rest)) = self.bytes.split_at_checked(length) else {
            return Err(self.too_short());
        };
        let section = if self.section == Section::File {
            Section::Element
        } else {
            self.section
        };
        let taken = Cursor {
            bytes,
            order: self.order,
            offset: self.offset,
            section,
        };
        self.bytes = rest;
        if self.section != Section::Unpacked {
            self.offset = self.offset.saturating_add(length as u64);
        }
        Ok(taken)
    }

    /// Takes all remaining bytes. If they turn out to be too few, the error is the same as for this
    /// section.
    pub(super) fn take_all(&mut self) -> Result<Cursor<'b>, VariableFault> {
        let rest = *self;
        self.pass(rest.len())?;
        Ok(rest)
    }

    /// Skips `length` bytes, or all remaining bytes if there are fewer.
    pub(super) fn pass(&mut self, length: usize) -> Result<(), VariableFault> {
        self.take(length.min(self.len())).map(drop)
    }

    pub(super) fn read_u32(&mut self) -> Result<u32, VariableFault> {
        let order = self.order;
        let bytes = self.read_array()?;
        Ok(order.u32(bytes))
    }

    fn read_array<const N: usize>(&mut self) -> Result<[u8; N], VariableFault> {
        let taken = self.take(N)?;
        <[u8; N]>::try_from(taken.bytes).map_err(|_| self.too_short())
    }

    /// Returns the error for bytes at this position that contradict the format.
    pub(super) fn damaged(&self, damage: Damage) -> VariableFault {
        VariableFault::damaged("", damage, self.offset)
    }

    /// Returns the error for a section that ends too early.
    fn too_short(&self) -> VariableFault {
        match self.section {
            Section::File => VariableFault::CutOff {
                variable: String::new(),
                offset: self.offset,
            },
            Section::Element | Section::Unpacked => self.damaged(Damage::ElementLength),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_read_in_both_orders() {
        assert_eq!(
            Cursor::file(&[1, 0, 0, 0], ByteOrder::Little).read_u32(),
            Ok(1)
        );
        assert_eq!(
            Cursor::file(&[0, 0, 0, 1], ByteOrder::Big).read_u32(),
            Ok(1)
        );
    }

    #[test]
    fn the_end_of_the_file_is_not_the_end_of_an_element() {
        let mut file = Cursor::file(&[0; 6], ByteOrder::Little);
        let mut element = file.take(3).unwrap();
        assert!(matches!(
            element.read_u32(),
            Err(VariableFault::Damaged { offset: 0, .. })
        ));
        assert!(matches!(
            file.read_u32(),
            Err(VariableFault::CutOff { offset: 3, .. })
        ));
        assert!(file.pass(9).is_ok() && file.is_empty());
    }
}
