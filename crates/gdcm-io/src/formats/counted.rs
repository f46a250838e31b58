//! Counts with their nouns, for messages and notes.

/// Returns a count with its noun: "1 column", "3 columns".
pub(super) fn counted(count: usize, noun: &str) -> String {
    if count == 1 {
        format!("1 {noun}")
    } else {
        format!("{count} {noun}s")
    }
}
