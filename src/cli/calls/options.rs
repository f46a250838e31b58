//! A call's options, written as on the command line.

use std::ffi::OsString;

use clap::{Args, Command};

use crate::cli::command_line::{usage_words, with_values_joined};
use crate::cli::failure::Failure;

/// Reads a command's options.
///
/// # Errors
/// An option is unknown or incomplete, or its value cannot be read.
pub(super) fn parsed<A: Args>(options: impl IntoIterator<Item = OsString>) -> Result<A, Failure> {
    let command = A::augment_args(Command::new("gdcm").no_binary_name(true));
    let matches = command.try_get_matches_from(with_values_joined(options));
    match matches.and_then(|matches| A::from_arg_matches(&matches)) {
        Ok(arguments) => Ok(arguments),
        Err(wrong) => Err(Failure::CommandLine {
            words: usage_words(&wrong),
        }),
    }
}

/// Returns the names of a command's options, such as "--band", in the same order as its help.
pub(super) fn option_names<A: Args>() -> Vec<String> {
    let command = A::augment_args(Command::new("gdcm"));
    let mut names = Vec::new();
    for argument in command.get_arguments() {
        if let Some(name) = argument.get_long() {
            names.push(format!("--{name}"));
        }
    }
    names
}
