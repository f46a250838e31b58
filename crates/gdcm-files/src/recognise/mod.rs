//! From variables to models: what a file holds, whatever its format.
//!
//! A group of fields is a model by the names that the field gives them: `A`, `B`, `C`, `D`; a response over frequencies; numerators
//! and denominators; zeros, poles and gains. Groups are structs, objects of MATLAB, the variables of a file beside one another, and
//! all of these inside structs, cells and arrays.

mod descriptor;
pub(super) mod labels;
mod matrix;
pub(super) mod record;
mod response;
mod search;
mod state_space;
mod transfer_function;

use gdcm_core::assembly::FoundModel;

use super::variables::Variable;

/// Deepest nesting that is searched for models.
const DEEPEST: usize = 16;

/// What was recognised among variables.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Recognised {
    /// The models; their source names the variable only.
    pub(super) models: Vec<FoundModel>,
    /// What looks like a model but cannot be taken, with its place and why.
    pub(super) faults: Vec<String>,
    /// What is no model, in words.
    pub(super) passed_over: Vec<String>,
}

/// Every model among the variables of a file.
pub(super) fn recognise(variables: &[Variable]) -> Recognised {
    search::search(variables)
}
