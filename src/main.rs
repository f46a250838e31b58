//! Executable: opens the window, or carries out a command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(gdcm::run(std::env::args_os()))
}
