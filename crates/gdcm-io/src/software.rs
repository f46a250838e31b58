//! The program's name, version and commit, as stated in the files that it writes.
//!
//! The version has one source, the workspace's `Cargo.toml`. Only the program knows the commit, and
//! sets it when it starts: the libraries need not be recompiled for every commit, and test output
//! does not depend on it.

use std::sync::OnceLock;

/// Program version, from the workspace's `Cargo.toml`.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Commit statement if the build did not know its commit.
pub const UNKNOWN_COMMIT: &str = "commit unknown";

static COMMIT: OnceLock<&'static str> = OnceLock::new();

/// Sets the commit from which the program was built, in words such as "commit 0123456789ab". Only
/// the first call counts.
pub fn set_commit(commit: &'static str) {
    COMMIT.get_or_init(|| commit);
}

/// Returns version and commit: "1.0.0 (commit 0123456789ab)".
pub fn version() -> String {
    let commit = COMMIT.get().copied().unwrap_or(UNKNOWN_COMMIT);
    format!("{VERSION} ({commit})")
}

/// Returns name, version and commit: "gdcm 1.0.0 (commit 0123456789ab)".
pub fn software() -> String {
    format!("gdcm {}", version())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_without_a_program_knows_its_version_and_no_commit() {
        assert_eq!(
            software(),
            concat!("gdcm ", env!("CARGO_PKG_VERSION"), " (commit unknown)")
        );
    }
}
