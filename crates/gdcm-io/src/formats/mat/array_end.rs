//! Where an array ends in a file whose tags may be wrong: GNU Octave announces too many bytes for
//! some strings and objects.

use crate::formats::mat::cursor::Cursor;
use crate::formats::mat::element::{DataKind, Element, TAG_BYTES};
use crate::reading_budget::VariableFault;

/// Positions in an array that was read, from which the next element is found.
#[derive(Clone, Copy)]
pub(super) struct ReadArray<'b> {
    /// Tag position.
    pub(super) start: Cursor<'b>,
    pub(super) element: Element<'b>,
    /// Data that were not read.
    pub(super) unread: Cursor<'b>,
    /// Position after the element and its padding, according to the tag.
    pub(super) end: Cursor<'b>,
}

impl<'b> ReadArray<'b> {
    /// Returns the next element's position.
    ///
    /// GNU Octave announces too many bytes for some strings and objects. Hence, if bytes were not
    /// read, and at the announced end neither an array begins nor the data end, the next element
    /// begins with the unread bytes.
    pub(super) fn next_position(self) -> Result<Cursor<'b>, VariableFault> {
        if self.unread.is_empty() || (self.element.is_whole && begins_array(&self.end)) {
            return Ok(self.end);
        }
        let mut next = self.start;
        let read = self.element.data.len().saturating_sub(self.unread.len());
        next.pass(TAG_BYTES + read)?;
        Ok(next)
    }
}

/// Returns whether an array begins at the cursor, or the data end there.
fn begins_array(cursor: &Cursor<'_>) -> bool {
    if cursor.is_empty() {
        return true;
    }
    let mut tag = *cursor;
    let Ok(number) = tag.read_u32() else {
        return false;
    };
    let Ok(length) = tag.read_u32() else {
        return false;
    };
    let is_array = matches!(
        DataKind::from_number(number),
        Some(DataKind::Matrix | DataKind::Packed)
    );
    is_array && length as usize <= tag.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::mat::cursor::ByteOrder;

    #[test]
    fn an_array_begins_at_a_tag_that_fits_the_remaining_bytes() {
        let begins = |bytes: &[u8]| begins_array(&Cursor::file(bytes, ByteOrder::Little));
        assert!(begins(&[]) && begins(&[14, 0, 0, 0, 0, 0, 0, 0]));
        for bytes in [
            &[14, 0, 0, 0, 1, 0, 0, 0][..],
            &[9, 0, 0, 0, 0, 0, 0, 0],
            &[14, 0, 0, 0],
        ] {
            assert!(!begins(bytes), "{bytes:?}");
        }
    }
}
