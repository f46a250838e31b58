//! What the models of a condition answer to a test input, where no flight record is there to compare them with (M17.2).

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::dataset::ConditionId;
use crate::executor::{Executor, each};
use crate::requirements::TestInput;

use super::{Analysis, Cancelled, Job, Progress, RequirementRole};

/// Time shown, as a multiple of the duration of the test.
const SHOWN: f64 = 5.0;
/// The least time shown \[s\].
const LEAST_SHOWN_S: f64 = 10.0;
/// Sample times that the time shown has.
const STEPS: usize = 1000;

/// What the models of a condition answer to a test input from rest.
#[derive(Clone, Debug, PartialEq)]
pub struct TestAnswers {
    /// The condition.
    pub condition: ConditionId,
    /// Index of the input that is moved.
    pub input: usize,
    /// How it is moved.
    pub test: TestInput,
    /// Sample time \[s\]; the first sample is at 0 s.
    pub sample_time_s: f64,
    /// The input at every sample, in its unit.
    pub signal: Vec<f64>,
    /// Outputs of each model, samples x outputs, in their units; in words why there are none.
    pub models: Vec<(RequirementRole, Result<DMatrix<f64>, String>)>,
}

impl TestAnswers {
    fn of(job: &TestAnswersJob, executor: &dyn Executor) -> Result<Self, String> {
        let TestAnswersJob { analysis, condition, input, test } = job;
        let (condition, input) = (*condition, *input);
        let result = match analysis.conditions.get(&condition) {
            Some(Ok(result)) => result,
            Some(Err(failure)) => return Err(failure.to_string()),
            None => return Err("it was not analysed".to_owned()),
        };
        let sample_time_s = LEAST_SHOWN_S.max(SHOWN * test.duration_s) / STEPS as f64;
        let answer = |role: &RequirementRole| {
            let model = analysis.role_model(result, *role).map_err(|error| error.to_string())?;
            test.answer(&model, input, sample_time_s, STEPS + 1).map_err(|error| error.to_string())
        };
        let answers = each(executor, &RequirementRole::ALL, answer);
        let signal = test.signal(sample_time_s, STEPS + 1);
        let models = RequirementRole::ALL.into_iter().zip(answers).collect();
        Ok(Self { condition, input, test: *test, sample_time_s, signal, models })
    }

    /// The times of the samples \[s\].
    pub fn time_s(&self) -> Vec<f64> {
        (0..self.signal.len()).map(|n| n as f64 * self.sample_time_s).collect()
    }
}

/// The answers of the models of a condition to the test input of the study, beside the live answer.
#[derive(Clone, Debug)]
pub struct TestAnswersJob {
    /// The analysis.
    pub analysis: Arc<Analysis>,
    /// The condition.
    pub condition: ConditionId,
    /// Index of the input that is moved.
    pub input: usize,
    /// How it is moved.
    pub test: TestInput,
}

impl PartialEq for TestAnswersJob {
    fn eq(&self, other: &Self) -> bool {
        let same_analysis = Arc::ptr_eq(&self.analysis, &other.analysis);
        same_analysis && (self.condition, self.input, self.test) == (other.condition, other.input, other.test)
    }
}

impl Job for TestAnswersJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    /// In words why there are none.
    type Output = Result<Arc<TestAnswers>, String>;

    fn run(&self, executor: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let found = TestAnswers::of(self, executor.as_ref()).map(Arc::new);
        if progress.cancelled() { Err(Cancelled) } else { Ok(found) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::Pade;
    use crate::dataset::BundleKind;
    use crate::requirements::TestInputShape;
    use crate::study::Unobserved;
    use crate::study::couplings_example_tests::EXAMPLE;

    fn answers(test: TestInput) -> TestAnswers {
        let analysis = EXAMPLE.analysis.clone();
        let condition = *analysis.conditions.keys().next().unwrap();
        let job = TestAnswersJob { analysis: Arc::new(analysis), condition, input: 1, test };
        let executor: Box<dyn Executor> = Box::new(crate::executor::Sequential);
        TestAnswers::clone(&job.run(&mut { executor }, &Unobserved).unwrap().unwrap())
    }

    #[test]
    fn every_model_answers_in_proportion_to_the_size_of_the_test() {
        let test = TestInput { shape: TestInputShape::Doublet, size: 1.0, duration_s: 1.0 };
        let (one, three) = (answers(test), answers(TestInput { size: 3.0, ..test }));
        for ((role, small), (_, large)) in one.models.iter().zip(&three.models) {
            let (small, large) = (small.as_ref().unwrap(), large.as_ref().unwrap());
            // Linear models; rounding of a thousand steps.
            assert!((3.0 * small - large).amax() <= 1e-9 * large.amax(), "{role:?}");
            assert!(small.amax() > 0.0, "{role:?}");
        }
    }

    #[test]
    fn the_corrected_model_answers_as_that_which_is_exported() {
        let test = TestInput { shape: TestInputShape::Step, size: 2.0, duration_s: 3.0 };
        let found = answers(test);
        let result = EXAMPLE.analysis.conditions[&found.condition].as_ref().unwrap();
        let physics = result.condition.model(BundleKind::Physics, result.representative_name(BundleKind::Physics));
        let physics = physics.unwrap().state_space().unwrap();
        let exported = result.corrected_model(physics, &result.correction, Pade::default()).unwrap().model;
        let expected = test.answer(&exported, 1, found.sample_time_s, found.signal.len()).unwrap();
        let of = |role| found.models.iter().find(|of| of.0 == role).unwrap().1.as_ref().unwrap();
        assert_eq!(*of(RequirementRole::Corrected), expected);
        assert_ne!(*of(RequirementRole::Physics), expected);
    }
}
