//! Panels around the views.

pub mod advice;
pub mod answer_panel;
pub mod bars;
pub mod centre;
mod condition_marks;
pub mod conditions_panel;
pub mod cost_map;
pub mod explanation;
mod form;
pub mod forms;
pub mod help;
pub mod matrix_panel;
mod model_row;
pub mod models_panel;
mod path_forms;
mod phase_sketch;
pub mod reasons;
pub mod response_card;
pub mod result_panel;
pub mod settings_panel;
pub mod start_page;
pub mod status_bar;
pub mod table_menu;
pub mod verdict;
