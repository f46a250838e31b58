//! Tests of the remarks on the couplings in the example.

use std::sync::{Arc, LazyLock};

use gdcm_model::dataset::ConditionId;
use gdcm_study::results::coupling_remark::{CostSource, CouplingRemark};
use gdcm_study::results::coupling_remark_search::{
    coupling_cautions, coupling_offer, coupling_remarks,
};
use gdcm_study::results::couplings_assessment::{CouplingsAssessment, UnstablePole};
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_study::{CouplingCorrection, Engine, Unobserved};

use crate::coupling_remark::coupling_remark_text;
use crate::example_tests::EXAMPLE;

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
fn the_diagnosis_precedes_the_verdict_on_costs() {
    let remarks = coupling_remarks(&ASSESSED, &EXAMPLE.study.dataset);
    let swashplate = remarks.iter().position(|remark| {
        matches!(remark, CouplingRemark::Mixing(share)
            if share.to == 1 && share.swashplate_phase_deg.is_some())
    });
    let verdict = remarks.iter().position(|remark| {
        matches!(remark, CouplingRemark::Costs(benefit) if benefit.source == CostSource::LeftOut)
    });
    let swashplate = swashplate.unwrap();
    assert!(swashplate < verdict.unwrap(), "{remarks:#?}");
    // Channel 1 is LAT.
    let words = coupling_remark_text(&remarks[swashplate], &EXAMPLE.study.dataset);
    assert!(words.starts_with("LAT receives "), "{words}");
    assert!(
        remarks
            .iter()
            .all(|remark| remark.code() != "couplings-not-worthwhile"),
        "{remarks:#?}"
    );
    let offer = coupling_offer(&ASSESSED).unwrap();
    assert_eq!(offer.code(), "couplings-offered");
}

#[test]
fn an_unstable_pole_in_the_band_precedes_a_faster_one_above_it() {
    let unstable = |model: &str, real: f64, is_in_band: bool| UnstablePole {
        condition: ConditionId(4),
        model: model.to_owned(),
        is_representative: false,
        pole: nalgebra::Complex::from(real),
        is_in_band,
    };
    let mut assessed = (**ASSESSED).clone();
    assessed.unstable = vec![unstable("fast", 90.0, false), unstable("slow", 2.0, true)];
    // One of the eleven fits without a condition failed.
    assessed.left_out_fits.pop();
    let cautions = coupling_cautions(&assessed);
    let poles = cautions
        .iter()
        .find(|caution| caution.code() == "newly-unstable")
        .unwrap();
    assert_eq!(poles.kind(), RemarkKind::Trouble);
    let words = "2 poles of other kept physics models become unstable with the couplings: within \
                 the band, condition 4, slow at 2.000 rad/s; condition 4, fast at 90.000 rad/s.";
    assert_eq!(coupling_remark_text(poles, &EXAMPLE.study.dataset), words);
    assert!(
        cautions.contains(&CouplingRemark::PartlyLeftOut {
            fits: 10,
            conditions: 11
        }),
        "{cautions:#?}"
    );
}

#[test]
fn feedback_without_leads_has_a_caution_that_it_replaces_them() {
    assert_eq!(ASSESSED.unused_lead_offers, 0, "leads are on");
    let has_caution = |assessment: &CouplingsAssessment| {
        coupling_cautions(assessment)
            .iter()
            .any(|remark| remark.code() == "feedback-as-lead")
    };
    let mut assessed = (**ASSESSED).clone();
    assert!(!has_caution(&assessed));
    assessed.unused_lead_offers = 2;
    assert!(has_caution(&assessed));
    assessed.couplings = CouplingCorrection::Mixing;
    assert!(!has_caution(&assessed), "mixing adds no lead");
}
