//! Texts: MATLAB's characters, and strings of HDF5.

use hdf5_pure::{Dataset, Datatype, StringPadding, VlenStringReadOptions};

use super::dataset::Elements;
use super::fault::{damaged, fault};
use crate::places::count;
use crate::variables::{Array, MemoryBudget, TextArray, VariableFault};

/// The texts in the rows of an array of characters' numbers (UTF-16), as many as the shape says.
///
/// An array without characters is one empty text, as MATLAB's `''` is, unless it has several rows.
pub(super) fn rows(codes: &Array, path: &str, meter: &MemoryBudget<'_>) -> Result<TextArray, VariableFault> {
    let (height, length) = (codes.shape.first().copied().unwrap_or(1), codes.shape.get(1).copied().unwrap_or(1));
    if codes.is_empty() && height <= 1 {
        return Ok(TextArray { shape: vec![1, 1], texts: vec![String::new()] });
    }
    let mut shape = codes.shape.clone();
    if let Some(length) = shape.get_mut(1) {
        *length = 1;
    }
    let texts = count(&shape).ok_or_else(|| damaged(path, "there are more rows than can be counted"))?;
    meter.take(texts as u64, size_of::<String>() as u64, path)?;
    // A unit of UTF-16 takes up to three bytes.
    meter.take(codes.len() as u64, 3, path)?;
    let row = |text: usize| {
        let first = (text / height).saturating_mul(height.saturating_mul(length)) + text % height;
        let places = (0..length).map(|column| first.saturating_add(column.saturating_mul(height)));
        let units = places.filter_map(|place| codes.re.get(place)).map(|&code| code as u16);
        char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    Ok(TextArray { shape, texts: (0..texts).map(row).collect() })
}

/// A text of fixed length without what fills it up.
pub(super) fn fixed(bytes: &[u8], padding: &StringPadding) -> String {
    let text = String::from_utf8_lossy(bytes);
    let end = text.find('\0').unwrap_or(text.len());
    let text = &text[..end];
    if matches!(padding, StringPadding::SpacePad) { text.trim_end_matches(' ') } else { text }.to_owned()
}

/// The strings of a dataset, if they are of one of HDF5's two kinds.
pub(super) fn strings(
    dataset: &Dataset,
    elements: &Elements,
    path: &str,
    meter: &MemoryBudget<'_>,
) -> Result<Option<TextArray>, VariableFault> {
    meter.take(elements.count() as u64, (size_of::<String>()) as u64, path)?;
    let texts = match &elements.datatype {
        Datatype::String { padding, size, .. } => {
            meter.take(elements.count() as u64, u64::from(*size), path)?;
            elements.places().map(|place| fixed(elements.at(place), padding)).collect()
        }
        Datatype::VariableLength { is_string: true, .. } => {
            let mut texts = variable(dataset, elements.count(), path, meter)?;
            elements.places().filter_map(|place| texts.get_mut(place).map(std::mem::take)).collect()
        }
        _ => return Ok(None),
    };
    Ok(Some(TextArray { shape: elements.shape.clone(), texts }))
}

fn variable(
    dataset: &Dataset,
    count: usize,
    path: &str,
    meter: &MemoryBudget<'_>,
) -> Result<Vec<String>, VariableFault> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let failed = |error| fault(&error, path);
    // Each string may be the same long one.
    let length = dataset.vlen_string_payload_size().map_err(failed)?;
    meter.take(length, 1, path)?;
    let most = usize::try_from(length).unwrap_or(usize::MAX);
    let options = VlenStringReadOptions::new().with_max_elements(count).with_max_payload_bytes(most);
    let texts = dataset.read_vlen_strings(options).map_err(failed)?;
    if texts.len() == count { Ok(texts) } else { Err(damaged(path, "strings are missing")) }
}
