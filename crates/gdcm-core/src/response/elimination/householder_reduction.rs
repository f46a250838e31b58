//! Balancing of a model, and its reduction to upper Hessenberg form by Householder reflections.

use nalgebra::DMatrix;
use pulp::{Simd, WithSimd};

use super::{AlignedNumbers, BLOCK, Block, SystemTable};

/// Blocks of a row that are summed up in registers at once.
const TOGETHER: usize = 4;

/// Brings a table `[A B; C D]` to `[Q' A Q, Q' B; C Q, D]` with Q orthogonal, `Q' A Q` upper Hessenberg, and the first
/// column of `Q' B` zero below its first entry.
///
/// One reflection `I - beta v v'` for that column, then one for each column of A (Golub & Van Loan, "Matrix
/// Computations", 4th ed. 2013, 7.4.2), applied from both inputs in one pass over the table T, as `T - y v' - v w'` with
///
/// ```text
/// y = beta T v,   w = beta T' v - gamma v,   gamma = beta v' y
/// ```
///
/// 10/3 n^3 + 4 n^2 (m + p) operations. Sums run over eight partial sums whatever the length of a vector, and every
/// multiply-add is fused, without one in hardware too: the result has the same bits on every instruction set.
pub struct HouseholderReduction<'a>(pub &'a mut SystemTable);

impl WithSimd for HouseholderReduction<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let table = self.0;
        let (states, first_input) = (table.states(), table.states());
        let mut reflector = Reflector::with_room_for(table);
        reflector.clear(simd, table, first_input, 0);
        for column in 0..states.saturating_sub(2) {
            reflector.clear(simd, table, column, column + 1);
        }
    }
}

/// A reflection and what it needs of the table.
struct Reflector {
    beta: f64,
    /// One entry for each state; zeros up to the column that is cleared.
    v: AlignedNumbers,
    w: AlignedNumbers,
    /// One entry for each row of the table.
    y: AlignedNumbers,
}

impl Reflector {
    fn with_room_for(table: &SystemTable) -> Self {
        let zeros = |count: usize| AlignedNumbers::zeros(count.next_multiple_of(BLOCK));
        Self { beta: 0.0, v: zeros(table.width()), w: zeros(table.width()), y: zeros(table.rows().len()) }
    }

    /// Clears a column below row `first` by a reflection of the states from `first` on, applied from both inputs; the column
    /// itself is not among those of these states.
    #[inline(always)]
    fn clear<S: Simd>(&mut self, simd: S, table: &mut SystemTable, column: usize, first: usize) {
        let (states, width) = (table.states(), table.width());
        let v = &mut *self.v;
        v[..first].fill(0.0);
        for (entry, row) in v.iter_mut().zip(table.numbers().chunks_exact(width)).take(states).skip(first) {
            *entry = row[column];
        }
        let Some((head, tail)) = v[first..states].split_first_mut() else { return };
        let tail: f64 = tail.iter().map(|entry| entry * entry).sum();
        if tail == 0.0 {
            return;
        }
        // The largest entries of A and B are of order 1: squares that underflow are negligible.
        let norm = (*head * *head + tail).sqrt();
        let left = -norm.copysign(*head);
        self.beta = 1.0 / (norm * (norm + head.abs()));
        *head -= left;
        self.apply(simd, table, first);
        let numbers = table.numbers_mut();
        for row in first..states {
            numbers[row * width + column] = if row == first { left } else { 0.0 };
        }
    }

    /// Applies the reflection to the columns from `first` on, from both inputs.
    #[inline(always)]
    fn apply<S: Simd>(&mut self, simd: S, table: &mut SystemTable, first: usize) {
        let (states, blocks) = (table.states(), first / BLOCK..table.blocks());
        let (all, _) = self.v.as_chunks();
        let v = &all[blocks.clone()];
        for (y, row) in self.y.iter_mut().zip(table.rows()) {
            *y = self.beta * dot(simd, &row[blocks.clone()], v);
        }
        let gamma = self.beta * dot(simd, all, self.y.as_chunks().0);
        let w = &mut self.w.as_chunks_mut().0[blocks.clone()];
        sum_rows(simd, w, table, blocks.start, first, &self.v[..states], self.beta);
        subtract_multiple(simd, w, gamma, v);
        // The first block may begin with columns that are done; v is zero there.
        w.as_flattened_mut()[..first % BLOCK].fill(0.0);
        for (row, (y, entries)) in self.y.iter().zip(table.rows_mut()).enumerate() {
            let entries = &mut entries[blocks.clone()];
            if (first..states).contains(&row) {
                subtract_multiples(simd, entries, [*y, self.v[row]], [v, w]);
            } else {
                subtract_multiple(simd, entries, *y, v);
            }
        }
    }
}

/// `sums = beta T' v` of the blocks from `block` on; v is zero before row `first`.
#[inline(always)]
fn sum_rows<S: Simd>(
    simd: S,
    sums: &mut [Block],
    table: &SystemTable,
    block: usize,
    first: usize,
    v: &[f64],
    beta: f64,
) {
    let (whole, rest) = sums.as_chunks_mut::<TOGETHER>();
    let start_of_rest = block + whole.len() * TOGETHER;
    for (sums, block) in whole.iter_mut().zip((block..).step_by(TOGETHER)) {
        sum_blocks(simd, sums, table, block, first, v, beta);
    }
    for (sum, block) in rest.iter_mut().zip(start_of_rest..) {
        sum_blocks(simd, std::array::from_mut(sum), table, block, first, v, beta);
    }
}

/// [`sum_rows`] of `N` blocks, in registers.
#[inline(always)]
fn sum_blocks<S: Simd, const N: usize>(
    simd: S,
    sums: &mut [Block; N],
    table: &SystemTable,
    block: usize,
    first: usize,
    v: &[f64],
    beta: f64,
) {
    let vectors = BLOCK / S::F64_LANES;
    let mut parts = [[simd.splat_f64s(0.0); BLOCK]; N];
    for (factor, row) in v.iter().zip(table.rows()).skip(first) {
        let factor = simd.splat_f64s(-factor * beta);
        for (parts, row) in parts.iter_mut().zip(&row[block..block + N]) {
            for (part, row) in parts[..vectors].iter_mut().zip(S::as_simd_f64s(row).0) {
                *part = simd.negate_mul_add_f64s(factor, *row, *part);
            }
        }
    }
    for (sum, parts) in sums.iter_mut().zip(&parts) {
        S::as_mut_simd_f64s(sum).0.copy_from_slice(&parts[..vectors]);
    }
}

/// `left' right`, in [`BLOCK`] partial sums and a fixed order whatever the length of a vector.
#[inline(always)]
fn dot<S: Simd>(simd: S, left: &[Block], right: &[Block]) -> f64 {
    let mut sums = [simd.splat_f64s(0.0); BLOCK];
    for (left, right) in left.iter().zip(right) {
        let vectors = S::as_simd_f64s(left).0.iter().zip(S::as_simd_f64s(right).0);
        for (sum, (left, right)) in sums.iter_mut().zip(vectors) {
            *sum = simd.mul_add_f64s(*left, *right, *sum);
        }
    }
    let mut count = BLOCK / S::F64_LANES;
    while count > 1 {
        count /= 2;
        for part in 0..count {
            sums[part] = simd.add_f64s(sums[part], sums[part + count]);
        }
    }
    simd.reduce_sum_f64s(sums[0])
}

/// `from -= factor row`.
#[inline(always)]
fn subtract_multiple<S: Simd>(simd: S, from: &mut [Block], factor: f64, row: &[Block]) {
    let factor = simd.splat_f64s(factor);
    let (from, _) = S::as_mut_simd_f64s(from.as_flattened_mut());
    let (row, _) = S::as_simd_f64s(row.as_flattened());
    for (from, row) in from.iter_mut().zip(row) {
        *from = simd.negate_mul_add_f64s(factor, *row, *from);
    }
}

/// [`subtract_multiple`] of two rows, one after the other.
#[inline(always)]
fn subtract_multiples<S: Simd>(simd: S, from: &mut [Block], factors: [f64; 2], rows: [&[Block]; 2]) {
    let factors = [simd.splat_f64s(factors[0]), simd.splat_f64s(factors[1])];
    let (from, _) = S::as_mut_simd_f64s(from.as_flattened_mut());
    let rows = [S::as_simd_f64s(rows[0].as_flattened()).0, S::as_simd_f64s(rows[1].as_flattened()).0];
    for ((from, first), second) in from.iter_mut().zip(rows[0]).zip(rows[1]) {
        let part = simd.negate_mul_add_f64s(factors[0], *first, *from);
        *from = simd.negate_mul_add_f64s(factors[1], *second, part);
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

    /// Entries from a sine: without pattern, and the same everywhere.
    fn table() -> SystemTable {
        let mut table = SystemTable::zeros(STATES, 2, 3);
        let width = table.width();
        for (row, numbers) in table.numbers_mut().chunks_exact_mut(width).enumerate() {
            let columns = if row < STATES { STATES + 2 } else { STATES };
            for (column, number) in numbers[..columns].iter_mut().enumerate() {
                *number = (7.3 * row as f64 + 2.9 * (column * column) as f64).sin();
            }
        }
        table
    }

    fn reduced(arch: Arch) -> SystemTable {
        let mut table = table();
        arch.dispatch(HouseholderReduction(&mut table));
        table
    }

    /// `C A^k B`, which a change of coordinates leaves alone.
    fn markov_parameter(table: &SystemTable, power: usize, output: usize, input: usize) -> f64 {
        let mut states: Vec<f64> = (0..STATES).map(|row| table.row(row)[STATES + input]).collect();
        let product = |row: usize, states: &[f64]| table.row(row).iter().zip(states).map(|(a, x)| a * x).sum::<f64>();
        for _ in 0..power {
            states = (0..STATES).map(|row| product(row, &states)).collect();
        }
        product(STATES + output, &states)
    }

    #[test]
    fn what_stands_below_the_subdiagonal_is_zero() {
        let table = reduced(Arch::new());
        assert!((2..STATES).all(|row| table.row(row)[..row - 1].iter().all(|entry| *entry == 0.0)));
    }

    #[test]
    fn from_inputs_to_outputs_nothing_changes() {
        let (before, after) = (table(), reduced(Arch::new()));
        for (power, output, input) in [(0, 0, 0), (1, 2, 1), (5, 1, 0)] {
            let [before, after] = [&before, &after].map(|table| markov_parameter(table, power, output, input));
            // Entries of A^5 grow to some thousand; eleven reflections with rounding errors of 1e-16 each.
            assert!((before - after).abs() < 1e-11, "C A^{power} B: {before} and {after}");
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let scalar = reduced(Arch::Scalar);
        assert_eq!(reduced(Arch::new()).numbers(), scalar.numbers());
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = pulp::x86::V3::try_new() {
            assert_eq!(reduced(Arch::V3(simd)).numbers(), scalar.numbers());
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
