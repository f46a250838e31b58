//! Panels around the views: menu and status bar, conditions and models at the left
//! (`conditions_panel.rs`, `models_panel.rs`, in narrow windows `rail.rs`), verdict, result and
//! matrix at the right (`right_panel.rs`), views in the middle (`centre.rs`), and forms in front.

pub mod advice;
pub mod centre;
mod condition_marks;
mod condition_rows;
pub mod conditions_panel;
pub mod cost_map;
mod cost_picture;
pub mod derivation_sheet;
mod dock;
mod export_dialog;
mod form_parts;
pub mod forms;
mod keys_page;
mod matrix_cell;
pub mod matrix_panel;
pub mod menu_bar;
pub mod message_bars;
mod messages_page;
mod model_row;
pub mod models_panel;
mod open_study_card;
mod path_forms;
mod phase_sketch;
pub mod rail;
pub mod reasons;
mod record_dataset_form;
pub mod response_card;
pub mod result_panel;
pub mod right_panel;
pub mod settings_panel;
pub mod sheet_frame;
mod sign_reversal;
mod start_icons;
pub mod start_page;
pub mod status_bar;
pub mod table_menu;
mod toasts;
pub mod tour;
mod trim_columns;
pub mod verdict;
mod verdict_caution;
mod verdict_view;
mod verdict_words;
mod view_bar;
mod view_frame;
