//! Reasons for rejections, decisions kept under names (variants), and the differences between
//! variants.

use std::sync::Arc;

use gdcm_model::dataset::{Dataset, ModelId};
use gdcm_study::decisions::dataset_differences::{CarriedDecision, Difference};
use gdcm_study::decisions::edit::LONGEST_REASON;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::decisions::history::History;
use gdcm_study::jobs::analysis_jobs::VariantJob;
use gdcm_study::jobs::job::Job;

use super::*;

fn nominal_of_10() -> ModelId {
    ModelId::new(ConditionId(10), BundleKind::Physics, "nominal")
}

fn apply(study: &mut Study, edits: &[Edit]) {
    for edit in edits {
        study.apply(edit).unwrap();
    }
}

fn store(name: &str) -> Edit {
    Edit::StoreVariant {
        name: name.to_owned(),
    }
}

/// Returns the example without its last condition, as if its file had been changed.
fn shorter_example() -> Arc<Dataset> {
    let dataset = &crate::REFERENCE_DATASET.dataset;
    let conditions = dataset
        .conditions()
        .iter()
        .filter(|condition| condition.id() != ConditionId(10));
    Arc::new(
        Dataset::new(
            dataset.header(),
            conditions.map(|condition| (**condition).clone()).collect(),
        )
        .unwrap(),
    )
}

#[test]
fn a_rejection_carries_its_reason_and_a_restored_model_has_none() {
    let mut study = study_of_example();
    let model = nominal_of_10();
    let reason = |text: &str| Edit::SetReason(model.clone(), text.to_owned());
    assert!(matches!(
        study.apply(&reason("why")),
        Err(EditRefusal::ReasonOfKept { .. })
    ));
    apply(
        &mut study,
        &[Edit::RejectBecause {
            model: model.clone(),
            reason: " step at 62 kt ".to_owned(),
        }],
    );
    assert_eq!(
        (study.is_rejected(&model), study.reason(&model)),
        (true, Some("step at 62 kt"))
    );
    assert!(matches!(
        study.apply(&reason(&"x".repeat(LONGEST_REASON + 1))),
        Err(EditRefusal::TooLong { most: 1000, .. })
    ));
    apply(
        &mut study,
        &[reason("inflow"), Edit::Restore(model.clone())],
    );
    assert_eq!(
        (study.is_rejected(&model), study.reason(&model)),
        (false, None)
    );
    apply(
        &mut study,
        &[
            Edit::Reject(model.clone()),
            reason("a"),
            Edit::RestoreAll {
                condition: ConditionId(10),
            },
        ],
    );
    apply(&mut study, &[Edit::Reject(model.clone())]);
    assert_eq!(
        study.reason(&model),
        None,
        "restoring the model should remove the reason"
    );
    apply(&mut study, &[reason("a"), reason("")]);
    assert_eq!(study.reason(&model), None);
}

#[test]
fn undo_reverts_a_rejection_and_its_reason_and_a_refused_one_changes_nothing() {
    let mut study = study_of_example();
    let mut history: History = History::default();
    let edit = Edit::RejectBecause {
        model: nominal_of_10(),
        reason: "step".to_owned(),
    };
    let before = study.clone();
    apply(&mut study, std::slice::from_ref(&edit));
    history.record(before.clone(), &edit);
    assert_eq!(history.undo(&study, |()| ()), Some(before.clone()));
    assert_eq!(history.redo(&before, |()| ()), Some(study.clone()));
    let too_long = Edit::RejectBecause {
        model: nominal_of_10(),
        reason: "x".repeat(LONGEST_REASON + 1),
    };
    let mut fresh = study_of_example();
    assert!(fresh.apply(&too_long).is_err());
    assert_eq!(fresh, study_of_example());
}

#[test]
fn reasons_and_variants_change_no_result_and_reasons_are_exported() {
    let mut study = study_of_example();
    let mut engine = Engine::default();
    apply(
        &mut study,
        &[setting_table::POINTS.to(40), Edit::Reject(nominal_of_10())],
    );
    let without = analyze(&mut engine, &study);
    apply(
        &mut study,
        &[
            Edit::SetReason(nominal_of_10(), "step".to_owned()),
            store("a"),
        ],
    );
    let with = analyze(&mut engine, &study);
    let before = without.condition(ConditionId(10)).unwrap();
    let after = with.condition(ConditionId(10)).unwrap();
    assert!(
        Arc::ptr_eq(&before.comparison, &after.comparison),
        "the comparison should not be computed again"
    );
    let folder = tempfile::tempdir().unwrap();
    let outputs = gdcm_io::output_set::OutputSet::new(gdcm_io::Existing::Replace, Vec::new());
    let all = with.conditions.keys().copied().collect();
    gdcm_io::files::corrections_file::write_results(&with, "", &all, folder.path(), outputs)
        .unwrap();
    let written = json(&std::fs::read_to_string(folder.path().join("corrections.json")).unwrap());
    let condition = list(&written["conditions"])
        .iter()
        .find(|condition| condition["id"] == 10)
        .unwrap();
    assert_eq!(condition["rejected"], serde_json::json!(["nominal"]));
    assert_eq!(
        condition["reasons"],
        serde_json::json!([{"bundle": "physics", "model": "nominal", "why": "step"}])
    );
}

#[test]
fn applying_a_variant_restores_its_decisions_and_keeps_the_variant() {
    let mut study = study_of_example();
    apply(
        &mut study,
        &[
            setting_table::ALPHA_GAIN.to(0.1),
            store(" soft "),
            setting_table::ALPHA_GAIN.to(9.0),
        ],
    );
    let before = study.clone();
    apply(
        &mut study,
        &[Edit::ApplyVariant {
            name: "soft".to_owned(),
        }],
    );
    assert_eq!((study.settings.alpha_gain, study.variants.len()), (0.1, 1));
    assert_eq!(before.of_variant("soft").unwrap().settings, study.settings);
    assert_ne!(before, study);
}

#[test]
fn names_of_variants_are_unique_and_variants_can_be_renamed_and_removed() {
    let mut study = study_of_example();
    apply(&mut study, &[store("a"), store("b")]);
    let refused = |study: &mut Study, edit: Edit| study.apply(&edit).unwrap_err();
    let exists = |name: &str| EditRefusal::VariantExists {
        name: name.to_owned(),
    };
    assert_eq!(refused(&mut study, store("a")), exists("a"));
    assert_eq!(
        refused(&mut study, store("  ")),
        EditRefusal::VariantWithoutName
    );
    assert!(matches!(
        refused(&mut study, store(&"x".repeat(61))),
        EditRefusal::TooLong {
            most: 60,
            found: 61,
            ..
        }
    ));
    let rename = |from: &str, to: &str| Edit::RenameVariant {
        from: from.to_owned(),
        to: to.to_owned(),
    };
    assert_eq!(refused(&mut study, rename("a", "b")), exists("b"));
    apply(
        &mut study,
        &[
            rename("a", "a "),
            rename("a", "c"),
            Edit::RemoveVariant {
                name: "b".to_owned(),
            },
        ],
    );
    assert_eq!(
        study
            .variants
            .iter()
            .map(|variant| variant.name.as_str())
            .collect::<Vec<_>>(),
        ["c"]
    );
    let name = "b".to_owned();
    let unknown = Edit::ApplyVariant { name: name.clone() };
    assert_eq!(
        refused(&mut study, unknown),
        EditRefusal::NoVariant { name }
    );
}

#[test]
fn a_variant_is_analysed_like_a_study_with_its_decisions() {
    let mut study = study_of_example();
    apply(
        &mut study,
        &[
            setting_table::POINTS.to(40),
            setting_table::ALPHA_GAIN.to(0.01),
            store("soft"),
        ],
    );
    apply(
        &mut study,
        &[
            setting_table::ALPHA_GAIN.to(1.0),
            Edit::Reject(nominal_of_10()),
        ],
    );
    let job = VariantJob {
        study: study.of_variant("soft").unwrap(),
    };
    let mut engine = Engine::default();
    analyze(&mut engine, &study);
    let found = job.run(&mut engine, &Unobserved).unwrap();
    assert_eq!(
        *found,
        analyze(&mut Engine::default(), &study.of_variant("soft").unwrap())
    );
    let mut reworded = study.of_variant("soft").unwrap();
    assert_eq!(
        job,
        VariantJob {
            study: reworded.clone()
        }
    );
    apply(&mut reworded, &[Edit::Reject(nominal_of_10())]);
    let rejected = VariantJob {
        study: reworded.clone(),
    };
    assert_ne!(job, rejected);
    apply(
        &mut reworded,
        &[Edit::SetReason(nominal_of_10(), "step".to_owned())],
    );
    assert_eq!(rejected, VariantJob { study: reworded });
}

#[test]
fn reasons_and_variants_are_reconciled_to_a_changed_dataset() {
    let mut study = study_of_example();
    let other = ModelId::new(ConditionId(3), BundleKind::Physics, "nominal");
    let because = |model: &ModelId| Edit::RejectBecause {
        model: model.clone(),
        reason: "step".to_owned(),
    };
    apply(
        &mut study,
        &[
            because(&other),
            because(&nominal_of_10()),
            store("strict"),
            Edit::Restore(nominal_of_10()),
        ],
    );
    let (carried, differences) = study.reconciled(shorter_example());
    assert_eq!(carried.reason(&other), Some("step"));
    let variant = carried.of_variant("strict").unwrap();
    assert_eq!(
        (variant.reason(&other), variant.choices.len()),
        (Some("step"), 10)
    );
    assert!(
        differences.iter().any(|difference| matches!(
            difference,
            Difference::NotApplied {
                decision: CarriedDecision::Edit {
                    edit: Edit::RejectBecause { model, .. } | Edit::Reject(model),
                    ..
                },
                variant: Some(variant),
                ..
            } if *model == nominal_of_10() && variant == "strict"
        )),
        "{differences:?}"
    );
}
