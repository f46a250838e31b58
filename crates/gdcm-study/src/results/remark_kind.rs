//! Kind of a remark: success, caution or failure.

/// Whether a request was fulfilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemarkKind {
    /// The request was fulfilled.
    Good,
    /// The request was fulfilled, with a caution.
    Caution,
    /// The request could not be fulfilled.
    Trouble,
}
