//! Commands, and the table from which menus, keys and palette are made.
//!
//! `command.rs` joins the command groups, one file each; `gui/app/…_commands.rs` carries them out.
//! `command_table.rs` lists them as entries (`entry.rs`) with names and keys, and
//! `command_palette.rs` searches the list.

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
pub mod step_name;
pub mod study;
mod view_entries;
