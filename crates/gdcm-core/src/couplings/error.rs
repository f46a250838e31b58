//! Why no couplings can be found.

use crate::dataset::ConditionId;
use crate::progress::Cancelled;
use crate::units::{number, telling};

/// Why no couplings can be found (M16.2).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// There is no condition, or none has a response that both representatives have.
    #[error("no response of the {conditions} conditions is known of both the physics model and flight")]
    NothingToFit {
        /// Number of conditions.
        conditions: usize,
    },
    /// Too few conditions for what is asked.
    #[error("error bars need at least {needed} conditions, and there are {found}")]
    TooFewConditions {
        /// How many it takes.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A condition's table has another shape than the others.
    #[error(
        "condition {condition}: expected {expected_outputs} x {expected_inputs} responses at {expected_points} \
         frequencies in every table, found {outputs} x {inputs} at {points}"
    )]
    Shape {
        /// The condition.
        condition: ConditionId,
        /// Outputs expected.
        expected_outputs: usize,
        /// Inputs expected.
        expected_inputs: usize,
        /// Frequencies expected.
        expected_points: usize,
        /// Outputs found.
        outputs: usize,
        /// Inputs found.
        inputs: usize,
        /// Frequencies found.
        points: usize,
    },
    /// The loop of a pass cannot be closed: `I - K H` is singular.
    #[error(
        "the feedback makes the loop of condition {condition} singular at {} rad/s",
        number(*omega_rad_s)
    )]
    SingularLoop {
        /// The condition.
        condition: ConditionId,
        /// The frequency \[rad/s\].
        omega_rad_s: f64,
    },
    /// The normal matrix has no Cholesky factors.
    #[error("the responses do not tell the {unknowns} entries of the mixing and the feedback apart")]
    SingularNormalMatrix {
        /// Number of unknowns.
        unknowns: usize,
    },
    /// The mixing takes an input away or turns it around.
    #[error(
        "the mixing multiplies input {input} by {} at {} kt, and only a positive number is a correction",
        telling(*factor, 3),
        number(*airspeed_kt)
    )]
    ReversedInput {
        /// The input, counted from 1.
        input: usize,
        /// The airspeed \[kt\].
        airspeed_kt: f64,
        /// `M_ii` there.
        factor: f64,
    },
    /// The work was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CouplingError {
    /// Why, in words that name the input.
    pub fn words(&self, inputs: &[String]) -> String {
        match self {
            Self::ReversedInput { input, .. } => {
                let name = inputs.get(input - 1).map_or("", String::as_str);
                self.to_string().replace(&format!("input {input}"), &format!("input {name}"))
            }
            other => other.to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_that_is_turned_around_is_named() {
        let error = CouplingError::ReversedInput { input: 2, airspeed_kt: 40.0, factor: -0.598_742_4 };
        let words = error.words(&["LON".to_owned(), "LAT".to_owned()]);
        assert!(words.starts_with("the mixing multiplies input LAT by -0.599 at 40 kt"), "{words}");
    }
}
