//! Window content: functions that draw the state and return the engineer's commands.

pub mod answer_panel;
pub mod assembling;
pub mod bars;
pub mod centre;
pub mod command;
pub mod command_palette;
pub mod command_table;
pub mod conditions_panel;
pub mod controls;
pub mod cost_map;
pub mod curve_display;
pub mod display;
pub mod explanation;
pub mod figures;
pub mod focus;
pub mod forms;
pub mod help;
pub mod matrix_panel;
pub mod models_panel;
pub mod palette;
pub mod plot;
pub mod records;
pub mod result_panel;
pub mod settings_panel;
pub mod start_page;
pub mod state;
pub mod tables;
pub mod verdict;
pub mod views;

pub use bars::Bar;
pub use command::{Command, FormKind, RequirementTable};

pub use controls::restore_panel_size;

pub use display::{Arrangement, Preferences};
pub use explanation::Sheet;

pub use state::{RecentFile, State};

pub use views::{Need, View};
