//! The texts of a `string` object, packed into whole numbers of 64 bits.

use crate::variables::{MemoryBudget, TextArray, VariableFault};

/// The only version of the packing that is known.
const VERSION: u64 = 1;
/// What stands for the length of a missing text.
const MISSING: u64 = u64::MAX;

/// The texts packed as version, number of dimensions, dimensions, lengths and units of UTF-16, four to a number; `None` if the
/// numbers are something else. A missing text is an empty one.
pub(super) fn packed_text(words: &[u64], meter: &MemoryBudget<'_>) -> Result<Option<TextArray>, VariableFault> {
    meter.take(words.len() as u64, 64, "")?;
    Ok(unpacked(words))
}

fn unpacked(words: &[u64]) -> Option<TextArray> {
    let [VERSION, dimensions, rest @ ..] = words else { return None };
    let (shape, rest) = rest.split_at_checked(usize::try_from(*dimensions).ok()?)?;
    let shape: Vec<usize> = shape.iter().map(|&length| usize::try_from(length).ok()).collect::<Option<_>>()?;
    let count = shape.iter().try_fold(1_usize, |product, &length| product.checked_mul(length))?;
    let (lengths, rest) = rest.split_at_checked(count)?;
    let units: Vec<u16> = rest.iter().flat_map(|word| [0, 16, 32, 48].map(|shift| (word >> shift) as u16)).collect();
    let mut rest = units.as_slice();
    let mut texts = Vec::new();
    for &length in lengths {
        let length = if length == MISSING { 0 } else { usize::try_from(length).ok()? };
        let (text, after) = rest.split_at_checked(length)?;
        texts.push(String::from_utf16_lossy(text));
        rest = after;
    }
    Some(TextArray { shape, texts })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_follow_one_another_without_gaps() {
        let units: Vec<u16> = "abcde".encode_utf16().collect();
        let word = |units: &[u16]| units.iter().rev().fold(0_u64, |word, &unit| (word << 16) | u64::from(unit));
        let words = [1, 2, 1, 3, 3, MISSING, 2, word(&units[..4]), word(&units[4..])];
        let texts = ["abc", "", "de"].map(str::to_owned).to_vec();
        assert_eq!(unpacked(&words), Some(TextArray { shape: vec![1, 3], texts }));
    }

    #[test]
    fn other_numbers_are_no_texts() {
        for words in [&[][..], &[2, 2, 1, 1, 0], &[1, 2, 1, 1, 5, 0], &[1, 9, 1], &[1, 2, u64::MAX, 2, 0]] {
            assert_eq!(unpacked(words), None);
        }
    }
}
