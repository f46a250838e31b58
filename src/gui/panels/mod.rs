//! Panels around the views.

pub mod answer_panel;
pub mod bars;
pub mod centre;
pub mod conditions_panel;
pub mod cost_map;
pub mod explanation;
pub mod forms;
pub mod help;
pub mod matrix_panel;
pub mod models_panel;
pub mod response_card;
pub mod result_panel;
pub mod settings_panel;
pub mod start_page;
pub mod table_menu;
pub mod verdict;
