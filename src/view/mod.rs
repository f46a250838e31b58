//! What the window shows: functions that draw the state and say what the engineer asks for.

mod assessment_scene;
pub mod bars;
pub mod bode_scene;
pub mod centre;
pub mod command;
pub mod conditions_panel;
pub mod explanation;
pub mod focus_ring;
pub mod forms;
mod heading;
pub mod matrix_panel;
pub mod menu_bar;
pub mod models_panel;
pub mod net_gain_scene;
pub mod number_field;
pub mod palette;
pub mod plot;
pub mod region;
pub mod result_panel;
mod row;
pub mod settings_panel;
pub mod state;
pub mod status_bar;
