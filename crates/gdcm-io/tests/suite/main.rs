//! Integration tests of numbers and files, linked into one program that does not depend on the
//! window.

use std::path::PathBuf;
use std::sync::LazyLock;

use gdcm_io::{LoadedDataset, embedded_example, load_dataset};
use gdcm_model::executor::{Executor, Task};

mod analysis;
mod dataset_file;
#[path = "../../../../tests/support/evidence.rs"]
mod evidence;
mod figures;
mod file_forms;
mod foreign_files;
mod fuzz;
mod hostile_files;
mod identification;
mod optimiser;
mod synthetic;

/// Returns the root folder of the repository, which contains the data of all tests.
fn program_folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Returns the archive with the flight records of the example.
fn records_archive() -> Vec<u8> {
    std::fs::read(program_folder().join("assets/example-records.zip"))
        .expect("the archive of the example's records can be read")
}

/// The embedded example, read once.
static EXAMPLE: LazyLock<LoadedDataset> =
    LazyLock::new(|| embedded_example().expect("the embedded example is a valid dataset"));

/// Dataset for which independent code computed the reference values: the example's physics models,
/// and three identified models per condition that were not identified by this program.
static REFERENCE_DATASET: LazyLock<LoadedDataset> = LazyLock::new(|| {
    let path = program_folder().join("tests/data/reference/example-dataset.json.gz");
    load_dataset(&path).expect("the reference file is a valid dataset")
});

/// Executor on all cores of the machine; tasks are started in their order.
struct EveryCore;

impl Executor for EveryCore {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        rayon::scope_fifo(|scope| {
            for task in tasks {
                scope.spawn_fifo(move |_| task());
            }
        });
    }
}
