//! Panels around the views: menu and status bar, conditions and models at the left
//! (`conditions_panel.rs`, `models_panel.rs`, in narrow windows `rail.rs`), verdict, result and
//! matrix at the right (`answer_panel.rs`), views in the middle (`centre.rs`), and forms in front.

pub mod advice;
pub mod answer_panel;
pub mod centre;
mod condition_marks;
mod condition_rows;
pub mod conditions_panel;
pub mod cost_map;
mod dock;
pub mod explanation;
mod form;
pub mod forms;
mod keys_page;
pub mod matrix_panel;
pub mod menu_bar;
pub mod message_bars;
mod model_row;
pub mod models_panel;
mod path_forms;
mod phase_sketch;
pub mod rail;
pub mod reasons;
pub mod response_card;
pub mod result_panel;
pub mod settings_panel;
pub mod sheet_frame;
mod sign_reversal;
pub mod start_page;
pub mod status_bar;
pub mod table_menu;
pub mod tour;
pub mod verdict;
mod verdict_view;
mod view_bar;
mod view_frame;
