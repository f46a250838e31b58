//! Numeric types of HDF5 elements.

use hdf5_pure::{CompoundMember, Datatype, DatatypeByteOrder, EnumMember, FloatingPointLayout};

use crate::formats::stored_number::{NumberClass, StoredNumber};

/// IEEE 754 binary16, which h5py writes for NumPy's float16.
const HALF: FloatingPointLayout = FloatingPointLayout {
    bit_offset: 0,
    bit_precision: 16,
    exponent_location: 10,
    exponent_size: 5,
    mantissa_location: 0,
    mantissa_size: 10,
    exponent_bias: 15,
};

/// A numeric type, real or complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NumberType {
    /// Type of the number, or of each part if the number is complex.
    pub(super) number: StoredNumber,
    /// Offset of the number or its real part in an element \[bytes\].
    re: usize,
    /// Offset of the imaginary part in an element \[bytes\]; `None` for real numbers.
    im: Option<usize>,
}

impl NumberType {
    /// Returns the elements' numeric type; `None` if they are not numbers.
    pub(super) fn from_datatype(datatype: &Datatype) -> Option<Self> {
        let Datatype::Compound { members, size } = datatype else {
            return Some(Self {
                number: stored_number(datatype)?,
                re: 0,
                im: None,
            });
        };
        // MATLAB names a complex number's parts real and imag, h5py r and i.
        let [re, im] = members.as_slice() else {
            return None;
        };
        match (re.name.as_str(), im.name.as_str()) {
            ("real", "imag") | ("r", "i") => {}
            _ => return None,
        }
        let number = stored_number(&re.datatype)?;
        if stored_number(&im.datatype) != Some(number) {
            return None;
        }
        let size = *size as usize;
        Some(Self {
            number,
            re: offset_within(re, number, size)?,
            im: Some(offset_within(im, number, size)?),
        })
    }

    pub(super) fn is_complex(self) -> bool {
        self.im.is_some()
    }

    /// Decodes the number in an element, or its real part.
    pub(super) fn real_part(self, element: &[u8]) -> f64 {
        self.part_at(self.re, element)
    }

    /// Decodes the imaginary part of the number in an element; `None` for real numbers.
    pub(super) fn imaginary_part(self, element: &[u8]) -> Option<f64> {
        Some(self.part_at(self.im?, element))
    }

    fn part_at(self, offset: usize, element: &[u8]) -> f64 {
        self.number
            .decode(element.get(offset..).unwrap_or_default())
    }
}

/// Returns the offset of a part \[bytes\]; `None` if the part exceeds an element of `size` bytes.
fn offset_within(part: &CompoundMember, number: StoredNumber, size: usize) -> Option<usize> {
    let offset = usize::try_from(part.byte_offset).ok()?;
    if offset + number.size() <= size {
        Some(offset)
    } else {
        None
    }
}

/// Returns the type for real numbers, which include enumerations; `None` if the elements are not
/// real numbers or have an unusual layout.
fn stored_number(datatype: &Datatype) -> Option<StoredNumber> {
    match datatype {
        Datatype::FixedPoint {
            size,
            byte_order,
            layout,
        } => {
            if layout.bit_offset != 0 || u32::from(layout.bit_precision) != size.checked_mul(8)? {
                return None;
            }
            let class = if layout.signed {
                NumberClass::Signed
            } else {
                NumberClass::Unsigned
            };
            StoredNumber::new(class, *size as usize, is_big_endian(byte_order)?)
        }
        Datatype::FloatingPoint {
            size,
            byte_order,
            layout,
        } => {
            let ieee = match size {
                2 => HALF,
                4 => FloatingPointLayout::IEEE754_BINARY32,
                _ => FloatingPointLayout::IEEE754_BINARY64,
            };
            if *layout != ieee {
                return None;
            }
            let big_endian = is_big_endian(byte_order)?;
            StoredNumber::new(NumberClass::Float, *size as usize, big_endian)
        }
        Datatype::Enumeration {
            base_type, members, ..
        } => {
            let base = stored_number(base_type)?;
            if has_truth_names(members) {
                // The byte order does not matter: a logical value is true if any bit is set.
                StoredNumber::new(NumberClass::Logical, base.size(), false)
            } else {
                Some(base)
            }
        }
        _ => None,
    }
}

fn is_big_endian(order: &DatatypeByteOrder) -> Option<bool> {
    match order {
        DatatypeByteOrder::LittleEndian => Some(false),
        DatatypeByteOrder::BigEndian => Some(true),
        DatatypeByteOrder::Vax => None,
    }
}

/// Returns whether an enumeration has the two names that h5py gives to logical values.
fn has_truth_names(members: &[EnumMember]) -> bool {
    let names: Vec<_> = members.iter().map(|member| member.name.as_str()).collect();
    names == ["FALSE", "TRUE"]
}
