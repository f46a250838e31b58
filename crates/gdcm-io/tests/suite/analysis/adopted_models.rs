//! Adopted models, which replace the identified models of the dataset.

use std::sync::Arc;

use gdcm_io::embedded_example;
use gdcm_model::dataset::{BundleKind, ConditionId, Model, ModelId};
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::{Edit, Study};

fn example_study() -> Study {
    Study::new(embedded_example().unwrap().dataset)
}

/// Returns the identified models of condition 1 under other names.
fn renamed_models(study: &Study) -> Arc<AdoptedModels> {
    let models = study.dataset.conditions()[0].bundle(BundleKind::Identified);
    let renamed = |model: &Model| Model {
        name: format!("{} again", model.name),
        ..model.clone()
    };
    Arc::new(AdoptedModels {
        models: models.iter().map(renamed).collect(),
        records: Vec::new(),
    })
}

#[test]
fn adopted_models_replace_those_of_the_file_and_end_decisions_about_them() {
    let mut study = example_study();
    let before = study.clone();
    let id = ConditionId(1);
    let first_name = study.dataset.conditions()[0].bundle(BundleKind::Identified)[0]
        .name
        .clone();
    study
        .apply(&Edit::Pin(ModelId::new(
            id,
            BundleKind::Identified,
            &first_name,
        )))
        .unwrap();
    study
        .apply(&Edit::StoreVariant {
            name: "pinned".into(),
        })
        .unwrap();
    let adopted = renamed_models(&study);
    study
        .apply(&Edit::AdoptModels(vec![(id, Arc::clone(&adopted))]))
        .unwrap();
    assert_eq!(
        study
            .dataset
            .condition(id)
            .unwrap()
            .bundle(BundleKind::Identified),
        adopted.models
    );
    assert_eq!(
        study.choice(id).identified.pinned,
        None,
        "the pinned model is no longer in the dataset"
    );
    assert_eq!(study.variants[0].choices[&id].identified.pinned, None);
    assert!(
        Arc::ptr_eq(study.file_dataset(), &before.dataset),
        "the dataset of the file is kept for restoring"
    );
    study
        .apply(&Edit::RestoreFileModels { condition: id })
        .unwrap();
    assert!(Arc::ptr_eq(&study.dataset, &before.dataset));
}

#[test]
fn a_refused_adoption_changes_no_condition() {
    let mut study = example_study();
    let before = study.clone();
    let no_models = Arc::new(AdoptedModels {
        models: Vec::new(),
        records: Vec::new(),
    });
    let accepted = (ConditionId(1), renamed_models(&study));
    let refusal = study
        .apply(&Edit::AdoptModels(vec![
            accepted,
            (ConditionId(2), no_models),
        ]))
        .unwrap_err();
    assert!(
        matches!(
            refusal,
            EditRefusal::Models {
                condition: ConditionId(2),
                ..
            }
        ),
        "{refusal}"
    );
    assert_eq!(study, before, "condition 1 keeps its models too");
    let absent = study
        .apply(&Edit::AdoptModels(vec![(
            ConditionId(99),
            renamed_models(&before),
        )]))
        .unwrap_err();
    assert_eq!(
        absent,
        EditRefusal::NoCondition {
            condition: ConditionId(99)
        }
    );
}

#[test]
fn adopted_models_survive_saving_the_study_and_reloading_its_dataset() {
    use gdcm_io::files::study_file::open_study;
    use gdcm_io::save_study;
    let loaded = embedded_example().unwrap();
    let mut study = Study::new(loaded.dataset.clone());
    let adopted = renamed_models(&study);
    study
        .apply(&Edit::AdoptModels(vec![(
            ConditionId(1),
            Arc::clone(&adopted),
        )]))
        .unwrap();
    let pinned = ModelId::new(
        ConditionId(1),
        BundleKind::Identified,
        &adopted.models[0].name,
    );
    study.apply(&Edit::Pin(pinned)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gdcm-study.json");
    save_study(&study, &loaded, &path).unwrap();
    let opened = open_study(&path).unwrap();
    assert_eq!(opened.study, study);
    assert!(opened.differences.is_empty(), "{:?}", opened.differences);

    let (reloaded, differences) = opened.study.reconciled(embedded_example().unwrap().dataset);
    assert_eq!(reloaded, study, "the adopted models and the pin are kept");
    assert!(differences.is_empty(), "{differences:?}");
}
