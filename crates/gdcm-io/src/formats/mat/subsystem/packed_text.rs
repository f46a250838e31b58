//! Strings in a `string` object, packed into 64-bit integers, here called words.

use crate::formats::variables::TextArray;
use crate::reading_budget::{ReadingBudget, VariableFault};

/// The only supported packing version.
const VERSION: u64 = 1;
/// Upper bound for the memory per word: a length with its string, or four units and their
/// characters \[bytes\].
const MEMORY_PER_WORD: u64 = 64;
/// Length that marks a missing string.
const MISSING: u64 = u64::MAX;

/// Unpacks strings from words: version, dimension count, dimensions, string lengths \[UTF-16
/// units\], and the units of all strings, four in each word. A missing string becomes an empty
/// string. Returns `None` for words in any other form.
pub(super) fn unpack_texts(
    words: &[u64],
    budget: &ReadingBudget<'_>,
) -> Result<Option<TextArray>, VariableFault> {
    budget.take(words.len() as u64, MEMORY_PER_WORD, "")?;
    Ok(parse_words(words))
}

fn parse_words(words: &[u64]) -> Option<TextArray> {
    let [VERSION, dimensions, after_count @ ..] = words else {
        return None;
    };
    let (sides, after_sides) = after_count.split_at_checked(usize::try_from(*dimensions).ok()?)?;
    let mut shape = Vec::with_capacity(sides.len());
    for &side in sides {
        shape.push(usize::try_from(side).ok()?);
    }
    let mut count = 1_usize;
    for &side in &shape {
        count = count.checked_mul(side)?;
    }
    let (lengths, packed_units) = after_sides.split_at_checked(count)?;
    // The first unit is in a word's lowest 16 bits.
    let units: Vec<u16> = packed_units
        .iter()
        .flat_map(|word| [0, 16, 32, 48].map(|shift| (word >> shift) as u16))
        .collect();
    let mut rest = units.as_slice();
    let mut texts = Vec::new();
    for &length in lengths {
        let length = if length == MISSING {
            0
        } else {
            usize::try_from(length).ok()?
        };
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
        let word = |units: &[u16]| {
            units
                .iter()
                .rev()
                .fold(0_u64, |word, &unit| (word << 16) | u64::from(unit))
        };
        let words = [
            1,
            2,
            1,
            3,
            3,
            MISSING,
            2,
            word(&units[..4]),
            word(&units[4..]),
        ];
        let texts = ["abc", "", "de"].map(str::to_owned).to_vec();
        assert_eq!(
            parse_words(&words),
            Some(TextArray {
                shape: vec![1, 3],
                texts
            })
        );
    }

    #[test]
    fn other_numbers_are_no_texts() {
        for words in [
            &[][..],
            &[2, 2, 1, 1, 0],
            &[1, 2, 1, 1, 5, 0],
            &[1, 9, 1],
            &[1, 2, u64::MAX, 2, 0],
        ] {
            assert_eq!(parse_words(words), None);
        }
    }
}
