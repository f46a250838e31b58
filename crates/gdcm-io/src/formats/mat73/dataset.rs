//! Dataset elements, read within the budget. A *dataset* is an array in an HDF5 file; `path` is its
//! name in errors.

use hdf5_pure::{Dataset, Datatype, ReferenceType};

use crate::formats::element_order::{Places, element_count, matrix_shape};
use crate::formats::mat73::chunks::check_chunks;
use crate::formats::mat73::library_fault::{damaged, library_fault};
use crate::formats::mat73::number_type::NumberType;
use crate::formats::variables::Array;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Order in which the elements are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// Column-major, as in MATLAB: the dimensions in the file are reversed.
    Columns,
    /// Row-major, as in C.
    Rows,
}

impl Order {
    /// Converts the dimensions in the file to the array shape, which has at least two dimensions.
    fn shape(self, sides: &[usize]) -> Vec<usize> {
        match self {
            Order::Rows => matrix_shape(sides),
            Order::Columns => {
                let mut shape: Vec<usize> = sides.iter().rev().copied().collect();
                shape.resize(shape.len().max(2), 1);
                shape
            }
        }
    }
}

/// Dataset elements, in file order.
pub(super) struct Elements {
    pub(super) datatype: Datatype,
    /// Array shape, with at least two dimensions.
    pub(super) shape: Vec<usize>,
    /// Element size \[bytes\].
    size: usize,
    bytes: Vec<u8>,
    order: Order,
}

impl Elements {
    /// Reads a dataset.
    ///
    /// # Errors
    /// [`VariableFault`] if the size exceeds the budget, or the dataset is damaged or not
    /// supported.
    pub(super) fn read(
        dataset: &Dataset,
        order: Order,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Self, VariableFault> {
        let datatype = dataset
            .datatype()
            .map_err(|error| library_fault(&error, path))?;
        let file_sides = dataset
            .shape()
            .map_err(|error| library_fault(&error, path))?;
        let size = dataset
            .element_size()
            .map_err(|error| library_fault(&error, path))?;
        let sides = sides_in_memory(&file_sides).ok_or_else(|| too_many_elements(path))?;
        let count = element_count(&sides).ok_or_else(|| too_many_elements(path))?;
        budget.take(count as u64, size, path)?;
        check_chunks(dataset, &sides, size, path, budget)?;
        let bytes = dataset
            .read_raw()
            .map_err(|error| library_fault(&error, path))?;
        let size = usize::try_from(size).map_err(|_| too_many_elements(path))?;
        if bytes.is_empty() && count == 1 {
            // An h5py `Empty` has no shape and no element; the library reveals this only by the
            // absence of raw bytes.
            return Ok(Self {
                datatype,
                shape: vec![0, 0],
                size,
                bytes,
                order,
            });
        }
        if count.checked_mul(size) != Some(bytes.len()) {
            return Err(damaged(path, Damage::DatasetShape));
        }
        Ok(Self {
            datatype,
            shape: order.shape(&sides),
            size,
            bytes,
            order,
        })
    }

    pub(super) fn count(&self) -> usize {
        self.bytes.len().checked_div(self.size).unwrap_or(0)
    }

    /// Returns each element's place in the file, in column-major order.
    pub(super) fn places(&self) -> Box<dyn Iterator<Item = usize>> {
        match (self.order, Places::row_major(&self.shape)) {
            (Order::Rows, Some(places)) => Box::new(places),
            _ => Box::new(0..self.count()),
        }
    }

    /// Returns the bytes of the element at a place in the file, counted in elements.
    pub(super) fn bytes_at(&self, place: usize) -> &[u8] {
        self.bytes
            .get(place * self.size..(place + 1) * self.size)
            .unwrap_or_default()
    }

    /// Returns the elements as numbers; `None` if they are not numeric.
    pub(super) fn numbers(
        &self,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Option<Array>, VariableFault> {
        let Some(number_type) = NumberType::from_datatype(&self.datatype) else {
            return Ok(None);
        };
        let is_complex = number_type.is_complex();
        let bytes_per_element = if is_complex { 16 } else { 8 };
        budget.take(self.count() as u64, bytes_per_element, path)?;
        let re = self
            .places()
            .map(|place| number_type.real_part(self.bytes_at(place)))
            .collect();
        let im = if is_complex {
            self.places()
                .map(|place| number_type.imaginary_part(self.bytes_at(place)))
                .collect()
        } else {
            None
        };
        Ok(Some(Array {
            shape: self.shape.clone(),
            kind: number_type.number.kind(),
            re,
            im,
        }))
    }

    /// Returns the elements without rounding, in column-major order; `None` if they are not 64-bit
    /// integers. A negative integer is returned in two's complement.
    pub(super) fn words(
        &self,
        path: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Option<Vec<u64>>, VariableFault> {
        let Some(number_type) = NumberType::from_datatype(&self.datatype) else {
            return Ok(None);
        };
        if number_type.is_complex() || !number_type.number.is_whole_word() {
            return Ok(None);
        }
        budget.take(self.count() as u64, 8, path)?;
        let words = self
            .places()
            .map(|place| number_type.number.bits(self.bytes_at(place)));
        Ok(Some(words.collect()))
    }
}

/// Returns whether elements of this type are references to datasets or groups.
pub(super) fn is_object_reference(datatype: &Datatype) -> bool {
    matches!(
        datatype,
        Datatype::Reference {
            ref_type: ReferenceType::Object,
            ..
        }
    )
}

/// Converts the dimensions in a file; `None` if one exceeds `usize`.
fn sides_in_memory(sides: &[u64]) -> Option<Vec<usize>> {
    sides
        .iter()
        .map(|&side| usize::try_from(side).ok())
        .collect()
}

fn too_many_elements(path: &str) -> VariableFault {
    damaged(path, Damage::ElementCount)
}
