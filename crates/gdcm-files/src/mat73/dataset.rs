//! The elements of a dataset, read within limits.

use hdf5_pure::{Dataset, Datatype};

use super::chunks;
use super::fault::{damaged, fault};
use super::number_type::NumberType;
use crate::places::{Places, count};
use crate::variables::{Array, ElementKind, MemoryBudget, VariableFault};

/// Whether the elements run as MATLAB or as C keeps them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// The first index runs fastest, and the dimensions stand the other way round.
    Columns,
    /// The last index runs fastest.
    Rows,
}

/// The elements of a dataset as they stand in the file.
pub(super) struct Elements {
    pub(super) datatype: Datatype,
    /// With at least two dimensions.
    pub(super) shape: Vec<usize>,
    /// Number of bytes of each element.
    pub(super) size: usize,
    bytes: Vec<u8>,
    order: Order,
}

impl Elements {
    /// Reads a dataset after its size was found to be within the limits.
    pub(super) fn read(
        dataset: &Dataset,
        order: Order,
        path: &str,
        meter: &MemoryBudget<'_>,
    ) -> Result<Self, VariableFault> {
        let failed = |error| fault(&error, path);
        let too_many = || damaged(path, "there are more elements than can be counted");
        let datatype = dataset.datatype().map_err(failed)?;
        let sides = dataset.shape().map_err(failed)?;
        let size = dataset.element_size().map_err(failed)?;
        let sides: Vec<usize> =
            sides.iter().map(|&side| usize::try_from(side).ok()).collect::<Option<_>>().ok_or_else(too_many)?;
        let elements = count(&sides).ok_or_else(too_many)?;
        meter.take(elements as u64, size, path)?;
        chunks::check(dataset, &sides, size, path, meter)?;
        let bytes = dataset.read_raw().map_err(failed)?;
        let (shape, size) = (matrix_shape(sides, order), usize::try_from(size).map_err(|_| too_many())?);
        let none = bytes.is_empty() && elements == 1;
        // h5py's Empty has no shape and no element, which the library tells by the bytes alone.
        let (shape, elements) = if none { (vec![0, 0], 0) } else { (shape, elements) };
        if elements.checked_mul(size) != Some(bytes.len()) {
            return Err(damaged(path, "the dataset is not as long as its shape says"));
        }
        Ok(Self { datatype, shape, size, bytes, order })
    }

    /// Number of elements.
    pub(super) fn count(&self) -> usize {
        self.bytes.len().checked_div(self.size).unwrap_or(0)
    }

    /// Where the elements stand, in the order of this program.
    pub(super) fn places(&self) -> Box<dyn Iterator<Item = usize>> {
        match (self.order, Places::row_major(&self.shape)) {
            (Order::Rows, Some(places)) => Box::new(places),
            _ => Box::new(0..self.count()),
        }
    }

    /// The bytes of the element at a place.
    pub(super) fn at(&self, place: usize) -> &[u8] {
        self.bytes.get(place * self.size..(place + 1) * self.size).unwrap_or_default()
    }

    /// The numbers, if they are numbers.
    pub(super) fn numbers(&self, path: &str, meter: &MemoryBudget<'_>) -> Result<Option<Array>, VariableFault> {
        let Some(numbers) = NumberType::of(&self.datatype) else { return Ok(None) };
        meter.take(self.count() as u64, if numbers.im.is_some() { 16 } else { 8 }, path)?;
        let part = |offset: usize| {
            let decode = |place| numbers.number.decode(self.at(place).get(offset..).unwrap_or_default());
            self.places().map(decode).collect::<Vec<f64>>()
        };
        let (re, im) = (part(numbers.re), numbers.im.map(part));
        Ok(Some(Array { shape: self.shape.clone(), kind: numbers.number.kind(), re, im }))
    }

    /// Whole numbers of 64 bits without a sign, to the last digit, if that is what they are.
    pub(super) fn words(&self, path: &str, meter: &MemoryBudget<'_>) -> Result<Option<Vec<u64>>, VariableFault> {
        let numbers = NumberType::of(&self.datatype);
        let kind = numbers.filter(|numbers| numbers.im.is_none()).map(|numbers| numbers.number.kind());
        if self.size != 8 || kind != Some(ElementKind::Integer) {
            return Ok(None);
        }
        meter.take(self.count() as u64, 8, path)?;
        let word = |place| self.at(place).iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte));
        Ok(Some(self.places().map(word).collect()))
    }
}

fn matrix_shape(mut sides: Vec<usize>, order: Order) -> Vec<usize> {
    if order == Order::Columns {
        sides.reverse();
        sides.resize(sides.len().max(2), 1);
    }
    match *sides.as_slice() {
        [] => vec![1, 1],
        [columns] => vec![1, columns],
        _ => sides,
    }
}
