//! Numbers as binary files hold them.

use super::variables::ElementKind;

/// How the bits of a number are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberClass {
    /// True where any bit is set.
    Logical,
    /// Two's complement.
    Signed,
    /// No sign.
    Unsigned,
    /// IEEE 754 binary interchange formats.
    Float,
}

/// One number in a file: how its bits are read, how many bytes it takes, and their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StoredNumber {
    class: NumberClass,
    size: usize,
    big_endian: bool,
}

impl StoredNumber {
    /// A number of `size` bytes, unless there is no such number.
    pub(crate) fn new(class: NumberClass, size: usize, big_endian: bool) -> Option<Self> {
        let sizes: &[usize] = match class {
            NumberClass::Float => &[2, 4, 8],
            _ => &[1, 2, 4, 8],
        };
        sizes.contains(&size).then_some(Self { class, size, big_endian })
    }

    /// Number of bytes.
    pub(crate) fn size(self) -> usize {
        self.size
    }

    /// What an array of such numbers holds.
    pub(crate) fn kind(self) -> ElementKind {
        match self.class {
            NumberClass::Logical => ElementKind::Logical,
            NumberClass::Signed | NumberClass::Unsigned => ElementKind::Integer,
            NumberClass::Float => ElementKind::Float,
        }
    }

    /// The number that stands at the beginning of `bytes`, with zeros for bytes that are missing; whole numbers beyond 2^53 are
    /// rounded to the nearest float.
    pub(crate) fn decode(self, bytes: &[u8]) -> f64 {
        let bits = self.bits(bytes);
        match self.class {
            NumberClass::Logical => f64::from(u8::from(bits != 0)),
            NumberClass::Unsigned => bits as f64,
            NumberClass::Signed => {
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

    fn bits(self, bytes: &[u8]) -> u64 {
        let mut eight = [0; 8];
        for (place, &byte) in bytes.iter().take(self.size).enumerate() {
            eight[if self.big_endian { self.size - 1 - place } else { place }] = byte;
        }
        u64::from_le_bytes(eight)
    }
}

/// The value of a float of 16 bits (IEEE 754, binary16).
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
        // IEEE 754-2008, table 3.5: largest, smallest normal and smallest subnormal number of binary16.
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
        assert_eq!(number(NumberClass::Signed, 2, true).decode(&[0xff, 0xfe]), -2.0);
        assert_eq!(number(NumberClass::Signed, 2, false).decode(&[0xfe, 0xff]), -2.0);
        assert_eq!(number(NumberClass::Unsigned, 4, true).decode(&[0, 0, 1, 2]), 258.0);
        assert_eq!(number(NumberClass::Float, 4, true).decode(&[0x3f, 0x80, 0, 0]), 1.0);
        assert_eq!(number(NumberClass::Signed, 8, false).decode(&[255; 8]), -1.0);
        assert_eq!(StoredNumber::new(NumberClass::Float, 16, false), None);
    }
}
