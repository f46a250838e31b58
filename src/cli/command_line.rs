//! The words on the command line before clap parses them, and clap's errors as messages.

use std::error::Error;
use std::ffi::{OsStr, OsString};

use clap::error::{ContextKind, ContextValue};

use gdcm_study::decisions::setting::Kind;
use gdcm_study::decisions::setting_table::SETTINGS;

use super::terminal::OutputFormat;

/// Returns whether an argument is exactly `option`.
pub(super) fn has_argument(arguments: &[OsString], option: &str) -> bool {
    arguments.iter().any(|argument| argument == option)
}

/// Removes `--json` and `--quiet` before the command, and returns the output format that they
/// request. The parser itself cannot accept them there: it rejects a command after any other
/// argument, because it must reject one after the window's file. The first element in `arguments`
/// is the program.
pub(super) fn take_leading_switches(arguments: &mut Vec<OsString>) -> OutputFormat {
    let mut output = OutputFormat::default();
    while let Some(argument) = arguments.get(1) {
        if argument == "--json" {
            output.json = true;
        } else if argument == "--quiet" {
            output.quiet = true;
        } else {
            break;
        }
        arguments.remove(1);
    }
    output
}

/// Joins an option and its value by "=" if the option takes a variable number of values. Otherwise
/// `--gain-bounds auto FILE` would take the file as its second number, and `--schedule-delays FILE`
/// as its value.
pub(super) fn with_values_joined(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    for argument in arguments {
        match joined.last_mut() {
            Some(option) if is_value_of(&argument, option) => {
                option.push("=");
                option.push(argument);
            }
            _ => joined.push(argument),
        }
    }
    joined
}

/// Returns whether an argument is a word accepted by an option with a variable number of values:
/// the word for no value of a range, or one of the choices that a bare option also allows.
fn is_value_of(argument: &OsStr, option: &OsStr) -> bool {
    let Some(setting) = SETTINGS.iter().find(|setting| option == setting.option) else {
        return false;
    };
    match setting.kind {
        Kind::Range { nothing, .. } => argument == nothing.option,
        Kind::Choice { words, .. } if setting.bare.is_some() => {
            words.iter().any(|word| argument == word.option)
        }
        _ => false,
    }
}

/// Returns clap's error message on one line, without the usage, which is printed separately. For an
/// invalid value, returns the option and the reason.
pub(super) fn usage_words(error: &clap::Error) -> String {
    if let (Some(ContextValue::String(option)), Some(reason)) =
        (error.get(ContextKind::InvalidArg), error.source())
    {
        return format!("{}: {reason}", option.split(' ').next().unwrap_or(option));
    }
    let words = error.to_string();
    let complaint = words.split("\n\nUsage:").next().unwrap_or(&words);
    let paragraphs: Vec<String> = complaint
        .split("\n\n")
        .filter(|paragraph| !paragraph.starts_with("For more information"))
        .map(on_one_line)
        .collect();
    let line = paragraphs.join("; ");
    format!(
        "{} (see gdcm --help)",
        line.strip_prefix("error: ").unwrap_or(&line).trim_end()
    )
}

/// Joins a paragraph's lines by blanks.
fn on_one_line(paragraph: &str) -> String {
    let lines: Vec<&str> = paragraph.lines().map(str::trim).collect();
    lines.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the remaining arguments after the program, and the output that the removed switches
    /// request.
    fn leading(words: &str) -> (Vec<String>, OutputFormat) {
        let mut arguments: Vec<OsString> = words.split(' ').map(OsString::from).collect();
        let output = take_leading_switches(&mut arguments);
        let left = arguments.into_iter().skip(1);
        let left = left.map(|word| word.into_string().expect("text")).collect();
        (left, output)
    }

    #[test]
    fn switches_before_the_command_are_taken_and_others_stay() {
        let both = OutputFormat {
            quiet: true,
            json: true,
        };
        let none = OutputFormat::default();
        let words = ["check".to_owned(), "--json".to_owned()];
        assert_eq!(
            leading("gdcm --json --quiet check --json"),
            (words.to_vec(), both)
        );
        assert_eq!(leading("gdcm check --json"), (words.to_vec(), none));
        assert_eq!(leading("gdcm"), (Vec::new(), none));
    }
}
