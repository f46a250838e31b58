//! Gaussian elimination of an upper Hessenberg matrix shifted by many frequencies at once.

use pulp::Simd;

use super::complex_lanes::ComplexLanes;
use super::hessenberg_form::HessenbergForm;

/// How many times larger than the real row's pivot that of the complex row must be to be preferred (tau).
///
/// With 1 this is partial pivoting. A real row halves the work of back-substitution, and costs at most this factor in
/// accuracy (see [`Elimination`]).
const PREFERENCE_FOR_REAL: f64 = 64.0;

/// An active row that has gathered a larger scale is multiplied by [`SHRINKING`], long before squares overflow.
const LARGE: f64 = 1e50;

/// 2^-166, about 1 / [`LARGE`]: a power of two, so that nothing is rounded.
const SHRINKING: f64 = 1.0 / ((1_u128 << 83) as f64 * (1_u128 << 83) as f64);

/// The upper triangle that row operations make of `[F - j omega I, B]`, one frequency to a lane.
///
/// Column k is cleared by combining the one complex *active* row `u` (what the rows above have become) with the next row
/// `r`, which is real but for its diagonal entry:
///
/// ```text
/// u' = u - h r,   h = u_k / r_k,   r_k = F_(k+1,k) real
/// ```
///
/// 2 fused operations an entry, n^2 + 2 n m in all. Rows may be scaled at will, so the same `u'` serves whichever of `u` and
/// `r` is the pivot row: `r - u / h` is `-u' / h`, with the same relative rounding errors. Pivoting only chooses which of the
/// two stays in the triangle, in each lane for itself: `r`, unless `|u_k| > tau s |r_k|`, where `s` is the scale that `u`
/// has gathered. This is threshold pivoting (Duff, Erisman & Reid, "Direct Methods for Sparse Matrices", 2nd ed. 2017, 5.2):
/// multipliers are at most tau; and since each row enters as it is, entries grow at most to `n tau` times the largest.
pub struct Elimination<S: Simd> {
    omega: S::f64s,
    /// Active rows from the diagonal on. One that stays in no lane is overwritten by the next: the rest fits the cache.
    rows: Vec<ComplexLanes<S>>,
    pivots: Vec<Pivot<S>>,
}

/// The row that stays in the triangle for one column.
#[derive(Clone, Copy)]
struct Pivot<S: Simd> {
    kept: Kept,
    /// Where the active row starts.
    start: usize,
    /// One over the diagonal entry.
    reciprocal: ComplexLanes<S>,
}

/// Which row stays in the triangle.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kept {
    /// The next row in all lanes.
    Next,
    /// The active row, or what each lane has chosen, put in its place.
    Active,
}

/// A row of the triangle.
pub enum TriangleRow<'a, S: Simd> {
    /// Row of `[F B]` right of the diagonal; the first of its entries has `-j omega` besides.
    Real(&'a [f64]),
    /// Its entries right of the diagonal.
    Complex(&'a [ComplexLanes<S>]),
}

/// What a step needs first of the active row, kept in registers.
struct Head<S: Simd> {
    diagonal: ComplexLanes<S>,
    /// By how much the row is larger than partial pivoting would have left it.
    scale: S::f64s,
}

impl<S: Simd> Elimination<S> {
    /// Room for a model.
    #[inline(always)]
    pub fn with_room_for(simd: S, form: &HessenbergForm) -> Self {
        let (order, sides) = (form.order(), form.sides());
        let zero = ComplexLanes::real(simd, 0.0);
        let pivot = Pivot { kept: Kept::Active, start: 0, reciprocal: zero };
        Self { omega: zero.re, rows: vec![zero; order * (order + 1) / 2 + order * sides], pivots: vec![pivot; order] }
    }

    /// The frequencies \[rad/s / alpha\].
    #[inline(always)]
    pub fn omega(&self) -> S::f64s {
        self.omega
    }

    /// One over the diagonal entry of a row.
    #[inline(always)]
    pub fn reciprocal(&self, row: usize) -> ComplexLanes<S> {
        self.pivots[row].reciprocal
    }

    /// A row of the triangle, with its right-hand sides at the end.
    #[inline(always)]
    pub fn row<'a>(&'a self, form: &'a HessenbergForm, row: usize) -> TriangleRow<'a, S> {
        let Pivot { kept, start, .. } = self.pivots[row];
        match kept {
            Kept::Next => TriangleRow::Real(form.row_from_diagonal(row + 1)),
            Kept::Active => {
                let end = start + form.order() + form.sides() - row;
                TriangleRow::Complex(&self.rows[start + 1..end])
            }
        }
    }

    /// Eliminates at the frequencies `omega` \[rad/s / alpha\].
    #[inline(always)]
    pub fn run(&mut self, simd: S, form: &HessenbergForm, omega: S::f64s) {
        self.omega = omega;
        let Some(last) = form.order().checked_sub(1) else {
            return;
        };
        let mut head = load(simd, form.row_from_diagonal(0), omega, &mut self.rows);
        self.pivots[0].start = 0;
        for column in 0..last {
            head = self.clear(simd, form, column, head);
        }
        self.pivots[last].kept = Kept::Active;
        self.pivots[last].reciprocal = head.diagonal.reciprocal(simd);
    }

    /// Clears what stands below the diagonal in one column; returns the head of the new active row.
    #[inline(always)]
    fn clear(&mut self, simd: S, form: &HessenbergForm, column: usize, mut head: Head<S>) -> Head<S> {
        let next = form.row_from_diagonal(column + 1);
        let start = self.pivots[column].start;
        let (active, below) = self.rows[start..].split_at_mut(next.len() + 1);
        let Some(reciprocal) = form.subdiagonal_reciprocal(column) else {
            // The next row has nothing to clear: the model falls in two parts.
            self.pivots[column].keep_active(head.diagonal.reciprocal(simd));
            self.pivots[column + 1].start = start + active.len();
            return load(simd, next, self.omega, below);
        };
        let real = ComplexLanes::real(simd, reciprocal);
        let mut multiplier = head.diagonal.scaled(simd, real.re);
        let size = multiplier.magnitude(simd);
        let limit = simd.mul_f64s(simd.splat_f64s(PREFERENCE_FOR_REAL), head.scale);
        if !any(simd, simd.greater_than_f64s(size, limit)) {
            self.pivots[column] = Pivot { kept: Kept::Next, start, reciprocal: real };
            self.pivots[column + 1].start = start + 1;
            head.diagonal = combine_in_place(simd, &mut active[1..], multiplier, next, self.omega);
            return head;
        }
        let next_stays = simd.less_than_or_equal_f64s(size, limit);
        head.scale = simd.select_f64s(next_stays, head.scale, size);
        if any(simd, simd.greater_than_f64s(size, simd.splat_f64s(LARGE))) {
            let factors = head.shrink(simd, active);
            multiplier = multiplier.scaled(simd, factors);
        }
        let inverse = active[0].reciprocal(simd);
        self.pivots[column].keep_active(inverse.replaced_where(simd, next_stays, real));
        self.pivots[column + 1].start = start + active.len();
        head.diagonal = combine(simd, &active[1..], multiplier, next, self.omega, below);
        if any(simd, next_stays) {
            replace_where(simd, next_stays, &mut active[1..], next, self.omega);
        }
        head
    }
}

impl<S: Simd> Pivot<S> {
    #[inline(always)]
    fn keep_active(&mut self, reciprocal: ComplexLanes<S>) {
        self.kept = Kept::Active;
        self.reciprocal = reciprocal;
    }
}

impl<S: Simd> Head<S> {
    /// Multiplies the row by [`SHRINKING`] in the lanes where its scale is large; returns the factors.
    #[inline(always)]
    fn shrink(&mut self, simd: S, row: &mut [ComplexLanes<S>]) -> S::f64s {
        let large = simd.greater_than_f64s(self.scale, simd.splat_f64s(LARGE));
        let factors = simd.select_f64s(large, simd.splat_f64s(SHRINKING), simd.splat_f64s(1.0));
        for entry in row {
            *entry = entry.scaled(simd, factors);
        }
        self.scale = simd.mul_f64s(self.scale, factors);
        factors
    }
}

/// `row - j omega e_1` as the active row.
#[inline(always)]
fn load<S: Simd>(simd: S, row: &[f64], omega: S::f64s, into: &mut [ComplexLanes<S>]) -> Head<S> {
    for (entry, real) in into.iter_mut().zip(row) {
        *entry = ComplexLanes::real(simd, *real);
    }
    into[0].im = simd.neg_f64s(omega);
    Head { diagonal: into[0], scale: simd.splat_f64s(1.0) }
}

/// `cleared = active - multiplier (next - j omega e_1)`; returns the first entry.
#[inline(always)]
fn combine<S: Simd>(
    simd: S,
    active: &[ComplexLanes<S>],
    multiplier: ComplexLanes<S>,
    next: &[f64],
    omega: S::f64s,
    cleared: &mut [ComplexLanes<S>],
) -> ComplexLanes<S> {
    let first = active[0].minus_real_product(simd, multiplier, simd.splat_f64s(next[0]));
    let first = first.plus_imaginary_product(simd, multiplier, omega);
    cleared[0] = first;
    for ((cleared, active), real) in cleared[1..].iter_mut().zip(&active[1..]).zip(&next[1..]) {
        *cleared = active.minus_real_product(simd, multiplier, simd.splat_f64s(*real));
    }
    first
}

/// [`combine`], over the active row itself.
#[inline(always)]
fn combine_in_place<S: Simd>(
    simd: S,
    active: &mut [ComplexLanes<S>],
    multiplier: ComplexLanes<S>,
    next: &[f64],
    omega: S::f64s,
) -> ComplexLanes<S> {
    let first = active[0].minus_real_product(simd, multiplier, simd.splat_f64s(next[0]));
    let first = first.plus_imaginary_product(simd, multiplier, omega);
    active[0] = first;
    for (active, real) in active[1..].iter_mut().zip(&next[1..]) {
        *active = active.minus_real_product(simd, multiplier, simd.splat_f64s(*real));
    }
    first
}

/// Puts `next - j omega e_1` in the place of the active row, in the lanes of a mask.
#[inline(always)]
fn replace_where<S: Simd>(simd: S, mask: S::m64s, active: &mut [ComplexLanes<S>], next: &[f64], omega: S::f64s) {
    for (entry, real) in active.iter_mut().zip(next) {
        *entry = entry.replaced_where(simd, mask, ComplexLanes::real(simd, *real));
    }
    active[0].im = simd.select_f64s(mask, simd.neg_f64s(omega), active[0].im);
}

/// Whether a mask holds in any lane.
#[inline(always)]
fn any<S: Simd>(simd: S, mask: S::m64s) -> bool {
    simd.first_true_m64s(mask) < S::F64_LANES
}
