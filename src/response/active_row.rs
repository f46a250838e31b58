//! The one complex row of an elimination.

use pulp::Simd;

use super::complex_lanes::ComplexLanes;
use super::hessenberg_form::HessenbergForm;

/// Columns that are computed at once.
pub const PANEL: usize = 4;

/// Entries of neighbouring columns.
pub type Panel<S> = [ComplexLanes<S>; PANEL];

/// What the rows above a column have become: a base row less multiples of the real rows since.
///
/// ```text
/// u = base - sum over i of h_i (r_(i+1) - j omega e_(i+1))
/// ```
///
/// Only the multipliers are written at every column. Entries are computed where they are needed, a panel of columns at
/// a time in registers, always in the order of i: so their bits do not depend on when that is.
pub struct ActiveRow<S: Simd> {
    omega: S::f64s,
    base: Base,
    /// The column of the first multiplier that the base does not have in it.
    pending: usize,
    /// `h`, one for each column.
    multipliers: Vec<ComplexLanes<S>>,
}

/// What the multiples are subtracted from.
#[derive(Clone, Copy)]
pub enum Base {
    /// A row of `[F - j omega I, B]`.
    Real(usize),
    /// A stored row that begins in a column.
    Stored {
        /// Where its first entry is.
        start: usize,
        /// The column of that.
        column: usize,
    },
}

impl<S: Simd> ActiveRow<S> {
    /// Room for a model.
    #[inline(always)]
    pub fn with_room_for(simd: S, form: &HessenbergForm) -> Self {
        let zero = ComplexLanes::real(simd, 0.0);
        Self { omega: zero.re, base: Base::Real(0), pending: 0, multipliers: vec![zero; form.order()] }
    }

    /// The frequencies \[rad/s / alpha\].
    #[inline(always)]
    pub fn omega(&self) -> S::f64s {
        self.omega
    }

    /// Starts with the first row at other frequencies.
    #[inline(always)]
    pub fn start(&mut self, omega: S::f64s) {
        self.omega = omega;
        self.restart(Base::Real(0), 0);
    }

    /// Continues from a base that has all multiples in it from the columns before `column`.
    #[inline(always)]
    pub fn restart(&mut self, base: Base, column: usize) {
        self.base = base;
        self.pending = column;
    }

    /// Takes the multiplier that clears a column.
    #[inline(always)]
    pub fn push(&mut self, column: usize, multiplier: ComplexLanes<S>) {
        self.multipliers[column] = multiplier;
    }

    /// Subtracts the multiple of the next row that clears `column` from what follows in the panel that begins in column
    /// `first`.
    #[inline(always)]
    pub fn subtract_next(
        &self,
        simd: S,
        form: &HessenbergForm,
        first: usize,
        column: usize,
        multiplier: ComplexLanes<S>,
        panel: &mut Panel<S>,
    ) {
        let reals = form.entries::<PANEL>(column + 1, first);
        for offset in column + 1 - first..PANEL {
            panel[offset] = panel[offset].minus_real_product(simd, multiplier, simd.splat_f64s(reals[offset]));
        }
        if let Some(diagonal) = panel.get_mut(column + 1 - first) {
            *diagonal = diagonal.plus_imaginary_product(simd, multiplier, self.omega);
        }
    }

    /// The panel that begins in column `first` when the columns before `column` are clear: 2 fused operations for each
    /// entry and multiplier.
    #[inline(always)]
    pub fn panel(
        &self,
        simd: S,
        form: &HessenbergForm,
        stored: &[ComplexLanes<S>],
        first: usize,
        column: usize,
    ) -> Panel<S> {
        let mut panel = self.base_panel(simd, form, stored, first);
        let multipliers = &self.multipliers[self.pending..column];
        for (row, multiplier) in (self.pending + 1..).zip(multipliers) {
            let reals = form.entries::<PANEL>(row, first);
            for (entry, real) in panel.iter_mut().zip(reals) {
                *entry = entry.minus_real_product(simd, *multiplier, simd.splat_f64s(*real));
            }
        }
        if let Some(last) = multipliers.last()
            && first == column
        {
            panel[0] = panel[0].plus_imaginary_product(simd, *last, self.omega);
        }
        panel
    }

    #[inline(always)]
    fn base_panel(&self, simd: S, form: &HessenbergForm, stored: &[ComplexLanes<S>], first: usize) -> Panel<S> {
        match self.base {
            Base::Real(row) => {
                let mut panel = [ComplexLanes::real(simd, 0.0); PANEL];
                for (entry, real) in panel.iter_mut().zip(form.entries::<PANEL>(row, first)) {
                    entry.re = simd.splat_f64s(*real);
                }
                for (column, entry) in (first..).zip(&mut panel) {
                    if column == row {
                        entry.im = simd.neg_f64s(self.omega);
                    }
                }
                panel
            }
            Base::Stored { start, column } => *panel_at(stored, start + first - column),
        }
    }
}

/// The panel stored at a place.
#[inline(always)]
pub fn panel_at<S: Simd>(stored: &[ComplexLanes<S>], place: usize) -> &Panel<S> {
    stored[place..].first_chunk().expect("rows are whole panels")
}

/// The panel stored at a place, to change.
#[inline(always)]
pub fn panel_at_mut<S: Simd>(stored: &mut [ComplexLanes<S>], place: usize) -> &mut Panel<S> {
    stored[place..].first_chunk_mut().expect("rows are whole panels")
}
