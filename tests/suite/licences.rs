//! Licences of the libraries in the program.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::commands::Desk;

/// Returns the names and versions in the list of licences: lines such as
/// `  egui 0.37.0  https://…`.
fn listed() -> Vec<(String, String)> {
    let mut found = Vec::new();
    for line in gdcm::licences::TEXT.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let is_entry = line.starts_with("  ")
            && !line.starts_with("   ")
            && (words.len() == 2 || (words.len() == 3 && words[2].starts_with("http")))
            && words[1].split('.').count() >= 3
            && words[1].starts_with(|digit: char| digit.is_ascii_digit());
        if is_entry {
            found.push((words[0].to_owned(), words[1].to_owned()));
        }
    }
    found
}

/// Returns the names and versions of the libraries that are built into the program on this system,
/// or that write its code.
fn built() -> Vec<(String, String)> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--package", "gdcm", "--edges", "normal,build"])
        .args(["--prefix", "none", "--format", "{p}"])
        .args(["--locked", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    let mut found = Vec::new();
    for line in String::from_utf8(output.stdout).unwrap().lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        // Packages of this workspace are followed by their paths.
        let is_own = words
            .get(2)
            .is_some_and(|word| word.starts_with('(') && word.contains(['/', '\\']));
        if !is_own && words.len() >= 2 {
            found.push((
                words[0].to_owned(),
                words[1].trim_start_matches('v').to_owned(),
            ));
        }
    }
    found.sort();
    found.dedup();
    found
}

/// If this fails: `packaging/licences/collect`.
#[test]
fn licences_of_every_library_are_listed() {
    let listed = listed();
    let built = built();
    assert!(built.len() > 150, "{} libraries", built.len());
    let missing: Vec<_> = built
        .iter()
        .filter(|library| !listed.contains(library))
        .collect();
    assert!(missing.is_empty(), "not listed: {missing:?}");
    // Libraries of other systems too: none of an earlier version.
    let lock = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.lock");
    let lock = fs::read_to_string(lock).unwrap();
    let outdated: Vec<_> = listed
        .iter()
        .filter(|(name, version)| {
            !lock.contains(&format!("name = \"{name}\"\nversion = \"{version}\"\n"))
        })
        .collect();
    assert!(outdated.is_empty(), "no longer used: {outdated:?}");
}

#[test]
fn a_command_prints_the_licences_of_the_fonts_too() {
    let ended = Desk::new().gdcm(&["licences"]);
    ended.assert_done();
    for name in ["egui 0", "Apache License", "SIL OPEN FONT LICENSE"] {
        assert!(ended.out.contains(name), "{name}");
    }
}
