//! The Gauss-Newton matrix as a sum of Kronecker products over frequency bins.
//!
//! ```text
//! column of the Jacobian for entry (v, s) of [[A, B], [C, D]]:  v s,   v in the columns of V, s in
//!    the entries of S (`normal_equations`)
//! G = sum over bins of Re(P (x) Q),   P = V^H V,   Q = sum over the lines of the bin conj(S) S'
//! ```
//!
//! P and Q are Hermitian, so that only their upper triangles are summed.

use nalgebra::DMatrix;

use gdcm_model::executor::{Executor, each};

use super::binned_products::VectorProducts;

/// Number of columns in a panel: the unit of parallel work in [`subtract_squares`].
const PANEL: usize = 64;

/// `sum conj(S) S'` in each bin, as an upper triangle: a row for each pair in [`ordered_pairs`], a
/// column for each bin.
pub(super) struct ScalarSquares {
    /// Number of entries in S: n + inputs.
    size: usize,
    re: DMatrix<f64>,
    im: DMatrix<f64>,
}

impl ScalarSquares {
    /// Creates zero sums; `size` is n + inputs.
    pub(super) fn zeros(size: usize, bins: usize) -> Self {
        let pairs = size * (size + 1) / 2;
        Self {
            size,
            re: DMatrix::zeros(pairs, bins),
            im: DMatrix::zeros(pairs, bins),
        }
    }

    /// Adds another sum over the same bins.
    pub(super) fn add(&mut self, other: &Self) {
        self.re += &other.re;
        self.im += &other.im;
    }

    /// Adds a line's `factor conj(S) S'` to a bin; `re` and `im` hold the parts of S.
    pub(super) fn add_line(&mut self, bin: usize, re: &[f64], im: &[f64], factor: f64) {
        let pairs = self.re.nrows();
        let mut to_re = &mut self.re.as_mut_slice()[bin * pairs..(bin + 1) * pairs];
        let mut to_im = &mut self.im.as_mut_slice()[bin * pairs..(bin + 1) * pairs];
        for first in 0..self.size {
            let length = self.size - first;
            let (row_re, rest_re) = to_re.split_at_mut(length);
            let (row_im, rest_im) = to_im.split_at_mut(length);
            let first_re = factor * re[first];
            let first_im = factor * im[first];
            let seconds = re[first..].iter().zip(&im[first..]);
            for ((to, to_im), (re, im)) in row_re.iter_mut().zip(row_im).zip(seconds) {
                *to += first_re * re + first_im * im;
                *to_im += first_re * im - first_im * re;
            }
            to_re = rest_re;
            to_im = rest_im;
        }
    }

    /// Computes `Re sum X X^H` over all bins; X is the first `order` entries in S.
    pub(super) fn controllability(&self, order: usize) -> DMatrix<f64> {
        let sums = self.re.column_sum();
        let mut gramian = DMatrix::zeros(order, order);
        for (row, (first, second)) in ordered_pairs(self.size).into_iter().enumerate() {
            if second < order {
                gramian[(first, second)] = sums[row];
                gramian[(second, first)] = sums[row];
            }
        }
        gramian
    }
}

/// Computes `sum over bins of Re(P (x) Q)` for Hermitian `P = V^H V` and `Q = sum conj(S) S'`:
/// entry ((v, s), (w, t)) is `Re(P[v, w] Q[s, t])`, with v running fastest.
///
/// Only the pairs v <= w and s <= t are computed: the entries (v, s), (w, t) are
/// `Re P Re Q - Im P Im Q`; the entries (v, t), (w, s), with conj(Q), are `Re P Re Q + Im P Im Q`.
pub(super) fn kronecker_sum(
    products: &VectorProducts,
    squares: &ScalarSquares,
    executor: &dyn Executor,
) -> DMatrix<f64> {
    let vectors = products.size;
    let bins = squares.re.ncols();
    let vector_pairs = ordered_pairs(vectors);
    let mut left_re = DMatrix::zeros(vector_pairs.len(), bins);
    let mut left_im = left_re.clone();
    for bin in 0..bins {
        for (row, &(v, w)) in vector_pairs.iter().enumerate() {
            let product = products.entry(bin, v, w);
            left_re[(row, bin)] = product.re;
            left_im[(row, bin)] = product.im;
        }
    }
    let pairs_of_parts = [(&left_re, &squares.re), (&left_im, &squares.im)];
    let parts = each(executor, pairs_of_parts, |(left, right)| {
        left * right.transpose()
    });
    let [re, im] = parts.as_slice() else {
        return DMatrix::zeros(0, 0);
    };
    let size = vectors * squares.size;
    let mut matrix = DMatrix::zeros(size, size);
    for (column, &(s, t)) in ordered_pairs(squares.size).iter().enumerate() {
        for (row, &(v, w)) in vector_pairs.iter().enumerate() {
            let direct = re[(row, column)] - im[(row, column)];
            let crossed = re[(row, column)] + im[(row, column)];
            let [vs, wt, vt, ws] = [
                s * vectors + v,
                t * vectors + w,
                t * vectors + v,
                s * vectors + w,
            ];
            matrix[(vs, wt)] = direct;
            matrix[(wt, vs)] = direct;
            matrix[(vt, ws)] = crossed;
            matrix[(ws, vt)] = crossed;
        }
    }
    matrix
}

/// Subtracts `sum F F'` over the matrices F from a symmetric matrix.
///
/// Each panel is computed from its diagonal block down, and copied to the right of it.
pub(super) fn subtract_squares(
    matrix: &mut DMatrix<f64>,
    roots: &[DMatrix<f64>],
    executor: &dyn Executor,
) {
    let size = matrix.nrows();
    let panels = each(executor, (0..size).step_by(PANEL), |first| {
        let width = PANEL.min(size - first);
        let mut panel = matrix
            .view((first, first), (size - first, width))
            .into_owned();
        for root in roots {
            let transposed = root.rows(first, width).transpose();
            panel.gemm(-1.0, &root.rows(first, size - first), &transposed, 1.0);
        }
        panel
    });
    for (number, panel) in panels.iter().enumerate() {
        let first = number * PANEL;
        let width = panel.ncols();
        matrix
            .view_mut((first, first), panel.shape())
            .copy_from(panel);
        let below = panel.rows(width, size - first - width).transpose();
        matrix
            .view_mut((first, first + width), below.shape())
            .copy_from(&below);
    }
}

/// Returns all index pairs below `count` whose second index is not smaller than the first.
fn ordered_pairs(count: usize) -> Vec<(usize, usize)> {
    let mut pairs = Vec::with_capacity(count * (count + 1) / 2);
    for first in 0..count {
        for second in first..count {
            pairs.push((first, second));
        }
    }
    pairs
}
