//! Tests of the sentences about the couplings in the example.

use std::sync::{Arc, LazyLock};

use gdcm_model::dataset::ConditionId;
use gdcm_study::results::couplings_assessment::{CouplingsAssessment, UnstablePole};
use gdcm_study::{CouplingCorrection, Engine, Unobserved};

use crate::couplings::{coupling_cautions, coupling_offer, coupling_remarks};
use crate::example_tests::EXAMPLE;
use crate::remark::RemarkKind;

/// Assessment of mixing and feedback for the reference dataset.
static ASSESSED: LazyLock<Arc<CouplingsAssessment>> = LazyLock::new(|| {
    Engine::default()
        .assess_couplings(
            &EXAMPLE.study,
            CouplingCorrection::MixingAndFeedback,
            &Unobserved,
        )
        .unwrap()
        .unwrap()
        .unwrap()
});

#[test]
fn the_diagnosis_comes_first() {
    let said = coupling_remarks(&ASSESSED, &EXAMPLE.study.dataset);
    let swashplate = said.iter().position(|of| {
        of.text.starts_with("LAT receives ") && of.text.contains("swashplate phase of ")
    });
    let verdict = said.iter().position(|of| {
        of.text
            .starts_with("Off-axis J of conditions left out of the fit is ")
    });
    assert!(swashplate.unwrap() < verdict.unwrap(), "{said:#?}");
    assert!(
        said.iter()
            .all(|of| !of.text.contains("switch the couplings off")),
        "{said:#?}"
    );
    assert!(coupling_offer(&ASSESSED).unwrap().starts_with(
        "With mixing and feedback, off-axis J of conditions left out of the fit would be "
    ));
}

#[test]
fn an_unstable_pole_in_the_band_is_told_before_faster_ones_beyond_it() {
    let unstable = |model: &str, real: f64, is_in_band: bool| UnstablePole {
        condition: ConditionId(4),
        model: model.to_owned(),
        is_representative: false,
        pole: nalgebra::Complex::from(real),
        is_in_band,
    };
    let mut assessed = (**ASSESSED).clone();
    assessed.unstable = vec![unstable("fast", 90.0, false), unstable("slow", 2.0, true)];
    assessed.left_out_fits.pop();
    let said = coupling_cautions(&assessed, &EXAMPLE.study.dataset);
    let poles = said
        .iter()
        .find(|of| of.text.contains("become unstable"))
        .unwrap();
    assert_eq!(poles.kind, RemarkKind::Trouble);
    let words = "2 poles of other kept physics models become unstable with the couplings: within \
                 the band, condition 4, slow at 2.000 rad/s; condition 4, fast at 90.000 rad/s.";
    assert_eq!(poles.text, words);
    assert!(
        said.iter()
            .any(|of| of.text.contains("are based on 10 of 11 conditions")),
        "{said:#?}"
    );
}

#[test]
fn without_leads_a_feedback_is_said_to_take_their_place() {
    assert_eq!(ASSESSED.want_leads, 0, "leads are given");
    let has_caution = |assessment: &CouplingsAssessment| {
        coupling_cautions(assessment, &EXAMPLE.study.dataset)
            .iter()
            .any(|remark| remark.code == "feedback-as-lead")
    };
    let mut assessed = (**ASSESSED).clone();
    assert!(!has_caution(&assessed));
    assessed.want_leads = 2;
    assert!(has_caution(&assessed));
    assessed.couplings = CouplingCorrection::Mixing;
    assert!(!has_caution(&assessed), "a mixing gives no lead");
}
