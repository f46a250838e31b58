//! The frequency response of a reduced model: Gaussian elimination of its states at a vector of frequencies at a time.

use std::ops::{Deref, DerefMut};

use nalgebra::Complex;
use pulp::{Simd, WithSimd};

use super::{EliminatedRows, HessenbergForm, Interchanged, PANEL, Panel, frequencies};
use crate::dataset::PairTable;
use crate::response::frequency_response::FrequencyResponse;

/// `H(j omega)` of a reduced model, to be evaluated with the vectors of an instruction set.
pub struct LaneResponse<'a> {
    /// The model.
    pub form: &'a HessenbergForm,
    /// The frequencies \[rad/s\].
    pub omega: &'a [f64],
}

/// Largest `omega / alpha`, of which squares are taken.
const LARGEST_FREQUENCY: f64 = 1e150;

/// A vector of values, in the order of the frequencies.
type Values<S> = [<S as Simd>::f64s; 2];

impl WithSimd for LaneResponse<'_> {
    type Output = FrequencyResponse;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> FrequencyResponse {
        // In registers a panel takes six for each row.
        let most = if S::REGISTER_COUNT >= 32 { 4 } else { 2 };
        match tile_of(self.form.inputs(), most) {
            1 => self.evaluate::<S, 1>(simd),
            3 if S::REGISTER_COUNT >= 32 => self.evaluate::<S, 3>(simd),
            4 if S::REGISTER_COUNT >= 32 => self.evaluate::<S, 4>(simd),
            _ => self.evaluate::<S, 2>(simd),
        }
    }
}

/// Rows of each tile, at most so many, that leave the fewest places of tiles empty.
fn tile_of(rows: usize, most: usize) -> usize {
    let rows = rows.max(1);
    rows.div_ceil(rows.div_ceil(most))
}

impl LaneResponse<'_> {
    /// All values, with tiles of `R` rows.
    #[inline(always)]
    fn evaluate<S: Simd, const R: usize>(&self, simd: S) -> FrequencyResponse {
        let form = self.form;
        let scale = simd.splat_f64s(form.frequency_scale());
        let room = self.omega.len().div_ceil(S::F64_LANES) * form.outputs() * form.inputs();
        let mut values: Vec<Values<S>> = Vec::with_capacity(room);
        let mut elimination = Elimination::<S, R>::with_room_for(simd, form);
        let mut lanes = [simd.splat_f64s(0.0); GROUP];
        for omega in self.omega.chunks(GROUP) {
            let vectors = omega.len().div_ceil(S::F64_LANES);
            for (lanes, omega) in lanes.iter_mut().zip(omega.chunks(S::F64_LANES)) {
                let omega = simd.mul_f64s(scale, frequencies(simd, omega));
                // What would overflow must not look like a number.
                let overflows = simd.greater_than_f64s(omega, simd.splat_f64s(LARGEST_FREQUENCY));
                *lanes = simd.select_f64s(overflows, simd.splat_f64s(f64::NAN), omega);
            }
            elimination.run(simd, form, &lanes[..vectors]);
            for rows in elimination.vectors_mut() {
                for panel in 0..form.output_panels() {
                    for tile in 0..rows.tiles() {
                        let entries = rows.responses(simd, form, panel, tile);
                        append(simd, form, panel, tile, &entries, &mut values);
                    }
                }
            }
        }
        let values: Vec<Complex<f64>> = bytemuck::cast_vec(values);
        FrequencyResponse::from_blocks(self.omega.len(), S::F64_LANES, places(form, R), values)
    }
}

/// Appends the values of a tile: output by output, those of its inputs.
#[inline(always)]
fn append<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    panel: usize,
    tile: usize,
    entries: &Panel<S, R>,
    values: &mut Vec<Values<S>>,
) {
    let mut interleaved = [[[simd.splat_f64s(0.0); 2]; R]; PANEL];
    for offset in 0..PANEL {
        for row in 0..R {
            interleaved[offset][row] = entries[offset][row].interleaved(simd);
        }
    }
    let (inputs, outputs) = of_tile(form, R, panel, tile);
    for values_of_output in &interleaved[..outputs] {
        values.extend_from_slice(&values_of_output[..inputs]);
    }
}

/// Sides and outputs of a panel of a tile that the model has.
#[inline(always)]
fn of_tile(form: &HessenbergForm, rows: usize, panel: usize, tile: usize) -> (usize, usize) {
    (rows.min(form.inputs() - tile * rows), PANEL.min(form.outputs() - panel * PANEL))
}

/// The place of each response in the order in which tiles of so many rows are appended.
fn places(form: &HessenbergForm, rows: usize) -> PairTable<usize> {
    let (outputs, inputs) =
        if form.is_dual() { (form.inputs(), form.outputs()) } else { (form.outputs(), form.inputs()) };
    let mut places = PairTable::filled(outputs, inputs, 0);
    let mut place = 0;
    for panel in 0..form.output_panels() {
        for tile in 0..form.inputs().div_ceil(rows) {
            let (inputs, outputs) = of_tile(form, rows, panel, tile);
            for output in 0..outputs {
                for input in 0..inputs {
                    places[form.pair(tile * rows + input, panel * PANEL + output)] = place;
                    place += 1;
                }
            }
        }
    }
    places
}

/// Frequencies that choose their pivots together, whatever the length of a vector.
pub const GROUP: usize = 8;

/// What elimination of the states makes of `[G - j omega I, K; L, D']`, one frequency to a lane: in place of D' stands the
/// response.
///
/// The next row, which is real, takes half the operations of the active one: it clears a column unless in some lane of the
/// group the entry of the active row is more than tau times as large. Multipliers within G are then at most tau, and since each
/// row of G enters as it is, entries grow at most to `n tau` times the largest.
pub struct Elimination<S: Simd, const R: usize> {
    vectors: Vec<EliminatedRows<S, R>>,
    /// How many of them are in use.
    used: usize,
    /// Whether the last group had interchanges in each panel of states, as the next then mostly has.
    expected: Vec<bool>,
}

impl<S: Simd, const R: usize> Elimination<S, R> {
    /// Room for a model.
    #[inline(always)]
    pub fn with_room_for(simd: S, form: &HessenbergForm) -> Self {
        let count = GROUP / S::F64_LANES;
        let mut vectors = Vec::with_capacity(count);
        for _ in 0..count {
            vectors.push(EliminatedRows::with_room_for(simd, form));
        }
        Self { vectors, used: 0, expected: vec![false; form.state_panels()] }
    }

    /// The rows of each vector.
    #[inline(always)]
    pub fn vectors_mut(&mut self) -> &mut [EliminatedRows<S, R>] {
        &mut self.vectors[..self.used]
    }

    /// Eliminates all states at the frequencies `omega` of a group \[rad/s / alpha\].
    ///
    /// A panel of columns is cleared as if no row were interchanged; where that is found not to hold, it is cleared again
    /// column by column; and where that was so in the last group, only so. Both ways give the same bits.
    #[inline(always)]
    pub fn run(&mut self, simd: S, form: &HessenbergForm, omega: &[S::f64s]) {
        self.used = omega.len();
        let vectors = &mut self.vectors[..self.used];
        for (rows, omega) in vectors.iter_mut().zip(omega) {
            rows.start(*omega);
        }
        for (panel, expected) in self.expected.iter_mut().enumerate() {
            if *expected || !clear(simd, form, panel, vectors) {
                *expected = clear_with_interchanges(simd, form, panel, vectors) != [false; PANEL];
            }
            for rows in &mut *vectors {
                rows.follow(simd, form, panel);
            }
        }
        for rows in vectors {
            rows.finish(simd, form);
        }
    }
}

/// Clears a panel without an interchange; whether no vector asks for one.
#[inline(always)]
fn clear<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    panel: usize,
    vectors: &mut [EliminatedRows<S, R>],
) -> bool {
    // A closure in place of the loop would not have the instructions of the vectors.
    for rows in vectors {
        if !rows.clear(simd, form, panel) {
            return false;
        }
    }
    true
}

/// Clears a panel column by column, with an interchange in all vectors where one of them asks for it; returns where.
#[inline(always)]
fn clear_with_interchanges<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    panel: usize,
    vectors: &mut [EliminatedRows<S, R>],
) -> Interchanged {
    let mut required = [false; PANEL];
    'again: loop {
        let mut required_so_far = required;
        for (index, rows) in vectors.iter_mut().enumerate() {
            let found = rows.clear_with_interchanges(simd, form, panel, required_so_far);
            let first_new = (0..PANEL).find(|&offset| found[offset] && !required_so_far[offset]);
            if let (1.., Some(first_new)) = (index, first_new) {
                // The vectors before did without: all begin again, with what holds for the columns up to this one.
                required = [false; PANEL];
                required[..=first_new].copy_from_slice(&found[..=first_new]);
                continue 'again;
            }
            required_so_far = found;
        }
        return required_so_far;
    }
}

/// Numbers in a [`Block`]: as many as the longest vector register holds.
pub const BLOCK: usize = LINE;

/// Neighbouring entries of a row. Loops over them become vector instructions of whatever length the processor has.
pub type Block = [f64; BLOCK];

/// `[A B; C D]`, row by row, with zeros after each row up to a whole number of blocks.
#[derive(Clone, Debug)]
pub struct SystemTable {
    states: usize,
    blocks: usize,
    entries: AlignedNumbers,
}

impl SystemTable {
    /// Zeros for so many states, columns of B and rows of C.
    pub fn zeros(states: usize, inputs: usize, outputs: usize) -> Self {
        let blocks = (states + inputs).div_ceil(BLOCK).max(1);
        Self { states, blocks, entries: AlignedNumbers::zeros(blocks * BLOCK * (states + outputs)) }
    }

    /// Rows of A.
    #[inline(always)]
    pub fn states(&self) -> usize {
        self.states
    }

    /// Blocks in a row.
    #[inline(always)]
    pub fn blocks(&self) -> usize {
        self.blocks
    }

    /// Numbers in a row, the zeros at its end included.
    #[inline(always)]
    pub fn width(&self) -> usize {
        self.blocks * BLOCK
    }

    /// All numbers, row by row.
    #[inline(always)]
    pub fn numbers(&self) -> &[f64] {
        &self.entries
    }

    /// A row, its blocks as numbers.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.numbers()[row * self.width()..(row + 1) * self.width()]
    }

    /// All numbers to change, row by row.
    #[inline(always)]
    pub fn numbers_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// Every row as blocks.
    #[inline(always)]
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[Block]> {
        self.entries.as_chunks().0.chunks_exact(self.blocks)
    }

    /// Every row as blocks to change.
    #[inline(always)]
    pub fn rows_mut(&mut self) -> impl Iterator<Item = &mut [Block]> {
        self.entries.as_chunks_mut().0.chunks_exact_mut(self.blocks)
    }
}

/// Numbers in a cache line, and in the longest vector register.
pub const LINE: usize = 8;

/// Numbers that begin on a cache line: a vector that lies across two of them takes twice as long to read and to write.
#[derive(Clone, Debug)]
pub struct AlignedNumbers {
    /// A copy begins where the copied ones did, on a cache line or not: that costs time, not correctness.
    numbers: Vec<f64>,
    start: usize,
    count: usize,
}

impl AlignedNumbers {
    /// So many zeros.
    pub fn zeros(count: usize) -> Self {
        let numbers = vec![0.0_f64; count + LINE - 1];
        let start = numbers.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE - 1);
        Self { numbers, start, count }
    }
}

impl Deref for AlignedNumbers {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.numbers[self.start..self.start + self.count]
    }
}

impl DerefMut for AlignedNumbers {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.start..self.start + self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::StateSpace;
    use nalgebra::{DMatrix, dmatrix};
    use pulp::{Arch, Scalar};

    type Values = PairTable<Vec<Complex<f64>>>;

    fn on<S: Simd>(simd: S, model: &StateSpace, omega: &[f64]) -> Values {
        let form = &HessenbergForm::of(Arch::new(), model);
        simd.vectorize(LaneResponse { form, omega }).curves()
    }

    /// The values on every instruction set of this machine with fused multiply-adds, which must have the same bits.
    fn on_vectors(model: &StateSpace, omega: &[f64]) -> Vec<Values> {
        let mut values = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            values.extend(pulp::x86::V3::try_new().map(|simd| on(simd, model, omega)));
            values.extend(pulp::x86::V4::try_new().map(|simd| on(simd, model, omega)));
        }
        #[cfg(target_arch = "aarch64")]
        values.extend(pulp::aarch64::Neon::try_new().map(|simd| on(simd, model, omega)));
        values
    }

    /// Entries from a sine: without pattern, and the same everywhere.
    fn matrix(rows: usize, columns: usize, seed: f64) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |row, column| (seed + 7.3 * row as f64 + 2.9 * (column * column) as f64).sin())
    }

    fn model(order: usize, outputs: usize, inputs: usize) -> StateSpace {
        let a = matrix(order, order, 0.3) - DMatrix::identity(order, order) * 2.0;
        let (b, c, d) = (matrix(order, inputs, 1.1), matrix(outputs, order, 2.3), matrix(outputs, inputs, 3.7));
        StateSpace::new(a, b, c, d).unwrap()
    }

    /// From far below the poles, where real rows stay, to far above, where active ones do; lanes differ in between.
    fn wide(count: usize) -> Vec<f64> {
        (0..count).map(|k| 1e-3 * 1e6_f64.powf(k as f64 / count as f64)).collect()
    }

    /// By a dense decomposition.
    fn dense(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
        let [a, b, c, d] = [model.a(), model.b(), model.c(), model.d()].map(|matrix| matrix.map(Complex::from));
        let states = DMatrix::identity(a.nrows(), a.nrows()) * Complex::new(0.0, omega) - a;
        c * states.lu().solve(&b).unwrap() + d
    }

    /// The largest difference, relative to the largest value.
    fn difference(found: &Values, expected: &Values) -> f64 {
        let all = |values: &Values| values.iter().flat_map(|(_, values)| values.clone()).collect::<Vec<_>>();
        let (found, expected) = (all(found), all(expected));
        let largest = expected.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let differences = found.iter().zip(&expected).map(|(found, expected)| (found - expected).norm());
        // NaN must not be lost in a maximum.
        differences.fold(0.0, |worst: f64, next| if next <= worst { worst } else { next }) / largest
    }

    #[test]
    fn tiles_are_as_alike_as_they_can_be() {
        assert_eq!([1, 2, 3, 4, 5, 6, 7, 8, 9].map(|rows| tile_of(rows, 4)), [1, 2, 3, 4, 3, 3, 4, 4, 3]);
        assert_eq!([0, 1, 2, 3, 9].map(|rows| tile_of(rows, 2)), [1, 1, 2, 2, 2]);
    }

    #[test]
    fn vectors_of_every_length_agree_with_scalars_at_every_remainder_length() {
        for count in 0..=17 {
            let (model, omega) = (model(9, 3, 3), wide(count));
            let scalar = on(Scalar::new(), &model, &omega);
            for vectors in on_vectors(&model, &omega) {
                // Two backward stable solutions of order 9: rounding errors of at most 9 tau times 1e-16 each.
                assert!(count == 0 || difference(&vectors, &scalar) < 8e-12, "{count} frequencies");
            }
        }
    }

    #[test]
    fn vectors_of_every_length_give_the_same_bits() {
        for (order, outputs, inputs) in
            [(0, 2, 1), (1, 1, 1), (2, 6, 4), (12, 6, 4), (30, 6, 4), (17, 3, 5), (8, 7, 6), (7, 9, 9)]
        {
            let (model, omega) = (model(order, outputs, inputs), wide(61));
            let all = on_vectors(&model, &omega);
            assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "order {order}");
        }
    }

    #[test]
    fn values_depend_on_the_frequencies_of_their_group_only() {
        let (model, omega) = (model(14, 6, 4), wide(45));
        let together = on_vectors(&model, &omega);
        for (k, omega) in omega.chunks(GROUP).enumerate() {
            let alone = on_vectors(&model, omega);
            for (alone, together) in alone.iter().zip(&together) {
                let same = |(pair, values): (_, &Vec<_>)| together[pair][k * GROUP..].starts_with(values);
                assert!(alone.iter().all(same), "group {k}");
            }
        }
    }

    #[test]
    fn frequencies_of_a_group_that_disagree_on_their_pivots_each_have_theirs() {
        // At 1e-4 the real row must stay, at 1e4 the complex one: neighbours in one group.
        let model = model(14, 6, 4);
        let omega: Vec<f64> = (0..29).map(|k| if k % 2 == 0 { 1e-4 } else { 1e4 } * (1.0 + f64::from(k))).collect();
        let mut all = on_vectors(&model, &omega);
        all.push(on(Scalar::new(), &model, &omega));
        for values in all {
            for (k, omega) in omega.iter().enumerate() {
                let expected = dense(&model, *omega);
                let largest = expected.iter().map(|value| value.norm()).fold(0.0, f64::max);
                for (pair, values) in values.iter() {
                    let error = (values[k] - expected[(pair.output, pair.input)]).norm();
                    // The bound of threshold pivoting, 3e-11, times the condition of a random matrix of order 14.
                    assert!(error < 1e-9 * largest, "{omega}, {pair:?}: {error}");
                }
            }
        }
    }

    #[test]
    fn poles_on_the_grid_are_survived_by_models_of_any_order() {
        for order in 1..=9 {
            let (b, c) = (matrix(order, 2, 1.1), matrix(3, order, 2.3));
            // All poles in zero; then pairs at 2 rad/s, with one in zero left over.
            let turning = DMatrix::from_fn(order, order, |row, column| match (row % 2, column) {
                (0, column) if column == row + 1 => 2.0,
                (1, column) if column + 1 == row => -2.0,
                _ => 0.0,
            });
            for (a, omega) in [(DMatrix::zeros(order, order), 0.0), (turning, 2.0)] {
                let model = StateSpace::new(a, b.clone(), c.clone(), DMatrix::zeros(3, 2)).unwrap();
                for frequencies in [vec![omega], vec![1.0, omega, 3.0]] {
                    let mut all = on_vectors(&model, &frequencies);
                    all.push(on(Scalar::new(), &model, &frequencies));
                    let finite =
                        |k: usize| all.iter().all(|values| values.iter().all(|(_, curve)| curve[k].is_finite()));
                    assert!(frequencies.len() == 1 || (finite(0) && finite(2)), "{order} states");
                }
            }
        }
    }

    #[test]
    fn a_chain_coupled_by_1e_minus_55_neither_overflows_nor_loses_its_coupling() {
        // One over the coupling is 1e55 a step: without shrinking, the fifth step would overflow the square of a pivot.
        let weak = 1e-55;
        let a = DMatrix::from_fn(8, 8, |row, column| match row.abs_diff(column) {
            0 => -1.0,
            1 => weak,
            _ => 0.0,
        });
        let model = StateSpace::new(a, DMatrix::identity(8, 8), DMatrix::identity(8, 8), DMatrix::zeros(8, 8)).unwrap();
        let mut all = on_vectors(&model, &[0.5, 1.0, 2.0]);
        all.push(on(Scalar::new(), &model, &[0.5, 1.0, 2.0]));
        for values in all {
            for (pair, values) in values.iter() {
                let lag = Complex::new(0.5, -0.5);
                let expected = match pair.output.abs_diff(pair.input) {
                    0 => lag,
                    1 => lag * lag * weak,
                    _ => continue,
                };
                // A dozen operations.
                assert!((values[1] - expected).norm() < 1e-14 * expected.norm(), "{pair:?}: {}", values[1]);
            }
        }
    }

    #[test]
    fn a_model_of_two_separate_parts_is_the_sum_of_both() {
        let a = dmatrix![-1.0, 2.0, 0.0, 0.0; -3.0, -0.5, 0.0, 0.0; 0.0, 0.0, -0.2, 4.0; 0.0, 0.0, -5.0, -0.3];
        let (b, c) = (dmatrix![1.0; 0.5; -1.0; 2.0], dmatrix![1.0, -2.0, 0.5, 3.0]);
        let part = |at: usize| {
            let (a, b, c) = (a.view((at, at), (2, 2)), b.rows(at, 2), c.columns(at, 2));
            StateSpace::new(a.into_owned(), b.into_owned(), c.into_owned(), dmatrix![0.0]).unwrap()
        };
        let whole = StateSpace::new(a.clone(), b.clone(), c.clone(), dmatrix![0.0]).unwrap();
        let omega = wide(11);
        let (first, second) = (on(Scalar::new(), &part(0), &omega), on(Scalar::new(), &part(2), &omega));
        let sum = first.map(|pair, values| values.iter().zip(&second[pair]).map(|(a, b)| a + b).collect());
        for values in on_vectors(&whole, &omega) {
            assert!(difference(&values, &sum) < 1e-14);
        }
    }
}

#[cfg(test)]
mod system_table_tests {
    use super::*;

    #[test]
    fn numbers_begin_on_a_cache_line() {
        for count in [0, 1, 7, 8, 9, 100] {
            let numbers = AlignedNumbers::zeros(count);
            assert_eq!((numbers.len(), numbers.as_ptr().align_offset(64)), (count, 0));
        }
    }

    #[test]
    fn a_copy_has_the_same_numbers() {
        let mut numbers = AlignedNumbers::zeros(5);
        numbers.copy_from_slice(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(numbers.clone()[..], numbers[..]);
    }
}
