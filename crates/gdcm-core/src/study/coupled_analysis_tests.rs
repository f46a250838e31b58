//! Mixing and feedback through the engine: the known answers of the reference dataset, and what makes it fit again.

use std::sync::{Arc, LazyLock};

use super::couplings_example_tests::{EXAMPLE, FEEDBACK, REFERENCE, assert_close, fit, mean_costs, number, numbers};
use super::*;
use crate::couplings::CouplingKind;
use crate::dataset::{BundleKind, ConditionId, ModelId, Pair, PairTable};

/// The study of the reference dataset with leads and these couplings.
fn study(couplings: CouplingCorrection) -> Study {
    let mut study = EXAMPLE.analysis.study.clone();
    study.apply(&setting::COUPLINGS.to(couplings)).unwrap();
    study
}

fn analyze(engine: &mut Engine, study: &Study) -> Analysis {
    engine.analyze(study, &Unobserved).unwrap()
}

/// An engine that has analysed the example with mixing and feedback, and what it found.
pub(super) static COUPLED: LazyLock<(Engine, Analysis)> = LazyLock::new(|| {
    let mut engine = Engine::default();
    let analysis = analyze(&mut engine, &study(CouplingCorrection::MixingAndFeedback));
    (engine, analysis)
});

/// The engine of [`COUPLED`], which each test changes for itself.
pub(super) fn engine() -> Engine {
    COUPLED.0.fork(Box::new(crate::executor::Sequential))
}

/// `[on-axis, others]` of the mean J of each condition's own correction, and of the scheduled one.
pub(super) fn own_and_scheduled(analysis: &Analysis) -> [[f64; 2]; 2] {
    let results = analysis.conditions.values().map(|result| result.as_ref().unwrap());
    let own = mean_costs(results.map(|result| (*result.cost).clone()));
    let choice = AssessmentChoice {
        model: AssessedModel::Representative,
        correction: AssessedCorrection::Scheduled,
        average: analysis.study.settings.cost_average,
    };
    let table = AssessmentTable::of(analysis, choice);
    let change = |id: ConditionId| PairTable::from_fn(6, 4, |pair| table.change(id, pair));
    [own, mean_costs(analysis.conditions.keys().map(|&id| change(id)))]
}

fn agrees(analysis: &Analysis, name: &str) {
    let mean_cost = &REFERENCE["example"][name]["mean_J"];
    let tolerance = number(&REFERENCE["tolerance"]["mean_J"]);
    let [own, scheduled] = own_and_scheduled(analysis);
    assert_close("own J", &own, &numbers(&mean_cost["own"]), tolerance);
    assert_close("scheduled J", &scheduled, &numbers(&mean_cost["scheduled"]), tolerance);
}

#[test]
fn the_engine_with_mixing_and_feedback_gives_the_known_answers() {
    let analysis = &COUPLED.1;
    assert_eq!(analysis.fitted_couplings().unwrap().fit, *FEEDBACK);
    agrees(analysis, "feedback");
    for (id, result) in &analysis.conditions {
        let (result, before) = (result.as_ref().unwrap(), EXAMPLE.analysis.condition(*id).unwrap());
        let representatives =
            |of: &ConditionAnalysis| BundleKind::BOTH.map(|kind| of.representative_name(kind).to_owned());
        assert_eq!(representatives(result), representatives(before), "decided on the models as they are");
        assert_eq!(result.suggested(), before.suggested());
        assert_eq!(result.before_couplings(), &*before.comparison);
        assert_eq!(result.doubts, before.doubts);
    }
}

#[test]
fn the_engine_with_mixing_gives_the_known_answers() {
    let analysis = analyze(&mut engine(), &study(CouplingCorrection::Mixing));
    assert_eq!(analysis.fitted_couplings().unwrap().fit, fit(&EXAMPLE.problem(CouplingKind::Mixing)));
    agrees(&analysis, "mixing");
}

#[test]
fn without_couplings_every_number_is_as_if_there_were_none() {
    let found = analyze(&mut engine(), &study(CouplingCorrection::None));
    assert!(found.couplings.is_none());
    assert_eq!(found, EXAMPLE.analysis);
    let coupled = analyze(&mut engine(), &study(CouplingCorrection::MixingAndFeedback));
    assert_eq!(coupled, COUPLED.1, "nor does what was computed between change anything");
}

#[test]
fn a_drag_of_the_gains_weight_does_not_fit_again() {
    let mut study = study(CouplingCorrection::MixingAndFeedback);
    study.apply(&setting::ALPHA_GAIN.to(0.2)).unwrap();
    study.apply(&setting::AGREEMENT.to(0.1)).unwrap();
    let analysis = analyze(&mut engine(), &study);
    assert!(Arc::ptr_eq(analysis.fitted_couplings().unwrap(), COUPLED.1.fitted_couplings().unwrap()));
    let id = *analysis.conditions.keys().next().unwrap();
    assert_ne!(analysis.condition(id).unwrap().gains, COUPLED.1.condition(id).unwrap().gains);
    study.settings.points = 150;
    assert_ne!(analyze(&mut engine(), &study).fitted_couplings(), COUPLED.1.fitted_couplings(), "other frequencies do");
}

#[test]
fn a_condition_held_out_does_not_enter_the_fit() {
    let mut study = study(CouplingCorrection::MixingAndFeedback);
    let held_out = ConditionId(3);
    study.apply(&Edit::SetHeldOut { condition: held_out, held_out: true }).unwrap();
    let mut engine = engine();
    let analysis = analyze(&mut engine, &study);
    let couplings = analysis.fitted_couplings().unwrap();
    assert!(!couplings.is_fitted_to(held_out) && couplings.problem.conditions.len() == 10);
    assert_ne!(couplings.fit, *FEEDBACK);
    let result = analysis.condition(held_out).unwrap();
    assert_ne!(&*result.comparison, result.before_couplings(), "but it is coupled too");
    // Another identified model of it changes nothing of the fit.
    let mut other = result.condition.bundle(BundleKind::Identified).iter().map(|model| &model.name);
    let other = other.rfind(|name| *name != result.representative_name(BundleKind::Identified)).unwrap();
    study.apply(&Edit::Pin(ModelId::new(held_out, BundleKind::Identified, other))).unwrap();
    let pinned = analyze(&mut engine, &study);
    assert!(Arc::ptr_eq(pinned.fitted_couplings().unwrap(), couplings));
    assert_ne!(pinned.condition(held_out).unwrap().comparison, result.comparison);
}

#[test]
fn couplings_that_cannot_be_fitted_are_refused_in_words_and_leave_the_models_as_they_are() {
    let mut study = study(CouplingCorrection::MixingAndFeedback);
    for &condition in EXAMPLE.analysis.conditions.keys() {
        study.apply(&Edit::SetHeldOut { condition, held_out: true }).unwrap();
    }
    let analysis = analyze(&mut engine(), &study);
    let refusal = analysis.couplings.as_ref().unwrap().as_ref().unwrap_err();
    assert!(refusal.to_string().starts_with("no response of the 0 conditions"), "{refusal}");
    let result = analysis.condition(ConditionId(1)).unwrap();
    assert_eq!(result.comparison, EXAMPLE.analysis.condition(ConditionId(1)).unwrap().comparison);
    assert!(result.coupled.is_none());
}

#[test]
fn error_bars_are_of_physics_models_with_the_couplings_of_the_representatives() {
    let mut engine = engine();
    let id = ConditionId(1);
    let pair = EXAMPLE.dataset.on_axis().marked().next().unwrap();
    let bar = |engine: &mut Engine, analysis: &Analysis| {
        let uncertainty = engine.uncertainty(analysis, &Unobserved).unwrap();
        *uncertainty.bar(id, crate::uncertainty::Scalar::Gain(pair)).unwrap()
    };
    let with = bar(&mut engine, &COUPLED.1);
    let without = bar(&mut engine, &EXAMPLE.analysis);
    let gain = |analysis: &Analysis, pair: Pair| analysis.condition(id).unwrap().wanted_gain(pair).unwrap();
    assert!((with.value - gain(&COUPLED.1, pair).ln()).abs() < 1e-12);
    assert!((without.value - gain(&EXAMPLE.analysis, pair).ln()).abs() < 1e-12);
    assert_ne!(with, without);
    assert_eq!(bar(&mut engine, &COUPLED.1), with);
}
