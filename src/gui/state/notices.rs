//! Messages to the engineer: short notices in the status bar, and bars that remain until closed.

use gdcm_study::decisions::dataset_differences::Difference;

/// Message about the program or its files, shown until it is closed.
#[derive(Clone, Debug, PartialEq)]
pub enum MessageBar {
    /// A computation panicked.
    Fault(FaultReport),
    /// Decisions from an earlier window that ended without saving them.
    Recovery(RecoveryOffer),
    /// The dataset's file has changed since it was opened.
    Changed { name: String },
    /// The dataset was read again and has changed.
    Differences {
        name: String,
        /// Differences from the earlier dataset, and decisions that no longer apply.
        differences: Vec<Difference>,
    },
}

/// Report of a panic, with the details to send to the program's authors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultReport {
    /// The interrupted work, such as "the computation".
    pub work: String,
    /// Origin of the dataset.
    pub dataset: String,
    /// Version of the program.
    pub version: &'static str,
    /// Message and place of the panic.
    pub fault: String,
}

/// Offer to restore decisions that were not saved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecoveryOffer {
    /// Number of the offer.
    pub number: usize,
    /// Origin of the dataset.
    pub dataset: String,
    /// File name of the study, if it was saved before.
    pub study: Option<String>,
    /// Time of the last decision, as displayed.
    pub kept_at: String,
}

impl MessageBar {
    /// Returns the stable code, for tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Fault(_) => "fault",
            Self::Recovery(_) => "decisions-not-saved",
            Self::Changed { .. } => "dataset-changed-on-disk",
            Self::Differences { .. } => "dataset-reloaded",
        }
    }
}

/// Outcome that a notice reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeKind {
    Done,
    Trouble,
}

/// Short message in the status bar; the next decision or notice replaces it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    pub kind: NoticeKind,
    /// Stable code, for tests.
    pub code: &'static str,
    pub text: String,
}
