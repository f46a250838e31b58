//! Marker file that distinguishes the first program start from later ones.

use std::fs::{OpenOptions, create_dir_all};
use std::path::Path;

/// Name of the empty file that marks an earlier program start.
const STARTED: &str = "started";

/// Returns whether this is the first program start, and marks it in `directory`. Returns false if
/// it cannot be marked: otherwise every start would look like the first.
pub fn is_first_start(directory: &Path) -> bool {
    let kept = create_dir_all(directory).and_then(|()| {
        OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(directory.join(STARTED))
    });
    kept.is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_start_is_the_first_and_none_if_nothing_can_be_kept() {
        let folder = tempfile::tempdir().unwrap();
        let directory = folder.path().join("gdcm");
        assert!(is_first_start(&directory));
        assert!(!is_first_start(&directory));
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        assert!(!is_first_start(&file.join("gdcm")));
    }
}
