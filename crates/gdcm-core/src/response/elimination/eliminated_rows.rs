//! The complex rows of an elimination in one vector of frequencies, with threshold pivoting: which of two rows clears a column.

use pulp::Simd;

use super::*;

/// In which columns of a panel rows were interchanged.
pub type Interchanged = [bool; PANEL];

/// What the complex rows of a system matrix become, in one vector of frequencies.
///
/// They are the *active* row, which begins as the first of `[G K]`, and all rows of `[L D']` but the first. That has one
/// entry in G's columns, the last, and needs nothing before all others are clear: it takes no part, and the active row
/// has its place, so that rows and responses are counted alike.
///
/// Only multipliers are written at every column. Entries are computed where they are needed, a panel of columns of `R`
/// rows at a time in registers: 2 fused operations on real numbers for each entry and column before it, n (n + 2 p) a row
/// in all. Rows beyond `R` are other tiles, which follow the first: that one has the active row.
pub struct EliminatedRows<S: Simd, const R: usize> {
    omega: S::f64s,
    tiles: Vec<Tile<S, R>>,
    interchanges: Vec<Interchange<S>>,
    /// How many interchanges there are.
    count: usize,
    /// The active row at each interchange, in the columns of the panel at hand.
    pivots: Vec<Pivots<S>>,
    /// The active row in the columns of outputs at hand, when it alone is left.
    left: Pivots<S>,
}

/// `R` rows.
struct Tile<S: Simd, const R: usize> {
    /// Multiples of the next row in each column; in the last, what is left there.
    multipliers: Vec<Panel<S, R>>,
    /// Multiples of the active row at each interchange.
    quotients: Vec<Rows<S, R>>,
    /// Multiples of the active row, when it alone is left.
    last: Rows<S, R>,
}

impl<S: Simd, const R: usize> EliminatedRows<S, R> {
    /// Room for a model, and for an interchange in every column of its panels (one that is not a number asks for one even in
    /// the columns that make the last panel whole): a list that grows would cost the registers their contents.
    #[inline(always)]
    pub fn with_room_for(simd: S, form: &HessenbergForm) -> Self {
        let zeros = [ComplexLanes::real(simd, 0.0); R];
        let count = form.inputs().div_ceil(R).max(1);
        let columns = form.state_panels() * PANEL;
        let mut tiles = Vec::with_capacity(count);
        for _ in 0..count {
            let multipliers = filled([zeros; PANEL], form.state_panels());
            tiles.push(Tile { multipliers, quotients: filled(zeros, columns), last: zeros });
        }
        let left = [zeros[0]; PANEL];
        let (interchanges, pivots) = (filled(Interchange::none(simd), columns), filled(left, columns));
        Self { omega: left[0].re, tiles, interchanges, count: 0, pivots, left }
    }

    /// Starts at the frequencies `omega` \[rad/s / alpha\].
    #[inline(always)]
    pub fn start(&mut self, omega: S::f64s) {
        self.omega = omega;
        self.count = 0;
    }

    /// Clears a panel of the first tile without an interchange; whether none is asked for.
    #[inline(always)]
    pub fn clear(&mut self, simd: S, form: &HessenbergForm, panel: usize) -> bool {
        self.forget_from(panel);
        let mut entries = self.state_panel::<true>(simd, form, 0, panel);
        self.subtract_next::<0>(simd, form, panel, entries[0], &mut entries);
        self.subtract_next::<1>(simd, form, panel, entries[1], &mut entries);
        // Their sum: not a number if one is none.
        let mut excess = simd.splat_f64s(0.0);
        for (entries, subdiagonal) in entries.iter().zip(form.subdiagonals(panel)) {
            let inverse_square_threshold = simd.splat_f64s(subdiagonal.inverse_square_threshold);
            excess = simd.mul_add_e_f64s(entries[0].square(simd), inverse_square_threshold, excess);
        }
        self.tiles[0].multipliers[panel] = entries;
        !exceeds(simd, excess)
    }

    /// Clears a panel of the first tile column by column, with an interchange where one is asked for or `required`; returns
    /// where.
    #[inline(always)]
    pub fn clear_with_interchanges(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        panel: usize,
        required: Interchanged,
    ) -> Interchanged {
        self.forget_from(panel);
        let mut entries = self.state_panel::<true>(simd, form, 0, panel);
        let mut multipliers = entries;
        let mut interchanged = required;
        // Written out: a loop has no constants.
        (interchanged[0], multipliers[0]) = self.clear_one::<0>(simd, form, panel, required[0], &mut entries);
        (interchanged[1], multipliers[1]) = self.clear_one::<1>(simd, form, panel, required[1], &mut entries);
        (interchanged[2], multipliers[2]) = self.clear_one::<2>(simd, form, panel, required[2], &mut entries);
        self.tiles[0].multipliers[panel] = multipliers;
        interchanged
    }

    /// Forgets what was done to a panel of the first tile.
    #[inline(always)]
    fn forget_from(&mut self, panel: usize) {
        self.count = self.before(panel);
    }

    #[inline(always)]
    fn clear_one<const OFFSET: usize>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        panel: usize,
        required: bool,
        entries: &mut Panel<S, R>,
    ) -> (bool, Rows<S, R>) {
        let inverse_square_threshold = simd.splat_f64s(form.subdiagonals(panel)[OFFSET].inverse_square_threshold);
        let required_here = exceeds(simd, simd.mul_f64s(entries[OFFSET][0].square(simd), inverse_square_threshold));
        let mut multipliers = entries[OFFSET];
        if required_here || required {
            multipliers = self.interchange::<OFFSET>(simd, form, panel, entries);
        }
        self.subtract_next::<OFFSET>(simd, form, panel, multipliers, entries);
        (required_here || required, multipliers)
    }

    /// Interchanges the active and the next row in a column; returns the multiples of the next row that are left to
    /// subtract.
    #[inline(always)]
    fn interchange<const OFFSET: usize>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        panel: usize,
        entries: &mut Panel<S, R>,
    ) -> Rows<S, R> {
        let (column, subdiagonal) = (panel * PANEL + OFFSET, &form.subdiagonals(panel)[OFFSET]);
        let interchange = Interchange::new(simd, column, subdiagonal, entries[OFFSET][0]);
        let mut quotients = interchange.quotients(simd, entries[OFFSET]);
        let mut multipliers = interchange.multipliers(simd, entries[OFFSET]);
        quotients[0] = interchange.active_quotient(simd, subdiagonal);
        multipliers[0] = interchange.active_multiplier(simd, subdiagonal, entries[OFFSET][0]);
        let index = self.count;
        *entries = subtract_active(simd, *entries, &quotients, &mut self.pivots[index]);
        self.interchanges[index] = interchange;
        self.tiles[0].quotients[index] = quotients;
        self.count += 1;
        multipliers
    }

    /// Interchanges in the first panels.
    #[inline(always)]
    fn before(&self, panels: usize) -> usize {
        let mut count = self.count;
        while let Some(last) = count.checked_sub(1)
            && self.interchanges[last].column >= panels * PANEL
        {
            count = last;
        }
        count
    }

    /// Clears a panel that is clear in the first tile in the others.
    #[inline(always)]
    pub fn follow(&mut self, simd: S, form: &HessenbergForm, panel: usize) {
        for tile in 1..self.tiles.len() {
            let mut entries = self.state_panel::<false>(simd, form, tile, panel);
            let mut multipliers = entries;
            let mut done = self.before(panel);
            multipliers[0] = self.follow_one::<0>(simd, form, tile, panel, &mut done, &mut entries);
            multipliers[1] = self.follow_one::<1>(simd, form, tile, panel, &mut done, &mut entries);
            multipliers[2] = self.follow_one::<2>(simd, form, tile, panel, &mut done, &mut entries);
            self.tiles[tile].multipliers[panel] = multipliers;
        }
    }

    #[inline(always)]
    fn follow_one<const OFFSET: usize>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        tile: usize,
        panel: usize,
        done: &mut usize,
        entries: &mut Panel<S, R>,
    ) -> Rows<S, R> {
        let mut multipliers = entries[OFFSET];
        let index = *done;
        if let Some(interchange) = self.interchanges[..self.count].get(index)
            && interchange.column == panel * PANEL + OFFSET
        {
            *done += 1;
            let quotients = interchange.quotients(simd, entries[OFFSET]);
            multipliers = interchange.multipliers(simd, entries[OFFSET]);
            *entries = subtract_pivots(simd, *entries, &quotients, &self.pivots[index]);
            self.tiles[tile].quotients[index] = quotients;
        }
        self.subtract_next::<OFFSET>(simd, form, panel, multipliers, entries);
        multipliers
    }

    /// Subtracts multiples of the next row of a column from what is right of it in the panel.
    #[inline(always)]
    fn subtract_next<const OFFSET: usize>(
        &self,
        simd: S,
        form: &HessenbergForm,
        panel: usize,
        multipliers: Rows<S, R>,
        entries: &mut Panel<S, R>,
    ) {
        let next = &form.next_rows(panel)[panel][OFFSET];
        for offset in OFFSET + 1..PANEL {
            let real = simd.splat_f64s(next[offset]);
            for row in 0..R {
                entries[offset][row] = entries[offset][row].minus_real_product(simd, multipliers[row], real);
            }
        }
        if let Some(diagonal) = entries.get_mut(OFFSET + 1) {
            let reciprocal = simd.splat_f64s(form.subdiagonals(panel)[OFFSET].reciprocal);
            subtract_diagonal(simd, diagonal, multipliers, simd.mul_f64s(self.omega, reciprocal));
        }
    }

    /// A panel of states of a tile, when those before it are clear.
    #[inline(always)]
    fn state_panel<const LEADS: bool>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        tile: usize,
        panel: usize,
    ) -> Panel<S, R> {
        let mut entries = self.panel::<LEADS>(simd, form, tile, panel, panel);
        if let Some(before) = panel.checked_sub(1) {
            let multipliers = self.tiles[tile].multipliers[before][PANEL - 1];
            let reciprocal = simd.splat_f64s(form.subdiagonals(before)[PANEL - 1].reciprocal);
            subtract_diagonal(simd, &mut entries[0], multipliers, simd.mul_f64s(self.omega, reciprocal));
        } else if LEADS {
            entries[0][0].im = simd.neg_f64s(self.omega);
        }
        entries
    }

    /// A panel of a tile when the first `clear` panels are, but for the imaginary part of the next row after them.
    #[inline(always)]
    fn panel<const LEADS: bool>(
        &mut self,
        simd: S,
        form: &HessenbergForm,
        tile: usize,
        panel: usize,
        clear: usize,
    ) -> Panel<S, R> {
        let rows = &self.tiles[tile];
        let (next, multipliers) =
            (form.next_rows(panel)[..clear].as_flattened(), rows.multipliers[..clear].as_flattened());
        let count = self.before(clear);
        let mut entries = real_panel(simd, form.complex_rows(panel, tile));
        let mut from = 0;
        let interchanges = self.interchanges[..count].iter().zip(&rows.quotients).zip(&mut self.pivots);
        for ((interchange, quotients), pivots) in interchanges {
            let to = interchange.column;
            entries = subtract_multiples(simd, entries, &multipliers[from..to], &next[from..to]);
            entries = if LEADS {
                subtract_active(simd, entries, quotients, pivots)
            } else {
                subtract_pivots(simd, entries, quotients, pivots)
            };
            from = to;
        }
        subtract_multiples(simd, entries, &multipliers[from..], &next[from..])
    }

    /// Clears the last column with the active row, of which multiples are then left to subtract.
    #[inline(always)]
    pub fn finish(&mut self, simd: S, form: &HessenbergForm) {
        let Some(last) = form.order().checked_sub(1) else { return };
        let (panel, offset) = (last / PANEL, last % PANEL);
        let reciprocal = self.tiles[0].multipliers[panel][offset][0].reciprocal(simd);
        for tile in &mut self.tiles {
            tile.last = tile.multipliers[panel][offset];
            for entry in &mut tile.last {
                *entry = entry.product(simd, reciprocal);
            }
        }
        // The first row of L has its turn.
        self.tiles[0].last[0] = reciprocal.scaled(simd, simd.splat_f64s(form.gain()));
    }

    /// Tiles of rows.
    #[inline(always)]
    pub fn tiles(&self) -> usize {
        self.tiles.len()
    }

    /// The responses of a panel of outputs, when all states are eliminated: of one tile after the other.
    #[inline(always)]
    pub fn responses(&mut self, simd: S, form: &HessenbergForm, output_panel: usize, tile: usize) -> Panel<S, R> {
        let states = form.state_panels();
        if tile > 0 {
            let values = self.panel::<false>(simd, form, tile, states + output_panel, states);
            return subtract_pivots(simd, values, &self.tiles[tile].last, &self.left);
        }
        let mut values = self.panel::<true>(simd, form, tile, states + output_panel, states);
        {
            let feed_through = form.feed_through(output_panel);
            for offset in 0..PANEL {
                self.left[offset] = values[offset][0];
                values[offset][0] = ComplexLanes::real(simd, feed_through[offset]);
            }
        }
        subtract_pivots(simd, values, &self.tiles[tile].last, &self.left)
    }
}

/// Whether a sum of `(|u_k| / (tau |h|))^2` is more than 1, or not a number, in any lane.
#[inline(always)]
fn exceeds<S: Simd>(simd: S, excess: S::f64s) -> bool {
    any(simd, simd.not_m64s(simd.less_than_or_equal_f64s(excess, simd.splat_f64s(1.0))))
}

/// Subdiagonal entries below this part the model in two; the largest entry is of order 1, and a double has 16 digits.
const NEGLIGIBLE: f64 = 1e-70;

/// How much larger than the entry of the next row that of the active row must be for both to be interchanged, times the
/// order (`n tau`).
///
/// With tau = 1 elimination is partial pivoting. Real rows take a half to a third of the work of complex ones; they cost at
/// most this factor in accuracy: `n tau` times the unit roundoff of 1.1e-16 is 3e-11, for every order. The errors of the
/// models in `benches/responses.rs` are up to 7e-13 of their largest value.
const PIVOT_THRESHOLD: f64 = (1_u32 << 18) as f64;

/// The one entry of a column of G below the diagonal, `h`, and how it is eliminated.
#[derive(Clone, Copy, Debug)]
pub struct Subdiagonal {
    /// `h`; zero where that is negligible.
    pub entry: f64,
    /// What the row of `h` is divided by, so that it has a one in place of `h`: `h`, or one where that is negligible.
    pub divisor: f64,
    /// One over [`divisor`](Self::divisor).
    pub reciprocal: f64,
    /// `1 / (tau h)^2`; not a number, so that no comparison holds, where `h` is negligible.
    pub inverse_square_threshold: f64,
    /// `h^2`; below every square where `h` is negligible.
    pub square: f64,
}

impl Subdiagonal {
    /// That of a column after which no row follows: nothing is subtracted, and no interchange asked for.
    pub const NONE: Self =
        Self { entry: 0.0, divisor: 1.0, reciprocal: 0.0, inverse_square_threshold: 0.0, square: f64::INFINITY };

    /// Of a model of an order.
    pub fn new(entry: f64, order: usize) -> Self {
        if entry.abs() < NEGLIGIBLE {
            return Self {
                entry: 0.0,
                divisor: 1.0,
                reciprocal: 1.0,
                inverse_square_threshold: f64::NAN,
                square: -1.0,
            };
        }
        let largest = PIVOT_THRESHOLD / order as f64 * entry;
        let (reciprocal, inverse_square_threshold) = (1.0 / entry, 1.0 / (largest * largest));
        Self { entry, divisor: entry, reciprocal, inverse_square_threshold, square: entry * entry }
    }
}

/// That the active row clears a column, in some lanes, and the next row becomes active in its place.
///
/// With `u` the entry of the active row in the column, `w` that of another complex row, and `h` that of the next row, the
/// rows become
///
/// ```text
/// active row:  h (next row / h) - (h / u) (active row)
/// other row:   (row) - (w / u) (active row)
/// ```
///
/// In the other lanes the next row clears the column, and `u` and `w` times (next row / h) are subtracted. Both are done in
/// two steps: *quotients* times the active row are subtracted (from zero in place of the active row itself), then
/// *multipliers* times (next row / h).
#[derive(Clone, Copy)]
pub struct Interchange<S: Simd> {
    /// The column.
    pub column: usize,
    lanes: S::m64s,
    /// `1 / u`.
    reciprocal: ComplexLanes<S>,
}

impl<S: Simd> Interchange<S> {
    /// None in any lane.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        let one = ComplexLanes::real(simd, 1.0);
        Self { column: 0, lanes: simd.less_than_f64s(one.re, one.re), reciprocal: one }
    }

    /// In the lanes where the entry `u` of the active row is larger than that of the next row.
    #[inline(always)]
    pub fn new(simd: S, column: usize, subdiagonal: &Subdiagonal, pivot: ComplexLanes<S>) -> Self {
        let lanes = simd.greater_than_f64s(pivot.square(simd), simd.splat_f64s(subdiagonal.square));
        Self { column, lanes, reciprocal: pivot.reciprocal(simd) }
    }

    /// The quotients of rows with these entries: `w / u`, or zero.
    #[inline(always)]
    pub fn quotients<const R: usize>(&self, simd: S, mut entries: Rows<S, R>) -> Rows<S, R> {
        let zero = ComplexLanes::real(simd, 0.0);
        for entry in &mut entries {
            *entry = zero.replaced_where(simd, self.lanes, entry.product(simd, self.reciprocal));
        }
        entries
    }

    /// The quotient of the active row: `h / u`, or -1.
    #[inline(always)]
    pub fn active_quotient(&self, simd: S, subdiagonal: &Subdiagonal) -> ComplexLanes<S> {
        // Zero even where the pivot is zero: nothing of the active row goes on.
        let quotient = if subdiagonal.entry == 0.0 {
            ComplexLanes::real(simd, 0.0)
        } else {
            self.reciprocal.scaled(simd, simd.splat_f64s(subdiagonal.entry))
        };
        ComplexLanes::real(simd, -1.0).replaced_where(simd, self.lanes, quotient)
    }

    /// The multipliers of rows with these entries: zero, or `w`.
    #[inline(always)]
    pub fn multipliers<const R: usize>(&self, simd: S, mut entries: Rows<S, R>) -> Rows<S, R> {
        let zero = ComplexLanes::real(simd, 0.0);
        for entry in &mut entries {
            *entry = entry.replaced_where(simd, self.lanes, zero);
        }
        entries
    }

    /// The multiplier of the active row: `-h`, or `u`.
    #[inline(always)]
    pub fn active_multiplier(&self, simd: S, subdiagonal: &Subdiagonal, pivot: ComplexLanes<S>) -> ComplexLanes<S> {
        pivot.replaced_where(simd, self.lanes, ComplexLanes::real(simd, -subdiagonal.divisor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_that_is_negligible_always_asks_for_an_interchange() {
        let subdiagonal = Subdiagonal::new(1e-80, 12);
        for active in [0.0, 1e-90, 1.0] {
            assert!(active > subdiagonal.square, "the active row is chosen");
            let asks = active * subdiagonal.inverse_square_threshold;
            assert!(asks.is_nan(), "no comparison holds");
        }
        assert_eq!((subdiagonal.entry, subdiagonal.reciprocal), (0.0, 1.0));
    }

    #[test]
    fn the_pivot_threshold_times_the_order_is_the_same_for_every_order() {
        for order in [2, 12, 60, 500] {
            let tau = Subdiagonal::new(0.5, order).inverse_square_threshold.sqrt().recip() / 0.5;
            // A handful of roundings.
            assert!((tau * order as f64 / PIVOT_THRESHOLD - 1.0).abs() < 1e-14);
        }
    }
}
