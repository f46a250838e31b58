//! Sentence parts and table cells in the report.

use gdcm_model::number_format::{NO_VALUE, counted};

/// Maximum number of names in a list within a sentence.
pub(super) const NAMES_SHOWN: usize = 12;

/// Placeholder for a missing value in tables.
pub(super) const MISSING: &str = NO_VALUE;

/// Joins names with commas; beyond [`NAMES_SHOWN`] names, the others are only counted.
pub(super) fn names<S: AsRef<str>>(all: &[S]) -> String {
    let shown: Vec<&str> = all.iter().take(NAMES_SHOWN).map(AsRef::as_ref).collect();
    let shown = shown.join(", ");
    if all.len() <= NAMES_SHOWN {
        return shown;
    }
    format!("{shown} and {} more", all.len() - NAMES_SHOWN)
}

/// Returns a count with its noun and verb: "1 model is", "3 models are".
pub(super) fn counted_are(count: usize, noun: &str) -> String {
    let verb = if count == 1 { "is" } else { "are" };
    format!("{} {verb}", counted(count, noun))
}

/// Capitalises the first letter; a leading symbol is unchanged ("α of the gains").
pub(super) fn capital(words: &str) -> String {
    let mut capital = words.to_owned();
    if let Some(first) = capital.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    capital
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_names_the_first_are_given_and_the_others_counted() {
        assert_eq!(names(&["a", "b"]), "a, b");
        let many: Vec<String> = (0..1000).map(|number| number.to_string()).collect();
        assert!(
            names(&many).ends_with("10, 11 and 988 more"),
            "{}",
            names(&many)
        );
    }
}
