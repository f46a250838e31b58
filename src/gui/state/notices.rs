//! Messages to the engineer: short notices in the status bar, and bars that remain until closed.

/// Message about the program or its files, shown until it is closed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MessageBar {
    /// A computation panicked.
    Fault {
        /// Names the interrupted work, states that the decisions are kept, and gives the details to
        /// send.
        sentence: String,
    },
    /// Decisions from an earlier window that ended without saving them.
    Recovery {
        offer: usize,
        /// Study and date of the lost decisions.
        sentence: String,
    },
    /// The dataset's file has changed since it was opened.
    Changed { name: String },
    /// The dataset was read again and has changed.
    Differences {
        name: String,
        /// Differences from the earlier dataset, and decisions that no longer apply.
        sentences: Vec<String>,
    },
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
    pub text: String,
}
