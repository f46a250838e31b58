//! Gaussian elimination of an upper Hessenberg matrix shifted by many frequencies at once.

use pulp::Simd;

use super::active_row::{ActiveRow, Base, PANEL, Panel, panel_at_mut};
use super::complex_lanes::{ComplexLanes, any};
use super::hessenberg_form::HessenbergForm;

/// How many times larger than the real row's pivot that of the complex row must be to be preferred (tau).
///
/// With 1 this is partial pivoting. Real rows halve the work of back-substitution, and are not stored; they cost at
/// most this factor in accuracy (see [`Elimination`]): `n tau` times the unit roundoff of 1.1e-16 is 3e-11 for 60
/// states. From 2^6 to 2^12 the error of the model of 60 states in `benches/responses.rs` grows from 2e-14 to 6e-13 of
/// its largest value.
const PREFERENCE_FOR_REAL: f64 = 4096.0;

/// An active row that has gathered a larger scale is multiplied by [`SHRINKING`], long before squares overflow.
const LARGE: f64 = 1e50;

/// 2^-166, about 1 / [`LARGE`]: a power of two, so that nothing is rounded.
const SHRINKING: f64 = 1.0 / ((1_u128 << 83) as f64 * (1_u128 << 83) as f64);

/// The upper triangle that row operations make of `[F - j omega I, B]`, one frequency to a lane.
///
/// Column k is cleared by combining the one complex *active* row `u` (what the rows above have become) with the next
/// row `r`, which is real but for its diagonal entry:
///
/// ```text
/// u' = u - h r,   h = u_k / r_k,   r_k = F_(k+1,k) real
/// ```
///
/// 2 fused operations an entry, n^2 + 2 n m in all. Rows may be scaled at will, so the same `u'` serves whichever of
/// `u` and `r` is the pivot row: `r - u / h` is `-u' / h`, with the same relative rounding errors. Pivoting only
/// chooses which of the two stays in the triangle, in each lane for itself: `r`, unless `|u_k| > tau s |r_k|`, where
/// `s` is the scale that `u` has gathered. This is threshold pivoting (Duff, Erisman & Reid, "Direct Methods for Sparse
/// Matrices", 2nd ed. 2017, 5.2): multipliers are at most tau; and since each row enters as it is, entries grow at most
/// to `n tau` times the largest.
pub struct Elimination<S: Simd> {
    active: ActiveRow<S>,
    /// By how much the active row is larger than partial pivoting would have left it.
    scale: S::f64s,
    /// Complex rows, each from the first column of a panel on; one over the diagonal entry is in its place.
    stored: Vec<ComplexLanes<S>>,
    /// Where the next one goes.
    end: usize,
    /// The row that stays in the triangle for each column.
    kept: Vec<Kept>,
}

/// Which row stays in the triangle.
#[derive(Clone, Copy)]
enum Kept {
    /// The next row in all lanes.
    Next,
    /// The active row, or what each lane has chosen; its diagonal is stored here.
    Stored(usize),
}

/// A row of the triangle: one over its diagonal entry, and its entries right of that with the right-hand sides at the
/// end.
pub enum TriangleRow<'a, S: Simd> {
    /// Of `[F B]`; the first entry has `-j omega` besides.
    Real(f64, &'a [f64]),
    /// Any other.
    Complex(ComplexLanes<S>, &'a [ComplexLanes<S>]),
}

impl<S: Simd> Elimination<S> {
    /// Room for a model; that for complex rows is made as they come.
    #[inline(always)]
    pub fn with_room_for(simd: S, form: &HessenbergForm) -> Self {
        Self {
            active: ActiveRow::with_room_for(simd, form),
            scale: simd.splat_f64s(1.0),
            stored: Vec::new(),
            end: 0,
            kept: vec![Kept::Next; form.order()],
        }
    }

    /// The frequencies \[rad/s / alpha\].
    #[inline(always)]
    pub fn omega(&self) -> S::f64s {
        self.active.omega()
    }

    /// A row of the triangle.
    #[inline(always)]
    pub fn row<'a>(&'a self, form: &'a HessenbergForm, row: usize) -> TriangleRow<'a, S> {
        let end = form.order() + form.sides();
        match self.kept[row] {
            Kept::Next => TriangleRow::Real(form.reciprocals()[row], &form.row(row + 1)[row + 1..end]),
            Kept::Stored(diagonal) => {
                let row = &self.stored[diagonal..diagonal + end - row];
                TriangleRow::Complex(row[0], &row[1..])
            }
        }
    }

    /// Eliminates at the frequencies `omega` \[rad/s / alpha\].
    #[inline(always)]
    pub fn run(&mut self, simd: S, form: &HessenbergForm, omega: S::f64s) {
        self.active.start(omega);
        self.scale = simd.splat_f64s(1.0);
        self.end = 0;
        let Some(last) = form.order().checked_sub(1) else {
            return;
        };
        for first in (0..=last).step_by(PANEL) {
            let mut panel = self.active.panel(simd, form, &self.stored, first, first);
            if !self.clear_panel(simd, form, first, &mut panel) {
                for column in first..last.min(first + PANEL) {
                    self.clear(simd, form, first, column, &mut panel);
                }
            }
            if last - first < PANEL {
                self.keep_active(simd, form, first, last, &panel);
            }
        }
    }

    /// Clears the columns of a panel if the next row stays in each of them, in all lanes; else returns `false`.
    #[inline(always)]
    fn clear_panel(&mut self, simd: S, form: &HessenbergForm, first: usize, panel: &mut Panel<S>) -> bool {
        let columns = PANEL.min(form.order() - 1 - first);
        let reciprocals = &form.reciprocals()[first..first + columns];
        let limit = simd.mul_f64s(simd.splat_f64s(PREFERENCE_FOR_REAL), self.scale);
        let mut entries = *panel;
        let mut exceeded = simd.greater_than_f64s(limit, limit);
        for offset in 0..PANEL {
            if offset >= columns {
                break;
            }
            let multiplier = entries[offset].scaled(simd, simd.splat_f64s(reciprocals[offset]));
            exceeded = simd.or_m64s(exceeded, simd.greater_than_f64s(multiplier.magnitude(simd), limit));
            self.active.push(first + offset, multiplier);
            self.active.subtract_next(simd, form, first, first + offset, multiplier, &mut entries);
        }
        if any(simd, exceeded) || reciprocals.contains(&0.0) {
            return false;
        }
        self.kept[first..first + columns].fill(Kept::Next);
        *panel = entries;
        true
    }

    /// Clears what stands below the diagonal in one column of a panel.
    #[inline(always)]
    fn clear(&mut self, simd: S, form: &HessenbergForm, first: usize, column: usize, panel: &mut Panel<S>) {
        let reciprocal = form.reciprocals()[column];
        if reciprocal == 0.0 {
            // The model falls in two parts, of which the second begins with the next row.
            self.keep_active(simd, form, first, column, panel);
            self.active.restart(Base::Real(column + 1), column + 1);
            self.scale = simd.splat_f64s(1.0);
            *panel = self.active.panel(simd, form, &self.stored, first, column + 1);
            return;
        }
        let mut multiplier = panel[column - first].scaled(simd, simd.splat_f64s(reciprocal));
        let size = multiplier.magnitude(simd);
        let limit = simd.mul_f64s(simd.splat_f64s(PREFERENCE_FOR_REAL), self.scale);
        self.kept[column] = Kept::Next;
        if any(simd, simd.greater_than_f64s(size, limit)) {
            let next_stays = simd.less_than_or_equal_f64s(size, limit);
            self.scale = simd.select_f64s(next_stays, self.scale, size);
            let start = self.store(simd, form, first, column, panel);
            if any(simd, simd.greater_than_f64s(size, simd.splat_f64s(LARGE))) {
                multiplier = multiplier.scaled(simd, self.shrink(simd, start, panel));
            }
            let diagonal = start + column - first;
            self.kept[column] = Kept::Stored(diagonal);
            self.stored[diagonal] = panel[column - first].reciprocal(simd);
            let base = if any(simd, next_stays) {
                self.put_next(simd, form, start, diagonal, column, next_stays)
            } else {
                start
            };
            self.active.restart(Base::Stored { start: base, column: first }, column);
        }
        self.active.push(column, multiplier);
        self.active.subtract_next(simd, form, first, column, multiplier, panel);
    }

    /// Keeps the active row in the triangle for a column that needs no clearing.
    #[inline(always)]
    fn keep_active(&mut self, simd: S, form: &HessenbergForm, first: usize, column: usize, panel: &Panel<S>) {
        let diagonal = self.store(simd, form, first, column, panel) + column - first;
        self.stored[diagonal] = panel[column - first].reciprocal(simd);
        self.kept[column] = Kept::Stored(diagonal);
    }

    /// Puts the next row in the place of the stored active row, in the lanes of a mask; returns where a copy of the
    /// latter is.
    #[inline(always)]
    fn put_next(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        start: usize,
        diagonal: usize,
        column: usize,
        mask: S::m64s,
    ) -> usize {
        let copy = self.end;
        self.reserve(simd, copy - start);
        self.stored.copy_within(start..copy, copy);
        let reciprocal = ComplexLanes::real(simd, form.reciprocals()[column]);
        self.stored[diagonal] = self.stored[diagonal].replaced_where(simd, mask, reciprocal);
        let omega = self.omega();
        let row = &mut self.stored[diagonal + 1..copy];
        for (entry, real) in row.iter_mut().zip(&form.row(column + 1)[column + 1..]) {
            *entry = entry.replaced_where(simd, mask, ComplexLanes::real(simd, *real));
        }
        row[0].im = simd.select_f64s(mask, simd.neg_f64s(omega), row[0].im);
        copy
    }

    /// Takes room for so many more entries.
    #[inline(always)]
    fn reserve(&mut self, simd: S, entries: usize) {
        self.end += entries;
        if self.stored.len() < self.end {
            self.stored.resize(self.end, ComplexLanes::real(simd, 0.0));
        }
    }

    /// Stores the active row from column `first` on, of which `panel` is the beginning; returns where.
    #[inline(always)]
    fn store(&mut self, simd: S, form: &HessenbergForm, first: usize, column: usize, panel: &Panel<S>) -> usize {
        let (start, width) = (self.end, form.order() + form.sides() - first);
        self.reserve(simd, width.next_multiple_of(PANEL));
        *panel_at_mut(&mut self.stored, start) = *panel;
        for offset in (PANEL..width).step_by(PANEL) {
            let panel = self.active.panel(simd, form, &self.stored, first + offset, column);
            *panel_at_mut(&mut self.stored, start + offset) = panel;
        }
        start
    }

    /// Multiplies the active row, stored from `start` on, by [`SHRINKING`] in the lanes where its scale is large;
    /// returns the factors.
    #[inline(always)]
    fn shrink(&mut self, simd: S, start: usize, panel: &mut Panel<S>) -> S::f64s {
        let large = simd.greater_than_f64s(self.scale, simd.splat_f64s(LARGE));
        let factors = simd.select_f64s(large, simd.splat_f64s(SHRINKING), simd.splat_f64s(1.0));
        for entry in self.stored[start..self.end].iter_mut().chain(panel) {
            *entry = entry.scaled(simd, factors);
        }
        self.scale = simd.mul_f64s(self.scale, factors);
        factors
    }
}
