//! Commands, and the table from which menus, keys and palette are made.

pub mod assembling;
pub mod command;
pub mod command_palette;
pub mod command_table;
pub mod computing;
pub mod curve_entries;
pub mod display;
mod edit_entries;
pub mod entry;
pub mod file;
mod file_entries;
pub mod form;
pub mod layout;
pub mod output;
pub mod records;
pub mod selection;
pub mod study;
mod view_entries;
