//! Numbers in bytes, the lowest byte first.

/// A number of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// How many bytes it has.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number that stands at a place; none where the bytes end before.
    pub(super) fn at(self, bytes: &[u8], offset: usize) -> Option<f64> {
        Some(match self {
            Self::I8 => f64::from(i8::from_le_bytes(array(bytes, offset)?)),
            Self::U8 => f64::from(u8::from_le_bytes(array(bytes, offset)?)),
            Self::I16 => f64::from(i16::from_le_bytes(array(bytes, offset)?)),
            Self::U16 => f64::from(u16::from_le_bytes(array(bytes, offset)?)),
            Self::I32 => f64::from(i32::from_le_bytes(array(bytes, offset)?)),
            Self::U32 => f64::from(u32::from_le_bytes(array(bytes, offset)?)),
            Self::I64 => i64::from_le_bytes(array(bytes, offset)?) as f64,
            Self::U64 => u64::from_le_bytes(array(bytes, offset)?) as f64,
            Self::F32 => f64::from(f32::from_le_bytes(array(bytes, offset)?)),
            Self::F64 => f64::from_le_bytes(array(bytes, offset)?),
        })
    }
}

/// So many bytes from a place on; none where there are not as many.
pub(super) fn array<const N: usize>(bytes: &[u8], offset: usize) -> Option<[u8; N]> {
    bytes.get(offset..offset.checked_add(N)?)?.try_into().ok()
}
