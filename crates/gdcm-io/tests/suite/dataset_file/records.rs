//! Flight records of conditions, and the error bands of the models identified from these records.

use nalgebra::DMatrix;

use gdcm_io::files::dataset_file::save_dataset;
use gdcm_model::dataset::condition::{ConditionRecord, RecordKind};
use gdcm_model::dataset::dataset_draft::ModelDraft;
use gdcm_model::dataset::draft_fault::DraftFault;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{BundleKind, Pair};

use super::*;

fn records() -> Value {
    json!([
        {"name": "LON 1", "file": "records/lon_1.csv", "kind": "sweep", "held_out": false},
        {
            "name": "steps",
            "file": "records/all.mat",
            "variable": "run 2",
            "sha256": "ab",
            "kind": "3-2-1-1",
            "held_out": true,
            "used": false,
            "sample_time_s": 0.02,
            "used_s": [[0.0, 30.5], [31.0, 60.0]]
        },
        {"name": "rest", "file": "rest.csv"}
    ])
}

fn bands() -> Value {
    let table = |value: f64| {
        json!([
            [[value, 0.5, 1.0], [0.0, 0.0, 0.0]],
            [[1.0, 2.0, 3.0], [0.1, 0.2, 0.3]]
        ])
    };
    json!({"omega_rad_s": [0.5, 1.0, 12.0], "sd_db": table(0.25), "sd_deg": table(1.5)})
}

fn with_records_and_bands(file: &mut Value) {
    file["conditions"][0]["records"] = records();
    let model = &mut file["conditions"][0]["identified_models"][0];
    model["bands"] = bands();
    model["source"] = json!({"made": "2026-03-01", "records": ["LON 1", "steps"]});
}

/// Returns the text of the file to which the dataset in `bytes` is saved.
fn saved(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.json");
    save_dataset(&load(bytes).unwrap().dataset, &path).unwrap();
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn records_and_bands_survive_saving() {
    let loaded = load(&small(with_records_and_bands)).unwrap();
    assert_eq!(loaded.cautions, []);
    let condition = &loaded.dataset.conditions()[0];
    let kinds: Vec<RecordKind> = condition
        .records()
        .iter()
        .map(|record| record.kind)
        .collect();
    assert_eq!(
        kinds,
        [
            RecordKind::Sweep,
            RecordKind::ThreeTwoOneOne,
            RecordKind::Other
        ]
    );
    let steps = &condition.records()[1];
    assert_eq!(
        (steps.held_out, steps.used, steps.sample_time_s),
        (true, false, Some(0.02))
    );
    assert_eq!(steps.used_s, [[0.0, 30.5], [31.0, 60.0]]);
    assert!(
        condition.records()[2].used,
        "a record should be used by default"
    );
    let model = &condition.bundle(BundleKind::Identified)[0];
    let bands = model.bands.as_ref().unwrap();
    assert_eq!(bands.sd_db()[Pair::new(1, 0)], [1.0, 2.0, 3.0]);
    assert_eq!(bands.sd_deg()[Pair::new(0, 0)], [1.5, 0.5, 1.0]);
    assert_eq!(model.source.as_ref().unwrap().records, ["LON 1", "steps"]);
    let text = saved(&small(with_records_and_bands));
    let again = load(text.as_bytes()).unwrap();
    assert_eq!(again.dataset, loaded.dataset);
    assert_eq!(saved(text.as_bytes()), text);
}

#[test]
fn a_dataset_without_records_is_saved_without_their_keys() {
    let text = saved(SMALL.as_bytes());
    for key in ["\"records\"", "\"bands\"", "\"sd_db\""] {
        assert!(!text.contains(key), "{key}");
    }
    assert_eq!(
        text,
        saved(&small(|file| file["conditions"][0]["records"] = json!([])))
    );
}

#[test]
fn impossible_records_are_refused_with_their_place() {
    let refused = |change: fn(&mut Value), code: &str, place: &str, values: &[&str]| {
        assert_refused(
            |file| {
                with_records_and_bands(file);
                change(&mut file["conditions"][0]["records"]);
            },
            code,
            place,
            values,
        );
    };
    let place = "condition 7 (number 1 in the file)";
    refused(
        |records| records[0]["kind"] = json!("doublet"),
        "unknown-word",
        "condition 7 (number 1 in the file), records, entry 1, kind",
        &["\"multisine\"", "doublet"],
    );
    refused(
        |records| records[1]["name"] = json!("LON 1"),
        "duplicate-record",
        place,
        &["\"LON 1\"", "records 1 and 2"],
    );
    refused(
        |records| records[1]["sample_time_s"] = json!(0),
        "record-of-model",
        place,
        &["\"steps\" (number 2), sample_time_s"],
    );
    refused(
        |records| records[1]["used_s"][1][1] = json!(30.0),
        "record-of-model",
        place,
        &["used_s"],
    );
    refused(
        |records| drop(records[2].as_object_mut().unwrap().remove("file")),
        "missing-key",
        "records, entry 3",
        &["\"file\""],
    );
    refused(
        |records| records[0]["held_out"] = json!("no"),
        "wrong-type",
        "records, entry 1, held_out",
        &[],
    );
}

#[test]
fn impossible_bands_are_refused_with_their_place() {
    let refused = |change: fn(&mut Value), code: &str, values: &[&str]| {
        assert_refused(
            |file| {
                with_records_and_bands(file);
                change(&mut file["conditions"][0]["identified_models"][0]["bands"]);
            },
            code,
            "identified model \"sweeps\" (number 1), bands",
            values,
        );
    };
    refused(
        |bands| bands["sd_db"][1][0][2] = json!(-1.0),
        "response-value",
        &["sd_db, output 2, input 1, entry 3", "-1"],
    );
    refused(
        |bands| bands["omega_rad_s"][2] = json!(1.0),
        "response-frequency",
        &["frequency 3"],
    );
    refused(
        |bands| bands["sd_deg"] = json!([[[1.0, 2.0, 3.0]]]),
        "table-shape",
        &["sd_deg", "expected 2 x 2 x 3", "found 1 x 1 x 3"],
    );
    refused(
        |bands| bands["sd_deg"][0][1] = json!("x"),
        "wrong-type",
        &["sd_deg, output 1, input 2"],
    );
    let name = r#""name": "sweeps","#;
    let infinite = r#""bands": {"omega_rad_s": [1, 1e999], "sd_db": [], "sd_deg": []},"#;
    assert_text_refused(
        name,
        &format!("{name} {infinite}"),
        "number-not-finite",
        "bands, omega_rad_s",
        &[],
    );
}

#[test]
fn identified_models_replace_the_bundle_and_records_replace_those_of_the_same_name() {
    let dataset = load(&small(with_records_and_bands)).unwrap().dataset;
    let condition = &dataset.conditions()[0];
    let before = condition.bundle(BundleKind::Identified).len();
    let constant =
        |rows: usize, columns: usize, value: f64| Some(DMatrix::from_element(rows, columns, value));
    let draft = |name: &str, inputs: usize| ModelDraft {
        name: name.to_owned(),
        origin: Origin::Identified {
            method: None,
            order: None,
        },
        matrices: [
            constant(1, 1, -1.0),
            constant(1, inputs, 1.0),
            constant(2, 1, 1.0),
            constant(2, inputs, 0.0),
        ],
        timing: Timing::default(),
        response: None,
        source: None,
        states: Vec::new(),
        bands: None,
        moved: None,
    };
    let model = |name: &str| dataset.identified_model(draft(name, 2)).unwrap().0;
    let records = vec![
        ConditionRecord::new("LON 1", "elsewhere.csv"),
        ConditionRecord::new("LON 2", "lon_2.csv"),
    ];
    let filled = condition
        .with_identified(vec![model("sweeps"), model("new")], records)
        .unwrap();
    let names: Vec<&str> = filled
        .bundle(BundleKind::Identified)
        .iter()
        .map(|model| model.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["sweeps", "new"],
        "expected the new models instead of the {before} of the bundle"
    );
    assert_eq!(
        filled.bundle(BundleKind::Identified)[0].order(),
        Some(1),
        "\"sweeps\" should be the new model"
    );
    let files: Vec<&str> = filled
        .records()
        .iter()
        .map(|record| record.file.as_str())
        .collect();
    assert_eq!(
        files,
        ["elsewhere.csv", "records/all.mat", "rest.csv", "lon_2.csv"]
    );
    let changed = dataset.with_condition(filled.clone()).unwrap();
    assert_eq!(
        (changed.conditions()[0].as_ref(), &changed.conditions()[1]),
        (&filled, &dataset.conditions()[1])
    );
    let error = dataset.identified_model(draft("narrow", 1)).unwrap_err();
    assert!(
        matches!(&*error.fault, DraftFault::Shape { found, .. } if found == "2 x 1"),
        "{error:?}"
    );
}
