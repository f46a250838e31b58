//! Every test that is not beside the code it tests, as one program: linking the window library is what building tests spends
//! its time on.

use std::path::Path;
use std::sync::LazyLock;

use gdcm_files::{LoadedDataset, embedded_example, load_dataset};

mod assembling;
mod commands;
mod couplings;
mod documents;
mod exports;
#[path = "../../crates/gdcm-files/tests/suite/made_up.rs"]
mod made_up;
mod messages;
mod outputs;
mod records;
mod report;
mod requirements;
mod scripts;
mod structure;
mod window;

/// What a file of JSON holds.
fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).expect("it can be read")).expect("it is JSON")
}

/// The members of an object of JSON, in their order.
fn members(json: &serde_json::Value) -> Vec<&serde_json::Value> {
    json.as_object().expect("it is an object").values().collect()
}

/// The entries of a list of JSON.
fn entries(json: &serde_json::Value) -> &[serde_json::Value] {
    json.as_array().expect("it is a list")
}

/// The embedded example, read once: most tests of the window and of whole studies start from it.
static EXAMPLE: LazyLock<LoadedDataset> =
    LazyLock::new(|| embedded_example().expect("the embedded example is a dataset"));

/// The dataset that reference figures were computed from by independent code: the example's physics models, and three identified
/// models a condition that are not the program's.
static REFERENCE_DATASET: LazyLock<LoadedDataset> = LazyLock::new(|| {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference/example-dataset.json.gz");
    load_dataset(&path).expect("it is a dataset")
});
