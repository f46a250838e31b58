//! Strings in datasets: MATLAB's character arrays, and HDF5 strings of fixed or variable length.

use hdf5_pure::{Dataset, Datatype, StringPadding, VlenStringReadOptions};

use crate::formats::mat::text_rows;
use crate::formats::mat73::dataset::Elements;
use crate::formats::mat73::library_fault::{damaged, library_fault};
use crate::formats::variables::{Array, TextArray};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Converts a character array, stored as UTF-16 codes, to a string for each row.
pub(super) fn character_rows(
    codes: &Array,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<TextArray, VariableFault> {
    budget.take(codes.len() as u64, size_of::<u32>() as u64, path)?;
    let units: Vec<u32> = codes
        .re
        .iter()
        .map(|&code| u32::from(code as u16))
        .collect();
    text_rows(&units, &codes.shape, path, budget)
}

/// Reads the strings of a dataset, of fixed or variable length; `None` if its type is not a string.
pub(super) fn strings(
    dataset: &Dataset,
    elements: &Elements,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Option<TextArray>, VariableFault> {
    let count = elements.count();
    budget.take(count as u64, size_of::<String>() as u64, path)?;
    let texts = match &elements.datatype {
        Datatype::String { padding, size, .. } => {
            budget.take(count as u64, u64::from(*size), path)?;
            elements
                .places()
                .map(|place| decode_fixed_text(elements.bytes_at(place), padding))
                .collect()
        }
        Datatype::VariableLength {
            is_string: true, ..
        } => {
            let mut texts = variable_strings(dataset, count, path, budget)?;
            elements
                .places()
                .filter_map(|place| texts.get_mut(place).map(std::mem::take))
                .collect()
        }
        _ => return Ok(None),
    };
    Ok(Some(TextArray {
        shape: elements.shape.clone(),
        texts,
    }))
}

/// Decodes a fixed-length string and removes its padding.
pub(super) fn decode_fixed_text(bytes: &[u8], padding: &StringPadding) -> String {
    let text = String::from_utf8_lossy(bytes);
    let end = text.find('\0').unwrap_or(text.len());
    let text = &text[..end];
    match padding {
        StringPadding::SpacePad => text.trim_end_matches(' ').to_owned(),
        _ => text.to_owned(),
    }
}

/// Reads `count` variable-length strings, in file order.
fn variable_strings(
    dataset: &Dataset,
    count: usize,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<String>, VariableFault> {
    if count == 0 {
        return Ok(Vec::new());
    }
    // Take the total length from the budget: all strings may refer to the same long string.
    let length = dataset
        .vlen_string_payload_size()
        .map_err(|error| library_fault(&error, path))?;
    budget.take(length, 1, path)?;
    let options = VlenStringReadOptions::new()
        .with_max_elements(count)
        .with_max_payload_bytes(usize::try_from(length).unwrap_or(usize::MAX));
    let texts = dataset
        .read_vlen_strings(options)
        .map_err(|error| library_fault(&error, path))?;
    if texts.len() == count {
        Ok(texts)
    } else {
        Err(damaged(path, Damage::StringsMissing))
    }
}
