//! Program `gdcm`: applies the gain-delay correction method, in a window or by commands.
//!
//! This crate joins the library crates into a program; the numbers come from them. Begin with
//! [`cli::run`], which parses the command line: each command is a file in [`cli`], and without a
//! command it opens the window, [`gui::app::open`]. In the window, `gui::panels` and `gui::views`
//! turn clicks into commands (`gui::commands`), which change the state (`gui::state`) and start
//! background work. Commands and window use the threads in [`executor`], and tell the engineer what
//! happened by a [`message`] with a stable code ([`message_codes`]). [`cli::calls`] offers the
//! commands as functions, which the Python module exposes. `docs/architecture.md` shows the crates
//! below this one, and follows a click and a flight record through them.
//!
//! Section numbers (M4, M13.2, ...) are those of the pages listed under
//! [Sections M1 to M18](gdcm_method#sections-m1-to-m18).

pub mod cli;
pub mod executor;
pub mod gui;
pub mod licences;
pub mod message;
pub mod message_codes;
pub mod version;

use std::ffi::OsString;

/// Runs the program: carries out a command, or opens the window. The first argument is the program
/// name. Returns the exit status.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    version::set_commit();
    gdcm_io::output_set::report_size_limit();
    cli::run(arguments, gui::app::open)
}
