//! Dataset files: which content is accepted, and with which messages other content is rejected.

use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

use gdcm_io::file_caution::FileCaution;
use gdcm_io::{
    DatasetOrigin, Example, FileError, LoadedDataset, embedded_example, load_any, load_dataset,
    load_dataset_bytes,
};
use gdcm_model::dataset::draft_fault::DraftOddity;
use gdcm_model::dataset::limits::LARGEST_TEXT;
use gdcm_model::dataset::{BundleKind, Dynamics, Model};

mod parameters;
mod properties;
mod records;
mod studies;
mod wrong_content;
mod wrong_text;

const SMALL: &str = include_str!("../../../../../tests/data/small-dataset.json");

/// Returns the small dataset as a file after `change`.
fn small(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut value: Value = serde_json::from_str(SMALL).unwrap();
    change(&mut value);
    serde_json::to_vec(&value).unwrap()
}

fn load(bytes: &[u8]) -> Result<LoadedDataset, FileError> {
    load_dataset_bytes(bytes, DatasetOrigin::File(PathBuf::from("test.json")))
}

/// Returns the error with which these bytes are rejected; asserts that its message is a single line
/// and names the file.
fn refusal(bytes: &[u8]) -> FileError {
    let error = load(bytes).expect_err("the file should be refused");
    let message = error.to_string();
    assert!(
        message.starts_with("test.json: ") && message.lines().count() == 1,
        "{message}"
    );
    error
}

/// Returns the code with which these bytes are rejected.
fn refusal_code(bytes: &[u8]) -> &'static str {
    refusal(bytes).code()
}

/// Asserts that the small dataset after `change` is rejected: the code of the error, a part of its
/// place, and values that its message gives, such as "found -5".
fn assert_refused(change: impl FnOnce(&mut Value), code: &str, place: &str, values: &[&str]) {
    assert_error(&refusal(&small(change)), code, place, values);
}

/// Asserts the same for the text of the small dataset in which the first `from` is replaced by
/// `to`.
fn assert_text_refused(from: &str, to: &str, code: &str, place: &str, values: &[&str]) {
    assert!(SMALL.contains(from), "{from}");
    let error = refusal(SMALL.replacen(from, to, 1).as_bytes());
    assert_error(&error, code, place, values);
}

fn assert_error(error: &FileError, code: &str, place: &str, values: &[&str]) {
    assert_eq!(error.code(), code, "{error}");
    let found = error.place().map(ToString::to_string).unwrap_or_default();
    assert!(found.contains(place), "expected \"{place}\" in: {found}");
    let message = error.to_string();
    for value in values {
        assert!(
            message.contains(value),
            "expected \"{value}\" in: {message}"
        );
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn the_small_dataset_is_read_with_its_shape_orders_and_matrices() {
    let loaded = load(SMALL.as_bytes()).unwrap();
    let dataset = &loaded.dataset;
    assert_eq!(
        (
            dataset.inputs().len(),
            dataset.outputs().len(),
            dataset.conditions().len()
        ),
        (2, 2, 2)
    );
    let orders: Vec<Option<usize>> = dataset
        .conditions()
        .iter()
        .flat_map(|condition| condition.bundle(BundleKind::Identified))
        .map(Model::order)
        .collect();
    assert_eq!(orders, [Some(2), None, Some(2), Some(0)]);
    let Dynamics::StateSpace(model) =
        &dataset.conditions()[0].bundle(BundleKind::Physics)[0].dynamics
    else {
        panic!("the model should have matrices")
    };
    assert_eq!(
        (model.a()[(0, 1)], model.a()[(1, 0)]),
        (1.0, -2.0),
        "A should be read by rows"
    );
    assert_eq!(loaded.cautions, []);
}

#[test]
fn timing_valid_bands_averages_and_windows_survive_saving() {
    let bytes = small(|file| {
        let model = &mut file["conditions"][0]["physics_models"][1];
        model["sample_time_s"] = json!(0.01);
        model["output_delays_s"] = json!([0, 0.02]);
        let response = &mut file["conditions"][0]["identified_models"][1]["frequency_response"];
        response["averages"] = json!(12);
        response["window_s"] = json!(20.0);
        response["valid_band_rad_s"] = json!([[[0.5, 9], [0.5, 9]], [[0.5, 9], [1, 9]]]);
    });
    let loaded = load(&bytes).unwrap();
    assert_eq!(loaded.cautions, []);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("again.json");
    gdcm_io::files::dataset_file::save_dataset(&loaded.dataset, &path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    for written in [
        "\"sample_time_s\":0.01",
        "\"output_delays_s\":[0.0,0.02]",
        "\"averages\":12.0",
        "\"window_s\":20.0",
    ] {
        assert!(text.contains(written), "{written}");
    }
    assert_eq!(load_dataset(&path).unwrap().dataset, loaded.dataset);
}

#[test]
fn a_gzip_file_is_recognised_by_its_bytes_not_its_name() {
    let plain = load(SMALL.as_bytes()).unwrap();
    let packed = load(&gzip(SMALL.as_bytes())).unwrap();
    assert_eq!(plain.dataset, packed.dataset);
    assert_ne!(
        plain.sha256, packed.sha256,
        "the hash should be that of the stored bytes"
    );
}

#[test]
fn the_embedded_example_has_eleven_conditions_and_no_cautions() {
    let example = embedded_example().unwrap();
    assert_eq!(
        (example.dataset.conditions().len(), example.cautions.len()),
        (11, 0)
    );
    assert_eq!(
        example.origin,
        DatasetOrigin::EmbeddedExample(Example::Simulated)
    );
}

#[test]
fn a_byte_order_mark_is_skipped() {
    assert!(load(&[b"\xef\xbb\xbf", SMALL.as_bytes()].concat()).is_ok());
}

#[test]
fn the_matrix_c_of_a_static_gain_may_have_empty_rows_or_none() {
    for c in [json!([]), json!([[], []])] {
        let bytes = small(|file| file["conditions"][1]["identified_models"][1]["C"] = c.clone());
        assert!(load(&bytes).is_ok(), "{c}");
    }
}

#[test]
fn unknown_keys_are_reported_with_their_first_place_and_their_count() {
    let bytes = small(|file| {
        file["author"] = json!("someone");
        for model in file["conditions"][0]["physics_models"]
            .as_array_mut()
            .unwrap()
        {
            model["wind"] = json!({"deep": [1, 2]});
        }
    });
    assert_eq!(
        load(&bytes).unwrap().cautions,
        [
            FileCaution::UnknownKey {
                place: String::new(),
                key: "author".to_owned(),
                count: 1,
            },
            FileCaution::UnknownKey {
                place: "condition 7 (number 1 in the file), physics model \"nominal\" (number 1): "
                    .to_owned(),
                key: "wind".to_owned(),
                count: 2,
            },
        ]
    );
}

#[test]
fn a_stated_order_that_differs_from_the_matrices_is_a_caution() {
    let bytes = small(|file| file["conditions"][1]["identified_models"][0]["order"] = json!(12));
    let cautions = load(&bytes).unwrap().cautions;
    let [FileCaution::Oddity(warning)] = cautions.as_slice() else {
        panic!("{cautions:?}")
    };
    assert_eq!(
        warning.oddity,
        DraftOddity::Order {
            stated: 12,
            states: 2
        }
    );
    let place = warning.place.to_string();
    assert!(
        place.starts_with("condition 10") && place.contains("\"sweeps\""),
        "{place}"
    );
}

#[test]
fn the_first_fifty_unknown_keys_are_listed_and_the_rest_are_counted() {
    let bytes = small(|file| {
        for index in 0..1000 {
            file[format!("key {index}")] = json!(index);
        }
    });
    let cautions = load(&bytes).unwrap().cautions;
    assert_eq!(cautions.len(), 51);
    assert_eq!(cautions[50], FileCaution::MoreUnknownKeys { count: 950 });
}

#[test]
fn state_names_are_kept_only_if_every_state_has_one() {
    let names = |loaded: &LoadedDataset, model: usize| {
        loaded.dataset.conditions()[0].bundle(BundleKind::Physics)[model]
            .states
            .to_vec()
    };
    let loaded = load(&small(|_| {})).unwrap();
    assert_eq!(
        (names(&loaded, 0), loaded.cautions.len()),
        (vec!["w".to_owned(), "q".to_owned()], 0)
    );
    let wrong = load(&small(|value| {
        value["conditions"][0]["physics_models"][1]["states"] = json!(["w"])
    }))
    .unwrap();
    assert_eq!((names(&wrong, 0).len(), names(&wrong, 1).len()), (2, 0));
    let [caution] = wrong.cautions.as_slice() else {
        panic!("{:?}", wrong.cautions)
    };
    assert_eq!(caution.code(), "state-name-count");
}
