//! A physics model with mixing and feedback as matrices (M16.3).

use nalgebra::{DMatrix, Dyn, LU};

use super::CouplingMatrices;
use crate::correction::{ChannelCorrection, CorrectedModel, CorrectedModelError, Pade};
use crate::dataset::{StateSpace, StateSpaceError, Timing};
use crate::units::number;

/// Condition number of `I - D K` beyond which a loop through the feed-through is refused.
const WORST_CONDITION: f64 = 1e6;

/// Why mixing and feedback cannot be put on a model as matrices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CoupledModelError {
    /// The loop through the feed-through cannot be closed.
    #[error(
        "the feedback through its feed-through cannot be computed with: the condition number of I − D K is {}, and at most \
         {WORST_CONDITION:e} is allowed",
        number(*condition_number)
    )]
    AlgebraicLoop {
        /// Condition number of `I - D K`; infinite where it is singular.
        condition_number: f64,
    },
    /// It has other channels than the couplings.
    #[error(
        "it has {outputs} outputs and {inputs} inputs, and the couplings are of {expected_outputs} and {expected_inputs}"
    )]
    Channels {
        /// Its outputs.
        outputs: usize,
        /// Its inputs.
        inputs: usize,
        /// Outputs of the couplings.
        expected_outputs: usize,
        /// Inputs of the couplings.
        expected_inputs: usize,
    },
    /// The delays of its channels, which stand inside the loop, cannot become states.
    #[error(transparent)]
    Delays(#[from] CorrectedModelError),
    /// A product is not finite.
    #[error(transparent)]
    Matrices(#[from] StateSpaceError),
}

impl CoupledModelError {
    /// Why, in words that name the channels.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        match self {
            Self::Delays(error) => error.words(inputs, outputs),
            other => other.to_string(),
        }
    }
}

impl CouplingMatrices {
    /// The physics model with mixing and feedback, in continuous or discrete time; delays of its channels, which stand inside the loop,
    /// are states first: `pade` approximants, or whole samples.
    ///
    /// ```text
    /// K~ = K (I - D K)^-1
    /// A' = A + B K~ C,             B' = B (I + K~ D) M~
    /// C' = (I - D K)^-1 C,         D' = (I - D K)^-1 D M~
    /// ```
    ///
    /// # Errors
    /// [`CoupledModelError`] where the condition number of `I - D K` is over 1e6, the channels are others, or delays or numbers are not
    /// those of a model.
    pub fn model(&self, physics: &StateSpace, airspeed_kt: f64, pade: Pade) -> Result<StateSpace, CoupledModelError> {
        self.check_channels(physics)?;
        let physics = without_delays(physics, pade)?;
        let (a, b, c, d) = (physics.a(), physics.b(), physics.c(), physics.d());
        let (k, mixing) = (self.feedback(), self.normalised_mixing(airspeed_kt));
        let algebraic = algebraic_loop(d, k)?;
        let refused = || CoupledModelError::AlgebraicLoop { condition_number: f64::INFINITY };
        let c_closed = algebraic.solve(c).ok_or_else(refused)?;
        let d_closed = algebraic.solve(d).ok_or_else(refused)?;
        // K~ C = K (I - D K)^-1 C, and likewise with D.
        let a_closed = a + b * (k * &c_closed);
        let b_closed = (b + b * (k * &d_closed)) * &mixing;
        let model = StateSpace::new(a_closed, b_closed, c_closed, d_closed * mixing)?;
        Ok(model.timed(physics.timing().clone())?)
    }

    fn check_channels(&self, physics: &StateSpace) -> Result<(), CoupledModelError> {
        let (expected_inputs, expected_outputs) = self.feedback().shape();
        let (inputs, outputs) = (physics.inputs(), physics.outputs());
        if (inputs, outputs) == (expected_inputs, expected_outputs) {
            return Ok(());
        }
        Err(CoupledModelError::Channels { outputs, inputs, expected_outputs, expected_inputs })
    }
}

/// `I - D K` with its factors.
fn algebraic_loop(d: &DMatrix<f64>, k: &DMatrix<f64>) -> Result<LU<f64, Dyn, Dyn>, CoupledModelError> {
    let difference = DMatrix::identity(d.nrows(), d.nrows()) - d * k;
    let singular = difference.clone().svd(false, false).singular_values;
    let condition_number = singular.max() / singular.min();
    // Not a number, too, where D K overflows.
    if !condition_number.le(&WORST_CONDITION) {
        return Err(CoupledModelError::AlgebraicLoop { condition_number });
    }
    Ok(difference.lu())
}

/// The model with the delays of its channels as states.
pub(crate) fn without_delays(physics: &StateSpace, pade: Pade) -> Result<StateSpace, CorrectedModelError> {
    let timing = Timing { sample_time_s: physics.timing().sample_time_s, ..Timing::default() };
    if *physics.timing() == timing {
        return Ok(physics.clone());
    }
    let (inputs, outputs) = (physics.inputs(), physics.outputs());
    let no_correction = ChannelCorrection {
        input_gains: vec![1.0; inputs],
        output_gains: vec![1.0; outputs],
        input_delays_s: vec![0.0; inputs],
        output_delays_s: vec![0.0; outputs],
        leads: None,
    };
    Ok(CorrectedModel::of(physics, &no_correction, pade)?.model)
}
