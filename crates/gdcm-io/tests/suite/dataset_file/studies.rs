//! Writing and reading of study files.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use serde_json::{Value as Json, json};

use gdcm_io::files::study_file::{open_study, open_study_of};
use gdcm_io::{
    DatasetOrigin, Example, FileError, LoadedDataset, Opened, embedded_example, load_any,
    load_dataset, load_example, save_study,
};
use gdcm_method::correction::Channel;
use gdcm_method::schedule::DelayScheduling;
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId, Pair};
use gdcm_study::decisions::dataset_differences::{Difference, NotApplied};
use gdcm_study::decisions::edit_refusal::EditRefusal;
use gdcm_study::decisions::setting::{Kind, Setting};
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_table::SETTINGS;
use gdcm_study::decisions::setting_value::Value;
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::{Edit, Study};

use super::{SMALL, assert_error};

/// A directory with the small dataset in `data/`, and an empty `studies/` beside it.
struct Workspace {
    directory: tempfile::TempDir,
}

impl Workspace {
    fn new() -> Self {
        let directory = tempfile::tempdir().unwrap();
        fs::create_dir(directory.path().join("data")).unwrap();
        fs::create_dir(directory.path().join("studies")).unwrap();
        fs::write(directory.path().join("data/small.json"), SMALL).unwrap();
        Self { directory }
    }

    fn dataset(&self) -> PathBuf {
        self.directory.path().join("data/small.json")
    }

    fn study(&self) -> PathBuf {
        self.directory.path().join("studies/a.gdcm-study.json")
    }

    fn loaded(&self) -> LoadedDataset {
        load_dataset(&self.dataset()).unwrap()
    }

    /// Saves a study without decisions, then changes the JSON in its file.
    fn save_changed(&self, change: impl FnOnce(&mut Json)) {
        let loaded = self.loaded();
        save_study(&Study::new(loaded.dataset.clone()), &loaded, &self.study()).unwrap();
        let mut value: Json = serde_json::from_slice(&fs::read(self.study()).unwrap()).unwrap();
        change(&mut value);
        fs::write(self.study(), serde_json::to_vec(&value).unwrap()).unwrap();
    }

    /// Returns the error with which a study file is rejected after `change`.
    fn refusal(&self, change: impl FnOnce(&mut Json)) -> FileError {
        self.save_changed(change);
        open_study(&self.study()).unwrap_err()
    }
}

fn apply(study: &mut Study, edits: &[Edit]) {
    for edit in edits {
        study.apply(edit).unwrap();
    }
}

/// Returns a permitted value of a setting, chosen by two numbers between 0 and 1.
fn value_of(setting: &Setting, [first, second]: [f64; 2]) -> Value {
    let within = |[least, most]: [f64; 2], at: f64| least + at * (most - least);
    match setting.kind {
        Kind::Optional { .. } | Kind::Range { .. } if second > 0.7 => Value::Nothing,
        Kind::Number {
            range, whole: true, ..
        } => Value::Number(within(range, first).round()),
        Kind::Number { range, .. } | Kind::Optional { range, .. } => {
            Value::Number(within(range, first))
        }
        Kind::Range { .. } | Kind::Band { .. } => {
            let range = setting.kind.range().unwrap();
            let lower = within(range, 0.9 * first);
            Value::Range([lower, within([lower, range[1]], 0.1 + 0.9 * second)])
        }
        Kind::Flag { .. } => Value::Flag(first > 0.5),
        Kind::Choice { words, .. } => Value::Choice((first * (words.len() as f64 - 0.01)) as usize),
    }
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let pair = || (0_usize..2, 0_usize..2).prop_map(|(output, input)| Pair::new(output, input));
    let edit = prop_oneof![
        (pair(), any::<bool>()).prop_map(|(pair, on)| Edit::Hold(pair, on)),
        (pair(), any::<bool>()).prop_map(|(pair, on)| Edit::Fit(pair, on)),
        (
            prop::sample::select(SETTINGS.to_vec()),
            [0.0..1.0_f64, 0.0..1.0_f64]
        )
            .prop_map(|(setting, at)| setting.to(value_of(setting, at))),
    ];
    prop::collection::vec(edit, 0..30)
}

#[test]
fn every_setting_is_a_key_of_the_file() {
    let workspace = Workspace::new();
    let loaded = workspace.loaded();
    let mut study = Study::new(loaded.dataset.clone());
    for setting in SETTINGS {
        study
            .apply(&setting.to(value_of(setting, [0.6, 0.6])))
            .unwrap();
    }
    save_study(&study, &loaded, &workspace.study()).unwrap();
    let text: Json = serde_json::from_slice(&fs::read(workspace.study()).unwrap()).unwrap();
    for setting in SETTINGS {
        let pointer = format!("/settings/{}", setting.key.replace('.', "/"));
        assert!(text.pointer(&pointer).is_some(), "{}", setting.key);
    }
}

#[test]
fn decisions_about_physics_parameters_are_kept_and_checked() {
    let workspace = Workspace::new();
    let loaded = workspace.loaded();
    let mut study = Study::new(loaded.dataset.clone());
    let parameters = &mut study.settings.physics_parameters;
    parameters.by_hand.insert("Ixx".to_owned(), -4.5);
    parameters.off.insert("lift".to_owned());
    parameters.plausible_sd.insert("Ixx".to_owned(), 7.5);
    save_study(&study, &loaded, &workspace.study()).unwrap();
    assert_eq!(open_study(&workspace.study()).unwrap().study, study);
    // A file of an older program has none of these decisions.
    let workspace = Workspace::new();
    workspace.save_changed(|text| {
        assert!(text["settings"].get("physics").is_none());
        assert!(text["settings"].get("physics_parameters").is_none());
    });
    let opened = open_study(&workspace.study()).unwrap().study;
    assert_eq!(opened.settings.physics_parameters, Default::default());
    for (key, value) in [
        ("plausible_sd", serde_json::json!({"Ixx": 0.0})),
        ("points", serde_json::json!(1)),
        ("gain_sd", serde_json::json!(-1.0)),
    ] {
        workspace.save_changed(|text| {
            text["settings"]["physics_parameters"] = serde_json::json!({key: value})
        });
        assert!(open_study(&workspace.study()).is_err(), "{key}");
    }
}

/// Returns the delay scheduling of a study opened from a file after `change`.
fn delay_scheduling(change: impl FnOnce(&mut Json)) -> DelayScheduling {
    let workspace = Workspace::new();
    workspace.save_changed(change);
    open_study(&workspace.study())
        .unwrap()
        .study
        .settings
        .schedule_delays
}

#[test]
fn flags_of_older_studies_set_the_delay_scheduling() {
    let older = |flag: bool| {
        delay_scheduling(|file| {
            file["settings"]
                .as_object_mut()
                .unwrap()
                .remove("schedule_delays");
            file["settings"]["schedule"]["delays"] = json!(flag);
        })
    };
    assert_eq!(
        [older(true), older(false)],
        [DelayScheduling::Always, DelayScheduling::Never]
    );
    let read_as =
        |value: Json| delay_scheduling(|file| file["settings"]["schedule_delays"] = value);
    let values = [
        json!("automatic"),
        json!("always"),
        json!("never"),
        json!(true),
        json!(false),
    ];
    assert_eq!(
        values.map(read_as),
        [
            DelayScheduling::Automatic,
            DelayScheduling::Always,
            DelayScheduling::Never,
            DelayScheduling::Always,
            DelayScheduling::Never
        ]
    );
    let refusal =
        Workspace::new().refusal(|file| file["settings"]["schedule_delays"] = json!("sometimes"));
    assert_error(
        &refusal,
        "unknown-word",
        "settings, schedule_delays",
        &["\"automatic\"", "sometimes"],
    );
}

#[test]
fn the_flag_that_older_programs_read_is_written_too() {
    let workspace = Workspace::new();
    let loaded = workspace.loaded();
    for (scheduling, flag) in [("automatic", false), ("always", true), ("never", false)] {
        let mut study = Study::new(loaded.dataset.clone());
        let value = setting_table::SCHEDULE_DELAYS.read(&[scheduling]).unwrap();
        study
            .apply(&setting_table::SCHEDULE_DELAYS.to(value))
            .unwrap();
        save_study(&study, &loaded, &workspace.study()).unwrap();
        let text: Json = serde_json::from_slice(&fs::read(workspace.study()).unwrap()).unwrap();
        let settings = &text["settings"];
        assert_eq!(
            (
                &settings["schedule_delays"],
                &settings["schedule"]["delays"]
            ),
            (&json!(scheduling), &json!(flag))
        );
    }
}

proptest! {
    #[test]
    fn a_study_saved_and_opened_is_the_same_to_the_last_digit(
        edits in edits(),
        others in edits(),
        rejected in 0_usize..2,
        [scheduled, held_out] in any::<[bool; 2]>(),
        reason in "[ -~α→\n]{0,40}",
    ) {
        let workspace = Workspace::new();
        let loaded = workspace.loaded();
        let mut study = Study::new(loaded.dataset.clone());
        apply(&mut study, &edits);
        let first = loaded.dataset.conditions()[0].clone();
        let id = |bundle, model: usize| {
            ModelId::new(first.id(), bundle, &first.bundle(bundle)[model].name)
        };
        apply(&mut study, &[
            Edit::RejectBecause { model: id(BundleKind::Physics, rejected), reason },
            Edit::Pin(id(BundleKind::Identified, rejected)),
            Edit::SetScheduled { condition: loaded.dataset.conditions()[1].id(), scheduled },
            Edit::SetHeldOut { condition: first.id(), held_out },
            Edit::SetSign { channel: Channel::Output(1), role: Some(SignRole::Identified) },
            Edit::StoreVariant { name: "first → α".to_owned() },
        ]);
        apply(&mut study, &others);
        apply(&mut study, &[
            Edit::Restore(id(BundleKind::Physics, rejected)),
            Edit::StoreVariant { name: "second".to_owned() },
        ]);
        save_study(&study, &loaded, &workspace.study()).unwrap();
        let opened = open_study(&workspace.study()).unwrap();
        prop_assert_eq!(opened.study, study);
        prop_assert_eq!(opened.loaded.sha256, loaded.sha256);
        prop_assert_eq!(opened.differences, []);
    }
}

#[test]
fn a_study_without_newer_keys_opens_with_the_behaviour_of_older_programs() {
    let workspace = Workspace::new();
    workspace.save_changed(|text| {
        assert!(
            text.get("variants").is_none()
                && text["conditions"][0]["physics"].get("reasons").is_none()
        );
        let settings = text["settings"].as_object_mut().unwrap();
        for key in ["agreement_db", "coherence_threshold"] {
            settings.remove(key).unwrap();
        }
    });
    let opened = open_study(&workspace.study()).unwrap();
    let mut expected = Study::new(opened.loaded.dataset.clone());
    assert_eq!(
        expected.settings.coherence_threshold,
        Some(0.6),
        "a response of the dataset has coherence, so new studies use it"
    );
    apply(&mut expected, &[setting_table::COHERENCE.to(None::<f64>)]);
    assert_eq!(
        opened.study, expected,
        "older programs ignored coherence, so the study should too"
    );
    assert_eq!(opened.study.settings.agreement_db, 0.05);
}

#[test]
fn a_wrong_variant_is_refused_with_its_name() {
    let workspace = Workspace::new();
    let error = workspace.refusal(|text| {
        let settings = text["settings"].clone();
        let conditions = text["conditions"].clone();
        text["variants"] =
            json!([{"name": "soft", "settings": settings, "conditions": conditions}]);
        text["variants"][0]["settings"]["alpha_gain"] = json!(-1);
    });
    assert_error(
        &error,
        "out-of-range",
        "variant \"soft\", settings, alpha_gain",
        &["found -1"],
    );
}

#[test]
fn a_study_names_its_dataset_relative_to_itself_and_moves_with_it() {
    let workspace = Workspace::new();
    workspace.save_changed(|_| {});
    let text: Json = serde_json::from_slice(&fs::read(workspace.study()).unwrap()).unwrap();
    assert_eq!(text["dataset"]["path"], json!("../data/small.json"));
    let moved = tempfile::tempdir().unwrap();
    let root = moved.path().join("elsewhere");
    fs::rename(workspace.directory.path(), &root).unwrap();
    assert!(open_study(&root.join("studies/a.gdcm-study.json")).is_ok());
}

#[test]
fn a_study_of_the_embedded_example_has_no_path() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("example.gdcm-study.json");
    let loaded = embedded_example().unwrap();
    let mut study = Study::new(loaded.dataset.clone());
    apply(&mut study, &[setting_table::ALPHA_GAIN.to(0.1 + 0.2)]);
    save_study(&study, &loaded, &path).unwrap();
    let text: Json = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    assert_eq!(
        (&text["dataset"]["path"], &text["dataset"]["name"]),
        (&Json::Null, &json!("embedded example"))
    );
    let Opened::Study(opened) = load_any(&path, &Default::default()).unwrap() else {
        panic!("the file should open as a study")
    };
    assert_eq!(opened.study, study);
}

#[test]
fn a_study_of_the_real_aircraft_opens_that_example_again() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("real-aircraft.gdcm-study.json");
    let loaded = load_example(Example::RealAircraft).unwrap();
    let study = Study::new(loaded.dataset.clone());
    save_study(&study, &loaded, &path).unwrap();
    let opened = open_study(&path).unwrap();
    assert_eq!(
        opened.loaded.origin,
        DatasetOrigin::EmbeddedExample(Example::RealAircraft)
    );
    assert_eq!((opened.study, opened.differences), (study, vec![]));
}

#[test]
fn a_study_whose_dataset_is_missing_names_the_file() {
    let workspace = Workspace::new();
    workspace.save_changed(|_| {});
    fs::remove_file(workspace.dataset()).unwrap();
    let error = open_study(&workspace.study()).unwrap_err();
    let FileError::StudyDataset { path, dataset } = error else {
        panic!("{error}")
    };
    assert_eq!(path, workspace.study());
    assert!(
        matches!(&*dataset, FileError::Missing { path } if path.ends_with("small.json")),
        "{dataset}"
    );
}

/// Returns the differences of the dataset that are reported when the study is opened.
fn differences(workspace: &Workspace) -> Vec<Difference> {
    open_study(&workspace.study()).unwrap().differences
}

#[test]
fn a_study_whose_dataset_has_changed_opens_and_lists_the_differences() {
    let workspace = Workspace::new();
    let loaded = workspace.loaded();
    let mut study = Study::new(loaded.dataset.clone());
    let model = |id, kind, name: &str| ModelId::new(ConditionId(id), kind, name);
    apply(
        &mut study,
        &[
            setting_table::ALPHA_GAIN.to(0.5),
            Edit::Reject(model(7, BundleKind::Physics, "V+5kt")),
            Edit::Pin(model(7, BundleKind::Identified, "measured")),
        ],
    );
    save_study(&study, &loaded, &workspace.study()).unwrap();
    let mut value: Json = serde_json::from_str(SMALL).unwrap();
    let first = &mut value["conditions"][0];
    first["airspeed_kt"] = json!(61);
    let models = first["physics_models"].as_array_mut().unwrap();
    models[0]["A"][0][0] = json!(-0.25);
    models[1]["name"] = json!("V+6kt");
    fs::write(workspace.dataset(), serde_json::to_vec(&value).unwrap()).unwrap();

    let found = differences(&workspace);
    let physics = |name: &str| model(7, BundleKind::Physics, name);
    for difference in [
        Difference::AirspeedChanged {
            condition: ConditionId(7),
            before_kt: 0.0,
            now_kt: 61.0,
        },
        Difference::ModelChanged(physics("nominal")),
        Difference::ModelRemoved(physics("V+5kt")),
        Difference::ModelAdded(physics("V+6kt")),
    ] {
        assert!(found.contains(&difference), "{difference:?} in {found:?}");
    }
    assert!(
        found.iter().any(|difference| matches!(
            difference,
            Difference::NotApplied {
                why: NotApplied::Refused(EditRefusal::NoModel { .. }),
                ..
            }
        )),
        "{found:?}"
    );
    assert_eq!(found.len(), 5, "{found:?}");
    let opened = open_study(&workspace.study()).unwrap().study;
    assert_eq!(
        opened.settings.alpha_gain, 0.5,
        "decisions that still apply should be kept"
    );
    let pinned = &opened.choice(ConditionId(7)).identified.pinned;
    assert_eq!(pinned.as_deref(), Some("measured"));
}

#[test]
fn a_reformatted_dataset_has_no_differences() {
    let workspace = Workspace::new();
    workspace.save_changed(|_| {});
    let value: Json = serde_json::from_str(SMALL).unwrap();
    fs::write(
        workspace.dataset(),
        serde_json::to_string_pretty(&value).unwrap(),
    )
    .unwrap();
    assert_eq!(differences(&workspace), []);
}

#[test]
fn a_study_without_an_inventory_reports_a_changed_dataset_as_another_file() {
    let workspace = Workspace::new();
    workspace.save_changed(|file| drop(file["dataset"].as_object_mut().unwrap().remove("holds")));
    assert_eq!(differences(&workspace), [], "the file is unchanged");
    fs::write(workspace.dataset(), SMALL.replace("6600", "6601")).unwrap();
    let found = differences(&workspace);
    assert!(
        matches!(
            found.as_slice(),
            [Difference::AnotherFile { found, .. }] if *found == workspace.loaded().sha256
        ),
        "{found:?}"
    );
}

#[test]
fn a_moved_dataset_is_found_beside_the_study_or_at_the_given_path() {
    let workspace = Workspace::new();
    workspace.save_changed(|_| {});
    let elsewhere = workspace.directory.path().join("elsewhere.json");
    fs::rename(workspace.dataset(), &elsewhere).unwrap();
    assert!(matches!(
        open_study(&workspace.study()),
        Err(FileError::StudyDataset { .. })
    ));
    assert_eq!(
        open_study_of(&workspace.study(), &elsewhere, &Default::default())
            .unwrap()
            .differences,
        []
    );
    fs::rename(&elsewhere, workspace.study().with_file_name("small.json")).unwrap();
    assert_eq!(open_study(&workspace.study()).unwrap().differences, []);
}

#[test]
fn a_study_with_invalid_decisions_is_refused_with_the_place() {
    let workspace = Workspace::new();
    type Change = fn(&mut Json);
    let cases: [(Change, &str, &str, &str); 8] = [
        (
            |file| file["version"] = json!(9),
            "other-version",
            "",
            "found 9",
        ),
        (
            |file| file["settings"]["alpha_gain"] = json!(-1),
            "out-of-range",
            "settings, alpha_gain",
            "found -1",
        ),
        (
            |file| file["settings"]["points"] = json!(1),
            "out-of-range",
            "settings, points",
            "found 1",
        ),
        (
            |file| file["settings"]["band_rad_s"] = json!([2, 1]),
            "wrong-band",
            "settings, band_rad_s",
            "min 2, max 1",
        ),
        (
            |file| file["settings"]["gain_bounds"] = json!([2, 1]),
            "out-of-range",
            "settings, gain_bounds",
            "found 1",
        ),
        (
            |file| file["settings"]["schedule"]["degree"] = json!(4),
            "invalid-entry",
            "settings, schedule",
            "found 4",
        ),
        (
            |file| file["settings"]["cost_average"] = json!("mode"),
            "unknown-word",
            "settings, cost_average",
            "mode",
        ),
        (
            |file| file["conditions"][1]["id"] = json!(7),
            "duplicate-condition",
            "condition 7 (number 2 in the file)",
            "7",
        ),
    ];
    for (change, code, place, value) in cases {
        let error = workspace.refusal(change);
        assert_error(&error, code, place, &[value, "a.gdcm-study.json: "]);
        assert_eq!(error.to_string().lines().count(), 1);
    }
}

#[test]
fn a_study_beside_its_dataset_stores_only_the_file_name() {
    let workspace = Workspace::new();
    let loaded = workspace.loaded();
    let beside = workspace.dataset().with_file_name("b.gdcm-study.json");
    save_study(&Study::new(loaded.dataset.clone()), &loaded, &beside).unwrap();
    let text: Json = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
    assert_eq!(text["dataset"]["path"], json!("small.json"));
    assert!(matches!(
        load_any(Path::new(&beside), &Default::default()).unwrap(),
        Opened::Study(_)
    ));
}

#[test]
fn the_source_of_a_model_survives_saving_and_appears_in_the_corrections() {
    let mut value: Json = serde_json::from_str(SMALL).unwrap();
    let source = json!({
        "file": "models/roll+5.mat",
        "sha256": "ab12",
        "variable": "sys",
        "made": "2026-03-01",
        "note": "trim 3",
    });
    value["conditions"][0]["physics_models"][1]["source"] = source.clone();
    let loaded = super::load(&serde_json::to_vec(&value).unwrap()).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("again.json");
    gdcm_io::files::dataset_file::save_dataset(&loaded.dataset, &path).unwrap();
    let again: Json = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    assert_eq!(
        again["conditions"][0]["physics_models"][1]["source"],
        source
    );
    assert_eq!(
        again["conditions"][0]["physics_models"][0].get("source"),
        None
    );
    let study = Study::new(load_dataset(&path).unwrap().dataset);
    let analysis = gdcm_study::Engine::default()
        .analyze(&study, &gdcm_model::progress::Unobserved)
        .unwrap();
    let written = gdcm_io::files::corrections_file::corrections(
        &analysis,
        "",
        &analysis.conditions.keys().copied().collect(),
    );
    let sources = written["conditions"][0]["sources"].as_array().unwrap();
    assert_eq!(
        (&sources[0]["bundle"], &sources[0]["file"]),
        (&"physics".into(), &"models/roll+5.mat".into())
    );
    assert_eq!(sources.len(), 1);
}
