//! Dataset elements, read within limits.

use hdf5_pure::{
    Chunk, ChunkIndex, Dataset, Datatype, DatatypeByteOrder, EnumMember, FloatingPointLayout,
};

use crate::formats::mat73::{damaged, fault};
use crate::formats::strides::{NumberClass, Places, StoredNumber, count, matrix_shape};
use crate::formats::variables::{Array, ElementKind};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Storage order of the elements: MATLAB's or C's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// The first index is fastest, and the dimensions are reversed.
    Columns,
    /// The last index is fastest.
    Rows,
}

/// Elements of a dataset in file order.
pub(super) struct Elements {
    pub(super) datatype: Datatype,
    /// At least two dimensions.
    pub(super) shape: Vec<usize>,
    /// Bytes of each element.
    pub(super) size: usize,
    bytes: Vec<u8>,
    order: Order,
}

impl Elements {
    /// Reads a dataset whose size is within the limits.
    pub(super) fn read(
        dataset: &Dataset,
        order: Order,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Self, VariableFault> {
        let failed = |error| fault(&error, path);
        let too_many = || damaged(path, "there are more elements than can be counted");
        let datatype = dataset.datatype().map_err(failed)?;
        let sides = dataset.shape().map_err(failed)?;
        let size = dataset.element_size().map_err(failed)?;
        let sides: Vec<usize> = sides
            .iter()
            .map(|&side| usize::try_from(side).ok())
            .collect::<Option<_>>()
            .ok_or_else(too_many)?;
        let elements = count(&sides).ok_or_else(too_many)?;
        budget.take(elements as u64, size, path)?;
        check(dataset, &sides, size, path, budget)?;
        let bytes = dataset.read_raw().map_err(failed)?;
        let size = usize::try_from(size).map_err(|_| too_many())?;
        let shape = match order {
            Order::Rows => matrix_shape(&sides),
            Order::Columns => {
                let mut shape: Vec<usize> = sides.into_iter().rev().collect();
                shape.resize(shape.len().max(2), 1);
                shape
            }
        };
        let none = bytes.is_empty() && elements == 1;
        // h5py's Empty has no shape and no element; the library shows this only in the raw bytes.
        let (shape, elements) = if none {
            (vec![0, 0], 0)
        } else {
            (shape, elements)
        };
        if elements.checked_mul(size) != Some(bytes.len()) {
            return Err(damaged(
                path,
                "the dataset is not as long as its shape says",
            ));
        }
        Ok(Self {
            datatype,
            shape,
            size,
            bytes,
            order,
        })
    }

    /// Number of elements.
    pub(super) fn count(&self) -> usize {
        self.bytes.len().checked_div(self.size).unwrap_or(0)
    }

    /// Positions of the elements in the file, in the order of this program.
    pub(super) fn places(&self) -> Box<dyn Iterator<Item = usize>> {
        match (self.order, Places::row_major(&self.shape)) {
            (Order::Rows, Some(places)) => Box::new(places),
            _ => Box::new(0..self.count()),
        }
    }

    /// Returns the bytes of the element at an index.
    pub(super) fn at(&self, place: usize) -> &[u8] {
        self.bytes
            .get(place * self.size..(place + 1) * self.size)
            .unwrap_or_default()
    }

    /// Returns the numbers, if the elements are numbers.
    pub(super) fn numbers(
        &self,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Option<Array>, VariableFault> {
        let Some(numbers) = NumberType::of(&self.datatype) else {
            return Ok(None);
        };
        budget.take(
            self.count() as u64,
            if numbers.im.is_some() { 16 } else { 8 },
            path,
        )?;
        let part = |offset: usize| {
            let decode = |place| {
                numbers
                    .number
                    .decode(self.at(place).get(offset..).unwrap_or_default())
            };
            self.places().map(decode).collect::<Vec<f64>>()
        };
        let re = part(numbers.re);
        let im = numbers.im.map(part);
        Ok(Some(Array {
            shape: self.shape.clone(),
            kind: numbers.number.kind(),
            re,
            im,
        }))
    }

    /// Returns exact unsigned 64-bit integers, if the elements have that type.
    pub(super) fn words(
        &self,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Option<Vec<u64>>, VariableFault> {
        let numbers = NumberType::of(&self.datatype);
        let kind = numbers
            .filter(|numbers| numbers.im.is_none())
            .map(|numbers| numbers.number.kind());
        if self.size != 8 || kind != Some(ElementKind::Integer) {
            return Ok(None);
        }
        budget.take(self.count() as u64, 8, path)?;
        let word = |place| {
            self.at(place)
                .iter()
                .rev()
                .fold(0, |word, &byte| word << 8 | u64::from(byte))
        };
        Ok(Some(self.places().map(word).collect()))
    }
}

// Chunks of packed datasets.

/// Memory of the library for each chunk of a dataset during reading \[bytes\].
const CHUNK: u64 = 128;
/// Largest growth of a chunk by filters, beyond twice its length \[bytes\].
const OVERHEAD: u64 = 4096;

/// Budgets the chunked reading of a dataset (one unpacked chunk, and the bookkeeping of each chunk)
/// and checks that the claimed chunks are possible: the library allocates memory for the claimed
/// sizes and adds up their offsets unchecked.
pub(super) fn check(
    dataset: &Dataset,
    sides: &[usize],
    size: u64,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<(), VariableFault> {
    let failed = |error| fault(&error, path);
    let Some(shape) = dataset.chunk_shape().map_err(failed)? else {
        return Ok(());
    };
    if shape.contains(&0) || shape.len() != sides.len() {
        return Err(damaged(path, "the chunks have no size"));
    }
    let elements = shape.iter().copied().fold(1, u64::saturating_mul);
    let along = |(&side, &chunk): (&usize, &u64)| (side as u64).div_ceil(chunk);
    let most = sides
        .iter()
        .zip(&shape)
        .map(along)
        .fold(1, u64::saturating_mul);
    budget.take(elements, size, path)?;
    budget.take(most, CHUNK, path)?;
    let index = dataset.chunk_index().map_err(failed)?;
    if index == Some(ChunkIndex::BTreeV2) {
        let remedy = "write it with a shape that is fixed";
        return Err(VariableFault::unsupported(
            path,
            "a dataset that can grow in two directions",
            remedy,
        ));
    }
    let longest = elements
        .saturating_mul(size)
        .saturating_mul(2)
        .saturating_add(OVERHEAD);
    let chunks = dataset.chunks().map_err(failed)?;
    if chunks.iter().any(|chunk| chunk.storage_size > longest) {
        return Err(damaged(path, "a chunk is longer than it can be"));
    }
    // The other indices compute offsets instead of storing them.
    if index == Some(ChunkIndex::BTreeV1)
        && (chunks.len() as u64 > most || chunks.iter().any(|chunk| outside(chunk, sides)))
    {
        return Err(damaged(path, "a chunk lies outside the dataset"));
    }
    Ok(())
}

fn outside(chunk: &Chunk, sides: &[usize]) -> bool {
    chunk
        .offset
        .iter()
        .zip(sides)
        .any(|(&offset, &side)| offset >= side as u64)
}

// Numeric dataset types.

/// IEEE 754 binary16, as h5py writes numpy's float16.
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
    pub(super) number: StoredNumber,
    /// Offset of the real part, or of the number, in an element \[bytes\].
    pub(super) re: usize,
    /// Offset of the imaginary part \[bytes\].
    pub(super) im: Option<usize>,
}

impl NumberType {
    /// Returns the numeric type of a dataset's type, if it has one.
    pub(super) fn of(datatype: &Datatype) -> Option<Self> {
        let Datatype::Compound { members, size } = datatype else {
            return Some(Self {
                number: number(datatype)?,
                re: 0,
                im: None,
            });
        };
        // MATLAB names the parts of complex numbers real and imag, h5py r and i.
        let [re, im] = members.as_slice() else {
            return None;
        };
        if !matches!(
            (re.name.as_str(), im.name.as_str()),
            ("real", "imag") | ("r", "i")
        ) {
            return None;
        }
        let part = number(&re.datatype).filter(|part| number(&im.datatype) == Some(*part))?;
        let inside = |offset: u64| {
            usize::try_from(offset)
                .ok()
                .filter(|offset| offset + part.size() <= *size as usize)
        };
        Some(Self {
            number: part,
            re: inside(re.byte_offset)?,
            im: Some(inside(im.byte_offset)?),
        })
    }
}

fn number(datatype: &Datatype) -> Option<StoredNumber> {
    let (class, size, order) = match datatype {
        Datatype::FixedPoint {
            size,
            byte_order,
            layout,
        } => {
            let whole =
                layout.bit_offset == 0 && u32::from(layout.bit_precision) == size.checked_mul(8)?;
            let class = if layout.signed {
                NumberClass::Signed
            } else {
                NumberClass::Unsigned
            };
            (whole.then_some(class)?, size, byte_order)
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
            (
                (*layout == ieee).then_some(NumberClass::Float)?,
                size,
                byte_order,
            )
        }
        Datatype::Enumeration {
            base_type, members, ..
        } => {
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

/// Whether an enumeration has the two names of h5py's logical values.
fn truths(members: &[EnumMember]) -> bool {
    let names: Vec<_> = members.iter().map(|member| member.name.as_str()).collect();
    names == ["FALSE", "TRUE"]
}
