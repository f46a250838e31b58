//! A single response as a minimal-order model: balanced, without the states that the input does not
//! control or the output does not observe.
//!
//! In discrete time, A - I takes the place of A (`s_plane.rs`).

use nalgebra::{DMatrix, DVector};

use super::balancing::balance;
use super::connection::connecting_states;
use super::s_plane::SPlane;
use crate::dataset::{Pair, StateSpace};

/// A single-input, single-output model: `dx/dt = a x + b u`, `y = c x + d u`.
#[derive(Clone, Debug)]
pub(super) struct SingleResponse {
    pub(super) a: DMatrix<f64>,
    pub(super) b: DVector<f64>,
    /// Output row, as a column.
    pub(super) c: DVector<f64>,
    pub(super) d: f64,
}

/// Share of |A| below which an entry is regarded as a rounding error from the reflections.
const NEGLIGIBLE: f64 = 1e-12;

impl SingleResponse {
    /// Extracts the model between an input and an output, and balances it (step 1 in
    /// `zeros.rs`).
    pub(super) fn new(model: &StateSpace, plane: SPlane, pair: Pair) -> Self {
        let states = connecting_states(model, pair);
        let mut a = plane.matrix(&model.a().select_rows(&states).select_columns(&states));
        let mut b = model.b().columns(pair.input, 1).select_rows(&states);
        let mut c = model.c().rows(pair.output, 1).select_columns(&states);
        balance(&mut a, &mut b, &mut c);
        Self {
            a,
            b: b.column(0).into_owned(),
            c: c.row(0).transpose(),
            d: model.d()[(pair.output, pair.input)],
        }
    }

    /// Returns the model without its uncontrollable states: A is then upper Hessenberg, and b is
    /// zero except for its first entry.
    ///
    /// Reflections align b with the first state, then each column of A with its subdiagonal, so
    /// that the states form a chain from the input. The chain ends at the first negligible
    /// subdiagonal entry, or at once if b is zero (Van Dooren's staircase, IEEE Trans. Automatic
    /// Control 26(1), 1981, for one input).
    pub(super) fn controllable(mut self) -> Self {
        let size = self.a.nrows();
        let negligible = NEGLIGIBLE * self.a.norm();
        for chained in 0..size {
            // Effect of the input or, from the second state on, of the chain's last state on the
            // states that are not in the chain yet.
            let effect = if chained == 0 {
                self.b.clone()
            } else {
                let mut effect = self.a.column(chained - 1).into_owned();
                effect.rows_mut(0, chained).fill(0.0);
                effect
            };
            // b is not compared with |A|: its size depends on the unit of the input.
            let coupling = effect.norm();
            if coupling == 0.0 || (chained > 0 && coupling <= negligible) {
                return self.first_states(chained);
            }
            self.reflect(effect, chained);
        }
        self
    }

    /// Returns the transposed model, whose controllable states are the original's observable
    /// states.
    pub(super) fn transposed(self) -> Self {
        Self {
            a: self.a.transpose(),
            b: self.c,
            c: self.b,
            d: self.d,
        }
    }

    /// Reflects the states so that the vector `effect`, which is zero before index `at`, becomes
    /// zero except at that index.
    fn reflect(&mut self, effect: DVector<f64>, at: usize) {
        let mut normal = effect.clone();
        normal[at] += effect.norm().copysign(effect[at]);
        normal.normalize_mut();
        let rows = normal.transpose() * &self.a;
        self.a -= 2.0 * &normal * rows;
        let columns = &self.a * &normal;
        self.a -= 2.0 * columns * normal.transpose();
        for vector in [&mut self.b, &mut self.c] {
            *vector -= 2.0 * normal.dot(vector) * &normal;
        }
        // Set the entries that the reflection clears, apart from rounding, to exactly zero.
        if at == 0 {
            self.b.rows_mut(1, self.b.nrows() - 1).fill(0.0);
        } else {
            self.a
                .view_mut((at + 1, at - 1), (self.a.nrows() - at - 1, 1))
                .fill(0.0);
        }
    }

    /// Returns the model with its first `count` states alone.
    fn first_states(&self, count: usize) -> Self {
        Self {
            a: self.a.view((0, 0), (count, count)).into_owned(),
            b: self.b.rows(0, count).into_owned(),
            c: self.c.rows(0, count).into_owned(),
            d: self.d,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{dmatrix, dvector};

    use super::*;

    #[test]
    fn states_that_the_input_does_not_reach_are_left_out() {
        // Two lags of which the input drives only the sum: a single controllable state in other
        // coordinates.
        let a = dmatrix![-1.5, 0.5; 0.5, -1.5];
        let model = SingleResponse {
            a,
            b: dvector![1.0, 1.0],
            c: dvector![1.0, 0.0],
            d: 0.25,
        };
        let reached = model.clone().controllable();
        assert_eq!(reached.a.nrows(), 1);
        // 0.25 + 1 / (s + 1); tolerance: the rounding of one reflection.
        assert!(
            (reached.a[(0, 0)] + 1.0).abs() < 1e-14
                && (reached.b[0] * reached.c[0] - 1.0).abs() < 1e-14
        );
        assert_eq!(
            model.transposed().controllable().a.nrows(),
            2,
            "the first state alone sees both"
        );
    }

    #[test]
    fn what_an_input_reaches_is_a_chain() {
        let a = DMatrix::from_fn(6, 6, |row, column| {
            ((1.0 + 7.3 * row as f64) * (1.0 + 2.9 * column as f64)).sin()
        });
        let b = DVector::from_fn(6, |row, _| 1.0 / (1.0 + row as f64));
        let reached = SingleResponse {
            a: a.clone(),
            b: b.clone(),
            c: b.clone(),
            d: 0.0,
        }
        .controllable();
        assert_eq!(reached.a.nrows(), 6);
        assert_eq!(reached.b.iter().filter(|entry| **entry != 0.0).count(), 1);
        let below = (0..6).flat_map(|column| (column + 2..6).map(move |row| (row, column)));
        assert!(below.into_iter().all(|at| reached.a[at] == 0.0));
        // c A b is invariant under changes of coordinates.
        let before = b.dot(&(&a * &b));
        let after = reached.c.dot(&(&reached.a * &reached.b));
        assert!((before - after).abs() < 1e-13 * before.abs());
    }
}
