//! Order of array elements in files, and decoding of binary numbers.

use crate::formats::variables::ElementKind;

/// Iterator over the positions of array elements in a file, in column-major order (first index
/// fastest), which this program uses.
pub(crate) struct Places {
    shape: Vec<usize>,
    /// Distance in the file between neighbouring elements along each dimension, in elements.
    strides: Vec<usize>,
    /// Indices of the next element.
    index: Vec<usize>,
    /// Position of the next element in the file.
    place: usize,
    /// Number of remaining elements.
    left: usize,
}

impl Places {
    /// Creates the positions for a file in row-major order (last index fastest); `None` if the
    /// number of elements overflows.
    pub(crate) fn row_major(shape: &[usize]) -> Option<Self> {
        let left = count(shape)?;
        let mut strides = vec![1; shape.len()];
        for axis in (1..shape.len()).rev() {
            strides[axis - 1] = strides[axis] * shape[axis].max(1);
        }
        Some(Self::new(shape, strides, left))
    }

    /// Creates the positions for a file in column-major order (first index fastest); `None` if the
    /// number of elements overflows.
    pub(crate) fn column_major(shape: &[usize]) -> Option<Self> {
        let left = count(shape)?;
        let mut strides = vec![1; shape.len()];
        for axis in 1..shape.len() {
            strides[axis] = strides[axis - 1] * shape[axis - 1].max(1);
        }
        Some(Self::new(shape, strides, left))
    }

    fn new(shape: &[usize], strides: Vec<usize>, left: usize) -> Self {
        Self {
            shape: shape.to_vec(),
            strides,
            index: vec![0; shape.len()],
            place: 0,
            left,
        }
    }
}

/// Returns the number of elements; `None` on overflow.
///
/// The product of the nonzero dimensions must not overflow even if another dimension is zero.
pub(crate) fn count(shape: &[usize]) -> Option<usize> {
    let mut product = 1_usize;
    for &side in shape {
        product = product.checked_mul(side.max(1))?;
    }
    Some(shape.iter().product())
}

impl Iterator for Places {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        self.left = self.left.checked_sub(1)?;
        let place = self.place;
        for axis in 0..self.shape.len() {
            self.index[axis] += 1;
            self.place += self.strides[axis];
            if self.index[axis] < self.shape[axis] {
                break;
            }
            self.place -= self.strides[axis] * self.shape[axis];
            self.index[axis] = 0;
        }
        Some(place)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Places {}

/// Reorders elements from row-major to column-major order.
pub(crate) fn first_index_fastest<T>(shape: &[usize], elements: Vec<T>) -> Vec<T> {
    let Some(places) = Places::row_major(shape) else {
        return Vec::new();
    };
    let mut elements: Vec<Option<T>> = elements.into_iter().map(Some).collect();
    places
        .filter_map(|place| elements.get_mut(place)?.take())
        .collect()
}

/// Extends a shape to at least two dimensions: a scalar becomes 1 x 1, and n elements in one
/// dimension become 1 x n.
pub(crate) fn matrix_shape(shape: &[usize]) -> Vec<usize> {
    match *shape {
        [] => vec![1, 1],
        [columns] => vec![1, columns],
        _ => shape.to_vec(),
    }
}

/// Interpretation of the bits of a number.
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

    /// Returns the kind of an array with such numbers.
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
    pub(crate) fn at(self, bytes: &[u8], offset: usize) -> Option<f64> {
        Some(self.decode(bytes.get(offset..offset.checked_add(self.size)?)?))
    }

    /// Returns the bits of a number; missing bytes count as zeros.
    fn bits(self, bytes: &[u8]) -> u64 {
        let mut eight = [0; 8];
        let count = bytes.len().min(self.size);
        eight[..count].copy_from_slice(&bytes[..count]);
        if self.big_endian {
            eight[..self.size].reverse();
        }
        u64::from_le_bytes(eight)
    }
}

/// Decodes a 16-bit float (IEEE 754, binary16).
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
mod places_tests {
    use super::*;

    #[test]
    fn rows_are_turned_into_columns() {
        let places: Vec<_> = Places::row_major(&[2, 3]).unwrap().collect();
        assert_eq!(places, [0, 3, 1, 4, 2, 5]);
        let places: Vec<_> = Places::row_major(&[2, 1, 2]).unwrap().collect();
        assert_eq!(places, [0, 2, 1, 3]);
    }

    #[test]
    fn columns_stay_in_order_and_a_scalar_has_a_single_place() {
        assert!(Places::column_major(&[2, 3, 4]).unwrap().eq(0..24));
        assert!(Places::row_major(&[]).unwrap().eq(0..1));
        assert!(Places::row_major(&[0, 5]).unwrap().eq(0..0));
    }

    #[test]
    fn overflowing_counts_are_refused() {
        assert!(Places::row_major(&[usize::MAX, 2]).is_none());
        assert!(Places::column_major(&[usize::MAX, 2, 0]).is_none());
    }
}

#[cfg(test)]
mod stored_number_tests {
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
