//! Responses to a test input from a condition's models, for plots (M17.2); there is no measurement
//! to compare them with. In names, such a response is an *answer*.

use nalgebra::DMatrix;

use gdcm_method::requirements::TestInput;
use gdcm_method::requirements::test_input::TestInputError;
use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::{Executor, each};

use super::analysis::{Analysis, NoResult};
use super::requirement_role::{RequirementRole, RoleModelError};

/// Displayed time, as a multiple of the test input's duration.
const SHOWN_DURATIONS: f64 = 5.0;

/// Minimum displayed time \[s\].
const LEAST_SHOWN_S: f64 = 10.0;

/// Number of sample intervals in the displayed time.
const STEPS: usize = 1000;

/// Why a model has no response to a test input.
#[derive(Clone, Debug, PartialEq)]
pub enum NoTestAnswer {
    NoModel(RoleModelError),
    NotSimulated(TestInputError),
}

impl NoTestAnswer {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoModel(_) => "no-role-model",
            Self::NotSimulated(_) => "not-simulated",
        }
    }
}

/// Responses to a test input, from a condition's models starting at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct TestAnswers {
    pub condition: ConditionId,
    pub input: usize,
    /// Test input: shape, amplitude and duration.
    pub test: TestInput,
    /// Sample time \[s\]; the first sample is at 0 s.
    pub sample_time_s: f64,
    /// The input at every sample, in its unit.
    pub signal: Vec<f64>,
    /// Each model's outputs, samples x outputs, in their units.
    pub models: Vec<(RequirementRole, Result<DMatrix<f64>, NoTestAnswer>)>,
}

impl TestAnswers {
    /// Simulates a condition's models with a test input in an input channel.
    ///
    /// # Errors
    /// [`NoResult`] without a result for the condition.
    pub(crate) fn new(
        analysis: &Analysis,
        condition: ConditionId,
        input: usize,
        test: TestInput,
        executor: &dyn Executor,
    ) -> Result<Self, NoResult> {
        let result = analysis.result(condition)?;
        let sample_time_s = LEAST_SHOWN_S.max(SHOWN_DURATIONS * test.duration_s) / STEPS as f64;
        let answers = each(executor, &RequirementRole::ALL, |role| {
            let model = analysis
                .role_model(result, *role)
                .map_err(NoTestAnswer::NoModel)?;
            test.simulate(&model, input, sample_time_s, STEPS + 1)
                .map_err(NoTestAnswer::NotSimulated)
        });
        Ok(Self {
            condition,
            input,
            test,
            sample_time_s,
            signal: test.signal(sample_time_s, STEPS + 1),
            models: RequirementRole::ALL.into_iter().zip(answers).collect(),
        })
    }

    /// Returns the samples' times \[s\].
    pub fn time_s(&self) -> Vec<f64> {
        (0..self.signal.len())
            .map(|sample| sample as f64 * self.sample_time_s)
            .collect()
    }
}
