//! Putting models of many files together: a table with a line a model, what each is to be, and its response.

mod channels;
mod columns;
mod details;
mod entry;
mod header;
mod preview;
mod problems;
mod table;
mod workbench;

pub use entry::{entry_ui, typed_number};
pub use header::assembling_ui;
pub use table::{Column, cell_text};
pub use workbench::{AssemblingCommand, Reading, Workbench};
