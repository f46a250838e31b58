//! How each parameter changes the matrices of a condition's physics model (step 1 in `physics`,
//! M18.2), and the model for chosen values (M18.5).
//!
//! ```text
//! one run at z_1:           L = (A_1 - A_0) / z_1,   Q = 0
//! two runs at z_1, z_2:     Q = [(A_1 - A_0) / z_1 - (A_2 - A_0) / z_2] / (z_1 - z_2),
//!                           L = (A_1 - A_0) / z_1 - z_1 Q
//! A(z) = A + sum_k (z_k L_k + z_k^2 Q_k);   B, C and D likewise
//! ```
//!
//! A *run* is a model linearised with one parameter moved, its *base* the model at the same trim
//! with the parameter nominal. `z_k` is parameter k's change divided by its plausible standard
//! deviation, `A_0` the matrix in the runs' base, `A_1` and `A_2` those in the runs.

use std::sync::Arc;

use gdcm_model::dataset::state_space::StateSpaceError;
use gdcm_model::dataset::{Model, StateSpace};

use super::matrices::Matrices;

/// Ratio between the quadratic and the linear change in A, at the value found, above which a
/// caution reports a nonlinear effect (M18.7): the quadratic part is then more than half the linear
/// part, and extrapolation beyond the runs is doubtful.
pub const NOTABLE_CURVATURE: f64 = 0.5;

/// A run with one parameter moved by `z` plausible standard deviations.
#[derive(Clone, Copy, Debug)]
pub struct RunStep<'a> {
    /// The parameter's change divided by its plausible standard deviation; not zero.
    pub z: f64,
    /// The model at which the parameter is nominal.
    pub base: &'a StateSpace,
    /// The model with the parameter moved; same shape as `base`.
    pub run: &'a StateSpace,
}

impl RunStep<'_> {
    /// Returns whether the step is finite and not zero, and the run has its base's shape.
    pub(super) fn is_valid(&self) -> bool {
        self.z.is_finite() && self.z != 0.0 && model_shape(self.run) == model_shape(self.base)
    }
}

/// Returns the numbers of states, inputs and outputs.
pub(super) fn model_shape(model: &StateSpace) -> [usize; 3] {
    [model.order(), model.inputs(), model.outputs()]
}

/// How one parameter changes the matrices.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ParameterIncrement {
    /// `L`, per plausible standard deviation.
    pub(super) linear: Matrices,
    /// `Q`, per squared plausible standard deviation; `None` for a single run.
    pub(super) quadratic: Option<Matrices>,
}

impl ParameterIncrement {
    /// Computes `L` and `Q` from one or two runs; further runs are not used. Returns `None` without
    /// a run, if two runs have the same step, if a step is zero or not finite, or if a run differs
    /// in shape from its base.
    pub(super) fn from_runs(runs: &[RunStep<'_>]) -> Option<Self> {
        let first = runs.first()?;
        if !runs.iter().all(RunStep::is_valid) {
            return None;
        }
        let mut linear = Matrices::slope(first.run, first.base, first.z);
        let Some(second) = runs.get(1) else {
            return Some(Self {
                linear,
                quadratic: None,
            });
        };
        if first.z == second.z {
            return None;
        }
        let mut quadratic = linear.clone();
        quadratic.add(&Matrices::slope(second.run, second.base, second.z), -1.0);
        quadratic.scale(1.0 / (first.z - second.z));
        linear.add(&quadratic, -first.z);
        Some(Self {
            linear,
            quadratic: Some(quadratic),
        })
    }

    /// Adds the change at `z` to a model's matrices.
    pub(super) fn add_to(&self, model: &mut Matrices, z: f64) {
        if z == 0.0 {
            return;
        }
        model.add(&self.linear, z);
        if let Some(quadratic) = &self.quadratic {
            model.add(quadratic, z * z);
        }
    }

    /// Returns the derivative `L + 2 z Q`.
    pub(super) fn derivative(&self, z: f64) -> Matrices {
        let mut derivative = self.linear.clone();
        if let Some(quadratic) = &self.quadratic {
            derivative.add(quadratic, 2.0 * z);
        }
        derivative
    }

    /// Returns `|z| ||Q|| / ||L||` for the system matrix A: quadratic over linear change; 0 for a
    /// single run, and if A does not change.
    pub(super) fn curvature(&self, z: f64) -> f64 {
        let linear = self.linear.a.norm();
        match &self.quadratic {
            Some(quadratic) if linear > 0.0 => z.abs() * quadratic.a.norm() / linear,
            _ => 0.0,
        }
    }

    /// Returns the increment in the coordinates balanced by `scales`.
    pub(super) fn balanced(&self, scales: &[f64]) -> Self {
        Self {
            linear: self.linear.balanced(scales),
            quadratic: self
                .quadratic
                .as_ref()
                .map(|matrices| matrices.balanced(scales)),
        }
    }
}

/// How each parameter changes a condition's physics models, one increment per parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionIncrements {
    /// The base's state names; empty if unknown.
    states: Arc<[String]>,
    order: usize,
    inputs: usize,
    outputs: usize,
    pub(super) parameters: Vec<ParameterIncrement>,
}

/// Reasons why increments cannot be formed, or do not apply to a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IncrementError {
    /// A parameter has no run, two runs with the same step, a step that is zero or not finite, or a
    /// run that differs in shape from its base or from the other parameters' runs.
    #[error(
        "parameter number {parameter}: expected one run (a model linearised with the parameter \
        changed), or two with different steps other than 0"
    )]
    Runs {
        /// Parameter number, counted from 1.
        parameter: usize,
    },
    /// A model has other states than the base, or another number of inputs or outputs.
    #[error(
        "the states, or the numbers of inputs and outputs, differ from those of the model with nominal \
        parameters; write all models with the same states in the same order"
    )]
    States,
    /// A model is a measured response.
    #[error("expected a model with matrices, found a measured response")]
    Measured,
    /// There are more or fewer values than parameters.
    #[error("expected {expected} parameter values, found {found}")]
    Count { expected: usize, found: usize },
    /// The matrices with the changes are not finite.
    #[error(transparent)]
    StateSpace(#[from] StateSpaceError),
}

impl IncrementError {
    /// Returns the stable code used in files.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Runs { .. } => "increment-runs",
            Self::States => "increment-states-differ",
            Self::Measured => "increment-needs-matrices",
            Self::Count { .. } => "increment-value-count",
            Self::StateSpace(_) => "increment-not-finite",
        }
    }
}

impl ConditionIncrements {
    /// Computes a condition's increments from each parameter's runs; `base` gives the state names.
    ///
    /// # Errors
    /// [`IncrementError::Measured`] if `base` is a measured response; [`IncrementError::Runs`] if a
    /// parameter has no usable runs, or runs that differ from `base` in shape.
    pub fn new(base: &Model, runs: &[Vec<RunStep<'_>>]) -> Result<Self, IncrementError> {
        let Some(model) = base.state_space() else {
            return Err(IncrementError::Measured);
        };
        let mut parameters = Vec::with_capacity(runs.len());
        for (index, runs) in runs.iter().enumerate() {
            match ParameterIncrement::from_runs(runs) {
                Some(increment) if increment.linear.has_shape_of(model) => {
                    parameters.push(increment);
                }
                _ => {
                    return Err(IncrementError::Runs {
                        parameter: index + 1,
                    });
                }
            }
        }
        Ok(Self {
            states: Arc::clone(&base.states),
            order: model.order(),
            inputs: model.inputs(),
            outputs: model.outputs(),
            parameters,
        })
    }

    /// Returns the parameter count.
    pub fn parameters(&self) -> usize {
        self.parameters.len()
    }

    /// Returns whether a model has the base's shape and states: equally many states, inputs and
    /// outputs, and the same state names in the same order if both give names. `false` for a
    /// measured response.
    pub fn has_states_of(&self, model: &Model) -> bool {
        match model.state_space() {
            Some(matrices) => {
                matrices.order() == self.order
                    && matrices.inputs() == self.inputs
                    && matrices.outputs() == self.outputs
                    && (self.states.is_empty()
                        || model.states.is_empty()
                        || self.states == model.states)
            }
            None => false,
        }
    }

    /// Returns the matrices for one of the condition's models with the parameters at `z` (plausible
    /// standard deviations): `A(z) = A + sum_k (z_k L_k + z_k^2 Q_k)`, and likewise B, C and D.
    /// Sample time and delays stay.
    ///
    /// # Errors
    /// [`IncrementError`] for a measured model, for other states than the base's, if `z` has the
    /// wrong length, and for values at which the matrices are not finite.
    pub fn apply(&self, model: &Model, z: &[f64]) -> Result<StateSpace, IncrementError> {
        let Some(matrices) = model.state_space() else {
            return Err(IncrementError::Measured);
        };
        if !self.has_states_of(model) {
            return Err(IncrementError::States);
        }
        if z.len() != self.parameters.len() {
            return Err(IncrementError::Count {
                expected: self.parameters.len(),
                found: z.len(),
            });
        }
        let mut moved = Matrices::from_model(matrices);
        for (increment, &z) in self.parameters.iter().zip(z) {
            increment.add_to(&mut moved, z);
        }
        let moved = StateSpace::new(moved.a, moved.b, moved.c, moved.d)?;
        Ok(moved.timed(matrices.timing().clone())?)
    }

    /// Returns `|z| ||Q|| / ||L||` for the system matrix A, per parameter; above
    /// [`NOTABLE_CURVATURE`], a caution reports a nonlinear effect (M18.7).
    pub fn curvatures(&self, z: &[f64]) -> Vec<f64> {
        self.parameters
            .iter()
            .zip(z)
            .map(|(increment, &z)| increment.curvature(z))
            .collect()
    }
}
