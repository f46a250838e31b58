//! Executable: opens the window, or carries out a command.

use std::process::ExitCode;

fn main() -> ExitCode {
    gdcm::version::set_commit();
    gdcm_io::output_set::report_size_limit();
    gdcm::cli::run(std::env::args_os(), gdcm::gui::app::open)
}
