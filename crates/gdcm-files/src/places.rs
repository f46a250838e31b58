//! The order of an array's elements in a file.

/// Where the elements of an array stand in a file, in the order in which this program keeps them: the first index running fastest.
pub(crate) struct Places {
    shape: Vec<usize>,
    strides: Vec<usize>,
    index: Vec<usize>,
    place: usize,
    left: usize,
}

impl Places {
    /// For a file in which the last index runs fastest (row by row); none where the elements cannot be counted.
    pub(crate) fn row_major(shape: &[usize]) -> Option<Self> {
        let left = count(shape)?;
        let mut strides = vec![1; shape.len()];
        for axis in (1..shape.len()).rev() {
            strides[axis - 1] = strides[axis] * shape[axis].max(1);
        }
        Some(Self::new(shape, strides, left))
    }

    /// For a file in which the first index runs fastest (column by column); none where the elements cannot be counted.
    pub(crate) fn column_major(shape: &[usize]) -> Option<Self> {
        let left = count(shape)?;
        let mut strides = vec![1; shape.len()];
        for axis in 1..shape.len() {
            strides[axis] = strides[axis - 1] * shape[axis - 1].max(1);
        }
        Some(Self::new(shape, strides, left))
    }

    fn new(shape: &[usize], strides: Vec<usize>, left: usize) -> Self {
        Self { shape: shape.to_vec(), strides, index: vec![0; shape.len()], place: 0, left }
    }
}

/// Number of elements of an array; none beyond what can be counted.
///
/// Lengths beside a zero are multiplied all the same: an array of nothing with sides that cannot be multiplied is refused too.
pub(crate) fn count(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1usize, |product, &side| product.checked_mul(side.max(1)))?;
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
    fn columns_stay_as_they_are_and_a_number_alone_has_one_place() {
        assert!(Places::column_major(&[2, 3, 4]).unwrap().eq(0..24));
        assert!(Places::row_major(&[]).unwrap().eq(0..1));
        assert!(Places::row_major(&[0, 5]).unwrap().eq(0..0));
    }

    #[test]
    fn what_cannot_be_counted_is_refused() {
        assert!(Places::row_major(&[usize::MAX, 2]).is_none());
        assert!(Places::column_major(&[usize::MAX, 2, 0]).is_none());
    }
}
