//! `gdcm example`.

use std::path::Path;

use crate::io::{Existing, plain_path, write_example};

use super::failure::Failure;
use super::terminal::say;

/// Writes the embedded example into a directory and says where.
pub(super) fn example(directory: &Path, existing: Existing) -> Result<(), Failure> {
    let path = write_example(directory, existing)?;
    say(&format!("{}: the example dataset (synthetic data)\n", plain_path(&path)))
}
