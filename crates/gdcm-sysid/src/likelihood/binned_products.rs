//! Products summed over frequency bins, as factors of the normal equations: `V^H V` in each bin,
//! and scalars z to be multiplied by it.
//!
//! ```text
//! V = [W C R, W],   R = (j omega - A)^-1,   W whitening weight: outputs x (n + outputs)
//! ```
//!
//! Every column of the Jacobian, and every nuisance column, is V times a vector, times a scalar of
//! the line (`normal_equations`, `nuisance_elimination`). In a bin V is taken as constant, so that
//! only the scalars are summed over its lines.

use nalgebra::{Complex, DMatrix};

/// `V^H V` in every bin, for weights with scale 1.
pub(super) struct VectorProducts {
    /// Number of rows and columns of `V^H V`: n + outputs.
    pub(super) size: usize,
    /// A row for each entry in `V^H V`, column after column, and two columns for each bin: real
    /// part and negative imaginary part. A product with [`BinnedScalars`] is then the real part.
    table: DMatrix<f64>,
}

impl VectorProducts {
    /// Gathers `V^H V` from all bins.
    pub(super) fn new(products: Vec<DMatrix<Complex<f64>>>) -> Self {
        let size = products.first().map_or(0, DMatrix::nrows);
        let mut table = DMatrix::zeros(size * size, 2 * products.len());
        for (bin, product) in products.iter().enumerate() {
            for (row, entry) in product.iter().enumerate() {
                table[(row, 2 * bin)] = entry.re;
                table[(row, 2 * bin + 1)] = -entry.im;
            }
        }
        Self { size, table }
    }

    /// Returns an entry in a bin's `V^H V`.
    pub(super) fn entry(&self, bin: usize, v: usize, w: usize) -> Complex<f64> {
        let row = w * self.size + v;
        Complex::new(self.table[(row, 2 * bin)], -self.table[(row, 2 * bin + 1)])
    }

    /// Computes `Re sum (W C R)^H W C R` over the lines, n x n; `squared_scales` holds the sum of
    /// the lines' squared weight scales in each bin.
    pub(super) fn observability(&self, order: usize, squared_scales: &[f64]) -> DMatrix<f64> {
        let mut gramian = DMatrix::zeros(order, order);
        for (bin, squared_scale) in squared_scales.iter().enumerate() {
            for w in 0..order {
                for v in 0..order {
                    gramian[(v, w)] += squared_scale * self.table[(w * self.size + v, 2 * bin)];
                }
            }
        }
        gramian
    }

    /// Computes `sum over bins of Re(V^H V[v, w] z)` for `count` columns w from `first` on: rows
    /// are entries (v, w) with v running fastest, columns those of `scalars`.
    pub(super) fn times(
        &self,
        first: usize,
        count: usize,
        scalars: &BinnedScalars,
    ) -> DMatrix<f64> {
        let rows = self.table.rows(first * self.size, count * self.size);
        rows * &scalars.table
    }
}

/// Complex scalars z summed in bins: real and imaginary parts in two rows for each bin.
pub(super) struct BinnedScalars {
    table: DMatrix<f64>,
}

impl BinnedScalars {
    /// Creates zero sums for `count` scalars.
    pub(super) fn zeros(bins: usize, count: usize) -> Self {
        Self {
            table: DMatrix::zeros(2 * bins, count),
        }
    }

    /// Adds to the scalar in `column`.
    pub(super) fn add(&mut self, bin: usize, column: usize, value: Complex<f64>) {
        self.table[(2 * bin, column)] += value.re;
        self.table[(2 * bin + 1, column)] += value.im;
    }

    /// Returns the number of scalars.
    pub(super) fn count(&self) -> usize {
        self.table.ncols()
    }
}
