//! Types of datasets whose elements are numbers.

use hdf5_pure::{Datatype, DatatypeByteOrder, EnumMember, FloatingPointLayout};

use crate::stored_number::{NumberClass, StoredNumber};

/// Binary16 of IEEE 754, as h5py writes numpy's float16.
const HALF: FloatingPointLayout = FloatingPointLayout {
    bit_offset: 0,
    bit_precision: 16,
    exponent_location: 10,
    exponent_size: 5,
    mantissa_location: 0,
    mantissa_size: 10,
    exponent_bias: 15,
};

/// A type of numbers, real or complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NumberType {
    pub(super) number: StoredNumber,
    /// Where the real part, or the number, begins in an element \[bytes\].
    pub(super) re: usize,
    /// Where the imaginary part does.
    pub(super) im: Option<usize>,
}

impl NumberType {
    /// The numbers that a dataset's type stands for, if it does.
    pub(super) fn of(datatype: &Datatype) -> Option<Self> {
        let Datatype::Compound { members, size } = datatype else {
            return Some(Self { number: number(datatype)?, re: 0, im: None });
        };
        // MATLAB writes complex numbers as real and imag, h5py as r and i.
        let [re, im] = members.as_slice() else { return None };
        if !matches!((re.name.as_str(), im.name.as_str()), ("real", "imag") | ("r", "i")) {
            return None;
        }
        let part = number(&re.datatype).filter(|part| number(&im.datatype) == Some(*part))?;
        let inside = |offset: u64| usize::try_from(offset).ok().filter(|offset| offset + part.size() <= *size as usize);
        Some(Self { number: part, re: inside(re.byte_offset)?, im: Some(inside(im.byte_offset)?) })
    }
}

fn number(datatype: &Datatype) -> Option<StoredNumber> {
    let (class, size, order) = match datatype {
        Datatype::FixedPoint { size, byte_order, layout } => {
            let whole = layout.bit_offset == 0 && u32::from(layout.bit_precision) == size.checked_mul(8)?;
            let class = if layout.signed { NumberClass::Signed } else { NumberClass::Unsigned };
            (whole.then_some(class)?, size, byte_order)
        }
        Datatype::FloatingPoint { size, byte_order, layout } => {
            let ieee = match size {
                2 => HALF,
                4 => FloatingPointLayout::IEEE754_BINARY32,
                _ => FloatingPointLayout::IEEE754_BINARY64,
            };
            ((*layout == ieee).then_some(NumberClass::Float)?, size, byte_order)
        }
        Datatype::Enumeration { base_type, members, .. } => {
            let base = number(base_type)?;
            return if truths(members) {
                StoredNumber::new(NumberClass::Logical, base.size(), false)
            } else {
                Some(base)
            };
        }
        _ => return None,
    };
    let big_endian = match order {
        DatatypeByteOrder::LittleEndian => false,
        DatatypeByteOrder::BigEndian => true,
        DatatypeByteOrder::Vax => return None,
    };
    StoredNumber::new(class, *size as usize, big_endian)
}

/// h5py writes truths as an enumeration of these two names.
fn truths(members: &[EnumMember]) -> bool {
    let names: Vec<_> = members.iter().map(|member| member.name.as_str()).collect();
    names == ["FALSE", "TRUE"]
}
