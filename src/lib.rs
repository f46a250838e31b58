//! The program: the window and the headless commands.

pub mod cli;
pub mod executor;
pub mod gui;
