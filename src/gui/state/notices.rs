//! Messages to the engineer: notices that come and go, and bars that stay.

/// Event that concerns the program or its files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Bar {
    /// A computation panicked.
    Fault {
        /// The ended work, the kept decisions, and the details to send.
        sentence: String,
    },
    /// Decisions from an earlier window that ended without saving them.
    Recovery {
        offer: usize,
        /// Study and date.
        sentence: String,
    },
    /// The dataset's file has changed since it was opened.
    Changed { name: String },
    /// The dataset was read again and has changed.
    Differences {
        name: String,
        /// Changes, and decisions that no longer apply.
        sentences: Vec<String>,
    },
}

/// Outcome reported by a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoticeKind {
    /// Success.
    Done,
    /// Failure.
    Trouble,
}

/// Message to the engineer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    pub kind: NoticeKind,
    pub text: String,
}
