//! Balancing of a model, and its reduction to upper Hessenberg form by Householder reflections.

use std::ops::Range;

use nalgebra::DMatrix;
use pulp::{Simd, WithSimd};

/// Partial sums of a scalar product.
const LANES: usize = 8;

/// Brings `[A B; C D]` to `[Q' A Q, Q' B; C Q, D]` with Q orthogonal, `Q' A Q` upper Hessenberg, and the first column of
/// `Q' B` zero below its first entry.
///
/// One reflection `I - beta v v'` for that column, then one for each column of A (Golub & Van Loan, "Matrix
/// Computations", 4th ed. 2013, 7.4.2), applied from both inputs in one pass over the matrix T, as `T - y v' - v w'` with
///
/// ```text
/// y = beta T v,   w = beta T' v - gamma v,   gamma = beta v' y
/// ```
///
/// 10/3 n^3 + 4 n^2 (m + p) operations. A scalar product runs over eight partial sums, and every multiply-add is fused,
/// without one in hardware too: the result has the same bits on every instruction set.
pub struct HouseholderReduction<'a> {
    /// The rows of `[A B; C D]`, each of which lies in one column.
    pub rows: &'a mut DMatrix<f64>,
    /// Rows of A.
    pub states: usize,
}

impl WithSimd for HouseholderReduction<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        clear(self.rows, self.states, self.states, 0);
        for column in 0..self.states.saturating_sub(2) {
            clear(self.rows, self.states, column, column + 1);
        }
    }
}

/// Clears a column below row `first` by a reflection of the states from `first` on, applied from both inputs; the column
/// itself is not among those of these states.
#[inline(always)]
fn clear(rows: &mut DMatrix<f64>, states: usize, column: usize, first: usize) {
    let mut v = vec![0.0; rows.nrows()];
    for state in first..states {
        v[state] = rows[(column, state)];
    }
    let Some((head, tail)) = v[first..states].split_first_mut() else { return };
    let tail: f64 = tail.iter().map(|entry| entry * entry).sum();
    if tail == 0.0 {
        return;
    }
    // The largest entries of A and B are of order 1: squares that underflow are negligible.
    let norm = (*head * *head + tail).sqrt();
    let left = -norm.copysign(*head);
    let beta = 1.0 / (norm * (norm + head.abs()));
    *head -= left;
    reflect(rows, first..states, &v, beta);
    for state in first..states {
        rows[(column, state)] = if state == first { left } else { 0.0 };
    }
}

/// Applies the reflection `I - beta v v'` of these states from both inputs.
#[inline(always)]
fn reflect(rows: &mut DMatrix<f64>, states: Range<usize>, v: &[f64], beta: f64) {
    let width = rows.nrows();
    // What stands before is done; v is zero there. Partial sums begin at whole blocks.
    let from = states.start / LANES * LANES;
    let (mut y, mut w) = (vec![0.0; rows.ncols()], vec![0.0; width]);
    for (y, row) in y.iter_mut().zip(rows.as_slice().chunks_exact(width)) {
        *y = beta * dot(&row[from..], &v[from..]);
    }
    let gamma = beta * dot(v, &y);
    for state in states.clone() {
        subtract_multiple(&mut w[from..], -v[state] * beta, &rows.as_slice()[state * width..][from..width]);
    }
    subtract_multiple(&mut w[from..], gamma, &v[from..]);
    w[..states.start].fill(0.0);
    for (index, row) in rows.as_mut_slice().chunks_exact_mut(width).enumerate() {
        subtract_multiple(&mut row[from..], y[index], &v[from..]);
        if states.contains(&index) {
            subtract_multiple(&mut row[from..], v[index], &w[from..]);
        }
    }
}

/// `left' right`.
#[inline(always)]
fn dot(left: &[f64], right: &[f64]) -> f64 {
    let mut sums = [0.0_f64; LANES];
    let count = left.len().min(right.len());
    let ((left, left_rest), (right, right_rest)) = (left[..count].as_chunks(), right[..count].as_chunks());
    for (left, right) in left.iter().zip(right) {
        add_products::<LANES>(&mut sums, left, right);
    }
    for (sum, (left, right)) in sums.iter_mut().zip(left_rest.iter().zip(right_rest)) {
        *sum = left.mul_add(*right, *sum);
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// `sums + left right`, entry by entry.
#[inline(always)]
fn add_products<const N: usize>(sums: &mut [f64; N], left: &[f64; N], right: &[f64; N]) {
    for lane in 0..N {
        sums[lane] = left[lane].mul_add(right[lane], sums[lane]);
    }
}

/// `from -= factor row`.
#[inline(always)]
fn subtract_multiple(from: &mut [f64], factor: f64, row: &[f64]) {
    for (from, row) in from.iter_mut().zip(row) {
        *from = (-factor).mul_add(*row, *from);
    }
}

/// Brings row k and column k of `a`, for each state k, to norms within a factor of two of each other, by a diagonal similarity
/// of powers of two, so that nothing is rounded: `a <- S^-1 a S`, `b <- S^-1 b`, `c <- c S`.
///
/// Balancing of Parlett and Reinsch with 2-norms (James, Langou & Lowery, arXiv:1401.5766, algorithm 3). Entries far beyond
/// those of any machine in use can neither keep it busy (it ends after so many sweeps over the states, each of which leaves a
/// similar model) nor carry a scale to where B or C would overflow.
pub fn balance(a: &mut DMatrix<f64>, b: &mut DMatrix<f64>, c: &mut DMatrix<f64>) {
    /// A helicopter's model takes three to six.
    const MOST_SWEEPS: usize = 100;
    /// 30 decades to either side.
    const LARGEST_SCALE: f64 = (1_u128 << 100) as f64;
    let mut scales = vec![1.0; a.nrows()];
    for _ in 0..MOST_SWEEPS {
        let mut balanced = true;
        for (state, scale) in scales.iter_mut().enumerate() {
            let Some(factor) = factor(a, state) else { continue };
            if (LARGEST_SCALE.recip()..=LARGEST_SCALE).contains(&(*scale * factor)) {
                balanced = false;
                *scale *= factor;
                a.column_mut(state).scale_mut(factor);
                a.row_mut(state).unscale_mut(factor);
            }
        }
        if balanced {
            break;
        }
    }
    for (state, &scale) in scales.iter().enumerate() {
        b.row_mut(state).scale_mut(1.0 / scale);
        c.column_mut(state).scale_mut(scale);
    }
}

/// The power of two that brings a column and its row closest together; `None` where that gains less than 5 % of their squares.
fn factor(a: &DMatrix<f64>, state: usize) -> Option<f64> {
    let (column, row) = (a.column(state).norm_squared(), a.row(state).norm_squared());
    let whole = column + row;
    let (mut column, mut row, mut factor) = (column.sqrt(), row.sqrt(), 1.0);
    if column == 0.0 || row == 0.0 {
        return None;
    }
    while column < row / 2.0 {
        (column, row, factor) = (column * 2.0, row / 2.0, factor * 2.0);
    }
    while column >= row * 2.0 {
        (column, row, factor) = (column / 2.0, row * 2.0, factor / 2.0);
    }
    (column * column + row * row < 0.95 * whole).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Arch;

    const STATES: usize = 11;

    /// The rows of two inputs and three outputs; entries from a sine: without pattern, and the same everywhere.
    fn rows() -> DMatrix<f64> {
        DMatrix::from_fn(STATES + 2, STATES + 3, |column, row| {
            if row < STATES || column < STATES {
                (7.3 * row as f64 + 2.9 * (column * column) as f64).sin()
            } else {
                0.0
            }
        })
    }

    fn reduced(arch: Arch) -> DMatrix<f64> {
        let mut rows = rows();
        arch.dispatch(HouseholderReduction { rows: &mut rows, states: STATES });
        rows
    }

    /// `C A^k B`, which a change of coordinates leaves alone.
    fn markov_parameter(rows: &DMatrix<f64>, power: usize, output: usize, input: usize) -> f64 {
        let mut states: Vec<f64> = (0..STATES).map(|row| rows[(STATES + input, row)]).collect();
        let product = |row: usize, states: &[f64]| rows.column(row).iter().zip(states).map(|(a, x)| a * x).sum::<f64>();
        for _ in 0..power {
            states = (0..STATES).map(|row| product(row, &states)).collect();
        }
        product(STATES + output, &states)
    }

    #[test]
    fn what_stands_below_the_subdiagonal_is_zero() {
        let rows = reduced(Arch::new());
        assert!((2..STATES).all(|row| rows.column(row).iter().take(row - 1).all(|entry| *entry == 0.0)));
    }

    #[test]
    fn from_inputs_to_outputs_nothing_changes() {
        let (before, after) = (rows(), reduced(Arch::new()));
        for (power, output, input) in [(0, 0, 0), (1, 2, 1), (5, 1, 0)] {
            let [before, after] = [&before, &after].map(|rows| markov_parameter(rows, power, output, input));
            // Entries of A^5 grow to some thousand; eleven reflections with rounding errors of 1e-16 each.
            assert!((before - after).abs() < 1e-11, "C A^{power} B: {before} and {after}");
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let scalar = reduced(Arch::Scalar);
        assert_eq!(reduced(Arch::new()), scalar);
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            assert_eq!(reduced(Arch::V3(simd)), scalar);
        }
    }
}

#[cfg(test)]
mod balancing_tests {
    use super::*;
    use nalgebra::{dmatrix, linalg::balancing::balance_parlett_reinsch};

    #[test]
    fn it_gives_the_bits_of_the_textbook_where_no_limit_is_met() {
        let a = DMatrix::from_fn(7, 7, |row, column| {
            (1.0 + 7.3 * row as f64 + 2.9 * column as f64).sin() * 10_f64.powi(3 * row as i32)
        });
        let (mut ours, mut theirs) = (a.clone(), a);
        let (mut b, mut c) = (DMatrix::from_element(7, 1, 1.0), DMatrix::from_element(1, 7, 1.0));
        balance(&mut ours, &mut b, &mut c);
        let scales = balance_parlett_reinsch(&mut theirs);
        assert_eq!(ours, theirs);
        assert!(c.iter().eq(scales.iter()) && b.iter().zip(&scales).all(|(b, scale)| b * scale == 1.0));
    }

    #[test]
    fn a_chain_of_couplings_of_1e_minus_60_does_not_carry_the_scales_away() {
        let mut a = DMatrix::from_fn(60, 60, |row, column| match column as i32 - row as i32 {
            1 => 1e-60,
            -1 => 1.0,
            _ => 0.0,
        });
        let (mut b, mut c) = (DMatrix::from_element(60, 1, 1.0), DMatrix::from_element(1, 60, 1.0));
        balance(&mut a, &mut b, &mut c);
        assert!(b.iter().chain(c.iter()).all(|entry| (1e-31..=1e31).contains(entry)));
    }

    #[test]
    fn a_state_that_nothing_leads_to_is_left_as_it_is() {
        let (mut a, mut b, mut c) = (dmatrix![-1.0, 0.0; 1e9, 0.0], dmatrix![1.0; 1.0], dmatrix![1.0, 1.0]);
        balance(&mut a, &mut b, &mut c);
        assert!(a[(1, 0)] != 0.0 && b[1] == 1.0, "the second column is zero");
    }
}
