//! Matrices of which only the numbers other than zero are stored, filled up.

use crate::variables::{Array, ElementKind, MemoryBudget, VariableFault};

/// The numbers other than zero, each with its place.
pub(super) struct Entries {
    /// Number of rows and columns.
    pub(super) shape: [usize; 2],
    /// What the numbers are.
    pub(super) kind: ElementKind,
    /// Row of each number, counted from 0.
    pub(super) rows: Vec<usize>,
    /// Column of each number, counted from 0.
    pub(super) columns: Vec<usize>,
    /// Real part of each number.
    pub(super) re: Vec<f64>,
    /// Imaginary part of each number of complex ones.
    pub(super) im: Option<Vec<f64>>,
}

impl Entries {
    /// The whole matrix; what two entries say of the same place is added.
    ///
    /// `outside` is the fault that a number lies outside the matrix.
    pub(super) fn filled(
        &self,
        meter: &MemoryBudget<'_>,
        outside: impl Fn() -> VariableFault,
    ) -> Result<Array, VariableFault> {
        let [height, width] = self.shape;
        let count = (height as u64).saturating_mul(width as u64);
        meter.take(count, if self.im.is_some() { 16 } else { 8 }, "")?;
        let fill = |values: &[f64]| {
            let mut filled = vec![0.0; height.saturating_mul(width)];
            for ((&row, &column), value) in self.rows.iter().zip(&self.columns).zip(values) {
                let inside = row < height && column < width;
                let place = if inside { filled.get_mut(column * height + row) } else { None };
                *place.ok_or_else(&outside)? += value;
            }
            Ok(filled)
        };
        let im = self.im.as_deref().map(fill).transpose()?;
        Ok(Array { shape: self.shape.to_vec(), kind: self.kind, re: fill(&self.re)?, im })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(shape: [usize; 2]) -> Entries {
        let (rows, columns) = (vec![0, 1], vec![1, 0]);
        Entries { shape, kind: ElementKind::Float, rows, columns, re: vec![2.0, 3.0], im: Some(vec![0.0, 1.0]) }
    }

    #[test]
    fn what_is_not_stored_is_zero() {
        let meter = MemoryBudget::new(1000, &|_| false);
        let array = entries([2, 2]).filled(&meter, || VariableFault::Stopped).unwrap();
        assert_eq!((array.re, array.im), (vec![0.0, 3.0, 2.0, 0.0], Some(vec![0.0, 1.0, 0.0, 0.0])));
    }

    #[test]
    fn places_outside_and_sizes_beyond_the_limit_are_refused() {
        let meter = MemoryBudget::new(1000, &|_| false);
        assert_eq!(entries([1, 2]).filled(&meter, || VariableFault::Stopped), Err(VariableFault::Stopped));
        let large = entries([usize::MAX, 1]).filled(&meter, || VariableFault::Stopped);
        assert!(matches!(large, Err(VariableFault::TooLarge { .. })));
    }
}
