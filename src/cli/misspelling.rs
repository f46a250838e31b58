//! Recognises misspelt commands on the command line.

use std::ffi::OsString;
use std::path::Path;

use clap::CommandFactory;

use gdcm_model::message_text::{sanitized, shortened};

use super::arguments::Arguments;
use super::failure::Failure;

/// Returns the failure if the first word on the command line is neither a command nor a file but
/// differs from a command by one or two letters; otherwise `None`. The first element in `arguments`
/// is the program.
pub(super) fn misspelt_command(arguments: &[OsString]) -> Option<Failure> {
    let word = arguments
        .iter()
        .skip(1)
        .find(|argument| !argument.to_string_lossy().starts_with('-'))?;
    let word = word.to_str()?;
    let names_a_file = word.contains(['/', '\\', '.']) || Path::new(word).exists();
    let commands = Arguments::command();
    let is_a_command = word == "help" || commands.find_subcommand(word).is_some();
    if names_a_file || is_a_command {
        return None;
    }
    let nearest = commands
        .get_subcommands()
        .flat_map(|command| command.get_name_and_visible_aliases())
        .min_by_key(|name| edit_distance(word, name))?;
    // A word with fewer than five letters may differ by one letter only; with two, it would be a
    // different word.
    let most = if word.chars().count() < 5 { 1 } else { 2 };
    if edit_distance(word, nearest) > most {
        return None;
    }
    Some(Failure::UnknownCommand {
        found: shortened(&sanitized(word)),
        suggestion: nearest.to_owned(),
    })
}

/// Returns the Levenshtein distance: the minimum number of letters to insert, delete or replace to
/// turn one word into the other (V. I. Levenshtein, "Binary codes capable of correcting deletions,
/// insertions, and reversals", 1966).
fn edit_distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    // Distances from the processed part of `from` to each prefix of `to`, by the prefix's length.
    let mut distances: Vec<usize> = (0..=to.len()).collect();
    for (row, letter) in from.chars().enumerate() {
        // Distance before `letter` in `from` and before the letter `column` in `to`.
        let mut before_both = distances[0];
        distances[0] = row + 1;
        for column in 0..to.len() {
            let replaced = before_both + usize::from(letter != to[column]);
            let deleted = distances[column + 1] + 1;
            let inserted = distances[column] + 1;
            before_both = distances[column + 1];
            distances[column + 1] = replaced.min(deleted).min(inserted);
        }
    }
    distances[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suggestion(words: &[&str]) -> Option<String> {
        let arguments: Vec<OsString> = ["gdcm"].iter().chain(words).map(OsString::from).collect();
        match misspelt_command(&arguments)? {
            Failure::UnknownCommand { suggestion, .. } => Some(suggestion),
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_misspelt_command_is_distinguished_from_a_file() {
        for (word, command) in [
            ("analize", "analyze"),
            ("exprot", "export"),
            ("chek", "check"),
            ("Assemble", "assemble"),
        ] {
            assert_eq!(
                suggestion(&["--json", word, "x"]).as_deref(),
                Some(command),
                "{word}"
            );
        }
        for words in [
            &["analyze", "analize"][..],
            &["analyse"],
            &["help"],
            &["./analize"],
            &["analize.json"],
            &["data"],
            &["--version"],
            &[],
        ] {
            assert_eq!(suggestion(words), None, "{words:?}");
        }
    }

    #[test]
    fn the_distance_counts_letters() {
        for (from, to, distance) in [
            ("", "abc", 3),
            ("kitten", "sitting", 3),
            ("same", "same", 0),
        ] {
            assert_eq!(
                (edit_distance(from, to), edit_distance(to, from)),
                (distance, distance)
            );
        }
    }
}
