//! Finds the commit from which the program is built, for `gdcm --version` and for the files that
//! it writes.
//!
//! Only release builds name a commit: during development nothing is compiled again because of a
//! commit, and tests do not depend on one. The commit comes from, in this order,
//!
//! 1. the environment variable `GDCM_COMMIT`, for builds outside a checkout;
//! 2. git, if this folder is the root of a checkout;
//! 3. `packaging/source-commit.txt`, which `git archive` fills in for source archives.
//!
//! Nothing else about the build is recorded (no date, no machine): the same source gives the same
//! program.

use std::path::Path;
use std::process::Command;

/// Number of hexadecimal digits by which a commit is named.
const DIGITS: usize = 12;
const ARCHIVED: &str = "packaging/source-commit.txt";

fn main() {
    println!("cargo::rerun-if-env-changed=GDCM_COMMIT");
    println!("cargo::rerun-if-changed=build.rs");
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = if is_release { commit() } else { None };
    let words = match commit {
        Some(commit) => format!("commit {commit}"),
        None => "commit unknown".to_owned(),
    };
    println!("cargo::rustc-env=GDCM_BUILT_FROM={words}");
}

fn commit() -> Option<String> {
    if let Ok(given) = std::env::var("GDCM_COMMIT")
        && is_commit(&given)
    {
        return Some(shortened(&given));
    }
    if let Some(commit) = commit_of_checkout() {
        return Some(commit);
    }
    println!("cargo::rerun-if-changed={ARCHIVED}");
    let archived = std::fs::read_to_string(ARCHIVED).ok()?;
    let archived = archived.trim();
    // In a checkout the file holds the placeholder that `git archive` replaces.
    if is_commit(archived) {
        Some(shortened(archived))
    } else {
        None
    }
}

/// Returns the commit that is checked out, marked as modified if a tracked file differs from it;
/// `None` unless git is available and this folder is the root of a checkout.
fn commit_of_checkout() -> Option<String> {
    // Source unpacked inside another repository is not that repository's commit.
    let root = git(&["rev-parse", "--show-toplevel"])?;
    let here = std::env::current_dir().ok()?.canonicalize().ok()?;
    if Path::new(&root).canonicalize().ok()? != here {
        return None;
    }
    let commit = git(&["rev-parse", "HEAD"])?;
    // A change in these paths usually compiles this package again anyway, so that checking again
    // whether the source differs from the commit costs little.
    for path in ["src", "crates", "assets", "Cargo.toml", "Cargo.lock"] {
        println!("cargo::rerun-if-changed={path}");
    }
    for name in ["HEAD", "logs/HEAD", "packed-refs"] {
        if let Some(path) = git(&["rev-parse", "--git-path", name])
            && Path::new(&path).exists()
        {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let changes = git(&["status", "--porcelain", "--untracked-files=no"])?;
    if changes.is_empty() {
        Some(shortened(&commit))
    } else {
        Some(format!("{}, modified", shortened(&commit)))
    }
}

/// Returns the output of a git command; `None` without git, or if the command fails.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    if !output.status.success() {
        return None;
    }
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned())
}

fn is_commit(text: &str) -> bool {
    text.len() >= DIGITS && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

fn shortened(commit: &str) -> String {
    commit.chars().take(DIGITS).collect()
}
