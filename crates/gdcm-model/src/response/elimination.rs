//! Computes a state-space model's frequency response by eliminating the states from the system
//! matrix.
//!
//! The model is `dx/dt = A x + B u`, `y = C x + D u` with `n` states, and H its response at a
//! frequency. Step 1 is in `hessenberg_form.rs`, which explains the matrices; the other steps are
//! in `eliminate_group`.
//!
//! ```text
//! 1  scale the model (A by 1 / alpha), transform and transpose it, once for all frequencies s = j omega / alpha:
//!        [ G - s I  K  ]      G (n x n) from A', K from C', L from B'; ' denotes the transpose
//!        [ L        D' ]      H' = D' - L (G - s I)^-1 K
//!    G is real, and zero below its subdiagonal entries h_k, k = 1 ... n - 1;
//!    the first row of L is zero except for its last entry
//! 2  u <- first row of [G - s I, K], the active row; w <- each row of [L D'] but the first
//! 3  for k = 1 ... n - 1, with the next row r = [G - s I, K]_(k+1) / h_k, which is real but for -s / h_k:
//! 4     if |u_k| > tau |h_k| in any of eight neighbouring frequencies, then in those with |u_k| > |h_k| interchange:
//!          w <- w - (w_k / u_k) u;   u <- h_k r - (h_k / u_k) u
//! 5     else: w <- w - w_k r;   u <- u - u_k r
//! 6  the last column: w <- w - (w_n / u_n) u, and the first row of [L D'] likewise; D' is now H'
//! ```
//!
//! If the model has fewer outputs than inputs, its dual (A', C', B', D') takes its place, whose
//! response is H'. A negligible h_k is replaced by zero, which forces the interchange in step 4
//! (see `subdiagonal.rs`).
//!
//! Each frequency occupies a lane of a vector register. Hessenberg form: Laub, IEEE Trans.
//! Automatic Control 26(2), 1981; tau is the pivot threshold in Duff, Erisman & Reid, "Direct
//! Methods for Sparse Matrices", 2nd ed. 2017, 5.2.

use nalgebra::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::complex_lanes::ComplexLanes;
use super::frequency_response::FrequencyResponse;
use super::hessenberg_form::HessenbergForm;
use super::subdiagonal::Subdiagonal;
use crate::dataset::{PairTable, StateSpace};

/// Computes `H(j omega) = C (j omega I - A)^-1 B + D`: a p x m table of curves, with a value at
/// each `omega` \[rad/s\].
///
/// The model is balanced and reduced to Hessenberg form once; at each frequency its states are then
/// eliminated from the system matrix, with pivoting, in O(n (n + 2 max(m, p)) min(m, p))
/// operations. As many frequencies are solved at once as a vector register holds: eight with
/// AVX-512, four with AVX2, two with NEON, otherwise one.
///
/// Eight neighbouring frequencies share their pivots: a value depends on its group through rounding
/// only. The bits are the same on all hardware with fused multiply-adds (AVX2, AVX-512, NEON).
///
/// Backward error: below 1e-10 relative to the largest entry in the balanced A, in practice about
/// 1e-13. The relative error in the response grows as `j omega` approaches a pole; at a pole, where
/// elimination meets a zero pivot, the values are not finite. Entries beyond
/// [`super::large_entry::LARGEST_ENTRY`] may overflow.
///
/// Uses only the matrices, as continuous-time ones; for a model with
/// [`crate::dataset::state_space::Timing`] see [`super::prepared_model::PreparedModel`].
pub fn evaluate(model: &StateSpace, omega: &[f64]) -> FrequencyResponse {
    evaluate_on(Arch::new(), model, omega)
}

/// Evaluates as [`evaluate`], with a given instruction set, for tests and benchmarks.
pub fn evaluate_on(arch: Arch, model: &StateSpace, omega: &[f64]) -> FrequencyResponse {
    let s: Vec<_> = omega
        .iter()
        .map(|omega| Complex::new(0.0, *omega))
        .collect();
    arch.dispatch(Elimination {
        form: &HessenbergForm::new(arch, model.a().clone(), model),
        s: &s,
    })
}

/// Evaluates `H(s)` for a reduced model, compiled for an instruction set.
pub(super) struct Elimination<'a> {
    pub(super) form: &'a HessenbergForm,
    /// Values of `s` at which to evaluate: \[rad/s\], or `z - 1` in discrete time.
    pub(super) s: &'a [Complex<f64>],
}

/// Number of neighbouring frequencies that share their pivots, independent of the vector length.
const GROUP: usize = 8;

/// Maximum `|s| / alpha`: beyond it, its square could overflow.
const LARGEST_SHIFT: f64 = 1e150;

impl WithSimd for Elimination<'_> {
    type Output = FrequencyResponse;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> FrequencyResponse {
        let form = self.form;
        let [outputs, inputs] = form.model_shape();
        let mut curves = PairTable::from_fn(outputs, inputs, |_| Vec::with_capacity(self.s.len()));
        // The rows for a frequency group: a register contains `S::F64_LANES` of its frequencies.
        let mut vectors: Vec<ComplexRows<S>> = Vec::new();
        for _ in 0..GROUP / S::F64_LANES {
            vectors.push(ComplexRows {
                shift: ComplexLanes::real(simd, 0.0),
                entries: Vec::new(),
            });
        }
        for group in self.s.chunks(GROUP) {
            let shifts = GroupShifts::new(group, form.frequency_scale);
            let vectors = &mut vectors[..group.len().div_ceil(S::F64_LANES)];
            eliminate_group(simd, form, vectors, &shifts);
            append_group(form, vectors, group, &mut curves);
        }
        FrequencyResponse::new(curves)
    }
}

/// The values `s / alpha` for a group, real and imaginary parts separate.
struct GroupShifts {
    re: [f64; GROUP],
    im: [f64; GROUP],
}

impl GroupShifts {
    /// Scales a group's frequencies; an incomplete group repeats its last frequency. A frequency
    /// whose square could overflow becomes NaN, so that its response cannot be mistaken for a valid
    /// value.
    #[inline(always)]
    fn new(group: &[Complex<f64>], frequency_scale: f64) -> Self {
        let mut shifts = Self {
            re: [f64::NAN; GROUP],
            im: [f64::NAN; GROUP],
        };
        for lane in 0..GROUP {
            let shift = group[lane.min(group.len() - 1)] * frequency_scale;
            let is_too_large = shift.norm() > LARGEST_SHIFT;
            if !is_too_large {
                shifts.re[lane] = shift.re;
                shifts.im[lane] = shift.im;
            }
        }
        shifts
    }
}

/// Eliminates the states for a group: steps 2 to 6. `vectors` contains the rows for the group's
/// frequencies, and afterwards their responses.
///
/// The next row is real, and costs half as much as the active row. It is therefore used to clear a
/// column unless the active row's entry is more than tau times as large in some lane. Multipliers
/// within G are then at most tau, and since G's rows enter unchanged, entries grow at most by the
/// factor `n tau`.
#[inline(always)]
fn eliminate_group<S: Simd>(
    simd: S,
    form: &HessenbergForm,
    vectors: &mut [ComplexRows<S>],
    shifts: &GroupShifts,
) {
    let re = S::as_simd_f64s(&shifts.re).0;
    let im = S::as_simd_f64s(&shifts.im).0;
    for (rows, (re, im)) in vectors.iter_mut().zip(re.iter().zip(im)) {
        rows.start(simd, form, ComplexLanes { re: *re, im: *im });
    }
    for column in 0..form.order.saturating_sub(1) {
        let mut interchange = false;
        for rows in &*vectors {
            interchange |= rows.needs_interchange(simd, form, column);
        }
        for rows in &mut *vectors {
            rows.clear_column(simd, form, column, interchange);
        }
    }
    for rows in vectors {
        rows.finish(simd, form);
    }
}

/// Appends a group's values to the curves. A NaN frequency gives NaN, even for a model without
/// states, whose response would otherwise be finite.
#[inline(always)]
fn append_group<S: Simd>(
    form: &HessenbergForm,
    vectors: &[ComplexRows<S>],
    group: &[Complex<f64>],
    curves: &mut PairTable<Vec<Complex<f64>>>,
) {
    for output in 0..form.outputs {
        for input in 0..form.inputs {
            let curve = &mut curves[form.pair(input, output)];
            // Row `input` of [L D'], past the state columns.
            let place = input * form.width() + form.order + output;
            for (lane, s) in group.iter().enumerate() {
                let value = &vectors[lane / S::F64_LANES].entries[place];
                curve.push(if s.is_nan() {
                    *s
                } else {
                    value.lane(lane % S::F64_LANES)
                });
            }
        }
    }
}

/// A system matrix's complex rows during elimination, for a vector of frequencies.
///
/// These are the *active* row `u`, initially the first row of `[G K]`, and the rows `w`, which are
/// all rows of `[L D']` except the first. The first row of `[L D']` is zero in G's columns except
/// for the last, and is not needed until all other columns are clear: the active row occupies its
/// place, so that rows and responses are numbered alike.
struct ComplexRows<S: Simd> {
    /// `s / alpha`, called s in the steps.
    shift: ComplexLanes<S>,
    /// Entries, row by row: the active row, then the rows `w`; [`HessenbergForm::width`] entries
    /// each.
    entries: Vec<ComplexLanes<S>>,
}

impl<S: Simd> ComplexRows<S> {
    /// Sets the rows to their values before elimination (step 2), reusing the memory from the
    /// previous frequencies.
    #[inline(always)]
    fn start(&mut self, simd: S, form: &HessenbergForm, shift: ComplexLanes<S>) {
        self.shift = shift;
        self.entries.clear();
        self.entries.reserve(form.complex_rows.len());
        for entry in &form.complex_rows {
            self.entries.push(ComplexLanes::real(simd, *entry));
        }
        if form.order > 0 {
            self.entries[0] = self.entries[0].minus(simd, shift);
        }
    }

    /// Returns whether, in any lane, the active row's entry `u_k` is NaN or exceeds the pivot
    /// threshold `tau |h_k|` (the condition in step 4). Always true for a negligible `h_k`, whose
    /// threshold is NaN.
    #[inline(always)]
    fn needs_interchange(&self, simd: S, form: &HessenbergForm, column: usize) -> bool {
        let inverse_square_threshold =
            simd.splat_f64s(form.subdiagonals[column].inverse_square_threshold);
        let excess = simd.mul_f64s(self.entries[column].square(simd), inverse_square_threshold);
        let exceeds = simd.not_m64s(simd.less_than_or_equal_f64s(excess, simd.splat_f64s(1.0)));
        simd.first_true_m64s(exceeds) < S::F64_LANES
    }

    /// Clears a column: step 5, or with `interchange` step 4, which swaps the active row and the
    /// next row in the lanes where the active entry is larger.
    #[inline(always)]
    fn clear_column(&mut self, simd: S, form: &HessenbergForm, column: usize, interchange: bool) {
        let next = form.next_row(column);
        let subdiagonal = &form.subdiagonals[column];
        let shift = self
            .shift
            .scaled(simd, simd.splat_f64s(subdiagonal.reciprocal));
        let (active, others) = self.entries.split_at_mut(form.width());
        let pivot = active[column];
        let active = &mut active[column + 1..];
        if !interchange {
            subtract_next(simd, active, pivot, next, shift);
            for row in others.chunks_exact_mut(form.width()) {
                let multiplier = row[column];
                subtract_next(simd, &mut row[column + 1..], multiplier, next, shift);
            }
            return;
        }
        let interchange = Interchange::new(simd, subdiagonal, pivot);
        for row in others.chunks_exact_mut(form.width()) {
            let [quotient, multiplier] = interchange.factors(simd, row[column]);
            let row = &mut row[column + 1..];
            subtract_multiple(simd, row, quotient, active);
            subtract_next(simd, row, multiplier, next, shift);
        }
        // Update the active row last: the other rows need its old value.
        let [quotient, multiplier] = interchange.active_factors(simd, subdiagonal, pivot);
        let zero = ComplexLanes::real(simd, 0.0);
        for entry in &mut *active {
            *entry = zero.minus_product(simd, quotient, *entry);
        }
        subtract_next(simd, active, multiplier, next, shift);
    }

    /// Clears the last column with the active row; the first row of `[L D']` then takes its place
    /// (step 6).
    #[inline(always)]
    fn finish(&mut self, simd: S, form: &HessenbergForm) {
        let (active, others) = self.entries.split_at_mut(form.width());
        let (states, active) = active.split_at_mut(form.order);
        let Some(pivot) = states.last() else {
            for (entry, feed_through) in active.iter_mut().zip(&form.feed_through) {
                *entry = ComplexLanes::real(simd, *feed_through);
            }
            return;
        };
        let reciprocal = pivot.reciprocal(simd);
        for row in others.chunks_exact_mut(form.width()) {
            let quotient = row[form.order - 1].product(simd, reciprocal);
            subtract_multiple(simd, &mut row[form.order..], quotient, active);
        }
        let quotient = reciprocal.scaled(simd, simd.splat_f64s(form.gain));
        for (entry, feed_through) in active.iter_mut().zip(&form.feed_through) {
            *entry = ComplexLanes::real(simd, *feed_through).minus_product(simd, quotient, *entry);
        }
    }
}

/// Subtracts `multiplier (next row)` from a row, right of the cleared column; this takes most of
/// the time. The first entry in the next row also contains `-shift`.
#[inline(always)]
fn subtract_next<S: Simd>(
    simd: S,
    row: &mut [ComplexLanes<S>],
    multiplier: ComplexLanes<S>,
    next: &[f64],
    shift: ComplexLanes<S>,
) {
    for (entry, next) in row.iter_mut().zip(next) {
        *entry = entry.minus_real_product(simd, multiplier, simd.splat_f64s(*next));
    }
    row[0] = row[0].plus_product(simd, multiplier, shift);
}

/// Subtracts `quotient (other row)` from a row.
#[inline(always)]
fn subtract_multiple<S: Simd>(
    simd: S,
    row: &mut [ComplexLanes<S>],
    quotient: ComplexLanes<S>,
    other: &[ComplexLanes<S>],
) {
    for (entry, other) in row.iter_mut().zip(other) {
        *entry = entry.minus_product(simd, quotient, *other);
    }
}

/// An interchange: in some lanes, the active row clears a column and the next row becomes active.
///
/// With the entries in the column, `u` in the active row, `w` in another complex row and `h` in the
/// next row, the rows become
///
/// ```text
/// active row:  h (next row / h) - (h / u) (active row)
/// other row:   (row) - (w / u) (active row)
/// ```
///
/// In the other lanes the next row clears the column, and `u` and `w` times (next row / h) are
/// subtracted. Both take two steps: subtract a *quotient* times the active row (from zero for the
/// active row itself), then a *multiplier* times (next row / h).
///
/// The new active row contains the next row itself, not (next row / h). Otherwise a chain of weak
/// couplings would enlarge the pivots by `1 / h` at each interchange, until their squares overflow.
struct Interchange<S: Simd> {
    /// Lanes in which the rows are interchanged.
    lanes: S::m64s,
    /// `1 / u`.
    reciprocal: ComplexLanes<S>,
}

impl<S: Simd> Interchange<S> {
    /// Selects the lanes in which the active row's entry `u` is larger than the next row's `h`.
    #[inline(always)]
    fn new(simd: S, subdiagonal: &Subdiagonal, pivot: ComplexLanes<S>) -> Self {
        let lanes = simd.greater_than_f64s(pivot.square(simd), simd.splat_f64s(subdiagonal.square));
        Self {
            lanes,
            reciprocal: pivot.reciprocal(simd),
        }
    }

    /// Returns quotient and multiplier for a row with entry `w`: `w / u` and zero in the selected
    /// lanes, zero and `w` in the others.
    #[inline(always)]
    fn factors(&self, simd: S, entry: ComplexLanes<S>) -> [ComplexLanes<S>; 2] {
        let zero = ComplexLanes::real(simd, 0.0);
        let quotient = zero.replaced_where(simd, self.lanes, entry.product(simd, self.reciprocal));
        [quotient, entry.replaced_where(simd, self.lanes, zero)]
    }

    /// Returns quotient and multiplier for the active row: `h / u` and `-h` in the selected lanes,
    /// -1 and `u` in the others. For a negligible `h` they are zero and -1 in the selected lanes:
    /// the next row, which is then stored unscaled, becomes the active row.
    #[inline(always)]
    fn active_factors(
        &self,
        simd: S,
        subdiagonal: &Subdiagonal,
        pivot: ComplexLanes<S>,
    ) -> [ComplexLanes<S>; 2] {
        // If `h` is zero, set the quotient to zero without division by the pivot, which may be zero
        // too.
        let quotient = if subdiagonal.entry == 0.0 {
            ComplexLanes::real(simd, 0.0)
        } else {
            self.reciprocal
                .scaled(simd, simd.splat_f64s(subdiagonal.entry))
        };
        let multiplier = ComplexLanes::real(simd, -subdiagonal.divisor);
        [
            ComplexLanes::real(simd, -1.0).replaced_where(simd, self.lanes, quotient),
            pivot.replaced_where(simd, self.lanes, multiplier),
        ]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};
    use pulp::Scalar;

    use super::*;
    use crate::dataset::Pair;

    fn siso(a: DMatrix<f64>, b: DMatrix<f64>, c: DMatrix<f64>, d: f64) -> StateSpace {
        StateSpace::new(a, b, c, dmatrix![d]).unwrap()
    }

    fn oscillator() -> StateSpace {
        siso(
            dmatrix![0.0, 1.0; -4.0, 0.0],
            dmatrix![0.0; 1.0],
            dmatrix![1.0, 0.0],
            0.0,
        )
    }

    fn only(response: FrequencyResponse) -> Complex<f64> {
        response.curve(Pair::new(0, 0))[0]
    }

    #[test]
    fn a_first_order_lag_has_its_known_response() {
        // 1 / (j omega + 2) at omega = 3: (2 - 3j) / 13.
        let value = only(evaluate(
            &siso(dmatrix![-2.0], dmatrix![1.0], dmatrix![1.0], 0.0),
            &[3.0],
        ));
        assert!((value - Complex::new(2.0 / 13.0, -3.0 / 13.0)).norm() < 1e-16);
    }

    #[test]
    fn a_model_of_order_zero_is_its_feed_through() {
        let empty = siso(
            DMatrix::zeros(0, 0),
            DMatrix::zeros(0, 1),
            DMatrix::zeros(1, 0),
            2.5,
        );
        assert_eq!(only(evaluate(&empty, &[1.0])), Complex::new(2.5, 0.0));
    }

    #[test]
    fn an_undamped_oscillator_at_its_own_frequency_is_not_finite() {
        assert!(!only(evaluate(&oscillator(), &[2.0])).is_finite());
    }

    #[test]
    fn a_pole_on_the_grid_leaves_the_other_frequencies_alone() {
        let omega: Vec<f64> = (0..19).map(|k| f64::from(k) * 0.25).collect();
        let response = evaluate(&oscillator(), &omega);
        for (omega, value) in omega.iter().zip(response.curve(Pair::new(0, 0))) {
            // 1 / (4 - omega^2): the difference amplifies the rounding errors of a few operations
            // up to 8 times.
            let expected = 1.0 / (4.0 - omega * omega);
            assert_eq!(value.is_finite(), *omega != 2.0, "{omega}");
            assert!(
                *omega == 2.0 || (value - expected).norm() < 1e-14 * expected.abs(),
                "{omega}"
            );
        }
    }

    #[test]
    fn units_of_inputs_and_outputs_only_scale_the_response() {
        let a = dmatrix![-1.0, 2.0; -3.0, -0.5];
        let plain = only(evaluate(
            &siso(a.clone(), dmatrix![1.0; 0.5], dmatrix![1.0, -2.0], 0.0),
            &[1.3],
        ));
        for exponent in [-800, 800] {
            let unit = 2.0_f64.powi(exponent);
            let scaled = only(evaluate(
                &siso(
                    a.clone(),
                    dmatrix![unit; 0.5 * unit],
                    dmatrix![1.0, -2.0],
                    0.0,
                ),
                &[1.3],
            ));
            // The unit is a power of two, so that scaling causes no rounding.
            assert_eq!(scaled, plain * unit);
        }
    }

    #[test]
    fn units_of_the_states_do_not_matter() {
        let a = dmatrix![-1.0, 2.0; -3.0, -0.5];
        let b = dmatrix![1.0; 0.5];
        let c = dmatrix![1.0, -2.0];
        let scale = DMatrix::from_diagonal(&nalgebra::dvector![1e-9, 1e9]);
        let inverse = DMatrix::from_diagonal(&nalgebra::dvector![1e9, 1e-9]);
        let plain = only(evaluate(
            &siso(a.clone(), b.clone(), c.clone(), 0.1),
            &[1.3],
        ));
        let scaled = only(evaluate(
            &siso(&scale * a * &inverse, scale * b, c * inverse, 0.1),
            &[1.3],
        ));
        // Tolerance: the scaling rounds each entry once.
        assert!((plain - scaled).norm() < 1e-14 * plain.norm());
    }

    type Values = PairTable<Vec<Complex<f64>>>;

    fn on<S: Simd>(simd: S, model: &StateSpace, omega: &[f64]) -> Values {
        let form = &HessenbergForm::new(Arch::new(), model.a().clone(), model);
        let s: Vec<_> = omega
            .iter()
            .map(|omega| Complex::new(0.0, *omega))
            .collect();
        simd.vectorize(Elimination { form, s: &s }).curves().clone()
    }

    /// Returns the values for every instruction set of this machine with fused multiply-adds; they
    /// must agree bit for bit.
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

    /// Returns a matrix with reproducible irregular entries from a sine.
    fn matrix(rows: usize, columns: usize, seed: f64) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |row, column| {
            (seed + 7.3 * row as f64 + 2.9 * (column * column) as f64).sin()
        })
    }

    fn model(order: usize, outputs: usize, inputs: usize) -> StateSpace {
        let a = matrix(order, order, 0.3) - DMatrix::identity(order, order) * 2.0;
        let b = matrix(order, inputs, 1.1);
        let c = matrix(outputs, order, 2.3);
        let d = matrix(outputs, inputs, 3.7);
        StateSpace::new(a, b, c, d).unwrap()
    }

    /// Returns frequencies from far below the poles, where the real rows are the pivots, to far
    /// above, where the active rows are; in between, the lanes of a vector differ.
    fn wide(count: usize) -> Vec<f64> {
        (0..count)
            .map(|k| 1e-3 * 1e6_f64.powf(k as f64 / count as f64))
            .collect()
    }

    /// Computes the response with a dense matrix decomposition.
    fn dense(model: &StateSpace, omega: f64) -> DMatrix<Complex<f64>> {
        let [a, b, c, d] =
            [model.a(), model.b(), model.c(), model.d()].map(|matrix| matrix.map(Complex::from));
        let states = DMatrix::identity(a.nrows(), a.nrows()) * Complex::new(0.0, omega) - a;
        c * states.lu().solve(&b).unwrap() + d
    }

    fn flattened(values: &Values) -> Vec<Complex<f64>> {
        values
            .iter()
            .flat_map(|(_, values)| values.clone())
            .collect()
    }

    /// Returns the maximum difference, relative to the largest expected value.
    fn difference(found: &Values, expected: &Values) -> f64 {
        let found = flattened(found);
        let expected = flattened(expected);
        let largest = expected
            .iter()
            .map(|value| value.norm())
            .fold(0.0, f64::max);
        let differences = found
            .iter()
            .zip(&expected)
            .map(|(found, expected)| (found - expected).norm());
        // `f64::max` would drop a NaN.
        differences.fold(
            0.0,
            |worst: f64, next| if next <= worst { worst } else { next },
        ) / largest
    }

    #[test]
    fn vectors_of_every_length_agree_with_scalars_at_every_remainder_length() {
        for count in 0..=17 {
            let model = model(9, 3, 3);
            let omega = wide(count);
            let scalar = on(Scalar::new(), &model, &omega);
            for vectors in on_vectors(&model, &omega) {
                // Tolerance: two backward stable solutions of order 9, each with rounding errors of
                // at most 9 tau times 1e-16.
                assert!(
                    count == 0 || difference(&vectors, &scalar) < 8e-12,
                    "{count} frequencies"
                );
            }
        }
    }

    #[test]
    fn vectors_of_every_length_give_the_same_bits() {
        for (order, outputs, inputs) in [
            (0, 2, 1),
            (1, 1, 1),
            (2, 6, 4),
            (12, 6, 4),
            (30, 6, 4),
            (17, 3, 5),
            (8, 7, 6),
            (7, 9, 9),
        ] {
            let model = model(order, outputs, inputs);
            let omega = wide(61);
            let results = on_vectors(&model, &omega);
            assert!(
                results.windows(2).all(|pair| pair[0] == pair[1]),
                "order {order}"
            );
        }
    }

    #[test]
    fn values_depend_on_the_frequencies_of_their_group_only() {
        let model = model(14, 6, 4);
        let omega = wide(45);
        let together = on_vectors(&model, &omega);
        for (k, omega) in omega.chunks(GROUP).enumerate() {
            let alone = on_vectors(&model, omega);
            for (alone, together) in alone.iter().zip(&together) {
                let same =
                    |(pair, values): (_, &Vec<_>)| together[pair][k * GROUP..].starts_with(values);
                assert!(alone.iter().all(same), "group {k}");
            }
        }
    }

    #[test]
    fn frequencies_of_a_group_may_need_different_pivots() {
        // Both ends in one group: the real row must be the pivot at 1e-4 rad/s, the complex row at
        // 1e4 rad/s.
        let model = model(14, 6, 4);
        let omega: Vec<f64> = (0..29)
            .map(|k| if k % 2 == 0 { 1e-4 } else { 1e4 } * (1.0 + f64::from(k)))
            .collect();
        let mut results = on_vectors(&model, &omega);
        results.push(on(Scalar::new(), &model, &omega));
        for values in results {
            for (k, omega) in omega.iter().enumerate() {
                let expected = dense(&model, *omega);
                let largest = expected
                    .iter()
                    .map(|value| value.norm())
                    .fold(0.0, f64::max);
                for (pair, values) in values.iter() {
                    let error = (values[k] - expected[(pair.output, pair.input)]).norm();
                    // Tolerance: the bound of threshold pivoting, 3e-11, times the condition number
                    // of a random matrix of order 14.
                    assert!(error < 1e-9 * largest, "{omega}, {pair:?}: {error}");
                }
            }
        }
    }

    #[test]
    fn poles_on_the_grid_leave_other_frequencies_finite() {
        for order in 1..=9 {
            let b = matrix(order, 2, 1.1);
            let c = matrix(3, order, 2.3);
            // All poles at zero; then pairs of poles at 2 rad/s and, for an odd order, a single
            // pole at zero.
            let turning = DMatrix::from_fn(order, order, |row, column| match (row % 2, column) {
                (0, column) if column == row + 1 => 2.0,
                (1, column) if column + 1 == row => -2.0,
                _ => 0.0,
            });
            for (a, omega) in [(DMatrix::zeros(order, order), 0.0), (turning, 2.0)] {
                let model = StateSpace::new(a, b.clone(), c.clone(), DMatrix::zeros(3, 2)).unwrap();
                for frequencies in [vec![omega], vec![1.0, omega, 3.0]] {
                    let mut results = on_vectors(&model, &frequencies);
                    results.push(on(Scalar::new(), &model, &frequencies));
                    let finite = |k: usize| {
                        results
                            .iter()
                            .all(|values| values.iter().all(|(_, curve)| curve[k].is_finite()))
                    };
                    assert!(
                        frequencies.len() == 1 || (finite(0) && finite(2)),
                        "{order} states"
                    );
                }
            }
        }
    }

    #[test]
    fn a_chain_coupled_by_1e_minus_55_neither_overflows_nor_loses_its_coupling() {
        // The inverse coupling is 1e55 per step: without the factor `h` of an interchange, the
        // square of a pivot would overflow in the fifth step.
        let weak = 1e-55;
        let a = DMatrix::from_fn(8, 8, |row, column| match row.abs_diff(column) {
            0 => -1.0,
            1 => weak,
            _ => 0.0,
        });
        let model = StateSpace::new(
            a,
            DMatrix::identity(8, 8),
            DMatrix::identity(8, 8),
            DMatrix::zeros(8, 8),
        )
        .unwrap();
        let mut results = on_vectors(&model, &[0.5, 1.0, 2.0]);
        results.push(on(Scalar::new(), &model, &[0.5, 1.0, 2.0]));
        for values in results {
            for (pair, values) in values.iter() {
                let lag = Complex::new(0.5, -0.5);
                let expected = match pair.output.abs_diff(pair.input) {
                    0 => lag,
                    1 => lag * lag * weak,
                    _ => continue,
                };
                // Tolerance: about a dozen roundings.
                assert!(
                    (values[1] - expected).norm() < 1e-14 * expected.norm(),
                    "{pair:?}: {}",
                    values[1]
                );
            }
        }
    }

    #[test]
    fn a_model_of_two_separate_parts_is_the_sum_of_both() {
        let a = dmatrix![-1.0, 2.0, 0.0, 0.0; -3.0, -0.5, 0.0, 0.0; 0.0, 0.0, -0.2, 4.0; 0.0, 0.0, -5.0, -0.3];
        let b = dmatrix![1.0; 0.5; -1.0; 2.0];
        let c = dmatrix![1.0, -2.0, 0.5, 3.0];
        let part = |at: usize| {
            let a = a.view((at, at), (2, 2));
            let b = b.rows(at, 2);
            let c = c.columns(at, 2);
            StateSpace::new(
                a.into_owned(),
                b.into_owned(),
                c.into_owned(),
                dmatrix![0.0],
            )
            .unwrap()
        };
        let whole = StateSpace::new(a.clone(), b.clone(), c.clone(), dmatrix![0.0]).unwrap();
        let omega = wide(11);
        let first = on(Scalar::new(), &part(0), &omega);
        let second = on(Scalar::new(), &part(2), &omega);
        let sum = first.map(|pair, values| {
            values
                .iter()
                .zip(&second[pair])
                .map(|(a, b)| a + b)
                .collect()
        });
        for values in on_vectors(&whole, &omega) {
            assert!(difference(&values, &sum) < 1e-14);
        }
    }
}
