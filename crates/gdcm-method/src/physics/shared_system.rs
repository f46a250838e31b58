//! Normal equations for the parameters and delays, summed over conditions (step 7 in `physics`).
//!
//! ```text
//! (sum_c S'_c + prior) x = sum_c g'_c,   prior: 1 for a parameter, 1 / sd_delay^2 for a delay
//! ```
//!
//! `x` are the parameter values (in plausible standard deviations, hence the prior 1) and the
//! channel delays. `S'_c` and `g'_c` are the normal matrix and the right-hand side of condition c
//! after the elimination of its ln gains (`condition_equations`).
//!
//! Delays are fixed at zero if their prior standard deviation is 0, and so are the parameters that
//! `solve_for` leaves out.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::condition_equations::{ReducedEquations, UnknownCounts, symmetrise};

/// The summed equations, without prior.
#[derive(Clone, Debug)]
pub(super) struct SharedSystem {
    counts: UnknownCounts,
    /// Prior standard deviation of a delay \[s\]; 0: no delays.
    delay_sd_s: f64,
    /// `sum_c S'_c`.
    matrix: DMatrix<f64>,
    /// `sum_c g'_c`.
    right: DVector<f64>,
}

impl SharedSystem {
    /// Creates empty equations.
    pub(super) fn new(counts: UnknownCounts, delay_sd_s: f64) -> Self {
        Self {
            counts,
            delay_sd_s,
            matrix: DMatrix::zeros(counts.shared(), counts.shared()),
            right: DVector::zeros(counts.shared()),
        }
    }

    pub(super) fn add(&mut self, condition: &ReducedEquations) {
        self.matrix += &condition.matrix;
        self.right += &condition.right;
    }

    /// Returns the equations without a condition that was added.
    pub(super) fn without(&self, condition: &ReducedEquations) -> Self {
        let mut others = self.clone();
        others.matrix -= &condition.matrix;
        others.right -= &condition.right;
        others
    }

    /// Solves for all shared unknowns; `None` if the matrix has no Cholesky factors, or the
    /// solution is not finite.
    pub(super) fn solve(&self) -> Option<DVector<f64>> {
        let parameters: Vec<usize> = (0..self.counts.parameters).collect();
        self.solve_for(&parameters)
    }

    /// Solves with only these parameters free, the others at zero; `None` in the same cases as
    /// [`Self::solve`].
    pub(super) fn solve_for(&self, parameters: &[usize]) -> Option<DVector<f64>> {
        let mut free = parameters.to_vec();
        if self.delay_sd_s > 0.0 {
            free.extend(self.counts.parameters..self.counts.shared());
        }
        let matrix = DMatrix::from_fn(free.len(), free.len(), |row, column| {
            let prior = if row == column {
                self.prior(free[row])
            } else {
                0.0
            };
            self.matrix[(free[row], free[column])] + prior
        });
        let right = DVector::from_fn(free.len(), |row, _| self.right[free[row]]);
        let mut solution = DVector::zeros(self.counts.shared());
        if !free.is_empty() {
            let values = Cholesky::new(matrix)?.solve(&right);
            for (value, &unknown) in values.iter().zip(&free) {
                solution[unknown] = *value;
            }
        }
        if solution.iter().all(|value| value.is_finite()) {
            Some(solution)
        } else {
            None
        }
    }

    /// Returns `F` (see `identifiability`): the parameters' normal matrix without their prior,
    /// after eliminating the ln gains and the delays, whose prior is included; `None` if the delays
    /// are not determined.
    pub(super) fn parameter_information(&self) -> Option<DMatrix<f64>> {
        let size = self.counts.parameters;
        let mut information = self.matrix.view((0, 0), (size, size)).into_owned();
        if self.delay_sd_s > 0.0 {
            let delays = self.counts.channels();
            let mut delay_block = self
                .matrix
                .view((size, size), (delays, delays))
                .into_owned();
            for delay in 0..delays {
                delay_block[(delay, delay)] += self.prior(size + delay);
            }
            let border = self.matrix.view((size, 0), (delays, size)).into_owned();
            information -= border.tr_mul(&Cholesky::new(delay_block)?.solve(&border));
        }
        symmetrise(&mut information);
        Some(information)
    }

    /// Returns a shared unknown's prior precision, 1 / variance.
    fn prior(&self, unknown: usize) -> f64 {
        if unknown < self.counts.parameters {
            1.0
        } else {
            self.delay_sd_s.powi(-2)
        }
    }
}
