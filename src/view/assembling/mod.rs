//! Importing models of many files: a table with a line a model, what each is to be, and its response.

mod assembling_view;
mod assembly_state;
mod details;
mod preview;
mod table;

pub use assembling_view::assembling_ui;
pub use assembly_state::{AssemblingCommand, AssemblyState, Reading};
pub use table::{COLUMNS, Column};

use details::{columns_ui, details_ui};
use preview::Preview;
use preview::preview_ui;
use table::{problems_ui, table_ui};
