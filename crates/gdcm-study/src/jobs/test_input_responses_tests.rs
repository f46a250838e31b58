//! Responses of the models of the example to test inputs.

use std::sync::Arc;

use gdcm_method::correction::Pade;
use gdcm_method::requirements::{TestInput, TestInputShape};
use gdcm_model::dataset::BundleKind;
use gdcm_model::executor::Executor;
use gdcm_model::progress::Unobserved;

use super::couplings_tests::EXAMPLE;
use super::job::Job;
use super::requirement_jobs::TestAnswersJob;
use crate::results::requirement_role::RequirementRole;
use crate::results::test_input_responses::TestAnswers;

fn answers(test: TestInput) -> TestAnswers {
    let analysis = EXAMPLE.analysis.clone();
    let condition = *analysis.conditions.keys().next().unwrap();
    let job = TestAnswersJob {
        analysis: Arc::new(analysis).into(),
        condition,
        input: 1,
        test,
    };
    let executor: Box<dyn Executor> = Box::new(gdcm_model::executor::Sequential);
    TestAnswers::clone(&job.run(&mut { executor }, &Unobserved).unwrap().unwrap())
}

#[test]
fn every_model_answers_in_proportion_to_the_size_of_the_test() {
    let test = TestInput {
        shape: TestInputShape::Doublet,
        size: 1.0,
        duration_s: 1.0,
    };
    let one = answers(test);
    let three = answers(TestInput { size: 3.0, ..test });
    for ((role, small), (_, large)) in one.models.iter().zip(&three.models) {
        let small = small.as_ref().unwrap();
        let large = large.as_ref().unwrap();
        // The models are linear; the tolerance covers the rounding of a thousand steps.
        assert!(
            (3.0 * small - large).amax() <= 1e-9 * large.amax(),
            "{role:?}"
        );
        assert!(small.amax() > 0.0, "{role:?}");
    }
}

#[test]
fn the_corrected_model_answers_as_that_which_is_exported() {
    let test = TestInput {
        shape: TestInputShape::Step,
        size: 2.0,
        duration_s: 3.0,
    };
    let found = answers(test);
    let result = EXAMPLE.analysis.conditions[&found.condition]
        .as_ref()
        .unwrap();
    let physics = result.condition.model(
        BundleKind::Physics,
        result.representative_name(BundleKind::Physics),
    );
    let physics = physics.unwrap().state_space().unwrap();
    let exported = result
        .corrected_model(physics, &result.correction, Pade::default())
        .unwrap()
        .model;
    let expected = test
        .simulate(&exported, 1, found.sample_time_s, found.signal.len())
        .unwrap();
    let of = |role| {
        found
            .models
            .iter()
            .find(|of| of.0 == role)
            .unwrap()
            .1
            .as_ref()
            .unwrap()
    };
    assert_eq!(*of(RequirementRole::Corrected), expected);
    assert_ne!(*of(RequirementRole::Physics), expected);
}
