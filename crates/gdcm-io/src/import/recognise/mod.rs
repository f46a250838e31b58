//! Recognises models among a file's variables, whatever the format.
//!
//! A group of fields is a model if the fields have the customary names: `A`, `B`, `C`, `D`; a
//! response over frequencies; numerators and denominators; zeros, poles and gains. The group is a
//! struct, a MATLAB object, or a file's variables. Structs and objects may be inside structs, cells
//! and arrays.
//!
//! Such a group is a `Record` (`record.rs`), whether it holds a model or a flight record.

mod delay_names;
mod delays;
mod flight_condition;
mod frequency_response;
pub(super) mod labels;
pub(super) mod recognition_fault;
pub(super) mod record;
mod response_frequencies;
mod search;
mod state_space;
mod suffixed_matrices;
mod transfer_function;
pub(super) mod values;

#[cfg(test)]
mod recognise_tests;

use std::collections::BTreeSet;

use gdcm_model::assembly::FoundModel;

use self::frequency_response::{is_response, response};
use self::recognition_fault::RecognitionFault;
use self::record::Record;
use self::state_space::{is_state_space, state_spaces};
use self::suffixed_matrices::suffixed_models;
use self::transfer_function::{is_transfer_function, transfer_function};
use crate::formats::variables::{PageIndex, Variable};
use crate::reading_budget::{ReadingBudget, VariableFault};

pub(crate) use self::search::{Found, search};

/// Maximum nesting depth of values that are searched.
pub(crate) const DEEPEST: usize = 16;
/// Maximum number of models or records in a file.
pub(crate) const MOST_FOUND: usize = 10_000;
/// Work steps charged to the budget for each field, which is compared with all recognised names.
const STEPS: u64 = 64;
/// Variables that describe the file, and are therefore not listed as unused.
const NEVER_UNUSED: [&str; 5] = [
    "format",
    "version",
    "__header__",
    "__version__",
    "__globals__",
];

/// Finds all models among the variables of a file. If the shape of an array is ambiguous,
/// `page_index` decides whether its first or its last index selects the model.
///
/// 1. Search the variables together, and inside each (`search`).
/// 2. Add the models whose matrices have a common suffix; they come first.
/// 3. Without any result, only the ignored variables are listed; otherwise only the unused ones,
///    without those of step 2, and elements of an array only once.
pub(crate) fn recognise(
    variables: &[Variable],
    page_index: PageIndex,
    budget: &ReadingBudget<'_>,
) -> Result<Found<FoundModel>, VariableFault> {
    let read = |record: &Record<'_>, variable: &str| read_models(record, variable, page_index);
    // Step 1.
    let mut found = search(variables, budget, &read)?;
    // Step 2.
    let suffixed = suffixed_models(variables, &read, budget)?;
    // Models with suffixes come first: their matrices are variables of the file itself.
    found.items.splice(0..0, suffixed.found.items);
    found.faults.splice(0..0, suffixed.found.faults);
    // Step 3.
    if found.items.is_empty() && found.faults.is_empty() {
        found.unused.clear();
        return Ok(found);
    }
    found.ignored.clear();
    let mut listed = BTreeSet::new();
    for name in std::mem::take(&mut found.unused) {
        if suffixed.used.contains(&name) || NEVER_UNUSED.contains(&name.as_str()) {
            continue;
        }
        let name = without_indices(&name);
        if listed.insert(name.clone()) {
            found.unused.push(name);
        }
    }
    Ok(found)
}

/// Reads the models that the fields of a record form: state-space models, else a measured response,
/// else transfer functions; `None` if they do not form a model.
fn read_models(
    record: &Record<'_>,
    variable: &str,
    page_index: PageIndex,
) -> Option<Vec<Result<FoundModel, RecognitionFault>>> {
    if is_state_space(record) {
        Some(state_spaces(record, variable, page_index))
    } else if is_response(record) {
        Some(vec![response(record, variable)])
    } else if is_transfer_function(record) {
        Some(vec![transfer_function(record, variable)])
    } else {
        None
    }
}

/// Replaces the indices in a path by colons: "models(3).mass" becomes "models(:).mass".
fn without_indices(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    let mut is_inside = false;
    for letter in name.chars() {
        match letter {
            '(' | '{' => is_inside = true,
            ')' | '}' => is_inside = false,
            _ => {}
        }
        if !(is_inside && letter.is_ascii_digit()) {
            text.push(letter);
        } else if !text.ends_with(':') {
            text.push(':');
        }
    }
    text
}
