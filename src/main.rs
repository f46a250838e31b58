//! The program: a window, or one of the commands without one.

use std::process::ExitCode;

use gdcm::cli::{self, Request};

fn main() -> ExitCode {
    gdcm_files::report_size_limit();
    match cli::request(std::env::args_os()) {
        Ok(Request::Window(file)) => gdcm::app::open(file),
        Ok(Request::Command(command)) => cli::run(&command),
        Err(status) => status,
    }
}
