//! The program's version and commit.
//!
//! The build script finds the commit (`build.rs`); [`gdcm_io::software`] states it in every file.

/// Description of the commit, from the build script: "commit 0123456789ab", with ", modified" if a
/// source file differed from it, or "commit unknown".
pub const BUILT_FROM: &str = env!("GDCM_BUILT_FROM");

/// Sets the commit that files state. Called once, when the program starts; libraries that are used
/// without it, as in tests, state that the commit is unknown.
pub fn set_commit() {
    gdcm_io::software::set_commit(BUILT_FROM);
}
