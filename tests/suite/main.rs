//! All tests outside the source files, linked into one program, because linking the window library
//! takes most of the build time.

use std::path::Path;
use std::sync::LazyLock;

use gdcm_io::{
    DatasetOrigin, Example, LoadedDataset, embedded_example, load_dataset, load_dataset_bytes,
};

mod assembling;
mod calls;
mod commands;
mod couplings;
mod documents;
mod exports;
mod file_cycles;
mod licences;
mod messages;
mod outputs;
mod physics;
mod planning;
mod records;
mod report;
mod requirements;
mod scripts;
mod structure;
#[path = "../../crates/gdcm-io/tests/suite/synthetic.rs"]
mod synthetic;
mod window;

/// Parses a JSON file.
fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).expect("it can be read")).expect("it is JSON")
}

/// Returns the members of a JSON object, in file order.
fn members(json: &serde_json::Value) -> Vec<&serde_json::Value> {
    json.as_object()
        .expect("it is an object")
        .values()
        .collect()
}

/// Returns the entries of a JSON list.
fn entries(json: &serde_json::Value) -> &[serde_json::Value] {
    json.as_array().expect("it is a list")
}

/// The embedded example, loaded once for most tests of the window and of whole studies.
static EXAMPLE: LazyLock<LoadedDataset> =
    LazyLock::new(|| embedded_example().expect("the embedded example is a dataset"));

/// Conditions 3, 7 and 10 of the example as a file. They take a quarter of the example's computing
/// time.
static FEW_TEXT: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let packed = std::fs::File::open(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/assets/example-dataset.json.gz"
    ));
    let unpacked = flate2::read::GzDecoder::new(packed.expect("it can be read"));
    let mut file: serde_json::Value = serde_json::from_reader(unpacked).expect("it is JSON");
    file["conditions"]
        .as_array_mut()
        .expect("a list")
        .retain(|of| [3, 7, 10].contains(&of["id"].as_i64().unwrap()));
    serde_json::to_vec(&file).expect("it can be written")
});

/// The conditions of [`FEW_TEXT`], loaded. The program contains flight records of conditions 3 and
/// 10.
static FEW: LazyLock<LoadedDataset> = LazyLock::new(|| {
    load_dataset_bytes(
        &FEW_TEXT,
        DatasetOrigin::EmbeddedExample(Example::Simulated),
    )
    .expect("it is a dataset")
});

/// Dataset for which independent code computed the reference values: the example's physics models,
/// and three identified models per condition from another source.
static REFERENCE_DATASET: LazyLock<LoadedDataset> = LazyLock::new(|| {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference/example-dataset.json.gz");
    load_dataset(&path).expect("it is a dataset")
});
