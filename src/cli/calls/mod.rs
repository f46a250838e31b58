//! The commands as functions, for programs that embed this crate, such as the Python module.
//!
//! A call takes its command's options as on the command line, and returns the result in memory
//! rather than in files. The text that the command would print is returned beside the result, as
//! the object that `--json` prints. Several threads may call at once.

mod analysed;
mod error;
mod identified;
mod opened;
mod options;

use nalgebra::Complex;
use serde_json::Value;

use gdcm_model::dataset::{BundleKind, Dynamics, PairTable};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use options::option_names;

use super::chosen_example;
use super::failure::Failure;
use super::identify_arguments::IdentifyArguments;
use super::model_arguments::AssembleArguments;
use super::result_arguments::FigureArguments;
use super::study_arguments::StudyArguments;
use super::terminal::collected;
use crate::executor::start_threads;

pub use analysed::{AnalysedStudy, DrawnFigure, ModelChoice, analyze, figure_format_named};
pub use error::CallError;
pub use identified::{IdentifiedRecords, identify};
pub use opened::{Assembled, OpenedData, assemble};

/// Frequency responses by output and input.
pub type Responses = PairTable<Vec<Complex<f64>>>;

/// A call's result, with the messages that the command would print.
#[derive(Clone, Debug)]
pub struct Called<T> {
    pub value: T,
    /// Notes, cautions and text, as the object that `--json` prints.
    pub messages: Value,
}

impl<T> Called<T> {
    /// Applies a function to the result, and keeps the messages.
    pub fn map<U>(self, function: impl FnOnce(T) -> U) -> Called<U> {
        Called {
            value: function(self.value),
            messages: self.messages,
        }
    }
}

/// Returns a model's response at the frequencies `omega` \[rad/s\], by output and input.
fn response_of(dynamics: &Dynamics, omega: &[f64]) -> Responses {
    let grid = FrequencyGrid::at(omega.to_vec());
    FrequencyResponse::from_dynamics(dynamics, &grid)
        .curves()
        .clone()
}

/// Carries out a call, and collects the messages that it would print.
fn called<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<Called<T>, CallError> {
    let (result, messages) = collected(|| {
        start_threads().map_err(|reason| Failure::NoThreads { reason })?;
        work()
    });
    match result {
        Ok(value) => Ok(Called { value, messages }),
        Err(failure) => Err(CallError::new(&failure, messages)),
    }
}

/// Returns the zip archive with the example's flight records, or with the real aircraft's.
pub fn example_records(is_real: bool) -> &'static [u8] {
    chosen_example(is_real).records()
}

/// Returns the names of a command's options, such as "--band"; none for a command that cannot be
/// called.
pub fn option_names_of(command: &str) -> Vec<String> {
    match command {
        "analyze" => option_names::<StudyArguments>(),
        "figure" => option_names::<FigureArguments>(),
        "identify" => option_names::<IdentifyArguments>(),
        "assemble" => option_names::<AssembleArguments>(),
        _ => Vec::new(),
    }
}

/// Returns the bundle with this name; the physics models for an unknown name.
pub fn bundle_named(name: &str) -> BundleKind {
    match name {
        "identified" => BundleKind::Identified,
        _ => BundleKind::Physics,
    }
}
