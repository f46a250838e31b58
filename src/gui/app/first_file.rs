//! File with which the window opens: the requested file, the file from the last session, or the
//! example.

use std::path::PathBuf;

use gdcm_io::files::recent_files::recent_files;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_io::user_paths::file_exists;
use gdcm_io::{FileError, Opened, embedded_example, load_any};
use gdcm_model::message_text::{sanitized, shortened_message};

use super::setup::Setup;
use crate::gui::state::opens_with::OpensWith;
use crate::message::Message;

/// Result of reading the requested file; the example if there is none.
pub(super) struct Loaded {
    /// The study to open, or the fault in the embedded example.
    pub(super) opened: Result<Opened, String>,
    /// Fault in the requested file; the window then opens the example.
    pub(super) trouble: Option<Message>,
}

/// Loads the requested file, or the example if there is none or it is faulty. A fault is also
/// printed on the terminal, where it remains visible if no window opens.
pub(super) fn load_and_report(path: Option<PathBuf>) -> Loaded {
    let loaded = load(path);
    if let Some(trouble) = &loaded.trouble {
        eprintln!("error: {}", trouble.text);
    }
    loaded
}

fn load(path: Option<PathBuf>) -> Loaded {
    let Some(path) = path else {
        return Loaded {
            opened: load_example(),
            trouble: None,
        };
    };
    match load_any(&path, &ReadingBudget::default()) {
        Ok(opened) => Loaded {
            opened: Ok(opened),
            trouble: None,
        },
        Err(error) => Loaded {
            opened: load_example(),
            trouble: Some(Message::new(error.code(), short_message(&error))),
        },
    }
}

fn load_example() -> Result<Opened, String> {
    match embedded_example() {
        Ok(example) => Ok(Opened::Dataset(example)),
        Err(error) => Err(short_message(&error)),
    }
}

fn short_message(error: &FileError) -> String {
    shortened_message(&sanitized(&error.to_string()))
}

/// Returns the most recent file that still exists; `None` if there is none, or if the preferences
/// do not ask for it.
pub(super) fn last_opened(setup: &Setup) -> Option<PathBuf> {
    if setup.preferences.opens_with != OpensWith::LastStudy {
        return None;
    }
    recent_files(setup.directory.as_deref()?)
        .into_iter()
        .find(|path| file_exists(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_file_opens_the_example_and_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.json");
        std::fs::write(&path, "{\"format\": ").unwrap();
        let loaded = load(Some(path));
        assert!(
            matches!(loaded.opened, Ok(Opened::Dataset(example)) if example.path().is_none()),
            "the example"
        );
        let trouble = loaded.trouble.unwrap();
        assert_eq!(trouble.code, "json-cut-off");
        assert!(trouble.text.contains("broken.json"));
        let example = load(None);
        assert!(example.opened.is_ok());
        assert_eq!(example.trouble, None);
    }
}
