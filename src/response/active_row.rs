//! The one complex row of an elimination.

use pulp::Simd;

use super::complex_lanes::{ComplexLanes, filled};
use super::hessenberg_form::{HessenbergForm, PANEL};
use super::subdiagonal::Subdiagonal;

/// A number in each lane of `V` vectors.
pub type Across<S, const V: usize> = [ComplexLanes<S>; V];

/// Entries of neighbouring columns.
pub type Panel<S, const V: usize> = [Across<S, V>; PANEL];

/// What the rows above a column have become, in `V` vectors of frequencies side by side.
///
/// For each column k that is cleared, the active row `u` becomes
///
/// ```text
/// f u - m r,   r = (F_(k+1) - j omega e_(k+1)) / h,   h = F_(k+1,k)
/// ```
///
/// with `r` real but for one entry, and 1 in column k. Where the next row stays in the triangle, the factor `f` is 1 and
/// the multiplier `m` is `u_k`. Where `u` does, they are `-h / u_k` and `-h`: that is the next row less `h / u_k` times
/// `u`.
///
/// Only multipliers are written at every column, and factors at every interchange. Entries are computed where they are
/// needed, a panel of columns at a time in registers.
pub struct ActiveRow<S: Simd, const V: usize> {
    omega: [S::f64s; V],
    /// `m`, one for each column.
    multipliers: Vec<Across<S, V>>,
    interchanges: Vec<Interchange<S, V>>,
    /// The row that each interchange left in the triangle, in whole panels from column 0 on.
    stored: Vec<Vec<Panel<S, V>>>,
}

/// An interchange of the active and the next row, in some lanes.
#[derive(Clone, Copy)]
struct Interchange<S: Simd, const V: usize> {
    column: usize,
    /// Where the active row stays in the triangle.
    lanes: [S::m64s; V],
    /// `f`.
    factors: Across<S, V>,
}

impl<S: Simd, const V: usize> ActiveRow<S, V> {
    /// Room for a model; that for rows of the triangle is made as they come.
    #[inline(always)]
    pub fn with_room_for(simd: S, form: &HessenbergForm) -> Self {
        let zero = ComplexLanes::real(simd, 0.0);
        let multipliers = filled([zero; V], form.order());
        Self { omega: [zero.re; V], multipliers, interchanges: Vec::new(), stored: Vec::new() }
    }

    /// Starts with the first row at the frequencies `omega` \[rad/s / alpha\].
    #[inline(always)]
    pub fn start(&mut self, omega: [S::f64s; V]) {
        self.omega = omega;
        self.interchanges.clear();
    }

    /// The frequencies of one of the vectors \[rad/s / alpha\].
    #[inline(always)]
    pub fn omega(&self, vector: usize) -> S::f64s {
        self.omega[vector]
    }

    /// The row that the interchange of an index left in the triangle: one over the diagonal entry is in its place, and
    /// what is left of that has no meaning.
    #[inline(always)]
    pub fn stored(&self, interchange: usize) -> &[Across<S, V>] {
        self.stored[interchange].as_flattened()
    }

    /// The panel that begins in column `first` when the columns before `column` are clear: 2 fused operations for each
    /// entry and multiplier, 4 for each entry and interchange.
    #[inline(always)]
    pub fn panel(&mut self, simd: S, form: &HessenbergForm, first: usize, column: usize) -> Panel<S, V> {
        let (rows, multipliers) = (&form.panel(first)[..column], &self.multipliers[..column]);
        let mut panel = first_row(simd, form, first, self.omega);
        let mut done = 0;
        for (interchange, stored) in self.interchanges.iter().zip(&mut self.stored) {
            let to = interchange.column;
            panel = subtract_multiples(simd, panel, &multipliers[done..to], &rows[done..to]);
            let mut row = interchange.row(simd, &panel, &rows[to]);
            if first == to + 1 {
                row[0] = interchange.diagonal(simd, row[0], shifts(simd, self.omega, &form.subdiagonals()[to]));
            }
            stored[first / PANEL] = row;
            for entry in &mut panel {
                *entry = product(simd, *entry, interchange.factors);
            }
            done = to;
        }
        panel = subtract_multiples(simd, panel, &multipliers[done..], &rows[done..]);
        if first == column
            && let Some(last) = multipliers.last()
        {
            let shifts = shifts(simd, self.omega, &form.subdiagonals()[column - 1]);
            panel[0] = plus_imaginary_product(simd, panel[0], *last, shifts);
        }
        panel
    }

    /// Clears so many columns of the panel that begins in column `first`, with the next row staying in each. Returns by
    /// how much each lane exceeds what is allowed: the sum of all `(|u_k| / (tau |h|))^2`.
    #[inline(always)]
    pub fn clear(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        first: usize,
        columns: usize,
        panel: &mut Panel<S, V>,
    ) -> [S::f64s; V] {
        let mut excess = [simd.splat_f64s(0.0); V];
        // Written out: a loop keeps the panel in memory.
        if columns == PANEL {
            self.clear_one::<0>(simd, form, first, panel, &mut excess);
            self.clear_one::<1>(simd, form, first, panel, &mut excess);
            self.clear_one::<2>(simd, form, first, panel, &mut excess);
            self.clear_one::<3>(simd, form, first, panel, &mut excess);
            return excess;
        }
        if columns > 0 {
            self.clear_one::<0>(simd, form, first, panel, &mut excess);
        }
        if columns > 1 {
            self.clear_one::<1>(simd, form, first, panel, &mut excess);
        }
        if columns > 2 {
            self.clear_one::<2>(simd, form, first, panel, &mut excess);
        }
        excess
    }

    #[inline(always)]
    fn clear_one<const OFFSET: usize>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        first: usize,
        panel: &mut Panel<S, V>,
        excess: &mut [S::f64s; V],
    ) {
        let sensitivity = simd.splat_f64s(form.subdiagonals()[first + OFFSET].sensitivity);
        for (excess, multiplier) in excess.iter_mut().zip(&panel[OFFSET]) {
            *excess = simd.mul_add_e_f64s(multiplier.square(simd), sensitivity, *excess);
        }
        self.subtract_next::<OFFSET>(simd, form, first, panel[OFFSET], panel);
    }

    /// Subtracts the multiple of the next row that clears column `first + OFFSET` from what follows in the panel that
    /// begins in column `first`.
    #[inline(always)]
    pub fn subtract_next<const OFFSET: usize>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        first: usize,
        multiplier: Across<S, V>,
        panel: &mut Panel<S, V>,
    ) {
        let column = first + OFFSET;
        self.multipliers[column] = multiplier;
        let row = &form.panel(first)[column];
        for offset in OFFSET + 1..PANEL {
            let real = simd.splat_f64s(row[offset]);
            for vector in 0..V {
                panel[offset][vector] = panel[offset][vector].minus_real_product(simd, multiplier[vector], real);
            }
        }
        if let Some(diagonal) = panel.get_mut(OFFSET + 1) {
            let shifts = shifts(simd, self.omega, &form.subdiagonals()[column]);
            *diagonal = plus_imaginary_product(simd, *diagonal, multiplier, shifts);
        }
    }

    /// Leaves the active row in the triangle in the lanes where its entry in column `first + OFFSET` is larger than that
    /// of the next row, and multiplies it with its factors; returns the multipliers of the next row.
    #[inline(always)]
    pub fn interchange<const OFFSET: usize>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        first: usize,
        panel: &mut Panel<S, V>,
    ) -> Across<S, V> {
        let (column, subdiagonal) = (first + OFFSET, &form.subdiagonals()[first + OFFSET]);
        let (interchange, reciprocals) = Interchange::new(simd, column, subdiagonal, panel[OFFSET]);
        let mut row = interchange.row(simd, panel, &form.panel(first)[column]);
        row[OFFSET] = reciprocals;
        if let Some(diagonal) = row.get_mut(OFFSET + 1) {
            *diagonal = interchange.diagonal(simd, *diagonal, shifts(simd, self.omega, subdiagonal));
        }
        let mut multipliers = panel[OFFSET];
        for (multiplier, lanes) in multipliers.iter_mut().zip(&interchange.lanes) {
            *multiplier = multiplier.replaced_where(simd, *lanes, ComplexLanes::real(simd, -subdiagonal.divisor));
        }
        for entry in &mut panel[OFFSET + 1..] {
            *entry = product(simd, *entry, interchange.factors);
        }
        if self.stored.len() == self.interchanges.len() {
            let zero = ComplexLanes::real(simd, 0.0);
            self.stored.push(filled([[zero; V]; PANEL], form.panels()));
        }
        self.stored[self.interchanges.len()][first / PANEL] = row;
        self.interchanges.push(interchange);
        multipliers
    }
}

impl<S: Simd, const V: usize> Interchange<S, V> {
    /// That of the column in which the active row is `pivots`; and one over the entry that it leaves on the diagonal, where
    /// the next row has a one.
    #[inline(always)]
    fn new(simd: S, column: usize, subdiagonal: &Subdiagonal, pivots: Across<S, V>) -> (Self, Across<S, V>) {
        let one = ComplexLanes::real(simd, 1.0);
        let mut interchange = Self { column, lanes: [simd.less_than_f64s(one.re, one.re); V], factors: [one; V] };
        let mut reciprocals = [one; V];
        for vector in 0..V {
            let lanes = simd.greater_than_f64s(pivots[vector].square(simd), simd.splat_f64s(subdiagonal.square));
            reciprocals[vector] = one.replaced_where(simd, lanes, pivots[vector].reciprocal(simd));
            // Zero even where the pivot is zero: nothing of the active row goes on.
            let factor = if subdiagonal.entry == 0.0 {
                ComplexLanes::real(simd, 0.0)
            } else {
                reciprocals[vector].scaled(simd, simd.splat_f64s(-subdiagonal.entry))
            };
            interchange.lanes[vector] = lanes;
            interchange.factors[vector] = one.replaced_where(simd, lanes, factor);
        }
        (interchange, reciprocals)
    }

    /// What stays in the triangle of a panel of the active row and the `next`.
    #[inline(always)]
    fn row(&self, simd: S, active: &Panel<S, V>, next: &[f64; PANEL]) -> Panel<S, V> {
        let mut row = *active;
        for offset in 0..PANEL {
            let next = ComplexLanes::real(simd, next[offset]);
            for vector in 0..V {
                row[offset][vector] = next.replaced_where(simd, self.lanes[vector], active[offset][vector]);
            }
        }
        row
    }

    /// The entry right of the interchange, with the imaginary part that the next row has there.
    #[inline(always)]
    fn diagonal(&self, simd: S, mut entry: Across<S, V>, shifts: [S::f64s; V]) -> Across<S, V> {
        for vector in 0..V {
            let next = simd.neg_f64s(shifts[vector]);
            entry[vector].im = simd.select_f64s(self.lanes[vector], entry[vector].im, next);
        }
        entry
    }
}

/// `omega / h`.
#[inline(always)]
fn shifts<S: Simd, const V: usize>(simd: S, omega: [S::f64s; V], subdiagonal: &Subdiagonal) -> [S::f64s; V] {
    let mut shifts = omega;
    for shift in &mut shifts {
        *shift = simd.mul_f64s(*shift, simd.splat_f64s(subdiagonal.reciprocal));
    }
    shifts
}

/// The first row of `[F - j omega I, B]`.
#[inline(always)]
fn first_row<S: Simd, const V: usize>(
    simd: S,
    form: &HessenbergForm,
    first: usize,
    omega: [S::f64s; V],
) -> Panel<S, V> {
    let row = form.first_row(first);
    let mut panel = [[ComplexLanes::real(simd, 0.0); V]; PANEL];
    for offset in 0..PANEL {
        panel[offset] = [ComplexLanes::real(simd, row[offset]); V];
    }
    if first == 0 {
        for vector in 0..V {
            panel[0][vector].im = simd.neg_f64s(omega[vector]);
        }
    }
    panel
}

/// `panel - sum of multipliers times rows`: nearly all the work of an elimination.
#[inline(always)]
fn subtract_multiples<S: Simd, const V: usize>(
    simd: S,
    mut panel: Panel<S, V>,
    multipliers: &[Across<S, V>],
    rows: &[[f64; PANEL]],
) -> Panel<S, V> {
    for (row, multiplier) in rows.iter().zip(multipliers) {
        for offset in 0..PANEL {
            let real = simd.splat_f64s(row[offset]);
            for vector in 0..V {
                panel[offset][vector] = panel[offset][vector].minus_real_product(simd, multiplier[vector], real);
            }
        }
    }
    panel
}

/// `left right`.
#[inline(always)]
fn product<S: Simd, const V: usize>(simd: S, mut left: Across<S, V>, right: Across<S, V>) -> Across<S, V> {
    for vector in 0..V {
        left[vector] = left[vector].product(simd, right[vector]);
    }
    left
}

/// `entry + factor j imaginary`.
#[inline(always)]
fn plus_imaginary_product<S: Simd, const V: usize>(
    simd: S,
    mut entry: Across<S, V>,
    factor: Across<S, V>,
    imaginary: [S::f64s; V],
) -> Across<S, V> {
    for vector in 0..V {
        entry[vector] = entry[vector].plus_imaginary_product(simd, factor[vector], imaginary[vector]);
    }
    entry
}
