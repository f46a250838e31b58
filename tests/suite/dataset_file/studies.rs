//! Study files.

use std::fs;
use std::path::{Path, PathBuf};

use gdcm::correction::{GainBounds, GainObjective};
use gdcm::dataset::{Band, BundleKind, ModelId, Pair};
use gdcm::fidelity::CostAverage;
use gdcm::io::{FileError, LoadedDataset, Opened, embedded_example, load_any, load_dataset, open_study, save_study};
use gdcm::schedule::{ScheduleKind, ScheduleSettings, ScheduledQuantity};
use gdcm::study::{Edit, Setting, Study};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::SMALL;

/// A directory with the small dataset in `data/`, and the way to a study beside that.
struct Desk {
    directory: tempfile::TempDir,
}

impl Desk {
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

    /// Saves a study without decisions and changes its text.
    fn saved(&self, change: impl FnOnce(&mut Value)) {
        let loaded = self.loaded();
        save_study(&Study::new(loaded.dataset.clone()), &loaded, &self.study()).unwrap();
        let mut value: Value = serde_json::from_slice(&fs::read(self.study()).unwrap()).unwrap();
        change(&mut value);
        fs::write(self.study(), serde_json::to_vec(&value).unwrap()).unwrap();
    }

    fn refusal(&self, change: impl FnOnce(&mut Value)) -> String {
        self.saved(change);
        open_study(&self.study()).unwrap_err().to_string()
    }
}

fn decided(study: &mut Study, edits: &[Edit]) {
    for edit in edits {
        study.apply(edit).unwrap();
    }
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let number = || 0.0..1e3_f64;
    let setting = prop_oneof![
        (0_usize..2, 0_usize..2, any::<bool>())
            .prop_map(|(output, input, on)| Setting::Constrained(Pair::new(output, input), on)),
        (0_usize..2, 0_usize..2, any::<bool>())
            .prop_map(|(output, input, on)| Setting::Fitted(Pair::new(output, input), on)),
        number().prop_map(Setting::AlphaGain),
        number().prop_map(Setting::AlphaDelay),
        (1e-3..1.0_f64, 1.1..1e3_f64).prop_map(|(min, max)| Setting::Band(Band::new(min, max).unwrap())),
        (2_usize..5000).prop_map(Setting::Points),
        prop::sample::select(vec![CostAverage::Median, CostAverage::Mean]).prop_map(Setting::CostAverage),
        prop::sample::select(vec![GainObjective::Ratio, GainObjective::Decibel]).prop_map(Setting::GainObjective),
        (0.0..0.5_f64).prop_map(Setting::Quantile),
        (0.1..1.0_f64, 1.0..3.0_f64).prop_map(|(lower, upper)| Setting::GainBounds(Some(GainBounds { lower, upper }))),
        prop::option::of(number()).prop_map(Setting::DelayUpper),
        (0_usize..=3, any::<bool>(), any::<bool>()).prop_map(|(degree, table, delays)| {
            let kind = if table { ScheduleKind::Table } else { ScheduleKind::Polynomial { degree } };
            let quantity = if delays { ScheduledQuantity::Gain } else { ScheduledQuantity::LnGain };
            Setting::Schedule(ScheduleSettings { kind, quantity, delays })
        }),
    ];
    prop::collection::vec(setting.prop_map(Edit::Set), 0..12)
}

proptest! {
    #[test]
    fn a_study_saved_and_opened_is_the_same_to_the_last_digit(edits in edits(), rejected in 0_usize..2, scheduled in any::<bool>()) {
        let desk = Desk::new();
        let loaded = desk.loaded();
        let mut study = Study::new(loaded.dataset.clone());
        decided(&mut study, &edits);
        let id = |bundle, model| ModelId { condition: 0, bundle, model };
        decided(&mut study, &[
            Edit::Reject(id(BundleKind::Physics, rejected)),
            Edit::Pin(id(BundleKind::Identified, rejected)),
            Edit::SetScheduled { condition: 1, scheduled },
        ]);
        save_study(&study, &loaded, &desk.study()).unwrap();
        let (opened, dataset) = open_study(&desk.study()).unwrap();
        prop_assert_eq!(opened, study);
        prop_assert_eq!(dataset.sha256, loaded.sha256);
    }
}

#[test]
fn a_study_names_its_dataset_relative_to_itself_and_moves_with_it() {
    let desk = Desk::new();
    desk.saved(|_| {});
    let text: Value = serde_json::from_slice(&fs::read(desk.study()).unwrap()).unwrap();
    assert_eq!(text["dataset"]["path"], json!("../data/small.json"));
    let moved = tempfile::tempdir().unwrap();
    let root = moved.path().join("elsewhere");
    fs::rename(desk.directory.path(), &root).unwrap();
    assert!(open_study(&root.join("studies/a.gdcm-study.json")).is_ok());
}

#[test]
fn a_study_of_the_embedded_example_has_no_path() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("example.gdcm-study.json");
    let loaded = embedded_example().unwrap();
    let mut study = Study::new(loaded.dataset.clone());
    decided(&mut study, &[Edit::Set(Setting::AlphaGain(0.1 + 0.2))]);
    save_study(&study, &loaded, &path).unwrap();
    let text: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    assert_eq!((&text["dataset"]["path"], &text["dataset"]["name"]), (&Value::Null, &json!("embedded example")));
    let Opened::Study { study: opened, .. } = load_any(&path).unwrap() else { panic!("a study was saved") };
    assert_eq!(opened, study);
}

#[test]
fn a_study_whose_dataset_is_gone_says_which() {
    let desk = Desk::new();
    desk.saved(|_| {});
    fs::remove_file(desk.dataset()).unwrap();
    let message = open_study(&desk.study()).unwrap_err().to_string();
    assert!(message.contains("a.gdcm-study.json: the study's dataset cannot be opened: "), "{message}");
    assert!(message.ends_with("small.json: there is no such file"), "{message}");
}

#[test]
fn a_study_whose_dataset_has_changed_says_so_with_both_hashes() {
    let desk = Desk::new();
    desk.saved(|_| {});
    let before = desk.loaded().sha256;
    fs::write(desk.dataset(), SMALL.replace("6600", "6601")).unwrap();
    let after = desk.loaded().sha256;
    let error = open_study(&desk.study()).unwrap_err();
    assert!(
        matches!(&error, FileError::DatasetChanged { expected, found, .. } if *expected == before && *found == after)
    );
    assert!(error.to_string().contains("has changed since the study was saved"));
}

#[test]
fn a_study_that_holds_what_cannot_be_decided_is_refused_with_the_place() {
    let desk = Desk::new();
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 13] = [
        (|file| file["version"] = json!(9), "expected version 1 of gdcm-study, found 9"),
        (
            |file| file["settings"]["alpha_gain"] = json!(-1),
            "settings, alpha_gain: α of the gains: expected a number from 0",
        ),
        (|file| file["settings"]["points"] = json!(1), "settings, points"),
        (
            |file| file["settings"]["band_rad_s"] = json!([2, 1]),
            "settings, band_rad_s: the frequency band must be 0.0001 <= min < max",
        ),
        (|file| file["settings"]["gain_bounds"] = json!([2, 1]), "settings, gain_bounds: gain bounds"),
        (
            |file| file["settings"]["schedule"]["degree"] = json!(4),
            "settings, schedule: schedule: expected a whole number from 0 to 3",
        ),
        (|file| file["settings"]["cost_average"] = json!("mode"), "settings, cost_average"),
        (
            |file| file["settings"]["constrained"] = json!([["P", "PED"]]),
            "settings, constrained, entry 1: the dataset has no input",
        ),
        (|file| file["conditions"][1]["id"] = json!(7), "condition 7 (number 2 in the file): condition 7 stands twice"),
        (
            |file| file["conditions"][1]["id"] = json!(8),
            "condition 8 (number 2 in the file): the dataset has no condition 8",
        ),
        (
            |file| file["conditions"][0]["physics"]["rejected"] = json!(["V+6kt"]),
            "condition 7 (number 1 in the file), physics, rejected, entry 1: the dataset's condition has no such model: \"V+6kt\"",
        ),
        (
            |file| file["conditions"][0]["physics"]["rejected"] = json!(["nominal", "V+5kt"]),
            "the last model kept in its bundle",
        ),
        (
            |file| {
                file["conditions"][0]["physics"] = json!({"rejected": ["nominal"], "pinned": "nominal"});
            },
            "physics, pinned: condition 7: \"nominal\" is rejected",
        ),
    ];
    for (change, words) in cases {
        let message = desk.refusal(change);
        assert!(
            message.contains("a.gdcm-study.json: ") && message.contains(words),
            "expected \"{words}\" in: {message}"
        );
        assert_eq!(message.lines().count(), 1);
    }
}

#[test]
fn a_study_beside_its_dataset_names_it_plainly() {
    let desk = Desk::new();
    let loaded = desk.loaded();
    let beside = desk.dataset().with_file_name("b.gdcm-study.json");
    save_study(&Study::new(loaded.dataset.clone()), &loaded, &beside).unwrap();
    let text: Value = serde_json::from_slice(&fs::read(&beside).unwrap()).unwrap();
    assert_eq!(text["dataset"]["path"], json!("small.json"));
    assert!(matches!(load_any(Path::new(&beside)).unwrap(), Opened::Study { .. }));
}
