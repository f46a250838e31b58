//! Sparse matrices, and their expansion to full matrices.
//!
//! A file gives [`SparseEntries`] (row and column of each element), or [`CompressedColumns`], which
//! [`CompressedColumns::into_entries`] converts; [`SparseEntries::full_matrix`] expands them.

use crate::formats::variables::{Array, ElementKind};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Nonzero elements of a matrix, with their indices.
pub(crate) struct SparseEntries {
    /// Number of rows, then number of columns.
    pub(crate) shape: [usize; 2],
    pub(crate) kind: ElementKind,
    /// Row index for each element, from 0.
    pub(crate) rows: Vec<usize>,
    /// Column index for each element, from 0.
    pub(crate) columns: Vec<usize>,
    pub(crate) re: Vec<f64>,
    /// Imaginary parts; `None` for real numbers.
    pub(crate) im: Option<Vec<f64>>,
}

impl SparseEntries {
    /// Returns the full matrix; elements with the same indices are added.
    ///
    /// `outside` creates the error for an element outside the matrix.
    pub(crate) fn full_matrix(
        &self,
        variable: &str,
        budget: &ReadingBudget<'_>,
        outside: impl Fn() -> VariableFault,
    ) -> Result<Array, VariableFault> {
        let [height, width] = self.shape;
        let count = (height as u64).saturating_mul(width as u64);
        let bytes_per_element = if self.im.is_some() { 16 } else { 8 };
        budget.take(count, bytes_per_element, variable)?;
        let im = match &self.im {
            Some(im) => Some(self.expand(im).ok_or_else(&outside)?),
            None => None,
        };
        Ok(Array {
            shape: self.shape.to_vec(),
            kind: self.kind,
            re: self.expand(&self.re).ok_or_else(&outside)?,
            im,
        })
    }

    /// Returns a full matrix in column-major order with `values` at the elements' indices; `None`
    /// if an index is outside the matrix.
    fn expand(&self, values: &[f64]) -> Option<Vec<f64>> {
        let [height, width] = self.shape;
        let mut full = vec![0.0; height.saturating_mul(width)];
        for ((&row, &column), value) in self.rows.iter().zip(&self.columns).zip(values) {
            if row >= height || column >= width {
                return None;
            }
            // Column-major order: a column has `height` elements.
            *full.get_mut(column * height + row)? += value;
        }
        Some(full)
    }
}

/// Sparse matrix in compressed sparse column format, as stored by MATLAB and GNU Octave.
pub(crate) struct CompressedColumns {
    /// Number of rows, then number of columns.
    pub(crate) shape: [usize; 2],
    pub(crate) kind: ElementKind,
    /// Row index for each element, from 0.
    pub(crate) rows: Vec<usize>,
    /// Index in `rows` of each column's first element, then the element count.
    pub(crate) starts: Vec<usize>,
    /// Real parts; `rows`, `re` and `im` may have unused entries at the end.
    pub(crate) re: Vec<f64>,
    /// Imaginary parts; `None` for real numbers.
    pub(crate) im: Option<Vec<f64>>,
}

impl CompressedColumns {
    /// Converts the matrix to elements with indices; `None` if column starts, row indices and
    /// numbers are inconsistent.
    pub(crate) fn into_entries(self) -> Option<SparseEntries> {
        let stored = *self.starts.last()?;
        let [_, width] = self.shape;
        if self.starts.len() != width.checked_add(1)?
            || self.starts.first() != Some(&0)
            || !self.starts.is_sorted()
            || !self.has_numbers(stored)
        {
            return None;
        }
        let mut rows = self.rows;
        rows.truncate(stored);
        let mut columns = Vec::new();
        // The elements of column j are those from starts[j] up to, but excluding, starts[j + 1].
        for (column, range) in self.starts.windows(2).enumerate() {
            columns.extend(std::iter::repeat_n(column, range[1] - range[0]));
        }
        Some(SparseEntries {
            shape: self.shape,
            kind: self.kind,
            rows,
            columns,
            re: self.re,
            im: self.im,
        })
    }

    /// Returns whether there are at least `stored` row indices and numbers.
    fn has_numbers(&self, stored: usize) -> bool {
        let has_imaginary_parts = match &self.im {
            Some(im) => stored <= im.len(),
            None => true,
        };
        stored <= self.rows.len() && stored <= self.re.len() && has_imaginary_parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(shape: [usize; 2]) -> SparseEntries {
        SparseEntries {
            shape,
            kind: ElementKind::Float,
            rows: vec![0, 1],
            columns: vec![1, 0],
            re: vec![2.0, 3.0],
            im: Some(vec![0.0, 1.0]),
        }
    }

    #[test]
    fn elements_that_are_not_stored_are_zero() {
        let budget = ReadingBudget::new(1000);
        let array = entries([2, 2])
            .full_matrix("", &budget, || VariableFault::Stopped)
            .unwrap();
        assert_eq!(array.re, [0.0, 3.0, 2.0, 0.0]);
        assert_eq!(array.im, Some(vec![0.0, 1.0, 0.0, 0.0]));
    }

    #[test]
    fn places_outside_and_sizes_beyond_the_limit_are_refused() {
        let budget = ReadingBudget::new(1000);
        assert_eq!(
            entries([1, 2]).full_matrix("", &budget, || VariableFault::Stopped),
            Err(VariableFault::Stopped)
        );
        let large = entries([usize::MAX, 1]).full_matrix("", &budget, || VariableFault::Stopped);
        assert!(matches!(large, Err(VariableFault::TooLarge { .. })));
    }
}
