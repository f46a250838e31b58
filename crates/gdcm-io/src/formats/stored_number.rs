//! Decoding of binary numbers of any class, size and byte order.

use crate::formats::variables::ElementKind;

/// Binary number representation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberClass {
    /// True if any bit is set.
    Logical,
    /// Two's complement integer.
    Signed,
    Unsigned,
    /// IEEE 754 binary floating-point number.
    Float,
}

/// Type of a number in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StoredNumber {
    class: NumberClass,
    /// Size \[bytes\].
    size: usize,
    big_endian: bool,
}

impl StoredNumber {
    /// Creates the type of a number with `size` bytes; `None` if `class` has no number of this
    /// size.
    pub(crate) fn new(class: NumberClass, size: usize, big_endian: bool) -> Option<Self> {
        let sizes: &[usize] = match class {
            NumberClass::Float => &[2, 4, 8],
            _ => &[1, 2, 4, 8],
        };
        if !sizes.contains(&size) {
            return None;
        }
        Some(Self {
            class,
            size,
            big_endian,
        })
    }

    /// Creates a little-endian type; `size` must be valid for the class.
    pub(crate) const fn little_endian(class: NumberClass, size: usize) -> Self {
        Self {
            class,
            size,
            big_endian: false,
        }
    }

    /// Returns the size \[bytes\].
    pub(crate) fn size(self) -> usize {
        self.size
    }

    /// Returns the element kind for an array of such numbers.
    pub(crate) fn kind(self) -> ElementKind {
        match self.class {
            NumberClass::Logical => ElementKind::Logical,
            NumberClass::Signed | NumberClass::Unsigned => ElementKind::Integer,
            NumberClass::Float => ElementKind::Float,
        }
    }

    /// Decodes the number at the beginning of `bytes`; missing bytes count as zeros. Integers
    /// beyond 2^53 are rounded to the nearest float.
    pub(crate) fn decode(self, bytes: &[u8]) -> f64 {
        let bits = self.bits(bytes);
        match self.class {
            NumberClass::Logical => f64::from(u8::from(bits != 0)),
            NumberClass::Unsigned => bits as f64,
            NumberClass::Signed => {
                // Move the sign to bit 63, then back: the shift to the right repeats the sign.
                let unused = 64 - 8 * self.size as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            NumberClass::Float => match self.size {
                2 => half(bits as u16),
                4 => f64::from(f32::from_bits(bits as u32)),
                _ => f64::from_bits(bits),
            },
        }
    }

    /// Decodes consecutive numbers; ignores an incomplete number at the end.
    pub(crate) fn decode_all(self, bytes: &[u8]) -> Vec<f64> {
        bytes
            .chunks_exact(self.size)
            .map(|number| self.decode(number))
            .collect()
    }

    /// Decodes the number at an offset \[bytes\]; `None` if the bytes end too early.
    pub(crate) fn decode_at(self, bytes: &[u8], offset: usize) -> Option<f64> {
        Some(self.decode(bytes.get(offset..offset.checked_add(self.size)?)?))
    }

    /// Returns whether the number is a 64-bit integer.
    pub(crate) fn is_whole_word(self) -> bool {
        self.size == 8 && matches!(self.class, NumberClass::Signed | NumberClass::Unsigned)
    }

    /// Returns the bits of a number, the lowest in bit 0; missing bytes count as zeros.
    pub(crate) fn bits(self, bytes: &[u8]) -> u64 {
        let mut eight = [0; 8];
        let count = bytes.len().min(self.size);
        eight[..count].copy_from_slice(&bytes[..count]);
        if self.big_endian {
            eight[..self.size].reverse();
        }
        u64::from_le_bytes(eight)
    }
}

/// Decodes a 16-bit float (IEEE 754, binary16): a sign bit, 5 exponent bits with bias 15, and 10
/// fraction bits. The powers of 2 in the code already divide the fraction by 2^10.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let exponent = i32::from(bits >> 10 & 31);
    let fraction = f64::from(bits & 1023);
    sign * match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_floats_have_the_values_of_the_standard() {
        // Largest, smallest normal and smallest subnormal number of binary16 (IEEE 754-2008, table
        // 3.5).
        let cases = [
            (0x7bff, 65504.0),
            (0x0400, 2f64.powi(-14)),
            (0x0001, 2f64.powi(-24)),
            (0xc000, -2.0),
            (0x3555, 0.333251953125),
        ];
        for (bits, value) in cases {
            assert_eq!(half(bits), value);
        }
        assert_eq!(half(0xfc00), f64::NEG_INFINITY);
        assert!(half(0x7e00).is_nan());
    }

    #[test]
    fn signs_and_byte_orders_are_kept() {
        let number = |class, size, big| StoredNumber::new(class, size, big).unwrap();
        assert_eq!(
            number(NumberClass::Signed, 2, true).decode(&[0xff, 0xfe]),
            -2.0
        );
        assert_eq!(
            number(NumberClass::Signed, 2, false).decode(&[0xfe, 0xff]),
            -2.0
        );
        assert_eq!(
            number(NumberClass::Unsigned, 4, true).decode(&[0, 0, 1, 2]),
            258.0
        );
        assert_eq!(
            number(NumberClass::Float, 4, true).decode(&[0x3f, 0x80, 0, 0]),
            1.0
        );
        assert_eq!(
            number(NumberClass::Signed, 8, false).decode(&[255; 8]),
            -1.0
        );
        assert_eq!(StoredNumber::new(NumberClass::Float, 16, false), None);
    }
}
