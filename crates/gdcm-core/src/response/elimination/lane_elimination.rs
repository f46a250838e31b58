//! Gaussian elimination of the states from a system matrix at many frequencies at once.

use pulp::Simd;

use super::eliminated_rows::{EliminatedRows, Interchanged};
use super::hessenberg_form::{HessenbergForm, PANEL};

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
