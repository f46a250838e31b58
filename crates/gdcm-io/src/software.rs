//! Name, version and commit of the program, as every file that it writes states them.
//!
//! The version has one source, the workspace's `Cargo.toml`. The commit is known to the program
//! alone, which sets it at its start: the libraries are not compiled again for every commit, and
//! what tests write does not depend on it.

use std::sync::OnceLock;

/// Version of the program, from the workspace's `Cargo.toml`.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Statement of a program whose build had no commit to name.
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
