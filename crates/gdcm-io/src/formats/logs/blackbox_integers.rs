//! Packed integers in blackbox frames, encoded as in
//! <https://betaflight.com/docs/development/Blackbox-Internals>. All methods that read return
//! `None` if the bytes end early.

/// Cursor over bytes that hold packed integers.
pub(super) struct PackedBytes<'b> {
    bytes: &'b [u8],
    /// Offset of the next byte.
    pub(super) at: usize,
}

impl<'b> PackedBytes<'b> {
    /// Creates a cursor at the offset `at` \[bytes\].
    pub(super) fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        let byte = self.bytes.get(self.at).copied()?;
        self.at += 1;
        Some(byte)
    }

    /// Reads a variable-length integer: seven bits per byte, lowest first; the eighth bit is set if
    /// another byte follows. Returns `None` if the bytes end early or the integer exceeds five
    /// bytes.
    pub(super) fn unsigned(&mut self) -> Option<u32> {
        let mut value = 0_u32;
        for shift in (0..32).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// Reads a variable-length integer with the sign in the lowest bit.
    pub(super) fn signed(&mut self) -> Option<i32> {
        let value = self.unsigned()?;
        Some((value >> 1).cast_signed() ^ -((value & 1).cast_signed()))
    }

    /// Reads the encoding `NEG_14BIT`: the lower 14 bits of a variable-length integer are a signed
    /// number, whose sign is reversed.
    pub(super) fn neg_14bit(&mut self) -> Option<i32> {
        Some(-extended(self.unsigned()? & 0x3fff, 14))
    }

    /// Reads the encoding `TAG2_3S32`. The upper two bits of the first byte are the tag: 0, 1 and 2
    /// mean 2, 4 and 6 bits for each integer; with 3, the lower six bits give each integer's
    /// length, from 1 to 4 bytes.
    pub(super) fn tag2_3s32(&mut self) -> Option<[i32; 3]> {
        let lead = self.byte()?;
        Some(match lead >> 6 {
            0 => [lead >> 4, lead >> 2, lead].map(|bits| extended(u32::from(bits & 3), 2)),
            1 => {
                let next = self.byte()?;
                [lead & 15, next >> 4, next & 15].map(|bits| extended(u32::from(bits), 4))
            }
            2 => [lead, self.byte()?, self.byte()?].map(|bits| extended(u32::from(bits & 63), 6)),
            _ => {
                let mut values = [0; 3];
                for (index, value) in values.iter_mut().enumerate() {
                    // Two bits give each length, the lowest those of the first integer; each
                    // integer's bytes follow, lowest first.
                    let bytes = 1 + u32::from((lead >> (2 * index)) & 3);
                    let mut bits = 0_u32;
                    for byte in 0..bytes {
                        bits |= u32::from(self.byte()?) << (8 * byte);
                    }
                    *value = extended(bits, 8 * bytes);
                }
                values
            }
        })
    }

    /// Reads the encoding `TAG8_4S16`. The first byte holds a two-bit tag for each integer, the
    /// lowest bits for the first. The tags 0 to 3 mean integers with 0, 4, 8 and 16 bits, which are
    /// packed without gaps, each byte's higher half first.
    pub(super) fn tag8_4s16(&mut self) -> Option<[i32; 4]> {
        let tags = self.byte()?;
        // Lower half of the byte read last, if not yet used.
        let mut half = None;
        let mut values = [0; 4];
        for (index, value) in values.iter_mut().enumerate() {
            // Integer length in half bytes.
            let halves = [0, 1, 2, 4][usize::from((tags >> (2 * index)) & 3)];
            let mut bits = 0_u32;
            for _ in 0..halves {
                let next = match half.take() {
                    Some(next) => next,
                    None => {
                        let byte = self.byte()?;
                        half = Some(byte & 15);
                        byte >> 4
                    }
                };
                bits = bits << 4 | u32::from(next);
            }
            *value = if halves == 0 {
                0
            } else {
                extended(bits, 4 * halves)
            };
        }
        Some(values)
    }
}

/// Sign-extends a number with `count` bits.
fn extended(bits: u32, count: u32) -> i32 {
    let unused = 32 - count;
    (bits << unused).cast_signed() >> unused
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_numbers_agree_with_the_format_description() {
        assert_eq!(PackedBytes::new(&[0xff, 0x01], 0).unsigned(), Some(255));
        assert_eq!(
            PackedBytes::new(&[0x80; 6], 0).unsigned(),
            None,
            "it does not end"
        );
        assert_eq!(
            [0, 1, 2, 3].map(|byte| PackedBytes::new(&[byte], 0).signed()),
            [0, -1, 1, -2].map(Some)
        );
        assert_eq!(
            PackedBytes::new(&[0xff, 0x3f], 0).neg_14bit(),
            Some(-0x1fff)
        );
        assert_eq!(
            PackedBytes::new(&[0b0001_1011], 0).tag2_3s32(),
            Some([1, -2, -1])
        );
        assert_eq!(
            PackedBytes::new(&[0b0100_0111, 0x9f], 0).tag2_3s32(),
            Some([7, -7, -1])
        );
        assert_eq!(
            PackedBytes::new(&[0b1100_0001, 0x34, 0x12, 0xff, 0x05], 0).tag2_3s32(),
            Some([0x1234, -1, 5])
        );
        // Lengths 4, 8, 0 and 16 bits: the values 1, -2, 0 and 0x1234.
        assert_eq!(
            PackedBytes::new(&[0b1100_1001, 0x1f, 0xe1, 0x23, 0x40], 0).tag8_4s16(),
            Some([1, -2, 0, 0x1234])
        );
        assert_eq!(PackedBytes::new(&[0b1100_1001, 0x1f], 0).tag8_4s16(), None);
    }
}
