//! The window.

pub mod app;
pub mod commands;
pub mod panels;
pub mod plot;
pub mod state;
pub mod views;
pub mod widgets;
