//! Responses of the models of the example to test inputs.

use std::sync::Arc;

use nalgebra::DMatrix;

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

/// Returns the responses of the models of the first condition to a test of the second input.
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
fn the_response_of_every_model_is_proportional_to_the_size_of_the_test() {
    let test = TestInput {
        shape: TestInputShape::Doublet,
        size: 1.0,
        duration_s: 1.0,
    };
    let single = answers(test);
    let triple = answers(TestInput { size: 3.0, ..test });
    for ((role, small), (_, large)) in single.models.iter().zip(&triple.models) {
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
fn the_corrected_model_responds_as_the_exported_model() {
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
    assert_eq!(*response(&found, RequirementRole::Corrected), expected);
    assert_ne!(*response(&found, RequirementRole::Physics), expected);
}

/// Returns the outputs of the model in a role, samples x outputs.
fn response(answers: &TestAnswers, role: RequirementRole) -> &DMatrix<f64> {
    let (_, outputs) = answers
        .models
        .iter()
        .find(|(model_role, _)| *model_role == role)
        .unwrap();
    outputs.as_ref().unwrap()
}
