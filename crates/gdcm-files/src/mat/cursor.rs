//! Bytes read one after the other, in the order of the machine that wrote them.

use crate::variables::VariableFault;

/// Which byte of a number comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// A place in a stretch of bytes that cannot be left.
///
/// Its faults name no variable: [`super::trail::FieldPath::name`] does that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'b> {
    bytes: &'b [u8],
    /// Which byte of a number comes first.
    pub(super) order: ByteOrder,
    /// Where in the file the next byte lies.
    pub(super) offset: u64,
    /// How the stretch lies in the file.
    stretch: Stretch,
}

/// What it means that a stretch of bytes ends too early, and where its bytes lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stretch {
    /// The file itself: it is cut off.
    File,
    /// An element in the file: its size is wrong.
    Element,
    /// An element that was unpacked: the best that can be said of its place is where the packed one begins.
    Unpacked,
}

impl<'b> Cursor<'b> {
    /// At the beginning of a file.
    pub(super) fn file(bytes: &'b [u8], order: ByteOrder) -> Self {
        Self { bytes, order, offset: 0, stretch: Stretch::File }
    }

    /// At the beginning of what was unpacked, or stands as data, at `offset` of the file.
    pub(super) fn unpacked(bytes: &'b [u8], order: ByteOrder, offset: u64) -> Self {
        Self { bytes, order, offset, stretch: Stretch::Unpacked }
    }

    /// The bytes that are left.
    pub(super) fn rest(&self) -> &'b [u8] {
        self.bytes
    }

    /// Number of bytes that are left.
    pub(super) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Whether the end is reached.
    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The next `length` bytes, as an element of their own.
    pub(super) fn take(&mut self, length: usize) -> Result<Cursor<'b>, VariableFault> {
        let (bytes, rest) = self.bytes.split_at_checked(length).ok_or_else(|| self.too_short())?;
        let stretch = if self.stretch == Stretch::File { Stretch::Element } else { self.stretch };
        let taken = Cursor { bytes, order: self.order, offset: self.offset, stretch };
        self.bytes = rest;
        if self.stretch != Stretch::Unpacked {
            self.offset = self.offset.saturating_add(length as u64);
        }
        Ok(taken)
    }

    /// All bytes that are left, and the place behind them. If they are too few, it is still this stretch that ends too early.
    pub(super) fn take_all(&mut self) -> Result<Cursor<'b>, VariableFault> {
        let rest = *self;
        self.pass(rest.len())?;
        Ok(rest)
    }

    /// Passes over `length` bytes, or as many as there are.
    pub(super) fn pass(&mut self, length: usize) -> Result<(), VariableFault> {
        self.take(length.min(self.len())).map(drop)
    }

    /// The next `N` bytes.
    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], VariableFault> {
        let taken = self.take(N)?;
        <[u8; N]>::try_from(taken.bytes).map_err(|_| self.too_short())
    }

    /// A whole number of 32 bits.
    pub(super) fn u32(&mut self) -> Result<u32, VariableFault> {
        let (order, bytes) = (self.order, self.array()?);
        Ok(order.u32(bytes))
    }

    /// The fault that the bytes here contradict the format.
    pub(super) fn damaged(&self, what: impl Into<String>) -> VariableFault {
        VariableFault::Damaged { variable: String::new(), what: what.into(), offset: self.offset }
    }

    fn too_short(&self) -> VariableFault {
        match self.stretch {
            Stretch::File => VariableFault::CutOff { variable: String::new(), offset: self.offset },
            _ => self.damaged("an element is longer than the one it lies in"),
        }
    }
}

impl ByteOrder {
    /// A whole number of 16 bits.
    pub(super) fn u16(self, bytes: [u8; 2]) -> u16 {
        match self {
            ByteOrder::Little => u16::from_le_bytes(bytes),
            ByteOrder::Big => u16::from_be_bytes(bytes),
        }
    }

    /// A whole number of 32 bits.
    pub(super) fn u32(self, bytes: [u8; 4]) -> u32 {
        match self {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        }
    }

    /// A whole number of 64 bits.
    pub(super) fn u64(self, bytes: [u8; 8]) -> u64 {
        match self {
            ByteOrder::Little => u64::from_le_bytes(bytes),
            ByteOrder::Big => u64::from_be_bytes(bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_read_in_both_orders() {
        assert_eq!(Cursor::file(&[1, 0, 0, 0], ByteOrder::Little).u32(), Ok(1));
        assert_eq!(Cursor::file(&[0, 0, 0, 1], ByteOrder::Big).u32(), Ok(1));
    }

    #[test]
    fn the_end_of_the_file_is_not_the_end_of_an_element() {
        let mut file = Cursor::file(&[0; 6], ByteOrder::Little);
        let mut element = file.take(3).unwrap();
        assert!(matches!(element.u32(), Err(VariableFault::Damaged { offset: 0, .. })));
        assert!(matches!(file.u32(), Err(VariableFault::CutOff { offset: 3, .. })));
        assert!(file.pass(9).is_ok() && file.is_empty());
    }
}
