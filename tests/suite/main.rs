//! Every test that is not beside the code it tests, as one program: linking the window library is what building tests spends
//! its time on.

use std::sync::LazyLock;

use gdcm::io::{LoadedDataset, embedded_example};

mod analysis;
mod assembling;
mod commands;
mod dataset_file;
mod exports;
mod figures;
mod hostile_files;
mod identification;
mod messages;
mod optimiser;
mod outputs;
mod records;
mod report;
mod structure;
mod window;

/// The embedded example, read once: most tests of the window and of whole studies start from it.
static EXAMPLE: LazyLock<LoadedDataset> =
    LazyLock::new(|| embedded_example().expect("the embedded example is a dataset"));
