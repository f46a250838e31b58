//! Widgets, tables and colours, from which views and panels are made.
//!
//! Begin with `controls.rs` (named controls, buttons), `painted_text.rs` (text in rows) and
//! `palette.rs` (colours and fonts). None of them knows the study.

pub mod choices;
pub mod controls;
pub mod drawer;
pub mod elision;
pub mod escape_key;
pub mod focus_ring;
pub mod list_row;
pub mod number_entry;
pub mod number_field;
pub mod page_switch;
pub mod painted_text;
pub mod palette;
pub mod panel_layout;
pub mod sorting;
mod table_layout;
pub mod tables;
pub mod text_fields;
pub mod window_regions;
