//! Gaussian elimination of an upper Hessenberg matrix shifted by many frequencies at once.

use std::ops::Range;

use pulp::Simd;

use super::active_row::{Across, ActiveRow, Panel};
use super::complex_lanes::{ComplexLanes, any, filled};
use super::hessenberg_form::{HessenbergForm, PANEL};

/// Frequencies that choose their pivots together, whatever the length of a vector.
pub const GROUP: usize = 16;

/// The upper triangle that row operations make of `[F - j omega I, B]`, one frequency to a lane.
///
/// Column k is cleared by combining the one complex *active* row `u` (what the rows above have become) with the next
/// row `r`, which is real but for its diagonal entry: `u - m r`, `m = u_k / r_k`. That takes 2 fused operations an entry,
/// n^2 + 2 n m in all. Then one of `u` and `r` stays in the triangle: `r`, unless in some lane of the group `|u_k| > tau
/// |r_k|`. If so, both are interchanged in all lanes where `|u_k| > |r_k|`, which for neighbouring frequencies are nearly
/// always all: the row that each lane keeps is of one kind. This is threshold pivoting (Duff, Erisman & Reid, "Direct
/// Methods for Sparse Matrices", 2nd ed. 2017, 5.2): multipliers are at most tau; and since each row enters as it is,
/// entries grow at most to `n tau` times the largest.
///
/// A panel of columns is cleared as if no row were interchanged, in all vectors of the group; where that is found not to
/// hold, it is cleared again column by column; and where that was so in the last group, only so. Both ways give the same
/// bits. `V` vectors share what is read of F.
pub struct Elimination<S: Simd, const V: usize> {
    rows: Vec<ActiveRow<S, V>>,
    /// How many of them are in use.
    used: usize,
    /// The panel that is being cleared, of each.
    panels: Vec<Panel<S, V>>,
    /// The last panel, cleared as if no row were interchanged.
    cleared: Vec<Panel<S, V>>,
    interchanges: usize,
    /// Whether the last group had interchanges in each panel, as the next then mostly has.
    expected: Vec<bool>,
    /// The row that stays in the triangle for each column but the last.
    kept: Vec<Kept>,
    /// The right-hand sides of the last row of the triangle, divided by its diagonal entry.
    last: Vec<Across<S, V>>,
}

/// Which row stays in the triangle.
#[derive(Clone, Copy)]
enum Kept {
    /// The next row in all lanes.
    Next,
    /// What the interchange of an index left.
    Stored(usize),
}

/// A row of the triangle in `V` vectors: its entries from the diagonal on, the first of which is one over the diagonal
/// entry, and its right-hand sides.
pub type ComplexRow<'a, S, const V: usize> = (&'a [Across<S, V>], &'a [Across<S, V>]);

impl<S: Simd, const V: usize> Elimination<S, V> {
    /// Room for a model; that for complex rows is made as they come.
    #[inline(always)]
    pub fn with_room_for(simd: S, form: &HessenbergForm) -> Self {
        let zero = [ComplexLanes::real(simd, 0.0); V];
        let count = GROUP / S::F64_LANES / V;
        let mut rows = Vec::with_capacity(count);
        for _ in 0..count {
            rows.push(ActiveRow::with_room_for(simd, form));
        }
        Self {
            rows,
            used: 0,
            panels: filled([zero; PANEL], count),
            cleared: filled([zero; PANEL], count),
            interchanges: 0,
            expected: vec![false; form.panels()],
            kept: filled(Kept::Next, form.subdiagonals().len()),
            last: filled(zero, count * form.sides()),
        }
    }

    /// The frequencies of a vector of the group \[rad/s / alpha\].
    #[inline(always)]
    pub fn omega(&self, vector: usize) -> S::f64s {
        self.rows[vector / V].omega(vector % V)
    }

    /// Whether rows of the triangle are those of F and B in all lanes.
    #[inline(always)]
    pub fn are_real(&self, rows: Range<usize>) -> bool {
        self.kept[rows].iter().all(|kept| matches!(kept, Kept::Next))
    }

    /// A row of the triangle that is complex, in the vectors beside `vector`; empty for one that is real.
    #[inline(always)]
    pub fn complex_row(&self, form: &HessenbergForm, vector: usize, row: usize) -> ComplexRow<'_, S, V> {
        let Kept::Stored(interchange) = self.kept[row] else { return (&[], &[]) };
        let (entries, sides) = self.rows[vector / V].stored(interchange).split_at(form.order());
        (&entries[row..], sides)
    }

    /// The last unknown for one right-hand side, in one vector.
    #[inline(always)]
    pub fn last(&self, form: &HessenbergForm, vector: usize, side: usize) -> ComplexLanes<S> {
        self.last[vector / V * form.sides() + side][vector % V]
    }

    /// Eliminates at the frequencies `omega` of a group \[rad/s / alpha\].
    #[inline(always)]
    pub fn run(&mut self, simd: S, form: &HessenbergForm, omega: &[S::f64s]) {
        self.start(simd, omega);
        let Some(last) = form.order().checked_sub(1) else { return };
        for first in (0..=last).step_by(PANEL) {
            let columns = PANEL.min(last - first);
            self.kept[first..first + columns].fill(Kept::Next);
            let before = self.interchanges;
            if self.expected[first / PANEL] {
                self.compute(simd, form, first);
                self.clear_with_interchanges(simd, form, first, columns);
            } else if !self.clear(simd, form, first, columns) {
                self.clear_with_interchanges(simd, form, first, columns);
            } else if columns < PANEL {
                self.panels.copy_from_slice(&self.cleared);
            }
            self.expected[first / PANEL] = self.interchanges > before;
        }
        self.finish(simd, form, last);
    }

    #[inline(always)]
    fn start(&mut self, simd: S, omega: &[S::f64s]) {
        self.used = omega.len().div_ceil(V);
        self.interchanges = 0;
        for (row, omega) in self.rows.iter_mut().zip(omega.chunks(V)) {
            // A vector too many repeats the last.
            let mut all = [omega.last().copied().unwrap_or(simd.splat_f64s(0.0)); V];
            all[..omega.len()].copy_from_slice(omega);
            row.start(all);
        }
    }

    /// Computes the panel that begins in column `first`, before any of its columns is cleared.
    #[inline(always)]
    fn compute(&mut self, simd: S, form: &HessenbergForm, first: usize) {
        for (row, panel) in self.rows[..self.used].iter_mut().zip(&mut self.panels) {
            *panel = row.panel(simd, form, first, first);
        }
    }

    /// Computes the panel that begins in column `first` and clears columns of it as if no row were interchanged; whether that
    /// is so.
    #[inline(always)]
    fn clear(&mut self, simd: S, form: &HessenbergForm, first: usize, columns: usize) -> bool {
        let one = simd.splat_f64s(1.0);
        let mut stays = simd.less_than_or_equal_f64s(one, one);
        let places = self.panels.iter_mut().zip(&mut self.cleared);
        for (row, (before, cleared)) in self.rows[..self.used].iter_mut().zip(places) {
            let mut panel = row.panel(simd, form, first, first);
            *before = panel;
            for excess in &row.clear(simd, form, first, columns, &mut panel) {
                stays = simd.and_m64s(stays, simd.less_than_or_equal_f64s(*excess, one));
            }
            if columns < PANEL {
                *cleared = panel;
            }
        }
        !any(simd, simd.not_m64s(stays))
    }

    /// Clears columns one by one.
    #[inline(always)]
    fn clear_with_interchanges(&mut self, simd: S, form: &HessenbergForm, first: usize, columns: usize) {
        if columns > 0 {
            self.clear_one::<0>(simd, form, first);
        }
        if columns > 1 {
            self.clear_one::<1>(simd, form, first);
        }
        if columns > 2 {
            self.clear_one::<2>(simd, form, first);
        }
        if columns > 3 {
            self.clear_one::<3>(simd, form, first);
        }
    }

    #[inline(always)]
    fn clear_one<const OFFSET: usize>(&mut self, simd: S, form: &HessenbergForm, first: usize) {
        let interchange = !self.next_stays::<OFFSET>(simd, form, first);
        if interchange {
            self.kept[first + OFFSET] = Kept::Stored(self.interchanges);
            self.interchanges += 1;
        }
        for (row, panel) in self.rows[..self.used].iter_mut().zip(&mut self.panels) {
            let multipliers =
                if interchange { row.interchange::<OFFSET>(simd, form, first, panel) } else { panel[OFFSET] };
            row.subtract_next::<OFFSET>(simd, form, first, multipliers, panel);
        }
    }

    /// Whether `|u_k| <= tau |h|` in all lanes.
    #[inline(always)]
    fn next_stays<const OFFSET: usize>(&self, simd: S, form: &HessenbergForm, first: usize) -> bool {
        let one = simd.splat_f64s(1.0);
        let sensitivity = simd.splat_f64s(form.subdiagonals()[first + OFFSET].sensitivity);
        let mut stays = simd.less_than_or_equal_f64s(one, one);
        for panel in &self.panels[..self.used] {
            for entry in &panel[OFFSET] {
                let excess = simd.mul_f64s(entry.square(simd), sensitivity);
                stays = simd.and_m64s(stays, simd.less_than_or_equal_f64s(excess, one));
            }
        }
        !any(simd, simd.not_m64s(stays))
    }

    /// Divides the right-hand sides of the last row by its diagonal entry; its panel has all other columns clear.
    #[inline(always)]
    fn finish(&mut self, simd: S, form: &HessenbergForm, last: usize) {
        let (order, sides) = (form.order(), form.sides());
        let first_panel = last / PANEL * PANEL;
        for (index, row) in self.rows[..self.used].iter_mut().enumerate() {
            let mut reciprocals = self.panels[index][last - first_panel];
            for reciprocal in &mut reciprocals {
                *reciprocal = reciprocal.reciprocal(simd);
            }
            let into = &mut self.last[index * sides..(index + 1) * sides];
            for first in (first_panel..order + sides).step_by(PANEL) {
                let panel = if first == first_panel { self.panels[index] } else { row.panel(simd, form, first, last) };
                for (column, entry) in (first..).zip(&panel) {
                    let side = column.checked_sub(order).and_then(|side| into.get_mut(side));
                    let Some(into) = side else { continue };
                    for vector in 0..V {
                        into[vector] = entry[vector].product(simd, reciprocals[vector]);
                    }
                }
            }
        }
    }
}
