//! Whether the program was started before.

use std::fs::{OpenOptions, create_dir_all};
use std::path::Path;

/// The file that says so.
const NAME: &str = "started";

/// Whether nothing in the program's directory says that it was started before; from now on something does. Where that cannot be
/// kept, it is taken as started before: what the first start shows would come at every one.
pub fn is_first_start(directory: &Path) -> bool {
    let kept = create_dir_all(directory)
        .and_then(|()| OpenOptions::new().write(true).create_new(true).open(directory.join(NAME)));
    kept.is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_start_is_the_first_and_none_where_nothing_can_be_kept() {
        let folder = tempfile::tempdir().unwrap();
        let directory = folder.path().join("gdcm");
        assert!(is_first_start(&directory));
        assert!(!is_first_start(&directory));
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        assert!(!is_first_start(&file.join("gdcm")));
    }
}
