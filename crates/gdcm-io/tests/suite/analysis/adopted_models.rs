//! Adopted models, which replace the identified models of the dataset.

use std::sync::Arc;

use gdcm_io::embedded_example;
use gdcm_model::dataset::{BundleKind, ConditionId, Model, ModelId};
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::{Edit, Study};

fn study() -> Study {
    Study::new(embedded_example().unwrap().dataset)
}

/// Returns the identified models of condition 1 under other names.
fn others(study: &Study) -> Arc<AdoptedModels> {
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
fn models_are_taken_and_returned_and_decisions_about_absent_ones_go() {
    let mut study = study();
    let before = study.clone();
    let id = ConditionId(1);
    let first = study.dataset.conditions()[0].bundle(BundleKind::Identified)[0]
        .name
        .clone();
    study
        .apply(&Edit::Pin(ModelId::new(id, BundleKind::Identified, &first)))
        .unwrap();
    study
        .apply(&Edit::StoreVariant {
            name: "pinned".into(),
        })
        .unwrap();
    let taken = others(&study);
    study
        .apply(&Edit::AdoptModels(vec![(id, Arc::clone(&taken))]))
        .unwrap();
    assert_eq!(
        study
            .dataset
            .condition(id)
            .unwrap()
            .bundle(BundleKind::Identified),
        taken.models
    );
    assert_eq!(
        study.choice(id).identified.pinned,
        None,
        "the pinned model is gone"
    );
    assert_eq!(study.variants[0].choices[&id].identified.pinned, None);
    assert!(
        Arc::ptr_eq(study.file_dataset(), &before.dataset),
        "the file's dataset is known still"
    );
    study
        .apply(&Edit::RestoreFileModels { condition: id })
        .unwrap();
    assert!(Arc::ptr_eq(&study.dataset, &before.dataset));
}

#[test]
fn models_of_another_shape_are_refused_and_nothing_is_taken() {
    let mut study = study();
    let before = study.clone();
    let nothing = Arc::new(AdoptedModels {
        models: Vec::new(),
        records: Vec::new(),
    });
    let good = (ConditionId(1), others(&study));
    let refusal = study
        .apply(&Edit::AdoptModels(vec![good, (ConditionId(2), nothing)]))
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
    assert_eq!(study, before);
    let absent = study
        .apply(&Edit::AdoptModels(vec![(ConditionId(99), others(&before))]))
        .unwrap_err();
    assert_eq!(
        absent,
        EditRefusal::NoCondition {
            condition: ConditionId(99)
        }
    );
}

#[test]
fn a_saved_study_and_a_reloaded_dataset_keep_the_models_taken() {
    use gdcm_io::files::study_file::open_study;
    use gdcm_io::save_study;
    let loaded = embedded_example().unwrap();
    let mut study = Study::new(loaded.dataset.clone());
    let taken = others(&study);
    study
        .apply(&Edit::AdoptModels(vec![(
            ConditionId(1),
            Arc::clone(&taken),
        )]))
        .unwrap();
    let pinned = ModelId::new(
        ConditionId(1),
        BundleKind::Identified,
        &taken.models[0].name,
    );
    study.apply(&Edit::Pin(pinned)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gdcm-study.json");
    save_study(&study, &loaded, &path).unwrap();
    let opened = open_study(&path).unwrap();
    assert_eq!(opened.study, study);
    assert!(opened.differences.is_empty(), "{:?}", opened.differences);

    let (reloaded, differences) = opened.study.reconciled(embedded_example().unwrap().dataset);
    assert_eq!(reloaded, study, "models, and decisions about them");
    assert!(differences.is_empty(), "{differences:?}");
}
