//! A physics model with mixing and feedback as state-space matrices (M16.3): inputs `u` and outputs
//! `y` with `y = H (u' + K y)`, `u' = M~ u`.

use nalgebra::{DMatrix, Dyn, LU};

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::state_space::{StateSpaceError, Timing};
use gdcm_model::units::number;

use super::coupling_matrices::CouplingMatrices;
use crate::correction::corrected_model::{CorrectedModel, CorrectedModelError};
use crate::correction::{ChannelCorrection, Pade};

/// Condition number of `I - D K` above which the algebraic loop through the feed-through is
/// rejected: beyond it, closing the loop loses more than six of about sixteen digits.
const WORST_CONDITION: f64 = 1e6;

/// Reasons why mixing and feedback cannot be applied to a model's matrices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CoupledModelError {
    /// The algebraic loop through the feed-through is singular or nearly so.
    #[error(
        "the loop through the feed-through cannot be closed: the condition number of I − D K is \
        {}, and at most {WORST_CONDITION:e} is allowed",
        number(*condition_number)
    )]
    AlgebraicLoop {
        /// Condition number of `I - D K`; infinite if singular.
        condition_number: f64,
    },
    /// The model and the couplings have different channel counts.
    #[error(
        "the model has {} outputs and {} inputs, but the couplings have {} and {}",
        found[0],
        found[1],
        expected[0],
        expected[1]
    )]
    Channels {
        /// The model's outputs and inputs.
        found: [usize; 2],
        /// The couplings' outputs and inputs.
        expected: [usize; 2],
    },
    /// The channel delays, which lie inside the loop, cannot be converted to states.
    #[error(transparent)]
    Delays(#[from] CorrectedModelError),
    /// A matrix in the coupled model is not finite.
    #[error(transparent)]
    Matrices(#[from] StateSpaceError),
}

impl CoupledModelError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::AlgebraicLoop { .. } => "algebraic-loop",
            Self::Channels { .. } => "channels-differ",
            Self::Delays(error) => error.code(),
            Self::Matrices(error) => error.code(),
        }
    }
}

impl CouplingMatrices {
    /// Builds the physics model with the normalised mixing `M~` and the feedback `K`, in continuous
    /// or discrete time. Channel delays, which lie inside the loop, are first converted to states:
    /// by the Padé approximant `pade`, or to whole samples.
    ///
    /// ```text
    /// K~ = K (I - D K)^-1
    /// A' = A + B K~ C,             B' = B (I + K~ D) M~
    /// C' = (I - D K)^-1 C,         D' = (I - D K)^-1 D M~
    /// ```
    ///
    /// # Errors
    /// [`CoupledModelError`] if the condition number of `I - D K` exceeds 1e6, the channel counts
    /// differ, the delays cannot be converted to states, or a matrix is not finite.
    pub fn model(
        &self,
        physics: &StateSpace,
        airspeed_kt: f64,
        pade: Pade,
    ) -> Result<StateSpace, CoupledModelError> {
        let (inputs, outputs) = self.feedback().shape();
        let found = [physics.outputs(), physics.inputs()];
        let expected = [outputs, inputs];
        if found != expected {
            return Err(CoupledModelError::Channels { found, expected });
        }
        let physics = without_delays(physics, pade)?;
        let a = physics.a();
        let b = physics.b();
        let c = physics.c();
        let d = physics.d();
        let k = self.feedback();
        let mixing = self.normalised_mixing(airspeed_kt);
        let algebraic = algebraic_loop(d, k)?;
        let (Some(c_closed), Some(d_closed)) = (algebraic.solve(c), algebraic.solve(d)) else {
            return Err(CoupledModelError::AlgebraicLoop {
                condition_number: f64::INFINITY,
            });
        };
        // `c_closed = (I - D K)^-1 C`, so that `K~ C = K c_closed`; likewise `d_closed` for D.
        let a_closed = a + b * (k * &c_closed);
        let b_closed = (b + b * (k * &d_closed)) * &mixing;
        let model = StateSpace::new(a_closed, b_closed, c_closed, d_closed * mixing)?;
        Ok(model.timed(physics.timing().clone())?)
    }
}

/// Factorises `I - D K`.
///
/// # Errors
/// [`CoupledModelError::AlgebraicLoop`] if its condition number exceeds 1e6.
fn algebraic_loop(
    d: &DMatrix<f64>,
    k: &DMatrix<f64>,
) -> Result<LU<f64, Dyn, Dyn>, CoupledModelError> {
    let difference = DMatrix::identity(d.nrows(), d.nrows()) - d * k;
    let singular_values = difference.clone().svd(false, false).singular_values;
    let condition_number = singular_values.max() / singular_values.min();
    // `!condition_number.le(...)` is also true for NaN, which results if D K overflows.
    if !condition_number.le(&WORST_CONDITION) {
        return Err(CoupledModelError::AlgebraicLoop { condition_number });
    }
    Ok(difference.lu())
}

/// Returns the model with its channel delays converted to states, in continuous time by the
/// approximant `pade`.
///
/// # Errors
/// [`CorrectedModelError`] if the delays need more states than a model may have, or if a
/// discrete-time delay is not a whole number of samples.
pub fn without_delays(physics: &StateSpace, pade: Pade) -> Result<StateSpace, CorrectedModelError> {
    let timing = Timing {
        sample_time_s: physics.timing().sample_time_s,
        ..Timing::default()
    };
    if *physics.timing() == timing {
        return Ok(physics.clone());
    }
    let inputs = physics.inputs();
    let outputs = physics.outputs();
    let no_correction = ChannelCorrection {
        input_gains: vec![1.0; inputs],
        output_gains: vec![1.0; outputs],
        input_delays_s: vec![0.0; inputs],
        output_delays_s: vec![0.0; outputs],
        leads: None,
    };
    Ok(CorrectedModel::new(physics, &no_correction, pade)?.model)
}
