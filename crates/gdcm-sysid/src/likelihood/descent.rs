//! Levenberg-Marquardt descent over all entries of `A`, `B`, `C`, `D` (M14.19).
//!
//! ```text
//! J cost, N degrees of freedom, k parameters (`cost`); G, g as in `normal_equations`
//! phi = J/(N - k);   lambda damping, at first 1e-3;   delta^2 = g' G^+ g: Newton decrement
//! for each of at most 40 steps:
//! 1  F: fall of J over the last six steps.  Stop if J - F (steps left)/6 > the cost above which
//!       the model is useless: hopeless
//! 2  balanced coordinates (`balancing`), then G and g there
//! 3  stop if delta^2 < limit k phi: converged.  The limit is at least 0.1 if F < 0.02 k phi: the
//!       rest takes too many steps to be worth them
//!    or if J - 3 delta^2 > the cost above which the model is useless: hopeless
//! 4  (G + lambda diag G) d = g;  while J does not fall: lambda = max(6 lambda, 1e-7);
//!       stop if it does not fall after 10 such increases
//! 5  rho = decrease / (2 g'd - d'G d):  lambda, at least 1e-8,
//!       /= 10 for rho > 0.75, /= 3 for rho > 0.4, unchanged for rho > 0.15, *= 4 otherwise
//! ```
//!
//! The descent also stops if N <= k, or without normal equations.
//!
//! At delta^2 = 0.02 k phi the remaining distance is 14 % of the parameters' standard deviation. A
//! limit on the relative decrease in `J` would stop in a valley.

use nalgebra::{DMatrix, DVector};

use gdcm_model::progress::{Cancelled, Shares};

use super::balancing::{Coordinates, Gramians, balancing_coordinates};
use super::cost::{Likelihood, SegmentCost};
use super::gram_matrix::solve_positive_definite;
use super::normal_equations::{BIN_WIDTH, EXACT, NormalEquations};
use super::schur_model::SchurModel;

/// Limit on `delta^2 / (k phi)` below which a descent has reached its minimum.
pub(crate) const CONVERGED: f64 = 0.02;
/// Limit on `delta^2 / (k phi)` for comparing orders: the cost may still fall by about 10 % of the
/// noise that k parameters explain, which is little compared with the BIC penalty on a state,
/// `(inputs + outputs) phi ln N`.
pub(crate) const COMPARABLE: f64 = 0.1;
/// Limit on `delta^2 / (k phi)` before the noise is measured again.
pub(crate) const NEARLY_CONVERGED: f64 = 0.2;
/// The cost is expected to fall by no more than this many times `delta^2`.
const LARGEST_FALL: f64 = 3.0;
/// Maximum number of steps in a descent.
const MOST_STEPS: usize = 40;
/// Number of steps over which the fall of the cost is observed.
const OBSERVED_STEPS: usize = 6;
/// Damping in the first step.
const FIRST_DAMPING: f64 = 1e-3;
/// Factor on the damping after a step that does not lower the cost.
const DAMPING_FACTOR: f64 = 6.0;
/// Minimum damping after a step that does not lower the cost.
const LEAST_FAILED_DAMPING: f64 = 1e-7;
/// Minimum damping: it replaces the pseudo-inverse in the directions that only change the
/// coordinates.
const LEAST_DAMPING: f64 = 1e-8;
/// A column's scale is computed from at least this share of its square, even where the nuisance
/// columns explain more.
const LEAST_SHARE_LEFT: f64 = 1e-6;
/// Number of increases of the damping after which a step is given up.
const FAILURES: usize = 10;
/// Share of the total progress per step.
const STEP_PROGRESS: f64 = 0.01;

/// Limits at which a descent ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// `delta^2 / (k phi)` below which the model has converged.
    pub(crate) decrement: f64,
    /// Cost above which the model is useless: the descent ends if `J - 3 delta^2`, or `J`
    /// extrapolated to the last step, exceeds it.
    pub(crate) hopeless_above: f64,
}

impl Limits {
    /// Creates limits on `delta^2 / (k phi)` alone.
    pub(crate) fn to(decrement: f64) -> Self {
        Self {
            decrement,
            hopeless_above: f64::INFINITY,
        }
    }
}

/// A model and its cost.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) model: SchurModel,
    /// Each segment's contribution to the cost.
    pub(crate) parts: Vec<SegmentCost>,
    /// `J`.
    pub(crate) cost: f64,
    /// `delta^2 / (k phi)` where it was last computed; infinite before.
    pub(crate) decrement: f64,
    /// `lambda` for the next step.
    damping: f64,
    /// Gramians from the last step, in the present coordinates; `None` before the first.
    gramians: Option<Gramians>,
}

impl Fit {
    /// Evaluates a model; `None` if its cost is not finite.
    pub(crate) fn start(likelihood: &Likelihood, model: SchurModel) -> Option<Self> {
        let parts = likelihood.parts(&model)?;
        let cost = parts.iter().map(|part| part.cost).sum::<f64>();
        if !cost.is_finite() {
            return None;
        }
        Some(Self {
            model,
            parts,
            cost,
            decrement: f64::INFINITY,
            damping: FIRST_DAMPING,
            gramians: None,
        })
    }

    pub(crate) fn order(&self) -> usize {
        self.model.order()
    }

    /// Returns `phi = J/(N - k)`; `None` if the parameters leave no degrees of freedom.
    pub(crate) fn dispersion(&self, likelihood: &Likelihood) -> Option<f64> {
        let freedom = likelihood.freedom(self.order());
        match freedom.checked_sub(self.model.parameters()) {
            None | Some(0) => None,
            Some(spare) => Some(self.cost / spare as f64),
        }
    }

    /// Computes `delta^2 / (k phi)` with exact normal equations.
    #[cfg(test)]
    pub(crate) fn decrement(&self, likelihood: &Likelihood) -> Option<f64> {
        let system = NormalEquations::new(likelihood, &self.model, &self.parts, EXACT)?;
        let square = ScaledSystem::new(system).decrement()?;
        Some(square / (self.model.parameters() as f64 * self.dispersion(likelihood)?))
    }

    /// Descends until a limit is reached, no step lowers the cost, or 40 steps are taken; `Err` if
    /// cancelled.
    pub(crate) fn descended(
        mut self,
        likelihood: &Likelihood,
        limits: Limits,
        progress: &Shares,
    ) -> Result<Self, Cancelled> {
        let mut costs = vec![self.cost];
        for step in 1..=MOST_STEPS {
            progress.advance(
                STEP_PROGRESS,
                &format!("order {}, step {step}", self.order()),
            )?;
            let fall = match costs.len().checked_sub(OBSERVED_STEPS + 1) {
                Some(before) => costs[before] - self.cost,
                None => f64::INFINITY,
            };
            // Step 1.
            let steps_left = (MOST_STEPS + 1 - step) as f64;
            let extrapolated = self.cost - fall * steps_left / OBSERVED_STEPS as f64;
            if extrapolated > limits.hopeless_above || !self.step(likelihood, limits, fall) {
                break;
            }
            costs.push(self.cost);
        }
        Ok(self)
    }

    /// Takes a step (2 to 5); returns whether a further one may be worthwhile. `fall` is `F`,
    /// infinite before the sixth step.
    fn step(&mut self, likelihood: &Likelihood, limits: Limits, fall: f64) -> bool {
        let Some(dispersion) = self.dispersion(likelihood) else {
            return false;
        };
        // Step 2.
        self.balance(likelihood);
        let Some(system) =
            NormalEquations::new(likelihood, &self.model, &self.parts, bin_width(likelihood))
        else {
            return false;
        };
        self.gramians = Some(system.gramians.clone());
        let scaled = ScaledSystem::new(system);
        let k_phi = self.model.parameters() as f64 * dispersion;
        let mut direction = scaled.solve(self.damping);
        // Step 3.
        let limit = if fall < CONVERGED * k_phi {
            limits.decrement.max(COMPARABLE)
        } else {
            limits.decrement
        };
        // With damping, g'd is a lower bound on delta^2, which is computed only where the bound
        // does not exclude that it ends the descent.
        let least_square = direction
            .as_ref()
            .map_or(0.0, |direction| scaled.gradient.dot(direction));
        let may_end = least_square < limit * k_phi
            || self.cost - LARGEST_FALL * least_square > limits.hopeless_above;
        if may_end {
            let square = scaled.decrement().unwrap_or(f64::INFINITY);
            self.decrement = square / k_phi;
            let is_hopeless = self.cost - LARGEST_FALL * square > limits.hopeless_above;
            if self.decrement < limit || is_hopeless {
                return false;
            }
        }
        // Steps 4 and 5.
        for _ in 0..=FAILURES {
            if let Some(direction) = direction
                && self.try_step(likelihood, &scaled, &direction)
            {
                return true;
            }
            self.damping = (DAMPING_FACTOR * self.damping).max(LEAST_FAILED_DAMPING);
            direction = scaled.solve(self.damping);
        }
        self.damping = FIRST_DAMPING;
        false
    }

    /// Transforms model and transients to balanced coordinates, with the Gramians from the previous
    /// step, or sampled anew in the first. Changes nothing if there are no such coordinates.
    fn balance(&mut self, likelihood: &Likelihood) {
        let gramians = self
            .gramians
            .take()
            .unwrap_or_else(|| Gramians::sampled(likelihood, &self.model));
        let Some(coordinates) = balancing_coordinates(&gramians) else {
            return;
        };
        let Coordinates {
            transformation,
            inverse,
        } = coordinates;
        if let Some(model) = self.model.in_coordinates(&transformation, &inverse) {
            self.model = model;
            for part in &mut self.parts {
                part.transient = &inverse * &part.transient;
            }
        }
    }

    /// Tries a step, in scaled columns, and takes it if it lowers the cost (step 5); returns
    /// whether it did.
    fn try_step(
        &mut self,
        likelihood: &Likelihood,
        system: &ScaledSystem,
        direction: &DVector<f64>,
    ) -> bool {
        let predicted = system.predicted_decrease(direction);
        let (outputs, inputs) = self.model.d().shape();
        let order = self.order();
        let step = DMatrix::from_column_slice(
            order + outputs,
            order + inputs,
            system.unscaled(direction).as_slice(),
        );
        let Some(model) = self.model.stepped(&step) else {
            return false;
        };
        let Some(stepped) = Self::start(likelihood, model) else {
            return false;
        };
        if stepped.cost >= self.cost {
            return false;
        }
        let ratio = (self.cost - stepped.cost) / predicted;
        self.model = stepped.model;
        self.parts = stepped.parts;
        self.cost = stepped.cost;
        self.damping = (self.damping * damping_factor(ratio)).max(LEAST_DAMPING);
        true
    }
}

/// Returns the bin width: exact bins if samples are missing, because their spectra turn so fast
/// with frequency that a descent with wide bins stalls.
fn bin_width(likelihood: &Likelihood) -> f64 {
    let has_gaps = likelihood
        .segments
        .iter()
        .any(|segment| !segment.hats.is_empty());
    if has_gaps { EXACT } else { BIN_WIDTH }
}

/// Returns the factor on the damping after a step (step 5); `ratio` is actual over predicted
/// decrease. The better the quadratic model predicts, the less damping is needed.
fn damping_factor(ratio: f64) -> f64 {
    if ratio > 0.75 {
        0.1
    } else if ratio > 0.4 {
        1.0 / 3.0
    } else if ratio > 0.15 {
        1.0
    } else {
        4.0
    }
}

/// A normal system in scaled columns.
struct ScaledSystem {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    scales: DVector<f64>,
}

impl ScaledSystem {
    /// Scales the columns to unit length, but less where the nuisance columns explain nearly all of
    /// a column: the rest is mostly rounding error.
    fn new(system: NormalEquations) -> Self {
        let scales =
            system
                .matrix
                .diagonal()
                .zip_map(&system.whole_diagonal, |remaining, whole| {
                    let square = remaining.max(LEAST_SHARE_LEFT * whole);
                    if square > 0.0 {
                        1.0 / square.sqrt()
                    } else {
                        0.0
                    }
                });
        let mut matrix = system.matrix;
        let size = scales.len();
        for (at, entry) in matrix.iter_mut().enumerate() {
            *entry *= scales[at % size] * scales[at / size];
        }
        Self {
            gradient: system.gradient.component_mul(&scales),
            matrix,
            scales,
        }
    }

    /// Solves `(G + lambda I) d = g` in scaled columns; `None` if the matrix is not positive
    /// definite or the solution not finite.
    fn solve(&self, damping: f64) -> Option<DVector<f64>> {
        let mut damped = self.matrix.clone();
        for k in 0..self.scales.len() {
            damped[(k, k)] += damping;
        }
        let solution = solve_positive_definite(damped, &self.gradient)?;
        if solution.iter().all(|entry| entry.is_finite()) {
            Some(solution)
        } else {
            None
        }
    }

    /// Returns `delta^2`, the squared Newton decrement, `g' G^+ g`, with the first damping from
    /// 1e-8 on for which the matrix is positive definite; `None` if none of ten is large enough.
    fn decrement(&self) -> Option<f64> {
        let mut damping = LEAST_DAMPING;
        for _ in 0..FAILURES {
            if let Some(step) = self.solve(damping) {
                return Some(self.gradient.dot(&step));
            }
            damping *= DAMPING_FACTOR;
        }
        None
    }

    /// Returns `2 g'd - d'G d`, the cost decrease that the quadratic model predicts.
    fn predicted_decrease(&self, direction: &DVector<f64>) -> f64 {
        2.0 * self.gradient.dot(direction) - direction.dot(&(&self.matrix * direction))
    }

    /// Converts a step from scaled columns to parameters.
    fn unscaled(&self, direction: &DVector<f64>) -> DVector<f64> {
        direction.component_mul(&self.scales)
    }
}
