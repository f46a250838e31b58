//! A state-space model transformed so that each frequency costs O(n^2) operations: balanced, and
//! reduced to upper Hessenberg form by Householder reflections.

use std::ops::Range;

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use super::subdiagonal::Subdiagonal;
use crate::dataset::{Pair, StateSpace};

/// Minimum `alpha`, 2^-450 rad/s: the poles of a slower model are effectively zero at any frequency
/// in use.
const LEAST_ALPHA: f64 = f64::from_bits((1023 - 450) << 52);

/// The system matrix of a model, prepared for state elimination.
///
/// ```text
/// [ G - (s / alpha) I   K  ]
/// [ L                   D' ]     H(s)' = D' - L (G - (s / alpha) I)^-1 K
/// ```
///
/// G (n x n) is zero below its first subdiagonal; L has a row per input, and its first row is zero
/// except for the last entry; K has a column per output. Steps from the model (A, B, C, D):
///
/// 1. Balance A by a diagonal similarity, which removes the influence of state units.
/// 2. Scale A by alpha and B by another power of two, so that their largest entries are near 1.
/// 3. Householder reflections make A Hessenberg and the first column in B a multiple of the first
///    unit vector.
/// 4. Transpose the system matrix and reverse the states, which restores the Hessenberg form.
///
/// The cost per frequency grows with the row count of L. A model with fewer outputs than inputs is
/// therefore stored as its dual `(A', C', B', D')`, whose response is the transpose and whose
/// inputs are the model's outputs.
#[derive(Clone, Debug)]
pub(super) struct HessenbergForm {
    /// Number of states, `n`.
    pub order: usize,
    /// Number of rows of L: inputs (of the dual if `dual`).
    pub inputs: usize,
    /// Number of columns of K: outputs (of the dual if `dual`).
    pub outputs: usize,
    /// Whether this is the dual: L then has a row per output, K a column per input.
    pub dual: bool,
    /// Index of the input that was swapped with the first input, because its column in B is the
    /// largest.
    first_input: usize,
    /// `1 / alpha`.
    pub frequency_scale: f64,
    /// The last entry of the first row of L; all its other entries are zero.
    pub gain: f64,
    /// Subdiagonal entries of G, one for each column except the last.
    pub subdiagonals: Vec<Subdiagonal>,
    /// First row of `[G K]`, then all rows of `[L D']` except the first.
    pub complex_rows: Vec<f64>,
    /// All rows of `[G K]` except the first, each divided by its subdiagonal entry.
    next_rows: Vec<f64>,
    /// First row of `D'`.
    pub feed_through: Vec<f64>,
}

impl HessenbergForm {
    /// Computes the reduced form of a model whose A is replaced by `a`. `arch` affects only the
    /// computing time: the result is the same bit for bit on every instruction set.
    pub fn new(arch: Arch, a: DMatrix<f64>, model: &StateSpace) -> Self {
        let mut system = ScaledSystem::new(a, model);
        let first_input = system.swap_largest_input_first();
        let order = system.a.nrows();
        let inputs = system.b.ncols();
        let outputs = system.c.nrows();
        let dual = system.dual;
        let frequency_scale = system.frequency_scale;
        let mut rows = system.into_rows();
        arch.dispatch(HouseholderReduction {
            rows: &mut rows,
            states: order,
        });
        let reduced = ReversedSystem { rows, order };
        let mut subdiagonals = Vec::new();
        let mut next_rows = Vec::new();
        for row in 1..order {
            let subdiagonal = Subdiagonal::new(reduced.entry(row, row - 1), order);
            next_rows.extend(reduced.scaled_row(row, order + outputs, subdiagonal.reciprocal));
            subdiagonals.push(subdiagonal);
        }
        let width = order + outputs;
        let mut complex_rows = Vec::new();
        if order > 0 {
            complex_rows.extend(reduced.scaled_row(0, width, 1.0));
        } else {
            complex_rows.resize(width, 0.0);
        }
        for row in order + 1..order + inputs {
            complex_rows.extend(reduced.scaled_row(row, width, 1.0));
        }
        let gain = if order > 0 && inputs > 0 {
            reduced.entry(order, order - 1)
        } else {
            0.0
        };
        let feed_through = if inputs > 0 {
            reduced.scaled_row(order, width, 1.0).skip(order).collect()
        } else {
            vec![0.0; outputs]
        };
        Self {
            order,
            inputs,
            outputs,
            dual,
            first_input,
            frequency_scale,
            gain,
            subdiagonals,
            complex_rows,
            next_rows,
            feed_through,
        }
    }

    /// Returns the response of the model that corresponds to row `input` of L and column `output`
    /// of K.
    pub fn pair(&self, input: usize, output: usize) -> Pair {
        let input = if input == 0 {
            self.first_input
        } else if input == self.first_input {
            0
        } else {
            input
        };
        if self.dual {
            Pair::new(input, output)
        } else {
            Pair::new(output, input)
        }
    }

    /// Returns the number of entries in a row of `[G K]`.
    pub fn width(&self) -> usize {
        self.order + self.outputs
    }

    /// Returns the row of `[G K]` whose subdiagonal entry, scaled to 1, lies in this column; it
    /// begins at the next column.
    #[inline(always)]
    pub fn next_row(&self, column: usize) -> &[f64] {
        &self.next_rows[column * self.width()..][column + 1..self.width()]
    }
}

/// A model or its dual, balanced, with the largest entries in A and B between 1 and 2.
struct ScaledSystem {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    dual: bool,
    /// `1 / alpha`.
    frequency_scale: f64,
}

impl ScaledSystem {
    fn new(a: DMatrix<f64>, model: &StateSpace) -> Self {
        let dual = model.outputs() < model.inputs();
        let mut a = if dual { a.transpose() } else { a };
        let [mut b, mut c, d] = if dual {
            [model.c(), model.b(), model.d()].map(DMatrix::transpose)
        } else {
            [model.b(), model.c(), model.d()].map(DMatrix::clone)
        };
        balance(&mut a, &mut b, &mut c);
        let frequency_scale = 1.0 / power_of_two_below(a.amax()).max(LEAST_ALPHA);
        let input_scale = 1.0 / power_of_two_below(b.amax());
        a *= frequency_scale;
        b *= input_scale;
        // Multiply by the larger factor first, so that no intermediate result underflows.
        let output_scale = 1.0 / input_scale;
        c *= frequency_scale.max(output_scale);
        c *= frequency_scale.min(output_scale);
        Self {
            a,
            b,
            c,
            d,
            dual,
            frequency_scale,
        }
    }

    /// Swaps the first input with the input that has the largest column in B; returns the index of
    /// the latter.
    fn swap_largest_input_first(&mut self) -> usize {
        let mut largest = 0;
        for input in 1..self.b.ncols() {
            let is_larger = self
                .b
                .column(input)
                .amax()
                .total_cmp(&self.b.column(largest).amax())
                .is_gt();
            if is_larger {
                largest = input;
            }
        }
        if largest > 0 {
            self.b.swap_columns(0, largest);
            self.d.swap_columns(0, largest);
        }
        largest
    }

    /// Returns the matrix `[A B; C D]`, transposed so that each row is contiguous in memory.
    fn into_rows(self) -> DMatrix<f64> {
        let order = self.a.nrows();
        let inputs = self.b.ncols();
        let outputs = self.c.nrows();
        let mut rows = DMatrix::zeros(order + inputs, order + outputs);
        for (matrix, row, column) in [
            (self.a, 0, 0),
            (self.b, 0, order),
            (self.c, order, 0),
            (self.d, order, order),
        ] {
            rows.view_mut((column, row), (matrix.ncols(), matrix.nrows()))
                .tr_copy_from(&matrix);
        }
        rows
    }
}

/// The reduced system matrix, transposed, with the states in reversed order.
struct ReversedSystem {
    /// The matrix before transposition and reversal, with each row stored as a column.
    rows: DMatrix<f64>,
    order: usize,
}

impl ReversedSystem {
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.rows[(self.reversed(row), self.reversed(column))]
    }

    fn reversed(&self, index: usize) -> usize {
        if index < self.order {
            self.order - 1 - index
        } else {
            index
        }
    }

    /// Returns the first `width` entries of a row, multiplied by a factor.
    fn scaled_row(&self, row: usize, width: usize, factor: f64) -> impl Iterator<Item = f64> {
        (0..width).map(move |column| factor * self.entry(row, column))
    }
}

/// Returns the largest power of two that does not exceed `value`, within 2^-1000 ... 2^1000; 1 for
/// zero.
fn power_of_two_below(value: f64) -> f64 {
    if value == 0.0 {
        return 1.0;
    }
    value.log2().floor().clamp(-1e3, 1e3).exp2()
}

/// Number of partial sums in a scalar product.
const LANES: usize = 8;

/// Transforms `[A B; C D]` to `[Q' A Q, Q' B; C Q, D]` with Q orthogonal, `Q' A Q` upper
/// Hessenberg, and the first column of `Q' B` zero below its first entry.
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
struct HouseholderReduction<'a> {
    /// The matrix `[A B; C D]`, with each row stored as a column.
    rows: &'a mut DMatrix<f64>,
    /// Number of rows of A.
    states: usize,
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

/// Clears a column below row `first` by a reflection of the states from `first` on, applied from
/// both sides. The column itself must not be one of these states.
#[inline(always)]
fn clear(rows: &mut DMatrix<f64>, states: usize, column: usize, first: usize) {
    let mut v = vec![0.0; rows.nrows()];
    for state in first..states {
        v[state] = rows[(column, state)];
    }
    let Some((head, tail)) = v[first..states].split_first_mut() else {
        return;
    };
    let tail: f64 = tail.iter().map(|entry| entry * entry).sum();
    if tail == 0.0 {
        return;
    }
    // Underflow is harmless: the largest entries in A and B are near 1, so that such squares are
    // negligible.
    let norm = (*head * *head + tail).sqrt();
    let left = -norm.copysign(*head);
    let beta = 1.0 / (norm * (norm + head.abs()));
    *head -= left;
    reflect(rows, first..states, &v, beta);
    for state in first..states {
        rows[(column, state)] = if state == first { left } else { 0.0 };
    }
}

/// Applies the reflection `I - beta v v'` of the given states from both sides.
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

/// Returns the scalar product `left' right`, with a fixed order of summation.
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

/// Balances A: for each state k, the norms of row k and column k then differ by less than a factor
/// of two. The diagonal similarity `S` consists of powers of two, so that nothing is rounded:
/// `a <- S^-1 a S`, `b <- S^-1 b`, `c <- c S`.
///
/// Balancing of Parlett and Reinsch with 2-norms (James, Langou & Lowery, arXiv:1401.5766,
/// algorithm 3). The number of sweeps is limited (the model remains similar after each sweep), and
/// so is the scale, to prevent overflow in B and C; both limits take effect only for entries far
/// beyond those of any aircraft.
pub(super) fn balance(a: &mut DMatrix<f64>, b: &mut DMatrix<f64>, c: &mut DMatrix<f64>) {
    /// Maximum number of sweeps; a helicopter model needs three to six.
    const MOST_SWEEPS: usize = 100;
    /// Maximum scale, about 1e30 in either direction.
    const LARGEST_SCALE: f64 = (1_u128 << 100) as f64;
    let mut scales = vec![1.0; a.nrows()];
    for _ in 0..MOST_SWEEPS {
        let mut balanced = true;
        for (state, scale) in scales.iter_mut().enumerate() {
            let Some(factor) = balancing_factor(a, state) else {
                continue;
            };
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

/// Returns the power of two that makes the norms of a column and its row most nearly equal; `None`
/// if it reduces the sum of their squares by less than 5 %.
fn balancing_factor(a: &DMatrix<f64>, state: usize) -> Option<f64> {
    let column = a.column(state).norm_squared();
    let row = a.row(state).norm_squared();
    let whole = column + row;
    let mut column = column.sqrt();
    let mut row = row.sqrt();
    let mut factor = 1.0;
    if column == 0.0 || row == 0.0 {
        return None;
    }
    while column < row / 2.0 {
        column *= 2.0;
        row /= 2.0;
        factor *= 2.0;
    }
    while column >= row * 2.0 {
        column /= 2.0;
        row *= 2.0;
        factor /= 2.0;
    }
    if column * column + row * row < 0.95 * whole {
        Some(factor)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;
    use nalgebra::linalg::balancing::balance_parlett_reinsch;

    use super::*;

    fn form(model: &StateSpace) -> HessenbergForm {
        HessenbergForm::new(Arch::new(), model.a().clone(), model)
    }

    #[test]
    fn the_scale_is_a_power_of_two_that_brings_the_largest_entry_between_one_and_two() {
        assert_eq!(
            [0.0, 1.0, 1.999, 40.0, 0.3].map(power_of_two_below),
            [1.0, 1.0, 1.0, 32.0, 0.25]
        );
    }

    #[test]
    fn the_inputs_or_outputs_whichever_are_fewer_are_solved_for() {
        let model = |p, m| {
            let a = dmatrix![-1.0];
            let b = DMatrix::zeros(1, m);
            let c = DMatrix::zeros(p, 1);
            form(&StateSpace::new(a, b, c, DMatrix::zeros(p, m)).unwrap())
        };
        assert_eq!((model(6, 4).inputs, model(6, 4).dual), (4, false));
        assert_eq!((model(1, 3).inputs, model(1, 3).dual), (1, true));
    }

    #[test]
    fn a_model_of_one_state_and_no_reduction_is_its_own_system_matrix() {
        let model = StateSpace::new(
            dmatrix![-1.5],
            dmatrix![1.0, 1.5],
            dmatrix![4.0; 5.0],
            dmatrix![0.1, 0.2; 0.3, 0.4],
        );
        let form = form(&model.unwrap());
        // `first_input`: the second input has the larger column in B.
        assert_eq!(
            (form.gain, form.pair(0, 1), form.pair(1, 0)),
            (1.5, Pair::new(1, 1), Pair::new(0, 0))
        );
        assert_eq!(form.complex_rows, [-1.5, 4.0, 5.0, 1.0, 0.1, 0.3]);
        assert_eq!(form.feed_through, [0.2, 0.4]);
    }

    #[test]
    fn next_rows_have_a_one_below_the_diagonal_and_the_first_input_reaches_one_state() {
        let a = dmatrix![1.0, 1.25, 0.5; 1.5, 1.75, -1.0; 0.25, 0.5, -0.75];
        let model = StateSpace::new(
            a,
            dmatrix![2.0; 3.0; 1.0],
            dmatrix![1.0, 1.0, 2.0],
            dmatrix![0.0],
        );
        let form = form(&model.unwrap());
        let next: Vec<&[f64]> = form.next_rows.chunks_exact(4).collect();
        // Tolerance: rounding errors of a few operations. There are two next rows.
        assert!(
            next.len() == 2 && (next[0][0] - 1.0).abs() < 1e-15 && (next[1][1] - 1.0).abs() < 1e-15
        );
        assert_eq!(next[1][0], 0.0);
        assert_eq!(form.next_row(1), &next[1][2..]);
        // A reflection preserves |B| = sqrt(14); the scaling divides it by 2, the power of two
        // below 3.
        assert!((form.gain.abs() - 14.0_f64.sqrt() / 2.0).abs() < 1e-14);
    }

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

    #[test]
    fn it_gives_the_bits_of_the_textbook_where_no_limit_is_met() {
        let a = DMatrix::from_fn(7, 7, |row, column| {
            (1.0 + 7.3 * row as f64 + 2.9 * column as f64).sin() * 10_f64.powi(3 * row as i32)
        });
        let mut ours = a.clone();
        let mut theirs = a;
        let mut b = DMatrix::from_element(7, 1, 1.0);
        let mut c = DMatrix::from_element(1, 7, 1.0);
        balance(&mut ours, &mut b, &mut c);
        let scales = balance_parlett_reinsch(&mut theirs);
        assert_eq!(ours, theirs);
        assert!(
            c.iter().eq(scales.iter()) && b.iter().zip(&scales).all(|(b, scale)| b * scale == 1.0)
        );
    }

    #[test]
    fn a_chain_of_couplings_of_1e_minus_60_does_not_carry_the_scales_away() {
        let mut a = DMatrix::from_fn(60, 60, |row, column| match column as i32 - row as i32 {
            1 => 1e-60,
            -1 => 1.0,
            _ => 0.0,
        });
        let mut b = DMatrix::from_element(60, 1, 1.0);
        let mut c = DMatrix::from_element(1, 60, 1.0);
        balance(&mut a, &mut b, &mut c);
        assert!(
            b.iter()
                .chain(c.iter())
                .all(|entry| (1e-31..=1e31).contains(entry))
        );
    }

    #[test]
    fn a_state_that_nothing_leads_to_is_left_as_it_is() {
        let mut a = dmatrix![-1.0, 0.0; 1e9, 0.0];
        let mut b = dmatrix![1.0; 1.0];
        let mut c = dmatrix![1.0, 1.0];
        balance(&mut a, &mut b, &mut c);
        assert!(a[(1, 0)] != 0.0 && b[1] == 1.0, "the second column is zero");
    }
}
