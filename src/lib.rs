//! The program: the window and the headless commands.

pub mod app;
pub mod cli;
pub mod executor;
pub mod view;
