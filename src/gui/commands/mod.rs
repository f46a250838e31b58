//! Commands of the window: one table for menu, keys and palette.

pub mod command;
pub mod command_palette;
pub mod command_table;
