//! Models whose matrices have a common suffix: `A_nom, B_nom, ...`, `A1, B1, ...`.
//!
//! The variables `A_nom, B_nom, C_nom, InputDelay_nom, labels` become the record `A, B, C,
//! InputDelay, labels`, which is read like any other:
//!
//! ```text
//! 1  suffixes: A_nom with a B_nom beside it                       (suffixed_models)
//! 2  for each suffix: the matrices, without it                    (matrices_with_suffix)
//!      A, B and C are not all there: no model
//! 3  the other variables; its own delays, without the suffix      (fields_beside)
//! 4  read the record, and list the variables that it used
//! ```

use std::collections::{BTreeSet, HashMap};

use gdcm_model::assembly::FoundModel;

use super::STEPS;
use super::delay_names::is_delay;
use super::record::Record;
use super::search::{Found, Recognise};
use super::state_space::is_state_space;
use super::values::{Field, matrix_of};
use crate::formats::variables::{Value, Variable};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};

const MATRICES: [&str; 5] = ["A", "B", "C", "D", "E"];

pub(super) struct SuffixedModels {
    pub(super) found: Found<FoundModel>,
    /// Names of the variables that these models use.
    pub(super) used: BTreeSet<String>,
}

/// Finds the models whose matrices have a common suffix. Other variables, such as labels, apply to
/// all models; delays may have a model's suffix.
pub(super) fn suffixed_models(
    variables: &[Variable],
    read: Recognise<'_, FoundModel>,
    budget: &ReadingBudget<'_>,
) -> Result<SuffixedModels, VariableFault> {
    let mut models = SuffixedModels {
        found: Found::default(),
        used: BTreeSet::new(),
    };
    let by_name = values_by_name(variables);
    let suffixes: Vec<&str> = variables
        .iter()
        .filter_map(|variable| variable.name.strip_prefix('A'))
        .filter(|suffix| !suffix.is_empty() && by_name.contains_key(format!("B{suffix}").as_str()))
        .collect();
    // Delays that apply to one model only.
    let suffixed_delays = delays_with_suffix(variables, &suffixes.iter().copied().collect());
    for suffix in suffixes {
        budget.work(STEPS, NO_VARIABLE)?;
        let mut fields = matrices_with_suffix(&by_name, suffix);
        if !is_state_space(&Record::from_fields(fields.iter().copied())) {
            continue;
        }
        budget.work(STEPS * variables.len() as u64, NO_VARIABLE)?;
        fields.extend(fields_beside(variables, suffix, &suffixed_delays));
        // Step 4.
        let record = Record::from_fields(fields.into_iter()).shared();
        let name = suffix.trim_start_matches('_');
        models
            .found
            .add(name, read(&record, name).unwrap_or_default());
        for field in record.fields() {
            if record.is_used(field.name) {
                // In the file, the variable has this name, or this name with the suffix, which was
                // removed from the model's matrices and delays.
                models.used.insert(field.name.to_owned());
                models.used.insert(format!("{}{suffix}", field.name));
            }
        }
    }
    Ok(models)
}

/// Returns the values by name; the first if several have the same name.
fn values_by_name(variables: &[Variable]) -> HashMap<&str, &Value> {
    let mut by_name = HashMap::with_capacity(variables.len());
    for variable in variables {
        by_name
            .entry(variable.name.as_str())
            .or_insert(&variable.value);
    }
    by_name
}

/// Returns the matrices whose names end in `suffix`, with the suffix removed.
fn matrices_with_suffix<'v>(by_name: &HashMap<&str, &'v Value>, suffix: &str) -> Vec<Field<'v>> {
    let mut fields = Vec::new();
    for name in MATRICES {
        if let Some(&value) = by_name.get(format!("{name}{suffix}").as_str())
            && matrix_of(name, value).is_ok()
        {
            fields.push(Field { name, value });
        }
    }
    fields
}

/// Returns the fields that apply to the model with this suffix, other than its matrices: all
/// variables but matrices without a suffix and delays with another model's suffix. The suffix is
/// removed from its own delays. Other models' matrices remain: their suffixed names mean nothing in
/// the record.
fn fields_beside<'v>(
    variables: &'v [Variable],
    suffix: &str,
    suffixed_delays: &BTreeSet<&str>,
) -> Vec<Field<'v>> {
    let mut fields = Vec::new();
    for variable in variables {
        if MATRICES.contains(&variable.name.as_str()) {
            continue;
        }
        let mut name = variable.name.as_str();
        if suffixed_delays.contains(name) {
            match name.strip_suffix(suffix) {
                Some(stem) if is_delay(stem) => name = stem,
                _ => continue,
            }
        }
        fields.push(Field {
            name,
            value: &variable.value,
        });
    }
    fields
}

/// Returns the names of delays with the suffix of a model, such as `InputDelay_nom` beside `A_nom`.
fn delays_with_suffix<'v>(
    variables: &'v [Variable],
    suffixes: &BTreeSet<&str>,
) -> BTreeSet<&'v str> {
    variables
        .iter()
        .map(|variable| variable.name.as_str())
        .filter(|name| has_delay_stem(name, suffixes))
        .collect()
}

/// Returns whether a name is a delay name followed by one of the suffixes.
fn has_delay_stem(name: &str, suffixes: &BTreeSet<&str>) -> bool {
    name.char_indices().any(|(at, _)| {
        let (stem, end) = name.split_at(at);
        suffixes.contains(end) && is_delay(stem)
    })
}
