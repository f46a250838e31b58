//! The window: application, commands, panels, plots, state, views and widgets.

pub mod app;
pub mod commands;
pub mod panels;
pub mod plot;
pub mod state;
pub mod views;
pub mod widgets;
