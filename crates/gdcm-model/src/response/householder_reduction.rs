//! Reduces a system matrix to upper Hessenberg form by Householder reflections, compiled for an
//! instruction set.

use std::ops::Range;

use nalgebra::DMatrix;
use pulp::{Simd, WithSimd};

/// Number of partial sums in a scalar product.
const LANES: usize = 8;

/// Transforms `[A B; C D]` to `[Q' A Q, Q' B; C Q, D]` with Q orthogonal, `Q' A Q` upper
/// Hessenberg, and the first column of `Q' B` zero below its first entry. The model has n states, m
/// inputs and p outputs; ' denotes the transpose.
///
/// One reflection `I - beta v v'` clears that column, and one more clears each column of A (Golub &
/// Van Loan, "Matrix Computations", 4th ed. 2013, 7.4.2). Each is applied from both sides in a
/// single pass over the matrix T, as `T - y v' - v w'` with
///
/// ```text
/// y = beta T v,   w = beta T' v - gamma v,   gamma = beta v' y
/// ```
///
/// This takes 10/3 n^3 + 4 n^2 (m + p) operations. A scalar product uses eight partial sums, and
/// every multiply-add is fused, in software where necessary, so that the result is the same bit for
/// bit on every instruction set.
pub(super) struct HouseholderReduction<'a> {
    /// The matrix `[A B; C D]`, with each row stored as a column: `rows[(column, row)]`.
    pub(super) rows: &'a mut DMatrix<f64>,
    /// Row count of A.
    pub(super) states: usize,
}

impl WithSimd for HouseholderReduction<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        // The first column of B follows the columns of A.
        clear_column(self.rows, self.states, self.states, 0);
        for column in 0..self.states.saturating_sub(2) {
            clear_column(self.rows, self.states, column, column + 1);
        }
    }
}

/// Clears a column below row `first` by reflecting the states from `first` on, from both sides. The
/// column itself must not be one of these states.
#[inline(always)]
fn clear_column(rows: &mut DMatrix<f64>, states: usize, column: usize, first: usize) {
    let mut v = vec![0.0; rows.nrows()];
    for state in first..states {
        v[state] = rows[(column, state)];
    }
    let Some((head, tail)) = v[first..states].split_first_mut() else {
        return;
    };
    let tail_square: f64 = tail.iter().map(|entry| entry * entry).sum();
    if tail_square == 0.0 {
        return;
    }
    // Underflow is harmless: the largest entries in A and B are near 1, so that such squares are
    // negligible.
    let norm = (*head * *head + tail_square).sqrt();
    // The only entry that remains in the column.
    let remaining = -norm.copysign(*head);
    let beta = 1.0 / (norm * (norm + head.abs()));
    *head -= remaining;
    reflect(rows, first..states, &v, beta);
    for state in first..states {
        rows[(column, state)] = if state == first { remaining } else { 0.0 };
    }
}

/// Applies the reflection `I - beta v v'` to the given states from both sides, with y, w and gamma
/// as in [`HouseholderReduction`]: `y` has an entry per matrix row, `v` and `w` have an entry per
/// column. Only these states' rows change by `v w'`.
#[inline(always)]
fn reflect(rows: &mut DMatrix<f64>, states: Range<usize>, v: &[f64], beta: f64) {
    let width = rows.nrows();
    // Skip earlier entries, where v is zero; start at a whole block of partial sums.
    let from = states.start / LANES * LANES;
    let mut y = vec![0.0; rows.ncols()];
    let mut w = vec![0.0; width];
    for (y, row) in y.iter_mut().zip(rows.as_slice().chunks_exact(width)) {
        *y = beta * dot(&row[from..], &v[from..]);
    }
    let gamma = beta * dot(v, &y);
    for state in states.clone() {
        subtract_multiple(
            &mut w[from..],
            -v[state] * beta,
            &rows.as_slice()[state * width..][from..width],
        );
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

/// Returns the scalar product `left' right`, with a fixed summation order.
#[inline(always)]
fn dot(left: &[f64], right: &[f64]) -> f64 {
    let mut sums = [0.0_f64; LANES];
    let count = left.len().min(right.len());
    let (left, left_rest) = left[..count].as_chunks();
    let (right, right_rest) = right[..count].as_chunks();
    for (left, right) in left.iter().zip(right) {
        add_products::<LANES>(&mut sums, left, right);
    }
    for (sum, (left, right)) in sums.iter_mut().zip(left_rest.iter().zip(right_rest)) {
        *sum = left.mul_add(*right, *sum);
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Adds `left * right` to `sums`, entry by entry.
#[inline(always)]
fn add_products<const N: usize>(sums: &mut [f64; N], left: &[f64; N], right: &[f64; N]) {
    for lane in 0..N {
        sums[lane] = left[lane].mul_add(right[lane], sums[lane]);
    }
}

/// Subtracts `factor * row` from `from`, entry by entry.
#[inline(always)]
fn subtract_multiple(from: &mut [f64], factor: f64, row: &[f64]) {
    for (from, row) in from.iter_mut().zip(row) {
        *from = (-factor).mul_add(*row, *from);
    }
}

#[cfg(test)]
mod tests {
    use pulp::Arch;

    use super::*;

    const STATES: usize = 11;

    /// Returns the rows for two inputs and three outputs, with reproducible irregular entries from
    /// a sine.
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
        arch.dispatch(HouseholderReduction {
            rows: &mut rows,
            states: STATES,
        });
        rows
    }

    /// Returns `C A^k B`, which is invariant under a change of coordinates.
    fn markov_parameter(rows: &DMatrix<f64>, power: usize, output: usize, input: usize) -> f64 {
        let mut states: Vec<f64> = (0..STATES).map(|row| rows[(STATES + input, row)]).collect();
        let product = |row: usize, states: &[f64]| {
            rows.column(row)
                .iter()
                .zip(states)
                .map(|(a, x)| a * x)
                .sum::<f64>()
        };
        for _ in 0..power {
            states = (0..STATES).map(|row| product(row, &states)).collect();
        }
        product(STATES + output, &states)
    }

    #[test]
    fn what_stands_below_the_subdiagonal_is_zero() {
        let rows = reduced(Arch::new());
        assert!((2..STATES).all(|row| {
            rows.column(row)
                .iter()
                .take(row - 1)
                .all(|entry| *entry == 0.0)
        }));
    }

    #[test]
    fn from_inputs_to_outputs_nothing_changes() {
        let before = rows();
        let after = reduced(Arch::new());
        for (power, output, input) in [(0, 0, 0), (1, 2, 1), (5, 1, 0)] {
            let [before, after] =
                [&before, &after].map(|rows| markov_parameter(rows, power, output, input));
            // Tolerance: entries of A^5 of up to some thousands, and eleven reflections with
            // rounding errors of 1e-16.
            assert!(
                (before - after).abs() < 1e-11,
                "C A^{power} B: {before} and {after}"
            );
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
