//! Commands of the window: one table for menu, keys and palette.

pub mod assembling;
pub mod command;
pub mod command_palette;
pub mod command_table;
pub mod curve_entries;
pub mod entry;
pub mod records;
