//! Order of array elements in files, and conversion to column-major order.
//!
//! This program stores arrays in column-major order: the first index changes fastest. In a file in
//! row-major order, a 2 x 3 array with the elements a11 a12 a13 / a21 a22 a23 is stored as
//! a11 a12 a13 a21 a22 a23; its elements in column-major order, a11 a21 a12 a22 a13 a23, are at the
//! places 0 3 1 4 2 5. The strides are 3 and 1: the distances between neighbours along each
//! dimension.

/// Iterates over the places where a file stores array elements, in column-major order.
pub(crate) struct Places {
    shape: Vec<usize>,
    /// Distance between neighbours along each dimension in the file \[elements\].
    strides: Vec<usize>,
    /// Indices of the next element.
    index: Vec<usize>,
    /// Place of the next element in the file, counted in elements from 0.
    place: usize,
    /// Number of remaining elements.
    remaining: usize,
}

impl Places {
    /// Creates the places for a file in row-major order (last index fastest); `None` if the element
    /// count overflows.
    pub(crate) fn row_major(shape: &[usize]) -> Option<Self> {
        let remaining = element_count(shape)?;
        let mut strides = vec![1; shape.len()];
        for axis in (1..shape.len()).rev() {
            strides[axis - 1] = strides[axis] * shape[axis].max(1);
        }
        Some(Self::new(shape, strides, remaining))
    }

    /// Creates the places for a file in column-major order (first index fastest); `None` if the
    /// element count overflows.
    pub(crate) fn column_major(shape: &[usize]) -> Option<Self> {
        let remaining = element_count(shape)?;
        let mut strides = vec![1; shape.len()];
        for axis in 1..shape.len() {
            strides[axis] = strides[axis - 1] * shape[axis - 1].max(1);
        }
        Some(Self::new(shape, strides, remaining))
    }

    fn new(shape: &[usize], strides: Vec<usize>, remaining: usize) -> Self {
        Self {
            shape: shape.to_vec(),
            strides,
            index: vec![0; shape.len()],
            place: 0,
            remaining,
        }
    }
}

/// Returns the element count; `None` on overflow.
///
/// The product of the nonzero dimensions must not overflow even if another dimension is zero,
/// because the strides are such products.
pub(crate) fn element_count(shape: &[usize]) -> Option<usize> {
    let mut product = 1_usize;
    for &side in shape {
        product = product.checked_mul(side.max(1))?;
    }
    Some(shape.iter().product())
}

impl Iterator for Places {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        self.remaining = self.remaining.checked_sub(1)?;
        let place = self.place;
        // Count up like an odometer: advance the first index; after its last value, return it to 0
        // and advance the next index.
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
        (self.remaining, Some(self.remaining))
    }
}

impl ExactSizeIterator for Places {}

/// Reorders elements from row-major to column-major order; returns no elements if the element count
/// overflows.
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

#[cfg(test)]
mod tests {
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
