//! Computes a state-space model's frequency response by eliminating the states from the system
//! matrix.
//!
//! The model is `dx/dt = A x + B u`, `y = C x + D u` with `n` states, and `H(s)` its response at `s
//! = j omega`. ^T denotes the transpose. Step 1 is in `hessenberg_form.rs`, which explains the
//! matrices; the other steps are in `eliminate_group`.
//!
//! ```text
//! 1  once for all frequencies: scale A by 1 / alpha, transform the model and transpose it;
//!    with sigma = s / alpha the system matrix is
//!        [ G - sigma I  K   ]      G (n x n) from A^T, K from C^T, L from B^T
//!        [ L            D^T ]      H^T = D^T - L (G - sigma I)^-1 K
//!    G is real, and zero below its subdiagonal entries h_k, k = 1 ... n - 1;
//!    the first row of L is zero except for its last entry l
//! 2  u <- first row of [G - sigma I, K], the active row; w <- each row of [L D^T] but the first
//! 3  for k = 1 ... n - 1, with r = row k + 1 of [G - sigma I, K], divided by h_k: the next row,
//!    with 1 in column k and otherwise real but for -sigma / h_k in column k + 1;
//!    u_k and w_k are the entries in column k:
//! 4     if |u_k| > tau |h_k| in any of eight neighbouring frequencies,
//!       then in those of the eight with |u_k| > |h_k|:
//!          w <- w - (w_k / u_k) u;   u <- h_k r - (h_k / u_k) u        u clears the column
//! 5     else, and in the other frequencies of the eight:
//!          w <- w - w_k r;           u <- u - u_k r                    r clears the column
//! 6  the last column: w <- w - (w_n / u_n) u, and the first row of [L D^T] likewise, with l
//!    instead of w_n; D^T is now H^T
//! ```
//!
//! Step 5 costs half as much as step 4, because r is real. It is therefore used unless `u_k`
//! exceeds `h_k` by more than the pivot threshold `tau = 2^18 / n` (`pivot_threshold.rs`). The
//! multipliers within G are then at most tau, and since G's rows enter unchanged, entries grow at
//! most by the factor `n tau`.
//!
//! If the model has fewer outputs than inputs, its dual (A^T, C^T, B^T, D^T) takes its place, whose
//! response is H^T. A negligible h_k is replaced by zero, which forces step 4 with an interchange
//! in every frequency (see `pivot_threshold.rs`).
//!
//! Each frequency occupies a lane of a vector register. Hessenberg form: Laub, IEEE Trans.
//! Automatic Control 26(2), 1981; tau is the pivot threshold in Duff, Erisman & Reid, "Direct
//! Methods for Sparse Matrices", 2nd ed. 2017, 5.2.

use nalgebra::Complex;
use pulp::{Arch, Simd, WithSimd};

use super::complex_lanes::ComplexLanes;
use super::frequency_response::FrequencyResponse;
use super::hessenberg_form::HessenbergForm;
use super::pivot_threshold::Subdiagonal;
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
pub(super) const GROUP: usize = 8;

/// Maximum `|sigma|`: beyond it, its square could overflow.
const LARGEST_SHIFT: f64 = 1e150;

impl WithSimd for Elimination<'_> {
    type Output = FrequencyResponse;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> FrequencyResponse {
        let form = self.form;
        let [outputs, inputs] = form.model_shape();
        let mut curves = PairTable::from_fn(outputs, inputs, |_| Vec::with_capacity(self.s.len()));
        // The rows for a frequency group, for `S::F64_LANES` of its frequencies each.
        let mut registers: Vec<ComplexRows<S>> = Vec::new();
        for _ in 0..GROUP / S::F64_LANES {
            registers.push(ComplexRows {
                shift: ComplexLanes::real(simd, 0.0),
                entries: Vec::new(),
            });
        }
        for group in self.s.chunks(GROUP) {
            let shifts = GroupShifts::new(group, form.frequency_scale);
            let registers = &mut registers[..group.len().div_ceil(S::F64_LANES)];
            eliminate_group(simd, form, registers, &shifts);
            append_group(form, registers, group, &mut curves);
        }
        FrequencyResponse::new(curves)
    }
}

/// The values `sigma = s / alpha` for a group, real and imaginary parts separate.
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

/// Eliminates the states for a group: steps 2 to 6. `registers` contains the rows for the group's
/// frequencies, and afterwards their responses.
#[inline(always)]
fn eliminate_group<S: Simd>(
    simd: S,
    form: &HessenbergForm,
    registers: &mut [ComplexRows<S>],
    shifts: &GroupShifts,
) {
    let re = S::as_simd_f64s(&shifts.re).0;
    let im = S::as_simd_f64s(&shifts.im).0;
    for (rows, (re, im)) in registers.iter_mut().zip(re.iter().zip(im)) {
        rows.start(simd, form, ComplexLanes { re: *re, im: *im });
    }
    for column in 0..form.order.saturating_sub(1) {
        let mut needs_interchange = false;
        for rows in &*registers {
            needs_interchange |= rows.needs_interchange(simd, form, column);
        }
        for rows in &mut *registers {
            rows.clear_column(simd, form, column, needs_interchange);
        }
    }
    for rows in registers {
        rows.finish(simd, form);
    }
}

/// Appends a group's values to the curves. A NaN frequency gives NaN, even for a model without
/// states, whose response would otherwise be finite.
#[inline(always)]
fn append_group<S: Simd>(
    form: &HessenbergForm,
    registers: &[ComplexRows<S>],
    group: &[Complex<f64>],
    curves: &mut PairTable<Vec<Complex<f64>>>,
) {
    for output in 0..form.outputs {
        for input in 0..form.inputs {
            let curve = &mut curves[form.pair(input, output)];
            // Row `input` of [L D^T], past the state columns.
            let index = input * form.width() + form.order + output;
            for (lane, s) in group.iter().enumerate() {
                let value = &registers[lane / S::F64_LANES].entries[index];
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
/// all rows of `[L D^T]` except the first. The first row of `[L D^T]` is zero in G's columns except
/// for the last, and is not needed until all other columns are clear: the active row occupies its
/// place, so that rows and responses are numbered alike.
struct ComplexRows<S: Simd> {
    /// `sigma`.
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
        self.entries.reserve(form.initial_rows.len());
        for entry in &form.initial_rows {
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

    /// Clears a column: step 5, or with `needs_interchange` step 4, which swaps the active row and
    /// the next row in the lanes where the active entry is larger.
    #[inline(always)]
    fn clear_column(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        column: usize,
        needs_interchange: bool,
    ) {
        let next = form.next_row(column);
        let subdiagonal = &form.subdiagonals[column];
        let shift = self
            .shift
            .scaled(simd, simd.splat_f64s(subdiagonal.reciprocal));
        let (active, others) = self.entries.split_at_mut(form.width());
        let pivot = active[column];
        let active = &mut active[column + 1..];
        if !needs_interchange {
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

    /// Clears the last column with the active row; the first row of `[L D^T]` then takes its place
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
        let quotient = reciprocal.scaled(simd, simd.splat_f64s(form.first_l_entry));
        for (entry, feed_through) in active.iter_mut().zip(&form.feed_through) {
            *entry = ComplexLanes::real(simd, *feed_through).minus_product(simd, quotient, *entry);
        }
    }
}

/// Subtracts `multiplier r` from a row, right of the cleared column; this takes most of the time.
/// `next` is the real part of r, and `-shift` is the rest of its first entry.
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

/// Step 4 in a column: in the lanes with `|u_k| > |h_k|`, `u` clears the column and the next row
/// becomes active; in the other lanes, `r` clears it as in step 5. With the symbols of the steps,
/// the rows become in the former lanes
///
/// ```text
/// active row:  h_k r - (h_k / u_k) u
/// other rows:  w - (w_k / u_k) u
/// ```
///
/// Both kinds of lanes take the same two operations: subtract a *quotient* times `u` (from zero for
/// the active row itself), then a *multiplier* times `r`.
///
/// The new active row contains `h_k r`, not `r`. Otherwise a chain of weak couplings would enlarge
/// the pivots by `1 / h_k` at each interchange, until their squares overflow.
struct Interchange<S: Simd> {
    /// Lanes in which the rows are interchanged.
    lanes: S::m64s,
    /// `1 / u_k`.
    reciprocal: ComplexLanes<S>,
}

impl<S: Simd> Interchange<S> {
    /// Selects the lanes with `|u_k| > |h_k|`; `pivot` is `u_k`.
    #[inline(always)]
    fn new(simd: S, subdiagonal: &Subdiagonal, pivot: ComplexLanes<S>) -> Self {
        let lanes = simd.greater_than_f64s(pivot.square(simd), simd.splat_f64s(subdiagonal.square));
        Self {
            lanes,
            reciprocal: pivot.reciprocal(simd),
        }
    }

    /// Returns quotient and multiplier for a row with `entry` `w_k`: `w_k / u_k` and zero in the
    /// selected lanes, zero and `w_k` in the others.
    #[inline(always)]
    fn factors(&self, simd: S, entry: ComplexLanes<S>) -> [ComplexLanes<S>; 2] {
        let zero = ComplexLanes::real(simd, 0.0);
        let quotient = zero.replaced_where(simd, self.lanes, entry.product(simd, self.reciprocal));
        [quotient, entry.replaced_where(simd, self.lanes, zero)]
    }

    /// Returns quotient and multiplier for the active row: `h_k / u_k` and `-h_k` in the selected
    /// lanes, -1 and `u_k` in the others. For a negligible `h_k` they are zero and -1 in the
    /// selected lanes: the next row, which is then stored undivided, becomes the active row.
    #[inline(always)]
    fn active_factors(
        &self,
        simd: S,
        subdiagonal: &Subdiagonal,
        pivot: ComplexLanes<S>,
    ) -> [ComplexLanes<S>; 2] {
        // If `h_k` is zero, set the quotient to zero without division by the pivot, which may be
        // zero too.
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
