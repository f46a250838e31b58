//! Summary of a folded section below the records.

/// Text at the right of the line that unfolds a section.
pub(super) struct FoldSummary {
    pub(super) text: String,
    /// Whether something in the section should be checked.
    pub(super) is_doubtful: bool,
}
