//! State of the window: document, display, results.

pub mod arrangement;
pub mod assembling;
pub mod assembly_columns;
pub mod assessed_figures;
pub mod channels_view;
pub mod curve_display;
pub mod display;
pub mod evidence_cache;
pub mod forms;
pub mod mapped_cost;
pub mod modes_cache;
pub mod notices;
pub mod opens_with;
pub mod pair_set;
pub mod preferences;
pub mod records;
pub mod requirements_page;
pub mod results;
pub mod sheet;
pub mod tables;
pub mod view;
pub mod window_state;
