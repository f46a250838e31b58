//! Every test of numbers and files that is not beside the code it tests, as one program: it links no window.

use std::path::PathBuf;
use std::sync::LazyLock;

use gdcm_io::{LoadedDataset, embedded_example, load_dataset};
use gdcm_model::executor::{Executor, Task};

mod analysis;
mod dataset_file;
mod figures;
mod file_forms;
mod foreign_files;
mod fuzz;
mod hostile_files;
mod identification;
mod made_up;
mod optimiser;

/// The folder of the program, where the data of all tests are.
fn program_folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// The example's flight records as they were packed.
fn records_archive() -> Vec<u8> {
    std::fs::read(program_folder().join("assets/example-records.zip"))
        .expect("the archive is there")
}

/// The embedded example, read once.
static EXAMPLE: LazyLock<LoadedDataset> =
    LazyLock::new(|| embedded_example().expect("the embedded example is a dataset"));

/// The dataset that reference figures were computed from by independent code: the example's physics models, and three identified
/// models a condition that are not the program's.
static REFERENCE_DATASET: LazyLock<LoadedDataset> = LazyLock::new(|| {
    let path = program_folder().join("tests/data/reference/example-dataset.json.gz");
    load_dataset(&path).expect("it is a dataset")
});

/// All cores of the machine: what is asked for first is begun first.
struct EveryCore;

impl Executor for EveryCore {
    fn carry_out(&self, tasks: Vec<Task<'_>>) {
        rayon::scope_fifo(|scope| {
            tasks
                .into_iter()
                .for_each(|task| scope.spawn_fifo(move |_| task()))
        });
    }
}
