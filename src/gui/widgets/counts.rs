//! Counts with their nouns.

/// Returns a count with its noun: "1 model", "3 models".
pub fn counted(count: usize, noun: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{ending}")
}
