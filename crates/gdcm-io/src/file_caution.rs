//! Cautions about a file's text: something in it is not used, or looks unusual.

use gdcm_model::dataset::draft_fault::Warning;
use gdcm_model::message_text::quoted;

/// A caution about a file, with its place.
///
/// Its text is the sentence shown to the engineer; [`Self::code`] is for programs and tests.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileCaution {
    /// An unknown key, the first of `count` like it.
    #[error("{place}the key {} is unknown and ignored{}", quoted(key), more(*count))]
    UnknownKey {
        /// Where the first such key is, with a colon at the end; empty for the whole file.
        place: String,
        key: String,
        count: usize,
    },
    /// A list entry that the program does not use, the first of `count` like it.
    #[error("{place}this entry is unknown and ignored{}", more(*count))]
    UnknownEntry { place: String, count: usize },
    /// Further unknown keys, which are only counted.
    #[error("{} unknown and ignored", others(*count))]
    MoreUnknownKeys { count: usize },
    /// A key that is valid only in the other kind of model, or only outside a dataset.
    #[error("{place}the key \"{key}\" has no meaning here and is ignored")]
    MisplacedKey { place: String, key: String },
    /// An unusual model property.
    #[error("{}{}", .0.place.before(), .0.oddity)]
    Oddity(Warning),
}

impl FileCaution {
    /// Returns the stable code by which scripts and tests distinguish the cautions.
    pub fn code(&self) -> &'static str {
        match self {
            Self::UnknownKey { .. } => "unknown-key",
            Self::UnknownEntry { .. } => "unknown-entry",
            Self::MoreUnknownKeys { .. } => "more-unknown-keys",
            Self::MisplacedKey { .. } => "misplaced-key",
            Self::Oddity(warning) => warning.oddity.code(),
        }
    }
}

/// Returns the words for further occurrences: ", as are 2 more like it"; empty for a single
/// occurrence.
fn more(count: usize) -> String {
    match count {
        0 | 1 => String::new(),
        2 => ", as is 1 more like it".to_owned(),
        count => format!(", as are {} more like it", count - 1),
    }
}

fn others(count: usize) -> String {
    match count {
        1 => "1 other key is".to_owned(),
        count => format!("{count} other keys are"),
    }
}
