//! Notes on a file's channels.

use crate::dataset::channel::ChannelSide;

/// Note on a file's channels, for the engineer to review.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChannelNote {
    /// The rules declare another unit than the file.
    #[error("{channel}: the declared unit {declared} replaces the unit {found} in the file")]
    UnitReplaced {
        channel: String,
        declared: String,
        /// Unit in the file.
        found: String,
    },
    /// File channels match no dataset channel.
    #[error("{side}s in the file but not in the dataset: {}", names.join(", "))]
    NotInDataset {
        side: ChannelSide,
        names: Vec<String>,
    },
}

impl ChannelNote {
    /// Returns the stable code by which scripts and tests distinguish the notes.
    pub fn code(&self) -> &'static str {
        match self {
            Self::UnitReplaced { .. } => "unit-replaced",
            Self::NotInDataset { .. } => "channels-not-in-dataset",
        }
    }
}
