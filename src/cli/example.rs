//! `gdcm example`.

use std::path::Path;

use crate::io::{plain, write_example};

use super::failure::Failure;
use super::terminal::say;

/// Writes the embedded example into a directory and says where.
pub(super) fn example(directory: &Path) -> Result<(), Failure> {
    let path = write_example(directory)?;
    say(&format!("{}: the example dataset (synthetic data)\n", plain(&path.display().to_string())))
}
