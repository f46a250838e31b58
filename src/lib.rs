//! Program `gdcm`: applies the gain-delay correction method, in a window or by commands.
//!
//! This crate joins the library crates into a program; it computes nothing itself. Begin with
//! [`cli::run`], which parses the command line: each command is a file of [`cli`], and without a
//! command it opens the window, [`gui::app::open`]. In the window, `gui::panels` and `gui::views`
//! turn clicks into commands (`gui::commands`), which change the state (`gui::state`) and start
//! background work. Commands and window use the threads of [`executor`], and tell the engineer what
//! happened by a [`message`] with a stable code ([`message_codes`]). `docs/architecture.md`
//! shows the crates below this one, and follows a click and a flight record through them.

pub mod cli;
pub mod executor;
pub mod gui;
pub mod licences;
pub mod message;
pub mod message_codes;
pub mod version;
