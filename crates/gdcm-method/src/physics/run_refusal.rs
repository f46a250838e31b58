//! Why a run cannot be used (M18.1). A *run* is a physics model linearised with one named parameter
//! moved by a *step*, its *base* the condition's physics model at the same trim with the parameter
//! nominal.

/// A run that is not used, with the reason.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedRun {
    /// Name of the run's model.
    pub model: String,
    /// Name of the parameter that the run moves.
    pub parameter: String,
    pub reason: RunRefusal,
}

/// Reasons for which a run is not used.
#[derive(Clone, Debug, PartialEq)]
pub enum RunRefusal {
    /// No physics model in the condition has the run's perturbation.
    NoBase,
    /// The base is rejected or set aside.
    BaseNotUsed { base: String },
    /// The run or its base is a measured response.
    NoMatrices,
    /// Run and base differ in their counts of states, inputs or outputs.
    Shape {
        base: String,
        /// The base's states, inputs and outputs.
        expected: [usize; 3],
        /// The run's states, inputs and outputs.
        found: [usize; 3],
    },
    /// Run and base have different states, or the same states in another order.
    States {
        base: String,
        /// First differing state, counted from 1.
        position: usize,
        expected: String,
        found: String,
    },
    /// Run and base have different sample times or delays.
    Timing { base: String },
    /// The step is in another unit than the parameter.
    Unit { expected: String, found: String },
    /// The step is zero or not finite.
    Step { delta: f64 },
    /// The run's matrices equal the base's.
    NoChange { base: String },
    /// An earlier run for the parameter has the same step.
    StepRepeated { other: String, delta: f64 },
    /// An earlier run for the parameter has the same matrices, at another step.
    MatricesRepeated { other: String },
    /// Two earlier runs for the parameter are used already.
    TooMany,
}

impl RunRefusal {
    /// Returns the stable code used in files.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoBase => "run-without-base",
            Self::BaseNotUsed { .. } => "run-base-not-used",
            Self::NoMatrices => "run-without-matrices",
            Self::Shape { .. } => "run-shape-differs",
            Self::States { .. } => "run-states-differ",
            Self::Timing { .. } => "run-timing-differs",
            Self::Unit { .. } => "run-unit-differs",
            Self::Step { .. } => "run-step",
            Self::NoChange { .. } => "run-changes-nothing",
            Self::StepRepeated { .. } => "run-step-repeated",
            Self::MatricesRepeated { .. } => "run-repeats-another",
            Self::TooMany => "run-too-many",
        }
    }
}
